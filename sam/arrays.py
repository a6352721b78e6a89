# SPDX-License-Identifier: MIT
"""Names of the array types that annotations use, and the tolerance for rounding."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
"""Real numbers in double precision."""
Mask = NDArray[np.bool_]
"""True or false for each cell."""
ROUNDING = 1e-9
"""Relative tolerance within which a number counts as whole or as at its bound: rounding stays below it."""
