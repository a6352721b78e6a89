# SPDX-License-Identifier: MIT
"""Full slip, q = mu p along x: the traction in the gap and in the stress, given tractions, and paths."""

from dataclasses import replace
from functools import cache
from itertools import product

import numpy as np
import pytest
from builders import STEEL, SWIFT, scene as small_scene
from made_results import line
from plastic_start import begin

import sam
from sam.contact.convolution import Counters
from sam.contact.normal import Search, solve_contact
from sam.contact.operators import SurfaceOperators
from sam.elastic.problem import sliding_of
from sam.grid.cells import Window
from sam.kernels.patches import Lags, displacement_coefficients, parity
from sam.planner.bodies import Bodies
from sam.scene import Scene
from sam.schedule import Load
from verification.reference.quadrature import patch_response

ALUMINIUM = {"young": 70e9, "poisson": 0.33}


def scene(coefficient=0.4, counterbody=None, cells=33, *, friction=None, **loading) -> Scene:
    return small_scene(
        counterbody=counterbody or {},
        loading=loading,
        friction=None if coefficient is None else {"coefficient": coefficient, **(friction or {})},
        grid={"cells": (cells, cells)},
    )


def coupling_of(a_scene: Scene) -> float:
    """2 beta mu, with which the traction enters the gap."""
    slip = sam.plan(a_scene).slip
    return slip.coupling * slip.coefficient


@pytest.mark.parametrize("counterbody", [{}, ALUMINIUM], ids=["rigid", "aluminium"])
def test_traction_moves_both_bodies_as_point_forces_do(counterbody):
    """u_z of body 1 under q and of body 2 under -q, by quadrature of Cerruti's solution."""
    a_scene = scene(0.37, counterbody)
    rng, modulus, h = np.random.default_rng(1), Bodies(a_scene).pair.contact_modulus, 2e-7
    pressure = rng.random((3, 2))

    @cache
    def moved(lag_x, lag_y):
        at, out = (1.0 * lag_x, 0.8 * lag_y, 0.0), 0.0
        for constants, sign in ((STEEL, 1), *([(counterbody, -1)] if counterbody else [])):
            mu = constants["young"] / (2 * (1 + constants["poisson"]))
            out += sign * patch_response(1, at, (0.5, 0.4), constants["poisson"])[8] / mu
        return 0.37 * h * out

    expected = np.zeros((5, 4))
    for (i, j), (k, m) in product(np.ndindex(5, 4), np.ndindex(3, 2)):
        expected[i, j] += pressure[k, m] * moved(i - k - 1, j - m - 2)
    grid = SurfaceOperators((8, 8), 0.8, Counters(), coupling=coupling_of(a_scene))
    found = grid.tangential(Window(1, 2, 3, 2), Window(0, 0, 5, 4))(2 * pressure / modulus) * h
    assert np.abs(found - expected).max() <= 1e-11 * np.abs(expected).max()


def test_the_mismatch_is_dundurs_and_zero_between_like_bodies():
    """2 beta of (1 - 2 nu)/mu and (1 - nu)/mu of both bodies; rigid: (1 - 2 nu)/(2 (1 - nu))."""
    assert Bodies(scene()).pair.tangential_mismatch == pytest.approx(0.4 / 0.7, rel=1e-14)
    assert Bodies(scene(counterbody=STEEL)).pair.tangential_mismatch == 0.0
    assert coupling_of(scene(counterbody=STEEL)) == 0.0
    assert coupling_of(scene(friction={"coupling": False})) == 0.0
    mu, other = 210e9 / 2.6, 70e9 / 2.66
    beta = (0.4 / mu - 0.34 / other) / (2 * (0.7 / mu + 0.67 / other))
    assert Bodies(scene(counterbody=ALUMINIUM)).pair.tangential_mismatch == pytest.approx(2 * beta, rel=1e-13)


def dense(n, h, load, tangential):
    """Matrix of u by pressure, E* = 1 (u_hat of p_hat = 2 p), all lags."""
    lag = np.arange(n)[:, None] - np.arange(n)
    kernel = h * 2 * displacement_coefficients(Lags(n, n, 1.0, 1.0), nu=0.0, component=3, load=load)
    sign = np.where(lag < 0, parity("3", load)[0], 1)
    matrix = kernel[np.abs(lag)[:, :, None, None], np.abs(lag)[None, None]] * sign[:, :, None, None]
    return np.moveaxis(matrix, 2, 1).reshape(n * n, n * n) * tangential


