# SPDX-License-Identifier: MIT
"""The comparison as Python and the command share it: rows, verdict on one line, tolerances that are given;
the command with several scenes, own data, a page and a JUnit file.
"""

import csv
import json
import re
from dataclasses import replace
from types import SimpleNamespace
from xml.etree import ElementTree

import numpy as np
import pandas as pd
import pytest
from builders import COARSE as COARSE_TEXT, parsed, scene_text
from stored import COARSE

from sam.scene import Scene, SceneError, Status, resolved
from samfem.compared import NOT_COMPARED, asked
from verification.compare.comparison import compare_scene, names_of_rows
from verification.compare.rows import COLUMNS
from verification.figures.compared import curves
from verification.runs.files import read_run

WIDE = '[compare.tolerances]\n"p_Pa over the contact" = "20 %"\n"mises_Pa in the plane y = 0" = 0.2\n'
OFF = '[compare]\ntolerances = { p_max_Pa = "1e-8 %" }\n'


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


# the command


@pytest.fixture
def scenes(folder, monkeypatch):
    """good.toml agrees, off.toml does not; both are solved once."""
    monkeypatch.setenv("SAMFEM_STORE", str(folder / "store"))
    (folder / "good.toml").write_text(scene_text(add=COARSE_TEXT + WIDE))
    (folder / "off.toml").write_text(scene_text(add=COARSE_TEXT + OFF))
    return folder


@pytest.fixture
def own(scenes, samfem):
    """line.csv: the pressure of SAM times 1.05, with the columns of a run."""
    samfem("solve", "good.toml")
    line = read_run(scenes / "good-sam").tables["line"].query("state == 'peak'")
    line[["x_m", "p_Pa"]].assign(p_Pa=1.05 * line["p_Pa"]).to_csv("own.csv", index=False)
    return "own.csv"


def rows_of(path) -> dict[str, dict[str, str]]:
    with open(path, encoding="utf-8", newline="") as stream:
        return {row["quantity"]: row for row in csv.DictReader(stream)}


def test_compare_on_coarse_meshes_fails_and_says_what_to_change(sphere_folder, samfem):
    coarser = scene_text(add="[grid]\ncells = [17, 17]\n[fem]\ncells_per_radius = 5\n")
    (sphere_folder / "coarse.toml").write_text(coarser)
    shown = samfem("compare", "coarse.toml", "--out", "out", code=1)
    assert "FAILED" in shown.out and "outside the tolerance" in shown.err
    assert "raise grid.cells = [17, 17], or raise fem.cells_per_radius = 5" in shown.err
    samfem("compare", "sphere.toml", "--out", "out")  # an older comparison is replaced
    assert {row["passed"] for row in rows_of(sphere_folder / "out" / "compare.csv").values()} == {"True"}


def test_compare_does_not_write_over_a_single_run(sphere_folder, samfem):
    samfem("solve", "coarse.toml", "--out", "out")
    assert "single run" in samfem("compare", "coarse.toml", "--out", "out", code=2).err


def test_several_scenes_have_a_line_and_a_folder_each_and_one_verdict(scenes, samfem):
    said = samfem("compare", "good.toml", "off.toml", code=1)
    lines = said.out.splitlines()
    assert lines[1].startswith("good ") and lines[1].endswith("passed")
    assert lines[2].startswith("off ") and lines[2].endswith("FAILED") and len(lines) == 4
    assert lines[-1].startswith("1 of 2 scenes agree, not off; SAM ")
    for name in ("good", "off"):
        for file in ("compare.csv", "compare.json", "sam/summary.json", "fem/summary.json"):
            assert (scenes / f"{name}-compare" / file).is_file()
    samfem("compare", "good.toml", "good.toml", code=2)
    given = ("p_max_Pa=2%", "p_Pa over the contact=0.2", "mises_Pa in the plane y = 0=0.2")
    words = [word for each in given for word in ("--tolerance", each)]
    said = samfem("compare", "good.toml", "off.toml", "--out", "all", *words)
    assert said.out.splitlines()[-1].startswith("2 of 2 scenes agree; SAM ")
    assert (scenes / "all" / "good" / "compare.csv").is_file()


def test_the_table_says_who_gave_a_tolerance_and_the_companion_what_it_took(scenes, samfem):
    said = samfem("compare", "off.toml", "--tolerance", "p_max_Pa=50 %", code=1)
    row = rows_of(scenes / "off-compare" / "compare.csv")["p_max_Pa"]
    assert float(row["tolerance"]) == 0.5 and "option" in row["reason"]
    companion = json.loads((scenes / "off-compare" / "compare.json").read_text())
    assert companion["line"] == said.out.splitlines()[-1] and not companion["passed"]
    for part in ("sam", "fem"):
        run = read_run(scenes / "off-compare" / part)
        assert companion["cost"][run.model]["seconds"] == run.cost["setup_s"] + run.cost["solve_s"]
        assert companion["cost"][run.model]["peak_memory_bytes"] == run.cost["peak_memory_bytes"]


