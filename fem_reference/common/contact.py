# SPDX-License-Identifier: MIT
"""Contact by a primal-dual active set with nodal multipliers, under a prescribed force; frictionless axisymmetric contact.

Semi-smooth Newton method (Hueeber and Wohlmuth, Comput. Methods Appl. Mech. Engrg. 194 (2005) 3147): in each iteration
the gap of the active nodes is zero, the multiplier of the others is zero, and the set is then corrected by the signs of
both. The zero gaps are eliminated affinely,

    u = u0 + T v + delta d1,

so that T^T K T stays symmetric and positive definite; the approach delta follows from a second right-hand side and
sum(lambda) = F. Everything is in the consistent units of the caller; no tolerance has a unit.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from typing import Protocol

import numpy as np
import scipy.sparse as sp
from scipy.sparse.linalg import LinearOperator, cg, splu

from fem_reference.common.elasticity import AxisymmetricSolid
from fem_reference.common.linear import NO_WORK, Counted, Kept, Work, nested_dissection
from fem_reference.common.plasticity import History, Material
from fem_reference.common.point_force import boussinesq
from sam.scene.residuals import unfinished

EQUILIBRIUM = 1e-9
"""Largest residual force on a free degree of freedom, over the contact force."""
SIGN = 1e-10
"""Multipliers (over the force) and gaps (over the approach) of the wrong sign up to this are rounding: no change."""
MAX_ITERATIONS = 60
DIVERGED = 1.0
"""A residual of the whole contact force on one degree of freedom is not coming back."""
NEGLIGIBLE = 0.3
"""A linear solve needs no smaller residual than this share of EQUILIBRIUM."""
FEW = 12
"""Iterations with the factors of an earlier tangent, each a twentieth of new factors: beyond these, new ones are cheaper."""
STALLED = 10
"""Nor is one that has not fallen below its best for so many iterations."""


@dataclass(frozen=True)
class Load:
    """What acts on the body. ratio: tangential over normal traction, along x; x, y: place of a prescribed pressure."""

    force: float
    ratio: float = 0.0
    x: float = 0.0
    y: float = 0.0

    def halfway(self, start: Load) -> Load:
        """Between `start` and this one. Ratio and place change at once where there is no force, place also under force."""
        if start.force == 0.0:
            return replace(self, force=0.5 * self.force)
        force, x, y = 0.5 * (start.force + self.force), 0.5 * (start.x + self.x), 0.5 * (start.y + self.y)
        return Load(force, self.ratio, x, y)


class NotDefiniteError(ArithmeticError):
    """The tangent is not positive definite in floating-point numbers."""


@dataclass(frozen=True)
class Block:
    """One body of the contact. young, poisson: for its far field; the solid may use any material, its film is respected."""

    solid: AxisymmetricSolid
    young: float
    poisson: float

    def far_field(self) -> np.ndarray:
        """(size,) displacements of the point force on the outer boundary, under a unit force; zero elsewhere."""
        values, locations = np.zeros(self.solid.size), self.solid.basis.doflocs
        for component in (0, 1):
            far = self.solid.boundary_dofs("far", component)
            values[far] = boussinesq(1.0, self.young, self.poisson, *locations[:, far])[component]
            if self.solid.film is not None:
                from fem_reference.common.layered_force import normal  # a body without film does without

                values[far] += normal(self.solid.film, self.young, self.poisson, *locations[:, far])[
                    component
                ]
        return values


@dataclass
class ActiveSet:
    """Nodes in contact; the first node, under the apex, always stays, unless `anchored` is false: then the last one does.

    `update` makes the full primal-dual correction until a set comes back (ping-pong); from then on it corrects one node
    at a time, the one of the largest violation, and `stuck` is true when a set comes back even so.
    """

    active: np.ndarray
    anchored: bool = True
    single: bool = False
    stuck: bool = False
    seen: set[bytes] = field(default_factory=set)

    def update(self, multipliers: np.ndarray, gaps: np.ndarray) -> bool:
        """Correct the set from multipliers / force and gaps / approach (each (n,)); True if it changed."""
        violation = np.where(self.active, -multipliers, -gaps)
        violation[0 if self.anchored else np.argmax(np.where(self.active, multipliers, -np.inf))] = 0.0
        wrong = violation > SIGN
        if not wrong.any():
            return False
        self.seen.add(self.active.tobytes())
        corrected = self.active ^ wrong
        if corrected.tobytes() in self.seen and not self.single:
            self.single, self.seen = True, {self.active.tobytes()}
        if self.single:
            corrected = self.active.copy()
            corrected[np.argmax(violation)] ^= True
            self.stuck = corrected.tobytes() in self.seen
        self.active = corrected
        return True

    def forget(self) -> None:
        """Let sets come back: the displacements that corrected them were not in equilibrium."""
        self.single, self.seen = False, set()


@dataclass(frozen=True)
class Open:
    """In place of an active set where nothing touches."""

    active: np.ndarray
    stuck: bool = False

    def forget(self) -> None:
        """There is nothing to remember."""

    def update(self, _multipliers: np.ndarray, _gaps: np.ndarray) -> bool:
        """The set never changes."""
        return False


@dataclass(frozen=True)
class Equilibrium:
    """A solved load step. u: displacements of all bodies; multipliers, gap, active: (n_candidates,), by distance.

    residuals: largest force on a free degree of freedom over the force, after each iteration; steady: how many of the
    last iterations left the set as it was. history: of the first body at the end of the step, None if it is elastic.
    work: what it took; ending: in words, why it did not converge.
    """

    u: np.ndarray
    approach: float
    load: Load
    multipliers: np.ndarray
    gap: np.ndarray
    active: np.ndarray
    history: History | None = None
    residuals: tuple[float, ...] = ()
    steady: int = 0
    converged: bool = True
    work: Work = NO_WORK
    ending: str = ""

    @property
    def force(self) -> float:
        return self.load.force

    @property
    def iterations(self) -> int:
        return len(self.residuals)

    @property
    def residual(self) -> float:
        return self.residuals[-1] if self.residuals else 0.0

    @property
    def yielded(self) -> bool:
        """Whether any point has yielded up to now."""
        return self.history is not None and self.history.yielded


@dataclass(frozen=True)
class Response:
    """What the bodies do at given displacements: internal force (size,), its derivative, history as in Equilibrium."""

    force: np.ndarray
    tangent: sp.csr_matrix
    history: History | None


class Problem(Protocol):
    """What the iteration needs to know of bodies in contact. gap0: (n_candidates,); displacements and forces (size,)."""

    size: int
    gap0: np.ndarray
    anchored: bool

    def respond(self, u: np.ndarray, start: History | None) -> Response: ...

    def newton_step(
        self, u: np.ndarray, response: Response, active: np.ndarray, load: Load, kept: Kept
    ) -> tuple[np.ndarray, float]: ...

    def reaction(self, response: Response) -> np.ndarray: ...

    def gap(self, u: np.ndarray, approach: float) -> np.ndarray: ...

    def out_of_balance(self, response: Response, active: np.ndarray, load: Load) -> float: ...


class ContactProblem:
    """One body against a rigid surface, or two whose surface nodes match, each in its own (r, z into the body).

    gap0: (n_candidates,) initial gap of the surface nodes that may touch, by r from the axis. material: of the first
    body, None if it is elastic; the other body always is. prescribed: (size,) nodal forces of a given pressure under a unit
    force, which then takes the place of contact. The outer boundary of
    each body is displaced as by the point force that balances the contact, so that delta counts from infinity.
    """

    anchored = True

    def __init__(
        self,
        blocks: Sequence[Block],
        gap0: np.ndarray,
        material: Material | None = None,
        prescribed: np.ndarray | float = 0.0,
    ):
        if len(blocks) not in (1, 2):
            raise ValueError(f"blocks: {len(blocks)}, allowed are one (rigid counter-body) or two")
        self.blocks, self.gap0, self.material, self.prescribed = tuple(blocks), gap0, material, prescribed
        sizes = [block.solid.size for block in blocks]
        self.size = sum(sizes)
        self.offsets = np.cumsum(sizes) - sizes  # first degree of freedom of each body
        surface = [block.solid.boundary_dofs("surface", 1)[: gap0.size] for block in blocks]
        self.normal = (
            np.stack(surface) + self.offsets[:, None]
        )  # (n_blocks, n_candidates): u_z of the candidates
        # eliminated are displacements of the softer body: those of a nearly rigid one would be small differences
        self.slave = int(np.argmin([block.young for block in blocks]))
        self.fixed, self.far_field = self._supports()
        self.order = self._order()

    def _order(self) -> np.ndarray:
        """The degrees of freedom (size,) in the order of their elimination; the second body lies above the first."""
        mesh = self.blocks[0].solid.basis.mesh
        corners = [np.unique(np.round(line, 12)) for line in mesh.p]
        places = np.concatenate([block.solid.basis.doflocs for block in self.blocks], axis=1)
        numbers = [
            np.interp(place, line, np.arange(line.size)) for place, line in zip(places, corners, strict=True)
        ]
        r, z = np.rint(2.0 * np.array(numbers)).astype(int)  # mid nodes are halfway
        rows = corners[1].size - 1
        second = np.arange(self.size) >= self.blocks[0].solid.size
        z = np.where(second, -z, z) + 2 * rows * (len(self.blocks) - 1)
        part = nested_dissection(corners[0].size - 1, rows * len(self.blocks))
        return np.argsort(part[r, z], kind="stable")

    def _supports(self) -> tuple[np.ndarray, np.ndarray]:
        """Which degrees of freedom are prescribed (bool), and their values under a unit force (others zero); (size,).

        Far away they are the displacements of the point force; on the axis u_r = 0.
        """
        fixed, values = np.zeros(self.size, dtype=bool), np.zeros(self.size)
        for block, offset in zip(self.blocks, self.offsets, strict=True):
            values[offset:][: block.solid.size] = block.far_field()
            for component in (0, 1):
                fixed[offset + block.solid.boundary_dofs("far", component)] = True
            axis = block.solid.boundary_dofs("axis", 0)
            fixed[offset + axis], values[offset + axis] = True, 0.0
        return fixed, values

    def body(self, u: np.ndarray, index: int) -> np.ndarray:
        """Displacements of one body."""
        return u[self.offsets[index] :][: self.blocks[index].solid.size]

    def internal_force(self, u: np.ndarray, history: History | None = None) -> np.ndarray:
        """Internal force (size,) of all bodies when no plastic strain changes any more."""
        plastic = [0.0 if history is None else history.plastic_strain, 0.0]
        solids = [block.solid for block in self.blocks]
        parts = [s.internal_force(s.stress(self.body(u, i), plastic[i])) for i, s in enumerate(solids)]
        return np.concatenate(parts)

    def respond(self, u: np.ndarray, start: History | None) -> Response:
        """Response at u in a step that starts from `start`; the caller decides whether its end becomes history."""
        if self.material is None or start is None:
            return Response(
                self.internal_force(u), self.tangent([b.solid.stiffness for b in self.blocks]), None
            )
        solid, *others = (block.solid for block in self.blocks)
        update = self.material.update(solid.strain(self.body(u, 0)), start)
        forces = [solid.internal_force(update.stress)]
        forces += [s.internal_force(s.stress(self.body(u, i))) for i, s in enumerate(others, start=1)]
        matrices = [solid.softened(update.elements, update.loss), *(s.stiffness for s in others)]
        return Response(np.concatenate(forces), self.tangent(matrices), update.history)

    def tangent(self, matrices: Sequence[sp.csr_matrix]) -> sp.csr_matrix:
        """Derivative of the internal force from that of each body."""
        return matrices[0] if len(matrices) == 1 else sp.block_diag(matrices, format="csr")

    def gap(self, u: np.ndarray, approach: float) -> np.ndarray:
        """gap0 + sum of u_z - delta at the candidates."""
        return self.gap0 + u[self.normal].sum(axis=0) - approach

    def elimination(self, active: np.ndarray) -> tuple[sp.csr_matrix, np.ndarray]:
        """(T, d1) of changes T v + delta d1 that leave the gap of the active nodes as it is, for every v and delta.

        Eliminated is u_z of one body: u_z = delta (rigid counter-body), or minus u_z of the other one as well.
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

    def admissible(self, u: np.ndarray, active: np.ndarray, load: Load) -> tuple[np.ndarray, float]:
        """u with the prescribed displacements, and with the gap zero at the active nodes; and its approach."""
        moved = np.where(self.fixed, load.force * self.far_field, u)
        approach = float(self.gap(moved, 0.0)[active].mean()) if active.any() else 0.0
        moved[self.normal[self.slave, active]] -= self.gap(moved, approach)[active]
        return moved, approach

    def newton_step(
        self, u: np.ndarray, response: Response, active: np.ndarray, load: Load, kept: Kept
    ) -> tuple[np.ndarray, float]:
        """Displacements and approach that balance the forces linearised at u, with the given nodes in contact.

        T^T (f + K (u0 + T v + delta d1 - u)) = 0 and d1^T (the same bracket) = F: the internal force of the eliminated
        degrees of freedom is the multiplier, the force with which the contact presses on the body. Without contact the
        approach is that of first touch. Raises NotDefiniteError.
        """
        T, d1 = self.elimination(active)
        u0, approach = self.admissible(u, active, load)
        K, touches = response.tangent, active.any()
        force = response.force - load.force * self.prescribed + K @ (u0 - u)
        right = np.append(-(T.T @ force), load.force - d1 @ force if touches else 0.0)
        column = K @ d1
        border, corner = T.T @ column, float(d1 @ column) if touches else 1.0

        def apply(x: np.ndarray) -> np.ndarray:
            v, delta = x[:-1], x[-1]
            return np.append(T.T @ (K @ (T @ v)) + delta * border, border @ v + delta * corner)

        x = None
        # the first tangent of a step, at the end of the one before, is elastic: it stands for no later one
        if kept.setups > 1 and np.array_equal(kept.active, active):
            x = refined(apply, right, kept)
        if x is None:
            inverse = Bordered(T.T @ K @ T, border, corner)
            kept.keep(inverse, active)
            x = inverse(right)
        if not (np.isfinite(x).all() and right @ x >= 0.0):
            raise NotDefiniteError("the matrix is not positive definite")
        u = u0 + T @ x[:-1] + x[-1] * d1
        return u, approach + float(x[-1]) if touches else float(self.gap(u, 0.0).min())

    def reaction(self, response: Response) -> np.ndarray:
        """Force (n_candidates,) with which each candidate, if it is in contact, is pressed into the body."""
        return response.force[self.normal[self.slave]]

    def out_of_balance(self, response: Response, active: np.ndarray, load: Load) -> float:
        """Largest force on a free degree of freedom."""
        T = self.elimination(active)[0]
        return float(np.max(np.abs(T.T @ (response.force - load.force * self.prescribed))))


