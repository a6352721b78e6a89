# SPDX-License-Identifier: MIT
"""Stress and surface displacement of plastic strain anywhere on the grid: what the box of the solution does not cover."""

from __future__ import annotations

import numpy as np

from sam.contact.convolution import FEW_ROWS, Convolution, Counters, row_sums
from sam.grid.cells import Window
from sam.kernels.eigenstrain import surface_displacement_coefficients
from sam.kernels.lags import Cuboids, Lags
from sam.kernels.layer_stress import residual_stress_coefficients
from sam.kernels.patches import STRESS, parity
from sam.plasticity.spectra import ODD_X, ODD_Y

ODD = np.array([ODD_X, ODD_Y])
AT_ONCE = 1e6  # coefficients, which bounds the memory


def _strained(strain: np.ndarray, box: Window) -> tuple[np.ndarray, Window, slice] | None:
    """The part of the box that holds plastic strain: (strain there, its window on the grid, its layers)."""
    where = np.nonzero(strain.any(axis=0))
    if not where[0].size:
        return None
    (k0, i0, j0), (k1, i1, j1) = (tuple(f(axis) for axis in where) for f in (np.min, np.max))
    part = strain[:, k0 : k1 + 1, i0 : i1 + 1, j0 : j1 + 1]
    window = Window(int(box.i0 + i0), int(box.j0 + j0), int(i1 - i0 + 1), int(j1 - j0 + 1))
    return part, window, slice(int(k0), int(k1) + 1)


def residual_stress(
    strain: np.ndarray,
    box: Window,
    faces: np.ndarray,
    depths: np.ndarray,
    observed: Window,
    hx: float,
    hy: float,
    mu: float,
    nu: float,
    counters: Counters,
) -> np.ndarray:
    """Stress of the plastic strain in the box at any depths and cells, (6, n_depths, nx, ny) in Pa. Paper Eq. 7.

    strain: (6, n_layers, nx, ny) on the box; faces: of its layers, in m; depths in m, none of them on a face.
    """
    out = np.zeros((6, len(depths), *observed.shape))
    found = _strained(strain, box)
    if found is None:
        return out
    part, source, layers = found
    lags = Convolution.lags_needed(source, observed)
    cuboids = Cuboids(Lags(*lags, 1.0, hy / hx), tuple(faces[layers.start : layers.stop + 1] / hx), nu)
    at_once = max(1, int(AT_ONCE // (36 * part.shape[1] * lags[0] * lags[1])))
    for first in range(0, len(depths), at_once):
        some = slice(first, first + at_once)
        kernels = residual_stress_coefficients(cuboids, depths[some] / hx)
        # paper Eq. 7, second sum
        out[:, some] = mu * row_sums(kernels, part, source, observed, odd_out=ODD, odd_in=ODD)
    return out


def surface_displacement(
    strain: np.ndarray,
    box: Window,
    faces: np.ndarray,
    observed: Window,
    hx: float,
    hy: float,
    nu: float,
    counters: Counters,
    component: int = 3,
) -> np.ndarray:
    """Displacement of the surface due to the plastic strain in the box, (nx, ny) in m. Paper Eq. 6.

    component: 3 for u_z (> 0 into the body), 1 for u_x.
    """
    found = _strained(strain, box)
    if found is None:
        return np.zeros(observed.shape)
    part, source, layers = found
    lags = Convolution.lags_needed(source, observed)
    of_layers = faces[layers.start : layers.stop + 1] / hx
    kernels = surface_displacement_coefficients(
        Cuboids(Lags(*lags, 1.0, hy / hx), tuple(of_layers), nu), component=component
    )[None]
    if observed.ny <= FEW_ROWS:
        odd = np.array([[component == 1], [component == 2]], dtype=int)
        return hx * row_sums(kernels[:, :, None], part, source, observed, odd_out=odd, odd_in=ODD)[0, 0]
    signs = [parity(name, component) for name in STRESS for _ in range(part.shape[1])]
    # paper Eq. 6
    return hx * Convolution(kernels, signs, source, observed, counters=counters).summed(part)[0]
