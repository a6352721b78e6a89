# SPDX-License-Identifier: MIT
"""Heights at the missing points of a map: the harmonic function of their measured neighbours."""

from __future__ import annotations

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.linalg import splu

from sam.arrays import Array


def harmonic(values: Array, cell: tuple[float, float]) -> Array:
    """Heights (nx, ny) in m on cells in m, those that are nan replaced: sum of (h_neighbour - h)/distance^2 =
    0 at each.
    """
    unknown = np.isnan(values)
    if not unknown.any():
        return values
    entries, right = _laplace(values, unknown, (cell[0] / cell[1]) ** 2)
    matrix = coo_matrix(entries, shape=(right.size, right.size)).tocsc()
    filled = values.copy()
    filled[unknown] = splu(matrix, permc_spec="MMD_AT_PLUS_A", options={"SymmetricMode": True}).solve(right)
    return filled


def _laplace(values: Array, unknown: Array, along_y: float) -> tuple[tuple[Array, tuple[Array, ...]], Array]:
    """(entries, (rows, columns)) and right side of the equations, one for each unknown; those of a pair
    appear twice and add up.

    along_y: the weight of neighbours along y; along x it is 1.
    """
    count = int(np.count_nonzero(unknown))
    number = np.where(unknown, np.cumsum(unknown).reshape(unknown.shape) - 1, -1)
    right, entries = np.zeros(count), []
    for axis, weight in enumerate((1.0, along_y)):
        ends = (slice(None, -1), slice(1, None))
        for mine, other in (ends, ends[::-1]):
            here, there = (number.swapaxes(0, axis)[part] for part in (mine, other))
            heights = values.swapaxes(0, axis)[other]
            rows, known, both = here[here >= 0], (here >= 0) & (there < 0), (here >= 0) & (there >= 0)
            right += np.bincount(here[known], weights=weight * heights[known], minlength=count)
            entries += [(weight, rows, rows), (-weight, here[both], there[both])]
    data = np.concatenate([np.full(rows.size, weight) for weight, rows, _ in entries])
    return (data, tuple(np.concatenate([entry[k] for entry in entries]) for k in (1, 2))), right
