# SPDX-License-Identifier: MIT
"""Error against cost: what a given error takes, and references that carry an uncertainty of their own.

A curve is a ladder of resolutions, coarse to fine, with a cost and an error each. The time to an error t lies
between two of its points, the last whose error is above t and the next, behind which all errors are at most t
(the bracket): an error that passes through zero on its way is small by chance there, and does not count.
Between the two it is interpolated linearly in the logarithms. No bracket, no time: nothing is extrapolated.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from verification.reference.convergence import extrapolate

TARGETS = (0.05, 0.01, 0.003)
"""Relative errors whose cost is stated."""


@dataclass(frozen=True)
class Reached:
    """Where a curve reaches an error. value: cost, or whatever was interpolated, None if it never does;
    coarsest: even the first point is as good, so that the value is an upper bound; smallest: of the errors.
    """

    value: float | None
    coarsest: bool
    smallest: float


def bracket(errors: Sequence[float], target: float) -> tuple[int, int] | None:
    """Two points between which the error falls to `target` for good, (0, 0): at the first; None: never."""
    above = ~(np.asarray(errors, dtype=float) <= target)  # nan is above
    if not above.size or above[-1]:
        return None
    last = int(np.flatnonzero(above)[-1]) if above.any() else -1
    return max(last, 0), last + 1


def at_error(values: Sequence[float], errors: Sequence[float], target: float, floor: float = 0.0) -> Reached:
    """The value (cost, cells) at which the error is `target`, log-log between the points of the bracket.
    values, errors: (n,), coarse to fine, values positive; floor: errors count as no smaller.
    """
    values, errors = np.asarray(values, dtype=float), np.asarray(errors, dtype=float)
    if values.shape != errors.shape or values.ndim != 1 or not np.all(values > 0.0):
        raise ValueError(f"values and errors: of one length, values positive, not {values} and {errors}")
    errors = np.maximum(errors, floor)
    finite = errors[np.isfinite(errors)]
    smallest = float(finite.min()) if finite.size else float("nan")
    ends = bracket(errors, target)
    if ends is None:
        return Reached(None, False, smallest)
    coarse, fine = ends
    if coarse == fine:
        return Reached(float(values[fine]), True, smallest)
    if not (np.isfinite(errors[coarse]) and errors[fine] > 0.0):
        return Reached(float(values[fine]), False, smallest)  # nothing to interpolate between
    share = np.log(errors[coarse] / target) / np.log(errors[coarse] / errors[fine])
    return Reached(float(values[coarse] * (values[fine] / values[coarse]) ** share), False, smallest)


@dataclass(frozen=True)
class Reference:
    """A value to measure errors against, and its own relative uncertainty: the floor of the figures."""

    value: float
    uncertainty: float
    origin: str

    def error(self, value: float | None) -> float:
        """Relative; nan for a value that is missing."""
        return float("nan") if value is None else abs(value / self.value - 1.0)


@dataclass(frozen=True)
class Ladder:
    """Values of one model over cell sizes h, coarse to fine."""

    name: str
    h: Sequence[float]
    values: Sequence[float]


def limit_of(ladder: Ladder) -> Reference:
    """Richardson's limit with the last correction as uncertainty, else the finest and its change."""
    fitted = extrapolate(ladder.h, ladder.values)
    if fitted.observed:
        return Reference(fitted.limit, max(fitted.uncertainty, fitted.scatter), ladder.name)
    finest, before = ladder.values[-1], ladder.values[-2]
    return Reference(float(finest), abs(before / finest - 1.0), ladder.name)


def agreed(*ladders: Ladder) -> Reference:
    """The limits of independent models as one reference: their mean, weighted with the inverse squares of
    their last corrections. Uncertainty: half the largest disagreement, and no less than a third of the
    smallest correction, what an extrapolation of first order with an exponent off by a half leaves.
    """
    limits = [limit_of(ladder) for ladder in ladders]
    tiny = 1e-12
    weights = np.array([max(each.uncertainty, tiny) ** -2.0 for each in limits])
    values = np.array([each.value for each in limits])
    value = float(weights @ values / weights.sum())
    apart = float(np.ptp(values)) / abs(value) / 2.0
    least = min(each.uncertainty for each in limits) / (3.0 if len(limits) > 1 else 1.0)
    return Reference(value, max(apart, least), " and ".join(each.origin for each in limits))
