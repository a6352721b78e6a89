# SPDX-License-Identifier: MIT
"""Elastic-plastic contact of a sphere and a flat: fits of published finite-element results.

Sources: Kogut & Etsion, ASME J. Appl. Mech. 69 (2002) 657; Jackson & Green, ASME J. Tribol. 127 (2005) 343;
with hardening Etsion, Kligerman & Kadin, Int. J. Solids Struct. 42 (2005) 3716 (unloading), and Ghaednia,
Brake, Berryhill & Jackson, ASME J. Tribol. 141 (2019) 031403 (load and area). The first two
give load and area, divided by those at first yield, over the approach w* divided by that at first yield.
They were fitted to a deformable sphere on a rigid flat: under small strain the half-space under a rigid
sphere is the same problem.

First yield by a factor c of the yield stress Y: p0 = c Y, hence by Hertz (Johnson 1985, Eq. 4.22-4.24)
w_c = (pi c Y/(2 E*))^2 R, A_c = pi R w_c, P_c = (4/3) E* sqrt(R) w_c^(3/2).
"""

import math
from dataclasses import dataclass

import numpy as np

from .checks import Checked, depth, positive
from .hertz import CircularContact


def onset(factor: float, radius: float, modulus: float, yield_stress: float) -> CircularContact:
    """First yield at the peak pressure factor * yield_stress, whose approach, force and area are the units of
    w*, P* and A*; radius in m, E* and yield stress in Pa.
    """
    peak = positive("factor", factor) * positive("yield_stress", yield_stress)
    return CircularContact.from_peak_pressure(peak, radius, modulus)


@dataclass(frozen=True)
class KogutEtsion(Checked):
    """Kogut & Etsion (2002), w* from 0 to 110: Hertz to 1, then two power laws that do not quite meet at 6.
    At 6 the second starts 1.7 % (load) and 2.9 % (area) above the end of the first.
    """

    poisson: float

    largest = 110.0

    @property
    def factor(self) -> float:
        """p0/Y at first yield: K H/Y with the hardness H = 2.8 Y and K = 0.454 + 0.41 nu (Eq. 3)."""
        return 2.8 * (0.454 + 0.41 * self.poisson)

    def load(self, w) -> np.ndarray:
        """P/P_c, table 1; w = w*, any shape. ValueError beyond 110."""
        w = _within(w, self.largest)
        return np.select([w <= 1.0, w <= 6.0], [w**1.5, 1.03 * w**1.425], 1.40 * w**1.263)[()]

    def area(self, w) -> np.ndarray:
        """A/A_c, table 1."""
        w = _within(w, self.largest)
        return np.select([w <= 1.0, w <= 6.0], [w, 0.93 * w**1.136], 0.94 * w**1.146)[()]


@dataclass(frozen=True)
class JacksonGreen(Checked):
    """Jackson & Green (2005) for the yield strain Y/E*: Hertz to w* = 1.9, then one law."""

    poisson: float
    yield_strain: float

    elastic = 1.9

    @property
    def factor(self) -> float:
        """p0/Y at first yield, C = 1.295 exp(0.736 nu)."""
        return 1.295 * math.exp(0.736 * self.poisson)

    def load(self, w) -> np.ndarray:
        """P/P_c; w = w*, any shape. Elastic part and a hardness H_G that falls with a/R."""
        w = depth("w", w)
        safe = np.maximum(w, self.elastic)
        plastic = 4.0 * self._hardness(safe) / self.factor * -np.expm1(-(safe ** (5.0 / 9.0)) / 25.0) * safe
        load = np.exp(-(safe ** (5.0 / 12.0)) / 4.0) * safe**1.5 + plastic
        return np.where(w <= self.elastic, w**1.5, load)[()]

    def area(self, w) -> np.ndarray:
        """A/A_c = w* (w*/1.9)^B, B = 0.14 exp(23 Y/E*)."""
        w = depth("w", w)
        exponent = 0.14 * math.exp(23.0 * self.yield_strain)
        return (w * np.maximum(w / self.elastic, 1.0) ** exponent)[()]

    def _hardness(self, w: np.ndarray) -> np.ndarray:
        """H_G/Y = 2.84 (1 - exp(-0.82 (a/R)^-0.7)), with a/R = (pi C Y/(2 E*)) sqrt(A*)."""
        slope = math.pi * self.factor * self.yield_strain / 2.0 * np.sqrt(self.area(w))
        return -2.84 * np.expm1(-0.82 * slope**-0.7)


def residual_share(w) -> np.ndarray:
    """Displacement of the centre after unloading from the approach w* over that approach, Etsion, Kligerman &
    Kadin (2005): (1 - w*^-0.28) (1 - w*^-0.69), for 1 <= w* <= 170 and linear hardening of 2 % of E.
    """
    w = _within(w, 170.0)
    if np.any(w < 1.0):
        raise ValueError(f"w must be >= 1 everywhere, smallest value {w.min()!r}")
    return ((1.0 - w**-0.28) * (1.0 - w**-0.69))[()]


@dataclass(frozen=True)
class Ghaednia(Checked):
    """Ghaednia et al. (2019), linear hardening, as its authors corrected it (their Eq. 26 has an exponent
    without its sign and without the approach at first yield). Lengths over the radius of the sphere. modulus:
    E*, young: E of the body that yields, yield_stress in Pa; hardening: slope of stress over the total strain
    beyond yield, over young.
    """

    modulus: float
    young: float
    poisson: float
    yield_stress: float
    hardening: float

    @property
    def perfect(self) -> JacksonGreen:
        """The body without hardening, whose area the fit begins with."""
        return JacksonGreen(self.poisson, self.yield_stress / self.modulus)

    @property
    def first(self) -> CircularContact:
        """First yield under a sphere of radius 1 m."""
        return onset(self.perfect.factor, 1.0, self.modulus, self.yield_stress)

    def area_radius(self, approach) -> np.ndarray:
        """a/R at an approach over R beyond 1.9 of that at first yield."""
        d = depth("approach", approach)
        elastic = np.sqrt(d)
        plastic = self.first.contact_radius * np.sqrt(self.perfect.area(d / self.first.approach))
        stiff, share = math.sqrt(self.young / self.yield_stress), self.hardening
        power = share ** (1.0 - (d - self.first.approach))
        bottom = (4.0 - 3.0 * math.exp(-2.0 * stiff * share)) * (1.0 - share)
        return (elastic + (plastic - elastic) * np.exp(-2.0 * stiff * power / bottom))[()]

    def load(self, approach) -> np.ndarray:
        """Force over E* R^2."""
        d, first, factor = depth("approach", approach), self.first, self.perfect.factor
        w, a = d / first.approach, self.area_radius(approach)
        hardness = 2.84 - 0.92 * (1.0 - np.cos(math.pi * a))
        plastic = np.exp(-(w ** (5.0 / 12.0)) / 4.0) * w**1.5
        plastic = plastic - 4.0 * hardness / factor * np.expm1(-(w ** (5.0 / 9.0)) / 25.0) * w
        flat = first.force / self.modulus * plastic
        return (flat - (4.0 / 3.0 * d**1.5 - flat) * np.expm1(-3.3 * self.hardening))[()]


def _within(w, largest: float) -> np.ndarray:
    w = depth("w", w)
    if np.any(w > largest):
        raise ValueError(f"w must be <= {largest:g} everywhere, largest value {w.max()!r}")
    return w
