# SPDX-License-Identifier: MIT
"""Coefficients as means over the observed cell, of plastic strain and of loads, and their transforms."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sam.arrays import Array
from sam.contact.convolution import real_spectrum
from sam.kernels.layer_stress import CornerFunctions, four_points, functions_of, mesh
from sam.kernels.patches import ODD_X, ODD_Y, Cuboids, Lags, stress_coefficients
from sam.plasticity.swept import GAUSS

Parities = NDArray[np.integer[Any]]
"""1 for odd, 0 for even, of each component."""
NEAR = 4  # cells: up to there stresses are means over the observed cell


def gauss_depths(faces: Array) -> Array:
    """Depths of the Gauss points of each layer, (n_layers, 2)."""
    return ((faces[1:] + faces[:-1])[:, None] + np.diff(faces)[:, None] * GAUSS) / 2


class CellMeans(CornerFunctions):
    """The same functions as means over the cell in x and y: by Gauss points up to NEAR cells away."""

    def __init__(self, lags: Lags):
        self.shape, self.near = lags.shape, (min(NEAR, lags.nx), min(NEAR, lags.ny))
        self.line = lags.period == 1
        points = four_points((lags.hx * GAUSS[1] / 2, lags.hy * GAUSS[1] / 2))
        far = mesh(replace(lags, nx=lags.nx + 1, ny=lags.ny + 1), first=-1)
        if self.line:
            far, points = (far[0][..., 1:3], far[1][..., 1:3]), [points[0], points[2]]
        super().__init__(lags.shape, far, mesh(first_lags(lags, self.near), points))

    def planes(self, corners: Array, odd: tuple[int, int]) -> Array:
        """Means over the cells, (..., nx, ny)."""
        far, near = self._differences(corners)
        out = np.empty((*corners.shape[:-1], *self.shape))
        _plane_mean(far[..., 0, :, :1] if self.line else far[..., 0, :, :], out)
        np.mean(near[..., :-1, :-1], axis=-3, out=out[..., : self.near[0], : self.near[1]])
        return out


class CellSpectra(CornerFunctions):
    """Their transforms of so many wave numbers, see `real_spectrum`; closed: with the lag half a period."""

    def __init__(self, lags: Lags, closed: bool):
        self.means = functions_of(first_lags(lags, (lags.nx + closed, lags.ny + closed)), CellMeans)
        self.x, self.y, self.line, self.half = self.means.x, self.means.y, self.means.line, lags.shape
        self.itself = np.ones((lags.nx + 1, lags.ny + 1))

    def planes(self, corners: Array, odd: tuple[int, int]) -> Array:
        """(..., nx + 1, ny + 1)."""
        return np.asarray(real_spectrum(self.means.planes(corners, odd), self.half, odd))


def first_lags(lags: Lags, counts: tuple[int, int]) -> Lags:
    """So many of the lags."""
    return replace(lags, nx=counts[0], ny=counts[1])


def mean_stress_of_load(cuboids: Cuboids, load: int = 3) -> Array:
    """Mean stress/Pa in cuboids, (6, n_layers, nx, ny), of pressure (3) or traction (1) on one cell."""
    lags, nu = cuboids.lags, cuboids.nu
    points, (nx, ny) = gauss_depths(cuboids.depths), lags.shape
    depths, shape = points.ravel(), (6, *points.shape)
    further = replace(lags, nx=nx + 1, ny=ny + 1)
    far = stress_coefficients(further, depths, nu, load=load).reshape(*shape, *further.shape)
    out = np.empty((6, len(points), nx, ny))
    kernel = _with_lag_before(far.mean(axis=2), ODD_X ^ int(load == 1), ODD_Y)
    _plane_mean(kernel[..., 1:2] if lags.period == 1 else kernel, out)
    near = min(NEAR, nx), min(NEAR, ny)
    few = replace(first_lags(lags, near), period=lags.period == 1)
    shifts = [(lags.hx * x / 2, lags.hy * y / 2) for x in GAUSS for y in GAUSS]
    at = [stress_coefficients(few, depths, nu, load=load, shift=shift) for shift in shifts]
    means = np.mean(at, axis=0).reshape(*shape, *near).mean(axis=2)
    if lags.period < 2:
        out[..., : near[0], : near[1]] = means
        return out
    # of the cell alone; what its repetitions add is smooth over a cell
    space, alone = replace(few, nx=near[0] + 1, ny=near[1] + 1, period=0), np.empty_like(means)
    far = stress_coefficients(space, depths, nu, load=load).reshape(*shape, *space.shape)
    _plane_mean(_with_lag_before(far.mean(axis=2), ODD_X ^ int(load == 1), ODD_Y), alone)
    means, sign = means - alone, np.where(ODD_Y, -1.0, 1.0).reshape(6, 1, 1, 1)
    for k in range(near[1]):
        out[..., : near[0], k % lags.period :: lags.period] += means[..., k : k + 1]
        if k:
            out[..., : near[0], -k % lags.period :: lags.period] += sign * means[..., k : k + 1]
    return out


def _plane_mean(kernel: Array, out: Array) -> None:
    """Mean over the cell in x and y, K + (d_x^2 K + d_y^2 K)/24, from lags -1 .. n at lags 0 .. n - 1; of
    plane strain from one lag in y.
    """
    if kernel.shape[-1] == 1:
        kernel = np.repeat(kernel, 3, axis=-1)
    (nx, ny), row, flat = out.shape[-2:], kernel.shape[-1], kernel.reshape(-1)
    # sums of neighbours in one go; those over the border are not kept
    pairs = flat[row:] + flat[1 : 1 - row]  # one further in x and one further in y
    mean = 20 * flat  # 24 - 4
    inner = mean[row + 1 : -row]
    inner += pairs[row + 1 :]
    inner += pairs[: -row - 1]
    np.multiply(mean.reshape(kernel.shape)[..., 1 : nx + 1, 1 : ny + 1], 1 / 24, out=out)


def _with_lag_before(kernel: Array, odd_x: Parities, odd_y: Parities) -> Array:
    """Lags -1 .. n from lags 0 .. n, of kernels (len(odd_x), ..., n_x + 1, n_y + 1) of these parities."""
    sign_x, sign_y = (
        np.where(odd, -1.0, 1.0).reshape(-1, *[1] * (kernel.ndim - 1)) for odd in (odd_x, odd_y)
    )
    kernel = np.concatenate([sign_x * kernel[..., 1:2, :], kernel], axis=-2)
    return np.concatenate([sign_y * kernel[..., 1:2], kernel], axis=-1)
