# SPDX-License-Identifier: MIT
"""The load schedule of a scene: the loads that a model solves, one after the other. Solves nothing."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from fem_reference.common.arrays import Array
from fem_reference.common.linear import NO_WORK, Work
from sam.scene import Loading, Strokes

HERTZ_RISE = 1.5
"""Power of the approach with which the force of an elastic contact grows: Johnson 1985, Eq. (4.23)."""


@dataclass(frozen=True)
class Load:
    """What acts on the body. ratio: tangential over normal traction, along x; x, y: place of a prescribed
    pressure, or of the apex of a counter-body that moves.

    approach: that of the bodies, counted from infinity, if it is given in place of the force, which is then
    an estimate until the contact is solved.
    """

    force: float
    ratio: float = 0.0
    x: float = 0.0
    y: float = 0.0
    approach: float | None = None

    def found(self, force: float) -> Load:
        """The load with another force."""
        return replace(self, force=force)

    def part(self, k: int, count: int) -> Load:
        """The load after k of so many equal steps to it; the force of a given approach grows as in Hertz."""
        if self.approach is None:
            return replace(self, force=self.force * k / count)
        return replace(self, force=self.force * (k / count) ** HERTZ_RISE, approach=self.approach * k / count)

    def halfway(self, start: Load, approach: float) -> Load:
        """The load between `start`, which has this approach, and this one.

        Ratio and place change at once where there is no force, the place also under force.
        """
        half = None if self.approach is None else 0.5 * (approach + self.approach)
        if start.force == 0.0:
            return replace(self.part(1, 2), approach=half)
        force, x, y = 0.5 * (start.force + self.force), 0.5 * (start.x + self.x), 0.5 * (start.y + self.y)
        return Load(force, self.ratio, x, y, half)


NO_LOAD = Load(0.0)


@dataclass(frozen=True)
class Sliding:
    """Friction and path of a load, in the model's units.

    strokes: the passes, one in each cycle; places: (n, 2) at which the full load acts on its way forth, one
    after the other, or only the one where it is put on and taken off.
    """

    coefficient: float
    strokes: Strokes
    places: Array = field(default_factory=lambda: np.zeros((1, 2)))

    def ratio(self, cycle: int) -> float:
        """Tangential over normal traction in a cycle, counted from 1."""
        return self.strokes.of_cycle(cycle).sign * self.coefficient

    def way(self, cycle: int) -> Array:
        """(n, 2) places in a cycle, in their order."""
        return self.places[::-1] if self.strokes.goes_back(cycle) else self.places

    @property
    def moves(self) -> bool:
        """Whether a counter-body travels."""
        return self.strokes.path is not None and self.strokes.with_motion

    @property
    def repeats(self) -> bool:
        """Whether every cycle has the same loads."""
        return self.ratio(1) == self.ratio(2) and not self.strokes.goes_back(2)


@dataclass(frozen=True)
class Target:
    """The end of a step of the schedule.

    unloads: the step takes the load off; steps_if_yielding: single-step elastic unloading is tried first,
    and replaced by so many equal steps if a point yields in it; 0: one step in any case. spent: work on a
    discarded attempt, which counts in this step.
    """

    load: Load
    cycle: int = 1
    number: int = 1
    unloads: bool = False
    steps_if_yielding: int = 0
    spent: Work = NO_WORK


@dataclass(frozen=True)
class Schedule:
    """The targets of all cycles that are solved. repeats: later cycles equal the first."""

    targets: tuple[Target, ...]
    cycles: int = 1
    repeats: bool = False

    @property
    def loading_steps(self) -> int:
        """Number of steps that do not take the load off, without those of repeated cycles."""
        return sum(not target.unloads for target in self.targets)

    def with_forces(self, forces: Mapping[tuple[int, int], float]) -> Schedule:
        """The same with forces in place of approaches; forces: solved ones by cycle, number."""
        targets = [
            target
            if target.load.approach is None
            else replace(
                target, load=replace(target.load, force=forces[target.cycle, target.number], approach=None)
            )
            for target in self.targets
        ]
        return replace(self, targets=tuple(targets))


def schedule_of(
    loading: Loading, peak_force: float, *, sliding: Sliding, elastic: bool = False, unit: float = 1.0
) -> Schedule:
    """The schedule of a scene's loading; unit: of displacement in m, of the model."""
    repeats = elastic and sliding.repeats
    approach = None if loading.approach is None else loading.approach / unit
    strokes = replace(sliding.strokes, cycles=1 if repeats else loading.cycles)
    targets: list[Target] = []
    for cycle in range(1, strokes.cycles + 1):
        stroke, peak = strokes.of_cycle(cycle), Load(peak_force, sliding.ratio(cycle), approach=approach)
        steps = loading.steps if stroke.pressed else 0  # none where the load is on
        start, *others = (replace(peak, x=x, y=y) for x, y in sliding.way(cycle).tolist())
        loads = [start.part(k, steps) for k in range(1, steps + 1)] + others
        targets += [Target(load, cycle, number) for number, load in enumerate(loads, start=1)]
        if stroke.unloads:
            targets.append(unloading(loading.unload_steps or loading.steps, targets[-1]))
    return Schedule(tuple(targets), loading.cycles, repeats)


def unloading(count: int, last: Target) -> Target:
    """The way back from the target `last`: one elastic step, or `count` if a point yields."""
    load = replace(last.load, force=0.0, approach=None)
    return Target(load, last.cycle, last.number + 1, unloads=True, steps_if_yielding=count)
