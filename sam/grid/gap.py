# SPDX-License-Identifier: MIT
"""The gap between unloaded bodies: of a paraboloid, a punch or a plane, less the heights of rough bodies."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from math import pi
from typing import Protocol

import numpy as np

from sam.arrays import Array, Mask
from sam.grid.cells import CellGrid
from sam.scene.section import stated
from sam.schedule import UNLOADED, Load

Place = tuple[float, float]
"""Centre of the counter-body (x, y) in m."""
ORIGIN: Place = (0.0, 0.0)


class Shape(Protocol):
    """The shape of a counter-body."""

    def gap(self, grid: CellGrid, at: Place = ORIGIN) -> Array:
        """The gap at the cell centres, (nx, ny) in m."""


@dataclass(frozen=True)
class Paraboloid:
    """The gap x^2/(2 Rx) + y^2/(2 Ry) of a sphere or an ellipsoid. radii: (Rx, Ry) in m."""

    radii: tuple[float, float]

    def gap(self, grid: CellGrid, at: Place = ORIGIN) -> Array:
        """At the cell centres, (nx, ny) in m."""
        rx, ry = self.radii
        x, y = grid.x[:, None] - at[0], grid.y[None, :] - at[1]
        return x**2 / (2 * rx) + y**2 / (2 * ry)


@dataclass(frozen=True)
class Punch:
    """The flat end of a cylinder: no gap under it, an infinite one beside it. radius in m.

    Its cells are those nearest to the axis that together have its area, as closely as whole rings allow.
    """

    radius: float

    def gap(self, grid: CellGrid, at: Place = ORIGIN) -> Array:
        """At the cell centres, (nx, ny) in m: 0 or inf."""
        distance = np.hypot(grid.x[:, None] - at[0], grid.y[None, :] - at[1])
        return np.where(_cells_of_circle(distance, self.radius, grid.hx * grid.hy), 0.0, np.inf)


@dataclass(frozen=True)
class Plane:
    """A plane counter-body: no gap but for the heights of the bodies."""

    def gap(self, grid: CellGrid, at: Place = ORIGIN) -> Array:
        """Zero at the cell centres, (nx, ny)."""
        return np.zeros((grid.nx, grid.ny))


@dataclass(frozen=True)
class NoCounterBody:
    """Nothing is opposite where a scene gives the pressure."""

    def gap(self, grid: CellGrid, at: Place = ORIGIN) -> Array:
        """Not a number at the cell centres, (nx, ny)."""
        return np.full((grid.nx, grid.ny), np.nan)


@dataclass(frozen=True)
class InitialGap:
    """The gap before the first load, at the cell centres of a grid.

    heights: of a rough body, (nx, ny) in m, positive out of it; opposite: of the counter-body, by the number
    of the stretch and the place, positive out of that. With either the gap is zero where the unworn bodies
    touch first, for each stretch by itself; on a path where they do so at its start.
    """

    shape: Shape
    grid: CellGrid
    heights: Array | None = None
    opposite: Callable[[int, Place], Array] | None = None
    start: Place | None = None
    known: dict[tuple[Place, int], Array] = field(default_factory=dict, compare=False, repr=False)
    touching: dict[int, float] = field(default_factory=dict, compare=False, repr=False)

    def __call__(self, load: Load = UNLOADED) -> Array:
        """The gap with the counter-body at the place of a load, (nx, ny) in m; kept for the last place."""
        at, stretch = (load.x, load.y), load.stretch
        if (at, stretch) not in self.known:
            gap = self._between(at, stretch)
            if self.heights is not None or self.opposite is not None:
                gap = gap - (gap.min() if self.start is None else self._first(stretch))
            self.known.clear()
            self.known[at, stretch] = gap
        return self.known[at, stretch]

    def _between(self, at: Place, stretch: int) -> Array:
        """Shape less heights, (nx, ny) in m."""
        gap = self.shape.gap(self.grid, at)
        if self.heights is not None:
            gap = gap - self.heights
        return gap if self.opposite is None else gap - self.opposite(stretch, at)

    def _first(self, stretch: int) -> float:
        """The smallest gap at the start of the path in m."""
        if stretch not in self.touching:
            self.touching[stretch] = float(self._between(stated(self.start), stretch).min())
        return self.touching[stretch]


def _cells_of_circle(distance: Array, radius: float, cell_area: float) -> Mask:
    """The cells nearest to the centre whose number comes closest to the area of the circle: at least the
    innermost.

    Cells at one distance enter together, so the symmetry of the grid stays.
    """
    rings, counts = np.unique(np.round(distance / radius, 9), return_counts=True)
    last = np.abs(np.cumsum(counts) - pi * radius**2 / cell_area).argmin()
    inside: Mask = np.round(distance / radius, 9) <= rings[last]
    return inside
