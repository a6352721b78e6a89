# SPDX-License-Identifier: MIT
"""Sweeps of case files, on made results whose errors are powers of the size of a cell."""

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
from made_results import Made, context

from sam.scene import SceneError
from verification.cases import case_of
from verification.cases.kinds import KINDS, OVER_VARIANTS, SWEPT
from verification.cases.plastic.plastic_convergence import growth_of_norms, limit_of_both
from verification.cases.recipes import RECIPES, VALUES, beside
from verification.cases.sweep import STATISTICS, evaluated, words_of
from verification.judging import evaluate
from verification.references import contact_of
from verification.rows import Take, case_files, read_cases

FILE = """
title = "Made"
scene = "hertz-sphere"
reference = "hertz-sphere"
figures = ["orders", "lines radius over cells"]
levels = ["quick"]

[sweeps.made]
models = ["sam"]
axes = {cells = [9, 17, 33, 65], "loading.force" = [0.3, 0.6]}
columns = {p-max = "relative", radius = "value", approach = "value"}
size = "cell"

[rows.limit]
order = ["absolute", 1e-9, "made", "order", "order p-max at loading.force = 0.6 | 1.5"]
late = ["absolute", 1e-9, "made", "order", "order p-max at loading.force = 0.6, cells > 9 | 1.5"]
point = ["relative", 1e-9, "made", "value at a point", "radius at cells = 17, loading.force = 0.3"]
"r{1,2}" = ["relative", 1e-9, "made", "radius {1,2}", "last radius of {sam,made} | first radius of sam"]
bound = ["at_least", 2.5, "made", "value alone", "ratio p-max at cells < 33, loading.force = 0.3"]
"""


@pytest.fixture
def made(tmp_path):
    """(case, what it found) where p_max errs by (h/a)^1.5, and the radius of all is that of 0.6 N."""

    def solve(model, scene, label, demand=True):
        exact, n = contact_of(scene), scene.grid.cells[0]
        h = scene.grid.extent[0] / n
        quantities = {
            "p_max_Pa": exact.peak_pressure * (1.0 + (h / exact.contact_radius) ** 1.5),
            "contact_radius_m": exact.contact_radius,
            "approach_m": None if n == 9 else exact.approach,
        }
        return Made(quantities, model=model, discretisation={"cell_m": (h, h)})

    def case(extra=""):
        path = tmp_path / "made.toml"
        path.write_text(FILE + extra, encoding="utf-8")
        own = case_of(read_cases(path)[0])
        here = context("made", tmp_path)
        here.solve = solve
        return own, own.solve(here)

    return case


def verdicts(case, found):
    return {v.row.id.partition(".")[2]: v for v in evaluate(case.file.rows, {"made": case.values(found)})}


def test_rows_take_of_columns(made):
    case, found = made()
    judged = verdicts(case, found)
    failed = {name for name, verdict in judged.items() if verdict.status != "passed"}
    assert len(found[""].frame) == 8 and failed == {"r1", "r2"}  # last and first radius: of 0.6 and 0.3 N
    assert judged["order"].value == pytest.approx(1.5, abs=1e-9) and judged["order"].expected == 1.5
    assert judged["point"].expected == judged["point"].value
    assert judged["r1"].error == pytest.approx(2.0 ** (1 / 3) - 1.0)
    assert judged["bound"].expected is None


def test_a_missing_value_is_red_and_two_points_are_no_point(made):
    extra = 'gone = ["at_most", 1.0, "made", "largest", "largest approach"]'
    case, found = made(extra)
    assert verdicts(case, found)["gone"].note == "not a finite number"
    with pytest.raises(ValueError, match="4 points where one is meant"):
        evaluated(case.file, found[""].frame, Take.parse("radius at loading.force = 0.3"))


@pytest.mark.parametrize("take", ["order of the p-max!", "p-max at cells", "largest p max of sam", ""])
def test_what_is_no_take_is_refused(made, take):
    with pytest.raises(SceneError, match=r"rows\.limit\.wrong"):
        made(f'wrong = ["at_most", 1.0, "made", "words", "{take}"]')


