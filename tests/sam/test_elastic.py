# SPDX-License-Identifier: MIT
"""Scenes through the semi-analytical solver, against Hertz and against each other."""

import numpy as np
import pytest
from builders import STEEL, scene as small_scene
from rounding import FAR_SCENE, close
from scipy.integrate import quad

import sam
from sam import choose_grid
from sam.planner.bodies import Bodies, hertz_semi_axes
from sam.scene import Solver, Status
from verification.reference import flat_punch, hertz


def scene(counterbody=None, body=None, grid=None, **loading):
    return small_scene(body=body or {}, counterbody=counterbody or {}, loading=loading, grid=grid)


def rigid_hertz(a_scene):
    """(a, p0) by an independent formula: a^3 = 3 F R/(4 E*), p0 = 3 F/(2 pi a^2)."""
    body, other, force = a_scene.body, a_scene.counterbody, a_scene.loading.force
    modulus = hertz.effective_modulus(body.young, body.poisson, other.young, other.poisson)
    a = (3 * force * other.radius / (4 * modulus)) ** (1 / 3)
    return a, 1.5 * force / (np.pi * a**2)


@pytest.mark.parametrize(
    "counterbody", [{}, STEEL, {"young": 70e9, "poisson": 0.33}], ids=["rigid", "steel", "aluminium"]
)
def test_sphere(counterbody):
    """Default grid, 129 x 129 cells over four contact radii. Measured: p_max 3.6e-5, approach 4.5e-5, radius
    1.8e-4.
    """
    a_scene = scene(counterbody)
    result = sam.solve(a_scene)
    a, p0 = rigid_hertz(a_scene)
    q = result.quantities
    assert result.status is Status.CONVERGED and result.message == ""
    assert q == q | {
        "p_max_Pa": pytest.approx(p0, rel=1e-4),
        "p_center_Pa": q["p_max_Pa"],
        "approach_m": pytest.approx(a**2 / a_scene.counterbody.radius, rel=1e-4),
        "force_N": pytest.approx(0.65, rel=1e-12),
    }
    assert (q["mises_max_Pa"], q["mises_max_depth_m"]) == pytest.approx((0.6200 * p0, 0.481 * a), rel=5e-3)
    assert q["contact_radius_m"] == pytest.approx(a, rel=1e-3)
    # the body alone: u_z(0) = (1 - nu^2)/E x pi p0 a/2
    line = result.tables["line"]
    uz = np.asarray(line["uz_m"])[np.abs(line["x_m"]).argmin()]
    assert uz == pytest.approx((1 - 0.3**2) / 210e9 * np.pi * p0 * a / 2, rel=1e-4)


def test_axis_stresses_follow_the_closed_form():
    """All components over two contact radii; 0.2 % of p0 covers the cells of a/32 near the surface."""
    a_scene = scene()
    axis = sam.solve(a_scene).tables["axis"]
    a, p0 = rigid_hertz(a_scene)
    answer = hertz.axis_stress(np.asarray(axis["z_m"]), p0, a, 0.3)
    names = ("sxx_Pa", "syy_Pa", "szz_Pa", "syz_Pa", "sxz_Pa", "sxy_Pa")
    assert np.abs(np.stack([axis[name] for name in names], axis=-1) - answer).max() < 2e-3 * p0


def test_even_grid_gives_the_mean_of_the_cells_on_the_axis():
    """128 cells: no centre on the apex; the centre pressure is the mean of four cells, all h/sqrt(2) away.

    p0 sqrt(1 - r^2/a^2) there is 1 - (h/a)^2/4 = 2.4e-4 low; 4e-4 leaves room for the discretisation.
    """
    a_scene = scene(grid={"cells": (128, 128)})
    q = sam.solve(a_scene).quantities
    _, p0 = rigid_hertz(a_scene)
    assert q["p_center_Pa"] == pytest.approx(p0, rel=4e-4)
    assert q["p_center_Pa"] == pytest.approx(q["p_max_Pa"], rel=1e-12)


