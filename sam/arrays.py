# SPDX-License-Identifier: MIT
"""Names of the array types that annotations use, and what rounding may add up to."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
"""Real numbers in double precision."""
Mask = NDArray[np.bool_]
"""True or false for each cell."""
ROUNDING = 1e-9
"""Relative: above what rounding adds up to, below what matters, where a number is whole, or at its bound."""
