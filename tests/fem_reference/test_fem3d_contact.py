# SPDX-License-Identifier: MIT
"""Elastic contact and given tractions in three dimensions: Hertz, full slip, symmetry, units, what is
refused.
"""

from functools import cache

import numpy as np
import pytest
from builders import SPHERE, scene as small_scene
from rounding import close
from scipy.optimize import brentq
from scipy.special import ellipe, ellipk

from fem_reference import spatial
from fem_reference.common.loading import run
from fem_reference.common.schedule import Load
from fem_reference.spatial import planner
from fem_reference.spatial.lines import Lines
from fem_reference.spatial.model import build
from fem_reference.spatial.planner import plan
from fem_reference.spatial.recovery import stresses
from sam.scene.schema import Scene

YOUNG, NU, FORCE, RADIUS = 210e9, 0.3, 0.65, 105e-6


def scene(
    cells=4,
    friction=0.0,
    *,
    counter=SPHERE,
    box=6,
    poisson=NU,
    units=(1.0, 1.0),
    direction="constant",
    **loading,
):
    return small_scene(
        *units,
        body={"poisson": poisson},
        counterbody=counter,
        loading=loading,
        friction=friction and {"coefficient": friction, "direction": direction},
        fem={"cells_per_radius": cells, "box": box},
    )


def given(cells=4, friction=0.0, **keys):
    return scene(cells, friction, prescribed="hertz", p0=2e9, radius=6e-6, **keys)


@cache
def hertz(cells):
    return spatial.solve(scene(cells))


@cache
def at_peak(cells, friction):
    model = build(plan(scene(cells, friction)))
    return model, run(model, model.plan.schedule)[-1].state


def test_hertz():
    """Largest pressure and approach within 0.3 % at h = a/6; the order of the pressure is at least 1.5."""
    modulus = YOUNG / (1 - NU**2)
    p0 = (6 * FORCE * modulus**2 / (np.pi**3 * RADIUS**2)) ** (1 / 3)
    a = (3 * FORCE * RADIUS / (4 * modulus)) ** (1 / 3)
    errors = [abs(hertz(cells).quantities["p_max_Pa"] / p0 - 1) for cells in (3, 6)]
    assert errors[1] < 3e-3 and np.log2(errors[0] / errors[1]) > 1.5
    q = hertz(6).quantities
    assert q["approach_m"] == pytest.approx(a**2 / RADIUS, rel=3e-3)
    assert q == q | {
        "contact_radius_m": pytest.approx(a, rel=3e-3),
        "mises_max_Pa": pytest.approx(0.6200 * p0, rel=1e-2),
        "mises_max_depth_m": pytest.approx(0.4808 * a, abs=0.04 * a),
        "force_N": pytest.approx(FORCE, rel=1e-9),
    }
    assert abs(q["pressure_centroid_x_m"]) < 1e-8 * a
    line = {name: np.asarray(column) for name, column in hertz(6).tables["line"].items()}
    exact = p0 * np.sqrt(np.clip(1 - (line["x_m"] / a) ** 2, 0, None))
    assert np.abs(line["p_Pa"] - exact)[np.abs(line["x_m"]) < 0.9 * a].max() < 0.02 * p0


