# SPDX-License-Identifier: MIT
"""Contact by a primal-dual active set with nodal multipliers, under a given force or approach.

Semi-smooth Newton method (Hueeber and Wohlmuth, Comput. Methods Appl. Mech. Engrg. 194 (2005) 3147): in
each iteration the gap of the active nodes is zero and the multiplier of the others is zero; then the set is
corrected by the signs of both. Bodies and their linear systems are a `Problem`; here is the iteration.
Everything is in the consistent units of the caller; no tolerance has a unit.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Protocol

import numpy as np
import scipy.sparse as sp

from fem_reference.common.arrays import Array, Bools
from fem_reference.common.linear import NO_WORK, Kept, Work
from fem_reference.common.plasticity import History, Material
from fem_reference.common.schedule import Load
from sam.scene.result import unfinished

EQUILIBRIUM = 1e-9
"""Largest residual force on a free degree of freedom, over the contact force; rounding leaves 1e-14."""
SIGN = 1e-10
"""Multipliers (over the force), gaps (over the approach) of the wrong sign: rounding."""
MAX_ITERATIONS = 60
"""Limit of the iteration; steps that converge take 1 to 12."""
DIVERGED = 1.0
"""A residual of the whole contact force on one degree of freedom does not come back."""
NEGLIGIBLE = 0.3
"""A linear solve needs no smaller residual than this share of EQUILIBRIUM."""
STALLED = 10
"""An iteration ends after so many residuals above its best; those that converge take 12 at most."""


class NotDefiniteError(ArithmeticError):
    """The tangent is not positive definite in floating-point numbers."""


@dataclass
class ActiveSet:
    """Nodes in contact; the first node, under the apex, always stays, unless `anchored` is false: then the
    last one does. pressed: whether there is contact at all, without which nothing changes.

    `update` makes the full primal-dual correction until a set comes back (ping-pong); from then on it
    corrects one node at a time, the one of the largest violation, and `stuck` is true when a set comes back
    even so.
    """

    active: Bools
    anchored: bool = True
    pressed: bool = True
    single: bool = False
    stuck: bool = False
    seen: set[bytes] = field(default_factory=set)

    def update(self, multipliers: Array, gaps: Array) -> bool:
        """Correct the set from multipliers / force and gaps / approach (each (n,)); True if it changed."""
        violation = np.where(self.active, -multipliers, -gaps)
        violation[0 if self.anchored else np.argmax(np.where(self.active, multipliers, -np.inf))] = 0.0
        wrong = violation > SIGN
        if not (self.pressed and wrong.any()):
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
class Equilibrium:
    """A solved load step.

    u: (size,) displacements of all bodies; approach: of the bodies, counted from infinity; load: where the
    approach is given with the force that was found; multipliers, gap, active: (n_candidates,) nodal forces,
    gaps and whether in contact, by the distance from the apex; history: plastic strain of the half-space at
    the end of the step, None if it is elastic; residuals: largest force on a free degree of freedom over the
    force, after each iteration; steady: how many of the last iterations left the nodes in contact as they
    were; converged: whether equilibrium was reached; work: counters; ending: why it was not, in words.
    """

    u: Array
    approach: float
    load: Load
    multipliers: Array
    gap: Array
    active: Bools
    history: History | None = None
    residuals: tuple[float, ...] = ()
    steady: int = 0
    converged: bool = True
    work: Work = NO_WORK
    ending: str = ""

    @property
    def force(self) -> float:
        """Normal force of the load."""
        return self.load.force

    @property
    def residual(self) -> float:
        """The last residual; zero where nothing was to do."""
        return self.residuals[-1] if self.residuals else 0.0

    @property
    def yielded(self) -> bool:
        """Whether any point has yielded up to now."""
        return self.history is not None and self.history.yielded


@dataclass(frozen=True)
class Response:
    """What bodies do at given displacements: internal force (size,), its derivative, history; start: history
    at the beginning of the step, where a search along the step needs it.
    """

    force: Array
    tangent: sp.csr_matrix
    history: History | None
    start: History | None = field(default=None, kw_only=True)


class Problem(Protocol):
    """Bodies in contact. gap0: (n_candidates,); displacements and forces: (size,)."""

    size: int
    gap0: Array
    anchored: bool
    material: Material | None

    def respond(self, u: Array, start: History | None) -> Response:
        """Return the internal force at u in a step that starts from `start`."""

    def newton_step(
        self, u: Array, response: Response, active: Bools, *, load: Load, kept: Kept
    ) -> tuple[Array, float]:
        """Return displacements and approach of the linearised problem. Raises NotDefiniteError."""

    def reaction(self, response: Response) -> Array:
        """Return the force of the counter-body on each candidate."""

    def gap(self, u: Array, approach: float) -> Array:
        """Return the gap of the candidates."""

    def out_of_balance(self, response: Response, active: Bools, load: Load) -> float:
        """Return the largest force on a free degree of freedom."""


def equilibrium(
    problem: Problem,
    load: Load | float,
    start: Bools,
    *,
    u: Array | None = None,
    history: History | None = None,
) -> Equilibrium:
    """Contact under `load` (its force > 0) from the set `start` (n_candidates,), displacements u (none) and
    a history.

    One loop for material and contact. It ends when the set stands still, the largest force on a free degree
    of freedom is at most EQUILIBRIUM * force, and no sign is wrong by more than SIGN; `converged` is false
    when it does not end: MAX_ITERATIONS, a set that keeps coming back, a residual that grows, a tangent
    that is not positive definite.
    """
    u = np.zeros(problem.size) if u is None else u
    load = load if isinstance(load, Load) else Load(load)
    if problem.anchored or not start.any():
        start = start | (np.arange(start.size) == problem.gap0.argmin())
    before = Equilibrium(u, 0.0, load, np.zeros(start.size), problem.gap0, start, history, converged=False)
    return _iterate(problem, before, load.force, ActiveSet(start, anchored=problem.anchored))


def without_contact(
    problem: Problem, load: Load, scale: float, *, u: Array, history: History | None
) -> Equilibrium:
    """Equilibrium under a prescribed pressure, or none. scale: the force that residuals are measured by."""
    none = np.zeros(problem.gap0.size, dtype=bool)
    before = Equilibrium(u, 0.0, load, np.zeros(none.size), problem.gap0, none, history, converged=False)
    return _iterate(problem, before, scale, ActiveSet(none, pressed=False))


def _iterate(problem: Problem, state: Equilibrium, scale: float, contact: ActiveSet) -> Equilibrium:
    """The semi-smooth Newton iteration from `state`, with the load and history of its beginning."""
    load, history, u = state.load, state.history, state.u
    residuals: list[float] = []
    steady, definite = 0, True
    kept = Kept(NEGLIGIBLE * EQUILIBRIUM * scale)
    response = problem.respond(u, history)
    for _ in range(MAX_ITERATIONS):
        active = contact.active
        try:
            u, approach, load = newton_step(problem, u, response, active, load=load, kept=kept)
        except NotDefiniteError:
            definite = False
            break
        response = problem.respond(u, history)
        scale = scale if load.approach is None else abs(load.force) or scale
        kept.target = NEGLIGIBLE * EQUILIBRIUM * scale
        multipliers = np.where(active, problem.reaction(response), 0.0)
        gap = problem.gap(u, approach)
        residuals.append(problem.out_of_balance(response, active, load) / scale)
        if residuals[-1] > EQUILIBRIUM:
            contact.forget()  # the set comes back to other displacements: no ping-pong
        changed = contact.update(multipliers / scale, gap / (abs(approach) or 1.0))
        steady = 0 if changed else steady + 1
        converged, end = not changed and residuals[-1] <= EQUILIBRIUM, response.history
        state = Equilibrium(
            u, approach, load, multipliers, gap, active, end, tuple(residuals), steady, converged
        )
        if converged or contact.stuck or not residuals[-1] < DIVERGED or stalled(residuals):
            break
    ending = "" if state.converged else ended(residuals, definite, contact.stuck)
    return replace(state, work=Work(len(residuals), kept.setups, kept.linear), ending=ending)


def newton_step(
    problem: Problem, u: Array, response: Response, active: Bools, *, load: Load, kept: Kept
) -> tuple[Array, float, Load]:
    """Displacements, approach and load of the linearised problem; to a given approach two
    solutions, which are linear in the force, are combined. Raises NotDefiniteError.
    """
    loaded, reached = problem.newton_step(u, response, active, load=load, kept=kept)
    if load.approach is None:
        return loaded, reached, load
    unloaded, least = problem.newton_step(u, response, active, load=load.found(0.0), kept=kept)
    share = (load.approach - least) / (reached - least)
    return unloaded + share * (loaded - unloaded), load.approach, load.found(share * load.force)


def ended(residuals: Sequence[float], definite: bool, stuck: bool) -> str:
    """Why an iteration ended without equilibrium, in words."""
    if not definite:
        return "Newton's method met a tangent that is not positive definite: the body carries no more there"
    if stuck:
        return "the set of nodes in contact stagnated: it keeps coming back"
    return unfinished("Newton's method", residuals, EQUILIBRIUM, stalled(residuals))


def stalled(residuals: Sequence[float]) -> bool:
    """Whether the last residuals are all above the best before them."""
    before, recent = residuals[:-STALLED], residuals[-STALLED:]
    return bool(before) and min(recent) > max(min(before), EQUILIBRIUM)
