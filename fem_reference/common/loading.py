# SPDX-License-Identifier: MIT
"""The load steps of a model: one equilibrium after the other, halved when they do not converge.

The plastic history at the end of a step belongs to its Equilibrium, and the next step begins from an
Equilibrium: nothing is changed in place, so that a step that is discarded leaves no trace and none can
count twice. `Progressed`, the steps so far and the targets to come, is all that later steps read.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from fem_reference.common.contact import EQUILIBRIUM, Equilibrium
from fem_reference.common.linear import NO_WORK, Work
from fem_reference.common.model import ContactModel
from fem_reference.common.refusals import MOST_CUTS
from fem_reference.common.schedule import Load, Schedule, Target
from sam.scene.result import Attempt, Progress

ELASTIC_UNLOADING = "elastic: unloading in one step"
ELASTIC_CYCLE = "elastic: equal to cycle 1"


@dataclass(frozen=True)
class Step:
    """A step of the schedule that was solved.

    state: the equilibrium at its end, or the last iterate of the part that did not converge; work: counters
    of all its parts, also the discarded ones; cuts: how often a part of it was halved; cycle, number: cycle
    and place in it, from 1; unloads: it takes the load off; note: what was done to it, in words; attempts:
    residuals of all its parts; dissipated: energy in J, where that is asked for; peeq_max: largest
    accumulated plastic strain, of a step whose state is `forgotten`, None of others.
    """

    state: Equilibrium
    work: Work
    cuts: int = 0
    cycle: int = 1
    number: int = 1
    unloads: bool = False
    note: str = ""
    attempts: tuple[Attempt, ...] = ()
    dissipated: float = 0.0
    peeq_max: float | None = None

    @property
    def iterations(self) -> int:
        """Iterations of Newton's method."""
        return self.work.newton


@dataclass(frozen=True)
class Progressed:
    """A schedule after some of its steps. start: the state before the first of them."""

    start: Equilibrium
    targets: Sequence[Target]
    steps: list[Step] = field(default_factory=list)

    @property
    def state(self) -> Equilibrium:
        """The state now."""
        return self.steps[-1].state if self.steps else self.start

    @property
    def ended(self) -> bool:
        """Whether all targets are reached, or one was not."""
        return not self.targets or not self.state.converged


Followed = Callable[[Progressed], None]
Strained = Callable[[Equilibrium], float]
"""Largest accumulated plastic strain of a state."""


def run(
    model: ContactModel,
    schedule: Schedule,
    *,
    progress: Progress | None = None,
    keep: Followed | None = None,
    begin: Progressed | None = None,
    strained: Strained | None = None,
) -> list[Step]:
    """The steps of all cycles, up to the first that does not converge; repeated cycles are copies of the
    first.

    progress: called as progress("contact", done, total) after each step towards the peak; keep: called
    after each step of a body that can yield, with the record so far; begin: such a record, to go on from
    there; strained: of the states that nothing reads any more it is all that is kept, see `forgotten`; None:
    all are kept.
    """
    if begin is None:
        begin = Progressed(model.virgin(), schedule.targets)
    total = sum(not step.unloads for step in begin.steps)
    total += sum(not target.unloads for target in begin.targets)

    def followed(record: Progressed) -> None:
        if progress is not None and not record.steps[-1].unloads:
            progress("contact", sum(not step.unloads for step in record.steps), total)
        if keep is not None and not model.elastic and record.state.converged:
            keep(record)

    steps = follow(model, begin, followed, strained)
    return repeated(steps, schedule.cycles) if schedule.repeats and steps[-1].state.converged else steps


def repeated(steps: list[Step], cycles: int) -> list[Step]:
    """The steps of an elastic body's first cycle, and those of the later ones, which are equal to it."""
    again = [
        replace(step, work=NO_WORK, attempts=(), note="; ".join(filter(None, (step.note, ELASTIC_CYCLE))))
        for step in steps
    ]
    return steps + [replace(step, cycle=cycle) for cycle in range(2, cycles + 1) for step in again]


