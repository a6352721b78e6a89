# SPDX-License-Identifier: MIT
"""Heights of a map on other cells of the same patch, by its Fourier series mirrored at the sides."""

from __future__ import annotations

import numpy as np
from scipy.fft import dct, idct

from sam.arrays import Array


def resampled(heights: Array, cells: tuple[int, int]) -> Array:
    """Heights (nx, ny) at the centres of the cells of a patch on other cells of the same patch; any unit."""
    for axis, n in enumerate(cells):
        had = heights.shape[axis]
        if n == had:
            continue
        waves = np.moveaxis(dct(heights, type=2, axis=axis), axis, 0)
        other = np.zeros((n, *waves.shape[1:]))
        other[: min(n, had)] = waves[:n]
        heights = np.moveaxis(idct(other, type=2, axis=0), 0, axis) * (n / had)
    return heights