def test_ellipse_equals_the_sphere_in_the_limit_and_turns_with_its_axes():
    sphere = sam.solve(scene()).quantities
    same = sam.solve(
        scene({"shape": "ellipsoid", "radius": None, "radius_x": 105e-6, "radius_y": 105e-6})
    ).quantities
    assert same["p_max_Pa"] == pytest.approx(sphere["p_max_Pa"], rel=1e-12)
    turned = [
        sam.solve(scene({"shape": "ellipsoid", "radius": None, "radius_x": rx, "radius_y": ry}))
        for rx, ry in ((300e-6, 100e-6), (100e-6, 300e-6))
    ]
    for name in ("p_max_Pa", "approach_m", "mises_max_Pa", "contact_area_m2"):
        first, second = (result.quantities[name] for result in turned)
        assert first == close(second, 1e-9)


@pytest.mark.parametrize("ratio", [1.00001, 1.5, 10.0, 1000.0])
def test_estimated_semi_axes_meet_hertz(ratio):
    """The estimate that chooses the grid: curvatures of the displacement under the ellipse, by quadrature.

    Under p0 sqrt(1 - x^2/a^2 - y^2/b^2) the displacement is L - M x^2 - N y^2 with (Johnson 1985, Eq. 3.64) M
    = p0 a b/(2 E*) x integral of dw/((a^2 + w)^1.5 (b^2 + w)^0.5 w^0.5) over w > 0; contact asks M = 1/(2
    Rx).
    """
    a_scene = scene({"shape": "ellipsoid", "radius": None, "radius_x": 1e-4, "radius_y": 1e-4 * ratio})
    a, b = hertz_semi_axes(a_scene)
    p0, modulus = 1.5 * 0.65 / (np.pi * a * b), Bodies(a_scene).pair.contact_modulus
    for this, other, radius in ((a, b, 1e-4), (b, a, 1e-4 * ratio)):

        def integrand(t, m=this, n=other):  # w = m^2 tan^2 t
            return np.cos(t) ** 2 / np.hypot(n * np.cos(t), m * np.sin(t))

        curvature = p0 * other / (modulus * this) * quad(integrand, 0, np.pi / 2)[0]
        assert curvature == pytest.approx(1 / (2 * radius), rel=1e-4)


def test_punch():
    """Rigid cylinder. The cells stand for the circle to 0.5 % of its radius, and so does the approach F/(2 a
    E*).
    """
    a_scene = scene({"shape": "punch", "radius": 10e-6}, force=1.0)
    result = sam.solve(a_scene)
    grid = choose_grid(a_scene)
    a = np.sqrt(result.discretisation["contact_cells"] * grid.hx * grid.hy / np.pi)
    assert a == pytest.approx(10e-6, rel=5e-3)
    modulus = Bodies(a_scene).pair.contact_modulus
    assert result.status is Status.CONVERGED
    assert result.quantities == result.quantities | {
        "approach_m": pytest.approx(flat_punch.FlatPunch(1.0, 10e-6, modulus).approach, rel=5e-3),
        "p_center_Pa": pytest.approx(1.0 / (2 * np.pi * a**2), rel=1e-2),
        "contact_area_m2": close(np.pi * a**2, 1e-12),
    }


def test_history_unloading_and_cycles():
    """Elastic: steps of Hertz (approach as F^(2/3)), unloading in one step that says so, cycles that
    repeat.
    """
    result = sam.solve(scene(steps=3, unload=True, unload_steps=5, cycles=2))
    history = result.tables["history"]
    assert history["cycle"] == [1] * 4 + [2] * 4 and history["step"] == [1, 2, 3, 4] * 2
    assert history["force_N"][3] == history["approach_m"][3] == history["p_max_Pa"][3] == 0.0
    assert "one step" in history["note"][3] and "cycle 1" in history["note"][4]
    assert history["approach_m"][0] / history["approach_m"][2] == pytest.approx((1 / 3) ** (2 / 3), rel=1e-3)
    assert history["approach_m"][4:] == history["approach_m"][:4]
    assert result.tables["cycles"]["p_max_Pa"] == [result.quantities["p_max_Pa"]] * 2
    states = result.tables["line"]["state"]
    assert states.count("peak") == states.count("unloaded") == 129
    unloaded = np.array([state == "unloaded" for state in states])
    assert np.all(np.asarray(result.tables["axis"]["mises_Pa"])[101:] == 0.0)
    assert np.asarray(result.tables["line"]["gap_m"])[unloaded].min() == 0.0
    assert {entry.stage for entry in result.left_out} >= {
        "tangential kernels",
        "volume grid",
        "unloading steps",
    }


