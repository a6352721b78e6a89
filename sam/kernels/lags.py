# SPDX-License-Identifier: MIT
"""Where influence coefficients are wanted: the lags between cells of the surface, and the layers of cuboids
below them.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from sam.arrays import Array


@dataclass(frozen=True)
class Lags:
    """The offsets (i hx, j hy), 0 <= i < nx and 0 <= j < ny, from the centre of a loaded cell to that of an
    observed one.

    Parameters
    ----------
    nx, ny
        Number of lags in x and in y: as many as a box of cells has cells.
    hx, hy
        Sides of a cell, in any unit of length.
    """

    nx: int
    ny: int
    hx: float
    hy: float

    @property
    def shape(self) -> tuple[int, int]:
        """(nx, ny)."""
        return self.nx, self.ny

    @property
    def exchanged(self) -> Lags:
        """The same lags with x and y exchanged."""
        return Lags(self.ny, self.nx, self.hy, self.hx)

    def in_units_of(self, length: float) -> Lags:
        """The same lags with another unit of length."""
        return replace(self, hx=self.hx / length, hy=self.hy / length)

    def corners(self, first: int = 0) -> tuple[Array, Array]:
        """x and y of the corners of the cells at the lags first .. n - 1: half-integers times the cell, none
        of them 0.

        >>> Lags(2, 1, 1.0, 3.0).corners()
        (array([-0.5,  0.5,  1.5]), array([-1.5,  1.5]))
        """
        i = np.arange(first, self.nx + 1, dtype=float)
        j = np.arange(first, self.ny + 1, dtype=float)
        return (i - 0.5) * self.hx, (j - 0.5) * self.hy


@dataclass(frozen=True)
class Cuboids:
    """The half-space z >= 0 below cells of its surface, divided into layers: a cuboid hx x hy x thickness in
    each.

    Parameters
    ----------
    lags
        Lags between the columns of cuboids.
    faces
        Depths of the n + 1 faces of n layers of any thicknesses, ascending from a depth >= 0, in the unit of
        hx.
    nu
        Poisson's ratio of the half-space, 0 <= nu <= 1/2.

    Raises
    ------
    ValueError
        For faces that are fewer than two, negative or not ascending.
    """

    lags: Lags
    faces: tuple[float, ...]
    nu: float

    def __post_init__(self) -> None:
        faces = self.depths
        if faces.ndim != 1 or faces.size < 2 or faces[0] < 0 or not np.all(np.diff(faces) > 0):
            raise ValueError("faces must be two or more increasing depths >= 0")

    @property
    def depths(self) -> Array:
        """The faces as an array, (n + 1,)."""
        return np.asarray(self.faces, dtype=float)

    @property
    def layers(self) -> int:
        """Number of layers."""
        return len(self.faces) - 1
