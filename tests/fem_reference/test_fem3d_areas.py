# SPDX-License-Identifier: MIT
"""Area of contact spots between the nodes of a mesh, against closed forms."""

import numpy as np
import pytest

from fem_reference.spatial import area as areas


def edge_fields(distance):
    """Pressure and gap of a smooth contact whose edge is at distance 0, inside where it is positive, for k =
    1 and E* = 1.
    """
    return np.sqrt(np.clip(distance, 0, None)), 4 / 3 * np.clip(-distance, 0, None) ** 1.5


def of_shape(level, h, clamped=0.0):
    """Area of {level > 0}, level(x, y) the distance to the edge, by the mesh of size h."""
    x = np.arange(-3, 3 + h / 2, h) + 0.137 * h
    y = np.arange(-2, 2 + h / 2, h) - 0.29 * h
    return areas.area_of_spots(x, y, *edge_fields(level(x[:, None], y[None, :])), clamped=clamped)


def test_area_of_two_discs_and_of_a_ring():
    """Exact fields at the nodes: second order, so 1 % at ten elements in the radius; a hole counts as a
    hole.
    """

    def discs(x, y):
        return np.maximum(1.0 - np.hypot(x + 1.5, y), 0.7 - np.hypot(x - 1.6, y - 0.3))

    def ring(x, y):
        return 0.4 - np.abs(np.hypot(x, y) - 1.2)

    assert of_shape(discs, 0.1) == pytest.approx(np.pi * 1.49, rel=0.01)
    assert of_shape(ring, 0.1) == pytest.approx(np.pi * (1.6**2 - 0.8**2), rel=0.01)
    errors = [abs(of_shape(discs, h) / (np.pi * 1.49) - 1) for h in (0.2, 0.05)]
    assert errors[1] < errors[0] / 6
    strip = of_shape(discs, 0.1) - of_shape(discs, 0.1, clamped=0.5)
    assert strip == pytest.approx(0.5 * 0.1 * 2 * np.pi * 1.7, rel=0.03)
    assert areas.area_of_spots(*2 * (np.arange(4.0),), np.zeros((4, 4)), np.ones((4, 4))) == 0.0
