# SPDX-License-Identifier: MIT
"""Running-in: the five cases of Bosman & Schipper (2011), Figs. 13-17, on five surfaces, against what the
paper says of them.

Gates are for what must be so: sums that agree, cycles that are complete, friction between its two
coefficients. What the paper says of its own surface is judged in a table, beside the pressures at which a
film fails and metal is removed, which decide it.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from sam.scene import Result, Scene
from verification.compare.running_in_measures import History, Limits, Scar
from verification.figures.running_in import comparison, regime_map, six_panels
from verification.suite.cases.case import SAM, Case, Context, Measured, Plot, SmallTable, View
from verification.suite.cases.running_in_scenes import (
    LITERATURE_B,
    Effort,
    reduced,
    with_plasticity,
    with_seed,
)
from verification.suite.cases.running_in_statements import LAST, NAMES, STATEMENTS, B, JudgedStatement, judge
from verification.suite.cases.running_in_tables import (
    HELD_NOTE,
    cases_table,
    cost_table,
    findings_note,
    held_of,
    iterations_of,
    of_case,
    regimes_table,
    statements_table,
    varied_table,
)
from verification.suite.cases.running_in_varied import varied_scenes

SHOWN = 2  # the seed of the scenes
EFFORTS = {
    "quick": Effort((B,), (SHOWN,), cycles=3, steps=3, cells=32),
    "full": Effort(tuple(NAMES), (1, 2, 3, 4, 5), cycles=LAST, steps=10, cells=64, varied=True),
}
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


@dataclass(frozen=True)
class Runs:
    """bases: case -> its scene; found: what ran on each surface; varied: other assumptions, by name."""

    effort: Effort
    bases: Mapping[str, Scene]
    found: Mapping[Key, RunningInRun]
    varied: Mapping[str, RunningInRun]

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
            case: [
                held_of(one.scar, own, one.friction) for (name, _), one in self.good.items() if name == case
            ]
            for case, (own, _) in self.limits.items()
        }


class RunningIn(Case):
    """Every case on every surface; then what is varied; gates over all of them, statements over those that
    converged.
    """

    def solve(self, context: Context) -> Runs:
        effort = EFFORTS[context.level]
        bases = {case: reduced(context.scene(f"running-in-{case}"), effort) for case in effort.cases}
        found = {
            (case, seed): solved(context, with_seed(bases[case], seed), label_of(case, seed))
            for seed in effort.seeds
            for case in effort.cases
        }
        return Runs(effort, bases, found, variations(context, bases, found) if effort.varied else {})

    def measure(self, runs: Runs) -> dict[str, Measured]:
        return gates([*runs.found.values(), *runs.varied.values()])

    def setup(self, runs: Runs) -> list[tuple[str, str]]:
        scene, effort = next(iter(runs.bases.values())), runs.effort
        film, surface, plasticity, wear = (
            scene.friction,
            scene.surface,
            scene.body.plasticity,
            scene.wear,
        )
        law = f"σ_y = {plasticity.B / 1e6:g} MPa ({plasticity.C:g} + 10⁶ ε)^{plasticity.n:g}"
        waves, seeds = (
            f"waves of {surface.cutoff_short * 1e6:g} µm and more",
            ", ".join(map(str, effort.seeds)),
        )
        side, layers = 1e6 * scene.grid.extent[0], len(scene.grid.depths) - 1
        return [
            ("Body", f"E = {scene.body.young / 1e9:g} GPa, {law}"),
            ("Surface", f"hard-turned, Ra = {surface.ra * 1e6:g} µm, {waves}; seeds {seeds}"),
            (
                "Patch",
                f"{side:g} × {side:g} µm, {effort.cells} × {effort.cells} cells, {layers} layers, the first "
                "0.1 µm",
            ),
            (
                "Load",
                f"{scene.loading.force:g} N, {effort.cycles} cycles of {effort.steps} + {effort.steps} "
                "steps, flat steel above",
            ),
            (
                "Film",
                f"{film.film_thickness * 1e9:g} nm, yields at {film.film_yield / 1e9:.3g} GPa, fails beyond "
                f"{film.thinning_limit:.2%} a cycle",
            ),
            ("Friction", f"{film.low:g} below a whole film, {film.high:g} where it has failed"),
            (
                "Wear",
                f"beyond {wear.strain_limit:.1%} of plastic strain, in a layer 2 % or 5 %; window "
                f"{wear.smoothing_window}",
            ),
            (
                "Assumed",
                "the layers' yield stress over depth (curve-*.csv, hardening-only.csv), window and order of "
                "smoothing",
            ),
        ]

    def tables(self, runs: Runs) -> Iterator[SmallTable]:
        yield cases_table(runs.histories)
        if runs.judged:
            yield statements_table(runs.judged, runs.limits, runs.histories)
        yield regimes_table(runs.limits, runs.histories, runs.held)
        if runs.varied:
            varied = {name: (limits_of(one.scene)[0], one.history) for name, one in runs.varied.items()}
            yield varied_table(varied)
        named = {f"{NAMES[case]}, surface {seed}": one for (case, seed), one in runs.found.items()}
        yield cost_table({name: one.result for name, one in (named | dict(runs.varied)).items()})

    def notes(self, runs: Runs) -> Iterator[str]:
        if runs.judged:
            yield findings_note(runs.judged)
        if any(above for counts in runs.held.values() for _, above in counts):
            yield HELD_NOTE

    def figures(self, runs: Runs) -> Iterator[Plot]:
        found, limits = runs.good, runs.limits
        histories = {case: of_case(runs.histories, case) for case in limits}
        histories = {case: each for case, each in histories.items() if each}
        if not histories:
            return
        first = next(iter(found.values()))
        yield Plot(
            comparison({NAMES[case]: each for case, each in histories.items()}),
            "comparison",
            "Volume, friction and roughness over the cycles",
            "Wear volume, friction and roughness over the cycles, a line for each case and a band over the "
            "surfaces.",
            "Lines: median of the surfaces; bands: their range. Sa of the unloaded surface after each cycle.",
        )
        reached = {NAMES[case]: median_pressures(each) for case, each in histories.items()}
        pairs = {NAMES[case]: pair for case, pair in limits.items()}
        constants = (first.scene.body.plasticity.B, LITERATURE_B)
        yield Plot(
            regime_map(
                pairs, reached, first.friction, tuple(f"B = {constant / 1e6:g} MPa" for constant in constants)
            ),
            "regimes",
            "Where films fail and metal is removed",
            "Map of pressure against friction and against strength: zones where the film is whole, has "
            "failed, and metal is removed.",
            "Lines: √3 μ p = σ_y(limit), above which the traction alone removes the surface. Dash-dotted: "
            "the film fails. Right: full marks at the strength of each case, open ones with the other B; "
            "arrows: median of the surfaces.",
        )
        for case, seed in runs.shown:
            one = found[case, seed]
            yield Plot(
                six_panels(one.scar, one.history, one.friction),
                case,
                f"Running-in, {NAMES[case]}",
                f"Six panels of {NAMES[case]}: worn depth, worn surface, volume and friction over cycles, "
                "local friction, pressure.",
                f"As the paper's Fig. {FIGURES[case]}, on our surface. (a) and (b) after the last cycle, (e) "
                "and (f) at its peak.",
            )

    def views(self, runs: Runs) -> Iterator[View]:
        for case, seed in runs.shown:
            yield View(
                label_of(case, seed),
                "worn",
                f"{case}-worn",
                f"Worn surface over the original, {NAMES[case]}",
                f"The rough surface of {NAMES[case]} in space, coloured by the depth worn; the original "
                "surface above it is transparent.",
                f"As the paper's Fig. {FIGURES[case]}b, on our surface, after the last cycle.",
            )


def label_of(case: str, seed: int) -> str:
    """What the run of a case on a surface is written as."""
    return f"{case}-seed-{seed}"


def solved(context: Context, scene: Scene, label: str) -> RunningInRun:
    """A run that may stay unconverged: a gate counts those, and a set of hours does not break off for one of
    them.
    """
    return RunningInRun(scene, context.solve(SAM, scene, label, demand=False))


def by_surface(found: Mapping[Key, RunningInRun], seeds: Sequence[int]) -> list[dict[str, History]]:
    """For each surface the cases that there are."""
    return [{case: one.history for (case, own), one in found.items() if own == seed} for seed in seeds]


def limits_of(scene: Scene) -> tuple[Limits, Limits]:
    """With the scene's own constant B, and with that of the literature."""
    return Limits.of(scene), Limits.of(with_plasticity(scene, B=LITERATURE_B))


