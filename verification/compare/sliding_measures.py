# SPDX-License-Identifier: MIT
"""What two three-dimensional results have in common: the plane y = 0, profiles over depth, contours, nodal
pressures.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.interpolate import RectBivariateSpline

from sam.scene import Result
from verification.runs.sampling import plane_field, surface_nodes, surface_pressure

SHALLOWEST = 0.3  # elastic contact radii: above it the plastic strain near the surface depends on the mesh
SPACING = 0.1  # of the depths compared, in the same
SHARE = 0.1  # of the largest strain of a profile: below it a relative difference says nothing
FINE = 0.005  # of the grid on which contours are measured, in elastic contact radii


@dataclass(frozen=True)
class Plane:
    """The plastic strain in y = 0. x (nx,), z (nz,) in contact radii of the elastic contact, ascending; peeq:
    (nx, nz).
    """

    x: np.ndarray
    z: np.ndarray
    peeq: np.ndarray

    @classmethod
    def of(cls, result: Result, a: float) -> Plane:
        """At peak load. a: contact radius of the elastic contact in m."""
        x, z, peeq = plane_field(result.tables, "peeq")
        return cls(x / a, z / a, peeq)

    def at(self, x: np.ndarray, z: np.ndarray) -> np.ndarray:
        """On the grid of x (m,) and z (n,), (m, n), by a bicubic spline; never below zero, NaN outside the
        own grid.
        """
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
    """Multiples of SPACING from SHALLOWEST on, as far as the profile at x is at least SHARE of its largest
    value there.
    """
    z = np.arange(SHALLOWEST, plane.z[-1], SPACING)
    peeq = plane.at(np.array([x]), z)[0]
    return z[peeq >= SHARE * np.nanmax(peeq)]


def profile_difference(sam: Plane, fem: Plane, x: float) -> float:
    """Largest |sam - fem|/fem of the plastic strain at x over `depths_compared` of fem; NaN if there are
    none.
    """
    z, at = depths_compared(fem, x), np.array([x])
    own, reference = sam.at(at, z)[0], fem.at(at, z)[0]
    return float(np.max(np.abs(own / reference - 1.0), initial=np.nan if z.size == 0 else 0.0))


@dataclass(frozen=True)
class Contour:
    """Extent of the part of y = 0 where the plastic strain is at least a level, in contact radii of the
    elastic contact.
    """

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
    """(n, m): means of piecewise constant values over linear shape functions, the integral of each divided by
    its own.

    nodes: (n,), faces: (m + 1,) of the cells, both ascending; shape functions of the outermost nodes are
    one-sided.
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
    """Pressures of SAM and FEM at the surface nodes y >= 0 of FEM, and the areas of the nodes, (nx, ny) each,
    in Pa and m^2.

    A nodal force of FEM is the integral of the pressure with the shape function of the node: that of SAM is
    integrated so.
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
    """Means of the pressure over hats of half width `width` (m), (nx, ny), of SAM or of FEM, from its nodal
    pressures.

    A contact that ends inside an element has its last force on one node or the other: over hats of a length
    that does not go with the elements both sides of the edge are taken together.
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
    """Relative L2 norm of the difference of the pressures over hats; those on y = 0 stand for half a hat
    each.
    """
    p, reference = (patch_pressures(each, fem, width) for each in (result, fem))
    weight = np.ones(p.shape)
    weight[:, 0] = 0.5
    return pressure_distance(p, reference, weight)
