# SPDX-License-Identifier: MIT
"""Closed forms against quadrature of point loads, reciprocity, Fourier series, limits and known values; and
limits of shakedown by the smallest ball about the stresses of a travelling load.

Tolerances: quadratures meet at rounding error times the condition of the integrand (1e-10 to 1e-13 of the
largest value); finite differences of order 8 with a step of 0.005 lengths leave 1e-11 in first derivatives.
"""

import math

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.special import ellipe, ellipk, ellipkm1

from verification.reference import (
    capped,
    elliptic,
    flat_punch,
    hamilton,
    hertz,
    hertz_line,
    merwin_johnson,
    mindlin_cheng,
    point_loads,
    rounded_punch,
    stress as stress_record,
    westergaard,
)
from verification.reference.quadrature import gauss
from verification.reference.shakedown import cell_limit, in_place_limit, smallest_ball, travelling_limit
from verification.reference.stress import von_mises

TENSOR = np.array([[0, 5, 4], [5, 1, 3], [4, 3, 2]])  # component number of s_ij
WEIGHTS = np.array([4 / 5, -1 / 5, 4 / 105, -1 / 280])  # central difference of order 8
RATIOS = (0.0, 0.3, 0.5)


def partial(f, point, axis, step):
    """df/dx_axis by central differences of order 8."""
    shifts = [step * k * np.eye(3)[axis] for k in range(1, 5)]
    return sum(w * (f(*(point + k)) - f(*(point - k))) for k, w in zip(shifts, WEIGHTS, strict=True)) / step


def disc_nodes(a, b, x, y, z, count=160):
    """Nodes (x', y') in the ellipse, weights dA sqrt(1 - x'^2/a^2 - y'^2/b^2): resolve a kernel peaked at (x,
    y).

    Polar coordinates around the foot (x, y), inside the ellipse: s = z sinh(v) resolves the peak, v = top (1
    - (1-t)^2) the square root at the rim.
    """
    angle = 2 * np.pi * np.arange(count)[:, None] / count
    c, s = np.cos(angle), np.sin(angle)
    A, B, C = (c / a) ** 2 + (s / b) ** 2, x * c / a**2 + y * s / b**2, 1 - (x / a) ** 2 - (y / b) ** 2
    rim = (-B + np.sqrt(B**2 + A * C)) / A
    t, w = gauss(count)
    top = np.arcsinh(rim / z)
    radius = z * np.sinh(top * (1 - (1 - t) ** 2))
    slope = z * np.cosh(top * (1 - (1 - t) ** 2)) * top * 2 * (1 - t)
    root = np.sqrt(np.maximum(A * (rim - radius) * (radius + C / (A * rim)), 0.0))
    return x + radius * c, y + radius * s, radius * slope * w * root * 2 * np.pi / count


def outside_nodes(count=200):
    """The same for a unit disc seen from outside: polar about the centre, r = sin(alpha)."""
    angle = 2 * np.pi * np.arange(count)[:, None] / count
    t, w = gauss(count)
    r, root = np.sin(t * np.pi / 2), np.cos(t * np.pi / 2)
    weight = np.broadcast_to(r * root**2 * w * np.pi**2 / count, (count, count))
    return r * np.cos(angle), r * np.sin(angle), weight


def of_point(nu):
    return lambda *place: point_loads.boussinesq_stress(*place, 1.0, nu=nu)


def superposed(kernel, x, y, z, nodes):
    xs, ys, weight = nodes
    return np.einsum("ijk,ij->k", kernel(x - xs, y - ys, z), weight)


def chord_displacement(x, y, a, b, power, count=400):
    """Integral of (1 - x'^2/a^2 - y'^2/b^2)^power / distance over the ellipse, by chords through (x, y).

    In the plane where the ellipse is the unit circle a chord at the distance d from the centre has the
    half-length sqrt(1 - d^2), and its integral is (1 - d^2)^(power + 1/2) Beta(power + 1, 1/2) times the
    stretch of lengths.
    """
    distance, bearing = math.hypot(x / a, y / b), math.atan2(y / b, x / a)
    if distance < 1:
        offset, weight = np.pi * np.arange(count) / count, np.full(count, np.pi / count)
    else:  # only chords that meet the circle: Gauss points between the tangents, dense at both
        t, w = np.polynomial.legendre.leggauss(count)
        half = math.asin(1 / distance)
        offset, weight = half * np.sin(np.pi * t / 2), w * half * np.pi / 2 * np.cos(np.pi * t / 2)
    # ds dtheta with dtheta = a b/L^2 d(offset) and ds = L ds', L = length of a unit vector of that plane
    stretch = a * b / np.hypot(a * np.cos(bearing + offset), b * np.sin(bearing + offset))
    chord = np.maximum(1 - (distance * np.sin(offset)) ** 2, 0.0) ** (power + 0.5)
    beta = math.gamma(power + 1) * math.gamma(0.5) / math.gamma(power + 1.5)
    return np.sum(weight * stretch * chord) * beta


