# SPDX-License-Identifier: MIT
"""Running-in in the readings of the paper's words that stand beside the printed inputs: a sound roof that
falls, a filter that fills what it removed, both, the plastic loop as printed and the film by Eq. 12 to 14.

READINGS and SAID were written down before any of their runs. The second reading, finer cells and the loop as
printed cost several times as much as the printed inputs: they have a quarter of the area, and three surfaces.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial
from itertools import product
from typing import TYPE_CHECKING, Any

import numpy as np

from sam.scene import Scene, Status
from verification.cases.case import Context, Measured, Plot, SmallTable, with_grid, with_keys
from verification.cases.running_in import study
from verification.cases.running_in.running_in import renewed
from verification.cases.running_in.study import (
    CUBIC,
    DUCTILE,
    HARDENING,
    LAST,
    A,
    B,
    Effort,
    Reading,
    Readings,
    Run,
    Statement,
)
from verification.compare.running_in_measures import Spread
from verification.figures.lines import over_cycles

if TYPE_CHECKING:
    from pandas import DataFrame

C = "curve-c"
NAMES = study.NAMES | {C: "curve C"}
STEPS = 3  # each way
WHOLE = Effort(LAST, STEPS, 64, tuple(NAMES), tuple(range(1, 11)))
QUARTER = Effort(LAST, STEPS, 32, tuple(NAMES), (2, 4, 6))
ROOFS, FILTERS = {"roof stays": "stays", "roof falls": "falls"}, {"removes all": False, "fills": True}
"""In words -> keys of [wear]."""
PRINTED, SECOND, SMALL = "printed inputs", "second reading, quarter", "printed inputs, quarter"
FINE, FILM = "cells of 0.457 µm, quarter", "film by Eq. 12 to 14"
LOOP, LOOSE = "printed loop", "printed loop, 2 %"
FINER, WINDOW = 70, 11  # cells along 32 um, 0.457 um each, and in the window of smoothing, 5 um
LOOSER = 0.02  # yield excess that the printed loop may leave, where the scenes have 0.001
FALLEN = -0.02  # of a coefficient that falls, where running-in asks for 0.001


def fine(scene: Scene) -> Scene:
    """On cells that give the worn volume of most surfaces within a tenth: 26 in the shortest wave of 12 um in
    place of 12.
    """
    return with_keys(with_grid(scene, cells=(FINER, FINER)), "wear", smoothing_window=WINDOW)


def looped(scene: Scene, **keys: float) -> Scene:
    """By the loops as printed."""
    return with_keys(scene, "solver", method="paper", stop="stress", **keys)


BASES = {
    PRINTED: Reading("printed-", WHOLE),
    SECOND: Reading("second-", QUARTER, renewed),
    SMALL: Reading("quarter-", QUARTER),
    FINE: Reading("fine-", QUARTER, fine),
}
OTHERS = {
    LOOP: Reading("loop-", QUARTER, looped),
    LOOSE: Reading("loop-loose-", QUARTER, partial(looped, tolerance=LOOSER)),
    FILM: Reading("film-", QUARTER, partial(with_keys, section="friction", form="printed")),
}
"""Alone: the roof stays, and the filter removes all."""


def named(base: str, roof: str, smoothing: str) -> str:
    """A reading in words."""
    return f"{base}, {roof}, filter {smoothing}"


def combined(scene: Scene, base: Reading, roof: str, fills: bool) -> Scene:
    """A printed scene in one reading."""
    return with_keys(base.change(scene), "wear", roof=roof, smoothing_fills=fills)


COMBINED = {named(base, *words): (base, *words) for base, *words in product(BASES, ROOFS, FILTERS)}
READINGS = {
    name: replace(
        BASES[base],
        label=f"{BASES[base].label}{ROOFS[roof]}-{smoothing.split()[0]}-",
        change=partial(combined, base=BASES[base], roof=ROOFS[roof], fills=FILTERS[smoothing]),
    )
    for name, (base, roof, smoothing) in COMBINED.items()
} | OTHERS


IMPLIED = ("bulk: hardly any wear later", "curve A: friction below that of bulk")
"""By others: that bulk is worn in six cycles, and that A and hardening are below bulk in friction."""
TABLE = """\
15 | curve C: wears like curve B | V(25), ratio | 0.8 | 1.25 | volume curve-c / curve-b
15 | curve C: friction of curve B | μ(25), ratio | 0.9 | 1.1 | friction curve-c / curve-b
13–17 | friction: bulk above all layers | largest over bulk | -inf | 0.999 \
| friction curve-a curve-b curve-b-ductile hardening / bulk
17 | hardening, 2 %, is best: wears less than soft layers | V(25), ratio | -inf | 0.999 \
| volume hardening / curve-a curve-b
17 | hardening, 2 %, is best: its largest pressure falls | p_max(25)/p_max(1) | -inf | 0.999 \
| pressed hardening
"""
SAID = tuple(
    Statement(*said[:4], FALLEN, said.how) if said.how.startswith("fallen") else said
    for said in study.STATEMENTS
    if said.words not in IMPLIED
) + tuple(
    Statement(figure, words, measure, float(low), float(high), how)
    for figure, words, measure, low, high, how in study.parts_of(TABLE)
)
PLAIN = "roof stays", "removes all"
CHANGES = (
    (named(PRINTED, "roof falls", "removes all"), named(PRINTED, *PLAIN), "A roof that falls", "model"),
    (named(PRINTED, "roof stays", "fills"), named(PRINTED, *PLAIN), "A filter that fills", "numerics"),
    (named(SECOND, *PLAIN), named(SMALL, *PLAIN), "The second reading", "model"),
    (named(FINE, *PLAIN), named(SMALL, *PLAIN), "Finer cells", "numerics"),
    (LOOP, named(SMALL, *PLAIN), "The plastic loop as printed", "numerics"),
    (LOOSE, named(SMALL, *PLAIN), "That loop, stopped 20 times earlier", "numerics"),
    (FILM, named(SMALL, *PLAIN), "The film by Eq. 12 to 14 as printed", "model"),
)
"""Reading, the one beside it, the one thing that differs, and of what that is a part."""
AGAIN = 2  # the surface on which curve A is solved again in every reading beside a campaign: 19 of 510 runs
NEAR = 0.1  # of its threshold: how near the median of a measure is that finer cells may decide


def cycles_of(one: Run, column: str) -> np.ndarray:
    """A column of cycles.csv, zero where the scene has none."""
    return one.of_cycles(column) if column in one.result.tables["cycles"] else np.zeros(LAST)


class RunningInReadings(Readings):
    """Every material in every reading, a surface after the other."""

    numbers: Mapping[str, Callable[[Run], float]] = {
        "pressed": lambda one: one.history.p_max[-1] / one.history.p_max[0],
        "roofs": lambda one: float(np.sum(cycles_of(one, "roof_volume_m3"))),
        "filled": lambda one: float(np.mean(cycles_of(one, "filled_volume_m3")[study.STEADY :])),
    }

    def readings(self, context: Context) -> Mapping[str, Reading]:
        return READINGS

    def solved_again(self, reading: Any, material: str, surface: int) -> bool:
        return surface == AGAIN and material == A

    def scenes(self, context: Context) -> dict[tuple, tuple[str, Scene]]:
        return dict(sorted(super().scenes(context).items(), key=lambda item: item[0][2]))

    def solve(self, context: Context) -> Any:
        """coarse: contacts of too few cells for a result, as the filter that fills leaves; judged too."""
        runs = self.runs(context)
        coarse = [one.result.status is Status.UNDER_RESOLVED for one in runs.values()]
        kept = {
            key: replace(one, result=replace(one.result, status=Status.CONVERGED)) if few else one
            for (key, one), few in zip(runs.items(), coarse, strict=True)
        }
        return study.framed(kept, study.PARTS, self.numbers).assign(coarse=coarse)

    def measure(self, found: DataFrame) -> dict[str, Measured]:
        """balance: of wear and raw removal, as the filter that fills digs as much; excess: over its goal; of
        runs that are solved, as a campaign keeps six digits.
        """
        balance, excess = [0.0], [0.0]
        for one in study.solved_of(found):
            if one.scene.wear.smoothing_fills:
                wear, raw = (one.of_cycles(name) for name in ("wear_of_cycle_m3", "raw_volume_m3"))
                balance.append(float(np.abs(wear - raw).max() / max(raw.sum(), 1e-30)))
            if one.scene.solver.method == "paper":
                excess.append(float(one.of_cycles("yield_excess").max() / one.scene.solver.tolerance))
        own = {"balance": Measured(max(balance)), "excess": Measured(max(excess))}
        return own | super().measure(found)

    def judged(self, found: DataFrame) -> dict[str, list[dict[str, Any]]]:
        """Reading -> what is told of SAID."""
        return study.readings_of(found, SAID)

    def data(self, found: DataFrame) -> dict[str, Any]:
        """finer: of the statements as running-in asks, on the cells of the scenes and on finer ones."""
        cells = found["reading"].isin(named(base, *PLAIN) for base in (SMALL, FINE))
        return {"statements": self.judged(found), "finer": study.readings_of(found[cells])}

    def tables(self, found: DataFrame) -> Iterator[SmallTable]:
        said = self.judged(found)
        yield changes(held_in(said))
        yield from study.together(said)
        for base in (*BASES, *OTHERS):
            own = {name: each for name, each in said.items() if COMBINED.get(name, (name,))[0] == base}
            yield study.statements_table(own, base)
        groups = found.groupby(["material", "reading"], sort=False)["run"]
        yield study.runs_table("Runs", {f"{NAMES[case]}, {name}": runs for (case, name), runs in groups})
        yield late_wear(found)
        yield loops(found)

    def notes(self, found: DataFrame) -> Iterator[str]:
        judged, changed = self.judged(found), []
        holds = held_in(judged).values()
        never, counts = {one.words for one in SAID}.difference(*holds), sorted(map(len, holds))
        yield (
            "The gates check the runs, not the paper. A statement holds here if the median of the surfaces "
            f"meets what is asked. Agreement of {100 * study.AGREED:.0f} % of the surfaces is stricter; the "
            f"tables of each reading give both. By the median {counts[0]} to {counts[-1]} of {len(SAID)} "
            f"statements hold, depending on the reading; {len(never)} hold in none of {len(judged)}: "
            f"{'; '.join(sorted(never))}."
        )
        yield from self.told_of_campaign(found)
        few = found.groupby("reading", sort=False)["coarse"].agg(["sum", "size"])
        words = "; ".join(f"{name}: {n} of {of} runs" for name, n, of in few[few["sum"] > 0].itertuples())
        yield (
            "Contacts of too few cells remain at the end of some runs; these are judged like the others, and "
            f"their verdicts are less certain: {words or 'none'}."
        )
        for name, own in judged.items():
            base, *words = COMBINED.get(name, ("",))
            if base == SMALL:
                for said, one, other in zip(SAID, own, judged[named(FINE, *words)], strict=True):
                    if near(said, one) and one["by_median"] != other["by_median"]:
                        changed.append(
                            f"{said.words} ({', '.join(words)}: {one['by_median']}, {other['by_median']})"
                        )
        yield (
            f"Where the median lies within {100 * NEAR:.0f} % of the threshold, finer cells change the "
            f"verdict of: {'; '.join(changed) or 'none'} (first verdict: cells of 1 µm; second: 0.457 µm)."
        )

    def figures(self, found: DataFrame) -> Iterator[Plot]:
        panels: dict[tuple[str, str], dict[tuple[str, str], np.ndarray]] = {}
        good = found[found["converged"] & found["reading"].isin(COMBINED)]
        for (reading, case), runs in good.groupby(["reading", "material"], sort=False)["run"]:
            base, roof, smoothing = COMBINED[reading]
            if base in (PRINTED, SECOND) and case != C:
                depths = [1e9 * one.history.volume / np.prod(one.scene.grid.extent) for one in runs]
                line = np.append(0.0, np.median(depths, axis=0))
                label = f"{base}: mean worn depth [nm]"
                panels.setdefault((label, NAMES[case]), {})[roof, f"filter {smoothing}"] = line
        if panels:
            yield Plot(
                over_cycles(panels, ("roof", "filter")),
                "volume",
                "Mean worn depth over the cycles in each reading",
                "The figure compares the worn volume divided by the area of the patch. Each line is the "
                "median of the surfaces. Colours tell of the roof, dashes of the filter.",
            )


def held_in(judged: Mapping[str, Sequence[Mapping[str, Any]]]) -> dict[str, set[str]]:
    """Reading -> the statements that hold by the median of the surfaces."""
    return {
        name: {one["statement"] for one in said if one["by_median"] == study.HELD}
        for name, said in judged.items()
    }


def changes(holds: Mapping[str, set[str]]) -> SmallTable:
    """What single changes of the reading make hold and fail. holds: reading -> statements, see `held_in`."""
    rows = []
    for name, beside, words, kind in CHANGES:
        own, other = holds[name], holds[beside]
        more, less = ("; ".join(sorted(some)) or "–" for some in (own - other, other - own))
        rows.append((words, kind, str(len(other)), str(len(own)), more, less))
    columns = "change|of the model or of the numerics|held before|held after|gained|lost".split("|")
    return SmallTable("What one change of the reading does (by the median of the surfaces)", columns, rows)


def near(said: Statement, told: Mapping[str, Any]) -> bool:
    """Whether the median of a measure is within NEAR of a bound of what is asked."""
    median = Spread.of(told["values"]).median
    ends = [end for end in (said.low, said.high) if np.isfinite(end)]
    return any(abs(median - end) <= NEAR * abs(end) for end in ends)


def late_wear(found: DataFrame) -> SmallTable:
    """Wear per cycle late, and what the filter fills: whether linear wear is the filter's."""
    rows = []
    for name, own in found[found["converged"]].groupby("reading", sort=False):
        cells = []
        for case in (A, B, DUCTILE):
            runs = own[own["material"] == case]
            cells += [Spread.of(CUBIC * runs[each]).text for each in ("steady", "filled")]
        ratio = own.pivot(index="surface", columns="material", values="steady").reindex(columns=[DUCTILE, B])
        cells.append(Spread.of([study.ratio(*each) for each in ratio.to_numpy(float)]).text)
        roofs = own[own["material"] == HARDENING]["roofs"]
        rows.append((name, *cells, Spread.of(CUBIC * roofs).text))
    columns, both = ["reading"], ("wear per cycle", "filled by smoothing")
    columns += [f"{NAMES[case]}: {what}" for case in (A, B, DUCTILE) for what in both]
    columns += ["wear per cycle, 5 % over 2 % limit (ratio)"]
    columns += ["hardening only: volume of fallen roofs, 25 cycles [µm³]"]
    return SmallTable(
        "Wear and filling per cycle, mean of cycles 11 to 25 [µm³], median and range", columns, rows
    )


