# SPDX-License-Identifier: MIT
"""Residual stress between layers of cuboids: sums of the functions of `sam.kernels.eigenstrain` over corners,
faces and points.

Most of the work of a grid with equal layers is shared between pairs of layers, see `LayerStress`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from itertools import islice
from math import floor, log10, prod

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sam.arrays import Array, Mask
from sam.kernels import line
from sam.kernels.eigenstrain import (
    EXCHANGED_ROWS,
    FOURTH,
    MIRRORED,
    blocks,
    full_space_functions,
    image_functions,
    image_orders,
    own_stress,
)
from sam.kernels.patches import FURTHER, Cuboids, Lags, apart

Numbers = NDArray[np.intp]
"""Numbers of pairs of layers."""
AT_ONCE = 1e5  # corners whose functions are computed together: 1e4 and 1e6 take as long
DIGITS = 9  # to which depths are compared, in thicknesses of the thinnest layer: far above rounding


def residual_stress_coefficients(
    cuboids: Cuboids, z: ArrayLike, *, off: tuple[float, float] = (0.0, 0.0)
) -> Array:
    """Stress/mu at (i hx, j hy, z) by a unit eigenstrain in the cuboids at the origin, (6, 6, nz,
    n, nx, ny): S_pl of paper Eq. 7, in the appendix the stress outside and inside with Eq. 22 to
    26. z: (nz,) in hx, none on a face but 0 (ValueError); off: the mean over four points so far
    away.
    """
    z_observed, faces = np.atleast_1d(np.asarray(z, float)), cuboids.depths
    if np.any(z_observed < 0) or np.isin(z_observed, faces[faces > 0]).any():
        raise ValueError("z_observed must be >= 0 and not on a face inside the body, where the stress jumps")
    functions = functions_of(
        cuboids.lags, lambda lags: CornerFunctions(lags.shape, mesh(lags, four_points(off)))
    )
    layers = LayerStress(functions, z_observed[:, None], faces, cuboids.nu)
    out = np.empty((36, z_observed.size, cuboids.layers, *cuboids.lags.shape))
    for k in range(z_observed.size):
        layers.of(k, out[:, k])
    return out.reshape(6, 6, *out.shape[1:])


Points = Sequence[tuple[float, float]]
"""(x, y) of observed points, from the centre of their cell."""


def four_points(off: tuple[float, float]) -> Points:
    """The four points that lie off a centre by this much on either side in x and y; the centre for (0, 0)."""
    return [(a * off[0], b * off[1]) for a in (-1, 1) for b in (-1, 1)] if any(off) else [(0.0, 0.0)]


def mesh(lags: Lags, points: Points = ((0.0, 0.0),), *, first: int = 0) -> tuple[Array, Array]:
    """x and y of the corners of cells, seen from each point, both (points, X, Y); lags first .. n - 1."""
    x, y = lags.corners(first)
    dx, dy = np.array(points, float).T[:, :, None, None]
    moved_x, moved_y = np.broadcast_arrays(dx + x[:, None], dy + y[None, :])
    return moved_x, moved_y


class CornerFunctions:
    """The functions that coefficients are sums of, at the corners of cells; meshes: of corners,
    (points, X, Y), over whose points the mean is taken. line: all is the same at every y.
    """

    line = False

    def __init__(self, shape: tuple[int, int], *meshes: tuple[Array, Array]):
        self.meshes = [x.shape for x, _ in meshes]
        self.x, self.y = (
            np.concatenate([part.ravel() for part in parts]) for parts in zip(*meshes, strict=True)
        )
        self.itself = np.zeros(shape)  # the plane that is 1 in the cell of the source
        self.itself[0, 0] = 1.0

    def __call__(self, image: bool, offsets: Array, wanted: int | None = None) -> Array:
        """The first of `image_orders` at depths z + face, or of FOURTH at z - face, all if not said how many:
        (..., functions, g, corners) at offsets (..., g).
        """
        functions = image_functions if image else full_space_functions
        if wanted is None:
            wanted = len(image_orders() if image else FOURTH)
        out = np.empty((*offsets.shape[:-1], wanted, offsets.shape[-1], self.x.size))
        for k, value in enumerate(islice(functions(self.x, self.y, offsets[..., None]), wanted)):
            out[..., k, :, :] = value
        return out

    def _differences(self, corners: Array) -> Iterator[Array]:
        """Over the corners of the cells of each mesh: (..., points, X, Y), the last of X and of Y to be left
        out.
        """
        start = 0
        for sides in self.meshes:
            stop, row = start + prod(sides), sides[-1]
            # in one go; those over the border are not wanted
            flat = corners[..., start:stop].reshape(-1)
            out = np.empty(flat.size)
            np.subtract(flat[row:], flat[:-row], out=out[:-row])
            np.subtract(out[1:-row], out[: -row - 1], out=out[: -row - 1])
            yield out.reshape(*corners.shape[:-1], *sides)
            start = stop

    def planes(self, corners: Array, odd: tuple[int, int]) -> Array:
        """What is wanted of the cells: (..., nx, ny) from sums of functions (..., corners) of one parity."""
        (cells,) = self._differences(corners)
        return np.asarray(cells[..., :-1, :-1].mean(axis=-3))


class RepeatedFunctions(CornerFunctions):
    """Functions of cells that repeat along y, by those of cells alone and of strips; alone: makes either."""

    def __init__(self, lags: Lags, alone: Callable[[Lags], CornerFunctions]):
        self.lags, (space, strip) = lags, apart(lags)
        self.cells = alone(replace(space, ny=(FURTHER[1][-1] + 1) * lags.period + 1))
        self.strip = alone(strip)
        self.x, self.y = (
            np.concatenate(both) for both in ((self.cells.x, self.strip.x), (self.cells.y, self.strip.y))
        )
        self.itself = np.zeros(lags.shape)
        self.itself[0, :: lags.period] = 1.0

    def planes(self, corners: Array, odd: tuple[int, int]) -> Array:
        """Of the cells: (..., nx, ny)."""
        of_cells, of_strip = np.split(corners, [self.cells.x.size], axis=-1)
        cells, period = self.cells.planes(of_cells, odd), self.lags.period
        plane, sign = self.strip.planes(of_strip, odd), np.array(odd[1])
        found = line.repeated(lambda ny: cells, plane, period, odd=sign, up_to=FURTHER[1])
        return np.asarray(found[..., np.arange(self.lags.ny) % period])


def functions_of(lags: Lags, alone: Callable[[Lags], CornerFunctions]) -> CornerFunctions:
    """The functions of cells that may repeat along y; alone: those of cells that do not, or of strips."""
    return RepeatedFunctions(lags, alone) if lags.period > 1 else alone(lags)


class LayerStress:
    """Stress in observed layers by eigenstrains in layers of cuboids, both of any thickness, from functions
    of corners. points: (observed layers, g) depths, the answer is the mean over these g; faces: (n + 1,) as
    above; scale: (36,) factors; exchanged: the mesh is the same with x and y exchanged, and of two
    coefficients that change places one is summed. With s = -1, +1 on the upper and lower face the stress is a
    sum over points and faces of s F(z - face) in the full space and of s (p00 + face p01 + z p10 + z face
    p11) G(z + face) of the image. Pairs of layers with equal offsets share them: the first depends on these
    alone, up to a sign for their opposite; the second, moved to z + d and face - d, is a polynomial of second
    degree in d. So equal layers need 2 n - 1 sums each, not n^2.
    """

    def __init__(
        self,
        functions: CornerFunctions,
        points: Array,
        faces: Array,
        nu: float,
        *,
        scale: Array | None = None,
        exchanged: bool = False,
    ):
        self.functions, self.points, self.faces = functions, points, faces
        self.exchanged, factors = exchanged, np.ones(36) if scale is None else scale
        self.blocks = [
            block.times(factors) for block in blocks(nu, exchanged) if not (functions.line and block.odd[1])
        ]
        self.rows = np.concatenate([block.rows for block in self.blocks])
        self.own = (factors * own_stress(nu).ravel())[self.rows]
        self.mirrored = MIRRORED[self.rows]
        offsets = points[:, None, :, None] - np.stack([faces[:-1], faces[1:]], axis=-1)[:, None]
        self.inside = (faces[:-1] <= points[:, :1]) & (points[:, :1] < faces[1:])
        self.above = offsets.mean(axis=(2, 3)) < 0
        sums = 2 * points[:, None, :, None] - offsets
        offsets[self.above] = -offsets[self.above][:, ::-1, ::-1]
        digits = DIGITS - floor(log10(np.diff(faces).min()))
        at_once = max(1, int(AT_ONCE // (functions.x.size * 2 * points.shape[1])))
        self.image = _Shared(sums, digits, self._image_sums, at_once)
        self.full = _Shared(offsets, digits, self._full_space_sums, at_once)

    def of(self, layer: int, out: Array, sources: slice = slice(None)) -> None:
        """Stress/mu in one of the observed layers by sources into `out`, (36, n, X, Y); each once, in order.
        In plane strain what is odd in y is left as it is.
        """
        found = zip(self._image(layer, sources), self._full_space(layer, sources), strict=True)
        for k, (image, stress) in enumerate(found):
            stress += image
            self._every(stress, out[:, k])

    def of_part(self, layer: int, image: bool) -> Iterator[Array]:
        """The part of the free surface alone, or the rest, that of the full space less the eigenstrain's own
        stress, (36, X, Y) by each source; layers in order, as in `of`.
        """
        for rows in self._image(layer) if image else self._full_space(layer):
            yield self._every(rows, np.empty((36, *rows.shape[1:])))

    def _every(self, rows: Array, out: Array) -> Array:
        """Into all coefficients from those that are summed."""
        if self.exchanged:
            out[EXCHANGED_ROWS[self.rows]] = rows.swapaxes(-1, -2)
        out[self.rows] = rows
        return out

    def _image(self, layer: int, sources: slice = slice(None)) -> Iterator[Array]:
        for first, image in self.image.of(layer)[sources]:
            if move := self.points[layer, 0] - self.points[first // (len(self.faces) - 1), 0]:
                yield np.dot(move ** np.arange(3), image.reshape(3, -1)).reshape(image.shape[1:])
            else:
                yield image[0]

    def _full_space(self, layer: int, sources: slice = slice(None)) -> Iterator[Array]:
        for k, (_, shared) in list(enumerate(self.full.of(layer)))[sources]:
            stress = shared * self.mirrored if self.above[layer, k] else shared.copy()
            if self.inside[layer, k]:  # paper, last term of Eq. 3: inside the plastic volume
                stress -= self.own[:, None, None] * self.functions.itself
            yield stress

    def _at_faces(self, pairs: Numbers, opposite: Mask) -> tuple[Array, Array, Numbers, Numbers]:
        """Points and faces, both (m, g), that these pairs of layers need, each once; the sign of their
        offset, (m, 1), -1 if opposite; and which of them belong to the upper and to the lower face of each
        pair, (2, pairs).
        """
        layer, source = np.divmod(pairs, len(self.faces) - 1)
        face = layer * len(self.faces) + source + np.stack([opposite, ~opposite])
        each, index = np.unique(2 * face + opposite, return_inverse=True)
        layer, face = np.divmod(each // 2, len(self.faces))
        z, face = np.broadcast_arrays(self.points[layer], self.faces[face][:, None])
        return z, face, 1 - 2 * (each % 2)[:, None], index.reshape(2, -1)

    def _image_sums(self, pairs: Numbers, shared: bool) -> Array:
        """Coefficients of 1, d and d^2, of 1 alone if not shared: (pairs, 3 or 1, rows, X, Y)."""
        z, face, _, index = self._at_faces(pairs, np.zeros(len(pairs), bool))
        functions = self.functions(True, z + face, self.blocks[-1].of_image.stop)
        ones, zeros = np.ones_like(z), np.zeros_like(z)
        of_d = [[ones, face, z, z * face], [zeros, -ones, ones, face - z], [zeros, zeros, zeros, -ones]]
        powers = np.array(of_d[: 3 if shared else 1]) / z.shape[1]  # (3 or 1, 4, m, g)
        planes = []
        for block in self.blocks:
            weights = np.einsum("dpmg,prf->mdrfg", powers, block.image)
            sides = len(z), -1, weights[0, 0, 0].size
            at_faces = weights.reshape(sides) @ functions[:, block.of_image].reshape(len(z), sides[-1], -1)
            sums = at_faces[index[1]] - at_faces[index[0]]
            sums = sums.reshape(len(pairs), len(powers), len(block.rows), -1)
            planes.append(self.functions.planes(sums, block.odd))
        return np.concatenate(planes, axis=2)

    def _full_space_sums(self, pairs: Numbers, shared: bool) -> Array:
        """The coefficients by sums of the functions, without the eigenstrain's own: (pairs, rows, X, Y)."""
        z, face, sign, index = self._at_faces(pairs, self.above.ravel()[pairs])
        functions = self.functions(False, sign * (z - face), self.blocks[-1].of_full.stop).mean(axis=2)
        sums = functions[index[1]] - functions[index[0]]
        planes = [
            np.tensordot(block.full, self.functions.planes(sums[:, block.of_full], block.odd), ([1], [1]))
            for block in self.blocks
        ]
        return np.concatenate(planes).swapaxes(0, 1)


