# SPDX-License-Identifier: MIT
"""Fields of the states on the surface, in the plane y = 0 and in the box of plastic cells, on their grids;
those of the first state on the surface and in the plane also as one mesh.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from sam.arrays import Array
from sam.contact.stress import von_mises
from sam.grid.cells import CellGrid
from sam.results.history import CycleEnd
from sam.results.snapshots import Snapshot
from sam.scene import FieldMesh, GridFields


def field_mesh(grid: CellGrid, snapshot: Snapshot, height: Array | None = None) -> FieldMesh:
    """The mesh of a state: stress and strain in the plane, pressure in the cells of the surface."""
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
            **{name: on_plane(field) for name, field in snapshot.repeated.items()},
        },
        cell_data={name: on_surface(field) for name, field in on_cells.items()},
    )


def state_grids(
    grid: CellGrid, snapshot: Snapshot, share: float, height: Array | None = None
) -> dict[str, GridFields]:
    """The fields of a state: on the "surface", in the "plane" and, of one that yields, in the "body"."""
    strained = {"plastic_strain": snapshot.strain, "peeq": snapshot.peeq} if snapshot.box else {}
    means = {"stress_Pa": snapshot.stress, **strained, **snapshot.repeated}
    in_plane = {name: field.mean(axis=-1) for name, field in means.items()}
    in_plane["mises_Pa"] = von_mises(snapshot.in_plane)
    points = {name: field.swapaxes(-1, -2)[..., None, :] for name, field in in_plane.items()}
    parts = {
        "surface": _surface(grid, snapshot, share, height),
        "plane": GridFields(grid.x, np.zeros(1), grid.depths, points),
    }
    if (box := snapshot.box) is not None:
        fields = {
            "stress_Pa": box.stress,
            "mises_Pa": von_mises(box.stress),
            "plastic_strain": box.strain,
            "peeq": box.peeq,
            **box.repeated,
        }
        cells = {name: np.moveaxis(field, -3, -1) for name, field in fields.items()}
        parts["body"] = GridFields(box.x, box.y, box.z, cell_data=cells)
    return parts


def cycle_grids(
    grid: CellGrid, ends: Sequence[CycleEnd], height: Array | None = None
) -> dict[str, dict[str, GridFields]]:
    """The unloaded surface after each cycle that can wear it, as "cycle-1" and so on."""
    return {
        f"cycle-{end.cycle}": {
            "surface": _on_cells(grid, {"uz_m": end.moved, "worn_m": end.worn, "height_m": height})
        }
        for end in ends
        if end.moved is not None
    }


def _surface(grid: CellGrid, snapshot: Snapshot, share: float, height: Array | None) -> GridFields:
    """The cells of the surface; friction is zero out of contact, a gap that is not everywhere is left out."""
    contact, sliding, coated = snapshot.contact, snapshot.sliding, snapshot.coated
    cells: dict[str, Array | None] = {"p_Pa": contact.pressure, "height_m": height, "worn_m": snapshot.worn}
    if np.isfinite(contact.gap).all():
        cells["gap_m"] = contact.gap
    if sliding is not None:
        cells |= {"qx_Pa": sliding.traction, "friction": np.nan_to_num(snapshot.local_friction)}
    beyond = [sliding.uz] if sliding is not None else []
    beyond += [coated.counter_uz] if coated is not None else []
    if not any(moved.any() for moved in beyond):  # those are known along y = 0 alone
        whole = 1.0 if coated is not None else share
        cells["uz_m"] = whole * contact.displacement + snapshot.residual_displacement
    return _on_cells(grid, cells)


def _on_cells(grid: CellGrid, cells: Mapping[str, Array | None]) -> GridFields:
    """Fields (nx, ny) of the surface but for None; displacements at nodes as means of the cells."""
    points, moved = {}, cells.get("uz_m")
    if moved is not None:
        around = np.pad(moved, 1, mode="edge")
        uz = (around[1:, 1:] + around[1:, :-1] + around[:-1, 1:] + around[:-1, :-1]) / 4
        points["normal_displacement_m"] = np.stack([0 * uz, 0 * uz, uz])[..., None]
    xs, ys = (np.append(c - h / 2, c[-1] + h / 2) for c, h in ((grid.x, grid.hx), (grid.y, grid.hy)))
    known = {name: field[..., None] for name, field in cells.items() if field is not None}
    return GridFields(xs, ys, np.zeros(1), points, known)
