# SPDX-License-Identifier: MIT
"""The tables and quantities of a counter-body that moves: along the track, across it, and of its passes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from sam.arrays import Array
from sam.contact.stress import von_mises
from sam.grid.cells import CellGrid
from sam.moving.track import Track
from sam.results.history import CycleEnd, PassEnd, Row
from sam.results.snapshots import Snapshot
from sam.scene.groove import passes_to_steady
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
from sam.surface_state import TribofilmState, Visits, bins_of_visits

XX, YY, XZ = 0, 1, 4  # of the order 11 22 33 23 13 12
Tables = dict[str, dict[str, Any]]


@dataclass(frozen=True)
class Solved:
    """What the tables are made of: rows of the history, what the passes and the cycles leave, the last state,
    and the visits of a film.
    """

    last: Snapshot
    rows: Sequence[Row]
    passes: Sequence[PassEnd] = ()
    ends: Sequence[CycleEnd] = ()
    film: TribofilmState | None = None


def path_tables(track: Track, grid: CellGrid, found: Solved) -> Tables:
    """The tables track and cross of a body that has yielded below a path along x, passes, and visits of a
    film; none of an elastic body.
    """
    last, passes = found.last, found.passes
    tables: Tables = {"passes": _passes(passes)} if passes else {}
    worn = last.worn is not None
    if passes and (worn or found.film is not None):
        tables["passes"] |= _surface_of_passes(track, found)
    if found.film is not None and found.film.visits is not None:
        tables["visits"] = _visits(track, found.film.visits)
    if track.along_x and last.box is not None:
        tables |= {"track": _track(track, grid, last), "cross": _cross(track, grid, last)}
    return tables


def path_quantities(track: Track, grid: CellGrid, found: Solved) -> dict[str, float | None]:
    """Every name of PATH_QUANTITIES: of the track that the last pass leaves."""
    last, passes = found.last, found.passes
    values: dict[str, float | None] = {"rolling_coefficient": track.rolling(found.rows)}
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
            "passes_to_steady": passes_to_steady([each.strain for each in passes]),
        }
    return {
        name: None if (value := values.get(name)) is None or np.isnan(value) else float(value)
        for name in PATH_QUANTITIES
    }


def _passes(passes: Sequence[PassEnd]) -> dict[str, Any]:
    values = [
        (
            each.cycle,
            each.direction,
            each.depth,
            each.at_start,
            each.at_end,
            each.beside,
            each.strain,
            each.drive,
            each.rolling,
        )
        for each in passes
    ]
    return {name: [value[k] for value in values] for k, name in enumerate(PASSES)}


def _surface_of_passes(track: Track, found: Solved) -> dict[str, Any]:
    """What friction and wear did in each pass: work of the driving force, means over the way at full load."""
    ends = {end.cycle: end.wear_of_cycle for end in found.ends if end.worn is not None}
    table: dict[str, list[float | None]] = {name: [] for name in OF_PASSES}
    for each in found.passes:
        loaded = [row for row in found.rows if row.cycle == each.cycle and row.force > 0]
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
    """How many cells were out of contact for how long, up to each way; bins that nothing fell in before the
    first are left out.
    """
    ways, growth = bins_of_visits(track.period), track.growth
    first = int(np.flatnonzero(visits.counts)[0]) if visits.counts.any() else len(ways) - 1
    count = len(ways) - first
    unknown = np.full(len(ways), np.nan)
    columns = (
        ways,
        unknown if growth is None else ways / growth.speed,
        unknown if growth is None else growth.rate * np.sqrt(ways),
        visits.counts.astype(int),
    )
    return {name: values[-count:] for name, values in zip(VISITS, columns, strict=True)}


def _track(track: Track, grid: CellGrid, last: Snapshot) -> dict[str, Any]:
    """Along the path in the rows of cells that touch it; stresses of the unloaded body, in the uppermost
    layer and in that of the largest strain of the steady part.
    """
    box, x = last.box, grid.x
    assert box is not None, "asked for of bodies that have yielded"
    own, rows = _inside(x, box.x), track.touched(grid.y, grid.hy)
    across = track.touched(_centres(box.y), grid.hy)
    way = (x - track.start[0]) * track.direction[0]
    steady = track.steady(way)
    peeq, stress = np.zeros(grid.nx), np.full((2, 3, grid.nx), np.nan)
    peeq[own] = box.peeq.max(axis=(0, 2))
    counted = box.peeq[:, steady[own]] if steady.any() else box.peeq
    layer = int(counted.max(axis=(1, 2)).argmax())
    if last.state == UNLOADED:
        for row, k in enumerate((0, layer)):
            stress[row][:, own] = box.stress[[XX, YY, XZ], k][..., across].mean(axis=-1)
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
    found: Array = (faces[1:] + faces[:-1]) / 2
    return found


def _inside(centres: Array, faces: Array) -> Any:
    """Which cells of the grid lie between the outer faces of a box."""
    return (centres > faces[0]) & (centres < faces[-1])
