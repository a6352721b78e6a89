# SPDX-License-Identifier: MIT
"""Closed forms: the checks of ``closed_form_checks``, limits, known values, bad input, changed
coefficients.
"""

import inspect
import math
import sys
import types

import numpy as np
import pytest
from closed_form_checks import (
    RATIOS,
    TENSOR,
    check_elliptic,
    check_integrals,
    check_normal,
    check_point_loads,
    check_profiles,
    check_punch,
    check_rounded_punch,
    check_sphere,
    check_sphere_surface,
    check_tangential,
    check_wave,
    gauss,
    partial,
)
from growing_sphere_checks import check_cycled_sphere, check_growing_sphere
from scipy.special import ellipe, ellipkm1

from verification.reference import (
    elliptic,
    flat_punch,
    hamilton,
    hertz,
    hertz_integrals,
    mindlin_cheng,
    misfit_sphere,
    point_loads,
    rounded_punch,
    stress as stress_record,
    westergaard,
)
from verification.reference.stress import von_mises


def test_point_loads_satisfy_the_field_equations():
    check_point_loads(point_loads)


@pytest.mark.parametrize("nu", RATIOS)
@pytest.mark.parametrize("axis, kind", [(2, "boussinesq"), (0, "cerruti")])
def test_point_loads_balance_the_force_and_free_the_surface(nu, axis, kind):
    stress = getattr(point_loads, f"{kind}_stress")
    t, w = gauss(60)
    angle = 2 * np.pi * np.arange(16)[:, None] / 16
    alpha = t * np.pi / 2  # r = z tan(alpha) covers the whole plane z = 0.3
    r, area = (
        0.3 * np.tan(alpha),
        0.3**2 * np.tan(alpha) / np.cos(alpha) ** 2 * w * np.pi / 2 * 2 * np.pi / 16,
    )
    traction = stress(r * np.cos(angle), r * np.sin(angle), 0.3, 7.0, nu=nu)[..., TENSOR[2]]
    resultant = np.einsum("ijk,ij->k", traction, np.broadcast_to(area, traction.shape[:2]))
    np.testing.assert_allclose(resultant, -7.0 * np.eye(3)[axis], rtol=0, atol=1e-12 * 7)
    assert np.all(stress(0.3, 0.4, 0.0, 7.0, nu=nu)[TENSOR[2]] == 0)


@pytest.mark.parametrize("kind", ["boussinesq", "cerruti"])
def test_point_displacements_give_the_stresses_by_hooke(kind):
    E, nu = 2.5, 0.3
    displacement, stress = (
        getattr(point_loads, f"{kind}_displacement"),
        getattr(point_loads, f"{kind}_stress"),
    )
    for point in (np.array([0.4, -0.3, 0.7]), np.array([0.01, 0.02, 1.0])):
        gradient = np.array(
            [partial(lambda *x: displacement(*x, 3.0, young=E, nu=nu), point, k, 0.005) for k in range(3)]
        )
        strain = (gradient + gradient.T) / 2
        hooke = E / (1 + nu) * (strain + nu / (1 - 2 * nu) * np.trace(strain) * np.eye(3))
        expected = stress(*point, 3.0, nu=nu)[TENSOR]
        np.testing.assert_allclose(hooke, expected, rtol=0, atol=1e-9 * np.max(np.abs(expected)))


def test_integrals_equal_their_bessel_quadrature():
    check_integrals(hertz_integrals)


def test_normal_stress_equals_boussinesq_quadrature():
    check_normal(hertz)


def test_tangential_stress_equals_cerruti_quadrature():
    check_tangential(hamilton)


def test_axis_stress_is_the_textbook_form():
    nu, z = 0.3, np.geomspace(1e-6, 20, 30)
    axial = -1 / (1 + z**2)
    lateral = -(1 + nu) * (1 - z * np.arctan(1 / z)) + 0.5 / (1 + z**2)  # Johnson 3.45
    stress = hertz.axis_stress(2.0 * z, 5.0, 2.0, nu)
    np.testing.assert_allclose(stress[:, 2], 5 * axial, rtol=1e-13)
    np.testing.assert_allclose(stress[:, 0], 5 * lateral, rtol=0, atol=5e-15 * 5)
    np.testing.assert_array_equal(stress[:, 0], stress[:, 1])
    tangential = hamilton.tangential_stress(0.0, 0.0, z, 1.0, contact_radius=1.0, nu=nu)[:, 4]
    np.testing.assert_allclose(
        tangential, -1 + 1.5 * z * np.arctan(1 / z) - z**2 / (2 * (1 + z**2)), rtol=0, atol=5e-15
    )  # Hamilton


