# SPDX-License-Identifier: MIT
"""Contact of SAM's cells, smooth or rough, at rest or sliding, their displacement summed directly; as in
`conditions`.

Pressure by Love's closed form, traction by the integral of Cerruti's over a cell, plastic strain by
reciprocity with the stress of a point force on the surface (Maysel): u_z(x) = integral of strain : stress of
a unit force at x over the plastic cells.
"""

from collections.abc import Callable, Mapping, Sequence
from functools import cache
from itertools import pairwise

import numpy as np

from sam import choose_grid
from sam.scene import Checkpoint, Result, Scene
from verification.checks.conditions import (
    conditions,
    initial_gap,
    opposite,
    peak_rows,
    plane_of,
    surface_of,
    traction_of,
)
from verification.checks.material import fields_at_points
from verification.reference.point_loads import boussinesq_stress, cerruti_stress

NEAR = 2
FEW, MANY, BELOW = 4, 12, 40
"""Gauss points each way: of all cells; of those so near to the force, in cells and layers; of that below it,
where the stress is singular. The last gives 1e-6 of the displacement by the plastic strain."""
DEEP, COLUMNS = 2.0, 12
"""Cells: from there on FEW points give the stress below a cell to 1e-7 of its pressure."""
TWICE = np.array([1.0, 1.0, 1.0, 2.0, 2.0, 2.0])


def displaced(scene: Scene, result: Result, records: Sequence[Checkpoint]) -> float:
    """`conditions` of all cells, displaced by direct sums; records: after each load step, of plasticity."""
    x, y, p = surface_of(result)
    cell, q = result.discretisation["cell_m"], traction_of(scene, result)
    u = half_space(scene.body.young, scene.body.poisson, x, y, p=p, q=q, cell=cell)
    if records:
        trees = [record.tree() for record in records]
        u = u + residual_uz(scene, max(trees, key=lambda tree: tree["state"]["load"]["force"]), cell, p.shape)
    height = 0.0
    if scene.patch_surface is not None:
        height = np.asarray(result.fields.cell_data["height_m"])[: p.size].reshape(p.shape)
        height = height + opposite(peak_rows(result, "surface")).reshape(p.shape)
    return conditions(initial_gap(scene, x[:, None], y[None, :], height) + u, p, result)


