# SPDX-License-Identifier: MIT
"""Influence coefficients of a uniform eigenstrain in a cuboid of the half-space: residual stress, surface
displacement.

Paper: the coefficients of Eq. 6 and of the second sum of Eq. 7, in the appendix Eq. 19 and Eq. 22 to 26. The
printed appendix has several misprints (docs/equations.md): the rows of eigenstrain_table.json, which
tests/derivations/eigenstrain_table.py produces, replace its image part, and Mura's formula the rest.

The stress is the full-space part (source at depth z', offset z - z') plus the image part that frees the
surface z = 0 (offset z + z'), minus the eigenstrain's own stress inside the cuboid. Coefficients are
dimensionless: stress/mu and displacement/length of the caller per unit eigenstrain. Columns J = 3, 4, 5 (23,
13, 12) are the response to the tensor components e_ab = e_ba = 1. Offsets are observation minus source
everywhere.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cache
from itertools import combinations_with_replacement
from math import pi
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from sam.arrays import Array
from sam.kernels import line
from sam.kernels.patches import FURTHER, STRESS, Cuboids, Lags, parity as of_load, repeated
from sam.kernels.primitives import Corners, primitive

PAIRS = tuple((int(name[0]) - 1, int(name[1]) - 1) for name in STRESS)
ENTRIES = tuple(f"{i},{j}" for i in STRESS for j in STRESS)
PARITIES = (
    (0, 0),
    (1, 0),
    (1, 1),
    (0, 1),
)  # odd in x, in y; the orders of primitives with a < b are in the last
EXCHANGED = np.array([STRESS.index(name) for name in ("22", "11", "33", "13", "23", "12")])
"""The component that each becomes if x and y are exchanged."""
EXCHANGED_ROWS = np.add.outer(6 * EXCHANGED, EXCHANGED).ravel()
"""The same of coefficients 6 I + J."""
MIRRORED = np.array([(-1.0) ** (i + j).count("3") for i in STRESS for j in STRESS])[:, None, None]
"""Sign of each coefficient of the full space under z -> -z."""
FOURTH = tuple(
    sorted(
        combinations_with_replacement(range(3), 4),
        key=lambda indices: PARITIES.index((indices.count(0) % 2, indices.count(1) % 2)),
    )
)
"""Fourth derivatives of the triple antiderivative of R, of the full-space part, by parity."""


Term = tuple[int, int, int, int, int]
"""(p, q, a, b, c): z^p z'^q times the derivative of orders a, b, c of 1/R."""


@cache
def eigenstrain_table() -> dict[str, dict[str, dict[Term, tuple[float, ...]]]]:
    """The derived table: kind -> name -> {(p, q, a, b, c): coefficients of 1, nu, nu^2}."""
    raw = json.loads(Path(__file__).with_name("eigenstrain_table.json").read_text(encoding="utf-8"))
    return {
        kind: {
            name: {(row[0], row[1], row[2], row[3], row[4]): tuple(map(float, row[5])) for row in rows}
            for name, rows in entries.items()
        }
        for kind, entries in raw.items()
    }


def parity(i: int, j: int) -> tuple[int, int]:
    """Sign of stress coefficient [i, j] (0 .. 5) under x -> -x, y -> -y: each index 1 (2) is odd in x (y)."""
    return of_load(STRESS[i], STRESS[j])


def displacement_parity(component: int, j: int) -> tuple[int, int]:
    """Sign of the coefficient of u_component (1 .. 3) by eigenstrain j (0 .. 5) under x -> -x, y -> -y."""
    return of_load(str(component), STRESS[j])


@dataclass(frozen=True)
class Block:
    """Coefficients of one parity, rows 6 I + J: image (4, rows, functions), full (rows, functions)."""

    odd: tuple[int, int]
    rows: NDArray[np.intp]
    of_image: slice
    of_full: slice
    image: Array
    full: Array

    def times(self, factors: Array) -> Block:
        """The block with factors (36,) of its coefficients."""
        of_rows = factors[self.rows][:, None]
        return replace(self, image=of_rows * self.image, full=of_rows * self.full)


