# SPDX-License-Identifier: MIT
"""Hertz contact of a sphere (paraboloid of radius R) and a half-space.

Sources: Hertz (1882); Huber (1904) for the stresses; Johnson, Contact Mechanics (1985), sections 3.4 and 4.2.
The elastic contact modulus is E*; a = contact radius, p0 = peak pressure, F = force, R = relative radius of
curvature. Eight integrals carry every stress under the traction sqrt(1 - r^2/a^2), r < a, along z or x: with
rho = r/a, zeta = z/a and the spherical Bessel function j1 (j1(k)/k is the Hankel transform of sqrt(1 -
rho^2)),

    I(m, n) = integral_0^inf j1(k) k^n J_m(k rho) exp(-k zeta) dk,    m = 0..3, n = 0, 1.

Oblate spheroidal coordinates zeta = xi eta, rho^2 = (1 + xi^2)(1 - eta^2) make them elementary: with c = zeta
- i the root w = sqrt(rho^2 + c^2) = xi - i eta, and integral exp(-c k) J_m(k rho) dk = ((w - c)/rho)^m / w
(Watson 1944, 13.2), where (w - c)/rho = sqrt((1 - eta)/(1 + eta)) exp(i phi), cot phi = xi. M = a xi and N =
a eta are the functions of Hamilton (1983). The factors that vanish on the axis, at the edge and at infinity
are written out, so nothing cancels.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from scipy.special import elliprd

from .checks import Checked, coordinate, depth, poisson, positive
from .stress import components, largest_mises


class HertzIntegrals(NamedTuple):
    """i0..i3 = I(m, 0)/rho^m and z0..z3 = zeta I(m, 1)/rho^m, dimensionless, each regular on the axis."""

    i0: np.ndarray
    i1: np.ndarray
    i2: np.ndarray
    i3: np.ndarray
    z0: np.ndarray
    z1: np.ndarray
    z2: np.ndarray
    z3: np.ndarray


def spheroidal(rho, zeta) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Oblate spheroidal coordinates xi >= 0, 0 <= eta <= 1, and xi^2 + eta^2, of rho, zeta >= 0."""
    difference = (rho - 1.0) * (rho + 1.0) + zeta**2  # xi^2 - eta^2
    total = np.hypot(difference, 2.0 * zeta)  # xi^2 + eta^2
    large = np.sqrt(0.5 * (total + np.abs(difference)))
    small = np.divide(zeta, large, out=np.zeros_like(large), where=large > 0)
    outside = difference >= 0
    return np.where(outside, large, small), np.where(outside, small, large), total


def one_minus_xi_acot(xi) -> np.ndarray:
    """1 - xi acot(xi) = (xi/3) R_D(1 + xi^2, 1 + xi^2, xi^2) for xi >= 0: no cancellation for large xi. R_D
    is Carlson's integral (DLMF 19.16.5). Below xi = 1e-100, where xi^2 would underflow, the value rounds to
    1.
    """
    xi = np.asarray(xi, dtype=float)
    regular = xi > 1e-100
    square = np.where(regular, xi, 1.0) ** 2
    return np.where(regular, xi / 3.0 * elliprd(1.0 + square, 1.0 + square, square), 1.0)


def hertz_integrals(rho, zeta) -> HertzIntegrals:
    """The eight integrals at rho = r/a, zeta = z/a >= 0, broadcast; the zeta I(m, 1) are 0 at the edge."""
    rho, zeta = np.broadcast_arrays(np.asarray(rho, dtype=float), np.asarray(zeta, dtype=float))
    xi, eta, total = spheroidal(rho, zeta)
    sin = 1.0 / np.sqrt(1.0 + xi**2)  # of phi = acot(xi)
    cos = xi * sin
    arc = 2.0 / 3.0 * elliprd(xi**2, 1.0 + xi**2, 1.0 + xi**2)  # phi - sin(phi) cos(phi)
    axial = sin / (1.0 + eta)  # sqrt((1 - eta)/(1 + eta))/rho
    depth = np.divide(zeta, total, out=np.zeros_like(total), where=total > 0)  # zeta/(xi^2 + eta^2)
    bracket = 4.0 * cos**2 * (1.0 + eta) * (2.0 + eta) - eta * (3.0 + eta)
    return HertzIntegrals(
        i0=eta * one_minus_xi_acot(xi),
        i1=arc / 2.0,
        i2=axial**2 * sin**2 * (2.0 + eta) / 3.0,
        i3=axial**3 * sin**2 * cos * (3.0 + eta) / 3.0,
        z0=zeta * arc - depth * rho**2 * sin**3 * cos,
        z1=depth * eta * sin**2,
        z2=depth * sin**3 * cos,
        z3=depth * axial**3 * sin * bracket / 3.0,
    )


def effective_modulus(E1: float, nu1: float, E2: float | None = None, nu2: float | None = None) -> float:
    """Contact modulus 1/E* = (1 - nu1^2)/E1 + (1 - nu2^2)/E2 in Pa; the counter-body is rigid if E2 and nu2
    are None. ValueError if only one of E2, nu2 is given.
    """
    compliance = (1.0 - poisson("nu1", nu1) ** 2) / positive("E1", E1)
    if (E2 is None) != (nu2 is None):
        raise ValueError("E2 and nu2 must be given together, or neither (rigid counter-body)")
    if E2 is not None:
        compliance += (1.0 - poisson("nu2", nu2) ** 2) / positive("E2", E2)
    return 1.0 / compliance


