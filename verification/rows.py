# SPDX-License-Identifier: MIT
"""A row: what is claimed of a quantity, read from the file of a case, and how a measured value is held
against it.

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

A file `verification/cases/<family>/<name>.toml` is a case, or several where it has tables `[cases.NAME]`,
each of which overrides the keys above it. A row is `name = [metric, tolerance, reason, words]` in a table
`[rows.KIND]`; its id is `<case>.<name>`. Braces stand for several rows: `"{sam,fem}-radius"` with
"radius, {SAM,FEM}" are two. A reason "@name" stands in `[reasons]`, an equation "name" in equations.toml.
"""

from __future__ import annotations

import math
import re
import tomllib
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from enum import StrEnum
from functools import cache
from importlib import resources
from pathlib import Path
from typing import Any, Literal

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, ValidationError, field_validator, model_validator

from sam.scene import Problem, SceneError, problems, spelling
from verification.quantities import QUANTITIES, Measured

LEVELS = ("quick", "full")
CASES = "verification/cases"
FAMILIES = (
    *("hertz", "plastic", "sliding", "cyclic", "moving", "published", "energy"),
    *("coated", "rough", "film", "running_in"),
    *("limits", "cost", "peers", "certificates", "robustness"),
)
"""Folders of cases, in the order of the report."""
KINDS = {
    "exact": "closed form or quadrature",
    "published": "published number or formula",
    "model": "the other model",
    "program": "another program",
    "limit": "limit or order under refinement",
    "bound": "bound",
}
"""Kind of a reference -> what it is, for the reader."""
ROW = "a row is [metric, tolerance, reason, words]; without words its name is a quantity"


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


class CaseFile(BaseModel):
    """A case as its file says it.

    equations: (what, formula, source) of the independent answer; levels: at which of LEVELS it runs,
    none: only when it is named. Without `scene` the module of the same name in its folder measures it;
    with one:

    scene: of `verification/scenes`; set: key of the scene, as `loading.force` -> its value here, in SI;
    vary: recipe of `verification.cases.recipes` -> its value; quick: `set` and `vary` that differ at that
    level; models: that solve it; reference: an independent answer, a name in `verification.references`;
    figures: kinds of `verification.cases.kinds`; claims: table of rows -> the names in it.
    """

    model_config = ConfigDict(strict=True, extra="forbid", frozen=True)

    name: str
    family: str
    path: Path
    title: str = Field(min_length=1)
    question: str = ""
    equations: tuple[tuple[str, str, str], ...] = ()
    levels: tuple[Literal["quick", "full"], ...] = ("quick", "full")
    scene: str = ""
    set: dict[str, Any] = {}
    vary: dict[str, Any] = {}
    quick: dict[str, Any] = {}
    models: tuple[Literal["sam", "fem", "fem-3d"], ...] = ()
    reference: str = ""
    figures: tuple[str, ...] = ()
    rows: tuple[Row, ...]
    claims: dict[str, tuple[str, ...]]


@cache
def case_files() -> Mapping[str, CaseFile]:
    """Name -> case of the suite, in the order of the families and of the names of their files."""
    folder = Path(str(resources.files("verification"))) / "cases"
    paths = [path for family in FAMILIES for path in sorted((folder / family).glob("*.toml"))]
    cases = [case for path in paths for case in read_cases(path)]
    return {case.name: case for family in FAMILIES for case in cases if case.family == family}


@cache
def _equations() -> Mapping[str, Sequence[str]]:
    text = resources.files("verification").joinpath("cases", "equations.toml").read_text(encoding="utf-8")
    return tomllib.loads(text)


def read_cases(path: Path) -> list[CaseFile]:
    """The cases of a file. Raises SceneError, which names file, key, value and what is allowed."""
    try:
        content = tomllib.loads(path.read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError, tomllib.TOMLDecodeError) as error:
        raise SceneError([Problem("case file", path.name, str(error))], str(path)) from error
    own, reasons = content.pop("cases", {}), content.pop("reasons", {})
    common = {"name": path.stem.replace("_", "-"), "family": path.parent.name, "path": path}
    cases = [_merged(content, case | {"name": name}) for name, case in own.items()] if own else [content]
    return [_case(common | case, reasons) for case in cases]