@pytest.mark.parametrize("nu", RATIOS)
@pytest.mark.parametrize("axis, kind", [(2, "boussinesq"), (0, "cerruti")])
def test_point_loads_balance_the_force_and_free_the_surface(nu, axis, kind):
    stress = getattr(point_loads, f"{kind}_stress")
    t, w = gauss(60)
    angle = 2 * np.pi * np.arange(16)[:, None] / 16
    alpha = t * np.pi / 2  # r = z tan(alpha) covers the whole plane z = 0.3
    r = 0.3 * np.tan(alpha)
    area = 0.3**2 * np.tan(alpha) / np.cos(alpha) ** 2 * w * np.pi / 2 * 2 * np.pi / 16
    traction = stress(r * np.cos(angle), r * np.sin(angle), 0.3, 7.0, nu=nu)[..., TENSOR[2]]
    resultant = np.einsum("ijk,ij->k", traction, np.broadcast_to(area, traction.shape[:2]))
    np.testing.assert_allclose(resultant, -7.0 * np.eye(3)[axis], rtol=0, atol=1e-12 * 7)
    assert np.all(stress(0.3, 0.4, 0.0, 7.0, nu=nu)[TENSOR[2]] == 0)


@pytest.mark.parametrize("kind", ["boussinesq", "cerruti"])
def test_point_displacements_give_the_stresses_by_hooke(kind):
    E, nu = 2.5, 0.3
    displacement = getattr(point_loads, f"{kind}_displacement")
    stress = getattr(point_loads, f"{kind}_stress")
    for point in (np.array([0.4, -0.3, 0.7]), np.array([0.01, 0.02, 1.0])):
        gradient = np.array(
            [partial(lambda *x: displacement(*x, 3.0, young=E, nu=nu), point, k, 0.005) for k in range(3)]
        )
        strain = (gradient + gradient.T) / 2
        hooke = E / (1 + nu) * (strain + nu / (1 - 2 * nu) * np.trace(strain) * np.eye(3))
        expected = stress(*point, 3.0, nu=nu)[TENSOR]
        np.testing.assert_allclose(hooke, expected, rtol=0, atol=1e-9 * np.max(np.abs(expected)))


SUPERPOSED = [
    (point_loads.boussinesq_stress, hertz.subsurface_stress),
    (point_loads.cerruti_stress, hamilton.tangential_stress),
]


@pytest.mark.parametrize(("point_stress", "closed"), SUPERPOSED)
def test_stress_equals_the_quadrature_of_point_loads(point_stress, closed):
    """Below the disc (down to 1e-6 from the surface), at the edge, outside: quadrature of the point load."""
    below = [(0.0, 0.0, 0.5), (0.3, -0.4, 0.02), (-0.6, 0.5, 1e-6), (1e-7, 2e-7, 0.2), (0.9, 0.0, 0.01)]
    beside = [(1.0, 0.0, 0.4), (-0.9, 1.1, 0.2), (0.0, -3.0, 0.05), (0.5, 0.2, 4.0)]
    for nu in RATIOS:
        for k, (x, y, z) in enumerate(below + beside):
            nodes = disc_nodes(1, 1, x, y, z) if k < len(below) else outside_nodes()
            expected = superposed(lambda *p, nu=nu: point_stress(*p, 1.0, nu=nu), x, y, z, nodes)
            found = closed(x, y, z, 1.0, contact_radius=1.0, nu=nu)
            np.testing.assert_allclose(found, expected, rtol=0, atol=1e-10, err_msg=f"{(x, y, z, nu)}")


