# SPDX-License-Identifier: MIT
"""Older reports: what changed between two is listed by gate, and nothing else is; samfem pages --stale names
the cases that are older than the code, and why.
"""

import json
from dataclasses import replace
from pathlib import Path

import pytest

from samfem.cli import main
from verification.cases import all_cases
from verification.cases.case import Context, Outcome
from verification.runs.code_version import version_of_cases
from verification.runs.files import json_text
from verification.runs.store import Reuse
from verification.suite import freshness, outcomes
from verification.suite.changes import EQUAL, changes, grown, lost
from verification.suite.verify import RanCase, begin, finish


def gate(name: str, value: float | None, error: float | None = 0.5, unit: str = "Pa", **said) -> dict:
    made = {"metric": "relative", "tolerance": 0.01, "points": 9}
    return {"id": name, "value": value, "error": error, "unit": unit, **made, **said}


def of_gates(*gates: dict) -> dict:
    return {"format": "samfem-verification", "complete": True, "gates": list(gates)}


@pytest.mark.parametrize(
    ("before", "after", "differs"),
    [
        (gate("a", 1e9), gate("a", 1e9 * (1 + 0.5 * EQUAL)), False),
        (gate("a", 1e9), gate("a", 1e9 * (1 + 3 * EQUAL)), True),
        (gate("a", 1e-15, unit=""), gate("a", 3e-15, unit=""), False),
        (gate("a", 1e-15), gate("a", 3e-15), True),
        (gate("a", 1e-3, unit=""), gate("a", 1e-3 + 2 * EQUAL, unit=""), True),
        (gate("a", None, 0.5, ""), gate("a", None, 0.5001, ""), True),
        (gate("a", None, None), gate("a", 1.0), True),
    ],
    ids=str,
)
def test_a_gate_differs_by_its_value_or_its_error(before, after, differs):
    assert bool(changes(of_gates(before), of_gates(after))) is differs
    came = changes(of_gates(before), of_gates(before, gate("new", 3.0)))
    went = changes(of_gates(before, gate("old", 1.0)), of_gates(before))
    found = [(one.gate, one.before, one.after) for one in came + went]
    assert found == [("new", None, 3.0), ("old", 1.0, None)]


@pytest.mark.parametrize(
    ("rows", "said", "lost_as"),
    [
        ({"a": "b"}, {}, None),
        ({}, {}, "no entry"),
        ({"a": "c"}, {}, "there is no gate c"),
        ({"a": ""}, {}, "there is no gate for it"),
        ({"a": "tests/test_x.py::test_y"}, {}, None),
        ({"a": "the gate b says it already"}, {}, None),
        ({"a": "b"}, {"metric": "absolute"}, "metric absolute, was relative"),
        ({"a": "b"}, {"tolerance": 0.02}, "tolerance 0.02, was 0.01"),
        ({"a": "b"}, {"points": 8}, "8 points, were 9"),
        ({"a": "b"}, {"tolerance": 0.005, "points": 10}, None),
    ],
)
def test_a_gate_that_is_claimed_no_more_is_lost(rows, said, lost_as):
    found = lost(of_gates(gate("a", 1.0)), of_gates(gate("b", 1.0, **said)), rows)
    assert len(found) == (lost_as is not None) and (lost_as or "") in "".join(found)


def test_a_lower_bound_is_wider_where_it_is_lower():
    one, other = (of_gates(gate("a", 1.0, metric="at_least", tolerance=t)) for t in (0.5, 0.4))
    assert lost(one, other, {"a": "a"}) and not lost(other, one, {"a": "a"})


def test_an_error_that_grew_to_more_than_twice_is_named_but_not_rounding():
    old = of_gates(gate("a", 1.0, 1e-3), gate("b", 1.0, 1e-3), gate("c", 1.0, 1e-15), gate("d", 1.0, None))
    new = of_gates(gate("a", 1.0, 1.9e-3), gate("b", 1.0, 2.1e-3), gate("c", 1.0, 9e-12), gate("d", 1.0, 1.0))
    assert grown(old, new) == ["b: error 0.0021, was 0.001"]


def test_the_command_lists_them_and_says_so_by_its_exit_code(tmp_path, capsys):
    for name, value in (("one", 1.0), ("two", 1.0), ("other", 1.5)):
        (tmp_path / name).mkdir()
        text = json.dumps(of_gates(gate("case.gate", value)))
        (tmp_path / name / "results.json").write_text(text, encoding="utf-8")
    one, two, other = (str(tmp_path / name) for name in ("one", "two", "other"))
    assert main(["report", two, "--against", one]) == 0
    assert "0 gates changed" in capsys.readouterr().out
    assert main(["report", other, "--against", one]) == 1
    out = capsys.readouterr().out
    assert "case.gate" in out and "1 gates changed" in out
    table = tmp_path / "rows.csv"
    for entry, code in (("case.gate", 0), ("", 1)):
        table.write_text(f"gate,row\ncase.gate,{entry}\n", encoding="utf-8")
        assert main(["report", other, "--against", one, "--map", str(table)]) == code
        assert f"{code} gates lost" in capsys.readouterr().out
    assert main(["report", other, "--against", one, "--map", str(tmp_path / "none")]) == 2
    assert "no table of gates and rows" in capsys.readouterr().err
    assert main(["report", one, "--against", str(tmp_path)]) == 2
    assert "no finished verification report" in capsys.readouterr().err


# against the code


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