def test_data_have_columns_of_their_own_and_decide_the_exit_code(scenes, own, samfem):
    samfem("compare", "good.toml")
    said = samfem("compare", "good.toml", "--with", own, code=1)
    rows = rows_of(scenes / "good-compare" / "compare.csv")
    columns = [f"own{end}" for end in ("", "_difference", "_tolerance", "_passed")]
    assert tuple(next(iter(rows.values()))) == (*COLUMNS, *columns)
    failed = {name for name, row in rows.items() if row["own_passed"] == "False"}
    assert failed == {"p_max_Pa", "p_center_Pa"}  # the scene gives 20 % for the field
    assert float(rows["p_max_Pa"]["own_difference"]) == pytest.approx(0.05 / 1.05, rel=1e-6)
    assert [rows["approach_m"][name] for name in columns] == ["", "", "", NOT_COMPARED]
    assert "own is outside the tolerance: p_max_Pa, p_center_Pa\n" in said.err
    assert "own: 2 of 4 agree" in said.out and f"{len(rows) - 4} not compared" in said.out
    runs = {model: read_run(scenes / "good-compare" / model.lower()) for model in ("SAM", "FEM")}
    line = pd.DataFrame({"state": ["peak"] * 3, "x_m": 1e-6 * np.arange(-1.0, 2.0), "p_Pa": np.full(3, 5e9)})
    data = runs | {"own": SimpleNamespace(quantities={}, tables={"line": line})}
    pressure, displacement, _ = curves(data, "line").figure.axes  # what data lack is not drawn
    assert [curve.get_label() for curve in pressure.lines] == ["SAM", "FEM", "own"]
    assert pressure.lines[2].get_ydata().tolist() == [5.0] * 3 and len(displacement.lines) == 2
    wide = [word for name in ("p_max_Pa", "p_center_Pa") for word in ("--tolerance", f"{name}=6 %")]
    samfem("compare", "good.toml", "--with", own, *wide)


def test_a_junit_file_has_a_test_for_each_row_of_each_scene(scenes, own, samfem):
    samfem("compare", "good.toml", "off.toml", "--junit", "rows.xml", code=1)
    suites = {suite.get("name"): suite for suite in ElementTree.parse("rows.xml").getroot()}
    assert list(suites) == ["good", "off"]
    for name, suite in suites.items():
        rows = rows_of(scenes / f"{name}-compare" / "compare.csv")
        assert [test.get("name") for test in suite] == list(rows)
        failed = {test.get("name") for test in suite if test.find("failure") is not None}
        assert failed == {quantity for quantity, row in rows.items() if row["passed"] == "False"}
        assert int(suite.get("failures")) == len(failed) and ("p_max_Pa" in failed) == (name == "off")
    samfem("compare", "good.toml", "--with", own, "--junit", "rows.xml", code=1)
    tests = {test.get("name"): test for test in ElementTree.parse("rows.xml").getroot()[0]}
    assert tests["own: p_max_Pa"].find("failure") is not None and tests["p_max_Pa"].find("failure") is None


def test_a_page_has_each_scene_with_figures_rows_and_cost(scenes, own, samfem):
    assert "page/report.html" in samfem("compare", "good.toml", "off.toml", "--report", "page", code=1).out
    page = (scenes / "page" / "report.html").read_text(encoding="utf-8")
    assert page.count("data:image/png;base64,") == 6 and "Comparison of SAM and FEM" in page
    assert "1 of 2 scenes failed" in page and "of its tolerance; SAM" in page and "Wall time" in page
    assert {path.name for path in (scenes / "page").iterdir()} == {
        "figures", "gates.csv", "junit.xml", "report.html", "results.json"
    }  # fmt: skip
    samfem("compare", "good.toml", "--with", own, "--report", "page", code=1)  # in place of the older one
    page = (scenes / "page" / "report.html").read_text(encoding="utf-8")
    assert "own: p_max_Pa" in page and not list((scenes / "page" / "figures").glob("off-*"))
    (scenes / "page" / "report.html").unlink()
    samfem("report", "page")
    assert (scenes / "page" / "report.html").read_text(encoding="utf-8") == page


REFUSED = {
    "tolerance without a value": (["--tolerance", "p_max_Pa"], "is not NAME=VALUE"),
    "tolerance of an unknown row": (["--tolerance", "p_max=2%"], "'p_max' (did you mean p_max_Pa?)"),
    "missing data": (["--with", "none.csv"], "none.csv: cannot be read"),
    "data of several scenes": (["good.toml", "--with", "none.csv"], "--with = none.csv: for one scene only"),
    "page in another folder": (["--report", "."], "no finished verification report here"),
    "page in a file": (["--report", "off.toml"], "--report off.toml is no folder that can be"),
    "JUnit in no folder": (["--junit", "none/rows.xml"], "a file in a folder that can be written to"),
    "missing scene": (["none.toml"], "none.toml: cannot be read"),
}


@pytest.mark.parametrize("words, fragment", REFUSED.values(), ids=REFUSED)
def test_a_wrong_option_is_refused_and_nothing_is_created(scenes, refused, words, fragment):
    assert fragment in refused("compare", "off.toml", *words)
