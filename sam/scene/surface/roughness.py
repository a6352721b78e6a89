# SPDX-License-Identifier: MIT
"""Areal roughness parameters of a height map (ISO 25178-2)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sam.arrays import Array


@dataclass(frozen=True)
class Roughness:
    """About the mean height. sa: mean |h|, sq: root mean square, in m; ssk: skewness; sdq: root mean square
    slope.
    """

    sa: float
    sq: float
    ssk: float
    sdq: float


def roughness(heights: Array, hx: float, hy: float) -> Roughness:
    """Areal parameters of heights (ISO 25178-2); slopes by central differences, one-sided at the edge.

    The skewness of a plane is 0. A form or a tilt is not removed. Points that are nan, and the slopes next to
    them, do not count.

    Parameters
    ----------
    heights
        (nx, ny) in m.
    hx, hy
        Sides of a cell in m.

    Examples
    --------
    Five points on a line of slope 1 deviate from their mean by 2, 1, 0, 1, 2:

    >>> found = roughness(np.arange(5.0)[:, None] * np.ones(3), 1.0, 1.0)
    >>> round(found.sa, 3), round(found.sdq, 3)
    (1.2, 1.0)
    """
    mean = np.nanmean if np.isnan(heights).any() else np.mean
    h = heights - mean(heights)
    sq = float(np.sqrt(mean(h**2)))
    slope_x, slope_y = np.gradient(h, hx, hy)
    return Roughness(
        sa=float(mean(np.abs(h))),
        sq=sq,
        ssk=float(mean((h / sq) ** 3)) if sq > 0 else 0.0,
        sdq=float(np.sqrt(mean(slope_x**2 + slope_y**2))),
    )
