# SPDX-License-Identifier: MIT
"""The runs of the running-in case: of one reading and of both, what they are judged by, and their gates."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from sam.scene import Result, Scene, Table
from verification.cases.case import Measured
from verification.cases.running_in.running_in_scenes import LITERATURE_B, Effort, Reading, with_constant
from verification.cases.running_in.running_in_statements import (
    LAST,
    NAMES,
    STATEMENTS,
    JudgedStatement,
    judge,
)
from verification.cases.running_in.running_in_tables import held_of, iterations_of
from verification.compare.running_in_measures import History, Limits, Scar

SHOWN = 2  # the seed of the scenes
Key = tuple[str, int]
"""Name of a case and seed of its surface."""


@dataclass(frozen=True)
class RunningInRun:
    """A scene and its result."""

    scene: Scene
    result: Result

    @property
    def history(self) -> History:
        """The run over its cycles."""
        return History.of(self.result.tables)

    @property
    def scar(self) -> Scar:
        """The surface of the last cycle."""
        return Scar.of(self.result.tables)

    @property
    def friction(self) -> tuple[float, float]:
        """The low and the high coefficient."""
        return self.scene.friction.low, self.scene.friction.high

    @property
    def renewed(self) -> bool:
        """Whether each cycle meets another counter-surface."""
        surface = self.scene.counterbody.surface
        return surface is not None and surface.renewed

    def of_cycles(self, column: str) -> np.ndarray:
        """A column of cycles.csv."""
        return np.asarray(self.result.tables["cycles"][column], dtype=float)


@dataclass(frozen=True)
class Runs:
    """The runs of one reading. bases: case -> its scene on the surface of the file; found: what ran on each
    surface.
    """

    reading: Reading
    effort: Effort
    bases: Mapping[str, Scene]
    found: Mapping[Key, RunningInRun]

    @cached_property
    def limits(self) -> dict[str, tuple[Limits, Limits]]:
        """Case -> limits with both constants B."""
        return {case: limits_of(scene) for case, scene in self.bases.items()}

    @cached_property
    def good(self) -> dict[Key, RunningInRun]:
        """Those that converged."""
        return {key: one for key, one in self.found.items() if one.result.converged}

    @cached_property
    def histories(self) -> dict[Key, History]:
        """The runs that converged, over their cycles."""
        return {key: one.history for key, one in self.good.items()}

    @cached_property
    def shown(self) -> list[Key]:
        """The case and the surface of each case that is drawn."""
        cases = dict.fromkeys(case for case, _ in self.good)
        return [(case, main_seed([own for name, own in self.good if name == case])) for case in cases]

    @cached_property
    def judged(self) -> list[JudgedStatement]:
        """The statements of the paper; none of a run with fewer cycles."""
        surfaces = by_surface(self.good, self.effort.seeds)
        return [judge(each, surfaces) for each in STATEMENTS] if self.effort.cycles >= LAST else []

    @cached_property
    def held(self) -> dict[str, list[tuple[int, int]]]:
        """Case -> see `held_of`, of each surface."""
        return {
            case: [held_of(one.scar, own, one.friction) for one in self.of_case(case)]
            for case, (own, _) in self.limits.items()
        }

    @property
    def cycles_tables(self) -> dict[str, list[Table]]:
        """Case -> the tables of cycles of its runs."""
        return {case: [one.result.tables["cycles"] for one in self.of_case(case)] for case in self.bases}

    def of_case(self, case: str) -> list[RunningInRun]:
        """The runs of a case that converged."""
        return [one for (name, _), one in self.good.items() if name == case]


@dataclass(frozen=True)
class Readings:
    """The runs of both readings, and on one surface those with other assumptions, by name."""

    runs: Sequence[Runs]
    varied: Mapping[str, RunningInRun]

    @property
    def cases(self) -> list[str]:
        """Those with a run that converged, in the order of the paper."""
        return [case for case in NAMES if any(runs.of_case(case) for runs in self.runs)]

    @property
    def all(self) -> list[RunningInRun]:
        """Every run there is."""
        return [one for runs in self.runs for one in runs.found.values()] + list(self.varied.values())

    @property
    def named(self) -> dict[str, RunningInRun]:
        """Every run by its name for the reader."""
        named = {
            f"{NAMES[case]}, surface {seed}, {runs.reading.short}": one
            for runs in self.runs
            for (case, seed), one in runs.found.items()
        }
        return named | dict(self.varied)

    @property
    def lost(self) -> dict[str, RunningInRun]:
        """The runs that did not converge."""
        return {name: one for name, one in self.named.items() if not one.result.converged}

    @property
    def deepened(self) -> dict[str, float]:
        """Depth of the last layer, in m, of the runs that have more layers than their scene."""
        return {
            f"{NAMES[case]}, surface {seed}, {runs.reading.short}": one.scene.grid.depths[-1]
            for runs in self.runs
            for (case, seed), one in runs.found.items()
            if one.scene.grid.depths != runs.bases[case].grid.depths
        }

    @property
    def on_one_surface(self) -> dict[str, tuple[Limits, History]]:
        """The runs with the printed inputs on the surface of the scenes, and what is varied there; those that
        converged.
        """
        printed = self.runs[0]
        own = {f"{NAMES[case]} as given": printed.found[case, SHOWN] for case in printed.bases}
        runs = own | dict(self.varied)
        return {
            name: (limits_of(one.scene)[0], one.history) for name, one in runs.items() if one.result.converged
        }

    @property
    def groups(self) -> dict[str, list[Result]]:
        """The results of each case in each reading, and of what is varied."""
        found = {
            f"{NAMES[case]}, {runs.reading.short}": [
                one.result for (name, _), one in runs.found.items() if name == case
            ]
            for case in NAMES
            for runs in self.runs
            if case in runs.bases
        }
        return found | (
            {"other assumptions": [one.result for one in self.varied.values()]} if self.varied else {}
        )


def by_surface(found: Mapping[Key, RunningInRun], seeds: Sequence[int]) -> list[dict[str, History]]:
    """For each surface the cases that there are."""
    return [{case: one.history for (case, own), one in found.items() if own == seed} for seed in seeds]


def limits_of(scene: Scene) -> tuple[Limits, Limits]:
    """With the scene's own constant B, and with that of the literature."""
    return Limits.of(scene), Limits.of(with_constant(scene, LITERATURE_B))


