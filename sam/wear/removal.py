# SPDX-License-Identifier: MIT
"""Wear at the end of a cycle: strained material is removed, and what was below it moves
up. Paper section 5.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from sam.arrays import Array
from sam.grid.cells import Window
from sam.surface_state import WearState
from sam.wear.depth import StrainLimits, Worn, worn_depth
from sam.wear.remap import closing_residual, remapped
from sam.wear.smoothing import smoothed

T = TypeVar("T", bound=np.generic)


@dataclass(frozen=True)
class WearLaw:
    """Wear of a grid of `shape` (nx, ny) cells with sides hx, hy in m.

    limits: of the accumulated plastic strain; interpolate: see `worn_depth`; window, order: of `smoothed`.
    """

    shape: tuple[int, int]
    hx: float
    hy: float
    limits: StrainLimits
    interpolate: bool
    window: int
    order: int

    def fresh(self) -> WearState:
        """The surface before the first cycle."""
        return WearState.empty(self.shape, self.hx, self.hy)

    def margin(self, peeq: Array, faces: Array) -> float:
        """1 less the largest plastic strain over its limit, see `sam.surface_state.Wear`."""
        return 1.0 - float((peeq / self.limits((faces[:-1] + faces[1:]) / 2)[:, None, None]).max())

    def removed(
        self, state: WearState, fields: dict[str, Array], faces: Array, window: Window, *, peeq: Array
    ) -> tuple[WearState, dict[str, Array]]:
        """Wear after one more cycle, and the fields of the material below the new surface; see
        `sam.surface_state.Wear`.
        """
        raw = worn_depth(peeq, faces, self.limits, self.interpolate)
        depth, roofed = (self._on_grid(each, window) for each in (raw.depth, raw.roofed))
        whole = Worn(depth, roofed, self._on_grid(raw.at_bottom, window))
        depth = smoothed(whole.depth, self.window, self.order, all_removed=True)
        below, worst = {}, 0.0
        for name, field in fields.items():
            below[name], gone = remapped(field, faces, depth[window.slices])
            worst = max(worst, closing_residual(field, below[name], gone, faces))
        return with_cycle(state, whole, depth, worst), below

    def _on_grid(self, field: NDArray[T], window: Window) -> NDArray[T]:
        """A field of the window on the whole grid, zero outside of it."""
        out: NDArray[T] = np.zeros(self.shape, dtype=field.dtype)
        out[window.slices] = field
        return out


def with_cycle(state: WearState, raw: Worn, depth: Array, residual: float) -> WearState:
    """The wear state after one more cycle.

    raw: what the strain removes, before smoothing; depth: (nx, ny) in m that was removed, both on the whole
    grid; residual: of the remap, relative. The depth stays the same array where nothing is removed: what was
    computed for the surface is still right.
    """
    return replace(
        state,
        depth=state.depth + depth if depth.any() else state.depth,
        volumes=(*state.volumes, state.volume_of(depth)),
        raw_volumes=(*state.raw_volumes, state.volume_of(raw.depth)),
        roofed_volumes=(*state.roofed_volumes, state.volume_of(raw.roofed)),
        bottom_columns=(*state.bottom_columns, int(raw.at_bottom.sum())),
        residuals=(*state.residuals, residual),
    )
