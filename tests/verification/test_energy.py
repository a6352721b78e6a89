# SPDX-License-Identifier: MIT
"""Balances of energy: their sums against closed forms, both models on small contacts."""

from dataclasses import replace

import numpy as np
import pytest
from builders import SPHERE, STEEL, scene
from scipy.integrate import quad

from sam.scene import plastic_work
from sam.scene.yield_curve import Linear, Swift, Tabulated
from verification.cases.case import with_loading
from verification.cases.energy.energy import alternating, row
from verification.energy import Balance, along_path, balance_of_fem, balance_of_sam
from verification.runs.models import FEM, FEM_3D, SAM, solve

# --- sums ---------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("peeq", [0.0, 1e-9, 1e-6, 1e-3, 0.2])
@pytest.mark.parametrize(
    ("curve", "rel"),
    [
        (Swift(945e6, 20.0, 0.121), 1e-6),
        (Linear(1e9, 2e10), 1e-13),
        (Tabulated((0.0, 0.1), (1e9, 2e9)), 1e-3),
    ],
)
def test_plastic_work_is_the_integral_of_the_yield_curve(curve, rel, peeq):
    """Swift to 1e-6, over nine decades; polynomials to rounding; a corner to 1e-3."""
    exact, _ = quad(curve.stress, 0.0, peeq, epsabs=0.0, epsrel=1e-13, points=[2e-5, 0.1], limit=500)
    assert plastic_work(curve, np.array([peeq]))[0] == pytest.approx(exact, rel=rel, abs=1e-3 * (rel > 1e-9))


def test_the_work_along_a_path_is_exact_for_straight_parts():
    """Of f = u at two places half the squares, whatever the steps; back again nothing."""
    u = np.array([[0.0, 0.0], [1.0, -0.5], [1.5, 3.0], [0.0, 0.0]])
    assert along_path([u], [u]) == pytest.approx(0.5 * (u**2).sum(axis=1), abs=1e-15)
    assert along_path([u, u], [u, u])[2] == pytest.approx((u[2] ** 2).sum())


# --- refusals, and errors by hand ---------------------------------------------------------------------------


def test_an_elastic_counter_body_and_a_given_pressure_in_space_are_refused():
    elastic = scene(counterbody=SPHERE | STEEL)
    given = scene(loading={"prescribed": "hertz", "p0": 1e9, "radius": 1e-6})
    refused = (balance_of_sam, elastic), (balance_of_fem, elastic, FEM), (balance_of_fem, given, FEM_3D)
    for of_model, of, *model in refused:
        with pytest.raises(ValueError, match="counterbody" if of is elastic else r"loading\.prescribed"):
            of_model(of, *model)


def by_hand() -> Balance:
    """Two cycles; each energy differs from what closes the balance by an amount of its own."""
    return Balance(
        force=np.array([0.0, 2.0, 0.0, 2.0, 0.0]),
        approach=np.array([0.0, 2.0, 1.0, 3.0, 2.0]),
        work=np.array([0.0, 4.0, 3.0, 8.0, 7.0]),
        elastic=np.array([0.0, 2.0, 0.5, 2.5, 0.5]),
        dissipated=np.array([0.0, 1.0, 2.0, 3.0, 4.0]),
        flowed=np.array([0.0, 1.5, 2.0, 4.0, 4.5]),
        beyond=np.array([0.0, 0.1, 0.0, 0.1, 0.0]),
        back=np.array([0.0, 0.25, 0.0, 0.25, 0.0]),
        within=np.array([0.0, 0.2, 0.3, 0.4, 0.4]),
    )


def test_errors_of_a_balance_by_hand():
    one = by_hand()
    assert one.peak == 1 and one.pressing[1] == 2.0
    expected = {"work": 4.0, "dissipated": 4.0, "locked": 0.5, "error-of-cells": 2.4 / 8.0}
    expected |= {"error-of-steps": 0.75 / 8.0, "within-cells": 0.4 / 8.0}
    for contact, more in (
        ("perfect", {"pressing": 0.5}),
        ("alternating", {"cycle": 4.0 / 2.0 - 1.0, "flow": 2.5 / 2.0 - 1.0}),
        ("sliding", {}),
    ):
        found = row(one, contact)
        assert found.pop("balance") == [one]
        assert found == pytest.approx(expected | more)


# --- back-stresses ------------------------------------------------------------------------------------------


@pytest.mark.parametrize("model", [SAM, FEM])
def test_a_cycle_of_a_body_with_back_stresses_dissipates_its_work(model):
    """Of Prager's back-stress that alternates, two cycles; cycles.csv has the same energies."""
    given = with_loading(alternating(4, 3), cycles=2)
    found = balance_of_sam(given) if model == SAM else balance_of_fem(given, model)
    assert found.error_of_cells < (1e-8 if model == FEM else 1e-2)
    ends = np.flatnonzero(found.force == 0)
    dissipated = solve(given, model).tables["cycles"]["dissipated_J"]
    assert dissipated == pytest.approx(np.diff(found.dissipated[ends]), rel=1e-9)
    assert (np.diff(found.dissipated) >= 0).all() and found.back.max() > 0.1 * found.dissipated[-1]
    assert replace(found, back=0.0).error_of_steps > 3 * found.error_of_steps