@pytest.mark.parametrize("ratio", [2.0, 0.5])
def test_ellipsoid(ratio):
    """p0 of the exact elliptical contact (Johnson 1985, Eqs. 4.26-4.33) within 1 %, for both orientations."""
    rx, ry = RADIUS * np.sqrt(ratio), RADIUS / np.sqrt(ratio)
    result = spatial.solve(scene(4, counter={"shape": "ellipsoid", "radius_x": rx, "radius_y": ry}))
    large, small, modulus = max(rx, ry), min(rx, ry), YOUNG / (1 - NU**2)

    def curvatures(k):  # of an ellipse b = k a: (A, B) a^2 b-free factors of Eq. (4.26)
        m = 1 - k**2
        K, E = ellipk(m), ellipe(m)
        return (K - E) / m, (E / k**2 - K) / m

    k = brentq(lambda k: curvatures(k)[1] / curvatures(k)[0] - large / small, 0.05, 0.999)
    # p0 b/(E* e^2 a^2) (K - E) = 1/(2 R'), F = 2/3 pi a b p0
    factor = 2 * curvatures(k)[0] * k * large / modulus  # p0 = a/factor... a = p0 factor
    p0 = (3 * FORCE / (2 * np.pi * k * factor**2)) ** (1 / 3)
    a = p0 * factor
    assert result.quantities["p_max_Pa"] == pytest.approx(p0, rel=0.01)
    assert result.quantities["contact_area_m2"] == pytest.approx(np.pi * k * a**2, rel=0.02)
    line = {name: np.asarray(column) for name, column in result.tables["line"].items()}
    reach = line["x_m"][line["p_Pa"] > 0].max()
    axis = a if ratio > 1 else k * a
    assert reach == pytest.approx(axis, abs=1.1 * axis / 4)


@pytest.mark.parametrize("friction", [0.0, 0.4])
def test_conditions_on_the_returned_field(friction):
    """Balance of forces, full slip and signs from displacements and stiffness alone (the loop's tolerance,
    1e-9).
    """
    model, state = at_peak(4, friction)
    problem, total = model.problem, 0.5 * model.scales.peak_force
    force = problem.solid.stiffness @ state.u
    normal = np.where(state.active, force[problem.normal], 0.0)
    assert state.converged and normal.sum() == pytest.approx(total, rel=1e-8)
    assert normal.min() >= 0.0
    assert force[problem.along][state.active] == pytest.approx(
        friction * normal[state.active], abs=1e-8 * total
    )
    gap = problem.gap0 + state.u[problem.normal] - state.approach
    assert np.abs(gap[state.active]).max() < 1e-13 and gap.min() > -1e-9
    loaded = np.concatenate([problem.normal[state.active], problem.along[state.active]])
    assert np.abs(np.delete(force, np.union1d(loaded, np.flatnonzero(problem.fixed)))).max() < 2e-9
    far = problem.solid.basis.nodal_dofs[:, problem.far]
    assert force[far[2]].sum() == pytest.approx(-total, rel=1e-7)
    assert force[far[0]].sum() == pytest.approx(-friction * total, abs=1e-7)
    assert state.iterations <= 5


def test_friction_moves_the_pressure_backwards():
    """u_z of a force along x is positive ahead of it (Cerruti): the pressure goes to -x, the more the more
    friction.

    The shift is proportional to Dundurs' beta = (1 - 2 nu)/(2 (1 - nu)): at nu = 0.45 less than a third of
    that at 0.3. The centroid is off by 0.003 a at h = a/4, 5 % of the larger one.
    """
    shift = [at_peak(4, friction)[0].centroid(at_peak(4, friction)[1]) for friction in (0.0, 0.4)]
    assert abs(shift[0]) < 1e-9
    assert -0.08 < shift[1] < -0.03
    stiff = build(plan(scene(4, 0.4, poisson=0.45)))
    state = run(stiff, stiff.plan.schedule)[-1].state
    assert stiff.centroid(state) / shift[1] == pytest.approx((0.1 / 1.1) / (0.4 / 1.4), abs=0.05)


def test_alternating_cycles_are_mirror_images():
    """An elastic body: the second cycle of alternating friction is the first with x reversed (tolerance of
    the loop).
    """
    model = build(plan(scene(3, 0.4, direction="alternating", cycles=2)))
    steps = run(model, model.plan.schedule)
    first, second = (model.nodal_pressure(steps[k].state) for k in (0, 2))
    assert [(step.state.force, step.state.load.ratio) for step in steps] == [
        (4 / 3, 0.4),
        (0.0, 0.4),
        (4 / 3, -0.4),
    ]
    assert second == pytest.approx(first[::-1], abs=1e-7)
    assert np.abs(first - first[::-1]).max() > 0.05


