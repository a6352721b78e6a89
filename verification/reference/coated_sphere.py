# SPDX-License-Identifier: MIT
"""Paraboloid pressed on a coated half-space: one Fredholm equation, solved in Legendre polynomials.

The problem of O'Sullivan & King, J. Tribol. 110 (1988) 235, without sliding; the method is that of Copson and
Lebedev & Ufliand for dual integral equations (Sneddon 1966; Gladwell 1980). Frictionless; bonded film; the
other body rigid or a bare elastic half-space. With the Hankel transform P(k) of the pressure, E the contact
modulus of film material and counter-body, and c_zz(k) = 2 (1 + g(k h))/(E k), where g tends to 0 for short
waves:

    P(k) = integral_0^a chi(t) cos(k t) dt           p(r) = - integral_r^a chi'(t)/sqrt(t^2 - r^2) dt
    chi(t) + (2/pi) integral_0^inf g P cos(k t) dk = (E/pi) (approach - t^2/R),        chi(a) = 0.

chi = sum c_n P_2n(t/a) turns cosines into spherical Bessel functions, integral_0^1 P_2n(x) cos(q x) dx =
(-1)^n j_2n(q). The contact radius is given and the load found, then the radius is sought that carries the
force asked for.
"""

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.optimize import minimize_scalar, root_scalar
from scipy.special import eval_legendre, j0

from .checks import depth, positive
from .hertz import CircularContact, subsurface_stress
from .layered_axisymmetric import CoatedHalfSpace, hankel_stress, wave_numbers
from .quadrature import gauss

SHORTEST = 20.0
"""Wave number times thickness from which g, of order (k h)^2 exp(-2 k h), is below rounding."""
THINNEST = 1e-3
"""Smallest thickness over contact radius: the number of wave numbers grows with its inverse."""
TAIL = 1e-11
"""Largest share of the last Legendre coefficients in the largest."""


