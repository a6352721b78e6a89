# SPDX-License-Identifier: MIT
"""The case of a given approach: its gates hold, and each turns red for a force that is wrong."""

from dataclasses import replace

import pytest
from made_results import context, red, with_quantities

from verification.cases.plastic.displacement_control import CASES
from verification.runs.models import FEM, SAM

(CASE,) = CASES


@pytest.fixture(scope="module")
def found(tmp_path_factory):
    return CASE.solve(context(CASE.name, tmp_path_factory.mktemp("case")))


def test_both_models_find_the_force(found):
    assert red(CASE.name, CASE.measure(found), whole=True) == set()
    assert len(next(iter(CASE.tables(found))).rows) == 6


@pytest.mark.parametrize(
    ("which", "model", "quantity", "factor", "gates"),
    [
        ("elastic", SAM, "force_N", 1.0003, {"sam-hertz"}),
        ("elastic", FEM, "force_N", 0.999, {"fem-hertz"}),
        ("plastic", SAM, "force_N", 1.01, {"plastic-force"}),
        ("plastic", FEM, "residual_uz_center_m", 0.97, {"plastic-residual"}),
    ],
)
def test_a_wrong_quantity_turns_its_gate_red(found, which, model, quantity, factor, gates):
    results = getattr(found, which)
    wrong = {which: results | {model: with_quantities(results[model], **{quantity: factor})}}
    assert red(CASE.name, CASE.measure(replace(found, **wrong))) == gates


def test_a_force_that_does_not_return_turns_red(found):
    wrong = replace(found, returned=with_quantities(found.returned, force_N=1.0002))
    assert red(CASE.name, CASE.measure(wrong)) == {"returned"}
