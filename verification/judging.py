# SPDX-License-Identifier: MIT
"""What is claimed of a quantity, and how a measured value is held against it: the one judge of `compare`
and `verify`.

What is not finite, not evaluated or not listed fails:

=============  ==============================================  ===========
metric         error                                           holds when
=============  ==============================================  ===========
relative       |v - e| / |e|                                   error <= tolerance
absolute       |v - e|                                         error <= tolerance
relative_l2    sqrt(sum w (v - e)^2 / sum w e^2)               error <= tolerance
at_most        |v|                                             error <= tolerance
at_least       v                                               error >= tolerance
equal          |v - e|                                         error = 0 (tolerance = 0)
=============  ==============================================  ===========

Where a scale is given it takes the place of |e|, or of the root mean square of e: `radii` is `relative`
with the contact radius. Then equal values agree even at zero.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from enum import StrEnum
from typing import Literal

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, field_validator, model_validator

KINDS = {
    "exact": "closed form or quadrature",
    "published": "published number or formula",
    "model": "the other model",
    "program": "another program",
    "limit": "limit or order under refinement",
    "bound": "bound",
}
"""Kind of a reference -> what it is, for the reader."""


class Row(BaseModel):
    """What one quantity of a case must reach. quantity: in words; kind: of the reference, see KINDS."""

    model_config = ConfigDict(strict=True, extra="forbid", frozen=True)

    id: str = Field(pattern=r"^[a-z0-9][a-z0-9.-]*$")
    case: str = Field(pattern=r"^[a-z0-9][a-z0-9-]*$")
    quantity: str = Field(min_length=1)
    metric: Literal["relative", "absolute", "relative_l2", "at_most", "at_least", "equal"]
    tolerance: float = Field(ge=0.0, allow_inf_nan=False)
    reason: str = Field(min_length=1)
    kind: Literal["exact", "published", "model", "program", "limit", "bound"]

    @field_validator("tolerance", mode="before")
    @classmethod
    def _accept_whole_numbers(cls, value: object) -> object:
        return float(value) if type(value) is int else value

    @model_validator(mode="after")
    def _equal_has_no_tolerance(self) -> Row:
        if (self.metric == "equal") != (self.tolerance == 0.0):
            raise ValueError("the tolerance is 0 for the metric equal, and above 0 for the others")
        return self


@dataclass(frozen=True)
class Measured:
    """A computed value and its independent answer. value, expected: numbers, or arrays of one shape for
    relative_l2; expected stays None for at_most and at_least; weight: of each entry of the arrays (1 by
    default); unit: for the reader only; scale: by which the difference is divided, in place of the expected
    value.
    """

    value: object
    expected: object = None
    weight: object = None
    unit: str = ""
    scale: float | None = None


class RowStatus(StrEnum):
    """What became of a row."""

    PASSED = "passed"
    FAILED = "failed"
    UNCHECKED = "unchecked"
    NOT_RUN = "not run"

    @property
    def red(self) -> bool:
        """Whether it counts as a failure."""
        return self in (RowStatus.FAILED, RowStatus.UNCHECKED)


@dataclass(frozen=True)
class Verdict:
    """A row after evaluation. value, expected: None for fields; error: in the metric; note: why red."""

    row: Row
    status: RowStatus
    value: float | None = None
    expected: float | None = None
    error: float | None = None
    unit: str = ""
    points: int = 1
    note: str = ""

    @property
    def quantity(self) -> str:
        """Of the row, in words."""
        return self.row.quantity

    @property
    def passed(self) -> bool:
        """Whether the value is within its tolerance."""
        return self.status is RowStatus.PASSED


def relative_l2(v: np.ndarray, e: np.ndarray, w: np.ndarray | float = 1.0) -> float:
    """sqrt(sum w (v - e)^2 / sum w e^2)."""
    return float(np.sqrt(np.sum(w * (v - e) ** 2) / np.sum(w * e**2)))


_ERRORS: dict[str, Callable[[np.ndarray, np.ndarray, np.ndarray], float]] = {
    "relative": lambda v, e, w: float(np.abs(v - e) / np.abs(e)),
    "radii": lambda v, e, w: math.nan,
    "absolute": lambda v, e, w: float(np.abs(v - e)),
    "relative_l2": relative_l2,
    "at_most": lambda v, e, w: float(np.abs(v)),
    "at_least": lambda v, e, w: float(v),
    "equal": lambda v, e, w: float(np.abs(v - e)),
}


LIMITS = dict.fromkeys(_ERRORS, "<=") | {"at_least": ">=", "equal": "=", "none": "="}
"""How the error of each metric is held against the tolerance; "none": a value without a gate."""


def judge(row: Row, measured: Measured | None, note: str = "") -> Verdict:
    """Hold a value of a case that was run against its row; `note` says why a value is missing."""
    if measured is None:
        return Verdict(row, RowStatus.UNCHECKED, note=note or "the case returned no value for this row")
    try:
        error = error_of(row.metric, measured)
    except (TypeError, ValueError) as problem:
        return Verdict(row, RowStatus.FAILED, unit=measured.unit, note=str(problem))
    holds = error >= row.tolerance if row.metric == "at_least" else error <= row.tolerance
    status = RowStatus.PASSED if holds and math.isfinite(error) else RowStatus.FAILED
    note = "" if math.isfinite(error) else "not a finite number"
    value, expected = (_scalar(each, measured) for each in (measured.value, measured.expected))
    return Verdict(row, status, value, expected, error, measured.unit, int(np.size(measured.value)), note)


def error_of(metric: str, measured: Measured) -> float:
    """The error in a metric. ValueError when the values do not fit it, TypeError for no numbers."""
    one_sided = metric in ("at_most", "at_least")
    if measured.value is None or (measured.expected is None) != one_sided:
        raise ValueError(f"metric {metric} needs a value {'alone' if one_sided else 'and an expected value'}")
    v = np.asarray(measured.value, dtype=float)
    e = v if one_sided else np.asarray(measured.expected, dtype=float)
    w = np.ones_like(v) if measured.weight is None else np.asarray(measured.weight, dtype=float)
    if not v.shape == e.shape == w.shape:
        raise ValueError(f"shapes differ: value {v.shape}, expected {e.shape}, weight {w.shape}")
    if (v.ndim > 0) != (metric == "relative_l2"):
        raise ValueError(f"metric {metric} does not apply to a value of shape {v.shape}")
    with np.errstate(all="ignore"):
        if measured.scale is None:
            return _ERRORS[metric](v, e, w)
        difference = root_mean_square(v - e, w)
        return difference / measured.scale if difference and measured.scale > 0.0 else difference and math.nan


def root_mean_square(v: np.ndarray, w: np.ndarray) -> float:
    """sqrt(sum w v^2 / sum w), NaN without weight."""
    return float(np.sqrt(np.sum(w * v**2) / total)) if (total := np.sum(w)) > 0.0 else math.nan


def _scalar(value: object, measured: Measured) -> float | None:
    """A number; of a field with a scale its root mean square."""
    if np.ndim(value) and measured.scale is not None:
        return root_mean_square(np.asarray(value), np.asarray(measured.weight))
    return float(value) if value is not None and np.ndim(value) == 0 else None


def evaluate(
    rows: Sequence[Row], ran: Mapping[str, Mapping[str, Measured]], failures: Mapping[str, str] | None = None
) -> list[Verdict]:
    """All verdicts, in the order of the table. ran: case -> id of a row -> value of the cases that were run;
    failures: case -> why it broke off. Rows of other cases are "not run". A value without a row of its case
    in the table is a red verdict of its own.
    """
    failures = failures or {}
    verdicts = []
    for row in rows:
        if row.case in ran:
            verdicts.append(judge(row, ran[row.case].get(row.id), failures.get(row.case, "")))
        else:
            verdicts.append(Verdict(row, RowStatus.NOT_RUN))
    listed = {(row.case, row.id) for row in rows}
    for case, values in ran.items():
        verdicts += [_without_row(case, name, values[name]) for name in values if (case, name) not in listed]
    return verdicts


def _without_row(case: str, name: str, measured: Measured) -> Verdict:
    """A value that no row asks for: forgotten in the file of the case or misspelt, and red either way."""
    said = {"metric": "none", "tolerance": 0.0, "reason": "no row of its case", "kind": "bound"}
    row = Row.model_construct(id=name, case=case, quantity=name, **said)
    note = f"case {case} returned a value that has no gate"
    value = _scalar(measured.value, measured)
    return Verdict(row, RowStatus.FAILED, value=value, unit=measured.unit, note=note)
