# SPDX-License-Identifier: MIT
"""The boxes of plastic strain that a solve will go through, before anything is solved.

They follow from a guessed plastic zone by the rules of `sam.plasticity.extent`.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import ceil, floor

import numpy as np

from sam.contact.normal import margin_around
from sam.contact.real_transforms import half_length
from sam.grid.cells import CellGrid
from sam.plasticity.extent import CONTAINED, DEEPEST, growth
from sam.plasticity.points import OFFSET, POINTS
from sam.plasticity.spectra import CACHED_BOXES, SINGLE


@dataclass(frozen=True)
class ExpectedBox:
    """A box of cells on which plastic strain is expected.

    Parameters
    ----------
    nx, ny, layers
        Cells in x and in y, and layers.
    tolerance
        That of the plastic iteration, on which the precision of the coefficients depends.
    exchange
        Whether x and y may be exchanged, so that half of the coefficients are stored.
    """

    nx: int
    ny: int
    layers: int
    tolerance: float
    exchange: bool = False

    @property
    def width(self) -> int:
        """Bytes of a stored coefficient."""
        return 4 if self.tolerance >= SINGLE else 8

    @property
    def coefficients(self) -> int:
        """For every wave number, the 6 x 6 components between every two layers: 36 nz^2 (N_x + 1)(N_y + 1)
        real numbers.

        Where x and y may be exchanged, those with k_x <= k_y.
        """
        nx, ny = half_length(self.nx) + 1, half_length(self.ny) + 1
        return 36 * self.layers**2 * (nx * (nx + 1) // 2 if self.exchange else nx * ny)

    def numbers(self, back_stresses: int) -> int:
        """Numbers of the material at the points of all cells: strain, accumulated strain, back-stresses."""
        return (7 + 6 * back_stresses) * POINTS * self.layers * self.nx * self.ny

    @property
    def set_up(self) -> int:
        """Coefficients of a layer with all others, which are made at once."""
        return 36 * self.layers * (self.nx + 1) * (self.ny + 1)


@dataclass(frozen=True)
class Zone:
    """What is guessed of a smooth contact and of the plastic zone below it.

    Parameters
    ----------
    axes
        Semi-axes of the contact along x and y, in m.
    wide, deep
        Radius and depth in which the elastic stress exceeds the yield stress, in semi-axes.
    needed
        Radius and depth of the plastic zone in semi-axes.
    ratio
        Largest elastic von Mises stress over the yield stress.
    path
        Cells that the load passes in x and in y.
    """

    axes: tuple[float, float]
    wide: float
    deep: float
    needed: tuple[float, float]
    ratio: float
    path: tuple[int, int] = (0, 0)


def expected_sides(grid: CellGrid, depths: np.ndarray, zone: Zone) -> list[tuple[int, int, int]]:
    """The sizes of the boxes below a smooth contact: the first guess, and what it grows to.

    Parameters
    ----------
    grid
        The cells.
    depths
        (nz,) centres of the layers in m.
    zone
        What the boxes have to hold.

    Returns
    -------
    list of tuple of int
        Cells in x, in y, and layers of each box.
    """
    box, needed = [], []
    for axis, h, n, path in zip(zone.axes, (grid.hx, grid.hy), (grid.nx, grid.ny), zone.path, strict=True):
        contact = 2 * floor(axis / h) + n % 2
        contact += 2 * margin_around(contact)
        some = ceil(contact / 8) if zone.ratio > CONTAINED else 0
        beside = min(max(floor(zone.wide * axis / h) + 2 - contact // 2, some), max(contact // 6, some))
        box.append(min(contact + 2 * beside + path, n))
        # a cell yields with the first of its points; the last two cells of a box stay free
        needed.append(min(2 * floor(zone.needed[0] * axis / h + 2 * OFFSET) + 5 + path, n))
    deep, half_width = zone.deep * min(zone.axes), min(box[0] * grid.hx, box[1] * grid.hy) / 2
    layers = int(np.searchsorted(depths, min(deep, DEEPEST * half_width))) + 1
    boxes = [(box[0], box[1], min(layers, len(depths)))]
    needed_layers = int(np.searchsorted(depths, zone.needed[1] * min(zone.axes))) + 1
    while True:
        nx, ny, nz = boxes[-1]
        wider, longer = (n + 2 * growth(n) * (n < need) for n, need in zip((nx, ny), needed, strict=True))
        deeper = nz + growth(nz) * (nz < needed_layers)
        larger = min(wider, grid.nx), min(longer, grid.ny), min(deeper, len(depths))
        if larger == boxes[-1]:
            return boxes
        boxes.append(larger)


def held(boxes: list[ExpectedBox]) -> list[ExpectedBox]:
    """The boxes whose coefficients are in memory at the end of a solve.

    Parameters
    ----------
    boxes
        Of the whole history, in their order.

    Returns
    -------
    list of ExpectedBox
        The last ones: one that is outgrown stays until the next is there.
    """
    return boxes[-max(CACHED_BOXES, 2) :]
