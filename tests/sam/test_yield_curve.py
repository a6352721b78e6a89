# SPDX-License-Identifier: MIT
"""Yield curves against values worked out by hand, as both solvers use them."""

import numpy as np
import pytest

from sam.scene import Plasticity
from sam.scene.yield_curve import DepthProfile, Linear, Swift, Tabulated

PAPER = Plasticity(law="swift", B=1780e6, C=4.0, n=0.095)
# 1780 MPa (4 + 1e6 peeq)^0.095 with logarithms: ln 1780 = 7.484369; 0.095 ln 4 = 0.131698, exp(7.616067) =
# 2030.6; and 0.095 times ln 14 = 2.639057, ln 104 = 4.644391, ln 2004 = 7.602900, ln 20004 = 9.903688, ln
# 50004 = 10.819858
BY_HAND = {0.0: 2030.6e6, 1e-5: 2287.2e6, 1e-4: 2767.2e6, 0.002: 3665.2e6, 0.02: 4560.6e6, 0.05: 4975.4e6}


def test_the_law_of_the_paper_by_hand():
    stress = PAPER.curve().stress(np.array(list(BY_HAND)))
    np.testing.assert_allclose(
        stress, list(BY_HAND.values()), rtol=0, atol=0.05e6
    )  # half a unit of the last digit
    assert PAPER.curve() == Swift(1780e6, 4.0, 0.095)
    slope = PAPER.curve().slope(np.array([0.0, 0.002]))  # 0.095 sigma_y 1e6/(4 + 1e6 peeq)
    np.testing.assert_allclose(slope, [0.095e6 / 4 * 2030.6e6, 0.095e6 / 2004 * 3665.2e6], rtol=2e-5)


def test_the_unit_of_strain_is_a_matter_of_alpha():
    """B (C + alpha e)^n with alpha and C divided by 1e6 and B multiplied by 1e6^n is the same law."""
    percent = Plasticity(law="swift", B=1780e6 * 1e6**0.095, C=4e-6, n=0.095, alpha=1.0).curve()
    np.testing.assert_allclose(percent.stress(list(BY_HAND)), PAPER.curve().stress(list(BY_HAND)), rtol=1e-14)


CURVES = [
    PAPER.curve(),
    Swift(945e6, 20.0, 0.121),
    Linear(1e9, 10.5e9),
    Linear(1e9),
    Tabulated((0.0, 0.01, 0.03, 0.05), (1.0e9, 1.5e9, 1.5e9, 1.7e9)),
]


@pytest.mark.parametrize("curve", CURVES, ids=lambda curve: type(curve).__name__)
def test_slope_is_the_derivative(curve):
    """Five-point differences with a step of 1/1000 of the strain: 1e-12, and rounding 1e-13/1e-3."""
    peeq = np.array([[2e-6, 3e-4], [0.004, 0.022]])  # off the corners of the table; any shape
    step = 1e-3 * peeq
    f = [curve.stress(peeq + k * step) for k in (-2, -1, 1, 2)]
    difference = (f[0] - 8 * f[1] + 8 * f[2] - f[3]) / (12 * step)
    np.testing.assert_allclose(curve.slope(peeq), difference, rtol=1e-8, atol=1e-8 * 1e9)


def test_depth_profile_by_hand():
    rows = [(1e-6, 2.0), (3e-6, 1.0)]
    graded, even = (Plasticity(law="perfect", yield_stress=1e9, profile=each) for each in (rows, None))
    profile, bare = graded.depth_profile(), even.depth_profile()
    depths = np.array([0.0, 1e-6, 1.5e-6, 3e-6, 1.0])
    np.testing.assert_allclose(profile(depths), [2.0, 2.0, 1.75, 1.0, 1.0], rtol=1e-15)
    assert bare == DepthProfile() and (bare(depths) == 1.0).all()
    kinks = graded.strength().kinks
    assert kinks.interval(depths).tolist() == [0, 1, 1, 2, 2]
    assert not np.ptp(even.strength().kinks.interval(depths))
