# SPDX-License-Identifier: MIT
"""Shakedown limits of a Hertz load that travels over a perfectly plastic body with Prager's back-stress.

Melan's theorem for linear kinematic hardening holds at each point by itself: a body shakes down exactly if at
each point the elastic stress deviators of a pass, and none, lie in a ball of radius sqrt(2) k, k the shear
yield stress, about any centre (E. Melan, Ing.-Arch. 9 (1938) 116-126; the back-stress takes the centre). So
p0/k = sqrt(2)/R, R the radius of the smallest ball about the deviators for p0 = 1, at the worst depth.
"""

import numpy as np
from scipy.optimize import minimize

from .hamilton import sliding_stress
from .stress import deviator

FAR, POINTS = 5.0, 401  # contact radii before and behind, and places there
SHEARS = np.sqrt([1.0, 1.0, 1.0, 2.0, 2.0, 2.0])
"""With them the sum of squares of the six components is s:s."""


def smallest_ball(points: np.ndarray) -> tuple[np.ndarray, float]:
    """Centre (m,) and radius of the smallest ball that holds points (n, m). A quadratic program: the least t
    + c.c with |s|^2 - 2 s.c <= t at all points.
    """
    points = np.asarray(points, dtype=float)
    scale = np.abs(points).max()
    s = points / scale
    square = (s**2).sum(axis=1)

    def cost(at: np.ndarray) -> float:
        return float(at[-1] + at[:-1] @ at[:-1])

    def slope(at: np.ndarray) -> np.ndarray:
        return np.append(2 * at[:-1], 1.0)

    inside = {
        "type": "ineq",
        "fun": lambda at: at[-1] - square + 2 * s @ at[:-1],
        "jac": lambda _: np.hstack([2 * s, np.ones((len(s), 1))]),
    }
    middle = (s.max(axis=0) + s.min(axis=0)) / 2
    start = np.append(middle, (square - 2 * s @ middle).max())
    how = {"method": "SLSQP", "options": {"ftol": 1e-14, "maxiter": 300}}
    found = minimize(cost, start, jac=slope, constraints=[inside], **how)
    centre = found.x[:-1]
    return scale * centre, scale * float(np.sqrt(((s - centre) ** 2).sum(axis=1).max()))


def pass_of(depth: float, *, nu: float, friction: float, alternates: bool = False) -> np.ndarray:
    """Deviators over p0 that a point in y = 0 at a depth in contact radii meets, and none: (n, 6), their sums
    of squares s:s. alternates: both signs of the traction.
    """
    x = np.linspace(-FAR, FAR, POINTS)
    signs = (1.0, -1.0) if alternates and friction else (1.0,)
    load = {"contact_radius": 1.0, "nu": nu}
    stress = [sliding_stress(x, 0.0, depth, 1.0, **load, friction=sign * friction) for sign in signs]
    return np.vstack([np.zeros(6), deviator(np.concatenate(stress))]) * SHEARS


def travelling_limit(
    friction: float, *, nu: float = 0.3, alternates: bool = False, depths: np.ndarray | None = None
) -> tuple[float, float]:
    """(p0/k at the shakedown limit, depth of the worst point in contact radii); below the surface."""
    depths = np.linspace(0.2, 0.6, 41) if depths is None else depths
    load = {"nu": nu, "friction": friction, "alternates": alternates}
    radii = [smallest_ball(pass_of(float(z), **load))[1] for z in depths]
    worst = int(np.argmax(radii))
    return float(np.sqrt(2) / radii[worst]), float(depths[worst])


def in_place_limit(friction: float, *, nu: float = 0.3) -> tuple[float, float]:
    """(p0/k at the shakedown limit, depth in contact radii) of a load that comes and goes in one place: the
    smallest ball about a deviator and none has half its norm, so the limit is twice the load of first yield.
    In y = 0 and below the surface: for friction up to 0.25 the worst point is there.
    """
    x, z = np.meshgrid(np.linspace(-0.6, 0.6, 121), np.linspace(0.2, 0.7, 201), indexing="ij")
    stress = sliding_stress(x, 0.0, z, 1.0, contact_radius=1.0, nu=nu, friction=friction)
    size = np.linalg.norm(deviator(stress) * SHEARS, axis=-1)
    worst = np.unravel_index(size.argmax(), size.shape)
    return float(np.sqrt(2) * 2 / size[worst]), float(z[worst])


def cell_limit(friction: float, h: float, stops: np.ndarray, *, nu: float = 0.3) -> float:
    """p0/k at the shakedown limit of cells of width h, which see means of the stress over them, under a load
    that stops at x = stops; both in contact radii. Of the cells in y = 0 about the middle, below the surface.
    """
    at, weight = np.polynomial.legendre.leggauss(3)
    weights = np.einsum("i,j,k->ijk", weight, weight, weight)[..., None] / 8
    x, y, z = (h / 2 * each for each in np.meshgrid(at, at, at, indexing="ij"))
    about = {"contact_radius": 1.0, "nu": nu, "friction": friction}

    def radius(centre: float, depth: float) -> float:
        places = [(centre - stop + x, y, depth + z) for stop in stops]
        means = [(weights * sliding_stress(*place, 1.0, **about)).sum(axis=(0, 1, 2)) for place in places]
        return smallest_ball(np.vstack([np.zeros(6), deviator(np.array(means))]) * SHEARS)[1]

    centres = h * np.arange(-round(0.5 / h), round(0.5 / h) + 1)
    depths = h * (np.arange(int(0.2 / h), round(0.7 / h)) + 0.5)
    return float(np.sqrt(2) / max(radius(centre, depth) for centre in centres for depth in depths))


def upper_bound(friction: float, *, nu: float = 0.3) -> float:
    """Upper bound of p0/k at which a perfectly plastic body may shake down below a load that travels.
    Residual stress that a travelling load leaves is the same along x, so it shifts s_xz(x) at each depth by a
    constant: half the range of s_xz over x is at most k, and at the surface, where the residual s_xz is zero,
    friction p0 is. Without friction this is the limit of Ponter, Hearle and Johnson, J. Mech. Phys. Solids 33
    (1985) 339, 4.68; from the Hertz stresses here, in the plane y = 0.
    """
    x, z = np.meshgrid(np.linspace(-1.5, 1.5, 301), np.linspace(0.0, 1.5, 151), indexing="ij")
    shear = sliding_stress(x, 0.0, z, 1.0, contact_radius=1.0, nu=nu, friction=friction)[..., 4]
    half = float((shear[:, 1:].max(axis=0) - shear[:, 1:].min(axis=0)).max()) / 2.0
    return 1.0 / max(half, friction)
