# SPDX-License-Identifier: MIT
"""The comparison as Python and the command share it: rows, verdict on one line, tolerances that are given."""

import re
from dataclasses import replace

import pytest
from builders import parsed
from stored import COARSE

from sam.scene import Scene, SceneError, Status, resolved
from samfem.compared import asked
from verification.compare.comparison import compare_scene, names_of_rows
from verification.compare.rows import COLUMNS


def judged(tolerances=None, base: Scene = COARSE, *, wide: float | None = 1.0, **how):
    """The comparison of a scene, with every tolerance `wide` but those given."""
    every = dict.fromkeys(names_of_rows(base), wide) if wide else {}
    return asked(base, tolerances=every | (tolerances or {}), **how).answer()


def test_the_frame_and_the_line_say_what_the_rows_say(counted):
    found = judged({"p_max_Pa": 0.5})
    assert tuple(found.frame.columns) == COLUMNS and len(found.frame) == len(found.rows)
    assert found.passed and not found.failed
    used = {row.quantity: row.error / row.row.tolerance for row in found.rows}
    closest = max(used, key=used.get)
    line = f"{len(used)} of {len(used)} agree, closest {closest} at {100 * used[closest]:.0f} % of its "
    line += "tolerance; "
    assert re.fullmatch(re.escape(line) + r"SAM [0-9.]+ s, FEM [0-9.]+ s", found.line)
    found = judged({"p_max_Pa": "1e-9 %", "approach_m": 1e-11})
    assert {row.quantity for row in found.failed} == {"p_max_Pa", "approach_m"} and not found.passed


def test_a_model_that_did_not_converge_is_named_and_nothing_passes(counted):
    found = judged()
    fem = replace(found.fem, status=Status.STEP_CUT_LIMIT, message="raise loading.steps")
    worse = replace(found, fem=fem)
    assert not worse.passed and worse.line.startswith("fem-axisymmetric ended with step-cut-limit; ")


def test_a_tolerance_that_is_given_stands_before_that_of_the_scene_and_that_before_the_default(counted):
    of_scene = {"p_max_Pa": 0.02, "approach_m": 0.03}
    base = Scene(**{**resolved(COARSE), "compare": {"tolerances": of_scene}})
    default = {row.quantity: row for row in asked(COARSE).answer().rows}
    rows = {row.quantity: row for row in asked(base, tolerances={"p_max_Pa": "4 %"}).answer().rows}
    assert rows["p_max_Pa"].row.tolerance == 0.04 and "argument tolerance" in rows["p_max_Pa"].row.reason
    assert rows["approach_m"].row.tolerance == 0.03
    assert "[compare] tolerances" in rows["approach_m"].row.reason
    assert {rows[name] == default[name] for name in set(rows) - set(of_scene)} == {True}
    for name in of_scene:  # the difference stays, and what it would have been is said
        assert rows[name].error == default[name].error
        assert rows[name].passed == (rows[name].error <= rows[name].row.tolerance)
        row = default[name].row
        assert f"without it {row.tolerance:g}: {row.reason}" in rows[name].row.reason


def test_a_tolerance_of_the_largest_strain_is_not_one_of_its_depth(counted):
    base = Scene(**{**resolved(COARSE), "body": {**resolved(COARSE)["body"], "plasticity": None}})
    plastic = asked(base, tolerances={"mises_max_Pa": 0.5}).tolerances
    rows = compare_scene(base, *judged().results)
    changed = [row.quantity for row, new in zip(rows, plastic.judged(rows), strict=True) if row != new]
    assert changed == ["mises_max_Pa"]


def test_every_wrong_tolerance_is_named(counted):
    base = Scene(**{**resolved(COARSE), "compare": {"tolerances": {"p_max": 0.02}}})
    with pytest.raises(SceneError) as caught:
        asked(base, tolerances={"peek_max": 0.1, "approach_m": "2 mm", "p_max_Pa": 0.0})
    said = str(caught.value)
    assert "4 errors" in said and 'in percent, such as "2 %"' in said and not counted
    assert "compare.tolerances.p_max = 0.02" in said and "did you mean p_max_Pa" in said
    assert "tolerances.peek_max" in said and 'tolerances.approach_m = "2 mm"' in said


def test_a_scene_file_gives_tolerances_in_percent_or_as_numbers():
    table = '[compare.tolerances]\np_max_Pa = "2 %"\n"p_Pa over the contact" = 0.03\n'
    assert parsed(add=table).compare.tolerances == {"p_max_Pa": 0.02, "p_Pa over the contact": 0.03}
    for wrong in ('"2"', '"2 mm"', "true", "-0.1", "0", '"% 2"', '"nan %"', "[0.1]"):
        with pytest.raises(SceneError, match=r"compare.tolerances.p_max_Pa = .*: tolerance from 1e-12 to 10"):
            parsed(add=table.replace('"2 %"', wrong))
