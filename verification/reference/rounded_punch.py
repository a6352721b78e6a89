# SPDX-License-Identifier: MIT
"""A rigid punch with a flat end and a rounded edge on a half-space, frictionless.

The gap is zero for r <= b and (r - b)^2/(2 R) beyond. Its Abel transform g(s) = s/R [sqrt(s^2 - b^2) - b
acos(b/s)], s > b, is the approach at the contact radius s (Sneddon, Int. J. Eng. Sci. 3 (1965) 47), and the
contact is a sum of flat punches of the radii s from b to a, each with the approach dg: pressure, surface and
stress follow from those of `flat_punch`. The shape: Ciavarella, Hills & Monno, Proc. Inst. Mech. Eng. C 212
(1998) 319.
"""

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.optimize import brentq

from .checks import Checked, depth
from .flat_punch import FlatPunch
from .quadrature import gauss

POINTS = 200  # of Gauss, in the fourth root of the distance from a branch point: force to 1e-9


@dataclass(frozen=True)
class RoundedPunch(Checked):
    """Flat end b and radius R of its edge (m), force (N), modulus E* (Pa). Profiles take r, z >= 0 in m."""

    force: float
    flat: float
    radius: float
    modulus: float

    @cached_property
    def contact_radius(self) -> float:
        """a in m: F = E* a^3/(3 R) [(4 - e^2) sqrt(1 - e^2) - 3 e acos e], e = b/a = cos t."""
        hertz = (0.75 * self.force * self.radius / self.modulus) ** (1.0 / 3.0)

        def missing(share: float) -> float:
            a = self.flat + share * hertz
            t = _angle(share * hertz / a)
            bracket = math.sin(t) * (3.0 + math.sin(t) ** 2) - 3.0 * math.cos(t) * t
            return self.modulus * a**3 / (3.0 * self.radius) * bracket / self.force - 1.0

        return self.flat + hertz * brentq(missing, 0.0, 1.0 + 1e-9, xtol=1e-15, rtol=1e-14)

    @property
    def approach(self) -> float:
        """a/R [sqrt(a^2 - b^2) - b acos(b/a)], m."""
        a, b = self.contact_radius, self.flat
        return a / self.radius * (math.sqrt((a - b) * (a + b)) - b * _angle((a - b) / a))

    def pressure(self, r) -> np.ndarray:
        """E*/pi times the integral of dg/sqrt(s^2 - r^2) over s from max(r, b) to a, Pa; 0 outside."""
        r, a = depth("r", r), self.contact_radius
        low = np.maximum(np.minimum(r, a), self.flat)
        # s^2 = r^2 + u^2; the derivative of g has a square root at s = b
        least = np.sqrt(np.maximum(low**2 - r**2, 0.0))
        most = np.sqrt(np.maximum(a**2 - r**2, 0.0))
        t, w = _fourth_powers()
        u = least[..., None] + (most - least)[..., None] * t
        s = np.sqrt(r[..., None] ** 2 + u**2)
        found = (self._slope(np.maximum(s - self.flat, 0.0)) / s * w).sum(axis=-1) * (most - least)
        return np.where(r < a, self.modulus / math.pi * found, 0.0)[()]

    def displacement(self, r) -> np.ndarray:
        """u_z of the surface (both bodies) at r, m: the approach less the gap inside the contact."""
        r, (s, share) = depth("r", r), self._punches()
        gap = np.maximum(r - self.flat, 0.0) ** 2 / (2.0 * self.radius)
        beside = s / np.maximum(r, self.contact_radius)[..., None]
        outside = (share * 2.0 / math.pi * np.arcsin(beside)).sum(axis=-1)
        return np.where(r < self.contact_radius, self.approach - gap, outside)[()]

    def axis_stress(self, z, nu: float) -> np.ndarray:
        """Stresses on the axis, (..., 6) in Pa."""
        forces = ((s, 2.0 * self.modulus * s * share) for s, share in zip(*self._punches(), strict=True))
        return np.sum([FlatPunch(force, s, self.modulus).axis_stress(z, nu) for s, force in forces], axis=0)

    def _slope(self, beyond: np.ndarray) -> np.ndarray:
        """dg/ds at s = b + beyond: [2 sqrt(s^2 - b^2) - b acos(b/s)]/R."""
        s = self.flat + beyond
        return (2.0 * np.sqrt(beyond * (s + self.flat)) - self.flat * _angle(beyond / s)) / self.radius

    def _punches(self) -> tuple[np.ndarray, np.ndarray]:
        """Radii and approaches of flat punches that together are this one."""
        t, w = _fourth_powers()
        beyond = (self.contact_radius - self.flat) * t
        return self.flat + beyond, self._slope(beyond) * w * (self.contact_radius - self.flat)


def _angle(share):
    """acos(1 - share), without the loss of digits where it is small."""
    return 2.0 * np.arcsin(np.sqrt(share / 2.0))


def _fourth_powers() -> tuple[np.ndarray, np.ndarray]:
    """Points and weights on (0, 1), dense at 0."""
    x, w = gauss(POINTS)
    return x**4, 4.0 * x**3 * w
