# SPDX-License-Identifier: MIT
"""The table [wear] of a scene: which plastic strain removes material, and how the scar is smoothed."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from math import isfinite
from typing import Any

from sam.scene.section import Conflict, Section
from sam.scene.units import Order, SmoothingWindow, StrainLimit


class Wear(Section):
    """Wear removes material after each cycle where its plastic strain, from the surface downwards, is above a
    limit.

    strain_limit: accumulated plastic strain beyond which it is removed (inf: never); strain_limit_layer:
    another one inside of body.plasticity.layer_thickness. smoothing_window: odd number of cells of a
    Savitzky-Golay filter of the worn depth, 0: none; smoothing_order: of its polynomials. interpolate: depths
    between the layers by linear interpolation of the strain; else whole layers are removed. Bosman & Schipper
    2011, section 5.
    """

    strain_limit: StrainLimit
    strain_limit_layer: StrainLimit | None = None
    smoothing_window: SmoothingWindow = 5
    smoothing_order: Order = 2
    interpolate: bool = True

    @property
    def removes(self) -> bool:
        """Whether any strain removes material."""
        return isfinite(self.strain_limit) or (
            self.strain_limit_layer is not None and isfinite(self.strain_limit_layer)
        )

    @classmethod
    def conflicts(cls, given: Mapping[str, Any]) -> Iterator[Conflict]:
        """A smoothing window without a middle."""
        window = given.get("smoothing_window")
        if isinstance(window, int) and window > 0 and window % 2 == 0:
            yield "smoothing_window", "an odd number of cells, or 0 for none"

    def excesses(self) -> Iterator[Conflict]:
        """A polynomial that the window does not determine."""
        if self.smoothing_window and not self.smoothing_order < self.smoothing_window:
            yield "smoothing_order", f"less than smoothing_window, {self.smoothing_window}"
