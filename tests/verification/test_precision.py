# SPDX-License-Identifier: MIT
"""Error against cost: brackets, interpolation, references with an uncertainty, curves made of them; SAM
beside other programs, without them: problems, errors, times to an error, processes that fail.
"""

import json
import math
import sys
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest

from sam.scene import load_scene
from verification.cases import all_cases
from verification.cases.case import Context
from verification.cases.cost import work_precision as case
from verification.cases.cost.work_precision_problems import AXISYMMETRIC, COUPLED, SPATIAL, TWICE
from verification.cases.peers import peers
from verification.cost.advice import read_rows
from verification.cost.precision import Ladder, Reached, agreed, at_error, bracket, limit_of
from verification.figures.style import save
from verification.figures.work_precision import overview
from verification.judging import evaluate
from verification.peers import elastic, plastic, problems, running
from verification.peers.programs import sam as ours
from verification.peers.running import SAM, TAMAAS, VARIABLE, Job, Measurement
from verification.references import contact_of
from verification.rows import load_rows
from verification.runs import models
from verification.suite.verify import main

SCENES = Path(case.__file__).parents[2] / "scenes"
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


class TestProblems:
    def test_rough_surface_is_one_on_all_grids(self):
        coarse, fine = problems.rough_heights(160), problems.rough_heights(320)
        assert np.allclose(fine[::2, ::2], coarse, rtol=0.0, atol=1e-12)
        assert np.sqrt(np.mean(fine**2)) == pytest.approx(1.0, rel=1e-12)
        with pytest.raises(ValueError, match="128 cells"):
            problems.rough_heights(128)

    def test_step_is_three_times_the_yield_stress_in_the_scene_too(self):
        scene = ours.scene_of(32, 16, 1e-3)
        exact = contact_of(scene)
        a, p0 = exact.contact_radius, exact.peak_pressure
        assert (a, p0) == pytest.approx((ours.RADIUS_M, 3 * scene.body.plasticity.yield_stress), rel=1e-12)
        assert scene.grid.extent[0] == pytest.approx(6 * a, rel=1e-12) and scene.loading.steps == 1


def rows(**found) -> pd.DataFrame:
    """Of programs whose error is 0.01/n^2: (seconds for n = 1, label) of each curve."""
    record = {"converged": True, "peak_memory_bytes": 1e8}
    own = {
        program: [
            Measurement(Job(problems.HERTZ, n, {"tolerance": 1e-5}, label), [0.0], [each * n], record=record)
            for each, label in curves
            for n in (10, 100)
        ]
        for program, curves in found.items()
    }
    return pd.DataFrame(running.rows_of("hertz", own, lambda m: 0.01 / m.job.cells**2))


class TestTimes:
    def test_time_to_an_error_is_interpolated_and_the_better_curve_taken(self):
        made = rows(sam=[(1e-3, "")], tamaas=[(2e-2, "tight"), (1e-2, "loose")])
        found = peers.reached(made, 1e-5)  # at n = sqrt(1000)
        assert found[SAM] == ("SAM", pytest.approx(1e-3 * 1000**0.5, rel=1e-12))
        assert found[TAMAAS] == ("Tamaas, loose", pytest.approx(1e-2 * 1000**0.5, rel=1e-12))
        assert peers.tamaas_to_error(made, "") == pytest.approx(10.0, rel=1e-12)
        never = peers.reached(made, 1e-9)
        assert never[SAM][1] is None and math.isnan(peers.ratio(never[TAMAAS][1], None))


def test_what_is_not_there_has_no_ratio():
    """SAM alone, on one grid of the rough patch and two of the sphere."""
    made = pd.concat([rows(sam=[(1e-3, "")]), rows(sam=[(1e-3, "")]).assign(sweep="rough", cells="1024²")])
    made["floor"] = 0.0
    for take in (peers.contact_mechanics_to_error, peers.contact_mechanics_on_finest):
        assert math.isnan(take(made, ""))
    assert all(math.isnan(take(made[:0], "")) for take in (peers.step_on_coarse, peers.step_on_fine))
    tables = [table(made).rows for table in (peers.hertz_times, peers.rough_times, peers.step_times)]
    assert [len(each) for each in tables] == [1, 1, 0] and tables[0][0][3] == tables[1][0][4] == "1"
    plot = peers.over_time(None, made, "hertz")
    assert "processor time" in plot.caption and plot.drawing.data


