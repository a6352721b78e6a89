# SPDX-License-Identifier: MIT
"""Frictionless contact of deformed surface nodes with a rigid sphere, in the loop of `fem_reference.common.contact`.

With the node at the radius x = r + strain u_r now, in the units of the contact (slope = length/R = strain):

    gap = h(x) + u_z - delta,   h(x) = (1 - sqrt(1 - slope^2 x^2))/slope^2

The force of a node in contact has the direction of the sphere's normal there, (slope h'(x), 1); its vertical part is the
multiplier. Eliminated are the u_z, whose derivative by u_r is that of the sphere.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
from scipy.sparse.linalg import splu

from fem_reference.common.contact import ContactProblem, Load, NotDefiniteError, Response
from fem_reference.common.linear import Kept
from fem_reference.common.plasticity import History
from fem_reference.finite_strain.kinematics import GradientOperator, deformation
from fem_reference.finite_strain.material import Hencky


@dataclass(frozen=True)
class Placed(Response):
    """A response, and the displacements at which it is."""

    u: np.ndarray


class SphereContact(ContactProblem):
    """One body against a rigid sphere of true geometry. slope: unit of length over its radius, also the unit of strain.

    hencky: the body's material at finite strain; None: small strain, by the material of ContactProblem.
    """

    slope: float = 0.0
    hencky: Hencky | None = None

    @classmethod
    def of(cls, problem: ContactProblem, slope: float, hencky: Hencky | None) -> SphereContact:
        """The contact problem of a flat gap with the gap of the sphere."""
        self = cls(problem.blocks, problem.gap0, problem.material)
        self.slope, self.hencky = slope, hencky
        solid = self.blocks[0].solid
        self.radial = solid.boundary_dofs("surface", 0)[: self.gap0.size]
        self.radii = solid.basis.doflocs[0, self.radial]
        self.operator = GradientOperator(solid.basis, solid.weights)
        return self

    def place(self, u: np.ndarray) -> np.ndarray:
        """Radius (n_candidates,) of the deformed surface nodes."""
        return self.radii + self.slope * u[self.radial]

    def gap(self, u: np.ndarray, approach: float) -> np.ndarray:
        """Vertical gap of the candidates, infinite beside the sphere."""
        x = self.place(u)
        square = 1.0 - (self.slope * x) ** 2
        height = np.where(square > 0.0, x**2 / (1.0 + np.sqrt(np.clip(square, 0.0, None))), np.inf)
        return height + u[self.normal[0]] - approach

    def respond(self, u: np.ndarray, start: History | None) -> Placed:
        """As ContactProblem.respond, at finite strain if so."""
        if self.hencky is None:
            small = super().respond(u, start)
            return Placed(small.force, small.tangent, small.history, u)
        update = self.hencky.update(self.operator.gradient(u), start)
        force, tangent = self.operator.nodal_forces(update.stress), self.operator.stiffness(update.tangent)
        return Placed(force, tangent, update.history, u)

    def elimination_at(self, u: np.ndarray, active: np.ndarray) -> tuple[sp.csr_matrix, np.ndarray]:
        """(T, d1) as ContactProblem.elimination, along the sphere at the active nodes."""
        T, d1 = self.elimination(active)
        x = self.slope * self.place(u)[active]
        tilt = x / np.sqrt(1.0 - x**2)
        rows, columns = self.normal[0, active], self.radial[active]
        return T - sp.csr_matrix((tilt, (rows, columns)), shape=(self.size,) * 2) @ T, d1

    def newton_step(
        self, u: np.ndarray, response: Placed, active: np.ndarray, load: Load, kept: Kept
    ) -> tuple[np.ndarray, float]:
        """As ContactProblem.newton_step; then the nodes in contact are moved along z onto the sphere.

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
        try:
            factor = splu(
                (T.T @ K @ T).tocsc(),
                permc_spec="NATURAL",
                diag_pivot_thresh=0.0,
                options={"SymmetricMode": True},
            )
        except RuntimeError as error:  # exactly singular
            raise NotDefiniteError(str(error)) from None
        kept.setups += 1
        side, held = factor.solve(T.T @ column), factor.solve(T.T @ -force)
        delta = (load.force - d1 @ force - column @ (T @ held)) / (d1 @ column - column @ (T @ side))
        moved = u0 + T @ (held - delta * side) + delta * d1
        approach += float(delta)
        moved[self.normal[0, active]] -= self.gap(moved, approach)[active]
        self._check(moved)
        return moved, approach

    def _check(self, u: np.ndarray) -> None:
        """Raise NotDefiniteError unless every point keeps a positive volume and no node in reach is beside the sphere."""
        if not np.isfinite(u).all():
            raise NotDefiniteError("displacements are not finite")
        plane, hoop = deformation(self.operator.gradient(u), self.slope)
        if self.hencky is not None and not (
            np.linalg.det(plane + np.eye(2)).min() > 0.0 and hoop.min() > -1.0
        ):
            raise NotDefiniteError("an element is turned inside out")

    def out_of_balance(self, response: Placed, active: np.ndarray, load: Load) -> float:
        """Largest force on a free degree of freedom, along the sphere at nodes in contact."""
        return float(np.max(np.abs(self.elimination_at(response.u, active)[0].T @ response.force)))
