# SPDX-License-Identifier: MIT
"""Layers are counted from the current surface: when it wears, the material of each column moves up through
them.

New layer k of a column worn by w holds the mean of what was between z_k + w and z_{k+1} + w, the old layers
being uniform; below the deepest face the material is fresh. With h the thicknesses of the layers and overlaps
by interval arithmetic,

    sum_k h_k new_k + integral over 0 ... w of old = sum_k h_k old_k                                       (a)

for each column and component, to rounding. Means of plastic strains are free of volume change again, and the
accumulated strain stays at least their norm. A shift by a fraction t of a uniform layer h smears like a
diffusion, with second moment t (1 - t) h^2 per remap (first-order upwind); whole layers move without it.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from sam.arrays import Array
from sam.wear.smoothing import check_depth


def remapped(field: Array, faces: Array, depth: Array) -> tuple[Array, Array]:
    """Move each column of a field up by its depth (nx, ny) in m >= 0.

    field: means of cells, (..., n_layers, nx, ny), a tensor of any shape in each; faces: (n_layers + 1,) in m
    from 0 downwards. Returns the field of the layers below the worn surface, and its integral over the worn
    depth, (..., nx, ny) in m. Columns that are not worn keep every bit, and without any the field that came
    in is returned. Raises ValueError for a depth that is negative or not finite.
    """
    check_depth(depth)
    worn, leading = depth > 0, field.shape[:-3]
    removed = np.zeros((*leading, *depth.shape))
    if worn.any():
        columns = field[..., worn]
        field = field.copy()
        moved, gone = _moved_up(
            columns.reshape(-1, *columns.shape[-2:]), np.asarray(faces, float), depth[worn]
        )
        field[..., worn], removed[..., worn] = moved.reshape(columns.shape), gone.reshape(*leading, -1)
    return field, removed


def _moved_up(state: Array, faces: Array, depth: Array) -> tuple[Array, Array]:
    """The new columns of (a) and the integrals (n, m) of what is gone.

    Columns are (n, n_layers, m), worn by depth (m,).
    """
    new = np.empty_like(state)
    above, below = faces[:-1, None], faces[1:, None]
    for k, (top, bottom) in enumerate(pairwise(faces)):
        # nothing moves down: only the layers from k on
        overlap = np.minimum(bottom + depth, below[k:]) - np.maximum(top + depth, above[k:])
        np.einsum("cjm,jm->cm", state[:, k:], np.maximum(overlap, 0.0) / (bottom - top), out=new[:, k])
    gone = np.clip(depth - above, 0.0, below - above)
    return new, np.einsum("cjm,jm->cm", state, gone)


def closing_residual(before: Array, after: Array, removed: Array, faces: Array) -> float:
    """Largest difference of both sides of (a), over the largest integral of |before|; 0 without strain.

    before, after: (..., n_layers, nx, ny); removed: (..., nx, ny).
    """
    h = np.diff(faces)[:, None, None]
    scale = (np.abs(before) * h).sum(axis=-3).max()
    difference = (after * h).sum(axis=-3) + removed - (before * h).sum(axis=-3)
    return float(np.abs(difference).max() / scale) if scale > 0 else 0.0
