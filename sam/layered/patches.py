# SPDX-License-Identifier: MIT
"""Influence coefficients of uniformly loaded rectangles on a coated half-space, without periods and without
aliases.

The response of `Response` to the wave vector k (cos phi, sin phi) is rotated to x and y. What each load and
component holds are terms f(k) cos(m phi) or f(k) sin(m phi), whose inverse transforms are i^m g(r) cos(m
theta) or sin, g the Hankel transform of order m of f (`RadialTable`): STRESS_TABLES and DISPLACEMENT_TABLES
list the radial functions, each made once, and the ENTRIES where they belong. Then `CellIntegrals` integrates
them over the cells.

At a depth z the response decays like e^{-kz}. Where that is slow, at the surface and in the coating less than
a cell deep, the closed forms of a half-space of coating (sam.kernels.patches) are taken out and added after:
the rest decays like e^{-k (2h - z)}. Deeper they would only cost digits, since their corner sums cancel.

Hankel transforms of smooth functions at all radii, and their integrals over the radius, are FFTs in ln k.

    g(r) = 1/(2 pi) int_0^inf f(k) J_m(k r) k dk,      G(R) = int_0^R g(r) r dr.

With x = ln k and y = ln r the function a(x) = f k^2 e^{-q x} falls to zero at both ends. Its Fourier series
a = sum a_n e^{i w_n x} gives, term by term (Mellin transform of J_m),

    g(r) = 1/(2 pi) sum a_n M(s_n) r^{-s_n},   s_n = q + i w_n,   M(s) = 2^(s-1) Gamma((m + s)/2)/Gamma(1 + (m
    - s)/2),

and G with 1/(2 - s_n) R^2 beside each term: no truncated integral, no sum over periods, all radii at once.
Source: Hamilton, Mon. Not. R. Astron. Soc. 312 (2000) 257 (FFTLog). The coefficients of a quintic spline in y
follow from the same series.

f has to be smooth in ln k, as e^{-k d} or 1/(k^3 + c) are: their series fall like e^{-pi w/2} or e^{-pi w/3},
to 1e-14 at the end of the spectrum with STEP = 0.1. Lengths: any unit; the range of e^{-100} to e^{100} of it
is covered.

Integrals over cells of g(r) cos(m theta) or g(r) sin(m theta). Near cells: F(X, Y), the integral over [0, X]
x [0, Y], differenced over the corners (half-integers times the cell, never zero). Two triangles make it up;
the one with its right angle at (X, 0) gives, with R = X cosh u at its far side,

    int G(R) cos(m theta) d theta,   G(R) = int_0^R g r dr,   theta = atan sinh u,   d theta = du/cosh u,

by Gauss-Legendre in u, in which G is smooth however small X is. Far cells: Gauss points of g itself, the
error being that of a power of r across a cell: below 1e-9 of the largest coefficient for the tails r^-1
(displacement) to r^-3. All is linear in the spline coefficients of `RadialTable`, so that one sparse matrix
serves every depth.

Frequency response of an elastic coating (thickness h) bonded on an elastic half-space: displacement and
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
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.sparse import csr_array
from scipy.special import loggamma

from sam.arrays import Array, Mask
from sam.kernels.patches import STRESS, Lags, displacement_coefficients, stress_coefficients


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


STEP = 0.1
COUNT = 2048
"""Samples of f (steps in ln k, even number): a k^(1/2) dies out in e^{+-102}."""
REFINE = 4
"""Steps of the spline per step of the samples: 0.025, where the quintic spline errs by less than 1e-12."""
SUPPORT = 6
"""Coefficients of a quintic spline that act on a point."""


def wave_numbers() -> Array:
    """Where f is to be sampled: COUNT wave numbers, 1/length."""
    return np.exp((np.arange(COUNT) - COUNT / 2) * STEP)


class RadialTable:
    """Splines of g and G for functions f of order m at `wave_numbers`, (functions, COUNT); bias: q,
    between -m and 2, or 1 for f ~ 1/k, so that f k^2 e^{-q x} and r^q g vanish at both ends.
    """

    def __init__(self, samples: Array, order: int, bias: float):
        self.bias = bias
        x = np.log(wave_numbers())
        spectrum = np.fft.rfft(samples * np.exp((2 - self.bias) * x), axis=-1) / COUNT
        spectrum[:, -1] = 0  # the highest frequency has no sign
        w = 2 * np.pi / (COUNT * STEP) * np.arange(spectrum.shape[1])
        s = self.bias + 1j * w
        mellin = np.exp((s - 1) * np.log(2) + loggamma((order + s) / 2) - loggamma(1 + (order - s) / 2)) / (
            2 * np.pi
        )
        angle = w * STEP / REFINE  # of the sum of the quintic B-spline at the integers times e^{i n angle}
        spectrum = np.conj(spectrum * mellin) / ((33 + 26 * np.cos(angle) + np.cos(2 * angle)) / 60)
        self.point = _series(spectrum)
        self.disc = _series(spectrum / np.conj(2 - s))

    def coefficients(self, kind: str) -> tuple[Array, float]:
        """Spline coefficients (REFINE COUNT, functions) of g ("point") or G ("disc"), and a power of r."""
        return (self.point, -self.bias) if kind == "point" else (self.disc, 2 - self.bias)


def _series(spectrum: Array) -> Array:
    """Real sum over the frequencies at REFINE COUNT points y = -x; the phases of both origins cancel."""
    size = REFINE * COUNT
    return np.ascontiguousarray(np.fft.irfft(spectrum * size, size, axis=-1).T)


def quintic(t: Array) -> Array:
    """The six pieces of the quintic B-spline, (..., 6), at 0 <= t < 1 beyond its knots."""
    u = 1 - t

    def middle(v: Array) -> Array:
        """120 beta(2 - v) = 1 + 5 v + 10 v^2 + 10 v^3 + 5 v^4 - 5 v^5."""
        return 1 + 5 * v * (1 + v * (2 + v * (2 + v * (1 - v))))

    def inner(v: Array) -> Array:
        """120 beta(1 - v) = 26 + 50 v + 20 v^2 - 20 v^3 - 20 v^4 + 10 v^5."""
        return 26 + v * (50 + v * (20 + v * (-20 + v * (-20 + 10 * v))))

    return np.stack([u**5, middle(u), inner(u), inner(t), middle(t), t**5], axis=-1) / 120


NEAR = 8
"""Distance in cells below which the corners are used: 4 changes 1e-12 of the largest, 2 8e-10."""
BANDS = ((5, 16.0), (4, 32.0), (3, 64.0), (2, np.inf))
"""Beyond: Gauss points in each direction, up to a distance in cells."""
NODES = 32
"""Gauss points in u: 24 change 1e-11 of the largest for square cells, 1e-9 for 10 to 1."""
BLOCK = 1 << 15
"""Far cells in one sparse matrix: bounds the memory."""


@dataclass(frozen=True)
class Angular:
    """cos(m theta), or sin(m theta)."""

    order: int
    sine: bool = False

    def __call__(self, theta: Array) -> Array:
        """The value at angles theta in rad."""
        return np.sin(self.order * theta) if self.sine else np.cos(self.order * theta)

    @property
    def parity(self) -> tuple[int, int]:
        """Signs under x -> -x and under y -> -y."""
        flip = (-1) ** self.order
        return (-flip, -1) if self.sine else (flip, 1)


def spline_matrix(r: Array, weights: Array, power: float, columns: int) -> csr_array:
    """Rows: sum of weights r^power times the spline at r; r, weights: (rows, points)."""
    rows, points = r.shape
    place = np.log(r.ravel()) * (REFINE / STEP) + REFINE * COUNT / 2
    first = np.floor(place).astype(np.int32)
    values = quintic(place - first) * (weights * r**power).reshape(-1, 1)
    indices = (first - 2)[:, None] + np.arange(SUPPORT, dtype=np.int32)
    pointers = np.arange(rows + 1) * (points * SUPPORT)
    return csr_array((values.ravel(), indices.ravel(), pointers), shape=(rows, columns))


class CellIntegrals:
    """Integrals over the cells around lags in the tables' unit of length."""

    def __init__(self, lags: Lags):
        self.shape, self.h = lags.shape, (lags.hx, lags.hy)
        widest = max(self.h)
        self.near = tuple(
            min(n, int(np.ceil(NEAR * widest / h))) for n, h in zip(self.shape, self.h, strict=True)
        )
        i, j = np.indices(self.shape)
        distance = np.hypot(i * lags.hx, j * lags.hy) / widest
        distance[: self.near[0], : self.near[1]] = -1
        lower = 0.0
        self.bands = []
        for points, upper in BANDS:
            self.bands.append((points, np.flatnonzero((distance >= lower) & (distance < upper))))
            lower = upper

    def integrate(self, table: RadialTable, angular: Angular) -> Array:
        """Integral over each cell for each function of the table: (functions, nx, ny)."""
        out = np.empty((self.shape[0] * self.shape[1], table.point.shape[1]))
        for points, cells in self.bands:
            for start in range(0, cells.size, BLOCK):
                block = cells[start : start + BLOCK]
                out[block] = self._gauss(block, points, table, angular)
        whole = out.reshape(*self.shape, -1)
        whole[: self.near[0], : self.near[1]] = self._corners(table, angular)
        return np.moveaxis(whole, -1, 0)

    def _gauss(self, cells: NDArray[np.intp], points: int, table: RadialTable, angular: Angular) -> Array:
        """points x points Gauss points in each of the cells (flat indices): (cells, functions)."""
        t, w = np.polynomial.legendre.leggauss(points)
        i, j = np.unravel_index(cells, self.shape)
        x = (i[:, None] + np.repeat(t, points) / 2) * self.h[0]
        y = (j[:, None] + np.tile(t, points) / 2) * self.h[1]
        weights = np.repeat(w, points) * np.tile(w, points) * (self.h[0] * self.h[1] / 4)
        coefficients, power = table.coefficients("point")
        matrix = spline_matrix(np.hypot(x, y), weights * angular(np.arctan2(y, x)), power, len(coefficients))
        return matrix @ coefficients

    def _corners(self, table: RadialTable, angular: Angular) -> Array:
        """Near cells by their corners, (near x, near y, functions); at minus half a cell by parity."""
        X, Y = ((np.arange(n) + 0.5) * h for n, h in zip(self.near, self.h, strict=True))
        X, Y = (a.ravel() for a in np.meshgrid(X, Y, indexing="ij"))
        coefficients, power = table.coefficients("disc")
        total: Array | float = 0.0
        for a, b, turned in ((X, Y, False), (Y, X, True)):
            r, theta, weights = _triangle(a, b)
            weights = weights * angular(np.pi / 2 - theta if turned else theta)
            total = total + spline_matrix(r, weights, power, len(coefficients)) @ coefficients
        corners = np.asarray(total).reshape(*self.near, -1)
        px, py = angular.parity
        corners = np.concatenate([-px * corners[:1], corners])
        corners = np.concatenate([-py * corners[:, :1], corners], axis=1)
        return np.diff(np.diff(corners, axis=0), axis=1)


