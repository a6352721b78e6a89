# SPDX-License-Identifier: MIT
"""Sliding elastic contact: coupling of traction and gap, stresses, displacement of the surface. Full slip, q
= mu p along +x.
"""

from dataclasses import replace

import numpy as np
import pytest
from builders import STEEL, scene as small_scene
from made_results import line
from rounding import FAR_SCENE

import sam
from sam import choose_grid
from sam.contact.convolution import Counters
from sam.contact.normal import Search, solve_contact
from sam.contact.operators import SurfaceOperators
from sam.elastic.stress import plane_stress, sliding_of
from sam.grid.cells import Window
from sam.kernels.patches import Lags, displacement_coefficients, parity
from sam.planner.bodies import Bodies
from sam.scene import Scene, Solver, Status
from sam.schedule import Load
from verification.reference import hertz
from verification.reference.hamilton import sliding_stress
from verification.reference.quadrature import patch_response

ALUMINIUM = {"young": 70e9, "poisson": 0.33}
RIGID = {}
HERTZ = {"prescribed": "hertz", "p0": 4e9, "radius": 6e-6}


def scene(coefficient=0.4, counterbody=RIGID, cells=65, *, units=(1, 1), friction=None, grid=None, **loading):
    return small_scene(
        *units,
        counterbody=counterbody,
        loading=loading,
        friction=None if coefficient is None else {"coefficient": coefficient, **(friction or {})},
        grid={"cells": (cells, cells), **(grid or {})},
    )


def centroid(pressure, x):
    return float((pressure.sum(axis=1) * x).sum() / pressure.sum())


def coupling_of(a_scene: Scene) -> float:
    """2 beta mu, with which the traction enters the gap."""
    slip = sam.plan(a_scene).slip
    return slip.coupling * slip.coefficient


@pytest.mark.parametrize("counterbody", [RIGID, ALUMINIUM], ids=["rigid", "aluminium"])
def test_traction_moves_both_bodies_as_point_forces_do(counterbody):
    """u_z of body 1 under q and of body 2 under -q, by quadrature of Cerruti's solution with each body's own
    constants.
    """
    a_scene = scene(0.37, counterbody)
    rng, modulus, h = np.random.default_rng(1), Bodies(a_scene).pair.contact_modulus, 2e-7
    pressure = rng.random((3, 2))
    expected = np.zeros((5, 4))
    for i, j in np.ndindex(5, 4):
        for k, m in np.ndindex(3, 2):
            for constants, sign in ((STEEL, 1), *([(counterbody, -1)] if counterbody else [])):
                mu = constants["young"] / (2 * (1 + constants["poisson"]))
                x, y = (i - k - 1) * 1.0, (j - m - 2) * 0.8
                u = patch_response(1, (x, y, 0.0), (0.5, 0.4), constants["poisson"])[8] / mu
                expected[i, j] += sign * 0.37 * pressure[k, m] * u * h
    grid = SurfaceOperators((8, 8), 0.8, Counters(), coupling=coupling_of(a_scene))
    found = grid.tangential(Window(1, 2, 3, 2), Window(0, 0, 5, 4))(2 * pressure / modulus) * h
    assert np.abs(found - expected).max() <= 1e-11 * np.abs(expected).max()


def test_the_mismatch_is_dundurs_and_zero_between_like_bodies():
    """Twice beta = ((1 - 2 nu1)/mu1 - (1 - 2 nu2)/mu2)/(2 ((1 - nu1)/mu1 + (1 - nu2)/mu2)); rigid: (1 - 2
    nu)/(2 (1 - nu)).
    """
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


@pytest.mark.parametrize("coupling", [0.23, 0.8, 3.0, "field"])
def test_equal_to_a_direct_solution(coupling):
    """Dense equations on an active set, solved without any lag; 1e-9 of the largest pressure (measured
    6e-11).
    """
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


