# SPDX-License-Identifier: MIT
"""The page: one self-contained HTML file made from results.json and the figures, without solving anything."""

from __future__ import annotations

import base64
import re
from collections.abc import Iterator, Mapping
from pathlib import Path

from jinja2 import Environment, PackageLoader, StrictUndefined

from verification.runs.store import short
from verification.suite.judging import LIMITS, GateStatus
from verification.text.console import number

_METRICS = {
    "relative": "relative",
    "absolute": "absolute",
    "relative_l2": "relative L2",
    "at_most": "at most",
    "at_least": "at least",
    "equal": "equal",
}

_SIGNS = {"<=": "\N{LESS-THAN OR EQUAL TO}", ">=": "\N{GREATER-THAN OR EQUAL TO}", "=": "="}

_CONTROL = re.compile(r"[\x00-\x08\x0b\x0c\x0e-\x1f\x7f-\x9f]")  # not allowed in HTML


WORDS = {
    "verification": {
        "title": "Verification of elastic and elasto-plastic contact: SAM and FEM",
        "heading": "Verification report",
        "lead": "Each contact is described once. The semi-analytical method (SAM) and, where they can "
        "represent it, finite elements (FEM) solve it without sharing any physics code, and are held against "
        "closed forms and against each other.",
        "case": "Case",
        "gate": "Gate",
    },
    "comparison": {
        "title": "Comparison of SAM and FEM",
        "heading": "Comparison of SAM and FEM",
        "lead": "Each scene is described once. The semi-analytical method (SAM) and finite elements (FEM) "
        "solve it without sharing any physics code, and are held against each other. Where there are data of "
        "the user, SAM is held against them too: then these are what is expected.",
        "case": "Scene",
        "gate": "Row",
    },
}
"""What a page is called and is about, by its kind."""


def render(results: Mapping, folder: Path) -> str:
    """The page as text. results: as verify writes them; folder: where the figures are."""
    environment = Environment(
        loader=PackageLoader("verification.suite"), autoescape=True, undefined=StrictUndefined
    )
    environment.filters |= {"number": number, "amount": _amount, "limit": _limit, "metric": _metric}
    environment.trim_blocks = environment.lstrip_blocks = True
    css, _, _ = environment.loader.get_source(environment, "report.css")
    page = environment.get_template("report.html.j2").render(
        css=css,
        words=WORDS[results.get("kind", "verification")],
        verdict=_verdict(results),
        cases=[_case(case, results["gates"], folder) for case in results["cases"]],
        heading=_heading(results),
        provenance=_provenance(results),
        inputs=results["provenance"]["input_sha256"],
        origin=origin(results.get("solves")),
    )
    return _CONTROL.sub("?", page)


def _amount(gate: Mapping, value: float | None) -> str:
    """A computed or expected value with its unit; fields have no single value."""
    if value is None:
        return "\N{EN DASH}"
    return f"{number(value, 7)} {gate['unit']}".rstrip()


def _limit(gate: Mapping) -> str:
    return f"{_SIGNS[LIMITS.get(gate['metric'], '<=')]} {number(gate['tolerance'])}"


def _metric(name: str) -> str:
    return _METRICS.get(name, name)


def _verdict(results: Mapping) -> dict[str, str]:
    """The sentence at the top."""
    count = results["summary"]
    red = count[GateStatus.FAILED] + count[GateStatus.UNCHECKED]
    ran = red + count[GateStatus.PASSED]
    one = WORDS[results.get("kind", "verification")]["gate"].lower()
    text = f"{count[GateStatus.PASSED]} of {ran} {one}s passed, {red} failed"
    text += f", {count[GateStatus.NOT_RUN]} not run."
    good = not red and not any(case["failure"] for case in results["cases"])
    return {
        "text": (f"All {one}s held: " if good else "Not verified: ") + text,
        "kind": "good" if good else "bad",
    }


def _heading(results: Mapping) -> list[tuple[str, str]]:
    """What a reader asks first: which code, when, how and where."""
    source, machine = results["provenance"], results["provenance"]["machine"]
    commit = source["commit"] or "no commit"
    memory = f", {machine['memory_bytes'] / 2**30:.0f} GiB" if machine["memory_bytes"] else ""
    return [
        ("Commit", commit[:12] + (" with changes" if source["dirty"] else "")),
        ("UTC", source["time_utc"]),
        ("Command", results["command"]),
        ("Machine", f"{machine['cpu']}, {machine['cores']} cores{memory}"),
        ("System", f"{machine['os']}, Python {source['versions']['python']}"),
    ]


def _case(case: Mapping, gates: list[Mapping], folder: Path) -> dict:
    """A case with its gates, their count by status, and the gate closest to its tolerance."""
    own = [gate for gate in gates if gate["case"] == case["name"]]
    figures = [
        figure | {"data": _embedded(folder / figure["png"])}
        for figure in case["figures"]
        if figure["embedded"]
    ]
    statuses = [gate["status"] for gate in own]
    return {
        **case,
        "gates": own,
        "figures": figures,
        "linked": [figure for figure in case["figures"] if not figure["embedded"]],
        "runs": [_run(run, case.get("sources", {}).get(run), folder) for run in case["runs"]],
        "unmet": case.get("unmet", ""),
        "reused": _from(case["reused"]) if case.get("reused") else "",
        "passed": statuses.count(GateStatus.PASSED),
        "red": statuses.count(GateStatus.FAILED) + statuses.count(GateStatus.UNCHECKED),
        "waiting": statuses.count(GateStatus.NOT_RUN),
        "tightest": max(filter(None, map(_used, own)), key=lambda used: used["share"], default=None),
    }


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


def _run(run: str, source: Mapping | None, folder: Path) -> dict:
    """A run with its link, and where it is from if it was not solved for this report."""
    kept = (folder / run / "summary.json").is_file()
    return {"path": run, "kept": kept, "source": _from(source) if source and source["reused"] else ""}


def _from(source: Mapping) -> str:
    return f"{source['created'][:16].replace('T', ' ')}, {short(source['commit'])}"


def _used(gate: Mapping) -> dict | None:
    """The share of the tolerance that a gate uses, None where it has no such number."""
    if not gate["error"] or not gate["tolerance"]:
        return None
    share = gate["error"] / gate["tolerance"]
    return {"quantity": gate["quantity"], "share": 1.0 / share if gate["metric"] == "at_least" else share}


def _embedded(png: Path) -> str | None:
    """The picture as a data address, None when the file is not there."""
    if not png.is_file():
        return None
    return "data:image/png;base64," + base64.b64encode(png.read_bytes()).decode("ascii")


def _provenance(results: Mapping) -> list[tuple[str, str]]:
    """Name and text of each row; the hashes of the inputs have a table of their own."""
    rest = {key: value for key, value in results["provenance"].items() if key != "input_sha256"}
    asked = {name: results[name] for name in ("command", "level") if name in results}
    return list(_flat(asked | rest))


def _flat(tree: Mapping, prefix: str = "") -> Iterator[tuple[str, str]]:
    """Nested provenance as (name, text) rows."""
    for key, value in tree.items():
        name = f"{prefix}{str(key).replace('_', ' ')}"
        if isinstance(value, Mapping):
            yield from _flat(value, f"{name}: ")
        elif isinstance(value, list | tuple):
            yield name, ", ".join(map(str, value)) or "none"
        else:
            yield name, "unknown" if value is None else str(value)
