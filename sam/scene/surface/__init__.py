# SPDX-License-Identifier: MIT
"""Rough surfaces: the table [surface] of a scene, heights from a file or a generator, and numbers that
describe them.
"""

from sam.scene.surface.counter import CounterSurface, leading
from sam.scene.surface.generators import heights, mean_deviation
from sam.scene.surface.height_map import FrictionMap, HeightMap
from sam.scene.surface.measured import processed, roughness_as_read
from sam.scene.surface.relief import BORDER, border_cells, with_relief
from sam.scene.surface.roughness import Roughness, roughness
from sam.scene.surface.section import Surface, patch_of
from sam.scene.surface.strip import Strip

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
