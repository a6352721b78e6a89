# SPDX-License-Identifier: MIT
"""Stress and surface displacement of plastic strain anywhere on the grid: what the box of the solution does not cover."""

from __future__ import annotations

import numpy as np

from sam.convolution import Convolution, Counters, Window, convolution_onto
from sam.kernels.eigenstrain import residual_stress_coefficients, surface_displacement_coefficients
from sam.kernels.patches import STRESS, parity

AT_ONCE = 1e7  # coefficients computed together


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
    of_layers = faces[layers.start : layers.stop + 1] / hx
    lags = Convolution.lags_needed(source, observed)
    signs = [
        _product(parity(row, 3), parity(name, 3)) for row in STRESS for name in STRESS for _ in range(part.shape[1])
    ]
    some = max(1, int(AT_ONCE // (36 * part.shape[1] * lags[0] * lags[1])))
    for start in range(0, len(depths), some):  # neighbouring depths share what their coefficients are made of
        at = depths[start : start + some] / hx
        kernels = residual_stress_coefficients(*lags, 1.0, hy / hx, at, of_layers, nu)
        for k in range(len(at)):
            convolution = convolution_onto(kernels[:, :, k], signs, source, observed, counters)
            out[:, start + k] = mu * convolution.summed(part)
    return out


def _product(a: tuple[int, int], b: tuple[int, int]) -> tuple[int, int]:
    return a[0] * b[0], a[1] * b[1]


def surface_lift(
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
    kernels = surface_displacement_coefficients(*lags, 1.0, hy / hx, of_layers, nu, component)[None]
    signs = [parity(name, component) for name in STRESS for _ in range(part.shape[1])]
    return hx * convolution_onto(kernels, signs, source, observed, counters).summed(part)[0]