def climb(model: ContactModel, forces: Sequence[float], state: Equilibrium) -> list[Step]:
    """Steps to these forces, one after the other, up to the first that does not converge."""
    targets = [Target(Load(force), 1, k) for k, force in enumerate(forces, start=1)]
    return follow(model, Progressed(state, targets))


def follow(
    model: ContactModel,
    record: Progressed,
    followed: Followed | None = None,
    strained: Strained | None = None,
) -> list[Step]:
    """All steps, to the last target or the first that does not converge; parameters as of `run`."""
    while not record.ended:
        before, record = record, onward(model, record)
        if strained is not None and len(record.steps) > 1:
            *earlier, last, new = record.steps
            if model.plan.forgets(last.cycle) and last.cycle == new.cycle and new.state.converged:
                last = last if new.unloads else forgotten(last, strained)
            record = replace(record, steps=[*earlier, last, new])
        if followed is not None and len(record.steps) > len(before.steps):
            followed(record)
    return record.steps


def forgotten(step: Step, strained: Strained) -> Step:
    """The step with what its row of the history needs: forces, gaps and the largest strain."""
    if step.state.history is None:
        return step
    state = replace(step.state, u=np.empty(0), history=None)
    return replace(step, state=state, peeq_max=strained(step.state))


def onward(model: ContactModel, record: Progressed) -> Progressed:
    """One step further; or, where single-step elastic unloading would yield, the same with more targets."""
    target, *rest = record.targets
    if target.steps_if_yielding:
        state = model.load(target.load, record.state)
        before, after = record.state.history, state.history
        still = before is None or after is None or np.array_equal(before.peeq, after.peeq)
        if not (state.converged and still):
            return replace(record, targets=[*divided(target, record.state.force, state.work), *rest])
        step = Step(state, state.work, note=ELASTIC_UNLOADING, attempts=(attempt(state),))
    else:
        step = advance(model, target.load, record.state)
        step = replace(step, note=f"cut into {step.cuts + 1} steps" if step.cuts else "")
    step = replace(
        step, work=step.work + target.spent, cycle=target.cycle, number=target.number, unloads=target.unloads
    )
    return replace(record, targets=rest, steps=[*record.steps, step])


def divided(target: Target, force: float, spent: Work) -> list[Target]:
    """Equal steps from `force` in place of single-step elastic unloading, after the work `spent` on that."""
    count = target.steps_if_yielding
    parts = [
        replace(
            target,
            load=replace(target.load, force=force * (count - k) / count),
            number=target.number + k - 1,
            steps_if_yielding=0,
        )
        for k in range(1, count + 1)
    ]
    return [replace(parts[0], spent=spent), *parts[1:]]


def advance(model: ContactModel, load: Load, start: Equilibrium, level: int = 0) -> Step:
    """One step to `load`; when it does not converge and the body can yield, in two halves."""
    state = model.load(load, start, halved=level > 0)
    tried: tuple[Attempt, ...] = (attempt(state),)
    if state.converged or model.elastic or level == MOST_CUTS:
        return Step(state, state.work, attempts=tried, dissipated=model.dissipated(start, state))
    first = advance(model, load.halfway(start.load, start.approach), start, level + 1)
    work, cuts, tried = state.work + first.work, 1 + first.cuts, tried + first.attempts
    if not first.state.converged:
        return Step(first.state, work, cuts, attempts=tried)
    second = advance(model, load, first.state, level + 1)
    work, cuts, tried = work + second.work, cuts + second.cuts, tried + second.attempts
    spent = first.dissipated + second.dissipated
    return Step(second.state, work, cuts, attempts=tried, dissipated=spent)


def attempt(state: Equilibrium) -> Attempt:
    """The record of a step that was tried."""
    return Attempt(state.converged, state.residuals, EQUILIBRIUM)
