# SPDX-License-Identifier: MIT
"""The load schedule: equal force steps, halved when they do not converge; unloading; cycles.

The plastic history at the end of a step belongs to its Equilibrium, and the next step begins from an Equilibrium:
nothing is changed in place, so that a step that is discarded leaves no trace and none can count twice.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from fem_reference.contact import Equilibrium
from fem_reference.model import Model, load, virgin
from sam.scene.result import Progress
from sam.scene.schema import Loading

MOST_CUTS = 6
"""A step is halved so many times at most."""
ELASTIC_UNLOADING = "elastic: unloading in one step"
ELASTIC_CYCLE = "elastic: equal to cycle 1"


@dataclass(frozen=True)
class Step:
    """A step of the schedule. iterations: of all parts that it was cut into, also the discarded ones; cuts: halvings."""

    state: Equilibrium
    iterations: int
    cuts: int = 0
    cycle: int = 1
    number: int = 1
    unloads: bool = False
    note: str = ""


def run(model: Model, loading: Loading, progress: Progress | None = None) -> list[Step]:
    """The steps of all cycles, up to the first that does not converge; an elastic body repeats the first cycle.

    progress: called as progress("contact", done, total) after each step towards the peak.
    """
    steps, new, state = [], [], virgin(model)
    total = loading.steps * (1 if model.elastic else loading.cycles)
    for cycle in range(1, loading.cycles + 1):
        if model.elastic and cycle > 1:
            repeats = [_joined(step.note, ELASTIC_CYCLE) if cycle == 2 else step.note for step in new]
            new = [replace(step, iterations=0, note=note) for step, note in zip(new, repeats, strict=True)]
        else:
            done = loading.steps * (cycle - 1)
            new = one_cycle(model, loading, state, progress and (lambda k, d=done: progress("contact", d + k, total)))
        steps += [replace(step, cycle=cycle, number=k) for k, step in enumerate(new, start=1)]
        state = steps[-1].state
        if not state.converged:
            break
    return steps


def one_cycle(
    model: Model, loading: Loading, state: Equilibrium, report: Callable[[int], None] | None = None
) -> list[Step]:
    """Equal steps to the peak, and back when the scene unloads. report: called as report(k) after the k-th step up."""
    peak = model.scales.peak_force
    steps = climb(model, [peak * k / loading.steps for k in range(1, loading.steps + 1)], state, report)
    if loading.unload and steps[-1].state.converged:
        steps += descend(model, loading.unload_steps or loading.steps, steps[-1].state)
    return steps


def _joined(*notes: str) -> str:
    return "; ".join(note for note in notes if note)


def climb(
    model: Model, forces: Sequence[float], state: Equilibrium, report: Callable[[int], None] | None = None
) -> list[Step]:
    """Steps to these forces, one after the other, up to the first that does not converge."""
    steps: list[Step] = []
    for k, force in enumerate(forces, start=1):
        steps.append(advance(model, force, state))
        state = steps[-1].state
        if report is not None:
            report(k)
        if not state.converged:
            break
    return steps


def descend(model: Model, count: int, peak: Equilibrium) -> list[Step]:
    """Back to no force: in one step if no point yields in it, otherwise in `count` equal steps."""
    state = load(model, 0.0, peak)
    if state.converged and same_history(peak, state):
        return [Step(state, state.iterations, unloads=True, note=ELASTIC_UNLOADING)]
    forces = [peak.force * (count - k) / count for k in range(1, count + 1)]
    steps = [replace(step, unloads=True) for step in climb(model, forces, peak)]
    return [replace(steps[0], iterations=steps[0].iterations + state.iterations), *steps[1:]]


def same_history(before: Equilibrium, after: Equilibrium) -> bool:
    """Whether nothing has yielded in between."""
    return before.history is None or np.array_equal(before.history.peeq, after.history.peeq)


def advance(model: Model, force: float, start: Equilibrium, level: int = 0) -> Step:
    """One step to `force`; when it does not converge and the body can yield, in two halves, each of which may be halved."""
    state = load(model, force, start)
    if state.converged or model.elastic or level == MOST_CUTS:
        return Step(state, state.iterations)
    first = advance(model, 0.5 * (start.force + force), start, level + 1)
    iterations, cuts = state.iterations + first.iterations, 1 + first.cuts
    if not first.state.converged:
        return Step(first.state, iterations, cuts)
    second = advance(model, force, first.state, level + 1)
    return Step(second.state, iterations + second.iterations, cuts + second.cuts)
