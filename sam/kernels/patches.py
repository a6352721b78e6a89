# SPDX-License-Identifier: MIT
"""Influence coefficients of a uniformly loaded rectangle on the half-space: stresses and displacements.

Paper: the coefficients of Eq. 5 and of the first sum of Eq. 7; in the appendix D_33 and D_31, Eq. 20 for
the normal load (Love 1929) and Eq. 21 for the tangential one (Vergne 1985). The appendix is not used as
printed. The rows of load_table.json, which tests/derivations/load_table.py produces, replace it:

* D_33 is printed with 1/(pi E); right is (1 - nu^2)/(pi E), or 1/(pi E*) for two bodies. * Eq. 20 and 21 lack
the factor 1/(2 pi). S_113 and S_223 are printed with 2 (1 - nu) atan(...); right is 2 (1 - 2 nu). * S_331 is
printed x y^2 R/(R (x^2 + z^2)); right is z^2 y/(R (x^2 + z^2)). S_131 has x^2 + y^2 for x^2 + z^2.

Coefficients are dimensionless: lengths in the caller's unit, stress per unit traction; displacement in units
of (length x traction / mu). Loads: tractions on the body F = (q_x, q_y, p), p > 0 pressing into it.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cache, partial
from math import ceil, pi
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike

from sam.arrays import Array
from sam.kernels import line
from sam.kernels.primitives import Corners, primitive

FURTHER = (6, 9, 13, 18), (3, 5, 7, 10)  # periods summed, of displacements to 2e-8, of stresses to 1e-6
LONG = 1e12  # cells hx: stresses of plane strain to 3e-13 of the largest


@dataclass(frozen=True)
class Lags:
    """Offsets (i hx, j hy), 0 <= i < nx and 0 <= j < ny, from a loaded cell to an observed one; period: cells
    along y after which loads repeat, 0 if they do not. With 1 all is the same at every y: plane strain.
    """

    nx: int
    ny: int
    hx: float
    hy: float
    period: int = 0

    @property
    def shape(self) -> tuple[int, int]:
        """(nx, ny)."""
        return self.nx, self.ny

    @property
    def exchanged(self) -> Lags:
        """The same lags with x and y exchanged."""
        return Lags(self.ny, self.nx, self.hy, self.hx)

    def in_units_of(self, length: float) -> Lags:
        """The same lags with another unit of length."""
        return replace(self, hx=self.hx / length, hy=self.hy / length)

    def corners(self, first: int = 0) -> tuple[Array, Array]:
        """x and y of the corners of the cells at the lags first .. n - 1: half-integers times the cell, none
        of them 0; in plane strain of a cell so long that stresses below it are those of plane strain.

        >>> Lags(2, 1, 1.0, 3.0).corners()
        (array([-0.5,  0.5,  1.5]), array([-1.5,  1.5]))
        """
        i = np.arange(first, self.nx + 1, dtype=float)
        j = np.arange(first, self.ny + 1, dtype=float)
        return (i - 0.5) * self.hx, (j - 0.5) * (LONG * self.hx if self.period == 1 else self.hy)


@dataclass(frozen=True)
class Cuboids:
    """The half-space below cells of its surface in layers; faces: depths of the n + 1 faces,
    ascending from >= 0, in the unit of hx, else ValueError; nu: 0 <= nu <= 1/2.
    """

    lags: Lags
    faces: tuple[float, ...]
    nu: float

    def __post_init__(self) -> None:
        faces = self.depths
        if faces.ndim != 1 or faces.size < 2 or faces[0] < 0 or not np.all(np.diff(faces) > 0):
            raise ValueError("faces must be two or more increasing depths >= 0")

    @property
    def depths(self) -> Array:
        """The faces as an array, (n + 1,)."""
        return np.asarray(self.faces, dtype=float)

    @property
    def layers(self) -> int:
        """Number of layers."""
        return len(self.faces) - 1


STRESS = ("11", "22", "33", "23", "13", "12")
"""Index order of the stress components, here and everywhere."""
ODD_X = np.array([name.count("1") % 2 for name in STRESS])
ODD_Y = np.array([name.count("2") % 2 for name in STRESS])
"""1 for a component that is odd under y -> -y, 0 for an even one; before, the same of x."""
Row = tuple[int, int, int, int, tuple[float, ...]]
"""A term of the derived table: z^p times a derivative a, b, c, and coefficients of 1, nu, nu^2."""


@cache
def load_table() -> dict[str, dict[str, list[Row]]]:
    """The derived table with coefficients as floats; for its rows see tests/derivations/load_table.py."""
    raw = json.loads(Path(__file__).with_name("load_table.json").read_text(encoding="utf-8"))

    def number(text: str) -> float:
        top, _, bottom = text.partition("/")
        return float(top) / float(bottom or 1)

    return {
        kind: {
            name: [(*row[:4], tuple(map(number, row[4]))) for row in rows] for name, rows in entries.items()
        }
        for kind, entries in raw.items()
    }


def parity(name: str, load: int | str) -> tuple[int, int]:
    """Sign of a coefficient under x -> -x and under y -> -y: each index 1 (2) is odd in x (y). name: "11" ...
    "12" of a stress, "1" ... "3" of a displacement; load: direction of the traction.
    """
    x, y = ((-1) ** f"{name}{load}".count(axis) for axis in "12")
    return x, y


def _corner_sum(rows: list[Row], nu: float, corners: Corners, z: Array) -> Array:
    """Rows summed at the corners (patch: P[a, b, c+1]) and differenced over x and y."""
    total: Array | float = 0.0
    for p, a, b, c, powers in rows:
        coef = sum(q * nu**k for k, q in enumerate(powers))
        if coef != 0.0:
            total = total + coef * z**p * primitive(a, b, c + 1, corners)
    whole: Array = np.broadcast_to(total, np.broadcast_shapes(corners.r.shape, np.shape(total)))
    return np.diff(np.diff(whole, axis=-1), axis=-2)


def _corners(lags: Lags, z: ArrayLike, shift: tuple[float, float] = (0.0, 0.0)) -> tuple[Corners, Array]:
    """The corners of the cells at depths z, and these depths as (nz, 1, 1)."""
    x, y = lags.corners()
    depth = np.atleast_1d(np.asarray(z, dtype=float))[:, None, None]
    return Corners((x + shift[0])[:, None], (y + shift[1])[None, :], depth), depth


def apart(lags: Lags) -> tuple[Lags, Lags]:
    """Of cells that repeat along y: lags of one alone in x, as far as cells are felt, and of a strip."""
    near = min(lags.nx, ceil(line.BESIDE * lags.period * lags.hy / lags.hx) + 1)
    return replace(lags, nx=near, period=0), replace(lags, ny=1, hy=lags.period * lags.hy, period=1)


def repeated(lags: Lags, odd: Array, further: Sequence[int], alone: Callable[[Lags], Array]) -> Array:
    """Coefficients of a cell that repeats along y; alone: those of one that does not, or of a strip."""
    space, strip = apart(lags)
    plane = alone(strip)
    found = line.repeated(lambda ny: alone(replace(space, ny=ny)), plane, lags.period, odd=odd, up_to=further)
    return found[..., np.arange(lags.ny) % lags.period]


def stress_coefficients(
    lags: Lags,
    z: ArrayLike,
    nu: float,
    *,
    load: int = 3,
    names: Sequence[str] = STRESS,
    shift: tuple[float, float] = (0.0, 0.0),
) -> Array:
    """Stress at (i hx, j hy, z) under unit traction on the cell hx x hy at the origin, (len(names), nz, nx,
    ny). Paper Eq. 7, 20, 21.

    lags: where it is wanted (negative ones: `parity`); z: depth, or depths (nz,), >= 0 in the unit of hx, at
    0 the limits from inside the body; load: direction of the traction on the body, 1, 2 or 3 (> 0 pressing
    into it); names: components, of `STRESS`; shift: (x, y) by which every observed point is moved, in the
    unit of hx, none where loads repeat.
    """
    if lags.period > 1:
        odd = np.array([[parity(name, load)[1] < 0] for name in names])
        alone = partial(stress_coefficients, nu=nu, load=load, names=names)
        at = [repeated(lags, odd, FURTHER[1], partial(alone, z=each)) for each in np.atleast_1d(z)]
        return np.concatenate(at, axis=1)
    corners, depth = _corners(lags, z, shift)
    table = load_table()["stress"]
    # paper Eq. 20 (load 3) and Eq. 21 (load 1), with the factor 1/(2 pi) that is not printed
    return np.stack([_corner_sum(table[f"{name},F{load}"], nu, corners, depth) for name in names]) / (2 * pi)


def displacement_coefficients(
    lags: Lags, nu: float, *, component: int = 3, load: int = 3, z: float = 0.0
) -> Array:
    """Displacement times mu at (i hx, j hy, z) under unit traction on the cell hx x hy at the origin, in the
    unit of hx, (nx, ny).

    Paper: D_ij of Eq. 5, printed for D_33 and D_31. For two bodies in contact the caller replaces (1 - nu)/mu
    by the sum over both (normal-normal) and (1 - 2 nu)/mu by the difference (tangential-normal). component,
    load: directions of the displacement and of the traction on the body, 1, 2 or 3 (> 0 into the body); z:
    depth >= 0 in the unit of hx; where loads repeat 0, and u along the load is zero at |x| = period hy/2.

    In the middle of a square the pressure 1 causes u_z = (1 - nu)/mu 2 ln(1 + sqrt(2))/pi times the side
    (Love):

    >>> center = displacement_coefficients(Lags(1, 1, 1.0, 1.0), nu=0.0)[0, 0]
    >>> bool(np.isclose(center, 2 * np.log(1 + np.sqrt(2)) / np.pi, rtol=1e-14))
    True
    """
    if lags.period == 1:
        reference = lags.hy / 2
        return line.displacement(lags.corners()[0], nu, reference, component=component, load=load)[:, None]
    if lags.period > 1:
        alone = partial(displacement_coefficients, nu=nu, component=component, load=load)
        return repeated(lags, np.zeros((), int), FURTHER[0], alone)
    corners, depth = _corners(lags, z)
    rows = load_table()["displacement"][f"{component},F{load}"]
    return _corner_sum(rows, nu, corners, depth)[0] / (2 * pi)  # paper Eq. 5, D_ij
