# SPDX-License-Identifier: MIT
"""Hardening as a parameter of both models: the yield stress over accumulated plastic strain and depth, the
constants of the back-stresses, and what both dissipate and store in a unit volume.

How a model uses them (return mapping, tangent) is its own. The power of the stress is
s : d eps_p = sigma_y dp + sum X_k : d eps_p. Each back-stress X_k = 2/3 C a_k
stores W = C/3 a_k : a_k and dissipates the rest, dD = 2/3 g C a_k : a_k dp. Along a constant direction N, in
which a = b a_0 + i N with b = exp(-g t), i = (1 - b)/g (see `sam.plasticity.flow`), the integrals over a
step are, with u = g dp, A = a_0 : a_0, B = a_0 : N and N : N = 3/2,

    D = 2/3 g C [ (1 - b^2)/(2 g) A + i^2 B + 3/2 dp^3 phi(u) ],                                           (a)
    phi(u) = [ u - 2 (1 - e^-u) + (1 - e^-2u)/2 ]/u^3.

A step counts X_k at its end, X_k1 : x with x = dp N, which is more than W_1 - W_0 + D by

    E = C dp^2 chi(u) (1 - 2/3 g B),      chi(u) = [ 1 - e^-u (1 + u) ]/u^2,                               (b)

an error of first order in the step. Neither is ever negative, because 2/3 a : a <= 1/g^2. In all
s_1 : x = sigma_y1 dp + sum (W_1 - W_0 + D + E), to rounding.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from itertools import zip_longest
from math import factorial, inf
from typing import Protocol, Self, cast

import numpy as np
from numpy.typing import NDArray

from sam.arrays import Array, Mask

# E over yield stress at most. Annealed lead and indium, the softest of metals in use, have some 1e3 to 1e4; a
# value in MPa that is taken as Pa adds a factor of 1e6 to the 10 to 1e4 of all materials.
SOFTEST = 1e5
OFFSET = 2e-3  # plastic strain of the yield stress that handbooks give, R_p0.2
POINTS, GRADING = 24, 4  # of Gauss's rule in s, peeq = s^GRADING: Swift's law rises within microstrains
# g dp up to which phi and chi are taken from their power series: beyond it their closed forms lose at most
# a factor of 24 of rounding, below it 18 terms leave 1e-16.
SMALL, TERMS = 0.5, 18


def off_unit(usual: float, young: float, key: str) -> str:
    """What a yield stress at OFFSET may be, if it is in another unit than Young's modulus."""
    if usual >= young / SOFTEST:
        return ""
    return (
        f"a yield stress of at least {young / SOFTEST:.4g} Pa, {key}/{SOFTEST:g}, at a plastic strain of "
        f"{OFFSET:g}: it is {usual:.4g} Pa: are values in MPa taken as Pa?"
    )


class YieldCurve(Protocol):
    """Isotropic hardening law, for arrays of any shape."""

    def stress(self, peeq: Array | float) -> Array:
        """The yield stress in Pa at an accumulated plastic strain >= 0."""

    def slope(self, peeq: Array | float) -> Array:
        """d sigma_y/d peeq in Pa; of a table that to the next row."""

    def at(self, points: Mask) -> YieldCurve:
        """The curve of some of the points that it belongs to."""


class Everywhere:
    """A curve that is the same at all points."""

    def at(self, points: Mask) -> Self:
        """The curve of some points."""
        return self


@dataclass(frozen=True)
class Swift(Everywhere):
    """sigma_y = B (C + alpha peeq)^n; B in Pa. Paper Eq. 18 (alpha = 1e6: the strain in microstrain)."""

    B: float
    C: float
    n: float
    alpha: float = 1e6

    def stress(self, peeq: Array | float) -> Array:
        """The yield stress in Pa at an accumulated plastic strain."""
        return self.B * (self.C + self.alpha * np.asarray(peeq)) ** self.n  # paper Eq. 18

    def slope(self, peeq: Array | float) -> Array:
        """d sigma_y/d peeq in Pa."""
        return self.B * self.n * self.alpha * (self.C + self.alpha * np.asarray(peeq)) ** (self.n - 1)


@dataclass(frozen=True)
class Linear(Everywhere):
    """sigma_y = yield_stress + modulus peeq, both in Pa; modulus 0: perfect plasticity."""

    yield_stress: float
    modulus: float = 0.0

    def stress(self, peeq: Array | float) -> Array:
        """The yield stress in Pa at an accumulated plastic strain."""
        return self.yield_stress + self.modulus * np.asarray(peeq)

    def slope(self, peeq: Array | float) -> Array:
        """d sigma_y/d peeq in Pa."""
        return np.full_like(np.asarray(peeq, dtype=float), self.modulus)