def test_zero_force_is_a_result():
    result = sam.solve(scene(force=0.0))
    assert result.status is Status.CONVERGED
    assert (
        result.quantities["approach_m"]
        == result.quantities["p_max_Pa"]
        == result.quantities["contact_area_m2"]
        == 0.0
    )
    assert all(np.isfinite(value) for value in result.quantities.values() if value is not None)


@pytest.mark.parametrize(
    ("grid", "status"),
    [
        ({"cells": (33, 33), "extent": (10e-6, 10e-6)}, Status.CONTACT_AT_GRID_EDGE),
        ({"cells": (9, 9), "extent": (40e-6, 40e-6)}, Status.UNDER_RESOLVED),
    ],
)
def test_a_grid_that_does_not_fit_is_said(grid, status):
    result = sam.solve(scene(grid=grid))
    assert result.status is status and "grid." in result.message


def test_scaled_scene_gives_scaled_digits():
    """Young times s, lengths times t: the same iterations where they stop far above rounding (see
    `rounding`).

    Contacts solved to 1e-12 scale to 1e-11, the refined depth to 1e-9.
    """
    s, t = 7.3e-5, 3.1e4
    scaled = scene({"radius": 105e-6 * t}, {"young": 210e9 * s, "poisson": 0.3}, force=0.65 * s * t**2)
    for tolerance in (FAR_SCENE, 1e-12):
        goal = {"solver": Solver(tolerance=tolerance)}
        base, other = (sam.solve(each.model_copy(update=goal)) for each in (scene(), scaled))
        same = other.cost["contact_iterations"] == base.cost["contact_iterations"]
        assert base.status is Status.CONVERGED and (same or tolerance < FAR_SCENE)
    for name, factor in (("p_max_Pa", s), ("approach_m", t), ("mises_max_Pa", s), ("contact_area_m2", t**2)):
        assert other.quantities[name] / factor == close(base.quantities[name], 1e-11)
    assert other.quantities["mises_max_depth_m"] / t == close(base.quantities["mises_max_depth_m"], 1e-9)


def test_incompressible_body():
    """nu = 0.5 is allowed in the elastic model; sigma_rr = sigma_zz on the axis at the surface."""
    a_scene = scene(body={"young": 210e9, "poisson": 0.5})
    result = sam.solve(a_scene)
    _, p0 = rigid_hertz(a_scene)
    axis = result.tables["axis"]
    assert result.quantities["p_max_Pa"] == pytest.approx(p0, rel=1e-4)
    assert axis["sxx_Pa"][0] == pytest.approx(axis["szz_Pa"][0], rel=1e-6)


def test_progress_is_reported_not_printed(capsys):
    seen = []
    sam.solve(scene(steps=2), progress=lambda *call: seen.append(call))
    assert seen == [("contact", 1, 2), ("contact", 2, 2), ("stress", 1, 1)]
    assert capsys.readouterr() == ("", "")


def test_a_punch_narrower_than_a_cell_is_under_resolved():
    result = sam.solve(
        scene(
            {"shape": "punch", "radius": 1e-6}, force=1e-3, grid={"cells": (20, 20), "extent": (1e-4, 1e-4)}
        )
    )
    assert result.status is Status.UNDER_RESOLVED


def test_beside_a_punch_there_is_no_gap():
    line = sam.solve(scene({"shape": "punch", "radius": 10e-6}, force=1.0, unload=True)).tables["line"]
    beside = np.abs(line["x_m"]) > 10.2e-6
    assert (
        np.isnan(np.asarray(line["gap_m"])[beside]).all()
        and np.isfinite(np.asarray(line["gap_m"])[~beside]).all()
    )


@pytest.mark.parametrize("tolerance", [1e-10, 1e-12])
def test_a_tolerance_that_rounding_allows_is_met(tolerance):
    """The contact is not asked for residuals below rounding: measured 5e-13 on the default grid."""
    result = sam.solve(
        scene(grid={"depths": (0.0,)}).model_copy(update={"solver": Solver(tolerance=tolerance)})
    )
    assert result.status is Status.CONVERGED
    assert max(result.certificate[name] for name in ("gap_in_contact", "penetration")) <= min(
        tolerance, 2e-12
    )
