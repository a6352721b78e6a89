# SPDX-License-Identifier: MIT
"""Running-in: the five cases of Bosman & Schipper (2011), Figs. 13-17, on ten surfaces, against what the
paper says of them; with the printed inputs, and beside it a second reading of what the paper leaves open.

Rows are for what must be so: sums that agree, cycles that are complete, friction between its two
coefficients. What the paper says of its own surface is judged in a table, beside the pressures at which a
film fails and metal is removed, which decide it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from sam.scene import Result, Scene
from verification.cases.case import Context, Measured, Plot, SmallTable, View, with_keys
from verification.cases.running_in.scenes import (
    BULK,
    LAST,
    LAYER_ALPHA,
    LITERATURE_B,
    NAMES,
    A,
    B,
    Effort,
    Reading,
    deeper,
    printed_scenes,
    renewed,
    with_constant,
    with_deviation,
    with_plasticity,
    with_seed,
)
from verification.cases.running_in.study import (
    CUBIC,
    EARLY,
    GIGA,
    Judged,
    Run,
    Study,
    apart,
    good,
    judged,
    outside,
    solved,
    spread,
    statements_table,
)
from verification.compare.running_in_measures import History, Limits, Scar
from verification.figures.lines import over_cycles, yield_profiles
from verification.figures.running_in import regime_map, six_panels
from verification.reference.regime import Regime, regime

SHOWN = 2  # the seed of the scenes
FULL = Effort(LAST, steps=10, cells=64, seeds=tuple(range(1, 11)))
EFFORTS = {
    "quick": {
        Reading.PRINTED: Effort(3, 3, 32, (B,), (SHOWN,)),
        Reading.RENEWED: Effort(3, 2, 32, (A,), (SHOWN,)),
    },
    "full": {Reading.PRINTED: FULL, Reading.RENEWED: FULL},
}
FIRST_CYCLES = 5  # of running-in; the later ones are steadier
FIGURES = dict(zip(NAMES, (13, 14, 15, 16, 17), strict=True))
"""Figures of the paper."""
DEEP = 2e-6  # m: how far down the yield stress is drawn; the profiles end above


@dataclass(frozen=True)
class Found:
    """efforts: of each reading; bases: reading and material -> its scene on the surface of the file; runs:
    reading, material and surface -> what ran; varied: on one surface, other assumptions by name.
    """

    efforts: Mapping[Reading, Effort]
    bases: Mapping[tuple[Reading, str], Scene]
    runs: Mapping[tuple[Reading, str, int], Run]
    varied: Mapping[str, Run]

    def of(self, reading: Reading, case: str, *, lost: bool = False) -> dict[int, Run]:
        """Surface -> the run of a material that converged, or with those that are lost."""
        own = {seed: one for (of, name, seed), one in self.runs.items() if (of, name) == (reading, case)}
        return own if lost else good(own)

    def cases(self, reading: Reading) -> dict[str, dict[int, Run]]:
        """Material -> see `of`, of those with a run that converged."""
        return {case: runs for case in NAMES if (runs := self.of(reading, case))}

    def limits(self, reading: Reading) -> dict[str, tuple[Limits, Limits]]:
        """Material -> limits with the constant B of its scene and with that of the literature."""
        return {case: limits_of(scene) for (of, case), scene in self.bases.items() if of is reading}

    @cached_property
    def judged(self) -> dict[Reading, list[Judged]]:
        """The statements of the paper; none with fewer cycles."""
        return {
            reading: judged(
                [
                    {c: runs[seed].history for c, runs in self.cases(reading).items() if seed in runs}
                    for seed in effort.seeds
                ]
            )
            for reading, effort in self.efforts.items()
            if effort.cycles >= LAST
        }

    @property
    def named(self) -> dict[str, Run]:
        """Every run by its name for the reader."""
        named = {
            f"{NAMES[case]}, surface {seed}, {of.short}": one for (of, case, seed), one in self.runs.items()
        }
        return named | dict(self.varied)


def limits_of(scene: Scene) -> tuple[Limits, Limits]:
    """With the scene's own constant B, and with that of the literature."""
    return Limits.of(scene), Limits.of(with_constant(scene, LITERATURE_B))


