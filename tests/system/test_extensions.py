# SPDX-License-Identifier: MIT
"""Each hardening law and shape is known everywhere: what is forgotten of a new one is named here."""

import math
from pathlib import Path

import numpy as np
import pytest
from builders import HARDENING, SHAPES, scene

from sam.grid.cells import CellGrid
from sam.planner import bodies
from sam.scene.body import LAWS, SHAPES as SHAPES_OF_SCENES
from verification.checks.conditions import GAPS

ROOT = Path(__file__).parents[2]
GUIDE = (ROOT / "docs" / "guide" / "scenes.md").read_text()


@pytest.mark.parametrize("law", LAWS)
def test_every_law_has_an_example_and_is_in_the_guide(law):
    """In both models and once more in the checks: `test_return_map.py`, of every law that has an example."""
    assert law in HARDENING and f'`"{law}"`' in GUIDE


@pytest.mark.parametrize("shape", SHAPES_OF_SCENES)
def test_every_shape_has_the_same_gap_in_the_checks_and_is_in_the_guide(shape):
    other = type(scene().counterbody)(**SHAPES[shape])
    grid = CellGrid(64, 64, 0.4e-6, 0.4e-6, np.zeros(1))
    x, y = np.meshgrid(grid.x, grid.y, indexing="ij")
    # the cells of a punch have its area as closely as whole rings allow: of its edge two cells are free
    edge = np.abs(np.hypot(x, y) - (other.radius if shape == "punch" else math.inf)) < 0.8e-6
    gap = bodies.SHAPES[shape].gap(other).gap(grid)
    np.testing.assert_allclose(GAPS[shape](other, x, y)[~edge], gap[~edge], rtol=1e-14)
    assert f'`"{shape}"`' in GUIDE