class _Shared:
    """What pairs of layers with equal offsets share, made when first needed, kept to the last."""

    def __init__(self, offsets: Array, digits: int, make: Callable[[Numbers, bool], Array], at_once: int):
        self.make, self.at_once = make, at_once
        _, first, index, uses = np.unique(
            np.round(offsets.reshape(-1, prod(offsets.shape[2:])), digits) + 0.0,
            axis=0,
            return_index=True,
            return_inverse=True,
            return_counts=True,
        )
        order = np.argsort(first)
        self.first, self.shared = first[order], uses[order] > 1
        self.number = np.argsort(order)[index.ravel()].reshape(offsets.shape[:2])
        self.last = np.zeros(len(first), int)
        self.last[self.number] = np.arange(len(offsets))[:, None]
        self.known: dict[int, Array] = {}
        self.made = 0

    def of(self, layer: int) -> list[tuple[int, Array]]:
        """The number of the pair that the array of each source was made for, and the array."""
        numbers = self.number[layer]
        while self.made <= numbers.max():
            self._more()
        out = [(self.first[k], self.known[k]) for k in numbers]
        for k in np.unique(numbers[self.last[numbers] == layer]):
            del self.known[k]
        return out

    def _more(self) -> None:
        chosen = np.arange(self.made, min(self.made + self.at_once, len(self.first)))
        for shared in (False, True):
            some = chosen[self.shared[chosen] == shared]
            if some.size:
                pairs = self.first[some]
                self.known.update(zip(some, self.make(pairs, shared), strict=True))
        self.made += len(chosen)
