# SPDX-License-Identifier: MIT
"""What the paper says of its five runs (Figs. 13-17), as measures with limits, and whether runs on several
surfaces agree.

The paper's surface is not public and its numbers belong to it: only directions and ratios are asked for. A
statement that the model contradicts is a finding; nothing here is a gate.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from verification.compare.running_in_measures import History, Spread

BULK, A, B, DUCTILE, HARDENING = "bulk", "curve-a", "curve-b", "curve-b-ductile", "hardening"
NAMES = {
    BULK: "bulk",
    A: "curve A",
    B: "curve B",
    DUCTILE: "curve B, 5 %",
    HARDENING: "hardening only",
}
"""The five cases, as scenes are named, and as the reader knows them."""
# cycles of the paper's figures: the last, the end of the first wear, the steady part
LAST, EARLY, STEADY = 25, 6, 10
# coefficients: the whole contact protected; as high as the paper's 0.17 of bulk steel
PROTECTED, NEAR = 0.105, 0.03
AGREED = 0.8  # of the seeds that must agree
INF = float("inf")
Histories = Mapping[str, History]


class Judgement(StrEnum):
    """Of a statement, over all seeds."""

    HELD = "held"
    FAILED = "failed"
    OPEN = "not decided"


@dataclass(frozen=True)
class Statement:
    """One sentence of the paper. cases: that it is about; value: its measure on one surface, NaN: says
    nothing there; asked: (lowest, highest) of the measure; figure: of the paper.
    """

    figure: str
    words: str
    cases: tuple[str, ...]
    measure: str
    value: Callable[[Histories], float]
    asked: tuple[float, float]

    def holds(self, value: float) -> bool:
        """Whether a value is what is asked for."""
        return self.asked[0] <= value <= self.asked[1]

    @property
    def asked_in_words(self) -> str:
        """What is asked for, for the reader."""
        low, high = self.asked
        if np.isinf(low) or np.isinf(high):
            return f"≤ {high:g}" if np.isinf(low) else f"≥ {low:g}"
        return f"{low:g} to {high:g}"


@dataclass(frozen=True)
class JudgedStatement:
    """A statement, its measure on each surface that has its cases, and what follows from the surfaces that
    agree.
    """

    statement: Statement
    values: tuple[float, ...]
    judgement: Judgement

    @property
    def agreeing(self) -> int:
        """Surfaces on which it holds."""
        return sum(self.statement.holds(value) for value in self.values)

    @property
    def spread(self) -> Spread:
        """Median and range over the surfaces."""
        return Spread.of(self.values)

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
        away = min(abs(median - limit) for limit in self.statement.asked if np.isfinite(limit))
        if np.isinf(away) or not between > 0.0:
            return away * INF if away else away
        return away / between

    @property
    def is_close(self) -> bool:
        """Whether the surfaces scatter by more than the median is away from the limit."""
        return self.by_median is not Judgement.OPEN and self.margin < 1.0


def judge(statement: Statement, surfaces: Sequence[Histories]) -> JudgedStatement:
    """Held or failed where eight surfaces of ten agree; a surface on which the measure says nothing, or where
    a run is missing, agrees with neither.
    """
    values = tuple(
        float(statement.value(each)) if set(statement.cases) <= set(each) else float("nan")
        for each in surfaces
    )
    held = sum(statement.holds(value) for value in values)
    failed = sum(not (np.isnan(value) or statement.holds(value)) for value in values)
    needed = AGREED * len(surfaces)
    judgement = Judgement.OPEN
    if values and max(held, failed) >= needed:
        judgement = Judgement.HELD if held >= needed else Judgement.FAILED
    return JudgedStatement(statement, values, judgement)


def ratio(a: float, b: float) -> float:
    """a/b of volumes, rates or heights; for b = 0 infinite, NaN where a is 0 too."""
    if b == 0.0:
        return float("nan") if a == 0.0 else float("inf")
    return a / b


def _volume(case: str, cycle: int = LAST) -> Callable[[Histories], float]:
    return lambda h: h[case].volume_after(cycle)


def _grown(case: str, first: int, last: int) -> Callable[[Histories], float]:
    """Share of the last volume that the cycles after `first` up to `last` wear; 0 where nothing has worn."""
    return lambda h: float(
        np.nan_to_num(ratio((last - first) * h[case].rate(first, last), h[case].volume_after(LAST)))
    )


def _straight(case: str) -> Callable[[Histories], float]:
    """Straightness over cycles 5 to 25; 0, the worst, where nothing wears any more."""
    return lambda h: float(np.nan_to_num(h[case].straightness(5, LAST)))


def _friction_change(case: str) -> Callable[[Histories], float]:
    return lambda h: h[case].at("friction", LAST) - h[case].at("friction", 1)


def _friction_above(case: str, other: str) -> Callable[[Histories], float]:
    return lambda h: h[case].at("friction", LAST) - h[other].at("friction", LAST)


def _less(h: Histories, lower: Sequence[str], upper: Sequence[str], what: Callable[[str], Callable]) -> float:
    """Largest of the first over smallest of the second."""
    return ratio(max(what(case)(h) for case in lower), min(what(case)(h) for case in upper))


def _friction(case: str) -> Callable[[Histories], float]:
    return lambda h: h[case].at("friction", LAST)


# of a coefficient: a hundredth of the low one, more than the steps of a load that a few cells carry
BELOW = (-INF, -1e-3)
STILL = 1e-3  # of the worn volume: what cycles 21 to 25 add at least where wear goes on
LESS = (-INF, 0.999)  # of a ratio
STATEMENTS = (
    Statement(
        "13",
        "bulk: worn in the first six cycles",
        (BULK,),
        "V(6)/V(25)",
        lambda h: ratio(h[BULK].volume_after(EARLY), h[BULK].volume_after(LAST)),
        (0.9, INF),
    ),
    Statement(
        "13",
        "bulk: hardly any wear later",
        (BULK,),
        "wear per cycle, 11–25 over 1–6",
        lambda h: ratio(h[BULK].rate(STEADY, LAST), h[BULK].rate(0, EARLY)),
        (-INF, 0.05),
    ),
    Statement(
        "13", "bulk: friction stays high, 0.17", (BULK,), "μ(25)", _friction(BULK), (0.17 - NEAR, 0.17 + NEAR)
    ),
    Statement(
        "14",
        "curve A: wears linearly after the first cycles",
        (A,),
        "R² of V, 5–25",
        _straight(A),
        (0.95, INF),
    ),
    Statement("14", "curve A: friction falls", (A,), "μ(25) − μ(1)", _friction_change(A), BELOW),
    Statement(
        "14",
        "curve A: friction below that of bulk",
        (A, BULK),
        "μ_A − μ_bulk",
        _friction_above(A, BULK),
        BELOW,
    ),
    Statement("15", "curve B: the whole surface protected", (B,), "μ(25)", _friction(B), (-INF, PROTECTED)),
    Statement(
        "15",
        "curve B: roughness falls more than with A",
        (B, A),
        "Sa_B/Sa_A",
        lambda h: ratio(h[B].at("sa", LAST), h[A].at("sa", LAST)),
        LESS,
    ),
    Statement("15", "curve B: still wears linearly", (B,), "R² of V, 5–25", _straight(B), (0.95, INF)),
    Statement(
        "16",
        "5 % instead of 2 %: the same wear per cycle later",
        (DUCTILE, B),
        "wear per cycle 11–25, ratio",
        lambda h: ratio(h[DUCTILE].rate(STEADY, LAST), h[B].rate(STEADY, LAST)),
        (0.8, 1.2),
    ),
    Statement(
        "16",
        "5 % instead of 2 %: less volume",
        (DUCTILE, B),
        "V(25), ratio",
        lambda h: ratio(_volume(DUCTILE)(h), _volume(B)(h)),
        LESS,
    ),
    Statement(
        "17",
        "hardening: wears as much as bulk",
        (HARDENING, BULK),
        "V(25), ratio",
        lambda h: ratio(_volume(HARDENING)(h), _volume(BULK)(h)),
        (0.5, 2.0),
    ),
    Statement(
        "17",
        "hardening: still wears slowly",
        (HARDENING,),
        "share of V, 21–25",
        _grown(HARDENING, 20, LAST),
        (STILL, 0.2),
    ),
    Statement(
        "17", "hardening: friction falls", (HARDENING,), "μ(25) − μ(1)", _friction_change(HARDENING), BELOW
    ),
    Statement(
        "13–17",
        "volume: hardening and bulk below A and B",
        (BULK, HARDENING, A, B),
        "largest over smallest",
        lambda h: _less(h, (BULK, HARDENING), (A, B), _volume),
        LESS,
    ),
    Statement(
        "13–17",
        "friction: B below A and hardening",
        (B, A, HARDENING),
        "largest over smallest",
        lambda h: _less(h, (B,), (A, HARDENING), _friction),
        LESS,
    ),
    Statement(
        "13–17",
        "friction: A and hardening below bulk",
        (A, HARDENING, BULK),
        "largest over smallest",
        lambda h: _less(h, (A, HARDENING), (BULK,), _friction),
        LESS,
    ),
)
