# SPDX-License-Identifier: MIT
"""Active set with multipliers: one answer from any start, no ping-pong, conditions of contact on the returned
field.
"""

import numpy as np
import pytest
from builders import RADIUS, scene as small_scene

from fem_reference.axisymmetric.elements import surface_weights
from fem_reference.axisymmetric.model import axis_pressure, build, edge_radius
from fem_reference.axisymmetric.planner import plan
from fem_reference.axisymmetric.problem import ContactProblem
from fem_reference.common import contact
from fem_reference.common.contact import ActiveSet, equilibrium


def scene(cells=8, counter=None, shape="sphere", poisson=0.3):
    return small_scene(
        body={"poisson": poisson},
        counterbody={"shape": shape, "radius": RADIUS, **(counter or {})},
        fem={"cells_per_radius": cells},
    )


ALUMINIUM = {"young": 70e9, "poisson": 0.2}
STARTS = {
    "apex": lambda r: r == 0.0,
    "everything": lambda r: r >= 0.0,
    "half": lambda r: r <= 0.5,
    "random": lambda r: np.random.default_rng(3).random(r.size) < 0.5,
}


@pytest.mark.parametrize("counter", [None, ALUMINIUM], ids=["rigid", "elastic"])
@pytest.mark.parametrize("start", STARTS)
def test_same_answer_from_any_start(start, counter):
    """The contact of a convex problem is unique: same set, displacements equal up to the rounding of the
    solver.
    """
    model = build(plan(scene(counter=counter)))
    force = model.scales.peak_force
    good = equilibrium(model.problem, force, model.radii <= 1.0)
    other = equilibrium(model.problem, force, STARTS[start](model.radii))
    assert good.converged
    assert other.converged
    assert np.array_equal(good.active, other.active) and np.abs(good.u - other.u).max() < 1e-11
    assert good.iterations <= 2
    assert 2 <= other.iterations <= 25


@pytest.mark.parametrize("counter", [None, ALUMINIUM], ids=["rigid", "elastic"])
@pytest.mark.parametrize("shape", ["sphere", "punch"])
def test_conditions_on_the_returned_field(shape, counter):
    """Balance of every body, force, signs and gaps, from displacements and stiffness alone (rounding:
    1e-11).
    """
    model = build(plan(scene(shape=shape, counter=counter)))
    problem, force = model.problem, model.scales.peak_force
    state = equilibrium(problem, force, model.radii <= 0.8)
    normal, far = problem.normal, problem.fixed
    forces = [block.solid.stiffness @ problem.body(state.u, i) for i, block in enumerate(problem.blocks)]
    total = np.concatenate(forces)
    for dofs in normal:  # every body carries the whole force, pressed into it
        assert total[dofs].sum() == pytest.approx(force, rel=1e-10)
        assert total[dofs][1:].min() >= -1e-11 * force
        assert np.abs(total[dofs] - state.multipliers).max() < 1e-11 * force
    assert np.abs(total[np.setdiff1d(np.flatnonzero(~far), normal.ravel())]).max() < 1e-11 * force
    gap = model.initial_gap(model.radii) + state.u[normal].sum(axis=0) - state.approach
    assert np.abs(gap[state.active]).max() < 1e-13 * state.approach and gap.min() > -1e-13 * state.approach
    assert state.active[0]
    # the supports on the outer boundary balance the same force
    outer = problem.blocks[0].solid.boundary_dofs("far", 1)
    assert forces[0][outer].sum() == pytest.approx(-force, rel=1e-10)


@pytest.mark.parametrize("ratio", [1e-12, 1e12])
def test_one_body_much_stiffer_is_rigid(ratio):
    """Moduli 10^12 apart, either way round: the approach is that on a rigid body, up to 1e-12 and
    rounding.
    """
    two = build(plan(scene(counter={"young": 210e9 * ratio, "poisson": 0.3})))
    one = build(plan(scene()))
    states = [equilibrium(m.problem, m.scales.peak_force, m.radii <= 1.0) for m in (two, one)]
    assert states[0].converged and states[0].iterations <= 2
    assert states[0].approach == pytest.approx(states[1].approach, rel=1e-11)


