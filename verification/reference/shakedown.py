# SPDX-License-Identifier: MIT
"""Shakedown limits of a Hertz load that travels over a perfectly plastic body with Prager's back-stress.

Melan's theorem for linear kinematic hardening holds at each point by itself: a body shakes down exactly if at
each point the elastic stress deviators of a pass, and none, lie in a ball of radius sqrt(2) k, k the shear
yield stress, about any centre (E. Melan, Ing.-Arch. 9 (1938) 116-126; the back-stress takes the centre). So
p0/k = sqrt(2)/R, R the radius of the smallest ball about the deviators for p0 = 1, at the worst depth.
"""

from __future__ import annotations

import numpy as np
from scipy.optimize import minimize

from .hamilton import sliding_stress

FAR, POINTS = 5.0, 401  # contact radii before and behind, and places there
SHEARS = np.sqrt([1.0, 1.0, 1.0, 2.0, 2.0, 2.0])
"""With them the sum of squares of the six components is s:s."""


def smallest_ball(points: np.ndarray) -> tuple[np.ndarray, float]:
    """Centre (m,) and radius of the smallest ball that holds points (n, m).

    A quadratic program: the least t + c.c with |s|^2 - 2 s.c <= t at all points.
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
    found = minimize(
        cost, start, jac=slope, constraints=[inside], method="SLSQP", options={"ftol": 1e-14, "maxiter": 300}
    )
    centre = found.x[:-1]
    return scale * centre, scale * float(np.sqrt(((s - centre) ** 2).sum(axis=1).max()))


def pass_of(depth: float, *, nu: float, friction: float, alternates: bool = False) -> np.ndarray:
    """Deviators over p0 that a point in y = 0 at a depth in contact radii meets, and none: (n, 6), their sums
    of squares s:s. alternates: both signs of the traction.
    """
    x = np.linspace(-FAR, FAR, POINTS)
    signs = (1.0, -1.0) if alternates and friction else (1.0,)
    stress = np.concatenate(
        [
            sliding_stress(x, 0.0, depth, 1.0, contact_radius=1.0, nu=nu, friction=sign * friction)
            for sign in signs
        ]
    )
    stress[:, :3] -= stress[:, :3].mean(axis=1, keepdims=True)
    return np.vstack([np.zeros(6), stress]) * SHEARS


def travelling_limit(
    friction: float, *, nu: float = 0.3, alternates: bool = False, depths: np.ndarray | None = None
) -> tuple[float, float]:
    """(p0/k at the shakedown limit, depth of the worst point in contact radii); below the surface."""
    depths = np.linspace(0.2, 0.6, 41) if depths is None else depths
    radii = [
        smallest_ball(pass_of(float(z), nu=nu, friction=friction, alternates=alternates))[1] for z in depths
    ]
    worst = int(np.argmax(radii))
    return float(np.sqrt(2) / radii[worst]), float(depths[worst])
