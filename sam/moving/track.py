# SPDX-License-Identifier: MIT
"""The track of a counter-body that moves over the surface: what a step and a pass say of it.

The gap moves, the body stays: g(x, y; s) = P(x - s) - c(x - k s) of the profile P, the heights c of the
counter-body and its slip k. With contact wherever g + u_z = delta, the work of the pressure over a small
motion is F d(delta) + ds int p (dP/dx - k dc/dx): the second part is the force that drives the counter-body
against the slope of the groove and of summits, to which friction adds int q.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from math import nan

import numpy as np

from sam.arrays import Array, Mask
from sam.grid.cells import CellGrid, Window
from sam.results.history import Moved, PassEnd, Row
from sam.results.peaks import refined_peak
from sam.scene.groove import RUN_IN, RUN_OUT, Groove, steady_part
from sam.scene.surface import Strip
from sam.schedule import Load

ROUNDING = 1e-6  # of a centre of cells, in cells
FINE = 8  # steps in the shortest wave of a counter-surface; half as many at least, see `Strip`
LONG = 0.5  # contact radii: longer steps leave 3 % of the groove and 13 % of the plastic strain, and more


@dataclass(frozen=True)
class Growth:
    """Of a film out of contact. rate: see `sam.tribofilm.visits.entered`; speed: in m/s."""

    rate: float
    speed: float


@dataclass(frozen=True)
class Track:
    """The track of a scene.

    start, end: of the path in m; radius: semi-axis of the contact along x by Hertz in m; curvatures: (1/Rx,
    1/Ry) in 1/m of the counter-body, None of one that has none; step: along the path in m; plane: whether the
    counter-body is one, below which every place counts as steady; carries: share of the motion by which the
    pressure moves; strip: of a rough counter-body; period: way in m from the start of a pass to that of the
    next, that of a closed track if the scene gives one; returns: whether even passes go
    back; growth: of a film.
    """

    start: tuple[float, float]
    end: tuple[float, float]
    radius: float
    curvatures: tuple[float, float] | None
    step: float = 0.0
    plane: bool = False
    carries: float = 1.0
    strip: Strip | None = None
    period: float = 0.0
    returns: bool = False
    growth: Growth | None = None

    @property
    def along_x(self) -> bool:
        """Whether the path of a counter-body that is no plane is along x: then the groove is measured."""
        return self.start[1] == self.end[1] and not self.plane

    @property
    def length(self) -> float:
        """From start to end in m."""
        return float(np.hypot(self.end[0] - self.start[0], self.end[1] - self.start[1]))

    @property
    def direction(self) -> tuple[float, float]:
        """Unit vector from start to end."""
        return (self.end[0] - self.start[0]) / self.length, (self.end[1] - self.start[1]) / self.length

    def way(self, load: Load) -> float:
        """Distance of a load from the start, along the path, in m."""
        tx, ty = self.direction
        return tx * (load.x - self.start[0]) + ty * (load.y - self.start[1])

    def clock(self, cycle: int, load: Load) -> float:
        """The way of the counter-body from the first start to a load of a cycle, in m."""
        way = self.way(load)
        return (cycle - 1) * self.period + (self.length - way if self.returns and cycle % 2 == 0 else way)

    @property
    def warnings(self) -> tuple[str, ...]:
        """What a user should know about the steps of a body that yields."""
        out, share = list(self._of_waves()), self.step / self.radius
        if not self.plane and share > LONG * (1 + ROUNDING):
            out.append(
                f"loading.path: steps of {share:.2g} contact radii leave several percent of the groove and "
                "more of the plastic strain: a quarter of the radius leaves 1 % of the groove"
            )
        return tuple(out)

    def _of_waves(self) -> Iterator[str]:
        """Steps that are long for the summits of the counter-surface."""
        share = 0.0 if self.strip is None else self.strip.share_of_wave(self.step / self.length)
        if share > (1 + ROUNDING) / FINE:
            yield (
                f"loading.path: in a step the counter-surface slides {share:.2g} of its shortest wave: above "
                f"1/{FINE} summits jump over places"
            )

    def place(self, load: Load) -> str:
        """Where a load is, in words."""
        return f"the counter-body is at x = {load.x:.4g} m, {self.way(load):.4g} m after its start"

    def steady(self, way: Array) -> Mask:
        """Whether places at these distances from the start in m lie in the steady part."""
        if self.plane:
            return np.ones(np.shape(way), dtype=bool)
        return steady_part(way, self.radius, self.length)

    def carried(self, grid: CellGrid, pressure: Array, before: Load, after: Load) -> Array | None:
        """A pressure (nx, ny) moved with the counter-body by the nearest number of cells; None where nothing
        is left of it.
        """
        i = round(self.carries * (after.x - before.x) / grid.hx)
        j = round(self.carries * (after.y - before.y) / grid.hy)
        if (i, j) == (0, 0):
            return pressure
        moved = np.roll(pressure, (i, j), axis=(0, 1))
        for axis, cells in enumerate((i, j)):  # what leaves on one side does not come in on the other
            gone = slice(0, cells) if cells > 0 else slice(moved.shape[axis] + cells, None)
            moved[(slice(None),) * axis + (gone if cells else slice(0),)] = 0.0
        return moved if moved.any() else None

    def moved(
        self, grid: CellGrid, load: Load, pressure: Array, *, window: Window, traction: Array | float
    ) -> Moved:
        """What a step says of the motion. pressure: in Pa on a window; traction: q_x over p there."""
        total, way = float(pressure.sum()), self.way(load)
        if total == 0.0:
            return Moved(way, 0.0, nan)
        tx, ty = self.direction
        i, j = window.slices
        x0, y0 = (0.0, 0.0) if self.plane else (load.x, load.y)
        x, y = (grid.x[i] - x0)[:, None], (grid.y[j] - y0)[None, :]
        offset = float((pressure * (tx * x + ty * y)).sum() / total)
        if self.curvatures is None:
            return Moved(way, nan, offset, self.at_edge(grid, pressure, window))
        cx, cy = self.curvatures
        slope = tx * cx * x + ty * cy * y + tx * traction
        if self.strip is not None:
            heights = self.strip.sliding(load.stretch, (load.x, load.y))[i, j]
            dx, dy = np.gradient(heights, grid.hx, grid.hy)
            slope = slope - self.strip.slip * (tx * dx + ty * dy)
        force = float((pressure * slope).sum() * grid.cell_area)
        return Moved(way, force, offset, self.at_edge(grid, pressure, window))

    @staticmethod
    def at_edge(grid: CellGrid, pressure: Array, window: Window) -> bool:
        """Whether cells in contact, of a window, are the outermost of the grid."""
        i, j = np.nonzero(pressure > 0)
        if not i.size:
            return False
        first, last = (window.i0 + i.min(), window.j0 + j.min()), (window.i0 + i.max(), window.j0 + j.max())
        return bool(min(first) == 0 or last[0] == grid.nx - 1 or last[1] == grid.ny - 1)

    def groove(self, grid: CellGrid, uz: Array) -> Groove:
        """The groove of a surface that was displaced by plastic strain, (nx, ny) in m."""
        way = (grid.x - self.start[0]) * self.direction[0]
        along, order = uz[:, self.touched(grid.y, grid.hy)].mean(axis=1), np.argsort(way)
        across = uz[self.middle_column(grid)]
        way, along = way[order], along[order]
        peak = refined_peak(way, along)
        return Groove.of(way, along, self.steady(way), self.length, across=across, peak=peak)

    def touched(self, y: Array, hy: float) -> Mask:
        """Whether rows of cells with these centres touch a path along x."""
        found: Mask = np.abs(y - self.start[1]) <= hy / 2 * (1 + ROUNDING)
        return found

    def middle_column(self, grid: CellGrid) -> int:
        """The column of cells in the middle of the steady part."""
        middle = (RUN_IN * self.radius + self.length - RUN_OUT * self.radius) / 2
        return int(np.abs(grid.x - (self.start[0] + self.direction[0] * middle)).argmin())

    def pass_end(
        self, grid: CellGrid, cycle: int, *, uz: Array, added: Array, window: Window, rows: Sequence[Row]
    ) -> PassEnd:
        """What a pass leaves. uz: by plastic strain, (nx, ny) in m; added: accumulated plastic strain of the
        pass on a box, (n_layers, nx, ny); rows: of the history so far.
        """
        of_pass = [row for row in rows if row.cycle == cycle and row.moved is not None]
        if not self.along_x:
            drive, rolling = self._driven(of_pass) if self.plane else (nan, nan)
            strain = float(added.max(initial=0.0))
            return PassEnd(cycle, self.sense(of_pass), strain=strain, drive=drive, rolling=rolling)
        way = (grid.x[window.slices[0]] - self.start[0]) * self.direction[0]
        inside, found = self.steady(way), self.groove(grid, uz)
        strain = float(added[:, inside].max(initial=0.0))
        heights = found.at_start, found.at_end, found.beside
        return PassEnd(cycle, self.sense(of_pass), found.middle, *heights, strain, *self._driven(of_pass))

    def sense(self, rows: Sequence[Row]) -> int:
        """1 of the rows of a pass from start to end, -1 of one back."""
        ways = [row.moved.way for row in rows if row.moved is not None]
        return 1 if ways[-1] >= ways[0] else -1

    def rolling(self, rows: Sequence[Row]) -> float:
        """The force of the pressure against the motion over the normal force in the steady part of the last
        pass.
        """
        of_pass = [row for row in rows if row.cycle == rows[-1].cycle and row.moved is not None]
        if not of_pass:
            return nan
        return self.sense(of_pass) * self._driven(of_pass)[1]

    def _driven(self, rows: Sequence[Row]) -> tuple[float, float]:
        """(mean driving force in N, the part of the pressure over the normal force) over the steady part."""
        found = [
            (row.moved.force, row.moved.force / row.force - self.sense(rows) * row.friction)
            for row in rows
            if row.moved is not None and row.force > 0 and self.steady(np.array(row.moved.way))
        ]
        if not found:
            return nan, nan
        drive, ratio = np.mean(found, axis=0)
        return float(drive), float(ratio)