def test_line_contact_is_the_quadrature_of_line_forces_and_the_benchmark_of_nafems():
    """Flamant's stress and the logarithm of a line force; NAFEMS R0094-1; first yield at nu = 0.3."""
    line, friction = hertz_line.LineContact(math.pi / 2, 1.0, 2.0, 1.0), 0.3
    assert (line.contact_radius, line.peak_pressure) == pytest.approx((1.0, 1.0), rel=1e-15)
    angle, w = np.polynomial.legendre.leggauss(200)  # s = sin(angle) has the root of the edges
    s, w = np.sin(angle * math.pi / 2), w * (np.cos(angle * math.pi / 2) ** 2 * math.pi / 2)
    for x, z in ((0.0, 0.5), (-0.7, 0.2), (0.4, 1.0), (1.5, 0.3), (1.0, 0.4)):
        along = x - s
        radial = -2 / math.pi * (z + friction * along) / (along**2 + z**2) ** 2
        xx, zz, xz = ((w * radial * part).sum() for part in (along**2, z**2, along * z))
        found = line.stress(x, z, 0.3, friction=friction)
        assert found == pytest.approx([xx, 0.3 * (xx + zz), zz, 0, xz, 0], abs=1e-10)
    # the surface at 3, far from the edge, and at the datum half of the length from the middle
    uz = -2 / (math.pi * line.modulus) * (w * np.log(np.abs(3.0 - s))).sum()
    datum = -2 / (math.pi * line.modulus) * math.pi / 2 * math.log(line.length / 2)
    gap = 3.0**2 / 2 - line.approach + uz - datum
    assert gap == pytest.approx(float(line.gap(3.0)), rel=1e-10)
    modulus = hertz.effective_modulus(70e9, 0.3, 210e9, 0.3)
    nafems = hertz_line.LineContact(35e3, 0.05, modulus, 1e-3)
    assert nafems.contact_radius == pytest.approx(6.2146e-3, rel=1e-5)
    assert nafems.at_pressure(3585.4e6).force == pytest.approx(35e3, rel=5e-5)
    largest, depth = nafems.largest_von_mises(0.3)
    assert nafems.peak_pressure / largest == pytest.approx(1.794, rel=3e-4)
    assert depth / nafems.contact_radius == pytest.approx(0.704, abs=1e-3)


def test_passes_by_merwin_and_johnson_settle_below_4_k_and_carry_the_surface_backwards_beyond():
    """First yield at 1.7937 sqrt(3) k, on the axis 0.704 deep; Melan's 4.00 k, half a half-width deep."""
    near = (share * 1.7937 * math.sqrt(3.0) for share in (0.999, 1.001))
    below, above = (merwin_johnson.plastic_shear(k, [0.704], nu=0.3, passes=1)[1].max() for k in near)
    assert below == 0.0 < above < 2e-3  # of a free fibre 1e-3 k/G
    depth = [0.45, 0.5, 0.55]
    ways = (merwin_johnson.plastic_shear(k, depth, nu=0.3, passes=10)[1] for k in (3.92, 4.08))
    settles, flows = (way.max(axis=1) for way in ways)
    assert (np.diff(settles) < 0.0).all() and settles[-1] < 0.01 * settles[0]
    assert flows[-1] > 0.97 * flows[-2] > 0.07
    net, way = merwin_johnson.plastic_shear(5.0, depth, nu=0.3, passes=3)
    assert (net > 0.5).any() and (net < way).all() and (net[-1] > 0.0).all()