def test_a_wrong_sign_of_the_traction_leaves_a_gap():
    """The certificate is measured with the current traction: that of the opposite one is open by percents."""
    n = 33
    x = (np.arange(n) - (n - 1) / 2) * 4.0 / n
    gap0 = (x[:, None] ** 2 + x[None, :] ** 2) / 2
    contact = solve_contact(gap0, (4 / n, 4 / n), 1.0, 4 / 3, coupling=0.2)
    grid = SurfaceOperators((n, n), 1.0, Counters(), coupling=0.2)
    p_hat = contact.pressure * 2
    for sign, low, high in ((1.0, 0.0, 1e-9), (-1.0, 0.5, 10.0)):
        gap = gap0 * n / 4 + grid.displacement(p_hat, grid.whole, grid.whole, sign)
        spread = np.ptp(gap[contact.pressure > 0]) / (grid.self_influence * p_hat.max())
        assert low <= spread <= high


def test_the_pressure_leans_against_the_traction():
    """q along +x on the body presses the surface down in front and raises it behind: the centroid moves to
    -x, as mu does.
    """
    found = {}
    for coefficient in (0.1, 0.2, 0.4):
        a_scene = scene(coefficient)
        grid = choose_grid(a_scene)
        problem, force = sam.plan(a_scene).problem(Counters()), a_scene.loading.force
        contact, mirrored = (problem.contact(Load(force, sign)) for sign in (1.0, -1.0))
        found[coefficient] = centroid(contact.pressure, grid.x) / 6.05e-6
        assert np.abs(mirrored.pressure - contact.pressure[::-1]).max() <= 1e-8 * contact.pressure.max()
    assert -0.02 < found[0.1] < -0.005
    assert found[0.2] == pytest.approx(2 * found[0.1], rel=0.05)
    assert found[0.4] == pytest.approx(4 * found[0.1], rel=0.1)


def test_without_coefficient_every_bit_is_that_of_no_friction():
    """mu = 0, and no [friction]: no tangential kernel is built; all tables, quantities and counters are
    equal.
    """
    plain, zero = sam.solve(scene(None, unload=True)), sam.solve(scene(0.0, unload=True))
    assert zero.quantities == plain.quantities
    for name, table in plain.tables.items():
        for column, values in table.items():
            assert (
                np.array_equal(np.asarray(values), np.asarray(zero.tables[name][column]))
                or np.isnan(values).all()
            )
    for result in (plain, zero):
        assert result.discretisation["tangential_kernels"] == 0
        assert result.left_out[0].stage == "tangential kernels"


@pytest.mark.parametrize(
    "options", [{"counterbody": STEEL}, {"friction": {"coupling": False}}], ids=["like bodies", "decoupled"]
)
def test_where_traction_moves_no_gap_the_contact_is_that_without_friction(options):
    """No kernel for the contact, the pressure bit for bit; the stress feels the traction."""
    without = {key: value for key, value in options.items() if key != "friction"}
    plain, sliding = sam.solve(scene(None, **without)), sam.solve(scene(0.4, **options))
    assert sliding.left_out[0].stage == "coupling"
    assert np.array_equal(line(plain, "p_Pa"), line(sliding, "p_Pa"))
    assert sliding.quantities["mises_max_Pa"] > 1.05 * plain.quantities["mises_max_Pa"]
    assert sliding.cost["displacement_applications"] == plain.cost["displacement_applications"]
    a_scene = scene(0.4, **options)
    counters = Counters()
    sam.plan(a_scene).problem(counters).contact(Load(0.65))
    assert counters.tangential_kernels == 0


def test_line_and_coefficient_of_friction():
    result = sam.solve(scene(0.25, steps=2, unload=True))
    assert result.status is Status.CONVERGED
    assert line(result, "qx_Pa") == pytest.approx(0.25 * line(result, "p_Pa"), rel=1e-14)
    assert result.quantities["friction_coefficient"] == pytest.approx(0.25, rel=1e-12)
    p, q, local = (result.fields.cell_data[name] for name in ("p_Pa", "qx_Pa", "friction"))
    assert local[p > 0] == pytest.approx(0.25, rel=1e-12) and np.isnan(local[~(p > 0)]).all()
    assert q[p > 0] == pytest.approx(0.25 * p[p > 0], rel=1e-14)
    assert result.tables["history"]["friction_coefficient"] == pytest.approx([0.25, 0.25, 0.0], rel=1e-12)
    assert not line(result, "qx_Pa", "unloaded").any() and not line(result, "ux_m", "unloaded").any()


