# SPDX-License-Identifier: MIT
"""Discrete convolution of non-periodic influence coefficients by FFT (DC-FFT, Liu, Wang & Liu 2000).

Transform convention: scipy.fft.rfft2 over the last two axes (x, y), no normalisation forward, 1/(m_x m_y)
backward. A field given on a source window is convolved exactly (no wrap-around, no periodic image): the
transform length is at least n_source + n_observed - 1 in each direction, and the lag l = observed - source
sits at index (l - first) mod m, where `first` is the lag between the first cells of both windows.

Cosine and sine sums (`forward`, `back`) transform what is even or odd about a point from the half of it that
is kept: the n values at j = 0 .. n - 1 from the point outward, or, `between`, at j + 1/2 (a row of an even
number of cells). The transform over the 2 half values about the point, those not given zero, is (-i)^odd
times half + 1 real numbers. With the angle a = pi m/half of wave number m, m = 0 .. half, they are f_0 + 2
sum_j f_j cos(j a) for even f and 2 sum_j f_j sin(j a) for odd, or with j + 1/2 in place of j 2 sum_j f_j cos
and sin.

Up to SHORT products a row, values times wave numbers, they are products with matrices, which take less time
than fast transforms.

`Transforms` have as many numbers for each wave number >= 0 as the symmetry of the scene leaves. Fields are
(n, ..., nx, ny), each of the n even or odd under x -> -x and under y -> -y as a kind of quantity (a shear
stress 13 is odd in x). A mirrored scene has mirrored fields: of them only the half from the middle outward is
kept, and sine and cosine sums take the place of complex transforms. The transform over the lags -N .. N-1 of
a kept field is (-i)^odd times a real number.

`columns` gives (N_x + 1, N_y + 1, n, ..., r) real numbers, times (-i)^(odd_x + odd_y): r = 4 without a mirror
(real and imaginary part at (k_x, k_y) and (-k_x, k_y)), 2 with one in y, 1 with both. `fields` takes such
columns back, (-i)^(odd_x + odd_y) less.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cache, cached_property, lru_cache
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy import fft

from sam.arrays import Array
from sam.grid.cells import Window

Real = NDArray[np.floating[Any]]
"""Real numbers in single or double precision."""
SHORT = 25000  # products a row, 110 values times 220 wave numbers: up to here they beat a fast transform

FEW_CELLS = 625  # of a box: up to here the matrix of all pairs beats transforms (25 us against 60 of 25 x 25)


class _Sum(NamedTuple):
    """Which of the sums of the module's text, or of their inverses."""

    odd: bool
    between: bool
    inverse: bool


def half_length(n: int) -> int:
    """Half the length of an even transform of n cells with lags -n .. n: at least n, a product of small
    primes.

    >>> half_length(65)
    72
    """
    return int(fft.next_fast_len(n, real=True))


def forward(kept: Real, half: int, odd: bool, axis: int, *, between: bool = False) -> Real:
    """Transform (..., n) or (..., n, m) kept values to half + 1 numbers, between or at points."""
    n = min(kept.shape[axis], half if between else half + 1)
    if n < kept.shape[axis]:
        kept = kept[..., :n] if axis == -1 else kept[..., :n, :]
    if n * half > SHORT:
        return _fast_forward(kept, half, axis, _Sum(odd, between, False))
    return _product(kept, _matrix(n, half, _Sum(odd, between, False), kept.dtype), axis)


def back(spectrum: Real, n: int, odd: bool, axis: int, *, between: bool = False) -> Real:
    """The inverse of `forward`: n values from half + 1 numbers along axis -1 or -2."""
    half = spectrum.shape[axis] - 1
    if n * half > SHORT:
        return _fast_back(spectrum, n, axis, _Sum(odd, between, True))
    return _product(spectrum, _matrix(n, half, _Sum(odd, between, True), spectrum.dtype), axis)


def real_spectrum(kernel: Real, half: tuple[int, int], odd: Sequence[bool | int]) -> Real:
    """Transform of lags >= 0 without its phase (-i)^(o_x + o_y), o = 1 for odd."""
    for axis, (length, is_odd) in enumerate(zip(half, odd, strict=True), start=-2):
        kernel = forward(kernel, length, bool(is_odd), axis)
    return kernel


def _product(field: Real, matrix: Real, axis: int) -> Real:
    """The matrix applied to the rows or to the columns of a field."""
    return field @ matrix if axis == -1 else matrix.T @ field


