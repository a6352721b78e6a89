"""Error against cost: brackets, interpolation, references with an uncertainty, and the curve of the case made
of them.
"""

import math
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from made_results import red

from sam.scene import load_scene
from verification.cases.case import Context
from verification.cases.cost import (
    work_precision as case,
    work_precision_problems as problems,
    work_precision_study as measuring,
)
from verification.cases.cost.work_precision_problems import (
    AXISYMMETRIC,
    COUPLED,
    ELLIPSOID,
    PROBLEMS,
    SPATIAL,
    TWICE,
    loaded,
)
from verification.cases.cost.work_precision_study import SolvePoint
from verification.cost.advice import advice_of
from verification.cost.advice_rows import NEVER, columns_of, read_rows, table_text
from verification.cost.precision import (
    Ladder,
    Reached,
    Reference,
    agreed,
    at_error,
    bracket,
    limit_of,
    time_to_error,
)
from verification.figures.check import findings
from verification.figures.style import save
from verification.figures.work_precision import Line, curves, overview
from verification.runs import models

SCENES = Path(problems.__file__).parents[2] / "scenes"


@pytest.mark.parametrize(
    "errors, target, ends",
    [
        ([0.1, 0.02, 0.005], 0.01, (1, 2)),
        ([0.1, 0.001, 0.02, 0.005], 0.01, (2, 3)),  # small by chance on the way through zero
        ([0.005, 0.001], 0.01, (0, 0)),
        ([0.1, 0.01], 0.01, (0, 1)),
        ([0.1, 0.02], 0.01, None),
        ([0.1, 0.001, 0.02], 0.01, None),
        ([0.1, 0.001, math.nan], 0.01, None),
        ([math.nan, 0.001], 0.01, (0, 1)),
        ([], 0.01, None),
    ],
)
def test_the_bracket_is_where_the_error_falls_below_the_target_for_good(errors, target, ends):
    assert bracket(errors, target) == ends


def test_time_is_interpolated_in_the_logarithms():
    """error = 0.4/n^2, time = 0.01 n^3: time = 0.01 (0.4/error)^1.5 at every error between the ends."""
    n = np.array([2.0, 4.0, 8.0, 16.0])
    for target in (0.05, 0.01, 0.003):
        assert time_to_error(0.01 * n**3, 0.4 / n**2, target) == pytest.approx(0.01 * (0.4 / target) ** 1.5)
        assert at_error(n, 0.4 / n**2, target).value == pytest.approx((0.4 / target) ** 0.5)
    assert time_to_error(n, 0.4 / n**2, 1e-4) is None
    assert at_error(n, 0.4 / n**2, 0.5) == Reached(2.0, True, pytest.approx(0.4 / 256))
    assert at_error([1.0, 2.0], [math.nan, 0.001], 0.01).value == 2.0  # nothing to interpolate from
    assert at_error([1.0, 2.0], [0.1, 0.0], 0.01).value == 2.0


def test_no_error_below_the_floor_is_claimed():
    n = np.array([2.0, 4.0, 8.0, 16.0])
    assert at_error(n, 0.4 / n**2, 0.003, floor=0.004) == Reached(None, False, 0.004)
    assert at_error(n, 0.4 / n**2, 0.01, floor=0.004).value == pytest.approx(np.sqrt(40.0))


@pytest.mark.parametrize("values, errors", [([1.0], [0.1, 0.2]), ([0.0, 1.0], [0.1, 0.2])])
def test_values_that_fit_no_error_are_refused(values, errors):
    with pytest.raises(ValueError, match="values and errors"):
        at_error(values, errors, 0.01)


def power_law(name: str, limit: float, factor: float, order: float, cells=(4, 8, 16, 32)) -> Ladder:
    h = 1.0 / np.array(cells)
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


def test_values_that_follow_no_power_are_their_own_limit_with_their_last_change():
    found = limit_of(Ladder("SAM", [0.25, 0.125, 0.0625], [1.0, 1.2, 1.0]))
    assert found.value == 1.0 and found.uncertainty == pytest.approx(0.2)


HERTZ = next(problem for problem in PROBLEMS if problem.name == "hertz")
SLIDING = next(problem for problem in PROBLEMS if problem.name == "friction-0-2")