def _triangle(a: Array, b: Array) -> tuple[Array, Array, Array]:
    """R, theta and weights (d theta) along the far side of a triangle, of length b: (corners, NODES)."""
    t, w = np.polynomial.legendre.leggauss(NODES)
    top = np.arcsinh(b / a)[:, None]
    u = top * (t + 1) / 2
    return a[:, None] * np.cosh(u), np.arctan(np.sinh(u)), top * w / 2 / np.cosh(u)


_ONE = Angular(0)
_COS = Angular(1)
_SIN = Angular(1, sine=True)
_COS2 = Angular(2)
_SIN2 = Angular(2, sine=True)
_COS3 = Angular(3)
_SIN3 = Angular(3, sine=True)

# Radial functions: order m of the Hankel transform and f from the stresses under p, q_L (zz, LL, TT, zL) and
# q_T (zT, LT).
# A load q_x has q_L = cos(phi), q_T = -sin(phi); the signs collect i^m and the phases of the sine components.
STRESS_TABLES: dict[int, dict[str, tuple[int, Callable[[Array, Array, Array], Array]]]] = {
    3: {
        "zz": (0, lambda p, q, t: p[0]),
        "mean": (0, lambda p, q, t: (p[1] + p[2]) / 2),
        "shear": (1, lambda p, q, t: p[3]),
        "deviator": (2, lambda p, q, t: (p[2] - p[1]) / 2),
    },
    1: {
        "zz": (1, lambda p, q, t: -q[0]),
        "mean": (1, lambda p, q, t: -(q[1] + q[2]) / 2),
        "shear": (0, lambda p, q, t: (q[3] + t[0]) / 2),
        "shear2": (2, lambda p, q, t: (t[0] - q[3]) / 2),
        "deviator": (1, lambda p, q, t: (q[2] - q[1]) / 4 - t[1] / 2),
        "deviator3": (3, lambda p, q, t: (q[1] - q[2]) / 4 - t[1] / 2),
    },
}
STRESS_ENTRIES: dict[tuple[str, int], tuple[tuple[str, Angular, int], ...]] = {
    ("33", 3): (("zz", _ONE, 1),),
    ("11", 3): (("mean", _ONE, 1), ("deviator", _COS2, 1)),
    ("22", 3): (("mean", _ONE, 1), ("deviator", _COS2, -1)),
    ("12", 3): (("deviator", _SIN2, 1),),
    ("13", 3): (("shear", _COS, 1),),
    ("23", 3): (("shear", _SIN, 1),),
    ("33", 1): (("zz", _COS, 1),),
    ("11", 1): (("mean", _COS, 1), ("deviator", _COS, 1), ("deviator3", _COS3, 1)),
    ("22", 1): (("mean", _COS, 1), ("deviator", _COS, -1), ("deviator3", _COS3, -1)),
    ("12", 1): (("deviator", _SIN, 1), ("deviator3", _SIN3, 1)),
    ("13", 1): (("shear", _ONE, 1), ("shear2", _COS2, 1)),
    ("23", 1): (("shear2", _SIN2, 1),),
}
# The same of the surface displacement, f from mu_1 k (c_zz, c_zL, c_LL, c_TT).
DISPLACEMENT_TABLES: dict[str, tuple[int, Callable[[Array], Array]]] = {
    "normal": (0, lambda c: c[0]),
    "cross": (1, lambda c: c[1]),
    "along": (0, lambda c: (c[2] + c[3]) / 2),
    "turned": (2, lambda c: (c[3] - c[2]) / 2),
}
DISPLACEMENT_ENTRIES: dict[tuple[int, int], tuple[tuple[str, Angular, int], ...]] = {
    (3, 3): (("normal", _ONE, 1),),
    (1, 3): (("cross", _COS, 1),),
    (2, 3): (("cross", _SIN, 1),),
    (3, 1): (("cross", _COS, -1),),
    (1, 1): (("along", _ONE, 1), ("turned", _COS2, 1)),
    (2, 1): (("turned", _SIN2, 1),),
}
_EXCHANGED = {"11": "22", "22": "11", "33": "33", "23": "13", "13": "23", "12": "12"}
"""Component of a stress -> which it is with x and y exchanged."""
_EXCHANGED_AXES = {1: 2, 2: 1, 3: 3}
"""The same of a direction."""