def varied_scenes(bases: Mapping[str, Scene], curve_c: Scene) -> dict[str, tuple[str, Scene]]:
    """Name for the reader -> (label of the run, scene): what the paper leaves open, one at a time."""
    bulk, own = bases[BULK], bases[B]
    scenes = {"curve C": ("curve-c", with_plasticity(own, profile=curve_c.body.plasticity.profile))}
    for scale in (0.8, 1.25):
        name = f"curve B, deviation × {scale:g}"
        scenes[name] = f"curve-b-deviation-{scale:g}", with_deviation(own, scale)
    for case in (BULK, B):
        name = f"{NAMES[case]}, B = {LITERATURE_B / 1e6:g} MPa"
        scenes[name] = f"{case}-1280", deeper(with_plasticity(bases[case], B=LITERATURE_B))
    for window in (0, 3, 7):  # cells; the scenes have 5
        scenes[f"bulk, window {window}"] = (
            f"bulk-window-{window}",
            with_keys(bulk, "wear", smoothing_window=window),
        )
    return scenes


class RunningIn(Study):
    """Every material on every surface in both readings; then what is varied of the printed inputs; rows over
    all of them, statements over those that converged.
    """

    def scenes(self, context: Context) -> dict[Any, Scene]:
        found = {}
        for reading, effort in EFFORTS[context.level].items():
            printed = printed_scenes(context, effort)
            found |= {
                (reading, case, seed): read_as(reading, with_seed(scene, seed))
                for seed in effort.seeds
                for case, scene in printed.items()
            }
        return found

    def label(self, key: tuple[Reading, str, int]) -> str:
        reading, case, seed = key
        return led(reading, f"{case}-seed-{seed}")

    def solve(self, context: Context) -> Found:
        efforts = EFFORTS[context.level]
        bases = {
            (reading, case): read_as(reading, scene)
            for reading, effort in efforts.items()
            for case, scene in printed_scenes(context, effort).items()
        }
        runs, varied = self.runs(context), {}
        if context.level == "full":
            own = {case: scene for (reading, case), scene in bases.items() if reading is Reading.PRINTED}
            others = varied_scenes(own, context.scene("running-in-curve-c"))
            varied = {name: solved(context, scene, label) for name, (label, scene) in others.items()}
        return Found(efforts, bases, runs, varied)

    def measure(self, found: Found) -> dict[str, Measured]:
        return measured([*found.runs.values(), *found.varied.values()])

    def setup(self, found: Found) -> Iterator[tuple[str, str]]:
        scene, effort = next(iter(found.bases.values())), found.efforts[Reading.PRINTED]
        film, rough, steel, wear = scene.friction, scene.surface, scene.body.plasticity, scene.wear
        law = f"σ_y = {steel.B / 1e6:g} MPa ({steel.C:g} + 10⁶ ε)^{steel.n:g}"
        yield "Body", f"E = {scene.body.young / 1e9:g} GPa, {law}"
        waves, seeds = f"waves of {rough.cutoff_short * 1e6:g} µm and more", ", ".join(map(str, effort.seeds))
        yield "Surface", f"hard-turned, Ra = {rough.ra * 1e6:g} µm, {waves}; seeds {seeds}"
        size = "{0:g} × {0:g} µm, {1} × {1} cells".format(1e6 * scene.grid.extent[0], effort.cells)
        yield "Patch", f"{size}, {len(scene.grid.depths) - 1} layers, the first 0.1 µm"
        steps = f"{effort.cycles} cycles of {effort.steps} + {effort.steps} steps, flat steel above"
        yield "Load", f"{scene.loading.force:g} N, {steps}"
        fails = f"yields at {film.film_yield / 1e9:.3g} GPa, fails beyond {film.thinning_limit:.2%} a cycle"
        yield "Film", f"{film.film_thickness * 1e9:g} nm, {fails}"
        yield "Friction", f"{film.low:g} below a whole film, {film.high:g} where it has failed"
        limits = f"beyond {wear.strain_limit:.1%} of plastic strain, in a layer 2 % or 5 %"
        yield "Wear", f"{limits}; window {wear.smoothing_window}"
        tables = "the layers' yield stress over depth (curve-*.csv, hardening-only.csv)"
        yield "Assumed", f"{tables}, window and order of smoothing"
        scene = next(scene for (reading, _), scene in found.bases.items() if reading is Reading.RENEWED)
        rough, depths = scene.counterbody.surface, scene.grid.depths
        yield "Second reading", f"{Reading.RENEWED}; for curve B: running-in-renewed.toml"
        yield "Layer", f"down to 1 µm σ_y with {LAYER_ALPHA:g} ε in place of 10⁶ ε, bulk with the printed 10⁶"
        waves = f"waves of {1e6 * rough.cutoff_short:g} to {1e6 * rough.cutoff_long:g} µm"
        yield "Counter-surface", f"{1e9 * rough.sq:g} nm rms, {waves}, another one in each cycle"
        yield "Grid", f"{len(depths) - 1} layers, to {1e6 * depths[-1]:g} µm"

    def data(self, found: Found) -> dict[str, Any]:
        def named(of: Callable[[Found, Reading], Mapping[str, Any]]) -> dict[str, dict[str, Any]]:
            every = {each.short: of(found, each).items() for each in found.efforts}
            return {name: {NAMES[case]: own for case, own in values} for name, values in every.items()}

        statements = {of.short: [one.data for one in each] for of, each in found.judged.items()}
        said = {"statements": statements, "second_reading": str(Reading.RENEWED)}
        return said | {"regimes": named(regimes), "last_cycle": named(last_cycles)}

    def tables(self, found: Found) -> Iterator[SmallTable]:
        if len(found.judged) == len(found.efforts):
            yield statements_table({reading.short: each for reading, each in found.judged.items()})
        for reading in found.efforts:
            yield cases_table(found, reading)
        yield new_strain_table(found)
        for reading in found.efforts:
            yield regimes_table(found, reading)
        if found.varied:
            yield varied_table(found)
        yield cost_table(found)

    def notes(self, found: Found) -> Iterator[str]:
        if Reading.PRINTED in found.judged:
            yield FINDINGS_NOTE
            yield REST_NOTE
        named = found.named
        if scars := {name: one.scar for name, one in good(named).items()}:
            yield lost_height_note(scars)
        depths = {key: one.scene.grid.depths for key, one in found.runs.items()}
        if words := "; ".join(
            f"{NAMES[case]}, surface {seed}, {of.short}, to {own[-1] * 1e6:g} µm"
            for (of, case, seed), own in depths.items()
            if own != found.bases[of, case].grid.depths
        ):
            yield (
                "The plastic zone reached the last layer, and the run was made again with deeper ones: "
                f"{words}."
            )
        if words := "; ".join(
            f"{name}: {one.result.status} after {len(one.of_cycles('cycle'))} cycles"
            for name, one in named.items()
            if not one.result.converged
        ):
            yield f"Not converged, and counted as surfaces on which a statement says nothing: {words}."
        if any(each["held_above"] for of in found.efforts for each in regimes(found, of).values()):
            yield HELD_NOTE

    def figures(self, found: Found) -> Iterator[Plot]:
        readings = {
            of: {c: [one.history for one in r.values()] for c, r in found.cases(of).items()}
            for of in found.efforts
        }
        cases = [case for case in NAMES if any(case in each for each in readings.values())]
        if not cases:
            return
        yield readings_plot(
            {NAMES[case]: {str(of): own.get(case, []) for of, own in readings.items()} for case in cases}
        )
        for reading in readings:
            shown = {case: main_seed(own) for case, own in found.cases(reading).items()}
            if not shown:
                continue
            yield yield_plot(found, reading)
            yield regimes_plot(found, reading)
            for case, seed in shown.items():
                one = found.runs[reading, case, seed]
                yield Plot(
                    six_panels(one.scar, one.history, one.friction),
                    led(reading, case),
                    f"Running-in, {NAMES[case]}, {reading}",
                    f"Six panels of {NAMES[case]}: worn depth, worn surface, volume and friction over "
                    "cycles, local friction, pressure.",
                    f"As the paper's Fig. {FIGURES[case]}, on our surface {seed} alone: its numbers differ "
                    "from the medians of all surfaces. (a) and (b) after the last cycle, (e) and (f) at its "
                    "peak; grey: not worn, or no contact.",
                )

    def views(self, found: Found) -> Iterator[View]:
        for reading in found.efforts:
            for case, own in found.cases(reading).items():
                yield View(
                    self.label((reading, case, main_seed(own))),
                    "worn",
                    f"{led(reading, case)}-worn",
                    f"Worn surface over the original, {NAMES[case]}, {reading}",
                    f"The rough surface of {NAMES[case]} in space, coloured by the depth worn; the original "
                    "surface above it is transparent.",
                    f"As the paper's Fig. {FIGURES[case]}b, on our surface, after the last cycle; {reading}.",
                )


