# SPDX-License-Identifier: MIT
"""Mean pressure over rings around the axis: one measure for square cells and for nodes on a radius.

At the edge of a plastic contact the pressure falls from almost its full value within a cell. There the
pressure of a cell depends on where the edge cuts it; the mean over a ring, which many cells share, does not,
and keeps the load.
"""

from __future__ import annotations

import numpy as np

SUBDIVIDED = 16  # points of a cell, each way, that are counted into the rings


def ring_edges(width: float, reach: float) -> np.ndarray:
    """Radii from 0 in steps of `width` to the first beyond `reach`, m."""
    return width * np.arange(int(np.ceil(reach / width)) + 1)


def means_of_cells(x: np.ndarray, y: np.ndarray, p: np.ndarray, edges: np.ndarray) -> np.ndarray:
    """Ring means of p (nx, ny), uniform on each cell around the centres x (nx,), y (ny,): (n_edges - 1,)."""
    offsets = (np.arange(SUBDIVIDED) + 0.5) / SUBDIVIDED - 0.5
    across, along = ((c[:, None] + offsets * (c[1] - c[0])).ravel() for c in (x, y))
    r = np.hypot(across[:, None], along[None, :])
    fine = np.repeat(np.repeat(p, SUBDIVIDED, axis=0), SUBDIVIDED, axis=1)
    counted = np.histogram(r, edges)[0]
    return np.histogram(r, edges, weights=fine)[0] / counted


def means_of_line(r: np.ndarray, p: np.ndarray, edges: np.ndarray) -> np.ndarray:
    """Ring means of p linear between the radii r (n,), ascending: (n_edges - 1,). Exact: p r is quadratic
    (Simpson).
    """
    knots = np.union1d(r[r < edges[-1]], edges)
    middle = (knots[1:] + knots[:-1]) / 2.0
    ends, inner = (np.interp(at, r, p) * at for at in (knots, middle))
    parts = np.diff(knots) * (ends[1:] + 4.0 * inner + ends[:-1]) / 6.0
    total = np.append(0.0, np.cumsum(parts))[np.searchsorted(knots, edges)]
    return 2.0 * np.diff(total) / np.diff(edges**2)
