# SPDX-License-Identifier: MIT
"""Transforms of what is even or odd about a point, from the half of it that is kept: cosine and sine sums.

Kept are the n values at j = 0 .. n - 1 from the point outward, or, `between`, at j + 1/2 (a row of an even number of cells).
The transform over the 2 half values about the point, those not given zero, is (-i)^odd times half + 1 real numbers. With the
angle a = pi m/half of wave number m, m = 0 .. half, they are f_0 + 2 sum_j f_j cos(j a) for even f and 2 sum_j f_j sin(j a) for
odd, or with j + 1/2 in place of j 2 sum_j f_j cos and sin.

Up to SHORT products a row, values times wave numbers, they are products with matrices, which take less time than fast
transforms.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from scipy import fft

SHORT = 8500  # products a row, 64 values times 128 wave numbers, up to which they take less time than a fast transform


def half_length(n: int) -> int:
    """Half the length of an even transform of n cells with lags -n .. n: at least n, a product of small primes."""
    return fft.next_fast_len(n, real=True)


def forward(kept: np.ndarray, half: int, odd: bool, axis: int, between: bool = False) -> np.ndarray:
    """The half + 1 numbers along axis -1 or -2; values beyond those that the transform takes are left out."""
    n = min(kept.shape[axis], half if between else half + 1)
    if n < kept.shape[axis]:
        kept = kept[..., :n] if axis == -1 else kept[..., :n, :]
    if n * half > SHORT:
        return _fast_forward(kept, half, odd, axis, between)
    return _product(kept, _matrix(n, half, odd, between, False, kept.dtype.type), axis)


def back(spectrum: np.ndarray, n: int, odd: bool, axis: int, between: bool = False) -> np.ndarray:
    """The inverse of `forward`: n values from half + 1 numbers along axis -1 or -2."""
    half = spectrum.shape[axis] - 1
    if n * half > SHORT:
        return _fast_back(spectrum, n, odd, axis, between)
    return _product(spectrum, _matrix(n, half, odd, between, True, spectrum.dtype.type), axis)


def real_spectrum(kernel: np.ndarray, half: tuple[int, int], odd: tuple[int, int]) -> np.ndarray:
    """Transform of (..., nx, ny) lags >= 0 without its phase, (..., N_x + 1, N_y + 1); odd: whether odd in x, in y.

    Over the lags -N .. N-1 it is (-i)^(o_x + o_y) times this, o = 1 for odd, which is even or odd in the wave number.
    """
    for axis, (length, is_odd) in enumerate(zip(half, odd, strict=True), start=-2):
        kernel = forward(kernel, length, is_odd, axis)
    return kernel


def _product(field: np.ndarray, matrix: np.ndarray, axis: int) -> np.ndarray:
    return field @ matrix if axis == -1 else matrix.T @ field


@lru_cache(maxsize=64)
def _matrix(n: int, half: int, odd: bool, between: bool, inverse: bool, real: type) -> np.ndarray:
    """What `forward`, or `back`, is a product with, of a row of numbers from the left: the sums of the module's text."""
    twice = 2 * np.arange(n) + between  # twice the place
    turns = np.outer(twice, np.arange(half + 1)) % (4 * half)  # of the angle, in pi/(2 half)
    angle = np.pi / (2 * half) * turns
    waves = np.where(turns % (2 * half) == 0, 0.0, np.sin(angle)) if odd else np.cos(angle)
    if inverse:
        ends = np.isin(np.arange(half + 1), (0, half))
        return (np.where(ends, 1, 2) * waves / (2 * half)).T.astype(real)
    own = np.isin(twice, (0, 2 * half))  # its own mirror image
    return (np.where(own, 1, 2)[:, None] * waves).astype(real)


def _fast_forward(kept: np.ndarray, half: int, odd: bool, axis: int, between: bool) -> np.ndarray:
    zero = np.zeros_like(np.take(kept, [0], axis=axis))
    if between:
        sums = (fft.dst if odd else fft.dct)(kept, type=2, n=half, axis=axis)
        parts = [zero, sums] if odd else [sums, zero]
    elif odd:
        inner = np.take(kept, range(1, min(kept.shape[axis], half)), axis=axis)
        parts = [zero, fft.dst(inner, type=1, n=half - 1, axis=axis), zero]
    else:
        return fft.dct(kept, type=1, n=half + 1, axis=axis)
    return np.concatenate(parts, axis=axis)


def _fast_back(spectrum: np.ndarray, n: int, odd: bool, axis: int, between: bool) -> np.ndarray:
    half = spectrum.shape[axis] - 1
    if between:
        part = np.take(spectrum, range(odd, half + odd), axis=axis)
        values = (fft.dst if odd else fft.dct)(part, type=3, axis=axis)
    elif odd:
        inner = fft.dst(np.take(spectrum, range(1, half), axis=axis), type=1, axis=axis)
        values = np.concatenate([np.zeros_like(np.take(inner, [0], axis=axis)), inner], axis=axis)
    else:
        values = fft.dct(spectrum, type=1, axis=axis)
    return np.take(values, range(n), axis=axis) / (2 * half)
