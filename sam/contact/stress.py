# SPDX-License-Identifier: MIT
"""Elastic stresses under surface tractions, at chosen depths, in a window of the grid. Paper Eq. 7, first sum."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from sam.contact.convolution import Convolution, Counters, Window, convolution_onto
from sam.kernels.lags import Lags
from sam.kernels.patches import STRESS, parity, stress_coefficients

if TYPE_CHECKING:
    from sam.layered.patches import LayeredPatches

DEPTHS_AT_ONCE = 16  # bounds the memory of the spectra
MIRRORED = 1e-9  # of the largest traction: within the tolerance of a contact


def stresses(
    tractions: Mapping[int, np.ndarray],
    hx: float,
    hy: float,
    depths: np.ndarray,
    nu: float,
    observed: Window,
    counters: Counters | None = None,
    layered: LayeredPatches | None = None,
) -> np.ndarray:
    """Stress at the centres of the observed cells, (6, nz, nx, ny) in Pa; order 11 22 33 23 13 12, tension positive.

    tractions: load direction (1, 2, 3: q_x, q_y, p, on the body, p > 0 compressive) -> (nx, ny) in Pa on the whole
    grid; a direction that is left out costs nothing. hx, hy, depths in m; nu: of the body; layered: the coefficients of a
    coated body, in place of nu.
    """
    depths = np.asarray(depths, dtype=float)
    total = np.zeros((len(STRESS), len(depths), *observed.shape))
    for load, field in tractions.items():
        loaded = np.flatnonzero(field.any(axis=1)), np.flatnonzero(field.any(axis=0))
        if not loaded[0].size:
            continue
        (i0, i1), (j0, j1) = ((hit[0], hit[-1] + 1) for hit in loaded)
        source = Window(int(i0), int(j0), int(i1 - i0), int(j1 - j0))
        lags = Convolution.lags_needed(source, observed)
        if counters is not None and load != 3:
            counters.tangential_kernels += 1
        needed = _needed(field, load, observed)
        names = tuple(STRESS[k] for k in needed)
        parities = [parity(name, load) for name in names]
        for k in range(0, len(depths), DEPTHS_AT_ONCE):
            some = depths[k : k + DEPTHS_AT_ONCE]
            if layered is None:
                kernels = stress_coefficients(
                    Lags(*lags, 1.0, hy / hx), some / hx, nu, load=load, names=names
                )
            else:
                kernels = layered.stress(Lags(*lags, hx, hy), some, load=load, names=names)
            each = [sign for sign in parities for _ in some]
            convolution = convolution_onto(kernels, each, source, observed, counters)
            # paper Eq. 7, first sum
            total[needed, k : k + len(some)] += convolution(field[source.slices])
    return total


def _needed(field: np.ndarray, load: int, observed: Window) -> list[int]:
    """Components that are not zero by symmetry: in one row about which the field is mirrored, those even in y."""
    everything = list(range(len(STRESS)))
    if observed.ny > 1 or 2 * observed.j0 + 1 != field.shape[1]:
        return everything
    if np.abs(field - field[:, ::-1]).max() > MIRRORED * np.abs(field).max():
        return everything
    return [k for k in everything if parity(STRESS[k], load)[1] > 0]


def von_mises(stress: np.ndarray) -> np.ndarray:
    """Von Mises stress of (6, ...) components in the order 11 22 33 23 13 12, to compare in paper Eq. 8."""
    s11, s22, s33, s23, s13, s12 = stress
    normal = (s11 - s22) ** 2 + (s22 - s33) ** 2 + (s33 - s11) ** 2
    return np.sqrt(normal / 2 + 3 * (s23**2 + s13**2 + s12**2))
