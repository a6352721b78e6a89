# SPDX-License-Identifier: MIT
"""Columns of the wavy surface: the pressure along a wave."""

from __future__ import annotations

import numpy as np

from sam.scene import Result, Scene
from verification.judging import Measured
from verification.quantities import Reference
from verification.runs.sampling import pressure_map


def place(scene: Scene, result: Result, reference: Reference) -> np.ndarray:
    """Place over the wavelength."""
    return pressure_map(result)[0] / reference.units["wave"]


def pressure_along(scene: Scene, result: Result, reference: Reference) -> Measured:
    """Pressure over that of complete contact."""
    (x, _, p), unit = pressure_map(result), reference.units["p0"]
    return Measured(p[:, 0] / unit, reference.values["pressure"](x, 0.0) / unit)