def read_as(reading: Reading, scene: Scene) -> Scene:
    """The scene in one of the readings."""
    return renewed(scene) if reading is Reading.RENEWED else scene


def led(reading: Reading, name: str) -> str:
    """A name of a file, led by that of the reading unless it is that of the printed inputs."""
    return name if reading is Reading.PRINTED else f"{reading.short}-{name}"


def main_seed(runs: Mapping[int, Run]) -> int:
    """The surface that is drawn: that of the scenes, or the first there is."""
    return SHOWN if SHOWN in runs else next(iter(runs))


def measured(runs: Sequence[Run]) -> dict[str, Measured]:
    """Worst of all runs. Sums are over surface.csv of the last cycle, against cycles.csv."""
    whole = [one for one in runs if one.result.converged]
    sums: Mapping[str, Callable[[Run], float]] = {
        "volume": lambda one: one.off,
        "friction-sum": lambda one: abs(one.scar.coefficient(*one.friction) - one.history.friction[-1]),
        "protected": lambda one: abs(one.scar.protected_fraction(*one.friction) - one.history.protected[-1]),
        "load": lambda one: apart(one.scar.force, one.scene.loading.force),
        "iterations": later_over_early,
        "friction-range": lambda one: outside(one.history.friction, *one.friction),
    }
    counts: Mapping[str, Callable[[Run], int]] = {
        "cycles": missing_cycles,
        "falls": lambda one: int((np.diff(one.history.volume, prepend=0.0) < 0.0).sum()),
        "added": lambda one: int((one.scar.worn < 0.0).sum()),
        "repeats": restless_cycles,
    }
    values = {name: Measured(max(map(of, whole), default=float("nan"))) for name, of in sums.items()}
    values |= {name: Measured(sum(map(count, whole)), 0) for name, count in counts.items()}
    return values | {"unconverged": Measured(len(runs) - len(whole), 0)}


