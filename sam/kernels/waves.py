# SPDX-License-Identifier: MIT
"""Coefficients of loads and of strain that repeat with a period, in wave numbers.

Of n_x x n_y cells, lengths in hx, a field has the wave numbers 2 pi (m/n_x, n/n_y) per cell. A coefficient is
a sum of derivatives of 1/R over a uniform cell, see `sam.kernels.primitives`. In wave numbers, k^2 = k_x^2 +
k_y^2,

    d_x^a d_y^b d_z^c (1/R) -> 2 pi (i k_x)^a (i k_y)^b (-k)^c e^{-k z}/k,                                 (a)
    a uniform cell -> sin(k_x hx/2)/(k_x hx/2) sin(k_y hy/2)/(k_y hy/2).

What is sampled at the centres of cells is the sum over k and its aliases, k + 2 pi (i/hx, j/hy). All of them
but k itself are together smooth between -pi and pi: they are summed at Chebyshev nodes, up to |k_x| of some
2 pi WINDOW, where a smooth end takes the place of waves that the depth has not removed. The result is within
1e-8 of the largest coefficient. Where k = 0 it is 0: what a uniform field does is said by the caller.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import lru_cache
from itertools import pairwise
from math import ceil, erfc, log, pi
from typing import Any

import numpy as np
from numpy.polynomial.chebyshev import chebvander
from numpy.typing import NDArray

from sam.arrays import Array
from sam.kernels.eigenstrain import eigenstrain_table
from sam.kernels.patches import STRESS, Lags, load_table

Radial = Callable[[Array], Sequence[Array]]
"""k > 0 -> functions of it, which derivatives along x and y multiply."""
Power = tuple[int, int]
Sums = tuple[tuple[int, int, int, int, float], ...]
"""(entry, a, b, function, factor): terms of the entries."""
ALIASED = 1e-10  # share of a coefficient that waves are left out at
NODES = 1e-10  # error of the sum over aliases between its nodes
# (c, d) in 2 pi/hx: waves count by erfc((|k_x| - c)/d)/2: at the centres of cells, and at Gauss points, where
# neighbouring aliases differ by a phase of pi, and of .42 pi
WINDOW = {False: (11.0, 2.8), True: (26.0, 6.6)}


def nodes(n: int) -> Array:
    """Chebyshev nodes in (-1, 1), descending."""
    return np.cos(pi / n * (np.arange(n, dtype=float) + 0.5))


def lagrange(n: int) -> Array:
    """Lagrange polynomials of the nodes in Chebyshev polynomials, a column each."""
    polynomials: Array = np.asarray(np.linalg.inv(chebvander(nodes(n), n - 1)), dtype=float)
    return polynomials


def at_nodes(points: Array, n: int) -> Array:
    """Lagrange polynomials of n nodes at points, (..., n)."""
    return chebvander(points, n - 1) @ lagrange(n)


def nodes_for(tolerance: float, *poles: complex) -> int:
    """Nodes in [-1, 1] for a function with such singular points: by the ellipse of Bernstein through them."""
    ellipse = min(abs(w + np.sqrt(w - 1 + 0j) * np.sqrt(w + 1 + 0j)) for w in poles)
    return ceil(log(1 / tolerance) / log(ellipse))


def _of_cell(x: Array, order: int, point: float) -> Array:
    """(i x)^order without (-i)^(order % 2), times the cell's, at points +- `point` of its centre."""
    sign = (-1.0) ** ((order + 1) // 2)
    return np.asarray(sign * x**order * np.sinc(x / (2 * pi)) * np.cos(point * x))


def _of_cells(waves: Sequence[Array], sums: Sums, aspect: float, point: float) -> list[dict[int, Array]]:
    """`_of_cell` along x and y, of each power there is."""
    return [
        {n: _of_cell(k, n, point) / side**n for n in {(term[1], term[2])[axis] for term in sums}}
        for axis, (k, side) in enumerate(zip(waves, (1.0, aspect), strict=True))
    ]


def repeated(period: Lags, sums: Sums, radial: Radial, *, depth: float, point: float = 0.0) -> Array:
    """Entries of sums of (a), (entries, n_x // 2 + 1, n_y // 2 + 1), real: without (-i)^(odd_x + odd_y).
    period: its cells, hx = 1; radial: the functions of k in the sums; depth: the least z in hx; point: means
    over four points, so far from the centre along x and y in sides of the cell.
    """
    aspect, sides = period.hy, [2 * pi / n * np.arange(n // 2 + 1.0) for n in period.shape]
    k = np.hypot(sides[0][:, None], sides[1] / aspect)
    k[0, 0] = 1.0
    out, functions = np.zeros((1 + max(term[0] for term in sums), *k.shape)), radial(k)
    of_x, of_y = _of_cells(sides, sums, aspect, point)
    for entry, a, b, function, factor in sums:
        out[entry] += factor * of_x[a][:, None] * functions[function] * of_y[b]
    count, aliases = _aliases(aspect, sums, radial, depth=depth, point=point)
    between = [at_nodes(side / pi, count) for side in sides] if aliases else []
    for (entry, _, _, _, factor), found in zip(sums, aliases, strict=False):
        out[entry] += factor * (between[0] @ found @ between[1].T)
    out[:, 0, 0] = 0.0
    return out


@lru_cache(maxsize=256)  # of the layers of a body, each some 0.1 MB at most
def _aliases(
    aspect: float, sums: Sums, radial: Radial, *, depth: float, point: float
) -> tuple[int, list[Array]]:
    """Of each term the sum over all aliases but k itself at so many nodes: for a period of any length."""
    count = 2 * ceil(nodes_for(NODES, 1j * min(aspect, 1 / aspect), 2.0) / 2)
    out, far = list[Array](), log(1 / ALIASED) / (2 * pi)
    if depth >= 2 * far * max(1.0, aspect):
        return count, out
    centre, width = WINDOW[point > 0]
    widest = centre + 4 * width
    most = [ceil(min(far * side / depth if depth else widest, widest)) for side in (1, aspect)]
    half = pi * nodes(count)[: count // 2]
    waves = [half[:, None] + 2 * pi * np.arange(-n, n + 1) for n in most]
    ends = [np.vectorize(erfc)((np.abs(each) / (2 * pi) - centre) / width) / 2 for each in waves]
    functions = radial(np.hypot(waves[0][:, :, None, None], waves[1] / aspect))
    for each in functions:
        each[:, most[0], :, most[1]] = 0.0  # k itself
    of_x, of_y = _of_cells(waves, sums, aspect, point)
    for _, a, b, function, _ in sums:
        by_y = (of_x[a] * ends[0])[:, None] @ functions[function].reshape(*waves[0].shape, -1)
        found = (by_y.reshape(-1, *waves[1].shape) * (of_y[b] * ends[1])).sum(axis=-1)
        found = np.concatenate([found, (-1) ** a * found[::-1]])
        out.append(np.concatenate([found, (-1) ** b * found[:, ::-1]], axis=1))
    return count, out


def _sums(
    rows: Sequence[tuple[int, Power, tuple[int, int], tuple[float, ...]]], nu: float
) -> tuple[list[Power], Sums]:
    """The powers (p, c) of z^p (-k)^c in rows (entry, (p, c), (a, b), factor in powers of nu), and sums."""
    powers = sorted({power for _, power, _, _ in rows})
    sums = [(e, *ab, powers.index(pc), sum(x * nu**k for k, x in enumerate(q))) for e, pc, ab, q in rows]
    return powers, tuple(sums)


@dataclass(frozen=True)
class _OfLoad:
    """Means of z^p (-k)^c e^{-k z}/k over depths."""

    powers: tuple[Power, ...]
    depths: tuple[float, ...]

    def __call__(self, k: Array) -> list[Array]:
        falls, inverse = [np.exp(-k * z) / k for z in self.depths], -1 / k
        means = [
            sum(z**p * fall for z, fall in zip(self.depths, falls, strict=True)) / len(falls) for p in (0, 1)
        ]
        return [means[p] * (inverse**-c if c < 0 else (-k) ** c) for p, c in self.powers]


@dataclass(frozen=True)
class _OfStrain:
    """Integrals of z^q (-k)^c e^{-k z}/k over a layer of thickness t below the depth `top`."""

    powers: tuple[Power, ...]
    top: float
    t: float

    def __call__(self, k: Array) -> list[Array]:
        ends = -np.expm1(-k * self.t) / k
        moment = self.top * ends + (ends - self.t * np.exp(-k * self.t)) / k
        fall = np.exp(-k * self.top) / k
        return [fall * (moment if q else ends) * (-k) ** c for q, c in self.powers]


def load_waves(
    kind: str,
    names: Sequence[str],
    period: Lags,
    nu: float,
    *,
    load: int,
    depths: Sequence[float] = (0.0,),
    point: float = 0.0,
) -> Array:
    """Of a unit traction on a cell (load: its direction), the mean over depths in hx of the `kind` "stress"
    or "displacement" (times mu, in hx), see `repeated`. Paper Eq. 5 and 7.
    """
    rows = [(e, row) for e, name in enumerate(names) for row in load_table()[kind][f"{name},F{load}"]]
    powers, sums = _sums([(e, (p, c), (a, b), of_nu) for e, (p, a, b, c, of_nu) in rows], nu)

    return repeated(period, sums, _OfLoad(tuple(powers), tuple(depths)), depth=min(depths), point=point)


def strain_displacement_waves(period: Lags, faces: Sequence[float], nu: float, component: int = 3) -> Array:
    """Displacement of the surface by unit strain in the cells of layers, in hx, (6, layers, n_x // 2 + 1,
    n_y // 2 + 1), as of `repeated`. Paper Eq. 6 and 19.
    """
    table = eigenstrain_table()["displacement"]
    rows = [(e, *row) for e, name in enumerate(STRESS) for row in table[f"{component},{name}"].items()]
    powers, sums = _sums([(e, (q, c), (a, b), of_nu) for e, (_, q, a, b, c), of_nu in rows], nu)
    return np.stack(
        [
            repeated(period, sums, _OfStrain(tuple(powers), top, bottom - top), depth=top)
            for top, bottom in pairwise(faces)
        ],
        axis=1,
    )


def in_cells(waves: Array, cells: tuple[int, int], names: Sequence[str], other: int) -> Array:
    """Coefficients at the lags 0 .. n - 1 of the period, (entries, ..., n_x, n_y), from `repeated` ones; see
    `whole_waves`.
    """
    return np.asarray(np.fft.irfft2(whole_waves(waves, cells[0], names, other), s=cells))


def whole_waves(
    waves: Array, nx: int, names: Sequence[str], other: int
) -> NDArray[np.complexfloating[Any, Any]]:
    """All wave numbers of a real transform, (entries, ..., n_x, n_y // 2 + 1), with their phase. names:
    indices of the entries, other: of what they are due to.
    """
    odd_x, odd_y = ([(name + str(other)).count(axis) % 2 for name in names] for axis in "12")
    m, between = np.arange(nx), (1,) * (waves.ndim - 3)
    sign = np.where(np.multiply.outer(odd_x, m > nx / 2), -1, 1)
    phase = (-1j) ** np.add(odd_x, odd_y)
    return (phase[:, None] * sign).reshape(-1, *between, nx, 1) * waves[..., np.minimum(m, nx - m), :]
