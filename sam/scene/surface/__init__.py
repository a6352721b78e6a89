# SPDX-License-Identifier: MIT
"""Rough surfaces: the tables [surface] and [counterbody.surface] of a scene, heights from a file or a
generator, and numbers that describe them.
"""

from sam.scene.surface.counter import CounterSurface, Strip, leading
from sam.scene.surface.height_map import FrictionMap, HeightMap
from sam.scene.surface.making import (
    BORDER,
    Roughness,
    border_cells,
    heights,
    mean_deviation,
    processed,
    roughness,
    roughness_as_read,
    with_relief,
)
from sam.scene.surface.section import Surface, patch_of

__all__ = [
    "BORDER",
    "CounterSurface",
    "FrictionMap",
    "HeightMap",
    "Roughness",
    "Strip",
    "Surface",
    "border_cells",
    "heights",
    "leading",
    "mean_deviation",
    "patch_of",
    "processed",
    "roughness",
    "roughness_as_read",
    "with_relief",
]
