# SPDX-License-Identifier: MIT
"""What the studies of running-in share: a run, the statements of the paper (Bosman & Schipper 2011, Figs.
13-17) as measures with limits, and whether runs on several surfaces agree.

The paper's surface is not public and its numbers belong to it: only directions and ratios are asked for. A
statement that the model contradicts is a finding; nothing here is a row.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from enum import StrEnum
from functools import cached_property
from typing import Any

import numpy as np

from sam.scene import Result, Scene
from verification.cases.case import SAM, Case, Context, SmallTable
from verification.cases.running_in.scenes import LAST, deeper_after
from verification.compare.running_in_measures import History, Scar, Spread

CUBIC, GIGA = 1e18, 1e-9
EARLY, STEADY = 6, 10  # cycles of the paper's figures: the end of the first wear, the steady part
AGREED = 0.8  # of the surfaces that must agree
STILL = 1e-3  # of the worn volume: what cycles 21 to 25 add at least where wear goes on
INF, NAN = float("inf"), float("nan")
Histories = Mapping[str, History]
"""Material -> its run over the cycles, on one surface."""


@dataclass(frozen=True)
class Run:
    """A scene and its result."""

    scene: Scene
    result: Result

    @cached_property
    def history(self) -> History:
        """The run over its cycles."""
        return History.of(self.result.tables)

    @cached_property
    def scar(self) -> Scar:
        """The surface of the last cycle."""
        return Scar.of(self.result.tables)

    @property
    def friction(self) -> tuple[float, float]:
        """The low and the high coefficient."""
        return self.scene.friction.low, self.scene.friction.high

    @property
    def renewed(self) -> bool:
        """Whether each cycle meets another counter-surface."""
        surface = self.scene.counterbody.surface
        return surface is not None and surface.renewed

    def of_cycles(self, column: str) -> np.ndarray:
        """A column of cycles.csv."""
        return np.asarray(self.result.tables["cycles"][column], dtype=float)

    @property
    def off(self) -> float:
        """Volume summed over surface.csv against the last of cycles.csv, relative; 0 where both are 0."""
        return apart(self.scar.volume, self.history.volume[-1])


def apart(value: float, expected: float) -> float:
    """Relative difference, 0 where both are 0."""
    return abs(value - expected) / max(abs(expected), abs(value)) if value != expected else 0.0


def outside(values: np.ndarray, low: float, high: float) -> float:
    """How far values lie out of a range, NaN where one is none."""
    return float(np.max(np.maximum(np.maximum(low - values, values - high), 0.0)))


def spread(values: Iterable[float], scale: float = 1.0) -> str:
    """Median and range for the reader."""
    return Spread.of([scale * value for value in values]).text()


class Study(Case):
    """Runs that may stay unconverged: a row counts those, and a set of hours does not break off for one of
    them. Where the plastic zone reaches the last layer a run begins again with deeper ones.
    """

    def scenes(self, context: Context) -> dict[Hashable, Scene]:
        """Of all runs, by a key."""
        raise NotImplementedError(self.name)

    def label(self, key: Any) -> str:
        """What the run of a key is written as."""
        raise NotImplementedError(self.name)

    def ahead(self, context: Context) -> Iterable[Scene]:
        return self.scenes(context).values()

    def then(self, scene: Scene, result: Result) -> Scene | None:
        return deeper_after(scene, result)

    def runs(self, context: Context) -> dict[Any, Run]:
        """What ran, by key."""
        return {key: solved(context, each, self.label(key)) for key, each in self.scenes(context).items()}


def solved(context: Context, scene: Scene, label: str) -> Run:
    """A run, see `Study`."""
    result = context.solve(SAM, scene, label, demand=False)
    below = deeper_after(scene, result)
    return Run(scene, result) if below is None else solved(context, below, f"{label}-deeper")


def good(runs: Mapping[Any, Run]) -> dict[Any, Run]:
    """Those that converged."""
    return {key: one for key, one in runs.items() if one.result.converged}


class Judgement(StrEnum):
    """Of a statement, over all surfaces."""

    HELD = "held"
    FAILED = "failed"
    OPEN = "not decided"


@dataclass(frozen=True)
class Statement:
    """One sentence of the paper. value: its measure on one surface, NaN: says nothing there; low, high: of
    the measure, as asked; figure: of the paper.
    """

    figure: str
    words: str
    measure: str
    low: float
    high: float
    value: Callable[[Histories], float]

    def holds(self, value: float) -> bool:
        """Whether a value is what is asked for."""
        return self.low <= value <= self.high

    def on(self, surface: Histories) -> float:
        """Its measure on a surface, NaN where a run is missing too."""
        try:
            return float(self.value(surface))
        except KeyError:
            return NAN

    @property
    def asked(self) -> str:
        """What is asked for, for the reader."""
        if np.isinf(self.low) or np.isinf(self.high):
            return f"≤ {self.high:g}" if np.isinf(self.low) else f"≥ {self.low:g}"
        return f"{self.low:g} to {self.high:g}"


@dataclass(frozen=True)
class Judged:
    """A statement and its measure on each surface."""

    statement: Statement
    values: tuple[float, ...]

    @property
    def agreeing(self) -> int:
        """Surfaces on which it holds."""
        return sum(map(self.statement.holds, self.values))

    @property
    def spread(self) -> Spread:
        """Median and range over the surfaces."""
        return Spread.of(self.values)

    @property
    def agreed(self) -> Judgement:
        """Held or failed where eight surfaces of ten agree; one on which the measure says nothing agrees with
        neither.
        """
        needed, failing = AGREED * len(self.values), self.spread.n - self.agreeing
        if not self.values or max(self.agreeing, failing) < needed:
            return Judgement.OPEN
        return Judgement.HELD if self.agreeing >= needed else Judgement.FAILED

    @property
    def by_median(self) -> Judgement:
        """What the median of the surfaces says; nothing where no more than half of them say anything."""
        if 2 * self.spread.n <= len(self.values):
            return Judgement.OPEN
        return Judgement.HELD if self.statement.holds(self.spread.median) else Judgement.FAILED

    @property
    def margin(self) -> float:
        """Distance of the median from the nearest limit, over the interquartile range of the surfaces: below
        1 the statement is decided by less than they scatter. NaN without median.
        """
        median, between = self.spread.median, self.spread.interquartile
        limits = filter(np.isfinite, (self.statement.low, self.statement.high))
        away = min(abs(median - limit) for limit in limits)
        if np.isinf(away) or not between > 0.0:
            return away * INF if away else away
        return away / between

    @property
    def is_close(self) -> bool:
        """Whether the surfaces scatter by more than the median is away from the limit."""
        return self.by_median is not Judgement.OPEN and self.margin < 1.0

    @property
    def data(self) -> dict[str, Any]:
        """For the pages: of none: surfaces without a value."""
        found = {"figure": self.statement.figure, "statement": self.statement.words, "values": self.values}
        found |= {"measure": self.statement.measure, "asked": self.statement.asked, "holds_on": self.agreeing}
        found |= {"of": len(self.values), "none_on": len(self.values) - self.spread.n}
        margin = {"margin": self.margin, "close": self.is_close}
        return found | {"by_median": self.by_median, "by_agreement": self.agreed, **margin}


def judged(surfaces: Sequence[Histories]) -> list[Judged]:
    """Every statement on the surfaces, of each of which there are the materials that converged."""
    return [Judged(each, tuple(each.on(surface) for surface in surfaces)) for each in STATEMENTS]


def statements_table(readings: Mapping[str, Sequence[Judged]]) -> SmallTable:
    """Each statement with its verdicts. readings: name of a reading -> the statements."""
    columns, rows = ["Fig.", "statement of the paper", "measure", "asked"], []
    for name in readings:
        columns += [f"{name}: median (range)", "holds on", "by the median", "by agreement"]
    for of_readings in zip(*readings.values(), strict=True):
        statement = of_readings[0].statement
        row = [statement.figure, statement.words, statement.measure, statement.asked]
        for one in of_readings:
            silent, margin = len(one.values) - one.spread.n, one.margin
            far = one.by_median is Judgement.OPEN or np.isinf(margin)
            row += [
                one.spread.text(),
                f"{one.agreeing} of {len(one.values)}" + (f", none on {silent}" if silent else ""),
                str(one.by_median) if far else f"{one.by_median} by {margin:.2g} IQR",
                str(one.agreed),
            ]
        rows.append(row)
    return SmallTable(
        "What the paper says of its Figures 13 to 17, on surfaces of our own. By the median: the distance of "
        "the median from the limit in interquartile ranges (IQR) of the surfaces; below 1, the surfaces "
        f"scatter by more. By agreement: of {AGREED:.0%} of the surfaces. None: surfaces without a value",
        columns,
        rows,
    )


def ratio(a: float, b: float) -> float:
    """a/b of volumes, rates or heights; for b = 0 infinite, NaN where a is 0 too."""
    if b == 0.0:
        return NAN if a == 0.0 else INF
    return a / b


MEASURES: Mapping[str, Callable[[History], float]] = {
    "early": lambda h: ratio(h.volume_after(EARLY), h.volume_after(LAST)),
    "later": lambda h: ratio(h.rate(STEADY, LAST), h.rate(0, EARLY)),
    "steady": lambda h: h.rate(STEADY, LAST),
    "volume": lambda h: h.volume_after(LAST),
    "straight": lambda h: float(np.nan_to_num(h.straightness(5, LAST))),  # 0, the worst, where nothing wears
    "grown": lambda h: float(np.nan_to_num(ratio(5 * h.rate(LAST - 5, LAST), h.volume_after(LAST)))),
    "friction": lambda h: h.at("friction", LAST),
    "fallen": lambda h: h.at("friction", LAST) - h.at("friction", 1),
    "sa": lambda h: h.at("sa", LAST),
}
"""Of a run of 25 cycles; grown: share of the volume that the last five wear, 0 where nothing has worn."""
# 0.001 of a coefficient: a hundredth of the low one, more than the steps of a load that a few cells carry
TABLE = """\
13 | bulk: worn in the first six cycles | V(6)/V(25) | 0.9 | inf | early bulk
13 | bulk: hardly any wear later | wear per cycle, 11–25 over 1–6 | -inf | 0.05 | later bulk
13 | bulk: friction stays high, 0.17 | μ(25) | 0.14 | 0.2 | friction bulk
14 | curve A: wears linearly after the first cycles | R² of V, 5–25 | 0.95 | inf | straight curve-a
14 | curve A: friction falls | μ(25) − μ(1) | -inf | -0.001 | fallen curve-a
14 | curve A: friction below that of bulk | μ_A − μ_bulk | -inf | -0.001 | friction curve-a - bulk
15 | curve B: the whole surface protected | μ(25) | -inf | 0.105 | friction curve-b
15 | curve B: roughness falls more than with A | Sa_B/Sa_A | -inf | 0.999 | sa curve-b / curve-a
15 | curve B: still wears linearly | R² of V, 5–25 | 0.95 | inf | straight curve-b
16 | 5 % instead of 2 %: the same wear per cycle later | wear per cycle 11–25, ratio | 0.8 | 1.2 \
| steady curve-b-ductile / curve-b
16 | 5 % instead of 2 %: less volume | V(25), ratio | -inf | 0.999 | volume curve-b-ductile / curve-b
17 | hardening: wears as much as bulk | V(25), ratio | 0.5 | 2.0 | volume hardening / bulk
17 | hardening: still wears slowly | share of V, 21–25 | 0.001 | 0.2 | grown hardening
17 | hardening: friction falls | μ(25) − μ(1) | -inf | -0.001 | fallen hardening
13–17 | volume: hardening and bulk below A and B | largest over smallest | -inf | 0.999 \
| volume bulk hardening / curve-a curve-b
13–17 | friction: B below A and hardening | largest over smallest | -inf | 0.999 \
| friction curve-b / curve-a hardening
13–17 | friction: A and hardening below bulk | largest over smallest | -inf | 0.999 \
| friction curve-a hardening / bulk
"""
"""Figure | words | measure | low | high | how it is measured: one of MEASURES and the materials; the largest
of those before a sign, less or over the smallest of those behind it.
"""


def _statement(line: str) -> Statement:
    figure, words, measure, low, high, how = (part.strip() for part in line.split("|"))
    name, *materials = how.split()
    sign = next((k for k, each in enumerate(materials) if each in "-/"), len(materials))

    def value(surface: Histories) -> float:
        own, *others = (
            [MEASURES[name](surface[m]) for m in part]
            for part in (materials[:sign], materials[sign + 1 :])
            if part
        )
        if not others:
            return own[0]
        return max(own) - min(others[0]) if materials[sign] == "-" else ratio(max(own), min(others[0]))

    return Statement(figure, words, measure, float(low), float(high), value)


STATEMENTS = tuple(map(_statement, TABLE.splitlines()))