def variations(
    context: Context, bases: Mapping[str, Scene], found: Mapping[Key, RunningInRun]
) -> dict[str, RunningInRun]:
    """On the surface of the scene: curves that deviate less and more, curve C, the other constant B, windows
    of smoothing.
    """
    own = {f"{NAMES[case]} as given": found[case, scene.surface.seed] for case, scene in bases.items()}
    scenes = varied_scenes(bases, context.scene)
    return own | {name: solved(context, scene, label) for name, (label, scene) in scenes.items()}


def gates(runs: Sequence[RunningInRun]) -> dict[str, Measured]:
    """Worst of all runs. Sums are over surface.csv of the last cycle, against cycles.csv."""
    whole = [one for one in runs if one.result.converged]
    sums = {
        "volume": lambda one: off(one.scar.volume, one.history.volume[-1]),
        "friction-sum": lambda one: abs(one.scar.coefficient(*one.friction) - one.history.friction[-1]),
        "protected": lambda one: abs(one.scar.protected_fraction(*one.friction) - one.history.protected[-1]),
        "load": lambda one: off(one.scar.force, one.scene.loading.force),
        "iterations": lambda one: later_over_early(one.result),
        "friction-range": lambda one: outside(one.history.friction, *one.friction),
    }
    counts = {
        "cycles": missing_cycles,
        "falls": lambda one: int((np.diff(one.history.volume, prepend=0.0) < 0.0).sum()),
        "added": lambda one: int((one.scar.worn < 0.0).sum()),
    }
    values = {name: Measured(max(map(of, whole), default=float("nan"))) for name, of in sums.items()}
    values |= {name: Measured(sum(map(of, whole)), 0) for name, of in counts.items()}
    return values | {"unconverged": Measured(len(runs) - len(whole), 0)}


