# SPDX-License-Identifier: MIT
"""Hankel transforms of smooth functions at all radii, and their integrals over the radius, by FFT in
logarithms.

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
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.special import loggamma

from sam.arrays import Array

STEP = 0.1
COUNT = 2048
"""Samples of f: steps in ln k, and their number (even). The range, e^{+-102}, is generous: a k^(1/2) has to
die out in it.
"""
REFINE = 4
"""Steps of the spline per step of the samples: 0.025, where the quintic spline errs by less than 1e-12."""
SUPPORT = 6
"""Coefficients of a quintic spline that act on a point."""


def wave_numbers() -> Array:
    """Where f is to be sampled: COUNT wave numbers, 1/length."""
    found: Array = np.exp((np.arange(COUNT) - COUNT / 2) * STEP)
    return found


class RadialTable:
    """Splines of g and G for a set of functions f that share the order m.

    samples: f at `wave_numbers`, (functions, COUNT). bias: q, between -m and 2 for a bounded f, between -m
    and 1 for f ~ 1/k, so that f k^2 e^{-q x} and r^q g vanish at both ends. Rounding errors of g are 1e-16 of
    the largest r^q g, over r^q.
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
        spectrum = np.conj(spectrum * mellin) / spline_symbol(w * STEP / REFINE)
        self.point = _series(spectrum)
        self.disc = _series(spectrum / np.conj(2 - s))

    def coefficients(self, kind: str) -> tuple[Array, float]:
        """Spline coefficients (REFINE COUNT, functions) of g ("point") or G ("disc") over r^power, and the
        power of r.
        """
        return (self.point, -self.bias) if kind == "point" else (self.disc, 2 - self.bias)


def _series(spectrum: Array) -> Array:
    """Real sum over the frequencies at REFINE COUNT points y = -x; the phases of both origins cancel."""
    size = REFINE * COUNT
    return np.ascontiguousarray(np.fft.irfft(spectrum * size, size, axis=-1).T)


def spline_symbol(angle: Array) -> Array:
    """Sum of the quintic B-spline at the integers times e^{i n angle}."""
    return (33 + 26 * np.cos(angle) + np.cos(2 * angle)) / 60


def spline_weights(r: Array) -> tuple[NDArray[np.int32], Array]:
    """First coefficient and the SUPPORT weights, (points, SUPPORT), of the spline in ln r at radii r > 0."""
    place = np.log(r) * (REFINE / STEP) + REFINE * COUNT / 2
    first = np.floor(place).astype(np.int32)
    return first - 2, quintic(place - first)


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
