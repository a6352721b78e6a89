# SPDX-License-Identifier: MIT
"""A body in full slip against a rigid surface, or under prescribed tractions, in three dimensions.

In contact the nodes have the gap zero, u_z = delta - gap0, and their multipliers lambda, the normal forces
on the body, come with the tangential forces ratio lambda along x. With the internal force f and its
derivative K, every iteration solves

    f_i(u) - ratio w_i lambda_i = 0     i: free, the second term only for u_x of nodes in contact
    sum(lambda) = F                 lambda: f of u_z of the nodes in contact

linearised at u, for increments of the free displacements and of the approach delta, a degree of freedom
itself; w: local coefficient of friction over the largest one. Far away the displacements are those of the
point forces F and ratio F (Boussinesq, Cerruti; with a coating see `layered_force`) at the place of the
load. Where w varies the tangential one is ratio sum(w lambda), of the iteration before: it moves the whole
body, and the contact hardly.
"""

from __future__ import annotations

from collections.abc import Callable
from copy import copy
from dataclasses import dataclass, replace

import numpy as np
from scipy.sparse.linalg import LinearOperator

from fem_reference.common.arrays import Array, Bools, Integers
from fem_reference.common.contact import NotDefiniteError, Response
from fem_reference.common.far_field import coating_effect, slanted
from fem_reference.common.linear import Counted, Kept
from fem_reference.common.plasticity import History, Material
from fem_reference.common.schedule import Load
from fem_reference.spatial.hexahedra import HexSolid
from fem_reference.spatial.multigrid import Preconditioner, UnsolvedError, solve

ACCURACY = 3e-3
"""Residual of a linear solve over its right-hand side: from 1e-1 to 1e-4 this costs least time."""
SLOWER = 2
"""A hierarchy is made anew after a solve of so many times the iterations of its first one."""
NodalForces = Callable[[Load], Array]


@dataclass(frozen=True)
class Candidates:
    """Surface nodes that may touch.

    nodes: (n,) their numbers, the apex first; gap0: (n,) their initial gap; weights: (n,) w; anchored: the
    first one is always in contact; carried: the whole force is at the place of a load, not at the origin.
    """

    nodes: Integers
    gap0: Array
    weights: Array
    anchored: bool = True
    carried: bool = True