def main_seed(seeds: Sequence[int]) -> int:
    """The surface that is drawn: that of the scenes, or the first there is."""
    return SHOWN if SHOWN in seeds else seeds[0]


def gates(runs: Sequence[RunningInRun]) -> dict[str, Measured]:
    """Worst of all runs. Sums are over surface.csv of the last cycle, against cycles.csv."""
    whole = [one for one in runs if one.result.converged]
    sums = {
        "volume": lambda one: off(one.scar.volume, one.history.volume[-1]),
        "friction-sum": lambda one: abs(one.scar.coefficient(*one.friction) - one.history.friction[-1]),
        "protected": lambda one: abs(one.scar.protected_fraction(*one.friction) - one.history.protected[-1]),
        "load": lambda one: off(one.scar.force, one.scene.loading.force),
        "iterations": later_over_early,
        "friction-range": lambda one: outside(one.history.friction, *one.friction),
    }
    counts = {
        "cycles": missing_cycles,
        "falls": lambda one: int((np.diff(one.history.volume, prepend=0.0) < 0.0).sum()),
        "added": lambda one: int((one.scar.worn < 0.0).sum()),
        "repeats": restless_cycles,
    }
    values = {name: Measured(max(map(of, whole), default=float("nan"))) for name, of in sums.items()}
    values |= {name: Measured(sum(map(of, whole)), 0) for name, of in counts.items()}
    return values | {"unconverged": Measured(len(runs) - len(whole), 0)}


def off(value: float, expected: float) -> float:
    """Relative difference, 0 where both are 0."""
    return abs(value - expected) / max(abs(expected), abs(value)) if value != expected else 0.0


def later_over_early(one: RunningInRun) -> float:
    """Plastic iterations, each with an application of the operator of residual stress: mean of later cycles
    over the first, where each meets the same counter-surface.
    """
    if one.renewed:
        return 0.0
    early, later = iterations_of(one.result)
    return float(np.mean(later) / np.mean(early))


def outside(values: np.ndarray, low: float, high: float) -> float:
    """How far values lie out of a range, NaN where one is none."""
    return float(np.max(np.maximum(np.maximum(low - values, values - high), 0.0)))


def missing_cycles(one: RunningInRun) -> int:
    """Cycles without a row, rows out of order, and numbers that are missing in them."""
    wanted = np.arange(1, one.scene.loading.cycles + 1)
    table = one.result.tables["cycles"]
    cycle = np.asarray(table["cycle"], dtype=float)
    if not np.array_equal(cycle, wanted):
        return max(1, abs(wanted.size - cycle.size))
    return sum(int(np.isnan(np.asarray(column, dtype=float)).sum()) for column in table.values())


def restless_cycles(one: RunningInRun) -> int:
    """Cycles that strain or wear the body after one that did neither, where each meets the same
    counter-surface.
    """
    if one.renewed:
        return 0
    busy = (one.of_cycles("new_strain_max") != 0.0) | (one.of_cycles("wear_of_cycle_m3") != 0.0)
    return int((busy & (np.cumsum(~busy) > 0)).sum())
