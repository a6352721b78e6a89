# SPDX-License-Identifier: MIT
"""The box of cells on which plastic strain is solved: the first guess, and how it grows; and the boxes
that a solve is expected to go through.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import floor

import numpy as np
from numpy.typing import NDArray

from sam.arrays import Array, Mask
from sam.contact.convolution import half_length
from sam.contact.normal import around, margin_around
from sam.contact.operators import yielding
from sam.elastic.problem import ElasticPeak
from sam.grid.cells import CellGrid, Sides, Window, at_edge
from sam.plasticity.points import OFFSET
from sam.plasticity.spectra import CACHED_BOXES, SINGLE
from sam.plasticity.state import Extent, Trial
from sam.plasticity.swept import neighbours

# Measured on spheres, 41 x 41 cells, 4 steps at 1e-4: P is of perfect plasticity at p0 = 4.8 yield stresses,
# and takes two boxes and 58 operator applications; S is of Swift steel at p0 = 5.3, one box and 22
# applications.
# Share of its size, 1/GROWTH, by which a box grows at least on a side that is reached: two boxes in P with 4
# and 16.
GROWTH = 8
# Cells or layers by which it grows at least: two boxes in P also with 1 and with 6.
LEAST_GROWTH = 3
# Share of the width of the zone of elastic stress by which that of plastic strain reaches further on either
# side: of the largest von Mises stress in yield stresses, less CONTAINED, one over SPREAD, and FURTHEST at
# most; a cell more if it slides or moves. Of 88 spheres (p0 = 1.8 to 7 yield stresses, 4 to 16 cells in
# the radius, friction up to 0.4, on a path) six take a second box, five of perfect plasticity from 3.5 on.
CONTAINED, SPREAD, FURTHEST = 1.6, 30, 1 / 12
# Contact half-widths that the first guess of the depth of the plastic zone has at most: with 1.2 S takes two
# boxes and 29 applications, with 2.5 it stays.
DEEPEST = 1.8
# Bytes of the matrices between all layers from which a box is swept. With 24 layers of cells an application
# takes as long either way; the matrices may be kept on disk.
MOST_BYTES = 1e9
SWEPT_SHARE = 0.05  # of the tolerance of the plastic iteration, the error of the sweeps
# Cells that are free beside the zone of a body that nothing touches: with two strained ones a box grows.
FREE_BESIDE = 3
# Share of a rough patch up to which a box is smaller than that, as fields beside a box have coefficients of
# their own: with 0.67 of 64 x 64 cells, 25 cycles take 34 s in place of 43 s.
MOST_OF_PATCH = 0.8


def first_extent(
    grid: CellGrid,
    peak: ElasticPeak,
    limit: Array,
    *,
    anywhere: bool,
    both_ways: bool = False,
    slides: bool = False,
    path: Sequence[tuple[float, float]] = ((0.0, 0.0),),
) -> Extent:
    """Box around the contact and the cells that would yield; limit: yield stress (nz,) in Pa;
    anywhere: below a rough surface, just around the contact; slides: with a traction, or along the path,
    places of the load in m.
    """
    exceeds = yielding(peak.mises, limit[:, None])
    if anywhere:
        layers = _layers(np.flatnonzero(exceeds.any(axis=1)), grid)
        box = around(peak.contact.pressure > 0)
        box = replace(box, j0=0, ny=grid.ny) if grid.line else box  # no end along y
        return Extent(or_whole(box, grid), layers)
    if not peak.contact.pressure.any():
        return _about_zone(exceeds, grid)
    box = around(peak.contact.pressure > 0)
    half_width = (box.nx * grid.hx if grid.line else min(box.nx * grid.hx, box.ny * grid.hy)) / 2
    deep = np.flatnonzero(exceeds.any(axis=1) & (grid.depths <= DEEPEST * half_width))
    columns, end = np.flatnonzero(exceeds.any(axis=0)), box.i0 + box.nx
    ratio = float((peak.mises / limit[:, None]).max())
    free = beside(int(columns[-1] + 1 - columns[0]), ratio, slides)
    margins = np.clip([box.i0 + free - columns[0], columns[-1] + 1 + free - end], 0, box.nx // 3)
    across, widest = int(margins.min()), int(margins.max())
    before, after = (widest, widest) if both_ways else margins
    swept = np.array(path) / (grid.hx, grid.hy)
    left, low = np.floor(swept.min(axis=0)).astype(int)
    right, high = np.ceil(swept.max(axis=0)).astype(int)
    i0, j0 = max(int(box.i0 - before + left), 0), max(int(box.j0 - across + low), 0)
    i1, j1 = min(int(end + after + right), grid.nx), min(int(box.j0 + box.ny + across + high), grid.ny)
    return Extent(Window(i0, j0, i1 - i0, j1 - j0), _layers(deep, grid))


def beside(columns: int, ratio: float, slides: bool) -> int:
    """Cells of a first box beside a zone of elastic stress of so many: of plastic strain and two free."""
    return 2 + floor(columns * min(max((ratio - CONTAINED) / SPREAD, 0), FURTHEST)) + slides


def _about_zone(exceeds: Mask, grid: CellGrid) -> Extent:
    """Box around what would yield of a body that nothing touches; exceeds: (nz, nx), in y = 0."""
    columns, deep = np.flatnonzero(exceeds.any(axis=0)), np.flatnonzero(exceeds.any(axis=1))
    free = min(int(columns[0]), grid.nx - 1 - int(columns[-1]))  # cells beside it
    half = (grid.nx / 2 - free) * grid.hx
    i = max(free - FREE_BESIDE, 0)
    j = max(int(grid.ny / 2 - half / grid.hy) - FREE_BESIDE, 0)
    return Extent(Window(i, j, grid.nx - 2 * i, grid.ny - 2 * j), _layers(deep, grid))


def _layers(deep: NDArray[np.intp], grid: CellGrid) -> int:
    """Layers down to one below the deepest of those that would yield, two at least."""
    return min(int(deep[-1]) + 2 if deep.size else 2, len(grid.depths))


def growth(count: int) -> int:
    """By how many cells or layers a box of so many grows on a side that is reached."""
    return max(LEAST_GROWTH, count // GROWTH)


def grown(extent: Extent, trial: Trial, grid: CellGrid) -> Extent:
    """The box with more cells on the sides that strain or contact reaches, as far as the grid goes."""
    strained = trial.increment.cells
    on_surface: Mask = strained.any(axis=0) | (trial.pressure > 0)
    window, layers = extent.window, extent.layers
    in_x = bool(on_surface[:2].any()), bool(on_surface[-2:].any())
    in_y = bool(on_surface[:, :2].any()), bool(on_surface[:, -2:].any())
    i, nx = widened(window.i0, window.nx, grid.nx, in_x)
    j, ny = widened(window.j0, window.ny, grid.ny, in_y)
    if strained[-1].any():
        layers = min(layers + growth(layers), len(grid.depths))
    return Extent(Window(i, j, nx, ny), layers)


def or_whole(window: Window, grid: CellGrid) -> Window:
    """The window, or the whole grid where it is most of that."""
    return window if window.nx * window.ny <= MOST_OF_PATCH * grid.nx * grid.ny else grid.whole


def holding(extent: Extent, cells: Mask, grid: CellGrid) -> Extent:
    """The box with these cells of the grid, (nx, ny), and a margin around them, or the whole grid."""
    box, more = extent.window, around(cells)
    i0, j0 = min(box.i0, more.i0), min(box.j0, more.j0)
    i1, j1 = max(box.i0 + box.nx, more.i0 + more.nx), max(box.j0 + box.ny, more.j0 + more.ny)
    return replace(extent, window=or_whole(Window(i0, j0, i1 - i0, j1 - j0), grid))


def widened(first: int, count: int, limit: int, reached: tuple[bool, bool]) -> tuple[int, int]:
    """A range of cells with more before and behind where that is reached, inside 0 .. limit."""
    more, (before, after) = growth(count), reached
    start, stop = max(first - more * before, 0), min(first + count + more * after, limit)
    return start, stop - start


def edge_reached(trial: Trial, grid: CellGrid, *, cut_beside: bool) -> Sides:
    """Sides at which plastic strain fills the outermost cells; a rough patch is cut beside anyway."""
    strained = trial.increment.cells
    columns: Mask = np.asarray(strained.any(axis=0))
    beside = at_edge(columns, grid.line)
    return Sides(bool(beside and not cut_beside), bool(strained[-1].any()))


@dataclass(frozen=True)
class ExpectedBox:
    """A box of plastic strain; tolerance: of the iteration; exchange: of x and y; operator: see `Solver`;
    faces: of the layers in hx, for `pairs`; periodic: all cells of a period.
    """

    nx: int
    ny: int
    layers: int
    tolerance: float
    exchange: bool = False
    operator: str | None = None
    faces: tuple[float, ...] = ()
    periodic: bool = False

    @property
    def width(self) -> int:
        """Bytes of a stored coefficient."""
        return 4 if self.tolerance >= SINGLE else 8

    @property
    def waves(self) -> int:
        """Wave numbers that are kept: (N_x + 1)(N_y + 1), or k_x <= k_y of them."""
        nx, ny = half_length(self.nx) + 1, half_length(self.ny) + 1
        if self.periodic:
            nx, ny = self.nx // 2 + 1, self.ny // 2 + 1
        return nx * (nx + 1) // 2 if self.exchange else nx * ny

    @property
    def matrices(self) -> int:
        """Bytes of the matrices between all layers, 36 nz^2 coefficients for each wave number."""
        return self.width * 36 * self.layers**2 * self.waves

    @property
    def large(self) -> bool:
        """Whether sweeps take less time and memory."""
        return self.matrices > MOST_BYTES

    @property
    def swept(self) -> float:
        """The error of the operator where it is swept, or 0."""
        swept = self.operator == "swept" or (self.operator is None and self.large)
        return SWEPT_SHARE * self.tolerance if swept or self.periodic else 0.0

    @property
    def words(self) -> str:
        """Which operator, and why."""
        matrices = f"matrices between all {self.layers} layers"
        if self.periodic:
            return "swept over the layers, in the wave numbers of the patch"
        if self.operator is not None:
            return f'solver.operator = "{self.operator}"'
        return f"swept: {matrices} would take {self.matrices / 1e9:.3g} GB" if self.swept else matrices

    @property
    def pairs(self) -> int:
        """Pairs of layers between which coefficients are stored: all, or those that sweeps leave to them."""
        if not self.swept:
            return self.layers**2
        runs, top = neighbours(np.array(self.faces[: self.layers + 1]), self.swept)
        return sum(len(run.keys) for run in runs) + top**2

    @property
    def coefficients(self) -> int:
        """Numbers of the stored coefficients."""
        return 36 * self.pairs * self.waves

    @property
    def cells(self) -> int:
        """Cells of all layers."""
        return self.layers * self.nx * self.ny

    @property
    def set_up(self) -> int:
        """Coefficients between these pairs in the lags of the box, or in half, to be transformed."""
        return 36 * self.pairs * (self.nx + 1) * (self.ny + 1) // (1 + self.exchange)


@dataclass(frozen=True)
class Zone:
    """A smooth contact, and the zone beyond yield below it: wide, deep of elastic stress, needed of
    plastic strain, in semi-axes; ratio of stress to yield stress; slides: as for `first_extent`; path in
    cells.
    """

    axes: tuple[float, float]
    wide: float
    deep: float
    needed: tuple[float, float]
    ratio: float
    slides: bool = False
    path: tuple[int, int] = (0, 0)


def expected_sides(grid: CellGrid, depths: np.ndarray, zone: Zone) -> list[tuple[int, int, int]]:
    """Cells in x, in y, and layers of the expected boxes, from the first on; depths (nz,) in m."""
    box, needed = [], []
    for axis, h, n, path in zip(zone.axes, (grid.hx, grid.hy), (grid.nx, grid.ny), zone.path, strict=True):
        contact = 2 * floor(axis / h) + n % 2
        contact += 2 * margin_around(contact)
        columns = 2 * floor(zone.wide * axis / h) + 1
        more = columns // 2 + beside(columns, zone.ratio, zone.slides) - contact // 2
        box.append(min(contact + 2 * min(max(more, 0), contact // 3) + path, n))
        # a cell yields with the first of its points; the last two cells of a box stay free
        needed.append(min(2 * floor(zone.needed[0] * axis / h + 2 * OFFSET) + 5 + path, n))
    deep, half_width = zone.deep * min(zone.axes), min(box[0] * grid.hx, box[1] * grid.hy) / 2
    layers = int(np.searchsorted(depths, min(deep, DEEPEST * half_width))) + 1
    boxes = [(box[0], box[1], min(layers, len(depths)))]
    needed_layers = int(np.searchsorted(depths, zone.needed[1] * min(zone.axes))) + 1
    while True:
        nx, ny, nz = boxes[-1]
        wider, longer = (n + 2 * growth(n) * (n < need) for n, need in zip((nx, ny), needed, strict=True))
        deeper = nz + growth(nz) * (nz < needed_layers)
        larger = min(wider, grid.nx), min(longer, grid.ny), min(deeper, len(depths))
        if larger == boxes[-1]:
            return boxes
        boxes.append(larger)


def held(boxes: list[ExpectedBox]) -> list[ExpectedBox]:
    """The boxes, in order, in memory at the end: one that is outgrown stays until the next is there."""
    return boxes[-max(CACHED_BOXES, 2) :]
