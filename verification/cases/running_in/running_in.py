# SPDX-License-Identifier: MIT
"""Running-in: the five cases of Bosman & Schipper (2011), Figs. 13-17, against what the paper says
of them: on ten surfaces with the printed inputs, and beside it in a second reading of what the
paper leaves open; on one surface with finer cells.

Rows are for what must be so: sums that agree, cycles that are complete, friction between its two
coefficients. What the paper says of its own surface is judged in a table, beside the pressures at
which a film fails and metal is removed, which decide it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from sam.scene import Result, Scene
from verification.cases.case import Context, Measured, Plot, SmallTable, View, with_grid, with_keys
from verification.cases.running_in import study
from verification.cases.running_in.study import BULK, CUBIC, GIGA, LAST, NAMES, A, B, Effort, Run, Study
from verification.compare.running_in_measures import Limits
from verification.figures.lines import over_cycles, yield_profiles
from verification.figures.running_in import regime_map, six_panels
from verification.reference.regime import regime

if TYPE_CHECKING:
    from pandas import DataFrame

PRINTED, RENEWED, OTHER = "printed inputs", "renewed", "other assumptions"
READINGS = {
    PRINTED: "with the printed inputs",
    RENEWED: "weakly hardening layer, renewed counter-surface",
}
"""How the paper is read: with its numbers, by our plastic loop, or see `renewed` -> for the reader."""
SHOWN = 2  # the seed of the scenes
FULL = Effort(LAST, steps=10, cells=64, seeds=tuple(range(1, 11)))
EFFORTS = {
    "quick": {PRINTED: Effort(3, 3, 32, (B,), (SHOWN,)), RENEWED: Effort(3, 2, 32, (A,), (SHOWN,))},
    "full": {PRINTED: FULL, RENEWED: FULL},
}
FIRST_CYCLES = 5  # of running-in; the later ones are steadier
FIGURES = dict(zip(NAMES, (13, 14, 15, 16, 17), strict=True))
"""Figures of the paper."""
DEEP = 2e-6  # m: how far down the yield stress is drawn; the profiles end above


def renewed(scene: Scene) -> Scene:
    """The second reading: the layer hardens little; the counter-surface is rough and another one
    in each cycle; layers of cells reach deeper.
    """
    scene = study.deeper(
        study.with_counter(study.with_layer_alpha(scene, study.LAYER_ALPHA), study.ROUGHNESS["sq"])
    )
    return scene.model_copy(update={"title": f"{scene.title}, {READINGS[RENEWED]}"})


def varied_scenes(bases: Mapping[str, Scene], curve_c: Scene) -> dict[str, tuple[str, Scene]]:
    """Name for the reader -> (label of the run, scene): what the paper leaves open, one at a time."""
    bulk, own = bases[BULK], bases[B]
    scenes = {"curve C": ("curve-c", study.with_plasticity(own, profile=curve_c.body.plasticity.profile))}
    for scale in (0.8, 1.25):
        name = f"curve B, deviation × {scale:g}"
        scenes[name] = f"curve-b-deviation-{scale:g}", study.with_deviation(own, scale)
    for case in (BULK, B):
        name = f"{NAMES[case]}, B = {study.LITERATURE_B / 1e6:g} MPa"
        scenes[name] = f"{case}-1280", study.deeper(study.with_plasticity(bases[case], B=study.LITERATURE_B))
    for window in (0, 3, 7):  # cells; the scenes have 5
        changed = with_keys(bulk, "wear", smoothing_window=window)
        scenes[f"bulk, window {window}"] = f"bulk-window-{window}", changed
    return scenes


def limits_of(scene: Scene) -> tuple[Limits, Limits]:
    """With the scene's own constant B, and with that of the literature."""
    return Limits.of(scene), Limits.of(study.with_constant(scene, study.LITERATURE_B))


def alike(one: Run) -> bool:
    """Whether each cycle meets the same counter-surface."""
    rough = one.scene.counterbody.surface
    return rough is None or not rough.renewed