def loops(found: DataFrame) -> SmallTable:
    """What the printed loop leaves in a cycle, and its strain and wear divided by those of the exact one."""
    exact = found[found["reading"] == named(SMALL, *PLAIN)]
    rows = []
    for name, case, seed, one in found.loc[
        found["converged"] & found["reading"].isin((LOOP, LOOSE)), [*study.PARTS, "run"]
    ].itertuples(index=False):
        same = exact[(exact["material"] == case) & (exact["surface"] == seed) & exact["converged"]]["run"]
        for k in (1, study.EARLY, LAST) if len(same) else ():
            pairs = ("peeq_max", "wear_volume_m3", "wear_of_cycle_m3", "friction_coefficient")
            over = [
                study.ratio(*(each.of_cycles(column)[k - 1] for each in (one, same.iloc[0])))
                for column in pairs
            ]
            cells = [f"{one.of_cycles(column)[k - 1]:.1e}" for column in ("yield_excess", "flow_residual")]
            cells += [Spread.of([each]).text for each in over]
            rows.append((name, NAMES[case], str(seed), str(k), *cells))
    columns = "reading|material|surface|cycle|yield excess / yield stress|flow residual / initial yield "
    columns += "stress|strain, ratio|worn volume, ratio|worn volume of the cycle, ratio|μ, ratio"
    caption = "The loop as printed: what it leaves, and its numbers divided by those of the exact loop"
    return SmallTable(caption, columns.split("|"), rows)


CASES = (RunningInReadings("running-in-readings"),)