def test_axis_stress_is_the_textbook_form():
    nu, z = 0.3, np.geomspace(1e-6, 20, 30)
    axial = -1 / (1 + z**2)
    lateral = -(1 + nu) * (1 - z * np.arctan(1 / z)) + 0.5 / (1 + z**2)  # Johnson 3.45
    stress = hertz.axis_stress(2.0 * z, 5.0, 2.0, nu)
    np.testing.assert_allclose(stress[:, 2], 5 * axial, rtol=1e-13)
    np.testing.assert_allclose(stress[:, 0], 5 * lateral, rtol=0, atol=5e-15 * 5)
    np.testing.assert_array_equal(stress[:, 0], stress[:, 1])
    tangential = hamilton.tangential_stress(0.0, 0.0, z, 1.0, contact_radius=1.0, nu=nu)[:, 4]
    exact = -1 + 1.5 * z * np.arctan(1 / z) - z**2 / (2 * (1 + z**2))  # Hamilton
    np.testing.assert_allclose(tangential, exact, rtol=0, atol=5e-15)


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
    exact = hertz.hertz_integrals(0.0, 0.3)
    for near in (1e-9, 1e-160):  # the integrals are even in rho: they differ by rho^2
        np.testing.assert_allclose(hertz.hertz_integrals(near, 0.3), exact, rtol=1e-15, atol=0)
    for x in (0.0, 0.4, 1.0, 1.7):  # to the surface: sqrt(z) at the edge, z elsewhere
        load = {"contact_radius": 1.0, "nu": 0.3, "friction": 0.4}
        at, off = (hamilton.sliding_stress(x, 0.0, z, 1.0, **load) for z in (0.0, 1e-200))
        np.testing.assert_allclose(off, at, rtol=0, atol=1e-15)
    near = [1.0, np.nextafter(1.0, 2), np.nextafter(1.0, 0)]
    edge = hertz.subsurface_stress(near, 0.0, 0.0, 1.0, contact_radius=1.0, nu=0.3)
    assert np.abs(edge - edge[0]).max() < 1e-7  # root of a rounding error
    for distance in (1e2, 1e4, 1e6):
        point, force = distance * np.array([0.6, -0.3, 0.74]), 2 * np.pi / 3
        for load, field in SUPERPOSED:
            far = load(*point, force, nu=0.3)
            difference = field(*point, 1.0, contact_radius=1.0, nu=0.3) - far
            assert np.max(np.abs(difference)) < (3 / distance**2 + 1e-14) * np.max(np.abs(far))


def test_circular_profiles_close_the_gap_and_carry_the_force():
    modulus = 3.0
    contact = hertz.CircularContact(2.0, 0.5, modulus)
    a, p0 = contact.contact_radius, contact.peak_pressure
    for rho in (0.0, 0.35, 0.9, 1.0001, 1.4, 6.0, 1e3):
        quadrature = p0 * chord_displacement(rho * a, 0.0, a, a, 0.5) / (math.pi * modulus)
        assert math.isclose(contact.displacement(rho * a), quadrature, rel_tol=1e-12)
        gap = (rho * a) ** 2 - contact.approach + quadrature  # R = 0.5
        assert abs(contact.gap(rho * a) - gap) < 1e-11 * contact.approach * (1 + rho**2)
        assert (contact.gap(rho * a) == 0) == (rho <= 1)
    force, _ = quad(lambda r: 2 * np.pi * r * contact.pressure(r), 0.0, a, epsabs=0.0, epsrel=1e-13)
    assert math.isclose(force, 2.0, rel_tol=1e-13)
    inverse = hertz.CircularContact.from_peak_pressure(p0, 0.5, modulus)
    assert math.isclose(inverse.force, 2.0, rel_tol=1e-14)


@pytest.mark.parametrize("nu", [0.0, 0.15, 0.3, 0.5])
def test_largest_von_mises_is_the_largest_anywhere(nu):
    size, depth = hertz.largest_von_mises(1.0, 1.0, nu)
    x, z = np.meshgrid(np.linspace(0, 1.5, 151), np.linspace(0, 1.5, 301))
    grid = von_mises(hertz.subsurface_stress(x, 0.0, z, 1.0, contact_radius=1.0, nu=nu))
    assert grid.max() <= size < grid.max() * (1 + 1e-4)  # grid step 0.005 a
    assert abs(z.flat[grid.argmax()] - depth) <= 0.0051
    if nu == 0.3:
        assert round(size, 5) == 0.62004 and round(depth, 3) == 0.481


def test_surface_overtakes_the_interior():
    edges = {0.0: 0.2309, 0.1: 0.3613, 0.2: 0.5053, 0.25: 0.5793, 0.3: 0.6540, 0.4: 0.8048, 0.5: 0.9567}
    for mu, value in edges.items():
        assert round(hamilton.largest_von_mises(1.0, 1.0, 0.3, mu)[1][0], 4) == value
    subsurface, edge = hamilton.largest_von_mises(1.0, 1.0, 0.3, 0.3047)
    assert abs(edge[0] - subsurface[0]) < 1e-4


