# SPDX-License-Identifier: MIT
"""Independent answers to the closed forms: quadrature of point loads, field equations, reciprocity, Fourier
series.

Each ``check_*`` takes the module it verifies, so that a copy with one coefficient changed can be handed to it
and must fail. Tolerances: the quadratures converge exponentially and meet at rounding error times the
condition of the integrand (1e-10 to 1e-13 of the largest value); finite differences of order 8 with a step of
0.005 lengths leave 1e-11 in first and 1e-9 in second derivatives.
"""

import math

import numpy as np
from scipy.special import ellipk, jv, spherical_jn

from verification.reference import point_loads

TENSOR = np.array([[0, 5, 4], [5, 1, 3], [4, 3, 2]])  # component number of s_ij
WEIGHTS = np.array([4 / 5, -1 / 5, 4 / 105, -1 / 280])  # central difference of order 8
RATIOS = (0.0, 0.3, 0.5)


# --- independent tools --------------------------------------------------------------------------------------


def partial(f, point, axis, step):
    """df/dx_axis by central differences of order 8."""
    shift = step * np.eye(3)[axis]
    return (
        sum(w * (f(*(point + k * shift)) - f(*(point - k * shift))) for k, w in enumerate(WEIGHTS, 1)) / step
    )


def assert_elastic(stress, point, nu, step, length):
    """Equilibrium and compatibility (Beltrami-Michell) at a point; length scales the derivatives."""
    point, scale = np.asarray(point, dtype=float), np.max(np.abs(stress(*point)))
    tensor = lambda *x: stress(*x)[TENSOR]  # noqa: E731
    divergence = sum(partial(tensor, point, k, step)[:, k] for k in range(3))
    assert np.max(np.abs(divergence)) < 1e-9 * scale / length

    def second(f, i, j):
        return partial(lambda *x: partial(f, np.array(x), i, step), point, j, step)

    trace = lambda *x: np.trace(tensor(*x))  # noqa: E731
    laplacian = sum(second(tensor, k, k) for k in range(3))
    hessian = np.array([[second(trace, i, j) for j in range(3)] for i in range(3)])
    assert np.max(np.abs(laplacian + hessian / (1 + nu))) < 1e-8 * scale / length**2


def gauss(order):
    """Gauss-Legendre points and weights on (0, 1)."""
    t, w = np.polynomial.legendre.leggauss(order)
    return (t + 1) / 2, w / 2


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
    """The same for a unit disc seen from outside: polar about the centre, r = sin(alpha), far from the
    peak.
    """
    angle = 2 * np.pi * np.arange(count)[:, None] / count
    t, w = gauss(count)
    alpha = t * np.pi / 2
    weight = np.sin(alpha) * np.cos(alpha) ** 2 * w * np.pi / 2 * 2 * np.pi / count
    return (
        np.sin(alpha) * np.cos(angle),
        np.sin(alpha) * np.sin(angle),
        np.broadcast_to(weight, (count, count)),
    )


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
    return (
        np.sum(weight * stretch * chord) * math.gamma(power + 1) * math.gamma(0.5) / math.gamma(power + 1.5)
    )


# --- point loads --------------------------------------------------------------------------------------------


def check_point_loads(module):
    for nu in RATIOS:
        for stress in (module.boussinesq_stress, module.cerruti_stress):
            for point in ((0.4, -0.3, 0.7), (0.02, 0.01, 1.0), (-0.8, 0.5, 0.4)):
                assert_elastic(lambda *x, f=stress, nu=nu: f(*x, 1.0, nu=nu), point, nu, 0.005, 1.0)


# --- sphere: integrals, stresses, profiles ------------------------------------------------------------------


def check_integrals(module):
    t, w = gauss(40)
    panels = np.arange(160)[:, None]
    k, weight = (panels + t).ravel(), np.tile(w, 160)  # exp(-0.3 k) is below 1e-20 at the end
    for rho, zeta in ((1e-3, 0.3), (0.5, 0.4), (1.0, 0.3), (2.5, 0.6), (0.7, 3.0)):
        result = module.hertz_integrals(rho, zeta)
        for n, prefix in ((0, "i"), (1, "z")):
            for m in range(4):
                value = np.sum(weight * spherical_jn(1, k) * k**n * jv(m, k * rho) * np.exp(-k * zeta))
                closed = getattr(result, f"{prefix}{m}") * rho**m / (zeta if n else 1)
                assert abs(closed - value) < 1e-13, (rho, zeta, m, n)


