# SPDX-License-Identifier: MIT
"""Load steps of the finite-element models: plastic history, halved steps, unloading, given approaches."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from builders import PERFECT, RADIUS, STEEL, SWIFT, hertz_force, scene as small_scene

import fem_reference
import fem_reference.spatial
from fem_reference.axisymmetric.model import Model, build
from fem_reference.axisymmetric.planner import plan
from fem_reference.common import loading
from fem_reference.common.loading import Step, run
from fem_reference.common.schedule import Load
from sam.scene import Status

YIELD = {"swift": 945e6 * 20**0.121, "perfect": 1e9, "profile": 1e9}
PROFILE = [[0.0, 1.3], [1e-6, 1.3], [4e-6, 1.0]]
LAWS = {"swift": SWIFT, "perfect": PERFECT, "profile": PERFECT | {"profile": PROFILE}}


def scene(law="swift", ratio=4.0, cells=8, steps=10, **keys):
    """A sphere whose Hertz pressure is `ratio` times the yield stress."""
    return small_scene(
        body={"plasticity": law and LAWS[law]},
        loading={"force": hertz_force(ratio * YIELD[law or "swift"]), "steps": steps, "unload": True, **keys},
        fem={"cells_per_radius": cells},
    )


def made(law="swift", ratio=4.0, cells=8, steps=10) -> tuple[Model, list[Step]]:
    model = build(plan(scene(law, ratio, cells, steps, unload=False)))
    return model, run(model, model.plan.schedule)


loaded = cache(made)


@pytest.mark.parametrize("law", ["swift", "perfect"])
def test_elastic_below_yield(law):
    """p0 = 1.5 Y: yield starts at 1.61 Y; every number equals the elastic answer, bit by bit."""
    plastic = fem_reference.solve(scene(law, 1.5, steps=3))
    elastic = fem_reference.solve(scene(None, steps=3, force=hertz_force(1.5 * YIELD[law])))
    assert plastic.quantities == elastic.quantities | {"peeq_max": 0.0}
    for name, table in elastic.tables.items():
        for column, values in table.items():
            np.testing.assert_array_equal(plastic.tables[name][column], values, f"{name} {column}")


def test_a_depth_profile_acts_at_each_point():
    """Factor 1.3 down to 1 um: it is that of the depth, and there is less plastic strain than without."""
    model, steps = loaded("profile", steps=4)
    depth, factor = model.body.points[1] * model.scales.length, model.problem.material.factor
    assert factor == pytest.approx(np.interp(depth, [1e-6, 4e-6], [1.3, 1.0]))
    plain = loaded("perfect", steps=4)[1][-1].state
    assert steps[-1].state.history.peeq.max() < plain.history.peeq.max()


@pytest.mark.parametrize("thickness", [0.28, 0.32])
def test_the_mesh_has_a_line_where_the_yield_stress_has_a_kink(monkeypatch, thickness):
    """Both ends of a weak layer lie in one row of elements 1/8 high. The largest strain is that of points,
    of no parabola through the kink there.
    """
    a = np.pi * 4 * YIELD["swift"] * RADIUS / (2 * 210e9 / 0.91)
    layer = {"B": 9450e6, "profile": [[thickness * a, 0.1], [1.5 * thickness * a, 1.0]]}
    monkeypatch.setitem(LAWS, "swift", SWIFT | layer)
    result = fem_reference.solve(scene(unload=False, steps=4))
    faces = np.unique(result.fields.points[:, 2]) / a
    assert np.abs(faces - thickness).min() < 1e-9 > np.abs(faces - 1.5 * thickness).min()
    largest = max(result.tables[name]["peeq"].max() for name in ("axis", "plane"))
    assert 0 < result.quantities["peeq_max"] == pytest.approx(largest, rel=1e-3)


# --- unloading and halved steps ---


def test_reverse_yielding_is_found_and_unloaded_in_steps():
    """Under a punch at 2.5 Y the edge yields backwards: as many steps as asked for, and strain added."""
    force = {"force": 2.5 * np.pi * 1e-10 * 1e9, "steps": 10, "unload": True, "unload_steps": 4}
    punch = {"shape": "punch", "radius": 1e-5}
    s = small_scene(
        body={"plasticity": PERFECT}, counterbody=punch, loading=force, fem={"cells_per_radius": 6}
    )
    model = build(plan(s))
    steps = run(model, model.plan.schedule)
    assert [step.unloads for step in steps] == [False] * 10 + [True] * 4
    assert all(step.state.converged for step in steps)
    peak, end = steps[9].state, steps[-1].state
    assert (end.history.peeq - peak.history.peeq).max() > 1e-3 * peak.history.peeq.max()
    assert not end.active.any()
    stress = model.body.stress(model.problem.body(end.u, 0), end.history.plastic_strain)
    assert model.problem.material.excess(stress, end.history).max() < 1e-10
    assert max(step.state.residual for step in steps) < 1e-9


def test_weak_steps_finish_by_cutting():
    """Perfect plasticity in one load step: Newton fails, the step is halved, and the cuts are counted."""
    result = fem_reference.solve(scene("perfect", steps=1))
    assert result.status is Status.CONVERGED and result.cost["step_cuts"] >= 1
    assert result.quantities["force_N"] == pytest.approx(hertz_force(4e9), rel=1e-9)
    assert result.tables["history"]["iterations"][0] == result.cost["newton_iterations"] - 1


def test_parts_of_a_cut_step_begin_with_the_nodes_of_the_last(monkeypatch):
    """A whole step begins with nodes scaled with the force, its halves with those that touch."""
    model, steps = loaded(cells=4, steps=3)
    state, begun = steps[1].state, []

    def tried(problem, load, start, **_):
        begun.append((load.force, start))
        return replace(steps[2].state, load=load, converged=len(begun) > 2)

    monkeypatch.setattr("fem_reference.common.model.equilibrium", tried)
    step = loading.advance(model, Load(2.0 * state.force), state)
    forces = [force / state.force for force, _ in begun[:3]]
    assert step.cuts == 2 and step.state.converged and forces == pytest.approx([2.0, 1.5, 1.25])
    assert begun[0][1].sum() > state.active.sum()
    assert all(np.array_equal(start, state.active) for _, start in begun[1:3])


# --- given approaches ---

COARSE, CYCLES = {"cells_per_radius": 4, "box": 5}, {"steps": 3, "unload": True, "cycles": 2}
WAVE = {"kind": "self-affine", "sq": 2e-8, "hurst": 0.8, "cutoff_long": 2e-5, "cutoff_short": 5e-6, "seed": 1}
KINDS = {
    "elastic": (fem_reference, {"counterbody": STEEL, "loading": CYCLES}),
    "sliding": (fem_reference.spatial, {"body": {"plasticity": SWIFT}, "friction": 0.2}),
    "rough": (fem_reference.spatial, {"surface": WAVE, "grid": {"cells": (8, 8), "extent": (1e-5, 1e-5)}}),
}


@pytest.mark.parametrize("kind", KINDS)
def test_a_scene_gives_the_approach(kind):
    """It is that of the result, of a mesh that is planned with an estimate of the force."""
    model, tables = KINDS[kind]
    loading = tables.get("loading", {}) | {"force": None, "approach": 0.3e-6}
    found = model.solve(small_scene(**tables | {"fem": COARSE, "loading": loading})).quantities["approach_m"]
    assert found == pytest.approx(0.3e-6, rel=1e-12)


def dented(fem, approach, steps):
    """Perfect plasticity, two cycles to an approach: the second begins above the dent of the first."""
    given = {"force": None, "approach": approach, "steps": steps, "unload": True, "cycles": 2}
    result = fem_reference.solve(small_scene(fem=fem, body={"plasticity": PERFECT}, loading=given))
    assert result.status is Status.CONVERGED
    return result.tables["history"]


def test_steps_in_a_dent_do_not_touch():
    """The first step of the second cycle ends above the dent of the first, without force, at its approach."""
    history = dented(COARSE, 0.3e-6, 5)
    at = {place: k for k, place in enumerate(zip(history["cycle"], history["step"], strict=True))}
    assert history["approach_m"][at[2, 1] - 1] > 0.06e-6  # unloaded
    assert history["force_N"][at[2, 1]] == 0.0
    assert history["approach_m"][at[2, 1]] == pytest.approx(0.06e-6, rel=1e-12)


def test_a_step_into_a_dent_is_halved_from_where_the_bodies_touch():
    """Not from no approach: most of the halves would end where the bodies are apart, and use the cuts up."""
    assert any("cut" in note for note in dented(COARSE, 0.312e-6, 4)["note"])
