# SPDX-License-Identifier: MIT
"""The cases of units and symmetries: right on small contacts, and red when one direction, place or unit is
preferred.
"""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from builders import scene as small_scene
from made_results import context, red as red_gates

import sam
from sam.contact import operators as bodies
from sam.kernels.patches import displacement_coefficients
from verification.cases.hertz import symmetries
from verification.cases.hertz.symmetries import (
    LENGTH_FACTOR,
    POWERS,
    YOUNG_FACTOR,
    blunter,
    change,
    contact_of,
    differences,
    scaled,
    scenes,
    turned,
)
from verification.judging import Measured
from verification.runs.models import SAM

CELL = (1e-6, 0.8e-6)


@pytest.fixture(scope="module")
def gap():
    x, y = (np.linspace(-1.0, 1.0, n) for n in (24, 18))
    return 1e-7 * (np.cos(7 * x)[:, None] * np.sin(5 * y + 1) + x[:, None] ** 2 + 0.3 * y)


def red(values: dict[str, float]) -> set[str]:
    return red_gates("symmetries", {name: Measured(value) for name, value in values.items()})


def test_a_rough_contact_turns_and_moves(gap):
    assert red(turned(gap, CELL, 0.02)) == set()


@pytest.mark.parametrize(
    ("weight", "gates"),
    [
        (lambda nx, ny: 1 + 1e-6 * np.arange(nx)[:, None] + 0 * np.arange(ny), {"mirror", "sliding-mirror"}),
        (
            lambda nx, ny: 1 + 1e-6 * np.arange(ny) + 0 * np.arange(nx)[:, None],
            {"quarter-turn", "sliding-mirror-y"},
        ),
    ],
)
def test_a_pressure_that_leans_to_one_side_is_seen(monkeypatch, gap, weight, gates):
    """By a millionth a cell, along x or along y."""

    def leaning(*args):
        found = contact_of(*args)
        return replace(found, pressure=found.pressure * weight(*found.pressure.shape))

    monkeypatch.setattr(symmetries, "contact_of", leaning)
    assert red(turned(gap, CELL, 0.02)) >= gates


def test_a_coefficient_with_a_direction_is_seen(monkeypatch, gap):
    """u_z of a pressure 1e-6 larger along x than along y: nothing but the quarter turn can show it."""

    def preferring(lags, *args, **keys):
        larger = 1 + 1e-6 * (np.arange(lags.nx) > 0)[:, None] * np.ones(lags.ny)
        return displacement_coefficients(lags, *args, **keys) * larger

    monkeypatch.setattr(bodies, "displacement_coefficients", preferring)
    assert red(turned(gap, CELL, 0.02)) == {"quarter-turn"}


def test_a_contact_that_does_not_converge_breaks_off(monkeypatch, gap):
    monkeypatch.setattr(
        symmetries, "solve_contact", lambda *_, **__: SimpleNamespace(converged=False, residual=0.1)
    )
    with pytest.raises(RuntimeError, match="did not converge"):
        contact_of(gap, CELL, 0.02)


def test_scaled_scenes_are_the_same_problem_in_other_units(tmp_path):
    """Every stress and length of the body, the grid and the load."""
    (_, scene, other, factors), (_, _, similar, _), _ = scenes(context("symmetries", tmp_path), SAM)
    assert other == scaled(scene, YOUNG_FACTOR, 3.1e4)
    assert factors["p_max_Pa"] == YOUNG_FACTOR and factors["contact_area_m2"] == LENGTH_FACTOR**2
    ratios = (
        other.body.plasticity.yield_stress / scene.body.plasticity.yield_stress,
        other.body.young / scene.body.young,
    )
    assert ratios == pytest.approx((YOUNG_FACTOR, YOUNG_FACTOR))
    assert np.array(other.grid.depths) == pytest.approx(3.1e4 * np.array(scene.grid.depths))
    assert similar == blunter(scene, symmetries.BLUNTER) and similar.loading == scene.loading
    assert similar.body.plasticity == scene.body.plasticity


def test_a_quantity_that_does_not_scale_turns_its_gate_red():
    base, other = (SimpleNamespace(quantities={"p_max_Pa": 2.0 * f, "approach_m": 3.0}) for f in (1.0, 7.0))
    factors = {"p_max_Pa": 7.0, "approach_m": 1.0}
    assert differences(base, other, factors) == 0.0
    wrong = SimpleNamespace(quantities={**other.quantities, "approach_m": 3.0 * (1 + 1e-7)})
    assert red({"sam-units": differences(base, wrong, factors)}) == {"sam-units"}
    assert red({"sam-similarity": differences(base, wrong, factors)}) == {"sam-similarity"}
    assert change(np.array([1.0, 2.0]), np.array([1.0, 4.0])) == 0.5


@pytest.mark.parametrize(("factor", "held"), [(1.0, True), (1.0 + 1e-8, False)])
def test_a_stress_that_is_not_quite_scaled_turns_the_gate_of_the_digits_red(factor, held):
    """A modulus wrong by 1e-8 in the other units: the digits gate is above rounding, and far below any unit
    forgotten.
    """
    scene = small_scene(loading={"force": 0.17}, grid={"cells": (17, 17)})
    other = scaled(scene, YOUNG_FACTOR, LENGTH_FACTOR)
    wrong = other.body.model_copy(update={"young": other.body.young * factor})
    again = sam.solve(other.model_copy(update={"body": wrong}))
    powers = {name: each for name, each in POWERS.items() if name != "peeq_max"}
    factors = {name: YOUNG_FACTOR**p * LENGTH_FACTOR**q for name, (p, q) in powers.items()}
    assert (red({"sam-units": differences(sam.solve(scene), again, factors)}) == set()) is held
