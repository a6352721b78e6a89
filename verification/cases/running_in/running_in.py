# SPDX-License-Identifier: MIT
"""Running-in: the five cases of Bosman & Schipper (2011), Figs. 13-17, in two readings on ten surfaces, and
on finer cells. Rows are for what must be so: sums, complete cycles, friction between its coefficients. What
the paper says of its own surface is judged in a table.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from typing import Any

import numpy as np

from sam.scene import Scene
from verification.cases.case import Context, DataFrame, Measured, Plot, SmallTable, View
from verification.cases.running_in import study
from verification.cases.running_in.study import (
    CUBIC,
    GIGA,
    LAST,
    NAMES,
    NAN,
    A,
    B,
    Effort,
    Reading,
    Readings,
    Run,
    readings_of,
)
from verification.compare.running_in_measures import Limits
from verification.figures.lines import Curve, curves, yield_profiles
from verification.figures.running_in import six_panels
from verification.reference.bonded_film import regime

PRINTED, RENEWED = "printed inputs", "renewed"
WORDS = {PRINTED: "with the printed inputs", RENEWED: "weakly hardening layer, renewed counter-surface"}
"""The readings on all surfaces: with its numbers, by our plastic loop, or see `renewed` -> for the reader."""
SHOWN = 2  # the seed of the scenes
FULL = Effort(LAST, steps=3, cells=64, seeds=tuple(range(1, 11)))
EFFORTS = {
    "quick": {PRINTED: Effort(3, 3, 32, (B,)), RENEWED: Effort(3, 2, 32, (A,))},
    "full": {PRINTED: FULL, RENEWED: FULL},
}
FIRST_CYCLES = 5  # of running-in; the later ones are steadier
FIGURES = dict(zip(NAMES, (13, 14, 15, 16, 17), strict=True))
"""Figures of the paper."""
DEEP = 2e-6  # m: how far down the yield stress is drawn; the profiles end above


def renewed(scene: Scene) -> Scene:
    """The second reading: a layer that hardens little, another rough counter-surface in each cycle."""
    scene = study.deeper(
        study.with_counter(study.with_layer_alpha(scene, study.LAYER_ALPHA), study.ROUGHNESS["sq"])
    )
    return scene.model_copy(update={"title": f"{scene.title}, {WORDS[RENEWED]}"})


def alike(one: Run) -> bool:
    """Whether each cycle meets the same counter-surface."""
    rough = one.scene.counterbody.surface
    return rough is None or not rough.renewed


def later_over_early(one: Run) -> float:
    """Plastic iterations, each with an application of the operator of residual stress: mean of the
    cycles after the fifth (of a short run: of the last) over the earlier ones, where each meets the same
    counter-surface.
    """
    history = one.result.tables["history"]
    cycle, iterations = (np.asarray(history[name], dtype=float) for name in ("cycle", "iterations"))
    per_cycle = [float(iterations[cycle == k].sum()) for k in np.unique(cycle)]
    split = min(FIRST_CYCLES, len(per_cycle) - 1)
    return float(np.mean(per_cycle[split:]) / np.mean(per_cycle[:split])) if alike(one) else 0.0


def missing_cycles(one: Run) -> int:
    """Cycles without a row, rows out of order, and numbers that are missing in them."""
    wanted, cycle = np.arange(1, one.scene.loading.cycles + 1), one.of_cycles("cycle")
    if not np.array_equal(cycle, wanted):
        return max(1, abs(wanted.size - cycle.size))
    return sum(int(np.isnan(one.of_cycles(name)).sum()) for name in one.result.tables["cycles"])


def restless_cycles(one: Run) -> int:
    """Cycles that strain or wear after one that did neither, under the same counter-surface."""
    busy = (one.of_cycles("new_strain_max") != 0.0) | (one.of_cycles("wear_of_cycle_m3") != 0.0)
    return int((busy & (np.cumsum(~busy) > 0)).sum()) if alike(one) else 0


LARGEST: Mapping[str, Callable[[Run], float]] = {
    "volume": lambda one: study.apart(one.scar.volume, one.history.volume[-1]),
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
"""Row -> its number of a run, the largest or the sum, by surface.csv of the last cycle and cycles.csv."""


class RunningIn(Readings):
    """Every material on every surface in both readings; statements over the converged."""

    def readings(self, context: Context) -> dict[str, Reading]:
        efforts = EFFORTS[context.level]
        return {
            PRINTED: Reading("", efforts[PRINTED]),
            RENEWED: Reading(f"{RENEWED}-", efforts[RENEWED], renewed),
        }

    def solved_again(self, reading: Any, material: str, surface: int) -> bool:
        return surface == SHOWN

    def measure(self, found: DataFrame) -> dict[str, Measured]:
        """Of runs that are solved, as a campaign has no surfaces and keeps six digits; all are counted."""
        good = study.solved_of(found)
        values = {name: Measured(float(good.map(of).max(skipna=False))) for name, of in LARGEST.items()}
        values |= {name: Measured(sum(map(of, good)), 0) for name, of in COUNTS.items()}
        values["unconverged"] = Measured(int((~found["converged"]).sum()), 0)
        return values | {"campaign": super().measure(found)["campaign"]}

    def data(self, found: DataFrame) -> dict[str, Any]:
        return {"statements": readings_of(found), "second_reading": WORDS[RENEWED]}

    def tables(self, found: DataFrame) -> Iterator[SmallTable]:
        if statements := readings_of(found):
            yield study.statements_table(statements)
        for reading, words in WORDS.items():
            groups = {NAMES[case]: runs for case, runs in runs_of(found, reading)}
            yield study.runs_table(words.capitalize(), groups)
        yield regimes_table(found)

    def notes(self, found: DataFrame) -> Iterator[str]:
        yield from self.told_of_campaign(found)
        yield "The paper's surface and curves of Fig. 9 are not public: a failed statement is a finding."
        every = [
            (f"{NAMES[case]}, surface {seed}, {reading}", one)
            for reading, case, seed, one in found[[*study.PARTS, "run"]].itertuples(index=False)
        ]
        depths = ((name, one.scene.grid.depths[-1]) for name, one in every if one.again)
        if words := "; ".join(f"{name}, to {depth * 1e6:g} µm" for name, depth in depths):
            yield f"Run again with deeper layers, as the plastic zone reached the last one: {words}."
        if words := "; ".join(
            f"{name}: {one.result.status} after {len(one.of_cycles('cycle'))} cycles"
            for name, one in every
            if not one.result.converged
        ):
            yield f"Not converged, and counted as surfaces on which a statement says nothing: {words}."

    def figures(self, found: DataFrame) -> Iterator[Plot]:
        good = found[found["converged"]]
        if good.empty:
            return
        yield readings_plot(good)
        scenes = {
            NAMES[case]: runs.iloc[0].scene.body.plasticity.strength()
            for case, runs in runs_of(found, PRINTED)
        }
        yield Plot(
            yield_profiles({name: each.stress for name, each in scenes.items()}, DEEP),
            "yield",
            f"Yield stress over depth, {WORDS[PRINTED]}",
            "The figure compares the yield stress of the materials over depth. The shape of the profiles is "
            "from the paper's Fig. 9, which has no numbers; their size is assumed.",
        )
        for reading, case, one in shown_of(found):
            yield Plot(
                six_panels(one.scar, one.history, one.friction),
                led(reading, case),
                f"Running-in, {NAMES[case]}, {WORDS[reading]}",
                f"The panels show what the paper's Fig. {FIGURES[case]} does, on our surface "
                f"{one.scene.surface.seed} alone: (a) and (b) after the last cycle, (e) and (f) at its peak. "
                "What is not worn or not in contact is grey; (b) is a shaded relief.",
            )

    def views(self, found: DataFrame) -> Iterator[View]:
        for reading, case, one in shown_of(found):
            if reading == PRINTED:
                yield View(
                    f"{case}-seed-{one.scene.surface.seed}",
                    "worn",
                    f"{case}-worn",
                    f"Worn surface over the original, {NAMES[case]}, {WORDS[reading]}",
                    f"The picture shows what the paper's Fig. {FIGURES[case]}b does, on our surface, after "
                    "the last cycle.",
                )


def led(reading: str, name: str) -> str:
    """A name of a file, led by that of the reading unless it is that of the printed inputs."""
    return name if reading == PRINTED else f"{reading}-{name}"


def runs_of(found: DataFrame, reading: str) -> Iterator[tuple[str, Any]]:
    """Each material with its runs."""
    yield from found[found["reading"] == reading].groupby("material", sort=False)["run"]


def shown_of(found: DataFrame) -> Iterator[tuple[str, str, Run]]:
    """Of each reading and material the run on the surface of the scenes, or else the first that is solved."""
    good = found.loc[study.solved_of(found).index]
    for reading in WORDS:
        for case, runs in runs_of(good, reading):
            yield reading, case, min(runs, key=lambda one: one.scene.surface.seed != SHOWN)


def regimes_table(found: DataFrame) -> SmallTable:
    """The pressures at which films fail and metal is removed, against the largest there is: the median of the
    runs in the first cycle.
    """
    rows = []
    for reading in WORDS:
        for case, runs in runs_of(found, reading):
            own = Limits.of(runs.iloc[0].scene)
            first = [one.history.p_max[0] for one in runs if one.result.converged]
            reached = float(np.median(first)) if first else NAN
            values = own.strength, own.removal, own.film, reached
            numbers = ("–" if np.isnan(number) else f"{GIGA * number:.2f}" for number in values)
            so = str(regime(reached, own.film, own.removal)) if first else "no run converged"
            rows.append((reading, NAMES[case], *numbers, so))
    columns = (
        "reading|case|σ_y(limit) at the surface|removed from, μ high|film fails from|p_max, first cycle|so"
    )
    words = "pressures in GPa at which films fail and the traction removes metal"
    return SmallTable(f"What decides: {words}", columns.split("|"), rows)


def readings_plot(good: DataFrame) -> Plot:
    """Each material over the cycles in both readings, the medians of the surfaces."""
    panels: dict[tuple[str, str], dict[str, Curve]] = {}
    for row, name, scale in (
        ("wear volume [µm³]", "volume", CUBIC),
        ("coefficient of friction", "friction", 1.0),
        ("roughness Sa [nm]", "sa", 1e9),
    ):
        for reading, words in WORDS.items():
            for case, runs in runs_of(good, reading):
                median = np.median([scale * getattr(one.history, name) for one in runs], axis=0)
                panel = panels.setdefault((row, words), {})
                panel[NAMES[case]] = Curve(np.arange(1, len(median) + 1), median, look={"markersize": 3})
    return Plot(
        curves(panels, "cycle", count=True, size=(4.4, 2.6)),
        "readings",
        "Both readings of the paper over the cycles",
        "The figure compares the materials in both readings of the paper: medians of the surfaces, whose "
        "ranges are in the tables. Sa is that of the unloaded surface after each cycle.",
    )


CASES = (RunningIn("running-in"),)