def test_elliptic_contact_closes_the_gap_and_superposes():
    contact = elliptic.EllipticContact(2.0, 0.5, 1.3, 4.0)
    (a, b), p0 = contact.semi_axes, contact.peak_pressure
    assert math.isclose(2 / 3 * math.pi * a * b * p0, 2.0, rel_tol=1e-14)
    for x, y in ((0.0, 0.0), (0.3, -0.5), (-0.9, 0.1), (1.0, 0.9), (0.0, 1.5), (4.0, -3.0)):
        quadrature = p0 * chord_displacement(x * a, y * b, a, b, 0.5) / (math.pi * 4.0)
        assert math.isclose(contact.displacement(x * a, y * b), quadrature, rel_tol=1e-12)
        gap = contact.gap(x * a, y * b)
        assert abs(gap) < 1e-14 * contact.approach if x**2 + y**2 < 1 else gap > 0
    for nu in RATIOS:
        for z in (1e-3 * a, 0.3 * a, 2.0 * a):
            nodes = disc_nodes(a, b, 0.0, 0.0, z, 240)
            quadrature = p0 * superposed(of_point(nu), 0.0, 0.0, z, nodes)
            np.testing.assert_allclose(contact.axis_stress(z, nu), quadrature, rtol=0, atol=1e-10 * p0)


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
    off = ellipse.axis_stress(z, 0.3) - hertz.axis_stress(z, circle.peak_pressure, circle.contact_radius, 0.3)
    assert np.abs(off).max() < 1e-14 * circle.peak_pressure
    assert math.isclose(ellipse.approach, circle.approach, rel_tol=1e-14)
    assert math.isclose(ellipse.largest_axis_von_mises(0.3)[0], 0.620041 * circle.peak_pressure, rel_tol=1e-6)
    one, other = elliptic.EllipticContact(1.0, 2.0, 0.3, 3.0), elliptic.EllipticContact(1.0, 0.3, 2.0, 3.0)
    np.testing.assert_allclose(one.semi_axes, other.semi_axes[::-1], rtol=1e-14)
    np.testing.assert_allclose(one.gap(2.0, 1.0), other.gap(1.0, 2.0), rtol=1e-12)


def test_wave_pressure_and_gap_satisfy_the_fourier_relation():
    """Cosine coefficients p_n of the pressure; sin(psi) = sqrt(m) sin(t): the midpoint rule is exact."""
    t, n = np.pi * (np.arange(4800) + 0.5) / 4800 - np.pi / 2, np.arange(601)
    for m in (0.1, 0.6):
        wave = westergaard.WavyContact(1.0, 1.0, 1.0, m * math.pi)  # p* = pi
        psi = np.arcsin(math.sqrt(m) * np.sin(t))
        measure = math.sqrt(m) * np.cos(t) / np.cos(psi) * np.pi / t.size  # d psi
        p = np.cos(2 * np.outer(n, psi)) @ (wave.pressure(psi / math.pi) * measure) / math.pi
        assert math.isclose(p[0], wave.mean_pressure, rel_tol=1e-12)
        u = 4 * p[1:] / (2 * math.pi * n[1:])  # E* = 1, k = 2 pi n; twice for n > 0
        inside, outside = wave.half_width * np.array([0, 0.4, 0.8]), np.array([0.3, 0.4, 0.5])
        x = np.concatenate([inside, outside])
        series = 1 - np.cos(2 * np.pi * x) + np.cos(2 * np.pi * np.outer(x, n[1:])) @ u
        series += wave.mean_gap - 1  # mean plane: the series has no mean
        # the truncated series of u_n ~ n^-2.5 leaves N^-2.5 away from the edge, N = 600: 1e-7
        np.testing.assert_allclose(wave.gap(x), series, atol=5e-7)
        assert np.all(wave.gap(inside) == 0) and np.all(wave.gap(outside) > 0)


def test_wave_mean_gap_is_the_mean_of_the_gap_and_full_contact_is_its_limit():
    for m in (0.05, 0.5, 0.95):
        wave = westergaard.WavyContact(2e-6, 3e-3, 1e9, m * math.pi * 1e9 * 2e-6 / 3e-3)
        opened, _ = quad(wave.gap, wave.half_width, 1.5e-3, epsabs=0.0, epsrel=1e-12)
        assert math.isclose(opened / 1.5e-3, wave.mean_gap, rel_tol=1e-10)
    full = westergaard.WavyContact(1.0, 1.0, 1.0, 2 * math.pi)
    x = np.linspace(-2, 2, 41)
    np.testing.assert_allclose(full.pressure(x), 2 * math.pi + math.pi * np.cos(2 * math.pi * x), rtol=1e-13)
    assert full.mean_gap == 0 and full.half_width == 0.5 and np.all(full.gap(x) == 0)
    almost = westergaard.WavyContact(1.0, 1.0, 1.0, math.pi * (1 - 1e-12))  # sqrt(1e-12) at the valley
    np.testing.assert_allclose(almost.pressure(x), full.pressure(x) - math.pi, atol=1e-5)


