# SPDX-License-Identifier: MIT
"""The command `compare`: one scene and several, own data, tolerances, a page and a JUnit file."""

import csv
import json
from types import SimpleNamespace
from xml.etree import ElementTree

import numpy as np
import pandas as pd
import pytest
from builders import COARSE, scene_text

from samfem.compared import NOT_COMPARED
from verification.compare.rows import COLUMNS
from verification.figures.compared import curves
from verification.runs.files import read_run

WIDE = '[compare.tolerances]\n"p_Pa over the contact" = "20 %"\n"mises_Pa in the plane y = 0" = 0.2\n'
OFF = '[compare]\ntolerances = { p_max_Pa = "1e-8 %" }\n'


@pytest.fixture
def scenes(folder, monkeypatch):
    """good.toml agrees, off.toml does not; both are solved once."""
    monkeypatch.setenv("SAMFEM_STORE", str(folder / "store"))
    (folder / "good.toml").write_text(scene_text(add=COARSE + WIDE))
    (folder / "off.toml").write_text(scene_text(add=COARSE + OFF))
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
    for words, source, tolerance in (
        ([], "[compare] tolerances", 1e-10),
        (["--tolerance", "p_max_Pa=50 %"], "option", 0.5),
    ):
        said = samfem("compare", "off.toml", *words, code=1)
        row = rows_of(scenes / "off-compare" / "compare.csv")["p_max_Pa"]
        assert float(row["tolerance"]) == tolerance and source in row["reason"]
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
