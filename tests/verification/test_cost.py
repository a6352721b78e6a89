# SPDX-License-Identifier: MIT
"""Accuracy on demand: what is chosen, how it is refined, what is refused and what is not reached. The
advice of `samfem plan`: which measurement a scene is nearest to, and the lines that it gets. Growth of time
and memory: exponents, processes that measure themselves alone, the published code.
"""

import json
import math
import os
from itertools import product
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from builders import MODULUS, PERFECT, RADIUS, SPHERE, STEEL, SWIFT, running_in, scene, scene_text
from made_results import of_frame, red

from sam import choose_grid
from sam.scene import Result, Scene, SceneError, Status, load_scene, parse_scene
from verification.cases.case import with_loading
from verification.cases.cost import published_code
from verification.cases.cost.work_precision import ADVISED
from verification.cases.cost.work_precision_problems import PROBLEMS
from verification.cases.recipes import Resolution, at_ratio, sliding_scene
from verification.cost import accuracy, advice, estimates
from verification.cost.accuracy import Choice, chosen_scene, expected, first_choice, missed, solve
from verification.cost.advice import LOAD_STEPS, NEVER, ON_TWO_GRIDS, AdviceRow, advice_of, kind_of
from verification.cost.contact import expected_contact, hertz_of
from verification.cost.measured import alone, idle_bytes
from verification.cost.plan import plan
from verification.cost.precision import TARGETS
from verification.reference.convergence import fit_power
from verification.reference.hertz import CircularContact
from verification.runs.files import read_run
from verification.runs.models import FEM, FEM_3D, MODELS, SAM, ModelError, check
from verification.runs.threads import EVERY_LIBRARY as THREADS
from verification.text.console import table_lines

ELASTIC = {"body": STEEL, "counterbody": SPHERE, "loading": {"force": 0.1}}
YIELDING = ELASTIC | {"body": STEEL | {"plasticity": PERFECT}, "loading": {"force": 0.02, "steps": 1}}


def asked(accuracy: float, tables=YIELDING, **more) -> Scene:
    return Scene(**tables | {"solver": {"accuracy": accuracy} | more})


def test_the_cells_and_steps_come_from_the_table():
    """More for a smaller error, as its square root; no fewer than three grids can be made of."""
    coarse, fine = (expected(asked(each), SAM) for each in (0.05, 0.0125))
    assert coarse.cells == pytest.approx(4.2 * 1.4**2) and fine.steps >= coarse.steps == 6
    (row,) = (
        each for each in advice.table() if (each.kind, each.method, each.error) == ("yielding", SAM, 0.003)
    )
    assert fine.cells == pytest.approx(row.resolution * (0.003 * 4.5 / 0.0125) ** 0.5, rel=0.02)
    assert expected(asked(0.005), SAM).steps > 6
    scene = chosen_scene(asked(0.0125), SAM, fine)
    assert scene.solver.accuracy is None and scene.solver.uncertainty and scene.loading.steps == fine.steps
    in_radius = CircularContact(scene.loading.force, RADIUS, MODULUS).contact_radius / choose_grid(scene).hx
    assert in_radius == pytest.approx(fine.cells, rel=0.15)
    assert chosen_scene(asked(0.05), FEM, first_choice(asked(0.05), FEM)).fem.cells_per_radius == 10
    assert first_choice(asked(0.05, ELASTIC), SAM).steps == 0
    assert first_choice(asked(1e-3), SAM) == Choice(4.2 * 1.4**2, 6)  # of what yields the fewest
    assert first_choice(asked(1e-3, ELASTIC), SAM) == expected(asked(1e-3, ELASTIC), SAM)


def made(scene: Scene, of_cells: float, of_steps: float) -> Result:
    """Of an error that falls with the square of the cells, and with the load steps."""
    grid = choose_grid(scene)
    strain = 1 + of_cells / grid.nx**2 + of_steps / scene.loading.steps
    values = {"peeq_max": strain, "contact_radius_m": 10 * grid.hx * grid.nx / 40}
    found = {"cells": [grid.nx, grid.ny]}
    return Result(SAM, Status.CONVERGED, values, {}, discretisation=found, cost={"solve_s": 1.0})


def searched(scene: Scene, solver, model: str = SAM) -> tuple[Result, list[str]]:
    """The result of a solver that makes results up, and the labels of its solves."""
    labels = []
    return solve(scene, model, lambda each, label: labels.append(label) or solver(each)), labels


