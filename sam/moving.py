# SPDX-License-Identifier: MIT
"""The track of a counter-body that moves over the surface: what a step and a pass say of it.

The gap moves, the body stays: g(x, y; s) = P(x - s) - c(x - k s) of the profile P, the heights c of the
counter-body and its slip k. With contact wherever g + u_z = delta, the work of the pressure over a small
motion is F d(delta) + ds int p (dP/dx - k dc/dx): the second part is the force that drives the counter-body
against the slope of the groove and of summits, to which friction adds int q.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields
from math import nan
from typing import Any

import numpy as np

from sam.arrays import Array, Mask
from sam.contact.operators import von_mises
from sam.grid.cells import CellGrid, Window
from sam.results.history import History, Moved, PassEnd, Row, Snapshot
from sam.results.tables import refined_peak
from sam.scene.result import (
    CROSS,
    OF_PASSES,
    PASSES,
    PATH_QUANTITIES,
    STRESSES,
    TRACK,
    TRACK_WORN,
    UNLOADED,
    VISITS,
)
from sam.scene.surface import Strip
from sam.scene.verdict import RUN_IN, RUN_OUT, Groove, passes_to_steady, steady_part
from sam.schedule import Load
from sam.tribofilm.state import TribofilmState, Visits, bins_of_visits

ROUNDING = 1e-6  # of a centre of cells, in cells
FINE = 8  # steps in the shortest wave of a counter-surface; half as many at least, see `Strip`
LONG = 0.5  # contact radii: longer steps leave 3 % of the groove and 13 % of the plastic strain, and more


@dataclass(frozen=True)
class Track:
    """The track of a scene, in m: start, end; radius: of the contact along x; curvatures: of the
    counter-body; step; plane: below one every place is steady; carries: share of the motion of the
    pressure; strip: of a rough counter-body; period: from pass to pass; returns: even passes go
    back; growth_rate: of a film out of contact in 1/sqrt(m), or None; speed in m/s.
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
    growth_rate: float | None = None
    speed: float = nan

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
        out, share = [], self.step / self.radius
        waves = 0.0 if self.strip is None else self.strip.share_of_wave(self.step / self.length)
        if waves > (1 + ROUNDING) / FINE:
            out.append(
                f"loading.path: in a step the counter-surface slides {waves:.2g} of its shortest wave: above "
                f"1/{FINE} summits jump over places"
            )
        if not self.plane and share > LONG * (1 + ROUNDING):
            out.append(
                f"loading.path: steps of {share:.2g} contact radii leave several percent of the groove and "
                "more of the plastic strain: a quarter of the radius leaves 1 % of the groove"
            )
        return tuple(out)

    def place(self, load: Load) -> str:
        """Where a load is, in words."""
        return f"the counter-body is at x = {load.x:.4g} m, {self.way(load):.4g} m after its start"

    def steady(self, way: Array) -> Mask:
        """Whether places at these distances from the start in m lie in the steady part."""
        if self.plane:
            return np.ones(np.shape(way), dtype=bool)
        return steady_part(way, self.radius, self.length)

    def carried(self, grid: CellGrid, pressure: Array, before: Load, after: Load) -> Array | None:
        """A pressure (nx, ny) moved with the counter-body by whole cells; None where nothing is left."""
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
        in_x = first[0] == 0 or last[0] == grid.nx - 1
        return bool(in_x or (not grid.line and (first[1] == 0 or last[1] == grid.ny - 1)))

    def groove(self, grid: CellGrid, uz: Array) -> Groove:
        """The groove of a surface that was displaced by plastic strain, (nx, ny) in m."""
        way = (grid.x - self.start[0]) * self.direction[0]
        along, order = uz[:, self.touched(grid.y, grid.hy)].mean(axis=1), np.argsort(way)
        across = uz[self.middle_column(grid)] if not grid.line else np.full(1, nan)
        way, along = way[order], along[order]
        peak = refined_peak(way, along)
        return Groove.of(way, along, self.steady(way), self.length, across=across, peak=peak)

    def touched(self, y: Array, hy: float) -> Mask:
        """Whether rows of cells with these centres touch a path along x."""
        return np.abs(y - self.start[1]) <= hy / 2 * (1 + ROUNDING)

    def middle_column(self, grid: CellGrid) -> int:
        """The column of cells in the middle of the steady part."""
        middle = (RUN_IN * self.radius + self.length - RUN_OUT * self.radius) / 2
        return int(np.abs(grid.x - (self.start[0] + self.direction[0] * middle)).argmin())

    def pass_end(
        self, grid: CellGrid, cycle: int, *, uz: Array, added: Array, window: Window, rows: Sequence[Row]
    ) -> PassEnd:
        """What a pass leaves. uz: plastic, (nx, ny) in m; added: its strain, (n_layers, nx, ny) on a box."""
        of_pass = [row for row in rows if row.cycle == cycle and row.moved is not None]
        if not self.along_x:
            drive, rolling = self._driven(of_pass) if self.plane else (nan, nan)
            strain = float(added.max(initial=0.0))
            return PassEnd(cycle, self.sense(of_pass), strain=strain, drive=drive, rolling=rolling)
        way = (grid.x[window.slices[0]] - self.start[0]) * self.direction[0]
        inside, groove = self.steady(way), self.groove(grid, uz)
        strain = float(added[:, inside].max(initial=0.0))
        heights = groove.at_start, groove.at_end, groove.beside
        return PassEnd(cycle, self.sense(of_pass), groove.middle, *heights, strain, *self._driven(of_pass))

    def sense(self, rows: Sequence[Row]) -> int:
        """1 of the rows of a pass from start to end, -1 of one back."""
        ways = [row.moved.way for row in rows if row.moved is not None]
        return 1 if ways[-1] >= ways[0] else -1

    def rolling(self, rows: Sequence[Row]) -> float:
        """Force of the pressure against the motion over the normal force in the last steady part."""
        of_pass = [row for row in rows if row.cycle == rows[-1].cycle and row.moved is not None]
        if not of_pass:
            return nan
        return self.sense(of_pass) * self._driven(of_pass)[1]

    def _driven(self, rows: Sequence[Row]) -> tuple[float, float]:
        """(mean driving force in N, the part of the pressure over the normal force) over the steady part."""
        drives = [
            (row.moved.force, row.moved.force / row.force - self.sense(rows) * row.friction)
            for row in rows
            if row.moved is not None and row.force > 0 and self.steady(np.array(row.moved.way))
        ]
        if not drives:
            return nan, nan
        drive, ratio = np.mean(drives, axis=0)
        return float(drive), float(ratio)


