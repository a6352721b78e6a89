# SPDX-License-Identifier: MIT
"""The study of running-in over physics, on made results: no run of it is solved."""

from dataclasses import replace

import pytest
from made_results import context, red
from made_studies import GOOD, over_physics, ran

from sam.scene import resolved
from verification.cases.running_in import running_in_physics as study
from verification.cases.running_in.running_in_physics import ALL
from verification.cases.running_in.running_in_statements import BULK, NAMES, STATEMENTS, B
from verification.figures.check import findings

CASE = study.CASES[0]


@pytest.fixture
def found() -> study.Found:
    return over_physics()


def test_every_physics_is_another_scene(tmp_path):
    scenes = study.scenes_of(context(CASE.name, tmp_path))
    every = [repr(resolved(each)) for each in scenes.values()]
    assert len(set(every)) == len(every) == len(ALL) * len(NAMES) == 120
    assert {scene.surface.seed for scene in scenes.values()} == {2}


def test_the_physics_under_which_most_holds_is_named(found):
    assert found.held(GOOD) == max(found.held(each) for each in ALL) == len(STATEMENTS)
    first, *_, still, _ = CASE.notes(found)
    assert str(len(STATEMENTS)) in first and study.words(GOOD) in first and first.count(";") == 0
    assert f"in {len(NAMES) - 1} of {len(found.runs)} runs" in still  # bulk has come to rest
    table, wear = CASE.tables(found)
    column = 2 + study.COLUMNS.index((GOOD.counter, GOOD.sign))
    assert all("K" in row[column] for row in table.rows[:-1])
    assert table.rows[-1][column].endswith(f" {len(STATEMENTS)}")
    assert all(len(row) == len(each.columns) for each in (table, wear) for row in each.rows)
    for plot in CASE.figures(found):
        assert list(findings(plot.drawing.figure)) == []


def test_a_lost_run_says_nothing_and_turns_the_gate_red(found):
    assert red(CASE.name, CASE.measure(found), whole=True) == set()
    for physics in ALL[:7]:
        found.runs[physics, BULK].result.converged = False
    found = replace(found)
    assert red(CASE.name, CASE.measure(found)) == {"lost"}
    table, wear = CASE.tables(found)
    assert "(IHK)" in table.rows[0][2] and wear.rows[0][2] == "not converged"
    del found.runs[GOOD, B]
    assert "missing" in red(CASE.name, CASE.measure(replace(found)))


def test_a_first_cycle_of_its_own_turns_the_gate_red(found):
    own = found.runs[GOOD, B].history
    found.runs[GOOD, B] = ran(replace(own, volume=own.volume * (1.0 + 1e-9)))
    assert red(CASE.name, CASE.measure(found)) == {"first-cycle"}
