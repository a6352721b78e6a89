# SPDX-License-Identifier: MIT
"""Contact in full slip of a plane-strain body with a rigid surface, or of two bodies.

Nodes in contact have the gap zero, gap0 + sum of u_z - delta, and multipliers lambda, the normal forces on
the bodies, with the tangential forces ratio lambda along x on the first and -ratio lambda on the second.
With the internal force f and its derivative K every iteration solves, linearised at u,

    f(u) - C lambda = 0        C: forces of unit multipliers, on the free degrees of freedom
    G'u - delta = -gap0        G: the u_z that make the gap
    sum(lambda) = F

for displacements u, lambda and the approach delta. The elastic stiffness E is factorised once, and with it
P(y), the elastic displacements under the loads y and multipliers that leave the gaps as they are. Where
points yield, K = E - L, u = P(y) with y - L P(y) = r, which GMRES solves: there are as many iterations as
the yielding points make it need, few where few yield, and no factorisation. Far away the displacements are
those of the line forces F and ratio F (Flamant) at the place of the load, and of the plastic strain, as of
the iteration before: it moves the outer boundary little, and the contact hardly.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from copy import copy

import numpy as np
import scipy.sparse as sp
from scipy.linalg import lu_factor, lu_solve
from scipy.sparse.linalg import LinearOperator, aslinearoperator, gmres, splu

from fem_reference.common.arrays import Array, Bools, Integers
from fem_reference.common.contact import NotDefiniteError, Response
from fem_reference.common.far_field import flamant, stretched
from fem_reference.common.linear import Counted, Kept
from fem_reference.common.plasticity import History, Material
from fem_reference.common.quadrilaterals import MatchedBodies, PlaneSolid, elimination_order
from fem_reference.common.schedule import Load

ACCURACY = 0.1
"""Residual of a linear solve over its right-hand side, far from equilibrium; near it less, see `_krylov`."""
OVERSHOT = 0.5
"""A Newton step is shortened, to where the secant has no work left, if behind it the forces do so much more
work against it than the first ones did along it.
"""
MOST = 120
"""Iterations of a linear solve; beyond, the body flows freely."""


class LineProblem(MatchedBodies):
    """One body against a rigid surface, or two.

    length: of the contact along y, which bears the forces of the loads; at half of it beside a line force the
    surface does not move along that.
    """

    anchored = False

    def __init__(
        self,
        solids: Sequence[PlaneSolid],
        candidates: slice,
        gap0: Array,
        *,
        length: float,
        material: Material | None = None,
    ):
        super().__init__(solids, candidates, gap0, material)
        half = "axis" in solids[0].basis.mesh.boundaries
        self.length, self.share = length, (0.5 if half else 1.0) / length
        self.signs = np.array([1.0, -1.0])[: len(solids), None]
        self.far = [solids[0].boundary_dofs("far", component) for component in (0, 1)]
        fixed = np.zeros(self.count, dtype=bool)
        fixed[np.concatenate(self.far)] = True
        if half:
            fixed[solids[0].boundary_dofs("axis", 0)] = True
        self.free = np.tile(~fixed, len(solids))
        self._factors = [_factor(solid, ~fixed) for solid in solids]
        self._stretches = None if material is None else _stretches(solids[0], self.far)
        self._columns: dict[tuple[np.intp, float], Array] = {}

    def with_gap(self, gap0: Array) -> LineProblem:
        """The same bodies below another initial gap (n_candidates,)."""
        other = copy(self)
        other.gap0 = gap0
        return other

    def far_field(self, load: Load, history: History | None) -> Array:
        """Displacements (size,) on the outer boundary, zero elsewhere."""
        solid, force = self.solids[0], load.force / self.length
        parts = []
        for body, sign in zip(self.solids, self.signs[:, 0], strict=True):
            part = np.zeros(solid.size)
            for component, dofs in enumerate(self.far):
                points = solid.basis.doflocs[:, dofs] - np.array([[load.x], [0.0]])
                forces = force, sign * load.ratio * force
                part[dofs] = flamant(forces, body.elastic, points, 0.5 * self.length)[component]
            parts.append(part)
        if history is not None and history.yielded and self._stretches is not None:
            for dofs, stretches in zip(self.far, self._stretches, strict=True):
                xx, yy = (strain.ravel() for strain in history.plastic_strain[:2])
                parts[0][dofs] += stretches @ (xx + solid.elastic.poisson * yy)
        return np.concatenate(parts)

    def respond(self, u: Array, start: History | None) -> Response:
        """Response at u in a step from `start`; the tangent is that of the first body."""
        first, *others = self.solids
        forces = [solid.stiffness @ self.body(u, i) for i, solid in enumerate(others, start=1)]
        if self.material is None or start is None:
            return Response(
                np.concatenate([first.stiffness @ self.body(u, 0), *forces]), first.stiffness, None
            )
        update = self.material.update(first.strain(self.body(u, 0)), start)
        forces = [first.internal_force(update.stress), *forces]
        tangent = first.softened(update.elements, update.loss)
        return Response(np.concatenate(forces), tangent, update.history, start=start)

    def reaction(self, response: Response) -> Array:
        """Whole force (n_candidates,) of the counter-body on each candidate, if that is in contact."""
        return response.force[self.normal[0]] / self.share

    def pressed(self, multipliers: Array, active: Bools, ratio: float) -> Array:
        """C lambda: forces (size,) of multipliers on the nodes in contact."""
        force = np.zeros(self.size)
        force[self.normal[:, active]] = multipliers
        force[self.along[:, active]] = ratio * self.signs * multipliers
        return np.where(self.free, force, 0.0)  # u_x on an axis of symmetry

    def out_of_balance(self, response: Response, active: Bools, load: Load) -> float:
        """Largest force on a free degree of freedom or missing in the sum."""
        multipliers = response.force[self.normal[0, active]]
        inside = (response.force - self.pressed(multipliers, active, load.ratio))[self.free]
        lacking = multipliers.sum() - self.share * load.force if active.any() else 0.0
        return float(max(np.abs(inside).max(), abs(lacking))) / self.share

    def inverse(self, force: Array) -> Array:
        """Elastic displacements under forces on the free degrees of freedom, the others held."""
        parts = [factor(self.body(force, i)) for i, factor in enumerate(self._factors)]
        return np.concatenate(parts)

    def _column(self, node: np.intp, ratio: float, solve: Callable[[Array], Array]) -> Array:
        """Elastic displacements under a unit multiplier of a candidate, kept while it is in contact."""
        if (node, ratio) not in self._columns:
            unit = np.arange(self.gap0.size) == node
            self._columns[node, ratio] = solve(self.pressed(np.ones(1), unit, ratio))
        return self._columns[node, ratio]

    def newton_step(
        self, u: Array, response: Response, active: Bools, *, load: Load, kept: Kept
    ) -> tuple[Array, float]:
        """Displacements and approach that balance the forces linearised at u.

        Without contact the approach is that of first touch. Raises NotDefiniteError.
        """
        solve, elastic, free = Counted(self.inverse), self.solids[0].stiffness, self.free
        softer, count = response.tangent is not elastic, self.count
        nodes, ratio = np.flatnonzero(active), load.ratio
        # increments from the multipliers and the approach that u has, so that all are small near equilibrium
        before = response.force[self.normal[0, active]]
        approach = float(self.gap(u, 0.0)[active].mean()) if nodes.size else 0.0
        jump = np.where(free, 0.0, self.far_field(load, response.history) - u)
        right = self.pressed(before, active, ratio) - response.force
        for i, solid in enumerate(self.solids):
            matrix = response.tangent if i == 0 else solid.stiffness
            right[i * count :][:count] -= matrix @ self.body(jump, i)
        right = np.where(free, right, 0.0)
        for node, traction in list(self._columns):
            if not active[node] or traction not in (0.0, ratio):
                del self._columns[node, traction]
        G = np.array([self._column(node, 0.0, solve) for node in nodes]).reshape(nodes.size, self.size)
        C = G
        if ratio and nodes.size:
            C = np.array([self._column(node, ratio, solve) for node in nodes])
        touching = self.normal[:, active]
        border = np.ones((nodes.size + 1, nodes.size + 1))
        border[:-1, :-1] = C[:, touching].sum(axis=1).T
        border[:-1, -1], border[-1, -1] = -1.0, 0.0 if nodes.size else 1.0
        factors = lu_factor(border)

        def moved(y: Array, gaps: Array, force: float) -> tuple[Array, float]:
            """Elastic displacements and approach under loads, changes of gaps, a force."""
            *multipliers, delta = lu_solve(factors, np.append(gaps - G @ y, force))
            return (solve(y) if y.any() else y) + np.array(multipliers) @ C, float(delta)

        def lost(w: Array) -> Array:
            """L w."""
            out = np.zeros(self.size)
            part = self.body(w, 0)
            out[:count] = elastic @ part - response.tangent @ part
            return np.where(free, out, 0.0)

        gaps = -self.gap(u, approach)[active]
        force = self.share * load.force - before.sum() if nodes.size else 0.0
        y = right
        if softer:
            none = np.zeros(nodes.size)
            y = right + lost(moved(np.zeros(self.size), gaps, force)[0])
            force_scale = self.share * (load.force or 1.0)
            y = _krylov(
                lambda y: y - lost(moved(y, none, 0.0)[0]),
                y,
                scale=force_scale,
                target=kept.target * self.share,
            )
        w, further = moved(y, gaps, force)
        kept.linear += solve.calls
        if softer:
            ahead = self.respond(u + jump + w, response.start)
            after = ahead.force - self.pressed(ahead.force[self.normal[0, active]], active, ratio)
            over, work = float(w @ np.where(free, after, 0.0)), float(w @ right)
            if work > 0.0 and over > OVERSHOT * work:
                share = work / (work + over)
                w, further = share * w, share * further
        u = u + jump + w
        return u, approach + further if nodes.size else float(self.gap(u, 0.0).min())


def _krylov(apply: Callable[[Array], Array], right: Array, *, scale: float, target: float) -> Array:
    """Solution by GMRES, to a share of the right-hand side that falls with the root of its size over `scale`,
    as Newton's method converges. Raises NotDefiniteError where it does not end.
    """
    operator = LinearOperator((right.size, right.size), apply)
    accuracy = min(ACCURACY, float(np.sqrt(np.abs(right).max() / scale)))
    y, info = gmres(operator, right, x0=right, rtol=accuracy, atol=target, restart=MOST, maxiter=1)
    if info or not np.isfinite(y).all():
        raise NotDefiniteError("the body flows freely")
    return y


def _stretches(solid: PlaneSolid, far: Sequence[Integers]) -> list[LinearOperator]:
    """u_x and u_z of the outer boundary by e_xx + nu e_yy at the Gauss points: (n_far, n_points), by way of
    the columns of points.
    """
    (x, z), weights = solid.points.reshape(2, -1), solid.weights.ravel()
    columns, column = np.unique(np.round(x, 12), return_inverse=True)
    entries, shape = (column, np.arange(x.size)), (columns.size, x.size)
    areas = [aslinearoperator(sp.csr_matrix((w, entries), shape=shape)) for w in (weights, z * weights)]
    # of a half the other one too
    shifts = (columns, -columns) if "axis" in solid.basis.mesh.boundaries else (columns,)
    out = []
    for component, dofs in enumerate(far):
        points = solid.basis.doflocs[:, dofs, None]
        found = [stretched(solid.elastic, points - np.array([shift, 0 * shift])[:, None]) for shift in shifts]
        flat, deeper = (aslinearoperator(sum(u)[component]) for u in zip(*found, strict=True))
        out.append(flat @ areas[0] + deeper @ areas[1])
    return out


def _factor(solid: PlaneSolid, free: Bools) -> Callable[[Array], Array]:
    """Inverse of the stiffness of the free degrees of freedom, by nested dissection; zero elsewhere."""
    order = elimination_order(solid)
    order = order[free[order]]
    matrix, options = solid.stiffness[order][:, order].tocsc(), {"SymmetricMode": True}
    factor = splu(matrix, permc_spec="NATURAL", diag_pivot_thresh=0.0, options=options)

    def inverse(force: Array) -> Array:
        u = np.zeros(solid.size)
        u[order] = factor.solve(force[order])
        return u

    return inverse
