# SPDX-License-Identifier: MIT
"""Correlations of indentation: numbers worked out by hand, Hertz below yield, the exact onset of yield, each
other.
"""

import math

import numpy as np
import pytest
from rounding import close

from verification.reference.hertz import CircularContact, largest_von_mises
from verification.reference.indentation import JacksonGreen, KogutEtsion, onset

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