@cache
def blocks(nu: float, exchanged: bool = False) -> list[Block]:
    """The four blocks by PARITIES, for paper Eq. 22 to 26; z^p z' is integrated over z' by parts. exchanged:
    of two coefficients that an exchange of x and y takes into each other the first alone, in three blocks.
    """
    terms, coefficients = _matrix("stress", ENTRIES, nu)
    orders, scale = image_orders(), 8 * pi * (1 - nu)
    image = np.zeros((2, 2, 36, len(orders)))  # by powers of z and of the face
    for (p, q, a, b, c), column in zip(terms, coefficients.T / scale, strict=True):
        # paper Eq. 22, 23, 24 and 25, terms without a prime (the image)
        image[p, q, :, orders.index((a, b, c))] += column
        if q:
            image[p, 0, :, orders.index((a, b, c - 1))] -= column
    # paper Eq. 22, 23, 24 and 25, terms with a prime (the full space)
    full = -_full_space_matrix(nu) / scale  # minus: integrated over z', its antiderivative is one in z - z'
    signs = np.array([parity(*divmod(row, 6)) for row in range(36)])
    first = np.arange(36) <= EXCHANGED_ROWS
    out = []
    for odd in PARITIES[: 3 if exchanged else 4]:
        of_parity = (signs == (-1) ** np.array(odd)).all(axis=1)
        rows = np.flatnonzero(of_parity & first if exchanged and odd[0] == odd[1] else of_parity)
        of_image = _run([(a % 2, b % 2) == odd for a, b, _ in orders])
        of_full = _run([(indices.count(0) % 2, indices.count(1) % 2) == odd for indices in FOURTH])
        weights = image.reshape(4, 36, -1)[:, rows, of_image]
        out.append(Block(odd, rows, of_image, of_full, weights, full[rows, of_full]))
    return out


def _run(chosen: list[bool]) -> slice:
    """The true entries of a list, which are neighbours, as a slice."""
    return slice(chosen.index(True), chosen.index(True) + sum(chosen))


@cache
def image_orders() -> list[tuple[int, int, int]]:
    """Orders of the image part by parity; a < b last, which finds every shared function computed."""
    terms, _ = _matrix("stress", ENTRIES, 0.0)
    wanted = {(a, b, c) for _, _, a, b, c in terms} | {(a, b, c - 1) for _, q, a, b, c in terms if q}
    return sorted(
        wanted, key=lambda order: (PARITIES.index((order[0] % 2, order[1] % 2)), order[0] < order[1], order)
    )


def image_functions(x: Array, y: Array, z: Array) -> Iterator[Array]:
    """Primitives at corners, one after the other; as `image_orders`."""
    corners = Corners(x, y, z)
    return (primitive(*order, corners) for order in image_orders())


def surface_displacement_coefficients(cuboids: Cuboids, *, component: int = 3) -> Array:
    """Displacement at (i hx, j hy, 0) by a unit eigenstrain in the cuboids at the origin, (6, n,
    nx, ny). Paper Eq. 19 is component 3 (> 0 into the body), printed twice too large.
    """
    if cuboids.lags.period > 1:
        odd = np.array([[displacement_parity(component, j)[1] < 0] for j in range(6)])

        def alone(lags: Lags) -> Array:
            return surface_displacement_coefficients(replace(cuboids, lags=lags), component=component)

        return repeated(cuboids.lags, odd, FURTHER[1], alone)
    x, y = cuboids.lags.corners()
    if cuboids.lags.period == 1:
        return line.surface_displacement(x, cuboids.depths, cuboids.nu, component=component)[..., None]
    source = cuboids.depths[:, None, None]
    terms, matrix = _matrix("displacement", tuple(f"{component},{j}" for j in STRESS), cuboids.nu)
    basis = _table_basis(terms, Corners(x[:, None], y[None, :], source), source)
    # paper Eq. 19, with 1/(2 pi) where 1/pi is printed
    return (matrix / (2 * pi) @ np.stack([term.ravel() for term in basis])).reshape(
        6, cuboids.layers, *cuboids.lags.shape
    )


@cache
def _matrix(kind: str, names: tuple[str, ...], nu: float) -> tuple[list[Term], Array]:
    """The terms (p, q, a, b, c) of the named entries and their coefficients, (len(names), len(terms))."""
    table = eigenstrain_table()[kind]
    # those that need x and y exchanged (a < b) last: they then find every shared function computed
    terms = sorted(
        {term for name in names for term in table[name]}, key=lambda term: (term[2] < term[3], term)
    )
    matrix = np.zeros((len(names), len(terms)))
    for row, name in enumerate(names):
        for term, powers in table[name].items():
            matrix[row, terms.index(term)] = sum(c * nu**k for k, c in enumerate(powers))
    return terms, matrix