@pytest.mark.parametrize(
    "of_cells, of_steps, cells, steps",
    [(30.0, 0.01, True, False), (1.0, 0.2, False, True), (30.0, 0.2, True, True), (1.0, 0.01, False, False)],
)
def test_what_is_missing_is_refined_and_nothing_else(of_cells, of_steps, cells, steps):
    """Errors of of_cells/nx^2 and of_steps/steps: the uncertainty is three and two times as much, of 5 %.
    Only more cells are solved, or more load steps, or both, or the first grids are enough.
    """
    result, labels = searched(asked(0.05), lambda scene: made(scene, of_cells, of_steps))
    found, entry = result.discretisation["accuracy"], result.uncertainty["peeq_max"]
    assert found["reached"] and 0.3 * 0.05 * (cells or steps) < found["relative"] <= 0.05
    assert not missed(result)
    assert found["relative"] == entry["relative"] and result.cost["solve_s"] == found["solves"]
    assert len(labels) == found["solves"] and len(found["attempts"]) == 1 + cells
    assert (entry["cells"][0] > 33, entry["steps"][0] > 6) == (cells, steps)
    assert entry["u_steps"] / entry["values"][0] == pytest.approx(2 * of_steps / entry["steps"][0], rel=0.1)
    several = [label for label in labels if "load steps" in label]
    assert all(label.endswith("on 17 cells") for label in several)  # the coarsest
    assert (len(several) > 3) == steps


@pytest.mark.parametrize(
    "memory, longest, words",
    [(4e8, 900.0, "memory needed, 400 MB available"), (1e12, 4.0, "4 s allowed for all solves")],
)
def test_a_grid_that_would_need_too_much_is_not_solved(monkeypatch, memory, longest, words):
    """The next grid is predicted to need more than there is; what was found before it is the result."""
    monkeypatch.setattr(accuracy, "memory_bytes", lambda: memory)
    monkeypatch.setattr(accuracy, "LONGEST", longest)
    result, labels = searched(asked(0.05), lambda scene: made(scene, 1000.0, 0.0))
    found = result.discretisation["accuracy"]
    assert not found["reached"] and words in found["why"] and "would be next" in missed(result)
    solved = [each for each in labels if "load steps" not in each]
    assert result.discretisation["cells"][0] == max(int(each.split()[0]) for each in solved)


def of_elements(scene: Scene) -> Result:
    """Of finite elements in a box that is too small, whatever the elements."""
    pressure = 1 + 1e-2 / scene.fem.cells_per_radius**2 + 2 / scene.fem.box**2
    return Result(FEM, Status.CONVERGED, {"p_max_Pa": pressure}, {}, cost={"solve_s": 1.0})


def test_what_more_cells_cannot_help_is_said():
    """The box of finite elements leaves 3 times 2/8^2; in one of 80 radii it leaves a hundredth of that."""
    small, large = (asked(0.02, ELASTIC | {"fem": {"box": box}}) for box in (8.0, 80.0))
    result, labels = searched(small, of_elements, FEM)
    assert "fem.box = 8 leaves too much" in missed(result) and len(labels) == 4
    result, _ = searched(large, of_elements, FEM)
    assert result.discretisation["accuracy"]["reached"] and result.uncertainty["p_max_Pa"]["u_box"] > 0.0


@pytest.mark.parametrize(
    "tables, words",
    [
        ({"grid": {"cells": (33, 33)}}, "not together with \\[grid\\]"),
        ({"solver": {"accuracy": 0.01, "extrapolate": True}}, "not together with extrapolate"),
        ({"solver": {"accuracy_of": ("peeq_max",)}}, "only together with accuracy"),
        ({"solver": {"accuracy": 0.01, "accuracy_of": ("peak",)}}, "p_max_Pa"),
        ({"solver": {"accuracy": 1e-6}}, 'or in percent, such as "1 %"'),
        ({"solver": {"accuracy": "a little"}}, 'or in percent, such as "1 %"'),
        ({"loading": {"force": 0.0}}, "loading.force above 0: without contact there is no error"),
    ],
)
def test_wrong_keys_are_refused(tables, words):
    with pytest.raises(SceneError, match=words):
        Scene(**YIELDING | {"solver": {"accuracy": 0.01}} | tables)


