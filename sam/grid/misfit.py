# SPDX-License-Identifier: MIT
"""The grid about a misfit sphere: what [grid] leaves out is chosen from the sphere and its plastic zone."""

from __future__ import annotations

from dataclasses import dataclass
from math import ceil

import numpy as np

from sam.arrays import Array
from sam.grid.cells import CellGrid, Room
from sam.grid.smooth import DEPTH_SPACING, LAYER_GROWTH, given_depths
from sam.scene import Grid

CELLS_IN_RADIUS = 8  # plastic strain of a smooth profile within 5 % (linear hardening), in 0.2 s
CELLS_IN_ZONE = 12  # at most so many are needed in the radius of a plastic zone
BEYOND_ZONE = 1.5  # radii of the zone: the half side of the grid
ELASTIC_SIDE = 2.0  # radii of the sphere, where nothing yields: the half side of the grid


@dataclass(frozen=True)
class MisfitDemand:
    """What the grid of a misfit sphere is chosen from.

    given: the table [grid], or None; depth, radius: of the sphere in m; zone: radius of the plastic zone in
    m, 0 where nothing yields, None of an elastic body.
    """

    given: Grid | None
    depth: float
    radius: float
    zone: float | None

    def grid(self, room: Room) -> CellGrid:
        """The grid, its sides and depth larger by the factors of a room than those chosen first."""
        given, zone = self.given, self.zone or 0.0
        half = max(BEYOND_ZONE * zone, self.radius) if zone else ELASTIC_SIDE * self.radius
        cell = max(self.radius / CELLS_IN_RADIUS, zone / CELLS_IN_ZONE)
        usual = 2 * ceil(half * room.beside / cell - 0.5) + 1
        nx, ny = (given.cells if given and given.cells else None) or (usual, usual)
        lx, ly = (given.extent if given and given.extent else None) or (2 * half * room.beside,) * 2
        if not given or not (given.cells or given.extent):
            lx = ly = usual * cell
        hx, hy = lx / nx, ly / ny
        depths = given_depths(given)
        if self.zone is None:
            return CellGrid(nx, ny, hx, hy, self._levels(half) if depths is None else depths, room=room)
        if depths is None:
            depths = self._faces(min(hx, hy), half, room.below)
        return CellGrid(nx, ny, hx, hy, (depths[1:] + depths[:-1]) / 2, depths, room=room)

    def _levels(self, half: float) -> Array:
        """Output depths of an elastic body: one of them that of the centre."""
        spacing = DEPTH_SPACING * self.radius
        above = int(self.depth / spacing)
        levels: Array = self.depth + spacing * np.arange(-above, ceil(half / spacing) + 1.0)
        return levels

    def _faces(self, thickness: float, half: float, room: float) -> Array:
        """Faces of layers as thick as a cell about the centre, which is the middle of one of them; above
        them, where nothing yields, layers that grow towards the surface.
        """
        count = ceil(half / thickness - 0.5)
        below = self.depth + thickness * (np.arange(ceil(count * room) + 1) + 0.5)
        above, upper = [self.depth - thickness / 2], thickness
        while above[-1] > 0:
            if len(above) > count:
                upper *= LAYER_GROWTH
            above.append(above[-1] - upper)
        above.pop()
        if len(above) > 1 and above[-1] < thickness / 2:
            above.pop()
        return np.concatenate([[0.0], above[::-1], below])