@dataclass(frozen=True)
class CoatedContact:
    """Contact of radius a between the paraboloid r^2/(2 R) and a coated half-space: ``solve_radius``,
    ``solve_force``. counter_modulus: E/(1 - nu^2) of the counter-body in Pa, infinite if rigid. scale = E
    a^2/(pi R); chi = scale times the sum of coefficients times P_2n(t/a); penetration = approach R/a^2. SI
    units.
    """

    layers: CoatedHalfSpace
    radius: float
    contact_radius: float
    counter_modulus: float
    penetration: float
    coefficients: np.ndarray

    @property
    def modulus(self) -> float:
        """E: contact modulus of film material and counter-body, Pa."""
        return _series(self.layers.modulus, self.counter_modulus)

    @property
    def scale(self) -> float:
        """E a^2/(pi R), N/m."""
        return self.modulus * self.contact_radius**2 / (math.pi * self.radius)

    @property
    def approach(self) -> float:
        """Displacement of distant points of the two bodies towards each other, m."""
        return self.penetration * self.contact_radius**2 / self.radius

    @property
    def force(self) -> float:
        """F = 2 pi P(0), N: only P_0 has a mean."""
        return 2.0 * math.pi * self.contact_radius * self.scale * self.coefficients[0]

    @cached_property
    def bare(self) -> CircularContact:
        """Hertz contact on the body without its film, at the same force."""
        modulus = _series(self.layers.modulus_body, self.counter_modulus)
        return CircularContact(self.force, self.radius, modulus)

    def pressure(self, r) -> np.ndarray:
        """p(r), Pa, 0 outside; r >= 0 in m, any shape. With x = t/a and t^2 = r^2 + (a^2 - r^2) u^2: p =
        scale/a sqrt(1 - r^2/a^2) integral_0^1 psi du, where psi = -(d chi/dx)/x is a polynomial in x^2, which
        Gauss points integrate exactly.
        """
        rho2 = (depth("r", r) / self.contact_radius) ** 2
        u, w = gauss(len(self.coefficients))
        inside = np.maximum(1.0 - rho2, 0.0)
        psi = self._slopes(np.minimum(rho2, 1.0)[..., None] + inside[..., None] * u**2)[0]
        return self.scale / self.contact_radius * np.sqrt(inside) * (psi @ w)

    @property
    def central_pressure(self) -> float:
        """p(0), Pa."""
        return float(self.pressure(0.0))

    def largest_pressure(self) -> tuple[float, float]:
        """Largest pressure (Pa) and its radius (m): off the axis under a stiff thin film."""
        r = self.contact_radius * np.sin(np.linspace(0.0, math.pi / 2, 8 * len(self.coefficients) + 64))
        p = self.pressure(r)
        top = int(np.argmax(p))
        if top == 0:
            return float(p[0]), 0.0
        best = minimize_scalar(
            lambda x: -float(self.pressure(x)), bounds=(r[top - 1], r[top + 1]), method="bounded",
            options={"xatol": 1e-7 * self.contact_radius},
        )  # fmt: skip
        return float(-best.fun), float(best.x)

    def transform(self, k) -> np.ndarray:
        """P(k) = integral_0^a p(r) r J0(k r) dr, N, of wave numbers k (n,) in 1/m."""
        a, c = self.contact_radius, self.coefficients
        return self.scale * a * (c @ _cosines(k * a, len(c)))

    def residual(self, count: int = 33) -> float:
        """Largest error of the surface's shape in the contact, over a^2/(2 R), at radii and wave numbers of
        its own. u(r) = (2/E) [integral_0^r chi/sqrt(r^2 - t^2) dt + integral_0^inf g P J0(k r) dk] is
        approach - r^2/(2 R).
        """
        a, h = self.contact_radius, self.layers.thickness
        r = a * np.linspace(0.0, 1.0, count)
        x, w = gauss(2 * len(self.coefficients) + 8)
        angles = np.sin(math.pi / 2 * x)
        chi = sum(c * eval_legendre(2 * n, np.outer(r / a, angles)) for n, c in enumerate(self.coefficients))
        k, weight = wave_numbers(h, 4.0 * a, 1.25 * SHORTEST)
        excess = _excess(self.layers, self.counter_modulus, k)
        spread = j0(np.outer(r, k)) @ (weight * excess * self.transform(k))
        shape = 2.0 / self.modulus * (math.pi / 2 * self.scale * chi @ w + spread)
        error = np.max(np.abs(shape - self.approach + r**2 / (2 * self.radius)))
        return float(error * 2 * self.radius / a**2)

    def stress(self, r, z, film: bool | None = None) -> np.ndarray:
        """Stresses in the plane theta = 0 for every r (n,) and z (m,), in m: (n, m, 6) in Pa. film: the side
        of the interface, None: film above it and body at and below it. The body's stresses are a Hankel
        integral over P(k); the film's are those of the bare half-space under p, closed forms, and what the
        interface sends back, a Hankel integral.
        """
        r, z = np.atleast_1d(depth("r", r)), np.atleast_1d(depth("z", z))
        h = self.layers.thickness
        in_film = z < h if film is None else np.full(len(z), film)
        if np.any(z[in_film] > h) or np.any(z[~in_film] < h):
            raise ValueError(f"z must be <= thickness = {h:g} m in the film and >= thickness in the body")
        stress = np.empty((len(r), len(z), 6))
        for upper in np.unique(in_film):
            stress[:, in_film == upper] = self._side(r, z[in_film == upper], bool(upper))
        return stress

    def _side(self, r: np.ndarray, z: np.ndarray, film: bool) -> np.ndarray:
        """Stresses on one side; integrands decay as exp(-k z), in the film as exp(-k (2 h - z))."""
        decay = 2.0 * self.layers.thickness - np.max(z) if film else np.min(z)
        k, weight = wave_numbers(decay, self.contact_radius + np.max(r), 2.0 * SHORTEST)
        amplitudes = self.layers.amplitudes(k)
        profiles = [self.layers.profiles(k, amplitudes, at, film, reflected=film) for at in z]
        stress = hankel_stress(k, weight * k * self.transform(k), np.stack(profiles, axis=1), r)
        return stress + self._direct(r[:, None], z[None, :]) if film else stress

    def _slopes(self, x2) -> tuple[np.ndarray, np.ndarray]:
        """psi = -(d chi/dx)/x and (d psi/dx)/x over scale, of x^2; P_2n(x) is P_n^(0,-1/2)(2 x^2 - 1)."""
        y = 2.0 * np.asarray(x2) - 1.0
        n = np.arange(1, len(self.coefficients))
        first = -2.0 * self.coefficients[1:] * (n + 0.5)
        second = 2.0 * first[1:] * (n[1:] + 1.5)
        return _jacobi_sum(first, 1.0, 0.5, y), _jacobi_sum(second, 2.0, 1.5, y)

    def _direct(self, r, z) -> np.ndarray:
        """Stresses of a bare half-space of the film's material under p(r): Hertz contacts of all radii up to
        a. p = scale/a [psi(1) sqrt(1 - x^2) - integral_x^1 psi'(y) sqrt(y^2 - x^2) dy], x = r/a; split at y =
        x.
        """
        a, nu = self.contact_radius, self.layers.poisson
        psi = self._slopes(1.0)[0]
        stress = psi * subsurface_stress(r, 0.0, z, 1.0, contact_radius=a, nu=nu)
        t, w = gauss(len(self.coefficients) + 24)
        rim = np.clip(r / a, 0.0, 1.0)
        for start, sign in ((0.0, -1.0), (1.0, 1.0)):
            length = np.abs(start - rim)
            for node, share in zip(t, w, strict=True):
                y = rim + sign * length * node**2  # the square root at y = x becomes smooth
                factor = 2.0 * node * share * length * self._slopes(y**2)[1] * y**2
                smaller = a * np.maximum(y, 1e-9)
                places = r / smaller, 0.0, z / smaller
                part = subsurface_stress(*places, 1.0, contact_radius=1.0, nu=nu)
                stress = stress - factor[..., None] * part
        return self.scale / a * stress


