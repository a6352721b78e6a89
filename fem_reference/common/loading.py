# SPDX-License-Identifier: MIT
"""The load schedule: equal force steps, halved when they do not converge; unloading; cycles.

The plastic history at the end of a step belongs to its Equilibrium, and the next step begins from an Equilibrium:
nothing is changed in place, so that a step that is discarded leaves no trace and none can count twice. A schedule is a list
of targets; `Progressed`, the steps so far and the targets to come, is all that later steps read.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from typing import Protocol

import numpy as np

from fem_reference.common.contact import EQUILIBRIUM, Equilibrium, Load
from fem_reference.common.hertz import Scales
from fem_reference.common.linear import NO_WORK, Work
from fem_reference.common.plasticity import History
from sam.scene import Loading
from sam.scene.residuals import Attempt
from sam.scene.result import Progress

MOST_CUTS = 6
"""A step is halved so many times at most."""
NO_LOAD = Load(0.0)
ELASTIC_UNLOADING = "elastic: unloading in one step"
ELASTIC_CYCLE = "elastic: equal to cycle 1"


class Model(Protocol):
    """What the schedule needs to know of a model. elastic: whether it has no history."""

    scales: Scales
    elastic: bool

    def virgin(self) -> Equilibrium: ...

    def load(self, load: Load, previous: Equilibrium, cut: bool = False) -> Equilibrium: ...


@dataclass(frozen=True)
class Sliding:
    """What a schedule does besides pressing: tangential over normal traction, and the places of a pass, in the model's units.

    alternating: the sign of the ratio changes each cycle, + in the first; places: (n, 2) at which the full load acts, one
    after the other, or only the one where it is put on and lifted.
    """

    coefficient: float = 0.0
    alternating: bool = False
    places: np.ndarray = field(default_factory=lambda: np.zeros((1, 2)))

    def ratio(self, cycle: int) -> float:
        """Tangential over normal traction in a cycle, counted from 1."""
        return -self.coefficient if self.alternating and cycle % 2 == 0 else self.coefficient

    @property
    def repeats(self) -> bool:
        """Whether every cycle has the same loads."""
        return self.coefficient == 0.0 or not self.alternating


AT_REST = Sliding()


@dataclass(frozen=True)
class Step:
    """A step of the schedule. work, attempts: all parts that it was cut into, also the discarded ones; cuts: halvings."""

    state: Equilibrium
    work: Work
    cuts: int = 0
    cycle: int = 1
    number: int = 1
    unloads: bool = False
    note: str = ""
    attempts: tuple[Attempt, ...] = ()

    @property
    def iterations(self) -> int:
        """Of Newton's method."""
        return self.work.newton


@dataclass(frozen=True)
class Target:
    """The end of a step of the schedule, as in `Step`.

    at_once: in one step if no point yields in it, otherwise in so many equal ones; 0: one step in any case. spent: work on
    a discarded attempt, which counts in this step.
    """

    load: Load
    cycle: int = 1
    number: int = 1
    unloads: bool = False
    at_once: int = 0
    spent: Work = NO_WORK


@dataclass(frozen=True)
class Progressed:
    """A schedule after some of its steps. start: the state before the first of them."""

    start: Equilibrium
    targets: list[Target]
    steps: list[Step] = field(default_factory=list)

    @property
    def state(self) -> Equilibrium:
        """The state now."""
        return self.steps[-1].state if self.steps else self.start

    @property
    def ended(self) -> bool:
        """Whether all targets are reached, or one was not."""
        return not self.targets or not self.state.converged

    @classmethod
    def from_tree(cls, tree: dict) -> Progressed:
        """From the tree of a checkpoint, see `sam.scene.checkpoint`."""
        steps = [
            Step(
                **step
                | {"state": _equilibrium(step["state"]), "work": Work(**step["work"])}
                | {"attempts": tuple(map(Attempt.from_tree, step["attempts"]))}
            )
            for step in tree["steps"]
        ]
        targets = [
            Target(**target | {"load": Load(**target["load"]), "spent": Work(**target["spent"])})
            for target in tree["targets"]
        ]
        return cls(_equilibrium(tree["start"]), targets, steps)


def _equilibrium(tree: dict) -> Equilibrium:
    history = tree["history"] and History(**tree["history"])
    load, work = Load(**tree["load"]), Work(**tree["work"])
    values = {"load": load, "history": history, "residuals": tuple(tree["residuals"]), "work": work}
    return Equilibrium(**tree | values)


Followed = Callable[[Progressed], None]


def run(
    model: Model,
    loading: Loading,
    progress: Progress | None = None,
    keep: Followed | None = None,
    begin: Progressed | None = None,
    sliding: Sliding = AT_REST,
) -> list[Step]:
    """The steps of all cycles, up to the first that does not converge; an elastic body repeats the first cycle if it can.

    progress: called as progress("contact", done, total) after each step towards the peak; keep: called after each step of a
    body that can yield, with the record so far; begin: such a record, to go on from there.
    """
    repeats = model.elastic and sliding.repeats
    if begin is None:
        begin = Progressed(model.virgin(), all_targets(model, loading, sliding))
    total = sum(not each.unloads for each in [*begin.steps, *begin.targets])

    def followed(now: Progressed) -> None:
        if progress is not None and not now.steps[-1].unloads:
            progress("contact", sum(not step.unloads for step in now.steps), total)
        if keep is not None and not model.elastic and now.state.converged:
            keep(now)

    steps = follow(model, begin, followed)
    return repeated(steps, loading.cycles) if repeats and steps[-1].state.converged else steps


