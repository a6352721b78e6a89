# SPDX-License-Identifier: MIT
"""What the periodic images of a box add to the stress in it: stress of the strain in the box, repeated with a
period, less that of the box alone.

Inside the box it is smooth, so it is a polynomial between Chebyshev nodes in x, y and depth: moments of the
strain, one dense matrix, and means of polynomials over the cells. The operator is that of
`sam.kernels.eigenstrain`. With (x, y) and zeta = |z - z'|, for the image part z + z', between observed and source
point, R their distance and phi the direction of (x, y), all of its functions are of one family:

(a) F_nm = int_0^inf k^n exp(-k zeta) J_m(k r) dk exp(i m phi)
         = w^m R^(-n-1) sum_j (-1)^j (n + m)! (n + j)!/((n - j)! j! (m + j)!) u^j,
    w = (x + i y)/(R + zeta), u = (1 - zeta/R)/2, n = 2, 3, 4, m = 0 .. 4,
(b) d_x^a d_y^b d_z^c (1/R) = Re sum_m (-1)^c i^(a+b+m) f_m F_nm, n = a + b + c, where Re sum_m f_m exp(i m theta) =
    cos^a(theta) sin^b(theta); c < 0 is a repeated integral,
(c) d_x^a d_y^b d_z^c R = (c - 1) d_x^a d_y^b d_z^(c-2) (1/R) + zeta d_x^a d_y^b d_z^(c-1) (1/R), a + b + c = 4.

The sums of F_nm over the images fall like 1/n: (d) S(|m_x|, |m_y| <= n) = S + sum_j c_j (2 n + 1)^(-j), from
which S follows by extrapolation, as a sum with weights.
"""

from __future__ import annotations

from itertools import product
from math import ceil, factorial, log, log10, pi

import numpy as np
from numpy.polynomial import chebyshev
from numpy.polynomial.legendre import leggauss

from sam.arrays import Array
from sam.kernels.eigenstrain import ENTRIES, FOURTH, MIRRORED, blocks, eigenstrain_table
from sam.kernels.patches import ODD_X, ODD_Y
from sam.plasticity.swept import GAUSS

MODES = np.arange(5)
POLYNOMIALS = np.zeros((3, 5, 5))  # of u in (a), by n - 2, m and j
for _n, _m in product((2, 3, 4), MODES.tolist()):
    for _j in range(_n + 1):
        _below = factorial(_n - _j) * factorial(_j) * factorial(_m + _j)
        POLYNOMIALS[_n - 2, _m, _j] = (-1) ** _j * factorial(_n + _m) * factorial(_n + _j) / _below
NEAR = 2  # periods: further images are summed at fewer nodes
SIGNS = [(-1.0) ** odd[:, None, None, None] for odd in (ODD_X, ODD_Y)]
COUNT = dict(box=1.0, table=1.0)


def _derivative(a: int, b: int, c: int) -> Array:
    angles = pi / 8 * np.arange(16)
    modes = np.fft.fft(np.cos(angles) ** a * np.sin(angles) ** b)[MODES] / np.where(MODES, 8, 16)
    modes *= (-1.0) ** c * 1j ** (a + b + MODES)  # (b)
    out = np.zeros((3, 2, 5))
    out[a + b + c - 2] = modes.real, -modes.imag
    return out.ravel()


def _weights(nu: float) -> tuple[Array, Array]:
    """Stress/mu by powers of depth and F_nm"""
    full, image = np.zeros((2, 36, 30)), np.zeros((2, 2, 36, 30))
    for block in blocks(nu):
        for indices, column in zip(FOURTH[block.of_full], -block.full.T, strict=True):
            a, b, c = (indices.count(i) for i in range(3))
            full[0, block.rows] += np.outer(column, (c - 1) * _derivative(a, b, c - 2))  # (c)
            full[1, block.rows] += np.outer(column, _derivative(a, b, c - 1))
    for row, name in enumerate(ENTRIES):
        for (p, q, *orders), powers in eigenstrain_table()["stress"][name].items():
            weight = sum(c * nu**k for k, c in enumerate(powers)) / (8 * pi * (1 - nu))
            image[p, q, row] += weight * _derivative(*orders)
    return full, image.reshape(4, 36, 30)


def _nodes(n: int) -> Array:
    return np.cos(pi * (np.arange(n) + 0.5) / n)


def _lagrange(n: int) -> Array:
    return np.linalg.inv(chebyshev.chebvander(_nodes(n), n - 1))


def _at(points: Array, n: int) -> Array:
    return chebyshev.chebvander(points, n - 1) @ _lagrange(n)


def _means(faces: Array, n: int) -> Array:
    t = (2 * faces - faces[0] - faces[-1]) / (faces[-1] - faces[0])
    return np.diff(chebyshev.chebvander(t, n) @ chebyshev.chebint(_lagrange(n)), axis=0) / np.diff(t)[:, None]


