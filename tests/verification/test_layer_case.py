# SPDX-License-Identifier: MIT
"""The cases of a layer with a law of its own: each of their gates turns red when a result is wrong.

Both models are played by FEM on a coarse mesh: every difference is zero, until one of them is changed.
"""

import numpy as np
import pytest
from made_results import context, red, with_column, with_quantities

from verification.cases import all_cases
from verification.cases.case import with_keys, with_mesh
from verification.runs import models
from verification.runs.models import FEM

CASE = "plastic-layer-swift"
FORGOTTEN = "without the layer"


@pytest.fixture(scope="module")
def results(tmp_path_factory):
    """Name of a run -> result; one of a solver that forgot the layer besides."""
    solved, solver = {}, context(CASE, tmp_path_factory.mktemp("scene"))

    def solve(model, scene, label):
        solved[label] = models.solve(with_mesh(scene, 8), FEM)
        return solved[label]

    solver.solve = solve
    scene = all_cases()[CASE].solve(solver).scene
    bare = with_keys(scene, "body.plasticity", layer=None)
    return solved | {FORGOTTEN: models.solve(with_mesh(bare, 8), FEM)}


def judged(results, tmp_path, changed=None) -> set[str]:
    """The red gates where some runs give another result."""
    given, case = results | (changed or {}), all_cases()[CASE]
    solver = context(CASE, tmp_path)
    solver.solve = lambda model, scene, label: given[label]
    return red(CASE, case.measure(case.solve(solver)), whole=True)


def scaled_in(layer: bool, thickness=3e-6):
    """Plastic strain 2.5 % too large on one side of the lower side of the layer."""

    def change(result):
        z = np.asarray(result.tables["plane"]["z_m"])
        return with_column(
            result, "plane", "peeq", lambda peeq: peeq * np.where((z < thickness) == layer, 1.025, 1.0)
        )

    return change


def one_bit(values):
    return np.nextafter(values, np.inf)


def test_equal_results_hold_every_gate(results, tmp_path):
    assert judged(results, tmp_path) == set()


@pytest.mark.parametrize(
    "gates, label, wrong",
    [
        ("strain-layer", "sam", scaled_in(True)),
        ("strain-below", "sam", scaled_in(False)),
        ("p-max", "sam", lambda result: with_quantities(result, p_max_Pa=1.0065)),
        ("approach", "sam", lambda result: with_quantities(result, approach_m=1.0065)),
        ("same-law-sam", "sam-same-law", lambda result: with_column(result, "line", "p_Pa", one_bit)),
        ("same-law-fem", "fem-same-law", lambda result: with_column(result, "line", "p_Pa", one_bit)),
    ],
)
def test_a_wrong_answer_turns_its_gate_red(results, tmp_path, gates, label, wrong):
    """A quarter beyond the tolerance, or the last bit of one column."""
    assert judged(results, tmp_path, {label: wrong(results[label])}) == {gates}


def test_a_solver_that_forgets_the_layer_is_seen(results, tmp_path):
    assert {"strain-layer", "strain-below"} <= judged(results, tmp_path, {"sam": results[FORGOTTEN]})


def test_both_cases_run_at_the_quick_level():
    assert all("quick" in all_cases()[name].levels for name in (CASE, "plastic-layer-linear"))
