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
from sam.tribofilm.material import Loads, Material

SHEAR = np.array([1.0, 1.0, 1.0, 2.0, 2.0, 2.0])  # each shear component stands for two entries of the tensor


def increment(loads: Loads, material: Material) -> Array:
    """Increment of the plastic strain, (6, n), of cells under the printed stress."""
    return radial_flow(printed_stress(loads, material), loads.plastic, material)


def printed_stress(loads: Loads, material: Material) -> Array:
    """Stress (6, n) in Pa by Eqs. 12-14 as printed, order 11 22 33 23 13 12."""
    young, poisson = material.young, material.poisson
    half, lame = young / (2.0 * (1.0 + poisson)), young * poisson / ((1.0 + poisson) * (1.0 - 2.0 * poisson))
    normals = np.stack([loads.strain[0], loads.strain[1], np.asarray(loads.bulk_normal)])
    stress = np.zeros((6, *loads.pressure.shape))
    stress[:3] = half * normals + lame * normals.sum(axis=0)  # paper Eq. 12
    stress[2] += loads.pressure  # paper Eq. 13
    stress[4] = loads.shear  # paper Eq. 14
    return stress


def radial_flow(stress: Array, plastic: Array, material: Material) -> Array:
    """Increment of the plastic strain (6, ...) after `plastic`, at given total strains; 0 below yield."""
    twice_shear, yield_stress = material.twice_shear, material.yield_stress
    deviator = stress - twice_shear * plastic
    deviator[:3] -= deviator[:3].mean(axis=0)
    q = np.sqrt(1.5 * np.einsum("i,i...,i...->...", SHEAR, deviator, deviator))
    found: Array = np.maximum(q - yield_stress, 0.0) / (twice_shear * np.maximum(q, yield_stress)) * deviator
    return found
