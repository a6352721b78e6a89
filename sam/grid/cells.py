# SPDX-License-Identifier: MIT
"""A grid of cells with depths below it, and a window of it. Of a grid that turns out too small a side that
the program chose is enlarged, one that the user gave is named. On its cells the gap between unloaded bodies:
of a paraboloid, a punch or a plane, less the heights of rough bodies.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from math import acos, cos, inf, pi, sin, sqrt

import numpy as np

from sam.arrays import Array, Mask
from sam.schedule import UNLOADED, Load


@dataclass(frozen=True)
class Window:
    """Cells of a grid, nx x ny of them from (i0, j0) on: i0 <= i < i0 + nx, j0 <= j < j0 + ny."""

    i0: int
    j0: int
    nx: int
    ny: int

    @property
    def slices(self) -> tuple[slice, slice]:
        """Indices of the cells in a field of the whole grid."""
        return slice(self.i0, self.i0 + self.nx), slice(self.j0, self.j0 + self.ny)

    @property
    def shape(self) -> tuple[int, int]:
        """(nx, ny)."""
        return self.nx, self.ny


@dataclass(frozen=True)
class Room:
    """Factors by which a chosen grid is larger than the first choice: its sides, and its depth."""

    beside: float = 1.0
    below: float = 1.0


@dataclass(frozen=True)
class CellGrid:
    """nx x ny cells of hx x hy in m about the origin. depths: (nz,) of output in m; faces: (nz +
    1,) of layers, or None; border: cells at each end that count for no maximum; room: as chosen; periodic:
    whether all repeats beside it; line: along y alone, of a line contact, with one cell the same at every y.
    """

    nx: int
    ny: int
    hx: float
    hy: float
    depths: Array
    faces: Array | None = None
    border: tuple[int, int] = (0, 0)
    room: Room = Room()
    periodic: bool = False
    line: bool = False

    @property
    def period(self) -> int:
        """Cells along y after which all repeats below a cylinder, 0 of others."""
        return self.ny if self.line else 0

    @property
    def wraps(self) -> tuple[bool, bool]:
        """Whether the last cell is a neighbour of the first, along x and along y."""
        return self.periodic, self.periodic or self.line

    @property
    def shape(self) -> tuple[int, int]:
        """(nx, ny)."""
        return self.nx, self.ny

    @property
    def whole(self) -> Window:
        """The window of all cells."""
        return Window(0, 0, self.nx, self.ny)

    @property
    def cell_area(self) -> float:
        """Area of a cell in m^2."""
        return self.hx * self.hy

    @property
    def x(self) -> Array:
        """Centres of the cells along x, (nx,) in m."""
        return _centres(self.nx, self.hx)

    @property
    def y(self) -> Array:
        """Centres of the cells along y, (ny,) in m."""
        return _centres(self.ny, self.hy)

    @property
    def axis_rows(self) -> Window:
        """The rows of cells that touch y = 0: one if ny is odd, two if it is even."""
        rows = 2 - self.ny % 2
        return Window(0, (self.ny - rows) // 2, self.nx, rows)

    @property
    def axis_columns(self) -> slice:
        """The columns of cells that touch x = 0."""
        columns = 2 - self.nx % 2
        first = (self.nx - columns) // 2
        return slice(first, first + columns)


def at_edge(cells: Mask, line: bool = False) -> bool:
    """Whether outermost cells are true, of (nx, ny); line: along y there are none, see `CellGrid`."""
    return bool(cells[[0, -1]].any() or (not line and cells[:, [0, -1]].any()))


def _centres(n: int, h: float) -> Array:
    """Centres of n cells of length h about the origin."""
    return (np.arange(n, dtype=np.float64) - (n - 1) / 2) * h


RATIO = 1.5  # by which a side grows that was reached
MOST_TIMES = 2  # how often a side grows at most: twice is 2.25 times the side, and five times the cells


@dataclass(frozen=True)
class Sides:
    """Sides of a grid, beside the contact and below it: those that were reached, or that a user gave."""

    beside: bool = False
    below: bool = False


def enlarged(given: Sides, room: Room, reached: Sides) -> Room | None:
    """More room where the grid was too small; None if it was not, or where the user gave what must grow."""
    if (
        not (reached.beside or reached.below)
        or (reached.beside and given.beside)
        or (reached.below and given.below)
    ):
        return None
    larger = Room(room.beside * RATIO**reached.beside, room.below * RATIO**reached.below)
    return larger if max(larger.beside, larger.below) <= RATIO**MOST_TIMES else None


def how_to_enlarge(grid: CellGrid, reached: Sides) -> str:
    """The sides of a grid that were reached, and what to give in place of them; empty if none was."""
    sides = []
    if reached.beside:
        lx, ly = (RATIO * n * h * 1e6 for n, h in ((grid.nx, grid.hx), (grid.ny, grid.hy)))
        larger = f'["{lx:.3g} um", "{ly:.3g} um"]'
        sides.append(f"beside the contact, raise grid.extent to {larger} and grid.cells in proportion")
    if reached.below and grid.faces is not None:
        deepest = RATIO * float(grid.faces[-1]) * 1e6
        sides.append(f'below the contact, let grid.depths (or grid.depth) go down to "{deepest:.3g} um"')
    return ", and ".join(sides)


def enlargement(first: CellGrid, grid: CellGrid) -> tuple[dict[str, object], str]:
    """(entry of the discretisation, warning) for a grid that was enlarged during the solve."""
    extra: dict[str, object] = {"grid_enlarged": {"beside": grid.room.beside, "below": grid.room.below}}
    before, after = (
        f"{one.nx} x {one.ny} cells and {one.depths[-1] * 1e6:.3g} um of depth" for one in (first, grid)
    )
    return (
        extra,
        f"the chosen grid was too small and was enlarged, from {before} to {after}; its cost is included",
    )


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
    start: Place | None = None  # of the path, where the surfaces touch first
    known: dict[tuple[Place, int], Array] = field(default_factory=dict, compare=False, repr=False)
    touching: dict[int, float] = field(default_factory=dict, compare=False, repr=False)

    def __call__(self, load: Load = UNLOADED) -> Array:
        """The gap with the counter-body at the place of a load, (nx, ny) in m; kept for the last place."""
        at, stretch = (load.x, load.y), load.stretch
        if (at, stretch) not in self.known:
            gap = self._between(at, stretch)
            if self.heights is not None or self.opposite is not None:
                if self.start is not None and stretch not in self.touching:
                    self.touching[stretch] = float(self._between(self.start, stretch).min())
                gap = gap - (gap.min() if self.start is None else self.touching[stretch])
            self.known.clear()
            self.known[at, stretch] = gap
        return self.known[at, stretch]

    def _between(self, at: Place, stretch: int) -> Array:
        """Shape less heights, (nx, ny) in m."""
        gap = self.shape.gap(self.grid, at)
        if self.heights is not None:
            gap = gap - self.heights
        return gap if self.opposite is None else gap - self.opposite(stretch, at)
