# SPDX-License-Identifier: MIT
"""What two three-dimensional results have in common: the plane y = 0, profiles over depth, contours, nodal
pressures.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.interpolate import RectBivariateSpline

from sam.scene import UNLOADED, Result
from verification.runs.sampling import peak, plane_field, rows_of, surface_nodes, surface_pressure

SHALLOWEST = 0.3  # elastic contact radii: above it the plastic strain near the surface depends on the mesh
SPACING = 0.1  # of the depths compared, in the same
SHARE = 0.1  # of the largest strain of a profile: below it a relative difference says nothing
FINE = 0.005  # of the grid on which contours are measured, in elastic contact radii


@dataclass(frozen=True)
class Plane:
    """The plastic strain (nx, nz) in y = 0; x (nx,), z (nz,) in elastic contact radii, ascending."""

    x: np.ndarray
    z: np.ndarray
    peeq: np.ndarray

    @classmethod
    def of(cls, result: Result, a: float) -> Plane:
        """At peak load. a: contact radius of the elastic contact in m."""
        x, z, peeq = plane_field(result.tables, "peeq")
        return cls(x / a, z / a, peeq)

    def at(self, x: np.ndarray, z: np.ndarray) -> np.ndarray:
        """At x (m,) and z (n,), (m, n), by a bicubic spline; never below zero, NaN outside."""
        values = RectBivariateSpline(self.x, self.z, self.peeq, s=0)(x, z)
        inside = ((x >= self.x[0]) & (x <= self.x[-1]))[:, None] & ((z >= self.z[0]) & (z <= self.z[-1]))
        return np.where(inside, np.maximum(values, 0.0), np.nan)

    def place_of_maximum(self) -> float:
        """x of the largest strain at z >= SHALLOWEST."""
        x, z = (
            FINE * np.arange(-round(1.0 / FINE), round(1.0 / FINE) + 1),
            np.arange(SHALLOWEST, min(1.5, self.z[-1]), FINE),
        )
        values = self.at(x, z)
        return float(x[np.unravel_index(np.nanargmax(values), values.shape)[0]])


def depths_compared(plane: Plane, x: float) -> np.ndarray:
    """Multiples of SPACING from SHALLOWEST on with at least SHARE of the largest value there at x."""
    z = np.arange(SHALLOWEST, plane.z[-1], SPACING)
    peeq = plane.at(np.array([x]), z)[0]
    return z[peeq >= SHARE * np.nanmax(peeq)]


def profile_difference(sam: Plane, fem: Plane, x: float) -> float:
    """Largest |sam - fem|/fem of the plastic strain at x over `depths_compared`, NaN without any."""
    z, at = depths_compared(fem, x), np.array([x])
    own, reference = sam.at(at, z)[0], fem.at(at, z)[0]
    return float(np.max(np.abs(own / reference - 1.0), initial=np.nan if z.size == 0 else 0.0))


@dataclass(frozen=True)
class Contour:
    """Where in y = 0 the plastic strain is at least a level, in elastic contact radii."""

    depth: float
    left: float
    right: float

    @property
    def length(self) -> float:
        return self.right - self.left


def contour(plane: Plane, level: float, top: float) -> Contour | None:
    """Of the part below the depth `top`; None where the level is not reached."""
    x = np.arange(plane.x[0], plane.x[-1] + FINE / 2, FINE)
    z = np.arange(top, plane.z[-1] + FINE / 2, FINE)
    reached = plane.at(x, z) >= level
    if not reached.any():
        return None
    columns, rows = np.flatnonzero(reached.any(axis=1)), np.flatnonzero(reached.any(axis=0))
    return Contour(float(z[rows[-1]]), float(x[columns[0]]), float(x[columns[-1]]))


def contours(planes: Sequence[Plane], level: float) -> list[Contour | None]:
    """Of several results, below the shallowest depth that all of them have."""
    top = max(plane.z[0] for plane in planes)
    return [contour(plane, level, top) for plane in planes]


def hat_means(nodes: np.ndarray, faces: np.ndarray) -> np.ndarray:
    """(n, m): means of piecewise constant values over linear shape functions, the integral of each
    divided by its own. nodes: (n,), faces: (m + 1,) of the cells, both ascending; shape functions
    of the outermost nodes are one-sided.
    """
    before, after = np.diff(nodes, prepend=nodes[0]), np.diff(nodes, append=nodes[-1])

    def integral(t: np.ndarray) -> np.ndarray:
        """Of every shape function up to t, (n, m + 1)."""
        rise = np.clip(t - (nodes - before)[:, None], 0.0, before[:, None])
        fall = np.clip((nodes + after)[:, None] - t, 0.0, after[:, None])
        safe_before, safe_after = (np.where(d > 0.0, d, 1.0)[:, None] for d in (before, after))
        return 0.5 * (rise**2 / safe_before + after[:, None] - fall**2 / safe_after)

    return np.diff(integral(faces), axis=1) / (0.5 * (before + after))[:, None]


def nodal_pressures(sam: Result, fem: Result) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Pressures of SAM and FEM at the surface nodes y >= 0 of FEM, and the areas of the nodes, (nx,
    ny) each, in Pa and m^2. A nodal force of FEM is the integral of the pressure with the shape
    function of the node: that of SAM is integrated so.
    """
    x, y, p_fem = surface_nodes(fem)
    u, v, p = surface_pressure(sam.fields.points, sam.fields.cells["quad"], sam.fields.cell_data["p_Pa"])
    faces_x, faces_y = (faces_of(centres) for centres in (u, v))
    whole = np.concatenate([-y[:0:-1], y])
    p_sam = (hat_means(x, faces_x) @ p @ hat_means(whole, faces_y).T)[:, y.size - 1 :]
    return p_sam, p_fem, np.outer(spans(x), spans(y))


