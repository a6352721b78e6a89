# SPDX-License-Identifier: MIT
"""What changed between two reports is listed by gate, and nothing else is."""

import json

import pytest

from samfem.cli import main
from verification.suite.changes import EQUAL, changes


def gate(name: str, value: float | None, error: float | None = 0.5, unit: str = "Pa") -> dict:
    return {"id": name, "value": value, "error": error, "unit": unit, "tolerance": 0.01}


def report(*gates: dict) -> dict:
    return {"format": "samfem-verification", "complete": True, "gates": list(gates)}


@pytest.mark.parametrize(
    ("before", "after", "differs"),
    [
        (gate("a", 1e9), gate("a", 1e9), False),
        (gate("a", 1e9), gate("a", 1e9 * (1 + 0.5 * EQUAL)), False),
        (gate("a", 1e9), gate("a", 1e9 * (1 + 3 * EQUAL)), True),
        (gate("a", 1e-15, unit=""), gate("a", 3e-15, unit=""), False),
        (gate("a", 1e-15), gate("a", 3e-15), True),
        (gate("a", 1e-3, unit=""), gate("a", 1e-3 + 2 * EQUAL, unit=""), True),
        (gate("a", None, 0.5), gate("a", None, 0.5), False),
        (gate("a", None, 0.5, ""), gate("a", None, 0.5001, ""), True),
        (gate("a", None, None), gate("a", None, None), False),
        (gate("a", None, None), gate("a", 1.0), True),
    ],
    ids=str,
)
def test_a_gate_differs_by_its_value_or_its_error(before, after, differs):
    assert bool(changes(report(before), report(after))) is differs


def test_gates_that_came_and_went_are_changes():
    found = changes(report(gate("old", 1.0), gate("same", 2.0)), report(gate("same", 2.0), gate("new", 3.0)))
    assert [(each.gate, each.before, each.after) for each in found] == [
        ("new", None, 3.0),
        ("old", 1.0, None),
    ]


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
    assert main(["report", one, "--against", str(tmp_path)]) == 2
    assert "no finished verification report" in capsys.readouterr().err
