# SPDX-License-Identifier: MIT
"""Axisymmetric bodies on tensor meshes of quadrilaterals of the half plane r >= 0, z >= 0."""

from __future__ import annotations

import numpy as np
from skfem import Basis, ElementQuadS2, ElementVector, MeshQuad
from skfem.element import Element

from fem_reference.common.arrays import Array
from fem_reference.common.bodies import Coating, Elastic
from fem_reference.common.elasticity import Solid


def half_plane(r: Array, z: Array) -> MeshQuad:
    """Tensor mesh with the boundaries "axis" (r = 0), "surface" (z = 0) and "far" (largest r or z)."""
    return MeshQuad.init_tensor(r, z).with_boundaries(
        {
            "axis": lambda x: x[0] == 0.0,
            "surface": lambda x: x[1] == 0.0,
            "far": lambda x: (x[0] == r[-1]) | (x[1] == z[-1]),
        }
    )


class AxisymmetricSolid(Solid):
    """A body on a mesh of 8-node serendipity elements with 2 x 2 Gauss points.

    There stresses are superconvergent. Strains are e_rr = du_r/dr, e_tt = u_r/r, e_zz = du_z/dz, 2 e_rz =
    du_r/dz + du_z/dr; integrals are over the full ring, 2 pi r dr dz, so that nodal forces are forces.
    Displacements are (n_dofs,), fields at the Gauss points (4, n_elements, 4).

    Parameters
    ----------
    mesh : skfem.MeshQuad
        Quadrilaterals of the half plane r >= 0, see `half_plane`.
    elastic : Elastic
        Constants of the body.
    element : skfem.Element, optional
        Another element. A patch of serendipity elements has no zero-energy mode but the rigid one; 9-node
        elements (ElementQuad2) with these points have.
    coating : Coating, optional
        Layer z < thickness of other constants; its lower face is a line of the mesh.
    """

    def __init__(
        self,
        mesh: MeshQuad,
        elastic: Elastic,
        *,
        element: Element | None = None,
        coating: Coating | None = None,
    ):
        basis = Basis(mesh, ElementVector(element or ElementQuadS2()), intorder=3)
        r = np.asarray(basis.global_coordinates())[0]
        weights = 2.0 * np.pi * r * basis.dx
        super().__init__(basis, _strain_operator(basis, r), weights, elastic, coating=coating)


def _strain_operator(basis: Basis, r: Array) -> Array:
    """B of strain = B u_element: (n_elements, 4 points, 4 strains, n_local)."""
    rows = []
    for (shape,) in basis.basis:
        u, grad = np.asarray(shape), shape.grad
        rows.append([grad[0, 0], u[0] / r, grad[1, 1], grad[0, 1] + grad[1, 0]])
    return np.ascontiguousarray(np.moveaxis(np.array(rows), (2, 3, 1, 0), (0, 1, 2, 3)))


def surface_weights(r: Array) -> Array:
    """Area of each node of a line of quadratic edges from the axis: integral of its shape function, 2 pi r
    dr.

    r: (2 n + 1,), corner and mid nodes in turn. An edge from r0 to r1 gives h r0/6, h (r0 + r1)/3 and h
    r1/6, times 2 pi; hence the node on the axis has none.
    """
    h = np.diff(r[::2])
    area = np.zeros_like(r)
    area[:-2:2] += h * r[:-2:2] / 6.0
    area[2::2] += h * r[2::2] / 6.0
    area[1::2] = h * r[1::2] * 2.0 / 3.0
    return 2.0 * np.pi * area