XX, YY, XZ = 0, 1, 4  # of the order 11 22 33 23 13 12
Tables = dict[str, dict[str, Any]]


def path_tables(track: Track, grid: CellGrid, history: History, film: TribofilmState | None) -> Tables:
    """The tables of passes and visits of a film; track and cross of a body that yielded on a path in x."""
    last, passes = list(history.snapshots.values())[-1], history.passes
    of_pass, tables = zip(PASSES, fields(PassEnd), strict=True), Tables()
    if passes:
        tables["passes"] = {name: [getattr(end, each.name) for end in passes] for name, each in of_pass}
    worn = last.worn is not None
    if passes and (worn or film is not None):
        tables["passes"] |= _surface_of_passes(track, history)
    if film is not None and film.visits is not None:
        tables["visits"] = _visits(track, film.visits)
    if track.along_x and last.box is not None:
        tables |= {"track": _track(track, grid, last), "cross": _cross(track, grid, last)}
    return tables


def path_quantities(track: Track, grid: CellGrid, history: History) -> dict[str, float | None]:
    """Every name of PATH_QUANTITIES: of the track that the last pass leaves."""
    last, passes = list(history.snapshots.values())[-1], history.passes
    values: dict[str, float | None] = {"rolling_coefficient": track.rolling(history.rows)}
    if track.along_x and last.box is not None:
        groove = track.groove(grid, last.residual_displacement)
        values |= {
            "groove_depth_m": groove.depth,
            "groove_deepest_m": groove.deepest,
            "groove_deepest_x_m": track.start[0] + track.direction[0] * groove.deepest_at,
            "shoulder_start_m": groove.at_start,
            "shoulder_end_m": groove.at_end,
            "shoulder_side_m": groove.beside,
            "transient_length_m": groove.transient,
            "passes_to_steady": passes_to_steady([passed.strain for passed in passes]),
        }
    return {
        name: None if (value := values.get(name)) is None or np.isnan(value) else float(value)
        for name in PATH_QUANTITIES
    }


