# SPDX-License-Identifier: MIT
"""Verdicts as data for machines: results.json, gates.csv, junit.xml, and the plain table on the terminal."""

import json
from collections import Counter
from collections.abc import Mapping, Sequence
from typing import Any
from xml.etree import ElementTree

from verification.judging import LIMITS, RowStatus
from verification.runs.files import plain
from verification.runs.tables import csv_text
from verification.text.console import digits

GATE_COLUMNS = tuple("id case quantity metric value expected unit error tolerance status reason note".split())


def results_json(results: Mapping) -> str:
    """What the pages are made of; each entry of a list is one line: there are more than a thousand gates."""
    fields = [f"{_json(key)}: {_entries(value)}" for key, value in plain(results).items()]
    return "{\n" + ",\n".join(fields) + "\n}\n"


def _entries(value: Any) -> str:
    return "[\n" + ",\n".join(map(_json, value)) + "\n]" if isinstance(value, list) else _json(value)


def _json(value: Any) -> str:
    return json.dumps(value, ensure_ascii=False, allow_nan=False)


def gates_csv(gates: Sequence[Mapping]) -> str:
    """The gates with every digit; what is not a number is an empty cell."""
    return csv_text(GATE_COLUMNS, [[gate[name] for name in GATE_COLUMNS] for gate in gates])


def junit_xml(cases: Sequence[Mapping], gates: Sequence[Mapping], name: str = "samfem verify") -> bytes:
    """A testsuite a case, a testcase a gate, and one each for a case or figures that broke."""
    root = ElementTree.Element("testsuites", name=name)
    for case in cases:
        own = [gate for gate in gates if gate["case"] == case["name"]]
        tests = [("run", "error", {"message": case["failure"]})] if case["failure"] else []
        if lines := unreadable(case):
            tests.append(("figures", "failure", {"message": "; ".join(lines)}))
        tests += [(gate["id"], *_ended(gate)) for gate in own]
        counts = Counter(f"{kind}s" if kind != "skipped" else kind for _, kind, _ in tests)
        said = {kind: str(counts[kind]) for kind in ("failures", "errors", "skipped")}
        said |= {"tests": str(len(tests)), "time": f"{case['seconds'] or 0.0:.3f}"}
        suite = ElementTree.SubElement(root, "testsuite", name=case["name"], **said)
        for title, kind, words in tests:
            test = ElementTree.SubElement(suite, "testcase", classname=case["name"], name=title, time="0")
            if kind:
                ElementTree.SubElement(test, kind, words)
    ElementTree.indent(root)
    return ElementTree.tostring(root, encoding="utf-8", xml_declaration=True)


def _ended(gate: Mapping) -> tuple[str, dict[str, str]]:
    """What stands in the testcase of a gate: its name, empty where the gate passed, and its attributes."""
    if gate["status"] == RowStatus.PASSED:
        return "", {}
    if gate["status"] == RowStatus.NOT_RUN:
        return "skipped", {"message": "the case was not run"}
    off = f"error {gate['error']}, tolerance {gate['tolerance']} ({gate['metric']})"
    message = f"{gate['quantity']}: {off}. {gate['note']}".strip()
    return "failure", {"message": message, "type": gate["status"]}


def unreadable(case: Mapping) -> list[str]:
    """A line for each thing that cannot be read in the figures of a case."""
    return [f"{one['png']}: {what}" for one in case["figures"] for what in one.get("findings", ())]


def text_rows(gates: Sequence[Mapping]) -> tuple[list[tuple[str, ...]], list[bool]]:
    """(case, gate, error, tolerance, status) of each gate of the cases that ran, and whether it is red."""
    ran = [gate for gate in gates if gate["status"] != RowStatus.NOT_RUN]
    limits = (f"{LIMITS[gate['metric']]} {digits(gate['tolerance'])}" for gate in ran)
    rows = [
        (g["case"], g["id"], digits(g["error"]), limit, g["status"])
        for g, limit in zip(ran, limits, strict=True)
    ]
    return rows, [gate["status"] != RowStatus.PASSED for gate in ran]


def origin(solves: Mapping | None) -> str:
    """How many of the runs were solved for this report; empty for one that does not say."""
    if not solves:
        return ""
    text = f"{solves['solved']} solved, {solves['reused']} taken from the store"
    again = [f"{solves[name]} {name}" for name in ("stale", "damaged") if solves[name]]
    if again:
        text += f" ({' and '.join(again)} entries of the store computed again)"
    if solves["cases"]:
        text += f"; cases not run again, code and scenes unchanged: {solves['cases']}"
    return text
