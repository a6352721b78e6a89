# SPDX-License-Identifier: MIT
"""Load steps that no halving brings to converge: a soft thin layer that friction shears, and what the history
and the result say of the longer iteration.
"""

from dataclasses import replace

import numpy as np
import pytest
from builders import PERFECT, RUN_IN_STEEL, hertz_force, running_in, scene as small_scene
from plastic_start import begin

import sam
from sam.plasticity import history, load_step as plastic_step
from sam.plasticity.history import LONGER
from sam.scene import Status
from sam.schedule import Load

SOFT = {"layer_thickness": 0.2e-6, "layer": {**RUN_IN_STEEL, "B": 0.3 * RUN_IN_STEEL["B"], "alpha": 1e2}}
"""A layer whose shear strength, 0.4 GPa, is a quarter of the traction at the summits."""
FRICTION = {"law": "constant", "coefficient": 0.5}


def forced(monkeypatch, iterations=3):
    """So few iterations that steps end at once in the longer one."""
    monkeypatch.setattr(plastic_step, "ITERATIONS", iterations)
    monkeypatch.setattr(history, "MOST_CUTS", 0)


def test_a_step_below_a_soft_layer_converges_by_the_longer_iteration():
    a_scene = running_in(cycles=1, film=FRICTION, wear=None, plasticity=RUN_IN_STEEL | SOFT)
    model, now = begin(a_scene)
    usual, load = model.problem(now.extent), Load(0.9 * a_scene.loading.force)
    short, trial = (replace(usual, longer=longer).step(now.state, load) for longer in (False, True))
    assert not short.converged and len(short.history) == plastic_step.ITERATIONS + 1
    assert trial.converged and max(trial.yield_excess, trial.flow_residual) <= a_scene.solver.tolerance
    assert np.max(trial.increment.peeq) > 1.0


@pytest.fixture(scope="module")
def usual():
    return sam.solve(running_in())


def test_the_result_says_how_many_steps_needed_it(usual, monkeypatch):
    """From the first step that halving would not bring to converge; the answer is the same."""
    assert not usual.warnings or LONGER not in " ".join(usual.warnings)
    forced(monkeypatch, iterations=8)
    result = sam.solve(running_in())
    notes = result.tables["history"]["note"]
    longer = [LONGER in note for note in notes]
    assert result.status is usual.status and any(longer)
    assert f"{sum(longer)} of {len(notes)} load steps" in " ".join(result.warnings)
    for name in ("peeq_max", "p_max_Pa", "wear_volume_m3"):
        assert result.quantities[name] == pytest.approx(usual.quantities[name], rel=1e-3)
    accepted = result.tables["residuals"]["accepted"]
    assert result.cost["step_cuts"] == 0 and 0 in accepted


def test_a_worn_surface_that_does_not_settle_is_solved_longer(usual, monkeypatch):
    """After a removal there is no load to halve: the first iteration there is cut short."""
    short, cut = plastic_step.Problem.step, []

    def step(problem, state, load, **keys):
        trial = short(problem, state, load, **keys)
        if not keys and load.force == 0 and not problem.longer:
            cut.append(load)
            return replace(trial, converged=False)
        return trial

    monkeypatch.setattr(plastic_step.Problem, "step", step)
    result = sam.solve(running_in())
    notes = result.tables["history"]["note"]
    assert result.status is usual.status and cut
    assert any(LONGER in note and "m3 removed" in note for note in notes)
    assert result.quantities["wear_volume_m3"] == pytest.approx(usual.quantities["wear_volume_m3"], rel=1e-6)


def test_the_loops_of_the_paper_know_no_longer_iteration(monkeypatch):
    forced(monkeypatch)
    monkeypatch.setattr("sam.plasticity.paper.OUTER", 1)
    result = sam.solve(
        small_scene(
            body={"plasticity": PERFECT},
            loading={"force": hertz_force(2.5e9), "steps": 1},
            grid={"cells": (17, 17)},
            solver={"method": "paper", "tolerance": 1e-4},
        )
    )
    assert result.status is Status.STEP_CUT_LIMIT
    assert len(result.tables["residuals"]["iteration"]) == 1