def test_half_is_whole(monkeypatch):
    """The mesh without symmetry has the same answer to the tolerance of the loop."""
    half = spatial.solve(scene(3, 0.4))
    choose = planner.choose_lines

    def whole(s):
        lines, core = choose(s)
        return Lines(lines.x, np.concatenate([-lines.y[:0:-1], lines.y]), lines.z, False), core

    monkeypatch.setattr(planner, "choose_lines", whole)
    full = spatial.solve(scene(3, 0.4))
    assert full.discretisation["elements"] == 2 * half.discretisation["elements"]
    for name, value in half.quantities.items():
        assert value is None or full.quantities[name] == close(value, 1e-6), name
    for name in ("p_Pa", "uz_m", "ux_m"):
        a, b = (np.asarray(result.tables["line"][name]) for result in (half, full))
        assert np.abs(a - b).max() < 1e-6 * np.abs(a).max()


def test_unit_system_changes_nothing():
    """Lengths in um, stresses in MPa: same iterations, numbers equal to the tolerance of the loop."""
    base = spatial.solve(scene(3, 0.3))
    other = spatial.solve(scene(3, 0.3, units=(1e6, 1e-6)))
    assert other.cost["newton_iterations"] == base.cost["newton_iterations"]
    units = {"m": 1e6, "m2": 1e12, "Pa": 1e-6, "N": 1e6}
    for name, value in base.quantities.items():
        if value:
            scaled = other.quantities[name] / units.get(name.rsplit("_", 1)[-1], 1.0)
            assert scaled == close(value, 1e-7), name


def point_force_stresses(x, y, z, ratio):
    """(6, n) stresses of unit normal and `ratio` tangential force at the origin: Johnson 1985, Eqs. (3.19),
    (3.76).
    """
    R, r2, soft, c = np.sqrt(x**2 + y**2 + z**2), x**2 + y**2, 1 - 2 * NU, 0.5 / np.pi
    turn = soft / r2
    normal = [
        turn * ((1 - z / R) * (x**2 - y**2) / r2 + z * y**2 / R**3) - 3 * z * x**2 / R**5,
        turn * ((1 - z / R) * (y**2 - x**2) / r2 + z * x**2 / R**3) - 3 * z * y**2 / R**5,
        -3 * z**3 / R**5,
        -3 * y * z**2 / R**5,
        -3 * x * z**2 / R**5,
        turn * ((1 - z / R) * 2 * x * y / r2 - x * y * z / R**3) - 3 * x * y * z / R**5,
    ]
    S = R + z
    cubic = 1 / (R**3 * S**2) + 2 / (R**2 * S**3)
    tangential = [
        -3 * x**3 / R**5 + soft * (x / R**3 - 3 * x / (R * S**2) + x**3 * cubic),
        -3 * x * y**2 / R**5 + soft * (x / R**3 - x / (R * S**2) + x * y**2 * cubic),
        -3 * x * z**2 / R**5,
        -3 * x * y * z / R**5,
        -3 * x**2 * z / R**5,
        -3 * x**2 * y / R**5 + soft * (-y / (R * S**2) + x**2 * y * cubic),
    ]
    return c * (np.array(normal) + ratio * np.array(tangential))


def hamilton(points, ratio):
    """(6, n) stresses over p0 of p = sqrt(1 - r^2) and ratio p at points (3, n), by quadrature of the point
    forces.
    """
    s, w = np.polynomial.legendre.leggauss(40)
    s, w = 0.5 * (s + 1), 0.5 * w
    angle = (np.arange(80) + 0.5) * 2 * np.pi / 80
    r = np.sqrt(1 - s**2)[:, None]  # p r dr = -s^2 ds
    weight = np.repeat(w * s**2, 80) * 2 * np.pi / 80
    place = (r * np.cos(angle)).ravel(), (r * np.sin(angle)).ravel()
    return np.stack(
        [point_force_stresses(x - place[0], y - place[1], z, ratio) @ weight for x, y, z in points.T], axis=1
    )


