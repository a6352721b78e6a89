# SPDX-License-Identifier: MIT
"""What changed in the gates between two reports, and whether each gate of the older one still stands."""

import csv
import math
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from verification.runs.files import FolderError
from verification.suite.verify import finished
from verification.text.console import digits, print_table

EQUAL, GROWN = 1e-12, 2.0
"""Values count as equal within so much of the larger one; dimensionless ones also within it."""


@dataclass(frozen=True)
class Change:
    """A gate whose value is another one. before, after: None where it is missing or was not evaluated."""

    gate: str
    before: float | None
    after: float | None
    tolerance: float


def changes(before: Mapping, after: Mapping, equal: float = EQUAL) -> list[Change]:
    """Gates of two reports (the contents of their results.json) that differ in value, in the order of the
    second one. The error stands for the value of a field, which has none. What both reports did not run is
    left out.
    """
    old, new = ({gate["id"]: gate for gate in report["gates"]} for report in (before, after))
    found = []
    for name in [*new, *(name for name in old if name not in new)]:
        one, other = old.get(name), new.get(name)
        first, second = _number(one), _number(other)
        if not _same(first, second, equal, (other or one)["unit"]):
            found.append(Change(name, first, second, (other or one)["tolerance"]))
    return found


def lost(before: Mapping, after: Mapping, rows: Mapping[str, str]) -> list[str]:
    """What the later report no longer claims: a line for each gate of the earlier one without an entry, with
    another metric, a wider tolerance or fewer points.

    rows: gate -> the gate that it is now, or what stands for it, a test (`tests/...::name`) or a sentence.
    """
    new, found = {gate["id"]: gate for gate in after["gates"]}, []
    for old in before["gates"]:
        now, sign = new.get(rows.get(old["id"], "")), -1 if old["metric"] == "at_least" else 1
        if old["id"] not in rows:
            found.append(f"{old['id']}: the table has no entry for it")
        elif now is None:
            if " " not in rows[old["id"]] and "::" not in rows[old["id"]]:
                found.append(f"{old['id']}: there is no gate {rows[old['id']] or 'for it'}")
        elif now["metric"] != old["metric"]:
            found.append(f"{old['id']}: metric {now['metric']}, was {old['metric']}")
        elif sign * now["tolerance"] > sign * old["tolerance"]:
            found.append(f"{old['id']}: tolerance {now['tolerance']:g}, was {old['tolerance']:g}")
        elif (now.get("points") or 1) < (old.get("points") or 0):
            found.append(f"{old['id']}: {now['points']} points, were {old['points']}")
    return found


def grown(before: Mapping, after: Mapping) -> list[str]:
    """A line for each error that is more than twice that of the earlier report, and no rounding."""
    old = {gate["id"]: gate["error"] for gate in before["gates"] if gate["metric"] != "at_least"}
    return [
        f"{gate['id']}: error {gate['error']:.3g}, was {old[gate['id']]:.3g}"
        for gate in after["gates"]
        if gate["error"] is not None
        and gate["error"] > max(GROWN * (old.get(gate["id"]) or math.inf), 10.0 * EQUAL)
    ]


def _number(gate: Mapping | None) -> float | None:
    """The value of a gate, or its error if that is all that is known; None where it was not run."""
    if gate is None:
        return None
    return gate["error"] if gate["value"] is None else gate["value"]


def _same(first: float | None, second: float | None, equal: float, unit: str) -> bool:
    if first is None or second is None:
        return first is second
    return abs(first - second) <= equal * max(abs(first), abs(second), 0.0 if unit else 1.0)


def show_changes(folder: Path, older: Path, table: Path | None = None) -> int:
    """Print the changes of the report in `folder` against an older one, and which errors grew; 1 if
    there are any, or, with a table of gates and rows, if a gate is lost. Raises FolderError without
    a report or the table.
    """
    before, after = finished(older), finished(folder)
    found = changes(before, after)
    rows = [
        (each.gate, digits(each.before, 10), digits(each.after, 10), digits(each.tolerance)) for each in found
    ]
    if rows:
        print_table(("gate", str(older), str(folder), "tolerance"), rows)
    print(f"{len(found)} gates changed by more than {EQUAL:g}")
    print("".join(f"{line}\n" for line in grown(before, after)), end="")
    if table is None:
        return 1 if found else 0
    try:
        with table.open(encoding="utf-8", newline="") as lines:
            missing = lost(before, after, {gate: row for gate, row, *_ in csv.reader(lines)})
    except (OSError, ValueError) as error:
        raise FolderError(f"{table}: no table of gates and rows, gate,row a line: {error}") from error
    print(*missing, f"{len(missing)} gates lost", sep="\n")
    return 1 if missing else 0