@pytest.mark.parametrize("nu", RATIOS)
def test_surface_values(nu):
    x, y = np.array([0.0, 0.3, -0.5, 0.1]), np.array([1e-9, 0.4, 0.2, -0.9])
    s = hamilton.tangential_stress(x, y, 0.0, 1.0, contact_radius=1.0, nu=nu)
    zero = np.zeros_like(x)
    expected = [-np.pi * (4 + nu) * x / 8, -3 * np.pi * nu * x / 8, zero, zero, -np.sqrt(1 - x**2 - y**2)]
    expected.append(-np.pi * (2 - nu) * y / 8)
    np.testing.assert_allclose(s, np.stack(expected, axis=-1), rtol=0, atol=1e-15)
    r = np.array([0.2, 0.7, 1.0, 1.0, 3.0])
    s = hertz.subsurface_stress(r, 0.0, 0.0, 1.0, contact_radius=1.0, nu=nu)
    root = np.sqrt(np.maximum(1 - r**2, 0))
    radial = (1 - 2 * nu) / (3 * r**2) * (1 - root**3) - root
    np.testing.assert_allclose(s[:, 0], radial, rtol=0, atol=1e-14)  # Johnson 3.43
    np.testing.assert_allclose(s[:, 2], -root, rtol=0, atol=1e-15)


def test_no_digit_is_lost_near_axis_edge_surface_and_far_away():
    exact = hertz_integrals.hertz_integrals(0.0, 0.3)
    for near in (1e-9, 1e-160):  # the integrals are even in rho: they differ by rho^2
        np.testing.assert_allclose(hertz_integrals.hertz_integrals(near, 0.3), exact, rtol=1e-15, atol=0)
    for x in (0.0, 0.4, 1.0, 1.7):  # to the surface: sqrt(z) at the edge, z elsewhere
        at, off = (
            hamilton.sliding_stress(x, 0.0, z, 1.0, contact_radius=1.0, nu=0.3, friction=0.4)
            for z in (0.0, 1e-200)
        )
        np.testing.assert_allclose(off, at, rtol=0, atol=1e-15)
    edge = hertz.subsurface_stress(
        [1.0, np.nextafter(1.0, 2), np.nextafter(1.0, 0)], 0.0, 0.0, 1.0, contact_radius=1.0, nu=0.3
    )
    np.testing.assert_allclose(
        edge, edge[:1] + np.zeros((3, 1)), rtol=0, atol=1e-7
    )  # root of a rounding error
    for distance in (1e2, 1e4, 1e6):
        point, force = distance * np.array([0.6, -0.3, 0.74]), 2 * np.pi / 3
        for field, load in (
            (hertz.subsurface_stress, point_loads.boussinesq_stress),
            (hamilton.tangential_stress, point_loads.cerruti_stress),
        ):
            far = load(*point, force, nu=0.3)
            difference = field(*point, 1.0, contact_radius=1.0, nu=0.3) - far
            assert np.max(np.abs(difference)) < (3 / distance**2 + 1e-14) * np.max(np.abs(far))


def test_circular_profiles_close_the_gap_and_carry_the_force():
    check_profiles(hertz)


def test_gap_just_outside_keeps_its_digits():
    contact = hertz.CircularContact(1.0, 1.0, 1.0)
    a = contact.contact_radius
    r = a * (1 + 1e-8)
    xi = math.sqrt((r / a) ** 2 - 1)
    leading = 4 / 3 * xi**3 * a**2 / math.pi  # next term is xi^2 smaller
    assert math.isclose(contact.gap(r), leading, rel_tol=1e-7)


@pytest.mark.parametrize("nu", [0.0, 0.15, 0.3, 0.5])
def test_largest_von_mises_is_the_largest_anywhere(nu):
    size, depth = hertz.largest_von_mises(1.0, 1.0, nu)
    x, z = np.meshgrid(np.linspace(0, 1.5, 151), np.linspace(0, 1.5, 301))
    grid = von_mises(hertz.subsurface_stress(x, 0.0, z, 1.0, contact_radius=1.0, nu=nu))
    assert grid.max() <= size < grid.max() * (1 + 1e-4)  # grid step 0.005 a
    assert abs(z.flat[grid.argmax()] - depth) <= 0.0051
    if nu == 0.3:
        assert round(size, 5) == 0.62004 and round(depth, 3) == 0.481


