# SPDX-License-Identifier: MIT
"""Error against cost: brackets, interpolation, references with an uncertainty, curves made of them."""

import math
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest

from sam.scene import load_scene
from verification.cases import all_cases
from verification.cases.case import Context
from verification.cases.cost import work_precision as case, work_precision_problems as problems
from verification.cases.cost.work_precision_problems import AXISYMMETRIC, COUPLED, SPATIAL, TWICE
from verification.cost.advice import read_rows
from verification.cost.precision import Ladder, Reached, agreed, at_error, bracket, limit_of
from verification.figures.style import save
from verification.figures.work_precision import overview
from verification.runs import models

SCENES = Path(problems.__file__).parents[2] / "scenes"
FILE = all_cases()["work-precision"].file


@pytest.mark.parametrize(
    "errors, target, ends",
    [
        ([0.1, 0.02, 0.005], 0.01, (1, 2)),
        ([0.1, 0.001, 0.02, 0.005], 0.01, (2, 3)),  # small by chance on the way through zero
        ([0.005, 0.001], 0.01, (0, 0)),
        ([0.1, 0.01], 0.01, (0, 1)),
        ([0.1, 0.001, 0.02], 0.01, None),
        ([0.1, 0.001, math.nan], 0.01, None),
        ([math.nan, 0.001], 0.01, (0, 1)),
        ([], 0.01, None),
    ],
)
def test_the_bracket_is_where_the_error_falls_below_the_target_for_good(errors, target, ends):
    assert bracket(errors, target) == ends


def test_time_is_interpolated_in_the_logarithms():
    """error = 0.4/n^2, time = 0.01 n^3: time = 0.01 (0.4/error)^1.5; none below the floor."""
    n = np.array([2.0, 4.0, 8.0, 16.0])
    for target in (0.05, 0.003):
        assert at_error(0.01 * n**3, 0.4 / n**2, target).value == pytest.approx(0.01 * (0.4 / target) ** 1.5)
    assert at_error(n, 0.4 / n**2, 1e-4).value is None
    assert at_error(n, 0.4 / n**2, 0.5) == Reached(2.0, True, pytest.approx(0.4 / 256))
    assert at_error([1.0, 2.0], [math.nan, 0.001], 0.01).value == 2.0  # nothing to interpolate from
    assert at_error([1.0, 2.0], [0.1, 0.0], 0.01).value == 2.0
    assert at_error(n, 0.4 / n**2, 0.003, floor=0.004) == Reached(None, False, 0.004)
    assert at_error(n, 0.4 / n**2, 0.01, floor=0.004).value == pytest.approx(np.sqrt(40.0))


@pytest.mark.parametrize("values, errors", [([1.0], [0.1, 0.2]), ([0.0, 1.0], [0.1, 0.2])])
def test_values_that_fit_no_error_are_refused(values, errors):
    with pytest.raises(ValueError, match="values and errors"):
        at_error(values, errors, 0.01)


def power_law(name: str, limit: float, factor: float, order: float) -> Ladder:
    h = 1.0 / np.array([4, 8, 16, 32])
    return Ladder(name, list(h), list(limit * (1.0 + factor * h**order)))


def test_limits_of_two_models_become_one_reference():
    one, other = power_law("SAM", 2.0, 0.3, 1.0), power_law("FEM", 2.004, -0.8, 2.0)
    assert limit_of(one).value == pytest.approx(2.0, rel=1e-6)
    assert limit_of(one).uncertainty == pytest.approx(0.3 / 32, rel=1e-3)
    both = agreed(one, other)
    assert both.value == pytest.approx(2.004, rel=2e-4)  # nearer the one with the smaller correction
    assert both.uncertainty == pytest.approx(0.001, rel=0.05)  # half of what they are apart
    assert both.error(2.01 * both.value / 2.0) == pytest.approx(0.005) and math.isnan(both.error(None))
    alone = agreed(one)
    assert alone.uncertainty == pytest.approx(0.3 / 32, rel=1e-3) and alone.origin == "SAM"
    none = limit_of(Ladder("SAM", [0.25, 0.125, 0.0625], [1.0, 1.2, 1.0]))  # follows no power
    assert none.value == 1.0 and none.uncertainty == pytest.approx(0.2)


HERTZ, SLIDING = case.STUDIED["hertz"], case.STUDIED["friction-0-2"]


def scene_of(problem):
    return problem.scene(load_scene(SCENES / f"{problem.file}.toml"))


def method(problem, name):
    return next(each for each in problem.methods if each.name == name)


def test_every_problem_has_its_methods_its_five_resolutions_and_a_scene_each_model_takes():
    for problem in case.STUDIED.values():
        scene = scene_of(problem)
        for each in filter(None, (*problem.methods, problem.steps)):
            assert len(each.ladder) >= (3 if each.model == models.FEM_3D else 5), (problem.name, each.name)
            assert list(each.ladder) == sorted(set(each.ladder))
            models.check(each.at(scene, each.ladder[0]), each.model)
        assert (problem.exact is None) == bool(problem.references)
        assert all(len(method(problem, name).ladder) >= problem.tops for name in problem.references)
        assert f"errors {problem.name}" in FILE.figures