@lru_cache(maxsize=64)
def _matrix(n: int, half: int, kind: _Sum, real: np.dtype[np.floating[Any]]) -> Real:
    """The matrix by which a row of numbers is multiplied from the left in `forward` or `back`."""
    twice = 2 * np.arange(n) + kind.between  # twice the place
    turns = np.outer(twice, np.arange(half + 1)) % (4 * half)  # of the angle, in pi/(2 half)
    angle = np.pi / (2 * half) * turns
    waves = np.where(turns % (2 * half) == 0, 0.0, np.sin(angle)) if kind.odd else np.cos(angle)
    if kind.inverse:
        ends = np.isin(np.arange(half + 1), (0, half))
        return (np.where(ends, 1, 2) * waves / (2 * half)).T.astype(real)
    itself = np.isin(twice, (0, 2 * half))  # its own mirror image
    return (np.where(itself, 1, 2)[:, None] * waves).astype(real)


def _fast_forward(kept: Real, half: int, axis: int, kind: _Sum) -> Real:
    """`forward` by fast sine and cosine transforms."""
    zero: Real = np.zeros_like(np.take(kept, [0], axis=axis))
    if kind.between:
        sums = (fft.dst if kind.odd else fft.dct)(kept, type=2, n=half, axis=axis)
        parts = [zero, sums] if kind.odd else [sums, zero]
    elif kind.odd:
        inner = np.take(kept, range(1, min(kept.shape[axis], half)), axis=axis)
        parts = [zero, fft.dst(inner, type=1, n=half - 1, axis=axis), zero]
    else:
        return fft.dct(kept, type=1, n=half + 1, axis=axis)
    return np.concatenate(parts, axis=axis)


def _fast_back(spectrum: Real, n: int, axis: int, kind: _Sum) -> Real:
    """`back` by fast sine and cosine transforms."""
    half = spectrum.shape[axis] - 1
    values: Real
    if kind.between:
        part = np.take(spectrum, range(kind.odd, half + kind.odd), axis=axis)
        values = (fft.dst if kind.odd else fft.dct)(part, type=3, axis=axis)
    elif kind.odd:
        inner = fft.dst(np.take(spectrum, range(1, half), axis=axis), type=1, axis=axis)
        values = np.concatenate([np.zeros_like(np.take(inner, [0], axis=axis)), inner], axis=axis)
    else:
        values = fft.dct(spectrum, type=1, axis=axis)
    return np.take(values, range(n), axis=axis) / (2 * half)


Parities = Iterable[tuple[int, int]]
"""Of each kernel its sign under x -> -x and under y -> -y."""
Parity = NDArray[np.integer[Any]]
"""Of each kind of quantity whether it is odd, 1, or even, 0."""
FEW_ROWS = 2  # of an observed window, up to which sums over y take less time than transforms along y


@dataclass
class Counters:
    """Work done, for `cost` in the results: a number of each kind, see `sam.scene.COST`."""

    ffts: int = 0
    displacement_applications: int = 0
    contact_iterations: int = 0
    operator_applications: int = 0
    plastic_iterations: int = 0
    step_cuts: int = 0
    tangential_kernels: int = 0


def transformed(field: Real, lengths: tuple[int, int]) -> NDArray[Any]:
    """rfft2 of (..., nx, ny) padded to the lengths; rows of zeros are not transformed."""
    return fft.fft(fft.rfft(field, n=lengths[1], axis=-1), n=lengths[0], axis=-2)


def cropped(spectrum: NDArray[Any], lengths: tuple[int, int], shape: tuple[int, int]) -> NDArray[Any]:
    """The first cells of irfft2, (..., *shape), other rows are left out; the spectrum is overwritten."""
    rows = fft.ifft(spectrum, axis=-2, overwrite_x=True)[..., : shape[0], :]
    return fft.irfft(rows, n=lengths[1], axis=-1)[..., : shape[1]]


def _lags(first: int, n_source: int, n_observed: int, m: int) -> NDArray[np.intp]:
    """Lag at each index of a transform of length m; indices that no pair of cells uses repeat a lag."""
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
    """f(at - l) + f(at + l) and f(at - l) - f(at + l) of the last axis, each cell once: (2, ..., lags)."""
    n, lag = field.shape[-1], np.arange(lags)
    below, above = at - lag, at + lag
    before = np.where((below >= 0) & (below < n), field[..., below % n], 0.0)
    behind = np.where((above < n) & (above >= 0) & (lag > 0), field[..., above % n], 0.0)
    return np.stack([before + behind, before - behind])


