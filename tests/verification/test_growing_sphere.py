# SPDX-License-Identifier: MIT
"""The closed form of a sphere that grows in an elasto-plastic body, and the semi-analytical model against
it.
"""

import numpy as np
import pytest
from growing_sphere_checks import LAWS, NU, YOUNG, check_cycled_sphere, check_growing_sphere

from sam.scene import Scene
from verification.reference import misfit_sphere
from verification.reference.misfit_sphere import GrowingSphere

A = 1e-5  # radius in m


def test_radial_elements_meet_the_closed_form_with_second_order():
    check_growing_sphere(misfit_sphere)


def test_rates_with_a_back_stress_meet_the_exact_solution():
    check_cycled_sphere(misfit_sphere)


def test_the_pressure_in_a_ball_is_that_of_an_expanding_cavity():
    """Hill 1950, Ch. 5: the radius of the zone is (e E/((1 - nu) Y))^(1/3) of that of the ball."""
    ball = GrowingSphere(YOUNG, NU, LAWS["perfect"][1], 0.02, 1.0, "ball")
    zone = 6 ** (1 / 3)
    assert ball.zone() == pytest.approx((1.0, zone), abs=2e-4)
    pressure = 2e9 / 3 + 2e9 * np.log(zone)
    assert -ball.radial_stress(np.array([0.0, 0.5, 0.99])) == pytest.approx([pressure] * 3, rel=1e-7)
    assert float(ball.fields(1.0).peeq) == pytest.approx(1 / 30, rel=1e-12)


@pytest.mark.parametrize("profile", ["smooth", "ball", "gauss"])
def test_profiles_have_the_mean_of_their_misfit_strain(profile):
    x, w = np.polynomial.legendre.leggauss(200)
    for end in (0.03, 0.04999, 0.05001, 0.5, 0.99, 1.7):
        local, excess = misfit_sphere.PROFILES[profile](np.array(end))
        inner = min(end, 1.0) if profile == "ball" else end
        at = inner * (x + 1) / 2
        mean = 3 / end**3 * inner / 2 * (misfit_sphere.PROFILES[profile](at)[0] * at**2 * w).sum()
        assert excess == pytest.approx(mean - local, abs=1e-6)


def test_stress_is_that_of_the_radial_fields():
    sphere = GrowingSphere(YOUNG, NU, LAWS["linear"][1], 0.02, A)
    r = 0.8 * A
    deviator, radial = float(sphere.fields(r).deviator), float(sphere.radial_stress(r))
    across = radial + deviator
    assert sphere.stress(0.0, 0.0, r) == pytest.approx([across, across, radial, 0, 0, 0], abs=1.0)
    half = (across + radial) / 2
    s = r / np.sqrt(2)
    assert sphere.stress(s, 0.0, s) == pytest.approx([half, across, half, 0, -deviator / 2, 0], abs=1.0)


@pytest.mark.parametrize("name", ["radius", "misfit", "profile", "nu"])
def test_bad_input_is_named(name):
    good = {"young": YOUNG, "nu": NU, "law": LAWS["linear"][1], "misfit": 0.02, "radius": 1.0}
    with pytest.raises(ValueError, match=name):
        GrowingSphere(**good | {name: "cube" if name == "profile" else -1.0})


def held(**loading):
    return Scene(
        body={
            "young": YOUNG,
            "poisson": NU,
            "plasticity": {"law": "linear", "yield_stress": 1e9, "modulus": 10e9},
        },
        loading={"prescribed": "misfit-sphere", "radius": A, "misfit": 0.02, "surface": "held", **loading},
        solver={"tolerance": 1e-4},
    )
