# SPDX-License-Identifier: MIT
"""The rows of compare.csv: a quantity or a field of two results, their difference, and what it may be.

A value that is missing or not finite fails. Metrics: "relative" |sam - fem|/|fem|; "radii" |sam - fem|/a with
a the contact radius of FEM; "relative L2" sqrt(sum w (sam - fem)^2 / sum w fem^2), for which the columns sam
and fem hold the root mean squares.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np

from verification.judging import Measured, Row, Verdict, judge, root_mean_square

Limit = tuple[float, str]
"""A tolerance and its reason."""
BELOW_SURFACE = 0.3
"""Contact radii: stresses and strains of a sliding contact are compared from this depth on."""
NO_RESIDUAL = 1e-6
"""Of the approach or the largest stress at peak load: a residual below it is no more than the tolerance of a
solver."""


class Solution(Protocol):
    """The part of a `Result` or a `Run` that is compared."""

    @property
    def quantities(self) -> Mapping[str, float | None]: ...

    @property
    def tables(self) -> Mapping[str, Any]: ...


COLUMNS = ("quantity", "sam", "fem", "metric", "difference", "tolerance", "passed", "reason")
"""Of compare.csv."""


@dataclass(frozen=True)
class Pair:
    """Two results of one scene. radius: contact radius of FEM in m; kinds: the tables of `rows.toml` that
    they have, which also say how they are compared; film: thickness of a coating in m, in which only its
    largest stress is compared.
    """

    sam: Solution
    fem: Solution
    radius: float = math.nan
    kinds: frozenset[str] = frozenset()
    film: float = 0.0

    @property
    def both(self) -> tuple[Solution, Solution]:
        return self.sam, self.fem

    @property
    def plastic(self) -> bool:
        return "plastic" in self.kinds

    @property
    def top(self) -> float:
        """Depth in m from which stresses are compared: below the film, and the peak that friction shifts."""
        return max(BELOW_SURFACE * self.radius if "slides" in self.kinds else 0.0, self.film)

    def floor(self, name: str) -> float:
        """What counts as no residual, from a quantity of FEM at peak load; 0 if it is missing."""
        value = abs(number(self.fem.quantities.get(name)))
        return NO_RESIDUAL * value if math.isfinite(value) else 0.0


def table_rows(rows: Sequence[Verdict]) -> list[tuple]:
    """The cells of compare.csv, in the order of COLUMNS."""
    found = []
    for each in rows:
        values = each.quantity, each.value, each.expected, metric_of(each)
        found.append((*values, each.error, each.row.tolerance, each.passed, each.row.reason))
    return found


def metric_of(verdict: Verdict) -> str:
    """The metric of a row in words."""
    return verdict.row.metric.replace("_l2", " L2")


def number(value: float | None) -> float:
    """A quantity as a float: NaN where it is missing."""
    return math.nan if value is None else float(value)


def scalar_row(pair: Pair, name: str, metric: str, limit: Limit) -> Verdict:
    """The row of a quantity that both results have."""
    a, b = (number(result.quantities.get(name)) for result in pair.both)
    floor = pair.floor("approach_m") if "residual" in name else 0.0
    scale = pair.radius if metric == "radii" else max(abs(b), floor)
    return judged(name, metric, Measured(a, b, scale=scale), limit)


def field_row(pair: Pair, name: str, sample: Callable, limit: Limit) -> Verdict:
    """The row of a field; sample: pair -> values of SAM and FEM at the same places, and their weights."""
    try:
        a, b, weight = sample(pair)
    except (KeyError, IndexError, ValueError):  # a table or state is missing, or too small to interpolate in
        a = b = weight = np.array([math.nan])
    floor = pair.floor("approach_m" if "uz_m" in name else "mises_max_Pa") if "residual" in name else 0.0
    scale = max(root_mean_square(b, weight), floor)
    return judged(name, "relative_l2", Measured(a, b, weight, scale=scale), limit)


def judged(name: str, metric: str, measured: Measured, limit: Limit) -> Verdict:
    """A row of `compare` with its value; limit: its tolerance and the reason."""
    tolerance, reason = limit
    said = {"quantity": name, "metric": metric, "tolerance": tolerance, "reason": reason}
    return judge(Row.model_construct(id=name, case="compare", kind="model", **said), measured)