def solve_radius(
    layers: CoatedHalfSpace, radius: float, contact_radius: float, counter_modulus: float = math.inf
) -> CoatedContact:
    """The contact of radius a (m) of a paraboloid of radius R (m); its force follows. ``CoatedContact`` for
    the rest. RuntimeError where the pressure would be tensile somewhere, or the expansion does not converge.
    """
    a, h = positive("contact_radius", contact_radius), layers.thickness
    positive("radius", radius)
    if not counter_modulus > 0:
        raise ValueError(f"counter_modulus = {counter_modulus!r} must be > 0 (infinite: rigid)")
    what = f"thickness/contact_radius = {h / a:.3g}"
    if h < THINNEST * a:
        raise ValueError(f"{what} must be >= {THINNEST:g}")
    k, weight = wave_numbers(h, 2.0 * a, SHORTEST)
    weighted = weight * a * _excess(layers, counter_modulus, k)
    count = 12 + math.ceil(7.0 * math.sqrt(a / h))
    while True:
        penetration, c = _expand(_cosines(k * a, count), weighted)
        if np.max(np.abs(c[-2:])) < TAIL * np.max(np.abs(c)):
            break
        if count > 400:
            raise RuntimeError(f"Legendre expansion does not converge at {what}")
        count = count * 3 // 2
    contact = CoatedContact(layers, radius, a, counter_modulus, penetration, c)
    if np.min(contact.pressure(np.linspace(0.0, 0.999, 200) * a)) < 0:
        raise RuntimeError(f"tensile pressure at {what}: the contact is not one disc")
    return contact


def _expand(cosines: np.ndarray, weighted: np.ndarray) -> tuple[float, np.ndarray]:
    """Penetration d and coefficients with chi(a) = 0: Galerkin in P_2m for the right-hand sides 1 and x^2."""
    count = len(cosines)
    matrix = (cosines * weighted) @ cosines.T * (2.0 / math.pi)
    matrix[np.diag_indices(count)] += 1.0 / (4.0 * np.arange(count) + 1.0)
    right = np.zeros((count, 2))
    right[0] = 1.0, 1.0 / 3.0
    right[1, 1] = 2.0 / 15.0
    one, square = np.linalg.solve(matrix, right).T
    penetration = square.sum() / one.sum()
    return float(penetration), penetration * one - square