def _surface_of_passes(track: Track, history: History) -> dict[str, Any]:
    """What friction and wear did in each pass: work of the driving force, means over the way at full load."""
    ends = {end.cycle: end.wear_of_cycle for end in history.ends if end.worn is not None}
    table: dict[str, list[float | None]] = {name: [] for name in OF_PASSES}
    for each in history.passes:
        loaded = [row for row in history.rows if row.cycle == each.cycle and row.force > 0]
        at_full = {
            row.moved.way: row for row in loaded if row.moved is not None
        }  # the last one at each place
        of_pass = list(at_full.values())
        ways, drives = np.array([(way, row.moved.force) for way, row in at_full.items() if row.moved]).T
        protected = [row.protected for row in of_pass if row.protected is not None]
        values = (
            float(np.trapezoid(drives, ways)),
            float(np.mean([row.friction for row in of_pass])),
            float(np.mean(protected)) if protected else None,
            ends.get(each.cycle),
            None if each.cycle not in ends else ends[each.cycle] / track.length,
        )
        for name, value in zip(OF_PASSES, values, strict=True):
            table[name].append(value)
    return table


def _visits(track: Track, visits: Visits) -> dict[str, Any]:
    """How many cells were out of contact for how long, up to each way, from the first bin that is used."""
    ways, rate = bins_of_visits(track.period), track.growth_rate
    first = int(np.flatnonzero(visits.counts)[0]) if visits.counts.any() else len(ways) - 1
    count = len(ways) - first
    unknown = np.full(len(ways), np.nan)
    columns = (
        ways,
        unknown if rate is None else ways / track.speed,
        unknown if rate is None else rate * np.sqrt(ways),
        visits.counts.astype(int),
    )
    return {name: values[-count:] for name, values in zip(VISITS, columns, strict=True)}


def _track(track: Track, grid: CellGrid, last: Snapshot) -> dict[str, Any]:
    """Along the path, in the rows that touch it; unloaded stresses in the top and the most strained layer."""
    box, x = last.box, grid.x
    assert box is not None, "asked for of bodies that have yielded"
    inside, rows = _inside(x, box.x), track.touched(grid.y, grid.hy)
    across = track.touched(_centres(box.y), grid.hy)
    way = (x - track.start[0]) * track.direction[0]
    steady = track.steady(way)
    peeq, stress = np.zeros(grid.nx), np.full((2, 3, grid.nx), np.nan)
    peeq[inside] = box.peeq.max(axis=(0, 2))
    counted = box.peeq[:, steady[inside]] if steady.any() else box.peeq
    layer = int(counted.max(axis=(1, 2)).argmax())
    if last.state == UNLOADED:
        for row, k in enumerate((0, layer)):
            stress[row][:, inside] = box.stress[[XX, YY, XZ], k][..., across].mean(axis=-1)
    columns = {
        "x_m": x,
        "uz_m": last.residual_displacement[:, rows].mean(axis=1),
        "peeq_max": peeq,
        "steady": steady.astype(int),
        "top_z_m": np.full(grid.nx, _centres(box.z)[0]),
        "deep_z_m": np.full(grid.nx, _centres(box.z)[layer]),
    }
    for row, place in enumerate(("top", "deep")):
        for k, name in enumerate(("sxx", "syy", "sxz")):
            columns[f"{place}_{name}_Pa"] = stress[row, k]
    table = {name: columns[name] for name in TRACK}
    return table if last.worn is None else table | {TRACK_WORN: last.worn[:, rows].mean(axis=1)}


def _cross(track: Track, grid: CellGrid, last: Snapshot) -> dict[str, Any]:
    """The cells across the track in the middle of the steady part, z running first."""
    box, middle = last.box, track.middle_column(grid)
    assert box is not None, "asked for of bodies that have yielded"
    column = int(np.abs(_centres(box.x) - grid.x[middle]).argmin())
    y, z = np.meshgrid(_centres(box.y), _centres(box.z), indexing="ij")
    stress = box.stress[:, :, column] if last.state == UNLOADED else np.full_like(box.stress[:, :, 0], np.nan)
    surface = last.residual_displacement[middle, _inside(grid.y, box.y)]
    columns = {
        "y_m": y.ravel(),
        "z_m": z.ravel(),
        "uz_m": np.repeat(surface, z.shape[1]),
        "peeq": box.peeq[:, column].T.ravel(),
        "mises_Pa": von_mises(stress).T.ravel(),
        **{name: component.T.ravel() for name, component in zip(STRESSES, stress, strict=True)},
    }
    return {name: columns[name] for name in CROSS}


def _centres(faces: Array) -> Array:
    return (faces[1:] + faces[:-1]) / 2


def _inside(centres: Array, faces: Array) -> Any:
    """Which cells of the grid lie between the outer faces of a box."""
    return (centres > faces[0]) & (centres < faces[-1])
