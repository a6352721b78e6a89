# SPDX-License-Identifier: MIT
"""samfem pages --stale names the cases of a report that are older than the code, and why."""

import json
from dataclasses import replace
from pathlib import Path

import pytest

from verification.cases import all_cases
from verification.cases.case import Context, Outcome
from verification.runs.code_version import version_of_cases
from verification.runs.files import json_text
from verification.runs.store import Reuse
from verification.suite import freshness, outcomes
from verification.suite.verify import RanCase, begin, finish

CASE, SCENE = "hertz-sphere", "hertz-sphere.toml"
OTHERS = len([case for case in all_cases().values() if case.published_at("full") and not case.needs()]) - 1


@pytest.fixture
def report(folder, capsys):
    """A report of one case without values, as published: the current folder."""
    context = Context(CASE, folder, "full", lambda *_: None, inputs={SCENE: outcomes.present(SCENE)})
    ran = {CASE: RanCase(context, Outcome(), "", 1.0, Reuse(False))}
    begin(folder)
    finish(ran, all_cases(), level="full", out=folder, command="", unmet={})
    return json.loads((folder / "results.json").read_text(encoding="utf-8"))


def said_of(samfem, results) -> str:
    """What is said of the case; the others are not published."""
    with open("results.json", "w", encoding="utf-8") as file:
        file.write(json_text(results))
    lines = samfem("pages", ".", "--stale", code=1).out.splitlines()
    assert sum(line.endswith(": not published") for line in lines) == OTHERS
    return next((line for line in lines if line.startswith(f"{CASE}: ")), lines[-1])


def record(results) -> dict:
    return next(case for case in results["cases"] if case["name"] == CASE)


def test_what_is_as_the_code_is_not_named(report, samfem, refused):
    assert record(report)["code"] == version_of_cases()
    assert said_of(samfem, report) == f"{OTHERS} stale, 1 as the code in front of you"
    assert "no finished verification report" in refused("pages", "none", "--stale")


def test_what_was_published_is_named_where_it_cannot_run(report, monkeypatch):
    missing = {name: replace(case, needs=lambda: "not here") for name, case in all_cases().items()}
    monkeypatch.setattr(freshness, "all_cases", lambda: missing)
    assert freshness.stale(report) == {}
    record(report)["code"] = "f" * 64
    assert freshness.stale(report) == {CASE: "the code that it depends on has changed"}


def test_other_code_another_scene_other_gates_and_a_case_that_broke_off_are_named(report, samfem):
    for key, value, why in (
        ("code", "f" * 64, "the code that it depends on has changed"),
        ("file", "f" * 64, "its case file has changed"),
        ("inputs", {SCENE: "f" * 64}, f"{SCENE} changed"),
        ("failure", "RuntimeError: no", "it broke off"),
    ):
        changed = json.loads(json.dumps(report))
        record(changed)[key] = value
        assert said_of(samfem, changed) == f"{CASE}: {why}"
    next(gate for gate in report["gates"] if gate["case"] == CASE)["tolerance"] *= 2.0
    assert said_of(samfem, report) == f"{CASE}: its gates have changed"


def test_a_case_file_counts_but_for_limits():
    file = all_cases()[CASE].file
    first, *others = file.claims
    wider = first._replace(row=first.row.model_copy(update={"tolerance": 1.0}))
    changed = ({}, {"claims": (wider, *others)}, {"claims": (*others,)}, {"vary": {"resolution": [9, 9]}})
    own, limit, row, resolution = (
        outcomes.file_digest(replace(all_cases()[CASE], file=file.model_copy(update=each)))
        for each in changed
    )
    assert own == limit and len({own, row, resolution}) == 3


def test_a_report_of_all_that_is_asked_is_not_stale(report, samfem, monkeypatch):
    monkeypatch.setattr(freshness, "all_cases", lambda: {CASE: all_cases()[CASE]})
    assert samfem("pages", ".", "--stale").out == "0 stale, 1 as the code in front of you\n"
    samfem("pages", ".")
    assert "older than the code" not in Path("index.html").read_text(encoding="utf-8")
    monkeypatch.setattr(freshness, "all_cases", dict)
    assert "hertz-sphere: there is no such case any more" in samfem("pages", ".", "--stale", code=1).out
    samfem("pages", ".")
    for name in ("index.html", "README.md"):
        assert "older than the code" in (text := Path(name).read_text(encoding="utf-8")) and CASE in text
