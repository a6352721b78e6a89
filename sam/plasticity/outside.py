# SPDX-License-Identifier: MIT
"""Stress and surface displacement of plastic strain anywhere on the grid: what the box of the solution does
not cover.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from sam.arrays import Array
from sam.contact.convolution import FEW_ROWS, Convolution, Counters, row_sums
from sam.grid.cells import Window
from sam.kernels.eigenstrain import surface_displacement_coefficients
from sam.kernels.lags import Cuboids, Lags
from sam.kernels.layer_stress import residual_stress_coefficients
from sam.kernels.patches import STRESS, parity
from sam.plasticity.spectra import ODD_X, ODD_Y

ODD = np.array([ODD_X, ODD_Y])
AT_ONCE = 1e6  # coefficients, 8 MB of them; ten times as many are no faster


@dataclass(frozen=True)
class Strained:
    """Plastic strain in a box of cells.

    Parameters
    ----------
    strain
        (6, n_layers, nx, ny).
    window
        The box on the grid.
    cuboids
        Its cells, in m.
    """

    strain: Array
    window: Window
    cuboids: Cuboids

    def part(self) -> Strained | None:
        """The smallest box that holds all of the strain; None without any."""
        where = np.nonzero(self.strain.any(axis=0))
        if not where[0].size:
            return None
        (k0, i0, j0), (k1, i1, j1) = ([int(each(axis)) for axis in where] for each in (np.min, np.max))
        window = Window(int(self.window.i0 + i0), int(self.window.j0 + j0), i1 - i0 + 1, j1 - j0 + 1)
        lags = replace(self.cuboids.lags, nx=window.nx, ny=window.ny)
        cuboids = replace(self.cuboids, lags=lags, faces=self.cuboids.faces[k0 : k1 + 2])
        return Strained(self.strain[:, k0 : k1 + 1, i0 : i1 + 1, j0 : j1 + 1], window, cuboids)

    def seen_from(self, observed: Window) -> Cuboids:
        """Its cuboids with the lags to another window of the grid, in the unit of hx."""
        lags, cells = Convolution.lags_needed(self.window, observed), self.cuboids.lags
        faces = tuple(float(z / cells.hx) for z in self.cuboids.faces)
        return replace(self.cuboids, lags=Lags(*lags, 1.0, cells.hy / cells.hx), faces=faces)


def residual_stress(source: Strained, depths: Array, observed: Window, *, mu: float) -> Array:
    """Stress of the plastic strain in a box at any depths and cells, (6, n_depths, nx, ny) in Pa. Paper Eq.
    7.

    depths in m, none of them on a face of the box; observed: cells of the grid; mu in Pa.
    """
    out = np.zeros((6, len(depths), *observed.shape))
    part = source.part()
    if part is None:
        return out
    cuboids, hx = part.seen_from(observed), part.cuboids.lags.hx
    at_once = max(1, int(AT_ONCE // (36 * cuboids.layers * cuboids.lags.nx * cuboids.lags.ny)))
    for first in range(0, len(depths), at_once):
        some = slice(first, first + at_once)
        kernels = residual_stress_coefficients(cuboids, depths[some] / hx)
        # paper Eq. 7, second sum
        out[:, some] = mu * row_sums(kernels, part.strain, part.window, observed, odd_out=ODD, odd_in=ODD)
    return out


def surface_displacement(
    source: Strained, observed: Window, *, counters: Counters, component: int = 3
) -> Array:
    """Displacement of the surface due to the plastic strain in a box. Paper Eq. 6.

    Parameters
    ----------
    source
        The plastic strain, and where its box is on the grid.
    observed
        Cells of the surface.
    counters
        Where the transforms are counted.
    component
        3 for u_z (> 0 into the body), 1 for u_x.

    Returns
    -------
    Array
        (nx, ny) in m on the observed cells.
    """
    part = source.part()
    if part is None:
        return np.zeros(observed.shape)
    hx = part.cuboids.lags.hx
    kernels = surface_displacement_coefficients(part.seen_from(observed), component=component)[None]
    if observed.ny <= FEW_ROWS:
        odd, kernels = np.array([[component == 1], [component == 2]], dtype=int), kernels[:, :, None]
        rows = row_sums(kernels, part.strain, part.window, observed, odd_out=odd, odd_in=ODD)
        return np.asarray(hx * rows[0, 0])
    signs = [parity(name, component) for name in STRESS for _ in range(part.cuboids.layers)]
    # paper Eq. 6
    convolution = Convolution(kernels, signs, part.window, observed, counters=counters)
    return np.asarray(hx * convolution.summed(part.strain)[0])
