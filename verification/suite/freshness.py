# SPDX-License-Identifier: MIT
"""Which cases of a published report are older than the code in front of the reader, and why; and which of an
earlier report stay in a new one, word for word and byte for byte: those that do not run again.

results.json says of each case by which code it was made (`code`, a digest of the files that it depends on),
by which case file (`file`, its digest but for limits) and of which scenes (`inputs`, their SHA-256).
Documentation and what only words a page do not count.
"""

import hashlib
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from verification.cases import all_cases
from verification.judging import Measured, Row, RowStatus, judge
from verification.rows import load_rows
from verification.runs.code_version import version_of_cases
from verification.suite.outcomes import file_digest, present

Record = Mapping[str, Any]
JUDGED_BY = ("metric", "tolerance", "quantity", "reason")


def stale(results: Mapping) -> dict[str, str]:
    """Name of each case that must be published again -> why; also unpublished ones that can run here."""
    known, ran = all_cases(), ran_in(results)
    gone = {name: "there is no such case any more" for name in ran if name not in known}
    asked = [case for case in known.values() if case.name in ran or case.published_at(results["level"])]
    found = {case.name: _why(case.name, results) for case in asked if case.name in ran or not case.needs()}
    return gone | {name: why for name, why in found.items() if why}


def older(results: Mapping) -> dict[str, str]:
    """The cases of `stale` that came to their end: what is shown is of other code. A comparison has none."""
    if results.get("kind") == "comparison":
        return {}
    ended = {name for name, case in ran_in(results).items() if not case["failure"]}
    return {name: why for name, why in stale(results).items() if name in ended}


def ran_in(results: Mapping) -> dict[str, Mapping]:
    """The cases of a report that ran, by name."""
    return {case["name"]: case for case in results["cases"] if case["status"] != RowStatus.NOT_RUN}


def _why(name: str, results: Mapping) -> str:
    """Why a case has to be published again, empty if it need not."""
    return of_other_code(name, results) or ("" if _judged(name, results) else "its gates have changed")


def of_other_code(name: str, results: Mapping) -> str:
    """Why a case has to run again, empty if what it found is of this code and of these scenes."""
    case = ran_in(results).get(name)
    if case is None:
        return "not published"
    if case["failure"]:
        return "it broke off"
    if case.get("code") != version_of_cases():
        return "the code that it depends on has changed"
    if case.get("file") != file_digest(all_cases().get(name)):
        return "its case file has changed"
    changed = [scene for scene, digest in case["inputs"].items() if digest != _digest(scene)]
    return f"{', '.join(changed)} changed" if changed else ""


def _digest(scene: str) -> str:
    return hashlib.sha256(present(scene) or b"").hexdigest()


def _judged(name: str, results: Mapping) -> bool:
    """Whether the gates of a case are those of the table."""
    kept = {g["id"]: tuple(g[key] for key in JUDGED_BY) for g in results["gates"] if g["case"] == name}
    return kept == {g.id: tuple(getattr(g, key) for key in JUDGED_BY) for g in load_rows() if g.case == name}


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