def cosine_wave(n):
    x = (np.arange(n) + 0.5) / n - 0.5
    return x, np.cos(2 * np.pi * x)


def test_double_wave_keeps_its_limits():
    """Without intensity at its edge what opens a round crack has no moment over sqrt(b^2 - r^2)."""
    complete = math.sqrt(2) * math.pi * 5.0 * 1e-3 / 2.0
    contact = westergaard.DoublyWavyContact(1e-3, 2.0, 5.0, 0.9999 * complete)
    b = math.sqrt((1 - contact.heavy_share) * contact.wavelength**2 / (2 * math.pi))  # two in a wave
    t, w = gauss(40)
    r = b * np.sin(0.5 * np.pi * t)  # moment of the mean over a circle about the hollow at (lambda/2, 0)
    angles = 2 * np.pi * np.arange(8) / 8
    ring = contact.complete(1.0 + np.outer(r, np.cos(angles)), np.outer(r, np.sin(angles))).mean(axis=1)
    assert abs(np.sum(w * r * ring)) < 1e-4 * np.sum(w * r * np.abs(ring))  # next order in b
    light = westergaard.DoublyWavyContact(1e-3, 2.0, 5.0, 1e-6 * contact.complete_pressure)
    spots = 2 * math.pi * (light.summit.contact_radius / 2.0) ** 2
    assert math.isclose(light.light_share, spots, rel_tol=1e-12)
    assert math.isclose(light.fitted_share, light.light_share, rel_tol=1e-2)
    over = westergaard.DoublyWavyContact(1e-3, 2.0, 5.0, 2 * contact.complete_pressure)
    x, wave = cosine_wave(16)
    heights, sides = 1e-3 * np.outer(wave, wave), (2.0, 2.0)
    found = capped.capped_pressure(heights, sides, 5.0, over.mean_pressure)
    np.testing.assert_allclose(found, over.complete(2.0 * x[:, None], 2.0 * x[None, :]), rtol=1e-4)
    assert math.isclose(capped.rms_slope(heights, sides), 1e-3 * math.pi / math.sqrt(2), rel_tol=1e-12)


def test_capped_pressure_is_westergaards_and_keeps_to_its_bounds():
    wave = westergaard.WavyContact(1e-3, 1.0, 1.0, 0.3e-3 * math.pi)
    x, cosine = cosine_wave(128)
    given = 1e-3 * np.repeat(cosine[:, None], 2, axis=1), (1.0, 2 / 128), 1.0
    p = capped.capped_pressure(*given, wave.mean_pressure)
    np.testing.assert_allclose(p[:, 0], wave.pressure(x), atol=0.03 * p.max())  # the edge falls within a cell
    assert math.isclose(p.max(), wave.pressure(x).max(), rel_tol=3e-4)
    hardness = 0.6 * p.max()
    p = capped.capped_pressure(*given, wave.mean_pressure, hardness=hardness, tolerance=1e-7)
    assert p.min() == 0 and p.max() == hardness and math.isclose(p.mean(), wave.mean_pressure, rel_tol=1e-12)
    k = 2 * np.pi * np.arange(1, 64)  # displacements summed wave by wave
    u = sum(4 / q * (p[:, 0] @ np.cos(q * x)) / 128 * np.cos(q * x) for q in k)
    gap, free = u - given[0][:, 0], (p[:, 0] > 0) & (p[:, 0] < hardness)
    gap -= gap[free].mean()
    np.testing.assert_allclose(gap[free], 0, atol=2e-8)
    assert gap[p[:, 0] == hardness].max() < -1e-5 and gap[p[:, 0] == 0].min() > 0
    for mean, message in ((-1.0, "between 0 and the hardness"), (hardness, "between")):
        with pytest.raises(ValueError, match=message):
            capped.capped_pressure(*given, mean, hardness=hardness)