@pytest.mark.parametrize(
    "change, more, words",
    [
        ({"counterbody": {"shape": "punch", "radius": 1e-5}}, {}, "no error was measured"),
        ({}, {"accuracy_of": ("residual_mises_max_Pa",)}, "moves to another place"),
    ],
)
def test_what_was_not_measured_is_refused(change, more, words):
    with pytest.raises(ModelError, match=words):
        first_choice(asked(0.01, ELASTIC | change, **more), SAM)


def test_the_plan_announces_it():
    content = plan(asked(0.02)).content["models"][0]
    (stage,) = (each for each in content["stages"] if each["stage"] == "accuracy")
    assert "2 % of peeq_max: begins with 8.23 cells" in stage["reason"]
    assert "advice expects" in stage["reason"]


def test_the_command_reaches_it(folder, samfem):
    """The pressure of Hertz to 1 %: the true error is smaller still."""
    (folder / "sphere.toml").write_text(scene_text(add='[solver]\naccuracy = "1 %"\n'))
    samfem("solve", "sphere.toml")
    run = read_run(folder / "sphere-sam")
    found = run.summary["discretisation"]["accuracy"]
    assert found["reached"] and found["quantity"] == "p_max_Pa" and found["relative"] <= 0.01
    exact = CircularContact(0.65, RADIUS, MODULUS).peak_pressure
    assert abs(run.quantities["p_max_Pa"] / exact - 1) < 0.01


# advice


SCENES = Path(advice.__file__).parents[1] / "scenes"


def scene_of(name: str):
    return load_scene(SCENES / f"{name}.toml")


STEEL_SPHERE = scene_of("plastic-swift-rigid")


def row(kind, method, numbers, *, error=0.01, bound="") -> AdviceRow:
    """numbers: resolution, seconds and time over the least."""
    unit = "load steps" if method == LOAD_STEPS else "cells in the contact radius"
    resolution, seconds, relative = numbers
    cost = (seconds, 10 * seconds, relative)
    return AdviceRow(kind, "largest plastic strain", method, error, bound, resolution, unit, 5, *cost)


ROWS = (
    row("yielding", SAM, (7.3, 0.42, 1.0)),
    row("yielding", FEM, (11.0, 1.3, 3.1)),
    row("yielding", FEM_3D, (math.nan,) * 3, bound=NEVER),
    row("yielding", LOAD_STEPS, (14.2, 3.0, math.nan)),
    row("yielding", SAM, (3.0, 0.1, 1.0), error=0.05, bound="<"),
    row("elastic", SAM, (3.0, 0.05, 1.0)),
)


def test_every_problem_of_the_case_is_the_nearest_to_itself_and_its_table_fits_80_columns():
    for problem in PROBLEMS:
        own = problem.scene(scene_of(problem.file))
        assert kind_of(own) == problem.kind
        found = advice_of(own, (SAM, FEM, FEM_3D))["table"]
        assert max(map(len, table_lines(found["columns"], found["rows"]))) <= 75


DEEP = "deeply yielding"


@pytest.mark.parametrize("ratio, kind", [(1.5, "elastic"), (1.7, "yielding"), (4.4, "yielding"), (4.6, DEEP)])
def test_a_sphere_is_judged_by_its_elastic_pressure(ratio, kind):
    assert kind_of(at_ratio(STEEL_SPHERE, ratio)) == kind


def test_other_scenes():
    assert kind_of(sliding_scene(STEEL_SPHERE, 1.5, 0.3, Resolution(4, 4))) == "yielding and sliding"
    assert kind_of(running_in()) == "running-in"
    of_files = {"hertz-ellipse": "elastic", "rough-patch": "rough, elastic", "coated-sliding": "coated"}
    of_files |= {"rough-asperities": "rough, yielding", "flat-punch": None, "misfit-sphere": None}
    assert {name: kind_of(scene_of(name)) for name in of_files} == of_files
    for force in (0.0, 1e-300):
        assert kind_of(with_loading(scene_of("plastic-perfect"), force=force)) == "elastic"


