# SPDX-License-Identifier: MIT
"""The verification cases and their gates as lists for the reader, and what a mistyped name may have meant."""

from __future__ import annotations

import sys
from collections.abc import Mapping, Sequence
from textwrap import fill

from verification.cases import Case, all_cases
from verification.judging import Row
from verification.rows import load_rows
from verification.text.console import table_lines, unknown

WIDTH = 100
"""Characters of a line of a reason."""


def show_cases(names: Sequence[str]) -> int:
    """One line a case on stdout, of the named ones (none: of all). Returns 0, or 2 for an unknown name."""
    known, gates = all_cases(), load_rows()
    if not _are_known(names, known):
        return 2
    rows = []
    for case in _chosen(names, known):
        count = sum(gate.case == case.name for gate in gates)
        rows.append((case.name, ", ".join(case.levels) or "when named", str(count), case.title))
    print("\n".join(table_lines(("case", "levels", "gates", "title"), rows)))
    return 0


def show_gates(names: Sequence[str]) -> int:
    """Question, gates, tolerances and reasons of the named cases (none: of all) on stdout. Returns 0, or 2 as
    above.
    """
    known, gates = all_cases(), load_rows()
    if not _are_known(names, known):
        return 2
    for case in _chosen(names, known):
        print(f"{case.name}: {case.question}")
        for gate in gates:
            if gate.case == case.name:
                print(f"  {gate.id}: {gate.quantity}: {_limit(gate)}")
                print(fill(gate.reason, WIDTH, initial_indent=" " * 6, subsequent_indent=" " * 6))
    return 0


def unknown_cases(names: Sequence[str], known: Mapping[str, Case]) -> str:
    """What is wrong with names of cases, or an empty text."""
    wrong = [name for name in names if name not in known]
    return unknown("case", wrong, known, "samfem verify --list shows all") if wrong else ""


def _are_known(names: Sequence[str], known: Mapping[str, Case]) -> bool:
    problem = unknown_cases(names, known)
    if problem:
        print(f"samfem: error: {problem}", file=sys.stderr)
    return not problem


def _chosen(names: Sequence[str], known: Mapping[str, Case]) -> list[Case]:
    return [case for case in known.values() if not names or case.name in names]


def _limit(gate: Row) -> str:
    """What the gate allows, in words."""
    match gate.metric:
        case "equal":
            return "equal"
        case "at_most" | "at_least":
            return f"{gate.metric.replace('_', ' ')} {gate.tolerance:g}"
        case _:
            words = {"relative_l2": "relative difference (L2)"}.get(gate.metric, f"{gate.metric} difference")
            return f"{words} at most {gate.tolerance:g}"