def test_every_problem_has_its_methods_its_five_resolutions_and_a_scene_each_model_takes():
    for problem in (*PROBLEMS, ELLIPSOID):
        scene = problem.scene(load_scene(SCENES / f"{problem.file}.toml"))
        for method in (*problem.methods, *problem.steps):
            assert len(method.ladder) >= (3 if method.model == models.FEM_3D else 5), (
                problem.name,
                method.name,
            )
            assert list(method.ladder) == sorted(set(method.ladder))
            models.check(method.at(scene, method.ladder[0]), method.model)
        assert (problem.exact is None) == bool(problem.references)
        assert all(len(problem.method(name).ladder) >= problem.tops for name in problem.references)


def test_what_each_method_changes_in_the_scene():
    scene = SLIDING.scene(load_scene(SCENES / f"{SLIDING.file}.toml"))
    for name, coupling, solver in (
        (COUPLED, True, "backward-euler"),
        ("SAM, decoupled", False, "backward-euler"),
    ):
        chosen = SLIDING.method(name).at(scene, 4)
        assert (chosen.friction.coupling, chosen.solver.method) == (coupling, solver)
    paper = SLIDING.method("SAM, the paper's loop").at(scene, 4)
    assert (paper.friction.coupling, paper.solver.method, paper.solver.stop) == (False, "paper", "stress")
    assert SLIDING.method(SPATIAL).at(scene, 6).fem.cells_per_radius == 6
    assert SLIDING.steps[0].at(scene, 40).loading.steps == 40
    worn = problems.worn_cells(load_scene(SCENES / "running-in-curve-b.toml"), 64)
    assert len(worn.grid.depths) - 1 == 26 and worn.grid.cells == (64, 64)


def test_methods_take_turns_rung_by_rung():
    turns = list(measuring.in_turn({"a": (1, 2, 3), "b": (4,), "c": (5, 6)}))
    assert turns == [("a", 1), ("b", 4), ("c", 5), ("a", 2), ("c", 6), ("a", 3)]


def solved_points(
    factor: float, order: float, seconds: float, method: str, cells=(4, 8, 16, 32)
) -> list[SolvePoint]:
    """Errors factor/n^order at seconds n^2, of a largest plastic strain of 0.5 %."""
    exact = {"peeq_max": 0.005, "p_max_Pa": HERTZ_P0}
    return [
        SolvePoint(
            method, n, "converged", seconds * n**2, 0.1, 0.2, 1e8, 0.1,
            values={name: size * (1.0 + factor / n**order) for name, size in exact.items()},
            counters={"operator_applications": 10},
        )
        for n in cells
    ]  # fmt: skip


HERTZ_P0 = problems._hertz(HERTZ.scene(load_scene(SCENES / "hertz-sphere.toml")))["p_max_Pa"]


def study(problem, **factors) -> measuring.ProblemStudy:
    """Synthetic: method -> (factor, order, seconds)."""
    points = {method.name: solved_points(*factors[method.name], method.name) for method in problem.methods}
    steps = {method.name: solved_points(0.5, 1.0, 0.01, method.name) for method in problem.steps}
    return measuring.ProblemStudy(
        problem, problem.scene(load_scene(SCENES / f"{problem.file}.toml")), points, steps
    )


@pytest.fixture
def studies():
    elastic = study(
        HERTZ, **{COUPLED: (0.2, 2.0, 1e-3), AXISYMMETRIC: (-0.2, 2.0, 2e-3), SPATIAL: (-0.5, 1.0, 1.0)}
    )
    rubbed = study(
        SLIDING,
        **{
            COUPLED: (0.3, 1.0, 1e-3),
            TWICE: (3.0, 1.0, 1e-3),
            "SAM, decoupled": (0.4, 1.0, 1e-3),
            "SAM, the paper's loop": (3.0, 1.0, 1e-3),
            SPATIAL: (-0.5, 1.0, 0.5),
        },
    )
    return [elastic, rubbed]


def red_of(*studies) -> set[str]:
    return red("work-precision", case.gated(studies))


