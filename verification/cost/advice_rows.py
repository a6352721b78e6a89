# SPDX-License-Identifier: MIT
"""Rows of the table of advice: what an error takes, as measured by case work-precision and kept in a file."""

from __future__ import annotations

import csv
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from verification.runs.tables import csv_text

ELASTIC, YIELDING, DEEP, SLIDING = "elastic", "yielding", "deeply yielding", "yielding and sliding"
COATED, ROUGH, ROUGH_YIELDING, RUNNING_IN = "coated", "rough, elastic", "rough, yielding", "running-in"
ON_TWO_GRIDS = "sam, solver.extrapolate"
"""Method of the rows of the semi-analytical model that extrapolates from two grids."""
LOAD_STEPS = "load steps"
"""Method of the rows that say how many load steps an error takes."""
COLUMNS = (
    "kind",
    "quantity",
    "method",
    "error",
    "bound",
    "resolution",
    "unit",
    "load_steps",
    "seconds",
    "kernels",
    "relative",
)
BELOW, NEVER = "<", "not reached"


@dataclass(frozen=True)
class AdviceRow:
    """What an error takes. bound: "", BELOW where even the coarsest measured is better, NEVER with the
    smallest error then in `error_reached`. resolution: in `unit`; load_steps: of the measurement; kernels: of
    the calibration, see verification.cost.measured; relative: time over that of the cheapest method for this
    error.
    """

    kind: str
    quantity: str
    method: str
    error: float
    bound: str
    resolution: float
    unit: str
    load_steps: int
    seconds: float
    kernels: float
    relative: float

    def text(self) -> tuple[str, ...]:
        """The cells of a row of the table; empty where there is no number."""
        return tuple(_cell(getattr(self, name)) for name in COLUMNS)


def _cell(value: Any) -> str:
    if isinstance(value, float):
        return f"{value:.3g}" if math.isfinite(value) else ""
    return str(value)


def read_rows(text: str) -> list[AdviceRow]:
    """The rows of a table of advice."""
    kinds = dict.fromkeys(("error", "resolution", "seconds", "kernels", "relative"), _number) | {
        "load_steps": int
    }
    return [
        AdviceRow(**{name: kinds.get(name, str)(row[name]) for name in COLUMNS})
        for row in csv.DictReader(text.splitlines())
    ]


def _number(text: str) -> float:
    return float(text) if text else math.nan


def table_text(rows: Sequence[AdviceRow]) -> str:
    """The file of a table."""
    return csv_text(COLUMNS, [row.text() for row in rows])


def columns_of(rows: Sequence[AdviceRow]) -> Mapping[str, list[str]]:
    """Column -> cells, for the data beside a figure."""
    return {name: [row.text()[k] for row in rows] for k, name in enumerate(COLUMNS)}