def _number(tolerance: float, *poles: complex) -> int:
    ellipse = min(abs(w + np.sqrt(w - 1 + 0j) * np.sqrt(w + 1 + 0j)) for w in poles)
    return 2 * ceil(log(1 / tolerance) / log(ellipse) / 2)


class PeriodImages:
    def __init__(self, cuboids, cells, period, tolerance, force=None, rings=None):
        self.nu, faces = cuboids.nu, cuboids.depths
        self.weights = _weights(cuboids.nu)
        self.cell = np.array([1.0, cuboids.lags.hy])
        self.period = np.array(period) * self.cell
        sides, self.bottom = np.array(cells) * self.cell, faces[-1]
        gap = self.period - sides
        self.reach = np.maximum(self.period / 2 + self.cell, sides)  # lags of the table
        tb, tt = tolerance * COUNT["box"], tolerance * COUNT["table"]
        half, thick = sides / 2, (faces[-1] - faces[0]) / 2
        nodes = [_number(tb, 1j * gap.min() / thick)] + [
            _number(tb, self.period[k] / half[k] - 1, 1j * gap[1 - k] / half[k]) for k in (0, 1)
        ]

        def lags(m):
            away = m * self.period
            clear = away - self.reach
            return [
                _number(tt, away[k] / self.reach[k], 1j * clear[1 - k] / self.reach[k]) for k in (0, 1)
            ] + [_number(tt, -1 + 1j * clear.min() / self.bottom)]

        fine, coarse = lags(1), lags(NEAR + 1)
        if force:
            nodes, fine, coarse = force
        self.counts = nodes, fine, coarse
        m, weight = self._images(tolerance) if rings is None else self._images(tolerance, *rings)
        self.nimages = len(m)
        near = np.abs(m).max(axis=1) <= NEAR
        far = self._sums(m[~near], weight[~near], coarse)
        tz, tx, ty = (_at(_nodes(n), k) for n, k in zip(np.roll(fine, 1), np.roll(coarse, 1)))
        far = tx @ np.tensordot(tz, far, 1) @ ty.T
        self.table = self._sums(m[near], weight[near], fine) + far
        # of the nodes
        ends = [faces, *(n * h * np.array([-0.5, 0.5]) for n, h in zip(cells, self.cell))]
        edges = [faces] + [(np.arange(n + 1) - n / 2) * h for n, h in zip(cells, self.cell)]
        self.means = [_means(e, n) for e, n in zip(edges, nodes)]
        self.measures = [m * np.diff(e)[:, None] for m, e in zip(self.means, edges)]
        pz, px, py = nodes
        depth = (faces[0] + faces[-1]) / 2 + thick * _nodes(pz)
        z, source = (g.ravel() for g in np.meshgrid(depth, depth, indexing="ij"))
        coefficients = self._coefficients(False, z, source) + self._coefficients(True, z, source)
        coefficients = coefficients.reshape(pz, pz, 6, 6, *coefficients.shape[2:]).transpose(3, 2, 0, 1, 4, 5)
        folded = []
        for k in (0, 1):
            x = half[k] * _nodes(nodes[k + 1])[: nodes[k + 1] // 2]
            minus, plus = (_at((x[:, None] + s * x).ravel() / self.reach[k], fine[k]) for s in (-1, 1))
            folded.append((minus + plus, minus - plus))
        hx, hy = px // 2, py // 2
        self.matrices = np.empty((2, 2, 6, pz, hx, hy, 6, pz, hx, hy))
        for sx, sy, j in np.ndindex(2, 2, 6):
            part = folded[0][sx ^ ODD_X[j]] @ coefficients[j] @ folded[1][sy ^ ODD_Y[j]].T
            self.matrices[sx, sy, ..., j, :, :, :] = part.reshape(6, pz, pz, hx, hx, hy, hy).transpose(
                0, 1, 3, 5, 2, 4, 6
            )
        self.matrices = self.matrices.reshape(2, 2, 6 * pz * hx * hy, -1)

    def _images(self, tolerance, first=None, count=None, step=None):
        digits = -log10(tolerance)
        group = [max(1, 2 * round((self.period.max() / p - 1) / 2) + 1) for p in self.period]
        big = group * self.period
        first = first or ceil(digits / 2.25)
        count = count or ceil(digits) + 1
        step = step or ceil(max(big.max(), 2 * self.bottom) / big.min())
        self.rs = (first, count, step, group)
        sizes = 2 * (first + np.arange(count)) * step + 1.0
        of_sum = [np.prod([s / (s - o) for o in sizes if o != s]) for s in sizes]
        m = np.stack(
            np.meshgrid(
                *(np.arange(-(sizes[-1] * g // 2), sizes[-1] * g // 2 + 1) for g in group), indexing="ij"
            ),
            -1,
        ).reshape(-1, 2)
        m = m[np.abs(m).any(axis=1)]
        size = 2 * np.abs(np.round(m / group)).max(axis=1) + 1
        return m, (size[:, None] <= sizes) @ of_sum

    def _sums(self, m, weight, numbers):
        """(Z, 30, X, Y)"""
        nx, ny, nz = numbers
        x, y = (r * _nodes(n)[: n // 2] for r, n in zip(self.reach, (nx, ny)))
        zeta = self.bottom * (1 + _nodes(nz))[:, None, None]
        out = np.zeros((3, 5, nz, len(x), len(y)), complex)
        at_once = max(1, 20000 // out[0, 0].size)
        for s in range(0, len(m), at_once):
            shift = (m[s : s + at_once] * self.period)[..., None, None, None]
            xs, ys = shift[:, 0] + x[:, None], shift[:, 1] + y
            r = np.sqrt(xs**2 + ys**2 + zeta**2)
            w = (xs + 1j * ys) / (r + zeta)
            u = ((1 - zeta / r) / 2) ** np.arange(5).reshape(5, 1, 1, 1, 1)
            radial = (POLYNOMIALS.reshape(15, 5) @ u.reshape(5, -1)).reshape(3, 5, *r.shape)
            radial *= (r ** -np.arange(3.0, 6.0).reshape(3, 1, 1, 1, 1))[:, None]
            turned = weight[s : s + at_once, None, None, None] * np.ones_like(w)
            for mode in range(5):
                out[:, mode] += (turned * radial[:, mode]).sum(axis=1)
                turned = turned * w
        out = np.stack([out.real, out.imag], axis=1)
        sx = (-1.0) ** (MODES + [[0], [1]])
        sy = np.array([[1.0], [-1.0]])
        out = np.concatenate([out, sx[..., None, None, None] * out[..., ::-1, :]], axis=-2)
        out = np.concatenate([out, sy[..., None, None, None] * out[..., ::-1]], axis=-1)
        return np.moveaxis(out.reshape(30, nz, nx, ny), 0, 1)

    def _coefficients(self, image: bool, z: Array, source: Array) -> Array:
        zeta = z + source if image else np.abs(z - source)
        ones = np.ones_like(z)
        powers = [ones, source, z, z * source] if image else [ones, zeta]
        weights = np.tensordot(np.array(powers), self.weights[image], ([0], [0]))
        nz, _, *sides = self.table.shape
        functions = _at(zeta / self.bottom - 1, nz) @ self.table.reshape(nz, -1)
        out = (weights @ functions.reshape(len(z), 30, -1)).reshape(-1, 36, *sides)
        if not image:
            out[z < source] *= MIRRORED
        return out

    def between(self, image, observed, source, lags):
        points, weights = leggauss(4)
        z, s = (sum(f) / 2 + (f[1] - f[0]) / 2 * g for f, g in ((observed, GAUSS), (source, points)))
        zz, ss = (g.ravel() for g in np.meshgrid(z, s, indexing="ij"))
        weight = np.tile(weights, 2) * (source[1] - source[0]) / 4
        k = np.tensordot(weight, self._coefficients(image, zz, ss), 1)
        points, weights = leggauss(3)
        off, w = np.add.outer(points, points).ravel() / 2, np.outer(weights, weights).ravel() / 4
        at = [
            np.tensordot(_at((np.arange(n + 1)[:, None] + off) * h / r, c), w, ([1], [0]))
            for n, h, r, c in zip(lags, self.cell, self.reach, k.shape[1:])
        ]
        return at[0] @ k @ at[1].T * self.cell.prod()

    def moments(self, strain):
        z, x, y = (m.astype(strain.dtype) for m in self.measures)
        part = x.T @ (strain @ y)
        return (z.T @ part.reshape(6, len(z), -1)).reshape(6, -1, *part.shape[2:])

    def values(self, moments):
        out = np.zeros(moments.shape)
        _, pz, px, py = moments.shape
        for sx, sy in np.ndindex(2, 2):
            fx, fy = (-1) ** sx * SIGNS[0], (-1) ** sy * SIGNS[1]
            part = moments + fx * moments[:, :, ::-1]
            part = part + fy * part[..., ::-1]
            part = (self.matrices[sx, sy] @ part[:, :, : px // 2, : py // 2].ravel()).reshape(
                6, pz, px // 2, -1
            )
            part = np.concatenate([part, fx * part[:, :, ::-1]], axis=2)
            out += np.concatenate([part, fy * part[..., ::-1]], axis=3) / 4
        return out.astype(moments.dtype)

    def fields(self, values):
        z, x, y = (m.astype(values.dtype) for m in self.means)
        part = (z @ values.reshape(6, values.shape[1], -1)).reshape(6, len(z), *values.shape[2:])
        return x @ part @ y.T

    @property
    def nbytes(self):
        return self.matrices.nbytes
