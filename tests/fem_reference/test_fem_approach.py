# SPDX-License-Identifier: MIT
"""Displacement control in the finite-element models: the approach is given, the force is found."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from builders import PERFECT, RADIUS, STEEL, SWIFT, scene

from fem_reference.axisymmetric.solution import METHOD as AXISYMMETRIC
from fem_reference.common import solution
from fem_reference.spatial.solution import METHOD as SPATIAL
from sam.scene import Status

SMALL = {"cells_per_radius": 8, "box": 6}
COARSE = {"cells_per_radius": 4, "box": 5}
CYCLES = {"force": 0.4, "steps": 3, "unload": True, "cycles": 2}
ROUGH = {
    "kind": "self-affine",
    "sq": 20e-9,
    "hurst": 0.8,
    "cutoff_long": 20e-6,
    "cutoff_short": 5e-6,
    "seed": 1,
}
COATING = {"thickness": 1e-6, "young": 80e9, "poisson": 0.3}
KINDS = {
    "elastic": (AXISYMMETRIC, lambda: scene(fem=SMALL, loading=CYCLES)),
    "two bodies": (AXISYMMETRIC, lambda: scene(fem=SMALL, counterbody=STEEL)),
    "punch": (AXISYMMETRIC, lambda: scene(fem=SMALL, counterbody={"shape": "punch", "radius": 8e-6})),
    "coated": (
        AXISYMMETRIC,
        lambda: scene(fem=SMALL, body=STEEL | {"coating": COATING}, loading=CYCLES),
    ),
    "yielding film": (
        AXISYMMETRIC,
        lambda: scene(fem=SMALL, body=STEEL | {"coating": COATING | {"yield_stress": 3e9}}, loading=CYCLES),
    ),
    "plastic": (
        AXISYMMETRIC,
        lambda: scene(fem=SMALL, body=STEEL | {"plasticity": SWIFT}, loading=CYCLES),
    ),
    "sliding": (SPATIAL, lambda: scene(fem=COARSE, friction=0.3, loading={"steps": 2, "unload": True})),
    "plastic, sliding": (
        SPATIAL,
        lambda: scene(fem=COARSE, body=STEEL | {"plasticity": SWIFT}, friction=0.2, loading={"force": 0.3}),
    ),
    "rough": (
        SPATIAL,
        lambda: scene(
            surface=ROUGH,
            grid={"cells": (12, 12), "extent": (1.5e-5, 1.5e-5)},
            loading={"force": 0.1, "steps": 2},
        ),
    ),
}


def solve(method, a_scene):
    return solution.solve(method, a_scene, progress=None, checkpoint=None, start=None)


@cache
def forced(kind):
    """The scene of a kind and its result, under force control."""
    method, make = KINDS[kind]
    a_scene = make()
    return a_scene, solve(method, a_scene)


def fed(method, a_scene, result):
    """The same scene with the approaches of a result in place of its forces, at every step to a peak."""
    history = result.tables["history"]
    places = zip(history["cycle"], history["step"], strict=True)
    approaches = dict(zip(places, history["approach_m"], strict=True))

    def with_approaches(plan):
        def changed(target):
            if target.unloads:
                return target
            given = approaches[target.cycle, target.number] / plan.scales.displacement
            return replace(target, load=replace(target.load, approach=given))

        schedule = replace(plan.schedule, targets=tuple(map(changed, plan.schedule.targets)))
        bare = None if plan.bare is None else with_approaches(plan.bare)
        return replace(plan, schedule=schedule, bare=bare)

    return solve(replace(method, plan=lambda its: with_approaches(method.plan(its))), a_scene)


@pytest.mark.parametrize("kind", KINDS)
def test_the_approaches_of_a_force_run_return_its_forces(kind):
    """In every step, to ten times the tolerance of the solver; the rest of the record with them."""
    method, (a_scene, by_force) = KINDS[kind][0], forced(kind)
    by_approach = fed(method, a_scene, by_force)
    near = 10 * a_scene.solver.tolerance
    assert by_force.status is by_approach.status
    forces, found = (np.array(each.tables["history"]["force_N"]) for each in (by_force, by_approach))
    assert found == pytest.approx(forces, rel=near, abs=near * forces.max())
    for name in ("p_max_Pa", "mises_max_Pa", "mises_max_change", "peeq_max"):
        if by_force.quantities[name] is not None:
            assert by_approach.quantities[name] == pytest.approx(by_force.quantities[name], rel=1e-4, abs=0)


@pytest.mark.parametrize("kind", ["elastic", "rough", "sliding"])
def test_a_scene_gives_the_approach(kind):
    """Planned with the approach: the force is that of a scene that is given this force."""
    method, (of_force, by_force) = KINDS[kind][0], forced(kind)
    approach = by_force.quantities["approach_m"]
    loading = of_force.loading.model_copy(update={"force": None, "approach": approach})
    result = solve(method, of_force.model_copy(update={"loading": loading}))
    assert result.quantities["approach_m"] == pytest.approx(approach, rel=1e-12)
    # a mesh of other units, the same but for the radius that its size comes from
    assert result.quantities["force_N"] == pytest.approx(of_force.loading.force, rel=2e-2)


def test_steps_in_a_dent_do_not_touch():
    """The second cycle: the first step ends above the dent of the first, without force, at its approach."""
    loading = {"force": None, "approach": 0.3e-6, "steps": 5, "unload": True, "cycles": 2}
    result = solve(AXISYMMETRIC, scene(fem=SMALL, body=STEEL | {"plasticity": PERFECT}, loading=loading))
    history = result.tables["history"]
    assert result.status is Status.CONVERGED
    at = {place: k for k, place in enumerate(zip(history["cycle"], history["step"], strict=True))}
    assert history["approach_m"][at[2, 1] - 1] > 0.06e-6  # unloaded
    assert history["force_N"][at[2, 1]] == 0.0
    assert history["approach_m"][at[2, 1]] == pytest.approx(0.06e-6, rel=1e-12)
    assert history["force_N"][at[2, 5]] == pytest.approx(history["force_N"][at[1, 5]], rel=0.02)


def test_a_step_into_a_dent_is_halved_from_where_the_bodies_touch():
    """Not from no approach: most of the halves would end where the bodies are apart, and use the cuts up."""
    loading = {"force": None, "approach": 0.312e-6, "steps": 4, "unload": True, "cycles": 2}
    result = solve(AXISYMMETRIC, scene(fem=COARSE, body=STEEL | {"plasticity": PERFECT}, loading=loading))
    assert result.status is Status.CONVERGED
    assert any("cut" in note for note in result.tables["history"]["note"])


def test_a_sphere_takes_the_force_of_hertz():
    result = solve(AXISYMMETRIC, scene(loading={"force": None, "approach": 0.3e-6}))
    exact = 4 / 3 * 210e9 / 0.91 * np.sqrt(RADIUS) * 0.3e-6**1.5
    assert result.quantities["force_N"] == pytest.approx(exact, rel=1e-3)