def test_equal_bodies_deform_alike():
    """Mirror symmetry: each body takes half the approach and the profile r^2/2 in half, node by node."""
    model = build(plan(scene(counter={"young": 210e9, "poisson": 0.3})))
    state = equilibrium(model.problem, model.scales.peak_force, model.radii <= 1.0)
    first, second = (model.problem.body(state.u, i) for i in (0, 1))
    assert np.abs(first - second).max() < 1e-11
    in_contact = state.u[model.problem.normal[0, state.active]]
    assert in_contact == pytest.approx(
        0.5 * (state.approach - 0.5 * model.radii[state.active] ** 2), abs=1e-11
    )


def test_set_corrections():
    """Negative multipliers leave, negative gaps enter, rounding changes nothing, the apex stays."""
    s = ActiveSet(np.array([True, True, True, False, False]))
    assert s.update(np.array([-1.0, 0.5, -0.1, 0.0, 0.0]), np.array([0.0, 0.0, 0.0, -0.1, 0.2]))
    assert s.active.tolist() == [True, True, False, True, False]
    assert not s.update(np.array([-1.0, 0.5, 0.0, -1e-12, 0.0]), np.array([0.0, 0.0, 0.3, 0.0, -1e-12]))
    assert s.active.tolist() == [True, True, False, True, False]


def test_ping_pong_is_broken_or_reported():
    """Two nodes that want to swap for ever: corrections become single, and if even these repeat the set is
    stuck.
    """
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


def test_a_set_that_never_settles_is_not_converged(monkeypatch):
    """The loop ends, and says that it did not converge."""

    def restless(self, _multipliers, _gaps):
        self.active = self.active.copy()
        self.active[5] ^= True
        return True

    model = build(plan(scene(cells=4)))
    monkeypatch.setattr(contact, "MAX_ITERATIONS", 6)
    monkeypatch.setattr(ActiveSet, "update", restless)
    state = equilibrium(model.problem, 1.0, model.radii <= 1.0)
    assert state.iterations == 6 and not state.converged


def test_residual_is_measured_not_assumed(monkeypatch):
    """A tangent 1 % off still converges to the same state (the residual decides), in more iterations."""
    model = build(plan(scene(cells=4)))
    exact = equilibrium(model.problem, 1.0, model.radii <= 1.0)
    tangent = ContactProblem.tangent
    monkeypatch.setattr(ContactProblem, "tangent", lambda self, u: 1.01 * tangent(self, u))
    inexact = equilibrium(model.problem, 1.0, model.radii <= 1.0)
    assert inexact.converged and inexact.iterations > exact.iterations
    # the residual criterion 1e-9 and the condition of the matrix leave about 1e-7
    assert inexact.approach == pytest.approx(exact.approach, rel=1e-7)


def test_unloaded_state_is_at_rest():
    model = build(plan(scene(cells=4)))
    state = model.virgin()
    assert not state.u.any() and not state.multipliers.any()
    assert model.contact_radius(state) == 0.0 and not model.nodal_pressure(state).any()


def test_pressure_recovery_is_exact_for_its_own_form():
    """An even parabola on the axis, and a gap that opens with (r - a)^(3/2), are reproduced up to
    rounding.
    """
    r = np.array([0.1, 0.2, 0.3, 0.4])
    area = surface_weights(np.concatenate([[0.0], r]))[1:]
    assert axis_pressure(r, 3.0 - 2.0 * r**2, area) == pytest.approx(3.0, rel=1e-13)
    r, a = np.linspace(0.0, 2.0, 41), 1.013  # not on a node
    gap = np.clip(r - a, 0.0, None) ** 1.5
    assert edge_radius(r, gap, 20) == pytest.approx(a, rel=1e-12)
    assert edge_radius(r[:23], gap[:23], 20) == r[20]  # too few nodes outside
    assert edge_radius(r, 1.0 + r, 20) >= r[18]  # within an element


def test_three_bodies_are_refused():
    model = build(plan(scene(cells=4)))
    with pytest.raises(ValueError, match="blocks: 3"):
        ContactProblem(model.problem.blocks * 3, model.problem.gap0)
