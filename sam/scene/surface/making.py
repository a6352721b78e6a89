# SPDX-License-Identifier: MIT
"""Heights of a surface on a patch. Generated ones are sums of waves, so that the same surface can be had on
any grid.

Self-affine: waves that are periodic over the extent, wave vectors q = 2 pi (m/Lx, n/Ly), with random phases;
the power of each is 1 for wavelengths above cutoff_long, falls like q^(-2-2H) below (H: Hurst exponent;
Persson et al. 2005) and is 0 below cutoff_short. The wavelengths are those of q* = (q_x, anisotropy q_y):
along y, the lay, all are longer by this factor. The phases are drawn in shells max(|m|, |n|) = 1, 2, ...:
neither the grid nor a cut-off changes those of the longer waves.

Hard-turned: sqrt(f) marks + sqrt(1 - f) self-affine (f: feed_share), each part with its own heights: the
marks are arcs of the tool's nose, x^2/(2 nose_radius) about the middle of each period `feed` (ideal Ra 0.0321
feed^2/nose_radius), the self-affine part has the Ra that the whole will have. The marks vary along x: sliding
is across the lay, which the paper (Bosman & Schipper 2011, Fig. 12) leaves open. A cusp lies at x = 0, so
that the ridges between the marks are inside of the patch; a feed longer than the patch is cut by it. Cusps
are rounded: the arcs are Fourier series up to cutoff_short.

Means are taken off and the heights scaled (to Ra or Sq) on a sampling of the surface that does not depend on
the grid.

The border of a rough patch may fall off afterwards, so that the contact ends before the patch does: a patch
cut out of a surface ends in ridges that go on in reality. On a half-space they carry what the end of a punch
carries, a pressure without bound at finer and finer cells.

Measured heights: their roughness (ISO 25178-2), and their preparation: form off, missing points filled,
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
from math import ceil, floor, pi, sqrt
from typing import cast

import numpy as np

from sam.arrays import Array
from sam.scene.section import stated
from sam.scene.surface.section import Surface

FEWEST_SAMPLES = 256  # of a side; between both limits four in the shortest wavelength
MOST_SAMPLES = 4096  # of a side: 134 MB a field
BORDER = 3 / 32  # of a side: 6 of 64 cells
DROP = 4.0  # of the heights at the edge, in mean deviations: lower than most of the valleys
_ON_THE_LIMIT = 1 + 1e-9  # a wavelength that is equal to a cut-off belongs to the waves that stay


def heights(surface: Surface, x: Array, y: Array, extent: tuple[float, float]) -> Array:
    """Heights (nx, ny) in m, positive out of the body, at x (nx,) and y (ny,) in m on a patch with sides (Lx,
    Ly) in m about the origin. ValueError for a number of cells that a file does not have, and if only the
    digest of the file is at hand; its heights are those at the centres of cells, of which the number counts.
    """
    if surface.kind == "file":
        return processed(surface, (len(x), len(y)))
    if surface.kind == "sinusoid":
        return _sinusoid(surface, x, y)
    mean, scale = _mean_and_scale(surface, (extent[0], extent[1]))
    return scale * (_unscaled(surface, x, y, extent) - mean)


@lru_cache(maxsize=4)
def mean_deviation(surface: Surface, extent: tuple[float, float]) -> float:
    """Ra in m on points of its own: of a file those of it, else on a patch (Lx, Ly)."""
    of_file = surface.kind == "file"
    h = prepared(surface) if of_file else heights(surface, *_sampling(surface, extent), extent)
    return float(np.abs(h - h.mean()).mean())


def _sinusoid(surface: Surface, x: Array, y: Array) -> Array:
    """A crest at the origin; amplitude cos(2 pi x/wavelength_x) cos(2 pi y/wavelength_y)."""
    waves = [
        np.ones(len(c)) if length is None else np.cos(2 * pi * c / length)
        for c, length in ((x, surface.wavelength_x), (y, surface.wavelength_y))
    ]
    return stated(surface.amplitude) * waves[0][:, None] * waves[1][None, :]


def _sampling(surface: Surface, extent: tuple[float, float]) -> tuple[Array, Array]:
    """Points along x and y in m at the centres of equal cells."""

    def sampled(side: float, shortest: float) -> Array:
        return centres(min(max(FEWEST_SAMPLES, 4 * round(side / shortest)), MOST_SAMPLES)) * side

    return sampled(extent[0], surface.shortest[0]), sampled(extent[1], surface.shortest[1])


@lru_cache(maxsize=4)
def _mean_and_scale(surface: Surface, extent: tuple[float, float]) -> tuple[float, float]:
    """What makes the mean 0 and Ra or Sq as the scene says."""
    h = _unscaled(surface, *_sampling(surface, extent), extent)
    mean = float(h.mean())
    if surface.sq is not None:
        return mean, surface.sq / float(np.sqrt(np.mean((h - mean) ** 2)))
    return mean, stated(surface.ra) / float(np.abs(h - mean).mean())


def _unscaled(surface: Surface, x: Array, y: Array, extent: tuple[float, float]) -> Array:
    if surface.kind == "self-affine":
        return _self_affine(surface, x, y, extent)
    share = stated(surface.feed_share)
    total = np.zeros((len(x), len(y)))
    if share > 0:
        total += sqrt(share) * _marks(surface, x)[:, None]
    if share < 1:
        keys = ("ra", "cutoff_long", "cutoff_short", "hurst", "anisotropy", "seed")
        other = Surface(kind="self-affine", **{key: getattr(surface, key) for key in keys})
        total += sqrt(1 - share) * heights(other, x, y, extent)
    return total


def _marks(surface: Surface, x: Array) -> Array:
    """Arcs t^2/(2 r), t from -feed/2 to feed/2 and a cusp at x = 0: their Fourier series, without its
    constant.

    t^2 = feed^2/12 + sum over k of (-1)^k (feed/(pi k))^2 cos(2 pi k t/feed), and t = x - feed/2 takes (-1)^k
    away.
    """
    k = np.arange(1, floor(stated(surface.feed) / stated(surface.cutoff_short) * _ON_THE_LIMIT) + 1)
    waves = np.cos(2 * pi * np.outer(x, k) / stated(surface.feed))
    return cast(Array, waves @ ((stated(surface.feed) / (pi * k)) ** 2 / (2 * stated(surface.nose_radius))))


def _self_affine(surface: Surface, x: Array, y: Array, extent: tuple[float, float]) -> Array:
    """Re sum over m >= 0 and n of a_mn exp(2 pi i (m x/Lx + n y/Ly)): two products of matrices."""
    amplitudes = _amplitudes(surface, (extent[0], extent[1]))
    m, n = np.arange(amplitudes.shape[0]), np.arange(amplitudes.shape[1]) - amplitudes.shape[1] // 2
    along_x = np.exp(2j * pi * np.outer(x / extent[0], m))
    along_y = np.exp(2j * pi * np.outer(n, y / extent[1]))
    return cast(Array, (along_x @ amplitudes @ along_y).real)


@lru_cache(maxsize=1)
def _amplitudes(surface: Surface, extent: tuple[float, float]) -> Array:
    """Complex amplitudes of waves m = 0 .. M, n = -N .. N, one of each pair of signs."""
    most = [floor(L / wave * _ON_THE_LIMIT) for L, wave in zip(extent, surface.shortest, strict=True)]
    m, n = np.arange(most[0] + 1)[:, None], np.arange(-most[1], most[1] + 1)[None, :]
    inverse = np.hypot(m / extent[0], stated(surface.anisotropy) * n / extent[1])  # 1/wavelength
    long, short = 1 / stated(surface.cutoff_long), _ON_THE_LIMIT / stated(surface.cutoff_short)
    power = np.maximum(inverse / long, 1.0) ** (-2 - 2 * stated(surface.hurst))
    power[(inverse > short) | ((m == 0) & (n <= 0))] = 0.0
    return cast(Array, np.sqrt(power) * np.exp(2j * pi * _phases(stated(surface.seed), *most)))


def _phases(seed: int, most_x: int, most_y: int) -> Array:
    """Uniform in 0 .. 1 for m = 0 .. most_x, n = -most_y .. most_y, drawn shell by shell."""
    k = max(most_x, most_y)
    m, n = (a.ravel() for a in np.meshgrid(np.arange(k + 1), np.arange(-k, k + 1), indexing="ij"))
    order = np.lexsort((n, m, np.maximum(m, np.abs(n))))
    drawn = np.empty(m.size)
    drawn[order] = np.random.Generator(np.random.PCG64(seed)).random(m.size)
    return drawn.reshape(k + 1, 2 * k + 1)[: most_x + 1, k - most_y : k + most_y + 1]


def centres(n: int) -> Array:
    """The centres of n equal cells between -1/2 and 1/2."""
    return (np.arange(n) + 0.5) / n - 0.5


def border_cells(cells: tuple[int, int]) -> tuple[int, int]:
    """Cells along x and y that the border takes at each end."""
    return ceil(BORDER * cells[0]), ceil(BORDER * cells[1])


def with_relief(
    heights: Array, points: tuple[Array, Array], extent: tuple[float, float], mean_deviation: float
) -> Array:
    """Heights (nx, ny) in m lowered in the outer BORDER of each side of the patch, at the edge by
    DROP Ra, as s^3 (10 - 15 s + 6 s^2) of the way s there.
    """

    def stays(c: Array, side: float) -> Array:
        s = np.clip((np.abs(c) / side - (0.5 - BORDER)) / BORDER, 0.0, 1.0)
        return 1 - s**3 * (10 - 15 * s + 6 * s**2)

    stays_x, stays_y = (stays(c, side) for c, side in zip(points, extent, strict=True))
    return heights - DROP * mean_deviation * (1 - stays_x[:, None] * stays_y[None, :])


def fall(cells: tuple[int, int], mean_deviation: float) -> Array:
    """By how much `with_relief` lowers heights at the centres of (nx, ny) cells, in m."""
    points = centres(cells[0]), centres(cells[1])
    return -with_relief(np.zeros(cells), points, (1.0, 1.0), mean_deviation)


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
