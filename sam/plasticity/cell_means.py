# SPDX-License-Identifier: MIT
"""Coefficients as means over the observed cell, of plastic strain and of loads, and their transforms."""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sam.arrays import Array
from sam.contact.convolution import forward, real_spectrum
from sam.kernels.layer_stress import CornerFunctions, four_points, functions_of, mesh
from sam.kernels.patches import ODD_X, ODD_Y, Cuboids, Lags, stress_coefficients
from sam.plasticity.swept import GAUSS

Parities = NDArray[np.integer[Any]]
"""1 for odd, 0 for even, of each component."""
NEAR = 4  # cells: up to there stresses are means over the Gauss points of the observed cell
WIDE = 3  # neighbours on either side whose values at the centres give this mean further away


def gauss_depths(faces: Array) -> Array:
    """Depths of the Gauss points of each layer, (n_layers, 2)."""
    return ((faces[1:] + faces[:-1])[:, None] + np.diff(faces)[:, None] * GAUSS) / 2


def _mean(n: int, odd: bool, wide: int) -> Array:
    """Mean over the Gauss points in one direction at lags 0 .. n - 1, a column each, by values at lags 0 ..
    n + wide - 1 of a function of this parity: with s = 2 sin(k/2), where -s^2 is the second difference,
    (a) cos(k/sqrt(12)) = sum_m c_m s^(2 m) = 1 - s^2/24 - 11 s^4/3456 - ..., m <= wide,
    c_(m+1)/c_m = (m^2 - 1/12)/((2 m + 1)(2 m + 2)).
    """
    power, factor, shift = np.eye(2 * wide + 1)[wide], 1.0, np.arange(-wide, wide + 1)
    of_neighbours = power
    for m in range(wide):
        power = np.convolve(power, [-1, 2, -1], "same")
        factor *= (m**2 - 1 / 12) / ((2 * m + 1) * (2 * m + 2))
        of_neighbours = of_neighbours + factor * power
    out, lag = np.zeros((n + wide, n)), np.arange(n)[:, None]
    np.add.at(out, (abs(lag + shift), lag), np.where((lag + shift < 0) & odd, -1, 1) * of_neighbours)
    return out


def _of_corners(of_cells: Array) -> Array:
    """Rows for the corners from those for the cells, whose values are differences."""
    return -np.diff(of_cells, axis=0, prepend=0, append=0)


@lru_cache(maxsize=8)
def _sums(
    shape: tuple[int, int], half: tuple[int, int] | None, odd: tuple[bool, bool], line: bool
) -> tuple[Array, Array, Array, Array]:
    """Matrices for `CellMeans.planes`, from corners to cells or, with `half`, to transforms: in x, in y,
    in y of the lags < NEAR, and what the Gauss points of those have more, by their corners.
    """
    axes = list(zip(shape, half or shape, odd, (WIDE, 0 if line else WIDE), strict=True))
    seen = [forward(np.eye(n), to, o, -1) if half else np.eye(n) for n, to, o, _ in axes]
    means = [_of_corners(_mean(n, o, wide) @ of) for (n, _, o, wide), of in zip(axes, seen, strict=True)]
    near, points = [min(NEAR, n) for n in shape], 2 if line else 4
    few = [_of_corners(_mean(n, o, wide)) for n, (_, _, o, wide) in zip(near, axes, strict=True)]
    at_points = np.kron(*(_of_corners(np.eye(n)) for n in near)) / points
    more = np.concatenate([-np.kron(*few), *[at_points] * points])
    return np.concatenate([means[0], seen[0][: near[0]]]), means[1], np.asarray(seen[1][: near[1]]), more


