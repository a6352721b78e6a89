# SPDX-License-Identifier: MIT
"""Load steps of the finite-element models: halved steps, unloading, what a step may not change."""

from dataclasses import replace

import numpy as np
import pytest
from test_fem_plastic_contact import LAWS, POISSON, YOUNG, hertz, loaded, scene, solved

import fem_reference
from fem_reference.axisymmetric.model import build
from fem_reference.axisymmetric.planner import plan
from fem_reference.common import contact, loading
from fem_reference.common.loading import Progressed, climb, follow, run
from fem_reference.common.schedule import Load, Target, unloading
from sam.scene.result import Status
from sam.scene.schema import Scene


def test_one_elastic_step_equals_unloading_in_steps():
    """The same displacements either way, with no plastic strain on the way."""
    model, steps = loaded()
    peak = steps[-1].state
    (single_step,) = follow(model, Progressed(peak, [unloading(5, Target(peak.load))]))
    slowly = climb(model, [peak.force * share for share in (0.8, 0.6, 0.4, 0.2, 0.0)], peak)
    assert single_step.note == loading.ELASTIC_UNLOADING
    assert np.array_equal(slowly[-1].state.history.peeq, peak.history.peeq)
    assert np.abs(slowly[-1].state.u - single_step.state.u).max() < 1e-9 * np.abs(single_step.state.u).max()
    assert [step.state.active.sum() for step in slowly] == sorted(
        (s.state.active.sum() for s in slowly), reverse=True
    )


def test_reverse_yielding_is_found_and_unloaded_in_steps():
    """Under a punch at 2.5 Y the edge yields backwards: as many steps as asked for, and plastic strain
    added.
    """
    s = Scene(
        body={"young": YOUNG, "poisson": POISSON, "plasticity": LAWS["perfect"]},
        counterbody={"shape": "punch", "radius": 1e-5},
        loading={"force": 2.5 * np.pi * 1e-10 * 1e9, "steps": 10, "unload": True, "unload_steps": 4},
        fem={"cells_per_radius": 6},
    )
    model = build(plan(s))
    steps = run(model, model.plan.schedule)
    assert [step.unloads for step in steps] == [False] * 10 + [True] * 4
    assert all(step.state.converged for step in steps)
    peak, end = steps[9].state, steps[-1].state
    assert (end.history.peeq - peak.history.peeq).max() > 1e-3 * peak.history.peeq.max()
    assert not end.active.any()
    stress = model.body.stress(model.problem.body(end.u, 0), end.history.plastic_strain)
    assert (model.problem.material.excess(stress, end.history)).max() < 1e-10
    assert max(step.state.residual for step in steps) < 1e-9


def test_weak_steps_finish_by_cutting():
    """Perfect plasticity in one load step: Newton fails, the step is halved, the cuts are counted; near many
    steps.
    """
    result, fine = fem_reference.solve(scene("perfect", 4.0, steps=1)), solved("perfect", 4.0)
    assert result.status is Status.CONVERGED and result.cost["step_cuts"] >= 1
    assert fine.cost["step_cuts"] == 0
    assert result.quantities["force_N"] == pytest.approx(hertz("perfect", 4.0)[0], rel=1e-9)
    # first order in the steps: 1.5 % with three in place of ten
    assert result.quantities["peeq_max"] == pytest.approx(fine.quantities["peeq_max"], rel=3e-2)
    assert result.tables["history"]["iterations"][0] == result.cost["newton_iterations"] - 1


def test_cut_limit_is_a_status(monkeypatch):
    """A step that fails at every size: the result says so, keeps the steps up to there, and has no unloaded
    state.
    """
    monkeypatch.setattr(contact, "MAX_ITERATIONS", 2)
    monkeypatch.setattr(loading, "MOST_CUTS", 1)
    result = fem_reference.solve(scene("perfect", 4.0, steps=2))
    assert result.status is Status.STEP_CUT_LIMIT and "loading.steps" in result.message
    history, residuals = result.tables["history"], result.tables["residuals"]
    assert len(history["step"]) < 3 and max(residuals["step"]) not in history["step"]
    assert result.quantities["residual_uz_center_m"] is None


def test_progress_counts_every_cycle():
    seen = []
    fem_reference.solve(
        scene(ratio=2.0, cells=4, steps=2, cycles=2), progress=lambda *args: seen.append(args)
    )
    assert seen == [("contact", k, 4) for k in (1, 2, 3, 4)]


def test_steps_are_immutable():
    _, steps = loaded()
    with pytest.raises(AttributeError):
        steps[0].state.history.peeq = None
    assert replace(steps[0], cuts=3).cuts == 3


def test_parts_of_a_cut_step_begin_with_the_nodes_of_the_last(monkeypatch):
    """A whole step begins with nodes scaled with the force, its halves with those that touch; each half may
    be cut again.
    """
    model, steps = loaded(cells=4, steps=3)
    state, begun = steps[1].state, []

    def tried(problem, load, start, **_):
        begun.append((load.force, start))
        return replace(steps[2].state, load=load, converged=len(begun) > 2)

    monkeypatch.setattr("fem_reference.common.model.equilibrium", tried)
    whole = Load(2.0 * state.force)
    step = loading.advance(model, whole, state)
    assert (
        step.cuts == 2
        and step.state.converged
        and [force for force, _ in begun[:3]]
        == pytest.approx([whole.force, 1.5 * state.force, 1.25 * state.force])
    )
    assert begun[0][1].sum() > state.active.sum()
    assert all(np.array_equal(start, state.active) for _, start in begun[1:3])
