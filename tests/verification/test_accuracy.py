# SPDX-License-Identifier: MIT
"""Accuracy on demand: what is chosen, how it is refined, what is refused and what is not reached."""

import json

import pytest
from builders import MODULUS, PERFECT, RADIUS, SPHERE, STEEL, scene_text

from sam import choose_grid
from sam.scene import Result, Scene, SceneError, Status
from verification.cost import accuracy
from verification.cost.accuracy import Choice, chosen_scene, expected, first_choice, missed, solve
from verification.cost.advice import table
from verification.cost.plan import plan
from verification.reference.hertz import CircularContact
from verification.runs.models import FEM, SAM, ModelError

ELASTIC = {"body": STEEL, "counterbody": SPHERE, "loading": {"force": 0.1}}
YIELDING = ELASTIC | {"body": STEEL | {"plasticity": PERFECT}, "loading": {"force": 0.02, "steps": 1}}


def asked(accuracy: float, tables=YIELDING, **more) -> Scene:
    return Scene(**tables | {"solver": {"accuracy": accuracy} | more})


def test_the_cells_and_steps_come_from_the_table():
    """More for a smaller error, as its square root; no fewer than three grids can be made of."""
    coarse, fine = (expected(asked(each), SAM) for each in (0.05, 0.0125))
    assert coarse.cells == pytest.approx(4.2 * 1.4**2) and fine.steps >= coarse.steps == 6
    (row,) = (each for each in table() if (each.kind, each.method, each.error) == ("yielding", SAM, 0.003))
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
    summary = json.loads((folder / "sphere-sam" / "summary.json").read_text())
    found = summary["discretisation"]["accuracy"]
    assert found["reached"] and found["quantity"] == "p_max_Pa" and found["relative"] <= 0.01
    exact = CircularContact(0.65, RADIUS, MODULUS).peak_pressure
    assert abs(summary["quantities"]["p_max_Pa"] / exact - 1) < 0.01