DISPLACEMENT_BIAS = 0.5
STRESS_BIAS = 1.0
"""q of `RadialTable`, in the middle of what all orders m allow: 0.2 and 0.8 change 1e-13."""


class LayeredPatches:
    """Influence coefficients of the cells of a grid on a coated half-space; conventions of
    `sam.kernels.patches`.

    Parameters
    ----------
    layers
        Coating and half-space.
    """

    def __init__(self, layers: Layers):
        self.layers = layers
        self._response = Response(layers, wave_numbers())  # unit of length: the thickness

    def response(self, k: Array) -> Array:
        """c_zz(k), m/Pa: u_z over p of a wave with k > 0 in rad/m; infinite at k = 0."""
        return normal_compliance(self.layers, k)

    def surface_response(self, k: Array) -> Array:
        """k times (c_zz, c_zL, c_LL, c_TT), see `Response.surface`, in 1/Pa, (4, ...); k > 0 in rad/m."""
        return Response(self.layers, k * self.layers.thickness).surface / self.layers.shear

    def displacement(self, lags: Lags, *, component: int = 3, load: int = 3) -> Array:
        """Surface displacement (nx, ny) in m/Pa at lags in m, >= 0, per unit traction on the cell
        at the origin; component, load: 1, 2 or 3 (> 0 into the body).
        """
        if load == 2:
            return self.displacement(lags.exchanged, component=_EXCHANGED_AXES[component], load=1).T
        h = self.layers.thickness
        in_thickness = lags.in_units_of(h)
        cells = CellIntegrals(in_thickness)
        out = displacement_coefficients(in_thickness, self.layers.poisson, component=component, load=load)
        for name, angular, sign in DISPLACEMENT_ENTRIES[component, load]:
            order, pick = DISPLACEMENT_TABLES[name]
            samples = pick(self._response.surface_excess) / wave_numbers()
            out = (
                out + sign * cells.integrate(RadialTable(samples[None], order, DISPLACEMENT_BIAS), angular)[0]
            )
        return out * (h / self.layers.shear)

    def stress(self, lags: Lags, z: ArrayLike, *, load: int = 3, names: Sequence[str] = STRESS) -> Array:
        """Stress (len(names), nz, nx, ny) at lags, >= 0, and depths z, in m, per unit traction
        `load` (1, 2 or 3); z < thickness is in the coating. ValueError for a depth that is not >=
        0.
        """
        depths = np.atleast_1d(np.asarray(z, dtype=float))
        if not np.all((depths >= 0) & np.isfinite(depths)):
            raise ValueError(f"depths = {depths.tolist()} must be finite and >= 0")
        if load == 2:
            exchanged = [_EXCHANGED[name] for name in names]
            return np.swapaxes(self.stress(lags.exchanged, depths, load=1, names=exchanged), -1, -2)
        h = self.layers.thickness
        in_thickness = lags.in_units_of(h)
        bare = (depths < h) & (depths < max(lags.hx, lags.hy))
        samples = self._stress_samples(depths, bare, load)
        out = self._radial_stress(CellIntegrals(in_thickness), samples, load, names)
        if np.any(bare):
            out[:, bare] += stress_coefficients(
                in_thickness, depths[bare] / h, self.layers.poisson, load=load, names=names
            )
        return out

    def _stress_samples(self, depths: Array, bare: Mask, load: int) -> dict[str, Array]:
        """The functions f of `STRESS_TABLES`, (nz, wave numbers); bare: less a half-space of coating."""
        rows: dict[str, list[Array]] = {key: [] for key in STRESS_TABLES[load]}
        for depth, without in zip(depths, bare, strict=True):
            (under_p, under_q), under_t = (
                self._response.coating_excess if without else self._response.stress
            )(depth)
            for key, (_, pick) in STRESS_TABLES[load].items():
                rows[key].append(pick(under_p, under_q, under_t))
        return {key: np.array(values) for key, values in rows.items()}

    @staticmethod
    def _radial_stress(
        cells: CellIntegrals, samples: dict[str, Array], load: int, names: Sequence[str]
    ) -> Array:
        """Sum of `STRESS_ENTRIES`, each radial and angular function once: (len(names), nz, nx, ny)."""
        tables: dict[str, RadialTable] = {}
        known: dict[tuple[str, Angular], Array] = {}
        nz = len(samples["zz"])
        out = np.zeros((len(names), nz, *cells.shape))
        for row, name in zip(out, names, strict=True):
            for key, angular, sign in STRESS_ENTRIES[name, load]:
                if key not in tables:
                    tables[key] = RadialTable(samples[key], STRESS_TABLES[load][key][0], STRESS_BIAS)
                if (key, angular) not in known:
                    known[key, angular] = cells.integrate(tables[key], angular)
                row += sign * known[key, angular]
        return out