@dataclass(frozen=True)
class Tabulated(Everywhere):
    """Linear between the rows (peeq, yield stress in Pa), the first at peeq = 0, constant after the last."""

    peeq: tuple[float, ...]
    yield_stress: tuple[float, ...]

    @classmethod
    def of_rows(cls, rows: Iterable[tuple[float, float]]) -> Tabulated:
        """The curve through the rows (peeq, yield stress in Pa)."""
        return cls(*zip(*rows, strict=True))

    def stress(self, peeq: Array | float) -> Array:
        """The yield stress in Pa at an accumulated plastic strain."""
        return cast(Array, np.interp(peeq, self.peeq, self.yield_stress))

    def slope(self, peeq: Array | float) -> Array:
        """The slope to the right of each point; 0 from the last row on."""
        slopes = np.append(np.diff(self.yield_stress) / np.diff(self.peeq), 0.0)
        row = np.searchsorted(self.peeq, peeq, side="right") - 1
        return cast(Array, slopes[np.clip(row, 0, len(slopes) - 1)])


@dataclass(frozen=True)
class Layered:
    """The curves of a body with a layer; inside: which points lie in it, as peeq."""

    body: YieldCurve
    layer: YieldCurve
    inside: Mask

    def stress(self, peeq: Array | float) -> Array:
        """The yield stress in Pa at an accumulated plastic strain."""
        return np.where(self.inside, self.layer.stress(peeq), self.body.stress(peeq))

    def slope(self, peeq: Array | float) -> Array:
        """d sigma_y/d peeq in Pa."""
        return np.where(self.inside, self.layer.slope(peeq), self.body.slope(peeq))

    def at(self, points: Mask) -> Layered:
        """The curves of some points, (n,)."""
        return Layered(self.body, self.layer, np.broadcast_to(self.inside, points.shape)[points])


@dataclass(frozen=True)
class BackStress:
    """Back-stresses X_k with d X_k = 2/3 C_k d eps_p - g_k X_k dp (Armstrong & Frederick 1966; several:
    Chaboche 1986); g_k = 0: Prager's linear law.

    modulus: C_k in Pa, the slope d sigma/d eps_p in tension at the start; recovery: g_k >= 0. In tension X_k
    tends to C_k/g_k.
    """

    modulus: tuple[float, ...]
    recovery: tuple[float, ...]

    @property
    def saturation(self) -> float:
        """The largest back-stress in tension in Pa, sum of C_k/g_k; infinite with Prager's law."""
        return sum(C / g if g else inf for C, g in zip(self.modulus, self.recovery, strict=True))


@dataclass(frozen=True)
class DepthProfile:
    """Factor on the yield stress over depth in m: linear between rows, constant beyond."""

    depth: tuple[float, ...] = (0.0,)
    factor: tuple[float, ...] = (1.0,)

    def __call__(self, z: Array | float) -> Array:
        """The factor at depths z in m."""
        return cast(Array, np.interp(z, self.depth, self.factor))


@dataclass(frozen=True)
class Kinks:
    """Depths in m, ascending, at which the yield stress has a kink or a jump."""

    depths: tuple[float, ...] = ()

    def interval(self, z: Array | float) -> NDArray[np.intp]:
        """How many kinks lie at or above z: where the number is the same, fields are smooth."""
        return np.searchsorted(self.depths, z, side="right")


@dataclass(frozen=True)
class Strength:
    """The yield stress over depth and accumulated strain: profile(z) times `curve`, or the layer's
    above thickness in m; back, layer_back: constants of back-stresses, with the factor.
    """

    curve: YieldCurve
    profile: DepthProfile = DepthProfile()
    layer: YieldCurve | None = None
    thickness: float = 0.0
    back: BackStress | None = None
    layer_back: BackStress | None = None

    def curve_at(self, z: Array | float) -> YieldCurve:
        """The curve at depths z in m, before the factor of the profile."""
        if self.layer is None:
            return self.curve
        return Layered(self.curve, self.layer, np.less(z, self.thickness))

    def stress(self, z: Array | float, peeq: Array | float) -> Array:
        """The yield stress in Pa at depths z in m and accumulated plastic strains, which broadcast."""
        return self.profile(z) * self.curve_at(z).stress(peeq)

    def back_at(self, z: Array | float) -> tuple[Array, Array] | None:
        """Moduli in Pa and recoveries at depths in m, (N, ...), 0 beyond fewer; or None."""
        if self.back is None and self.layer_back is None:
            return None
        none, z = BackStress((), ()), np.asarray(z, dtype=float)
        body, layer = self.back or none, self.layer_back or none
        inside = np.less(z, self.thickness if self.layer is not None else 0.0)
        pairs = zip_longest(body.modulus, body.recovery, layer.modulus, layer.recovery, fillvalue=0.0)
        values = [(np.where(inside, C1, C), np.where(inside, g1, g)) for C, g, C1, g1 in pairs]
        moduli, recoveries = (np.array(of_all) for of_all in zip(*values, strict=True))
        return self.profile(z) * moduli, recoveries

    def back_saturation(self, z: float) -> float:
        """The largest back-stress in tension at depth z in m, in Pa; 0 without back-stress."""
        in_layer = self.layer is not None and z < self.thickness
        back = self.layer_back if in_layer else self.back
        return 0.0 if back is None else float(self.profile(z)) * back.saturation

    def least(self, peeq: float) -> float:
        """The smallest yield stress at any depth, in Pa; also just above the lower side of a layer."""
        sides = () if self.layer is None else (float(np.nextafter(self.thickness, 0.0)), self.thickness)
        return float(self.stress(np.array([*self.profile.depth, *sides]), peeq).min())

    def with_curves(self, change: Callable[[YieldCurve], YieldCurve]) -> Strength:
        """The same with other curves."""
        layer = None if self.layer is None else change(self.layer)
        return replace(self, curve=change(self.curve), layer=layer)

    @property
    def kinks(self) -> Kinks:
        """The rows of the profile, and the lower side of a layer whose curve is another one."""
        same = self.layer == self.curve and self.layer_back == self.back
        lower = () if self.layer is None or same else (self.thickness,)
        return Kinks(tuple(sorted({*self.profile.depth, *lower})))


