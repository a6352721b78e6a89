# SPDX-License-Identifier: MIT
"""Correlations of indentation: numbers worked out by hand, Hertz below yield, the exact onset of yield, each
other.
"""

import math

import numpy as np
import pytest
from made_results import Made, red
from rounding import close

from verification.cases.published import published
from verification.reference import hamilton
from verification.reference.hertz import CircularContact, largest_von_mises
from verification.reference.indentation import Ghaednia, JacksonGreen, KogutEtsion, onset, residual_share

RADIUS, MODULUS, YIELD = 105e-6, 210e9 / 0.91, 1e9
KE, JG = KogutEtsion(0.3), JacksonGreen(0.3, 0.0088)


@pytest.mark.parametrize("fit", [KE, JG])
@pytest.mark.parametrize("share", [0.2, 0.9, 1.0])
def test_below_yield_both_are_hertz(fit, share):
    """The same force through the closed form of Hertz: equal to rounding."""
    unit = onset(fit.factor, RADIUS, MODULUS, YIELD)
    hertz = CircularContact(unit.load * fit.load(share), RADIUS, MODULUS)
    assert hertz.approach == close(share * unit.approach, 1e-13)
    assert math.pi * hertz.contact_radius**2 == close(fit.area(share) * unit.area, 1e-13)


@pytest.mark.parametrize("fit", [KE, JG])
def test_first_yield_is_that_of_hertz(fit):
    """max von Mises = Y at p0 = factor Y; the fits round their factors to about 0.2 %."""
    hertz = CircularContact(onset(fit.factor, RADIUS, MODULUS, YIELD).load, RADIUS, MODULUS)
    assert hertz.peak_pressure == pytest.approx(fit.factor * YIELD, rel=1e-13)
    mises, _ = largest_von_mises(hertz.peak_pressure, hertz.contact_radius, 0.3)
    assert mises == pytest.approx(YIELD, rel=2e-3)


def test_values_of_jackson_and_green():
    """Worked out with a calculator for Y/E* = 0.0088; digits as written."""
    assert JG.factor == pytest.approx(1.6150, abs=1e-4)
    assert JG.load(np.array([6.0, 20.0, 50.0, 110.0])) == pytest.approx([12.99, 63.5, 194.0, 466.0], rel=1e-3)
    # w = 20: B = 0.14 exp(0.2024) = 0.17141, (20/1.9)^B = 1.49716
    assert JG.area(20.0) == pytest.approx(29.943, rel=1e-4)


def test_values_of_kogut_and_etsion():
    """1.03 3^1.425 = 4.9285, 0.93 3^1.136 = 3.2395; 1.40 110^1.263 = 530.1, 0.94 110^1.146 = 205.4."""
    assert KE.load(3.0) == pytest.approx(4.9285, rel=1e-4) and KE.area(3.0) == pytest.approx(3.2395, rel=1e-4)
    assert KE.load(110.0) == pytest.approx(530.1, rel=1e-3) and KE.area(110.0) == pytest.approx(
        205.4, rel=1e-3
    )


def test_jumps_of_kogut_and_etsion_are_the_published_ones():
    """At w* = 6: 13.23 to 13.46 in load, 7.12 to 7.33 in area; nothing is smoothed away."""
    below, above = 6.0, np.nextafter(6.0, 7.0)
    assert KE.load(above) / KE.load(below) - 1.0 == pytest.approx(0.017, abs=1e-3)
    assert KE.area(above) / KE.area(below) - 1.0 == pytest.approx(0.029, abs=1e-3)


def test_mean_pressure_rises_from_first_yield():
    """P/A = (2/3) C Y = 1.077 Y at first yield, growing with w*; the load ends as 4 H_G/(C Y) w*, H_G = 2.84
    Y.
    """
    fit, w = JacksonGreen(0.3, 1e-9), np.array([1.0, 5.0, 20.0, 80.0])  # a/R stays small: H_G does not fall
    mean = 2.0 / 3.0 * fit.factor * fit.load(w) / fit.area(w)
    assert np.all(np.diff(mean) > 0.0) and mean[0] == pytest.approx(1.077, rel=1e-3)
    assert fit.load(1e7) / 1e7 == pytest.approx(4.0 * 2.84 / 1.6150, rel=1e-4)


def test_the_two_fits_agree_where_both_are_used():
    """Within 5 % to w* = 20, the tolerance of the verification case; 14 % apart at 110."""
    w = np.linspace(2.0, 20.0, 50)
    assert np.max(np.abs(KE.load(w) / JG.load(w) - 1.0)) < 0.05
    assert np.max(np.abs(KE.area(w) / JG.area(w) - 1.0)) < 0.05
    assert KE.load(110.0) / JG.load(110.0) - 1.0 == pytest.approx(0.14, abs=0.01)