@dataclass(frozen=True)
class CircularContact(Checked):
    """Hertz contact from force F (N), relative radius of curvature R (m) and contact modulus E* (Pa). a^3 = 3
    F R/(4 E*), p0 = 3 F/(2 pi a^2), approach = a^2/R (Johnson 4.22-4.24). Profiles take r >= 0 in m, any
    shape.
    """

    force: float
    radius: float
    modulus: float

    @classmethod
    def from_peak_pressure(cls, peak_pressure: float, radius: float, modulus: float) -> CircularContact:
        """The contact with peak pressure p0 (Pa): F = pi^3 p0^3 R^2/(6 E*^2)."""
        ratio = positive("peak_pressure", peak_pressure) / positive("modulus", modulus)
        force = math.pi**3 / 6.0 * ratio**2 * peak_pressure * positive("radius", radius) ** 2
        return cls(force, radius, modulus)

    @property
    def contact_radius(self) -> float:
        """Contact radius a in m."""
        return math.cbrt(0.75 * self.force * self.radius / self.modulus)

    @property
    def peak_pressure(self) -> float:
        """Largest pressure p0 in Pa."""
        return 1.5 * self.force / (math.pi * self.contact_radius**2)

    @property
    def area(self) -> float:
        """Contact area in m^2."""
        return math.pi * self.contact_radius**2

    @property
    def approach(self) -> float:
        """Displacement of distant points of the two bodies towards each other, m."""
        return self.contact_radius**2 / self.radius

    def pressure(self, r) -> np.ndarray:
        """p0 sqrt(1 - r^2/a^2) for r < a, else 0, Pa (Johnson 3.39)."""
        rho = depth("r", r) / self.contact_radius
        return self.peak_pressure * np.sqrt(np.maximum((1.0 - rho) * (1.0 + rho), 0.0))

    def displacement(self, r) -> np.ndarray:
        """u_z of both surfaces together, m; of one body alone times E* (1 - nu^2)/E. Inside pi p0 (2 a^2 -
        r^2)/(4 a E*); outside, with xi^2 = r^2/a^2 - 1, a p0/(2 E*) [acot xi + xi (1 - xi acot xi)] (Johnson
        3.42, rearranged so that nothing cancels far away).
        """
        a, p0 = self.contact_radius, self.peak_pressure
        rho = depth("r", r) / a
        xi = _outside(rho)
        outside = np.arctan2(1.0, xi) + xi * one_minus_xi_acot(xi)
        shape = np.where(rho < 1.0, 0.5 * math.pi * (2.0 - rho**2), outside)
        return p0 * a / (2.0 * self.modulus) * shape

    def gap(self, r) -> np.ndarray:
        """Gap r^2/(2R) - approach + u_z, m; exactly 0 inside. Outside, with xi^2 = r^2/a^2 - 1: gap = a^2/(pi
        R) [(xi - atan xi) + xi^2 atan xi], positive term by term.
        """
        xi = _outside(depth("r", r) / self.contact_radius)
        excess = xi**3 / 3.0 * elliprd(1.0 + xi**2, 1.0 + xi**2, 1.0)  # xi - atan(xi)
        return self.approach / math.pi * (excess + xi**2 * np.arctan(xi))


def _outside(rho: np.ndarray) -> np.ndarray:
    """xi = sqrt(rho^2 - 1) outside the contact, 0 inside."""
    return np.sqrt(np.maximum((rho - 1.0) * (rho + 1.0), 0.0))


def subsurface_stress(x, y, z, peak_pressure: float, *, contact_radius: float, nu: float) -> np.ndarray:
    """All stresses under the Hertz pressure, (..., 6) in Pa, everywhere in z >= 0 (surface, axis and edge
    included). x, y, z in m, broadcast. With I(m, n) of ``hertz_integrals`` (Huber 1904; Hamilton 1983, normal
    load): s_zz = -p0 [I00 + zeta I01], s_rz = -p0 zeta I11, (s_rr + s_tt)/2 = p0 [zeta I01/2 - (1/2 + nu)
    I00], (s_tt - s_rr)/2 = p0 [zeta I21/2 - (1/2 - nu) I20].
    """
    a, nu = positive("contact_radius", contact_radius), poisson("nu", nu)
    x, y, z = coordinate("x", x) / a, coordinate("y", y) / a, depth("z", z) / a
    i = hertz_integrals(np.hypot(x, y), z)
    mean = 0.5 * i.z0 - (0.5 + nu) * i.i0
    split = 0.5 * i.z2 - (0.5 - nu) * i.i2  # (s_tt - s_rr)/2 over rho^2
    cos2, sin2 = x**2 - y**2, 2.0 * x * y  # rho^2 cos(2 theta), rho^2 sin(2 theta)
    xx, yy, zz = mean - cos2 * split, mean + cos2 * split, -i.i0 - i.z0
    stress = components(xx, yy, zz, -y * i.z1, xz=-x * i.z1, xy=-sin2 * split)
    return positive("peak_pressure", peak_pressure) * stress


def axis_stress(z, peak_pressure: float, contact_radius: float, nu: float) -> np.ndarray:
    """Stresses under the centre, (..., 6) in Pa: s_xx = s_yy and s_zz are principal (Johnson 3.45)."""
    return subsurface_stress(0.0, 0.0, z, peak_pressure, contact_radius=contact_radius, nu=nu)


def largest_von_mises(peak_pressure: float, contact_radius: float, nu: float) -> tuple[float, float]:
    """Largest von Mises stress (Pa) under the Hertz pressure and its depth (m), which is on the axis."""
    a, p0 = positive("contact_radius", contact_radius), positive("peak_pressure", peak_pressure)
    largest, depth = largest_mises(lambda zeta: axis_stress(zeta, 1.0, 1.0, nu), (0.1, 1.5))
    return largest * p0, depth * a
