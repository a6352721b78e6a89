# SPDX-License-Identifier: MIT
"""Frequency response of an elastic coating (thickness h) bonded on an elastic half-space: displacement and
stress.

The surface z = 0 carries, in the frame L along the wave vector, T across, z into the body, the traction

    p cos(k L) (pressing),  q_L sin(k L)  and  q_T cos(k L) (on the body along L and T).

Then u_z, sigma_zz, sigma_LL, sigma_TT go with cos(k L), u_L and sigma_zL with sin(k L); u_T and sigma_zT with
cos(k L), sigma_LT with -sin(k L). All here are the factors before these, per unit traction.

In units of mu_1 (coating) and 1/k a wave that decays downwards, with amplitudes (P, A), is, times e^{-s}, s =
k z,

    u_L = P/2 + (s - kappa/2) A,   u_z = P/2 + (s + kappa/2) A,   kappa = 3 - 4 nu,
    s_zz = -P - (1 + 2 s) A,   s_zL = -P + (1 - 2 s) A,   s_LL = P + (2 s - 3) A,   s_TT = (kappa - 3) A,

where div u carries the factor 1 - 2 nu: incompressible material needs no case of its own. A wave that decays
upwards from the interface, (Q, D), is its mirror image. A wave (P', A') that meets the interface is reflected
and transmitted as

    Q = -lam A',   D = -kap P',   P_2 = (1 - kap) P',   A_2 = (1 - lam) A',
    lam = (r kappa_2 - kappa_1)/(1 + r kappa_2),   kap = (r - 1)/(r + kappa_1),   r = mu_1/mu_2,

and each way through the coating is P' = (P + 2 kh A) e^{-kh}, A' = A e^{-kh}. Only decaying exponentials
appear, and the load determines (P, A) by two equations with the determinant

    det = (1 - lam th)(1 - kap th) - 4 kap kh^2 th,   th = e^{-2 kh}.

Same problem: Burmister, J. Appl. Phys. 16 (1945) 89; O'Sullivan & King, J. Tribol. 110 (1988) 235.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from sam.arrays import Array


@dataclass(frozen=True)
class Layers:
    """A coating on a half-space, in Pa and m. ValueError for a number outside of its range."""

    young: float
    poisson: float
    thickness: float
    young_body: float
    poisson_body: float

    def __post_init__(self) -> None:
        for name in ("young", "thickness", "young_body"):
            if not (math.isfinite(getattr(self, name)) and getattr(self, name) > 0):
                raise ValueError(f"{name} = {getattr(self, name)!r} must be finite and > 0")
        for name in ("poisson", "poisson_body"):
            if not 0 <= getattr(self, name) <= 0.5:
                raise ValueError(f"{name} = {getattr(self, name)!r} must be in 0 ... 0.5")

    @property
    def shear(self) -> float:
        """mu_1 of the coating, Pa."""
        return self.young / (2 * (1 + self.poisson))

    @property
    def ratio(self) -> float:
        """r = mu_1/mu_2."""
        return self.shear * 2 * (1 + self.poisson_body) / self.young_body

    @property
    def kappa(self) -> tuple[float, float]:
        """3 - 4 nu of coating and body."""
        return 3 - 4 * self.poisson, 3 - 4 * self.poisson_body


def sinh_excess(x: Array) -> Array:
    """e^{-x} (sinh x - x) >= 0 with all its digits; for x < 1 the series of sinh."""
    small = np.minimum(x, 1.0)
    series = sum(small ** (2 * n + 1) / math.factorial(2 * n + 1) for n in range(8, 0, -1))
    return np.where(x < 1, np.exp(-x) * series, -np.expm1(-2 * x) / 2 - x * np.exp(-x))


class Response:
    """Response of a coated half-space at a wave number times thickness kh > 0: stress and k mu_1 u."""

    def __init__(self, layers: Layers, kh: Array):
        self.layers, self.kh = layers, np.asarray(kh, dtype=float)
        r, (kappa1, kappa2) = layers.ratio, layers.kappa
        self.lam, self.not_lam = (r * kappa2 - kappa1) / (1 + r * kappa2), (1 + kappa1) / (1 + r * kappa2)
        self.kap, self.not_kap = (r - 1) / (r + kappa1), (1 + kappa1) / (r + kappa1)  # 1 - lam, 1 - kap
        self.rho, self.not_rho = (r - 1) / (r + 1), 2 / (r + 1)
        self.th, self.gap = np.exp(-2 * self.kh), -np.expm1(-2 * self.kh)  # e^{-2 kh} and 1 - e^{-2 kh}

    def _less(self, reflection: float, rest: float) -> Array:
        """1 - reflection th >= 0 as a sum of terms of one sign; rest = 1 - reflection."""
        return rest + reflection * self.gap if reflection > 0 else 1 - reflection * self.th

    @cached_property
    def det(self) -> Array:
        """(1 - lam th)(1 - kap th) - 4 kap kh^2 th as a sum of positive terms. For kap > 0, with lam = 1 - (1
        - lam): (1 - kap)(1 - lam th) + kap [(1 - lam)(1 - th) th + (1 - th)^2 - 4 kh^2 th], and the last two
        are 4 e^{-2 kh} (sinh^2 kh - kh^2).
        """
        kh, th, upper = self.kh, self.th, self._less(self.lam, self.not_lam)
        if self.kap <= 0:
            return upper * (1 - self.kap * th) - 4 * self.kap * kh * kh * th
        excess = sinh_excess(kh)
        bending = 4 * excess * (excess + 2 * kh * np.exp(-kh))
        return self.not_kap * upper + self.kap * (self.not_lam * self.gap * th + bending)

    def _numerator(self, sign: int) -> Array:
        """1 - lam kap th^2 + sign 4 kap kh th; a sum of positive terms wherever terms of both signs could
        cancel. kap > 0 and sign = -1: (1 - kap) + kap [(1 - lam) th^2 + 1 - th^2 - 4 kh th]; the last three
        are 2 e^{-2 kh} (sinh 2 kh - 2 kh). kap < 0, lam < 0 and sign = 1: the same with |lam| and 1 - lam
        kap.
        """
        lam, kap, kh, th = self.lam, self.kap, self.kh, self.th
        r, (kappa1, kappa2) = self.layers.ratio, self.layers.kappa
        shear = 2 * sinh_excess(2 * kh)
        both = r * (1 + kappa1) * (1 + kappa2) / ((1 + r * kappa2) * (r + kappa1))  # 1 - lam kap
        if kap > 0 and sign < 0:
            return self.not_kap + kap * (self.not_lam * th * th + shear)
        if lam < 0 and kap < 0 and sign > 0:
            beyond = (kappa1 - 1 - 2 * r * kappa2) / (1 + r * kappa2)  # |lam| - 1
            return both - kap * (beyond * -np.expm1(-4 * kh) + shear)
        if lam * kap > 0:
            return both + lam * kap * -np.expm1(-4 * kh) + sign * 4 * kap * kh * th
        return 1 - lam * kap * th * th + sign * 4 * kap * kh * th

    @cached_property
    def surface(self) -> Array:
        """mu_1 k (c_zz, c_zL, c_LL, c_TT), (4, ...): u_z = c_zz p + c_zL q_L, u_L = c_zL p + c_LL q_L."""
        kappa1, kh, th = self.layers.kappa[0], self.kh, self.th
        cross = th * (self.not_lam - self.not_kap - 4 * kh * kh * self.kap) / self.det
        return np.stack(
            [
                (1 + kappa1) / 4 * self._numerator(1) / self.det,
                (1 - kappa1) / 4 + (1 + kappa1) / 4 * cross,
                (1 + kappa1) / 4 * self._numerator(-1) / self.det,
                self._less(-self.rho, 1 + self.rho) / self._less(self.rho, self.not_rho),
            ]
        )

    @cached_property
    def _down(self) -> Array:
        """(P, A) at z = 0 for the loads p and q_L: (load, 2, ...)."""
        x = 2 * self.kh * self.kap * self.th
        first = self._less(self.lam, self.not_lam) - 2 * self.kh * x
        second = self._less(self.kap, self.not_kap)
        return np.array([[first + x, second + x], [first - x, x - second]]) / (2 * self.det)

    @cached_property
    def _arriving(self) -> Array:
        """(P', A') at the interface for the loads p and q_L: (load, 2, ...)."""
        P, A = self._down[:, 0], self._down[:, 1]
        return np.stack([P + 2 * self.kh * A, A], axis=1) * np.exp(-self.kh)

    @cached_property
    def _up(self) -> Array:
        """(Q, D) at the interface for the loads p and q_L: (load, 2, ...)."""
        return np.stack([-self.lam * self._arriving[:, 1], -self.kap * self._arriving[:, 0]], axis=1)

    @cached_property
    def _reflected(self) -> Array:
        """(P, A) beyond a half-space of coating, (load, 2, ...): minus (D, Q) where they come to z = 0."""
        first, D = self._up[:, 0] * np.exp(-self.kh), self._up[:, 1] * np.exp(-self.kh)
        return -np.stack([D, first + 2 * self.kh * D], axis=1)

    @cached_property
    def _out_of_plane(self) -> Array:
        """Amplitude of the antiplane wave e^{-kz} in the coating under q_T: 1/(1 - rho th)."""
        return 1 / self._less(self.rho, self.not_rho)

    @property
    def surface_excess(self) -> Array:
        """`surface` less that of a half-space of coating, from the reflected waves; falls like e^{-2 kh}."""
        half = (1 + self.layers.kappa[0]) / 2
        under_p, under_q = self._reflected
        c_tt = 2 * self.rho * self.th * self._out_of_plane
        return np.stack(
            [half * under_p.sum(0), half * (under_p[0] - under_p[1]), half * (under_q[0] - under_q[1]), c_tt]
        )

    def stress(self, depth: float) -> tuple[Array, Array]:
        """Stress at a depth in m of p or q_L (zz LL TT zL), and of q_T (zT LT)."""
        height = depth / self.layers.thickness
        if height < 1:
            return self._in_coating(height, self._down, self._out_of_plane)
        s, kappa2 = self.kh * (height - 1), self.layers.kappa[1]
        below = np.stack([self.not_kap * self._arriving[:, 0], self.not_lam * self._arriving[:, 1]], axis=1)
        wave = self.not_rho * self._out_of_plane * np.exp(-self.kh * height)
        return wave_stress(below, s, kappa2), np.stack([-wave, wave])

    def coating_excess(self, depth: float) -> tuple[Array, Array]:
        """Stress in the coating less that of a half-space of coating; falls like e^{-k(2h - depth)}."""
        return self._in_coating(
            depth / self.layers.thickness, self._reflected, self.rho * self.th * self._out_of_plane
        )

    def _in_coating(self, height: float, down: Array, wave: Array) -> tuple[Array, Array]:
        kappa1 = self.layers.kappa[0]
        s, to_interface = self.kh * height, self.kh * (1 - height)
        in_plane = wave_stress(down, s, kappa1)
        in_plane += wave_stress(self._up, to_interface, kappa1) * _column([1, 1, 1, -1], self.kh.ndim)
        falling = wave * np.exp(-s)
        rising = self.rho * self._out_of_plane * np.exp(-self.kh - to_interface)
        # of a wave u_T = V: mu k V' (zT) and mu k V (LT); r mu_2 = mu_1
        return in_plane, np.stack([rising - falling, rising + falling])


def wave_stress(amplitude: Array, s: Array, kappa: float) -> Array:
    """Stresses zz, LL, TT, zL of waves (P, A) = amplitude[load], s = k times their way: (load, 4, ...)."""
    P, A = amplitude[:, 0], amplitude[:, 1]
    shape = [-P - (1 + 2 * s) * A, P + (2 * s - 3) * A, (kappa - 3) * A, -P + (1 - 2 * s) * A]
    return np.stack(shape, axis=1) * np.exp(-s)


def _column(values: list[float], dims: int) -> Array:
    return np.reshape(np.array(values, dtype=float), (-1,) + (1,) * dims)


def normal_compliance(layers: Layers, k: Array) -> Array:
    """Amplitude of u_z over that of the pressure, c_zz(k).

    Parameters
    ----------
    layers
        Coating and half-space.
    k
        Wave numbers in rad/m, > 0 (k = 0: infinite), of any shape.

    Returns
    -------
    Array
        In m/Pa, of that shape.

    Examples
    --------
    Long waves see the body, short ones the coating, 2 (1 - nu^2)/(E k) each:

    >>> layers = Layers(young=400e9, poisson=0.0, thickness=1e-6, young_body=200e9, poisson_body=0.0)
    >>> k = np.array([1e0, 1e9])
    >>> (normal_compliance(layers, k) * k * 200e9).round(3)
    array([2., 1.])
    """
    k = np.asarray(k, dtype=float)
    if np.any(~(k >= 0)):
        raise ValueError("wave numbers must be >= 0")
    with np.errstate(divide="ignore"):
        return Response(layers, k * layers.thickness).surface[0] / (layers.shear * k)