class TestEnvironment:
    def test_without_the_variable_the_case_is_not_run(self, tmp_path, monkeypatch, capsys):
        monkeypatch.delenv(VARIABLE, raising=False)
        assert main(["peers"], "full", tmp_path / "out") == 0
        said = capsys.readouterr().out
        assert said.startswith("peers: not run: ") and VARIABLE in said and "make peers" in said
        assert not (tmp_path / "out").exists()
        monkeypatch.setenv(VARIABLE, str(tmp_path / "none"))
        assert main(["peers"], "full", tmp_path / "out") == 0 and "no such program" in capsys.readouterr().out


class TestWorker:
    def test_real_child_process(self):
        good, bad = (Measurement(Job(problems.HERTZ, 48, how)) for how in ({"tolerance": 1e-6}, {}))
        for each in (good, bad):
            running.run(SAM, each, Path(sys.executable))
        assert good.solved and good.seconds > 0.0 and good.record["peak_memory_bytes"] > 1e7
        assert good.fields["pressure"].max() == pytest.approx(problems.P0, rel=1e-3)
        assert not bad.solved and "KeyError" in bad.failure and math.isnan(bad.seconds)


def in_process(program, each, python, allowance=0.0):
    """SAM in the place of every program, ten times slower than it is, and in this process."""
    job = each.job
    settings = {key: job.settings[key] for key in ("tolerance", "side", "depth") if key in job.settings}
    if program != SAM and job.problem != problems.STEP:
        settings["tolerance"] = 1e-8  # theirs are other measures
    counts, fields = ours.read(ours.setup(job.problem, job.cells, settings)()())
    each.setup_s.append(0.0)
    each.solve_s.append(job.cells[0] if job.problem == problems.STEP else job.cells)
    each.solve_s[-1] *= 1e-3 if program == SAM else 1e-2
    each.record, each.fields = {**counts, "peak_memory_bytes": 1e8}, fields


class TestRounds:
    def test_the_page_with_sam_in_the_place_of_all(self, tmp_path, monkeypatch):
        """Times made ten to one, tables and figures whole, a program that is not built."""
        monkeypatch.setattr(running, "run", in_process)
        monkeypatch.setattr(running, "calibration_s", lambda: 0.2)
        monkeypatch.setattr(peers, "interpreter", lambda: Path("python"))
        monkeypatch.setattr(peers, "installed", lambda _: {"tamaas": "2.9", "contact_mechanics": "1.8"})
        for name, value in {"SIZES": (48, 192, 256), "ROUGH_SIZES": (160,), "COMPARED": (192,)}.items():
            monkeypatch.setattr(elastic, name, value)
        monkeypatch.setattr(elastic, "disagreements", lambda *_: {"tamaas": 1e-9, "contact_mechanics": 1e-8})
        grids = {"GRIDS": ((16, 8),), "COMPARED": ((16, 8),), "OWN_GRIDS": ((11, 8), (15, 11))}
        for name, value in grids.items():
            monkeypatch.setattr(plastic, name, value)
        monkeypatch.setattr(peers, "MESHES", (8, 12))
        context = Context("peers", tmp_path, "quick", lambda *_: None)
        outcome = all_cases()["peers"].run(context)
        values = {name: measured.value for name, measured in outcome.values.items()}
        assert values["peers.rough-contact-mechanics"] == pytest.approx(10.0)
        assert values["peers.hertz-tamaas"] == pytest.approx(10.0, rel=0.05)
        assert values["peers.hertz-contact-mechanics"] == pytest.approx(10.0, rel=0.05)
        assert values["peers.step-16"] == values["peers.step-32"] > 1.0  # here the cells of both are the same
        built = next(table for table in outcome.tables if table.caption == "programs").rows
        assert any("not built" in cell for row in built for cell in row if "aspher" in row)
        assert len(outcome.figures) == 2 and len(outcome.tables) == 9
        red = {v.row.id for v in evaluate(load_rows(), {"peers": outcome.values}) if v.status.red}
        assert {"peers.hertz-tamaas", "peers.hertz-contact-mechanics"} <= red  # ten is not twenty
        assert all(len(row) == len(table.columns) for table in outcome.tables for row in table.rows)
        json.dumps([list(table.rows) for table in outcome.tables])
