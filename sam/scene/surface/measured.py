# SPDX-License-Identifier: MIT
"""Measured heights: their roughness (ISO 25178-2), and their preparation: form off, missing points filled,
cropped, resampled, in this order. scipy is loaded for the scenes that ask to fill or resample.

Form: the least-squares polynomial through the measured points of the whole map, which know it best, is taken
off (the F-operation of ISO 25178-2). "tilt": 1, x, y; "sphere": also x^2 + y^2, the cap of a sphere to second
order; "quadratic": also x^2, x y, y^2.

Missing points: what is left takes the values of the harmonic function of its measured neighbours, the
five-point Laplace equation, without flow through the border of the map. It has no maximum of its own: no
asperity is made up.

Resampling: the heights at the centres of the cells are a sum of cosines cos(pi k (i + 1/2)/n), k = 0 .. n - 1
along each side (DCT-II), evaluated at the centres of the other cells; fewer cells leave out the waves that
they cannot hold. That is the Fourier series of the patch mirrored at its sides. A measured patch is not
periodic: without the mirror it would jump from one side to the other, and ring there. What is left is a kink
of the mirrored slope at the sides.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from importlib import import_module

import numpy as np

from sam.arrays import Array
from sam.scene.section import stated
from sam.scene.surface.section import Surface

_TERMS = {
    "tilt": ([(0, 0)], [(1, 0)], [(0, 1)]),
    "sphere": ([(0, 0)], [(1, 0)], [(0, 1)], [(2, 0), (0, 2)]),
    "quadratic": ([(0, 0)], [(1, 0)], [(0, 1)], [(2, 0)], [(1, 1)], [(0, 2)]),
}
"""Form -> its terms, each a sum of x^p y^q."""


@dataclass(frozen=True)
class Roughness:
    """About the mean height: sa, sq in m (mean, root mean square), ssk skewness, sdq slope."""

    sa: float
    sq: float
    ssk: float
    sdq: float


def roughness(heights: Array, hx: float, hy: float) -> Roughness:
    """Areal parameters of heights (nx, ny) in m on cells with sides in m; slopes by central differences,
    one-sided at the edge.

    The skewness of a plane is 0. A form or a tilt is not removed. Points that are nan, and the slopes next to
    them, do not count. Five points on a line of slope 1 deviate from their mean by 2, 1, 0, 1, 2:

    >>> line = roughness(np.arange(5.0)[:, None] * np.ones(3), 1.0, 1.0)
    >>> round(line.sa, 3), round(line.sdq, 3)
    (1.2, 1.0)
    """
    mean = np.nanmean if np.isnan(heights).any() else np.mean
    h = heights - mean(heights)
    sq = float(np.sqrt(mean(h**2)))
    slope_x, slope_y = np.gradient(h, hx, hy) if h.shape[1] > 1 else (np.gradient(h, hx, axis=0), 0 * h)
    return Roughness(
        sa=float(mean(np.abs(h))),
        sq=sq,
        ssk=float(mean((h / sq) ** 3)) if sq > 0 else 0.0,
        sdq=float(np.sqrt(mean(slope_x**2 + slope_y**2))),
    )


def roughness_as_read(surface: Surface) -> Roughness:
    """Roughness of the measured points of a whole file; ValueError for a digest."""
    _check_at_hand(surface)
    return roughness(stated(surface.measured.values), *surface.measured.cell)


def processed(surface: Surface, cells: tuple[int, int]) -> Array:
    """Heights (nx, ny) in m as prepared, read-only; ValueError for other cells or a digest."""
    heights = prepared(surface)
    if heights.shape == tuple(cells):
        return heights
    if surface.resample is None:
        raise ValueError(f"{surface.path!r} has no heights at {cells[0]} x {cells[1]} points")
    return _resampled_surface(surface, tuple(cells))


@lru_cache(maxsize=2)
def _resampled_surface(surface: Surface, cells: tuple[int, int]) -> Array:
    heights = resampled(prepared(surface), cells)
    heights.flags.writeable = False
    return heights


def prepared(surface: Surface) -> Array:
    """Heights of a surface from a file on its own points, form off, filled and cropped, in m; read-only."""
    _check_at_hand(surface)  # before the cache, which knows a surface by its digest
    return _prepared(surface)


@lru_cache(maxsize=2)
def _prepared(surface: Surface) -> Array:
    values = stated(surface.measured.values)
    if surface.form != "none":
        values = values - fitted_form(values, surface.measured.cell, stated(surface.form))
    if surface.missing == "harmonic":
        values = harmonic(values, surface.measured.cell)
    if surface.crop is not None:
        values = values[surface.window]
    values.flags.writeable = False
    return values


def _check_at_hand(surface: Surface) -> None:
    if surface.measured.values is None:
        raise ValueError(f"{surface.path!r} has no heights: only its digest is at hand")


def fitted_form(values: Array, cell: tuple[float, float], form: str) -> Array:
    """The polynomial of least squares, (nx, ny) in m, through heights that are not nan."""
    x, y = (np.arange(n) * h - (n - 1) / 2 * h for n, h in zip(values.shape, cell, strict=True))
    scale = max(x[-1], y[-1])
    of_x, of_y = (np.vander(c / scale, 5, increasing=True) for c in (x, y))
    measured = ~np.isnan(values)
    moments = of_x.T @ measured @ of_y
    terms, total = _TERMS[form], np.zeros(values.shape)
    matrix = np.array(
        [[sum(moments[p + r, q + s] for p, q in a for r, s in b) for b in terms] for a in terms]
    )
    for _ in range(2):
        left = np.where(measured, values - total, 0.0)
        loads = of_x[:, :3].T @ left @ of_y[:, :3]
        solved = np.linalg.lstsq(matrix, [sum(loads[p, q] for p, q in a) for a in terms])[0]
        powers = np.zeros((3, 3))
        for coefficient, term in zip(solved, terms, strict=True):
            powers[tuple(zip(*term, strict=True))] += coefficient
        total += of_x[:, :3] @ powers @ of_y[:, :3].T
    return total


def harmonic(values: Array, cell: tuple[float, float]) -> Array:
    """Heights in m with those that are nan from sum of (h_neighbour - h)/distance^2 = 0."""
    unknown = np.isnan(values)
    if not unknown.any():
        return values
    sparse, linear = import_module("scipy.sparse"), import_module("scipy.sparse.linalg")
    count = int(np.count_nonzero(unknown))
    number = np.where(unknown, np.cumsum(unknown).reshape(unknown.shape) - 1, -1)
    right, entries = np.zeros(count), []
    for axis, weight in enumerate((1.0, (cell[0] / cell[1]) ** 2)):
        ends = (slice(None, -1), slice(1, None))
        for mine, other in (ends, ends[::-1]):
            here, there = (number.swapaxes(0, axis)[part] for part in (mine, other))
            heights = values.swapaxes(0, axis)[other]
            rows, known, both = here[here >= 0], (here >= 0) & (there < 0), (here >= 0) & (there >= 0)
            right += np.bincount(here[known], weights=weight * heights[known], minlength=count)
            entries += [(weight, rows, rows), (-weight, here[both], there[both])]
    data = np.concatenate([np.full(rows.size, weight) for weight, rows, _ in entries])
    places = tuple(np.concatenate([entry[k] for entry in entries]) for k in (1, 2))
    matrix = sparse.coo_matrix((data, places), shape=(count, count)).tocsc()
    factors = linear.splu(matrix, permc_spec="MMD_AT_PLUS_A", options={"SymmetricMode": True})
    filled = values.copy()
    filled[unknown] = factors.solve(right)
    return filled


def resampled(heights: Array, cells: tuple[int, int]) -> Array:
    """Heights (nx, ny) at the centres of the cells of a patch on other cells of the same patch; any unit."""
    fft = import_module("scipy.fft")
    for axis, n in enumerate(cells):
        had = heights.shape[axis]
        if n == had:
            continue
        waves = np.moveaxis(fft.dct(heights, type=2, axis=axis), axis, 0)
        other = np.zeros((n, *waves.shape[1:]))
        other[: min(n, had)] = waves[:n]
        heights = np.moveaxis(fft.idct(other, type=2, axis=0), 0, axis) * (n / had)
    return heights
