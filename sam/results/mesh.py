# SPDX-License-Identifier: MIT
"""The surface and the plane y = 0 as one mesh, for ParaView and pyvista."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sam.arrays import Array
from sam.contact.stress import von_mises
from sam.grid.cells import CellGrid
from sam.results.snapshots import Snapshot
from sam.scene import FieldMesh


def field_mesh(grid: CellGrid, snapshot: Snapshot, height: Array | None = None) -> FieldMesh:
    """The mesh of a state: stress and strain at the nodes of the plane, pressure in the cells of the surface.

    With friction the cells also have the traction and the local coefficient, of a rough body its heights,
    (nx, ny) in m.
    """
    xs, ys = (np.append(c - h / 2, c[-1] + h / 2) for c, h in ((grid.x, grid.hx), (grid.y, grid.hy)))
    surface = np.stack([*np.meshgrid(xs, ys, indexing="ij"), np.zeros((len(xs), len(ys)))], axis=-1).reshape(
        -1, 3
    )
    x, z = np.meshgrid(grid.x, grid.depths, indexing="ij")
    plane = np.stack([x, 0 * x, z], axis=-1).reshape(-1, 3)

    def quads(n: int, m: int, first: int) -> NDArray[np.int_]:
        """Node numbers of n - 1 x m - 1 quadrilaterals."""
        node = first + np.arange(n * m).reshape(n, m)
        return np.stack([node[:-1, :-1], node[1:, :-1], node[1:, 1:], node[:-1, 1:]], axis=-1).reshape(-1, 4)

    def on_plane(field: Array) -> Array:
        """(..., nz, nx, rows) as (nodes, ...), not a number on the surface."""
        values = np.moveaxis(field.mean(axis=-1).swapaxes(-1, -2), (-2, -1), (0, 1))
        values = values.reshape(-1, *values.shape[2:])
        return np.concatenate([np.full((len(surface), *values.shape[1:]), np.nan), values])

    def on_surface(field: Array) -> Array:
        """(nx, ny) as (cells,), not a number in the plane."""
        return np.append(field.ravel(), np.full(len(cells) - field.size, np.nan))

    cells = np.vstack([quads(len(xs), len(ys), 0), quads(*x.shape, len(surface))])
    on_cells = {"p_Pa": snapshot.contact.pressure}
    if snapshot.sliding is not None:
        on_cells |= {"qx_Pa": snapshot.sliding.traction, "friction": snapshot.local_friction}
    if height is not None:
        on_cells["height_m"] = height
    if snapshot.worn is not None:
        on_cells["worn_m"] = snapshot.worn
    return FieldMesh(
        points=np.vstack([surface, plane]),
        cells={"quad": cells},
        point_data={
            "stress_Pa": on_plane(snapshot.stress),
            "mises_Pa": on_plane(von_mises(snapshot.in_plane)[..., None]),
            "plastic_strain": on_plane(snapshot.strain),
            "peeq": on_plane(snapshot.peeq),
        },
        cell_data={name: on_surface(field) for name, field in on_cells.items()},
    )