def iterations_of(result: Result) -> tuple[list[float], list[float]]:
    """Plastic iterations of each cycle to the fifth (of a short run: of all but the last), and of those after
    it.
    """
    history = result.tables["history"]
    cycle, iterations = (np.asarray(history[name], dtype=float) for name in ("cycle", "iterations"))
    per_cycle = [float(iterations[cycle == k].sum()) for k in np.unique(cycle)]
    split = min(FIRST_CYCLES, len(per_cycle) - 1)
    return per_cycle[:split], per_cycle[split:]


def later_over_early(one: Run) -> float:
    """Plastic iterations, each with an application of the operator of residual stress: mean of later cycles
    over the first, where each meets the same counter-surface.
    """
    early, later = iterations_of(one.result)
    return 0.0 if one.renewed else float(np.mean(later) / np.mean(early))


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
    return 0 if one.renewed else int((busy & (np.cumsum(~busy) > 0)).sum())


def spreads(groups: Mapping[str, Sequence[Run]], columns: Mapping[str, Callable[[Run], float]]) -> list:
    """Rows: name, and median and range over its runs of each column."""
    return [(name, *(spread(map(of, runs)) for of in columns.values())) for name, runs in groups.items()]


def cases_table(found: Found, reading: Reading) -> SmallTable:
    """Median and range over the surfaces."""
    last = found.efforts[reading].cycles
    early = min(EARLY, last)

    def at(column: str, cycle: int, scale: float = 1.0) -> Callable[[Run], float]:
        return lambda one: scale * one.history.at(column, cycle)

    columns = {
        "V, first [µm³]": at("volume", 1, CUBIC),
        "V, early": at("volume", early, CUBIC),
        "V, last": at("volume", last, CUBIC),
        "μ, first": at("friction", 1),
        "μ, last": at("friction", last),
        "Sa, first [nm]": at("sa", 1, 1e9),
        "Sa, last": at("sa", last, 1e9),
        "protected, last [%]": at("protected", last, 100.0),
        "p_max, first [GPa]": at("p_max", 1, GIGA),
        "p_max, last": at("p_max", last, GIGA),
    }
    words = f"median and range over the surfaces; early: after {early} cycles, last: after {last}"
    groups = {NAMES[case]: list(runs.values()) for case, runs in found.cases(reading).items()}
    return SmallTable(f"{reading.capitalize()}: {words}", ("case", *columns), spreads(groups, columns))


