# SPDX-License-Identifier: MIT
"""What changed between two reports is listed by gate, and nothing else is."""

import json

import pytest

from samfem.cli import main
from verification.suite.changes import EQUAL, changes, grown, lost


def gate(name: str, value: float | None, error: float | None = 0.5, unit: str = "Pa", **said) -> dict:
    made = {"metric": "relative", "tolerance": 0.01, "points": 9}
    return {"id": name, "value": value, "error": error, "unit": unit, **made, **said}


def report(*gates: dict) -> dict:
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
    assert bool(changes(report(before), report(after))) is differs
    came = changes(report(before), report(before, gate("new", 3.0)))
    went = changes(report(before, gate("old", 1.0)), report(before))
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
    found = lost(report(gate("a", 1.0)), report(gate("b", 1.0, **said)), rows)
    assert len(found) == (lost_as is not None) and (lost_as or "") in "".join(found)


def test_a_lower_bound_is_wider_where_it_is_lower():
    one, other = (report(gate("a", 1.0, metric="at_least", tolerance=t)) for t in (0.5, 0.4))
    assert lost(one, other, {"a": "a"}) and not lost(other, one, {"a": "a"})


def test_an_error_that_grew_to_more_than_twice_is_named_but_not_rounding():
    old = report(gate("a", 1.0, 1e-3), gate("b", 1.0, 1e-3), gate("c", 1.0, 1e-15), gate("d", 1.0, None))
    new = report(gate("a", 1.0, 1.9e-3), gate("b", 1.0, 2.1e-3), gate("c", 1.0, 9e-12), gate("d", 1.0, 1.0))
    assert grown(old, new) == ["b: error 0.0021, was 0.001"]


def test_the_command_lists_them_and_says_so_by_its_exit_code(tmp_path, capsys):
    for name, value in (("one", 1.0), ("two", 1.0), ("other", 1.5)):
        (tmp_path / name).mkdir()
        text = json.dumps(report(gate("case.gate", value)))
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