def test_elliptic_contact_closes_the_gap_and_superposes():
    check_elliptic(elliptic)


@pytest.mark.parametrize("ratio", [1e-8, 1e-3, 0.5, 0.999999, 1.0, 1.000001, 7.0, 1e6])
def test_axis_ratio_solves_the_legendre_form(ratio):
    k = elliptic.axis_ratio(ratio)
    small = min(k, 1 / k)
    assert math.isclose(k * elliptic.axis_ratio(1 / ratio), 1.0, rel_tol=1e-14)
    if abs(ratio - 1) > 1e-3:  # near the circle the Legendre form itself loses digits
        K, E = ellipkm1(small**2), ellipe(1 - small**2)
        legendre = (E / small**2 - K) / (K - E)  # Johnson section 4.2(c)
        assert math.isclose(legendre, max(ratio, 1 / ratio), rel_tol=1e-11)
    else:
        assert math.isclose(k - 1, (ratio - 1) * 2 / 3, rel_tol=1e-5, abs_tol=1e-15)


def test_circle_is_the_elliptic_limit_and_axes_can_be_exchanged():
    circle, ellipse = hertz.CircularContact(1.0, 2.0, 3.0), elliptic.EllipticContact(1.0, 2.0, 2.0, 3.0)
    z = np.array([0.0, 1e-3, 0.5, 5.0, 1e3]) * circle.contact_radius
    expected = hertz.axis_stress(z, circle.peak_pressure, circle.contact_radius, 0.3)
    np.testing.assert_allclose(
        ellipse.axis_stress(z, 0.3), expected, rtol=0, atol=1e-14 * circle.peak_pressure
    )
    assert math.isclose(ellipse.approach, circle.approach, rel_tol=1e-14)
    assert math.isclose(ellipse.largest_axis_von_mises(0.3)[0], 0.620041 * circle.peak_pressure, rel_tol=1e-6)
    one, other = elliptic.EllipticContact(1.0, 2.0, 0.3, 3.0), elliptic.EllipticContact(1.0, 0.3, 2.0, 3.0)
    np.testing.assert_allclose(one.semi_axes, other.semi_axes[::-1], rtol=1e-14)
    np.testing.assert_allclose(one.gap(2.0, 1.0), other.gap(1.0, 2.0), rtol=1e-12)


def test_wave_pressure_and_gap_satisfy_the_fourier_relation():
    check_wave(westergaard)


def test_wave_mean_gap_is_the_mean_of_the_gap_and_full_contact_is_its_limit():
    t, w = gauss(200)
    for m in (0.05, 0.5, 0.95):
        wave = westergaard.WavyContact(2e-6, 3e-3, 1e9, m * math.pi * 1e9 * 2e-6 / 3e-3)
        width = 1.5e-3 - wave.half_width
        x = wave.half_width + width * t**2  # (x - a)^1.5 at the edge becomes t^3
        mean = np.sum(wave.gap(x) * 2 * width * t * w) / 1.5e-3
        assert math.isclose(mean, wave.mean_gap, rel_tol=1e-10)
    full = westergaard.WavyContact(1.0, 1.0, 1.0, 2 * math.pi)
    x = np.linspace(-2, 2, 41)
    np.testing.assert_allclose(full.pressure(x), 2 * math.pi + math.pi * np.cos(2 * math.pi * x), rtol=1e-13)
    assert full.mean_gap == 0 and full.half_width == 0.5 and np.all(full.gap(x) == 0)
    almost = westergaard.WavyContact(1.0, 1.0, 1.0, math.pi * (1 - 1e-12))
    np.testing.assert_allclose(
        almost.pressure(x), full.pressure(x) - math.pi, atol=1e-5
    )  # sqrt(1e-12) at the valley


def test_punch_is_flat_and_superposes():
    check_punch(flat_punch)
    assert list(flat_punch.FlatPunch(1.0, 1.0, 1.0).pressure([1.0, 1.5])) == [np.inf, 0.0]


def test_rounded_punch_is_a_sphere_or_flat_in_the_limit():
    check_rounded_punch(rounded_punch)
    round_one = rounded_punch.RoundedPunch(2.0, 1e-7, 3.0, 5.0)
    ball, flat = hertz.CircularContact(2.0, 3.0, 5.0), flat_punch.FlatPunch(2.0, 0.7, 5.0)
    assert round_one.approach == pytest.approx(ball.approach, rel=1e-6)
    sharp, r = rounded_punch.RoundedPunch(2.0, 0.7, 1e-12, 5.0), np.array([0.0, 0.3, 0.6])
    assert sharp.approach == pytest.approx(flat.approach, rel=1e-6)
    assert sharp.pressure(r) == pytest.approx(flat.pressure(r), rel=1e-4)
    assert list(sharp.pressure([0.71, 2.0])) == [0.0, 0.0]


