# SPDX-License-Identifier: MIT
"""A flat surface pressed on a one-dimensional wave Delta cos(2 pi x/lambda), or on a two-dimensional one,
Delta cos(2 pi x/lambda) cos(2 pi y/lambda); Delta is half of peak to valley.

Source: Westergaard, J. Appl. Mech. 6 (1939) A49; Johnson, Contact Mechanics (1985), section 13.2; of two
dimensions Johnson, Greenwood & Higginson, Int. J. Mech. Sci. 27 (1985) 383. psi = pi x/lambda, the crest is
at x = 0, pressures are per unit area of the plane, lengths in m, pressures in Pa.
"""

import math
from dataclasses import dataclass

import numpy as np

from .checks import Checked, coordinate
from .hertz import CircularContact


@dataclass(frozen=True)
class WavyContact(Checked):
    """Contact of a wave (amplitude, wavelength, m) under a mean pressure (Pa), contact modulus E* (Pa), plane
    strain. Contact is complete from p* = pi E* Delta/lambda. All profiles take x in m, any shape, and are
    periodic.
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
        """Delta (1 - m + m ln m), m = p_mean/p*, m; 0 when complete. The gap at the crest is 0, so it is
        Delta less the approach (relative displacement of the mean planes), with d(approach)/dm = Delta sum_n
        (P_n + P_n-1)(1 - 2m)/n = -Delta ln m: a pressure increment is that of a row of flat strips, whose
        Fourier coefficients are Legendre polynomials (Mehler-Dirichlet).
        """
        m = self.load_ratio
        return self.amplitude * (1.0 - m + m * math.log(m))

    def pressure(self, x) -> np.ndarray:
        """p(x), Pa: 2 p* cos(psi) sqrt(sin^2 psi_a - sin^2 psi) in contact, 0 elsewhere (Johnson, section
        13.2). Complete contact: p_mean + p* cos(2 psi).
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
        arch = m * np.arcsinh(distance / math.sqrt(m))
        return 2.0 * self.amplitude * (np.abs(np.sin(psi)) * distance - arch)

    @property
    def approach(self) -> float:
        """Displacement of the mean planes towards each other since the first touch, m."""
        return self.amplitude - self.mean_gap

    def _phase(self, x) -> np.ndarray:
        """psi = pi x/lambda in [-pi/2, pi/2]."""
        turns = coordinate("x", x) / self.wavelength
        return math.pi * (turns - np.round(turns))

    def _beyond(self, psi) -> np.ndarray:
        """sin^2 psi - sin^2 psi_a = sin(psi - psi_a) sin(psi + psi_a)."""
        edge = math.pi * self.half_width / self.wavelength
        return np.sin(psi - edge) * np.sin(psi + edge)


@dataclass(frozen=True)
class DoublyWavyContact(Checked):
    """Contact of a wave in two dimensions (amplitude, wavelength, m) under a mean pressure (Pa), E* in Pa.
    There is no closed form but in the limits of light and of nearly complete contact.
    """

    amplitude: float
    wavelength: float
    modulus: float
    mean_pressure: float

    @property
    def complete_pressure(self) -> float:
        """p* = sqrt(2) pi E* Delta/lambda: the mean pressure of first complete contact, Pa."""
        return math.sqrt(2.0) * math.pi * self.modulus * self.amplitude / self.wavelength

    @property
    def load_ratio(self) -> float:
        """Mean pressure over p*."""
        return self.mean_pressure / self.complete_pressure

    @property
    def summit(self) -> CircularContact:
        """Hertz on one of the two summits of a wave, of radius lambda^2/(4 pi^2 Delta), each for itself."""
        area = self.wavelength**2
        radius = area / (4.0 * math.pi**2 * self.amplitude)
        return CircularContact(0.5 * self.mean_pressure * area, radius, self.modulus)

    @property
    def light_share(self) -> float:
        """Share of the plane in contact where it is light, pi (3 m/(8 pi))^(2/3), m = p_mean/p*."""
        return math.pi * (3.0 * self.load_ratio / (8.0 * math.pi)) ** (2.0 / 3.0)

    @property
    def heavy_share(self) -> float:
        """The same where it is nearly complete, 1 - 3 (1 - m)/(2 pi): at each of two hollows the pressure
        opens a round crack without intensity at its edge.
        """
        return 1.0 - 1.5 / math.pi * (1.0 - self.load_ratio)

    @property
    def fitted_share(self) -> float:
        """The same in between: fit of Jackson & Streator, Wear 261 (2006) 1337, Eq. 21, to computed ones."""
        m = self.load_ratio
        if m >= 0.8:
            return self.heavy_share
        return self.light_share * (1.0 - m**1.51) + self.heavy_share * m**1.04

    def complete(self, x, y) -> np.ndarray:
        """p(x, y) = p_mean + p* cos(2 pi x/lambda) cos(2 pi y/lambda) of complete contact, Pa."""
        u, v = (np.cos(2.0 * math.pi * coordinate("x", c) / self.wavelength) for c in (x, y))
        return self.mean_pressure + self.complete_pressure * u * v
