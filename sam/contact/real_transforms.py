# SPDX-License-Identifier: MIT
"""Transforms of what is even or odd about a point, from the half of it that is kept: cosine and sine sums.

Kept are the n values at j = 0 .. n - 1 from the point outward, or, `between`, at j + 1/2 (a row of an even
number of cells). The transform over the 2 half values about the point, those not given zero, is (-i)^odd
times half + 1 real numbers. With the angle a = pi m/half of wave number m, m = 0 .. half, they are f_0 + 2
sum_j f_j cos(j a) for even f and 2 sum_j f_j sin(j a) for odd, or with j + 1/2 in place of j 2 sum_j f_j cos
and sin.

Up to SHORT products a row, values times wave numbers, they are products with matrices, which take less time
than fast transforms.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy import fft

# products a row, 64 values times 128 wave numbers, up to which they take less time than a fast transform
Real = NDArray[np.floating[Any]]
"""Real numbers in single or double precision."""
SHORT = 8500  # products a row, 64 values times 128 wave numbers: up to here they beat a fast transform


class _Sum(NamedTuple):
    """Which of the sums of the module's text, or of their inverses."""

    odd: bool
    between: bool
    inverse: bool


def half_length(n: int) -> int:
    """Half the length of an even transform of n cells with lags -n .. n: at least n, a product of small
    primes.

    >>> half_length(65)
    72
    """
    return int(fft.next_fast_len(n, real=True))


def forward(kept: Real, half: int, odd: bool, axis: int, *, between: bool = False) -> Real:
    """Transform the kept values along an axis.

    Parameters
    ----------
    kept
        (..., n) or (..., n, m), see `axis`; values beyond those that the transform takes are left out.
    half
        Half the length of the transform.
    odd
        Whether the field is odd about the point.
    axis
        -1 or -2.
    between
        Whether the values stand at j + 1/2.

    Returns
    -------
    Real
        The half + 1 numbers along the axis.
    """
    n = min(kept.shape[axis], half if between else half + 1)
    if n < kept.shape[axis]:
        kept = kept[..., :n] if axis == -1 else kept[..., :n, :]
    if n * half > SHORT:
        return _fast_forward(kept, half, axis, _Sum(odd, between, False))
    return _product(kept, _matrix(n, half, _Sum(odd, between, False), kept.dtype), axis)


def back(spectrum: Real, n: int, odd: bool, axis: int, *, between: bool = False) -> Real:
    """The inverse of `forward`: n values from half + 1 numbers along axis -1 or -2."""
    half = spectrum.shape[axis] - 1
    if n * half > SHORT:
        return _fast_back(spectrum, n, axis, _Sum(odd, between, True))
    return _product(spectrum, _matrix(n, half, _Sum(odd, between, True), spectrum.dtype), axis)


def real_spectrum(kernel: Real, half: tuple[int, int], odd: Sequence[bool | int]) -> Real:
    """Transform of (..., nx, ny) lags >= 0 without its phase, (..., N_x + 1, N_y + 1); odd: whether odd in x,
    in y.

    Over the lags -N .. N-1 it is (-i)^(o_x + o_y) times this, o = 1 for odd, which is even or odd in the wave
    number.
    """
    for axis, (length, is_odd) in enumerate(zip(half, odd, strict=True), start=-2):
        kernel = forward(kernel, length, bool(is_odd), axis)
    return kernel


def _product(field: Real, matrix: Real, axis: int) -> Real:
    """The matrix applied to the rows or to the columns of a field."""
    return field @ matrix if axis == -1 else matrix.T @ field


@lru_cache(maxsize=64)
def _matrix(n: int, half: int, kind: _Sum, real: np.dtype[np.floating[Any]]) -> Real:
    """The matrix by which a row of numbers is multiplied from the left in `forward` or `back`."""
    twice = 2 * np.arange(n) + kind.between  # twice the place
    turns = np.outer(twice, np.arange(half + 1)) % (4 * half)  # of the angle, in pi/(2 half)
    angle = np.pi / (2 * half) * turns
    waves = np.where(turns % (2 * half) == 0, 0.0, np.sin(angle)) if kind.odd else np.cos(angle)
    if kind.inverse:
        ends = np.isin(np.arange(half + 1), (0, half))
        return (np.where(ends, 1, 2) * waves / (2 * half)).T.astype(real)
    own = np.isin(twice, (0, 2 * half))  # its own mirror image
    return (np.where(own, 1, 2)[:, None] * waves).astype(real)


def _fast_forward(kept: Real, half: int, axis: int, kind: _Sum) -> Real:
    """`forward` by fast sine and cosine transforms."""
    zero: Real = np.zeros_like(np.take(kept, [0], axis=axis))
    if kind.between:
        sums = (fft.dst if kind.odd else fft.dct)(kept, type=2, n=half, axis=axis)
        parts = [zero, sums] if kind.odd else [sums, zero]
    elif kind.odd:
        inner = np.take(kept, range(1, min(kept.shape[axis], half)), axis=axis)
        parts = [zero, fft.dst(inner, type=1, n=half - 1, axis=axis), zero]
    else:
        even: Real = fft.dct(kept, type=1, n=half + 1, axis=axis)
        return even
    return np.concatenate(parts, axis=axis)


def _fast_back(spectrum: Real, n: int, axis: int, kind: _Sum) -> Real:
    """`back` by fast sine and cosine transforms."""
    half = spectrum.shape[axis] - 1
    values: Real
    if kind.between:
        part = np.take(spectrum, range(kind.odd, half + kind.odd), axis=axis)
        values = (fft.dst if kind.odd else fft.dct)(part, type=3, axis=axis)
    elif kind.odd:
        inner = fft.dst(np.take(spectrum, range(1, half), axis=axis), type=1, axis=axis)
        values = np.concatenate([np.zeros_like(np.take(inner, [0], axis=axis)), inner], axis=axis)
    else:
        values = fft.dct(spectrum, type=1, axis=axis)
    found: Real = np.take(values, range(n), axis=axis) / (2 * half)
    return found
