# SPDX-License-Identifier: MIT
"""The integrals that carry every stress under the traction sqrt(1 - r^2/a^2), r < a, in closed form.

With rho = r/a, zeta = z/a and the spherical Bessel function j1 (the Hankel transform of sqrt(1 - rho^2) is
j1(k)/k),

    I(m, n) = integral_0^inf j1(k) k^n J_m(k rho) exp(-k zeta) dk,    m = 0..3, n = 0, 1.

Oblate spheroidal coordinates zeta = xi eta, rho^2 = (1 + xi^2)(1 - eta^2) make them elementary: with c = zeta
- i the root w = sqrt(rho^2 + c^2) = xi - i eta, and integral exp(-c k) J_m(k rho) dk = ((w - c)/rho)^m / w
(Watson 1944, 13.2), where (w - c)/rho = sqrt((1 - eta)/(1 + eta)) exp(i phi), cot phi = xi. M = a xi and N =
a eta are the functions of Hamilton (1983). The factors that vanish on the axis, at the edge and at infinity
are written out, so nothing cancels.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.special import elliprd


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
    """Oblate spheroidal coordinates xi >= 0, 0 <= eta <= 1, and xi^2 + eta^2, of rho, zeta >= 0 (arrays, no
    unit).
    """
    difference = (rho - 1.0) * (rho + 1.0) + zeta**2  # xi^2 - eta^2
    total = np.hypot(difference, 2.0 * zeta)  # xi^2 + eta^2
    large = np.sqrt(0.5 * (total + np.abs(difference)))
    small = np.divide(zeta, large, out=np.zeros_like(large), where=large > 0)
    outside = difference >= 0
    return np.where(outside, large, small), np.where(outside, small, large), total


def one_minus_xi_acot(xi) -> np.ndarray:
    """1 - xi acot(xi) = (xi/3) R_D(1 + xi^2, 1 + xi^2, xi^2) for xi >= 0: no cancellation for large xi.

    R_D is Carlson's integral (DLMF 19.16.5). Below xi = 1e-100, where xi^2 would underflow, the value rounds
    to 1.
    """
    xi = np.asarray(xi, dtype=float)
    regular = xi > 1e-100
    square = np.where(regular, xi, 1.0) ** 2
    return np.where(regular, xi / 3.0 * elliprd(1.0 + square, 1.0 + square, square), 1.0)


def hertz_integrals(rho, zeta) -> HertzIntegrals:
    """The eight integrals at rho = r/a, zeta = z/a (>= 0, broadcast); the zeta I(m, 1) are 0 at the edge
    (limit).
    """
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
