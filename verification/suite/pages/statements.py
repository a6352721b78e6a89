# SPDX-License-Identifier: MIT
"""The statements of the paper about running-in, counted in the tables of the cases that judge them."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from verification.suite.pages.stored import ShownCase, Stored

STATEMENT = "statement of the paper"
FOLLOWS = {
    "bulk: hardly any wear later": "bulk: worn in the first six cycles",
    "curve A: friction below that of bulk": "friction: A and hardening below bulk",
}
"""Statements that say no more than another one does -> that one. The first follows by what is asked of both:
where nine tenths wear in 6 cycles, 15 of the other 19 wear at less than a twentieth of that rate. The second
follows in words only: a difference of 0.001 is asked of it, and of that one a ratio of 0.999.
"""
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
            own = [row[k] for row in rows if FOLLOWS.keys().isdisjoint(row)]
            more = f"; of the {len(own)} independent ones {_count(own)}" if len(own) < len(rows) else ""
            counts.append((words, f"{_count([row[k] for row in rows])}, of {len(rows)}{more}"))
    return counts


def _count(cells: Sequence[str]) -> str:
    found = Counter(verdict for cell in cells for verdict in VERDICTS if cell.startswith(verdict))
    return ", ".join(f"{found[verdict]} {verdict}" for verdict in VERDICTS)