def test_bad_input_is_refused():
    for call in (
        lambda: KE.load(111.0),
        lambda: KE.area([-1.0, 2.0]),
        lambda: JG.load(math.nan),
        lambda: JacksonGreen(0.3, 0.0),
        lambda: KogutEtsion(0.6),
        lambda: onset(1.6, -1.0, MODULUS, YIELD),
    ):
        with pytest.raises(ValueError):
            call()


def test_what_stays_after_unloading():
    """Worked out by hand: (1 - 8^-0.28) (1 - 8^-0.69) = 0.44135 x 0.76184; nothing at first yield."""
    assert residual_share(8.0) == pytest.approx(0.44135 * 0.76184, rel=1e-4) and residual_share(1.0) == 0.0
    assert np.all(np.diff(residual_share(np.linspace(1.0, 170.0, 50))) > 0.0)
    for bad in (0.99, 170.1):
        with pytest.raises(ValueError, match=r"^w must be"):
            residual_share(bad)


class TestHardening:
    STEEL = Ghaednia(100e9 / 0.91, 200e9, 0.3, 750e6, 0.02)

    def test_numbers_of_the_public_program(self):
        """Steel on steel, 750 MPa, 2 %: at d/R = 0.005 a/R = 0.0811 and 39.3 N on a sphere of 1 mm."""
        assert self.STEEL.area_radius(0.005) == pytest.approx(0.0811, abs=5e-5)
        assert self.STEEL.load(0.005) * self.STEEL.modulus * 1e-6 == pytest.approx(39.3, abs=0.05)

    def test_no_hardening_is_the_area_of_jackson_and_green(self):
        none = Ghaednia(MODULUS, 210e9, 0.3, YIELD, 1e-12)
        w = np.array([5.0, 20.0])
        d = w * none.first.approach
        assert math.pi * none.area_radius(d) ** 2 / none.first.area == pytest.approx(
            none.perfect.area(w), rel=1e-6
        )
        # its hardness is another fit to the same results
        assert none.load(d) * MODULUS / none.first.load == pytest.approx(none.perfect.load(w), rel=0.02)

    def test_hardening_carries_more_on_less_area(self):
        d = 20 * self.STEEL.first.approach
        harder = Ghaednia(100e9 / 0.91, 200e9, 0.3, 750e6, 0.1)
        assert harder.load(d) > self.STEEL.load(d) and harder.area_radius(d) < self.STEEL.area_radius(d)


class TestPublishedCases:
    def test_what_stays_is_red_when_it_is_off(self):
        w, first = 8.0, onset(KE.factor, RADIUS, MODULUS, YIELD)

        def found(sam, fem):
            approach = w * first.approach
            results = {
                name: Made(
                    {
                        "approach_m": approach,
                        "residual_uz_center_m": float(off * residual_share(w)) * approach,
                    }
                )
                for name, off in (("SAM", sam), ("FEM", fem))
            }
            return published.Unloaded(None, first, {8: results})

        case = published.CASES[0]
        assert red(case.name, case.measure(found(0.98, 0.985))) == set()
        assert red(case.name, case.measure(found(0.965, 0.985))) == {"sam-8", "between-8"}
        assert red(case.name, case.measure(found(1.031, 1.031))) == {"sam-8", "fem-8"}

    def test_hardening_is_red_when_it_is_off(self):
        one, case = published.SETS[0], published.CASES[1]

        def found(approach, radius):
            fit = float(one.fit.area_radius(one.depth))
            values = {"approach_m": approach * one.depth, "contact_radius_m": radius * fit}
            return {one: {"SAM": Made({name: value * published.RADIUS for name, value in values.items()})}}

        assert red(case.name, case.measure(found(0.98, 1.04))) == set()
        wrong = {"sam-steel-approach", "sam-steel-radius"}
        assert red(case.name, case.measure(found(0.96, 1.06))) == wrong

    def test_first_yield_is_that_of_the_closed_form(self):
        for mu, number in published.FIRST.items():
            exact = math.sqrt(3.0) / hamilton.largest_von_mises(1.0, 1.0, 0.3, mu)[0][0]
            assert number == pytest.approx(exact, abs=6e-4)
        case = published.CASES[2]
        for factor, wrong in ((0.999, set()), (1.003, {"sam-01"})):
            largest = factor * published.FIRST[0.1] / math.sqrt(3.0)
            result = Made({"p_max_Pa": largest, "mises_max_Pa": 1.0})
            assert red(case.name, case.measure({("SAM", 0.1): result})) == wrong
