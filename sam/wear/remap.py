# SPDX-License-Identifier: MIT
"""Layers are counted from the current surface: when it wears, the material of each column moves up through them.

New layer k of a column worn by w holds the mean of what was between z_k + w and z_{k+1} + w, the old layers being uniform;
below the deepest face the material is fresh. With h the thicknesses of the layers and overlaps by interval arithmetic,

    sum_k h_k new_k + integral over 0 ... w of old = sum_k h_k old_k                                       (a)

for each column and component, to rounding. Means of plastic strains are free of volume change again, and the accumulated
strain stays at least their norm. A shift by a fraction t of a uniform layer h smears like a diffusion, with second moment
t (1 - t) h^2 per remap (first-order upwind); whole layers move without it.
"""

from __future__ import annotations

from itertools import pairwise
from typing import NamedTuple

import numpy as np

from sam.wear.smoothing import check_depth


class Remapped(NamedTuple):
    """Material of the layers below the worn surface, and what went with the worn depth.

    strain: (6, n_layers, nx, ny); alpha: (n_layers, nx, ny); removed_strain: (6, nx, ny) and removed_alpha: (nx, ny), in m,
    their integrals over the worn depth.
    """

    strain: np.ndarray
    alpha: np.ndarray
    removed_strain: np.ndarray
    removed_alpha: np.ndarray


def remapped(strain: np.ndarray, alpha: np.ndarray, faces: np.ndarray, depth: np.ndarray) -> Remapped:
    """Move each column up by its depth (nx, ny) in m >= 0.

    strain: plastic strain (6, n_layers, nx, ny), alpha: accumulated (n_layers, nx, ny), both means of cells; faces:
    (n_layers + 1,) in m from 0 downwards. Columns that are not worn keep every bit, and without any the arrays
    that came in are returned. Raises ValueError for a depth that is negative or not finite.
    """
    check_depth(depth)
    worn = depth > 0
    removed = np.zeros((7, *depth.shape))
    if worn.any():
        state = np.concatenate([strain[:, :, worn], alpha[None, :, worn]])
        strain, alpha = strain.copy(), alpha.copy()
        moved, removed[:, worn] = _moved_up(state, np.asarray(faces, dtype=float), depth[worn])
        strain[:, :, worn], alpha[:, worn] = moved[:6], moved[6]
    return Remapped(strain, alpha, removed[:6], removed[6])


def _moved_up(state: np.ndarray, faces: np.ndarray, depth: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The new columns of (a) and the integrals (7, m) of what is gone.

    Columns are (7, n_layers, m), worn by depth (m,).
    """
    new = np.empty_like(state)
    above, below = faces[:-1, None], faces[1:, None]
    for k, (top, bottom) in enumerate(pairwise(faces)):
        overlap = np.minimum(bottom + depth, below[k:]) - np.maximum(
            top + depth, above[k:]
        )  # nothing moves down
        np.einsum("cjm,jm->cm", state[:, k:], np.maximum(overlap, 0.0) / (bottom - top), out=new[:, k])
    gone = np.clip(depth - above, 0.0, below - above)
    return new, np.einsum("cjm,jm->cm", state, gone)


def closing_residual(before: np.ndarray, after: np.ndarray, removed: np.ndarray, faces: np.ndarray) -> float:
    """Largest difference of both sides of (a), over the largest integral of |before|; 0 without strain.

    before, after: (..., n_layers, nx, ny); removed: (..., nx, ny)."""
    h = np.diff(faces)[:, None, None]
    scale = (np.abs(before) * h).sum(axis=-3).max()
    difference = (after * h).sum(axis=-3) + removed - (before * h).sum(axis=-3)
    return float(np.abs(difference).max() / scale) if scale > 0 else 0.0