def test_alternating_traction_mirrors_the_even_cycles():
    odd = sam.solve(scene(0.3, cycles=3, friction={"direction": "alternating"}))
    even = sam.solve(scene(0.3, cycles=2, friction={"direction": "alternating"}))
    assert line(even, "p_Pa") == pytest.approx(line(odd, "p_Pa")[::-1], rel=1e-7, abs=1.0)
    assert line(even, "qx_Pa") == pytest.approx(-line(odd, "qx_Pa")[::-1], rel=1e-7, abs=1.0)
    assert line(even, "ux_m") == pytest.approx(-line(odd, "ux_m")[::-1], rel=1e-7, abs=1e-16)
    assert odd.tables["cycles"]["friction_coefficient"] == pytest.approx([0.3] * 3, rel=1e-12)
    assert odd.tables["cycles"]["friction_sign"] == [1, -1, 1]
    assert even.quantities["friction_coefficient"] == pytest.approx(0.3, rel=1e-12)
    assert even.quantities["mises_max_Pa"] == pytest.approx(odd.quantities["mises_max_Pa"], rel=1e-7)


def test_given_tractions_make_hamiltons_stresses():
    """72 cells across, y = 0, interior points: each component within 0.5 % of p0; the opposite traction is
    far off.
    """
    depths = 6e-6 * np.array([0.1, 0.2, 0.3, 0.48, 0.7, 1.0, 1.5])
    a_scene = scene(0.4, grid={"cells": (145, 145), "depths": tuple(depths)}, **HERTZ)
    grid, counters = choose_grid(a_scene), Counters()
    assert 6e-6 / grid.hx == pytest.approx(36.25)
    problem, load = sam.plan(a_scene).problem(counters), Load(sam.plan(a_scene).schedule.peak.force)
    contact = problem.contact(load)
    stress = plane_stress(problem.state(load, contact))[..., 0]
    for friction, good in ((0.4, True), (-0.4, False)):
        exact = sliding_stress(
            grid.x[None, :], 0.0, depths[:, None], 4e9, contact_radius=6e-6, nu=0.3, friction=friction
        )
        error = np.abs(stress - np.moveaxis(exact, -1, 0)).max(axis=(1, 2)) / 4e9
        assert (error < 5e-3).all() == good
        assert good or error.max() > 0.2
    assert counters.contact_iterations == 0
    assert contact.load_error < 1e-5  # of the means over the cells that the edge cuts


def test_surface_moves_along_x_as_in_the_closed_form():
    """Johnson (1985) Eq. 3.91a for q0 sqrt(1 - r^2/a^2) and Eq. 3.41b for the pressure, inside the contact at
    y = 0.

    u_x = pi q0/(32 mu a) [4 (2 - nu) a^2 - (4 - 3 nu) x^2]; 1e-3 covers the cells of a/36 (measured 3e-4).
    """
    a, p0, nu, mu = 6e-6, 4e9, 0.3, 210e9 / 2.6
    result = sam.solve(scene(0.4, grid={"cells": (145, 145)}, **HERTZ))
    x, ux = line(result, "x_m"), line(result, "ux_m")
    inside = (np.abs(x) < 0.95 * a) & (x != 0)
    x, ux = x[inside], ux[inside]
    tangential = np.pi * 0.4 * p0 / (32 * mu * a) * (4 * (2 - nu) * a**2 - (4 - 3 * nu) * x**2)
    normal = -(1 - 2 * nu) * (1 + nu) / (3 * 210e9) * a**2 / x * p0 * (1 - (1 - x**2 / a**2) ** 1.5)
    assert np.abs(ux - tangential - normal).max() < 1e-3 * tangential.max()
    assert result.quantities["tangential_displacement_center_m"] == pytest.approx(tangential.max(), rel=1e-3)
    assert result.quantities["approach_m"] is None and np.isnan(line(result, "gap_m")).all()


