# SPDX-License-Identifier: MIT
"""What an error of 1 % costs: the table of the first page, from those of the case that measured it."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from verification.suite.pages.pairs import number_in
from verification.suite.pages.stored import ShownCase, Stored
from verification.text.console import number

CASE, TARGET = "work-precision", "1 %"
COLUMNS = ("contact", "error of the", "SAM [s]", "FEM [s]", "FEM over SAM", "FEM: the fastest model")
NOTE = (
    "Of SAM and of the finite elements that are fastest there, in a new process each. <: even the coarsest "
    "grid or mesh has so small an error; not reached: none that was tried has."
)
BOUND = "<"
"""Begin of a time that even the coarsest grid keeps below."""


@dataclass(frozen=True)
class Cost:
    """Processor times to the error in one contact. quantity: that has the error; sam, fem: seconds as the
    case writes them, or that the error is not reached; model: the fastest finite elements.
    """

    problem: str
    quantity: str
    sam: str
    fem: str
    model: str

    @property
    def ratio(self) -> float:
        """Of finite elements to SAM; NaN where one of them does not reach the error."""
        return _seconds(self.fem) / _seconds(self.sam)

    @property
    def known(self) -> bool:
        """Whether the ratio is one, and not that of two bounds."""
        return self.ratio > 0.0 and not (self.sam.startswith(BOUND) and self.fem.startswith(BOUND))

    @property
    def shown(self) -> str:
        """The ratio for the reader, as a bound where a time is one."""
        if math.isnan(self.ratio):
            return ""
        if not self.known:
            return "not known"
        signs = {(True, False): "> ", (False, True): "< "}
        return signs.get((self.sam.startswith(BOUND), self.fem.startswith(BOUND)), "") + number(self.ratio, 2)

    @property
    def row(self) -> tuple[str, ...]:
        """Of the table."""
        return self.problem, self.quantity, self.sam, self.fem, self.shown, self.model


def costs_of(stored: Stored) -> list[Cost]:
    """Every contact of the case, none where it did not run."""
    case = stored.ran.get(CASE)
    return list(_costs(case)) if case else []


def table_of(costs: list[Cost]) -> dict:
    """For the templates."""
    caption = f"Processor seconds on one thread to an error of {TARGET}"
    return {"caption": caption, "columns": COLUMNS, "rows": [each.row for each in costs], "note": NOTE}


def _costs(case: ShownCase) -> Iterator[Cost]:
    tables = case.case["tables"]
    quantities: dict[str, list[str]] = {}
    times: dict[str, dict[str, str]] = {}
    for table in tables:
        columns = list(table["columns"])
        if columns[:2] == ["problem", "quantity (SI)"]:
            for row in table["rows"]:
                quantities.setdefault(row[0], []).append(row[1])
        elif columns[:2] == ["problem", "method"] and TARGET in columns:
            for row in table["rows"]:
                times.setdefault(row[0], {})[row[1]] = row[columns.index(TARGET)].split(" (")[0]
    for problem, found in times.items():
        words = " and ".join(dict.fromkeys(quantities.get(problem, ())))
        yield Cost(problem, words, found.get("SAM", ""), *_fastest(found))


def _fastest(found: Mapping[str, str]) -> tuple[str, str]:
    """(time, name) of the finite elements that are fastest; of those that reach it not, the first."""
    fem = {name: time for name, time in found.items() if name.startswith("FEM")}
    reached = {name: _seconds(time) for name, time in fem.items() if _seconds(time) > 0.0}
    best = min(reached, key=lambda name: reached[name], default=next(iter(fem), ""))
    return fem.get(best, ""), best.removeprefix("FEM, ")


def _seconds(time: str) -> float:
    """NaN where it is none."""
    return number_in(time.lstrip(f"{BOUND} "))
