# SPDX-License-Identifier: MIT
"""Shakedown limits of a travelling load by the smallest ball about its stresses."""

import numpy as np
import pytest

from verification.reference.hamilton import sliding_stress
from verification.reference.shakedown import smallest_ball, travelling_limit


def shear_limit(friction):
    """1/max|s_xz/p0| in y = 0."""
    x, z = np.meshgrid(np.linspace(-1.5, 1.5, 301), np.linspace(0.0, 1.0, 101), indexing="ij")
    stress = sliding_stress(x, 0.0, z, 1.0, contact_radius=1.0, nu=0.3, friction=friction)
    return 1 / np.abs(stress[..., 4]).max()


def test_ball_of_a_simplex():
    """Corners of a cube's half: a triangle that is right-angled lies in the ball of its longest side."""
    centre, radius = smallest_ball(np.array([[0.0, 0, 0], [2, 0, 0], [0, 2, 0], [0.5, 0.5, 0]]))
    assert centre == pytest.approx([1, 1, 0], abs=1e-6) and radius == pytest.approx(np.sqrt(2), rel=1e-6)


def test_without_friction_the_limit_is_that_of_the_largest_shear():
    """Both signs of the largest s_xz lie on the ball, on either side of its centre."""
    limit, _ = travelling_limit(0.0, depths=np.array([0.35]))
    assert limit == pytest.approx(shear_limit(0.0), rel=1e-3)


def test_alternating_traction_lowers_the_limit_to_the_largest_shear():
    limit, _ = travelling_limit(0.2, alternates=True, depths=np.array([0.3]))
    assert limit == pytest.approx(shear_limit(0.2), rel=1e-3)