def test_sphere_satisfies_the_field_equations_the_free_surface_and_the_jump():
    check_sphere(mindlin_cheng)


def test_sphere_bulges_the_surface_as_reciprocity_says():
    check_sphere_surface(mindlin_cheng)


def test_deep_sphere_is_the_full_space_inclusion():
    inside = mindlin_cheng.EigenstrainSphere(0.01, 1.0, 1e4, 2.0, 0.3).stress(0.2, 0.1, 1e4)
    expected = -2 * 2.0 * 0.01 / (3 * 0.7)
    np.testing.assert_allclose(inside[:3], expected, rtol=1e-11)  # image (1e-4)^3


def test_von_mises_is_invariant_and_known_for_simple_states():
    assert von_mises([3.0, 0, 0, 0, 0, 0]) == 3.0 and von_mises([2.0, 2.0, 2.0, 0, 0, 0]) == 0.0
    assert math.isclose(von_mises([0, 0, 0, 1.0, 2.0, 2.0]), 3 * math.sqrt(3), rel_tol=1e-15)
    s = np.random.default_rng(1).normal(size=6)
    q, _ = np.linalg.qr(np.random.default_rng(2).normal(size=(3, 3)))
    xx, yy, zz, yz, xz, xy = (q @ s[TENSOR] @ q.T)[[0, 1, 2, 1, 0, 0], [0, 1, 2, 2, 2, 1]]
    record = stress_record.components(xx, yy, zz, yz, xz=xz, xy=xy)
    assert math.isclose(von_mises(record), von_mises(s), rel_tol=1e-14)


def test_effective_modulus():
    assert math.isclose(hertz.effective_modulus(210e9, 0.3), 210e9 / 0.91)
    assert math.isclose(hertz.effective_modulus(210e9, 0.3, 210e9, 0.3), 105e9 / 0.91)
    with pytest.raises(ValueError, match="E2 and nu2"):
        hertz.effective_modulus(210e9, 0.3, 210e9)


@pytest.mark.parametrize(
    "name, call",
    [
        ("nu1", lambda: hertz.effective_modulus(1.0, 0.6)),
        ("E1", lambda: hertz.effective_modulus(-1.0, 0.3)),
        ("radius", lambda: hertz.CircularContact(1.0, 0.0, 1.0)),
        ("force", lambda: elliptic.EllipticContact(math.nan, 1.0, 1.0, 1.0)),
        ("radius_y", lambda: elliptic.EllipticContact(1.0, 1.0, -1.0, 1.0)),
        ("nu", lambda: hertz.axis_stress(1.0, 1.0, 1.0, -0.1)),
        ("z", lambda: hertz.axis_stress([1.0, -1e-9], 1.0, 1.0, 0.3)),
        (
            "x",
            lambda: hamilton.sliding_stress(np.nan, 0.0, 1.0, 1.0, contact_radius=1.0, nu=0.3, friction=0.1),
        ),
        ("peak_pressure", lambda: hertz.pressure(0.0, math.inf, 1.0)),
        ("friction", lambda: hamilton.largest_von_mises(1.0, 1.0, 0.3, -0.1)),
        ("wavelength", lambda: westergaard.WavyContact(1.0, 0.0, 1.0, 1.0)),
        ("r", lambda: flat_punch.FlatPunch(1.0, 1.0, 1.0).pressure(-1.0)),
        ("centre_depth", lambda: mindlin_cheng.EigenstrainSphere(1.0, 1.0, 0.5, 1.0, 0.3)),
        ("x, y, z", lambda: point_loads.boussinesq_stress(0.0, 0.0, 0.0, 1.0, nu=0.3)),
        ("stress", lambda: von_mises(np.zeros(5))),
    ],
)
def test_bad_input_is_named(name, call):
    with pytest.raises(ValueError, match=rf"^{name} "):
        call()


