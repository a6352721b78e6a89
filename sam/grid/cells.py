# SPDX-License-Identifier: MIT
"""A grid of cells with depths below it, and a window of it. Of a grid that turns out too small a side that
the program chose is enlarged, one that the user gave is named.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sam.arrays import Array, Mask


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
    def layer_faces(self) -> Array:
        """Depths of the faces of all layers, (nz + 1,) in m; ValueError for a grid without layers."""
        if self.faces is None:
            raise ValueError("the grid has no layers")
        return self.faces

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