def iterations_of(result: Result) -> tuple[list[float], list[float]]:
    """Plastic iterations of each cycle to the fifth (of a short run: of all but the last), and of
    those after it.
    """
    history = result.tables["history"]
    cycle, iterations = (np.asarray(history[name], dtype=float) for name in ("cycle", "iterations"))
    per_cycle = [float(iterations[cycle == k].sum()) for k in np.unique(cycle)]
    split = min(FIRST_CYCLES, len(per_cycle) - 1)
    return per_cycle[:split], per_cycle[split:]


def later_over_early(one: Run) -> float:
    """Plastic iterations, each with an application of the operator of residual stress: mean of
    later cycles over the first, where each meets the same counter-surface.
    """
    early, later = iterations_of(one.result)
    return float(np.mean(later) / np.mean(early)) if alike(one) else 0.0


def missing_cycles(one: Run) -> int:
    """Cycles without a row, rows out of order, and numbers that are missing in them."""
    wanted, cycle = np.arange(1, one.scene.loading.cycles + 1), one.of_cycles("cycle")
    if not np.array_equal(cycle, wanted):
        return max(1, abs(wanted.size - cycle.size))
    return sum(int(np.isnan(one.of_cycles(name)).sum()) for name in one.result.tables["cycles"])


def restless_cycles(one: Run) -> int:
    """Cycles that strain or wear the body after one that did neither, where each meets the same
    counter-surface.
    """
    busy = (one.of_cycles("new_strain_max") != 0.0) | (one.of_cycles("wear_of_cycle_m3") != 0.0)
    return int((busy & (np.cumsum(~busy) > 0)).sum()) if alike(one) else 0


LARGEST: Mapping[str, Callable[[Run], float]] = {
    "volume": lambda one: one.off,
    "friction-sum": lambda one: abs(one.scar.coefficient(*one.friction) - one.history.friction[-1]),
    "protected": lambda one: abs(one.scar.protected_fraction(*one.friction) - one.history.protected[-1]),
    "load": lambda one: study.apart(one.scar.force, one.scene.loading.force),
    "iterations": later_over_early,
    "friction-range": lambda one: study.outside(one.history.friction, *one.friction),
}
COUNTS: Mapping[str, Callable[[Run], int]] = {
    "cycles": missing_cycles,
    "falls": lambda one: int((np.diff(one.history.volume, prepend=0.0) < 0.0).sum()),
    "added": lambda one: int((one.scar.worn < 0.0).sum()),
    "repeats": restless_cycles,
}
"""Row -> its number of a run, of which the row holds the largest, or the sum. Sums are over surface.csv of
the last cycle, against cycles.csv.
"""


