# SPDX-License-Identifier: MIT
"""Worn volume on finer cells, layers and load steps, each alone, with the surface shifted against the cells;
on how many surfaces the recommended cells give it within a tenth, and what they cost.

The scar is smoothed over a length: the window has as many cells as that takes. Sizes of cells are those of
which an odd number makes up the length, so that it is the same on all grids to the bit.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import asdict, dataclass
from functools import cached_property, partial

import numpy as np

from sam.scene import Grid, HeightMap, Result, Scene, Surface
from sam.scene.surface import heights, mean_deviation, with_relief
from verification.cases.case import (
    SAM,
    Case,
    Context,
    Measured,
    Plot,
    SmallTable,
    number,
    with_keys,
    with_loading,
)
from verification.cases.running_in.scenes import LITERATURE_B, with_plasticity
from verification.cases.running_in.study import CUBIC, spread
from verification.compare.running_in_measures import Scar
from verification.figures.lines import over_cells

SIDE, SHORTEST, SMOOTHED = 25e-6, 8e-6, 5e-6  # m: of the patch, shortest wave, window of smoothing
CELLS = (25, 45, 75, 135)  # along a side
COARSEST, VARIED_ON, DEFAULT, FINEST = CELLS
SIZES = {n: f"{1e6 * SIDE / n:.3g} µm" for n in CELLS}
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
    """A run. thirds: of a cell, by which the surface is shifted along x and y; parts: of each layer; window:
    cells, None: those of the length SMOOTHED; force: over FORCE.
    """

    seed: int
    cells: int
    thirds: int = 0
    parts: int = 1
    steps: int = STEPS
    window: int | None = None
    force: float = 1.0

    @property
    def label(self) -> str:
        """For the name of the run."""
        usual = asdict(Member(self.seed, self.cells))
        others = (f"-{name}-{value:g}" for name, value in asdict(self).items() if value != usual[name])
        return f"surface-{self.seed}-cells-{self.cells}" + "".join(others)

    def of(self, base: Scene) -> Scene:
        """The patch: waves of SHORTEST and more on softer steel than printed, so that most surfaces wear."""
        surface, grid = (
            shifted(base.surface, self.seed, self.cells, self.thirds / 3),
            Grid(depths=cut(FACES, self.parts)),
        )
        scene = with_plasticity(base.model_copy(update={"surface": surface, "grid": grid}), B=LITERATURE_B)
        window = window_of(self.cells) if self.window is None else self.window
        scene, force = with_keys(scene, "wear", smoothing_window=window), self.force * FORCE
        return with_loading(scene, force=force, cycles=CYCLES, steps=self.steps, unload_steps=1)


LAYERS, LOADS, MORE_LOAD = "layers of a third", "load steps of a third", "1 % more load"
VARIATIONS = {
    LAYERS: partial(Member, cells=VARIED_ON, parts=FINER),
    LOADS: partial(Member, cells=VARIED_ON, steps=FINER * STEPS),
    MORE_LOAD: partial(Member, cells=DEFAULT, force=1.01),
    "5 cells of smoothing": partial(Member, cells=DEFAULT, window=5),
}
"""What else is varied, in words -> the run of a surface; each against the same without."""
LEFT = {LAYERS: 1 / (FINER - 1), LOADS: FINER / (FINER - 1)}
"""Share of that change which is left, of first order: of the finer layers, which are recommended, and of the
coarser load steps, which are.
"""


def window_of(cells: int) -> int:
    """Cells in the length of smoothing."""
    return round(SMOOTHED * cells / SIDE)


def shifted(like: Surface, seed: int, cells: int, shift: float) -> Surface:
    """The surface and its relief, shifted by so many cells along x and y: sums of waves and a polynomial,
    evaluated elsewhere.
    """
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


@dataclass(frozen=True)
class Found:
    """volumes: in m3 after the last cycle; lowered: of the unshifted surfaces, see `lowering`; costs: of the
    unshifted ones, (processor s, operator applications); error: of the volume summed over a scar, the
    largest, m3.
    """

    volumes: Mapping[Member, float]
    lowered: Mapping[Member, np.ndarray]
    costs: Mapping[Member, tuple[float, int]]
    error: float

    def of_shifts(self, seed: int, cells: int) -> np.ndarray:
        """The volumes of a surface at all its shifts."""
        return np.array([self.volumes[Member(seed, cells, thirds)] for thirds in THIRDS[cells]])

    def mean(self, seed: int, cells: int) -> float:
        """Of the shifts."""
        return float(self.of_shifts(seed, cells).mean())

    @cached_property
    def worn(self) -> list[int]:
        """Surfaces that wear enough to be judged."""
        return [seed for seed in SEEDS if self.mean(seed, FINEST) > ENOUGH]

    @cached_property
    def good(self) -> list[int]:
        """Surfaces that wear enough and whose volume is within a tenth on the recommended cells."""
        return [seed for seed in self.worn if self.off(seed, DEFAULT) <= TENTH]

    def off(self, seed: int, cells: int) -> float:
        """Of the shift that is furthest off the finest cells, over the volume on those."""
        finest = self.mean(seed, FINEST)
        return float(np.abs(self.of_shifts(seed, cells) - finest).max() / finest)

    def change(self, seed: int, name: str) -> float:
        """What a variation changes, over the volume without it."""
        member = VARIATIONS[name](seed)
        return self.volumes[member] / self.volumes[Member(seed, member.cells)] - 1.0

    def heights_off(self, seed: int, cells: int) -> float:
        """Root mean square of what the lowering differs by from that on the finest cells, over its own."""
        finest = self.lowered[Member(seed, FINEST)]
        difference = self.lowered[Member(seed, cells)] - finest
        return float(np.sqrt(np.mean(difference**2) / np.mean(finest**2)))

    def left(self, seed: int, name: str) -> float:
        """What layers or load steps are still wrong by, relative."""
        return LEFT[name] * abs(self.change(seed, name))

    def uncertainty(self, seed: int) -> float:
        """Of the volume at what is recommended, relative: cells and shift, layers and load steps, added."""
        return self.off(seed, DEFAULT) + sum(self.left(seed, name) for name in LEFT)


class WearConverged(Case):
    """Six surfaces on four sizes of cells, shifted; on one size finer layers and load steps."""

    def ahead(self, context: Context) -> Iterator[Scene]:
        base = context.scene("running-in-bulk")
        yield from (member.of(base) for member in reversed(members()))

    def solve(self, context: Context) -> Found:
        base = context.scene("running-in-bulk")
        volumes, lowered, costs, error = {}, {}, {}, 0.0
        for member in members():
            result = context.solve(SAM, member.of(base), member.label)
            volumes[member] = float(result.tables["cycles"]["wear_volume_m3"][-1])
            error = max(error, abs(Scar.of(result.tables).volume - volumes[member]))
            if member == Member(member.seed, member.cells):
                lowered[member] = lowering(result)
                costs[member] = result.cost["cpu_s"], result.cost["operator_applications"]
        return Found(volumes, lowered, costs, error)

    def measure(self, found: Found) -> dict[str, Measured]:
        judged = {
            "heights": [found.heights_off(seed, DEFAULT) for seed in found.worn],
            "layers": [found.left(seed, LAYERS) for seed in found.worn],
            "steps": [found.left(seed, LOADS) for seed in found.worn],
        }
        return {
            "worn": Measured(len(found.worn)),
            "cells": Measured(len(found.good), unit=f"of {len(SEEDS)} surfaces"),
            **{name: Measured(kth(values, ASKED)) for name, values in judged.items()},
            "volume": Measured(found.error / np.median([found.mean(seed, FINEST) for seed in SEEDS])),
        }

    def setup(self, found: Found) -> Iterator[tuple[str, str]]:
        waves = f"waves of {1e6 * SHORTEST:g} µm and more, {FORCE:g} N, {CYCLES} cycles"
        yield "Patch", f"{1e6 * SIDE:g} × {1e6 * SIDE:g} µm, {waves}"
        sizes = (f"{size} ({per_wave(n):.3g} in the shortest wave)" for n, size in SIZES.items())
        yield "Cells", ", ".join(sizes)
        windows = ", ".join(str(window_of(n)) for n in CELLS)
        yield "Smoothing", f"{1e6 * SMOOTHED:g} µm: {windows} cells"
        parts = f"{STEPS}; also with each in {FINER} parts"
        yield "First layer, load steps", f"{1e6 * FACES[1]:g} µm, {parts}"
        yield "Surfaces", f"{len(SEEDS)}, shifted by 0, 1/3 and 2/3 of a cell along x and y"
        removed = "removed above a plastic strain of 0.2 %, film and friction as in running-in"
        yield "Body", f"steel of B = {LITERATURE_B / 1e6:g} MPa, {removed}"

    def tables(self, found: Found) -> Iterator[SmallTable]:
        yield cells_table(found)
        yield varied_table(found)
        totals = {n: np.sum([found.costs[Member(seed, n)] for seed in SEEDS], axis=0) for n in CELLS}
        rows = []
        for n, total in totals.items():
            over = (f"{ratio:.3g}" for ratio in total / totals[COARSEST])
            rows.append((SIZES[n], f"{window_of(n)}", *(number(v, 3) for v in total), *over))
        columns = "cells|in the window|processor time [s]|operator applications|time over|applications over"
        words = "Cost of all surfaces, unshifted; over: that of the coarsest cells"
        yield SmallTable(words, columns.split("|"), rows)

    def notes(self, found: Found) -> Iterator[str]:
        yield (
            f"{per_wave(DEFAULT):g} cells in the shortest wave and a smoothing of constant length give the "
            f"volume within {TENTH:.0%} at every shift on {len(found.good)} of {len(SEEDS)} surfaces; "
            f"{len(found.worn)} wear more than {CUBIC * ENOUGH:g} µm³."
        )
        if words := ", ".join(
            f"{seed} ({found.off(seed, DEFAULT):.0%}; 1 % more load changes it by "
            f"{found.change(seed, MORE_LOAD):+.0%})"
            for seed in found.worn
            if seed not in found.good
        ):
            yield f"Not on surface {words}."
        little = [seed for seed in SEEDS if seed not in found.worn]
        if words := ", ".join(f"{seed} ({CUBIC * found.mean(seed, FINEST):.3g} µm³)" for seed in little):
            yield f"Not judged, as hardly anything wears: surface {words}."

    def figures(self, found: Found) -> Iterator[Plot]:
        volumes = {
            f"surface {seed}": {per_wave(n): CUBIC * found.of_shifts(seed, n) for n in CELLS}
            for seed in SEEDS
        }
        yield Plot(
            over_cells(volumes, per_wave(DEFAULT)),
            "cells",
            f"Worn volume after {CYCLES} cycles on finer cells",
            "Worn volume over the number of cells in the shortest wave, a line for each surface with the "
            "range of its shifts.",
            "Bars: the surface shifted by 0, 1/3 and 2/3 of a cell. Dotted: what is recommended.",
        )


def kth(values: list[float], k: int) -> float:
    """The k-th smallest: at most what k surfaces hold; NaN with fewer."""
    return sorted(values)[k - 1] if len(values) >= k else float("nan")


def per_wave(cells: int) -> float:
    """Cells in the shortest wave."""
    return SHORTEST * cells / SIDE


def lowering(result: Result) -> np.ndarray:
    """What wear and plastic strain have lowered the unloaded surface by after the last cycle: means over the
    coarsest cells, (n, n) in m.
    """
    fields = result.grids["unloaded"]["surface"].cell_data
    lowered = np.squeeze(fields["worn_m"] + fields["uz_m"])
    share = overlaps(lowered.shape[0], COARSEST)
    return share @ lowered @ share.T


def overlaps(fine: int, coarse: int) -> np.ndarray:
    """(coarse, fine) shares of the fine cells of a side in the mean over each coarse one."""
    low, width = np.arange(coarse)[:, None] / coarse, 1.0 / coarse
    ends = np.clip(np.arange(fine + 1) / fine, low, low + width)
    return np.diff(ends, axis=1) / width


def cells_table(found: Found) -> SmallTable:
    """Volumes and heights of each surface on each size of cells."""
    rows, coarser = [], list(SIZES.items())[:-1]
    for seed in SEEDS:
        offs = [of(seed, n) for of in (found.off, found.heights_off) for n, _ in coarser]
        shown = (f"{value:.1%}" if seed in found.worn else "–" for value in offs)
        rows.append((f"{seed}", *(spread(found.of_shifts(seed, n), CUBIC) for n in CELLS), *shown))
    columns = (f"{what}, {size}" for what in ("off", "heights") for _, size in coarser)
    return SmallTable(
        f"Worn volume after {CYCLES} cycles [µm³], median and range of the shifts; off: the shift that is "
        "furthest from the finest cells; heights: root mean square of what residual heights have "
        f"lost less that on the finest cells, in means over {1e6 * SIDE / COARSEST:g} µm, over the latter",
        ("surface", *(f"V, {size}" for size in SIZES.values()), *columns),
        rows,
    )


def varied_table(found: Found) -> SmallTable:
    """What layers, load steps, load and the old smoothing change, and the uncertainty."""
    rows = []
    for seed in SEEDS:
        changes = {name: found.change(seed, name) for name in VARIATIONS}
        without = (found.volumes[Member(seed, of(seed).cells)] for of in VARIATIONS.values())
        cells = (f"{c:+.1%} ({CUBIC * c * v:+.2g})" for c, v in zip(changes.values(), without, strict=True))
        share, volume = (
            found.uncertainty(seed),
            found.volumes[Member(seed, DEFAULT)] * (1.0 + changes[LAYERS]),
        )
        known = f"{number(CUBIC * volume, 3)} ± {number(CUBIC * share * volume, 2)} ({share:.0%})"
        rows.append((f"{seed}", *cells, known if seed in found.worn else "–"))
    return SmallTable(
        "What else changes the worn volume, and by how many µm³: layers and load steps on cells of "
        f"{1e6 * SIDE / VARIED_ON:.3g} µm, load and smoothing on the recommended ones. V on these with "
        "layers of a third; uncertain by cells and shift, and by what is left of layers and steps, added",
        ("surface", *VARIATIONS, "V [µm³]"),
        rows,
    )


CASES = (WearConverged("wear-converged"),)
