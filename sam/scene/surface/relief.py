# SPDX-License-Identifier: MIT
"""The border of a rough patch: heights that fall off there, so that the contact ends before the patch does.

A patch cut out of a surface ends in ridges that go on in reality. On a half-space they carry what the
end of a punch carries, a pressure without bound at finer and finer cells.
"""

from __future__ import annotations

from math import ceil

import numpy as np

from sam.arrays import Array

BORDER = 3 / 32  # of a side: 6 of 64 cells
DROP = 4.0  # of the heights at the edge, in mean deviations: lower than most of the valleys


def border_cells(cells: tuple[int, int]) -> tuple[int, int]:
    """Cells along x and y that the border takes at each end."""
    return ceil(BORDER * cells[0]), ceil(BORDER * cells[1])


def with_relief(
    heights: Array, points: tuple[Array, Array], extent: tuple[float, float], mean_deviation: float
) -> Array:
    """Lower the heights in the outer BORDER of each side, by DROP mean deviations at the edge.

    Parameters
    ----------
    heights
        (nx, ny) in m.
    points
        x (nx,) and y (ny,) of the heights in m.
    extent
        (Lx, Ly), sides of the patch about the origin in m.
    mean_deviation
        Ra of the surface in m.

    Returns
    -------
    Array
        (nx, ny) in m. The fall is s^3 (10 - 15 s + 6 s^2) of the way s from the inner end of the strip to the
        edge, twice smooth at both.
    """
    stays_x, stays_y = (1 - _fall(c, side) for c, side in zip(points, extent, strict=True))
    return heights - DROP * mean_deviation * (1 - stays_x[:, None] * stays_y[None, :])


def fall(cells: tuple[int, int], mean_deviation: float) -> Array:
    """By how much `with_relief` lowers heights at the centres of (nx, ny) cells, in m."""
    x, y = ((np.arange(n) + 0.5) / n - 0.5 for n in cells)
    return -with_relief(np.zeros(cells), (x, y), (1.0, 1.0), mean_deviation)


def _fall(c: Array, side: float) -> Array:
    """The share of the drop: 0 inside, 1 at the edges."""
    s: Array = np.clip((np.abs(c) / side - (0.5 - BORDER)) / BORDER, 0.0, 1.0)
    return s**3 * (10 - 15 * s + 6 * s**2)
