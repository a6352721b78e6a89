# SPDX-License-Identifier: MIT
"""A rigid flat-ended circular punch on a half-space, frictionless.

Sources: Boussinesq (1885); Sneddon, Proc. Camb. Phil. Soc. 42 (1946) 29; Johnson, Contact Mechanics (1985),
section 3.4(a).
"""

import math
from dataclasses import dataclass

import numpy as np

from .checks import Checked, depth, poisson
from .stress import components


@dataclass(frozen=True)
class FlatPunch(Checked):
    """Punch of radius a (m) under a force (N), modulus E* (Pa). Profiles take r, z >= 0 in m."""

    force: float
    contact_radius: float
    modulus: float

    @property
    def approach(self) -> float:
        """F/(2 a E*), m."""
        return self.force / (2.0 * self.contact_radius * self.modulus)

    def pressure(self, r) -> np.ndarray:
        """F/(2 pi a sqrt(a^2 - r^2)) for r < a, Pa, infinite at r = a, 0 outside."""
        rho = depth("r", r) / self.contact_radius
        square = np.where(rho < 1.0, (1.0 - rho) * (1.0 + rho), 1.0)
        inside = self.force / (2.0 * math.pi * self.contact_radius**2) / np.sqrt(square)
        return np.select([rho < 1.0, rho == 1.0], [inside, np.inf], 0.0)[()]

    def displacement(self, r) -> np.ndarray:
        """u_z of the surface (both bodies), m: the approach for r <= a, (2/pi) approach asin(a/r) outside."""
        rho = np.maximum(depth("r", r) / self.contact_radius, 1.0)
        return self.approach * 2.0 / math.pi * np.arcsin(1.0 / rho)

    def axis_stress(self, z, nu: float) -> np.ndarray:
        """Stresses on the axis, (..., 6) in Pa (Sneddon 1946).

        With P = F/(2 pi a^2), t = z/a:

        s_zz = -P (1 + 3 t^2)/(1 + t^2)^2, s_xx = s_yy = P [t^2/(1 + t^2)^2 - (1/2 + nu)/(1 + t^2)].
        """
        nu, square = poisson("nu", nu), (depth("z", z) / self.contact_radius) ** 2
        lateral = square / (1.0 + square) ** 2 - (0.5 + nu) / (1.0 + square)
        normal = -(1.0 + 3.0 * square) / (1.0 + square) ** 2
        return self.force / (2.0 * math.pi * self.contact_radius**2) * components(lateral, lateral, normal)
