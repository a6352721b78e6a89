# SPDX-License-Identifier: MIT
"""Worn volume on finer cells, layers and load steps, each alone, with the surface shifted against the cells.
The window of smoothing is a length; sizes of cells are those of which an odd number makes it up, so that it
is the same on all grids to the bit.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import asdict, dataclass
from functools import partial
from typing import Any

import numpy as np

from sam.scene import Grid, HeightMap, Result, Scene, Surface
from sam.scene.surface import heights, mean_deviation, with_relief
from verification.cases.case import SAM, Context, DataFrame, Plot, with_keys, with_loading
from verification.cases.running_in.study import CUBIC, LITERATURE_B, NAN, with_plasticity
from verification.compare.running_in_measures import Scar
from verification.figures.lines import Curve, curves
from verification.rows import CaseFile

SIDE, SHORTEST, SMOOTHED = 25e-6, 8e-6, 5e-6  # m: of the patch, shortest wave, window of smoothing
CELLS = (25, 45, 75, 135)  # along a side
COARSEST, VARIED_ON, DEFAULT, FINEST = CELLS
SEEDS = (1, 2, 3, 4, 5, 6)
THIRDS = dict.fromkeys(CELLS, (0, 1, 2)) | {FINEST: (0,)}
"""Cells along a side -> thirds of a cell by which surfaces are shifted; a run on the finest takes most."""
CYCLES, STEPS, FORCE = 5, 3, 0.15
FACES = np.array([0.0, 0.3, 0.7, 1.2, 1.8, 2.6, 3.7, 5.2, 7.3, 10.0]) * 1e-6
FINER = 3  # parts of each layer, and of each load step
ENOUGH = 50e-18  # m3: surfaces that wear less are reported, and not judged
ASKED = 3  # of the surfaces that wear enough
TENTH = 0.1


@dataclass(frozen=True)
class Member:
    """A run. thirds: of a cell, the shift along x and y; parts: of a layer; force: over FORCE."""

    seed: int
    cells: int
    thirds: int = 0
    parts: int = 1
    steps: int = STEPS
    force: float = 1.0

    @property
    def label(self) -> str:
        """For the name of the run."""
        usual = asdict(Member(self.seed, self.cells))
        others = (f"-{name}-{value:g}" for name, value in asdict(self).items() if value != usual[name])
        return f"surface-{self.seed}-cells-{self.cells}" + "".join(others)

    def of(self, base: Scene) -> Scene:
        """The patch: waves of SHORTEST and more on softer steel, so that most surfaces wear."""
        surface = shifted(base.surface, self.seed, self.cells, self.thirds / 3)
        grid = Grid(depths=cut(FACES, self.parts))
        scene = with_plasticity(base.model_copy(update={"surface": surface, "grid": grid}), B=LITERATURE_B)
        scene = with_keys(scene, "wear", smoothing_window=round(SMOOTHED * self.cells / SIDE))
        keys = {"force": self.force * FORCE, "cycles": CYCLES, "steps": self.steps, "unload_steps": 1}
        return with_loading(scene, **keys)


VARIATIONS = {
    "layers": partial(Member, cells=VARIED_ON, parts=FINER),
    "steps": partial(Member, cells=VARIED_ON, steps=FINER * STEPS),
    "load": partial(Member, cells=DEFAULT, force=1.01),
}
"""What else is varied -> the run of a surface: a third of layers or load steps, or 1 % more load."""
LEFT = {"layers": 1 / (FINER - 1), "steps": FINER / (FINER - 1)}
"""Share of that change which is left, of first order: of the finer layers, of the coarser load steps."""


def shifted(like: Surface, seed: int, cells: int, shift: float) -> Surface:
    """The surface and its relief, shifted by so many cells: sums of waves and a polynomial."""
    waves = {"sq": 0.2e-6, "cutoff_long": SIDE, "cutoff_short": SHORTEST, "hurst": like.hurst}
    surface = Surface(kind="self-affine", **waves, seed=seed, anisotropy=like.anisotropy)
    x, extent = ((np.arange(cells) + 0.5 - shift) / cells - 0.5) * SIDE, (SIDE, SIDE)
    found = with_relief(heights(surface, x, x, extent), (x, x), extent, mean_deviation(surface, extent))
    return Surface(kind="file", path=HeightMap(found, extent))


def cut(faces: np.ndarray, parts: int) -> tuple[float, ...]:
    """The faces with every layer in so many parts."""
    k = np.arange((faces.size - 1) * parts + 1) / parts
    return tuple(float(z) for z in np.interp(k, np.arange(faces.size), faces))


def members() -> list[Member]:
    """Every run, those that cost most last."""
    grids = [Member(seed, cells, thirds) for cells in CELLS for thirds in THIRDS[cells] for seed in SEEDS]
    varied = [of(seed) for of in VARIATIONS.values() for seed in SEEDS]
    return sorted(grids + varied, key=lambda one: one.cells)


def surfaces(context: Context) -> Iterator[dict[str, Any]]:
    """A row for each surface. N cells: its worn volumes in m3 at all shifts on N cells a side;
    off-N: that of the shift that is furthest off the mean on the finest cells, heights-N: of what
    residual heights have lost, root mean square, both relative; layers, steps: relative, what is
    left of their change; load: change by it; time: on the recommended cells over that on the coarsest;
    error: of the volume summed over a scar, over the median.
    """
    base, errors = context.scene("running-in-bulk"), dict.fromkeys(SEEDS, 0.0)
    volumes, heights, seconds = {}, {}, {}
    for member in members():
        result = context.solve(SAM, member.of(base), member.label)
        volumes[member] = float(result.tables["cycles"]["wear_volume_m3"][-1])
        error = abs(Scar.of(result.tables).volume - volumes[member])
        errors[member.seed] = max(errors[member.seed], error)
        if member == Member(member.seed, member.cells):
            heights[member], seconds[member] = lowering(result), result.cost["cpu_s"]
    median = np.median([volumes[Member(seed, FINEST)] for seed in SEEDS])
    for seed in SEEDS:
        shifts = {n: np.array([volumes[Member(seed, n, k)] for k in THIRDS[n]]) for n in CELLS}
        fine, lost = float(shifts[FINEST].mean()), heights[Member(seed, FINEST)]
        row = {"surface": seed, "volume": fine} | {f"{n} cells": own for n, own in shifts.items()}
        for n in CELLS[:-1]:
            away = heights[Member(seed, n)] - lost
            row[f"off-{n}"] = float(np.abs(shifts[n] - fine).max() / fine)
            row[f"heights-{n}"] = float(np.sqrt(np.mean(away**2) / np.mean(lost**2)))
        for name, varied in VARIATIONS.items():
            member = varied(seed)
            change = volumes[member] / volumes[Member(seed, member.cells)] - 1.0
            row[name] = LEFT[name] * abs(change) if name in LEFT else change
        time = seconds[Member(seed, DEFAULT)] / seconds[Member(seed, COARSEST)]
        yield row | {"time": time, "error": errors[seed] / median}


def worn(rows: DataFrame, column: str = "volume") -> int:
    """Surfaces that wear enough to be judged."""
    return int((rows["volume"] > ENOUGH).sum())


def within(rows: DataFrame, column: str) -> int:
    """Of those, how many are within a tenth."""
    return int(((rows["volume"] > ENOUGH) & (rows[column] <= TENTH)).sum())


def third(rows: DataFrame, column: str) -> float:
    """The third smallest of those: at most what three surfaces hold; NaN with fewer."""
    values = sorted(rows.loc[rows["volume"] > ENOUGH, column])
    return values[ASKED - 1] if len(values) >= ASKED else NAN


def per_wave(cells: int) -> float:
    """Cells in the shortest wave."""
    return SHORTEST * cells / SIDE


def lowering(result: Result) -> np.ndarray:
    """What wear and strain have lowered the unloaded surface by at last: means, (n, n) in m."""
    fields = result.grids["unloaded"]["surface"].cell_data
    lowered = np.squeeze(fields["worn_m"] + fields["uz_m"])
    share = overlaps(lowered.shape[0], COARSEST)
    return share @ lowered @ share.T


def overlaps(fine: int, coarse: int) -> np.ndarray:
    """(coarse, fine) shares of the fine cells of a side in the mean over each coarse one."""
    low, width = np.arange(coarse)[:, None] / coarse, 1.0 / coarse
    ends = np.clip(np.arange(fine + 1) / fine, low, low + width)
    return np.diff(ends, axis=1) / width


def cells(file: CaseFile, frame: DataFrame) -> Plot:
    """Worn volume over the cells: of each surface the means, with bars from the smallest to the largest."""
    drawn, x = {}, np.array([per_wave(n) for n in CELLS])
    for _, row in frame.iterrows():
        shifts = [CUBIC * row[f"{n} cells"] for n in CELLS]
        mean, *ends = (np.array([of(each) for each in shifts]) for of in (np.mean, min, max))
        drawn[f"surface {row['surface']}"] = Curve(x, mean, ends=tuple(ends))
    marks, xlabel = {"recommended": ("x", per_wave(DEFAULT))}, "cells in the shortest wave of the surface"
    how = {"logarithmic": "x", "ticks": "{:.3g}".format, "marks": marks, "size": (6.2, 3.6)}
    drawing = curves({"": drawn}, xlabel, "worn volume [µm³]", **how)
    drawing.figure.axes[0].set_ylim(bottom=0.0)
    return Plot(
        drawing,
        "cells",
        f"Worn volume after {CYCLES} cycles on finer cells",
        f"The figure shows the volume worn after {CYCLES} cycles over the cells in the shortest wave; the "
        "bars are the range of each surface shifted by 0, 1/3 and 2/3 of a cell.",
    )
