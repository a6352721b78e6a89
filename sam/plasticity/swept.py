# SPDX-License-Identifier: MIT
"""Stress of plastic strain in the layers below a box by sweeps over depth, for each wave number: work and
memory grow with the number of layers, not with its square.

In axes along the wave vector (k = |k|, L along it, T across it in the plane) a strain e at the depth z' makes
at z, with w = W^T e and 1/R in wave numbers,

    full space, below:     k V (1 + k zeta a b^T) e^{-k zeta} w,                 zeta = z - z' > 0,
    above:                 the same with S V, S W and -zeta; S: signs under z -> -z,
    free surface:          k V (1 + k z a b^T)(F + k z' f b^T) e^{-k (z + z')} W^T S e,                    (h)

with three modes: two of P and SV waves, in the components LL, TT, 33, L3, one of SH waves, in T3 and LT,

    V = (LL + 2 nu TT + 33,   -2 LL - 2 nu TT + L3,   T3 + LT),
    W = (-(LL + 2 nu TT + 33)/2/(1 - nu),   (-LL - nu TT + L3)/(1 - nu),   T3 + LT),
    a = (1, 1, 0),   b = (1, -1, 0),   F = diag(-1, 1, 1),   f = (-1, 1, 0).

So all that a layer has to know of what lies on one side of it are four numbers at its face,

    P = k sum w e^{-k s},    Q = k sum k s b . w e^{-k s},    s: distance of the source from the face,

which cross a layer of thickness t as P -> e^{-kt} P, Q -> e^{-kt} (Q + kt b . P). One sweep up, the
reflection P -> F P + f Q, Q -> 0 at the free surface, and one sweep down give the stress in all layers.

Derived from the tables of `sam.kernels.eigenstrain`, which tests compare. In the plane the strain is uniform
in each cell, the stress its mean at 2 x 2 points; in depth likewise, exactly as in `sam.plasticity.spectra`.
What that leaves out are waves shorter than the cells (aliases), which reach about a cell: `NearBand` has
them.

What the periodic images of a box add to the stress in it: the stress of plastic strain that is repeated
with a period, less the stress of the strain in the box alone.

Inside the box this is smooth: moments of the strain, matrices between Chebyshev nodes in x, y and depth, and
means of the polynomials over the cells. The operator is that of `sam.kernels.eigenstrain`. From a source to
an observed point let r and phi be the offset (x, y) in the plane, zeta = |z - z'| in the full space and
z + z' in the image part, R^2 = r^2 + zeta^2, w = (x + i y)/(R + zeta), u = (1 - zeta/R)/2. All functions are
of one family:

(a) F_nm = int_0^inf k^n exp(-k zeta) J_m(k r) dk exp(i m phi) = w^m R^(-n-1) P_nm(u), n = 2 .. 4, m = 0 .. 4,
    P_nm = sum_j (-1)^j (n + m)! (n + j)!/((n - j)! j! (m + j)!) u^j.
(b) d_x^a d_y^b d_z^c (1/R) = (-1)^c Re sum_m i^(a+b+m) f_m F_nm, n = a + b + c, where cos^a(t) sin^b(t) is
    Re sum_m f_m exp(i m t); c < 0: repeated integrals.
(c) d_x^a d_y^b d_z^c R = ((c - 1) d_z^(c-2) + zeta d_z^(c-1)) d_x^a d_y^b (1/R), a + b + c = 4.
(d) The sum over |m_x|, |m_y| <= M is S + sum_j c_j (2 M + 1)^(-j); S, over all images, by extrapolation.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from math import ceil, factorial, log, pi
from typing import Any, Protocol

import numpy as np
from numpy.polynomial.chebyshev import chebint, chebvander
from numpy.polynomial.legendre import leggauss
from numpy.typing import NDArray

from sam.arrays import Array, Mask
from sam.kernels.eigenstrain import ENTRIES, FOURTH, MIRRORED, blocks, eigenstrain_table
from sam.kernels.patches import ODD_X, ODD_Y, Cuboids
from sam.kernels.waves import at_nodes, lagrange, nodes, nodes_for

Reals = NDArray[Any]
"""Real numbers in the precision of the operator, single or double."""
WAVES_AT_ONCE = 512  # that are swept together, so that they stay in the cache
GAUSS = np.array([-1.0, 1.0]) / np.sqrt(3)  # points of the mean over a cell, in each direction
# The largest stress/mu that waves two cells long leave of (h) between layers r cells apart, over e^{-pi r}:
# 5 to 8 for r = 1 to 3.
WORST = 8.0
DIGITS = 9  # to which thicknesses are compared


class Sweeps:
    """The operator (h) over mu, real as in `sam.plasticity.spectra`, without the full space in the layer of
    the strain. waves: k_x, k_y, (2, n) per hx; box: in hx, from z = 0.
    """

    def __init__(self, waves: Array, box: Cuboids, real: type[np.floating[Any]]):
        self.nu, self.real, (kx, ky), k = box.nu, real, waves, np.hypot(*waves)
        aspect = box.lags.hy / box.lags.hx
        c, s = np.divide(waves, k, out=np.zeros(waves.shape), where=k > 0)
        # cos, sin, cos^2, sin^2, cos sin and cos^2 - sin^2 of the direction of k
        self.direction = np.array([c, s, c * c, s * s, c * s, c * c - s * s], dtype=real)
        once, self.which = np.unique(np.round(np.diff(box.depths), DIGITS), return_inverse=True)
        kt = k * once[:, None]
        near, far = kt / 2 * (1 - GAUSS[1]), kt / 2 * (1 + GAUSS[1])  # k times the distance of both points
        crossed, at_near, at_far = np.exp(-kt), np.exp(-near), np.exp(-far)
        # strain uniform in the cell, stress at its points
        plane = np.sinc(kx / (2 * np.pi)) * np.sinc(ky * aspect / (2 * np.pi))
        plane *= np.cos(kx * GAUSS[1] / 2) * np.cos(ky * aspect * GAUSS[1] / 2)
        self.layers = np.array(
            [
                crossed,
                kt * crossed,
                (at_near + at_far) / 2,  # means of e^{-k s} and of k s e^{-k s} over the points
                (near * at_near + far * at_far) / 2,
                plane * -np.expm1(-kt),  # k times the integrals of them over the layer
                plane * (-np.expm1(-kt) - kt * crossed),
            ],
            dtype=real,
        )

    def __call__(self, strain: Reals, *, reflected: bool = True) -> Reals:
        """Stress/mu (n, 6 layers, r) of strain (n, 6 layers, r); reflected: with that of the free surface."""
        out = np.empty(strain.shape, dtype=self.real)
        for start in range(0, len(strain), WAVES_AT_ONCE):
            some = slice(start, start + WAVES_AT_ONCE)
            x = np.ascontiguousarray(np.moveaxis(strain[some], 0, -1), dtype=self.real)
            x = x.reshape(6, len(self.which), *x.shape[1:])
            out[some] = np.moveaxis(self._swept(x, some, reflected).reshape(-1, *x.shape[2:]), -1, 0)
        return out

    def matrices(self, reflected: bool) -> Iterator[tuple[slice, Reals]]:
        """The operator itself, some waves at a time: (n, 6, layers, 6, layers)."""
        layers = len(self.which)
        unit = np.eye(6 * layers, dtype=self.real).reshape(6, layers, -1, 1)
        for start in range(0, self.direction.shape[1], WAVES_AT_ONCE):
            some = slice(start, start + WAVES_AT_ONCE)
            x = unit.repeat(len(self.direction[0, some]), axis=-1)
            found = self._swept(x, some, reflected)
            yield some, np.moveaxis(found, -1, 0).reshape(-1, 6, layers, 6, layers)

    def _swept(self, x: Reals, some: slice, reflected: bool) -> Reals:
        """The same of (6, layers, r, n)."""
        nu, (c, s, cc, ss, cs, cc_ss) = self.nu, self.direction[:, some]
        along = cc * x[0] + ss * x[1] - 2 * cs * x[5]  # (-i)^2 was taken out of 12
        across = x[0] + x[1] - along
        even, odd = np.empty((3, *x.shape[1:]), dtype=self.real), np.zeros((3, *x.shape[1:]), dtype=self.real)
        even[0] = (along + 2 * nu * across + x[2]) / (-2 * (1 - nu))  # W^T e of (h)
        even[1] = (along + nu * across) / (nu - 1)
        even[2] = cs * (x[0] - x[1]) + cc_ss * x[5]
        odd[1] = (c * x[4] + s * x[3]) / (1 - nu)
        odd[2] = c * x[3] - s * x[4]
        numbers, layers = np.zeros((4, *x.shape[2:]), dtype=self.real), range(len(self.which))
        up = self._one_way(even - odd, numbers, reversed(layers), some)
        numbers[:2] += np.multiply.outer([-1, 1], numbers[3]) - [2 * numbers[0], 0 * numbers[1]]  # F P + f Q
        numbers[3] = 0
        down = self._one_way(even + odd, numbers if reflected else 0 * numbers, layers, some)
        y, odd = down + up, down - up
        out = np.empty_like(x)
        along, across = y[0] - 2 * y[1], 2 * nu * (y[0] - y[1])  # V y of (h)
        out[0] = cc * along + ss * across + 2 * cs * y[2]
        out[1] = along + across - out[0]
        out[2] = y[0]
        out[3] = c * odd[2] + s * odd[1]
        out[4] = c * odd[1] - s * odd[2]
        out[5] = cc_ss * y[2] - cs * (along - across)
        return out

    def _one_way(self, w: Reals, numbers: Reals, layers: Iterable[int], some: slice) -> Reals:
        """The modes (3, layers, r, n) in each layer by those swept before; numbers: P and Q, are moved on."""
        y, p, q = np.empty_like(w), numbers[:3], numbers[3]
        for i in layers:
            crossed, moved, mean, moment, source, of_source = self.layers[:, self.which[i], some]
            difference = p[0] - p[1]  # b . P
            np.multiply(mean, p, out=y[:, i])
            y[:2, i] += mean * q + moment * difference
            q *= crossed
            q += moved * difference + of_source * (w[0, i] - w[1, i])
            p *= crossed
            p += source * w[:, i]
        return y


class Exact(Protocol):
    """Spectra of the coefficients of cells and their periodic images, real as above, over mu."""

    def full_space(self, observed: int, sources: slice) -> Array:
        """Of strain in some layers on one, in the full space: (6, 6, sources, n)."""

    def image(self, layers: int) -> Array:
        """Of strain in the uppermost layers, what the free surface adds: (6, layers, 6, layers, n)."""


@dataclass
class Run:
    """Layers in a row, from `first` on, that have alike neighbours at the same offsets. keys: of an offset,
    both thicknesses and the distance; made: of which layer; matrices: (n, 6, 6 offsets).
    """

    first: int
    count: int = 0
    keys: dict[int, tuple[float, ...]] = field(default_factory=dict)
    made: dict[int, int] = field(default_factory=dict)
    matrices: Reals = field(default_factory=lambda: np.empty(0))

    def takes(self, keys: Mapping[int, tuple[float, ...]], layers: int) -> bool:
        """Whether the next layer has the same neighbours, but for those beyond either end."""
        i, known = self.first + self.count, self.keys
        alike = all(known[d] == keys[d] if d in known else i - 1 + d < 0 for d in keys)
        return not self.count or (alike and not any(0 <= i + d < layers for d in known if d not in keys))

    def stress(self, strain: Reals, some: slice) -> Reals:
        """Stress/mu (n, 6, count, r) in the run by its neighbours; strain: (n, 6, layers, r), some waves."""
        n, _, layers, r = strain.shape
        begin, offsets = self.first + min(self.keys), len(self.keys)
        end = begin + offsets + self.count - 1
        x = strain[:, :, max(begin, 0) : end]
        if begin < 0 or end > layers:  # nothing beyond the ends
            x = np.pad(x, [(0, 0), (0, 0), (max(-begin, 0), max(end - layers, 0)), (0, 0)])
        windows = np.lib.stride_tricks.sliding_window_view(x, offsets, axis=2).transpose(0, 1, 4, 2, 3)
        product = self.matrices[some] @ windows.reshape(n, 6 * offsets, self.count * r)
        return np.asarray(product.reshape(n, 6, self.count, r))


def runs_of(faces: Array, within: Mask) -> list[Run]:
    """The layers in runs; within: (layers, layers), which are neighbours."""
    thick, centre = np.round(np.diff(faces), DIGITS), (faces[1:] + faces[:-1]) / 2
    apart, out = np.round(np.subtract.outer(centre, centre), DIGITS), [Run(0)]
    for i, near in enumerate(within):
        keys = {int(j) - i: (thick[i], thick[j], apart[i, j]) for j in np.flatnonzero(near)}
        if not out[-1].takes(keys, len(within)):
            out.append(Run(i))
        out[-1].made |= {d: i for d in keys if d not in out[-1].keys}
        out[-1].keys |= keys
        out[-1].count += 1
    return out


def neighbours(faces: Array, error: float, aspect: float = 1.0) -> tuple[list[Run], int]:
    """Which layers are so close that (h) leaves more than an error, in runs; and how many of the uppermost
    are as close to the mirror image of the first. faces: in hx; aspect: hy/hx.
    """
    reach = log(WORST / error) / pi * max(1.0, aspect) - 10.0**-DIGITS
    gap = np.subtract.outer(faces[:-1], faces[1:])
    return runs_of(faces, np.maximum(gap, gap.T) < reach), int(np.searchsorted(faces[:-1], reach))


class SweptLayers:
    """The operator of a box, strain to stress/mu in its layers: by `Sweeps`, and between layers less than
    some cells apart by the `exact` coefficients less (h). waves, box: as there; error: of the stress/mu of a
    unit strain, what the shortest waves leave of (h) between the other layers.
    """

    def __init__(
        self, exact: Exact, waves: Array, box: Cuboids, *, error: float, real: type[np.floating[Any]]
    ):
        faces = box.depths

        def matrices(some: slice, reflected: bool) -> Iterator[tuple[slice, Array]]:
            layers = faces[some.start : some.stop + 1] - faces[some.start]
            return Sweeps(waves, replace(box, faces=tuple(layers)), np.float64).matrices(reflected)

        self.sweeps = Sweeps(waves, box, real)
        self.runs, self.top = neighbours(faces, error, box.lags.hy / box.lags.hx)
        for run in self.runs:
            offsets = sorted(run.made)
            found = np.empty((waves.shape[1], 6, 6, len(offsets)), dtype=real)
            for i in dict.fromkeys(run.made.values()):
                new = [k for k, d in enumerate(offsets) if run.made[d] == i]
                sources = slice(i + offsets[new[0]], i + offsets[new[-1]] + 1)
                first = min(sources.start, i)
                columns = slice(sources.start - first, sources.stop - first)
                spectra = exact.full_space(i, sources)
                for some, swept in matrices(slice(first, max(sources.stop, i + 1)), False):
                    left = np.moveaxis(spectra[..., some], -1, 0) - swept[:, :, i - first, :, columns]
                    found[some, ..., new[0] : new[-1] + 1] = left
            run.matrices = found.reshape(len(found), 6, -1)
        self.image = np.empty((waves.shape[1], 6, self.top, 6, self.top), dtype=real)
        spectra = exact.image(self.top)
        whole, alone = (matrices(slice(0, self.top), reflected) for reflected in (True, False))
        for (some, both), (_, full) in zip(whole, alone, strict=True):
            self.image[some] = np.moveaxis(spectra[..., some], -1, 0) - (both - full)

    @property
    def nbytes(self) -> int:
        """Bytes of the stored coefficients."""
        return self.image.nbytes + self.sweeps.layers.nbytes + sum(run.matrices.nbytes for run in self.runs)

    def __call__(self, strain: Reals) -> Reals:
        """Stress/mu (n, 6 layers, r) of strain (n, 6 layers, r)."""
        out = self.sweeps(strain)
        shape = len(strain), 6, -1, strain.shape[-1]
        x, y, top = strain.reshape(shape), out.reshape(shape), 6 * self.top
        for start in range(0, len(strain), WAVES_AT_ONCE):
            some = slice(start, start + WAVES_AT_ONCE)
            for run in self.runs:
                y[some, :, run.first : run.first + run.count] += run.stress(x[some], some)
            image, uppermost = self.image[some], x[some, :, : self.top]
            product = image.reshape(-1, top, top) @ uppermost.reshape(-1, top, uppermost.shape[-1])
            y[some, :, : self.top] += product.reshape(uppermost.shape)
        return out


NEAR = 2  # periods: images further away are summed at fewer nodes
SUMS = 2.0 * np.arange(
    4, 21, 2
)  # 2 M of the sums of (d), in longest over shortest length: 3e-11 of the largest
AT_ONCE = 20000  # functions of so many points are computed together
COLUMNS = 32  # that are added to the factors of a matrix at once
MODES = np.arange(5)


def _polynomials() -> Array:
    """Coefficients of u^j in P_nm of (a), (n, m, j)."""
    out = np.zeros((3, 5, 5))
    for n, m, j in np.ndindex(5, 5, 5):
        if 2 <= n >= j:
            below = factorial(n - j) * factorial(j) * factorial(m + j)
            out[n - 2, m, j] = (-1) ** j * factorial(n + m) * factorial(n + j) / below
    return out


def _derivative(a: int, b: int, c: int) -> Array:
    """d_x^a d_y^b d_z^c (1/R) in the real and the imaginary parts of F_nm, (3, 2, 5) as one."""
    angles = pi / 8 * np.arange(16)
    modes = np.fft.fft(np.cos(angles) ** a * np.sin(angles) ** b)[MODES] / np.where(MODES, 8, 16)
    modes = (-1.0) ** c * 1j ** (a + b + MODES) * modes  # (b)
    out = np.zeros((3, 2, 5))
    out[a + b + c - 2] = modes.real, -modes.imag
    return out.ravel()


def _weights(nu: float) -> tuple[Array, Array]:
    """Stress/mu in F_nm: full space by 1, zeta (2, 36, 30), image by 1, z', z, z z' (4, 36, 30)."""
    full, image = np.zeros((2, 36, 30)), np.zeros((2, 2, 36, 30))
    for block in blocks(nu):
        for indices, column in zip(FOURTH[block.of_full], -block.full.T, strict=True):
            a, b, c = (indices.count(i) for i in range(3))
            full[0, block.rows] += np.outer(column, (c - 1) * _derivative(a, b, c - 2))  # (c)
            full[1, block.rows] += np.outer(column, _derivative(a, b, c - 1))
    for row, name in enumerate(ENTRIES):
        for (p, q, a, b, c), powers in eigenstrain_table()["stress"][name].items():
            of_nu = sum(x * nu**k for k, x in enumerate(powers))
            image[p, q, row] += of_nu / (8 * pi * (1 - nu)) * _derivative(a, b, c)
    return full, image.reshape(4, 36, 30)


def _means(faces: Array, n: int) -> Array:
    """Means over cells of the Lagrange polynomials of n nodes between first and last face, (cells, n)."""
    t = (2 * faces - faces[0] - faces[-1]) / (faces[-1] - faces[0])
    return np.diff(chebvander(t, n) @ chebint(lagrange(n)), axis=0) / np.diff(t)[:, None]


def _factors(matrix: Array, tolerance: float) -> tuple[Array, Array]:
    """Left and right factor of a matrix by its range on random vectors (Halko, Martinsson and Tropp 2011)."""
    random, left, first = np.random.default_rng(0), np.zeros((len(matrix), 0)), 0.0
    while left.shape[1] < len(matrix):
        sample = matrix @ random.standard_normal((len(matrix), COLUMNS))
        sample -= left @ (left.T @ sample)
        first = first or float(np.linalg.norm(sample))
        if np.linalg.norm(sample) <= tolerance * first:
            break
        more = np.linalg.qr(sample)[0]
        left = np.hstack([left, np.linalg.qr(more - left @ (left.T @ more))[0]])  # orthogonal to rounding
    return left, left.T @ matrix


class Images:
    """Images of a cell, repeated with a period in cells, at lags up to half of it and one cell, or more.

    cuboids: faces in hx, `lags.hx` = 1, `lags.hy` the aspect (`lags.shape` is not used); tolerance: error of
    the stress/mu in the norm of the whole operator, about 2; lags: largest in cells.
    """

    def __init__(
        self, cuboids: Cuboids, period: tuple[int, int], tolerance: float, lags: tuple[int, int] = (0, 0)
    ):
        self.bottom, self.weights = cuboids.faces[-1], _weights(cuboids.nu)
        self.cell = np.array([1.0, cuboids.lags.hy])
        self.period = np.multiply(period, self.cell)
        self.reach = np.maximum(self.period / 2 + self.cell, np.multiply(lags, self.cell))
        near, far = (self._numbers(tolerance, m) for m in (1, NEAR + 1))
        images, weight = self._images()
        is_near = np.abs(images).max(axis=1) <= NEAR
        of_far = self._sums(images[~is_near], weight[~is_near], far)
        in_z, in_x, in_y = (at_nodes(nodes(near[k]), far[k]) for k in (2, 0, 1))
        self.table = in_x @ np.tensordot(in_z, of_far, 1) @ in_y.T
        self.table += self._sums(images[is_near], weight[is_near], near)

    def _numbers(self, tolerance: float, nearest: int) -> list[int]:
        """Nodes in x, y and zeta of sums over images from the so many-th on; even in x and y."""
        away = nearest * self.period
        clear = away - self.reach
        poles = [(away[k] / self.reach[k], 1j * clear[1 - k] / self.reach[k]) for k in (0, 1)]
        in_plane = [2 * ceil(nodes_for(tolerance, *each) / 2) for each in poles]
        return [*in_plane, nodes_for(tolerance, 1j * clear.min() / self.bottom - 1)]

    def _images(self) -> tuple[Array, Array]:
        """Images (n, 2) in periods, and their weights by (d); in groups about as long as wide."""
        group = np.maximum(1, 2 * np.round((self.period.max() / self.period - 1) / 2) + 1)
        sides = group * self.period
        sizes = SUMS * ceil(max(*sides, 2 * self.bottom) / min(sides)) + 1
        of_sum = [np.prod([a / (a - b) for b in sizes if b != a]) for a in sizes]  # (d)
        most = sizes[-1] * group // 2
        images = np.stack(np.meshgrid(*(np.arange(-n, n + 1) for n in most), indexing="ij"), axis=-1)
        images = images.reshape(-1, 2)[np.arange(images.size // 2) != images.size // 4]
        size = 2 * np.abs(np.round(images / group)).max(axis=1) + 1
        return images, (size[:, None] <= sizes) @ of_sum

    def _sums(self, images: Array, weight: Array, numbers: list[int]) -> Array:
        """Sums of F_nm over images at nodes of the lags and of zeta, (zeta, 30, x, y)."""
        x, y = (reach * nodes(n)[: n // 2] for reach, n in zip(self.reach, numbers[:2], strict=True))
        zeta = self.bottom * (1 + nodes(numbers[2]))[:, None, None]
        sums = np.zeros((3, 5, len(zeta), len(x), len(y)), complex)
        some = max(1, AT_ONCE // sums[0, 0].size)
        powers, polynomials = np.arange(5).reshape(5, 1, 1, 1, 1), _polynomials().reshape(15, 5)
        for start in range(0, len(images), some):
            shift = (images[start : start + some] * self.period)[..., None, None, None]
            in_x, in_y = shift[:, 0] + x[:, None], shift[:, 1] + y
            distance = np.sqrt(in_x**2 + in_y**2 + zeta**2)
            w, u = (in_x + 1j * in_y) / (distance + zeta), (1 - zeta / distance) / 2
            of_u = (polynomials @ (u**powers).reshape(5, -1)).reshape(3, 5, *u.shape)
            of_u *= (distance ** (-3.0 - powers[:3]))[:, None]
            turned = np.broadcast_to(weight[start : start + some, None, None, None], w.shape)
            for m in MODES:
                sums[:, m] += (turned * of_u[:, m]).sum(axis=1)  # (a)
                turned = turned * w
        out = np.stack([sums.real, sums.imag], axis=1)
        mirrored_x = (-1.0) ** (MODES + np.array([[0], [1]]))[..., None, None, None]
        out = np.concatenate([out, mirrored_x * out[..., ::-1, :]], axis=-2)
        mirrored_y = np.array([1.0, -1.0])[:, None, None, None, None]
        out = np.concatenate([out, mirrored_y * out[..., ::-1]], axis=-1)
        return np.moveaxis(out.reshape(30, -1, *out.shape[-2:]), 0, 1)

    def _stress(self, image: bool, z: Array, source: Array) -> Array:
        """Stress/mu at depths z by unit strain per volume at depths of sources, (n, 36, x, y) at the lags."""
        zeta, ones = z + source if image else np.abs(z - source), np.ones_like(z)
        powers = np.array([ones, source, z, z * source] if image else [ones, zeta])
        weights = np.tensordot(powers, self.weights[image], ([0], [0]))
        functions = at_nodes(zeta / self.bottom - 1, len(self.table)) @ self.table.reshape(
            len(self.table), -1
        )
        out = (weights @ functions.reshape(len(z), 30, -1)).reshape(-1, 36, *self.table.shape[2:])
        if not image:
            out[z < source] *= MIRRORED
        return out

    def between(
        self, image: bool, observed: tuple[float, float], source: tuple[float, float], lags: tuple[int, int]
    ) -> Array:
        """What images add to the coefficients at lags 0 .. N, N <= half of the period, from upper and lower
        face of both layers, of the image part or the full space: (36, lags_x + 1, lags_y + 1). In the plane a
        mean over observed and source cell by three Gauss points each, in depth two and four.
        """
        points, weights = leggauss(4)
        z, depths = (np.mean(f) + np.diff(f) / 2 * at for f, at in ((observed, GAUSS), (source, points)))
        z, depths, weight = np.repeat(z, 4), np.tile(depths, 2), np.tile(weights, 2) * np.diff(source) / 4
        stress = np.tensordot(weight, self._stress(image, z, depths), 1)
        points, weights = leggauss(3)
        off, weight = np.add.outer(points, points).ravel() / 2, np.outer(weights, weights).ravel() / 4
        in_x, in_y = (
            np.tensordot(weight, at_nodes((np.arange(n + 1) + off[:, None]) * h / reach, count), 1)
            for n, h, reach, count in zip(lags, self.cell, self.reach, stress.shape[1:], strict=True)
        )
        return in_x @ stress @ in_y.T * self.cell.prod()


class PeriodImages(Images):
    """Images of the strain in a box of cells (nx, ny); period: more than cells, best twice as many."""

    def __init__(self, cuboids: Cuboids, cells: tuple[int, int], period: tuple[int, int], tolerance: float):
        super().__init__(cuboids, period, tolerance, cells)
        faces, sides = cuboids.depths, np.multiply(cells, self.cell)
        gap, half, thick = self.period - sides, sides / 2, (faces[-1] - faces[0]) / 2
        numbers = [nodes_for(tolerance, 1j * gap.min() / thick)]
        for k in (0, 1):
            poles = self.period[k] / half[k] - 1, 1j * gap[1 - k] / half[k]
            numbers.append(2 * ceil(nodes_for(tolerance, *poles) / 2))
        edges = faces, *((np.arange(n + 1) - n / 2) * h for n, h in zip(cells, self.cell, strict=True))
        self.means = [_means(of_axis, n) for of_axis, n in zip(edges, numbers, strict=True)]
        self.integrals = [mean * np.diff(e)[:, None] for mean, e in zip(self.means, edges, strict=True)]
        depths = (faces[0] + faces[-1]) / 2 + thick * nodes(numbers[0])
        self.factors = [_factors(m, tolerance) for m in self._matrices(depths, half, numbers[1:])]

    def _matrices(self, depths: Array, half: Array, numbers: list[int]) -> Iterator[Array]:
        """Stress at the nodes by moments, of fields even (odd) in x and in y: at the nodes x, y > 0."""
        sides, folded = (6, len(depths), numbers[0] // 2, numbers[1] // 2), []
        for k in (0, 1):
            x = half[k] * nodes(numbers[k])[: sides[k + 2]]
            lags = np.array([np.subtract.outer(x, x).ravel(), np.add.outer(x, x).ravel()])
            minus, plus = at_nodes(lags / self.reach[k], self.table.shape[k + 2])
            folded.append((minus + plus, minus - plus))
        for odd_x, odd_y in np.ndindex(2, 2):
            out = np.empty((*sides, *sides))
            for i, z in enumerate(depths):
                z = np.full_like(depths, z)
                stress = self._stress(False, z, depths) + self._stress(True, z, depths)
                stress = stress.reshape(-1, 6, 6, *stress.shape[2:])
                for j in range(6):
                    in_x, in_y = folded[0][odd_x ^ ODD_X[j]], folded[1][odd_y ^ ODD_Y[j]]
                    part = (in_x @ stress[:, :, j] @ in_y.T).reshape(-1, 6, *np.repeat(sides[2:], 2))
                    out[:, i, :, :, j] = part.transpose(1, 2, 4, 0, 3, 5)
            yield out.reshape(np.prod(sides), -1)

    def moments(self, strain: Reals) -> Reals:
        """Integrals of strain (6, nz, nx, ny) times the polynomials, (6, pz, px, py) in hx^3."""
        z, x, y = (integral.astype(strain.dtype) for integral in self.integrals)
        part = x.T @ (strain @ y)
        return (z.T @ part.reshape(6, len(z), -1)).reshape(6, -1, *part.shape[2:])

    def values(self, moments: Reals) -> Reals:
        """Stress/mu at the nodes, (6, pz, px, py), by the moments."""
        out, (_, _, nx, ny) = np.zeros(moments.shape), moments.shape
        for (odd_x, odd_y), (left, right) in zip(np.ndindex(2, 2), self.factors, strict=True):
            sign_x, sign_y = (
                (-1.0) ** (odd ^ of_tensor)[:, None, None, None]
                for odd, of_tensor in ((odd_x, ODD_X), (odd_y, ODD_Y))
            )
            part = moments + sign_x * moments[:, :, ::-1]
            part = (part + sign_y * part[..., ::-1])[:, :, : nx // 2, : ny // 2] / 4
            part = (left @ (right @ part.ravel())).reshape(part.shape)
            part = np.concatenate([part, sign_x * part[:, :, ::-1]], axis=2)
            out += np.concatenate([part, sign_y * part[..., ::-1]], axis=3)
        return out.astype(moments.dtype)

    def fields(self, values: Reals) -> Reals:
        """Means over the cells, (6, nz, nx, ny), of the polynomials with these values at the nodes."""
        z, x, y = (mean.astype(values.dtype) for mean in self.means)
        part = (z @ values.reshape(6, values.shape[1], -1)).reshape(6, -1, *values.shape[2:])
        return x @ part @ y.T

    @property
    def nbytes(self) -> int:
        """Bytes of the factors and of the table."""
        return sum(part.nbytes for factors in self.factors for part in factors) + self.table.nbytes