@pytest.mark.parametrize("counterbody", [STEEL, ALUMINIUM], ids=["steel", "aluminium"])
def test_uz_is_that_of_the_body_alone(counterbody):
    """The part of the traction in u_z beside the contact: Cerruti's (1 - 2 nu)/(4 pi mu) times the integral
    of q x/r^2.

    The tractions of the result itself, as point forces in its cells: nearly two radii away that errs by less
    than 1e-3. Like bodies: the gap is not touched, u_z of each of them is.
    """
    a_scene = scene(0.4, counterbody, cells=97)
    grid = choose_grid(a_scene)
    result = sam.solve(a_scene)
    contact = sam.plan(a_scene).problem(Counters()).contact(Load(0.65))
    x, uz = line(result, "x_m"), line(result, "uz_m")
    point = -2
    i, j = np.nonzero(contact.pressure)
    load, dx = contact.pressure[i, j] * grid.hx * grid.hy, x[point] - grid.x[i]
    r2 = dx**2 + grid.y[j] ** 2
    traction = (1 - 2 * 0.3) / (4 * np.pi * 210e9 / 2.6) * 0.4 * (load * dx / r2).sum()
    normal = (1 - 0.3**2) / (np.pi * 210e9) * (load / np.sqrt(r2)).sum()
    assert uz[point] == pytest.approx(normal + traction, rel=1e-3)
    assert abs(traction) > 0.1 * normal


def test_sliding_costs_nothing_without_friction():
    a_scene = scene(None)
    counters, load = Counters(), Load(0.65)
    problem = sam.plan(a_scene).problem(counters)
    contact = problem.contact(load)
    before = counters.ffts
    assert sliding_of(problem.state(load, contact)) is None
    assert counters.ffts == before


def test_hertz_radius_is_the_given_one():
    result = sam.solve(scene(0.0, **HERTZ))
    assert result.status is Status.CONVERGED
    assert result.quantities["force_N"] == pytest.approx(2 / 3 * np.pi * 4e9 * 36e-12, rel=1e-5)
    assert result.quantities["contact_radius_m"] == pytest.approx(6e-6, rel=1e-12)
    axis = result.tables["axis"]
    answer = hertz.axis_stress(np.asarray(axis["z_m"]), 4e9, 6e-6, 0.3)
    assert np.abs(np.asarray(axis["szz_Pa"]) - answer[:, 2]).max() < 2e-3 * 4e9
    assert "contact search" in [each.stage for each in result.left_out]


def test_units_do_not_matter():
    """Iterations are equal where they stop far above rounding, see `rounding`; digits as those of contacts
    solved to 1e-10.
    """
    scaled = scene(0.4, units=(3.1e4, 7.3e-5))
    far = {"solver": Solver(tolerance=FAR_SCENE)}
    plain, other = (sam.solve(each.model_copy(update=far)) for each in (scene(0.4), scaled))
    assert other.cost["contact_iterations"] == plain.cost["contact_iterations"]
    plain, other = sam.solve(scene(0.4)), sam.solve(scaled)
    assert other.quantities["p_max_Pa"] / 7.3e-5 == pytest.approx(plain.quantities["p_max_Pa"], rel=1e-9)
    ux = other.quantities["tangential_displacement_center_m"] / 3.1e4
    assert ux == pytest.approx(plain.quantities["tangential_displacement_center_m"], rel=1e-9)


def test_passes_that_are_too_few_are_said():
    """beta mu far above 1 takes more iterations than are allowed: the contact does not call itself
    converged.
    """
    n = 33
    x = (np.arange(n) - (n - 1) / 2) * 4.0 / n
    gap0 = (x[:, None] ** 2 + x[None, :] ** 2) / 2
    contact = solve_contact(
        gap0, (4 / n, 4 / n), 1.0, 4 / 3, coupling=20.0, search=Search(max_iterations=200)
    )
    assert not contact.converged and contact.residual > 1e-3


def test_bodies_that_change_places_have_the_same_normal_displacement_beyond_their_share():
    """The normal displacement of a body by the traction, less its share of that of the contact.

    Those of both bodies add up to that of the contact, and the shares to 1: what is beyond is one number.
    """
    found = []
    for body, counterbody in ((STEEL, ALUMINIUM), (ALUMINIUM, STEEL)):
        pair = small_scene(body=body, counterbody=counterbody, friction=0.4, grid={"cells": (21, 21)})
        problem = sam.plan(pair).problem(Counters())
        load = Load(0.65)
        state = problem.state(load, problem.contact(load))
        found.append((state, sliding_of(state).uz))
    (state, uz), (other, _) = found
    swapped = sliding_of(replace(state, problem=other.problem)).uz
    assert np.abs(uz - swapped).max() <= 1e-12 * np.abs(uz).max() and uz.any()
