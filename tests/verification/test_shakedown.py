# SPDX-License-Identifier: MIT
"""Shakedown limits of a travelling load by the smallest ball about its stresses."""

import numpy as np
import pytest

from verification.reference.hamilton import sliding_stress
from verification.reference.shakedown import cell_limit, in_place_limit, smallest_ball, travelling_limit
from verification.reference.stress import von_mises


def shear_limit(friction):
    """1/max|s_xz/p0| in y = 0."""
    x, z = np.meshgrid(np.linspace(-1.5, 1.5, 301), np.linspace(0.0, 1.0, 101), indexing="ij")
    stress = sliding_stress(x, 0.0, z, 1.0, contact_radius=1.0, nu=0.3, friction=friction)
    return 1 / np.abs(stress[..., 4]).max()


def test_ball_of_a_simplex():
    """Corners of a cube's half: a triangle that is right-angled lies in the ball of its longest side."""
    centre, radius = smallest_ball(np.array([[0.0, 0, 0], [2, 0, 0], [0, 2, 0], [0.5, 0.5, 0]]))
    assert centre == pytest.approx([1, 1, 0], abs=1e-6) and radius == pytest.approx(np.sqrt(2), rel=1e-6)


@pytest.mark.parametrize(("friction", "alternates", "depth"), [(0.0, False, 0.35), (0.2, True, 0.3)])
def test_the_limit_is_that_of_the_largest_shear(friction, alternates, depth):
    """Without friction, or with traction that alternates, both signs of the largest s_xz lie on the ball."""
    limit, _ = travelling_limit(friction, alternates=alternates, depths=np.array([depth]))
    assert limit == pytest.approx(shear_limit(friction), rel=1e-3)


def test_in_place_the_limit_is_twice_first_yield():
    """First yield at 1.6128 yield stresses for nu = 0.3; friction moves the worst point off the axis."""
    limit, depth = in_place_limit(0.0)
    assert limit == pytest.approx(2 * 1.6128 * np.sqrt(3), rel=1e-4)
    assert depth == pytest.approx(0.48, abs=0.01)
    assert in_place_limit(0.2)[0] == pytest.approx(1 / first_yield(0.2) * 2, rel=1e-3)


def first_yield(friction):
    """Largest sqrt(J2)/p0 in y = 0, on a grid of its own."""
    x, z = np.meshgrid(np.linspace(-1, 1, 201), np.linspace(0.1, 1.0, 181), indexing="ij")
    stress = sliding_stress(x, 0.0, z, 1.0, contact_radius=1.0, nu=0.3, friction=friction)
    return von_mises(stress).max() / np.sqrt(3)


def test_cells_tend_to_the_limit_with_the_square_of_their_width():
    """In place, without friction: the middle of a cell is at 0.5 of both widths, the worst point at 0.48."""
    limit = in_place_limit(0.0)[0]
    first, second = (cell_limit(0.0, h, np.zeros(1)) / limit - 1 for h in (1 / 9, 1 / 27))
    assert 0 < second < first / 3 and first < 5e-3
