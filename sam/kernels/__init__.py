# SPDX-License-Identifier: MIT
"""Influence coefficients of the homogeneous half-space in closed form, by lags between equal cells.

`patches`: surface tractions (Eq. 5, 7, 20, 21 of the paper); `eigenstrain` and `layer_stress`: plastic strain
(Eq. 6, 7, 19, 22 to 26); `primitives`: the functions that both are made of (Eq. 26 to 30). Coefficients are
dimensionless, without a grid or a solver. `store` keeps them in files.
"""

from sam.kernels.patches import STRESS, Cuboids, Lags, displacement_coefficients, parity, stress_coefficients
from sam.kernels.store import CoefficientStore, using

__all__ = [
    "STRESS",
    "CoefficientStore",
    "Cuboids",
    "Lags",
    "displacement_coefficients",
    "parity",
    "stress_coefficients",
    "using",
]
