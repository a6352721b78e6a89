# SPDX-License-Identifier: MIT
"""Iso-lines whose numbers find no room are left out, and the others stay."""

import numpy as np
import pytest
from matplotlib.contour import ContourSet

from verification.figures.check import findings
from verification.figures.maps import FieldPair, MapPeak, plane_maps, readable

U, V = np.linspace(-1.5, 1.5, 61), np.linspace(0.0, 1.9, 39)
LEVELS = [0.4, 0.6, 0.8]


def bell(width: float, second: float = 0.9):
    """What draws maps of a bell of this width with iso-lines at some levels."""
    field = np.exp(-(U[:, None] ** 2 + (V - 0.5) ** 2) / width**2)
    pair = FieldPair(U, V, field, second * field, ("SAM", "FEM"), ("$x/a$", "$z/a$"), "plastic strain [%]")
    peaks = [MapPeak(0.0, 0.5, 1.0), MapPeak(0.0, 0.5, second)]
    return lambda levels: plane_maps(pair, peaks, levels)


def lines_of(drawing) -> list[list[float]]:
    """Levels that are drawn in the panels of both fields."""
    return [
        [
            level
            for lines in panel.findobj(ContourSet)
            for level, path in zip(lines.levels, lines.get_paths(), strict=True)
            if len(path.vertices)
        ]
        for panel in drawing.figure.axes[:2]
    ]


@pytest.mark.parametrize("keep", LEVELS[:2])
def test_of_lines_whose_numbers_touch_the_one_to_keep_stays(keep):
    draw = bell(0.15)
    assert any("collide" in finding for finding in findings(draw(LEVELS).figure))
    drawing = readable(draw, LEVELS, keep=(keep,))
    assert findings(drawing.figure) == [] and lines_of(drawing) == [pytest.approx([keep])] * 2


def test_a_line_too_small_for_its_number_goes_even_if_it_is_to_be_kept():
    drawing = readable(bell(0.1), LEVELS, keep=LEVELS[1:])
    assert findings(drawing.figure) == [] and lines_of(drawing) == [pytest.approx(LEVELS[:1])] * 2


def test_numbers_that_stand_apart_stay():
    drawing = readable(bell(1.0), LEVELS)
    assert lines_of(drawing) == [pytest.approx(LEVELS)] * 2


def test_a_level_that_one_field_does_not_reach_needs_no_number_there():
    drawing = readable(bell(1.0, second=0.5), LEVELS)
    assert lines_of(drawing) == [pytest.approx(LEVELS), pytest.approx(LEVELS[:1])]
