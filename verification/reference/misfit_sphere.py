# SPDX-License-Identifier: MIT
"""An elasto-plastic body in which a sphere grows: material about a centre with an isotropic eigenstrain e(r).

Small strain, von Mises plasticity with isotropic hardening Y(peeq) and a back-stress, an infinite body. With
the deviator D = s_theta - s_r, the plastic strain (r, theta, phi) = q (-2, 1, 1) and G(r) = 3/r^3 int_0^r e
s^2 ds - e(r), equilibrium r s_r' = 2 D and compatibility (r eps_theta)' = eps_r give (r^3 [(1 - nu) D/E +
q])' = -r^3 e', so that at each radius by itself

    (1 - nu) D/E + q = G,    |D - x| <= Y(peeq),    dx = 2 C dq - 2 g x |dq|,    dpeeq = 2 |dq|,

with the back-stress x/3 (-2, 1, 1), modulus C and recovery g (Prager: g = 0; Armstrong & Frederick 1966,
Mater. High Temp. 24 (2007) 1). Its direction never turns, so that while q grows one way x is known: x =
+-C/g + (x0 -+ C/g) exp(-2 g |q - q0|). Where the sphere grows and shrinks over and over and Y is constant, a
radius with E G <= 2 (1 - nu) Y is elastic in the end, and any other one yields to and fro: there g makes x
tend to a range about 0, and the strain that a period leaves to 0, as in a bar between fixed strains.

What yields makes no stress outside of its zone: there D = E G/(1 - nu) and s_r = -2 D/3, those of an elastic
body. So a free surface that the zone does not reach changes nothing in the plastic strain's own stress.
Lame's problem of a sphere: Timoshenko & Goodier 1970, Art. 152; Hill 1950, Ch. 5 for its plastic shell.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.special import erf

from .checks import coordinate, poisson, positive
from .stress import components

Law = Callable[[np.ndarray], np.ndarray]
PANELS = 200  # in a radius, for integrals over r: 3e-8 of the largest value, where a zone ends in a panel
ENDS = 6.0  # radii: beyond it all profiles have the field of a point (gauss: 1e-15)
GRID = np.arange(ENDS * PANELS + 1) / PANELS
ITERATIONS = 60


def smooth(x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """e/e0 and G/e0 of e0 (1 - x^2)^2 inside x = r/a = 1."""
    s = np.minimum(x, 1.0) ** 2
    return (1.0 - s) ** 2, np.where(x < 1, (4 / 5) * s - (4 / 7) * s**2, 8 / 35 / np.maximum(x, 1.0) ** 3)


def ball(x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """e/e0 and G/e0 of e0 inside x = r/a = 1; at its surface the outside value."""
    inside = x < 1
    return np.where(inside, 1.0, 0.0), np.where(inside, 0.0, 1 / np.maximum(x, 1.0) ** 3)


def gauss(x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """e/e0 and G/e0 of e0 exp(-x^2), x = r/a; G by its series near the centre."""
    local, far = np.exp(-(x**2)), np.maximum(x, 0.05)
    mean = 3 * (np.sqrt(np.pi) * erf(far) - 2 * far * np.exp(-(far**2))) / (4 * far**3)
    series = 2 / 5 * x**2 - 2 / 7 * x**4 + 1 / 9 * x**6 - 1 / 33 * x**8
    return local, np.where(x < 0.05, series, mean - local)


PROFILES = {"smooth": smooth, "ball": ball, "gauss": gauss}


@dataclass(frozen=True)
class Fields:
    """At some distances from the centre: D in Pa, q and the accumulated plastic strain."""

    deviator: np.ndarray
    plastic: np.ndarray
    peeq: np.ndarray


@dataclass(frozen=True)
class GrowingSphere:
    """e0 profile(r/radius) in an infinite body; young in Pa, radius in m, law: yield stress in Pa of the
    accumulated plastic strain; modulus in Pa, recovery: C and g of its back-stress. shares: of e0, which the
    sphere takes one after the other; (1,) is loading, (1, 0) loading and removal.
    """

    young: float
    nu: float
    law: Law
    misfit: float
    radius: float
    profile: str = "smooth"
    shares: Sequence[float] = (1.0,)
    modulus: float = 0.0
    recovery: float = 0.0

    def __post_init__(self):
        for name in ("young", "radius", "misfit"):
            positive(name, getattr(self, name))
        poisson("nu", self.nu)
        if self.profile not in PROFILES:
            raise ValueError(f"profile = {self.profile!r} must be one of {', '.join(PROFILES)}")

    def fields(self, r) -> Fields:
        """D, q and peeq at distances r from the centre in m, any shape."""
        *_, last = self.history(r)
        return last

    def history(self, r) -> Iterator[Fields]:
        """The same after each of the shares."""
        x = coordinate("r", r) / self.radius
        excess = self.misfit * PROFILES[self.profile](x)[1]
        q, peeq, back = np.zeros((3, *excess.shape))
        compliance = (1 - self.nu) / self.young
        for share in self.shares:
            trial = (share * excess - q) / compliance
            sign = np.sign(trial - back)
            dq = self._yielded(sign * trial, peeq, sign * back, compliance)
            q, peeq, back = q + sign * dq, peeq + 2 * dq, sign * self._back(sign * back, dq)
            yield Fields((share * excess - q) / compliance, q, peeq)

    def _back(self, start: np.ndarray, dq: np.ndarray) -> np.ndarray:
        """x after q has grown by dq from x = start."""
        part = 2 * dq if self.recovery == 0 else -np.expm1(-2 * self.recovery * dq) / self.recovery
        return start + (self.modulus - self.recovery * start) * part

    def _yielded(
        self, trial: np.ndarray, peeq: np.ndarray, back: np.ndarray, compliance: float
    ) -> np.ndarray:
        """The increment dq >= 0 of q: trial - dq/compliance = x(dq) + Y(peeq + 2 dq), by Newton's method."""
        low, high = np.zeros_like(trial), (trial - back) * compliance
        yields, dq = trial - back > self.law(peeq), np.zeros_like(trial)
        for _ in range(ITERATIONS):
            excess = trial - dq / compliance - self._back(back, dq) - self.law(peeq + 2 * dq)
            low, high = np.where(excess > 0, dq, low), np.where(excess < 0, dq, high)
            step = 1e-7 * (peeq + 2 * dq + 1e-9)
            slope = 2 * (self.law(peeq + 2 * dq + step) - self.law(peeq + 2 * dq)) / step
            slope += 2 * (self.modulus - self.recovery * self._back(back, dq))
            newton = dq + excess / (1 / compliance + slope)
            dq = np.where((newton > low) & (newton < high), newton, (low + high) / 2)
        return np.where(yields, dq, 0.0)

    @cached_property
    def _outward(self) -> np.ndarray:
        """int_x^ENDS 2 D/s ds from each panel's inner end, (n + 1,) in Pa."""
        found = self._panel(self._thrust, GRID[:-1], GRID[1:])
        return np.append(np.cumsum(found[::-1])[::-1], 0.0)

    def _panel(self, of: Callable, low: np.ndarray, high: np.ndarray) -> np.ndarray:
        """Integrals of a function of s between two radii each, in units of the radius."""
        t, w = np.polynomial.legendre.leggauss(5)
        s = (low + high)[..., None] / 2 + (high - low)[..., None] / 2 * t
        return (of(s) * w).sum(axis=-1) * (high - low) / 2

    def _thrust(self, s: np.ndarray) -> np.ndarray:
        return 2 * self.fields(s * self.radius).deviator / s

    def radial_stress(self, r) -> np.ndarray:
        """s_r in Pa at distances r from the centre in m."""
        x = coordinate("r", r) / self.radius
        last = -2 / 3 * float(self.fields(np.array(ENDS * self.radius)).deviator)
        inner = np.minimum(x, ENDS)
        panel = np.minimum(np.floor(inner * PANELS).astype(int) + 1, int(ENDS * PANELS))
        total = self._outward[panel] + self._panel(self._thrust, inner, panel / PANELS)
        return np.where(x < ENDS, last - total, -2 / 3 * self.fields(x * self.radius).deviator)

    def stress(self, x, y, z) -> np.ndarray:
        """Stress at points from the centre in m, (..., 6) in Pa; x, y, z broadcast."""
        x, y, z = np.broadcast_arrays(coordinate("x", x), coordinate("y", y), coordinate("z", z))
        r = np.sqrt(x**2 + y**2 + z**2)
        deviator, s_r = self.fields(r).deviator, self.radial_stress(r)
        nx, ny, nz = (each / np.where(r == 0, 1.0, r) for each in (x, y, z))
        products = components(nx * nx, ny * ny, nz * nz, ny * nz, xz=nx * nz, xy=nx * ny)
        return (s_r + deviator)[..., None] * components(1.0, 1.0, 1.0) - deviator[..., None] * products

    def zone(self) -> tuple[float, float]:
        """The first and the last radius in m at which there is plastic strain; (0, 0) without any."""
        x = np.linspace(0.0, ENDS, 60001)
        strained = x[self.fields(x * self.radius).peeq > 0]
        return (self.radius * strained[0], self.radius * strained[-1]) if strained.size else (0.0, 0.0)

    def total(self) -> float:
        """The integral of peeq over the body in m^3."""
        found = self._panel(lambda s: self.fields(s * self.radius).peeq * s**2, GRID[:-1], GRID[1:])
        return float(4 * np.pi * self.radius**3 * found.sum())
