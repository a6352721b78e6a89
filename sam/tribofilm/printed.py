# SPDX-License-Identifier: MIT
"""The stress of the film as Eqs. 12-14 of Bosman & Schipper (2011) print it, for comparison only.

Printed: s_ii = E/(2 (1 + nu)) e_ii + nu E/((1 + nu)(1 - 2 nu)) (e_xx + e_yy + e_zz) with all three strains
of the body (Eq. 12), then s_zz + P for s_zz (Eq. 13) and s_xz = mu P (Eq. 14). Used by default
(return_map.py): the strains in the plane only, Hooke's law, s_zz = -P. Why: Hooke's law has E/(1 + nu)
before e_ii; a bonded film shares only the strains in the surface with the body; and equilibrium fixes s_zz,
so that Eq. 13 counts the pressure twice, and as a tension where compression is negative: under a pressure
this film grows thicker. The plastic strain follows by the radial return of that stress at a given strain
with Hooke's 2G (Simo & Hughes 1998, box 3.1), so it always exists, at a shear stress below the mu P
prescribed.
"""

from __future__ import annotations

import numpy as np

from sam.arrays import Array

SHEAR = np.array([1.0, 1.0, 1.0, 2.0, 2.0, 2.0])  # each shear component stands for two entries of the tensor


def printed_stress(
    strain: Array,
    bulk_normal: Array,
    pressure: Array,
    shear: Array,
    young: float,
    poisson: float,
) -> Array:
    """Stress (6, ...) in Pa by Eqs. 12-14 as printed, order 11 22 33 23 13 12.

    strain: of the body's surface, xx, yy, xy, (3, ...), and bulk_normal its zz, (...); pressure, shear: P and
    s_xz in Pa.
    """
    half, lame = young / (2.0 * (1.0 + poisson)), young * poisson / ((1.0 + poisson) * (1.0 - 2.0 * poisson))
    normals = np.stack([strain[0], strain[1], bulk_normal])
    stress = np.zeros((6, *pressure.shape))
    stress[:3] = half * normals + lame * normals.sum(axis=0)  # paper Eq. 12
    stress[2] += pressure  # paper Eq. 13
    stress[4] = shear  # paper Eq. 14
    return stress


def radial_flow(stress: Array, plastic: Array, young: float, poisson: float, yield_stress: float) -> Array:
    """Increment of the plastic strain (6, ...) after `plastic`, at given total strains; 0 below yield."""
    twice_shear = young / (1.0 + poisson)
    deviator = stress - twice_shear * plastic
    deviator[:3] -= deviator[:3].mean(axis=0)
    q = np.sqrt(1.5 * np.einsum("i,i...,i...->...", SHEAR, deviator, deviator))
    factor = np.maximum(q - yield_stress, 0.0) / (twice_shear * np.maximum(q, yield_stress))
    increment: Array = factor * deviator
    return increment
