# SPDX-License-Identifier: MIT
"""From means over cells to values at points: the plastic strain at the centres of the cells, and its largest
value.

The plastic strain of a cell stands for its mean over the cell. Where it is smooth the value at the centre is
the mean less h^2/24 times the second derivative in each direction, to fourth order, and the largest value
lies between centres. It is not smooth where the yield stress has a kink over depth: just there a soft layer
strains most, and a curve across it overshoots. Three points do not do: where the maximum lies between two
layers, a parabola through the higher one and its neighbours is up to .5 % too high.
"""

from __future__ import annotations

import numpy as np
from numpy.polynomial import Polynomial
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
    """(depth, value) of the largest of (n_layers, nx, ny), from a cubic in each direction through it, its
    neighbours and the next value beside the larger of these, between which the maximum lies.

    interval: as of `at_centres`.
    """
    at = tuple(map(int, np.unravel_index(int(values.argmax()), values.shape)))
    depth, height = float(depths[at[0]]), float(values[at])
    for axis, k in enumerate(at):
        line = values[tuple(slice(None) if a == axis else i for a, i in enumerate(at))]
        place, same = depths, np.ones(len(line), bool)
        if axis > 0:
            place = np.arange(float(len(line)))
        elif interval is not None:
            same = interval == interval[k]
        shift, rise = _summit(place, line, k, same)
        height += rise
        depth += shift if axis == 0 else 0.0
    return depth, height


def _summit(x: Array, y: Array, k: int, same: NDArray[np.bool_]) -> tuple[float, float]:
    """How far the maximum lies from the k-th point, the highest, and how much higher: of the curve through
    three points, or four where the fourth is strained too. Without both neighbours nothing is known.
    """
    if not 0 < k < len(y) - 1 or not (same[k - 1] and same[k + 1]):
        return 0.0, 0.0
    ends = [k - 1, k + 1]
    side = 1 if y[k + 1] > y[k - 1] else -1
    fourth = k + 2 * side
    if 0 <= fourth < len(y) and same[fourth] and y[fourth] > 0:
        ends[(side + 1) // 2] = fourth
    near = slice(ends[0], ends[1] + 1)
    curve = Polynomial.fit(x[near] - x[k], y[near] - y[k], deg=ends[1] - ends[0]).convert()
    _, slope, bend, third = (*curve.coef, 0.0, 0.0, 0.0)[:4]
    root = float(np.sqrt(max(bend**2 - 3 * slope * third, 0.0))) - bend
    place = float(slope / root) if root > 0 else 0.0  # the zero of the slope where the curve bends down
    return place, float(curve(place) - curve(0.0))
