# SPDX-License-Identifier: MIT
"""What plastic strain dissipates and what back-stresses store: exact over a step, in both models."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

from fem_reference import load_steps
from sam import choose_grid
from sam.plasticity.progress import Progressed
from sam.scene import plastic_work, step_energies, stored_energy
from sam.scene.yield_curve import Linear, Swift
from tests.material_point import POINTS, YOUNG, SamPoint
from tests.system.test_repeated_loading import CHABOCHE, pressed
from verification.checks import axisymmetric, conditions
from verification.runs.models import SAM, solve

LAWS = {
    "prager": ([YOUNG / 19], [0.0]),
    "one": ([150e9], [300.0]),
    "three": ([400e9, 60e9, 6e9], [2000.0, 300.0, 0.0]),
    "extreme": ([1e12, 6e9], [1e7, 1e-3]),
}
TWICE = np.array([1.0, 1.0, 1.0, 2.0, 2.0, 2.0])


def constants(law, like):
    """C_k and g_k of a shape that broadcasts with fields of the dimension of one of the a_k."""
    return [np.reshape(np.array(values, dtype=float), (-1, *[1] * (like.ndim - 2))) for values in law]


@pytest.mark.parametrize("model", POINTS)
@pytest.mark.parametrize("law", LAWS.values(), ids=LAWS)
@pytest.mark.parametrize("curve", [Linear(1e9), Swift(945e6, 20.0, 0.121)], ids=["perfect", "swift"])
def test_work_of_the_stress_is_what_is_stored_and_dissipated(model, law, curve):
    """To rounding in random states, strains from 0.1 to 10 %; dissipation and error are never negative."""
    rng = np.random.default_rng(3)
    for size in (1e-3, 1e-2, 1e-1):
        point = POINTS[model](curve, *law)
        for _ in range(5):
            before, total = point.state, point.plastic
            stress, point.state = point.at(size * rng.standard_normal(6))
            s, now = stress - [*[stress[:3].mean()] * 3, 0, 0, 0], point.plastic
            x, length = now[0] - total[0], point.state.peeq - before.peeq
            if not length.item():
                continue
            C, g = constants(law, before.back)
            shaped = x.reshape(before.back.shape[1:])
            found = step_energies(C, g, before.back, shaped, length=length)
            work = float(TWICE @ (s * x))
            parts = curve.stress(now[1]) * length + found.stored + found.dissipated + found.error
            assert parts.item() == pytest.approx(work, rel=1e-11)
            change = stored_energy(C, point.state.back) - stored_energy(C, before.back)
            assert found.stored.item() == pytest.approx(change.item(), abs=1e-11 * work)
            assert found.dissipated.item() >= 0 and found.error.item() >= 0


@pytest.mark.parametrize("size", [1e-7, 1e-4, 3e-3, 0.1])
@pytest.mark.parametrize("law", LAWS.values(), ids=LAWS)
def test_a_straight_step_dissipates_what_its_parts_do(law, size):
    """Energies are exact in any number of steps along a direction; their error falls with the steps."""
    point = SamPoint(Linear(1e9), *law)
    for strain in ((0.01, -0.003, -0.007, 0, 0.004, 0), (-0.02, 0.01, 0.01, 0.003, 0, 0)):
        point.state = point.at(np.array(strain))[1]
    N, start = np.array([1, -0.5, -0.5, 0, 0, 0]).reshape(6, 1, 1, 1), point.state.back
    C, g = constants(law, start)
    dp = np.full((1, 1, 1), size)
    whole, parts, back = step_energies(C, g, start, size * N, length=dp), [], start
    for _ in range(5):
        parts.append(step_energies(C, g, back, size / 5 * N, length=dp / 5))
        back = back + point.material.back.change(back, size / 5 * N, dp / 5)
    assert whole.stored == pytest.approx(sum(each.stored for each in parts), rel=1e-9, abs=1e-6)
    assert whole.dissipated == pytest.approx(sum(each.dissipated for each in parts), rel=1e-12)
    assert 0 < sum(each.error for each in parts) < (1 + 1e-9) * whole.error


def test_the_work_of_the_yield_stress_adds_up():
    """Over [0, 1e-3] and [1e-3, 1e-2] it is that over [0, 1e-2]."""
    curve, first, last = Swift(945e6, 20.0, 0.121), np.array([1e-3]), np.array([1e-2])
    both = plastic_work(curve, first) + plastic_work(curve, last, first)
    assert both == pytest.approx(plastic_work(curve, last), rel=1e-6)


def two_cycles(tolerance=1e-12):
    """Chaboche's law beyond Melan's limit, on few cells."""
    scene = pressed(4.5e9, CHABOCHE, cycles=2)
    grid = scene.grid.model_copy(update={"cells": (13, 13), "layers": 10})
    fem = scene.fem.model_copy(update={"cells_per_radius": 3})
    solver = scene.solver.model_copy(update={"tolerance": tolerance})
    return scene.model_copy(update={"grid": grid, "fem": fem, "solver": solver})


def missed(stress, x, length, found):
    """What the identity misses in the cells that flow with the yield stress 1 GPa, over their work."""
    s, flows = stress.copy(), length > 1e-3 * length.max()
    s[:3] -= stress[:3].mean(axis=0)
    work = np.tensordot(TWICE[: len(s)], s * x, axes=1)
    assert found.dissipated.min() >= 0 and found.error.min() >= 0
    miss = work - 1e9 * length - found.stored - found.dissipated - found.error
    return float(np.abs(miss[flows] / work[flows]).max())


def test_every_point_of_sam_balances_in_a_solve():
    """To the tolerance of the flow rule: 1e-12 of the yield stress over 2 mu of the smallest increments."""
    kept, steps = [], 0
    result = solve(two_cycles(), SAM, checkpoint=kept.append)
    records = [each.record(Progressed) for each in kept]
    for old, new in pairwise(records):
        before, now = old.state.points, new.state.points
        if before.peeq.shape != now.peeq.shape or not (now.peeq - before.peeq).any():
            continue
        (C, g), x = constants(CHABOCHE.values(), before.back), now.strain - before.strain
        length, steps = now.peeq - before.peeq, steps + 1
        found = step_energies(C, g, before.back, x, length=length)
        stress = conditions.at_points(two_cycles(), new.last.stress, now.strain)
        assert missed(stress, x, length, found) < 1e-10
    assert steps >= 4
    depths, scene = choose_grid(two_cycles()).depths, two_cycles()
    assert max(conditions.flow(scene, kept, depths)[name] for name in ("direction", "yield")) < 1e-10
    assert max(conditions.yields(scene, result, state) for state in ("peak", "unloaded")) < 1e-10
    without = scene.body.plasticity.model_copy(update={"kinematic": None})
    without = scene.model_copy(update={"body": scene.body.model_copy(update={"plasticity": without})})
    assert conditions.flow(without, kept, depths)["direction"] > 1e-3


def test_every_point_of_the_elements_balances_in_a_solve():
    """To rounding: the history of a step is that of its return map."""
    scene = two_cycles(tolerance=1e-8)
    model, steps = load_steps(scene)
    unit, flowing = model.scales, 0
    states = [model.virgin(), *(step.state for step in steps)]
    for old, new in pairwise(states):
        length = unit.strain * (new.history.peeq - old.history.peeq)
        if not length.any():
            continue
        x = unit.strain * (new.history.plastic_strain - old.history.plastic_strain)
        x[3] /= 2
        C, g = constants(CHABOCHE.values(), old.history.back)
        found, flowing = step_energies(C, g, unit.strain * old.history.back, x, length=length), flowing + 1
        assert missed(unit.pressure * model.stress(new), x, length, found) < 1e-10
    assert flowing > 4
    finite = [axisymmetric.Finite(scene, model, step) for step in steps]
    assert max(each.yields() for each in finite) < 1e-10
    assert max(max(new.flow(old).values()) for old, new in pairwise(finite)) < 1e-10


@pytest.mark.parametrize("ends", [(0.0, 1e-7), (0.0, 0.03), (1e-3, 0.3)])
def test_work_of_swifts_law_is_its_closed_form(ends):
    law = Swift(1780e6, 4.0, 0.095, 1e6)
    before, after = (law.stress(np.array(end)) * (law.C + law.alpha * end) for end in ends)
    exact = (after - before) / law.alpha / (law.n + 1)
    assert plastic_work(law, np.array(ends[1]), ends[0]) == pytest.approx(exact, rel=1e-7)