FINDINGS_NOTE = (
    "The measured surface and the curves of the paper's Fig. 9 are not public: a failed statement is a "
    "finding."
)
REST_NOTE = (
    "With the printed inputs, a cycle that neither strains nor wears the body is followed by cycles like it "
    "(gate repeats); from which cycle on that is so is a finding, as nothing in the model bounds it."
)
HELD_NOTE = (
    "Failed cells that bear more than what removes them and yet hold are narrow spots, of a cell or two: "
    "√3 μ p is the stress at z = 0, the first layer of cells lies below it, where such a spot is held by its "
    "neighbours. Worn surfaces touch in many of these: there the criterion is one for wider spots, and the "
    "friction that remains is that of a grid of 1 µm."
)


def last_cycles(found: Found, reading: Reading) -> dict[str, dict[str, list[float]]]:
    """Material -> of each surface the first cycle from which on no cell strains, NaN if the last one still
    does, and what the last cycle adds: largest new strain, number of cells that yield, wear in m3.
    """
    columns = {"strain": "new_strain_max", "cells": "yielding_cells", "wear_m3": "wear_of_cycle_m3"}
    return {
        case: {"rest_from": [at_rest_from(one.of_cycles("new_strain_max")) for one in runs.values()]}
        | {
            name: [float(one.of_cycles(column)[-1]) for one in runs.values()]
            for name, column in columns.items()
        }
        for case, runs in found.cases(reading).items()
    }


def at_rest_from(new_strain: np.ndarray) -> float:
    """The first cycle from which on no cell strains; NaN if the last one still does."""
    busy = np.flatnonzero(new_strain > 0.0)
    after = int(busy[-1]) + 1 if busy.size else 0
    return after + 1.0 if after < new_strain.size else float("nan")


def new_strain_table(found: Found) -> SmallTable:
    """What the last cycle adds."""
    columns, every = ["case"], {of: last_cycles(found, of) for of in found.efforts}
    none: dict[str, list[float]] = {"rest_from": [], "strain": [], "cells": [], "wear_m3": []}
    for of in every:
        columns += [
            f"{of.short}: strain anew in",
            "at rest from cycle",
            "largest new strain [%]",
            "cells",
            "worn [µm³]",
        ]
    rows = []
    for case in (case for case in NAMES if any(case in each for each in every.values())):
        row = [NAMES[case]]
        for own in (each.get(case, none) for each in every.values()):
            row.append(f"{sum(value > 0.0 for value in own['strain'])} of {len(own['strain'])}")
            row += [spread(own["rest_from"]), spread(own["strain"], 100.0), spread(own["cells"])]
            row.append(spread(own["wear_m3"], CUBIC))
        rows.append(row)
    return SmallTable(
        "What the last cycle adds: surfaces on which any cell strains plastically again, of the others the "
        "first cycle from which on none does; median and range of the largest new strain, of the number of "
        "cells that yield and of the wear of that cycle",
        columns,
        rows,
    )


