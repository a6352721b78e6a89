# SPDX-License-Identifier: MIT
"""What the record of a rough scene has besides that of a smooth one: its surface table, and warnings."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from scipy import ndimage

from sam.arrays import Array
from sam.contact.fit import FEWEST_IN_SPOT
from sam.contact.normal import Contact
from sam.grid.cells import CellGrid
from sam.scene import Scene
from sam.scene.remedies import either, finer_cells, larger_patch, less_load
from sam.scene.result import SURFACE

if TYPE_CHECKING:
    from sam.record import Snapshot

WELL_RESOLVED = 4.0  # cells in the shortest wavelength; below it maxima depend on where the cells lie


def warnings_of(scene: Scene, grid: CellGrid, contact: Contact) -> tuple[str, ...]:
    """What a user should know about the peak, in words."""
    out, touching = [], contact.pressure > 0
    if scene.surface.kind != "file":
        cells = [short / h for short, h in zip(scene.surface.shortest, (grid.hx, grid.hy), strict=True)]
        if min(cells) < WELL_RESOLVED * (1 - 1e-6):
            out.append(
                f"{min(cells):.3g} cells in the shortest wavelength of the surface: with fewer than "
                f"{WELL_RESOLVED:g} the largest pressure depends on where the cells lie"
                f"{_then(finer_cells(scene))}"
            )
    if touching.any():
        spots, _ = ndimage.label(touching)
        top = np.unravel_index(contact.pressure.argmax(), touching.shape)
        count = int(np.count_nonzero(spots == spots[top]))
        if count < FEWEST_IN_SPOT:
            out.append(
                f"{count} cells in contact where the pressure is largest, {np.count_nonzero(touching)} "
                f"in all: with fewer than {FEWEST_IN_SPOT} p_max_Pa is off by some percent"
                f"{_then(finer_cells(scene))}"
            )
    if touching[[0, -1], :].any() or touching[:, [0, -1]].any():
        out.append(
            f"the contact touches the edge of the grid, where the half-space is cut{_at_edge(scene, grid)}"
        )
    return tuple(out)


def _then(remedy: str) -> str:
    """A remedy behind a warning, if there is one."""
    return f": {remedy}" if remedy else ""


def _at_edge(scene: Scene, grid: CellGrid) -> str:
    """What becomes of the edge, and what to change."""
    if not any(grid.border):  # the heights fall off already, and all cells count
        words = f' although the heights fall off there (grid.border = "{scene.grid.border}")'
        return f"{words}: {either(larger_patch(scene), less_load(scene))}"
    bx, by = grid.border
    return (
        f": the outer {bx} x {by} cells do not count for p_max_Pa and mises_max_Pa; "
        'grid.border = "relief" lets the heights fall off'
    )


def surface_table(heights: Array, grid: CellGrid, snapshots: Sequence[Snapshot]) -> dict:
    """The table surface: for each state a row a cell, y running first. heights: the original ones."""
    x, y = np.meshgrid(grid.x, grid.y, indexing="ij")
    parts = [
        {
            "state": np.full(x.size, each.state),
            "x_m": x.ravel(),
            "y_m": y.ravel(),
            "height_m": heights.ravel(),
            "p_Pa": each.contact.pressure.ravel(),
            "worn_m": np.zeros(x.size) if each.worn is None else each.worn.ravel(),
            "friction": each.local_friction.ravel(),
        }
        for each in snapshots
    ]
    table = {name: np.concatenate([part[name] for part in parts]) for name in SURFACE}
    return table | {"state": table["state"].tolist()}
