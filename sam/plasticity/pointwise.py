# SPDX-License-Identifier: MIT
"""From means over cells to values at points: the plastic strain at the centres of the cells, and its largest
value.

The plastic strain of a cell stands for its mean over the cell. Where it is smooth the value at the centre is
the mean less h^2/24 times the second derivative in each direction, to fourth order, and the largest value
lies between centres. It is not smooth where the yield stress has a kink over depth: just there a soft layer
strains most, and a parabola across it overshoots.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sam.arrays import Array


def at_centres(means: Array, faces: Array, interval: NDArray[np.intp] | None = None) -> Array:
    """Give values at the centres of cells from the means over them.

    A direction counts where both neighbours are strained too: beyond the border of the plastic zone, a kink,
    nothing is known.

    Parameters
    ----------
    means
        (n_layers, nx, ny) >= 0.
    faces
        Depths of the faces of the layers, (n_layers + 1,), in any unit.
    interval
        (n_layers,) numbers: depth counts between layers of the same one; without them all are.

    Returns
    -------
    Array
        (n_layers, nx, ny) >= 0, in the unit of the means.
    """
    out = means.copy()
    for axis, edges in enumerate((faces, np.arange(means.shape[1] + 1.0), np.arange(means.shape[2] + 1.0))):
        if len(edges) > 3:
            v = np.moveaxis(means, axis, 0)
            smooth = (v[:-2] > 0) & (v[1:-1] > 0) & (v[2:] > 0)
            if axis == 0 and interval is not None:
                smooth &= (interval[:-2] == interval[2:])[:, None, None]
            np.moveaxis(out, axis, 0)[1:-1] -= np.where(smooth, _bend(v, edges) / 24, 0.0)
    np.maximum(out, 0.0, out=out)
    return out


def _bend(means: Array, edges: Array) -> Array:
    """h^2 v'' of the parabola that has the means of a cell and its neighbours along the first axis, (n - 2,
    ...).
    """
    width, centre = (
        part.reshape(-1, *[1] * (means.ndim - 1)) for part in (np.diff(edges), (edges[1:] + edges[:-1]) / 2)
    )

    def second(v: Array) -> Array:
        slope = np.diff(v, axis=0) / np.diff(centre, axis=0)
        twice: Array = 2 * np.diff(slope, axis=0) / (centre[2:] - centre[:-2])
        return twice

    bend: Array = width[1:-1] ** 2 * second(means) / (1 + second(width**2) / 24)
    return bend


def largest(values: Array, depths: Array, interval: NDArray[np.intp] | None = None) -> tuple[float, float]:
    """(depth, value) of the largest of (n_layers, nx, ny), from a parabola through its neighbours in each
    direction.

    interval: as of `at_centres`.
    """
    at = tuple(map(int, np.unravel_index(int(values.argmax()), values.shape)))
    top = float(values[at])
    depth, height = float(depths[at[0]]), top
    for axis, k in enumerate(at):
        across = (
            axis == 0
            and interval is not None
            and interval[max(k - 1, 0)] != interval[min(k + 1, len(depths) - 1)]
        )
        if 0 < k < values.shape[axis] - 1 and not across:
            line = values[tuple(slice(k - 1, k + 2) if a == axis else i for a, i in enumerate(at))]
            place = depths[k - 1 : k + 2] - depths[k] if axis == 0 else np.array([-1.0, 0.0, 1.0])
            shift, rise = _vertex(place, line - top)
            height += rise
            depth += shift if axis == 0 else 0.0
    return depth, height


def _vertex(x: Array, y: Array) -> tuple[float, float]:
    """(x, y) of the highest point of the parabola through three points, the middle one, (0, 0), the highest
    of them.
    """
    left, right = y[0] / x[0], y[2] / x[2]
    bend = (right - left) / (x[2] - x[0])
    if bend >= 0:
        return 0.0, 0.0
    slope = left - bend * x[0]
    return float(-slope / (2 * bend)), float(-(slope**2) / (4 * bend))
