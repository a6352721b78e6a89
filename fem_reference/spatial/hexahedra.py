# SPDX-License-Identifier: MIT
"""Bodies on graded blocks of 8-node hexahedra; lengths in contact radii."""

from __future__ import annotations

import numpy as np
from skfem import Basis, ElementHex1, ElementVector, MeshHex

from fem_reference.common.arrays import Array
from fem_reference.common.bodies import Coating, Elastic
from fem_reference.common.elasticity import Solid
from fem_reference.common.mesh_lines import Lines

SHEARS = ((1, 2), (0, 2), (0, 1))
"""Pairs of coordinates of the shear components yz, xz, xy."""


class HexSolid(Solid):
    """8-node hexahedra with 2 x 2 x 2 Gauss points and mean dilatation (B-bar), which do not lock when the
    flow keeps volume.

    Hughes, Int. J. Numer. Methods Engrg. 15 (1980) 1413: the volumetric part of B is its mean over the
    element. Components are (xx, yy, zz, yz, xz, xy). mean_dilatation False: the plain element, for
    comparison.
    """

    def __init__(
        self, mesh: MeshHex, elastic: Elastic, *, mean_dilatation: bool = True, coating: Coating | None = None
    ):
        basis = Basis(mesh, ElementVector(ElementHex1()), intorder=3)
        B = strain_operator(basis)
        if mean_dilatation:
            volumetric = B[:, :, :3].sum(axis=2)  # (n_elements, 8 points, 24)
            mean = np.einsum("eqi,eq->ei", volumetric, basis.dx) / basis.dx.sum(axis=1)[:, None]
            B[:, :, :3] += ((mean[:, None] - volumetric) / 3.0)[:, :, None]
        super().__init__(basis, B, basis.dx, elastic, coating=coating)


def strain_operator(basis: Basis) -> Array:
    """B of strain = B u_element: (n_elements, n_points, 6, n_local)."""
    columns = []
    for (shape,) in basis.basis:
        grad = np.broadcast_to(shape.grad, (3, 3, *basis.dx.shape))
        columns.append([*(grad[i, i] for i in range(3)), *(grad[i, j] + grad[j, i] for i, j in SHEARS)])
    return np.ascontiguousarray(np.moveaxis(np.array(columns), (2, 3, 1, 0), (0, 1, 2, 3)))


def block(lines: Lines) -> MeshHex:
    """Tensor mesh with the boundaries "surface" (z = 0), "symmetry" (y = 0 of a half) and "far"."""
    x, y, z = lines.x, lines.y, lines.z

    def far(p: Array) -> Array:
        sides = (p[0] == x[0]) | (p[0] == x[-1]) | (p[1] == y[-1]) | (p[2] == z[-1])
        return sides if lines.half else sides | (p[1] == y[0])

    boundaries = {"surface": lambda p: p[2] == 0.0, "far": far}
    if lines.half:
        boundaries["symmetry"] = lambda p: p[1] == 0.0
    return MeshHex.init_tensor(x, y, z).with_boundaries(boundaries)
