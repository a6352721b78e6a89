# SPDX-License-Identifier: MIT
"""The running-in case as a whole, both readings, on made results: no run of it is solved."""

from dataclasses import replace

import numpy as np
import pytest
from made_histories import CYCLES, as_the_paper_says
from made_results import Made, context
from test_running_in_cases import made

from sam.scene import Status
from verification.cases.running_in import running_in
from verification.cases.running_in.running_in_scenes import Effort, Reading
from verification.cases.running_in.running_in_statements import BULK, DUCTILE, NAMES, A, B
from verification.cases.running_in.running_in_tables import at_rest_from, lost_height_note
from verification.compare.running_in_measures import Scar
from verification.figures.running_in_readings import side_by_side

CASE = running_in.CASES[0]
TEN = tuple(range(1, 11))


def answer(case: str, **changes) -> Made:
    """The result of a run that went as the paper says, and at last strains no more."""
    history, result = as_the_paper_says()[case], made().result
    volume = history.volume
    cycles = {
        "cycle": history.cycle,
        "wear_volume_m3": volume,
        "friction_coefficient": history.friction,
        "sa_m": history.sa,
        "protected_fraction": history.protected,
        "p_max_Pa": history.p_max,
        "new_strain_max": np.linspace(0.02, 0.0, CYCLES.size),
        "yielding_cells": CYCLES[::-1] - 1,
        "wear_of_cycle_m3": np.diff(volume, prepend=0.0),
    }
    steps = {"cycle": CYCLES, "iterations": CYCLES[::-1]}
    return replace(result, tables={**result.tables, "cycles": cycles, "history": steps}, **changes)


@pytest.fixture
def solved(tmp_path, monkeypatch):
    """The case at the full level without what is varied. lost: labels of runs that do not converge; shallow:
    of those whose plastic zone reaches the last layer.
    """

    def solve(lost=(), shallow=()):
        here, scenes = context("running-in", tmp_path, "full"), {}

        def one(model, scene, label, demand):
            assert not demand
            scenes[label] = scene
            case = max((name for name in NAMES if f"{name}-seed" in label), key=len)
            stopped = Status.STEP_CUT_LIMIT if label in lost else Status.PLASTIC_ZONE_AT_GRID_EDGE
            return answer(
                case, **({"converged": False, "status": stopped} if label in (*lost, *shallow) else {})
            )

        monkeypatch.setattr(here, "solve", one)
        efforts = dict.fromkeys(Reading, Effort(tuple(NAMES), TEN, cycles=25, steps=10, cells=64))
        monkeypatch.setitem(running_in.EFFORTS, "full", efforts)
        return CASE.solve(here), scenes

    return solve


def test_a_hundred_scenes_are_solved_each_under_a_name_of_its_own(solved):
    found, scenes = solved()
    assert len(scenes) == 100 and len({repr(scene) for scene in scenes.values()}) == 100
    assert scenes["curve-b-seed-3"].surface == scenes["renewed-curve-b-seed-3"].surface
    assert scenes["curve-b-seed-3"].surface.seed == 3
    assert scenes["renewed-curve-b-seed-3"].counterbody.surface.seed == 3001
    assert [runs.reading for runs in found.runs] == list(Reading) and len(found.all) == 100


def test_both_readings_stand_side_by_side(solved):
    found, _ = solved()
    statements, *others = CASE.tables(found)
    assert len(statements.rows) == 17 and {row[6] for row in statements.rows} == {
        row[10] for row in statements.rows
    }
    assert all(row[5] == row[9] == "10 of 10" for row in statements.rows)
    for table in (statements, *others):
        assert {len(row) for row in table.rows} == {len(table.columns)}, table.caption
    new_strain = next(table for table in others if table.caption.startswith("What the last cycle adds"))
    assert all(row[1:3] == row[6:8] == ["0 of 10", "25 (25 to 25)"] for row in new_strain.rows)
    words = [value for _, value in CASE.setup(found)]
    assert "13 layers" in " ".join(words) and "15 layers, to 19.4 µm" in words
    assert len([note for note in CASE.notes(found) if "17 held, 0 failed" in note]) == 2


def test_where_the_plastic_zone_reaches_the_last_layer_there_are_more(solved):
    shallow = {"bulk-seed-7", "renewed-bulk-seed-7", "renewed-bulk-seed-7-deeper"}
    found, scenes = solved(shallow=shallow)
    printed, renewed = (runs.found["bulk", 7] for runs in found.runs)
    assert printed.scene == scenes["bulk-seed-7-deeper"] and printed.scene.grid.depths[-1] == 19.4e-6
    assert printed.scene.grid.depths[:-2] == scenes["bulk-seed-7"].grid.depths
    assert renewed.scene.grid.depths[-1] == 36.2e-6 and len(scenes) == 102
    assert [len(found.deepened), list(found.lost)] == [2, ["bulk, surface 7, renewed"]]
    assert any("bulk, surface 7, printed inputs, to 19.4 µm" in note for note in CASE.notes(found))


