# SPDX-License-Identifier: MIT
"""A pressure that a scene gives in place of a counter-body."""

from __future__ import annotations

from dataclasses import dataclass
from math import pi

import numpy as np

from sam.arrays import Array
from sam.contact.normal import Contact, around
from sam.grid.cells import CellGrid, Window
from sam.schedule import Load

PARTS = 8  # of a cell each way for its mean: the force errs by 1.5e-4 on 8 cells in a, 2e-6 on 16


@dataclass(frozen=True)
class GivenHertz:
    """p0 sqrt(1 - r^2/a^2) at the peak force, in proportion to the force. p0 in Pa, radius a in m."""

    p0: float
    radius: float

    @property
    def peak_force(self) -> float:
        """Force of the pressure in N, 2/3 pi p0 a^2."""
        return 2 / 3 * pi * self.p0 * self.radius**2

    def pressure(self, grid: CellGrid, load: Load, window: Window | None = None) -> Array:
        """The mean over each cell of a window (None: of the grid), centred at the place of the load, (nx, ny)
        in Pa.
        """
        i, j = (grid.whole if window is None else window).slices
        return self._mean((grid.x[i], grid.y[j]), (grid.hx, grid.hy), load)

    def _mean(self, centres: tuple[Array, Array], cell: tuple[float, float], load: Load) -> Array:
        (x, y), a = centres, self.radius
        out, part = np.zeros((x.size, y.size)), (np.arange(PARTS) + 0.5) / PARTS - 0.5
        places = load.x, load.y
        i, j = (np.flatnonzero(np.abs(c - o) < a + h) for c, o, h in zip(centres, places, cell, strict=True))
        if load.force == 0 or not (i.size and j.size):
            return out
        fine_x, fine_y = (
            ((c[k, None] - o + h * part) / a).ravel()
            for c, k, o, h in zip(centres, (i, j), places, cell, strict=True)
        )
        p = np.sqrt(np.maximum(1.0 - fine_x[:, None] ** 2 - fine_y[None, :] ** 2, 0.0))
        p = p.reshape(i.size, PARTS, j.size, PARTS).mean(axis=(1, 3))
        out[np.ix_(i, j)] = self.p0 * (load.force / self.peak_force) * p
        return out

    def contact(self, grid: CellGrid, load: Load, pressure: Array, displacement: Array) -> Contact:
        """The state under the pressure: nothing is opposite, so gap and approach are not numbers.

        pressure in Pa, displacement in m, (nx, ny); load_error: of the means over the cells against the
        force.
        """
        error = abs(float(pressure.sum()) * (grid.hx * grid.hy) - load.force) / load.force
        nothing = np.full_like(pressure, np.nan)
        area = pi * self.radius**2
        return Contact(
            pressure=pressure,
            displacement=displacement,
            gap=nothing,
            approach=np.nan,
            force=load.force,
            box=around(pressure > 0),
            gap_residual=0.0,
            penetration=0.0,
            tension=0.0,
            load_error=error,
            iterations=0,
            converged=True,
            area=area,
        )
