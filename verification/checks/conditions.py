# SPDX-License-Identifier: MIT
"""Conditions of a solution, measured on what a solver returned with formulas of our own: nothing of the
solvers' residuals.

The tables and the mesh of fields of a Result, and the states that SAM hands out after each load step; for
those of FEM see `axisymmetric` and `spatial` beside it, for displacements of SAM summed directly `cells` and
`coated`. Every value is dimensionless, and zero in an exact solution. A rigid counter-body, a sphere where
nothing else is said.
"""

from collections.abc import Mapping, Sequence
from itertools import pairwise

import numpy as np
from scipy.integrate import simpson

from sam.scene import COUNTER_HEIGHT, Checkpoint, Result, Scene
from verification.checks.material import back_stress, fields_at_points, flow_of, von_mises, yield_stress

# of the contact radius: so far from the edge of contact are tractions judged, where the stress is singular
EDGE = 0.25


def peak_rows(result: Result, name: str, state: str = "peak") -> dict[str, np.ndarray]:
    """Columns of a table at the peak, or in another state."""
    table = result.tables[name]
    here = np.asarray(table["state"]) == state
    return {column: np.asarray(values)[here] for column, values in table.items() if column != "state"}


def surface_of(result: Result) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """(x, y, p) of SAM's cells: centres in m, pressure (nx, ny) in Pa."""
    nx, ny = result.discretisation["cells"]
    hx, hy = result.discretisation["cell_m"]
    p = np.asarray(result.fields.cell_data["p_Pa"])[: nx * ny].reshape(nx, ny)
    return (np.arange(nx) - (nx - 1) / 2) * hx, (np.arange(ny) - (ny - 1) / 2) * hy, p


def plane_of(result: Result) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """(x, z, stress) of SAM in y = 0: (nx,), (nz,), (6, nx, nz)."""
    plane = peak_rows(result, "plane")
    x, z = np.unique(plane["x_m"]), np.unique(plane["z_m"])
    stress = np.asarray(result.fields.point_data["stress_Pa"])[-x.size * z.size :]
    return x, z, stress.reshape(x.size, z.size, 6).transpose(2, 0, 1)


def load(scene: Scene, result: Result) -> float:
    """Largest of three: relative errors of total force and of given approach; tension over peak pressure."""
    force = force_of(scene, result)
    if result.model == "sam":
        hx, hy = result.discretisation["cell_m"]
        p = surface_of(result)[2]
        total = p.sum() * hx * hy
    else:
        line = peak_rows(result, "line")
        r, p = line["x_m"], line["p_Pa"]
        total = simpson(2.0 * np.pi * r * p, x=r)  # of nodal pressures on quadratic edges
    return max(abs(float(total) / force - 1.0), missed_approach(scene, result), -float(p.min() / p.max()))


def force_of(scene: Scene, result: Result) -> float:
    """The force in N: of the scene, or the one that the result found for an approach."""
    return float(result.quantities["force_N"] if scene.loading.force is None else scene.loading.force)


def missed_approach(scene: Scene, result: Result) -> float:
    """How far the approach of a result is off the given one, over that; 0 where none is given."""
    given = scene.loading.approach
    return 0.0 if given is None else abs(result.quantities["approach_m"] / given - 1.0)


def complementarity(scene: Scene, result: Result) -> float:
    """p gap = 0, gap >= 0 on the line y = 0, the gap that of the shapes + uz - approach and that returned;
    over the approach. Of a rough body with the returned heights, on a grid with a row of cells on the line.
    """
    line, approach = peak_rows(result, "line"), result.quantities["approach_m"]
    if scene.patch_surface is None:
        shape = initial_gap(scene, line["x_m"], np.zeros(line["x_m"].size), 0.0)
    else:
        table = peak_rows(result, "surface")
        shape = initial_gap(scene, table["x_m"], table["y_m"], both_heights(table))[table["y_m"] == 0.0]
    distance = shape + line["uz_m"]
    returned = float(np.abs(distance - approach - line["gap_m"]).max()) / approach
    return max(conditions(distance, line["p_Pa"], result), returned)


def both_heights(table: Mapping[str, np.ndarray]) -> np.ndarray:
    """Returned heights of both bodies in m, one on the other."""
    return table["height_m"] + opposite(table)


def opposite(table: Mapping[str, np.ndarray]) -> np.ndarray:
    """Returned heights of the counter-body in m; zero of a smooth one."""
    return table.get(COUNTER_HEIGHT, np.zeros(table["height_m"].shape))