def test_gates_of_the_case_turn_red_when_a_model_becomes_slow_or_errs(studies):
    elastic, rubbed = studies
    assert elastic.floor == measuring.EXACT and rubbed.floor < 0.01
    values = case.gated(studies)
    assert set(values) == {
        *("hertz-1", "hertz-0-3", "friction-0-2-faster", "hertz-monotone-sam", "hertz-monotone-fem"),
    }
    assert red("work-precision", values) == set()
    slow = replace(elastic, points=elastic.points | {COUPLED: solved_points(0.2, 2.0, 5e-3, COUPLED)})
    assert red_of(slow) == {"hertz-1", "hertz-0-3"}
    never = replace(elastic, points=elastic.points | {COUPLED: solved_points(2.0, 0.1, 1e-3, COUPLED)})
    assert red_of(never) == {"hertz-1", "hertz-0-3"}
    wavy = [*elastic.points[COUPLED][:2], elastic.points[COUPLED][0], elastic.points[COUPLED][3]]
    assert "hertz-monotone-sam" in red_of(replace(elastic, points=elastic.points | {COUPLED: wavy}))
    dear = replace(rubbed, points=rubbed.points | {COUPLED: solved_points(0.3, 1.0, 0.5, COUPLED)})
    assert red_of(dear) == {"friction-0-2-faster"}
    twice = replace(dear, points=dear.points | {TWICE: solved_points(0.01, 1.0, 1e-3, TWICE)})
    assert red_of(twice) == set()  # the better of one grid and two counts


def test_a_model_that_never_gets_there_counts_with_its_finest_point(studies):
    """0.5/32 = 1.6 %: 3D does not reach 1 %, and needed more than 0.5 * 32^2 s."""
    rubbed = studies[1]
    assert rubbed.curves[SPATIAL].time(0.01).value is None
    assert case.time_ratio(rubbed, SPATIAL, 0.01) == pytest.approx(
        rubbed.curves[COUPLED].time(0.01).value / 512.0
    )


def test_the_ratio_is_taken_at_the_smallest_error_that_both_reach(studies):
    """3D ends at 0.5/32 = 1.6 % after 512 s, where SAM, 0.3/n, has 19.2 cells: a sixtieth of a power."""
    rubbed = studies[1]
    ratio, error = case.faster(rubbed, SPATIAL)
    assert error == pytest.approx(0.5 / 32, rel=0.01)
    assert ratio == pytest.approx(512.0 / rubbed.curves[COUPLED].time(error).value)
    least, most = case.faster_range(rubbed, SPATIAL)
    assert least <= ratio <= most and least < most
    assert math.isnan(case.faster(rubbed, AXISYMMETRIC)[0])  # has no such model
    last = [*rubbed.points[SPATIAL][:-1], replace(rubbed.points[SPATIAL][-1], values={})]
    broken = replace(rubbed, points=rubbed.points | {SPATIAL: last})
    assert "friction-0-2-faster" in red_of(broken)


def test_below_what_is_known_of_the_reference_no_methods_are_compared(studies):
    vague = replace(studies[1])
    vars(vague)["floor"] = 0.05  # which is worked out once
    assert case.faster(vague, SPATIAL)[1] == pytest.approx(0.15)


def test_tables_and_advice_of_a_study(studies):
    rows = case.advice_rows(studies)
    assert {(row.method, row.bound) for row in rows if row.kind == HERTZ.kind and row.error == 0.05} == {
        ("sam", "<"), ("fem-axisymmetric", "<"), ("fem-3d", "")
    }  # fmt: skip
    one = next(
        row for row in rows if (row.kind, row.method, row.error) == (HERTZ.kind, "fem-axisymmetric", 0.01)
    )
    assert one.relative == pytest.approx(2.0, rel=1e-6) and one.resolution == pytest.approx(
        np.sqrt(20.0), rel=1e-4
    )
    assert one.kernels == pytest.approx(10.0 * one.seconds)
    steps = [row for row in rows if row.method == "load steps" and row.error == 0.05]
    assert len(steps) == 1 and steps[0].resolution == pytest.approx(10.0, rel=0.01)
    assert any(row.bound == NEVER for row in rows)
    kept = read_rows(table_text(rows))
    assert table_text(kept) == table_text(rows) and columns_of(kept) == columns_of(rows)
    for table in (case.times_table, case.faster_table, case.references_table, case.steps_table):
        found = table(studies)
        assert found.rows and all(len(row) == len(found.columns) for row in found.rows)
    assert all(
        len(row) == len(case.points_table(studies[0]).columns) for row in case.points_table(studies[0]).rows
    )
    assert any("not reached (1.6 %)" in row for row in case.times_table(studies).rows)


