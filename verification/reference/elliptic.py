# SPDX-License-Identifier: MIT
"""Hertz contact of an ellipsoid (paraboloid with two radii of curvature) and a half-space.

Source: Hertz (1882); Johnson, Contact Mechanics (1985), sections 3.5 and 4.2. The elliptic integrals are
Carlson's symmetric R_F and R_D (DLMF chapter 19), which need no ordering of the axes and lose no digits near
the circle. With A = a^2 + w, B = b^2 + w: integral_l^inf dw/sqrt(A B w) = 2 R_F(A_l, B_l, l), and
integral_l^inf dw/(A sqrt(A B w)) = (2/3) R_D(B_l, l, A_l).
"""

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.special import elliprd, elliprf

from .checks import Checked, coordinate, depth, poisson, positive
from .stress import components, largest_mises


def axis_ratio(radius_ratio: float) -> float:
    """b/a of the contact ellipse for radii of curvature R_y/R_x = radius_ratio, to rounding error. Root of
    R_x/R_y = R_D(0, 1, k^2)/R_D(0, k^2, 1), k = b/a (Johnson, section 4.2(c)). Sought in ln k, between 1 and
    R_y/R_x.
    """
    target = math.log(positive("radius_ratio", radius_ratio))
    if target == 0.0:
        return 1.0
    from scipy.optimize import brentq  # noqa: PLC0415 - a tenth of samfem solve, for ellipses alone

    def residual(log_k: float) -> float:
        square = math.exp(2.0 * log_k)
        return math.log(elliprd(0.0, 1.0, square) / elliprd(0.0, square, 1.0)) + target

    return math.exp(brentq(residual, min(target, 0.0), max(target, 0.0), xtol=1e-15, rtol=8.9e-16))


@dataclass(frozen=True)
class EllipticContact(Checked):
    """Hertz contact from a force (N), radii of curvature R_x, R_y (m) and contact modulus E* (Pa). The
    profile is x^2/(2 R_x) + y^2/(2 R_y). The semi-axes a (along x) and b (along y) follow from a^3 = F R_x
    R_D(0, b^2/a^2, 1)/(pi E*); R_x = R_y is the circle.
    """

    force: float
    radius_x: float
    radius_y: float
    modulus: float

    @cached_property
    def semi_axes(self) -> tuple[float, float]:
        """(a along x, b along y), m."""
        ratio = axis_ratio(self.radius_y / self.radius_x)
        cube = self.force * self.radius_x * elliprd(0.0, ratio**2, 1.0) / (math.pi * self.modulus)
        return math.cbrt(cube), ratio * math.cbrt(cube)

    @property
    def peak_pressure(self) -> float:
        """p0 = 3 F/(2 pi a b), Pa."""
        a, b = self.semi_axes
        return 1.5 * self.force / (math.pi * a * b)

    @property
    def approach(self) -> float:
        """Displacement of distant points towards each other, p0 a b R_F(0, a^2, b^2)/E*, m."""
        return float(self.displacement(0.0, 0.0))

    def pressure(self, x, y) -> np.ndarray:
        """p0 sqrt(1 - x^2/a^2 - y^2/b^2) inside the ellipse, else 0, Pa; x, y in m, broadcast."""
        a, b = self.semi_axes
        inside = 1.0 - (coordinate("x", x) / a) ** 2 - (coordinate("y", y) / b) ** 2
        return self.peak_pressure * np.sqrt(np.maximum(inside, 0.0))

    def displacement(self, x, y) -> np.ndarray:
        """u_z of both surfaces together, m, inside and outside the contact; x, y in m, broadcast. (p0 a b/2
        E*) integral_l^inf (1 - x^2/A - y^2/B) dw/sqrt(A B w), where l is 0 inside, else the root of x^2/A +
        y^2/B = 1 (Johnson, section 3.5). Of one body alone: times E* (1 - nu^2)/E.
        """
        a, b = self.semi_axes
        x2, y2 = (coordinate("x", x) / a) ** 2, (coordinate("y", y) / a) ** 2
        k2 = (b / a) ** 2
        low = _confocal(x2, y2, k2)
        shape = elliprf(1.0 + low, k2 + low, low)
        along, across = elliprd(k2 + low, low, 1.0 + low), elliprd(1.0 + low, low, k2 + low)
        shape = shape - (x2 * along + y2 * across) / 3.0
        return self.peak_pressure * b / self.modulus * shape

    def gap(self, x, y) -> np.ndarray:
        """x^2/(2 R_x) + y^2/(2 R_y) - approach + u_z, m; 0 inside to rounding (1e-15 of the approach)."""
        x, y = coordinate("x", x), coordinate("y", y)
        profile = x**2 / (2.0 * self.radius_x) + y**2 / (2.0 * self.radius_y)
        return profile - self.approach + self.displacement(x, y)

    def axis_stress(self, z, nu: float) -> np.ndarray:
        """Stresses on the axis x = y = 0, (..., 6) in Pa; z >= 0 in m, any shape. With the potentials Phi =
        integral p/rho dA and Psi = -integral p ln(rho + z) dA of the half-space, 2 pi s_zz = Phi_z - z
        Phi_zz, 2 pi s_xx = 2 nu Phi_z + (1 - 2 nu) Psi_xx - z Phi_xx, s_yy likewise. On the axis l = z^2 and
        Psi_xx = -2 pi a b p0/(sqrt A (sqrt A + sqrt B)) - z Phi_xx.
        """
        nu, (a, b) = poisson("nu", nu), self.semi_axes
        zeta, k = depth("z", z) / a, b / a
        A, B = 1.0 + zeta**2, k**2 + zeta**2
        # z Phi_xx, z Phi_yy and Psi_xx, Psi_yy over 2 pi p0; lengths over a
        phi_x = -zeta * k / 3.0 * elliprd(B, zeta**2, A)
        phi_y = -zeta * k / 3.0 * elliprd(A, zeta**2, B)
        roots = np.sqrt(A) + np.sqrt(B)
        psi_x = -k / (np.sqrt(A) * roots) - phi_x
        psi_y = -k / (np.sqrt(B) * roots) - phi_y
        phi_z = psi_x + psi_y  # both potentials are harmonic and Psi_z = -Phi
        stress = components(
            2.0 * nu * phi_z + (1.0 - 2.0 * nu) * psi_x - phi_x,
            2.0 * nu * phi_z + (1.0 - 2.0 * nu) * psi_y - phi_y,
            phi_z + phi_x + phi_y,
        )
        return self.peak_pressure * stress

    def largest_axis_von_mises(self, nu: float) -> tuple[float, float]:
        """Largest von Mises stress on the axis (Pa) and its depth (m), between 0.02 and 2 minor semi-axes."""
        scale = min(self.semi_axes)
        largest, depth = largest_mises(lambda t: self.axis_stress(t * scale, nu), (0.02, 2.0))
        return largest, depth * scale


def _confocal(x2, y2, k2) -> np.ndarray:
    """Largest root l >= 0 of x2/(1 + l) + y2/(k2 + l) = 1 outside the ellipse, 0 inside (lengths over a)."""
    half = 0.5 * (x2 + y2 - 1.0 - k2)
    product = x2 * k2 + y2 - k2  # -l_1 l_2: positive outside
    root = np.sqrt(half**2 + np.maximum(product, 0.0))
    # the form without cancellation for either sign of half
    safe = np.where(half < 0, root - half, 1.0)
    low = np.where(half < 0, product / safe, half + root)
    return np.where(product > 0, low, 0.0)
