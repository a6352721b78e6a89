# SPDX-License-Identifier: MIT
"""Columns of the surface that is wavy in two directions: how far its area is off."""

from __future__ import annotations

from sam.scene import Result, Scene
from verification.quantities import Reference


def off_series(scene: Scene, result: Result, reference: Reference) -> float:
    """Relative difference of the share in contact from that in Fourier series."""
    return abs(result.quantities["contact_share"] / reference.values["share"] - 1.0)


def off_fit(scene: Scene, result: Result, reference: Reference) -> float:
    """Relative difference of the share in contact from the published fit."""
    return abs(result.quantities["contact_share"] / reference.values["fitted-share"] - 1.0)
