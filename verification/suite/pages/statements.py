# SPDX-License-Identifier: MIT
"""The statements of the paper about running-in, read from the tables of the cases that judge them."""

from __future__ import annotations

import re
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

    caption: str
    note: str
    case: ShownCase
    columns: Sequence[str]
    rows: Sequence[Sequence[str]]
    counts: Sequence[tuple[str, str]]


def statements_of(stored: Stored) -> list[Statements]:
    """The tables of statements of the cases that ran."""
    return [
        _of_table(each, table)
        for each in stored.ran.values()
        for table in each.case["tables"]
        if STATEMENT in table["columns"]
    ]


def _of_table(each: ShownCase, table: Mapping) -> Statements:
    columns, rows = list(table["columns"]), table["rows"]
    counts, reading = [], ""
    for k, name in enumerate(columns):
        reading = name.partition(":")[0] if ":" in name else reading
        if rows and all(row[k].startswith(VERDICTS) for row in rows):
            words = f"{reading}, {name}" if reading else name
            counts.append((words, _count([row[k] for row in rows])))
    caption, *note = re.split(r"\. (?=[A-Z])", table["caption"], maxsplit=1)
    return Statements(caption, "".join(note), each, columns, rows, counts)


def _count(cells: Sequence[str]) -> str:
    found = Counter(verdict for cell in cells for verdict in VERDICTS if cell.startswith(verdict))
    return f"{', '.join(f'{found[verdict]} {verdict}' for verdict in VERDICTS)}, of {len(cells)}"
