# SPDX-License-Identifier: MIT
"""Displacements of a half-space under a normal point force on its surface (Boussinesq)."""

from __future__ import annotations

import numpy as np


def boussinesq(force: float, young: float, poisson: float, r: np.ndarray, z: np.ndarray) -> np.ndarray:
    """Displacements (u_r, u_z) of the half-space z >= 0 under `force` along +z at the origin.

    Johnson, Contact Mechanics (1985), Eq. (3.18a, c); with R^2 = r^2 + z^2 and G = E / (2 (1 + nu)):

        u_r = F / (4 pi G) [ r z / R^3 - (1 - 2 nu) r / (R (R + z)) ]
        u_z = F / (4 pi G) [ z^2 / R^3 + 2 (1 - nu) / R ]

    r, z: (n,) in m, not both zero; force in N, young in Pa (or any consistent units). Returns (2, n) in m.
    """
    R = np.hypot(r, z)
    factor = force * (1.0 + poisson) / (2.0 * np.pi * young)
    u_r = factor * (r * z / R**3 - (1.0 - 2.0 * poisson) * r / (R * (R + z)))
    u_z = factor * (z**2 / R**3 + 2.0 * (1.0 - poisson) / R)
    return np.stack([u_r, u_z])