def solve_force(
    layers: CoatedHalfSpace, radius: float, force: float, counter_modulus: float = math.inf
) -> CoatedContact:
    """The contact that carries the force (N): log(a) by the secant method, as F grows nearly like a^3."""
    bare = CircularContact(force, radius, _series(layers.modulus_body, counter_modulus))
    film = CircularContact(force, radius, _series(layers.modulus, counter_modulus))

    tried = {}

    def miss(log_a: float) -> float:
        tried[log_a] = solve_radius(layers, radius, math.exp(log_a), counter_modulus)
        return math.log(tried[log_a].force / force)

    weight = layers.thickness / (layers.thickness + bare.contact_radius)
    start = (1.0 - weight) * math.log(bare.contact_radius) + weight * math.log(film.contact_radius)
    found = root_scalar(miss, x0=start, x1=start + 0.01, method="secant", xtol=1e-11, maxiter=30)
    contact = min(tried.values(), key=lambda contact: abs(math.log(contact.force / force)))
    if not found.converged or abs(contact.force / force - 1.0) > 1e-10:
        raise RuntimeError(f"no contact radius found for force = {force:g} N: {found.flag}")
    return contact


def thin_layer(layers: CoatedHalfSpace, radius: float, contact_radius: float) -> tuple[float, float]:
    """Peak pressure (Pa) and force (N) of a thin bonded layer on a rigid base, a >> thickness (Johnson 1985,
    5.8). Oedometer modulus M = E (1 - nu)/((1 + nu)(1 - 2 nu)): p = M (a^2 - r^2)/(2 R h), F = pi M a^4/(4 R
    h); nu < 0.5.
    """
    nu, a = layers.poisson, positive("contact_radius", contact_radius)
    if nu >= 0.5:
        raise ValueError("poisson = 0.5: an incompressible thin layer has no oedometer modulus")
    oedometer = layers.young * (1.0 - nu) / ((1.0 + nu) * (1.0 - 2.0 * nu))
    peak = oedometer * a**2 / (2.0 * positive("radius", radius) * layers.thickness)
    return peak, math.pi * a**2 * peak / 2.0


def _excess(layers: CoatedHalfSpace, counter_modulus: float, k: np.ndarray) -> np.ndarray:
    """g = c_zz E k/2 - 1 with the counter-body in c_zz and in E: 0 for short waves."""
    modulus = _series(layers.modulus, counter_modulus)
    return (layers.compliance(k) * k / 2.0 - 1.0 / layers.modulus) * modulus


def _cosines(q: np.ndarray, orders: int) -> np.ndarray:
    """(-1)^n j_2n(q) = integral_0^1 P_2n(x) cos(q x) dx for n < orders: (orders, len(q)); q > 0. j_n by its
    recurrence upwards while n <= q, beyond by the ratios j_n/j_(n-1) from their continued fraction (DLMF
    10.51, 10.74(v)): both stable there, and much faster than one call for each order.
    """
    last = 2 * orders - 2
    ratio = np.zeros((last + 1, len(q)))
    following = np.zeros_like(q)
    for n in range(last + 60, 0, -1):
        # above its argument a ratio is below 1; elsewhere it is not used and only kept finite
        following = np.where(n > q - 1.0, 1.0 / np.maximum((2 * n + 1) / q - following, 1e-30), 0.0)
        if n <= last:
            ratio[n] = following
    bessel = np.empty_like(ratio)
    bessel[0] = before = np.sin(q) / q
    older = np.cos(q) / q  # j_(-1)
    for n in range(1, last + 1):
        bessel[n] = np.where(n <= q, (2 * n - 1) / q * before - older, before * ratio[n])
        older, before = before, bessel[n]
    signs = 1.0 - 2.0 * (np.arange(orders) % 2)
    return signs[:, None] * bessel[::2]


def _jacobi_sum(coefficients: np.ndarray, alpha: float, beta: float, y: np.ndarray) -> np.ndarray:
    """Sum of c_n P_n^(alpha, beta)(y), -1 <= y <= 1, by the recurrence in n (DLMF 18.9.1, 18.9.2)."""
    before, now, total = np.zeros_like(y), np.ones_like(y), np.zeros_like(y)
    both = alpha + beta
    for n, c in enumerate(coefficients):
        total = total + c * now
        m = 2.0 * n + both
        ahead = (m + 1.0) * ((m + 2.0) * m * y + alpha**2 - beta**2) * now
        ahead = ahead - 2.0 * (n + alpha) * (n + beta) * (m + 2.0) * before
        before, now = now, ahead / (2.0 * (n + 1.0) * (n + both + 1.0) * m)
    return total


def _series(first: float, second: float) -> float:
    """Modulus of two bodies in contact, 1/(1/first + 1/second)."""
    return 1.0 / (1.0 / first + 1.0 / second)
