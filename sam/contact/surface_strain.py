# SPDX-License-Identifier: MIT
"""Total strains at the surface of a body, which a tribofilm that is bonded to it shares."""

from __future__ import annotations

import numpy as np

from sam.arrays import Array


def elastic_strain(stress: Array, young: float, poisson: float) -> Array:
    """Elastic strains xx, yy, xy, zz of stresses (6, ...) in Pa, order 11 22 33 23 13 12."""
    sxx, syy, szz, sxy = stress[0], stress[1], stress[2], stress[5]
    parts = (
        sxx - poisson * (syy + szz),
        syy - poisson * (sxx + szz),
        (1 + poisson) * sxy,
        szz - poisson * (sxx + syy),
    )
    return np.stack(parts) / young


def surface_strain(stress: Array, plastic: Array, depths: Array, *, young: float, poisson: float) -> Array:
    """Total strains xx, yy, xy, zz of the surface, (4, nx, ny), from the mean strains of the two uppermost
    layers of cells.

    stress in Pa and plastic strain, (6, n_layers, nx, ny); depths: of the layer centres in m. In the plane
    total strains are continuous across the layers; they are extrapolated linearly to z = 0. With one layer
    its mean is taken.
    """
    total = elastic_strain(stress[:, :2], young, poisson) + plastic[[0, 1, 5, 2], :2]
    if total.shape[1] < 2:
        return total[:, 0]
    up: Array = (total[:, 0] - total[:, 1]) * depths[0] / (depths[1] - depths[0])
    return total[:, 0] + up
