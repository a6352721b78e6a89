# SPDX-License-Identifier: MIT
"""Frictionless axisymmetric contact of one body with a rigid surface, or of two bodies.

The zero gaps of the active nodes are eliminated affinely,

    u = u0 + T v + delta d1,

so that T^T K T stays symmetric and positive definite; the approach delta follows from a second right-hand
side and sum(lambda) = F.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
import scipy.sparse as sp
from scipy.sparse.linalg import LinearOperator, cg, splu

from fem_reference.common.arrays import Array, Bools
from fem_reference.common.contact import NotDefiniteError, Response
from fem_reference.common.elasticity import Solid
from fem_reference.common.far_field import normal_far_field
from fem_reference.common.linear import Counted, Kept
from fem_reference.common.plasticity import History, Material
from fem_reference.common.quadrilaterals import MatchedBodies, elimination_order
from fem_reference.common.schedule import Load

FEW = 12
"""Iterations with earlier factors, each a twentieth of new ones: beyond, these are cheaper."""


class ContactProblem(MatchedBodies):
    """One body against a rigid surface, or two.

    gap0: (n_candidates,) initial gap of the surface nodes that may touch, by r from the axis. prescribed:
    (size,) nodal forces of a given pressure under a unit force, which then takes the place of contact. The
    outer boundary of each body is displaced as by the point force that balances the contact, so that delta
    counts from infinity; far: (size,), or so under a unit of the load.
    """

    anchored = True

    def __init__(
        self,
        solids: Sequence[Solid],
        gap0: Array,
        material: Material | None = None,
        prescribed: Array | float = 0.0,
        *,
        far: Array | None = None,
    ):
        super().__init__(solids, slice(gap0.size), gap0, material)
        self.prescribed = prescribed
        # displacements of the softer body are eliminated: those of a nearly rigid one are small differences
        self.slave = int(np.argmin([solid.elastic.young for solid in solids]))
        self.order = elimination_order(solids[0], len(solids))
        # (size,) prescribed degrees of freedom, and their values under a unit force
        self.fixed, self.far_field = np.zeros(self.size, dtype=bool), np.zeros(self.size)
        for i, solid in enumerate(solids):
            fixed, values = self.fixed[i * self.count :], self.far_field[i * self.count :]
            for component in (0, 1):
                outer = solid.boundary_dofs("far", component)
                u = normal_far_field(solid.coating, solid.elastic, *solid.basis.doflocs[:, outer])
                fixed[outer], values[outer] = True, u[component] if far is None else far[outer]
            axis = solid.boundary_dofs("axis", 0)
            fixed[axis], values[axis] = True, 0.0

    def internal_force(self, u: Array, history: History | None = None) -> Array:
        """Internal force (size,) of all bodies when no plastic strain changes any more."""
        plastic = [0.0 if history is None else history.inelastic, 0.0]
        parts = [s.internal_force(s.stress(self.body(u, i), plastic[i])) for i, s in enumerate(self.solids)]
        return np.concatenate(parts)

    def respond(self, u: Array, start: History | None) -> Response:
        """Response at u in a step from `start`; the caller decides whether it becomes history."""
        if self.material is None or start is None:
            return Response(self.internal_force(u), self.tangent([s.stiffness for s in self.solids]), None)
        solid, *others = self.solids
        update = self.material.update(solid.strain(self.body(u, 0)), start)
        forces = [solid.internal_force(update.stress)]
        forces += [s.internal_force(s.stress(self.body(u, i))) for i, s in enumerate(others, start=1)]
        matrices = [solid.softened(update.elements, update.loss), *(s.stiffness for s in others)]
        return Response(np.concatenate(forces), self.tangent(matrices), update.history)

    def tangent(self, matrices: Sequence[sp.csr_matrix]) -> sp.csr_matrix:
        """Derivative of the internal force from that of each body."""
        return matrices[0] if len(matrices) == 1 else sp.block_diag(matrices, format="csr")

    def elimination(self, active: Bools) -> tuple[sp.csr_matrix, Array]:
        """(T, d1) of changes T v + delta d1 that leave the gap of the active nodes as it is, for every v
        and delta.

        Eliminated is u_z of one body: u_z = delta (rigid counter-body), or minus u_z of the other one as
        well.
        """
        slaves = self.normal[self.slave, active]
        free = ~self.fixed
        free[slaves] = False
        rows = [self.order[free[self.order]]]
        column = np.zeros(self.size, dtype=int)
        column[rows[0]] = np.arange(rows[0].size)
        columns, values = [column[rows[0]]], [np.ones(rows[0].size)]
        for masters in np.delete(self.normal, self.slave, axis=0)[:, active]:
            rows.append(slaves)
            columns.append(column[masters])
            values.append(-np.ones(slaves.size))
        entries = (np.concatenate(values), (np.concatenate(rows), np.concatenate(columns)))
        T = sp.csr_matrix(entries, shape=(self.size, rows[0].size))
        d1 = np.zeros(self.size)
        d1[slaves] = 1.0
        return T, d1

    def admissible(self, u: Array, active: Bools, load: Load) -> tuple[Array, float]:
        """Return u with the prescribed displacements and no gap at the active nodes, and its approach."""
        moved = np.where(self.fixed, load.force * self.far_field, u)
        approach = float(self.gap(moved, 0.0)[active].mean()) if active.any() else 0.0
        moved[self.normal[self.slave, active]] -= self.gap(moved, approach)[active]
        return moved, approach

    def newton_step(
        self, u: Array, response: Response, active: Bools, *, load: Load, kept: Kept
    ) -> tuple[Array, float]:
        """Displacements and approach that balance the forces linearised at u, with the given nodes in
        contact.

        T^T (f + K (u0 + T v + delta d1 - u)) = 0 and d1^T (the same bracket) = F: the internal force of the
        eliminated degrees of freedom is the multiplier, the force with which the contact presses on the
        body. Without contact the approach is that of first touch. Raises NotDefiniteError.
        """
        T, d1 = self.elimination(active)
        u0, approach = self.admissible(u, active, load)
        K, touches = response.tangent, active.any()
        force = response.force - load.force * self.prescribed + K @ (u0 - u)
        right = np.append(-(T.T @ force), load.force - d1 @ force if touches else 0.0)
        column = K @ d1
        border, corner = T.T @ column, float(d1 @ column) if touches else 1.0

        def apply(x: Array) -> Array:
            v, delta = x[:-1], x[-1]
            return np.append(T.T @ (K @ (T @ v)) + delta * border, border @ v + delta * corner)

        x = None
        # the first tangent of a step, at the end of the one before, is elastic: it stands for no later one
        if kept.setups > 1 and kept.active is not None and np.array_equal(kept.active, active):
            x = refined(apply, right, kept)
        if x is None:
            inverse = Bordered(T.T @ K @ T, border, corner)
            kept.keep(inverse, active)
            x = inverse(right)
        if not (np.isfinite(x).all() and right @ x >= 0.0):
            raise NotDefiniteError("the matrix is not positive definite")
        u = u0 + T @ x[:-1] + x[-1] * d1
        return u, approach + float(x[-1]) if touches else float(self.gap(u, 0.0).min())

    def reaction(self, response: Response) -> Array:
        """Force (n_candidates,) of the counter-body on each candidate, if that is in contact."""
        return response.force[self.normal[self.slave]]

    def out_of_balance(self, response: Response, active: Bools, load: Load) -> float:
        """Largest force on a free degree of freedom."""
        T = self.elimination(active)[0]
        return float(np.max(np.abs(T.T @ (response.force - load.force * self.prescribed))))


class Bordered:
    """Exact inverse of [[A, b], [b, c]] with A positive definite. Raises NotDefiniteError."""

    def __init__(self, A: sp.csr_matrix, b: Array, c: float):
        try:
            options = {"SymmetricMode": True}
            self.factor = splu(A.tocsc(), permc_spec="NATURAL", diag_pivot_thresh=0.0, options=options)
        except RuntimeError as error:  # exactly singular
            raise NotDefiniteError(str(error)) from None
        self.column = self.factor.solve(b)
        self.complement = c - b @ self.column
        if not (self.complement > 0.0 and b @ self.column >= 0.0):
            raise NotDefiniteError("the matrix is not positive definite")

    def __call__(self, r: Array) -> Array:
        """Return the solution for the right-hand side r."""
        last = (r[-1] - self.column @ r[:-1]) / self.complement
        return np.append(self.factor.solve(r[:-1]) - last * self.column, last)


def refined(apply: Callable[[Array], Array], right: Array, kept: Kept) -> Array | None:
    """Solution by conjugate gradients with the inverse that is kept; None if FEW iterations do not do."""
    inverse = Counted(kept.solve)
    operator, approximate = (LinearOperator((right.size,) * 2, function) for function in (apply, inverse))
    x, info = cg(operator, right, rtol=0.0, atol=kept.target, M=approximate, maxiter=FEW)
    kept.linear += inverse.calls
    return x if info == 0 and np.isfinite(x).all() else None
