# SPDX-License-Identifier: MIT
"""The cases of a sphere that grows: errors by hand, and each coefficient of the images at the surface."""

from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest
from made_results import context

from verification.cases.plastic.misfit_images import CELLS as IMAGE_CELLS, NAMES, images
from verification.cases.plastic.misfit_sphere import l2, law, means_of_cells, order_of_half, second_order
from verification.references import growing_sphere
from verification.rows import load_rows

CASE = "misfit-sphere"


def test_the_order_of_two_sizes_and_the_error_of_second_order():
    errors = pd.DataFrame({"total": [-4e-3, 1e-3, 3e-4], "sphere-cells": [6, 8, 12]})
    assert second_order(errors, "total") == pytest.approx(0.144, rel=1e-12)
    assert order_of_half(pd.DataFrame({"l2": [0.012, 0.002]}), "l2") == pytest.approx(np.log2(6.0), rel=1e-12)


def test_a_strain_that_is_one_percent_too_large_is_off_by_that():
    scene = law(context(CASE, Path()).scene(CASE), "linear")
    x = np.linspace(-1.0, 1.0, 7) * scene.loading.radius
    box = SimpleNamespace(x=x, y=x, z=x + scene.loading.depth, cell_data={})
    result = SimpleNamespace(grids={"peak": {"body": box}})
    box.cell_data["peeq"] = 1.01 * means_of_cells(scene, result)
    assert l2(scene, result, None) == pytest.approx(0.01, rel=1e-9)


def test_each_coefficient_of_the_image_that_is_1_percent_off_turns_its_gate_red():
    """All 36 of the stress and 6 of the displacement, in either sense."""
    scene = context(CASE, Path()).scene(CASE)
    found = images(growing_sphere(law(scene, "linear")), IMAGE_CELLS)
    tolerances = {gate.id: gate.tolerance for gate in load_rows()}
    gated = [{"yy": "xx", "yz": "xz"}.get(name, name) for name in (*NAMES, "raised")]
    limits = np.array([tolerances[f"{CASE}.sam-image-{name}"] for name in gated])
    assert (found.left() < limits).all()
    for off in 0.01 * np.vstack([np.eye(6), -np.eye(6)]):
        assert (found.left(1 + off) > limits).all()
