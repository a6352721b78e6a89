# SPDX-License-Identifier: MIT
"""The cases of repeated loads on made results: the rows that turn red when a number is wrong."""

from functools import cache
from pathlib import Path

import numpy as np
import pytest
from made_results import Made, context, red

from verification.cases import all_cases
from verification.cases.cyclic import misfit_cycles
from verification.references import growing_sphere

exact_cycles = cache(misfit_cycles.cycled_sphere)
"""Each is asked for by both models and by the case."""


@pytest.mark.parametrize("wrong", [False, True])
def test_misfit_sphere_in_cycles(wrong, monkeypatch):
    """The exact strains and verdicts in both models; each run, known by its periods, wrong in its way."""
    monkeypatch.setattr(misfit_cycles, "REACHES", np.linspace(0.3, 3.0, 28))
    monkeypatch.setattr(misfit_cycles, "sphere_cells", lambda scene, size: scene)
    monkeypatch.setattr(misfit_cycles, "cycled_sphere", exact_cycles)
    changes = {
        ("sam", 30): {"peeq_step_max": 1.031},
        ("fem-axisymmetric", 30): {"strain_step_max": 0.969},
        ("fem-axisymmetric", 4): {"peeq_step_max": 0.969},
        ("sam", 4): {"verdict": ["undecided"] * 4},
        ("sam", 75): {"verdict": ["undecided"] * 52 + ["alternating"] * 23},
        ("fem-axisymmetric", 240): {"verdict": ["undecided"] * 240},
        ("sam", 240): {"verdict": ["ratchetting"] + ["alternating"] * 239},
    }

    def made(model, scene):
        periods, exact = scene.loading.cycles, exact_cycles(scene).values
        here = changes.get((model, periods), {}) if wrong else {}
        said = here.get("verdict", ["undecided"] * 3 + ["alternating"] * (periods - 3))
        table = {"verdict": said, "periods_to_decide": [4] * periods}
        for name, column in (("peeq", "peeq_step_max"), ("strain", "strain_step_max")):
            table[column] = np.append(1.0, exact[name]) * here.get(column, 1.0)
        return Made(tables={"cycles": table})

    seen = (
        "sam-af-5-peeq fem-af-5-strain fem-prager-5-peeq sam-prager-5-class sam-near-2-told fem-near-1-told"
    )
    name, solver = "misfit-cycles-near", context("misfit-cycles-near", Path(), "full")
    solver.solve = lambda model, scene, label, demand=True: made(model, scene)
    found = red(name, all_cases()[name].measure(all_cases()[name].solve(solver)), whole=True)
    assert found == ({*seen.split(), "ratchetting"} if wrong else set())


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