class RunningIn(Study):
    """Every material on every surface in both readings, and what is varied of the printed inputs;
    rows over all of them, statements over those that converged.
    """

    parts = ("reading", "material", "surface")

    def scenes(self, context: Context) -> dict[Any, Scene]:
        found = {}
        for reading, effort in EFFORTS[context.level].items():
            printed = study.printed_scenes(context, effort)
            for seed, (case, scene) in ((k, each) for k in effort.seeds for each in printed.items()):
                scene = study.with_seed(scene, seed)
                found[reading, case, seed] = renewed(scene) if reading == RENEWED else scene
        if context.level == "full":
            others = varied_scenes(printed, context.scene("running-in-curve-c"))
            found |= {(OTHER, name, label): scene for name, (label, scene) in others.items()}
        return found

    def label(self, key: tuple[str, str, int | str]) -> str:
        reading, case, seed = key
        return str(seed) if reading == OTHER else led(reading, f"{case}-seed-{seed}")

    def solve(self, context: Context) -> DataFrame:
        return study.framed(self.runs(context), self.parts)

    def measure(self, found: DataFrame) -> dict[str, Measured]:
        good = found[found["converged"]]["run"]
        values = {name: Measured(float(good.map(of).max(skipna=False))) for name, of in LARGEST.items()}
        values |= {name: Measured(sum(map(of, good)), 0) for name, of in COUNTS.items()}
        return values | {"unconverged": Measured(len(found) - len(good), 0)}

    def setup(self, found: DataFrame) -> Iterator[tuple[str, str]]:
        first = found.drop_duplicates("reading").set_index("reading")["run"]
        scene, second = first[PRINTED].scene, first[RENEWED].scene
        load, rough = scene.loading, second.counterbody.surface
        seeds = dict.fromkeys(found.loc[found["reading"] == PRINTED, "surface"])
        waves = f"waves of {scene.surface.cutoff_short * 1e6:g} µm and more"
        made = f"hard-turned, Ra = {scene.surface.ra * 1e6:g} µm, {waves}; seeds {', '.join(map(str, seeds))}"
        yield "Surface", made
        size = "{0:g} × {0:g} µm, {1} × {1} cells".format(1e6 * scene.grid.extent[0], scene.grid.cells[0])
        yield "Patch", f"{size}, {len(scene.grid.depths) - 1} layers, the first 0.1 µm"
        yield (
            "Load",
            f"{load.force:g} N, {load.cycles} cycles of {load.steps} + {load.steps} steps, flat steel above",
        )
        tables = "the layers' yield stress over depth (curve-*.csv, hardening-only.csv)"
        yield "Assumed", f"{tables}, window and order of smoothing"
        layer, depths = f"a layer with {study.LAYER_ALPHA:g} ε in place of 10⁶ ε", second.grid.depths
        above = f"a counter-surface of {1e9 * rough.sq:g} nm rms, another one in each cycle"
        deep = f"{len(depths) - 1} layers, to {1e6 * depths[-1]:g} µm"
        yield "Second reading", f"{layer}; {above}; {deep}; for curve B: running-in-renewed.toml"

    def data(self, found: DataFrame) -> dict[str, Any]:
        said = {"statements": readings_of(found), "second_reading": READINGS[RENEWED]}
        for name, of in (("regimes", regimes), ("last_cycle", last_cycles)):
            said[name] = {
                reading: {NAMES[case]: own for case, own in of(found, reading).items()}
                for reading in READINGS
            }
        return said

    def tables(self, found: DataFrame) -> Iterator[SmallTable]:
        if statements := readings_of(found):
            yield study.statements_table(statements)
        last = found["run"].iloc[0].scene.loading.cycles
        for reading, own in found.groupby("reading", sort=False):
            words = READINGS.get(reading, f"{reading} on the surface of the scenes").capitalize()
            groups = {
                NAMES.get(case, case): runs for case, runs in own.groupby("material", sort=False)["run"]
            }
            yield study.runs_table(f"{words}, cycles 1, {min(study.EARLY, last)} and {last}", groups)
        for reading in READINGS:
            yield regimes_table(found, reading)

    def notes(self, found: DataFrame) -> Iterator[str]:
        yield "The paper's surface and curves of Fig. 9 are not public: a failed statement is a finding."
        named = {
            f"{NAMES[case]}, surface {seed}, {of}" if of != OTHER else case: one
            for of, case, seed, one in found[[*self.parts, "run"]].itertuples(index=False)
        }
        if scars := {name: one.scar for name, one in named.items() if one.result.converged}:
            yield lost_height_note(scars)
        depths = {name: one.scene.grid.depths[-1] for name, one in named.items() if one.again}
        if words := "; ".join(f"{name}, to {depth * 1e6:g} µm" for name, depth in depths.items()):
            yield f"Run again with deeper layers, as the plastic zone reached the last one: {words}."
        if words := "; ".join(
            f"{name}: {one.result.status} after {len(one.of_cycles('cycle'))} cycles"
            for name, one in named.items()
            if not one.result.converged
        ):
            yield f"Not converged, and counted as surfaces on which a statement says nothing: {words}."
        if any(each["held_above"] for reading in READINGS for each in regimes(found, reading).values()):
            yield (
                "Failed cells that bear more than what removes them and yet hold are spots of a cell or two: "
                "√3 μ p is the stress at z = 0, and in the first layer of cells the neighbours hold such a "
                "spot. The friction that remains is that of a grid of 1 µm."
            )

    def figures(self, found: DataFrame) -> Iterator[Plot]:
        good = found[found["converged"]]
        if good.empty:
            return
        yield readings_plot(good)
        for reading, words in READINGS.items():
            shown = {case: own["run"].iloc[0] for case, own in shown_of(good, reading)}
            if not shown:
                continue
            yield yield_plot(found, reading)
            yield regimes_plot(found, reading)
            for case, one in shown.items():
                seed = one.scene.surface.seed
                yield Plot(
                    six_panels(one.scar, one.history, one.friction),
                    led(reading, case),
                    f"Running-in, {NAMES[case]}, {words}",
                    f"Six panels of {NAMES[case]}: worn depth, worn surface, volume and friction over "
                    "cycles, local friction, pressure.",
                    f"As the paper's Fig. {FIGURES[case]}, on our surface {seed} alone. (a) "
                    "and (b) after the last cycle, (e) and (f) at its peak; grey: not worn, or no contact.",
                )

    def views(self, found: DataFrame) -> Iterator[View]:
        for reading, words in READINGS.items():
            for case, own in shown_of(found[found["converged"]], reading):
                yield View(
                    self.label((reading, case, own["surface"].iloc[0])),
                    "worn",
                    f"{led(reading, case)}-worn",
                    f"Worn surface over the original, {NAMES[case]}, {words}",
                    f"The rough surface of {NAMES[case]} in space, coloured by the depth worn; the original "
                    "surface above it is transparent.",
                    f"As the paper's Fig. {FIGURES[case]}b, on our surface, after the last cycle; {words}.",
                )