def conditions(distance: np.ndarray, p: np.ndarray, result: Result) -> float:
    """p gap = 0 and gap >= 0, gap = distance - approach in m; over the approach."""
    gap = distance / result.quantities["approach_m"] - 1.0
    return max(float(np.abs(gap[p > 0]).max()), -float(gap[p <= 0].min()))


GAPS = {
    "sphere": lambda other, x, y: x**2 / (2 * other.radius) + y**2 / (2 * other.radius),
    "ellipsoid": lambda other, x, y: x**2 / (2 * other.radius_x) + y**2 / (2 * other.radius_y),
    "punch": lambda other, x, y: np.where(np.hypot(x, y) <= other.radius, 0.0, np.inf),
    "rounded-punch": lambda other, x, y: (
        np.clip(np.hypot(x, y) - other.flat_radius, 0.0, None) ** 2 / (2 * other.radius)
    ),
    "flat": lambda other, x, y: np.zeros(x.shape),
    "cylinder": lambda other, x, y: x**2 / (2 * other.radius) + 0 * y,
}
"""The gap in m of each shape of counter-body, written once more."""


def initial_gap(scene: Scene, x: np.ndarray, y: np.ndarray, height: np.ndarray | float) -> np.ndarray:
    """Counter-body less height in m at places x, y; of a rough body zero where they touch first."""
    gap = GAPS[scene.counterbody.shape](scene.counterbody, x, y) - height
    return gap if scene.patch_surface is None else gap - gap.min()