def test_stresses_of_a_given_traction():
    """Every component at the centres of the elements below z = 0.25 a within 1.5 % of p0 (second order: 1 %
    at h = a/6).
    """
    model = build(plan(given(6, 0.3)))
    s, a = stresses(model, run(model, model.plan.schedule)[-1].state), 6e-6
    i, j, k = (
        np.flatnonzero((np.abs(line) < 1.3 * a) & (line > low * a))
        for line, low in ((s.x, -9), (s.y, 0), (s.z, 0.3))
    )
    k = k[s.z[k] < 1.1 * a][::2]
    grid = np.ix_(np.arange(6), i[::2], j[::3], k)
    points = np.stack([m.ravel() for m in np.meshgrid(s.x[i[::2]], s.y[j[::3]], s.z[k], indexing="ij")]) / a
    found = s.stress[grid].reshape(6, -1) / 2e9
    assert np.abs(found - hamilton(points, 0.3)).max() < 0.015
    assert np.abs(found - hamilton(points, 0.0)).max() > 0.1  # without the traction it would be red
    # the classical value on the axis: s_xz = -ratio p0 (1 - 3/2 z atan(1/z) + z^2/(2 (1 + z^2)))
    z = s.z / a
    exact = -0.3 * (1 - 1.5 * z * np.arctan2(1, z) + 0.5 * z**2 / (1 + z**2))
    assert np.abs(s.axis[4] / 2e9 - exact)[(z > 0.25) & (z < 1.2)].max() < 0.01


def test_a_load_that_travels():
    """An elastic body forgets the way: at the end of a path the state is that of the load put on there."""
    path = {"start": (-6e-6, 0.0), "end": (6e-6, 0.0), "steps": 2}
    model = build(plan(given(3, 0.2, path=path, box=4)))
    steps = run(model, model.plan.schedule)
    assert [step.state.load.x for step in steps] == [-1.0, 0.0, 1.0]
    direct = model.load(Load(model.scales.peak_force, 0.2, 1.0), model.virgin())
    assert np.abs(steps[-1].state.u - direct.u).max() < 1e-6
    moved = model.nodal_pressure(steps[-1].state)
    assert model.lines.x[np.argmax(moved[:, 0])] == pytest.approx(1.0)
    assert moved[::-1] == pytest.approx(model.nodal_pressure(steps[0].state), abs=1e-12)
    result = spatial.solve(
        given(4, 0.2, box=3, path={"start": (0.0, -3e-6), "end": (0.0, 3e-6), "steps": 1}, unload=True)
    )
    assert result.converged and result.discretisation["symmetry"] == "none"
    assert result.quantities["approach_m"] is None


def test_what_is_refused_and_left_out():
    """The reasons name key, value and what is allowed; coupling = false is said to have no meaning here."""
    punch = scene(counter={"shape": "punch", "radius": 1e-5})
    with pytest.raises(
        spatial.UnsupportedScene, match=r'counterbody\.shape = "punch".*"sphere" or "ellipsoid"'
    ):
        spatial.solve(punch)
    with pytest.raises(spatial.UnsupportedScene, match=r"counterbody\.young = 70000000000\.0: .*rigid"):
        spatial.check(scene(counter={"shape": "sphere", "radius": 1e-4, "young": 70e9, "poisson": 0.3}))
    soft = scene(box=3).model_dump()
    soft["body"] |= {"plasticity": {"law": "perfect", "yield_stress": 2e8}}
    with pytest.raises(spatial.UnsupportedScene, match=r"fem\.box = 3"):
        spatial.check(Scene(**soft))
    decoupled = Scene(**scene().model_dump() | {"friction": {"coefficient": 0.2, "coupling": False}})
    assert any("coupling" in entry.reason for entry in spatial.left_out(decoupled))
    stages = [entry.stage for entry in spatial.left_out(scene(friction=0.2))]
    assert "tangential traction" not in stages and "mesh of the counter-body" in stages


def test_statuses():
    """Too few elements in the contact; no force at all."""
    assert spatial.solve(scene(2)).status == "under-resolved"
    empty = spatial.solve(Scene(**scene(3).model_dump() | {"loading": {"force": 0.0}}))
    assert empty.converged and empty.quantities["p_max_Pa"] == 0.0
