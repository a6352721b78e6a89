# SPDX-License-Identifier: MIT
"""Point values of the plastic strain from its means over cells."""

import numpy as np
import pytest

from sam.plasticity.measure import at_centres, largest

FACES = np.array([0.0, 1.0, 2.0, 3.0, 4.0, 5.5, 7.5])
X, Y = np.arange(7) - 3.0, np.arange(6) - 2.5
NODES, WEIGHTS = np.polynomial.legendre.leggauss(6)


def bump(z, x, y):
    return 3.0 - 0.1 * (z - 3.3) ** 2 - 0.05 * (x - 0.2) ** 2 - 0.04 * (y + 0.1) ** 2


def means(of, scale=1.0):
    """Means over the cells by quadrature, (6, 7, 6)."""
    middle, half = (FACES[1:] + FACES[:-1]) / 2, np.diff(FACES) / 2
    out = 0.0
    for a, u in zip(WEIGHTS, NODES, strict=True):
        for b, v in zip(WEIGHTS, NODES, strict=True):
            for c, w in zip(WEIGHTS, NODES, strict=True):
                z = (middle + half * u)[:, None, None]
                out = out + a * b * c / 8 * of(z, X[:, None] + v / 2, Y[None, :] + w / 2)
    return scale * out


def test_quadratic_fields_are_met_exactly_inside():
    values = at_centres(means(bump), FACES)
    exact = bump(((FACES[1:] + FACES[:-1]) / 2)[:, None, None], X[:, None], Y[None, :])
    inner = (slice(1, -1),) * 3
    assert values[inner] == pytest.approx(exact[inner], rel=1e-12)
    assert np.abs(values - exact).max() > 1e-3  # at the sides a direction is missing


def test_largest_value_of_a_quadratic_lies_between_the_centres():
    middle = (FACES[1:] + FACES[:-1]) / 2
    values = bump(middle[:, None, None], X[:, None], Y[None, :])
    depth, top = largest(values, middle)
    assert (depth, top) == (pytest.approx(3.3), pytest.approx(3.0))
    assert largest(values[:, ::-1, ::-1], middle) == (pytest.approx(depth), pytest.approx(top))


def test_a_largest_value_midway_between_layers_is_met_to_the_fourth_order():
    def error(h):
        depths = h * np.arange(1.0, 30.0)
        values = np.exp(-((depths - 10.5 * h) ** 2) * (1 + 0.5 * (depths - 10.5 * h)))
        return abs(largest(values[:, None, None], depths)[1] - 1.0)

    assert error(0.1) < 4e-5  # a parabola: 2e-4
    assert np.log2(error(0.2) / error(0.1)) > 3.5


def test_fourth_order_where_smooth():
    def error(n):
        x = (np.arange(n) + 0.5) / n
        faces = np.linspace(0.0, 1.0, n + 1)
        mean = n * (np.cosh(faces[1:]) - np.cosh(faces[:-1]))  # of sinh
        field = np.broadcast_to((1.0 + mean)[:, None, None], (n, 3, 3))
        return np.abs(at_centres(field, faces)[1:-1, 1, 1] - 1.0 - np.sinh(x[1:-1])).max()

    assert np.log2(error(10) / error(20)) > 3.8


def test_nothing_is_taken_from_beyond_the_border_of_the_plastic_zone():
    mean = np.zeros((5, 5, 5))
    mean[2:, 2, 2] = (1.0, 2.0, 3.0)
    values = at_centres(mean, np.arange(6.0))
    assert (values[mean == 0] == 0).all() and values == pytest.approx(mean)
    spike = np.full((3, 3, 3), 100.0)
    spike[1, 1, 1] = 1e-3
    assert at_centres(spike, np.arange(4.0)).min() == 0.0  # never negative


def test_a_field_on_fewer_than_three_cells_is_left_as_it_is():
    field = np.array([[[2.0, 1.0]]])
    assert at_centres(field, np.array([0.0, 1.0])) == pytest.approx(field)
    assert largest(field, np.array([0.5])) == (0.5, 2.0)


def test_no_parabola_across_a_kink_of_the_yield_stress():
    """A soft layer strains most at its lower face: exp((z - 3)/1.2) above it, nothing much below. The largest
    value is 1.
    """
    middle = (FACES[1:] + FACES[:-1]) / 2
    above = 1.2 * np.diff(np.exp((FACES - 3.0) / 1.2))
    mean = np.where(middle < 3.0, above, 0.01)[:, None, None] * np.ones((1, 3, 3))
    interval = (middle > 3.0).astype(int)
    depth, top = largest(at_centres(mean, FACES, interval), middle, interval)
    assert depth == 2.5 and top == pytest.approx(above[2]) and above[1] < top < 1.0
    assert largest(at_centres(mean, FACES), middle)[1] > 1.05 * top  # without knowing of the kink
    smooth = means(bump)
    even = at_centres(smooth, FACES, np.ones(6))
    assert (even == at_centres(smooth, FACES)).all() and largest(even, middle, np.ones(6)) == largest(
        even, middle
    )


@pytest.mark.parametrize("side", [-1, 1])
def test_the_largest_of_a_cubic_over_depth_is_met_exactly(side):
    """Its maximum lies at 3.3, and the neighbour on one side is the higher."""
    depths = np.arange(1.0, 7.0)
    away = side * (depths - 3.3)
    values = 3.0 - 0.1 * away**2 + 0.004 * away**3
    assert largest(values[:, None, None], depths) == (
        pytest.approx(3.3, rel=1e-9),
        pytest.approx(3.0, rel=1e-12),
    )
