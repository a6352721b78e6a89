# SPDX-License-Identifier: MIT
"""The regimes of the running-in cases, against independent answers."""

from math import sqrt

import numpy as np
import pytest
from made_studies import SCENES
from scipy.integrate import solve_ivp

from verification.cases.running_in.study import BULK, DUCTILE, HARDENING, A, B, with_constant
from verification.compare.running_in_measures import Limits
from verification.reference.bonded_film import (
    Regime,
    film_pressure,
    in_plane_strain,
    largest_pressure,
    regime,
    swift,
    tear_pressure,
    thinning,
)

FILM, BODY = (80e9, 0.3, 2e9 / 3), (210e9, 0.3)


def rate_integrated(p: float, mu: float) -> float:
    """Thinning under proportional p and mu p, strain -0.26 p/E: the rate equations of a perfectly plastic
    film.

    Unknown: s = sxx = syy. On the yield surface the deviator n is normal to it; d(strain) = elastic + lambda
    n in xx, and the consistency of the von Mises stress gives ds.
    """
    (young, nu, _), onset = FILM, onset_of_yield(mu)

    def rate(t: float, state: np.ndarray) -> list[float]:
        s, _ = state
        tau = mu * t
        ds = -1.0 - 3.0 * mu * tau / (s + t)  # (s + t)^2 + 3 tau^2 = sy^2, differentiated
        elastic = ((1 - nu) * ds + nu) / young
        return [ds, -2.0 * (-0.26 / BODY[0] - elastic)]  # ezz = -(exx + eyy) of the plastic strain

    start = [onset * elastic_slope(), 0.0]
    return -float(solve_ivp(rate, (onset, p), start, rtol=1e-11, atol=[1.0, 1e-15]).y[1, -1])


def elastic_slope() -> float:
    """sxx/p of the elastic film, Hooke's law with szz = -p and the strain of the body."""
    return (-0.26 * FILM[0] / BODY[0] - 0.3) / 0.7


def onset_of_yield(mu: float) -> float:
    """Pressure at which the elastic film yields: p sqrt((1 + sxx/p)^2 + 3 mu^2) = sy."""
    return FILM[2] / sqrt((1 + elastic_slope()) ** 2 + 3 * mu**2)


class TestRegime:
    @pytest.mark.parametrize("p", [2e9, 3e9, 3.8e9])
    def test_thinning_with_friction_is_that_of_the_rate_equations(self, p):
        """Integrated to 1e-11; 1e-8 leaves room for its steps. A friction of 0.11 is noticed."""
        e = in_plane_strain(p, *BODY)
        assert thinning(p, 0.1, e, FILM) == pytest.approx(rate_integrated(p, 0.1), rel=1e-8)
        assert thinning(p, 0.095, e, FILM) != pytest.approx(rate_integrated(p, 0.1), rel=1e-3)

    def test_film_fails_where_it_thins_by_the_limit_or_has_no_equilibrium(self):
        for mu in (0.0, 0.05, 0.1):
            p = film_pressure(0.0204, mu, FILM, BODY)
            assert thinning(p, mu, in_plane_strain(p, *BODY), FILM) == pytest.approx(0.0204, rel=1e-7)
        largest = largest_pressure(FILM[2], 0.1)
        assert film_pressure(0.5, 0.1, FILM, BODY) == largest == pytest.approx(3.849e9, rel=1e-4)
        assert thinning(3.85e9, 0.1, -1e-3, FILM) == np.inf

    def test_removal_is_von_mises_of_the_traction_alone(self):
        """sqrt(3) mu p = sigma_y."""
        p = tear_pressure(2.0522895e9, 0.4)
        assert sqrt(3 * (0.4 * p) ** 2) == pytest.approx(2.0522895e9, rel=1e-14)
        assert swift(1780e6, 4, 0.095, 0.0) == pytest.approx(2030.6e6, rel=1e-4)
        assert [regime(each, 3.4e9, 5.3e9) for each in (3e9, 4e9, 6e9)] == list(Regime)

    @pytest.mark.parametrize(
        ("case", "removal", "softer"),
        [
            (BULK, 5.29, 3.80),
            (A, 5.27, 3.79),
            (B, 2.96, 2.13),
            (DUCTILE, 3.23, 2.32),
            (HARDENING, 9.87, 7.10),
        ],
    )
    def test_pressures_that_remove_metal_in_the_five_cases(self, case, removal, softer):
        """Three digits, as they are known."""
        limits, other = (Limits.of(each) for each in (SCENES[case], with_constant(SCENES[case], 1280e6)))
        assert (limits.removal / 1e9, other.removal / 1e9) == pytest.approx((removal, softer), abs=5e-3)
        assert limits.film == other.film
        if case == BULK:
            assert limits.strength == pytest.approx(swift(1780e6, 4, 0.095, 0.002), rel=1e-12)

    def test_bad_numbers_are_refused_by_name(self):
        for wrong, name in (((-1.0, 0.4), "strength"), ((1e9, 0.0), "friction"), ((np.nan, 0.4), "strength")):
            with pytest.raises(ValueError, match=name):
                tear_pressure(*wrong)