def led(reading: str, name: str) -> str:
    """A name of a file, led by that of the reading unless it is that of the printed inputs."""
    return name if reading == PRINTED else f"{reading}-{name}"


def shown_of(good: DataFrame, reading: str) -> Iterator[tuple[str, DataFrame]]:
    """Each material with its runs, that on the surface of the scenes first, where it is among
    them.
    """
    own = good[good["reading"] == reading]
    own = own.sort_values("surface", key=lambda seeds: seeds != SHOWN, kind="stable")
    yield from ((case, own[own["material"] == case]) for case in NAMES if (own["material"] == case).any())


def readings_of(found: DataFrame) -> dict[str, list[dict[str, Any]]]:
    """Reading, or size of cells -> what is told of the statements; none with fewer cycles than
    they ask for.
    """
    return {
        reading: study.judged(study.measured(own, ["surface"]))
        for reading, own in found.groupby("reading", sort=False)
        if reading != OTHER and own["run"].iloc[0].scene.loading.cycles >= LAST
    }


def last_cycles(found: DataFrame, reading: str) -> dict[str, dict[str, list[float]]]:
    """Material -> of each surface the first cycle from which on no cell strains, NaN if the last
    one still does, and what the last cycle adds: largest new strain, number of cells that yield,
    wear in m3.
    """
    columns = {"strain": "new_strain_max", "cells": "yielding_cells", "wear_m3": "wear_of_cycle_m3"}
    good = found[found["converged"] & (found["reading"] == reading)]
    return {
        case: {"rest_from": [study.at_rest_from(one.of_cycles("new_strain_max")) for one in runs]}
        | {name: [float(one.of_cycles(column)[-1]) for one in runs] for name, column in columns.items()}
        for case, runs in good.groupby("material", sort=False)["run"]
    }


def regimes(found: DataFrame, reading: str) -> dict[str, dict[str, Any]]:
    """Material -> the pressures in Pa at which films fail and metal is removed, the largest in the
    first cycle, the median of the surfaces, and of all surfaces the cells with a failed film at
    the last peak and those of them whose pressure removes a wide spot in the first layer.
    """
    values = {}
    for case, runs in found[found["reading"] == reading].groupby("material", sort=False)["run"]:
        own, other = limits_of(runs.iloc[0].scene)
        good = [one for one in runs if one.result.converged]
        failed = [(one.scar.unprotected(*one.friction), one.scar.p) for one in good]
        values[case] = {
            "strength": own.strength,
            "removed_from": own.removal,
            "with_other_B": other.removal,
            "first_layer": own.first,
            "removed_whole": own.removal_whole,
            "film_fails_from": own.film,
            "reached": float(np.median([one.history.p_max[0] for one in good])) if good else float("nan"),
            "held_above": sum(int((bare & (p > own.first)).sum()) for bare, p in failed),
            "failed": sum(int(bare.sum()) for bare, _ in failed),
        }
    return values


