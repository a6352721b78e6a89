# SPDX-License-Identifier: MIT
"""Which cases of a published report are older than the code in front of the reader, and why.

results.json says of each case by which code it was made (`code`, a digest of the files that it depends on)
and of which scenes (`inputs`, their SHA-256). Documentation and what only words a page do not count.
"""

from __future__ import annotations

import hashlib
from collections.abc import Mapping

from verification.cases import all_cases
from verification.judging import RowStatus
from verification.rows import load_rows
from verification.runs.code_version import version_of_cases
from verification.suite.outcomes import present

JUDGED_BY = ("metric", "tolerance", "quantity", "reason")


def stale(results: Mapping) -> dict[str, str]:
    """Name of each case that has to be published again -> why. results: as verify and publish write them.

    Those that are not published count too, unless something that they need is missing here.
    """
    known, ran = all_cases(), ran_in(results)
    gone = {name: "there is no such case any more" for name in ran if name not in known}
    asked = [case for case in known.values() if case.name in ran or case.published_at(results["level"])]
    found = {case.name: _why(case.name, results) for case in asked if case.name in ran or not case.needs()}
    return gone | {name: why for name, why in found.items() if why}


def older(results: Mapping) -> dict[str, str]:
    """Of these only the cases that came to their end: what the pages show of them is not of this code.

    A comparison has none.
    """
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
    changed = [scene for scene, digest in case["inputs"].items() if digest != _digest(scene)]
    return f"{', '.join(changed)} changed" if changed else ""


def _digest(scene: str) -> str:
    return hashlib.sha256(present(scene) or b"").hexdigest()


def _judged(name: str, results: Mapping) -> bool:
    """Whether the gates of a case are those of the table."""
    kept = {g["id"]: tuple(g[key] for key in JUDGED_BY) for g in results["gates"] if g["case"] == name}
    return kept == {g.id: tuple(getattr(g, key) for key in JUDGED_BY) for g in load_rows() if g.case == name}
