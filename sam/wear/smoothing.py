# SPDX-License-Identifier: MIT
"""Smoothing of the worn depth by local polynomials in two dimensions (Savitzky & Golay 1964; Bosman &
Schipper 2011, section 5).

In a window of n x n cells around each one, a polynomial of total degree <= m is fitted by least squares; its
value in the middle is the smoothed value. With p_i, the polynomials of degree i = 0 ... m that are
orthonormal over the n lags, it is

    sum over lags k, l of w(k, l) f(k, l),    w(k, l) = sum_{i + j <= m} p_i(k) p_i(0) p_j(l) p_j(0).    (a)

The total degree is bounded, not the degree in each direction (the filter along x and then along y would take
i, j <= m): those polynomials are the same in a turned frame, and the negative weights at the corners of the
window are smaller.
"""

from __future__ import annotations

from functools import cache

import numpy as np
from numpy.polynomial.legendre import legvander

from sam.arrays import Array


@cache
def weights(window: int, order: int) -> Array:
    """w(k, l) of (a) at the lags k, l = 0 ... (window - 1)/2; even in both, symmetric.

    Their sum over all lags is 1.

    Raises ValueError for an even window, or an order that the window does not determine.

    >>> (weights(3, 2) * 9).round(3)  # of the cell itself, of its neighbours, of the corners
    array([[ 5.,  2.],
           [ 2., -1.]])
    """
    if window < 1 or window % 2 == 0:
        raise ValueError(f"window = {window}: an odd number of cells is needed")
    if not 0 <= order < window:
        raise ValueError(f"order = {order}: from 0 to {window - 1} for a window of {window}")
    half = window // 2
    lags = np.arange(-half, half + 1) / max(half, 1)
    orthonormal = np.linalg.qr(legvander(lags, order))[0]  # column i: p_i, up to its sign
    terms = orthonormal * orthonormal[half]  # p_i(k) p_i(0)
    degrees = np.add.outer(np.arange(order + 1), np.arange(order + 1))
    found = (terms @ (degrees <= order) @ terms.T)[half:, half:]
    found.flags.writeable = False
    out: Array = found
    return out


def filtered(field: Array, window: int, order: int) -> Array:
    """The smoothed field (nx, ny), of any sign. Over the border it is continued as in a mirror at the outer
    faces of the border cells, so the sum over all cells stays.

    Cells at lags of equal weight are added first, pairs in an order that no mirror changes: a field with the
    symmetry of the square gives one with that symmetry bit by bit.
    """
    w, half = weights(window, order), window // 2
    padded = np.pad(field, half, mode="symmetric")
    out = np.zeros(field.shape)
    for k in range(half + 1):
        for other in range(k + 1):
            cells = 1 if k == 0 else 4 if other in (0, k) else 8
            repeated = _four(padded, half, k, other) + _four(
                padded, half, other, k
            )  # each cell 8/cells times
            out += w[k, other] * (repeated * (cells / 8))
    return out


def _four(padded: Array, half: int, k: int, l: int) -> Array:  # noqa: E741
    """f(k, l) + f(-k, -l) + (f(k, -l) + f(-k, l)) around each cell."""
    nx, ny = padded.shape[0] - 2 * half, padded.shape[1] - 2 * half

    def at(i: int, j: int) -> Array:
        return padded[half + i : half + i + nx, half + j : half + j + ny]

    return (at(k, l) + at(-k, -l)) + (at(k, -l) + at(-k, l))


def smoothed(depth: Array, window: int, order: int, all_removed: bool = False) -> Array:
    """Smoothed worn depth (nx, ny) in m, never below 0: smoothing adds no material. window = 0: as it is.

    The filter keeps the volume (see `filtered`). Around a scar its weights of order >= 2 ask for negative
    depths; these are set to 0, so the worn volume grows by what they held. Flanks within half a window of the
    raw scar are dug where the filter says so. Within the scar less than the raw depth may go: the
    material that stays is removed in the next cycle even if nothing is strained, and flanks are dug again. A
    scar of few cells may lose several times its raw volume that way, over tens of cycles. all_removed:
    nowhere less than the raw depth, which ends that, up to the error of the remap. Raises ValueError for a
    depth that is negative or not finite, and as `weights` does.
    """
    check_depth(depth)
    if window == 0 or not depth.any():
        return depth
    return np.maximum(filtered(depth, window, order), depth if all_removed else 0.0)


def check_depth(depth: Array) -> None:
    """Raises ValueError unless all depths are finite and >= 0."""
    if not (np.isfinite(depth) & (depth >= 0)).all():
        raise ValueError(f"depth from {np.min(depth)} to {np.max(depth)} m: finite depths >= 0 are needed")