def _cells(corners: Array) -> Array:
    """Differences over the faces and the corners in x and y: (n+1, nx+1, ny+1) -> (n, nx, ny)."""
    in_y = corners[..., 1:] - corners[..., :-1]
    in_xy = in_y[:, 1:] - in_y[:, :-1]
    return in_xy[1:] - in_xy[:-1]


def _table_basis(terms: list[Term], corners: Corners, source: Array) -> list[Array]:
    """Integral of z'^q d_x^a d_y^b d_z^c (1/R) over the cuboids, by parts for q = 1, each (n, nx, ny)."""
    known: dict[tuple[int, int, int], Array] = {}

    def value(a: int, b: int, c: int) -> Array:
        if (a, b, c) not in known:
            known[a, b, c] = primitive(a, b, c, corners)
        return known[a, b, c]

    return [
        _cells(source * value(a, b, c) - value(a, b, c - 1) if q else value(a, b, c))
        for _, q, a, b, c in terms
    ]


def full_space_functions(x: Array, y: Array, z: Array) -> Iterator[Array]:
    """Q_ijlm, fourth derivatives of the triple antiderivative of R, at corners, one after the other; as
    FOURTH. Paper Eq. 26: R_,kkkk, R_,kkkl, R_,kkll and R_,123k, up to such terms as are named below; U_i is
    Eq. 27. Terms that the corner differences remove are chosen so that each form is odd or even in x, y and z
    and none is a difference of nearly equal numbers. With k the third axis: Q_iiii = -2 U_i + S_j + S_k,
    Q_iijj = -S_k, Q_iijk = x_i/R, Q_iiij = asinh(x_k/p_k) - x_i^2 x_k/(R p_k^2); U_i = atan(x_j x_k/(x_i R)),
    S_k = x y z/(R p_k^2), p_k^2 = x_i^2 + x_j^2.
    """
    axes: tuple[Array, Array, Array] = (x, y, z)
    squares = [w * w for w in axes]
    across = [squares[1] + squares[2], squares[0] + squares[2], squares[0] + squares[1]]
    inverse = 1 / np.sqrt(across[2] + squares[2])
    over_r = [w * inverse for w in axes]
    slope = [w / p for w, p in zip(over_r, across, strict=True)]  # x_k/(R p_k^2)
    log = [np.arcsinh(w / np.sqrt(p)) for w, p in zip(axes, across, strict=True)]
    saddle = [slope[k] * (axes[k - 1] * axes[k - 2]) for k in range(3)]
    with np.errstate(divide="ignore"):  # z = 0 on the uppermost face: atan(+-inf), the limit from inside
        # U_i, paper Eq. 27
        angle = [np.arctan(axes[i - 2] * over_r[i - 1] / axes[i]) for i in range(3)]

    def derivative(indices: tuple[int, ...]) -> Array:
        count = [indices.count(i) for i in range(3)]
        i = count.index(max(count))
        if max(count) == 4:
            return saddle[i - 1] + saddle[i - 2] - 2 * angle[i]  # paper Eq. 26, R_,kkkk
        if max(count) == 3:
            k = count.index(0)
            return log[k] - squares[i] * slope[k]  # paper Eq. 26, R_,kkkl
        # paper Eq. 26, R_,123k and R_,kkll
        return over_r[i] if 1 in count else -saddle[count.index(0)]

    return (derivative(indices) for indices in FOURTH)


@cache
def _full_space_matrix(nu: float) -> Array:
    """Stress/mu times 8 pi (1 - nu) in terms of Q, (36, 15); rows 6 I + J. Mura (1987) Eq. 11.30 and Hooke's
    law. u_i,m = Q_ijlm e_jl - 2 nu e_ll P_im - 4 (1 - nu) e_il P_lm with P_ij = Q_ijkk/2, and by contraction
    u_k,k = -2 (1 - 2 nu) P_jl e_jl - 2 nu e_ll P_kk. The last term is zero outside; inside, P_kk = -4 pi
    after the corner sum, it is part of `own_stress`. Thus sigma_ij = u_i,j + u_j,i - 4 nu P_kl e_kl delta_ij,
    fit for nu = 1/2.
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


def own_stress(nu: float) -> Array:
    """What is subtracted inside, (6, 6): the last term of paper Eq. 3, 2 e + (lam/mu) tr e, and the
    P_kk that `_full_space_matrix` leaves out, together 2 e + 2 nu/(1 - nu) tr e.
    """
    out = 2 * np.eye(6)
    out[:3, :3] += 2 * nu / (1 - nu)
    return out
