# SPDX-License-Identifier: MIT
"""The recipe of the three asperities of scenes/rough-asperities.csv: heights and a map of friction on any
grid.

Gaussian bumps with their tops on y = 0, so that the plane y = 0 passes through the middle of each spot;
turned in the plane, so that nothing is symmetric. Their spectrum is below 1 % of its top at wavelengths of
2.5 um, ten of the file's cells.
"""

import numpy as np

from sam.scene import FrictionMap, HeightMap

SIDE = 12e-6
CELLS = 48
"""Of the file."""
HIGH, LOW = 0.4, 0.1
"""Coefficients of the map: high on the asperity in the middle."""
BORDERS = (-1.9e-6, 2.0e-6)
"""x in m between the asperities."""


BUMPS = (
    (-3.8e-6, 130e-9, 1.35e-6, 2.0e-6, 20.0),
    (0.2e-6, 118e-9, 1.2e-6, 1.7e-6, 0.0),
    (3.9e-6, 113e-9, 1.3e-6, 1.8e-6, -15.0),
)
"""Of each: x of its top, height and both widths in m, and by how many degrees it is turned."""


def centres(cells: int) -> np.ndarray:
    """(cells,) centres of the cells of a side in m."""
    return ((np.arange(cells) + 0.5) / cells - 0.5) * SIDE


def height_map(cells: int) -> HeightMap:
    """The asperities, height exp(-u^2/(2 wide_u^2) - v^2/(2 wide_v^2)), on cells x cells cells."""
    x, y = np.meshgrid(centres(cells), centres(cells), indexing="ij")
    heights = np.zeros_like(x)
    for top, height, wide_u, wide_v, angle in BUMPS:
        c, s = np.cos(np.radians(angle)), np.sin(np.radians(angle))
        u, v = (x - top) * c + y * s, y * c - (x - top) * s
        heights += height * np.exp(-(u**2) / (2.0 * wide_u**2) - v**2 / (2.0 * wide_v**2))
    return HeightMap(heights, (SIDE, SIDE))


def friction_map(cells: int) -> FrictionMap:
    """HIGH on the asperity in the middle, LOW on the others."""
    x, low, high = centres(cells), *BORDERS
    local = np.where((x > low) & (x < high), HIGH, LOW)
    return FrictionMap(np.repeat(local[:, None], cells, axis=1), (SIDE, SIDE))