def check_normal(module):
    assert_quadrature(point_loads.boussinesq_stress, module.subsurface_stress)


def check_tangential(module):
    assert_quadrature(point_loads.cerruti_stress, module.tangential_stress)


def assert_quadrature(point_stress, closed):
    """Below the disc (down to 1e-6 from the surface), at the edge, outside: quadrature of the point load."""
    below = [(0.0, 0.0, 0.5), (0.3, -0.4, 0.02), (-0.6, 0.5, 1e-6), (1e-7, 2e-7, 0.2), (0.9, 0.0, 0.01)]
    beside = [(1.0, 0.0, 0.4), (-0.9, 1.1, 0.2), (0.0, -3.0, 0.05), (0.5, 0.2, 4.0)]
    for nu in RATIOS:
        for k, (x, y, z) in enumerate(below + beside):
            nodes = disc_nodes(1, 1, x, y, z) if k < len(below) else outside_nodes()
            expected = superposed(lambda *p, nu=nu: point_stress(*p, 1.0, nu=nu), x, y, z, nodes)
            np.testing.assert_allclose(
                closed(x, y, z, 1.0, contact_radius=1.0, nu=nu),
                expected,
                rtol=0,
                atol=1e-10,
                err_msg=f"{(x, y, z, nu)}",
            )


def check_profiles(module):
    modulus = 3.0
    contact = module.CircularContact(2.0, 0.5, modulus)
    a, p0 = contact.contact_radius, contact.peak_pressure
    for rho in (0.0, 0.35, 0.9, 1.0001, 1.4, 6.0, 1e3):
        quadrature = p0 * chord_displacement(rho * a, 0.0, a, a, 0.5) / (math.pi * modulus)
        assert math.isclose(contact.displacement(rho * a), quadrature, rel_tol=1e-12)
        gap = (rho * a) ** 2 - contact.approach + quadrature  # R = 0.5
        assert abs(contact.gap(rho * a) - gap) < 1e-11 * contact.approach * (1 + rho**2)
        assert (contact.gap(rho * a) == 0) == (rho <= 1)
    t, w = gauss(60)
    r = a * np.sin(t * np.pi / 2)
    force = np.sum(2 * np.pi * r * contact.pressure(r) * a * np.cos(t * np.pi / 2) * w * np.pi / 2)
    assert math.isclose(force, 2.0, rel_tol=1e-13)
    inverse = module.CircularContact.from_peak_pressure(p0, 0.5, modulus)
    assert math.isclose(inverse.force, 2.0, rel_tol=1e-14)


# --- ellipse ------------------------------------------------------------------------------------------------


def check_elliptic(module):
    contact = module.EllipticContact(2.0, 0.5, 1.3, 4.0)
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
            quadrature = superposed(
                lambda *p, nu=nu: point_loads.boussinesq_stress(*p, p0, nu=nu), 0.0, 0.0, z, nodes
            )
            np.testing.assert_allclose(contact.axis_stress(z, nu), quadrature, rtol=0, atol=1e-10 * p0)


# --- wave ---------------------------------------------------------------------------------------------------


def wave_coefficients(module, m, count):
    """Cosine coefficients p_n, n = 0..count, of the pressure; sin(psi) = sqrt(m) sin(t): midpoint rule
    exact.
    """
    wave = module.WavyContact(1.0, 1.0, 1.0, m * math.pi)  # p* = pi
    t = np.pi * (np.arange(8 * count) + 0.5) / (8 * count) - np.pi / 2
    psi = np.arcsin(math.sqrt(m) * np.sin(t))
    measure = math.sqrt(m) * np.cos(t) / np.cos(psi) * np.pi / t.size  # d psi
    weighted = wave.pressure(psi / math.pi) * measure / math.pi
    n = np.arange(count + 1)
    coefficients = np.array([np.sum(weighted * np.cos(2 * k * psi)) for k in n])
    coefficients[1:] *= 2
    return wave, n, coefficients


