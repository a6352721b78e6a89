# SPDX-License-Identifier: MIT
"""Stresses under Hertz pressure and full-slip traction, summed over patches, against Hamilton."""

from collections.abc import Iterator

import numpy as np
from scipy.optimize import brentq

from sam.contact import stresses, von_mises
from sam.grid import Window
from verification.cases.case import Context, DataFrame
from verification.judging import Measured
from verification.reference.hamilton import largest_von_mises, sliding_stress

__all__ = ["limit_of_crossings"]


NU = 0.3
FRICTION = (0.0, 0.1, 0.2, 0.25, 0.3, 0.4, 0.5)
ACROSS = {"quick": (18, 36, 72), "full": (18, 36, 72, 144)}  # cells across the contact
CROSSING = {"quick": (36, 72, 144), "full": (36, 72, 144, 288)}  # to find where the edge overtakes
INTERIOR = np.linspace(0.1, 0.8, 57)  # depths at which the largest stress of the interior is looked for
DEPTHS = np.array([0.1, 0.2, 0.3, 0.48, 0.7, 1.0, 1.5])  # contact radii; interior points
COMPONENTS = ("sxx", "syy", "szz", "syz", "sxz", "sxy")
PARTS = 8  # of a cell each way, for the mean traction of a cell


def grid_of(across: int) -> tuple[np.ndarray, float]:
    """Odd number of cells over three contact radii, `across` in the contact: centres and size, in radii."""
    h = 2.0 / across
    n = int(1.5 * across) // 2 * 2 + 1
    return (np.arange(n) - (n - 1) / 2) * h, h


def mean_traction(x: np.ndarray, h: float) -> np.ndarray:
    """Mean of sqrt(1 - r^2) over each cell: the load of a cell that the edge cuts is right."""
    part = ((np.arange(PARTS) + 0.5) / PARTS - 0.5) * h
    fine = (x[:, None] + part).ravel()
    p = np.sqrt(np.maximum(1.0 - fine[:, None] ** 2 - fine[None, :] ** 2, 0.0))
    return p.reshape(x.size, PARTS, x.size, PARTS).mean(axis=(1, 3))


def interior_errors(across: int, friction: float) -> np.ndarray:
    """Largest error of each component over all cells and interior depths, in units of p0: (6,)."""
    x, h = grid_of(across)
    p = mean_traction(x, h)
    found = stresses({1: friction * p, 3: p}, (h, h), DEPTHS, Window(0, 0, x.size, x.size), nu=NU)
    places = x[None, :, None], x[None, None, :], DEPTHS[:, None, None]
    exact = sliding_stress(*places, 1.0, contact_radius=1.0, nu=NU, friction=friction)
    return np.abs(found - np.moveaxis(exact, -1, 0)).max(axis=(1, 2, 3))


def plane_maximum(across: int, friction: float) -> tuple[float, float]:
    """Largest von Mises stress in the plane y = 0 and its depth, in p0 and radii, surface included."""
    depths = np.linspace(0.0, 1.0, 81)
    _, under_p, under_q = row_stresses(across, depths)
    mises = von_mises(under_p + friction * under_q)
    k = np.unravel_index(mises.argmax(), mises.shape)[0]
    return float(mises.max()), float(depths[k])


def row_stresses(across: int, depths: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """x of the cells in |x| < 1.1 on y = 0, and their stresses under p and under q = p, (6, nz, nx) each."""
    x, h = grid_of(across)
    x = x[np.abs(x) < 1.1]
    p = mean_traction(x, h)
    row = Window(0, x.size // 2, x.size, 1)
    under_p, under_q = (stresses({load: p}, (h, h), depths, row, nu=NU)[..., 0] for load in (3, 1))
    return x, under_p, under_q


def crossing(across: int) -> float:
    """The friction at which the von Mises stress of the cell on the trailing edge becomes the largest."""
    (x, *edge), (_, *interior) = row_stresses(across, np.zeros(1)), row_stresses(72, INTERIOR)
    cell = np.abs(x + 1.0).argmin()

    def lead(friction: float) -> float:
        at_edge, inside = (von_mises(p + friction * q) for p, q in (edge, interior))
        return at_edge[0, cell] - inside.max()

    return brentq(lead, 0.2, 0.5, xtol=1e-6)


def limit_of_root(h: np.ndarray, values: np.ndarray) -> float:
    """Value at h = 0 of the parabola in sqrt(h) through the three finest: vertical tangent at r = a."""
    return float(np.polynomial.Polynomial.fit(np.sqrt(h[-3:]), values[-3:], 2)(0.0))


def overtaking() -> float:
    """The friction at which the largest von Mises stress moves to the edge, in closed form."""

    def lead(friction: float) -> float:
        interior, edge = largest_von_mises(1.0, 1.0, NU, friction)
        return edge[0] - interior[0]

    return brentq(lead, 0.2, 0.5, xtol=1e-6)


def frame(context: Context) -> Iterator[dict[str, object]]:
    """Six components inside at mu = 0.4, the place of the largest stress, and where the edge overtakes."""
    for n in ACROSS[context.level]:
        errors = dict(zip(COMPONENTS, interior_errors(n, 0.4), strict=True))
        yield {"sweep": "interior", "cells": n} | errors
    for friction in FRICTION:
        (largest, depth), places = plane_maximum(72, friction), largest_von_mises(1.0, 1.0, NU, friction)
        exact = {"mises expected": places[0][0], "mises of the edge expected": places[1][0]}
        yield {"sweep": "plane", "friction": friction, "mises": largest, "depth": depth} | exact
    for n in CROSSING[context.level]:
        yield {"sweep": "crossing", "cells": n, "crossing": crossing(n), "crossing expected": overtaking()}


def limit_of_crossings(rows: DataFrame, column: str) -> Measured:
    """Of the crossings on ever finer cells."""
    found = limit_of_root(1.0 / rows["cells"].to_numpy(), rows[column].to_numpy())
    return Measured(found, rows[f"{column} expected"].iloc[0])
