# SPDX-License-Identifier: MIT
"""Correlations of indentation: numbers by hand, Hertz below yield, the exact onset of yield."""

import math
from types import SimpleNamespace

import numpy as np
import pytest
from rounding import close

from sam.scene import load_scene
from verification.cases.case import with_keys
from verification.cases.published import published
from verification.reference import hamilton
from verification.reference.hertz import CircularContact, largest_von_mises
from verification.reference.indentation import Ghaednia, JacksonGreen, KogutEtsion, onset, residual_share
from verification.rows import case_files

RADIUS, MODULUS, YIELD = 105e-6, 210e9 / 0.91, 1e9
KE, JG = KogutEtsion(0.3), JacksonGreen(0.3, 0.0088)
STEEL = Ghaednia(100e9 / 0.91, 200e9, 0.3, 750e6, 0.02)


@pytest.mark.parametrize("fit", [KE, JG])
@pytest.mark.parametrize("share", [0.2, 0.9, 1.0])
def test_below_yield_both_are_hertz(fit, share):
    """The same force through the closed form of Hertz: equal to rounding."""
    unit = onset(fit.factor, RADIUS, MODULUS, YIELD)
    hertz = CircularContact(unit.force * fit.load(share), RADIUS, MODULUS)
    assert hertz.approach == close(share * unit.approach, 1e-13)
    assert hertz.area == close(fit.area(share) * unit.area, 1e-13)


@pytest.mark.parametrize("fit", [KE, JG])
def test_first_yield_is_that_of_hertz(fit):
    """max von Mises = Y at p0 = factor Y; the fits round their factors to about 0.2 %."""
    hertz = onset(fit.factor, RADIUS, MODULUS, YIELD)
    assert hertz.peak_pressure == pytest.approx(fit.factor * YIELD, rel=1e-13)
    mises, _ = largest_von_mises(hertz.peak_pressure, hertz.contact_radius, 0.3)
    assert mises == pytest.approx(YIELD, rel=2e-3)


def test_values_worked_out_with_a_calculator():
    """Jackson and Green for Y/E* = 0.0088; digits as written. Kogut and Etsion: 1.03 3^1.425 = 4.9285, 0.93
    3^1.136 = 3.2395, 1.40 110^1.263 = 530.16, 0.94 110^1.146 = 205.38; at w* = 6 the published jumps, 13.23
    to 13.46 in load and 7.12 to 7.33 in area.
    """
    assert JG.factor == pytest.approx(1.6150, abs=1e-4)
    assert JG.load(np.array([6.0, 20.0, 50.0, 110.0])) == pytest.approx([12.99, 63.5, 194.0, 466.0], rel=1e-3)
    # w = 20: B = 0.14 exp(0.2024) = 0.17141, (20/1.9)^B = 1.49716
    assert JG.area(20.0) == pytest.approx(29.943, rel=1e-4)
    w = np.array([3.0, 110.0])
    assert KE.load(w) == pytest.approx([4.9285, 530.16], rel=1e-4)
    assert KE.area(w) == pytest.approx([3.2395, 205.38], rel=1e-4)
    below, above = 6.0, np.nextafter(6.0, 7.0)
    assert KE.load(above) / KE.load(below) - 1.0 == pytest.approx(0.017, abs=1e-3)
    assert KE.area(above) / KE.area(below) - 1.0 == pytest.approx(0.029, abs=1e-3)


def test_bad_input_is_refused():
    for call in (
        lambda: KE.load(111.0),
        lambda: KE.area([-1.0, 2.0]),
        lambda: JG.load(math.nan),
        lambda: JacksonGreen(0.3, 0.0),
        lambda: KogutEtsion(0.6),
        lambda: onset(1.6, -1.0, MODULUS, YIELD),
    ):
        with pytest.raises(ValueError, match=r"must be (<=|>=|finite|0 <=)"):
            call()


def test_what_stays_after_unloading():
    """Worked out by hand: (1 - 8^-0.28) (1 - 8^-0.69) = 0.44135 x 0.76184; nothing at first yield."""
    assert residual_share(8.0) == pytest.approx(0.44135 * 0.76184, rel=1e-4) and residual_share(1.0) == 0.0
    assert np.all(np.diff(residual_share(np.linspace(1.0, 170.0, 50))) > 0.0)
    for bad in (0.99, 170.1):
        with pytest.raises(ValueError, match=r"^w must be"):
            residual_share(bad)


def test_numbers_of_the_public_program():
    """Steel on steel, 750 MPa, 2 %: at d/R = 0.005 a/R = 0.0811 and 39.3 N on a sphere of 1 mm."""
    assert STEEL.area_radius(0.005) == pytest.approx(0.0811, abs=5e-5)
    assert STEEL.load(0.005) * STEEL.modulus * 1e-6 == pytest.approx(39.3, abs=0.05)


def test_first_yield_is_that_of_the_closed_form():
    file = case_files()["first-yield"]
    for take, expected in (claim.take for claim in file.taken):
        mu = float(take.at[0][2]) if take.at else 0.0
        exact = math.sqrt(3.0) / hamilton.largest_von_mises(1.0, 1.0, 0.3, mu)[0][0]
        assert expected.number == pytest.approx(exact, abs=6e-4)


def test_the_fit_under_a_force_is_the_fit_at_its_approach():
    """Approach and radius of the fit at d/R = 0.007, for steel on steel."""
    base = load_scene("verification/scenes/published-sphere.toml")
    steel = with_keys(base, "counterbody", young=200e9, poisson=0.3)
    answer = published.ghaednia(published.ghaednia_depth(published.tangent(steel, 0.02), 0.007))
    assert answer.values["approach"] == pytest.approx(0.007e-3, rel=1e-12, abs=0)
    fit = STEEL.area_radius(0.007) * 1e-3
    assert answer.values["radius"] == pytest.approx(float(fit), rel=1e-12, abs=0)


def test_indentation_counts_resolved_load_steps_within_the_fits_only():
    """Approach 1 to 30 w_c: the first contacts are a few elements, the last beyond w* = 20."""
    scene, w = load_scene("verification/scenes/plastic-perfect.toml"), np.arange(1.0, 31.0)
    unit = published.jackson_green(scene)[1]
    history = {"approach_m": w * unit.approach, "force_N": w * unit.force, "contact_area_m2": w * unit.area}
    found = published.points(scene, SimpleNamespace(tables={"history": history}))
    assert found["w"] == pytest.approx(np.arange(4.0, 22.0))  # sqrt(4/30) > 0.35
    assert found["load"] == pytest.approx(found["w"])
