# SPDX-License-Identifier: MIT
"""Influence coefficients of a uniformly loaded rectangle on the half-space: stresses and displacements.

Paper: the coefficients of Eq. 5 and of the first sum of Eq. 7; in the appendix D_33 and D_31, Eq. 20 for
the normal load (Love 1929) and Eq. 21 for the tangential one (Vergne 1985). The appendix is not used as
printed. The rows of load_table.json, which tests/derivations/load_table.py produces, replace it:

* D_33 is printed with 1/(pi E); right is (1 - nu^2)/(pi E), or 1/(pi E*) for two bodies.
* Eq. 20 and 21 lack the factor 1/(2 pi). S_113 and S_223 are printed with 2 (1 - nu) atan(...); right is 2 (1 - 2 nu).
* S_331 is printed x y^2 R/(R (x^2 + z^2)); right is z^2 y/(R (x^2 + z^2)). S_131 has x^2 + y^2 for x^2 + z^2.

Coefficients are dimensionless: lengths in the caller's unit, stress per unit traction; displacement in units of
(length x traction / mu). Loads: tractions on the body F = (q_x, q_y, p), p > 0 pressing into it.
"""

from __future__ import annotations

import json
from functools import cache
from math import pi
from pathlib import Path

import numpy as np

from sam.kernels.primitives import Corners, primitive

STRESS = ("11", "22", "33", "23", "13", "12")
"""Index order of the stress components, here and everywhere."""


@cache
def load_table() -> dict:
    """The derived table, with its coefficients as floats (see tests/derivations/load_table.py for the meaning of a row)."""
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


def parity(name: str, load: int) -> tuple[int, int]:
    """Sign of a coefficient under x -> -x and under y -> -y.

    name: "11" ... "12" for a stress, "1" ... "3" for a displacement; load: 1, 2 or 3. Each index 1 (2) is odd in x (y).
    """
    indices = name + str(load)
    return (-1) ** indices.count("1"), (-1) ** indices.count("2")


def _corner_sum(rows, nu: float, corners: Corners, z) -> np.ndarray:
    """Rows summed at the corners (patch: P[a, b, c+1]) and differenced over x and y."""
    total = 0.0
    for p, a, b, c, powers in rows:
        coef = sum(q * nu**k for k, q in enumerate(powers))
        if coef != 0.0:
            total = total + coef * z**p * primitive(a, b, c + 1, corners)
    total = np.broadcast_to(total, np.broadcast_shapes(corners.r.shape, np.shape(total)))
    return np.diff(np.diff(total, axis=-1), axis=-2)


def _corners(nx: int, ny: int, hx: float, hy: float, z, shift=(0.0, 0.0)) -> tuple[Corners, np.ndarray]:
    """Corners of the cells at the lags 0 .. n-1: half-integers times the cell, no differences of positions."""
    x = (np.arange(nx + 1) - 0.5) * hx + shift[0]
    y = (np.arange(ny + 1) - 0.5) * hy + shift[1]
    z = np.atleast_1d(np.asarray(z, dtype=float))[:, None, None]
    return Corners(x[:, None], y[None, :], z), z


def stress_coefficients(
    nx: int,
    ny: int,
    hx: float,
    hy: float,
    z,
    nu: float,
    load: int = 3,
    names: tuple[str, ...] = STRESS,
    shift: tuple[float, float] = (0.0, 0.0),
) -> np.ndarray:
    """Stress at (i hx, j hy, z) under unit traction on the cell hx x hy at the origin. Paper Eq. 7, 20, 21.

    z: depth or (nz,) depths >= 0, same unit as hx, hy; load: 1, 2 or 3; returns (len(names), nz, nx, ny), lags i, j
    >= 0 (negative lags by `parity`). At z = 0 the values are limits from inside the body.
    """
    corners, depth = _corners(nx, ny, hx, hy, z, shift)
    table = load_table()["stress"]
    # paper Eq. 20 (load 3) and Eq. 21 (load 1), with the factor 1/(2 pi) that is not printed
    return np.stack([_corner_sum(table[f"{name},F{load}"], nu, corners, depth) for name in names]) / (2 * pi)


def displacement_coefficients(
    nx: int, ny: int, hx: float, hy: float, nu: float, component: int = 3, load: int = 3, z: float = 0.0
) -> np.ndarray:
    """Displacement times mu at (i hx, j hy, z) under unit traction on the cell at the origin.

    Paper: D_ij of Eq. 5, printed for D_33 and D_31.
    component, load: 1, 2 or 3; returns (nx, ny), lags i, j >= 0. For two bodies in contact the caller replaces
    (1 - nu)/mu by the sum over both (normal-normal) and (1 - 2 nu)/mu by the difference (tangential-normal).
    """
    corners, depth = _corners(nx, ny, hx, hy, z)
    rows = load_table()["displacement"][f"{component},F{load}"]
    return _corner_sum(rows, nu, corners, depth)[0] / (2 * pi)  # paper Eq. 5, D_ij
