# SPDX-License-Identifier: MIT
"""Hertz contact of a cylinder (radius R, length L, force F) and a half-space in plane strain, with full slip.

Sources: McEwen, Phil. Mag. 40 (1949) 454; Johnson, Contact Mechanics (1985), sections 4.2 and 7.1. E* is the
contact modulus, a the half-width, p0 the peak pressure; x runs across the contact.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from .checks import Checked, coordinate, depth, poisson, positive
from .stress import components, largest_mises


@dataclass(frozen=True)
class LineContact(Checked):
    """From force F (N), radius R (m), contact modulus E* (Pa) and length L (m). a^2 = 4 F R/(pi E* L), p0 = 2
    F/(pi a L) = E* a/(2 R) (Johnson 4.43 to 4.45).
    """

    force: float
    radius: float
    modulus: float
    length: float

    def at_pressure(self, peak_pressure: float) -> LineContact:
        """The same bodies under another peak pressure in Pa: F = pi p0^2 R L/E*."""
        p0 = positive("peak_pressure", peak_pressure)
        force = math.pi * p0**2 * self.radius * self.length / self.modulus
        return LineContact(force, self.radius, self.modulus, self.length)

    @property
    def contact_radius(self) -> float:
        """Half-width a in m; the name is that of circular contacts."""
        return math.sqrt(4.0 * self.force * self.radius / (math.pi * self.modulus * self.length))

    @property
    def peak_pressure(self) -> float:
        """Largest pressure p0 in Pa."""
        return 2.0 * self.force / (math.pi * self.contact_radius * self.length)

    @property
    def approach(self) -> float:
        """In m, counted from the surfaces of both bodies at L/2 from the middle: F/(pi E* L) (2 ln(L/a) + 1),
        from the displacement under Hertz's pressure, -p0 a/E* (ln|x| - ...) (Johnson, section 5.6).
        """
        line = self.force / (math.pi * self.modulus * self.length)
        return line * (2.0 * math.log(self.length / self.contact_radius) + 1.0)

    def pressure(self, x) -> np.ndarray:
        """p0 sqrt(1 - x^2/a^2) for |x| < a, else 0, Pa (Johnson 4.44)."""
        s = coordinate("x", x) / self.contact_radius
        return self.peak_pressure * np.sqrt(np.maximum((1.0 - s) * (1.0 + s), 0.0))

    def gap(self, x) -> np.ndarray:
        """Gap in m, 0 inside; a^2/(2 R) (t sqrt(t^2 - 1) - arccosh t) at t = |x|/a > 1 (Johnson, 5.6)."""
        t = np.maximum(np.abs(coordinate("x", x)) / self.contact_radius, 1.0)
        return self.contact_radius**2 / (2.0 * self.radius) * (t * np.sqrt(t * t - 1.0) - np.arccosh(t))

    def displacement(self, x) -> np.ndarray:
        """u_z of both surfaces together, m, counted as the approach."""
        return self.approach - coordinate("x", x) ** 2 / (2.0 * self.radius) + self.gap(x)

    def stress(self, x, z, nu: float, *, friction: float = 0.0) -> np.ndarray:
        """Stresses (..., 6) in Pa in the half-space, under the pressure and the traction friction * p along x
        (Johnson 4.49 and 7.8); x, z in m, broadcast. m, n: McEwen's functions of the place over a.
        """
        x, z = coordinate("x", x) / self.contact_radius, depth("z", z) / self.contact_radius
        c = (1.0 - x) * (1.0 + x) + z**2
        root = np.hypot(c, 2.0 * x * z)
        m, n = np.sqrt((root + c) / 2.0), np.sign(x) * np.sqrt(np.maximum(root - c, 0.0) / 2.0)
        total = m**2 + n**2
        share, lead = (z**2 + n**2) / total, (z**2 - m**2) / total
        xx, zz, xz = 2.0 * z - m * (1.0 + share), m * (share - 1.0), n * lead
        along, down, shear = n * (2.0 - lead) - 2.0 * x, xz, xx
        xx, zz, xz = xx + friction * along, zz + friction * down, xz + friction * shear
        return self.peak_pressure * components(xx, poisson("nu", nu) * (xx + zz), zz, xz=xz)

    def largest_von_mises(self, nu: float) -> tuple[float, float]:
        """Largest von Mises stress (Pa) without friction and its depth (m), on the axis."""
        a = self.contact_radius
        largest, depth = largest_mises(lambda s: self.stress(0.0, s * a, nu), (0.1, 1.5))
        return largest, depth * a