@dataclass(frozen=True)
class StepEnergies:
    """Of back-stresses over a step in J/m^3: stored W_1 - W_0, dissipated D of (a), error E of (b)."""

    stored: Array
    dissipated: Array
    error: Array


def plastic_work(curve: YieldCurve, peeq: Array, before: Array | float = 0.0) -> Array:
    """Work of the yield stress, its integral over the accumulated plastic strain from `before` to `peeq`, of
    the same shape or numbers, by Gauss's rule; in the unit of the curve.

    >>> round(float(plastic_work(Linear(1e9, 2e9), np.array(0.02), 0.01)))  # 1e9 0.01 + 1e9 (4e-4 - 1e-4)
    10300000
    """
    s, w = np.polynomial.legendre.leggauss(POINTS)
    s, w = (s + 1) / 2, w / 2
    added, total = peeq - before, np.zeros_like(peeq)
    for at, weight in zip(s, w, strict=True):
        total = total + weight * GRADING * at ** (GRADING - 1) * curve.stress(before + added * at**GRADING)
    return added * total


def stored_energy(modulus: Array, strains: Array) -> Array:
    """Energy W of back-stresses in J/m^3, (cells); modulus: C_k in Pa; strains: a_k, (N, n, cells)."""
    return cast(Array, (modulus * _contraction(strains, strains)).sum(axis=0) / 3)


def step_energies(
    modulus: Array, recovery: Array, start: Array, strain: Array, *, length: Array
) -> StepEnergies:
    """Energies of back-stresses over a step, (cells), from C_k in Pa, g_k, a_k at the start, (N, n,
    cells), and a strain x, (n, cells), of the accumulated length dp, (cells).
    """
    u = recovery * length
    b = np.exp(-u)
    i = np.divide(-np.expm1(-u), recovery, out=length + 0 * u, where=recovery > 0)
    twice = np.divide(-np.expm1(-2 * u), 2 * recovery, out=length + 0 * u, where=recovery > 0)
    A = _contraction(start, start)
    B = np.divide(_contraction(start, strain[None]), length, out=np.zeros_like(u), where=length > 0)
    phi = _joined(
        u,
        [(2 - 2 ** (n - 1)) * (-1) ** n / factorial(n) for n in range(3, 3 + TERMS)],  # 1/3 at u = 0
        lambda v: (v + 2 * np.expm1(-v) - np.expm1(-2 * v) / 2) / v**3,
    )
    chi = _joined(
        u,
        [(n - 1) * (-1) ** n / factorial(n) for n in range(2, 2 + TERMS)],  # 1/2 at u = 0
        lambda v: (-np.expm1(-v) - v * np.exp(-v)) / v**2,
    )
    stored = modulus / 3 * (-2 * recovery * twice * A + 2 * b * i * B + 1.5 * i**2)
    dissipated = recovery * modulus / 1.5 * (twice * A + i**2 * B + 1.5 * length**3 * phi)  # (a)
    error = modulus * length**2 * chi * (1 - recovery * B / 1.5)  # (b)
    return StepEnergies(stored.sum(axis=0), dissipated.sum(axis=0), error.sum(axis=0))


def _contraction(a: Array, b: Array) -> Array:
    """Double contraction of tensors (N, n, cells), (N, cells)."""
    return cast(Array, (a[:, :3] * b[:, :3]).sum(axis=1) + 2 * (a[:, 3:] * b[:, 3:]).sum(axis=1))


def _joined(u: Array, series: list[float], closed: Callable[[Array], Array]) -> Array:
    """A function by its power series near zero, and by its closed form beyond."""
    near = cast(Array, np.polynomial.polynomial.polyval(np.minimum(u, SMALL), series))
    return np.where(u < SMALL, near, closed(np.maximum(u, SMALL)))
