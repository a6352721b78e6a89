# SPDX-License-Identifier: MIT
"""The table of gates, read from the files of the families, and its evaluation.

A gate compares a measured value with its independent answer. What is not finite, not evaluated or not listed
fails:

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
"""

from __future__ import annotations

import math
import tomllib
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from enum import StrEnum
from functools import cache
from importlib import resources
from typing import Literal

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, field_validator, model_validator


class Gate(BaseModel):
    """One row of the table of gates."""

    model_config = ConfigDict(strict=True, extra="forbid", frozen=True)

    id: str = Field(pattern=r"^[a-z0-9][a-z0-9.-]*$")
    case: str = Field(pattern=r"^[a-z0-9][a-z0-9-]*$")
    quantity: str = Field(min_length=1)
    metric: Literal["relative", "absolute", "relative_l2", "at_most", "at_least", "equal"]
    tolerance: float = Field(ge=0.0, allow_inf_nan=False)
    reason: str = Field(min_length=1)

    @field_validator("tolerance", mode="before")
    @classmethod
    def _accept_whole_numbers(cls, value: object) -> object:
        return float(value) if type(value) is int else value

    @model_validator(mode="after")
    def _equal_has_no_tolerance(self) -> Gate:
        if (self.metric == "equal") != (self.tolerance == 0.0):
            raise ValueError(
                f"gate {self.id}: tolerance is 0 for the metric equal, and above 0 for the others"
            )
        return self


@dataclass(frozen=True)
class Measured:
    """A computed value and its independent answer.

    value, expected: numbers, or arrays of one shape for relative_l2; expected stays None for at_most and
    at_least; weight: of each entry of the arrays (1 by default); unit: for the reader only.
    """

    value: object
    expected: object = None
    weight: object = None
    unit: str = ""


class GateStatus(StrEnum):
    """What became of a gate."""

    PASSED = "passed"
    FAILED = "failed"
    UNCHECKED = "unchecked"
    NOT_RUN = "not run"

    @property
    def red(self) -> bool:
        """Whether it counts as a failure."""
        return self in (GateStatus.FAILED, GateStatus.UNCHECKED)


@dataclass(frozen=True)
class Verdict:
    """A gate after evaluation. value, expected: None for fields; error: in the gate's metric; note: why it is
    red.
    """

    gate: Gate
    status: GateStatus
    value: float | None = None
    expected: float | None = None
    error: float | None = None
    unit: str = ""
    note: str = ""


def _difference(v: np.ndarray, e: np.ndarray, w: np.ndarray) -> float:
    return float(np.abs(v - e))


def _relative(v: np.ndarray, e: np.ndarray, w: np.ndarray) -> float:
    return float(np.abs(v - e) / np.abs(e))


def _relative_l2(v: np.ndarray, e: np.ndarray, w: np.ndarray) -> float:
    return float(np.sqrt(np.sum(w * (v - e) ** 2) / np.sum(w * e**2)))


def _size(v: np.ndarray, e: np.ndarray, w: np.ndarray) -> float:
    return float(np.abs(v))


def _itself(v: np.ndarray, e: np.ndarray, w: np.ndarray) -> float:
    return float(v)


_ERRORS: dict[str, Callable[[np.ndarray, np.ndarray, np.ndarray], float]] = {
    "relative": _relative,
    "absolute": _difference,
    "relative_l2": _relative_l2,
    "at_most": _size,
    "at_least": _itself,
    "equal": _difference,
}


LIMITS = dict.fromkeys(_ERRORS, "<=") | {"at_least": ">=", "equal": "=", "none": "="}
"""How the error of each metric is held against the tolerance; "none": a value without a gate."""


FAMILIES = (
    *("hertz", "plastic", "sliding", "cyclic", "moving", "published", "energy"),
    *("coated", "rough", "film", "running_in"),
    *("limits", "cost", "peers", "certificates", "robustness"),
)
"""Families of cases, in the order of the table: each has its file <family>.toml."""


