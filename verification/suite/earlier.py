# SPDX-License-Identifier: MIT
"""Cases of an earlier report that stay in a new one: those that do not run again.

A publication in several sittings needs no more than its own report: what is of this code stays, word for word
and byte for byte.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from verification.judging import Measured, Row, RowStatus, judge
from verification.rows import load_rows
from verification.suite.freshness import of_other_code, ran_in

Record = Mapping[str, Any]


@dataclass(frozen=True)
class Earlier:
    """Cases of results.json by name, and their gates."""

    cases: Mapping[str, Record] = field(default_factory=dict)
    gates: Sequence[Record] = ()

    @property
    def files(self) -> set[str]:
        """Of their figures, relative to the folder of the report."""
        figures = [figure for case in self.cases.values() for figure in case["figures"]]
        return {figure[kind] for figure in figures for kind in ("png", "csv") if figure[kind]}

    @property
    def inputs(self) -> dict[str, str]:
        """Name of each scene and of what it names -> SHA-256."""
        named = [
            case.get("inputs", {}) for case in self.cases.values()
        ]  # a report of an older format names none
        return {name: digest for inputs in named for name, digest in inputs.items()}

    def among(self, gates: Iterable[Record]) -> list[Record]:
        """Gates of a new report with these in place of those of the same cases, the others of these last."""
        own: dict[str, list[Record]] = {name: [] for name in self.cases}
        for gate in self.gates:
            own[gate["case"]].append(gate)
        found = []
        for gate in gates:
            found += own.pop(gate["case"], []) if gate["case"] in self.cases else [gate]
        return found + [gate for left in own.values() for gate in left]


def earlier(results: Record, known: Iterable[str], wanted: Iterable[str]) -> Earlier:
    """What stays of a report: the cases that are known and not wanted, and of those wanted what came to its
    end with this code, judged anew where only its gates have changed.
    """
    again, cases = set(wanted), dict[str, Record]()
    gates: list[Record] = []
    for name, case in ran_in(results).items():
        own: list[Record] = [gate for gate in results["gates"] if gate["case"] == name]
        if name in again:
            own = [] if of_other_code(name, results) else judged_anew(name, own)
        if own and name in known:
            cases[name] = case if name not in again else {**case, "status": _status(case, own)}
            gates += own
    return Earlier(cases, gates)


def judged_anew(case: str, kept: Sequence[Record]) -> list[Record]:
    """The gates of a case from what was measured; none where the table asks for something else now."""
    measured, table = {gate["id"]: gate for gate in kept}, [g for g in load_rows() if g.case == case]
    if {(g.id, g.metric) for g in table} != {(gate["id"], gate["metric"]) for gate in kept}:
        return []
    if any(gate["error"] is None for gate in kept):
        return []
    return [
        {**measured[g.id], **g.model_dump(), "status": str(_holds(g, measured[g.id]["error"]))} for g in table
    ]


def _holds(gate: Row, error: float) -> RowStatus:
    """An error in the gate's metric against its tolerance."""
    one_sided = gate.model_copy(update={"metric": "at_least" if gate.metric == "at_least" else "at_most"})
    return judge(one_sided, Measured(error)).status


def _status(case: Record, gates: Sequence[Record]) -> str:
    """Of a case that came to its end."""
    unread = any(figure["findings"] for figure in case["figures"])
    red = any(RowStatus(gate["status"]).red for gate in gates)
    return str(RowStatus.FAILED if unread or red else RowStatus.PASSED)