class CellMeans(CornerFunctions):
    """The same functions as means over the cell in x and y, see NEAR; half: transforms of these means."""

    def __init__(self, lags: Lags, half: tuple[int, int] | None = None):
        self.shape, self.half, self.line = lags.shape, half, lags.period == 1
        near, wide = first_lags(lags, (min(NEAR, lags.nx), min(NEAR, lags.ny))), 0 if self.line else WIDE
        self.few = near.nx + WIDE + 1, near.ny + wide + 1  # corners
        points = four_points((lags.hx * GAUSS[1] / 2, lags.hy * GAUSS[1] / 2))
        if self.line:
            points = [points[0], points[2]]
        super().__init__(
            lags.shape, mesh(first_lags(lags, (lags.nx + WIDE, lags.ny + wide))), mesh(near, points)
        )

    def planes(self, corners: Array, odd: tuple[int, int]) -> Array:
        """Means over the cells, (..., nx, ny), or transforms, see `real_spectrum`."""
        of_x, of_y, near_y, of_more = _sums(self.shape, self.half, (bool(odd[0]), bool(odd[1])), self.line)
        lead, (_, nx, ny), (x, y) = corners.shape[:-1], self.meshes[0], self.few
        far, points = corners[..., : nx * ny].reshape(*lead, nx, ny), corners[..., nx * ny :]
        more = np.concatenate([far[..., :x, :y].reshape(*lead, -1), points], axis=-1) @ of_more
        rows = np.empty((*lead, len(of_x), of_y.shape[1]))
        np.matmul(far, of_y, out=rows[..., :nx, :])
        np.matmul(more.reshape(*lead, -1, len(near_y)), near_y, out=rows[..., nx:, :])
        return np.asarray(of_x.T @ rows)


class CellSpectra(CornerFunctions):
    """Their transforms of so many wave numbers, see `real_spectrum`; closed: with the lag half a period."""

    def __init__(self, lags: Lags, closed: bool):
        self.half, self.repeated = lags.shape, lags.period > 1
        some, half = (
            first_lags(lags, (lags.nx + closed, lags.ny + closed)),
            None if self.repeated else self.half,
        )
        self.means = functions_of(some, lambda alone: CellMeans(alone, half))
        self.x, self.y, self.line = self.means.x, self.means.y, self.means.line
        self.itself = np.ones((lags.nx + 1, lags.ny + 1))

    def planes(self, corners: Array, odd: tuple[int, int]) -> Array:
        """(..., nx + 1, ny + 1)."""
        found = self.means.planes(corners, odd)
        return np.asarray(real_spectrum(found, self.half, odd)) if self.repeated else found


def first_lags(lags: Lags, counts: tuple[int, int]) -> Lags:
    """So many of the lags."""
    return replace(lags, nx=counts[0], ny=counts[1])


def mean_stress_of_load(cuboids: Cuboids, load: int = 3) -> Array:
    """Mean stress/Pa in cuboids, (6, n_layers, nx, ny), of pressure (3) or traction (1) on one cell."""
    lags, nu = cuboids.lags, cuboids.nu
    points, (nx, ny) = gauss_depths(cuboids.depths), lags.shape
    depths, shape = points.ravel(), (6, *points.shape)

    def by_neighbours(lags: Lags) -> Array:
        """From values at the centres, (a) of `_mean`."""
        wide = 0 if lags.period == 1 else WIDE
        further, odd = (
            first_lags(lags, (lags.nx + WIDE, lags.ny + wide)),
            zip(ODD_X ^ int(load == 1), ODD_Y, strict=True),
        )
        far = stress_coefficients(further, depths, nu, load=load).reshape(*shape, *further.shape).mean(axis=2)
        means = [
            _mean(lags.nx, x, WIDE).T @ part @ _mean(lags.ny, y, wide)
            for part, (x, y) in zip(far, odd, strict=True)
        ]
        return np.array(means)

    out = by_neighbours(lags)
    near = min(NEAR, nx), min(NEAR, ny)
    few = replace(first_lags(lags, near), period=lags.period == 1)
    shifts = [(lags.hx * x / 2, lags.hy * y / 2) for x in GAUSS for y in GAUSS]
    at = [stress_coefficients(few, depths, nu, load=load, shift=shift) for shift in shifts]
    means = np.mean(at, axis=0).reshape(*shape, *near).mean(axis=2)
    if lags.period < 2:
        out[..., : near[0], : near[1]] = means
        return out
    # of the cell alone; what its repetitions add is smooth over a cell
    means, sign = (
        means - by_neighbours(replace(few, period=0)),
        np.where(ODD_Y, -1.0, 1.0).reshape(6, 1, 1, 1),
    )
    for k in range(near[1]):
        out[..., : near[0], k % lags.period :: lags.period] += means[..., k : k + 1]
        if k:
            out[..., : near[0], -k % lags.period :: lags.period] += sign * means[..., k : k + 1]
    return out
