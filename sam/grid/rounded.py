# SPDX-License-Identifier: MIT
"""A punch with a flat end and a rounded edge. Loaded for such a counter-body only."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import acos, cos, inf, sin, sqrt

import numpy as np

from sam.arrays import Array
from sam.grid.cells import CellGrid
from sam.grid.gap import ORIGIN, Place

FEWEST = 3  # cells in the contact beyond the flat end: the largest pressure errs by 1 %, with 1.5 by 5 %
HALVINGS = 60  # of a bracket: to the last digit


@dataclass(frozen=True)
class RoundedPunch:
    """The gap (r - flat)^2/(2 radius) beyond the flat end, zero below it; flat, radius (of the edge) in m.

    Contact of a rigid one with an elastic half-space: Ciavarella, Hills & Monno, Proc. Inst. Mech. Eng. C 212
    (1998) 319; here from the Abel transform of the gap. With cos t = flat/a the contact radius is a.
    """

    flat: float
    radius: float

    def gap(self, grid: CellGrid, at: Place = ORIGIN) -> Array:
        """At the cell centres, (nx, ny) in m."""
        beyond = np.maximum(np.hypot(grid.x[:, None] - at[0], grid.y[None, :] - at[1]) - self.flat, 0.0)
        found: Array = beyond**2 / (2 * self.radius)
        return found

    def largest_cell(self, a: float) -> float:
        """In m, at a contact radius in m; infinite without contact beyond the flat end."""
        return (a - self.flat) / FEWEST if a > self.flat else inf

    def force(self, a: float, modulus: float) -> float:
        """In N at a contact radius in m; modulus: E* in Pa."""
        t = acos(min(1.0, self.flat / a))
        return modulus * a**3 / self.radius * (4 / 3 * sin(t) ** 3 - cos(t) * (t - sin(t) * cos(t)))

    def approach(self, a: float) -> float:
        """In m at a contact radius in m."""
        return a / self.radius * (sqrt(a**2 - self.flat**2) - self.flat * acos(min(1.0, self.flat / a)))

    def contact_radius(self, force: float, modulus: float) -> float:
        """In m under a force in N: at most that of Hertz beyond the flat end."""
        hertz = (3 * force * self.radius / (4 * modulus)) ** (1 / 3)
        return self._radius(lambda a: self.force(a, modulus) < force, hertz)

    def radius_at(self, approach: float) -> float:
        """The contact radius in m at an approach in m: at most twice that of Hertz beyond the flat end."""
        return self._radius(lambda a: self.approach(a) < approach, 2 * sqrt(self.radius * approach))

    def _radius(self, smaller: Callable[[float], bool], beyond: float) -> float:
        low, high = self.flat, self.flat + beyond
        for _ in range(HALVINGS):
            middle = (low + high) / 2
            low, high = (middle, high) if smaller(middle) else (low, middle)
        return high
