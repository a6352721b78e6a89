# SPDX-License-Identifier: MIT
"""Influence coefficients of a uniform eigenstrain in a cuboid of the half-space: residual stress, surface displacement.

Paper: Eq. 8 and the appendix (Eq. 19, 22 to 25). The printed appendix has several misprints; the rows of
eigenstrain_table.json, which derive_eigenstrain_table.py produces, replace its image part, and Mura's formula the rest.

The stress is the full-space part (source at depth z', offset z - z') plus the image part that frees the surface z = 0
(offset z + z'), minus the eigenstrain's own stress inside the cuboid. Coefficients are dimensionless: stress/mu and
displacement/length of the caller per unit eigenstrain. Columns J = 3, 4, 5 (23, 13, 12) are the response to the tensor
components e_ab = e_ba = 1. Offsets are observation minus source everywhere.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from itertools import combinations_with_replacement
from math import floor, log10, pi, prod
from pathlib import Path

import numpy as np

from sam.kernels.patches import STRESS
from sam.kernels.primitives import Corners, primitive

AT_ONCE = 1e5  # corners whose functions are computed together
IN_CACHE = 2500  # cells of coefficients that are summed together
DIGITS = 9  # to which depths are compared, in thicknesses of the thinnest layer
PAIRS = tuple((int(name[0]) - 1, int(name[1]) - 1) for name in STRESS)
ENTRIES = tuple(f"{i},{j}" for i in STRESS for j in STRESS)
PARITIES = ((0, 0), (1, 0), (1, 1), (0, 1))  # odd in x, in y; the orders of primitives with a < b are in the last
MIRRORED = np.array([(-1.0) ** (i + j).count("3") for i in STRESS for j in STRESS])[:, None, None]
"""Sign of each coefficient of the full space under z -> -z."""
FOURTH = tuple(
    sorted(
        combinations_with_replacement(range(3), 4),
        key=lambda indices: PARITIES.index((indices.count(0) % 2, indices.count(1) % 2)),
    )
)
"""Index sets of the 15 fourth derivatives of the triple antiderivative of R that the full-space part is made of, by parity."""


@cache
def eigenstrain_table() -> dict:
    """The derived table: kind -> name -> {(p, q, a, b, c): coefficients of 1, nu, nu^2} (derive_eigenstrain_table)."""
    raw = json.loads(Path(__file__).with_name("eigenstrain_table.json").read_text(encoding="utf-8"))
    return {
        kind: {name: {tuple(row[:5]): tuple(map(float, row[5])) for row in rows} for name, rows in entries.items()}
        for kind, entries in raw.items()
    }


def parity(i: int, j: int) -> tuple[int, int]:
    """Sign of stress coefficient [i, j] (0 .. 5) under x -> -x and under y -> -y: each index 1 (2) is odd in x (y)."""
    name = STRESS[i] + STRESS[j]
    return (-1) ** name.count("1"), (-1) ** name.count("2")


def displacement_parity(component: int, j: int) -> tuple[int, int]:
    """Sign of the coefficient of u_component (1, 2, 3) by eigenstrain j (0 .. 5) under x -> -x and under y -> -y."""
    name = str(component) + STRESS[j]
    return (-1) ** name.count("1"), (-1) ** name.count("2")


def residual_stress_coefficients(
    nx: int, ny: int, hx: float, hy: float, z_observed, faces, nu: float, off: tuple[float, float] = (0.0, 0.0)
) -> np.ndarray:
    """Stress/mu at (i hx, j hy, z) by a unit eigenstrain in the cuboid hx x hy x (faces[k], faces[k+1]) at the origin.

    z_observed: (nz,) depths >= 0, none of them on a face but z = 0 (the limit from inside the body); faces: (n+1,)
    increasing depths >= 0 of the layers' faces, of any thicknesses; same unit as hx, hy; 0 <= nu <= 1/2. Returns
    (6, 6, nz, n, nx, ny): stress I, eigenstrain J, lags i, j >= 0 (negative lags by `parity`). The eigenstrain's own
    stress in the cell itself is subtracted. off: the mean over four observations, this far from the centre on either side
    in x and y, within half a cell. ValueError if the depths are not as said.
    """
    z_observed, faces = _depths(z_observed, faces)
    functions = CornerFunctions((nx, ny), mesh(nx, ny, hx, hy, four_points(off)))
    layers = LayerStress(functions, z_observed[:, None], faces, nu)
    out = np.empty((36, z_observed.size, faces.size - 1, nx, ny))
    for k in range(z_observed.size):
        layers.of(k, out[:, k])
    return out.reshape(6, 6, *out.shape[1:])


def four_points(off: tuple[float, float]) -> list[tuple[float, float]]:
    """Off a centre by this much on either side in x and y; the centre alone for (0, 0)."""
    return [(a * off[0], b * off[1]) for a in (-1, 1) for b in (-1, 1)] if any(off) else [(0.0, 0.0)]


def mesh(nx: int, ny: int, hx: float, hy: float, points=((0.0, 0.0),), first: int = 0) -> tuple[np.ndarray, np.ndarray]:
    """Corners of cells at the lags first .. n - 1, moved to each of the points: x and y, both (points, nx + 1, ny + 1)."""
    x, y = (np.arange(first, n + 1) - 0.5 for n in (nx, ny))  # half-integers, none of them 0
    dx, dy = np.array(points, float).T[:, :, None, None]
    return np.broadcast_arrays(dx + (x * hx)[:, None], dy + (y * hy)[None, :])


class CornerFunctions:
    """The functions that the coefficients are sums of, differenced over the corners of cells in x and y.

    shape: (nx, ny) lags of the answer; meshes: of corners, (points, X, Y) each; here one, over whose points the mean is taken.
    """

    def __init__(self, shape: tuple[int, int], *meshes: tuple[np.ndarray, np.ndarray]):
        self.shape, self.meshes = shape, [x.shape for x, _ in meshes]
        self.x, self.y = (np.concatenate([part.ravel() for part in parts]) for parts in zip(*meshes, strict=True))

    def __call__(self, image: bool, offsets: np.ndarray) -> np.ndarray:
        """At depths z + face for the image, z - face for the full space: (offsets, functions, nx, ny).

        In the order of `image_orders` and of FOURTH.
        """
        functions = _image_functions if image else _full_space_functions
        out = np.empty((len(offsets), len(image_orders() if image else FOURTH), *self.shape))
        for k, value in enumerate(functions(self.x, self.y, offsets[:, None])):
            self.observed(out[:, k], *self._differenced(value))
        return out

    def _differenced(self, value: np.ndarray):
        """The cells of each mesh, (offsets, points, X - 1, Y - 1)."""
        start = 0
        for sides in self.meshes:
            stop = start + prod(sides)
            corners = value[:, start:stop].reshape(-1, *sides)
            in_x = corners[..., 1:, :] - corners[..., :-1, :]
            yield in_x[..., 1:] - in_x[..., :-1]
            start = stop

    def observed(self, out: np.ndarray, cells: np.ndarray) -> None:
        """What is wanted of the cells of each mesh, into (offsets, nx, ny)."""
        np.add.reduce(cells, axis=1, out=out)
        if cells.shape[1] > 1:
            out /= cells.shape[1]


class LayerStress:
    """Stress in observed layers by eigenstrains in layers of cuboids, both of any thickness, from functions of corners.

    functions: (image?, offsets in depth) -> (offsets, functions, nx, ny), as `CornerFunctions`; points: (observed layers, g)
    depths, the answer is the mean over these g; faces: (n + 1,) as above; transform: a linear one of planes (..., nx, ny) of the
    given parity (odd in x?, in y?), whose shape is then that of the answer.

    With s = -1, +1 on the upper and lower face the stress is a sum over points and faces of s F(z - face) in the full space
    and of s (p00 + face p01 + z p10 + z face p11) G(z + face) of the image. Pairs of layers with equal offsets share them: the
    first depends on these alone, up to a sign for their opposite; the second, moved to z + d and face - d, is a polynomial of
    second degree in d. So equal layers need 2 n - 1 sums each, not n^2.
    """

    def __init__(self, functions, points: np.ndarray, faces: np.ndarray, nu: float, transform=lambda planes, odd: planes):
        self.functions, self.nu, self.transform = functions, nu, transform
        z, face = np.broadcast_arrays(points[:, None, :, None], np.stack([faces[:-1], faces[1:]], axis=-1)[None, :, None])
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

    def of(self, layer: int, out: np.ndarray) -> None:
        """Stress/mu in one of the observed layers into `out`, (36, n, X, Y); each once, in order."""
        parts = zip(self.image.of(layer), self.full.of(layer), strict=True)
        for k, ((first, image), (_, full)) in enumerate(parts):
            move = self.z[layer, k, 0] - self.z.reshape(-1, self.z.shape[-1])[first, 0]
            if move:
                image = np.dot(move ** np.arange(3), image.reshape(3, -1)).reshape(image.shape[1:])
            else:
                image = image[0]
            np.add(image, full * MIRRORED if self.above[layer, k] else full, out=out[:, k], casting="same_kind")

    def _image_sums(self, first: np.ndarray, offsets: np.ndarray, shared: bool) -> np.ndarray:
        """Coefficients of 1, d and d^2, of 1 alone if not shared: (sets of offsets, 3 or 1, 36, X, Y)."""
        z, face = (part.reshape(-1, part.shape[-1])[first] for part in (self.z, self.face))
        one, none = np.ones_like(z), np.zeros_like(z)
        powers = [[one, face, z, z * face], [none, -one, one, face - z], [none, none, none, -one]][: 3 if shared else 1]
        powers = self.sign * np.moveaxis(np.array(powers), 2, 0)  # (sets, 3 or 1, 4, points and faces)
        return self._sums(True, offsets, lambda block: np.einsum("sdpq,prf->sdrqf", powers, block.image))

    def _full_space_sums(self, first: np.ndarray, offsets: np.ndarray, shared: bool) -> np.ndarray:
        """(sets of offsets, 36, X, Y), less the eigenstrain's own stress."""
        own = np.where(self.inside.ravel()[first][:, None], _own_stress(self.nu).ravel(), 0.0)
        weights = self.sign[:, None]
        return self._sums(False, offsets, lambda block: (weights * block.full[:, None])[None, None], own)[:, 0]

    def _sums(self, image: bool, offsets: np.ndarray, weights, own=None) -> np.ndarray:
        """Sums of functions at offsets (sets, n), n points and faces: (sets, d, 36, X, Y).

        weights: block -> (sets or 1, d, rows, n, functions); own: (sets, 36), subtracted in the cell itself.
        """
        _, first, index = np.unique(np.round(offsets, self.digits), return_index=True, return_inverse=True)
        functions, index = self.functions(image, offsets.ravel()[first]), index.reshape(offsets.shape)
        blocks = [(block, block.of_image if image else block.of_full, weights(block)) for block in _blocks(self.nu)]
        some, out = max(1, int(IN_CACHE // prod(functions.shape[2:]))), None
        for sets in (slice(start, start + some) for start in range(0, len(offsets), some)):
            for block, of_block, matrix in blocks:
                matrix = matrix[sets] if len(matrix) > 1 else matrix
                chosen = functions[:, of_block][index[sets]]
                sides = len(matrix), -1, prod(matrix.shape[3:])
                planes = matrix.reshape(sides) @ chosen.reshape(len(chosen), sides[-1], -1)
                planes = planes.reshape(len(chosen), *matrix.shape[1:3], *functions.shape[2:])
                if own is not None:
                    planes[:, 0, :, 0, 0] -= own[sets][:, block.rows]
                planes = self.transform(planes, block.odd)
                if out is None:
                    out = np.empty((len(offsets), planes.shape[1], 36, *planes.shape[3:]))
                out[sets, :, block.rows] = planes
        return out


class _Shared:
    """What pairs of layers with equal offsets share, made when first needed and kept until the last need.

    offsets: (observed, sources, points and faces), equal if they are to so many digits; make(numbers of pairs, their offsets,
    whether shared) -> one array for each, called for at most `at_once` of them.
    """

    def __init__(self, offsets: np.ndarray, digits: int, make, at_once: int):
        self.offsets, self.make, self.at_once = offsets.reshape(-1, offsets.shape[-1]), make, at_once
        _, first, index, uses = np.unique(
            np.round(self.offsets, digits) + 0.0, axis=0, return_index=True, return_inverse=True, return_counts=True
        )
        order = np.argsort(first)
        self.first, self.shared = first[order], uses[order] > 1
        self.number = np.argsort(order)[index.ravel()].reshape(offsets.shape[:2])
        self.last = np.zeros(len(first), int)
        self.last[self.number] = np.arange(len(offsets))[:, None]
        self.known: dict[int, np.ndarray] = {}
        self.made = 0

    def of(self, layer: int) -> list[tuple[int, np.ndarray]]:
        """For each source the number of the pair that its array was made for, and the array."""
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


@dataclass(frozen=True)
class _Block:
    """The coefficients of one parity in x and y: rows 6 I + J as sums of functions of the same parity.

    of_image, of_full: which of `image_orders` and of FOURTH; image: (4, rows, functions), factors of 1, face, z and z face;
    full: (rows, functions).
    """

    odd: tuple[int, int]
    rows: np.ndarray
    of_image: slice
    of_full: slice
    image: np.ndarray
    full: np.ndarray


@cache
def _blocks(nu: float) -> list[_Block]:
    """The four blocks, in the order of PARITIES.

    A term z^p z'^q of the table is integrated over z' by parts: z' P[a,b,c] - P[a,b,c-1] for q = 1.
    """
    terms, coefficients = _matrix("stress", ENTRIES, nu)
    orders, scale = image_orders(), 8 * pi * (1 - nu)
    image = np.zeros((2, 2, 36, len(orders)))  # by powers of z and of the face
    for (p, q, a, b, c), column in zip(terms, coefficients.T / scale, strict=True):
        image[p, q, :, orders.index((a, b, c))] += column
        if q:
            image[p, 0, :, orders.index((a, b, c - 1))] -= column
    full = -_full_space_matrix(nu) / scale  # minus: integrated over z', its antiderivative is one in z - z'
    signs = np.array([parity(*divmod(row, 6)) for row in range(36)])
    blocks = []
    for odd in PARITIES:
        rows = np.flatnonzero((signs == (-1) ** np.array(odd)).all(axis=1))
        of_image = _run([(a % 2, b % 2) == odd for a, b, _ in orders])
        of_full = _run([(indices.count(0) % 2, indices.count(1) % 2) == odd for indices in FOURTH])
        weights = image.reshape(4, 36, -1)[:, rows, of_image]
        blocks.append(_Block(odd, rows, of_image, of_full, weights, full[rows, of_full]))
    return blocks


def _run(chosen: list[bool]) -> slice:
    """Of neighbours in a list."""
    return slice(chosen.index(True), chosen.index(True) + sum(chosen))


@cache
def image_orders() -> list[tuple[int, int, int]]:
    """Orders of the primitives that the image part is made of, by parity.

    Those that need x and y exchanged (a < b) last: they then find every shared function computed.
    """
    terms, _ = _matrix("stress", ENTRIES, 0.0)
    wanted = {(a, b, c) for _, _, a, b, c in terms} | {(a, b, c - 1) for _, q, a, b, c in terms if q}
    return sorted(wanted, key=lambda order: (PARITIES.index((order[0] % 2, order[1] % 2)), order[0] < order[1], order))


def _image_functions(x, y, z) -> Iterator[np.ndarray]:
    """Primitives at corners, one after the other; as `image_orders`."""
    corners = Corners(x, y, z)
    return (primitive(*order, corners) for order in image_orders())


def surface_displacement_coefficients(
    nx: int, ny: int, hx: float, hy: float, faces, nu: float, component: int = 3
) -> np.ndarray:
    """Displacement of the surface at (i hx, j hy, 0) by a unit eigenstrain in the cuboids at the origin.

    faces as in `residual_stress_coefficients`; the answer has their unit of length; component: 1, 2 or 3 (u_3 > 0 into
    the body). Returns (6, n, nx, ny): eigenstrain J, layer, lags i, j >= 0 (negative lags: `displacement_parity`).
    """
    _, faces = _depths((), faces)
    x, y = _half_integers(nx, ny, hx, hy)
    source = faces[:, None, None]
    terms, matrix = _matrix("displacement", tuple(f"{component},{j}" for j in STRESS), nu)
    basis = _table_basis(terms, Corners(x, y, source), source)
    return _combine(matrix / (2 * pi), basis).reshape(6, faces.size - 1, nx, ny)


def _depths(z_observed, faces) -> tuple[np.ndarray, np.ndarray]:
    z_observed, faces = np.atleast_1d(np.asarray(z_observed, float)), np.asarray(faces, float)
    if faces.ndim != 1 or faces.size < 2 or faces[0] < 0 or not np.all(np.diff(faces) > 0):
        raise ValueError("faces must be two or more increasing depths >= 0")
    if np.any(z_observed < 0) or np.isin(z_observed, faces[faces > 0]).any():
        raise ValueError("z_observed must be >= 0 and not on a face inside the body, where the stress jumps")
    return z_observed, faces


def _half_integers(nx: int, ny: int, hx: float, hy: float) -> tuple[np.ndarray, np.ndarray]:
    """Corners of the cells at the lags 0 .. n-1, none of them at x = 0 or y = 0."""
    return ((np.arange(nx + 1) - 0.5) * hx)[:, None], ((np.arange(ny + 1) - 0.5) * hy)[None, :]


@cache
def _matrix(kind: str, names: tuple[str, ...], nu: float) -> tuple[list[tuple], np.ndarray]:
    """The terms (p, q, a, b, c) that the named entries use and their coefficients, (len(names), len(terms))."""
    table = eigenstrain_table()[kind]
    # those that need x and y exchanged (a < b) last: they then find every shared function computed
    terms = sorted({term for name in names for term in table[name]}, key=lambda term: (term[2] < term[3], term))
    matrix = np.zeros((len(names), len(terms)))
    for row, name in enumerate(names):
        for term, powers in table[name].items():
            matrix[row, terms.index(term)] = sum(c * nu**k for k, c in enumerate(powers))
    return terms, matrix


def _cells(corners: np.ndarray) -> np.ndarray:
    """Differences over the faces and the corners in x and y: (n+1, nx+1, ny+1) -> (n, nx, ny)."""
    in_y = corners[..., 1:] - corners[..., :-1]
    in_xy = in_y[:, 1:] - in_y[:, :-1]
    return in_xy[1:] - in_xy[:-1]


def _combine(coefficients: np.ndarray, basis: list[np.ndarray]) -> np.ndarray:
    """Coefficients (rows, terms) times the terms: (rows, n * nx * ny)."""
    return coefficients @ np.stack([term.ravel() for term in basis])


def _table_basis(terms: list[tuple], corners: Corners, source) -> list[np.ndarray]:
    """Integral over the cuboids of z'^q d_x^a d_y^b d_z^c (1/R), the terms of a table without z^p: each (n, nx, ny).

    By parts: z' P[a,b,c] - P[a,b,c-1] for q = 1.
    """
    known: dict[tuple, np.ndarray] = {}

    def value(*order):
        if order not in known:
            known[order] = primitive(*order, corners)
        return known[order]

    return [_cells(source * value(a, b, c) - value(a, b, c - 1) if q else value(a, b, c)) for _, q, a, b, c in terms]


def _full_space_functions(x, y, z) -> Iterator[np.ndarray]:
    """Q_ijlm, fourth derivatives of the triple antiderivative of R, at corners, one after the other; as FOURTH.

    Terms that the corner differences remove are chosen so that each form is odd or even in x, y and z and none is a
    difference of nearly equal numbers. With k the third axis:
    Q_iiii = -2 U_i + S_j + S_k, Q_iijj = -S_k, Q_iijk = x_i/R, Q_iiij = asinh(x_k/p_k) - x_i^2 x_k/(R p_k^2);
    U_i = atan(x_j x_k/(x_i R)), S_k = x y z/(R p_k^2), p_k^2 = x_i^2 + x_j^2.
    """
    axes = (x, y, z)
    squares = [w * w for w in axes]
    across = [squares[1] + squares[2], squares[0] + squares[2], squares[0] + squares[1]]
    inverse = 1 / np.sqrt(across[2] + squares[2])
    over_r = [w * inverse for w in axes]
    slope = [w / p for w, p in zip(over_r, across, strict=True)]  # x_k/(R p_k^2)
    log = [np.arcsinh(w / np.sqrt(p)) for w, p in zip(axes, across, strict=True)]
    saddle = [slope[k] * (axes[k - 1] * axes[k - 2]) for k in range(3)]
    with np.errstate(divide="ignore"):  # z = 0 on the uppermost face: atan(+-inf), the limit from inside
        angle = [np.arctan(axes[i - 2] * over_r[i - 1] / axes[i]) for i in range(3)]

    def derivative(indices):
        count = [indices.count(i) for i in range(3)]
        i = count.index(max(count))
        if max(count) == 4:
            return saddle[i - 1] + saddle[i - 2] - 2 * angle[i]
        if max(count) == 3:
            k = count.index(0)
            return log[k] - squares[i] * slope[k]
        return over_r[i] if 1 in count else -saddle[count.index(0)]

    return (derivative(indices) for indices in FOURTH)


@cache
def _full_space_matrix(nu: float) -> np.ndarray:
    """Stress/mu times 8 pi (1 - nu) in terms of Q, (36, 15); rows 6 I + J. Mura (1987) Eq. 11.30 and Hooke's law.

    u_i,m = Q_ijlm e_jl - 2 nu e_ll P_im - 4 (1 - nu) e_il P_lm with P_ij = Q_ijkk/2, and by contraction
    u_k,k = -2 (1 - 2 nu) P_jl e_jl - 2 nu e_ll P_kk. The last term is zero outside; inside, P_kk = -4 pi after the
    corner sum, it is part of `_own_stress`. Thus sigma_ij = u_i,j + u_j,i - 4 nu P_kl e_kl delta_ij, fit for nu = 1/2.
    """
    fourth = np.zeros((3, 3, 3, 3, len(FOURTH)))
    for indices in np.ndindex(3, 3, 3, 3):
        fourth[indices][FOURTH.index(tuple(sorted(indices)))] = 1
    second = sum(fourth[..., k, k, :] for k in range(3)) / 2
    out = np.zeros((6, 6, len(FOURTH)))
    for column, (a, b) in enumerate(PAIRS):
        e = np.zeros((3, 3))
        e[a, b] = e[b, a] = 1
        gradient = np.tensordot(e, fourth, ([0, 1], [1, 2]))  # Q_ijlm e_jl
        gradient = gradient - 2 * nu * np.trace(e) * second - 4 * (1 - nu) * np.tensordot(e, second, 1)
        volume = np.tensordot(e, second, 2)
        for row, (i, j) in enumerate(PAIRS):
            out[row, column] = gradient[i, j] + gradient[j, i] - (4 * nu * volume if i == j else 0)
    return out.reshape(36, len(FOURTH))


def _own_stress(nu: float) -> np.ndarray:
    """What is subtracted inside, (6, 6): 2 e + (lam/mu) tr e, with the term of P_kk that `_full_space_matrix` leaves out.

    lam/mu = 2 nu/(1 - 2 nu); the term left out is lam/mu * 8 pi nu/(8 pi (1 - nu)) tr e: together 2 nu/(1 - nu) tr e.
    """
    own = 2 * np.eye(6)
    own[:3, :3] += 2 * nu / (1 - nu)
    return own
