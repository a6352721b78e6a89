# SPDX-License-Identifier: MIT
"""The rows of compare.csv: a quantity or a field of two results, their difference, and what it may be.

A value that is missing or not finite fails. Metrics: "relative" |sam - fem|/|fem|; "radii" |sam - fem|/a with
a the contact radius of FEM; "relative L2" sqrt(sum w (sam - fem)^2 / sum w fem^2), for which the columns sam
and fem hold the root mean squares.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import astuple, dataclass, fields
from typing import Protocol

import numpy as np

Limit = tuple[float, str]
"""A tolerance and its reason."""
BELOW_SURFACE = 0.3
"""Contact radii: stresses and strains of a sliding contact are compared from this depth on."""
NO_RESIDUAL = 1e-6
"""Of the approach or the largest stress at peak load: a residual below it is no more than the tolerance of a
solver."""


class Solution(Protocol):
    """The part of a `Result` or a `Run` that is compared."""

    quantities: Mapping[str, float | None]
    tables: Mapping[str, Mapping[str, Sequence]]


@dataclass(frozen=True)
class Comparison:
    """One line of compare.csv."""

    quantity: str
    sam: float
    fem: float
    metric: str
    difference: float
    tolerance: float
    passed: bool
    reason: str


COLUMNS = tuple(field.name for field in fields(Comparison))


@dataclass(frozen=True)
class Pair:
    """Two results of one scene.

    radius: contact radius of FEM in m; plastic: the body yields (a spline interpolates SAM); slides: there is
    friction, which may bring the largest stress to the surface; spatial: FEM is three-dimensional, and both
    sides of the axis are compared; film: thickness of a coating in m, in which only its largest stress is
    compared.
    """

    sam: Solution
    fem: Solution
    radius: float
    punch: bool
    plastic: bool
    slides: bool = False
    spatial: bool = False
    film: float = 0.0

    @property
    def top(self) -> float:
        """Depth in m from which stresses and strains are compared: in the body, below its film."""
        return max(BELOW_SURFACE * self.radius if self.slides else 0.0, self.film)

    def floor(self, name: str) -> float:
        """What counts as no residual, from a quantity of FEM at peak load; 0 if it is missing."""
        value = abs(number(self.fem.quantities.get(name)))
        return NO_RESIDUAL * value if math.isfinite(value) else 0.0


def table_rows(rows: Sequence[Comparison]) -> list[tuple]:
    """The cells of compare.csv, in the order of COLUMNS."""
    return [astuple(row) for row in rows]


def number(value: float | None) -> float:
    """A quantity as a float: NaN where it is missing."""
    return math.nan if value is None else float(value)


def scalar_row(pair: Pair, name: str, metric: str, limit: Limit) -> Comparison:
    """The row of a quantity that both results have."""
    a, b = (number(result.quantities.get(name)) for result in (pair.sam, pair.fem))
    floor = pair.floor("approach_m") if "residual" in name else 0.0
    scale = pair.radius if metric == "radii" else max(abs(b), floor)
    return judged(name, (a, b), metric, _ratio(abs(a - b), scale), limit=limit)


def field_row(pair: Pair, name: str, sample: Callable, limit: Limit) -> Comparison:
    """The row of a field; sample: from the pair the values of SAM and FEM at the same places, and their
    weights.
    """
    try:
        a, b, weight = sample(pair)
    except (KeyError, IndexError, ValueError):  # a table or state is missing, or too small to interpolate in
        a = b = weight = np.array([math.nan])
    total = np.sum(weight)
    rms = [float(np.sqrt(np.sum(weight * v**2) / total)) if total > 0 else math.nan for v in (a, b, a - b)]
    floor = pair.floor("approach_m" if "uz_m" in name else "mises_max_Pa") if "residual" in name else 0.0
    return judged(name, (rms[0], rms[1]), "relative L2", _ratio(rms[2], max(rms[1], floor)), limit=limit)


def _ratio(difference: float, scale: float) -> float:
    """difference/scale; equal values agree even at zero, and a scale of zero or NaN never passes."""
    if difference == 0:
        return 0.0
    return difference / scale if scale > 0 else math.nan


def judged(
    name: str, values: tuple[float, float], metric: str, difference: float, *, limit: Limit
) -> Comparison:
    """A row, which passes where the difference is no more than the tolerance."""
    tolerance, reason = limit
    return Comparison(name, *values, metric, difference, tolerance, bool(difference <= tolerance), reason)
