# SPDX-License-Identifier: MIT
"""Elastic stresses under surface tractions in a window of the grid, paper Eq. 7, first sum; and the total
strains at the surface of a body, which a tribofilm that is bonded to it shares.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import ArrayLike

from sam.arrays import Array, Mask
from sam.contact.convolution import Convolution, Counters, convolution_onto
from sam.grid.cells import Window
from sam.kernels.patches import STRESS, Lags, parity, stress_coefficients
from sam.layered.patches import LayeredPatches

DEPTHS_AT_ONCE = 16  # bounds the memory of the spectra
MIRRORED = 1e-9  # of the largest traction: within the tolerance of a contact


def stresses(
    tractions: Mapping[int, Array],
    cell: tuple[float, float] | tuple[float, float, int],
    depths: ArrayLike,
    observed: Window,
    *,
    nu: float,
    layered: LayeredPatches | None = None,
    counters: Counters | None = None,
) -> Array:
    """Stress in Pa under tractions on the surface, at the centres of the observed cells, (6, nz, nx, ny);
    components 11 22 33 23 13 12, tension positive. Paper Eq. 7, first sum.

    tractions: direction of the load (1, 2, 3: q_x, q_y, p, on the body, p > 0 compressive) -> (nx, ny) in Pa
    on the whole grid; one that is left out costs nothing. cell: (hx, hy), sides in m; third the cells along y
    after which the tractions repeat, if they do. depths: (nz,) in m. layered: coefficients of a coated body,
    in place of nu. counters: where the work is counted.
    """
    (hx, hy, *period), depths = cell, np.asarray(depths, dtype=float)
    total = np.zeros((len(STRESS), len(depths), *observed.shape))
    for load, field in tractions.items():
        source = _loaded(field)
        if source is None:
            continue
        lags = Convolution.lags_needed(source, observed)
        if counters is not None and load != 3:
            counters.tangential_kernels += 1
        needed = _needed(field, load, observed)
        names = tuple(STRESS[k] for k in needed)
        parities = [parity(name, load) for name in names]
        for k in range(0, len(depths), DEPTHS_AT_ONCE):
            some = depths[k : k + DEPTHS_AT_ONCE]
            if layered is None:
                in_cells = Lags(*lags, 1.0, hy / hx, *period)
                kernels = stress_coefficients(in_cells, some / hx, nu, load=load, names=names)
            else:
                kernels = layered.stress(Lags(*lags, hx, hy), some, load=load, names=names)
            each = [sign for sign in parities for _ in some]
            convolution = convolution_onto(kernels, each, source, observed, counters=counters)
            # paper Eq. 7, first sum
            total[needed, k : k + len(some)] += convolution(field[source.slices])
    return total


def _loaded(field: Array) -> Window | None:
    """The smallest window that holds all that is not zero; None for a field of zeros."""
    loaded = np.flatnonzero(field.any(axis=1)), np.flatnonzero(field.any(axis=0))
    if not loaded[0].size:
        return None
    (i0, i1), (j0, j1) = ((hit[0], hit[-1] + 1) for hit in loaded)
    return Window(int(i0), int(j0), int(i1 - i0), int(j1 - j0))


def _needed(field: Array, load: int, observed: Window) -> list[int]:
    """The components that are not zero by symmetry: in the row of a mirrored field those even in y."""
    everything = list(range(len(STRESS)))
    if observed.ny > 1 or 2 * observed.j0 + 1 != field.shape[1]:
        return everything
    if np.abs(field - field[:, ::-1]).max() > MIRRORED * np.abs(field).max():
        return everything
    return [k for k in everything if parity(STRESS[k], load)[1] > 0]


def von_mises(stress: Array) -> Array:
    """Von Mises stress (...) of stresses (6, ...), to compare in paper Eq. 8."""
    s11, s22, s33, s23, s13, s12 = stress
    normal = (s11 - s22) ** 2 + (s22 - s33) ** 2 + (s33 - s11) ** 2
    return np.sqrt(normal / 2 + 3 * (s23**2 + s13**2 + s12**2))


def yielding(mises: Array, limit: Array) -> Mask:
    """Where material yields: its von Mises stress is above the yield stress, which broadcasts with it."""
    return np.asarray(mises > limit)  # paper Eq. 8 does not hold


def elastic_strain(stress: Array, young: float, poisson: float) -> Array:
    """Elastic strains xx, yy, xy, zz of stresses (6, ...) in Pa, order 11 22 33 23 13 12."""
    sxx, syy, szz, sxy = stress[0], stress[1], stress[2], stress[5]
    parts = (
        sxx - poisson * (syy + szz),
        syy - poisson * (sxx + szz),
        (1 + poisson) * sxy,
        szz - poisson * (sxx + syy),
    )
    return np.stack(parts) / young


def surface_strain(stress: Array, plastic: Array, depths: Array, *, young: float, poisson: float) -> Array:
    """Total strains xx, yy, xy, zz of the surface, (4, nx, ny), from stress in Pa and plastic
    strain, (6, n_layers, nx, ny): linear to z = 0 from two layers, the mean of one.
    """
    total = elastic_strain(stress[:, :2], young, poisson) + plastic[[0, 1, 5, 2], :2]
    if total.shape[1] < 2:
        return total[:, 0]
    up: Array = (total[:, 0] - total[:, 1]) * depths[0] / (depths[1] - depths[0])
    return total[:, 0] + up
