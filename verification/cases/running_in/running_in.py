# SPDX-License-Identifier: MIT
"""Running-in: the five cases of Bosman & Schipper (2011), Figs. 13-17, on ten surfaces, against what the
paper says of them; with the printed inputs, and beside it a second reading of what the paper leaves open.

Gates are for what must be so: sums that agree, cycles that are complete, friction between its two
coefficients. What the paper says of its own surface is judged in a table, beside the pressures at which a
film fails and metal is removed, which decide it.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

import numpy as np

from sam.scene import Result, Scene
from verification.cases.case import SAM, Case, Context, Measured, Plot, SmallTable, View
from verification.cases.running_in.running_in_runs import SHOWN, Key, Readings, RunningInRun, Runs, gates
from verification.cases.running_in.running_in_scenes import (
    LAYER_ALPHA,
    LITERATURE_B,
    Effort,
    Reading,
    deeper_after,
    read_as,
    reduced,
    with_seed,
)
from verification.cases.running_in.running_in_statements import LAST, NAMES, A, B
from verification.cases.running_in.running_in_tables import (
    FINDINGS_NOTE,
    HELD_NOTE,
    REST_NOTE,
    cases_table,
    cost_table,
    deepened_note,
    findings_note,
    lost_height_note,
    lost_note,
    new_strain_table,
    of_case,
    regimes_table,
    statements_table,
    varied_table,
)
from verification.cases.running_in.running_in_varied import varied_scenes
from verification.compare.running_in_measures import History
from verification.figures.running_in import comparison, regime_map, six_panels, surface, yield_profiles
from verification.figures.running_in_readings import side_by_side

FULL = Effort(tuple(NAMES), tuple(range(1, 11)), cycles=LAST, steps=10, cells=64)
EFFORTS = {
    "quick": {
        Reading.PRINTED: Effort((B,), (SHOWN,), cycles=3, steps=3, cells=32),
        Reading.RENEWED: Effort((A,), (SHOWN,), cycles=3, steps=2, cells=32),
    },
    "full": {Reading.PRINTED: replace(FULL, varied=True), Reading.RENEWED: FULL},
}


class DeeperWhereItYields(Case):
    """A case whose runs begin again with deeper layers where the plastic zone reaches the last one."""

    def then(self, scene: Scene, result: Result) -> Scene | None:
        return deeper_after(scene, result)


class RunningIn(DeeperWhereItYields):
    """Every case on every surface in both readings; then what is varied of the printed inputs; gates over all
    of them, statements over those that converged.
    """

    def ahead(self, context: Context) -> Iterator[Scene]:
        for reading, effort in EFFORTS[context.level].items():
            yield from scenes_of(context, reading, effort)[1].values()

    def solve(self, context: Context) -> Readings:
        runs = [read(context, reading, effort) for reading, effort in EFFORTS[context.level].items()]
        varied = variations(context, runs[0].bases) if runs[0].effort.varied else {}
        return Readings(runs, varied)

    def measure(self, found: Readings) -> dict[str, Measured]:
        return gates(found.all)

    def setup(self, found: Readings) -> list[tuple[str, str]]:
        printed, renewed = (next(iter(runs.bases.values())) for runs in found.runs)
        return [*setup_printed(printed, found.runs[0].effort), *setup_renewed(renewed)]

    def tables(self, found: Readings) -> Iterator[SmallTable]:
        if all(runs.judged for runs in found.runs):
            yield statements_table({runs.reading.short: runs.judged for runs in found.runs})
        for runs in found.runs:
            yield cases_table(runs.reading, runs.histories)
        yield new_strain_table({runs.reading.short: runs.cycles_tables for runs in found.runs})
        for runs in found.runs:
            yield regimes_table(runs.reading, runs.limits, runs.histories, runs.held)
        if found.varied:
            yield varied_table(found.on_one_surface)
        yield cost_table(found.groups)

    def notes(self, found: Readings) -> Iterator[str]:
        for runs in found.runs:
            if runs.judged:
                yield findings_note(runs.reading, runs.judged)
        if found.runs[0].judged:
            yield FINDINGS_NOTE
            yield REST_NOTE
        if scars := {name: one.scar for name, one in found.named.items() if one.result.converged}:
            yield lost_height_note(scars)
        if found.deepened:
            yield deepened_note(found.deepened)
        if found.lost:
            yield lost_note({name: one.result for name, one in found.lost.items()})
        if any(above for runs in found.runs for counts in runs.held.values() for _, above in counts):
            yield HELD_NOTE

    def figures(self, found: Readings) -> Iterator[Plot]:
        if not found.cases:
            return
        yield Plot(
            side_by_side(
                {
                    NAMES[case]: {runs.reading: of_case(runs.histories, case) for runs in found.runs}
                    for case in found.cases
                }
            ),
            "readings",
            "Both readings of the paper over the cycles",
            "Wear volume and friction over the cycles, a column for each case, a line for each reading.",
            "Thick: median of the surfaces; thin: each surface.",
        )
        if found.runs[0].shown:
            yield surface_plot(found.runs[0])
        for runs in found.runs:
            yield from plots(runs)

    def views(self, found: Readings) -> Iterator[View]:
        for runs in found.runs:
            for case, seed in runs.shown:
                yield View(
                    label_of(runs.reading, case, seed),
                    "worn",
                    f"{led(runs.reading, case)}-worn",
                    f"Worn surface over the original, {NAMES[case]}, {runs.reading}",
                    f"The rough surface of {NAMES[case]} in space, coloured by the depth worn; the original "
                    "surface above it is transparent.",
                    f"As the paper's Fig. {FIGURES[case]}b, on our surface, after the last cycle; "
                    f"{runs.reading}.",
                )


def setup_printed(scene: Scene, effort: Effort) -> list[tuple[str, str]]:
    """What all runs have in common, and the second reading changes some of."""
    film, surface, plasticity, wear = scene.friction, scene.surface, scene.body.plasticity, scene.wear
    law = f"σ_y = {plasticity.B / 1e6:g} MPa ({plasticity.C:g} + 10⁶ ε)^{plasticity.n:g}"
    waves = f"waves of {surface.cutoff_short * 1e6:g} µm and more"
    seeds = ", ".join(map(str, effort.seeds))
    side, cells = 1e6 * scene.grid.extent[0], f"{effort.cells} × {effort.cells} cells"
    cycles = f"{effort.cycles} cycles of {effort.steps} + {effort.steps} steps"
    fails = f"fails beyond {film.thinning_limit:.2%} a cycle"
    limits = f"beyond {wear.strain_limit:.1%} of plastic strain, in a layer 2 % or 5 %"
    return [
        ("Body", f"E = {scene.body.young / 1e9:g} GPa, {law}"),
        ("Surface", f"hard-turned, Ra = {surface.ra * 1e6:g} µm, {waves}; seeds {seeds}"),
        ("Patch", f"{side:g} × {side:g} µm, {cells}, {_layers(scene)}, the first 0.1 µm"),
        ("Load", f"{scene.loading.force:g} N, {cycles}, flat steel above"),
        ("Film", f"{film.film_thickness * 1e9:g} nm, yields at {film.film_yield / 1e9:.3g} GPa, {fails}"),
        ("Friction", f"{film.low:g} below a whole film, {film.high:g} where it has failed"),
        ("Wear", f"{limits}; window {wear.smoothing_window}"),
        (
            "Assumed",
            "the layers' yield stress over depth (curve-*.csv, hardening-only.csv), window and order of "
            "smoothing",
        ),
    ]


def setup_renewed(scene: Scene) -> list[tuple[str, str]]:
    """What the second reading changes, for the reader."""
    surface = scene.counterbody.surface
    low, high = (1e6 * cutoff for cutoff in (surface.cutoff_short, surface.cutoff_long))
    waves = f"waves of {low:g} to {high:g} µm"
    return [
        ("Second reading", f"{Reading.RENEWED}; for curve B: running-in-renewed.toml"),
        ("Layer", f"down to 1 µm σ_y with {LAYER_ALPHA:g} ε in place of 10⁶ ε, bulk with the printed 10⁶"),
        ("Counter-surface", f"{1e9 * surface.sq:g} nm rms, {waves}, another one in each cycle"),
        ("Grid", f"{_layers(scene)}, to {1e6 * scene.grid.depths[-1]:g} µm"),
    ]


def _layers(scene: Scene) -> str:
    return f"{len(scene.grid.depths) - 1} layers"


def plots(runs: Runs) -> Iterator[Plot]:
    """The figures of one reading: all runs over the cycles, the regimes, and six panels of each case."""
    reading = runs.reading
    histories = {NAMES[case]: of_case(runs.histories, case) for case in runs.limits}
    histories = {name: each for name, each in histories.items() if each}
    if not histories:
        return
    yield Plot(
        comparison(histories),
        led(reading, "comparison"),
        f"Volume, friction and roughness over the cycles, {reading}",
        "Wear volume, friction and roughness over the cycles, a column of panels for each case.",
        "Thick: median of the surfaces; thin: each surface. Sa of the unloaded surface after each cycle.",
    )
    yield yield_plot(runs)
    yield regimes_plot(runs, {name: median_pressures(each) for name, each in histories.items()})
    for case, seed in runs.shown:
        one = runs.found[case, seed]
        yield Plot(
            six_panels(one.scar, one.history, one.friction),
            led(reading, case),
            f"Running-in, {NAMES[case]}, {reading}",
            f"Six panels of {NAMES[case]}: worn depth, worn surface, volume and friction over cycles, "
            "local friction, pressure.",
            f"As the paper's Fig. {FIGURES[case]}, on our surface {seed} alone: its numbers differ from the "
            "medians of all surfaces. (a) and (b) after the last cycle, (e) and (f) at its peak; grey: not "
            "worn, or no contact.",
        )


def surface_plot(runs: Runs) -> Plot:
    """The surface of the scenes before any wear."""
    case, seed = runs.shown[0]
    return Plot(
        surface(runs.found[case, seed].scar),
        "surface",
        f"The rough surface before running-in, surface {seed}",
        "Map of the heights of the rough surface, and its profile through the highest place.",
        "In place of the measured surface of the paper's Fig. 12, which is not public: made with its Ra, "
        "size and sampling. Heights out of the body; at the border they fall, so that the patch ends free.",
    )


def yield_plot(runs: Runs) -> Plot:
    """The yield stress over depth of each case."""
    return Plot(
        yield_profiles(
            {NAMES[case]: scene.body.plasticity.strength().stress for case, scene in runs.bases.items()}, DEEP
        ),
        led(runs.reading, "yield"),
        f"Yield stress over depth, {runs.reading}",
        "Curves of the yield stress over depth, one for each case, before any plastic strain and after 1 %.",
        "After the paper's Fig. 9, which has no numbers: the shape of the profiles is from it, their size is "
        "assumed. The line of a case may lie on that of another.",
    )


def regimes_plot(runs: Runs, reached: Mapping[str, tuple[float, float]]) -> Plot:
    """Where films fail and metal is removed. reached: name of a case -> see `median_pressures`."""
    first = next(iter(runs.good.values()))
    constants = (first.scene.body.plasticity.B, LITERATURE_B)
    return Plot(
        regime_map(
            {NAMES[case]: pair for case, pair in runs.limits.items()},
            reached,
            first.friction,
            tuple(f"B = {constant / 1e6:g} MPa" for constant in constants),
        ),
        led(runs.reading, "regimes"),
        f"Where films fail and metal is removed, {runs.reading}",
        "Map of pressure against friction and against strength: zones where the film is whole, has "
        "failed, and metal is removed.",
        "Lines: √3 μ p = σ_y(limit), above which the traction alone removes the surface. Dash-dotted: "
        "the film fails. Right: full marks at the strength of each case, open ones with the other B; "
        "arrows: median of the surfaces.",
    )


def led(reading: Reading, name: str) -> str:
    """A name of a file, led by that of the reading unless it is that of the printed inputs."""
    return name if reading is Reading.PRINTED else f"{reading.short}-{name}"


def label_of(reading: Reading, case: str, seed: int) -> str:
    """What the run of a case on a surface is written as."""
    return led(reading, f"{case}-seed-{seed}")


def read(context: Context, reading: Reading, effort: Effort) -> Runs:
    """Every case in one reading, on every surface."""
    bases, scenes = scenes_of(context, reading, effort)
    found = {key: solved(context, scene, label_of(reading, *key)) for key, scene in scenes.items()}
    return Runs(reading, effort, bases, found)


def scenes_of(
    context: Context, reading: Reading, effort: Effort
) -> tuple[dict[str, Scene], dict[Key, Scene]]:
    """Case -> its scene on the surface of the file; and the scene of each run."""
    printed = {case: reduced(context.scene(f"running-in-{case}"), effort) for case in effort.cases}
    bases = {case: read_as(reading, scene) for case, scene in printed.items()}
    runs = itertools.product(effort.seeds, effort.cases)
    return bases, {(case, seed): read_as(reading, with_seed(printed[case], seed)) for seed, case in runs}


def solved(context: Context, scene: Scene, label: str) -> RunningInRun:
    """A run that may stay unconverged: a gate counts those, and a set of hours does not break off for one of
    them. Where the plastic zone reaches the last layer it is run again with deeper ones.
    """
    result = context.solve(SAM, scene, label, demand=False)
    below = deeper_after(scene, result)
    return RunningInRun(scene, result) if below is None else solved(context, below, f"{label}-deeper")


def variations(context: Context, bases: Mapping[str, Scene]) -> dict[str, RunningInRun]:
    """On the surface of the scene: curves that deviate less and more, curve C, the other constant B, windows
    of smoothing.
    """
    scenes = varied_scenes(bases, context.scene)
    return {name: solved(context, scene, label) for name, (label, scene) in scenes.items()}


def median_pressures(histories: Sequence[History]) -> tuple[float, float]:
    """Largest pressure in Pa in the first and in the last cycle."""
    return tuple(float(np.median([history.p_max[k] for history in histories])) for k in (0, -1))


DEEP = 2e-6
"""How far down the yield stress is drawn, in m: the profiles end above."""
FIGURES = dict(zip(NAMES, (13, 14, 15, 16, 17), strict=True))
"""Figures of the paper."""


CASES = (RunningIn("running-in"),)
