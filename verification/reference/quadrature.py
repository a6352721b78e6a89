# SPDX-License-Identifier: MIT
"""Integrals of point-load solutions over a rectangle: an independent answer for influence coefficients."""

from collections.abc import Callable, Sequence

import numpy as np

from verification.reference.point_loads import (
    boussinesq_displacement,
    boussinesq_stress,
    cerruti_displacement,
    cerruti_stress,
)


def gauss(order: int) -> tuple[np.ndarray, np.ndarray]:
    """Gauss-Legendre points and weights on (0, 1)."""
    t, w = np.polynomial.legendre.leggauss(order)
    return (t + 1) / 2, w / 2


def _corner_triangle(f, a: float, b: float, z: float, *, swap: bool, order: int) -> np.ndarray:
    """Integral over the triangle (0,0), (a,0), (a,b), x and y exchanged if `swap`; f singular or peaked at
    (0, 0). Duffy's coordinates X = u, Y = u v b/a remove 1/R; u = z sinh t resolves a peak of width z.
    """
    t, wt = gauss(order)
    v, wv = gauss(order)
    if z > 0:
        top = np.arcsinh(abs(a) / z)
        u, du = z * np.sinh(top * t), top * z * np.cosh(top * t) * wt
    else:
        u, du = abs(a) * t, abs(a) * wt
    x = np.sign(a) * u[:, None] + 0 * v[None, :]
    y = u[:, None] * v[None, :] * (b / abs(a))
    weight = (u * du)[:, None] * wv[None, :] * abs(b / a)
    return np.sum(f(y, x, z) * weight if swap else f(x, y, z) * weight, axis=(-2, -1))


def _smooth_rectangle(f: Callable, sides: Sequence[float], z: float, order: int) -> np.ndarray:
    """Integral over x0 < x < x1, y0 < y < y1 of a function without singularity."""
    x0, x1, y0, y1 = sides
    t, w = gauss(order)
    x, y = x0 + (x1 - x0) * t[:, None], y0 + (y1 - y0) * t[None, :]
    weight = (x1 - x0) * (y1 - y0) * w[:, None] * w[None, :]
    return np.sum(f(x, y, z) * weight, axis=(-2, -1))


def over_rectangle(f: Callable, place: Sequence[float], half: Sequence[float], order: int = 96) -> np.ndarray:
    """Integral of f(x - x', y - y', z) over |x'| <= half_x, |y'| <= half_y. f: point-load solution, called
    with arrays of offsets and the depth z >= 0, returns (..., same shape); place: (x, y, z); half: (half_x,
    half_y). The point (x, y) may lie inside the rectangle (f may grow like 1/R at z = 0) or well outside,
    about half a rectangle away.
    """
    (x, y, z), (half_x, half_y) = place, half
    x0, x1, y0, y1 = x - half_x, x + half_x, y - half_y, y + half_y
    if not (x0 < 0 < x1 and y0 < 0 < y1):
        return _smooth_rectangle(f, (x0, x1, y0, y1), z, order)
    total = 0.0
    for a in (x0, x1):
        for b in (y0, y1):
            total = total + _corner_triangle(f, a, b, z, swap=False, order=order)
            total = total + _corner_triangle(f, b, a, z, swap=True, order=order)
    return total


def point_response(load: int, place, nu: float) -> np.ndarray:
    """Stress (6) and displacement times mu (3) under a unit point load along x, y or z (load 1, 2, 3). place:
    (x, y, z); (9, ...). Boussinesq and Cerruti; the load along y is the one along x with both axes exchanged.
    """
    young = 2 * (1 + nu)  # mu = 1
    x, y, z = place
    if load == 2:
        turned = point_response(1, (y, x, z), nu)
        return turned[[1, 0, 2, 4, 3, 5, 7, 6, 8]]
    stress, displacement = (
        (boussinesq_stress, boussinesq_displacement) if load == 3 else (cerruti_stress, cerruti_displacement)
    )
    both = np.concatenate(
        [stress(x, y, z, 1.0, nu=nu), displacement(x, y, z, 1.0, young=young, nu=nu)], axis=-1
    )
    return np.moveaxis(both, -1, 0)


def patch_response(load: int, place: Sequence[float], half: Sequence[float], nu: float) -> np.ndarray:
    """Stress (6) and displacement times mu (3) under a unit traction on a rectangle, by quadrature: (9,)."""
    return over_rectangle(lambda X, Y, Z: point_response(load, (X, Y, Z), nu), place, half)