def regimes(found: Found, reading: Reading) -> dict[str, dict[str, Any]]:
    """Material -> the pressures in Pa at which films fail and metal is removed, the largest in the first
    cycle, the median of the surfaces, and of all surfaces the cells with a failed film at the last peak and
    those of them whose pressure removes a wide spot in the first layer.
    """
    values = {}
    for case, (own, other) in found.limits(reading).items():
        runs = found.of(reading, case).values()
        failed = [(one.scar.unprotected(*one.friction), one.scar.p) for one in runs]
        reached = [one.history.at("p_max", 1) for one in runs]
        values[case] = {
            "strength": own.strength,
            "removed_from": own.removal,
            "with_other_B": other.removal,
            "first_layer": own.first,
            "removed_whole": own.removal_whole,
            "film_fails_from": own.film,
            "reached": float(np.median(reached)) if reached else float("nan"),
            "held_above": sum(int((bare & (p > own.first)).sum()) for bare, p in failed),
            "failed": sum(int(bare.sum()) for bare, _ in failed),
        }
    return values


def fate(removal: float, film: float, reached: float) -> str:
    """Of the spots with the largest pressure, in words."""
    if np.isnan(reached):
        return "no run converged"
    if removal <= film:
        return "every spot whose film fails is removed, unless it is one of few cells"
    above = f"{GIGA * removal:.2f} GPa"
    return {
        Regime.WHOLE: "no film fails",
        Regime.BARE: f"films fail, traction removes nothing ({GIGA * reached:.2f} < {above})",
        Regime.REMOVED: f"failed spots are removed above {above} only, films fail from {GIGA * film:.2f}",
    }[regime(reached, film, removal)]


def regimes_table(found: Found, reading: Reading) -> SmallTable:
    """What decides: the pressures at which films fail and metal is removed, against the largest there is."""
    rows = []
    for case, own in regimes(found, reading).items():
        *pressures, above, failed = own.values()
        numbers = ("–" if np.isnan(number) else f"{GIGA * number:.2f}" for number in pressures)
        so = fate(own["removed_from"], own["film_fails_from"], own["reached"])
        rows.append((NAMES[case], *numbers, f"{above} of {failed}", so))
    columns = (
        "case|σ_y(limit) at the surface|removed from, μ high|with the other B|in the first layer of cells"
    )
    columns += "|removed from, μ low|film fails from|p_max, first cycle|failed cells above it, last peak|so"
    words = "pressures in GPa at which films fail and the traction removes metal"
    return SmallTable(f"What decides, {reading}: {words}", columns.split("|"), rows)


def varied_table(found: Found) -> SmallTable:
    """One surface, other assumptions."""
    runs = {
        f"{NAMES[case]} as given": own[SHOWN]
        for case in NAMES
        if SHOWN in (own := found.of(Reading.PRINTED, case))
    }
    rows = []
    for name, one in (runs | good(found.varied)).items():
        history, last = one.history, int(one.history.cycle[-1])
        volumes = (f"{CUBIC * history.volume_after(cycle):.4g}" for cycle in (1, min(EARLY, last), last))
        friction = (f"{history.at('friction', cycle):.4f}" for cycle in (1, last))
        ends = f"{1e9 * history.at('sa', last):.1f}", f"{GIGA * history.at('p_max', last):.2f}"
        rows.append((name, f"{GIGA * Limits.of(one.scene).removal:.2f}", *volumes, *friction, *ends))
    columns = (
        "run|removed from [GPa]|V(1) [µm³]|V(6)|V, last|μ, first|μ, last|Sa, last [nm]|p_max, last [GPa]"
    )
    return SmallTable("Other assumptions on the surface of the scenes", columns.split("|"), rows)