def test_punch_is_flat_and_superposes():
    punch = flat_punch.FlatPunch(3.0, 0.7, 5.0)
    scale = 3.0 / (2 * math.pi * 0.7**2)
    for rho in (0.0, 0.5, 0.99, 1.01, 2.0, 50.0):
        quadrature = scale * chord_displacement(0.7 * rho, 0.0, 0.7, 0.7, -0.5) / (math.pi * 5.0)
        assert math.isclose(punch.displacement(0.7 * rho), quadrature, rel_tol=1e-12)
    t, w = gauss(200)
    angle = 2 * np.pi * np.arange(8)[:, None] / 8
    r = 0.7 * np.sin(t * np.pi / 2)
    ring = punch.pressure(r) * r * 0.7 * np.cos(t * np.pi / 2) * w * np.pi / 2 * 2 * np.pi / 8
    assert math.isclose(8 * np.sum(ring), 3.0, rel_tol=1e-10)  # p at the rim: 1e-4 from a, 1e-12/1e-4 lost
    nodes = r * np.cos(angle), r * np.sin(angle), np.broadcast_to(ring, (8, 200))
    for nu in RATIOS:
        for z in (0.05, 0.5, 3.0):
            quadrature = superposed(of_point(nu), 0.0, 0.0, z, nodes)
            np.testing.assert_allclose(punch.axis_stress(z, nu), quadrature, rtol=0, atol=1e-9 * scale)
    assert list(flat_punch.FlatPunch(1.0, 1.0, 1.0).pressure([1.0, 1.5])) == [np.inf, 0.0]


def test_rounded_punch_superposes():
    """Force, approach, surface beside the contact and stress below it, of the pressure on rings alone."""
    for b, edge in ((0.7, 3.0), (0.7, 0.02), (1e-3, 3.0)):
        punch = rounded_punch.RoundedPunch(0.05, b, edge, 5.0)
        a = punch.contact_radius
        t, w = gauss(200)
        place, width = t**3 * (10 - 15 * t + 6 * t**2), 30 * t**2 * (1 - t) ** 2 * w  # dense at both ends
        r = np.concatenate([b * place, b + (a - b) * place])
        p = punch.pressure(r)
        line = 2 / 5.0 * p * np.concatenate([b * width, (a - b) * width])
        ring = line * 5.0 * math.pi * r
        assert math.isclose(np.sum(ring), 0.05, rel_tol=1e-9)
        gap = max(0.9 * a - b, 0.0) ** 2 / (2 * edge)
        assert punch.displacement(0.0) == punch.approach
        assert math.isclose(np.sum(line), punch.approach, rel_tol=1e-9)
        assert math.isclose(punch.displacement(0.9 * a), punch.approach - gap, rel_tol=1e-12)
        for x in (1.01 * a, 3.0 * a):  # potential of a ring, with the complete elliptic integral
            beside = np.sum(line * 2 / math.pi * r / (x + r) * ellipk(4 * x * r / (x + r) ** 2))
            assert math.isclose(punch.displacement(x), beside, rel_tol=1e-8)
        z = 0.4 * a  # Boussinesq, Johnson 1985, Eq. 3.19
        normal = -np.sum(1.5 / math.pi * ring * z**3 / np.hypot(r, z) ** 5)
        assert math.isclose(punch.axis_stress(z, 0.3)[2], normal, rel_tol=1e-9)


def test_rounded_punch_is_a_sphere_or_flat_in_the_limit():
    round_one = rounded_punch.RoundedPunch(2.0, 1e-7, 3.0, 5.0)
    ball, flat = hertz.CircularContact(2.0, 3.0, 5.0), flat_punch.FlatPunch(2.0, 0.7, 5.0)
    assert round_one.approach == pytest.approx(ball.approach, rel=1e-6)
    sharp, r = rounded_punch.RoundedPunch(2.0, 0.7, 1e-12, 5.0), np.array([0.0, 0.3, 0.6])
    assert sharp.approach == pytest.approx(flat.approach, rel=1e-6)
    assert sharp.pressure(r) == pytest.approx(flat.pressure(r), rel=1e-4)
    assert list(sharp.pressure([0.71, 2.0])) == [0.0, 0.0]