def load_gates(text: str | None = None) -> tuple[Gate, ...]:
    """The table of gates, in the order of the families and of their files; `text` replaces the files.

    A row with `cases`, a list, instead of `case` is one gate for each of them, its id led by the name of the
    case. Raises ValueError for an unknown or missing key, an unknown metric, or an id that occurs twice.
    """
    if text is None:
        text = "\n".join(map(_table, FAMILIES))
    gates = tuple(Gate(**row) for shared in tomllib.loads(text)["gate"] for row in _rows(shared))
    ids = [gate.id for gate in gates]
    twice = sorted({name for name in ids if ids.count(name) > 1})
    if twice:
        raise ValueError(f"gates listed twice: {', '.join(twice)}")
    return gates


@cache
def families() -> Mapping[str, str]:
    """Case -> the family in whose file its gates stand."""
    return {
        row["case"]: family
        for family in FAMILIES
        for shared in tomllib.loads(_table(family))["gate"]
        for row in _rows(shared)
    }


def _table(family: str) -> str:
    folder = resources.files("verification.suite").joinpath("gates")
    return folder.joinpath(f"{family}.toml").read_text(encoding="utf-8")


def _rows(shared: dict) -> Iterator[dict]:
    """The row of each case that a row of the table stands for."""
    if "cases" not in shared or "case" in shared:
        yield shared
        return
    row = {key: value for key, value in shared.items() if key != "cases"}
    for case in shared["cases"]:
        yield {**row, "case": case, "id": f"{case}.{row.get('id')}"}


def judge(gate: Gate, measured: Measured | None, note: str = "") -> Verdict:
    """Evaluate one gate of a case that was run; `note` says why a value is missing."""
    if measured is None:
        return Verdict(gate, GateStatus.UNCHECKED, note=note or "the case returned no value for this gate")
    try:
        error = error_of(gate.metric, measured)
    except (TypeError, ValueError) as problem:
        return Verdict(gate, GateStatus.FAILED, unit=measured.unit, note=str(problem))
    holds = error >= gate.tolerance if gate.metric == "at_least" else error <= gate.tolerance
    status = GateStatus.PASSED if holds and math.isfinite(error) else GateStatus.FAILED
    note = "" if math.isfinite(error) else "not a finite number"
    value, expected = _scalar(measured.value), _scalar(measured.expected)
    return Verdict(gate, status, value, expected, error, measured.unit, note)


def error_of(metric: str, measured: Measured) -> float:
    """The error in a metric. Raises ValueError when the values do not fit it, TypeError when they are no
    numbers.
    """
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
        return _ERRORS[metric](v, e, w)


def _scalar(value: object) -> float | None:
    return float(value) if value is not None and np.ndim(value) == 0 else None


def evaluate(
    gates: Sequence[Gate],
    ran: Mapping[str, Mapping[str, Measured]],
    failures: Mapping[str, str] | None = None,
) -> list[Verdict]:
    """All verdicts, in the order of the table.

    ran: case -> gate id -> value of the cases that were run; failures: case -> why it broke off. Gates of
    other cases are "not run". A value without a row of its case in the table is a red verdict of its own.
    """
    failures = failures or {}
    verdicts = []
    for gate in gates:
        if gate.case in ran:
            verdicts.append(judge(gate, ran[gate.case].get(gate.id), failures.get(gate.case, "")))
        else:
            verdicts.append(Verdict(gate, GateStatus.NOT_RUN))
    listed = {(gate.case, gate.id) for gate in gates}
    for case, values in ran.items():
        verdicts += [_without_row(case, name, values[name]) for name in values if (case, name) not in listed]
    return verdicts


def _without_row(case: str, name: str, measured: Measured) -> Verdict:
    """A value that no gate asks for: forgotten in the table or misspelt, and red either way."""
    gate = Gate.model_construct(
        id=name, case=case, quantity=name, metric="none", tolerance=0.0, reason="no block in suite/gates"
    )
    return Verdict(
        gate,
        GateStatus.FAILED,
        value=_scalar(measured.value),
        unit=measured.unit,
        note=(f"case {case} returned a value that has no gate"),
    )