class SlidingProblem:
    """The body of a contact with friction; see the module.

    share: modelled part of every force;
    material: None if elastic; tractions: the nodal forces (size,) of prescribed tractions, which then take
    the place of contact.
    """

    def __init__(
        self,
        solid: HexSolid,
        candidates: Candidates,
        *,
        share: float,
        material: Material | None = None,
        tractions: NodalForces | None = None,
    ):
        self.solid, self.share, self.material = solid, share, material
        self.tractions, self.size, self.mesh = tractions, solid.size, solid.basis.mesh
        self.gap0, self.weights, self.anchored = candidates.gap0, candidates.weights, candidates.anchored
        self.carried = candidates.carried
        dofs = solid.basis.nodal_dofs
        self.normal, self.along = dofs[2, candidates.nodes], dofs[0, candidates.nodes]
        self.far = np.zeros(self.mesh.p.shape[1], dtype=bool)
        self.far[np.unique(self.mesh.facets[:, self.mesh.boundaries["far"]])] = True
        self.fixed = np.zeros(self.size, dtype=bool)
        self.fixed[dofs[:, self.far]] = True
        if "symmetry" in self.mesh.boundaries:
            self.fixed[solid.boundary_dofs("symmetry", 1)] = True
        self._coating_effects: dict[tuple[float, float, bool], Array] = {}
        self.approximate_inverse = Preconditioner(solid.stiffness, self.mesh.p, self.far)

    def with_gap(self, gap0: Array) -> SlidingProblem:
        """The same body below another initial gap (n_candidates,)."""
        other = copy(self)
        other.gap0 = gap0
        return other

    def far_field(self, load: Load) -> Array:
        """Displacements (size,) on the outer boundary, zero elsewhere; load.ratio: of the whole forces."""
        u, (x, y) = np.zeros(self.size), (load.x, load.y) if self.carried else (0.0, 0.0)
        offset = self.mesh.p[:, self.far] - np.array([[x], [y], [0.0]])
        forces = load.force, load.ratio * load.force
        values = slanted(forces, self.solid.elastic, offset)
        if self.solid.coating is not None:
            effect = self._coating_effect((x, y), offset, bool(load.ratio))
            values += np.einsum("f,fcn->cn", forces, effect)
        u[self.solid.basis.nodal_dofs[:, self.far]] = values
        return u

    def _coating_effect(self, place: tuple[float, float], offset: Array, sliding: bool) -> Array:
        """`coating_effect` at `place`, computed once for each."""
        key = *place, sliding
        if key not in self._coating_effects and self.solid.coating is not None:
            effect = coating_effect(self.solid.coating, self.solid.elastic, offset, sliding=sliding)
            self._coating_effects[key] = effect
        return self._coating_effects[key]

    def respond(self, u: Array, start: History | None) -> Response:
        """Response at u in a step from `start`; the caller decides whether it becomes history."""
        if self.material is None or start is None:
            return Response(self.solid.stiffness @ u, self.solid.stiffness, None)
        update = self.material.update(self.solid.strain(u), start)
        tangent = self.solid.softened(update.elements, update.loss)
        return Response(self.solid.internal_force(update.stress), tangent, update.history)

    def gap(self, u: Array, approach: float) -> Array:
        """gap0 + u_z - delta at the candidates."""
        return self.gap0 + u[self.normal] - approach

    def reaction(self, response: Response) -> Array:
        """Force (n_candidates,) of the counter-body on each candidate, if that is in contact."""
        return response.force[self.normal]

    def free(self, active: Bools) -> Bools:
        """Degrees of freedom (bool) that are not prescribed."""
        free = ~self.fixed
        free[self.normal[active]] = False
        return free

    def unbalanced(self, force: Array, active: Bools, ratio: float) -> Array:
        """The force f_i - ratio lambda_i on every degree of freedom."""
        slipping = force.copy()
        slipping[self.along[active]] -= ratio * self.weights[active] * force[self.normal[active]]
        return slipping

    def overall(self, load: Load, response: Response, active: Bools) -> Load:
        """The load with the ratio of the whole forces, as of the reactions in `response`."""
        if not active.any() or (self.weights == 1.0).all():
            return load
        pressing = np.clip(response.force[self.normal[active]], 0.0, None)
        share = np.average(self.weights[active], weights=pressing if pressing.any() else None)
        return replace(load, ratio=load.ratio * float(share))

    def out_of_balance(self, response: Response, active: Bools, load: Load) -> float:
        """Largest force on a free degree of freedom or missing in the sum."""
        force = response.force - (self.tractions(load) if self.tractions else 0.0)
        inside = np.abs(self.unbalanced(force, active, load.ratio)[self.free(active)]).max()
        lacking = abs(force[self.normal[active]].sum() - self.share * load.force) if active.any() else 0.0
        return float(max(inside, lacking)) / self.share

    def newton_step(
        self, u: Array, response: Response, active: Bools, *, load: Load, kept: Kept
    ) -> tuple[Array, float]:
        """Displacements and approach that balance the forces linearised at u.

        Without contact the approach is that of first touch. Raises NotDefiniteError.
        """
        free, touching, K = self.free(active), self.normal[active], response.tangent
        approach = float((u[touching] + self.gap0[active]).max(initial=-np.inf)) if active.any() else 0.0
        # first the prescribed displacements alone, delta as guessed from u
        jump = np.where(self.fixed, self.far_field(self.overall(load, response, active)) - u, 0.0)
        jump[touching] = approach - self.gap0[active] - u[touching]
        force = response.force + K @ jump - (self.tractions(load) if self.tractions else 0.0)

        def folded(f: Array) -> Array:
            """Equations of the free displacements and, last, of delta."""
            equations = np.where(free, self.unbalanced(f, active, load.ratio), 0.0)
            return np.append(equations, f[touching].sum())

        def unfolded(v: Array) -> Array:
            step = np.where(free, v[:-1], 0.0)
            step[touching] = v[-1]
            return step

        right = -folded(force)
        right[-1] += self.share * load.force if active.any() else 0.0
        symmetric = load.ratio == 0.0 or not active.any()  # a traction that is given follows no displacement
        size = right.size
        operator = LinearOperator((size, size), lambda v: folded(K @ unfolded(v.ravel())))
        v = self._solve(operator, right, response, active, kept=kept, symmetric=symmetric)
        u = u + jump + unfolded(v)
        return u, approach + float(v[-1]) if active.any() else float(self.gap(u, 0.0).min())

    def _solve(
        self,
        operator: LinearOperator,
        right: Array,
        response: Response,
        active: Bools,
        *,
        kept: Kept,
        symmetric: bool,
    ) -> Array:
        """Increments of the displacements and delta; the preconditioner treats delta apart, by its diagonal.

        One that is kept from an earlier tangent, and does not do, is made anew.
        """
        free, earlier = self.free(active), kept.inverse is not None
        if not earlier:
            try:
                kept.keep(self.approximate_inverse(response.tangent, free), active)
            except UnsolvedError as error:
                raise NotDefiniteError(str(error)) from None
        unit = np.zeros(self.size + 1)
        unit[-1] = 1.0
        stiffness = operator.matvec(unit)[-1] if active.any() else 1.0

        def inverse(r: Array) -> Array:
            return np.append(
                np.where(free, kept.solve(np.where(free, r.ravel()[:-1], 0.0)), 0.0),
                r.ravel()[-1] / stiffness,
            )

        counted = Counted(inverse)
        try:
            v = solve(
                operator,
                right,
                LinearOperator(operator.shape, counted),
                accuracy=ACCURACY,
                target=kept.target * self.share,
                symmetric=symmetric,
            )
        except UnsolvedError as error:
            if not earlier:
                raise NotDefiniteError(str(error)) from None
            kept.inverse = None
            return self._solve(operator, right, response, active, kept=kept, symmetric=symmetric)
        finally:
            kept.linear += counted.calls
        kept.first = kept.first or counted.calls
        if counted.calls > SLOWER * kept.first:
            kept.inverse = None
        return v
