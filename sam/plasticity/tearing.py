# SPDX-License-Identifier: MIT
"""What is torn off after a cycle: from the plastic strain of the box to the worn surface and the material below it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sam.grid.cells import CellGrid, Window
from sam.plasticity.extent import Extent
from sam.plasticity.step import State
from sam.scene import Scene
from sam.wear.depth import Worn, limit_by_depth, worn_depth
from sam.wear.ledger import Ledger
from sam.wear.remap import closing_residual, remapped
from sam.wear.smoothing import smoothed


@dataclass(frozen=True)
class Torn:
    """ledger: with this cycle; strain, alpha: of the box below the new surface, see `State`."""

    ledger: Ledger
    strain: np.ndarray
    alpha: np.ndarray


def torn_off(scene: Scene, grid: CellGrid, extent: Extent, state: State, ledger: Ledger) -> Torn:
    """Wear of an unloaded state of the box. Paper section 5."""
    wear, window = scene.wear, extent.window
    faces = grid.faces[: extent.layers + 1]
    limits = limit_by_depth(wear, scene.body.plasticity.layer_thickness)
    raw = worn_depth(state.alpha, faces, limits, wear.interpolate)
    whole = Worn(*(_on_grid(each, window, grid) for each in raw))
    depth = smoothed(whole.depth, wear.smoothing_window, wear.smoothing_order, all_torn=True)
    below = remapped(state.strain, state.alpha, faces, depth[window.slices])
    residual = max(
        closing_residual(state.strain, below.strain, below.removed_strain, faces),
        closing_residual(state.alpha, below.alpha, below.removed_alpha, faces),
    )
    return Torn(ledger.with_cycle(whole, depth, residual), below.strain, below.alpha)


def _on_grid(field: np.ndarray, window: Window, grid: CellGrid) -> np.ndarray:
    """A field of the window on the full grid, zero outside."""
    out = np.zeros((grid.nx, grid.ny), dtype=field.dtype)
    out[window.slices] = field
    return out