def coefficient_at(scene: Scene, x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Coefficient of friction at places (n,) in m, by the scene: of a map the nearest cell's."""
    if scene.friction is None or scene.constant_friction:
        return np.full(x.shape, scene.coefficient)
    given = scene.friction.path
    lines = (
        ((np.arange(n) + 0.5) / n - 0.5) * side for n, side in zip(given.cells, given.extent, strict=True)
    )
    i, j = (np.abs(line - at[:, None]).argmin(axis=1) for line, at in zip(lines, (x, y), strict=True))
    return given.values[i, j]


def traction_of(scene: Scene, result: Result) -> np.ndarray:
    """(nx, ny) mu p of SAM's cells in Pa, by the scene; zero where it does not act on the normal
    displacement. Of a chemical film with the high or the low coefficient, which of them is nearer
    to the returned traction.
    """
    x, y, p = surface_of(result)
    if scene.friction is None or not scene.friction.coupling:
        return np.zeros_like(p)
    if scene.friction.film:
        low, high = scene.friction.low * p, scene.friction.high * p
        return np.where(2 * returned_traction(result) > low + high, high, low)
    return coefficient_at(scene, *(c.ravel() for c in np.meshgrid(x, y, indexing="ij"))).reshape(p.shape) * p


def slips(scene: Scene, result: Result) -> float:
    """|q - mu p| of SAM's cells over the largest pressure."""
    return float(
        np.abs(returned_traction(result) - traction_of(scene, result)).max() / surface_of(result)[2].max()
    )


def returned_traction(result: Result) -> np.ndarray:
    """(nx, ny) of SAM's cells in Pa."""
    shape = surface_of(result)[2].shape
    return np.asarray(result.fields.cell_data["qx_Pa"])[: shape[0] * shape[1]].reshape(shape)


def yields(scene: Scene, result: Result, state: str = "peak") -> float:
    """Largest (q - sigma_y)/sigma_y in the plane y = 0, q of the stress less the back-stresses."""
    plane = peak_rows(result, "plane", state)
    mises, fields = plane["mises_Pa"], result.grids.get(state, {}).get("plane")
    if fields is not None and "back_stress_Pa" in fields.point_data:
        data = fields.point_data
        mises = von_mises(data["stress_Pa"] - data["back_stress_Pa"]).ravel()
    return float((mises / yield_stress(scene, plane["peeq"], plane["z_m"]) - 1.0).max())


def unloaded(scene: Scene, result: Result) -> dict[str, float]:
    """Without force: yield; on the axis szz extrapolated to the surface, over the largest pressure before;
    penetration and the distance of first touch, over the approach at the peak.
    """
    axis, gap = peak_rows(result, "axis", "unloaded"), peak_rows(result, "line", "unloaded")["gap_m"]
    z, szz = axis["z_m"], axis["szz_Pa"]
    at = szz[0] - (szz[1] - szz[0]) * z[0] / (z[1] - z[0])
    return {
        "yield": yields(scene, result, "unloaded"),
        "surface": abs(float(at)) / result.quantities["p_max_Pa"],
        "complementarity": abs(float(gap.min())) / result.quantities["approach_m"],
    }


def flow(scene: Scene, records: Sequence[Checkpoint], depths: np.ndarray) -> dict[str, float]:
    """The flow rule at the points of SAM's cells, over the steps of one box; depths: of layers in m."""
    worst: dict[str, float] = {}
    trees = [record.tree() for record in records]
    for before, now in pairwise(trees):
        old, new = (fields_at_points(each["state"]["material"]) for each in (before, now))
        stress = now["last"]["stress"]
        a, b = old["strain"], new["strain"]  # at the points of the cells
        if a.shape != b.shape or before["extent"] != now["extent"] or now["parts"]["count"] != 0:
            continue
        z = np.broadcast_to(depths[: a.shape[2], None, None], a.shape[1:])
        effective = at_points(scene, stress, b) - back_stress(scene, new.get("back"), z)
        found = flow_of(scene, b - a, old["peeq"], new["peeq"], stress=effective, z=z)
        worst = {name: max(worst.get(name, 0.0), value) for name, value in found.items()}
    return worst


def at_points(scene: Scene, stress: np.ndarray, strain: np.ndarray) -> np.ndarray:
    """Stress (6, 4, nz, nx, ny) in Pa at the 2 x 2 Gauss points in the plane of each cell, of that of the
    cells (6, nz, nx, ny) and the plastic strain at the points: s + 2 m E linear in the cell, less 2 m E of
    the point, m = mu/2.
    """
    twice = scene.body.young / (1 + scene.body.poisson) / 2
    smooth = stress + twice * strain.mean(axis=1)
    along, across = (np.gradient(smooth, axis=axis) / np.sqrt(12) for axis in (-2, -1))
    corners = [smooth + i * along + j * across for i in (-1, 1) for j in (-1, 1)]
    return np.stack(corners, axis=1) - twice * strain


def planes(r: np.ndarray, z: np.ndarray, szz: np.ndarray, force: float, *, spread: float) -> np.ndarray:
    """Force through the planes z = const over the load less 1, (nz,): szz (nr, nz) at radii r, ascending from
    near zero. Trapezoidal sums of 2 pi r szz; beyond the last radius R the stress of a point force (Johnson
    1985, Eq. 3.19), and of the mean square distance `spread` of the pressure from the axis the first term,
    spread/4 times the flux through r = R of the gradient of that stress.
    """
    inside = -2 * np.pi * np.trapezoid(szz * r[:, None], r, axis=0) - np.pi * r[0] ** 2 * szz[0]
    reach = np.hypot(r[-1], z)
    beyond = force * ((z / reach) ** 3 + 3.75 * spread * z**3 * r[-1] ** 2 / reach**7)
    return (inside + beyond) / force - 1.0


def sam_planes(scene: Scene, result: Result) -> np.ndarray:
    """`planes` of a contact round about the origin, from the half x >= 0 of y = 0."""
    x, z, stress = plane_of(result)
    right = x > -1e-9 * x[-1]
    along, across, p = surface_of(result)
    spread = float((p * (along[:, None] ** 2 + across**2)).sum() / p.sum())
    return planes(np.abs(x[right]), z, stress[2][right], force_of(scene, result), spread=spread)


def sam_surface(_scene: Scene, result: Result) -> float:
    """Tractions below the surface against those on it, over the largest pressure; from the first two depths,
    linearly. Away from the edge of contact, see EDGE. With friction the shear stress against q = mu p.
    """
    x, z, stress = plane_of(result)
    line = peak_rows(result, "line")
    a, top = result.quantities["contact_radius_m"], line["p_Pa"].max()
    at = stress[:, :, 0] - (stress[:, :, 1] - stress[:, :, 0]) * z[0] / (z[1] - z[0])
    normal, shear = np.abs(at[2] + line["p_Pa"]) / top, np.abs(at[4] + line["qx_Pa"]) / top
    return tractions(np.abs(x) / a, normal, shear)


def tractions(r: np.ndarray, normal: np.ndarray, shear: np.ndarray) -> float:
    """The largest of both, r in contact radii, away from the edge of contact, see EDGE."""
    away = np.abs(r - 1) > EDGE
    return float(max(normal[away].max(), shear[away].max()))
