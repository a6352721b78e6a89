# SPDX-License-Identifier: MIT
"""Planes of the meshes in space: blocks of hexahedra; lengths in contact radii, of a rough body in half
sides of the patch.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from fem_reference.common.arrays import Array

GROWTH = 1.7
"""Ratio of neighbouring elements outside the uniform part; 1.4 changes scalar results by up to 5e-3."""


@dataclass(frozen=True)
class Lines:
    """Coordinates of the planes of a block, ascending; z from 0. half: the block ends at the plane y = 0."""

    x: Array
    y: Array
    z: Array
    half: bool

    @property
    def shape(self) -> tuple[int, int, int]:
        """Numbers of elements."""
        return self.x.size - 1, self.y.size - 1, self.z.size - 1

    @property
    def share(self) -> float:
        """Modelled part of every force."""
        return 0.5 if self.half else 1.0

    @cached_property
    def areas(self) -> Array:
        """(nx + 1, ny + 1) integrals of the surface shape functions."""
        x, y = (
            0.5 * (np.diff(line, prepend=line[0]) + np.diff(line, append=line[-1]))
            for line in (self.x, self.y)
        )
        return np.outer(x, y)
