# SPDX-License-Identifier: MIT
"""What two results of one contact have in common: the strain in the plane y = 0, its profiles over depth and
contours, nodal pressures, stresses inside, the spots of a rough patch and what each of them bears.

On a rough patch both models give the pressure for the same cells: SAM at their centres, FEM at the nodes
there, each of which stands for a cell.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from scipy import ndimage
from scipy.interpolate import RectBivariateSpline

from sam.scene import UNLOADED, Result
from verification.judging import relative_l2
from verification.runs import sampling

# in elastic contact radii, or in radii of a spot
SHALLOWEST = 0.3  # above it the plastic strain near the surface depends on the mesh
SPACING = 0.1  # of the depths compared
SHARE = 0.1  # of the largest strain of a profile: below it a relative difference says nothing
FINE = 0.005  # of the grid on which contours are measured
LEAST = 0.05  # of the force: a spot that bears less is not compared by itself


@dataclass(frozen=True)
class Plane:
    """Plastic strain (nx, nz) in y = 0 at the peak; x, z ascending, in one unit; jump: depth of the law's."""

    x: np.ndarray
    z: np.ndarray
    peeq: np.ndarray
    jump: float = 0.0

    @classmethod
    def of(cls, tables: sampling.Tables, unit: float = 1.0, jump: float = 0.0) -> Plane:
        """From the tables of a result or of a run; unit: of length in m."""
        x, z, peeq = sampling.plane_field(tables, "peeq")
        return cls(x / unit, z / unit, peeq, jump)

    def at(self, x: np.ndarray, z: np.ndarray) -> np.ndarray:
        """At x (m,) and z (n,), (m, n), bicubic on either side of the jump; never below zero, NaN outside."""
        values = np.empty((x.size, z.size))
        for own, asked in ((self.z < self.jump, z < self.jump), (self.z >= self.jump, z >= self.jump)):
            if asked.any():
                degree = min(3, np.count_nonzero(own) - 1)
                spline = RectBivariateSpline(self.x, self.z[own], self.peeq[:, own], ky=degree, s=0)
                values[:, asked] = spline(x, z[asked])
        inside = ((x >= self.x[0]) & (x <= self.x[-1]))[:, None] & ((z >= self.z[0]) & (z <= self.z[-1]))
        return np.where(inside, np.maximum(values, 0.0), np.nan)

    def below(self, x: float, z: np.ndarray) -> np.ndarray:
        """At one x and depths z, (n,)."""
        return self.at(np.array([x]), z)[0]

    def place_of_maximum(self) -> float:
        """x of the largest strain at z >= SHALLOWEST."""
        x = FINE * np.arange(-round(1.0 / FINE), round(1.0 / FINE) + 1)
        values = self.at(x, np.arange(SHALLOWEST, min(1.5, self.z[-1]), FINE))
        return float(x[np.unravel_index(np.nanargmax(values), values.shape)[0]])


def depths_compared(plane: Plane, x: float, radius: float = 1.0) -> np.ndarray:
    """Depths from SHALLOWEST radii with SHARE of the largest strain at x or more; none next to the jump."""
    z = np.arange(SHALLOWEST, plane.z[-1] / radius, SPACING) * radius
    above, under = plane.z[plane.z < plane.jump], plane.z[plane.z >= plane.jump]
    if above.size:
        z = z[(z <= above[-1]) | (z >= under[0])]
    peeq = plane.below(x, z)
    return z[peeq >= SHARE * np.nanmax(peeq, initial=0.0)]


def profile_difference(sam: Plane, fem: Plane, x: float) -> float:
    """Largest |sam - fem|/fem of the plastic strain at x over `depths_compared`, NaN without any."""
    z = depths_compared(fem, x)
    away = np.abs(sam.below(x, z) / fem.below(x, z) - 1.0)
    return float(np.max(away, initial=np.nan if z.size == 0 else 0.0))


class Contour(NamedTuple):
    """The part of y = 0 with at least a level of plastic strain: its depth and its length along x."""

    depth: float
    length: float


def contour(plane: Plane, level: float, top: float) -> Contour | None:
    """Of the part below the depth `top`; None where the level is not reached."""
    x = np.arange(plane.x[0], plane.x[-1] + FINE / 2, FINE)
    z = np.arange(top, plane.z[-1] + FINE / 2, FINE)
    reached = plane.at(x, z) >= level
    if not reached.any():
        return None
    columns, rows = x[reached.any(axis=1)], z[reached.any(axis=0)]
    return Contour(float(rows[-1]), float(columns[-1] - columns[0]))


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
    x, y, p_fem = sampling.surface_nodes(fem)
    u, v, p = sampling.pressure_map(sam)
    faces_x, faces_y = (np.append(c - (h := np.ptp(c) / (c.size - 1)) / 2, c[-1] + h / 2) for c in (u, v))
    whole = np.concatenate([-y[:0:-1], y])
    p_sam = (hat_means(x, faces_x) @ p @ hat_means(whole, faces_y).T)[:, y.size - 1 :]
    return p_sam, p_fem, np.outer(spans(x), spans(y))