def off(value: float, expected: float) -> float:
    """Relative difference, 0 where both are 0."""
    return abs(value - expected) / max(abs(expected), abs(value)) if value != expected else 0.0


def later_over_early(result: Result) -> float:
    """Plastic iterations, each with an application of the operator of residual stress: mean of later cycles
    over the first.
    """
    early, later = iterations_of(result)
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


def main_seed(seeds: Sequence[int]) -> int:
    """The surface that is drawn: that of the scenes, or the first there is."""
    return SHOWN if SHOWN in seeds else seeds[0]


def median_pressures(histories: Sequence[History]) -> tuple[float, float]:
    """Largest pressure in Pa in the first and in the last cycle."""
    return tuple(float(np.median([history.p_max[k] for history in histories])) for k in (0, -1))


FIGURES = dict(zip(NAMES, (13, 14, 15, 16, 17), strict=True))
"""Figures of the paper."""


CASES = (
    RunningIn(
        "running-in",
        "Running-in of five materials",
        "Do the five materials of the paper run in as it says, and what decides how they do?",
        (
            (
                "Growth",
                "K₀ √t in a cycle; over the thickness: the strain that fails it",
                "Bosman & Schipper (2011), Eq. 11, 17",
            ),
            (
                "Film",
                "σ_zz = −p, σ_xz = μ p, bonded to the strain of the surface",
                "Bosman & Schipper (2011), section 4",
            ),
            (
                "Overall friction",
                "μ = μ_low + (μ_high − μ_low) W_high/W",
                "sum of the traction over the cells",
            ),
            (
                "Removal",
                "√3 μ p > σ_y(limit): by the traction alone",
                "equilibrium at the surface, von Mises",
            ),
        ),
    ),
)
