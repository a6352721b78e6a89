# SPDX-License-Identifier: MIT
"""Wear by itself: what it must do at its limits, and what the cell size does to its volume."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from sam.scene import Result, Scene, Surface, Wear
from verification.compare.running_in_measures import Scar, Spread
from verification.runs.sampling import surface_pressure
from verification.suite.cases.case import (
    SAM,
    Case,
    Context,
    Measured,
    SmallTable,
    number,
    with_grid,
    with_keys,
    with_loading,
)
from verification.suite.cases.friction import sliding_scene
from verification.suite.cases.resolution import Resolution
from verification.suite.cases.running_in_scenes import (
    LITERATURE_B,
    Effort,
    reduced,
    with_plasticity,
)

SPHERE, RATIO, LIMIT = "plastic-linear", 6.2, 0.004
"""A law that hardens little: on Swift steel no strain reaches the surface without friction, however small the
limit.
"""
CUBIC = 1e18


@dataclass(frozen=True)
class Extremes:
    """sphere, patch: the scenes; limited, plain, kept: the sphere with a limit, without wear, with an
    infinite limit; rough: the patch with an infinite limit.
    """

    sphere: Scene
    patch: Scene
    limited: Result
    plain: Result
    kept: Result
    rough: Result


class WearLimits(Case):
    """A smooth sphere without friction that wears, one that never does, and a rough patch that never does."""

    def solve(self, context: Context) -> Extremes:
        sphere, patch = sphere_scene(context), patch_scene(context)
        scenes = {
            "sphere-worn": with_limit(sphere, LIMIT),
            "sphere-plain": sphere,
            "sphere-infinite": with_limit(sphere, np.inf),
            "patch-infinite": with_limit(patch, np.inf),
        }
        results = (context.solve(SAM, scene, label) for label, scene in scenes.items())
        return Extremes(sphere, patch, *results)

    def measure(self, found: Extremes) -> dict[str, Measured | float]:
        values = {
            "symmetry": asymmetry(worn_of(found.limited)),
            "quarter-turn": asymmetry(worn_of(found.limited), turned=True),
            "volume": Measured(last(found.limited, "wear_volume_m3"), unit="m³"),
            "plain": Measured(difference(found.kept, found.plain), 0),
        }
        for label, result in (("sphere", found.kept), ("patch", found.rough)):
            values[f"{label}-wear"] = Measured(last(result, "wear_volume_m3"), 0, unit="m³")
            values[f"{label}-settles"] = last_gain(result)
        return values

    def setup(self, found: Extremes) -> list[tuple[str, str]]:
        return [
            (
                "Sphere",
                f"rigid, p₀/σ_y0 = {RATIO:g}, no friction, linear hardening, {found.sphere.loading.cycles} "
                "cycles",
            ),
            ("Limit", f"plastic strain of {LIMIT:.1%}, or infinite"),
            (
                "Patch",
                f"{1e6 * found.patch.grid.extent[0]:g} µm of the bulk case of running-in, film and friction, "
                "infinite limit",
            ),
        ]

    def tables(self, found: Extremes) -> Iterator[SmallTable]:
        results = found.limited, found.kept, found.rough
        rows = [row(words, result) for words, result in zip(RUNS, results, strict=True)]
        quantities = ("volume [µm³]", "largest strain [%]")
        ends = (f"{words}, {place}" for words in quantities for place in ("first", "last"))
        yield SmallTable("First and last cycle", ("run", *ends, "asymmetry of the scar"), rows)


RUNS = ("sphere that wears", "sphere, infinite limit", "rough patch, infinite limit")


def sphere_scene(context: Context) -> Scene:
    """A smooth sphere pressed on three times."""
    scene = sliding_scene(context.scene(SPHERE), RATIO, 0.0, Resolution(8, 8))
    return with_loading(scene, steps=3, unload=True, unload_steps=2, cycles=3)


def patch_scene(context: Context) -> Scene:
    """A small rough patch, sliding under its film."""
    return reduced(context.scene("running-in-bulk"), Effort((), (), cycles=5, steps=3, cells=32))


def with_limit(scene: Scene, limit: float) -> Scene:
    """The scene with wear beyond this strain."""
    wear = (
        Wear(strain_limit=limit)
        if scene.wear is None
        else scene.wear.model_copy(update={"strain_limit": limit})
    )
    return scene.model_copy(update={"wear": wear})


def worn_of(result: Result) -> np.ndarray:
    """(nx, ny) worn depth in m of a smooth scene at the last peak, before the removal of the last cycle."""
    fields = result.fields
    return surface_pressure(fields.points, fields.cells["quad"], fields.cell_data["worn_m"])[2]


def asymmetry(worn: np.ndarray, turned: bool = False) -> float:
    """Largest difference to the mirrored scar, or to the one turned by 90 degrees, over the largest depth;
    NaN without scar.
    """
    others = (worn.T,) if turned else (worn[::-1], worn[:, ::-1])
    with np.errstate(invalid="ignore"):
        return float(np.max([np.abs(worn - other).max() for other in others]) / worn.max())


def last(result: Result, column: str) -> float:
    """A column at the end of the last cycle."""
    return float(result.tables["cycles"][column][-1])


def last_gain(result: Result) -> float:
    """What the last cycle adds to the largest plastic strain, over that of the first."""
    strain = np.asarray(result.tables["cycles"]["peeq_max"], dtype=float)
    return float((strain[-1] - strain[-2]) / strain[0])


def difference(one: Result, other: Result) -> float:
    """Largest difference of the pressures and strains of all cycles."""
    pairs = [
        (np.asarray(r.tables["cycles"][name], dtype=float) for r in (one, other))
        for name in ("peeq_max", "p_max_Pa", "friction_coefficient")
    ]
    return max(float(np.abs(a - b).max()) for a, b in pairs)


def row(words: str, result: Result) -> tuple[str, ...]:
    """First and last cycle of a run."""
    cycles = result.tables["cycles"]
    volumes, strains = (np.asarray(cycles[name], dtype=float) for name in ("wear_volume_m3", "peeq_max"))
    worn = worn_of(result) if "worn_m" in result.fields.cell_data else np.zeros((1, 1))
    apart = max(asymmetry(worn), asymmetry(worn, turned=True)) if worn.any() else 0.0
    shape = f"{apart:.1e}" if worn.any() and result.tables.get("surface") is None else "–"
    ends = [number(scale * of[k], 4) for scale, of in ((CUBIC, volumes), (100.0, strains)) for k in (0, -1)]
    return (words, *ends, shape)


@dataclass(frozen=True)
class WearLevel:
    """cells: along a side of SIDE -> parts into which each of the layers is cut; seeds of its surfaces."""

    cells: Mapping[int, int]
    seeds: tuple[int, ...]


SIDE, CYCLES = 24e-6, 5
LEVELS = {"quick": WearLevel({24: 1, 48: 2}, (1,)), "full": WearLevel({24: 1, 48: 2, 96: 3}, (1, 2, 3, 4, 5))}
FACES = np.array([0.0, 0.3, 0.7, 1.2, 1.8, 2.6, 3.7, 5.2, 7.3, 10.0]) * 1e-6
FORCE = 0.15


@dataclass(frozen=True)
class Size:
    """How fine: cells along a side; whether depths are interpolated."""

    cells: int
    interpolate: bool


Volumes = Mapping[Size, Sequence[Sequence[float]]]
"""For each size the volumes in m3 over the cycles, of each surface."""


@dataclass(frozen=True)
class Grids:
    """Worn volumes on all sizes of cells. errors: of the volume summed over the scar, m3."""

    level: WearLevel
    volumes: Volumes
    errors: Sequence[float]

    @property
    def lasts(self) -> list[float]:
        """Median volume after the last cycle for each size of cells, m3."""
        return [median(self.volumes, size, CYCLES) for size in self.volumes]


class WearGrid(Case):
    """The same surfaces on finer and finer cells and layers, with interpolated depths and with whole
    layers.
    """

    def solve(self, context: Context) -> Grids:
        level, base = LEVELS[context.level], context.scene("running-in-bulk")
        volumes: dict[Size, list[np.ndarray]] = {}
        errors: list[float] = []
        for size in (Size(cells, interpolate) for interpolate in (True, False) for cells in level.cells):
            for seed in level.seeds:
                patch = small_patch(base, size.cells, level.cells[size.cells], seed)
                result = context.solve(
                    SAM,
                    with_keys(patch, "wear", interpolate=size.interpolate),
                    (f"{'interpolated' if size.interpolate else 'layers'}-{size.cells}-seed-{seed}"),
                )
                volume = np.asarray(result.tables["cycles"]["wear_volume_m3"], dtype=float)
                volumes.setdefault(size, []).append(volume)
                errors.append(abs(Scar.of(result.tables).volume - volume[-1]))
        return Grids(level, volumes, errors)

    def measure(self, found: Grids) -> dict[str, Measured | float]:
        return {
            "volume": max(found.errors) / max(found.lasts),
            "wears": Measured(min(found.lasts), unit="m³"),
        }

    def setup(self, found: Grids) -> list[tuple[str, str]]:
        cells = found.level.cells
        layers = ", ".join(f"{1e6 * FACES[1] / parts:g} µm" for parts in cells.values())
        return [
            (
                "Patch",
                f"{1e6 * SIDE:g} × {1e6 * SIDE:g} µm, waves of 8 µm and more, {FORCE:g} N, {CYCLES} cycles",
            ),
            ("Cells", ", ".join(words_of(n) for n in cells)),
            ("First layer", f"{layers}, all in proportion"),
            (
                "Body",
                f"steel of B = {LITERATURE_B / 1e6:g} MPa, removed above a plastic strain of 0.2 %, film and "
                "friction as in running-in",
            ),
        ]

    def tables(self, found: Grids) -> list[SmallTable]:
        return [grid_table(found.volumes), gap_table(found.volumes)]

    def notes(self, found: Grids) -> list[str]:
        return [trend(found.volumes)]


def median(volumes: Volumes, size: Size, cycle: int) -> float:
    """Volume in m3 after so many cycles, the median of the surfaces."""
    return float(np.median([of_surface[cycle - 1] for of_surface in volumes[size]]))


def words_of(cells: int) -> str:
    """The cell size for the reader."""
    return f"{1e6 * SIDE / cells:g} µm"


def small_patch(base: Scene, cells: int, parts: int, seed: int) -> Scene:
    """A patch with short waves, eight cells at the coarsest, and softer steel, which is removed on all
    surfaces.
    """
    rough = base.surface.model_dump(include={"hurst", "anisotropy"})
    surface = Surface(kind="self-affine", sq=0.2e-6, cutoff_long=24e-6, cutoff_short=8e-6, seed=seed, **rough)
    scene = with_plasticity(base.model_copy(update={"surface": surface}), B=LITERATURE_B)
    scene = with_loading(scene, force=FORCE, cycles=CYCLES, steps=3, unload_steps=1)
    return with_grid(scene, cells=(cells, cells), extent=(SIDE, SIDE), depths=cut(FACES, parts))


def cut(faces: np.ndarray, parts: int) -> tuple[float, ...]:
    """The faces with every layer in so many parts."""
    k = np.arange((faces.size - 1) * parts + 1) / parts
    return tuple(float(z) for z in np.interp(k, np.arange(faces.size), faces))


def grid_table(volumes: Volumes) -> SmallTable:
    """Volumes after the first cycle and after all."""
    rows = []
    for size, of_surfaces in volumes.items():
        rows.append(["interpolated" if size.interpolate else "whole layers", words_of(size.cells)])
        for cycle in (1, CYCLES):
            spread = Spread.of([CUBIC * each[cycle - 1] for each in of_surfaces])
            rows[-1] += [spread.text(4), change(volumes, size, cycle)]
    return SmallTable(
        f"Worn volume after one cycle and after {CYCLES}, median and range of the surfaces",
        (
            "depth of the scar",
            "cells",
            *(words for n in (1, CYCLES) for words in (f"V({n}) [µm³]", "change of the median")),
        ),
        rows,
    )


def change(volumes: Volumes, size: Size, cycle: int) -> str:
    """Of the median against the next coarser cells."""
    coarser = [each for each in volumes if each.interpolate == size.interpolate and each.cells < size.cells]
    if not coarser:
        return "–"
    return f"{median(volumes, size, cycle) / median(volumes, coarser[-1], cycle) - 1:+.1%}"


def gap(volumes: Volumes, cells: int, cycle: int) -> float:
    """Whole layers over interpolated depths, less 1: medians."""
    whole, interpolated = (median(volumes, Size(cells, interpolate), cycle) for interpolate in (False, True))
    return whole / interpolated - 1.0


def gap_table(volumes: Volumes) -> SmallTable:
    """The difference between whole layers and interpolated depths."""
    return SmallTable(
        "Whole layers against interpolated depths, medians",
        ("cells", "V(1)", f"V({CYCLES})"),
        [
            (words_of(n), *(f"{gap(volumes, n, cycle):+.1%}" for cycle in (1, CYCLES)))
            for n in sizes_of(volumes)
        ],
    )


def sizes_of(volumes: Volumes) -> list[int]:
    """Numbers of cells, coarsest first."""
    return sorted({size.cells for size in volumes})


def trend(volumes: Volumes) -> str:
    """Whether the medians close up on finer cells, in words."""
    words, cells = [], sizes_of(volumes)
    for cycle in (1, CYCLES):
        for interpolate, name in ((True, "interpolated depths"), (False, "whole layers")):
            steps = np.abs(np.diff([median(volumes, Size(n, interpolate), cycle) for n in cells]))
            if steps.size > 1:
                words.append(
                    f"V({cycle}), {name}: what halving the cells changes {_shrinks(steps)}, "
                    f"{CUBIC * steps[0]:.3g}, then {CUBIC * steps[-1]:.3g} µm³."
                )
        gaps = np.abs([gap(volumes, n, cycle) for n in cells])
        words.append(
            f"V({cycle}): the difference between the two {_shrinks(gaps)}, {gaps[0]:.1%} to {gaps[-1]:.1%}."
        )
    return " ".join(words) + (WHY_NOT if any(NOT in each for each in words) else "")


NOT = "does NOT shrink"
WHY_NOT = (
    " Each scar is the surface of the next cycle: the edges that a grid leaves decide where films fail next, "
    "so that after one cycle the volume is a matter of resolution, and after several of which spots happened "
    "to be removed."
)


def _shrinks(values: Sequence[float]) -> str:
    return "shrinks" if values[-1] < values[0] else NOT


CASES = (
    WearLimits(
        "wear-limits",
        "Wear at its limits",
        "Does nothing wear with an infinite limit, and does a symmetric contact wear symmetrically?",
        (
            (
                "Limit",
                "removed where the plastic strain passes it, from the surface down",
                "Bosman & Schipper (2011), section 5",
            ),
        ),
    ),
    WearGrid(
        "wear-grid",
        "Wear volume on finer cells",
        "Does the worn volume settle on finer cells and layers, with and without interpolated depths?",
        (
            (
                "Depth",
                "where the strain, linear between layers, is at its limit",
                "Bosman & Schipper (2011), section 5",
            ),
        ),
        ("full",),
    ),
)
