# SPDX-License-Identifier: MIT
"""How far one iteration moves the plastic strain of a cell, by the stiffness of each part of it.

The return map moves all parts of the strain of a cell by the stiffness 2 m. How much a part lowers the stress
of its own cell depends on the cell: in a flat one at the surface, a tenth of its width thick, a shear across
the layer by 0.1 mu for a unit strain, one in the plane by 1.6 mu. A soft layer that a traction shears flows
most by the first. Where the strain grows by x, the yield stress sigma_y resists a turn of x by

    T = 2 sigma_y/(3 dgamma),     dgamma = sqrt(2/3 x : x),                                               (a)

so that a change of the stress changes the return map by 1/(2 m + T), and the solution, as far as the cell
alone makes it, by 1/(a + T) with the stiffness a of the part in its own cell. The change of a part of x by
the return map is therefore multiplied by

    (2 m + T)/(a + T).                                                                                    (b)

The fixed point is the same for every factor.
"""

from __future__ import annotations

import numpy as np

from sam.arrays import Array
from sam.plasticity.return_map import SHEAR, equivalent_strain

ROOT = np.sqrt(SHEAR)
# Parts of a deviator, each of unit length in components times ROOT: 11 - 22, 11 + 22 - 2 33, 23, 13 and 12.
PARTS = np.zeros((5, 6))
PARTS[0, :3] = np.array([1.0, -1.0, 0.0]) / np.sqrt(2)
PARTS[1, :3] = np.array([1.0, 1.0, -2.0]) / np.sqrt(6)
PARTS[2:, 3:] = np.eye(3)
ACROSS = slice(2, 4)  # the shears across the layer: one stiffness for both


def stiffness_of_parts(own_stress: Array) -> Array:
    """Stiffness a of (b) in Pa, (5, n_layers), from the stress of unit strains in their own cell, (6, 6,
    n_layers) in Pa.
    """
    found: Array = -np.einsum("ai,ijk,aj->ak", PARTS * ROOT, own_stress, PARTS / ROOT)
    found[ACROSS] = found[ACROSS].mean(axis=0)
    return found


def preconditioned(x: Array, image: Array, limit: Array, *, m: float, own: Array) -> Array:
    """The image of an increment with its change by (b) where it flows.

    Parameters
    ----------
    x, image
        Increment of the plastic strain and what the return map makes of it, (6, n_layers, nx, ny).
    limit
        Yield stress in Pa, (n_layers, nx, ny).
    m
        Stiffness of the return map in Pa.
    own
        That of the parts of the strain, see `stiffness_of_parts`.
    """
    found, flowing = image.copy(), image.any(axis=0)
    start, end = x[:, flowing], image[:, flowing]
    turn = limit[flowing] / (1.5 * equivalent_strain(end))
    factor = (2 * m + turn) / (own[:, np.nonzero(flowing)[0]] + turn)
    parts = factor * (PARTS @ (ROOT[:, None] * (end - start)))
    found[:, flowing] = start + PARTS.T @ parts / ROOT[:, None]
    return found
