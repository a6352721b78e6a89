# SPDX-License-Identifier: MIT
"""Bookkeeping of the wear over the cycles: what went, what the smoothing made of it, what stays under a roof."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from sam.wear.depth import Worn


@dataclass(frozen=True)
class Ledger:
    """Wear so far on the whole grid.

    cell_area: hx hy in m2; depth: (nx, ny) in m, sum over the cycles of what was removed. For each cycle: volumes, in m3,
    removed; raw_volumes: what tore, before smoothing; roofed_volumes: above the limit under a sound roof, which stays;
    bottom_columns: how many tore down to the deepest face; residuals: of the remap, see `sam.wear.remap.closing_residual`.
    """

    cell_area: float
    depth: np.ndarray
    volumes: tuple[float, ...] = ()
    raw_volumes: tuple[float, ...] = ()
    roofed_volumes: tuple[float, ...] = ()
    bottom_columns: tuple[int, ...] = ()
    residuals: tuple[float, ...] = ()

    @classmethod
    def empty(cls, shape: tuple[int, int], hx: float, hy: float) -> Ledger:
        """Before the first cycle; hx, hy: cell in m."""
        return cls(hx * hy, np.zeros(shape))

    def with_cycle(self, raw: Worn, depth: np.ndarray, residual: float) -> Ledger:
        """One cycle more: what tore, and the depth (nx, ny) in m that was removed, both on the whole grid.

        residual: of the remap of the material, relative.
        """
        return replace(
            self,
            depth=self.depth + depth,
            volumes=(*self.volumes, self._volume(depth)),
            raw_volumes=(*self.raw_volumes, self._volume(raw.depth)),
            roofed_volumes=(*self.roofed_volumes, self._volume(raw.roofed)),
            bottom_columns=(*self.bottom_columns, int(raw.at_bottom.sum())),
            residuals=(*self.residuals, residual),
        )

    def _volume(self, thickness: np.ndarray) -> float:
        return float(self.cell_area * thickness.sum())

    @property
    def volume(self) -> float:
        """Removed so far, in m3."""
        return sum(self.volumes)

    @property
    def raw_volume(self) -> float:
        """Torn so far, in m3; what smoothing left to tear again counts again."""
        return sum(self.raw_volumes)

    def imbalance(self, original: np.ndarray, current: np.ndarray) -> float:
        """Volume minus hx hy sum(original - current), in m3; heights (nx, ny) in m, both without displacement."""
        return self.volume - self._volume(original - current)
