# SPDX-License-Identifier: MIT
"""The tables axis, line, plane and cut of the states, and what to change when a solve ends badly."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from sam.contact.stress import von_mises
from sam.grid.cells import CellGrid
from sam.results.snapshots import Cut, Snapshot
from sam.scene import Status
from sam.scene.remedies import either
from sam.scene.result import CUT, LINE, STRESSES


@dataclass(frozen=True)
class Remedies:
    """What may be changed of a scene, in words; empty what may not. slower: less friction."""

    finer_cells: str
    smaller_patch: str
    larger_patch: str
    less_load: str
    slower: str
    more_steps: str
    looser: str


def advice(remedies: Remedies, status: Status, larger: str = "") -> str:
    """What to change, in words; empty for a converged solve; larger: how to enlarge the sides of the grid."""
    can = remedies
    match status:
        case Status.NOT_CONVERGED:
            what = either(can.finer_cells, can.looser, can.slower)
            return f"the contact iteration stopped above its tolerance: {what}"
        case Status.CONTACT_AT_GRID_EDGE:
            what = either(larger or can.larger_patch, can.less_load)
            return f"the contact touches the edge of the grid: {what}"
        case Status.UNDER_RESOLVED:
            return f"too few cells in the contact: {either(can.finer_cells, can.smaller_patch)}"
        case Status.PLASTIC_ZONE_AT_GRID_EDGE:
            return f"the plastic zone touches the edge of the grid: {either(larger, can.less_load)}"
        case Status.STEP_CUT_LIMIT:
            what = either(can.more_steps, can.looser, can.less_load)
            return f"a load step did not converge however often it was halved: {what}"
    return status.advice


Table = dict[str, Any]


def state_tables(grid: CellGrid, snapshots: Sequence[Snapshot], share: float) -> dict[str, Table]:
    """The tables axis, line and plane, and cut where a state has one; share: see `ElasticPair.share`."""
    parts = [_tables_of(grid, snapshot, share) for snapshot in snapshots]
    merged: dict[str, Table] = {
        name: {column: np.concatenate([part[name][column] for part in parts]) for column in parts[0][name]}
        for name in parts[0]
    }
    for table in merged.values():
        table["state"] = table["state"].tolist()
    for snapshot in snapshots:
        if snapshot.cut is not None:
            merged["cut"] = _cut_table(snapshot.state, snapshot.cut)
    return merged


def _tables_of(grid: CellGrid, snapshot: Snapshot, share: float) -> dict[str, Table]:
    """The tables of one state."""
    rows = grid.axis_rows.slices[1]
    plane, peeq = snapshot.in_plane, snapshot.peeq.mean(axis=-1)
    axis = plane[:, :, grid.axis_columns].mean(axis=-1)
    x, z = np.meshgrid(grid.x, grid.depths, indexing="ij")
    out: dict[str, Table] = {
        "axis": {
            "z_m": grid.depths,
            "peeq": peeq[:, grid.axis_columns].mean(axis=-1),
            "mises_Pa": von_mises(axis),
            **dict(zip(STRESSES, axis, strict=True)),
        },
        "line": _line(grid, snapshot, share, rows),
        "plane": {
            "x_m": x.ravel(),
            "z_m": z.ravel(),
            "peeq": peeq.T.ravel(),
            "mises_Pa": von_mises(plane).T.ravel(),
        },
    }
    return {name: {"state": [snapshot.state] * len(next(iter(t.values())))} | t for name, t in out.items()}


def _line(grid: CellGrid, snapshot: Snapshot, share: float, rows: slice) -> Table:
    """The surface along x in y = 0, the mean of the rows of cells that touch it."""
    contact, sliding = snapshot.contact, snapshot.sliding
    p = contact.pressure[:, rows].mean(axis=1)
    gap = np.where(np.isfinite(contact.gap), contact.gap, np.nan)  # NaN: no counter-body opposite
    if snapshot.coated is None:
        uz = share * contact.displacement[:, rows] + snapshot.residual_displacement[:, rows]
    else:
        uz = contact.displacement[:, rows] - snapshot.coated.counter_uz
    along_x = {}
    if sliding is not None:
        uz = uz + sliding.uz
        along_x = {"ux_m": sliding.ux.mean(axis=1), "plastic_shear_m": sliding.shear.mean(axis=1)}
    line = {
        "x_m": grid.x,
        "p_Pa": p,
        "qx_Pa": np.zeros_like(p) if sliding is None else sliding.traction[:, rows].mean(axis=1),
        "gap_m": gap[:, rows].mean(axis=1),
        "uz_m": uz.mean(axis=1),
    } | along_x
    return {name: line.get(name, np.full_like(p, np.nan)) for name in LINE if name != "state"}


def _cut_table(state: str, cut: Cut) -> Table:
    """The table cut: a row a point, z running first."""
    x, z = np.meshgrid(cut.x, cut.z, indexing="ij")
    columns: Table = {
        "state": [state] * x.size,
        "x_m": x.ravel(),
        "y_m": np.full(x.size, cut.y),
        "z_m": z.ravel(),
        "peeq": cut.peeq.T.ravel(),
        "mises_Pa": von_mises(cut.stress).T.ravel(),
        **{name: component.T.ravel() for name, component in zip(STRESSES, cut.stress, strict=True)},
    }
    return {name: columns[name] for name in CUT}