@pytest.mark.parametrize(
    "name, p0, kind",
    [("hertz-sphere", 3e9, None)]
    + [("plastic-swift-rigid", p0, kind) for p0, kind in ((4e9, "yielding"), (7e9, DEEP), (15e9, None))],
)
def test_a_given_pressure_is_no_result_but_the_strain_below_it_is(name, p0, kind):
    given = with_loading(scene_of(name), force=None, prescribed="hertz", radius=5e-6, p0=p0)
    assert kind_of(given.model_copy(update={"counterbody": None})) == kind


def test_table_names_method_cells_time_and_origin():
    yielding = at_ratio(STEEL_SPHERE, 3.0)
    found = advice_of(yielding, (SAM, FEM, FEM_3D), ROWS)
    assert "case work-precision" in found["words"] and "largest plastic strain" in found["words"]
    assert "cells in the contact radius, load steps, processor time (about)" in found["words"]
    assert found["table"]["columns"] == ["error", "method", "cells", "steps", "time", "ratio"]
    assert found["table"]["rows"] == [  # ten steps, five measured; the largest error first
        ["5 %", "sam", "<= 3", "-", "0.2 s", "1"],
        ["1 %", "sam", "8", "15", "0.8 s", "1"],
        ["1 %", "fem-axisymmetric", "11", "15", "3 s", "3.1"],
        ["1 %", "fem-3d", "not reached", "15", "-", "-"],
    ]
    assert json.loads(json.dumps(found))["rows"][2]["seconds"] is None
    by_sam = advice_of(yielding, (SAM,), ROWS)["rows"]
    assert {row["method"] for row in by_sam} == {SAM, LOAD_STEPS}
    elastic = advice_of(with_loading(scene_of("hertz-sphere"), steps=40), (SAM,), ROWS)
    assert elastic["rows"][0]["seconds"] == 0.05  # does not grow with its steps


def test_the_committed_table_covers_every_kind_and_error():
    rows = advice.table()
    assert {row.kind for row in rows} == {problem.kind for problem in PROBLEMS}
    for problem in PROBLEMS:
        own = [row for row in rows if row.kind == problem.kind]
        methods = {ADVISED[method.name] for method in problem.methods if method.name in ADVISED}
        measured = {(row.method, row.error) for row in own if row.method != LOAD_STEPS}
        assert measured == set(product(methods, TARGETS))
        for row in own:
            assert (row.bound == NEVER) == math.isnan(row.seconds)
            assert row.method in (*MODELS, ON_TWO_GRIDS, LOAD_STEPS) and row.bound in ("", "<", NEVER)


def test_plan_is_short_and_in_numbers_the_same(samfem):
    file = SCENES / "plastic-swift-rigid.toml"
    found = plan(load_scene(file))
    assert json.loads(samfem("plan", file, "--json").out) == json.loads(json.dumps(found.content))
    assert (short := samfem("plan", file).out.splitlines()) == str(found).splitlines()
    assert len(short) == 5 + len(found.warnings)
    assert f"sam {found.cells_in_radius:.3g}, 0.3 %" in short[1] and max(map(len, short)) <= 112
    assert (found.error, found.contact["over_yield"]) == (0.003, pytest.approx(4.0, rel=1e-3))


def test_the_expected_contact_is_that_of_hertz_and_of_a_light_rough_contact():
    """An approach is turned into its force; below a plane the share has the slope 2 over p/(E* h')."""
    pressed = scene_of("hertz-ellipse")
    exact = hertz_of(pressed)
    by_approach = {"force": None, "approach": exact["approach_m"]}
    again = hertz_of(with_loading(pressed, **by_approach))
    assert again.pop("force_N") == pytest.approx(pressed.loading.force, rel=1e-9)
    assert again == pytest.approx({name: exact[name] for name in again}, rel=1e-9)
    found = expected_contact(pressed)
    assert found["p0_Pa"] == pytest.approx(exact["p_max_Pa"], rel=1e-6)
    light = expected_contact(with_loading(scene_of("pin-recipe"), force=1e-4))
    over = light["p_nominal_Pa"] / (2 * light["p_spots_Pa"])
    assert light["contact_share"] == pytest.approx(2 * over, rel=1e-3)
    assert not hertz_of(scene_of("coated-sphere")) and not hertz_of(scene_of("rough-patch"))


# growth


CELLS = np.array([1e3, 4e3, 16e3, 64e3])


