# SPDX-License-Identifier: MIT
"""A sphere that grows in an elasto-plastic body: closed form, a period of it, what its cases measure."""

from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest
from made_results import context
from scipy.integrate import solve_ivp

from verification.cases.cyclic import misfit_cycles
from verification.cases.plastic.misfit_images import CELLS as IMAGE_CELLS, NAMES, images
from verification.cases.plastic.misfit_sphere import l2, law, means_of_cells, order_of_half, second_order
from verification.reference import misfit_sphere
from verification.reference.misfit_sphere import GrowingSphere
from verification.references import growing_sphere
from verification.rows import load_rows

YOUNG, NU = 210e9, 0.3
A = 1e-5  # radius in m


def perfect(peeq):
    return 1e9 + 0 * peeq


def linear(peeq):
    return 1e9 + 10e9 * peeq


def test_rates_with_a_back_stress_meet_the_exact_solution():
    """With a back-stress and constant yield stress, growing and shrinking: against the rates at a radius,
    integrated from where it begins to yield. They follow from D = x +- Y, the law of x and equilibrium.
    """
    yields, compliance, r = 1e9, (1 - NU) / YOUNG, np.array([0.6, 1.0, 1.255, 2.0])
    for modulus, recovery in ((160e9, 0.0), (160e9, 90.0), (40e9, 300.0)):
        law, shares = perfect, (1.0, 0.0) * 3
        sphere = GrowingSphere(YOUNG, NU, law, 0.07, 1.0, "gauss", shares, modulus, recovery)
        found = np.array([(each.plastic, each.peeq) for each in sphere.history(r)])
        for k, excess in enumerate(0.07 * misfit_sphere.gauss(r)[1]):
            q = peeq = back = share = 0.0
            for number, end in enumerate(shares):
                sign = 1.0 if end > share else -1.0
                begin = (q + compliance * (back + sign * yields)) / excess
                if sign * (end - begin) > 0:

                    def rates(_, state, law=(modulus, recovery), sign=sign, excess=excess):
                        slope = 2 * (law[0] - law[1] * sign * state[1])
                        rate = excess / (1 + compliance * slope)
                        return rate, slope * rate, 2 * sign * rate

                    way = begin, end
                    ends = solve_ivp(rates, way, (q, back, peeq), rtol=1e-11, atol=(1e-16, 1e-3, 1e-16))
                    q, back, peeq = ends.y[:, -1]
                share = end
                assert np.abs(found[number, :, k] - (q, peeq)).max() < 1e-11, (modulus, recovery, number)


def test_the_pressure_in_a_ball_is_that_of_an_expanding_cavity():
    """Hill 1950, Ch. 5: the radius of the zone is (e E/((1 - nu) Y))^(1/3) of that of the ball."""
    ball = GrowingSphere(YOUNG, NU, perfect, 0.02, 1.0, "ball")
    zone = 6 ** (1 / 3)
    assert ball.zone() == pytest.approx((1.0, zone), abs=2e-4)
    pressure = 2e9 / 3 + 2e9 * np.log(zone)
    assert -ball.radial_stress(np.array([0.0, 0.5, 0.99])) == pytest.approx([pressure] * 3, rel=1e-7)
    assert float(ball.fields(1.0).peeq) == pytest.approx(1 / 30, rel=1e-12)
    # the integral of 2 (1 - nu) Y/E (c^3/r^3 - 1) from the ball to c, c^3 = 6
    assert ball.total() == pytest.approx(8 * np.pi / 300 * (6 * np.log(zone) - 5 / 3), rel=1e-4)


@pytest.mark.parametrize("name", ["radius", "misfit", "profile", "nu"])
def test_bad_input_is_named(name):
    good = {"young": YOUNG, "nu": NU, "law": linear, "misfit": 0.02, "radius": 1.0}
    with pytest.raises(ValueError, match=name):
        GrowingSphere(**good | {name: "cube" if name == "profile" else -1.0})


# cases of a sphere that grows


def test_the_exact_solution_of_a_period_is_that_of_the_closed_form():
    """A sphere that comes and goes twice: what the second period adds at the radius of the largest strain."""
    solver = context("misfit-cycles", Path(), "full")
    scene = misfit_cycles.above_limit(solver.scene("misfit-sphere"), (0.2, 90.0))
    loading = scene.loading.model_copy(update={"profile": "gauss", "cycles": 2})
    scene = scene.model_copy(update={"loading": loading})
    r = misfit_cycles.REACHES * loading.radius
    assert growing_sphere(scene).shares == (1.0,)  # it is put on alone
    _, once, _, twice = growing_sphere(scene, (1.0, 0.0) * 2).history(r)
    exact = misfit_cycles.cycled_sphere(scene).values
    assert exact["peeq"] == pytest.approx([(twice.peeq - once.peeq).max()], rel=1e-12)
    assert exact["strain"] == pytest.approx([np.abs(2 * (twice.plastic - once.plastic)).max()], rel=1e-12)


# errors of the case, and coefficients of the images


CASE = "misfit-sphere"


def test_the_order_of_two_sizes_and_the_error_of_second_order():
    errors = pd.DataFrame({"total": [-4e-3, 1e-3, 3e-4], "sphere-cells": [6, 8, 12]})
    assert second_order(errors, "total") == pytest.approx(0.144, rel=1e-12)
    assert order_of_half(pd.DataFrame({"l2": [0.012, 0.002]}), "l2") == pytest.approx(np.log2(6.0), rel=1e-12)


def test_a_strain_that_is_one_percent_too_large_is_off_by_that():
    scene = law(context(CASE, Path()).scene(CASE), "linear")
    x = np.linspace(-1.0, 1.0, 7) * scene.loading.radius
    box = SimpleNamespace(x=x, y=x, z=x + scene.loading.depth, cell_data={})
    result = SimpleNamespace(grids={"peak": {"body": box}})
    box.cell_data["peeq"] = 1.01 * means_of_cells(scene, result)
    assert l2(scene, result, None) == pytest.approx(0.01, rel=1e-9)


def test_each_coefficient_of_the_image_that_is_1_percent_off_turns_its_gate_red():
    """All 36 of the stress and 6 of the displacement, in either sense."""
    scene = context(CASE, Path()).scene(CASE)
    found = images(growing_sphere(law(scene, "linear")), IMAGE_CELLS)
    tolerances = {gate.id: gate.tolerance for gate in load_rows()}
    gated = [{"yy": "xx", "yz": "xz"}.get(name, name) for name in (*NAMES, "raised")]
    limits = np.array([tolerances[f"{CASE}.sam-image-{name}"] for name in gated])
    assert (found.left() < limits).all()
    for off in 0.01 * np.vstack([np.eye(6), -np.eye(6)]):
        assert (found.left(1 + off) > limits).all()
