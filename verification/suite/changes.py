# SPDX-License-Identifier: MIT
"""What changed in the gates between two reports: their values one by one, and gates that came or went."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from verification.suite.verify import finished
from verification.text.console import digits, print_table

EQUAL = 1e-12
"""Values count as equal within so much of the larger one; dimensionless ones, which may be rounding itself,
also within it.
"""


@dataclass(frozen=True)
class Change:
    """A gate whose value is another one. before, after: None where the gate is missing or was not
    evaluated.
    """

    gate: str
    before: float | None
    after: float | None
    tolerance: float


def changes(before: Mapping, after: Mapping, equal: float = EQUAL) -> list[Change]:
    """Gates of two reports (the contents of their results.json) that differ in value, in the order of the
    second one.

    The error stands for the value of a field, which has none. What both reports did not run is left out.
    """
    old, new = ({gate["id"]: gate for gate in report["gates"]} for report in (before, after))
    found = []
    for name in [*new, *(name for name in old if name not in new)]:
        one, other = old.get(name), new.get(name)
        first, second = _number(one), _number(other)
        if not _same(first, second, equal, (other or one)["unit"]):
            found.append(Change(name, first, second, (other or one)["tolerance"]))
    return found


def _number(gate: Mapping | None) -> float | None:
    """The value of a gate, or its error if that is all that is known; None where it was not run."""
    if gate is None:
        return None
    return gate["error"] if gate["value"] is None else gate["value"]


def _same(first: float | None, second: float | None, equal: float, unit: str) -> bool:
    if first is None or second is None:
        return first is second
    return abs(first - second) <= equal * max(abs(first), abs(second), 0.0 if unit else 1.0)


def show_changes(folder: Path, older: Path) -> int:
    """Print the changes of the report in `folder` against an older one; 1 if there are any. Raises
    FolderError without either.
    """
    found = changes(finished(older), finished(folder))
    rows = [
        (each.gate, digits(each.before, 10), digits(each.after, 10), digits(each.tolerance)) for each in found
    ]
    if rows:
        print_table(("gate", str(older), str(folder), "tolerance"), rows)
    print(f"{len(found)} gates changed by more than {EQUAL:g}")
    return 1 if found else 0
