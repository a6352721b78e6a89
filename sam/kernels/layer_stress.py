# SPDX-License-Identifier: MIT
"""Residual stress between layers of cuboids: sums of the functions of `sam.kernels.eigenstrain` over corners,
faces and points.

Most of the work of a grid with equal layers is shared between pairs of layers, see `LayerStress`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from math import floor, log10, prod

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sam.arrays import Array
from sam.kernels.eigenstrain import (
    FOURTH,
    MIRRORED,
    Block,
    blocks,
    full_space_functions,
    image_functions,
    image_orders,
    own_stress,
)
from sam.kernels.patches import Cuboids, Lags

Numbers = NDArray[np.intp]
"""Numbers of pairs of layers."""
AT_ONCE = 1e5  # corners whose functions are computed together: 1e4 and 1e6 take as long
IN_CACHE = 2500  # cells of coefficients that are summed together: 100 take as long, 1e5 longer
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
    functions = CornerFunctions(cuboids.lags.shape, mesh(cuboids.lags, four_points(off)))
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
    """The functions that coefficients are sums of, differenced over the corners of cells; meshes:
    of corners, (points, X, Y), over whose points the mean is taken.
    """

    def __init__(self, shape: tuple[int, int], *meshes: tuple[Array, Array]):
        self.shape, self.meshes = shape, [x.shape for x, _ in meshes]
        self.x, self.y = (
            np.concatenate([part.ravel() for part in parts]) for parts in zip(*meshes, strict=True)
        )

    def __call__(self, image: bool, offsets: Array) -> Array:
        """`image_orders` at depths z + face, or FOURTH at z - face: (offsets, functions, nx, ny)."""
        functions = image_functions if image else full_space_functions
        out = np.empty((len(offsets), len(image_orders() if image else FOURTH), *self.shape))
        for k, value in enumerate(functions(self.x, self.y, offsets[:, None])):
            self.observed(out[:, k], *self._differenced(value))
        return out

    def _differenced(self, value: Array) -> Iterator[Array]:
        """The cells of each mesh, (offsets, points, X - 1, Y - 1)."""
        start = 0
        for sides in self.meshes:
            stop = start + prod(sides)
            corners = value[:, start:stop].reshape(-1, *sides)
            in_x = corners[..., 1:, :] - corners[..., :-1, :]
            yield in_x[..., 1:] - in_x[..., :-1]
            start = stop

    def observed(self, out: Array, cells: Array) -> None:
        """What is wanted of the cells of each mesh, into (offsets, nx, ny)."""
        np.add.reduce(cells, axis=1, out=out)
        if cells.shape[1] > 1:
            out /= cells.shape[1]


class LayerStress:
    """Stress in observed layers by eigenstrains in layers of cuboids, both of any thickness, from functions
    of corners. functions: (image?, offsets in depth) -> (offsets, functions, nx, ny), as `CornerFunctions`;
    points: (observed layers, g) depths, the answer is the mean over these g; faces: (n + 1,) as above;
    transform: a linear one of planes (..., nx, ny) of the given parity (odd in x?, in y?), whose last two
    sides are then those of the answer. With s = -1, +1 on the upper and lower face the stress is a sum over
    points and faces of s F(z - face) in the full space and of s (p00 + face p01 + z p10 + z face p11) G(z +
    face) of the image. Pairs of layers with equal offsets share them: the first depends on these alone, up to
    a sign for their opposite; the second, moved to z + d and face - d, is a polynomial of second degree in d.
    So equal layers need 2 n - 1 sums each, not n^2.
    """

    def __init__(
        self,
        functions: CornerFunctions,
        points: Array,
        faces: Array,
        nu: float,
        *,
        transform: Callable[[Array, tuple[int, int]], Array] = lambda planes, odd: planes,
    ):
        self.functions, self.nu, self.transform = functions, nu, transform
        z, face = np.broadcast_arrays(
            points[:, None, :, None], np.stack([faces[:-1], faces[1:]], axis=-1)[None, :, None]
        )
        self.z, self.face = (part.reshape(*part.shape[:2], -1) for part in (z, face))
        self.sign = np.tile([-1.0, 1.0], points.shape[1]) / points.shape[1]
        self.inside = (faces[:-1] <= points[:, :1]) & (points[:, :1] < faces[1:])
        offsets = self.z - self.face
        self.above = offsets.mean(axis=-1) < 0
        offsets[self.above] = -offsets[self.above][:, ::-1]
        self.digits = DIGITS - floor(log10(np.diff(faces).min()))
        at_once = max(1, int(AT_ONCE // (functions.x.size * self.sign.size)))
        self.image = _Shared(self.z + self.face, self.digits, self._image_sums, at_once)
        self.full = _Shared(offsets, self.digits, self._full_space_sums, at_once)

    def of(self, layer: int, out: Array) -> None:
        """Stress/mu in one of the observed layers into `out`, (36, n, X, Y); each once, in order."""
        for k, (image, full) in enumerate(zip(self.of_image(layer), self.of_full_space(layer), strict=True)):
            np.add(image, full, out=out[:, k], casting="same_kind")

    def of_image(self, layer: int) -> Iterator[Array]:
        """The part of the free surface alone, (36, X, Y) by each source; layers in order, as in `of`."""
        for k, (first, image) in enumerate(self.image.of(layer)):
            if move := self.z[layer, k, 0] - self.z.reshape(-1, self.z.shape[-1])[first, 0]:
                yield np.dot(move ** np.arange(3), image.reshape(3, -1)).reshape(image.shape[1:])
            else:
                yield image[0]

    def of_full_space(self, layer: int) -> Iterator[Array]:
        """The rest, that of the full space less the eigenstrain's own stress."""
        for k, (_, full) in enumerate(self.full.of(layer)):
            yield full * MIRRORED if self.above[layer, k] else full

    def _image_sums(self, first: Numbers, offsets: Array, shared: bool) -> Array:
        """Coefficients of 1, d and d^2, of 1 alone if not shared: (sets of offsets, 3 or 1, 36, X, Y)."""
        z, face = (part.reshape(-1, part.shape[-1])[first] for part in (self.z, self.face))
        ones, zeros = np.ones_like(z), np.zeros_like(z)
        of_d = [[ones, face, z, z * face], [zeros, -ones, ones, face - z], [zeros, zeros, zeros, -ones]]
        # (sets, 3 or 1, 4, points and faces)
        powers = self.sign * np.moveaxis(np.array(of_d[: 3 if shared else 1]), 2, 0)

        def weights(block: Block) -> Array:
            return np.einsum("sdpq,prf->sdrqf", powers, block.image)

        return self._sums(True, offsets, weights)

    def _full_space_sums(self, first: Numbers, offsets: Array, shared: bool) -> Array:
        """(sets of offsets, 36, X, Y), less the eigenstrain's own stress."""
        own = np.where(self.inside.ravel()[first][:, None], own_stress(self.nu).ravel(), 0.0)
        sign = self.sign[:, None]
        return self._sums(False, offsets, lambda block: (sign * block.full[:, None])[None, None], own)[:, 0]

    def _sums(
        self, image: bool, offsets: Array, weights: Callable[[Block], Array], own: Array | None = None
    ) -> Array:
        """Sums of functions at offsets (sets, n): (sets, d, 36, X, Y); own: subtracted inside."""
        _, first, index = np.unique(np.round(offsets, self.digits), return_index=True, return_inverse=True)
        functions, index = self.functions(image, offsets.ravel()[first]), index.reshape(offsets.shape)
        of_parity = [
            (block, block.of_image if image else block.of_full, weights(block)) for block in blocks(self.nu)
        ]
        some = max(1, int(IN_CACHE // prod(functions.shape[2:])))
        out: Array | None = None
        for sets in (slice(start, start + some) for start in range(0, len(offsets), some)):
            for block, of_block, matrix in of_parity:
                matrix = matrix[sets] if len(matrix) > 1 else matrix
                chosen = functions[:, of_block][index[sets]]
                sides = len(matrix), -1, prod(matrix.shape[3:])
                planes = matrix.reshape(sides) @ chosen.reshape(len(chosen), sides[-1], -1)
                planes = planes.reshape(len(chosen), *matrix.shape[1:3], *functions.shape[2:])
                if own is not None:  # paper, last term of Eq. 3: inside the plastic volume
                    planes[:, 0, :, 0, 0] -= own[sets][:, block.rows]
                planes = self.transform(planes, block.odd)
                if out is None:
                    out = np.empty((len(offsets), planes.shape[1], 36, *planes.shape[3:]))
                out[sets, :, block.rows] = planes
        assert out is not None, "there are sets and blocks"
        return out


class _Shared:
    """What pairs of layers with equal offsets share, made when first needed, kept to the last."""

    def __init__(
        self, offsets: Array, digits: int, make: Callable[[Numbers, Array, bool], Array], at_once: int
    ):
        self.offsets, self.make, self.at_once = offsets.reshape(-1, offsets.shape[-1]), make, at_once
        _, first, index, uses = np.unique(
            np.round(self.offsets, digits) + 0.0,
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
                self.known.update(zip(some, self.make(pairs, self.offsets[pairs], shared), strict=True))
        self.made += len(chosen)
