# SPDX-License-Identifier: MIT
"""The coefficient of friction at the cells of a grid."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from sam.scene import Scene

if TYPE_CHECKING:
    from sam.grid.cells import CellGrid

Coefficient = float | np.ndarray
"""A number, or one for each cell, (nx, ny)."""


def coefficient_on(scene: Scene, grid: CellGrid) -> Coefficient:
    """What a scene gives: a number, or a map at the cells. With a chemical film the low one, as long as it is whole."""
    friction = scene.friction
    if friction is None:
        return 0.0
    if friction.law == "map":
        if friction.path.cells != (grid.nx, grid.ny):
            raise ValueError(f"{friction.path!r} is no map of {grid.nx} x {grid.ny} cells")
        return friction.path.values
    return friction.low if friction.film else friction.coefficient


def most_friction(scene: Scene) -> Coefficient | None:
    """The coefficient where a chemical film has failed everywhere; None without one: then the scene's holds."""
    return scene.friction.high if scene.friction is not None and scene.friction.film else None
