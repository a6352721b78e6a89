# SPDX-License-Identifier: MIT
"""What becomes of a body under repeated loading: it stays elastic, shakes down, settles, alternates or
ratchets.

This is the definition of the verdict, on the plastic strains that a model has found at the ends of periods.
A period is one load cycle, or two where the sign of the traction alternates or a counter-body moves to and
fro, which stays on. Over a period c a cell adds dp to its accumulated plastic strain and dE to its plastic
strain, de = sqrt(2/3 dE : dE) <= dp. Strain below the floor counts as none.

The groove that a pass leaves: its depth, its deepest place, the shoulders around it, and which part of it
counts as steady.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from enum import StrEnum
from math import nan
from typing import Any, cast

import numpy as np

from sam.arrays import Array, Mask
from sam.scene.result import VERDICT_COLUMNS
from sam.scene.schema import Scene
from sam.scene.section import stated

NEEDED = 3  # periods whose dp is compared; a class other than elastic or shakedown needs one more before them
LEAST = NEEDED + 1
# of the ratio of dp to that of the period before: 1 up to so much; at most so much
STEADY, SETTLES = 0.02, 0.9
OPEN = 0.02  # of de over dp: more of it does not close
GROWS = 0.05  # of the ratio of de: growth that is none
LASTS = 3000  # periods that a strain lasts in which noise hides the fall: fewer say nothing
ALIGNED = 0.99  # cosine of the directions of dE in two periods
POWER = 0.5  # least exponent of a trend that is a power of the number of periods
SHARES = 1.0, 0.5, 0.1  # of the largest strain: of the points whose loops are recorded
CARRIES = 0.01  # share of the plastic strain of a period that a class has to carry to be that of the body
FLOOR = 1e-4, 4.0  # of the yield strain: at least, and in tolerances of the solver for each load step


VERDICT = "verdict on repeated loading"
"""The stage of a plan."""


class Behaviour(StrEnum):
    """Of a cell, or of the body; from the mildest to the worst."""

    ELASTIC = "elastic"
    SHAKEDOWN = "shakedown"
    SETTLING = "settling"
    ALTERNATING = "alternating"
    RATCHETTING = "ratchetting"
    UNDECIDED = "undecided"


ORDER = tuple(Behaviour)
"""The classes of cells by number."""
PLACE = {behaviour: number for number, behaviour in enumerate(ORDER)}


@dataclass(frozen=True)
class Period:
    """What a period added. accumulated: dp, (n,); norm: de, (n,); strain: components of dE, (6, n), 11 22 33
    23 13 12, wanted of the last two periods; restarted: (n,), cells in which wear has moved the material.
    """

    accumulated: Array
    norm: Array
    strain: Array | None = None
    restarted: Mask | None = None


def norm_of(strain: Array) -> Array:
    """The norm sqrt(2/3 dE : dE), (...), of components 11 22 33 23 13 12, (6, ...)."""
    square = (strain[:3] ** 2).sum(axis=0) + 2 * (strain[3:] ** 2).sum(axis=0)
    return cast(Array, np.sqrt(2 / 3 * square))


@dataclass(frozen=True)
class Judging:
    """How a scene is judged. period: cycles; floor: strain of no plastic strain over the yield
    strain; noise: likewise of the solver; worst: of the hardening law, see `classes`; loaded: the
    load stays on.
    """

    period: int
    floor: float
    noise: float
    worst: Behaviour = Behaviour.RATCHETTING
    loaded: bool = False


def classes(
    periods: Sequence[Period], total: Array, yield_strain: Array, judging: Judging
) -> tuple[Array, Array]:
    """Classify each cell by all periods after the first, which holds the first loading.

    A cell whose dp is steady alternates if its strain closes: de is small, or has fallen by a tenth and ends
    small whatever noise hides, as the geometric series through three periods at equal distances says. It
    ratchets if de does not fall beyond noise over the last half of the periods, keeps its direction, and has
    been followed long enough to see a fall by which it would last less than LASTS periods. What falls never
    ratchets: a fall may slow down, and goes on all the same. Where some back-stress never recovers, its
    energy bounds the plastic strain: no step of the strain lasts, however slowly it falls, and nothing
    ratchets. Where the yield stress grows for ever everything settles.

    total: accumulated plastic strain of each cell; yield_strain: initial yield stress over Young's modulus,
    both (n,). Returns places in `ORDER`, (n,), and periods after which an undecided cell will be decided if
    it goes on like this, (n,), infinite where noise never lets it.
    """
    place, further = np.full(total.shape, PLACE[Behaviour.UNDECIDED]), np.zeros(total.shape)
    place[total == 0] = PLACE[Behaviour.ELASTIC]
    if len(periods) < NEEDED:
        return place, further + LEAST - len(periods)
    floor, last = judging.floor * yield_strain, periods[-NEEDED:]
    p = np.array([period.accumulated for period in last])
    quiet = (total > 0) & (p[1:] <= floor).all(axis=0)
    if len(periods) > NEEDED:
        flows, rho = p[-1] > floor, _ratio(p)
        change = np.abs(rho - 1).max(axis=0)
        slower, steady = flows & (rho < 1).all(axis=0), flows & (change <= STEADY)
        closes, lasts, further = _open_strain(periods, p[-1], yield_strain, judging)
        place[steady & closes] = PLACE[Behaviour.ALTERNATING]
        place[steady & lasts] = PLACE[Behaviour.RATCHETTING]
        settles = slower if judging.worst is Behaviour.SETTLING else flows & (rho <= SETTLES).all(axis=0)
        place[settles] = PLACE[Behaviour.SETTLING]
        further = np.where(steady, further, np.maximum(further, len(periods) * (change / STEADY - 1)))
    place[quiet] = PLACE[Behaviour.SHAKEDOWN]
    for period in last:
        if period.restarted is not None:
            place[period.restarted] = PLACE[Behaviour.UNDECIDED]
    return place, np.maximum(np.ceil(further), 1.0)


def _open_strain(
    periods: Sequence[Period], dp: Array, yield_strain: Array, judging: Judging
) -> tuple[Mask, Mask, Array]:
    """Of cells with steady dp: whether the strain closes; lasts; or after how many periods we know."""
    e, first = np.array([period.norm for period in periods]), np.ones(dp.shape, dtype=int)
    for number, period in enumerate(periods, start=1):
        if period.restarted is not None:
            first[period.restarted] = number
    end, noise, small = len(periods) - 1, judging.noise * yield_strain, OPEN * dp
    apart, back = np.maximum((end - first) // 2, 0), np.maximum((end - first) // 2, 2)
    a, b, begin = (
        np.take_along_axis(e, np.maximum(end - ago, 0)[None], axis=0)[0] for ago in (2 * apart, apart, back)
    )
    c, turn, falls = e[-1], _ratio(e[-NEEDED:]), a - e[-1] > noise
    # the geometric series through a, b, c ends below `small` if (a - small)(c - small) <= (b - small)^2
    excess, doubt = (a - small) * (c - small) - (b - small) ** 2, noise * (a + 2 * b + c - 4 * small)
    closes = (c <= small) | (falls & (c <= SETTLES * a) & (excess + doubt <= 0))
    lasts = (begin - c <= noise) & (noise * LASTS <= back * c) & (turn <= 1 + GROWS).all(axis=0)
    lasts &= (end - first >= 2) & ~closes & (_cosine(*periods[-2:]) >= ALIGNED)
    if judging.worst is not Behaviour.RATCHETTING:
        closes, lasts = (c <= small) | (turn < 1).all(axis=0), np.zeros_like(lasts)
    with np.errstate(divide="ignore", invalid="ignore"):
        rate, root = np.log(a / c) / (2 * apart), np.sqrt(noise / small)
        # nearly a geometric series: until it is small, or sure to end small, but at least half as many
        # periods again, as it slows down a little, and as many where its limit is not small; where it slows
        # down: small as 1/k, or steady as its differences fall
        tells = np.where(root < 1, 2 * np.log((1 + root) / (1 - root)) / rate, np.inf) - 2 * apart
        again = np.where(excess > doubt, 1.0, 0.5) * (end - first)
        ends = np.fmin(np.log(c / small) / rate, np.maximum(tells, again))
        nearly = (excess <= doubt) | ((a - c / 2) * c / 2 <= (b - c / 2) ** 2)
        steady = end - first + 2 * apart * np.log((b - c) / noise) / np.log((a - b) / (b - c))
        slows = np.fmin(apart * (1 / small - 1 / c) / (1 / c - 1 / b), steady)
        still = np.maximum(2 * LASTS * noise / c, 2.0 * (end - first)) - (end - first)
    further: Array = np.where(falls | (rate * LASTS > 1), np.where(nearly, ends, slows), still)
    return closes, lasts, np.where(np.isnan(further), np.inf, further)


def cell_fields(
    periods: Sequence[Period], total: Array, yield_strain: Array, judging: Judging
) -> dict[str, Array]:
    """Fields of the last period, (n,): peeq_step dp, strain_step de, class of ORDER."""
    last = periods[-1]
    places = classes(periods, total, yield_strain, judging)[0].astype(float)
    return {"peeq_step": last.accumulated, "strain_step": last.norm, "class": places}


def loop_places(accumulated: Array, total: Array) -> list[int]:
    """Three points whose loops are recorded: of the largest dp of the period before, (n,), of about
    a half and a tenth of it; by the accumulated strain if nothing flowed.
    """
    values = accumulated if accumulated.any() else total
    share, chosen = values / (values.max() or 1.0), list[int]()
    for wanted in SHARES[: share.size]:
        distance = np.abs(share - wanted)
        distance[chosen] = np.inf
        chosen.append(int(distance.argmin()))
    return chosen


def last_period(judging: Judging, cycles: int) -> range:
    """The load cycles, from 1, of the last whole one of the periods in so many cycles."""
    end = cycles // judging.period * judging.period
    return range(end - judging.period + 1, end + 1)


@dataclass(frozen=True)
class Verdict:
    """Of the body after a period. behaviour: the worst class that carries a hundredth of the
    plastic strain; undecided where cells may ratchet, and de of undecided ones is more than OPEN of
    it, or falls together. accumulated, strain: largest dp and de; ratio, closure: in the cell of
    the largest dp, dp over that before and de over dp; remaining, periods_to_floor: where it
    settles; flowing, volumes in m^3; periods_to_decide: None if decided, or never.
    """

    behaviour: Behaviour
    accumulated: float
    strain: float
    ratio: float | None
    closure: float
    remaining: float | None
    periods_to_floor: float | None
    flowing: float
    volumes: Mapping[str, float]
    periods_to_decide: int | None = None

    @property
    def columns(self) -> tuple[float | int | str | None, ...]:
        """The values of VERDICT_COLUMNS after the number of the period."""
        ratchets = self.volumes[Behaviour.RATCHETTING]
        numbers = self.accumulated, self.strain, self.ratio, self.closure, self.flowing, ratchets
        return *numbers, str(self.behaviour), self.periods_to_decide


UNSTRAINED = Verdict(
    Behaviour.ELASTIC, 0.0, 0.0, None, 0.0, None, None, 0.0, dict.fromkeys(map(str, ORDER), 0.0)
)
"""Of a body that yields nowhere."""


def verdict_on(
    periods: Sequence[Period], total: Array, yield_strain: Array, judging: Judging, *, volume: Array
) -> Verdict:
    """Sum up the cells of a body after the last period; volume: of each in m^3, (n,)."""
    (place, further), last = classes(periods, total, yield_strain, judging), periods[-1]
    floor = judging.floor * yield_strain
    flow = np.where(last.accumulated > floor, last.accumulated * volume, 0.0)
    at = int(last.accumulated.argmax())
    top = float(last.accumulated[at])
    before = float(periods[-2].accumulated[at]) if len(periods) > 1 else 0.0
    ratio = top / before if before else None
    settles = ORDER[place[at]] is Behaviour.SETTLING and ratio is not None
    behaviour, class_of = _worst(place, flow, total), place
    if behaviour is Behaviour.RATCHETTING:
        lasts = (flow > 0) & (place >= PLACE[behaviour])
        fall = periods[-1 - max((len(periods) - 2) // 2, 2)].norm - last.norm - judging.noise * yield_strain
        if (fall * volume)[lasts].sum() > 0:
            class_of = np.where(place == PLACE[behaviour], PLACE[Behaviour.UNDECIDED], place)
            behaviour = _worst(class_of, flow, total)
    waits = (class_of == PLACE[Behaviour.UNDECIDED]) & (flow > 0)
    undecided = np.where(waits, last.norm * volume, 0.0)
    may_ratchet = judging.worst is Behaviour.RATCHETTING and behaviour is not Behaviour.RATCHETTING
    if may_ratchet and undecided.sum() > OPEN * flow.sum():
        behaviour = Behaviour.UNDECIDED
    return Verdict(
        behaviour,
        top,
        float(last.norm.max()),
        ratio,
        float(last.norm[at] / top) if top else 0.0,
        top * ratio / (1 - ratio) if settles and ratio is not None else None,
        float(np.log(floor[at] / top) / np.log(ratio)) if settles and ratio is not None else None,
        float(volume[flow > 0].sum()),
        {str(name): float(volume[place == k].sum()) for k, name in enumerate(ORDER)},
        _until(further, undecided, OPEN * flow.sum()) if behaviour is Behaviour.UNDECIDED else None,
    )


def _until(further: Array, undecided: Array, small: float) -> int | None:
    """Periods after which no more than a small part of the undecided strain is left; None if never."""
    waiting = np.flatnonzero(undecided)
    if not waiting.size:
        return 1
    order = waiting[np.argsort(further[waiting])[::-1]]
    left = np.cumsum(undecided[order]) > small
    after = further[order[int(left.argmax()) if left.any() else -1]]
    return int(after) if np.isfinite(after) else None


def verdict_columns(
    cycles: Sequence[int], verdicts: Sequence[Verdict], cycles_in_period: int
) -> dict[str, list[Any]]:
    """VERDICT_COLUMNS of the table cycles: a period in its last cycle, the others None."""
    rows: dict[int, tuple[Any, ...]] = {
        number * cycles_in_period: (number, *verdict.columns)
        for number, verdict in enumerate(verdicts, start=1)
    }
    empty = (None,) * len(VERDICT_COLUMNS)
    return {name: [rows.get(cycle, empty)[k] for cycle in cycles] for k, name in enumerate(VERDICT_COLUMNS)}


def summary(verdicts: Sequence[Verdict], cycles_in_period: int, floor: float) -> dict[str, Any]:
    """What summary.json says of verdicts; floor: the smallest of a cell."""
    last, first = verdicts[-1], len(verdicts)
    while first > 1 and verdicts[first - 2].behaviour is last.behaviour:
        first -= 1
    trend = _trend([verdict.accumulated for verdict in verdicts]) if last.flowing else None
    settles = trend == "geometric"
    return {
        "class": str(last.behaviour),
        "decided_at_cycle": first * cycles_in_period,
        "peeq_per_period": last.accumulated,
        "strain_per_period": last.strain,
        "trend": trend,
        "remaining_peeq": last.remaining if settles else None,
        "periods_to_floor": last.periods_to_floor if settles else None,
        "floor": floor,
        "volumes_m3": dict(last.volumes),
        "cycles_in_period": cycles_in_period,
        "periods_to_decide": last.periods_to_decide,
    }


def _trend(largest: Sequence[float]) -> str | None:
    """How the largest dp goes on: "steady", "geometric", "power" (slower), or None."""
    values = np.array(largest[-max(NEEDED, len(largest) // 2) :])
    if len(largest) <= NEEDED or values.min() <= 0:
        return None
    ratio = values[1:] / values[:-1]
    if np.abs(ratio[-2:] - 1).max() <= STEADY:
        return "steady"
    if ratio.max() >= 1:
        return None
    number = np.arange(len(largest) - len(values), len(largest)) + 1.0
    slope = np.polyfit(np.log(number), np.log(values), 1)[0]
    return "power" if -slope > POWER and (np.diff(ratio) > 0).all() else "geometric"


def reason_without(scene: Scene) -> str:
    """Why a scene has no verdict, in words; empty if it has one."""
    solver, plasticity, loading = scene.solver, scene.body.plasticity, scene.loading
    if plasticity is None:
        return "no [body.plasticity]"
    if not (solver.verdict or plasticity.back_stresses):
        return "no [body.plasticity.kinematic], and solver.verdict is false"
    if not loading.unload:
        return "loading.unload is false: the strains of unloaded bodies are compared"
    length = cycles_in_period(scene)
    if loading.cycles < LEAST * length:
        return f"loading.cycles = {loading.cycles}: {LEAST * length} are needed, four periods"
    return ""


def judging_of(scene: Scene) -> Judging | None:
    """How a scene is judged; None where it has no verdict."""
    if reason_without(scene):
        return None
    loading, length, plasticity = scene.loading, cycles_in_period(scene), stated(scene.body.plasticity)
    steps = length * (loading.steps + scene.strokes.count + (loading.unload_steps or loading.steps))
    noise, worst = FLOOR[1] * scene.solver.tolerance * steps, Behaviour.RATCHETTING
    if plasticity.grows_for_ever:
        worst = Behaviour.SETTLING
    elif plasticity.bounds_strain:
        worst = Behaviour.ALTERNATING
    return Judging(length, max(FLOOR[0], noise), noise, worst, scene.strokes.goes_back(2))


def counts_dissipation(scene: Scene) -> bool:
    """Whether the energy that each cycle dissipates is asked for: with back-stresses or a verdict."""
    plasticity = scene.body.plasticity
    return plasticity is not None and (plasticity.back_stresses > 0 or judging_of(scene) is not None)


def periods_of(scene: Scene) -> int:
    """How many whole periods a scene has."""
    return scene.loading.cycles // cycles_in_period(scene)


def cycles_in_period(scene: Scene) -> int:
    """Cycles after which the load is the same: 2 where the traction alternates or goes back."""
    friction = scene.friction
    alternates = friction is not None and scene.coefficient > 0 and friction.direction == "alternating"
    return 2 if alternates or scene.strokes.goes_back(2) else 1


def _worst(place: Array, flow: Array, total: Array) -> Behaviour:
    """The class of the body: of what flows the worst that carries its share."""
    if not total.any():
        return Behaviour.ELASTIC
    if not flow.any():
        at_rest = place[total > 0] != PLACE[Behaviour.UNDECIDED]
        return Behaviour.SHAKEDOWN if at_rest.any() else Behaviour.UNDECIDED
    carrying = [name for k, name in enumerate(ORDER[:-1]) if flow[place == k].sum() / flow.sum() >= CARRIES]
    return carrying[-1] if carrying else Behaviour.UNDECIDED


def _ratio(values: Array) -> Array:
    """Each row over the one before; infinite over 0."""
    return np.divide(values[1:], values[:-1], out=np.full_like(values[1:], np.inf), where=values[:-1] > 0)


def _cosine(a: Period, b: Period) -> Array:
    """Of the angle between dE of two periods, (n,); 0 where one is zero, or is no longer known."""
    if a.strain is None or b.strain is None:
        return np.zeros_like(a.norm)
    weights = np.array([1.0, 1.0, 1.0, 2.0, 2.0, 2.0])[:, None]
    along, norms = (weights * a.strain * b.strain).sum(axis=0), 1.5 * a.norm * b.norm
    return cast(Array, np.divide(along, norms, out=np.zeros_like(along), where=norms > 0))


RUN_IN, RUN_OUT = 3.0, 1.5
"""Contact radii after the start and before the end of a path that do not count as steady: at p0 = 4 yield
stresses the groove is within 1 % after 2.7 radii of Swift steel, 3 of linear hardening; the body ahead of the
contact is still raised 1.5 radii before its end.
"""
SETTLED = 0.01  # of the largest new strain of the first pass, below which a pass adds nothing
WITHIN = 0.02  # of the steady depth, after which the groove counts as steady


def steady_part(way: Array, radius: float, length: float) -> Mask:
    """Whether places at these distances from the start are steady; radius: of the contact along x."""
    return (way >= RUN_IN * radius) & (way <= length - RUN_OUT * radius)


def passes_to_steady(strains: Sequence[float]) -> int | None:
    """The first pass with a new strain below a share of the first one, from 1; None if none is."""
    return next((k for k, strain in enumerate(strains, start=1) if strain < SETTLED * strains[0]), None)


@dataclass(frozen=True)
class Groove:
    """Lengths in m, not a number without a steady part: depth, mean over that; deepest and where;
    middle; shoulders at_start, at_end, beside; transient: before the depth is within 2 %.
    """

    depth: float
    deepest: float
    deepest_at: float
    middle: float
    at_start: float
    at_end: float
    beside: float
    transient: float

    @classmethod
    def of(
        cls, way: Array, uz: Array, steady: Mask, length: float, *, across: Array, peak: tuple[float, float]
    ) -> Groove:
        """Of u_z (n,) in m at ascending distances; peak: place and value of the largest."""
        depth, middle, transient = nan, nan, nan
        at, deepest = peak
        if steady.any():
            depth = float(uz[steady].mean())
            places = np.flatnonzero(steady)
            middle = float(np.interp((way[places[0]] + way[places[-1]]) / 2, way, uz))
            if depth > 0:
                transient = _transient(way[: places[-1] + 1], uz[: places[-1] + 1], depth)
        shoulders = (-uz[way < 0], -uz[way > length], -across)
        start, end, side = (float(max(part.max(initial=0.0), 0.0)) for part in shoulders)
        return cls(depth, deepest, at, middle, start, end, side, transient)


def _transient(way: Array, uz: Array, depth: float) -> float:
    """The distance after which u_z stays within WITHIN of the depth, interpolated between the cells."""
    off = np.abs(uz / depth - 1) - WITHIN
    outside = np.flatnonzero(off > 0)
    if not outside.size:
        return 0.0
    k = int(outside[-1])
    if k + 1 == len(way):
        return nan
    share = off[k] / (off[k] - off[k + 1])
    return float(way[k] + share * (way[k + 1] - way[k]))
