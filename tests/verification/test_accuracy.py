# SPDX-License-Identifier: MIT
"""Accuracy on demand: what is chosen, how it is refined, what is refused and what is not reached."""

import json

import pytest
from builders import PERFECT, SPHERE, STEEL, scene_text
from made_results import context, red
from pydantic import ValidationError

from sam import choose_grid
from sam.scene import Result, Scene, Status
from verification.cost.accuracy import chosen_scene, first_choice, missed, solve
from verification.cost.plan import plan
from verification.reference.hertz import CircularContact
from verification.runs.models import FEM, SAM, ModelError
from verification.suite.cases.accuracy import CASES, Run, run_of, subjects
from verification.suite.judging import Measured

ELASTIC = {"body": STEEL, "counterbody": SPHERE, "loading": {"force": 0.1}}
YIELDING = ELASTIC | {"body": STEEL | {"plasticity": PERFECT}, "loading": {"force": 0.02, "steps": 1}}


def asked(accuracy: float, tables=YIELDING, **more) -> Scene:
    return Scene(**tables | {"solver": {"accuracy": accuracy} | more})


def in_radius(scene: Scene) -> float:
    """Cells in the contact radius of an elastic sphere."""
    exact = CircularContact(scene.loading.force, SPHERE["radius"], STEEL["young"] / (1 - 0.3**2))
    return exact.contact_radius / choose_grid(scene).hx


def test_the_cells_and_steps_come_from_the_table():
    """More for a smaller error, as its square root; no fewer than three grids can be made of."""
    coarse, fine = (first_choice(asked(accuracy), SAM) for accuracy in (0.05, 0.0125))
    assert coarse.cells == pytest.approx(10.0) and fine.steps > coarse.steps >= 4
    assert fine.cells == pytest.approx(13.3 * (0.003 * 4.5 / 0.0125) ** 0.5, rel=0.02)
    scene = chosen_scene(asked(0.0125), SAM, fine)
    assert scene.solver.accuracy is None and scene.solver.uncertainty and scene.loading.steps == fine.steps
    assert in_radius(scene) == pytest.approx(fine.cells, rel=0.15)
    assert chosen_scene(asked(0.05), FEM, first_choice(asked(0.05), FEM)).fem.cells_per_radius == 10
    assert first_choice(asked(0.05, ELASTIC), SAM).steps == 0


def made(scene: Scene, of_cells: float, of_steps: float) -> Result:
    """Of an error that falls with the square of the cells, and with the load steps."""
    grid = choose_grid(scene)
    strain = 1 + of_cells / grid.nx**2 + of_steps / scene.loading.steps
    values = {"peeq_max": strain, "contact_radius_m": 10 * grid.hx * grid.nx / 40}
    found = {"cells": [grid.nx, grid.ny]}
    return Result(SAM, Status.CONVERGED, values, {}, discretisation=found, cost={"solve_s": 1.0})


def test_it_is_refined_until_its_own_uncertainty_is_small_enough():
    """Errors of 1000/cells^2 and 0.2/steps are more than the table has: two refinements at most."""
    result = solve(asked(0.05), SAM, lambda scene, _: made(scene, 30.0, 0.2))
    found = result.discretisation["accuracy"]
    assert found["reached"] and found["relative"] <= 0.05 and missed(result) == ""
    assert result.uncertainty["peeq_max"]["relative"] == found["relative"]
    assert (
        result.discretisation["cells"][0]
        > choose_grid(chosen_scene(asked(0.05), SAM, first_choice(asked(0.05), SAM))).nx
    )


def test_what_is_not_reached_is_said_with_what_it_would_take():
    """An error that does not fall."""
    calls = []

    def solver(scene, label):
        calls.append(label)
        made_of = made(scene, 30.0, 0.0)
        return Result(**vars(made_of) | {"quantities": made_of.quantities | {"peeq_max": 1 + len(calls) % 3}})

    result = solve(asked(0.05), SAM, solver)
    assert calls.count("the scene itself") == 3 and not result.discretisation["accuracy"]["reached"]
    assert "accuracy 5 % not reached with" in missed(result) and "; try " in missed(result)


def test_no_uncertainty_is_no_accuracy():
    def solver(scene, label):
        return Result(**vars(made(scene, 1.0, 0.0)) | {"cost": {"step_cuts": len(label)}})

    assert "has no uncertainty: load steps were cut" in missed(solve(asked(0.05), SAM, solver))


@pytest.mark.parametrize(
    "tables, words",
    [
        ({"grid": {"cells": (33, 33)}}, "not together with \\[grid\\]"),
        ({"solver": {"accuracy": 0.01, "extrapolate": True}}, "not together with extrapolate"),
        ({"solver": {"accuracy_of": ("peeq_max",)}}, "only together with accuracy"),
        ({"solver": {"accuracy": 0.01, "accuracy_of": ("peak",)}}, "p_max_Pa"),
        ({"solver": {"accuracy": 1e-6}}, 'or in percent, such as "1 %"'),
        ({"solver": {"accuracy": "a little"}}, 'or in percent, such as "1 %"'),
    ],
)
def test_wrong_keys_are_refused(tables, words):
    with pytest.raises(ValidationError, match=words):
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
    content = plan(asked(0.02))["models"][0]
    (stage,) = (each for each in content["stages"] if each["stage"] == "accuracy")
    assert "2 % of peeq_max: begins with" in stage["reason"]


def test_the_command_reaches_it(folder, samfem):
    """The pressure of Hertz to 1 %: the true error is smaller still."""
    (folder / "sphere.toml").write_text(scene_text(add='[solver]\naccuracy = "1 %"\n'))
    samfem("solve", "sphere.toml")
    summary = json.loads((folder / "sphere-sam" / "summary.json").read_text())
    found = summary["discretisation"]["accuracy"]
    assert found["reached"] and found["quantity"] == "p_max_Pa" and found["relative"] <= 0.01
    exact = CircularContact(0.65, SPHERE["radius"], STEEL["young"] / (1 - 0.3**2)).peak_pressure
    assert abs(summary["quantities"]["p_max_Pa"] / exact - 1) < 0.01


def test_the_case_counts_what_is_missed_without_a_word():
    """Of four runs one is reached, one is said not to be, one is refused, one is missed unsaid."""
    good, said = Run("a", 0.05, True, 0.04, 0.01), Run("a", 0.01, False, 0.04, 0.01)
    refused, unsaid = Run("a", 1e-3, refused="no"), Run("a", 0.01, True, 0.009, 0.02)
    found = CASES[0].measure([good, said, refused, unsaid])
    assert found == {"reached": 0.25, "unsaid": 1.0}
    values = {name: Measured(value) for name, value in found.items()}
    assert red("accuracy", values, whole=True) == {"reached", "unsaid"}
    values = {name: Measured(value) for name, value in CASES[0].measure([good]).items()}
    assert red("accuracy", values, whole=True) == set()
    (table,) = CASES[0].tables([good, refused])
    assert [row[2] for row in table.rows] == ["reached", "no"]


def test_the_scenes_of_the_case_have_closed_forms_that_the_quantity_is_of(tmp_path):
    where = context("accuracy", tmp_path)
    own = subjects(where)
    assert len(own) == 10 and all(first_choice(with_accuracy(each.scene), SAM) for each in own)
    run = run_of(where, own[0], 0.05)
    assert run.reached and not run.unsaid and 0.0 < run.error < 0.05


def with_accuracy(scene: Scene) -> Scene:
    return scene.model_copy(update={"solver": scene.solver.model_copy(update={"accuracy": 0.02})})