def regimes_table(found: DataFrame, reading: str) -> SmallTable:
    """What decides: the pressures at which films fail and metal is removed, against the largest
    there is.
    """
    rows = []
    for case, own in regimes(found, reading).items():
        *pressures, above, failed = own.values()
        numbers = ("–" if np.isnan(number) else f"{GIGA * number:.2f}" for number in pressures)
        ends = own["reached"], own["film_fails_from"], own["removed_from"]
        so = "no run converged" if np.isnan(own["reached"]) else str(regime(*ends))
        rows.append((NAMES[case], *numbers, f"{above} of {failed}", so))
    columns = (
        "case|σ_y(limit) at the surface|removed from, μ high|with the other B|in the first layer of cells"
        "|removed from, μ low|film fails from|p_max, first cycle|failed cells above it, last peak|so"
    )
    words = "pressures in GPa at which films fail and the traction removes metal"
    return SmallTable(f"What decides, {READINGS[reading]}: {words}", columns.split("|"), rows)


def lost_height_note(scars: Mapping[str, Any]) -> str:
    """How much of the relief is worn away where most is. scars: by name of the run, at least one."""
    depths = {name: float(np.nanmax(scar.worn)) for name, scar in scars.items()}
    lost = {name: depth / float(np.ptp(scars[name].height)) for name, depth in depths.items()}
    most = max(lost, key=lambda name: lost[name])
    half, whole = (sum(share > limit for share in lost.values()) for limit in (0.5, 1.0))
    return (
        f"Worn depth over relief (highest less lowest place before any wear): above a half in {half} of "
        f"{len(lost)} runs, above one in {whole}; the most is {lost[most]:.2f}, {1e6 * depths[most]:.3g} of "
        f"{1e6 * np.ptp(scars[most].height):.3g} µm ({most})."
        + " How far the flat surface of the model is off below such scars is not known."
        * (half > 0)
    )


def readings_plot(good: DataFrame) -> Plot:
    """Both readings over the cycles."""
    panels: dict[tuple[str, str], dict[tuple[str, str], np.ndarray]] = {}
    for row, name, scale in (
        ("wear volume [µm³]", "volume", CUBIC),
        ("coefficient of friction", "friction", 1.0),
        ("Sa [nm]", "sa", 1e9),
    ):
        for case, reading in ((c, r) for c in NAMES for r in READINGS):
            own = good[(good["material"] == case) & (good["reading"] == reading)]["run"]
            lines = [scale * getattr(one.history, name) for one in own]
            named = dict(enumerate(lines, start=1)) | ({"median": np.median(lines, axis=0)} if lines else {})
            if (good["material"] == case).any():
                panel = panels.setdefault((row, NAMES[case]), {})
                panel |= {(READINGS[reading], str(k)): line for k, line in named.items()}
    return Plot(
        over_cycles(panels, ("reading", "surface"), thick="median", first=1),
        "readings",
        "Both readings of the paper over the cycles",
        "Volume, friction and roughness over the cycles, a column for each case, a line for each reading.",
        "Thick: median of the surfaces; thin: each surface. Sa of the unloaded surface after each cycle.",
    )


def yield_plot(found: DataFrame, reading: str) -> Plot:
    """The yield stress over depth of each material."""
    own = found[found["reading"] == reading].drop_duplicates("material")
    scenes = {NAMES[case]: one.scene for case, one in zip(own["material"], own["run"], strict=True)}
    return Plot(
        yield_profiles({name: each.body.plasticity.strength().stress for name, each in scenes.items()}, DEEP),
        led(reading, "yield"),
        f"Yield stress over depth, {READINGS[reading]}",
        "Curves of the yield stress over depth, one for each case, before any plastic strain and after 1 %.",
        "After the paper's Fig. 9, which has no numbers: the shape of the profiles is from it, their size is "
        "assumed. The line of a case may lie on that of another.",
    )