class Bordered:
    """Exact inverse of [[A, b], [b, c]]: A sparse, symmetric and positive definite, in an order of little fill-in.

    Raises NotDefiniteError.
    """

    def __init__(self, A: sp.csr_matrix, b: np.ndarray, c: float):
        try:
            options = {"SymmetricMode": True}
            self.factor = splu(A.tocsc(), permc_spec="NATURAL", diag_pivot_thresh=0.0, options=options)
        except RuntimeError as error:  # exactly singular
            raise NotDefiniteError(str(error)) from None
        self.column = self.factor.solve(b)
        self.complement = c - b @ self.column
        if not (self.complement > 0.0 and b @ self.column >= 0.0):
            raise NotDefiniteError("the matrix is not positive definite")

    def __call__(self, r: np.ndarray) -> np.ndarray:
        last = (r[-1] - self.column @ r[:-1]) / self.complement
        return np.append(self.factor.solve(r[:-1]) - last * self.column, last)


def refined(apply: Callable, right: np.ndarray, kept: Kept) -> np.ndarray | None:
    """Solution by conjugate gradients with the inverse that is kept; None if FEW iterations do not do."""
    inverse = Counted(kept.inverse)
    operator, approximate = (LinearOperator((right.size,) * 2, function) for function in (apply, inverse))
    x, info = cg(operator, right, rtol=0.0, atol=kept.target, M=approximate, maxiter=FEW)
    kept.linear += inverse.calls
    return x if info == 0 and np.isfinite(x).all() else None


