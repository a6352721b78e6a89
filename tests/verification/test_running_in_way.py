# SPDX-License-Identifier: MIT
"""The case of running-in on a way: each of its gates turns red when a number is wrong."""

from dataclasses import replace

import numpy as np
import pytest
from made_results import red

from sam.scene import Result, Status, load_scene
from verification.cases import all_cases
from verification.cases.running_in.running_in_way import OnWay

CASE = "running-in-way"


def result(applications: int = 30, steps: int = 10, status: Status = Status.CONVERGED, **passes) -> Result:
    """Three passes that remove 6 m3 in all."""
    columns = ("work_J", "friction_mean", "protected_mean", "wear_of_pass_m3", "new_strain_max", "fx_mean_N")
    table = {"pass": [1, 2, 3]} | {name: [0.2] * 3 for name in columns}
    tables = {
        "history": {"step": list(range(steps))},
        "passes": table | {"wear_of_pass_m3": [3.0, 2.0, 1.0]} | passes,
        "surface": {"state": ["peak", "unloaded", "unloaded"], "worn_m": [9.0, 2.0, 1.0]},
    }
    return Result("sam", status, {}, tables, cost={"operator_applications": applications})


def found(**changes) -> OnWay:
    scene = load_scene(f"verification/scenes/{CASE}.toml")
    loading = scene.loading.model_copy(update={"cycles": 3})
    grid = scene.grid.model_copy(update={"cells": (2, 2), "extent": (4.0, 2.0)})
    scene = scene.model_copy(update={"loading": loading, "grid": grid})
    return replace(OnWay(scene, result(), result(applications=20), 0, 0.0), **changes)


def judged(case: OnWay) -> set[str]:
    values = all_cases()[CASE].values(case)
    return red(CASE, {gate.removeprefix(f"{CASE}."): value for gate, value in values.items()}, whole=True)


@pytest.mark.parametrize(
    "gate, wrong",
    [
        ("unconverged", {"rest": result(status=Status.NOT_CONVERGED, applications=20)}),
        ("increments", {"moving": result(applications=51)}),
        ("resumed", {"differing": 1}),
        ("checkpoint", {"growth": 0.2}),
        ("missing", {"moving": result(protected_mean=[0.1, np.nan, 0.1])}),
        ("volume", {"moving": result(wear_of_pass_m3=[3.0, 2.0, 1.1])}),
        ("friction-range", {"moving": result(friction_mean=[0.2, 0.41, 0.2])}),
    ],
)
def test_a_wrong_number_turns_its_gate_red(gate, wrong):
    assert judged(found(**wrong)) == {gate}


def test_right_numbers_hold_every_gate():
    assert judged(found()) == set()