def test_sphere_bulges_the_surface_as_reciprocity_says():
    """Reciprocity: u_z(x) of a unit force there = integral over the sphere of e s_kk of that force."""
    sphere = mindlin_cheng.EigenstrainSphere(0.01, 0.5, 0.8, 2.0, 0.3)
    t, w = gauss(40)
    radius, cosine = 0.5 * t[:, None, None], (2 * t - 1)[None, :, None]
    angle = 2 * np.pi * np.arange(40) / 40
    lateral = radius * np.sqrt(1 - cosine**2)
    volume = 0.5 * w[:, None, None] * 2 * w[None, :, None] * 2 * np.pi / 40 * radius**2
    for x in (0.0, 0.4, 3.0):
        stress = of_point(0.3)(lateral * np.cos(angle) - x, lateral * np.sin(angle), 0.8 + radius * cosine)
        expected = 0.01 * np.sum(stress[..., :3].sum(axis=-1) * volume)
        assert expected < 0
        assert math.isclose(sphere.surface_displacement(x, 0.0), expected, rel_tol=1e-9)  # of 40 points


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


@pytest.mark.parametrize(
    "name, call",
    [
        ("E2 and nu2", lambda: hertz.effective_modulus(210e9, 0.3, 210e9)),
        ("nu1", lambda: hertz.effective_modulus(1.0, 0.6)),
        ("E1", lambda: hertz.effective_modulus(-1.0, 0.3)),
        ("radius", lambda: hertz.CircularContact(1.0, 0.0, 1.0)),
        ("force", lambda: elliptic.EllipticContact(math.nan, 1.0, 1.0, 1.0)),
        ("radius_y", lambda: elliptic.EllipticContact(1.0, 1.0, -1.0, 1.0)),
        ("nu", lambda: hertz.axis_stress(1.0, 1.0, 1.0, -0.1)),
        ("z", lambda: hertz.axis_stress([1.0, -1e-9], 1.0, 1.0, 0.3)),
        ("x", lambda: hamilton.tangential_stress(np.nan, 0.0, 1.0, 1.0, contact_radius=1.0, nu=0.3)),
        ("peak_pressure", lambda: hertz.largest_von_mises(math.inf, 1.0, 0.3)),
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


# shakedown limits of a travelling load


def in_plane(friction):
    """The stresses over p0 in y = 0."""
    x, z = np.meshgrid(np.linspace(-1.5, 1.5, 301), np.linspace(0.0, 1.0, 201))
    return hamilton.sliding_stress(x, 0.0, z, 1.0, contact_radius=1.0, nu=0.3, friction=friction)


def test_ball_of_a_simplex():
    """Corners of a cube's half: a triangle that is right-angled lies in the ball of its longest side."""
    centre, radius = smallest_ball(np.array([[0.0, 0, 0], [2, 0, 0], [0, 2, 0], [0.5, 0.5, 0]]))
    assert centre == pytest.approx([1, 1, 0], abs=1e-6) and radius == pytest.approx(np.sqrt(2), rel=1e-6)


@pytest.mark.parametrize(("friction", "alternates", "depth"), [(0.0, False, 0.35), (0.2, True, 0.3)])
def test_the_limit_is_that_of_the_largest_shear(friction, alternates, depth):
    """Without friction, or with traction that alternates, both signs of the largest s_xz lie on the ball."""
    limit, _ = travelling_limit(friction, alternates=alternates, depths=np.array([depth]))
    assert limit == pytest.approx(1 / np.abs(in_plane(friction)[..., 4]).max(), rel=1e-3)


def test_in_place_the_limit_is_twice_first_yield():
    """First yield at 1.6128 yield stresses for nu = 0.3; friction moves the worst point off the axis."""
    limit, depth = in_place_limit(0.0)
    assert limit == pytest.approx(2 * 1.6128 * np.sqrt(3), rel=1e-4)
    assert depth == pytest.approx(0.48, abs=0.01)
    first_yield = von_mises(in_plane(0.2)[20:]).max() / np.sqrt(3)  # below the surface
    assert in_place_limit(0.2)[0] == pytest.approx(2 / first_yield, rel=1e-3)


def test_cells_tend_to_the_limit_with_the_square_of_their_width():
    """In place, without friction: the middle of a cell is at 0.5 of both widths, the worst point at 0.48."""
    limit = in_place_limit(0.0)[0]
    first, second = (cell_limit(0.0, h, np.zeros(1)) / limit - 1 for h in (1 / 9, 1 / 27))
    assert 0 < second < first / 3 and first < 5e-3
