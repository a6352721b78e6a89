# SPDX-License-Identifier: MIT
"""Integrals over rectangular cells of radial functions times an angular one: g(r) cos(m theta) or g(r) sin(m
theta).

Near cells: F(X, Y), the integral over [0, X] x [0, Y], differenced over the corners (half-integers times the
cell, never zero). Two triangles make it up; the one with its right angle at (X, 0) gives, with R = X cosh u
at its far side,

    int G(R) cos(m theta) d theta,   G(R) = int_0^R g r dr,   theta = atan sinh u,   d theta = du/cosh u,

by Gauss-Legendre in u, in which G is smooth however small X is. Far cells: Gauss points of g itself, the
error being that of a power of r across a cell: below 1e-9 of the largest coefficient for the tails r^-1
(displacement) to r^-3. All is linear in the spline coefficients of `RadialTable`, so that one sparse matrix
serves every depth.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from sam.arrays import Array
from sam.kernels.lags import Lags
from sam.layered.radial import SUPPORT, RadialTable, spline_weights

NEAR = 8
"""Distance in cells below which the corners are used: 4 changes stresses by 1e-12 of the
largest, 2 by 8e-10.
"""
BANDS = ((5, 16.0), (4, 32.0), (3, 64.0), (2, np.inf))
"""Beyond: Gauss points in each direction, up to a distance in cells."""
NODES = 32
"""Gauss points in u: 24 give the same to 1e-11 of the largest coefficient for square cells, 1e-9 for cells of
10 to 1.
"""
BLOCK = 1 << 15
"""Far cells in one sparse matrix: bounds the memory."""


@dataclass(frozen=True)
class Angular:
    """cos(m theta), or sin(m theta)."""

    order: int
    sine: bool = False

    def __call__(self, theta: Array) -> Array:
        """The value at angles theta in rad."""
        return np.sin(self.order * theta) if self.sine else np.cos(self.order * theta)

    @property
    def parity(self) -> tuple[int, int]:
        """Signs under x -> -x and under y -> -y."""
        flip = (-1) ** self.order
        return (-flip, -1) if self.sine else (flip, 1)


def spline_matrix(r: Array, weights: Array, power: float, columns: int) -> csr_array:
    """Rows: sum of weights r^power times the spline at r; r, weights: (rows, points)."""
    rows, points = r.shape
    first, spline = spline_weights(r.ravel())
    values = spline * (weights * r**power).reshape(-1, 1)
    indices = first[:, None] + np.arange(SUPPORT, dtype=np.int32)
    pointers = np.arange(rows + 1) * (points * SUPPORT)
    return csr_array((values.ravel(), indices.ravel(), pointers), shape=(rows, columns))


class CellIntegrals:
    """Integrals over the cells around lags in the tables' unit of length."""

    def __init__(self, lags: Lags):
        self.shape, self.h = lags.shape, (lags.hx, lags.hy)
        widest = max(self.h)
        self.near = tuple(
            min(n, int(np.ceil(NEAR * widest / h))) for n, h in zip(self.shape, self.h, strict=True)
        )
        i, j = np.indices(self.shape)
        distance = np.hypot(i * lags.hx, j * lags.hy) / widest
        distance[: self.near[0], : self.near[1]] = -1
        lower = 0.0
        self.bands = []
        for points, upper in BANDS:
            self.bands.append((points, np.flatnonzero((distance >= lower) & (distance < upper))))
            lower = upper

    def integrate(self, table: RadialTable, angular: Angular) -> Array:
        """Integral over each cell for each function of the table: (functions, nx, ny)."""
        out = np.empty((self.shape[0] * self.shape[1], table.point.shape[1]))
        for points, cells in self.bands:
            for start in range(0, cells.size, BLOCK):
                block = cells[start : start + BLOCK]
                out[block] = self._gauss(block, points, table, angular)
        whole = out.reshape(*self.shape, -1)
        whole[: self.near[0], : self.near[1]] = self._corners(table, angular)
        return np.moveaxis(whole, -1, 0)

    def _gauss(self, cells: NDArray[np.intp], points: int, table: RadialTable, angular: Angular) -> Array:
        """points x points Gauss points in each of the cells (flat indices): (cells, functions)."""
        t, w = np.polynomial.legendre.leggauss(points)
        i, j = np.unravel_index(cells, self.shape)
        x = (i[:, None] + np.repeat(t, points) / 2) * self.h[0]
        y = (j[:, None] + np.tile(t, points) / 2) * self.h[1]
        weights = np.repeat(w, points) * np.tile(w, points) * (self.h[0] * self.h[1] / 4)
        coefficients, power = table.coefficients("point")
        matrix = spline_matrix(np.hypot(x, y), weights * angular(np.arctan2(y, x)), power, len(coefficients))
        found: Array = matrix @ coefficients
        return found

    def _corners(self, table: RadialTable, angular: Angular) -> Array:
        """Near cells by their corners, (near x, near y, functions); the corners at minus half a cell by
        parity.
        """
        X, Y = ((np.arange(n) + 0.5) * h for n, h in zip(self.near, self.h, strict=True))
        X, Y = (a.ravel() for a in np.meshgrid(X, Y, indexing="ij"))
        coefficients, power = table.coefficients("disc")
        total: Array | float = 0.0
        for a, b, turned in ((X, Y, False), (Y, X, True)):
            r, theta, weights = _triangle(a, b)
            weights = weights * angular(np.pi / 2 - theta if turned else theta)
            total = total + spline_matrix(r, weights, power, len(coefficients)) @ coefficients
        corners = np.asarray(total).reshape(*self.near, -1)
        px, py = angular.parity
        corners = np.concatenate([-px * corners[:1], corners])
        corners = np.concatenate([-py * corners[:, :1], corners], axis=1)
        return np.diff(np.diff(corners, axis=0), axis=1)


def _triangle(a: Array, b: Array) -> tuple[Array, Array, Array]:
    """R, theta and weights (d theta) along the side of length b opposite the origin, a from it: each
    (corners, NODES).
    """
    t, w = np.polynomial.legendre.leggauss(NODES)
    top = np.arcsinh(b / a)[:, None]
    u = top * (t + 1) / 2
    return a[:, None] * np.cosh(u), np.arctan(np.sinh(u)), top * w / 2 / np.cosh(u)
