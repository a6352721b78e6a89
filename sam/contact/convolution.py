# SPDX-License-Identifier: MIT
"""Discrete convolution of non-periodic influence coefficients by FFT (DC-FFT, Liu, Wang & Liu 2000).

Transform convention: scipy.fft.rfft2 over the last two axes (x, y), no normalisation forward, 1/(m_x m_y)
backward. A field given on a source window is convolved exactly (no wrap-around, no periodic image): the
transform length is at least n_source + n_observed - 1 in each direction, and the lag l = observed - source
sits at index (l - first) mod m, where `first` is the lag between the first cells of both windows.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy import fft

from sam.arrays import Array
from sam.contact.real_transforms import Real, forward, half_length, real_spectrum
from sam.grid.cells import Window

Parities = Iterable[tuple[int, int]]
"""Of each kernel its sign under x -> -x and under y -> -y."""
Parity = NDArray[np.integer[Any]]
"""Of each kind of quantity whether it is odd, 1, or even, 0."""
FEW_ROWS = 2  # of an observed window, up to which sums over y take less time than transforms along y


@dataclass
class Counters:
    """Work done, for `cost` in the results and for tests that gate it: a number of each kind, see
    `sam.scene.COST`.
    """

    ffts: int = 0
    displacement_applications: int = 0
    contact_iterations: int = 0
    operator_applications: int = 0
    plastic_iterations: int = 0
    step_cuts: int = 0
    tangential_kernels: int = 0


def transformed(field: Real, lengths: tuple[int, int]) -> NDArray[Any]:
    """rfft2 of (..., nx, ny) padded to the lengths; rows of zeros are not transformed."""
    found: NDArray[Any] = fft.fft(fft.rfft(field, n=lengths[1], axis=-1), n=lengths[0], axis=-2)
    return found


def cropped(spectrum: NDArray[Any], lengths: tuple[int, int], shape: tuple[int, int]) -> NDArray[Any]:
    """The first cells of irfft2, (..., *shape); other rows are not transformed back. The spectrum is
    overwritten.
    """
    rows = fft.ifft(spectrum, axis=-2, overwrite_x=True)[..., : shape[0], :]
    found: NDArray[Any] = fft.irfft(rows, n=lengths[1], axis=-1)[..., : shape[1]]
    return found


def _lags(first: int, n_source: int, n_observed: int, m: int) -> NDArray[np.intp]:
    """Lag at each index of a transform of length m; the indices that no pair of cells uses repeat a lag that
    exists.
    """
    index = np.arange(m)
    index = np.where(index < n_observed, index, np.maximum(index - m, 1 - n_source))
    return first + index


class Convolution:
    """f on `source` -> sum over source cells of K[observed - source] f, on `observed`, for a stack of kernels
    K.

    The spectra of the kernels are computed once.

    Parameters
    ----------
    kernels
        (..., nx, ny), for the lags >= 0.
    parities
        (sign under x -> -x, under y -> -y) for each of the stack, in order.
    source, observed
        Windows of cells of one grid.
    counters
        Where the transforms are counted.
    """

    def __init__(
        self,
        kernels: Array,
        parities: Parities,
        source: Window,
        observed: Window,
        *,
        counters: Counters | None = None,
    ):
        self.source, self.observed = source, observed
        self.counters = counters if counters is not None else Counters()
        self.lengths = (
            int(fft.next_fast_len(source.nx + observed.nx - 1, real=True)),
            int(fft.next_fast_len(source.ny + observed.ny - 1, real=True)),
        )
        lx = _lags(observed.i0 - source.i0, source.nx, observed.nx, self.lengths[0])
        ly = _lags(observed.j0 - source.j0, source.ny, observed.ny, self.lengths[1])
        px, py = (
            np.array(p, dtype=float).reshape((*kernels.shape[:-2], 1, 1)) for p in zip(*parities, strict=True)
        )
        full = kernels[..., np.abs(lx)[:, None], np.abs(ly)[None, :]]
        sign_x = np.where(lx[:, None] < 0, px, 1.0)
        sign_y = np.where(ly[None, :] < 0, py, 1.0)
        self.spectra = fft.rfft2(full * sign_x * sign_y)
        self.counters.ffts += int(np.prod(kernels.shape[:-2], dtype=int))

    @staticmethod
    def lags_needed(source: Window, observed: Window) -> tuple[int, int]:
        """How many lags >= 0 in x and y a kernel must have for these windows."""

        def needed(o0: int, no: int, s0: int, ns: int) -> int:
            return max(abs(o0 - s0 - (ns - 1)), abs(o0 - s0 + no - 1)) + 1

        return (
            needed(observed.i0, observed.nx, source.i0, source.nx),
            needed(observed.j0, observed.ny, source.j0, source.ny),
        )

    def __call__(self, field: Array) -> Array:
        """field: (nx, ny) on the source window; returns (..., nx, ny) on the observed window."""
        return self._observed(self.spectra * self._transformed(field))

    def summed(self, fields: Array) -> Array:
        """Kernels (m, g, n, nx, ny) with fields of (g, n, nx, ny), summed over g and n: (m, nx, ny)."""
        return self._observed(np.einsum("mgnxy,gnxy->mxy", self.spectra, self._transformed(fields)))

    def _transformed(self, field: Array) -> Array:
        self.counters.ffts += int(np.prod(field.shape[:-2], dtype=int))
        return transformed(field, self.lengths)

    def _observed(self, spectra: Array) -> Array:
        self.counters.ffts += int(np.prod(spectra.shape[:-2], dtype=int))
        return cropped(spectra, self.lengths, self.observed.shape)


def folded(field: Array, at: int, lags: int) -> Array:
    """f(at - l) + f(at + l) and f(at - l) - f(at + l) of the last axis, 0 <= l < lags, each cell once: (2,
    ..., lags).
    """
    n, lag = field.shape[-1], np.arange(lags)
    below, above = at - lag, at + lag
    before = np.where((below >= 0) & (below < n), field[..., below % n], 0.0)
    behind = np.where((above < n) & (above >= 0) & (lag > 0), field[..., above % n], 0.0)
    return np.stack([before + behind, before - behind])


class RowConvolution:
    """The same sums as of `Convolution` for an observed window of few rows: sums over y are taken as they
    stand, transforms are along x alone.

    A field is first folded about the observed row, f(y - l) + parity f(y + l), so that each lag l >= 0 is met
    once. Along x both windows lie in one frame; the transform of a kernel there is real, times -i if it is
    odd in x.
    """

    def __init__(
        self,
        kernels: Array,
        parities: Parities,
        source: Window,
        observed: Window,
        *,
        counters: Counters | None = None,
    ):
        self.source, self.observed = source, observed
        self.counters = counters if counters is not None else Counters()
        self.first = min(source.i0, observed.i0)
        half = half_length(max(source.i0 + source.nx, observed.i0 + observed.nx) - self.first)
        self.length = 2 * half
        sign_x, sign_y = (np.array(p).reshape(kernels.shape[:-2]) for p in zip(*parities, strict=True))
        self.odd_x, self.odd_y = sign_x < 0, sign_y < 0
        self.spectra = np.zeros((*kernels.shape[:-2], half + 1, kernels.shape[-1]))
        for odd in (False, True):
            if (chosen := self.odd_x == odd).any():
                self.spectra[chosen] = forward(kernels[chosen], half, odd, -2)

    def __call__(self, field: Array) -> Array:
        """field: (nx, ny) on the source window; returns (..., nx, rows) on the observed window."""
        out = np.empty((*self.odd_y.shape, *self.observed.shape))
        for row in range(self.observed.ny):
            for odd, folded in zip((False, True), self._folded(field, row), strict=True):
                chosen = self.odd_y == odd
                product = np.einsum("...kl,klc->...kc", self.spectra[chosen], _pairs(folded))
                out[chosen, :, row] = self._back(_complex(product), self.odd_x[chosen])
        return out

    def _folded(self, field: Array, row: int) -> tuple[Array, Array]:
        """Transforms along x of the field folded about an observed row, for kernels even and odd in y, (...,
        k, l).
        """
        lags = self.spectra.shape[-1]
        sums = folded(field, self.observed.j0 + row - self.source.j0, lags)
        framed = np.zeros((2, *field.shape[:-2], self.source.nx + self.source.i0 - self.first, lags))
        framed[..., self.source.i0 - self.first :, :] = sums
        even, odd = fft.rfft(framed, n=self.length, axis=-2)
        return even, odd

    def _back(self, spectra: Array, odd_x: Array) -> Array:
        """(..., k) -> (..., nx) of the observed window."""
        spectra = np.where(np.asarray(odd_x)[..., None], -1j, 1.0) * spectra
        start = self.observed.i0 - self.first
        found: Array = fft.irfft(spectra, n=self.length, axis=-1)[..., start : start + self.observed.nx]
        return found


def _pairs(field: Array) -> Array:
    """Complex numbers as pairs in a last axis: products with real coefficients then stay real."""
    return np.ascontiguousarray(field).view(float).reshape(*field.shape, 2)


def _complex(pairs: Array) -> Array:
    return np.ascontiguousarray(pairs).view(complex)[..., 0]


def convolution_onto(
    kernels: Array,
    parities: Parities,
    source: Window,
    observed: Window,
    *,
    counters: Counters | None = None,
) -> RowConvolution | Convolution:
    """The cheaper of `RowConvolution` and `Convolution`.

    Parameters
    ----------
    kernels, parities, source, observed, counters
        As of `Convolution`.

    Returns
    -------
    RowConvolution or Convolution
        A field on `source` -> the sums on `observed`.
    """
    kind = RowConvolution if observed.ny <= FEW_ROWS else Convolution
    return kind(kernels, parities, source, observed, counters=counters)


def row_sums(
    kernels: Array, fields: Array, source: Window, observed: Window, *, odd_out: Parity, odd_in: Parity
) -> Array:
    """Kernels times fields, summed over components, layers and cells, on an observed window of few rows.

    No transform is needed: the fields are folded about a row, their products with the kernels taken for every
    lag in x, and summed along x - x' = lag.

    Parameters
    ----------
    kernels
        (m, g, z, n, lags in x, lags in y).
    fields
        (g, n, nx, ny) on the source window.
    source, observed
        Windows of the fields and of the answer.
    odd_out, odd_in
        (2, m) and (2, g), whether each of m and of g is odd in x, in y; a kernel is odd where they differ.
        Each kind is a run of neighbours.

    Returns
    -------
    Array
        (m, z, nx, rows).
    """
    (m, _, depths, *_, lags_x, lags_y), columns = kernels.shape, np.arange(source.nx)
    lag = np.subtract.outer(observed.i0 + np.arange(observed.nx), source.i0 + columns)
    out = np.zeros((m, depths, *observed.shape))
    for row in range(observed.ny):
        sums = folded(fields, observed.j0 + row - source.j0, lags_y)
        for odd_x, odd_y, other_x in np.ndindex(2, 2, 2):
            of_out, of_in = _run((odd_out[0] == odd_x) & (odd_out[1] == odd_y)), _run(odd_in[0] == other_x)
            met = sums[odd_in[1][of_in] ^ odd_y, np.arange(len(fields))[of_in]]
            if of_out.start == of_out.stop or not met.any():  # by symmetry
                continue
            some = kernels[of_out, of_in].transpose(0, 2, 4, 1, 3, 5)
            by_lag = some.reshape(-1, met[..., 0, :].size) @ met.swapaxes(-1, -2).reshape(-1, source.nx)
            terms = by_lag.reshape(-1, depths, lags_x, source.nx)[..., np.abs(lag), columns]
            out[of_out, ..., row] += (terms * np.where(lag < 0, (-1) ** (odd_x + other_x), 1)).sum(axis=-1)
    return out


def _run(chosen: Array) -> slice:
    """The true entries, neighbours, as a slice."""
    where = np.flatnonzero(chosen)
    return slice(int(where[0]), int(where[-1]) + 1) if where.size else slice(0, 0)


class BoxConvolution:
    """f on a box of cells -> sum over its cells of K[lag] f, on the same box; K even in x and in y, so its
    transform is real.

    kernel: lags >= 0, at least (nx, ny) of them, whose transform is not counted, as it is made when first
    needed. Works in double, or on request in single precision: then good to about 1e-6 of the largest value,
    in half the time.
    """

    def __init__(self, kernel: Real, shape: tuple[int, int], counters: Counters):
        self.shape, self.counters = shape, counters
        half = half_length(shape[0]), half_length(shape[1])
        self.lengths = 2 * half[0], 2 * half[1]
        self.spectrum = self._spectrum(kernel[: shape[0], : shape[1]], half)

    def _spectrum(self, kernel: Real, half: tuple[int, int]) -> Real:
        """The real transform of the kernel at all wave numbers along x, and those >= 0 along y."""
        index = np.arange(self.lengths[0])
        return real_spectrum(kernel, half, (0, 0))[np.minimum(index, self.lengths[0] - index)]

    @cached_property
    def _single(self) -> Real:
        return self.spectrum.astype(np.float32)

    def __call__(self, field: Array) -> Array:
        """field: (nx, ny)."""
        return self._apply(field, self.spectrum)

    def single(self, field: Array) -> Array:
        """The same, computed in single precision; the field is scaled first, so that its unit does not
        matter.
        """
        scale = max(field.max(), -field.min()) or 1.0
        found: Array = scale * self._apply((field / scale).astype(np.float32), self._single)
        return found

    def _apply(self, field: Real, spectrum: Real) -> NDArray[Any]:
        self.counters.ffts += 2
        product = transformed(field, self.lengths)
        product *= spectrum
        return cropped(product, self.lengths, self.shape)
