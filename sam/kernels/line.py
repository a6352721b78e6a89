# SPDX-License-Identifier: MIT
"""Influence coefficients in plane strain, of strips that are loaded and of sections that are strained alike
at every y: the displacements of the surface, to which no form of `sam.kernels.primitives` tends.

A line force has no displacement that is zero far away. Along its direction that of the surface is therefore
counted from a distance: zero at |x| = reference from the middle of the strip's source at x = 0. Stresses are
those of a rectangle or a cuboid that is long in y, see `Lags.corners`.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import pi, prod

import numpy as np

from sam.arrays import Array

BESIDE = 3.0  # periods: further away cells that repeat act as plane strain does, to exp(-2 pi 3) = 7e-9


def displacement(x: Array, nu: float, reference: float, *, component: int, load: int) -> Array:
    """Displacement times mu of the surface by unit traction on a strip between the corners x, (n + 1,), seen
    from the observed points; (n,) in the unit of x. component, load: 1 or 3. Paper: D_33 and D_31 of Eq. 5.
    """
    size = np.abs(x)
    if component == load:  # Johnson 1985, sections 2.2 and 2.3, with that constant
        return (1 - nu) / pi * -np.diff(x * (np.log(size / reference) - 1))
    sign = 1 if component == 1 else -1
    return sign * (2 * nu - 1) / 4 * np.diff(size)  # the same


def surface_displacement(x: Array, faces: Array, nu: float, *, component: int) -> Array:
    """Displacement of the surface by unit eigenstrain in sections between the corners x, (m + 1,), seen from
    the observed points, and faces, (n + 1,): (6, n, m) in the unit of x. By reciprocity the integral over the
    section of the stress of a unit line force at the observed point (Johnson 1985, sections 2.2 and 2.3).
    Paper Eq. 19.
    """
    x, z = np.asarray(x)[None, :], np.asarray(faces)[:, None]
    depth, side = z * np.arctan2(x, z) / 2, np.abs(x) * np.arctan2(z, np.abs(x)) / 2
    log = np.log(x * x + z * z) / 2
    # double integrals of x^2 z/r^4 and x z^2/r^4, and the third power of the force's direction
    normal, third = (depth, depth + x * log) if component == 3 else (side, side + z * log)
    stress = np.zeros((6, *depth.shape))
    along, across = (2, 0) if component == 3 else (0, 2)
    stress[along], stress[across] = third, normal
    stress[1] = nu * (third + normal)
    stress[4] = -2 * (side if component == 3 else depth)  # e_13 and e_31
    sign = 1.0 if component == 3 else -1.0  # of x from the source to the observed point
    return -2 / pi * sign * np.diff(np.diff(stress, axis=1), axis=2)


def repeated(
    cell: Callable[[int], Array], plane: Array, period: int, *, odd: Array, up_to: Sequence[int]
) -> Array:
    """Coefficients of a cell that repeats along y after a period of cells, (..., nx, period). cell: lags in
    y -> those of one alone, at those lags in x that feel the cells, (..., near, lags); plane: those of a
    strip, (..., nx, 1); odd: (...), 1 where coefficients are odd in y.

    The mean over y is that of plane strain. What is left is summed over the periods |m| <= M, whose mean is
    taken off; what further ones add is a series in (2 M + 1)^-2 (Euler and Maclaurin), here cut off at the
    last of the numbers M, `up_to`.
    """
    beside = (max(up_to) + 1) * period
    above = cell(beside + 1)
    sign = np.where(odd, -1.0, 1.0)[..., None, None]
    lag = np.arange(-beside, beside)
    whole = np.concatenate([sign * above[..., :0:-1], above[..., :-1]], axis=-1)
    squares = [(2 * m + 1) ** -2.0 for m in up_to]
    out = np.repeat(plane / period, period, axis=-1)
    for square, m in zip(squares, up_to, strict=True):
        end = (2 * m + 1) * period  # of twice the lag
        counted = whole * (np.sign(end - 2 * np.abs(lag)) + 1) / 2
        summed = counted.reshape(*whole.shape[:-1], -1, period).sum(axis=-2)
        weight = prod(other / (other - square) for other in squares if other != square)
        out[..., : above.shape[-2], :] += weight * (summed - summed.mean(axis=-1, keepdims=True))
    return out
