# SPDX-License-Identifier: MIT
"""Preparation of the heights in a file: form off, missing points filled, cropped, resampled,
in this order.

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

from functools import lru_cache
from importlib import import_module

import numpy as np

from sam.arrays import Array
from sam.scene.section import stated
from sam.scene.surface.roughness import Roughness, roughness
from sam.scene.surface.section import Surface

STEPS = {"missing": "sam.scene.surface.filling", "resample": "sam.scene.surface.resampling"}
"""Key of a surface -> the module of what it asks for, loaded for the scenes that give it: both need scipy."""
_TERMS = {
    "tilt": ([(0, 0)], [(1, 0)], [(0, 1)]),
    "sphere": ([(0, 0)], [(1, 0)], [(0, 1)], [(2, 0), (0, 2)]),
    "quadratic": ([(0, 0)], [(1, 0)], [(0, 1)], [(2, 0)], [(1, 1)], [(0, 2)]),
}
"""Form -> its terms, each a sum of x^p y^q."""


def processed(surface: Surface, cells: tuple[int, int]) -> Array:
    """Heights of a surface from a file on cells of its patch, prepared as the scene says.

    Parameters
    ----------
    surface
        The table [surface] of a scene, of the kind "file".
    cells
        (nx, ny), see `Surface.patch`.

    Returns
    -------
    Array
        (nx, ny) in m, read-only.

    Raises
    ------
    ValueError
        For cells that the file does not have, and if only its digest is at hand.
    """
    found = prepared(surface)
    if found.shape == tuple(cells):
        return found
    if surface.resample is None:
        raise ValueError(f"{surface.path!r} has no heights at {cells[0]} x {cells[1]} points")
    return _resampled_surface(surface, tuple(cells))


@lru_cache(maxsize=2)
def _resampled_surface(surface: Surface, cells: tuple[int, int]) -> Array:
    found: Array = import_module(STEPS["resample"]).resampled(prepared(surface), cells)
    found.flags.writeable = False
    return found


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
        values = import_module(STEPS["missing"]).harmonic(values, surface.measured.cell)
    if surface.crop is not None:
        values = values[surface.window]
    values.flags.writeable = False
    return values


def roughness_as_read(surface: Surface) -> Roughness:
    """Roughness of the whole map in the file, of its measured points, before anything is done to it.

    Raises
    ------
    ValueError
        If only the digest of the file is at hand.
    """
    _check_at_hand(surface)
    return roughness(stated(surface.measured.values), *surface.measured.cell)


def _check_at_hand(surface: Surface) -> None:
    if surface.measured.values is None:
        raise ValueError(f"{surface.path!r} has no heights: only its digest is at hand")


def fitted_form(values: Array, cell: tuple[float, float], form: str) -> Array:
    """The polynomial of least squares through the heights (nx, ny) in m on cells in m that are not nan; (nx,
    ny) in m.

    Normal equations in moments: sums over x^p y^q are products of matrices. Fitted again to what is left,
    against rounding.
    """
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
        found = np.linalg.lstsq(matrix, [sum(loads[p, q] for p, q in a) for a in terms])[0]
        powers = np.zeros((3, 3))
        for coefficient, term in zip(found, terms, strict=True):
            powers[tuple(zip(*term, strict=True))] += coefficient
        total += of_x[:, :3] @ powers @ of_y[:, :3].T
    return total