def test_the_deepest_scar_is_set_against_the_relief():
    flat = np.zeros((2, 2))
    height = np.array([[1e-6, 0.0], [-1.5e-6, 0.5e-6]])
    scars = {
        name: Scar(np.arange(2.0), np.arange(2.0), height, flat, depth * np.eye(2), flat)
        for name, depth in (("shallow", 1e-6), ("half", 1.5e-6), ("deep", 2.75e-6))
    }
    text = lost_height_note(scars)
    assert "a half in 2 of 3 runs, above one in 1; the most is 1.10, 2.75 of 2.5 µm (deep)" in text


@pytest.mark.parametrize(
    ("strains", "cycle"), [([3.0, 2.0, 0.0], 3.0), ([0.0, 0.0], 1.0), ([1.0, 0.0, 1.0, 0.0], 4.0)]
)
def test_a_body_is_at_rest_from_its_last_new_strain_on(strains, cycle):
    assert at_rest_from(np.array(strains)) == cycle and np.isnan(at_rest_from(np.array([*strains, 1.0])))


def test_runs_that_are_lost_are_named_counted_and_left_out(solved):
    lost = {"renewed-curve-a-seed-4", *(f"renewed-bulk-seed-{seed}" for seed in TEN)}
    found, _ = solved(lost)
    assert CASE.measure(found)["unconverged"].value == 11
    text = next(note for note in CASE.notes(found) if note.startswith("Not converged"))
    assert text.count("step-cut-limit") == 11 and "curve A, surface 4, renewed" in text
    statements, *others = CASE.tables(found)
    rows = {row[1]: row for row in statements.rows}
    assert rows["curve A: friction falls"][5::4] == ["10 of 10", "9 of 10, none on 1"]
    assert rows["bulk: worn in the first six cycles"][9:] == ["0 of 10, none on 10", *["not decided"] * 2]
    cost = {row[0]: row[1] for row in others[-1].rows}
    assert (cost["bulk, printed inputs"], cost["bulk, renewed"], cost["curve A, renewed"]) == (
        "10 of 10",
        "0 of 10",
        "9 of 10",
    )


def test_the_readings_are_drawn_in_one_panel_for_each_case():
    """Curve A worn in two readings, curve B lost in the second."""
    paper = as_the_paper_says()
    worn = [replace(paper[A], volume=k * paper[A].volume) for k in (1, 2, 4)]
    cases = {"curve A": {"one": worn, "other": [paper[A]]}, "curve B": {"one": [paper[B]], "other": []}}
    drawing = side_by_side(cases)
    data = {
        name: np.array(drawing.data[name]) for name in ("quantity", "case", "reading", "surface", "value")
    }
    rows = (data["quantity"] == "volume") & (data["case"] == "curve A") & (data["surface"] == "median")
    assert data["value"][rows & (data["reading"] == "one")] == pytest.approx(2e18 * paper[A].volume)
    assert data["value"].size == 2 * CYCLES.size * (4 + 2 + 2)
    lines = [len(axes.lines) for axes in drawing.figure.axes]
    assert lines == [6, 2, 6, 2]
    assert [text.get_text() for text in drawing.figure.legends[0].get_texts()] == ["one", "other"]


def test_every_case_is_drawn_in_both_readings(solved, monkeypatch):
    """Without bulk in the second, which is lost. What a drawing holds is tested with the figures."""
    for drawing in ("side_by_side", "comparison", "regime_map", "six_panels", "surface", "yield_profiles"):
        monkeypatch.setattr(running_in, drawing, lambda *_: None)
    found, _ = solved({f"renewed-{BULK}-seed-{seed}" for seed in TEN} | {f"renewed-{DUCTILE}-seed-2"})
    names = [plot.name for plot in CASE.figures(found)]
    printed = ["comparison", "yield", "regimes", *NAMES]
    renewed = [f"renewed-{name}" for name in printed if name != BULK]
    assert names == ["readings", "surface", *printed, *renewed]
    views = {view.name: view.run for view in CASE.views(found)}
    assert views[f"{A}-worn"] == f"{A}-seed-2" and views[f"renewed-{B}-worn"] == f"renewed-{B}-seed-2"
    assert views[f"renewed-{DUCTILE}-worn"] == f"renewed-{DUCTILE}-seed-1"
