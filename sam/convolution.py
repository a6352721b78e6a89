# SPDX-License-Identifier: MIT
"""Discrete convolution of non-periodic influence coefficients by FFT (DC-FFT, Liu, Wang & Liu 2000).

Transform convention: scipy.fft.rfft2 over the last two axes (x, y), no normalisation forward, 1/(m_x m_y) backward. A
field given on a source window is convolved exactly (no wrap-around, no periodic image): the transform length is at
least n_source + n_observed - 1 in each direction, and the lag l = observed - source sits at index (l - first) mod m,
where `first` is the lag between the first cells of both windows.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import fft


@dataclass
class Counters:
    """Work done, for `cost` in the results and for tests that gate it."""

    ffts: int = 0
    displacement_applications: int = 0
    contact_iterations: int = 0
    operator_applications: int = 0
    plastic_iterations: int = 0
    step_cuts: int = 0
    tangential_kernels: int = 0


@dataclass(frozen=True)
class Window:
    """Cells i0 <= i < i0 + nx, j0 <= j < j0 + ny of a grid."""

    i0: int
    j0: int
    nx: int
    ny: int

    @property
    def slices(self) -> tuple[slice, slice]:
        return slice(self.i0, self.i0 + self.nx), slice(self.j0, self.j0 + self.ny)

    @property
    def shape(self) -> tuple[int, int]:
        return self.nx, self.ny


def _lags(first: int, n_source: int, n_observed: int, m: int) -> np.ndarray:
    """Lag at each index of a transform of length m; the indices that no pair of cells uses repeat a lag that exists."""
    index = np.arange(m)
    index = np.where(index < n_observed, index, np.maximum(index - m, 1 - n_source))
    return first + index


class Convolution:
    """f on `source` -> sum over source cells of K[observed - source] f, on `observed`, for a stack of kernels K.

    kernels: (..., nx, ny), the lags >= 0; parities: (sign under x -> -x, under y -> -y) for each of the stack, in
    order. The spectra are computed once.
    """

    def __init__(
        self, kernels: np.ndarray, parities, source: Window, observed: Window, counters: Counters | None = None
    ):
        self.source, self.observed = source, observed
        self.counters = counters if counters is not None else Counters()
        self.lengths = [
            fft.next_fast_len(ns + no - 1, real=True) for ns, no in zip(source.shape, observed.shape, strict=True)
        ]
        lx = _lags(observed.i0 - source.i0, source.nx, observed.nx, self.lengths[0])
        ly = _lags(observed.j0 - source.j0, source.ny, observed.ny, self.lengths[1])
        px, py = (np.array(p, dtype=float).reshape((*kernels.shape[:-2], 1, 1)) for p in zip(*parities, strict=True))
        full = kernels[..., np.abs(lx)[:, None], np.abs(ly)[None, :]]
        sign_x = np.where(lx[:, None] < 0, px, 1.0)
        sign_y = np.where(ly[None, :] < 0, py, 1.0)
        self.spectra = fft.rfft2(full * sign_x * sign_y)
        self.counters.ffts += int(np.prod(kernels.shape[:-2], dtype=int))

    @staticmethod
    def lags_needed(source: Window, observed: Window) -> tuple[int, int]:
        """How many lags >= 0 in x and y a kernel must have for these windows."""

        def needed(o0, no, s0, ns):
            return max(abs(o0 - s0 - (ns - 1)), abs(o0 - s0 + no - 1)) + 1

        return (
            needed(observed.i0, observed.nx, source.i0, source.nx),
            needed(observed.j0, observed.ny, source.j0, source.ny),
        )

    def __call__(self, field: np.ndarray) -> np.ndarray:
        """field: (nx, ny) on the source window; returns (..., nx, ny) on the observed window."""
        return self._observed(self.spectra * self._transformed(field))

    def summed(self, fields: np.ndarray) -> np.ndarray:
        """Kernels (..., n, nx, ny) each with its field of (n, nx, ny), summed over n: (..., nx, ny)."""
        return self._observed(np.einsum("...nxy,nxy->...xy", self.spectra, self._transformed(fields)))

    def _transformed(self, field: np.ndarray) -> np.ndarray:
        self.counters.ffts += int(np.prod(field.shape[:-2], dtype=int))
        return fft.rfft2(field, s=self.lengths)

    def _observed(self, spectra: np.ndarray) -> np.ndarray:
        self.counters.ffts += int(np.prod(spectra.shape[:-2], dtype=int))
        return fft.irfft2(spectra, s=self.lengths)[..., : self.observed.nx, : self.observed.ny]