def left(scene: Scene, result: Result, records: Sequence[Checkpoint]) -> float:
    """What is left without force on y = 0 less direct sums, over the approach; an odd number of rows."""
    shape = surface_of(result)[2].shape
    own = residual_uz(scene, records[-1].tree(), result.discretisation["cell_m"], shape)[:, shape[1] // 2]
    returned = peak_rows(result, "line", "unloaded")["uz_m"]
    return float(np.abs(own - returned).max()) / result.quantities["approach_m"]


def stress(scene: Scene, result: Result) -> float:
    """Stress of an elastic body in y = 0, DEEP cells and deeper, less sums over points of the cells
    in contact; over p_max. Of Boussinesq's and Cerruti's stress of point forces, in about COLUMNS
    columns of the plane.
    """
    (x, y, p), q = surface_of(result), traction_of(scene, result)
    cell, (at, z, returned) = result.discretisation["cell_m"], plane_of(result)
    deep, few = z >= DEEP * max(cell) * (1 - 1e-9), slice(None, None, max(1, at.size // COLUMNS))
    i, j = np.nonzero(p)
    px, wx = gauss(x[i] - cell[0] / 2, x[i] + cell[0] / 2)
    py, wy = gauss(y[j] - cell[1] / 2, y[j] + cell[1] / 2)
    dx = at[few, None, None, None, None] - px[:, :, None]
    dy, weight = -py[:, None, :], wx[:, :, None] * wy[:, None, :]
    place, nu = (dx, dy, z[deep, None, None, None]), scene.body.poisson
    forces = (boussinesq_stress, p), (cerruti_stress, q)
    own = sum(
        np.einsum("xznabc,nab->cxz", of(*place, 1.0, nu=nu), weight * load[i, j, None, None])
        for of, load in forces
    )
    return float(np.abs(own - returned[:, few][:, :, deep]).max() / p.max())


def half_space(
    young: float,
    poisson: float,
    x: np.ndarray,
    y: np.ndarray,
    *,
    p: np.ndarray,
    q: np.ndarray,
    cell: Sequence[float],
) -> np.ndarray:
    """(nx, ny) displacement in m of the surface of an elastic half-space under p and q (nx, ny) in Pa."""
    share = (1 - 2 * poisson) * (1 + poisson) / (2 * np.pi * young)
    return (1 - poisson**2) / (np.pi * young) * love(x, y, p, cell) + share * cerruti(x, y, q, cell)


def love(x: np.ndarray, y: np.ndarray, p: np.ndarray, cell: Sequence[float]) -> np.ndarray:
    """(nx, ny) sums of p times the integral of dA/r over each cell, at the centres x (nx,) and y
    (ny,), in m Pa. x ln(y + r) + y ln(x + r) at the corners, by asinh, which loses no digits.
    """
    return _corners(
        x, y, p, cell, primitive=lambda X, Y: X * np.arcsinh(Y / np.abs(X)) + Y * np.arcsinh(X / np.abs(Y))
    )


def cerruti(x: np.ndarray, y: np.ndarray, q: np.ndarray, cell: Sequence[float]) -> np.ndarray:
    """The same of x/r^2 and q: y ln(r) + x atan(y/x) at the corners."""
    return _corners(
        x, y, q, cell, primitive=lambda X, Y: 0.5 * Y * np.log(X**2 + Y**2) + X * np.arctan(Y / X)
    )


def _corners(
    x: np.ndarray, y: np.ndarray, load: np.ndarray, cell: Sequence[float], *, primitive: Callable
) -> np.ndarray:
    i, j = np.nonzero(load)
    dx, dy = (x[:, None] - x[i])[:, None, :], (y[:, None] - y[j])[None, :, :]
    sides = ((a, b) for a in (-1, 1) for b in (-1, 1))
    return sum(a * b * primitive(dx + a * cell[0] / 2, dy + b * cell[1] / 2) @ load[i, j] for a, b in sides)


def residual_uz(scene: Scene, tree: Mapping, cell: Sequence[float], shape: tuple[int, int]) -> np.ndarray:
    """(nx, ny) displacement in m by the plastic strain of a record."""
    window, points = tree["extent"]["window"], fields_at_points(tree["state"]["material"])
    strain = TWICE[:, None, None, None] * points["strain"].mean(axis=1)
    faces = choose_grid(scene).faces[: strain.shape[1] + 1]
    i0, j0, n, m = (window[name] for name in ("i0", "j0", "nx", "ny"))
    reach = max(shape[0] - i0, i0 + n), max(shape[1] - j0, j0 + m)
    influence = reciprocal(tuple(cell), reach, tuple(faces), scene.body.poisson)
    middle = influence.shape[2] // 2 + i0, influence.shape[3] // 2 + j0
    out = np.empty(shape)
    for i, j in np.ndindex(shape):
        here = slice(middle[0] - i, middle[0] - i + n), slice(middle[1] - j, middle[1] - j + m)
        out[i, j] = np.vdot(influence[(..., *here)], strain)
    return out


@cache
def reciprocal(
    cell: tuple[float, float], reach: tuple[int, int], faces: tuple[float, ...], poisson: float
) -> np.ndarray:
    """(6, nz, 2 rx + 1, 2 ry + 1) integrals of a unit force's stress over cells, by their distance."""
    lags = [h * np.arange(-r, r + 1) for r, h in zip(reach, cell, strict=True)]
    out = np.empty((6, len(faces) - 1, *(lag.size for lag in lags)))
    for layer, z in enumerate(pairwise(faces)):
        x, y = (gauss(lag - h / 2, lag + h / 2) for lag, h in zip(lags, cell, strict=True))
        out[:, layer] = integrals(x, y, gauss(*np.atleast_2d(z).T), poisson)[..., 0]
        for i, j in np.ndindex(2 * NEAR + 1, 2 * NEAR + 1) if layer <= NEAR else ():
            i, j = reach[0] - NEAR + i, reach[1] - NEAR + j
            count = BELOW if layer == 0 and (i, j) == reach else MANY
            sides = [(lag[k] - h / 2, lag[k] + h / 2) for lag, k, h in zip(lags, (i, j), cell, strict=True)]
            out[:, layer, i, j] = integrals(*(towards_zero(*side, count) for side in (*sides, z)), poisson)[
                :, 0, 0, 0
            ]
    return out


Rule = tuple[np.ndarray, np.ndarray]
"""Points and weights, (n intervals, m)."""


def gauss(low: np.ndarray, high: np.ndarray, count: int = FEW) -> Rule:
    """Of Gauss between low and high (n,)."""
    nodes, weights = np.polynomial.legendre.leggauss(count)
    half = 0.5 * (high - low)[:, None]
    return low[:, None] + half * (1.0 + nodes), half * weights


def towards_zero(low: float, high: float, count: int) -> Rule:
    """One interval, split at zero if that is inside, and in parts that end there of x = t^3."""
    ends = [low, 0.0, high] if low < 0.0 < high else [low, high]
    roots = np.cbrt(ends) if 0.0 in ends else np.array(ends)
    t, weight = (part.reshape(1, -1) for part in gauss(roots[:-1], roots[1:], count))
    return (t**3, 3 * t**2 * weight) if 0.0 in ends else (t, weight)


def integrals(x: Rule, y: Rule, z: Rule, poisson: float) -> np.ndarray:
    """(6, nx, ny, nz) of the stress of a unit force at the origin."""
    at = x[0].reshape(-1, 1, 1), y[0].reshape(1, -1, 1), z[0].reshape(1, 1, -1)
    weight = x[1].reshape(-1, 1, 1) * y[1].reshape(1, -1, 1) * z[1].reshape(1, 1, -1)
    stress = np.moveaxis(boussinesq_stress(*at, 1.0, nu=poisson), -1, 0) * weight
    (nx, mx), (ny, my), (nz, mz) = (rule[0].shape for rule in (x, y, z))
    return stress.reshape(6, nx, mx, ny, my, nz, mz).sum(axis=(2, 4, 6))