def regimes_plot(found: DataFrame, reading: str) -> Plot:
    """Where films fail and metal is removed."""
    limits, reached = {}, {}
    for case, own in found[found["reading"] == reading].groupby("material", sort=False):
        scene = own["run"].iloc[0].scene
        limits[NAMES[case]] = limits_of(scene)
        if good := [one.history.p_max for one in own["run"] if one.result.converged]:
            reached[NAMES[case]] = tuple(float(np.median([p[k] for p in good])) for k in (0, -1))
    constants = [f"B = {each / 1e6:g} MPa" for each in (scene.body.plasticity.B, study.LITERATURE_B)]
    return Plot(
        regime_map(limits, reached, (scene.friction.low, scene.friction.high), constants),
        led(reading, "regimes"),
        f"Where films fail and metal is removed, {READINGS[reading]}",
        "Map of pressure against friction and against strength: zones where the film is whole, has "
        "failed, and metal is removed.",
        "Lines: √3 μ p = σ_y(limit), above which the traction alone removes the surface. Dash-dotted: "
        "the film fails. Right: full marks at the strength of each case, open ones with the other B; "
        "arrows: median of the surfaces.",
    )


EFFORT = Effort(LAST, steps=3, cells=32, seeds=(SHOWN,))
WINDOWS = {32: 5, 70: 11}
"""Cells along a side of 32 um -> in the window of smoothing, which is 5 um long: 12 and 26 cells in the
shortest wave of 12 um, where wear-converged asks for 24.
"""
SIZES = {f"{EFFORT.cells / cells:.3g} µm": cells for cells in WINDOWS}


class RunningInCells(Study):
    """All materials on a quarter of the printed area, on both sizes of cells, which stand for
    readings.
    """

    parts = RunningIn.parts

    def scenes(self, context: Context) -> dict[Any, Scene]:
        return {
            (size, case, seed): with_keys(
                with_grid(study.with_seed(scene, seed), cells=(cells, cells)),
                "wear",
                smoothing_window=WINDOWS[cells],
            )
            for size, cells in SIZES.items()
            for case, scene in study.printed_scenes(context, EFFORT).items()
            for seed in EFFORT.seeds
        }

    def label(self, key: tuple[str, str, int]) -> str:
        size, case, seed = key
        return f"{case}-surface-{seed}-cells-{SIZES[size]}"

    def ahead(self, context: Context) -> Iterator[Scene]:
        yield from reversed(self.scenes(context).values())

    def solve(self, context: Context) -> DataFrame:
        return study.framed(self.runs(context), self.parts)

    def measure(self, found: DataFrame) -> dict[str, Measured]:
        good = found[found["converged"]]["run"]
        every = len(SIZES) * len(NAMES) * len(EFFORT.seeds)
        volume = Measured(float(good.map(LARGEST["volume"]).max(skipna=False)))
        return {"missing": Measured(every - len(good), 0), "volume": volume}

    def data(self, found: DataFrame) -> dict[str, Any]:
        return {"statements": readings_of(found)}

    def tables(self, found: DataFrame) -> Iterator[SmallTable]:
        yield study.statements_table(readings_of(found))
        groups = found.groupby(["material", "reading"], sort=False)["run"]
        named = {f"{NAMES[case]}, {size}": runs for (case, size), runs in groups}
        yield study.runs_table("Runs on both sizes of cells", named)

    def notes(self, found: DataFrame) -> Iterator[str]:
        changed = [
            f"{one['statement']}: {one['by_median']}, then {other['by_median']}"
            for one, other in zip(*readings_of(found).values(), strict=True)
            if one["by_median"] != other["by_median"]
        ]
        yield f"Verdicts by the median that finer cells change: {'; '.join(changed) or 'none'}."
        yield "One surface of a quarter of the printed area: this shows what cells do, no probability."


CASES = (RunningIn("running-in"), RunningInCells("running-in-cells"))
