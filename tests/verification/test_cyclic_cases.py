# SPDX-License-Identifier: MIT
"""The cases of repeated loads on made results: the rows that turn red when a number is wrong."""

from pathlib import Path

import numpy as np
import pytest
from made_results import context

from verification.cases.cyclic import misfit_cycles
from verification.references import growing_sphere


def test_the_exact_solution_of_a_period_is_that_of_the_closed_form():
    """A sphere that comes and goes twice: what the second period adds at the radius of the largest strain."""
    solver = context("misfit-cycles", Path(), "full")
    scene = misfit_cycles.above_limit(solver.scene("misfit-sphere"), (0.2, 90.0))
    loading = scene.loading.model_copy(update={"profile": "gauss", "cycles": 2})
    scene = scene.model_copy(update={"loading": loading})
    r = misfit_cycles.REACHES * loading.radius
    assert growing_sphere(scene).shares == (1.0,)  # it is put on alone
    _, once, _, twice = growing_sphere(scene, (1.0, 0.0) * 2).history(r)
    exact = misfit_cycles.cycled_sphere(scene).values
    assert exact["peeq"] == pytest.approx([(twice.peeq - once.peeq).max()], rel=1e-12)
    assert exact["strain"] == pytest.approx([np.abs(2 * (twice.plastic - once.plastic)).max()], rel=1e-12)
