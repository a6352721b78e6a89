# SPDX-License-Identifier: MIT
"""Each hardening law and shape is known everywhere: what is forgotten of a new one is named here."""

import math
from pathlib import Path

import numpy as np
import pytest
from builders import HARDENING, SHAPES, SPHERE_TEXT, YIELD_CURVE, scene

from sam.grid.cells import CellGrid
from sam.planner import bodies
from sam.scene import load_scene
from sam.scene.body import LAWS, SHAPES as SHAPES_OF_SCENES
from verification.checks.conditions import GAPS
from verification.checks.material import yield_stress

ROOT = Path(__file__).parents[2]
GUIDE = (ROOT / "docs" / "guide" / "scenes.md").read_text()


@pytest.mark.parametrize("law", LAWS)
def test_every_law_is_written_once_more_by_the_checks_and_in_the_guide(law, tmp_path):
    (tmp_path / "curve.csv").write_text(YIELD_CURVE)
    (tmp_path / "p.csv").write_text("depth_m,factor\n0,2\n1e-6,1\n")
    text = f"{SPHERE_TEXT}[body.plasticity]\n{HARDENING[law]}profile = 'p.csv'\n"
    (tmp_path / "scene.toml").write_text(text)
    found = load_scene(tmp_path / "scene.toml")
    peeq, z = np.meshgrid([0.0, 5e-4, 3e-3, 0.03], [0.0, 4e-7, 2e-6])
    expected = found.body.plasticity.depth_profile()(z) * found.body.plasticity.curve().stress(peeq)
    # fewer than ten roundings, of terms no larger than three times the result
    assert yield_stress(found, peeq, z) == pytest.approx(expected, rel=1e-14, abs=0.0)
    assert f'`"{law}"`' in GUIDE


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
