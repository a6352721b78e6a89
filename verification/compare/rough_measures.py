# SPDX-License-Identifier: MIT
"""What SAM and the three-dimensional FEM have in common on a rough patch: the same cells, spots, what each of
them bears.

Both give the pressure for the same cells: SAM at their centres, FEM at the nodes there, each of which stands
for a cell.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import ndimage
from scipy.interpolate import RectBivariateSpline

from verification.runs.sampling import plane_field, rows_of

LEAST = 0.05  # of the force: a spot that bears less is not compared by itself
SHALLOWEST = 0.3  # radii of the spot: above it the plastic strain near the surface depends on the mesh
SPACING = 0.1  # of the depths compared, in the same
SHARE = 0.1  # of the largest strain of a profile: below it a relative difference says nothing


@dataclass(frozen=True)
class PatchPressure:
    """Surface of a result: x (nx,), y (ny,) in m, and p (nx, ny) in Pa at peak load."""

    x: np.ndarray
    y: np.ndarray
    p: np.ndarray

    @classmethod
    def of(cls, tables) -> PatchPressure:
        """From the tables of a result or of a run."""
        x, y, p = rows_of(tables["surface"], "peak", "x_m", "y_m", "p_Pa")
        xs, ys = np.unique(np.round(x, 15)), np.unique(np.round(y, 15))
        return cls(xs, ys, p.reshape(xs.size, ys.size))

    @property
    def cell(self) -> float:
        """Area of a cell in m^2."""
        return float((self.x[1] - self.x[0]) * (self.y[1] - self.y[0]))


@dataclass(frozen=True)
class Spot:
    """One contact spot. where: its cells (bool), of both models; sam, fem: loads in N.

    area: of its cells in FEM, in m^2; x, y: in m, centre of its pressure in FEM.
    """

    where: np.ndarray
    sam: float
    fem: float
    area: float
    x: float
    y: float

    @property
    def radius(self) -> float:
        """Of the circle with its area, in m."""
        return float(np.sqrt(self.area / np.pi))


def spots(sam: PatchPressure, fem: PatchPressure) -> list[Spot]:
    """The spots that bear more than LEAST of the force, by x: connected regions where either model
    has contact. Raises ValueError when the two are not on the same cells.
    """
    if sam.p.shape != fem.p.shape or not (np.allclose(sam.x, fem.x) and np.allclose(sam.y, fem.y)):
        raise ValueError(f"the patches differ: {sam.p.shape} and {fem.p.shape} cells")
    regions, count = ndimage.label((sam.p > 0) | (fem.p > 0))
    found = []
    for k in range(1, count + 1):
        where = regions == k
        loads = [float(patch.p[where].sum()) * patch.cell for patch in (sam, fem)]
        if loads[1] <= LEAST * fem.p.sum() * fem.cell:
            continue
        weight = np.where(where, fem.p, 0.0)
        x, y = ((weight.sum(axis=1 - axis) @ line) / weight.sum() for axis, line in enumerate((fem.x, fem.y)))
        area = float(np.count_nonzero(where & (fem.p > 0))) * fem.cell
        found.append(Spot(where, *loads, area, float(x), float(y)))
    return sorted(found, key=lambda spot: spot.x)


@dataclass(frozen=True)
class Depths:
    """The plastic strain in y = 0 at peak load: x (nx,), z (nz,) in m, peeq (nx, nz). jump: depth in m at
    which the strain jumps, as the hardening law does.
    """

    x: np.ndarray
    z: np.ndarray
    peeq: np.ndarray
    jump: float = 0.0

    @classmethod
    def of(cls, tables, jump: float = 0.0) -> Depths:
        """From the tables of a result or of a run."""
        x, z, peeq = plane_field(tables, "peeq")
        return cls(x, z, np.nan_to_num(peeq), jump)

    def below(self, x: float, z: np.ndarray) -> np.ndarray:
        """The strain at x, depths z, by a bicubic spline on either side of the jump; never below zero."""
        found = np.zeros(np.shape(z))
        for own, asked in ((self.z < self.jump, z < self.jump), (self.z >= self.jump, z >= self.jump)):
            if asked.any():
                degree = min(3, np.count_nonzero(own) - 1)
                spline = RectBivariateSpline(self.x, self.z[own], self.peeq[:, own], ky=degree, s=0)
                found[asked] = spline(np.array([x]), z[asked])[0]
        return np.maximum(found, 0.0)


def compared_depths(fem: Depths, x: float, radius: float) -> np.ndarray:
    """Depths from SHALLOWEST radii on, with SHARE of FEM's largest strain there, beside the jump."""
    z = np.arange(SHALLOWEST, fem.z[-1] / radius, SPACING) * radius
    above, under = fem.z[fem.z < fem.jump], fem.z[fem.z >= fem.jump]
    if above.size:
        z = z[(z <= above[-1]) | (z >= under[0])]
    peeq = fem.below(x, z)
    return z[peeq >= SHARE * peeq.max()] if peeq.any() else z[:0]


def residual_line(tables) -> tuple[np.ndarray, np.ndarray]:
    """x and displacement into the body in m along y = 0 after unloading."""
    x, displacement = rows_of(tables["line"], "unloaded", "x_m", "uz_m")
    return x, displacement


def relative_l2(value: np.ndarray, reference: np.ndarray) -> float:
    """|value - reference|/|reference|."""
    return float(np.linalg.norm(value - reference) / np.linalg.norm(reference))
