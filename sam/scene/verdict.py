# SPDX-License-Identifier: MIT
"""What becomes of a body under repeated loading: it stays elastic, shakes down, settles, alternates or
ratchets.

This is the definition of the verdict, on the plastic strains that a model has found at the ends of periods.
A period is one load cycle, or two where the sign of the traction alternates. Over a period c a cell adds dp
to its accumulated plastic strain and dE to its plastic strain, de = sqrt(2/3 dE : dE) <= dp. Strain below
the floor counts as none.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from sam.arrays import Array, Mask

NEEDED = 3  # periods that are compared; a class other than elastic or shakedown needs one more before them
STEADY, SETTLES = (
    0.02,
    0.9,
)  # of the ratio of dp to that of the period before: 1 up to so much; at most so much
OPEN = 0.02  # of de over dp: more of it does not close
FALLING = 0.9  # of the ratio of de to that of the period before: the mean strain still settles
EQUAL = 0.05  # of the ratio of de: the same in each period
ALIGNED = 0.99  # cosine of the directions of dE in two periods
CARRIES = 0.01  # share of the plastic strain of a period that a class has to carry to be that of the body
FLOOR = 1e-4, 4.0  # of the yield strain: at least, and in tolerances of the solver for each load step


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


@dataclass(frozen=True)
class Period:
    """What a period added. accumulated: dp, (n,); strain: components of dE, (6, n), 11 22 33 23 13 12;
    restarted: (n,), cells in which wear has moved the material.
    """

    accumulated: Array
    strain: Array
    restarted: Mask | None = None

    @property
    def norm(self) -> Array:
        """The norm de, (n,)."""
        square = (self.strain[:3] ** 2).sum(axis=0) + 2 * (self.strain[3:] ** 2).sum(axis=0)
        found: Array = np.sqrt(2 / 3 * square)
        return found


def floor_of(yield_strain: Array, tolerance: float, steps: int) -> Array:
    """The strain below which a period counts as without plastic strain.

    Parameters
    ----------
    yield_strain
        Initial yield stress over Young's modulus of each cell, (n,).
    tolerance, steps
        Of the solver, and load steps of a period.

    Returns
    -------
    Array
        (n,).
    """
    return max(FLOOR[0], FLOOR[1] * tolerance * steps) * yield_strain


def classes(periods: Sequence[Period], total: Array, floor: Array) -> Array:
    """Classify each cell by the last periods.

    Parameters
    ----------
    periods
        All of them, or the last four; the first holds the first loading.
    total
        Accumulated plastic strain of each cell, (n,).
    floor
        See `floor_of`, (n,).

    Returns
    -------
    Array
        Places in `ORDER`, (n,).
    """
    found = np.full(total.shape, ORDER.index(Behaviour.UNDECIDED))
    found[total == 0] = ORDER.index(Behaviour.ELASTIC)
    if len(periods) < NEEDED:
        return found
    last = periods[-NEEDED:]
    p, e = (np.array(values) for values in ([one.accumulated for one in last], [one.norm for one in last]))
    quiet = (total > 0) & (p[1:] <= floor).all(axis=0)
    if len(periods) > NEEDED:
        flows = p[-1] > floor
        rho, turn = _ratio(p), _ratio(e)
        steady = flows & (np.abs(rho - 1) <= STEADY).all(axis=0)
        closes = (e[-1] <= OPEN * p[-1]) | (turn <= FALLING).all(axis=0)
        same = (np.abs(turn - 1) <= EQUAL).all(axis=0) & (_cosine(last[-2], last[-1]) >= ALIGNED)
        found[flows & (rho <= SETTLES).all(axis=0)] = ORDER.index(Behaviour.SETTLING)
        found[steady & closes] = ORDER.index(Behaviour.ALTERNATING)
        found[steady & ~closes & same] = ORDER.index(Behaviour.RATCHETTING)
    found[quiet] = ORDER.index(Behaviour.SHAKEDOWN)
    for one in last:
        if one.restarted is not None:
            found[one.restarted] = ORDER.index(Behaviour.UNDECIDED)
    return found


@dataclass(frozen=True)
class Verdict:
    """Of the body after a period.

    Parameters
    ----------
    behaviour
        The worst class that carries a hundredth of the plastic strain of the period.
    accumulated, strain
        Largest dp of a cell, and largest de.
    ratio, closure
        In the cell of the largest dp: dp over that of the period before, None in the first; de over dp.
    remaining, periods_to_floor
        Where the cell of the largest dp settles: accumulated strain still to come, and periods until dp is
        below the floor; else None.
    flowing, volumes
        Volume in m^3 of the cells whose dp is beyond the floor, and of the cells of each class.
    """

    behaviour: Behaviour
    accumulated: float
    strain: float
    ratio: float | None
    closure: float
    remaining: float | None
    periods_to_floor: float | None
    flowing: float
    volumes: dict[str, float]


def verdict(periods: Sequence[Period], total: Array, floor: Array, volume: Array) -> Verdict:
    """Sum up the cells of a body after the last of some periods.

    Parameters
    ----------
    periods, total, floor
        See `classes`.
    volume
        Of each cell in m^3, (n,).

    Returns
    -------
    Verdict
        Of the body.
    """
    found, last = classes(periods, total, floor), periods[-1]
    flow = np.where(last.accumulated > floor, last.accumulated * volume, 0.0)
    at = int(last.accumulated.argmax())
    top, norm = float(last.accumulated[at]), last.norm
    before = float(periods[-2].accumulated[at]) if len(periods) > 1 else 0.0
    ratio = top / before if before else None
    settles = ORDER[found[at]] is Behaviour.SETTLING and ratio is not None
    return Verdict(
        _worst(found, flow, total),
        top,
        float(norm.max()),
        ratio,
        float(norm[at] / top) if top else 0.0,
        top * ratio / (1 - ratio) if settles and ratio is not None else None,
        float(np.log(floor[at] / top) / np.log(ratio)) if settles and ratio is not None else None,
        float(volume[flow > 0].sum()),
        {each: float(volume[found == k].sum()) for k, each in enumerate(ORDER)},
    )


def _worst(found: Array, flow: Array, total: Array) -> Behaviour:
    """The class of the body: of what flows the worst that carries its share."""
    if not total.any():
        return Behaviour.ELASTIC
    if not flow.any():
        at_rest = found[total > 0] != ORDER.index(Behaviour.UNDECIDED)
        return Behaviour.SHAKEDOWN if at_rest.any() else Behaviour.UNDECIDED
    shares = {each: flow[found == k].sum() / flow.sum() for k, each in enumerate(ORDER)}
    carrying = [each for each in ORDER[:-1] if shares[each] >= CARRIES]
    return carrying[-1] if carrying else Behaviour.UNDECIDED


def _ratio(values: Array) -> Array:
    """Each row over the one before; infinite over 0."""
    return np.divide(values[1:], values[:-1], out=np.full_like(values[1:], np.inf), where=values[:-1] > 0)


def _cosine(a: Period, b: Period) -> Array:
    """Of the angle between dE of two periods, (n,); 0 where one is zero."""
    weights = np.array([1.0, 1.0, 1.0, 2.0, 2.0, 2.0])[:, None]
    along, norms = (weights * a.strain * b.strain).sum(axis=0), 1.5 * a.norm * b.norm
    found: Array = np.divide(along, norms, out=np.zeros_like(along), where=norms > 0)
    return found