def cost_table(found: Found) -> SmallTable:
    """Of the solves of each group, as they were when they were computed; median and range."""
    groups = {
        f"{NAMES[case]}, {of.short}": list(runs.values())
        for case in NAMES
        for of in found.efforts
        if (runs := found.of(of, case, lost=True))
    } | ({"other assumptions": list(found.varied.values())} if found.varied else {})

    def cost(key: str, scale: float = 1.0) -> Callable[[Run], float]:
        return lambda one: scale * float(one.result.cost.get(key) or 0.0)

    def a_cycle(key: str) -> Callable[[Run], float]:
        return lambda one: cost(key)(one) / (len(one.of_cycles("cycle")) or np.nan)

    def iterations(part: int) -> Callable[[Run], float]:
        return lambda one: float(np.mean(iterations_of(one.result)[part] or [np.nan]))

    columns = {
        "time of a cycle [s]": a_cycle("solve_s"),
        "CPU [s]": cost("cpu_s"),
        "memory [MiB]": cost("peak_memory_bytes", 2.0**-20),
        "operator applications a cycle": a_cycle("operator_applications"),
        f"plastic iterations a cycle, to the {FIRST_CYCLES}th": iterations(0),
        "later": iterations(1),
        "halved steps": cost("step_cuts"),
    }
    done = [f"{len(good(dict(enumerate(runs))))} of {len(runs)}" for runs in groups.values()]
    rows = [(name, of, *rest) for of, (name, *rest) in zip(done, spreads(groups, columns), strict=True)]
    words = "Cost on one core, median and range of the runs; memory: of the process so far"
    return SmallTable(words, ("runs", "converged", *columns), rows)


def lost_height_note(scars: Mapping[str, Scar]) -> str:
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


QUANTITIES = {
    "wear volume [µm³]": ("volume", CUBIC),
    "coefficient of friction": ("friction", 1.0),
    "Sa [nm]": ("sa", 1e9),
}
"""Rows of the figure of both readings, with the attribute of a history and its scale."""


def readings_plot(cases: Mapping[str, Mapping[str, Sequence[History]]]) -> Plot:
    """Name of a material -> reading -> its histories."""
    panels = {
        (row, name): {
            (reading, surface): values
            for reading, histories in readings.items()
            for surface, values in _with_median([scale * getattr(each, of) for each in histories]).items()
        }
        for row, (of, scale) in QUANTITIES.items()
        for name, readings in cases.items()
    }
    return Plot(
        over_cycles(panels, ("reading", "surface"), thick="median", first=1),
        "readings",
        "Both readings of the paper over the cycles",
        "Volume, friction and roughness over the cycles, a column for each case, a line for each reading.",
        "Thick: median of the surfaces; thin: each surface. Sa of the unloaded surface after each cycle.",
    )


def _with_median(values: Sequence[np.ndarray]) -> dict[str, np.ndarray]:
    found = {str(k): each for k, each in enumerate(values, start=1)}
    return found | ({"median": np.median(values, axis=0)} if values else {})


def yield_plot(found: Found, reading: Reading) -> Plot:
    """The yield stress over depth of each material."""
    scenes = {NAMES[case]: scene for (of, case), scene in found.bases.items() if of is reading}
    return Plot(
        yield_profiles({name: each.body.plasticity.strength().stress for name, each in scenes.items()}, DEEP),
        led(reading, "yield"),
        f"Yield stress over depth, {reading}",
        "Curves of the yield stress over depth, one for each case, before any plastic strain and after 1 %.",
        "After the paper's Fig. 9, which has no numbers: the shape of the profiles is from it, their size is "
        "assumed. The line of a case may lie on that of another.",
    )


def regimes_plot(found: Found, reading: Reading) -> Plot:
    """Where films fail and metal is removed."""
    runs = {case: list(own.values()) for case, own in found.cases(reading).items()}
    first = next(iter(runs.values()))[0]
    reached = {
        NAMES[case]: tuple(float(np.median([one.history.p_max[k] for one in own])) for k in (0, -1))
        for case, own in runs.items()
    }
    constants = (f"B = {each / 1e6:g} MPa" for each in (first.scene.body.plasticity.B, LITERATURE_B))
    limits = {NAMES[case]: pair for case, pair in found.limits(reading).items()}
    return Plot(
        regime_map(limits, reached, first.friction, tuple(constants)),
        led(reading, "regimes"),
        f"Where films fail and metal is removed, {reading}",
        "Map of pressure against friction and against strength: zones where the film is whole, has "
        "failed, and metal is removed.",
        "Lines: √3 μ p = σ_y(limit), above which the traction alone removes the surface. Dash-dotted: "
        "the film fails. Right: full marks at the strength of each case, open ones with the other B; "
        "arrows: median of the surfaces.",
    )


CASES = (RunningIn("running-in"),)