def test_ratios_are_of_the_times_to_an_error_that_both_reach():
    """Errors f/n at s n^2 seconds: (f/e)^2 s to an error e. The axisymmetric model ends at 1/32 and counts
    with its finest point, that in space at 0.5/32; nothing is compared below three times the floor.
    """
    of = {COUPLED: (0.3, 1e-3), AXISYMMETRIC: (1.0, 2e-3), SPATIAL: (0.5, 0.5)}
    points = [(name, f / n, s * n**2, 0.0) for name, (f, s) in of.items() for n in (4, 8, 16, 32)]
    rows = pd.DataFrame(points, columns=["method", "error", "cpu_s", "floor"])
    assert case.ratio_at_one(rows, "") == pytest.approx(30**2 * 1e-3 / (2e-3 * 32**2), rel=1e-12)
    assert case.ratio_at_a_third(rows, "") == math.inf  # 0.3/32 is 0.9 %
    ratio, error = case.faster(rows, SPATIAL)
    assert error == 0.5 / 32 and case.faster_than_spatial(rows, "") == ratio
    assert ratio == pytest.approx(0.5 * 32**2 / (1e-3 * 19.2**2), rel=1e-12)
    assert math.isnan(case.faster(rows, TWICE)[0])
    assert case.faster(rows.assign(floor=0.05), SPATIAL)[1] == pytest.approx(0.15, rel=1e-12)


def test_a_solve_that_breaks_off_or_does_not_converge_is_shown_and_counts_as_no_answer():
    def breaks(scene, model):
        raise RuntimeError("out of luck")

    scene, first = scene_of(HERTZ), HERTZ.methods[0]
    found = case.once(HERTZ, first, scene, 4, solve=breaks)
    assert found["status"] == "RuntimeError: out of luck" and not found["values"]
    assert math.isnan(found["cpu_s"])
    status = SimpleNamespace(value="under-resolved")
    bad = SimpleNamespace(converged=False, cost={"cpu_s": 1.0}, status=status, last_fitting={})
    bad.quantities = {"p_max_Pa": 2.0 * HERTZ.exact(scene)["p_max_Pa"]}
    strict = case.once(HERTZ, first, scene, 4, solve=lambda *_: bad)
    lenient = case.once(HERTZ, replace(first, strict=False), scene, 4, solve=lambda *_: bad)
    rows = [row | {"refined": "resolution", "kernel": 0.1} for row in (found, strict, lenient)]
    frame = pd.DataFrame(case.with_errors(HERTZ, scene, rows))
    assert np.isnan(frame["error"][:2]).all() and frame["error"][2] == pytest.approx(1.0)
    assert case.reached(frame, COUPLED, 1.1).value == 1.0
    with pytest.raises(RuntimeError, match="2 usable resolutions, 3 are needed"):
        case.limits(HERTZ, [lenient | {"method": COUPLED}] * 2, [COUPLED])


def test_a_small_study_from_end_to_end(tmp_path, monkeypatch):
    """Two coarse rungs more than an extrapolation needs, in this process: the pieces fit the solvers."""
    monkeypatch.setattr(case.measured, "alone", lambda function: 0.1)
    monkeypatch.setattr(case, "REPEATS", 1)
    ladders = {COUPLED: (3, 4, 6), AXISYMMETRIC: (4, 6, 8)}
    small = tuple(replace(method(HERTZ, name), ladder=ladder) for name, ladder in ladders.items())
    monkeypatch.setitem(case.STUDIED, "hertz", replace(HERTZ, methods=small))
    context = Context("work-precision", tmp_path, "full", lambda *_: None)
    frame = pd.DataFrame(case.frame(context, ["hertz"], models.solve))
    assert len(frame) == 6 and (frame["error"] < 0.1).all()
    assert case.growth(frame[frame["method"] == COUPLED], "error") < 1.0
    figures = [context.save(plot) for plot in (case.advice(FILE, frame), case.errors(FILE, frame, "hertz"))]
    assert all((tmp_path / figure.png).stat().st_size > 1000 and not figure.findings for figure in figures)
    none = case.errors(FILE, frame.assign(error=math.nan), "hertz").drawing  # without an answer: no curve
    (name,) = none.figure.legends[0].get_texts()
    assert name.get_text() == "an error whose times are stated" and len(none.data["method"]) == 6
    nowhere = overview({"running-in": {"SAM": Reached(None, False, 0.04)}}, "1 %")
    assert save(nowhere, tmp_path / "nowhere")[0].stat().st_size > 1000
    assert read_rows((tmp_path / "figures/work-precision-advice.csv").read_text(encoding="utf-8"))
