# SPDX-License-Identifier: MIT
"""Transforms of fields on a box, with as many numbers for each wave number >= 0 as the symmetry of the scene
leaves.

Fields are (n, ..., nx, ny), each of the n even or odd under x -> -x and under y -> -y as a kind of quantity
(a shear stress 13 is odd in x). A mirrored scene has mirrored fields: of them only the half from the middle
outward is kept, and sine and cosine sums take the place of complex transforms. The transform over the lags -N
.. N-1 of a kept field is (-i)^odd times a real number.

`columns` gives (N_x + 1, N_y + 1, n, ..., r) real numbers, times (-i)^(odd_x + odd_y): r = 4 without a mirror
(real and imaginary part at (k_x, k_y) and (-k_x, k_y)), 2 with one in y, 1 with both. `fields` takes such
columns back, (-i)^(odd_x + odd_y) less.
"""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy import fft

from sam.contact.convolution import BoxConvolution, Counters, Parity
from sam.contact.real_transforms import Real, back, forward, half_length, real_spectrum

Complex = NDArray[np.complexfloating[Any, Any]]
"""Complex numbers in single or double precision."""


def mirror_half(n: int) -> slice:
    """The cells from the middle outward, of n in a row."""
    return slice(n // 2, n)


@cache
def unfolded(n: int) -> NDArray[np.intp]:
    """The cell of `mirror_half` that each of n cells in a row is equal to."""
    cell = np.arange(n) - n // 2
    return np.where(cell < 0, n % 2 - 1 - cell, cell)


def filtered(kept: Real, cells: tuple[int, int], spectrum: Real) -> Real:
    """The kept quarter of a mirrored field on the cells, its transform multiplied by a real one, (N_x + 1,
    N_y + 1).
    """
    between, sizes = [n % 2 == 0 for n in cells], kept.shape
    for axis in (-1, -2):
        kept = forward(kept, spectrum.shape[axis] - 1, False, axis, between=between[axis])
    kept *= spectrum
    for axis in (-2, -1):
        kept = back(kept, sizes[axis], False, axis, between=between[axis])
    return kept


class MirroredConvolution(BoxConvolution):
    """The same for fields that are mirrored in x and in y, given on the quarter from the middle outward that
    is kept of them.
    """

    def _spectrum(self, kernel: Real, half: tuple[int, int]) -> Real:
        return real_spectrum(kernel, half, (0, 0))

    def _apply(self, field: Real, spectrum: Real) -> NDArray[Any]:
        self.counters.ffts += 2
        return filtered(field, self.shape, spectrum)


def _by_parity(field: Real, odd: Parity, *, n: int, half: int, axis: int, inverse: bool = False) -> Real:
    """Transform each field along an axis by its parity, with `forward` or `back`.

    odd: of each entry of the first axis; n: cells along the axis, of which half are kept.
    """
    shape = list(field.shape)
    shape[axis] = n - n // 2 if inverse else half + 1
    out = np.empty(shape, dtype=field.dtype)
    for which in (False, True):
        if (chosen := odd == which).any():
            part, between = field[chosen], n % 2 == 0
            if inverse:
                out[chosen] = back(part, shape[axis], which, axis, between=between)
            else:
                out[chosen] = forward(part, half, which, axis, between=between)
    return out


class Transforms:
    """Transforms of fields on a box of nx x ny cells.

    mirror: whether the fields are mirrored in x and in y (x only
    together with y).

    shape: of a kept field; half: the N of the module's text; single: whether in single precision.
    """

    def __init__(
        self, cells: tuple[int, int], mirror: tuple[bool, bool], *, single: bool, counters: Counters
    ):
        self.cells, self.mirror, self.counters = cells, mirror, counters
        self.half = half_length(cells[0]), half_length(cells[1])
        self.lengths = 2 * self.half[0], 2 * self.half[1]
        self.real: type[np.floating[Any]] = np.float32 if single else np.float64
        self.complex: type[np.complexfloating[Any, Any]] = np.complex64 if single else np.complex128
        self.kept = tuple(mirror_half(n) if m else slice(n) for n, m in zip(self.cells, mirror, strict=True))
        self.shape = len(range(cells[0])[self.kept[0]]), len(range(cells[1])[self.kept[1]])
        self._flip = -np.arange(self.half[0] + 1) % self.lengths[0]

    def keep(self, field: Real) -> Real:
        """The kept part of (..., nx, ny)."""
        return field[(..., *self.kept)]

    def whole(self, kept: Real, odd_x: Parity, odd_y: Parity) -> Real:
        """(n, ..., nx, ny) from its kept part."""
        for axis, odd in ((-2, odd_x), (-1, odd_y)):
            if self.mirror[axis]:
                n = self.cells[axis]
                kept = np.take(kept, unfolded(n), axis=axis)
                np.moveaxis(kept, axis, 1)[odd == 1, : n // 2] *= -1
        return kept

    def columns(self, field: Real, odd_x: Parity, odd_y: Parity) -> Real:
        """(n, ..., nx, ny), kept, to (N_x + 1, N_y + 1, n, ..., r)."""
        self.counters.ffts += int(np.prod(field.shape[:-2], dtype=int))
        field = field.astype(self.real, copy=False)
        if not self.mirror[1]:
            rows = fft.rfft(field, n=self.lengths[1], axis=-1)  # rows of zeros need none
            spectrum = fft.fft(rows, n=self.lengths[0], axis=-2)
            both = np.stack([spectrum[..., : self.half[0] + 1, :], spectrum[..., self._flip, :]], axis=-1)
            columns = np.ascontiguousarray(np.moveaxis(both, (-3, -2), (0, 1)))
            columns *= self._phases(odd_x, odd_y, field.ndim - 3)
            return columns.view(self.real)
        rows = _by_parity(field, odd_y, n=self.cells[1], half=self.half[1], axis=-1)
        sign = np.where(odd_y, -1, 1).reshape(-1, *[1] * (field.ndim - 1)).astype(self.real)  # (-i)(-i)
        if self.mirror[0]:
            sign = sign * np.where(odd_x, -1, 1).reshape(sign.shape).astype(self.real)
            spectrum = sign * _by_parity(rows, odd_x, n=self.cells[0], half=self.half[0], axis=-2)
            return np.ascontiguousarray(np.moveaxis(spectrum, (-2, -1), (0, 1)))[..., None]
        spectrum = fft.rfft(rows, n=self.lengths[0], axis=-2) * (sign * self._phase_x(odd_x, field.ndim))
        return np.ascontiguousarray(np.moveaxis(spectrum, (-2, -1), (0, 1)))[..., None].view(self.real)

    def fields(self, columns: Real, odd_x: Parity, odd_y: Parity) -> Real:
        """(N_x + 1, N_y + 1, n, ..., r) to (n, ..., nx, ny), kept."""
        self.counters.ffts += int(np.prod(columns.shape[2:-1], dtype=int))
        if not self.mirror[1]:
            phased = columns.view(self.complex) * self._phases(odd_x, odd_y, columns.ndim - 4)
            spectrum = np.empty((*phased.shape[2:-1], self.lengths[0], phased.shape[1]), dtype=self.complex)
            both = np.moveaxis(phased, (0, 1), (-3, -2))
            spectrum[..., self._flip, :] = both[..., 1]
            spectrum[..., : self.half[0] + 1, :] = both[..., 0]
            # no other rows are wanted
            rows = fft.ifft(spectrum, axis=-2, overwrite_x=True)[..., : self.cells[0], :]
            found: Real = fft.irfft(rows, n=self.lengths[1], axis=-1)[..., : self.cells[1]]
            return found
        if self.mirror[0]:
            spectrum = np.ascontiguousarray(np.moveaxis(columns[..., 0], (0, 1), (-2, -1)))
            rows = _by_parity(spectrum, odd_x, n=self.cells[0], half=self.half[0], axis=-2, inverse=True)
        else:
            spectrum = np.moveaxis(columns.view(self.complex)[..., 0], (0, 1), (-2, -1))
            spectrum = spectrum * self._phase_x(odd_x, spectrum.ndim)
            rows = fft.irfft(spectrum, n=self.lengths[0], axis=-2)[..., : self.cells[0], :]
        return _by_parity(rows, odd_y, n=self.cells[1], half=self.half[1], axis=-1, inverse=True)

    def _phase_x(self, odd_x: Parity, ndim: int) -> Complex:
        return np.where(odd_x, -1j, 1).reshape(-1, *[1] * (ndim - 1)).astype(self.complex)

    def _phases(self, odd_x: Parity, odd_y: Parity, between: int) -> Complex:
        """(-i)^(odd_x + odd_y) at k_x and at -k_x, (n, ..., 2)."""
        phase = (-1j) ** (np.asarray(odd_x) + np.asarray(odd_y))
        both = np.stack([phase, phase * (-1.0) ** np.asarray(odd_x)], axis=-1)
        return both.reshape(len(both), *[1] * between, 2).astype(self.complex)