MUTATIONS = [
    (point_loads, "(2.0 * R + z)", "(2.001 * R + z)", check_point_loads),
    (point_loads, "(3.0 * R + z) / (R**3", "(3.001 * R + z) / (R**3", check_point_loads),
    (hertz_integrals, "i1=arc / 2.0", "i1=arc / 2.001", check_integrals),
    (hertz_integrals, "eta * (3.0 + eta)\n", "eta * (3.001 + eta)\n", check_integrals),
    (hertz, "0.5 * i.z0 - (0.5 + nu)", "0.5 * i.z0 - (0.5001 + nu)", check_normal),
    (hertz, "(2.0 - rho**2)", "(2.0001 - rho**2)", check_profiles),
    (hertz, "excess + xi**2 *", "excess + 1.0001 * xi**2 *", check_profiles),
    (hertz, "math.pi**3 / 6.0 ", "math.pi**3 / 6.0001 ", check_profiles),
    (hamilton, "(2.0 + 0.5 * nu)", "(2.0 + 0.501 * nu)", check_tangential),
    (hamilton, "(1.0 - 0.5 * nu)", "(1.0 - 0.499 * nu)", check_tangential),
    (hamilton, "0.25 * i.z3", "0.2501 * i.z3", check_tangential),
    (elliptic, "elliprd(0.0, 1.0, square) /", "1.0001 * elliprd(0.0, 1.0, square) /", check_elliptic),
    (elliptic, "(np.sqrt(A) * roots)", "(np.sqrt(A) * roots * 1.0001)", check_elliptic),
    (westergaard, "2.0 * self.complete_pressure * np.cos(psi)", "2.001 * self.complete_pressure", check_wave),
    (westergaard, "1.0 - m + m * math", "1.0 - m + 1.001 * m * math", check_wave),
    (westergaard, "distance - m *", "distance - 1.001 * m *", check_wave),
    (flat_punch, "(1.0 + 3.0 * square)", "(1.0 + 3.001 * square)", check_punch),
    (flat_punch, "approach * 2.0 / math.pi", "approach * 2.001 / math.pi", check_punch),
    (rounded_punch, "(3.0 + math", "(3.001 + math", check_rounded_punch),
    (rounded_punch, "- b * _angle(", "- 1.001 * b * _angle(", check_rounded_punch),
    (rounded_punch, "(2.0 * np.sqrt(beyond", "(2.001 * np.sqrt(beyond", check_rounded_punch),
    (rounded_punch, "share * 2.0 / math.pi", "share * 2.001 / math.pi", check_rounded_punch),
    (rounded_punch, "FlatPunch(2.0 *", "FlatPunch(2.001 *", check_rounded_punch),
    (mindlin_cheng, "4.0 * self.nu * g22", "4.001 * self.nu * g22", check_sphere),
    (mindlin_cheng, "(3.0 - 4.0 * self.nu)", "(3.001 - 4.0 * self.nu)", check_sphere),
    (mindlin_cheng, "2.0 / self.radius**3", "2.001 / self.radius**3", check_sphere),
    (mindlin_cheng, "-4.0 * (1.0 - self.nu)", "-4.001 * (1.0 - self.nu)", check_sphere_surface),
    (misfit_sphere, "(4 / 5) * s", "(4.004 / 5) * s", check_growing_sphere),
    (misfit_sphere, "(1 - self.nu) / self.young", "(1.001 - self.nu) / self.young", check_growing_sphere),
    (misfit_sphere, "peeq + 2 * dq, sign", "peeq + 2.002 * dq, sign", check_growing_sphere),
    (misfit_sphere, "part = 2 * dq", "part = 2.002 * dq", check_cycled_sphere),
    (misfit_sphere, "-np.expm1(-2 * self", "-np.expm1(-2.002 * self", check_cycled_sphere),
    (misfit_sphere, "(self.modulus - self.recovery * start)", "self.modulus", check_cycled_sphere),
    (misfit_sphere, "sign * self._back(sign", "self._back(sign", check_cycled_sphere),
    (misfit_sphere, "(2 * self.fields(", "(2.002 * self.fields(", check_growing_sphere),
    (misfit_sphere, "last = -2 / 3", "last = -3 / 3", check_growing_sphere),
]


@pytest.mark.parametrize(
    "module, old, new, check", MUTATIONS, ids=lambda part: getattr(part, "__name__", None) or part
)
def test_a_changed_coefficient_turns_red(module, old, new, check, monkeypatch):
    source = inspect.getsource(module)
    assert source.count(old) == 1, "the coefficient to change must be found once"
    changed = types.ModuleType(module.__name__ + "_changed")
    changed.__package__ = module.__package__
    monkeypatch.setitem(sys.modules, changed.__name__, changed)  # dataclasses look their module up
    exec(compile(source.replace(old, new), changed.__name__, "exec"), changed.__dict__)
    with pytest.raises(AssertionError):
        check(changed)
