# SPDX-License-Identifier: MIT
"""The gap between unloaded bodies: of a paraboloid, a punch or a plane, less the heights of rough bodies."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from math import acos, cos, inf, pi, sin, sqrt

import numpy as np

from sam.arrays import Array
from sam.grid.cells import CellGrid
from sam.scene.section import stated
from sam.schedule import UNLOADED, Load

Place = tuple[float, float]
"""Centre of the counter-body (x, y) in m."""
ORIGIN: Place = (0.0, 0.0)


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
    """The flat end of a cylinder: its cells have its area, as closely as whole rings allow."""

    radius: float

    def gap(self, grid: CellGrid, at: Place = ORIGIN) -> Array:
        """At the cell centres, (nx, ny) in m: 0 or inf."""
        distance = np.hypot(grid.x[:, None] - at[0], grid.y[None, :] - at[1])
        rings, counts = np.unique(np.round(distance / self.radius, 9), return_counts=True)
        last = np.abs(np.cumsum(counts) - pi * self.radius**2 / grid.cell_area).argmin()
        return np.where(np.round(distance / self.radius, 9) <= rings[last], 0.0, np.inf)


@dataclass(frozen=True)
class Uniform:
    """The same gap in m everywhere: 0 of a plane counter-body, not a number where nothing is opposite."""

    value: float = 0.0

    def gap(self, grid: CellGrid, at: Place = ORIGIN) -> Array:
        """At the cell centres, (nx, ny) in m."""
        return np.full((grid.nx, grid.ny), self.value)


FEWEST = 3  # cells in the contact beyond the flat end: the largest pressure errs by 1 %, with 1.5 by 5 %
HALVINGS = 60  # of a bracket: to the last digit


@dataclass(frozen=True)
class RoundedPunch:
    """The gap (r - flat)^2/(2 radius) beyond the flat end in m (Ciavarella, Hills & Monno, Proc.
    Inst. Mech. Eng. C 212 (1998) 319), by Abel's transform; cos t = flat/a.
    """

    flat: float
    radius: float

    def gap(self, grid: CellGrid, at: Place = ORIGIN) -> Array:
        """At the cell centres, (nx, ny) in m."""
        beyond = np.maximum(np.hypot(grid.x[:, None] - at[0], grid.y[None, :] - at[1]) - self.flat, 0.0)
        return beyond**2 / (2 * self.radius)

    def largest_cell(self, a: float) -> float:
        """In m, at a contact radius in m; infinite without contact beyond the flat end."""
        return (a - self.flat) / FEWEST if a > self.flat else inf

    def force(self, a: float, modulus: float) -> float:
        """In N at a contact radius in m; modulus: E* in Pa."""
        t = acos(min(1.0, self.flat / a))
        return modulus * a**3 / self.radius * (4 / 3 * sin(t) ** 3 - cos(t) * (t - sin(t) * cos(t)))

    def approach(self, a: float) -> float:
        """In m at a contact radius in m."""
        return a / self.radius * (sqrt(a**2 - self.flat**2) - self.flat * acos(min(1.0, self.flat / a)))

    def contact_radius(self, force: float, modulus: float) -> float:
        """In m under a force in N: at most that of Hertz beyond the flat end."""
        hertz = (3 * force * self.radius / (4 * modulus)) ** (1 / 3)
        return self._radius(lambda a: self.force(a, modulus) < force, hertz)

    def radius_at(self, approach: float) -> float:
        """The contact radius in m at an approach in m: at most twice that of Hertz beyond the flat end."""
        return self._radius(lambda a: self.approach(a) < approach, 2 * sqrt(self.radius * approach))

    def _radius(self, smaller: Callable[[float], bool], beyond: float) -> float:
        low, high = self.flat, self.flat + beyond
        for _ in range(HALVINGS):
            middle = (low + high) / 2
            low, high = (middle, high) if smaller(middle) else (low, middle)
        return high


Shape = Paraboloid | Punch | Uniform | RoundedPunch
"""The shape of a counter-body."""


@dataclass(frozen=True)
class InitialGap:
    """The gap before the first load at the cell centres, zero at first touch of each stretch."""

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
