# SPDX-License-Identifier: MIT
"""Frictionless contact of deformed surface nodes with a rigid sphere, in the loop of
`fem_reference.common.contact`.

With the node at the radius x = r + strain u_r now, in the units of the contact (slope = length/R = strain):

    gap = h(x) + u_z - delta,   h(x) = (1 - sqrt(1 - slope^2 x^2))/slope^2

The force of a node in contact has the direction of the sphere's normal there, (slope h'(x), 1); its
vertical part is the multiplier. Eliminated are the u_z, whose derivative by u_r is that of the sphere.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp

from fem_reference.axisymmetric.problem import Bordered, ContactProblem
from fem_reference.common.arrays import Array, Bools
from fem_reference.common.contact import NotDefiniteError, Response
from fem_reference.common.linear import Kept
from fem_reference.common.plasticity import History
from fem_reference.common.schedule import Load
from fem_reference.finite_strain.kinematics import GradientOperator, deformation
from fem_reference.finite_strain.material import Hencky


@dataclass(frozen=True)
class Placed(Response):
    """A response, and the displacements at which it is."""

    u: Array


class SphereContact(ContactProblem):
    """One body against a rigid sphere of true geometry. slope: unit of length over its radius, and
    of strain; hencky: material at finite strain, None for that of small strain.
    """

    def __init__(self, flat: ContactProblem, slope: float, hencky: Hencky | None):
        """flat: the same bodies under a gap that does not follow the deformation."""
        material = flat.material if hencky is None else hencky.small
        super().__init__(flat.solids, flat.gap0, material)
        self.slope, self.hencky = slope, hencky
        solid = self.solids[0]
        self.radial = solid.boundary_dofs("surface", 0)[: self.gap0.size]
        self.radii = solid.basis.doflocs[0, self.radial]
        self.operator = GradientOperator(solid.basis, solid.weights)

    def place(self, u: Array) -> Array:
        """Radius (n_candidates,) of the deformed surface nodes."""
        return self.radii + self.slope * u[self.radial]

    def gap(self, u: Array, approach: float) -> Array:
        """Vertical gap of the candidates, infinite beside the sphere."""
        x = self.place(u)
        square = 1.0 - (self.slope * x) ** 2
        height = np.where(square > 0.0, x**2 / (1.0 + np.sqrt(np.clip(square, 0.0, None))), np.inf)
        return height + u[self.normal[0]] - approach

    def respond(self, u: Array, start: History | None) -> Placed:
        """Return the response as ContactProblem does, at finite strain if there is a material for it."""
        if self.hencky is None or start is None:
            small = super().respond(u, start)
            return Placed(small.force, small.tangent, small.history, u)
        update = self.hencky.update(self.operator.gradient(u), start)
        force, tangent = self.operator.nodal_forces(update.stress), self.operator.stiffness(update.tangent)
        return Placed(force, tangent, update.history, u)

    def elimination_at(self, u: Array, active: Bools) -> tuple[sp.csr_matrix, Array]:
        """(T, d1) as ContactProblem.elimination, along the sphere at the active nodes."""
        T, d1 = self.elimination(active)
        x = self.slope * self.place(u)[active]
        tilt = x / np.sqrt(1.0 - x**2)
        rows, columns = self.normal[0, active], self.radial[active]
        return T - sp.csr_matrix((tilt, (rows, columns)), shape=(self.size,) * 2) @ T, d1

    def newton_step(
        self, u: Array, response: Response, active: Bools, *, load: Load, kept: Kept
    ) -> tuple[Array, float]:
        """Balance the linearised forces as ContactProblem does; then move the nodes in contact along z onto
        the sphere.

        Raises NotDefiniteError when an element is turned inside out, or a node leaves the sphere sideways.
        """
        if self.gap(u, 0.0)[active].max(initial=0.0) == np.inf:
            raise NotDefiniteError("a node in contact is beside the sphere")
        T, d1 = self.elimination_at(u, active)
        u0, approach = self.admissible(u, active, load)
        x = self.slope * self.place(u)[active]
        curvature = np.zeros(self.size)
        curvature[self.radial[active]] = (
            self.slope**2 * (1.0 - x**2) ** -1.5 * self.reaction(response)[active]
        )
        K = response.tangent - sp.diags(curvature)
        force = response.force + K @ (u0 - u)
        column = K @ d1
        right = np.append(-(T.T @ force), load.force - d1 @ force)
        kept.setups += 1
        x = Bordered(T.T @ K @ T, T.T @ column, float(d1 @ column))(right)
        moved = u0 + T @ x[:-1] + x[-1] * d1
        approach += float(x[-1])
        moved[self.normal[0, active]] -= self.gap(moved, approach)[active]
        self._check(moved)
        return moved, approach

    def _check(self, u: Array) -> None:
        """Raise NotDefiniteError where an element is turned inside out."""
        if not np.isfinite(u).all():
            raise NotDefiniteError("displacements are not finite")
        plane, hoop = deformation(self.operator.gradient(u), self.slope)
        if self.hencky is not None and not (
            np.linalg.det(plane + np.eye(2)).min() > 0.0 and hoop.min() > -1.0
        ):
            raise NotDefiniteError("an element is turned inside out")

    def out_of_balance(self, response: Response, active: Bools, load: Load) -> float:
        """Largest force on a free degree of freedom, along the sphere at nodes in contact."""
        if not isinstance(response, Placed):
            raise TypeError("the response of another contact: it has no displacements")
        T = self.elimination_at(response.u, active)[0]
        return float(np.max(np.abs(T.T @ response.force)))
