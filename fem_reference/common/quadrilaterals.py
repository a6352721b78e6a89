# SPDX-License-Identifier: MIT
"""Bodies on plane tensor meshes of quadrilaterals: x, or r, along the surface, z into the body."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from skfem import Basis, ElementQuadS2, ElementVector, MeshQuad
from skfem.element import Element

from fem_reference.common.arrays import Array, Integers
from fem_reference.common.bodies import Coating, Elastic
from fem_reference.common.elasticity import Solid
from fem_reference.common.linear import nested_dissection
from fem_reference.common.plasticity import Material


def tensor_mesh(x: Array, z: Array, *, half: bool) -> MeshQuad:
    """Tensor mesh with the boundaries "surface" (z = 0), "far" and, of a half, "axis" (x = 0)."""

    def far(p: Array) -> Array:
        sides = (p[0] == x[-1]) | (p[1] == z[-1])
        return sides if half else sides | (p[0] == x[0])

    boundaries = {"surface": lambda p: p[1] == 0.0, "far": far}
    if half:
        boundaries["axis"] = lambda p: p[0] == 0.0
    return MeshQuad.init_tensor(x, z).with_boundaries(boundaries)


def elimination_order(solid: Solid, bodies: int = 1) -> Integers:
    """Degrees of freedom of so many bodies on the mesh of `solid`, as nested dissection eliminates them; a
    second body lies above the first.
    """
    lines = [np.unique(np.round(line, 12)) for line in solid.basis.mesh.p]
    places = zip(solid.basis.doflocs, lines, strict=True)
    numbers = np.array([np.interp(x, line, np.arange(line.size)) for x, line in places])
    i, j = np.rint(2.0 * numbers).astype(int)  # mid nodes are halfway
    columns, rows = (line.size - 1 for line in lines)
    deep = np.concatenate([j if body == 0 else -j for body in range(bodies)]) + 2 * rows * (bodies - 1)
    part = nested_dissection(columns, rows * bodies)
    return np.argsort(part[np.tile(i, bodies), deep], kind="stable")


class PlaneSolid(Solid):
    """A body in plane strain on a mesh of 8-node serendipity elements with 2 x 2 Gauss points.

    These do not lock when the flow keeps volume: an element brings six degrees of freedom and four points
    where the volume is kept (Nagtegaal, Parks and Rice, Comput. Methods Appl. Mech. Engrg. 4 (1974) 153),
    9-node elements with 3 x 3 points eight and nine. There stresses are superconvergent too. Components are
    (xx, yy, zz, xz), the strain yy is zero; fields at the points (4, n_elements, 4); forces are on a length
    of one along y.
    """

    def __init__(self, mesh: MeshQuad, elastic: Elastic):
        basis = Basis(mesh, ElementVector(ElementQuadS2()), intorder=3)
        super().__init__(basis, _strain_operator(basis, None), basis.dx, elastic)


class AxisymmetricSolid(Solid):
    """The same about the axis r = 0.

    Strains are e_rr = du_r/dr, e_tt = u_r/r, e_zz = du_z/dz, 2 e_rz = du_r/dz + du_z/dr; integrals are over
    the full ring, 2 pi r dr dz, so that nodal forces are forces. element: another one, of scikit-fem; a patch
    of serendipity elements has no zero-energy mode but the rigid one, 9-node elements (ElementQuad2) with
    these points have. coating: its lower face is a line of the mesh.
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


def _strain_operator(basis: Basis, r: Array | None) -> Array:
    """B of strain = B u_element: (n_elements, 4 points, 4 strains, n_local); r: None in plane strain."""
    rows = []
    for (shape,) in basis.basis:
        u, grad = np.asarray(shape), np.broadcast_to(shape.grad, (2, 2, *basis.dx.shape))
        hoop = np.zeros_like(basis.dx) if r is None else u[0] / r
        rows.append([grad[0, 0], hoop, grad[1, 1], grad[0, 1] + grad[1, 0]])
    return np.ascontiguousarray(np.moveaxis(np.array(rows), (2, 3, 1, 0), (0, 1, 2, 3)))


class MatchedBodies:
    """One body, or two whose surface nodes match, each in its own (x or r, z into the body).

    solids: on one mesh, the first may yield, with `material`; candidates: places in the surface of the nodes
    that may touch, by x; gap0: (n_candidates,) their initial gap.
    """

    def __init__(
        self, solids: Sequence[Solid], candidates: slice, gap0: Array, material: Material | None = None
    ):
        self.solids, self.gap0, self.material = tuple(solids), gap0, material
        self.count = solids[0].size
        self.size = self.count * len(solids)
        # u_z and u_x of the candidates, (n_bodies, n_candidates)
        first = np.arange(len(solids))[:, None] * self.count
        self.normal, self.along = (
            first + solids[0].boundary_dofs("surface", component)[candidates] for component in (1, 0)
        )

    def body(self, u: Array, index: int) -> Array:
        """Displacements of one body."""
        return u[index * self.count :][: self.count]

    def gap(self, u: Array, approach: float) -> Array:
        """gap0 + sum of u_z - delta at the candidates."""
        return self.gap0 + u[self.normal].sum(axis=0) - approach


def edge_weights(x: Array, width: Array | float = 1.0) -> Array:
    """Area of each node of a line of quadratic edges: the integral of its shape function times `width`, with
    the width of its own place: h/6, 2 h/3, h/6.

    x: (2 n + 1,), corner and mid nodes in turn; width: (2 n + 1,), linear along an edge, or one for all.
    """
    h, area, across = np.diff(x[::2]), np.zeros_like(x), np.broadcast_to(width, x.shape)
    area[:-2:2] += h * across[:-2:2] / 6.0
    area[2::2] += h * across[2::2] / 6.0
    area[1::2] = h * across[1::2] * 2.0 / 3.0
    return area


def surface_weights(r: Array) -> Array:
    """The same of rings, 2 pi r dr: the node on the axis has none."""
    return 2.0 * np.pi * edge_weights(r, r)
