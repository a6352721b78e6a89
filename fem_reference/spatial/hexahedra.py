# SPDX-License-Identifier: MIT
"""Bodies on graded blocks of 8-node hexahedra; lengths in contact radii."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from skfem import Basis, ElementHex1, ElementVector, MeshHex

from fem_reference.axisymmetric.mesh import grow
from fem_reference.common.elasticity import Film, Solid

GROWTH = 1.7
"""Ratio of neighbouring elements outside the uniform part; 1.4 changes scalar results by up to 5e-3."""
SHEARS = ((1, 2), (0, 2), (0, 1))
"""Pairs of coordinates of the shear components yz, xz, xy."""


class HexSolid(Solid):
    """8-node hexahedra with 2 x 2 x 2 Gauss points and mean dilatation (B-bar), which do not lock when the flow keeps volume.

    Hughes, Int. J. Numer. Methods Engrg. 15 (1980) 1413: the volumetric part of B is its mean over the element. Components
    are (xx, yy, zz, yz, xz, xy). young: any unit of stress; mean_dilatation False: the plain element, for comparison.
    """

    def __init__(
        self,
        mesh: MeshHex,
        young: float,
        poisson: float,
        mean_dilatation: bool = True,
        film: Film | None = None,
    ):
        basis = Basis(mesh, ElementVector(ElementHex1()), intorder=3)
        B = strain_operator(basis)
        if mean_dilatation:
            volumetric = B[:, :, :3].sum(axis=2)  # (n_elements, 8 points, 24)
            mean = np.einsum("eqi,eq->ei", volumetric, basis.dx) / basis.dx.sum(axis=1)[:, None]
            B[:, :, :3] += ((mean[:, None] - volumetric) / 3.0)[:, :, None]
        super().__init__(basis, B, basis.dx, young, poisson, film)


def strain_operator(basis: Basis) -> np.ndarray:
    """B of strain = B u_element: (n_elements, n_points, 6, n_local)."""
    columns = []
    for (shape,) in basis.basis:
        grad = np.broadcast_to(shape.grad, (3, 3, *basis.dx.shape))
        columns.append([*(grad[i, i] for i in range(3)), *(grad[i, j] + grad[j, i] for i, j in SHEARS)])
    return np.ascontiguousarray(np.moveaxis(np.array(columns), (2, 3, 1, 0), (0, 1, 2, 3)))


@dataclass(frozen=True)
class Lines:
    """Coordinates of the planes of a block, ascending; z from 0. half: it ends at the symmetry plane y = 0."""

    x: np.ndarray
    y: np.ndarray
    z: np.ndarray
    half: bool

    @property
    def shape(self) -> tuple[int, int, int]:
        """Numbers of elements."""
        return self.x.size - 1, self.y.size - 1, self.z.size - 1

    @property
    def share(self) -> float:
        """Modelled part of every force."""
        return 0.5 if self.half else 1.0

    @cached_property
    def areas(self) -> np.ndarray:
        """(nx + 1, ny + 1) integrals of the surface shape functions."""
        x, y = (
            0.5 * (np.diff(line, prepend=line[0]) + np.diff(line, append=line[-1]))
            for line in (self.x, self.y)
        )
        return np.outer(x, y)


def two_sided(low: float, high: float, size: float, box: float, growth: float = GROWTH) -> np.ndarray:
    """Lines uniform from about low <= 0 to about high >= 0, one of them at 0, then growing over `box` beyond both sides."""
    below, above = (int(np.ceil(round(reach / size, 9))) for reach in (-low, high))
    core = size * np.arange(-below, above + 1)
    outside = grow(0.0, box, size, growth)
    return np.concatenate([core[0] - outside[::-1], core, core[-1] + outside])


def block(lines: Lines) -> MeshHex:
    """Tensor mesh with the boundaries "surface" (z = 0), "symmetry" (y = 0 of a half) and "far" (the other faces)."""
    x, y, z = lines.x, lines.y, lines.z

    def far(p: np.ndarray) -> np.ndarray:
        sides = (p[0] == x[0]) | (p[0] == x[-1]) | (p[1] == y[-1]) | (p[2] == z[-1])
        return sides if lines.half else sides | (p[1] == y[0])

    boundaries = {"surface": lambda p: p[2] == 0.0, "far": far}
    if lines.half:
        boundaries["symmetry"] = lambda p: p[1] == 0.0
    return MeshHex.init_tensor(x, y, z).with_boundaries(boundaries)


def on_grid(points: np.ndarray, shape: tuple[int, ...]) -> np.ndarray:
    """Numbers of the points (3, n) of a tensor grid, as an array of the shape of the grid."""
    x, y, z = np.round(points, 12)
    return np.lexsort((z, y, x)).reshape(shape)