@pytest.mark.parametrize("coupling", [0.23, 3.0, "field"])
def test_equal_to_a_direct_solution(coupling):
    """Dense equations on an active set; 1e-9 of the largest pressure (measured 6e-11)."""
    n = 25
    h, rng = 4.0 / n, np.random.default_rng(3)
    x = (np.arange(n) - (n - 1) / 2) * h
    gap0 = (x[:, None] ** 2 + x[None, :] ** 2) / 2
    coupling = 0.4 * rng.random((n, n)) if coupling == "field" else coupling
    counters = Counters()
    contact = solve_contact(gap0, (h, h), 1.0, 4 / 3, coupling=coupling, search=Search(counters=counters))
    matrix = dense(n, h, 3, 1.0) + dense(n, h, 1, np.broadcast_to(coupling, (n, n)).ravel()[None, :])
    active = contact.pressure.ravel() > 0
    size = int(active.sum())
    system = np.ones((size + 1, size + 1))
    system[:size, :size], system[:size, size], system[size, size] = matrix[np.ix_(active, active)], -1.0, 0.0
    solution = np.linalg.solve(system, np.append(-gap0.ravel()[active], 4 / 3 / h**2))
    pressure = np.zeros(n * n)
    pressure[active] = solution[:size]
    gap = gap0.ravel() + matrix @ pressure - solution[size]
    assert (solution[:size] > 0).all() and (gap[~active] > 0).all()
    assert contact.converged and counters.tangential_kernels == 1
    assert np.abs(contact.pressure.ravel() - pressure).max() <= 1e-9 * pressure.max()
    assert contact.approach == pytest.approx(solution[size], rel=1e-9)
    assert np.abs(contact.gap.ravel() - gap).max() <= 1e-9 * solution[size]


@pytest.mark.parametrize(
    ("coefficient", "options", "left_out"),
    [
        (0.0, {}, "tangential kernels"),
        (0.4, {"counterbody": STEEL}, "coupling"),
        (0.4, {"friction": {"coupling": False}}, "coupling"),
    ],
)
def test_where_traction_moves_no_gap_the_contact_is_that_without_friction(coefficient, options, left_out):
    """No kernel for the contact, the pressure bit for bit; the stress feels a traction."""
    without = {key: value for key, value in options.items() if key != "friction"}
    plain, sliding = sam.solve(scene(None, **without)), sam.solve(scene(coefficient, **options))
    assert sliding.left_out[0].stage == left_out and plain.discretisation["tangential_kernels"] == 0
    assert np.array_equal(line(plain, "p_Pa"), line(sliding, "p_Pa"))
    assert (sliding.quantities == plain.quantities) is (coefficient == 0.0)
    assert sliding.cost["displacement_applications"] == plain.cost["displacement_applications"]
    counters = Counters()
    sam.plan(scene(coefficient, **options)).problem(counters).contact(Load(0.65))
    assert counters.tangential_kernels == 0


def test_alternating_traction_mirrors_the_even_cycles():
    odd, even = (
        sam.solve(scene(0.3, cycles=cycles, friction={"direction": "alternating"})) for cycles in (3, 2)
    )
    for name, sign in (("p_Pa", 1), ("qx_Pa", -1), ("ux_m", -1)):
        there = sign * line(odd, name)[::-1]
        assert line(even, name) == pytest.approx(there, abs=1e-7 * np.abs(there).max())
    assert odd.tables["cycles"]["friction_coefficient"] == pytest.approx([0.3] * 3, rel=1e-12)
    assert odd.tables["cycles"]["friction_sign"] == [1, -1, 1]
    assert even.quantities["friction_coefficient"] == pytest.approx(0.3, rel=1e-12)


def test_bodies_that_change_places_have_the_same_normal_displacement_beyond_their_share():
    """The normal displacement of a body by the traction, less its share of that of the contact.

    Those of both bodies add up to that of the contact, and the shares to 1: what is beyond is one number.
    """
    found = []
    for body, counterbody in ((STEEL, ALUMINIUM), (ALUMINIUM, STEEL)):
        pair = small_scene(body=body, counterbody=counterbody, friction=0.4, grid={"cells": (21, 21)})
        problem, load = sam.plan(pair).problem(Counters()), Load(0.65)
        state = problem.state(load, problem.contact(load))
        found.append((state, sliding_of(state).uz))
    (state, uz), (other, _) = found
    swapped = sliding_of(replace(state, problem=other.problem)).uz
    assert np.abs(uz - swapped).max() <= 1e-12 * np.abs(uz).max() and uz.any()


def test_a_traction_of_a_field_of_coefficients():
    """The coefficient may differ from cell to cell: q = coefficient * p in the gap and in the stress."""
    model, now = begin(small_scene(body={"plasticity": SWIFT}, friction=0.3, grid={"cells": (17, 17)}))
    rng, problem = np.random.default_rng(5), model.problem(now.extent)
    field = rng.random(now.state.pressure.shape)
    pressure, keep = now.state.pressure, problem.operator.keep  # a smooth scene is mirrored in y
    found = replace(problem, coefficient=field).stress(pressure, Load(1.0, sign=-1.0))
    loaded = pressure * problem.unit
    expected = problem.operator.stress(keep(loaded), traction=keep(-field * loaded))
    assert np.array_equal(found, expected)