@pytest.mark.parametrize(
    ("line", "problem"),
    [
        ("vary.resolution = 9", f"vary.resolution = 9: {VALUES['resolution']}"),
        ('vary.resolution = [8, "x"]', 'fem.cells_per_radius = "x": a whole number from 2 to 256'),
        ("vary.p0-over-yield = 3.0", "vary.p0-over-yield = 3.0: a number > 0, for a body that yields"),
        ("vary.nosuch = 1", f"vary.nosuch = 1: one of {', '.join(VALUES)}"),
        ('set."fem.box" = "wide"', 'fem.box = "wide": a number (in Hertz radii) from 3 to 1000'),
        ('set."fem.boxx" = 3', "set.fem.boxx = 3: a key of [fem]"),
        ('set."loading.force" = "3 m"', 'set.loading.force = "3 m": a number in units of N'),
        ("runs.a = {}", 'runs.a.model = "": one of sam, fem, fem-3d, fem-plane-strain'),
        (
            'runs.a = {model = "sam", vary.film = 3}',
            "vary.film = 3: as in the cases of the suite that use it",
        ),
    ],
)
def test_what_makes_no_scene_is_refused_before_anything_is_solved(tmp_path, line, problem):
    path = tmp_path / "made.toml"
    path.with_suffix(".py").write_text("1 / 0\n")  # of the user, and none of ours
    path.write_text(FILE.replace("levels", f"{line}\nlevels"), encoding="utf-8")
    with pytest.raises(SceneError) as caught:
        case_of(read_cases(path)[0])
    assert str(caught.value) == f"{path}: {problem}"


def test_what_is_shown_follows_from_the_words(made, tmp_path):
    case, found = made()
    assert [plot.name for plot in case.figures(found)] == ["orders", "radius"]
    (table,) = case.tables(found)
    assert table.columns[:4] == ("cells", "loading force", "model", "largest pressure, relative error")
    assert table.rows[-1][3] == "order 1.50"
    case = replace(case, file=case.file.model_copy(update={"figures": ("limits radius",)}))
    both = pd.concat([found[""].frame, found[""].frame.assign(model="fem")])
    figure = context("made", tmp_path).save(SWEPT["limits"](case.file, both, "radius"))
    assert (tmp_path / figure.png).stat().st_size > 1000


def test_limit_of_both_and_growth_of_norms():
    """Steps and cells act in products: v = 2 (1 + h_steps)(1 + h_cells^2)."""
    steps, cells = np.array([5, 10, 20]), np.array([0.1, 0.05, 0.025])
    rows = pd.DataFrame(
        {
            "sweep": ["steps"] * 3 + ["grid"] * 3,
            "loading.steps": [*steps, 10, 10, 10],
            "h": [*1.0 / steps, *cells],
            "peeq-max": [*2.0 * (1 + 1 / steps) * 1.01, *2.0 * 1.1 * (1 + cells**2)],
        }
    )
    assert limit_of_both(rows, "peeq-max") == pytest.approx(2.0, rel=1e-6)
    apart = pd.DataFrame({"peeq-axis": [0.04, 0.02, 0.01], "peeq-plane": [0.08, 0.03, 0.015]})
    assert growth_of_norms(apart, "") == pytest.approx(0.5, rel=1e-12)


@pytest.mark.parametrize("file", [f for f in case_files().values() if f.taken], ids=lambda file: file.name)
def test_every_name_of_a_file_with_points_is_known(file):
    """Recipes, columns, statistics and figures, of a registry or beside the file; what is taken and drawn."""
    for sweep in file.sweeps.values():
        for axes in (sweep.axes, sweep.quick):
            for axis, values in axes.items():
                keys = values.values() if isinstance(values, dict) else [{axis: None}]
                assert all(beside(file, key, RECIPES) for each in keys for key in each if "." not in key)
        assert all(words_of(file, column) for column in sweep.columns)
    for take in (take for claim in file.taken for take in claim.take if take.number is None):
        assert beside(file, take.statistic, STATISTICS)
        assert file.frame or take.column in {c for sweep in file.sweeps.values() for c in sweep.columns}
    known, drawn = KINDS | SWEPT | OVER_VARIANTS, [figure.split() for figure in file.figures]
    assert all(beside(file, kind, known) for kind, *_ in drawn)
    lines = {words[1].partition(",")[0].replace("_", "-") for words in drawn if words[0] == "lines"}
    assert lines <= file.captions.keys()
