# SPDX-License-Identifier: MIT
"""What the paper says of its five materials, with the printed inputs, on cells of 1 um and on those that give
the worn volume of most surfaces within a tenth (wear-converged): which verdicts the cells decide.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from sam.scene import Scene
from verification.cases.case import Context, Measured, SmallTable, number, with_grid, with_keys
from verification.cases.running_in.scenes import LAST, NAMES, Effort, printed_scenes, with_seed
from verification.cases.running_in.study import CUBIC, Judged, Run, Study, good, judged, statements_table

EFFORT = Effort(LAST, steps=3, cells=32, seeds=(2,))
WINDOWS = {32: 5, 70: 11}
"""Cells along a side of 32 um -> in the window of smoothing, which is 5 um long: 12 and 26 cells in the
shortest wave of 12 um, where wear-converged asks for 24.
"""
SIZES = {cells: f"{EFFORT.cells / cells:.3g} µm" for cells in WINDOWS}
Found = Mapping[tuple[int, str, int], Run]
"""Cells along a side, material and seed of its surface -> what ran."""


class RunningInCells(Study):
    """All materials on a quarter of the printed area, on both sizes of cells."""

    def scenes(self, context: Context) -> dict[Any, Scene]:
        return {
            (cells, case, seed): with_keys(
                with_grid(with_seed(scene, seed), cells=(cells, cells)), "wear", smoothing_window=window
            )
            for cells, window in WINDOWS.items()
            for case, scene in printed_scenes(context, EFFORT).items()
            for seed in EFFORT.seeds
        }

    def label(self, key: tuple[int, str, int]) -> str:
        cells, case, seed = key
        return f"{case}-surface-{seed}-cells-{cells}"

    def ahead(self, context: Context) -> Iterator[Scene]:
        yield from reversed(self.scenes(context).values())

    def solve(self, context: Context) -> Found:
        return self.runs(context)

    def measure(self, found: Found) -> dict[str, Measured]:
        whole = good(found)
        return {
            "missing": Measured(len(WINDOWS) * len(NAMES) * len(EFFORT.seeds) - len(whole), 0),
            "volume": Measured(max((one.off for one in whole.values()), default=np.nan)),
        }

    def setup(self, found: Found) -> Iterator[tuple[str, str]]:
        each = f"{LAST} cycles, {EFFORT.steps} load steps"
        yield "Runs", f"with the printed inputs, {EFFORT.cells} × {EFFORT.cells} µm, {each}"
        yield "Surfaces", ", ".join(map(str, EFFORT.seeds))
        windows = "; ".join(f"{SIZES[cells]}: {window}" for cells, window in WINDOWS.items())
        yield "Cells in the window of smoothing", windows

    def data(self, found: Found) -> dict[str, Any]:
        return {"statements": {size: [one.data for one in each] for size, each in on_cells(found).items()}}

    def tables(self, found: Found) -> Iterator[SmallTable]:
        yield statements_table(on_cells(found))
        rows, whole = [], good(found)
        for case, seed in ((case, seed) for case in NAMES for seed in EFFORT.seeds):
            runs = [whole.get((cells, case, seed)) for cells in WINDOWS]
            volumes = [CUBIC * one.history.volume[-1] if one else np.nan for one in runs]
            first, last = (one.result.cost["cpu_s"] if one else np.nan for one in runs)
            rows.append((NAMES[case], f"{seed}", *(number(v, 4) for v in volumes), f"{last / first:.3g}"))
        words = "processor time of the finer cells over that of the coarser"
        yield SmallTable(
            f"Volume worn in {LAST} cycles [µm³] and {words}",
            ("material", "surface", *SIZES.values(), "time"),
            rows,
        )

    def notes(self, found: Found) -> Iterator[str]:
        changed = [
            f"{one.statement.words}: {one.by_median}, then {other.by_median}"
            for one, other in zip(*on_cells(found).values(), strict=True)
            if one.by_median is not other.by_median
        ]
        yield f"Verdicts by the median that finer cells change: {'; '.join(changed) or 'none'}."
        yield "One surface of a quarter of the printed area: this shows what cells do, no probability."


def on_cells(found: Found) -> dict[str, list[Judged]]:
    """Size of cells for the reader -> the statements."""
    runs = good(found).items()
    return {
        size: judged(
            [
                {case: one.history for (n, case, own), one in runs if (n, own) == (cells, seed)}
                for seed in EFFORT.seeds
            ]
        )
        for cells, size in SIZES.items()
    }


CASES = (RunningInCells("running-in-cells"),)
