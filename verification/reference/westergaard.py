# SPDX-License-Identifier: MIT
"""A flat surface pressed on a one-dimensional wave Delta cos(2 pi x/lambda); Delta is half of peak to valley.

Source: Westergaard, J. Appl. Mech. 6 (1939) A49; Johnson, Contact Mechanics (1985), section 13.2. psi = pi
x/lambda, the crest is at x = 0, pressures are per unit area of the plane, lengths in m, pressures in Pa.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from .checks import Checked, coordinate


@dataclass(frozen=True)
class WavyContact(Checked):
    """Contact of a wave (amplitude, wavelength, m) under a mean pressure (Pa), contact modulus E* (Pa), plane
    strain.

    Contact is complete from p* = pi E* Delta/lambda. All profiles take x in m, any shape, and are periodic.
    """

    amplitude: float
    wavelength: float
    modulus: float
    mean_pressure: float

    @property
    def complete_pressure(self) -> float:
        """p* = pi E* Delta/lambda: the mean pressure of first complete contact, Pa."""
        return math.pi * self.modulus * self.amplitude / self.wavelength

    @property
    def load_ratio(self) -> float:
        """sin^2(psi_a) = mean pressure over p*, at most 1 (complete contact)."""
        return min(self.mean_pressure / self.complete_pressure, 1.0)

    @property
    def half_width(self) -> float:
        """Half-width of a contact strip, (lambda/pi) asin sqrt(p_mean/p*), m; lambda/2 when complete."""
        return self.wavelength / math.pi * math.asin(math.sqrt(self.load_ratio))

    @property
    def mean_gap(self) -> float:
        """Delta (1 - m + m ln m), m = p_mean/p*, m; 0 when complete.

        The gap at the crest is 0, so it is Delta less the approach (relative displacement of the mean
        planes), with d(approach)/dm = Delta sum_n (P_n + P_n-1)(1 - 2m)/n = -Delta ln m: a pressure increment
        is that of a row of flat strips, whose Fourier coefficients are Legendre polynomials
        (Mehler-Dirichlet).
        """
        m = self.load_ratio
        return self.amplitude * (1.0 - m + m * math.log(m))

    def pressure(self, x) -> np.ndarray:
        """p(x), Pa: 2 p* cos(psi) sqrt(sin^2 psi_a - sin^2 psi) in contact, 0 elsewhere (Johnson, section
        13.2).

        Complete contact: p_mean + p* cos(2 psi).
        """
        psi = self._phase(x)
        if self.mean_pressure >= self.complete_pressure:
            return self.mean_pressure + self.complete_pressure * np.cos(2.0 * psi)
        return 2.0 * self.complete_pressure * np.cos(psi) * np.sqrt(np.maximum(-self._beyond(psi), 0.0))

    def gap(self, x) -> np.ndarray:
        """g(x), m: 0 in contact; outside 2 Delta [S T - m arsinh(T/sqrt m)], S = sin |psi|, T^2 = S^2 - m.

        Integral of dg/dx = (4 p*/E*) cos(psi) T, the continuation of the pressure across the edge.
        """
        psi = self._phase(x)
        distance = np.sqrt(np.maximum(self._beyond(psi), 0.0))
        m = self.load_ratio
        return (
            2.0 * self.amplitude * (np.abs(np.sin(psi)) * distance - m * np.arcsinh(distance / math.sqrt(m)))
        )

    def _phase(self, x) -> np.ndarray:
        """psi = pi x/lambda in [-pi/2, pi/2]."""
        turns = coordinate("x", x) / self.wavelength
        return math.pi * (turns - np.round(turns))

    def _beyond(self, psi) -> np.ndarray:
        """sin^2 psi - sin^2 psi_a = sin(psi - psi_a) sin(psi + psi_a)."""
        edge = math.pi * self.half_width / self.wavelength
        return np.sin(psi - edge) * np.sin(psi + edge)
