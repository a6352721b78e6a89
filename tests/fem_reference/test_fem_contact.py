# SPDX-License-Identifier: MIT
"""The contact iteration: one answer from any start, no ping-pong; what solves share changes nothing."""

from types import SimpleNamespace

import numpy as np
import pytest
import scipy.sparse as sp
from builders import RADIUS, SWIFT, scene as small_scene
from scipy.sparse.linalg import aslinearoperator

import fem_reference
from fem_reference import spatial
from fem_reference.axisymmetric import problem as plane
from fem_reference.axisymmetric.model import axis_pressure, build
from fem_reference.axisymmetric.planner import plan
from fem_reference.axisymmetric.problem import ContactProblem, refined
from fem_reference.common.contact import ActiveSet, equilibrium
from fem_reference.common.quadrilaterals import surface_weights
from fem_reference.common.recovery import edge_radius
from fem_reference.spatial import problem
from fem_reference.spatial.multigrid import Coarsest, UnsolvedError, solve


def model_of(cells=8, shape="sphere", **counter):
    counter = {"shape": shape, "radius": RADIUS, **counter}
    return build(plan(small_scene(counterbody=counter, fem={"cells_per_radius": cells})))


COUNTERS = [{}, {"young": 70e9, "poisson": 0.2}]
STARTS = {
    "apex": lambda r: r == 0.0,
    "everything": lambda r: r >= 0.0,
    "random": lambda r: np.random.default_rng(3).random(r.size) < 0.5,
}


@pytest.mark.parametrize("counter", COUNTERS, ids=["rigid", "elastic"])
@pytest.mark.parametrize("start", STARTS)
def test_same_answer_from_any_start(start, counter):
    """The contact of a convex problem is unique: same set, displacements equal to rounding."""
    model = model_of(**counter)
    force = model.scales.peak_force
    good, other = (
        equilibrium(model.problem, force, nodes) for nodes in (model.radii <= 1.0, STARTS[start](model.radii))
    )
    assert good.converged and other.converged
    assert np.array_equal(good.active, other.active) and np.abs(good.u - other.u).max() < 1e-11
    assert good.work.newton <= 2 <= other.work.newton <= 25


def test_equal_bodies_deform_alike():
    """Mirror symmetry: each body takes half the approach and the profile r^2/2 in half, node by node."""
    model = model_of(young=210e9, poisson=0.3)
    state = equilibrium(model.problem, model.scales.peak_force, model.radii <= 1.0)
    first, second = (model.problem.body(state.u, i) for i in (0, 1))
    assert np.abs(first - second).max() < 1e-11
    half = 0.5 * (state.approach - 0.5 * model.radii[state.active] ** 2)
    assert state.u[model.problem.normal[0, state.active]] == pytest.approx(half, abs=1e-11)


# --- the set of nodes in contact ---


def test_set_corrections():
    """Negative multipliers leave, negative gaps enter, rounding changes nothing, the apex stays."""
    s = ActiveSet(np.array([True, True, True, False, False]))
    assert s.update(np.array([-1.0, 0.5, -0.1, 0.0, 0.0]), np.array([0.0, 0.0, 0.0, -0.1, 0.2]))
    assert s.active.tolist() == [True, True, False, True, False]
    assert not s.update(np.array([-1.0, 0.5, 0.0, -1e-12, 0.0]), np.array([0.0, 0.0, 0.3, 0.0, -1e-12]))
    assert s.active.tolist() == [True, True, False, True, False]


def test_a_set_without_anchor_keeps_its_last_node():
    """The first node may leave; the one with the largest multiplier never does: the force has to act."""
    free, tied = (ActiveSet(np.array([True, True, False]), anchored=anchored) for anchored in (False, True))
    for s in (free, tied):
        assert s.update(np.array([-1.0, 1.0, 0.0]), np.array([0.0, 0.0, 1.0])) == (s is free)
    assert free.active.tolist() == [False, True, False] and tied.active.tolist() == [True, True, False]
    assert not free.update(np.array([0.0, -1.0, 0.0]), np.array([1.0, 0.0, 1.0]))


def test_ping_pong_is_broken_or_reported():
    """Two nodes that want to swap for ever: corrections become single; if these repeat the set is stuck."""
    s = ActiveSet(np.array([True, True, True]))
    for _ in range(20):
        multipliers = np.where(s.active, [1.0, -1.0, -2.0], 0.0)
        gaps = np.where(s.active, 0.0, [0.0, -1.0, -2.0])
        assert s.update(multipliers, gaps)
        if s.stuck:
            break
    assert s.single and s.stuck
    s = ActiveSet(np.array([True, True, True]))
    for _ in range(20):  # both in: both want out; both out: both want in; one of them alone: at rest
        wrong = -1.0 if s.active[1] == s.active[2] else 1.0
        multipliers = np.where(s.active, [1.0, wrong, 2.0 * wrong], 0.0)
        gaps = np.where(s.active, 0.0, [0.0, wrong, 2.0 * wrong])
        if not s.update(multipliers, gaps):
            break
    assert s.active.tolist() == [True, False, True] and not s.stuck


def test_residual_is_measured_not_assumed(monkeypatch):
    """A tangent 1 % off still converges to the same state (the residual decides), in more iterations."""
    model, tangent = model_of(4), ContactProblem.tangent
    exact = equilibrium(model.problem, 1.0, model.radii <= 1.0)
    monkeypatch.setattr(ContactProblem, "tangent", lambda self, u: 1.01 * tangent(self, u))
    inexact = equilibrium(model.problem, 1.0, model.radii <= 1.0)
    assert inexact.converged and inexact.work.newton > exact.work.newton
    # the residual criterion 1e-9 and the condition of the matrix leave about 1e-7
    assert inexact.approach == pytest.approx(exact.approach, rel=1e-7)


