# SPDX-License-Identifier: MIT
"""The statements of the paper about running-in, counted in the tables of the cases that judge them."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from verification.suite.pages.stored import ShownCase, Stored

STATEMENT = "statement of the paper"
VERDICTS = ("held", "failed", "not decided")


@dataclass(frozen=True)
class Statements:
    """A table of statements. counts: (reading of the paper and rule of the verdict, `6 held, 8 failed,
    3 not decided`).
    """

    case: ShownCase
    counts: Sequence[tuple[str, str]]


def statements_of(stored: Stored) -> list[Statements]:
    """The tables of the cases that ran in which statements have verdicts."""
    found = (
        Statements(each, _counts(table))
        for each in stored.ran.values()
        for table in each.case["tables"]
        if STATEMENT in table["columns"]
    )
    return [each for each in found if each.counts]


def _counts(table: Mapping) -> list[tuple[str, str]]:
    rows, counts, reading = table["rows"], [], ""
    for k, name in enumerate(table["columns"]):
        reading = name.partition(":")[0] if ":" in name else reading
        if rows and all(row[k].startswith(VERDICTS) for row in rows):
            words = f"{reading}, {name}" if reading else name
            counts.append((words, _count([row[k] for row in rows])))
    return counts


def _count(cells: Sequence[str]) -> str:
    found = Counter(verdict for cell in cells for verdict in VERDICTS if cell.startswith(verdict))
    return f"{', '.join(f'{found[verdict]} {verdict}' for verdict in VERDICTS)}, of {len(cells)}"