def patch_pressures(result: Result, fem: Result, width: float) -> np.ndarray:
    """Means of the pressure over hats of half width `width` (m), (nx, ny), of SAM or of FEM, from
    its nodal pressures. A contact that ends inside an element has its last force on one node or the
    other: over hats of a length that does not go with the elements both sides of the edge are taken
    together.
    """
    x, y, p_fem = sampling.surface_nodes(fem)
    p = p_fem if result is fem else nodal_pressures(result, fem)[0]
    count = int(min(abs(x[0]), x[-1]) / width)
    centres = np.arange(-count, count + 1) * width
    aside = centres[centres >= 0.0]
    across = hats_at(y, aside, width) + hats_at(-y, aside, width)  # nodes on y = 0 have half of their area
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
    return relative_l2(p, reference, weight)


INTERIOR, WIDE = (0.25, 1.5), 1.2  # depths, and |x| and |y|, at which stresses are compared, in contact radii
COMPONENTS = ("sxx", "syy", "szz", "syz", "sxz", "sxy")


def stresses_inside(result: Result, a: float) -> tuple[tuple[np.ndarray, ...], np.ndarray]:
    """Places (x, y, z) in m, stresses (n, 6) in Pa: of SAM on the axis, of FEM in its elements."""
    if "hexahedron" in result.fields.cells:
        x, y, z = result.fields.points[result.fields.cells["hexahedron"]].mean(axis=1).T
        stress = np.asarray(result.fields.cell_data["stress_Pa"])
    else:
        z, *columns = sampling.peak(result.tables["axis"], "z_m", *(f"{name}_Pa" for name in COMPONENTS))
        x, y, stress = np.zeros(z.size), np.zeros(z.size), np.stack(columns, axis=1)
    use = _inside(x, z, a) & (np.abs(y) <= WIDE * a)
    return (x[use], y[use], z[use]), stress[use]


def mises_inside(result: Result, a: float) -> tuple[tuple[np.ndarray, ...], np.ndarray]:
    """Places and von Mises stresses (n,) in Pa of SAM in the plane y = 0."""
    x, z, mises = sampling.peak(result.tables["plane"], "x_m", "z_m", "mises_Pa")
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
        tuple(map(int, name.split("-")[2:])): Plane.of(each.tables, a).below(x, z)
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
    one, other = (sampling.rows_of(each.tables["plane"], UNLOADED, "peeq")[0] for each in (before, after))
    return float((other - one).max()) / (cycles[1] - cycles[0])


def patch_pressure(tables: sampling.Tables) -> tuple[np.ndarray, ...]:
    """Of a rough patch at peak load: x (nx,), y (ny,) in m, p (nx, ny) in Pa."""
    x, y, p = sampling.peak(tables["surface"], "x_m", "y_m", "p_Pa")
    return sampling.gridded(np.round(x, 15), np.round(y, 15), p)


class Spot(NamedTuple):
    """A contact spot. sam, fem: loads in N; x, y: centre of its pressure; radius: of its area of FEM, m."""

    sam: float
    fem: float
    x: float
    y: float
    radius: float


def spots(sam: sampling.Tables, fem: sampling.Tables) -> list[Spot]:
    """Regions of contact in either model that bear over LEAST of F, by x. ValueError: unlike cells."""
    (u, v, own), (x, y, p) = patch_pressure(sam), patch_pressure(fem)
    if own.shape != p.shape or not (np.allclose(u, x) and np.allclose(v, y)):
        raise ValueError(f"the patches differ: {own.shape} and {p.shape} cells")
    cell = float((x[1] - x[0]) * (y[1] - y[0]))
    regions, count = ndimage.label((own > 0) | (p > 0))
    found = []
    for where in (regions == k for k in range(1, count + 1)):
        if p[where].sum() > LEAST * p.sum():
            weight = np.where(where, p, 0.0)
            centre = ((weight.sum(axis=1 - axis) @ at) / weight.sum() for axis, at in enumerate((x, y)))
            radius = np.sqrt(np.count_nonzero(weight > 0) * cell / np.pi)
            loads = (each[where].sum() * cell for each in (own, p))
            found.append(Spot(*map(float, (*loads, *centre, radius))))
    return sorted(found, key=lambda spot: spot.x)