def test_unloaded_state_is_at_rest():
    model = model_of(4)
    state = model.virgin()
    assert not state.u.any() and not state.multipliers.any()
    assert model.contact_radius(state) == 0.0 and not model.nodal_pressure(state).any()


def test_pressure_recovery_is_exact_for_its_own_form():
    """An even parabola on the axis, and a gap that opens with (r - a)^(3/2), up to rounding."""
    r = np.array([0.1, 0.2, 0.3, 0.4])
    area = surface_weights(np.concatenate([[0.0], r]))[1:]
    assert axis_pressure(r, 3.0 - 2.0 * r**2, area) == pytest.approx(3.0, rel=1e-13)
    r, a = np.linspace(0.0, 2.0, 41), 1.013  # not on a node
    gap = np.clip(r - a, 0.0, None) ** 1.5
    assert edge_radius(r, gap, 20) == pytest.approx(a, rel=1e-12)
    assert edge_radius(r[:23], gap[:23], 20) == r[20]  # too few nodes outside
    assert edge_radius(r, 1.0 + r, 20) >= r[18]  # within an element


# --- linear solves ---

STEPS = 3


def yielding(plastic=True, friction=0.0, cells=8, box=10.0):
    """A rigid sphere on Swift steel to p0 = 4 times the initial yield stress."""
    return small_scene(
        body={"plasticity": SWIFT if plastic else None},
        loading={"force": 0.171424, "steps": STEPS},
        friction=friction,
        fem={"cells_per_radius": cells, "box": box},
    )


IN_SPACE = {"friction": 0.2, "cells": 3, "box": 4.0}


def test_an_elastic_iteration_has_factors_of_its_own():
    """It is exact for its set: none has anything to refine."""
    cost = fem_reference.solve(yielding(plastic=False)).cost
    assert cost["factorizations"] == cost["newton_iterations"] <= 3 * STEPS and cost["linear_iterations"] == 0
    assert "multigrid_setups" not in cost


@pytest.mark.parametrize(
    ("model", "keys", "new_each_time", "count", "within", "also"),
    [
        (fem_reference, {}, (plane, "FEW", 1), "factorizations", 1e-8, "contact_radius_m"),
        (spatial, IN_SPACE, (problem, "SLOWER", 0), "multigrid_setups", 1e-7, "pressure_centroid_x_m"),
    ],
    ids=["factors", "hierarchies"],
)
def test_what_is_kept_changes_no_result(monkeypatch, model, keys, new_each_time, count, within, also):
    """Equal to what new factors, or a new hierarchy, in every iteration give; about two set-ups a step."""
    kept = model.solve(yielding(**keys))
    assert STEPS <= kept.cost[count] <= 3 * STEPS < kept.cost["newton_iterations"] <= 8 * STEPS
    assert 0 < kept.cost["linear_iterations"] <= 20 * kept.cost["newton_iterations"]
    monkeypatch.setattr(*new_each_time)
    new = model.solve(yielding(**keys))
    assert new.cost[count] == new.cost["newton_iterations"] > kept.cost[count]
    for name in ("p_max_Pa", "peeq_max", "approach_m", "mises_max_Pa", also):
        assert kept.quantities[name] == pytest.approx(new.quantities[name], rel=within)


def test_a_kept_inverse_serves_until_few_iterations_do_not_do():
    """Of a diagonal of 200 numbers: the exact inverse takes one, none at all far more than a few."""
    diagonal, right = np.arange(1.0, 201.0), np.ones(200)
    for inverse, expected in ((lambda r: r / diagonal, 1 / diagonal), (lambda r: r, None)):
        kept = SimpleNamespace(solve=inverse, target=1e-12, linear=0)
        found = refined(lambda u: diagonal * u, right, kept)
        assert (found is None) == (expected is None) and kept.linear > 0
        assert found is None or found == pytest.approx(expected, rel=1e-12)


def test_coarsest_level():
    """Exact, zero where the level has no such degree of freedom, no answer for an indefinite matrix."""
    A = np.array([[2.0, 0.0, 1.0], [0.0, 0.0, 0.0], [1.0, 0.0, 3.0]])
    x = Coarsest(sp.csr_matrix(A))(np.array([3.0, 5.0, 4.0]))
    assert x == pytest.approx([1.0, 0.0, 1.0], rel=1e-14)
    with pytest.raises(UnsolvedError):
        Coarsest(sp.csr_matrix([[1.0, 2.0], [2.0, 1.0]]))


@pytest.mark.parametrize("size", [20, 100])
@pytest.mark.parametrize("smallest", [1.0, 1e-8])
def test_a_system_with_friction_is_solved_below_a_preconditioner_that_hides_a_residual(size, smallest):
    """Its last entries make the residual of one equation small: an iteration that measures M r ends on it."""
    A = aslinearoperator(sp.diags_array([np.ones(size), np.full(size - 1, 0.9)], offsets=(0, 1)))
    M = aslinearoperator(sp.diags_array(np.append(np.ones(size - 1), smallest)))
    right = np.ones(size)
    x = solve(A, right, M, accuracy=3e-3, target=0.0, symmetric=False)
    assert np.linalg.norm(right - A @ x) <= 3e-3 * np.linalg.norm(right)