class RowConvolution:
    """The sums of `Convolution` for few rows: a field is folded about the row, f(y - l) + parity
    f(y + l), and transformed along x alone, where kernels are real, times -i if odd.
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
                # complex numbers as pairs: products with real coefficients then stay real
                pairs = np.ascontiguousarray(folded).view(float).reshape(*folded.shape, 2)
                product = np.einsum("...kl,klc->...kc", self.spectra[chosen], pairs)
                product = np.ascontiguousarray(product).view(complex)[..., 0]
                out[chosen, :, row] = self._back(product, self.odd_x[chosen])
        return out

    def _folded(self, field: Array, row: int) -> tuple[Array, Array]:
        """Transforms along x of the field folded about an observed row, even and odd in y, (..., k, l)."""
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
        return fft.irfft(spectra, n=self.length, axis=-1)[..., start : start + self.observed.nx]


def convolution_onto(
    kernels: Array,
    parities: Parities,
    source: Window,
    observed: Window,
    *,
    counters: Counters | None = None,
) -> RowConvolution | Convolution:
    """A field on `source` -> the sums on `observed`: the cheaper of both convolutions above."""
    kind = RowConvolution if observed.ny <= FEW_ROWS else Convolution
    return kind(kernels, parities, source, observed, counters=counters)


def row_sums(
    kernels: Array, fields: Array, source: Window, observed: Window, *, odd_out: Parity, odd_in: Parity
) -> Array:
    """Kernels (m, g, z, n, lags in x, lags in y) times fields (g, n, nx, ny), summed over
    components, layers and cells on few rows: (m, z, nx, rows), folded, without a transform;
    odd_out, odd_in: (2, m), (2, g).
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
    """f -> sum over the cells of a box of K[lag] f on it, K even in x and y and real; of a field in single
    precision good to 1e-6 of the largest value in half the time.

    Columns are followed by as many zeros: their transform over 2 N values is that of f over N at the even
    wave numbers, and at the odd ones that of f exp(-i pi j/N), which takes less time than one over 2 N.
    """

    def __init__(self, kernel: Real, shape: tuple[int, int], counters: Counters):
        self.shape, self.counters = shape, counters
        half = half_length(shape[0]), half_length(shape[1])
        self.lengths = 2 * half[0], 2 * half[1]
        self.turn = np.exp(-1j * np.pi / half[0] * np.arange(half[0]))[:, None]
        self.spectrum = self._spectrum(kernel[: shape[0], : shape[1]], half)

    def _spectrum(self, kernel: Real, half: tuple[int, int]) -> Real:
        """Half the real transform of the kernel at even and odd wave numbers along x, those >= 0 along y."""
        index = np.arange(self.lengths[0]).reshape(-1, 2).T
        return real_spectrum(kernel / 2, half, (0, 0))[np.minimum(index, self.lengths[0] - index)]

    @cached_property
    def _single(self) -> Real:
        return self.spectrum.astype(np.float32)

    def __call__(self, field: Real) -> NDArray[Any]:
        """field: (nx, ny)."""
        self.counters.ffts += 2
        return self._apply(field, self._single if field.dtype == np.float32 else self.spectrum)

    def _apply(self, field: Real, spectrum: Real) -> NDArray[Any]:
        even = fft.rfft(field, n=self.lengths[1], axis=-1)
        turn = self.turn.astype(even.dtype)
        odd = turn[: len(field)] * even
        even, odd = (self._columns(*each) for each in zip((even, odd), spectrum, strict=True))
        odd *= turn.conj()
        even += odd
        return fft.irfft(even[: self.shape[0]], n=self.lengths[1], axis=-1)[:, : self.shape[1]]

    @staticmethod
    def _columns(rows: NDArray[Any], spectrum: Real) -> NDArray[Any]:
        """The columns, their transform multiplied by a real one."""
        columns = fft.fft(rows, n=len(spectrum), axis=-2, overwrite_x=True)
        columns *= spectrum
        return fft.ifft(columns, axis=-2, overwrite_x=True)


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
    """The quarter of a mirrored field, its transform multiplied by a real one, (N_x + 1, N_y + 1)."""
    between, sizes = [n % 2 == 0 for n in cells], kept.shape
    for axis in (-1, -2):
        kept = forward(kept, spectrum.shape[axis] - 1, False, axis, between=between[axis])
    kept *= spectrum
    for axis in (-2, -1):
        kept = back(kept, sizes[axis], False, axis, between=between[axis])
    return kept