def faces_of(centres: np.ndarray) -> np.ndarray:
    """(m + 1,) of cells of one size."""
    h = (centres[-1] - centres[0]) / (centres.size - 1)
    return np.append(centres - h / 2, centres[-1] + h / 2)


def pressure_distance(p: np.ndarray, reference: np.ndarray, area: np.ndarray) -> float:
    """sqrt(sum w (p - reference)^2 / sum w reference^2)."""
    return float(np.sqrt(np.sum(area * (p - reference) ** 2) / np.sum(area * reference**2)))


def patch_pressures(result: Result, fem: Result, width: float) -> np.ndarray:
    """Means of the pressure over hats of half width `width` (m), (nx, ny), of SAM or of FEM, from
    its nodal pressures. A contact that ends inside an element has its last force on one node or the
    other: over hats of a length that does not go with the elements both sides of the edge are taken
    together.
    """
    x, y, p_fem = surface_nodes(fem)
    p = p_fem if result is fem else nodal_pressures(result, fem)[0]
    count = int(min(abs(x[0]), x[-1]) / width)
    centres = np.arange(-count, count + 1) * width
    aside = centres[centres >= 0.0]
    across = hats_at(y, aside, width) + hats_at(
        -y, aside, width
    )  # the nodes on y = 0 have half of their area here
    return (hats_at(x, centres, width) * spans(x)) @ p @ (across * spans(y)).T / width**2


def hats_at(points: np.ndarray, centres: np.ndarray, width: float) -> np.ndarray:
    """(n_centres, n_points) values of the hats."""
    return np.maximum(1.0 - np.abs(points - centres[:, None]) / width, 0.0)


def spans(line: np.ndarray) -> np.ndarray:
    """(n,) integrals of the linear shape functions of a line of nodes."""
    return 0.5 * (np.diff(line, prepend=line[0]) + np.diff(line, append=line[-1]))


def patch_distance(result: Result, fem: Result, width: float) -> float:
    """Relative L2 difference of the pressures over hats; those on y = 0 count half."""
    p, reference = (patch_pressures(each, fem, width) for each in (result, fem))
    weight = np.ones(p.shape)
    weight[:, 0] = 0.5
    return pressure_distance(p, reference, weight)


INTERIOR, WIDE = (0.25, 1.5), 1.2  # depths, and |x| and |y|, at which stresses are compared, in contact radii
COMPONENTS = ("sxx", "syy", "szz", "syz", "sxz", "sxy")


def stresses_inside(result: Result, a: float) -> tuple[tuple[np.ndarray, ...], np.ndarray]:
    """Places (x, y, z) in m, stresses (n, 6) in Pa: of SAM on the axis, of FEM in its elements."""
    if "hexahedron" in result.fields.cells:
        x, y, z = result.fields.points[result.fields.cells["hexahedron"]].mean(axis=1).T
        stress = np.asarray(result.fields.cell_data["stress_Pa"])
    else:
        z, *columns = peak(result.tables["axis"], "z_m", *(f"{name}_Pa" for name in COMPONENTS))
        x, y, stress = np.zeros(z.size), np.zeros(z.size), np.stack(columns, axis=1)
    use = _inside(x, z, a) & (np.abs(y) <= WIDE * a)
    return (x[use], y[use], z[use]), stress[use]


def mises_inside(result: Result, a: float) -> tuple[tuple[np.ndarray, ...], np.ndarray]:
    """Places and von Mises stresses (n,) in Pa of SAM in the plane y = 0."""
    x, z, mises = peak(result.tables["plane"], "x_m", "z_m", "mises_Pa")
    use = _inside(x, z, a)
    return (x[use], np.zeros(use.sum()), z[use]), mises[use]


def _inside(x: np.ndarray, z: np.ndarray, a: float) -> np.ndarray:
    return (z >= INTERIOR[0] * a) & (z <= INTERIOR[1] * a) & (np.abs(x) <= WIDE * a)


def limit_of_strain(
    results: Mapping[str, Result], model: str, *, a: float, x: float, z: np.ndarray
) -> np.ndarray:
    """The strain at (x, z) in contact radii, (n,), without cells and load steps: of second order in
    the one and of first in the other, whose share is much the same on any cells. results:
    "limit-MODEL-COUNT-STEPS" -> of so many cells or elements in the radius; two counts in one step,
    and one of them in three numbers of steps.
    """
    at = {
        tuple(map(int, name.split("-")[2:])): Plane.of(each, a).at(np.array([x]), z)[0]
        for name, each in results.items()
        if name.startswith(f"limit-{model}-")
    }
    cells = min(count for count, steps in at if steps > 1)
    one, some, more = sorted(steps for count, steps in at if count == cells)
    few, many = sorted(count for count, steps in at if steps == 1)[-2:]
    in_cells = (many**2 * at[many, 1] - few**2 * at[few, 1]) / (many**2 - few**2)
    fine, coarse = at[cells, more], at[cells, some]
    return in_cells * (fine + (fine - coarse) * some / (more - some)) / at[cells, one]


def growth(before: Result, after: Result) -> float:
    """Plastic strain that a cycle adds: largest anywhere in y = 0, where a load travels."""
    cycles = [len(each.tables["cycles"]["peeq_max"]) for each in (before, after)]
    one, other = (rows_of(each.tables["plane"], UNLOADED, "peeq")[0] for each in (before, after))
    return float((other - one).max()) / (cycles[1] - cycles[0])
