"""How often the finite-element models factorise, set up multigrid and iterate; and that what they keep
changes no result.
"""

import numpy as np
import pytest
import scipy.sparse as sp
from builders import SWIFT, scene as small_scene
from scipy.sparse.linalg import aslinearoperator, splu

import fem_reference
import fem_reference.spatial
from fem_reference.axisymmetric import problem as plane
from fem_reference.axisymmetric.model import build
from fem_reference.axisymmetric.planner import plan
from fem_reference.common.linear import nested_dissection
from fem_reference.spatial import problem
from fem_reference.spatial.multigrid import Coarsest, UnsolvedError, solve
from sam.scene.schema import Scene

STEPS = 3


def scene(plastic=True, friction=0.0, cells=8, box=10.0) -> Scene:
    """A rigid sphere on Swift steel to p0 = 4 times the initial yield stress, as
    verification/scenes/plastic-swift-rigid.toml.
    """
    return small_scene(
        body={"plasticity": SWIFT if plastic else None},
        loading={"force": 0.171424, "steps": STEPS},
        friction=friction,
        fem={"cells_per_radius": cells, "box": box},
    )


def test_factorizations_of_the_axisymmetric_model():
    """Two a step: of the elastic tangent for a guessed set, of the plastic one for the set. Further
    iterations with this set are solved by conjugate gradients with its factors, which a change of the tangent
    by 1e-3 leaves within about four iterations.
    """
    cost = fem_reference.solve(scene()).cost
    assert (
        cost["factorizations"] <= 3 * STEPS < cost["newton_iterations"]
    )  # a step may change its set once more
    assert 0 < cost["linear_iterations"] <= 5 * (cost["newton_iterations"] - cost["factorizations"])
    assert "multigrid_setups" not in cost


def test_factorizations_of_an_elastic_body():
    """An elastic iteration is exact for its set: each has another one, and none has anything to refine."""
    cost = fem_reference.solve(scene(plastic=False)).cost
    assert cost["factorizations"] == cost["newton_iterations"] <= 3 * STEPS and cost["linear_iterations"] == 0


@pytest.mark.parametrize("friction", [0.0, 0.2])
def test_set_ups_and_iterations_in_three_dimensions(friction):
    """A hierarchy a step, and another where the plastic zone outgrew it; a solve to 1 % takes some ten
    iterations.
    """
    cost = fem_reference.spatial.solve(scene(friction=friction, cells=4, box=6.0)).cost
    assert STEPS <= cost["multigrid_setups"] <= 2 * STEPS
    assert cost["newton_iterations"] <= 6 * STEPS
    assert cost["linear_iterations"] <= 20 * cost["newton_iterations"] and "factorizations" not in cost


@pytest.mark.parametrize(
    "model, keys, new_each_time, count, within, also",
    [
        (fem_reference, {}, (plane, "FEW", 1), "factorizations", 1e-8, "contact_radius_m"),
        (
            fem_reference.spatial,
            {"friction": 0.2, "cells": 4, "box": 6.0},
            (problem, "SLOWER", 0),
            "multigrid_setups",
            1e-7,
            "pressure_centroid_x_m",
        ),
    ],
    ids=["factors", "hierarchies"],
)
def test_what_is_kept_changes_no_result(monkeypatch, model, keys, new_each_time, count, within, also):
    """Equal to what new factors, or a new hierarchy, in every iteration give.

    Within what equilibrium leaves open: 1e-9 of the force.
    """
    kept = model.solve(scene(**keys))
    monkeypatch.setattr(*new_each_time)
    new = model.solve(scene(**keys))
    assert new.cost[count] == new.cost["newton_iterations"] > kept.cost[count]
    for name in ("p_max_Pa", "peeq_max", "approach_m", "mises_max_Pa", also):
        assert kept.quantities[name] == pytest.approx(new.quantities[name], rel=within)


def test_a_hierarchy_that_no_longer_does_is_made_anew(monkeypatch):
    """One that is kept and fails costs a set-up, not the load step."""
    alone, keep, fresh = problem.solve, problem.Kept.keep, []

    def solve(*arguments, **keys):
        if not fresh:
            raise UnsolvedError("no solution")
        fresh.clear()
        return alone(*arguments, **keys)

    usual = fem_reference.spatial.solve(scene(friction=0.2, cells=4, box=6.0))
    monkeypatch.setattr(problem, "solve", solve)
    monkeypatch.setattr(problem.Kept, "keep", lambda self, *of: fresh.append(1) or keep(self, *of))
    again = fem_reference.spatial.solve(scene(friction=0.2, cells=4, box=6.0))
    assert again.converged and again.cost["step_cuts"] == 0
    assert again.cost["multigrid_setups"] == again.cost["newton_iterations"] > usual.cost["multigrid_setups"]
    assert again.quantities["peeq_max"] == pytest.approx(usual.quantities["peeq_max"], rel=1e-7)


def test_separators_come_after_what_they_separate():
    """The line across the middle of 30 x 40 elements is the last part, and no other one is on both of its
    sides.
    """
    part = nested_dissection(30, 40)
    assert part.shape == (61, 81)
    last = np.argwhere(part == part.max())
    assert (last[:, 1] == 40).all() and len(last) == 61
    assert not set(part[:, :40].ravel()) & set(part[:, 41:].ravel())


def test_order_of_elimination_fills_in_no_more_than_minimum_degree():
    """Entries of the factors of the stiffness matrix, supports eliminated, in both orders."""
    found = build(plan(scene(cells=16))).problem
    T = found.elimination(np.zeros(found.gap0.size, dtype=bool))[0]
    A = (T.T @ found.blocks[0].solid.stiffness @ T).tocsc()
    options = {"diag_pivot_thresh": 0.0, "options": {"SymmetricMode": True}}
    own, other = (splu(A, permc_spec=order, **options).L.nnz for order in ("NATURAL", "MMD_AT_PLUS_A"))
    assert own <= 1.05 * other


def test_coarsest_level():
    """Exact, zero where the level has no such degree of freedom, and no answer for a matrix that is not
    definite.
    """
    A = np.array([[2.0, 0.0, 1.0], [0.0, 0.0, 0.0], [1.0, 0.0, 3.0]])
    x = Coarsest(sp.csr_matrix(A))(np.array([3.0, 5.0, 4.0]))
    assert x == pytest.approx([1.0, 0.0, 1.0], rel=1e-14)
    with pytest.raises(UnsolvedError):
        Coarsest(sp.csr_matrix([[1.0, 2.0], [2.0, 1.0]]))


@pytest.mark.parametrize("size", [20, 50, 100])
@pytest.mark.parametrize("smallest", [1.0, 1e-5, 1e-8])
def test_a_system_with_friction_is_solved_below_a_preconditioner_that_hides_a_residual(size, smallest):
    """Its last entries make the residual of one equation small: an iteration that measures M r ends on it."""
    A = aslinearoperator(sp.diags_array([np.ones(size), np.full(size - 1, 0.9)], offsets=(0, 1)))
    M = aslinearoperator(sp.diags_array(np.append(np.ones(size - 1), smallest)))
    right = np.ones(size)
    x = solve(A, right, M, accuracy=3e-3, target=0.0, symmetric=False)
    assert np.linalg.norm(right - A @ x) <= 3e-3 * np.linalg.norm(right)