class DirectConvolution(BoxConvolution):
    """The same for few cells, by the matrix of all pairs."""

    def _spectrum(self, kernel: Real, half: tuple[int, int]) -> Real:
        return between_pairs(kernel)

    def _apply(self, field: Real, spectrum: Real) -> NDArray[Any]:
        return (spectrum @ field.ravel()).reshape(field.shape)


def between_pairs(kernel: Real) -> Real:
    """The matrix (cells, cells) of an even kernel at lags >= 0, (nx, ny), between the cells of a box."""
    x, y = (np.abs(np.subtract.outer(*[np.arange(n)] * 2)) for n in kernel.shape)
    return np.asarray(kernel[x[:, None, :, None], y[:, None]].reshape(kernel.size, kernel.size))


class MirroredConvolution(BoxConvolution):
    """The same for fields that are mirrored in x and in y, given on the quarter from the middle outward."""

    def _spectrum(self, kernel: Real, half: tuple[int, int]) -> Real:
        return real_spectrum(kernel, half, (0, 0))

    def _apply(self, field: Real, spectrum: Real) -> NDArray[Any]:
        return filtered(field, self.shape, spectrum)


class PeriodicConvolution(BoxConvolution):
    """The same on all cells of a period, by the transform of a kernel that repeats with it; mirrored: as
    above.
    """

    def __init__(self, spectrum: Real, shape: tuple[int, int], mirrored: bool, counters: Counters):
        self.spectrum, self.shape, self.mirrored, self.counters = spectrum, shape, mirrored, counters

    def _apply(self, field: Real, spectrum: Real) -> NDArray[Any]:
        if self.mirrored:
            return filtered(field, self.shape, spectrum)
        found = transformed(field, self.shape)
        found *= spectrum
        return cropped(found, self.shape, self.shape)


def _by_parity(field: Real, odd: Parity, *, n: int, half: int, axis: int, inverse: bool = False) -> Real:
    """Transform each field along an axis by its parity; odd: of each entry; n: cells, half are kept."""
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
    """Transforms of fields on a box, mirrored in x (with y) and in y; half: the N of the text; periodic: of
    all cells of a period, of which N are half; wraps: padded, but what is given repeats along y.
    """

    wraps = False

    def __init__(
        self,
        cells: tuple[int, int],
        mirror: tuple[bool, bool],
        *,
        single: bool,
        counters: Counters,
        periodic: bool = False,
    ):
        self.cells, self.mirror, self.counters, self.periodic = cells, mirror, counters, periodic
        self.half = half_length(cells[0]), half_length(cells[1])
        if periodic:
            self.half = cells[0] // 2, cells[1] // 2
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
            cells_first = np.ascontiguousarray(np.moveaxis(field, (-2, -1), (0, 1)))
            rows = fft.rfft(cells_first, n=self.lengths[1], axis=1)  # rows of zeros need none
            spectrum = fft.fft(rows, n=self.lengths[0], axis=0, overwrite_x=True)
            columns = np.empty((self.half[0] + 1, *spectrum.shape[1:], 2), dtype=self.complex)
            phases = self._phases(odd_x, odd_y, field.ndim - 3)
            np.multiply(spectrum[: self.half[0] + 1], phases[..., 0], out=columns[..., 0])
            np.multiply(spectrum[self._flip], phases[..., 1], out=columns[..., 1])
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
            both, phases = columns.view(self.complex), self._phases(odd_x, odd_y, columns.ndim - 4)
            spectrum = np.empty((self.lengths[0], *both.shape[1:-1]), dtype=self.complex)
            spectrum[self._flip] = both[..., 1] * phases[..., 1]
            np.multiply(both[..., 0], phases[..., 0], out=spectrum[: self.half[0] + 1])
            # no other rows are wanted
            rows = fft.ifft(spectrum, axis=0, overwrite_x=True)[: self.cells[0]]
            found: Real = fft.irfft(rows, n=self.lengths[1], axis=1)[:, : self.cells[1]]
            return np.ascontiguousarray(np.moveaxis(found, (0, 1), (-2, -1)))
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
