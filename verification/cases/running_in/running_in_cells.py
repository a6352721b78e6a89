# SPDX-License-Identifier: MIT
"""What the paper says of its five materials, with the printed inputs, on cells of 1 um and on those that give
the worn volume of most surfaces within a tenth (wear-converged): which verdicts the cells decide.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from sam.scene import Scene
from verification.cases.case import Context, Measured, SmallTable, number, with_grid, with_keys
from verification.cases.running_in.running_in import DeeperWhereItYields, solved
from verification.cases.running_in.running_in_runs import RunningInRun, off
from verification.cases.running_in.running_in_scenes import Effort, reduced, with_seed
from verification.cases.running_in.running_in_statements import (
    LAST,
    NAMES,
    STATEMENTS,
    JudgedStatement,
    judge,
)
from verification.cases.running_in.running_in_tables import CUBIC, statements_table

EFFORT = Effort(tuple(NAMES), (2,), cycles=LAST, steps=3, cells=32)
WINDOWS = {32: 5, 70: 11}
"""Cells along a side of 32 um -> in the window of smoothing, which is 5 um long: 12 and 26 cells in the
shortest wave of 12 um, where wear-converged asks for 24.
"""
Key = tuple[int, str, int]
"""Cells along a side, material, seed of its surface."""


@dataclass(frozen=True)
class Found:
    """What ran."""

    runs: Mapping[Key, RunningInRun]

    @cached_property
    def good(self) -> dict[Key, RunningInRun]:
        """Those that converged."""
        return {key: one for key, one in self.runs.items() if one.result.converged}

    @cached_property
    def judged(self) -> dict[str, list[JudgedStatement]]:
        """The statements on each size of cells, by its words."""
        return {
            words_of(cells): [judge(each, self.surfaces(cells)) for each in STATEMENTS] for cells in WINDOWS
        }

    def surfaces(self, cells: int) -> list[dict]:
        """Of each surface the materials that converged."""
        return [
            {case: one.history for (n, case, own), one in self.good.items() if (n, own) == (cells, seed)}
            for seed in EFFORT.seeds
        ]

    @property
    def changed(self) -> list[str]:
        """Statements whose verdict by the median is another one on finer cells."""
        pairs = zip(*self.judged.values(), strict=True)
        return [
            f"{one.statement.words}: {one.by_median}, then {other.by_median}"
            for one, other in pairs
            if one.by_median is not other.by_median
        ]


class RunningInCells(DeeperWhereItYields):
    """All materials on a quarter of the printed area, on both sizes of cells."""

    def ahead(self, context: Context) -> Iterator[Scene]:
        yield from reversed(scenes_of(context).values())

    def solve(self, context: Context) -> Found:
        return Found(
            {
                (cells, case, seed): solved(context, scene, f"{case}-surface-{seed}-cells-{cells}")
                for (cells, case, seed), scene in scenes_of(context).items()
            }
        )

    def measure(self, found: Found) -> dict[str, Measured]:
        sums = [off(one.scar.volume, one.history.volume[-1]) for one in found.good.values()]
        return {
            "missing": Measured(len(WINDOWS) * len(NAMES) * len(EFFORT.seeds) - len(found.good), 0),
            "volume": Measured(max(sums, default=float("nan"))),
        }

    def setup(self, found: Found) -> list[tuple[str, str]]:
        windows = "; ".join(f"{words_of(cells)}: {window}" for cells, window in WINDOWS.items())
        return [
            (
                "Runs",
                f"with the printed inputs, {EFFORT.cells} × {EFFORT.cells} µm, {LAST} cycles, "
                f"{EFFORT.steps} load steps",
            ),
            ("Surfaces", ", ".join(map(str, EFFORT.seeds))),
            ("Cells in the window of smoothing", windows),
        ]

    def tables(self, found: Found) -> Iterator[SmallTable]:
        yield statements_table(found.judged)
        yield volumes_table(found)

    def notes(self, found: Found) -> Iterator[str]:
        words = "; ".join(found.changed) or "none"
        yield f"Verdicts by the median that finer cells change: {words}."
        yield ("One surface of a quarter of the printed area: this shows what cells do, no probability.")


def scenes_of(context: Context) -> dict[Key, Scene]:
    """The scene of each run."""
    printed = {case: context.scene(f"running-in-{case}") for case in NAMES}
    return {
        (cells, case, seed): on_cells(reduced(with_seed(scene, seed), EFFORT), cells)
        for cells in WINDOWS
        for case, scene in printed.items()
        for seed in EFFORT.seeds
    }


def on_cells(scene: Scene, cells: int) -> Scene:
    """The same patch on so many cells a side, its scars smoothed over the same length."""
    scene = with_grid(scene, cells=(cells, cells))
    return with_keys(scene, "wear", smoothing_window=WINDOWS[cells])


def words_of(cells: int) -> str:
    """The size of cells for the reader."""
    return f"{EFFORT.cells / cells:.3g} µm"


def volumes_table(found: Found) -> SmallTable:
    """Volume and time of each material on each surface."""
    rows = []
    for case, name in NAMES.items():
        for seed in EFFORT.seeds:
            runs = [found.good.get((cells, case, seed)) for cells in WINDOWS]
            volumes = [np.nan if one is None else CUBIC * one.history.volume[-1] for one in runs]
            times = [np.nan if one is None else one.result.cost["cpu_s"] for one in runs]
            rows.append((name, f"{seed}", *(number(v, 4) for v in volumes), f"{times[1] / times[0]:.3g}"))
    return SmallTable(
        f"Volume worn in {LAST} cycles [µm³] and processor time of the finer cells over that of the coarser",
        ("material", "surface", *(words_of(cells) for cells in WINDOWS), "time"),
        rows,
    )


CASES = (RunningInCells("running-in-cells"),)