def _merged(first: Mapping, second: Mapping) -> dict:
    """Nested tables, the second's values before the first's."""
    both = {k: _merged(first[k], v) if isinstance(v, dict) and k in first else v for k, v in second.items()}
    return {**first, **both}


def _case(content: dict[str, Any], reasons: Mapping[str, str]) -> CaseFile:
    """One case of a file. Raises SceneError with every fault of it."""
    faults: list[Problem] = []
    tables = content.pop("rows", {})
    rows = [
        row
        for table in tables
        for row in _rows(content["name"], table, tables[table], reasons=reasons, faults=faults)
    ]
    named = [each for each in content.get("equations", ()) if isinstance(each, str)]
    content["equations"] = [_equations().get(e, e) if e in named else e for e in content.get("equations", ())]
    lists = {key: tuple(value) for key, value in content.items() if isinstance(value, list)}
    lists["equations"] = tuple(map(tuple, lists["equations"]))
    twice = sorted({row.id for row in rows if sum(other.id == row.id for other in rows) > 1})
    faults += [Problem("rows", name, "occurs twice") for name in twice]
    try:
        case = CaseFile(
            **{**content, **lists}, rows=tuple(rows), claims={k: tuple(v) for k, v in tables.items()}
        )
    except ValidationError as error:
        faults += problems(error)
    if faults:
        raise SceneError(faults, str(content["path"]))
    return case


def _rows(case: str, table: str, named: Mapping, *, reasons: Mapping, faults: list[Problem]) -> Iterator[Row]:
    """The rows of a table, of kind `exact`, or, where two models are held against each other or one against
    something, `sam/fem`, `sam/exact`; what is wrong with one is added to `faults`.
    """
    model, _, against = table.rpartition("/")
    kind = "model" if against == "fem" else against
    lead = f"{model}-" if model and kind != "model" else ""
    of = f", {model.upper()}" + " against FEM" * (kind == "model") if model else ""
    for key, cells in named.items():
        try:
            metric, tolerance, reason, *words = cells
            reason = reasons[reason[1:]] if reason.startswith("@") else reason
            said = words or [f"{QUANTITIES[key].words}{of}"]
            for name, quantity in zip(_braces(key), _braces(*said), strict=True):
                yield Row(
                    id=f"{case}.{lead}{name}",
                    case=case,
                    quantity=quantity,
                    metric=metric,
                    tolerance=tolerance,
                    reason=reason,
                    kind=kind,
                )
        except ValidationError as error:
            faults += [Problem(f"rows.{table}.{key}.{p.key}", p.value, p.allowed) for p in problems(error)]
        except (KeyError, TypeError, ValueError, AttributeError):
            faults.append(Problem(f"rows.{table}.{key}", spelling(cells), ROW))


def _braces(text: str) -> list[str]:
    """The texts that one with braces stands for: a{b,c} for ab and ac."""
    found = re.search(r"\{([^{}]*,[^{}]*)\}", text)
    if not found:
        return [text]
    return [
        each
        for part in found[1].split(",")
        for each in _braces(text[: found.start()] + part + text[found.end() :])
    ]


def load_rows() -> tuple[Row, ...]:
    """The rows of all cases of the suite, in their order."""
    return tuple(row for case in case_files().values() for row in case.rows)


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
    """A row after evaluation. value, expected: None for fields; error: in the gate's metric; note: why it is
    red.
    """

    row: Row
    status: RowStatus
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
    value, expected = _scalar(measured.value), _scalar(measured.expected)
    return Verdict(row, status, value, expected, error, measured.unit, note)


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
    rows: Sequence[Row],
    ran: Mapping[str, Mapping[str, Measured]],
    failures: Mapping[str, str] | None = None,
) -> list[Verdict]:
    """All verdicts, in the order of the table.

    ran: case -> id of a row -> value of the cases that were run; failures: case -> why it broke off. Rows of
    other cases are "not run". A value without a row of its case in the table is a red verdict of its own.
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
    row = Row.model_construct(
        id=name,
        case=case,
        quantity=name,
        metric="none",
        tolerance=0.0,
        reason="no row of its case",
        kind="bound",
    )
    note = f"case {case} returned a value that has no gate"
    return Verdict(row, RowStatus.FAILED, value=_scalar(measured.value), unit=measured.unit, note=note)
