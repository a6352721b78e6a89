# SPDX-License-Identifier: MIT
"""The table [grid] of a scene: cells and output depths of the semi-analytical model."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from itertools import pairwise
from typing import Annotated, Any, Literal

from pydantic import AfterValidator

from sam.scene.inputs import list_of, refused
from sam.scene.section import Conflict, Section
from sam.scene.units import Cells, Count, Depth, Length

MOST_DEPTHS = 1001  # entries of a list; the layers of a box cost 36 n^2 coefficients for each wave number


def _ascending(depths: tuple[float, ...]) -> tuple[float, ...]:
    if any(lower >= upper for lower, upper in pairwise(depths)):
        raise refused("depths in strictly ascending order")
    return depths


class Grid(Section):
    """The cells and output depths of the semi-analytical model. cells: (nx, ny); extent: (Lx, Ly) in m.

    Cells alone take the default extent, an extent alone the default number of cells. depths: z in m where
    stresses are returned, with plasticity the faces of the layers, the first at 0; or `layers` equal layers
    down to `depth`. border: of a rough patch; "relief": its heights fall off there, so that the contact ends
    before the patch does.
    """

    cells: Annotated[tuple[Cells, Cells], list_of(2, 2)] | None = None
    extent: Annotated[tuple[Length, Length], list_of(2, 2)] | None = None
    depths: Annotated[tuple[Depth, ...], AfterValidator(_ascending), list_of(1, MOST_DEPTHS)] | None = None
    layers: Count | None = None
    depth: Length | None = None
    border: Literal["free", "relief"] = "free"

    @classmethod
    def conflicts(cls, given: Mapping[str, Any]) -> Iterator[Conflict]:
        """Depths together with layers, or layers without a depth."""
        if "depths" in given and ("layers" in given or "depth" in given):
            yield "depths", "either depths, or layers with depth, not both"
        elif ("layers" in given) != ("depth" in given):
            yield ("depth" if "layers" in given else "layers"), "required: layers and depth together"