def test_a_power_is_found():
    exact = fit_power(CELLS, 3e-7 * CELLS**1.2)
    assert (exact.exponent, exact.factor) == pytest.approx((1.2, 3e-7), rel=1e-12)
    assert exact.error < 1e-12 and exact(1e3) == pytest.approx(3e-7 * 1e3**1.2)


def test_a_power_needs_three_points_in_its_range():
    assert fit_power(CELLS, CELLS, first=4e3).first == 4e3
    bent = fit_power(CELLS[:3], CELLS[:3] * [1.0, 1.2, 1.0])
    assert bent.exponent == pytest.approx(1.0)
    assert bent.error == pytest.approx(np.log(1.2) / np.log(4.0) / np.sqrt(3.0))
    few = (CELLS[:2], CELLS[:2]), (CELLS[[0, 1, 1]], CELLS[:3]), (CELLS, CELLS[:3]), (CELLS, CELLS, 1e4)
    wrong = (CELLS, -CELLS), (CELLS, CELLS * [1, 0, 1, 1]), (CELLS, CELLS * np.nan)
    for points in (*few, *wrong):
        with pytest.raises(ValueError, match="x and y"):
            fit_power(*points)


def test_a_process_measures_its_own_memory_and_one_thread():
    """Also after this process had much more memory than it has."""
    idle, before = idle_bytes(SAM), {name: os.environ.get(name) for name in THREADS}
    large = np.ones(40_000_000)
    assert large.nbytes > 2 * idle
    del large
    assert idle_bytes(SAM) < 1.3 * idle  # more than twice as much if it began with that of this process
    assert alone(os.getenv, THREADS[0]) == "1" and {name: os.environ.get(name) for name in THREADS} == before


@pytest.mark.parametrize("model", [SAM, FEM])
def test_a_yielding_body_without_a_load_has_an_estimate(model):
    none = scene(body={"plasticity": SWIFT}, loading={"force": 0.0})
    assert estimates.load_ratio(none, np.zeros(1))[0] == 0.0
    assert np.isfinite(estimates.estimate(none, model).time_s)


def test_back_stresses_count_by_what_they_add_at_one_per_cent():
    """0.01 C_1 + C_2 (1 - exp(-0.01 g))/g over the yield stress, and nothing without any."""
    kinematic = {"modulus": (50e9, 100e9), "recovery": (0.0, 300.0)}
    added = 0.01 * 50 + 100 * (1 - np.exp(-3.0)) / 300
    for law, hardening in ((PERFECT, 0.0), (PERFECT | {"kinematic": kinematic}, added)):
        found = estimates._back_hardening(scene(body={"plasticity": law}), np.array([1e-6, 2e-6]))
        assert found == pytest.approx(hardening, rel=1e-13)


def took(time: float = 1.0, ffts: int = 100, **quantities) -> dict:
    """What a solve took, counted and found."""
    counts = {"ffts": ffts, "step_cuts": max(ffts - 104, 0)}
    found = {"p_max_Pa": 1e9, "p_center_Pa": 1e-3, "contact_spots": None} | quantities
    return {"time": time, "memory": 1e8, "counts": counts, "quantities": found, "tolerance": 1e-4}


@pytest.mark.parametrize(("ffts", "wrong"), [(90, set()), (105, set()), (106, {"counts"}), (107, {"counts"})])
def test_a_count_may_grow_by_two_or_a_twentieth(ffts, wrong):
    pairs = [(took(), took(time, ffts, p_max_Pa=1.1e9, p_center_Pa=2e-3)) for time in (3.0, 1.0, 1.5)]
    row = published_code.row_of(pairs)
    assert (row["time ratio"], row["time ratio of pairs"], row["time [s]"]) == (1.5, "1.00 to 3.00", 1.5)
    assert row["counts"].startswith(f"ffts 100 {ffts - 100:+d}") and row["most different"] == "p_max_Pa"
    assert row["difference"] == pytest.approx(0.1)
    frame = pd.DataFrame([{"sweep": "", "model": ""} | row])
    assert red("published-code", of_frame("published-code", frame)) == wrong


def test_the_scenes_for_the_published_code_are_read_and_can_be_solved():
    for rung in published_code.RUNGS:
        check(parse_scene(rung.text(published_code.ROOT).encode(), rung.file), rung.model)
    with pytest.raises(RuntimeError, match="0 lines of cycles"):
        published_code.Rung("", "hertz-sphere", {"cycles": "2"}).text(published_code.ROOT)