def test_a_solve_that_breaks_off_or_does_not_converge_is_shown_and_counts_as_no_answer():
    scene = HERTZ.scene(load_scene(SCENES / "hertz-sphere.toml"))

    def breaks(scene, model):
        raise RuntimeError("out of luck")

    found = measuring.once(HERTZ, HERTZ.methods[0], scene, 4, solve=breaks)
    assert found.status == "RuntimeError: out of luck" and not found.values and math.isnan(found.cpu_s)
    cost = dict.fromkeys(("cpu_s", "setup_s", "solve_s", "peak_memory_bytes"), 1.0)
    bad = SimpleNamespace(
        converged=False,
        cost=cost,
        quantities={"p_max_Pa": 1e9},
        status=SimpleNamespace(value="under-resolved"),
        last_fitting={},
        tables={},
    )
    strict = measuring.once(HERTZ, HERTZ.methods[0], scene, 4, solve=lambda *_: bad)
    lenient = measuring.once(HERTZ, replace(HERTZ.methods[0], strict=False), scene, 4, solve=lambda *_: bad)
    assert not strict.values and lenient.values == {"p_max_Pa": 1e9}
    drawn = measuring.curve([found, strict, lenient], {"p_max_Pa": Reference(2e9, 0.0, "")})
    assert np.isnan(drawn.errors[:2]).all() and drawn.errors[2] == 0.5 and drawn.time(0.6).value == 1.0


def test_repeats_become_their_median():
    found = measuring.merged(solved_points(0.2, 2.0, 1.0, COUPLED, cells=(1, 2, 3)))
    assert (found.cpu_s, found.spread, found.repeats) == (4.0, 9.0, 3)


def test_distance_of_profiles():
    z = np.linspace(0.0, 1.0, 11)
    assert measuring.profile_distance((z, 1.01 * z), (z, z)) == pytest.approx(0.01)
    assert math.isnan(measuring.profile_distance(None, (z, z)))


def test_a_small_study_from_end_to_end(tmp_path, monkeypatch):
    """Two coarse rungs more than an extrapolation needs, in this process: the pieces fit the solvers."""
    monkeypatch.setattr(measuring.measured, "alone", lambda function, *arguments: 0.1)
    monkeypatch.setattr(measuring, "REPEATS", 1)
    ladders = {COUPLED: (3, 4, 6), AXISYMMETRIC: (4, 6, 8)}
    small = replace(
        HERTZ,
        methods=tuple(replace(HERTZ.method(name), ladder=ladder) for name, ladder in ladders.items()),
    )
    context = Context("work-precision", tmp_path, "full", lambda *_: None)
    outcome = replace(case.CASES[0], problems=(small,), solver=models.solve).run(context)
    assert {name.split(".")[1] for name in outcome.values} == {
        *("hertz-1", "hertz-0-3", "hertz-monotone-sam", "hertz-monotone-fem")
    }
    assert outcome.values["work-precision.hertz-monotone-sam"].value < 1.0
    assert [figure.png for figure in outcome.figures] == [
        f"figures/work-precision-{n}.png" for n in ("advice", "hertz")
    ]
    assert read_rows((tmp_path / "figures/work-precision-advice.csv").read_text(encoding="utf-8"))
    assert len(outcome.tables) == 5


def test_figures_of_synthetic_curves(tmp_path):
    n = np.array([2, 4, 8, 16])
    lines = {
        "SAM": Line(0.01 * n**2.0, 0.2 / n**2.0, n),
        "FEM, 3D": Line(1.0 * n**3.0, np.where(n > 2, 0.3 / n, np.nan), n),
        "another": Line(np.full(4, np.nan), np.full(4, np.nan), n),
    }
    drawing = curves({"resolution": (lines, 1e-3), "load steps": (lines, 0.0)}, "error")
    assert len(drawing.data["method"]) == 2 * 12
    labels = [text.get_text() for text in drawing.figure.legends[0].get_texts()]
    assert labels[:-2] == ["SAM", "FEM, 3D"] and findings(drawing.figure) == []
    assert save(drawing, tmp_path / "curves")[0].stat().st_size > 5000
    times = {"elastic": {"SAM": Reached(0.1, False, 0.0), "FEM, 3D": Reached(None, False, 0.02)}}
    assert len(overview(times, "1 %").data["kind"]) == 2
    nowhere = overview({"running-in": {"SAM": Reached(None, False, 0.04)}}, "1 %")
    assert save(nowhere, tmp_path / "nowhere")[0].stat().st_size > 1000


def test_advice_for_a_scene_without_a_measurement():
    scene = loaded(load_scene(SCENES / "flat-punch.toml"))
    assert advice_of(scene, ("sam",))["kind"] is None
    assert "no error against run time" in advice_of(scene, ("sam",))["words"]
