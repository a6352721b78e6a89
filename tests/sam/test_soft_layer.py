# SPDX-License-Identifier: MIT
"""A soft layer that is squeezed out over a harder body: what its largest strain converges with."""

import numpy as np
import pytest
from builders import SWIFT, scene as small_scene

import sam

THICKNESS, FORCE = 3e-6, 0.5  # 0.54 contact radii of Hertz; p0 = 5.7 yield stresses
SOFT = SWIFT | {"layer_thickness": THICKNESS, "layer": {**SWIFT, "alpha": 1e3}}
GRADING = 1.5


def faces(thinnest: float) -> tuple[float, ...]:
    """Faces of layers that get thinner towards the lower side of the soft layer."""
    count = int(np.ceil(np.log1p(THICKNESS * (GRADING - 1) / thinnest) / np.log(GRADING)))
    steps = thinnest * GRADING ** np.arange(count)
    above = THICKNESS - np.cumsum(steps)
    below = THICKNESS + np.cumsum(np.minimum(np.append(steps, [2e-6] * 10), 2e-6))
    return (0.0, *above[above > steps[-1] / 2][::-1].tolist(), THICKNESS, *below[below < 20e-6].tolist())


def largest(thinnest: float) -> tuple[float, float]:
    """The largest plastic strain in the layer and below it."""
    grid = {"cells": (17, 17), "extent": (22e-6, 22e-6), "depths": faces(thinnest)}
    loading, solver = {"force": FORCE, "steps": 2}, {"tolerance": 1e-4}
    result = sam.solve(small_scene(body={"plasticity": SOFT}, loading=loading, grid=grid, solver=solver))
    assert result.converged
    plane = result.tables["plane"]
    z, peeq = np.array(plane["z_m"]), np.array(plane["peeq"])
    return float(peeq[z < THICKNESS].max()), float(peeq[z > THICKNESS].max())


def test_the_sheet_at_the_lower_side_of_a_soft_layer_needs_thin_layers_of_cells():
    """The layer shears in a sheet some hundredths of a radius thick: with layers of cells as thick as that a
    third of the strain is missing. Below it the strain hardly depends on them.
    """
    coarse, fine = largest(200e-9), largest(20e-9)
    assert coarse[0] < 0.7 * fine[0]
    assert coarse[1] == pytest.approx(fine[1], rel=0.04)
