# SPDX-License-Identifier: MIT
"""Plane-strain bodies on tensor meshes of quadrilaterals: x along the surface, z into the body."""

from __future__ import annotations

import numpy as np
from skfem import Basis, ElementQuadS2, ElementVector, MeshQuad

from fem_reference.common.arrays import Array
from fem_reference.common.bodies import Elastic
from fem_reference.common.elasticity import Solid


def section(x: Array, z: Array, *, half: bool) -> MeshQuad:
    """Tensor mesh with the boundaries "surface" (z = 0), "far" and, of a half, "axis" (x = 0)."""

    def far(p: Array) -> Array:
        sides = (p[0] == x[-1]) | (p[1] == z[-1])
        return sides if half else sides | (p[0] == x[0])

    boundaries = {"surface": lambda p: p[1] == 0.0, "far": far}
    if half:
        boundaries["axis"] = lambda p: p[0] == 0.0
    return MeshQuad.init_tensor(x, z).with_boundaries(boundaries)


class PlaneSolid(Solid):
    """A body on a mesh of 8-node serendipity elements with 2 x 2 Gauss points.

    These do not lock when the flow keeps volume: an element brings six degrees of freedom and four points
    where the volume is kept (Nagtegaal, Parks and Rice, Comput. Methods Appl. Mech. Engrg. 4 (1974) 153),
    9-node elements with 3 x 3 points eight and nine. There stresses are superconvergent too. Components are
    (xx, yy, zz, xz), the strain yy is zero; fields at the points (4, n_elements, 4); forces are on a length
    of one along y.
    """

    def __init__(self, mesh: MeshQuad, elastic: Elastic):
        basis = Basis(mesh, ElementVector(ElementQuadS2()), intorder=3)
        rows = []
        for (shape,) in basis.basis:
            grad = np.broadcast_to(shape.grad, (2, 2, *basis.dx.shape))
            rows.append([grad[0, 0], np.zeros_like(basis.dx), grad[1, 1], grad[0, 1] + grad[1, 0]])
        B = np.ascontiguousarray(np.moveaxis(np.array(rows), (2, 3, 1, 0), (0, 1, 2, 3)))
        super().__init__(basis, B, basis.dx, elastic)


def edge_weights(x: Array) -> Array:
    """Width of each node of a line of quadratic edges, the integral of its shape function: h/6, 2 h/3, h/6.

    x: (2 n + 1,), corner and mid nodes in turn.
    """
    h, width = np.diff(x[::2]), np.zeros_like(x)
    width[:-2:2] += h / 6.0
    width[2::2] += h / 6.0
    width[1::2] = 2.0 * h / 3.0
    return width