def all_targets(model: Model, loading: Loading, sliding: Sliding = AT_REST) -> list[Target]:
    """The targets of all cycles that are not equal to the first."""
    cycles = 1 if model.elastic and sliding.repeats else loading.cycles
    return [target for cycle in range(1, cycles + 1) for target in of_cycle(model, loading, cycle, sliding)]


def of_cycle(model: Model, loading: Loading, cycle: int = 1, sliding: Sliding = AT_REST) -> list[Target]:
    """Equal steps to the peak, the pass if there is one, and back when the scene unloads, or to begin another cycle.

    An elastic body whose cycles are all equal needs no way back between them.
    """
    peak, steps, ratio = model.scales.peak_force, loading.steps, sliding.ratio(cycle)
    start, *others = sliding.places.tolist()
    loads = [Load(peak * k / steps, ratio, *start) for k in range(1, steps + 1)]
    loads += [Load(peak, ratio, *place) for place in others]
    up = [Target(load, cycle, number) for number, load in enumerate(loads, start=1)]
    lifted = replace(loads[-1], force=0.0)
    last = cycle == loading.cycles or (model.elastic and sliding.repeats)
    return up + [back(loading.unload_steps or steps, cycle, len(up) + 1, lifted)] * (
        loading.unload or not last
    )


def back(count: int, cycle: int = 1, number: int = 1, load: Load = NO_LOAD) -> Target:
    """Back to no force: in one step if no point yields in it, otherwise in `count` equal steps."""
    return Target(load, cycle, number, unloads=True, at_once=count)


def repeated(steps: list[Step], cycles: int) -> list[Step]:
    """The steps of an elastic body's first cycle, and those of the later ones, which are equal to it."""
    again = [
        replace(step, work=NO_WORK, attempts=(), note=_joined(step.note, ELASTIC_CYCLE)) for step in steps
    ]
    return steps + [replace(step, cycle=cycle) for cycle in range(2, cycles + 1) for step in again]


def _joined(*notes: str) -> str:
    return "; ".join(note for note in notes if note)


def one_cycle(model: Model, loading: Loading, state: Equilibrium) -> list[Step]:
    """The steps of one cycle from any state, up to the first that does not converge."""
    return follow(model, Progressed(state, of_cycle(model, loading)))


def climb(model: Model, forces: Sequence[float], state: Equilibrium) -> list[Step]:
    """Steps to these forces, one after the other, up to the first that does not converge."""
    return follow(
        model, Progressed(state, [Target(Load(force), 1, k) for k, force in enumerate(forces, start=1)])
    )


def descend(model: Model, count: int, peak: Equilibrium) -> list[Step]:
    """Steps back to no force, see `back`."""
    return follow(model, Progressed(peak, [back(count)]))


def follow(model: Model, now: Progressed, followed: Followed | None = None) -> list[Step]:
    """All steps, to the last target or the first step that does not converge. followed: called after each of them."""
    while not now.ended:
        before, now = now, onward(model, now)
        if followed is not None and len(now.steps) > len(before.steps):
            followed(now)
    return now.steps


def onward(model: Model, now: Progressed) -> Progressed:
    """One step further; or, where unloading at once would yield, the same with more targets."""
    target, *rest = now.targets
    if target.at_once:
        state = model.load(target.load, now.state)
        if not (state.converged and same_history(now.state, state)):
            return replace(now, targets=[*in_steps(target, now.state.force, state.work), *rest])
        step = Step(state, state.work, note=ELASTIC_UNLOADING, attempts=(attempt(state),))
    else:
        step = advance(model, target.load, now.state)
        step = replace(step, note=f"cut into {step.cuts + 1} steps" if step.cuts else "")
    step = replace(
        step,
        work=step.work + target.spent,
        cycle=target.cycle,
        number=target.number,
        unloads=target.unloads,
    )
    return replace(now, targets=rest, steps=[*now.steps, step])


def in_steps(target: Target, force: float, spent: Work) -> list[Target]:
    """Equal steps from `force` in place of the target that was to be reached at once, after the work `spent` on that."""
    count = target.at_once
    parts = [
        replace(
            target,
            load=replace(target.load, force=force * (count - k) / count),
            number=target.number + k - 1,
            at_once=0,
        )
        for k in range(1, count + 1)
    ]
    return [replace(parts[0], spent=spent), *parts[1:]]


def same_history(before: Equilibrium, after: Equilibrium) -> bool:
    """Whether nothing has yielded in between."""
    return before.history is None or np.array_equal(before.history.peeq, after.history.peeq)


def advance(model: Model, load: Load, start: Equilibrium, level: int = 0) -> Step:
    """One step to `load`; when it does not converge and the body can yield, in two halves, each of which may be halved."""
    state = model.load(load, start, cut=level > 0)
    tried = (attempt(state),)
    if state.converged or model.elastic or level == MOST_CUTS:
        return Step(state, state.work, attempts=tried)
    first = advance(model, load.halfway(start.load), start, level + 1)
    work, cuts, tried = state.work + first.work, 1 + first.cuts, tried + first.attempts
    if not first.state.converged:
        return Step(first.state, work, cuts, attempts=tried)
    second = advance(model, load, first.state, level + 1)
    return Step(second.state, work + second.work, cuts + second.cuts, attempts=tried + second.attempts)


def attempt(state: Equilibrium) -> Attempt:
    """The record of a step that was tried."""
    return Attempt(state.converged, state.residuals, EQUILIBRIUM)