def equilibrium(
    problem: Problem,
    load: Load | float,
    start: np.ndarray,
    u: np.ndarray | None = None,
    history: History | None = None,
) -> Equilibrium:
    """Contact under `load` (its force > 0) from the set `start` (bool, (n_candidates,)), displacements u (none), history.

    One loop for material and contact. It ends when the set stands still, the largest force on a free degree of freedom is
    at most EQUILIBRIUM * force, and no sign is wrong by more than SIGN; `converged` is false when it does not end:
    MAX_ITERATIONS, a set that keeps coming back, a residual that grows, a tangent that is not positive definite.
    """
    u = np.zeros(problem.size) if u is None else u
    load = load if isinstance(load, Load) else Load(load)
    if problem.anchored or not start.any():
        start = start | (np.arange(start.size) == 0)
    return _iterate(problem, load, load.force, ActiveSet(start, problem.anchored), u, history)


def without_contact(
    problem: Problem, load: Load, scale: float, u: np.ndarray, history: History | None
) -> Equilibrium:
    """Equilibrium under a prescribed pressure, or none. scale: the force by which the residual is measured."""
    return _iterate(problem, load, scale, Open(np.zeros(problem.gap0.size, dtype=bool)), u, history)


def _iterate(
    problem: Problem,
    load: Load,
    scale: float,
    contact: ActiveSet | Open,
    u: np.ndarray,
    history: History | None,
) -> Equilibrium:
    zeros, residuals, steady = np.zeros(problem.gap0.size), [], 0
    kept = Kept(NEGLIGIBLE * EQUILIBRIUM * scale)
    state = Equilibrium(u, 0.0, load, zeros, problem.gap0, contact.active, history, converged=False)
    response, definite = problem.respond(u, history), True
    for _ in range(MAX_ITERATIONS):
        active = contact.active
        try:
            u, approach = problem.newton_step(u, response, active, load, kept)
        except NotDefiniteError:
            definite = False
            break
        response = problem.respond(u, history)
        multipliers = np.where(active, problem.reaction(response), 0.0)
        gap = problem.gap(u, approach)
        residuals.append(problem.out_of_balance(response, active, load) / scale)
        if residuals[-1] > EQUILIBRIUM:
            contact.forget()  # the set comes back to other displacements: no ping-pong
        changed = contact.update(multipliers / scale, gap / (abs(approach) or 1.0))
        steady = 0 if changed else steady + 1
        settled, end = not changed and residuals[-1] <= EQUILIBRIUM, response.history
        state = Equilibrium(
            u, approach, load, multipliers, gap, active, end, tuple(residuals), steady, settled
        )
        if settled or contact.stuck or hopeless(residuals):
            break
    ending = "" if state.converged else ended(residuals, definite, contact.stuck)
    return replace(state, work=Work(len(residuals), kept.setups, kept.linear), ending=ending)


def ended(residuals: Sequence[float], definite: bool, stuck: bool) -> str:
    """Why an iteration ended without equilibrium, in words."""
    if not definite:
        return "Newton's method met a tangent that is not positive definite: the body carries no more there"
    if stuck:
        return "the set of nodes in contact stagnated: it keeps coming back"
    return unfinished("Newton's method", residuals, EQUILIBRIUM, stalled(residuals))


def hopeless(residuals: Sequence[float]) -> bool:
    """Whether the residuals, in the order of the iterations, have diverged or stalled."""
    return not residuals[-1] < DIVERGED or stalled(residuals)


def stalled(residuals: Sequence[float]) -> bool:
    """Whether the last residuals are all above the best before them."""
    before, recent = residuals[:-STALLED], residuals[-STALLED:]
    return bool(before) and min(recent) > max(min(before), EQUILIBRIUM)