def check_wave(module):
    for m in (0.1, 0.6):
        wave, n, p = wave_coefficients(module, m, 600)
        assert math.isclose(p[0], wave.mean_pressure, rel_tol=1e-12)
        u = 2 * p[1:] / (2 * math.pi * n[1:])  # E* = 1, k = 2 pi n
        inside, outside = wave.half_width * np.array([0, 0.4, 0.8]), np.array([0.3, 0.4, 0.5])
        x = np.concatenate([inside, outside])
        series = 1 - np.cos(2 * np.pi * x) + np.cos(2 * np.pi * np.outer(x, n[1:])) @ u
        series += wave.mean_gap - 1  # mean plane: the series has no mean
        # the truncated series of u_n ~ n^-2.5 leaves N^-2.5 away from the edge, N = 600: 1e-7
        np.testing.assert_allclose(wave.gap(x), series, atol=5e-7)
        assert np.all(wave.gap(inside) == 0) and np.all(wave.gap(outside) > 0)


# --- flat punch ---------------------------------------------------------------------------------------------


def check_punch(module):
    punch = module.FlatPunch(3.0, 0.7, 5.0)
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
            quadrature = superposed(
                lambda *p, nu=nu: point_loads.boussinesq_stress(*p, 1.0, nu=nu), 0.0, 0.0, z, nodes
            )
            np.testing.assert_allclose(punch.axis_stress(z, nu), quadrature, rtol=0, atol=1e-9 * scale)


# --- rounded punch ------------------------------------------------------------------------------------------


def check_rounded_punch(module):
    """Force, approach, surface beside the contact and stress below it, of the pressure on rings alone."""
    for b, edge in ((0.7, 3.0), (0.7, 0.02), (1e-3, 3.0)):
        punch = module.RoundedPunch(0.05, b, edge, 5.0)
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


# --- eigenstrain sphere -------------------------------------------------------------------------------------


def check_sphere(module):
    for nu in RATIOS:
        sphere = module.EigenstrainSphere(0.01, 0.5, 0.8, 2.0, nu)
        for point in ((0.1, -0.2, 0.7), (0.6, 0.3, 0.5), (0.0, 0.9, 1.5), (0.01, 0.0, 0.2)):
            assert_elastic(sphere.stress, point, nu, 0.0025, 0.5)
        surface = sphere.stress(np.linspace(0, 3, 7), 0.2, 0.0)
        assert np.max(np.abs(surface[..., TENSOR[2]])) < 1e-15 * np.max(np.abs(surface)) * 10
        normal = np.array([0.48, -0.6, 0.64])
        centre = np.array([0, 0, 0.8])
        inner, outer = (sphere.stress(*(centre + 0.5 * (1 + s) * normal))[TENSOR] for s in (-1e-12, 1e-12))
        # continuous traction; the tangential elastic strain jumps by the eigenstrain
        jump = 2.0 * 0.01 / (1 - nu) * (np.eye(3) - np.outer(normal, normal))
        np.testing.assert_allclose(outer - inner, jump, rtol=0, atol=1e-10 * np.max(np.abs(inner)))


def check_sphere_surface(module):
    """Reciprocity: u_z(x) of a unit force there = integral over the sphere of e s_kk of that force."""
    sphere = module.EigenstrainSphere(0.01, 0.5, 0.8, 2.0, 0.3)
    t, w = gauss(40)
    radius, cosine = 0.5 * t[:, None, None], (2 * t - 1)[None, :, None]
    angle = 2 * np.pi * np.arange(40) / 40
    lateral = radius * np.sqrt(1 - cosine**2)
    volume = 0.5 * w[:, None, None] * 2 * w[None, :, None] * 2 * np.pi / 40 * radius**2
    for x in (0.0, 0.4, 3.0):
        stress = point_loads.boussinesq_stress(
            lateral * np.cos(angle) - x, lateral * np.sin(angle), 0.8 + radius * cosine, 1.0, nu=0.3
        )
        expected = 0.01 * np.sum(stress[..., :3].sum(axis=-1) * volume)
        assert expected < 0
        assert math.isclose(
            sphere.surface_displacement(x, 0.0), expected, rel_tol=1e-9
        )  # 40 points a direction
