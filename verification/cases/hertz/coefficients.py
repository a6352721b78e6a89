# SPDX-License-Identifier: MIT
"""Influence coefficients of a loaded rectangle against quadrature, and the DC-FFT against the direct sum."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from sam.contact import Convolution
from sam.grid import Window
from sam.kernels import STRESS, Lags, displacement_coefficients, parity, stress_coefficients
from verification.cases.case import Context
from verification.reference.quadrature import patch_response

HX, HY = 1.0, 0.7
POISSON = (0.0, 0.3, 0.5)
DEPTHS = (0.02, 0.3, 1.0, 4.0)
LAGS = ((0, 0), (1, 0), (0, 1), (2, 3), (6, 4))
DISPLACEMENTS = ("1", "2", "3")
LOADS = {1: "tangential, along x", 2: "tangential, along y", 3: "normal"}


def coefficients(load: int, lag: tuple[int, int], z: float, nu: float) -> np.ndarray:
    """Six stresses and three displacements (times mu) at a lag (i, j) >= 0: (9,)."""
    i, j = lag
    stress = stress_coefficients(Lags(i + 1, j + 1, HX, HY), z, nu, load=load)[:, 0, i, j]
    shift = [
        displacement_coefficients(Lags(i + 1, j + 1, HX, HY), nu, component=int(c), load=load, z=z)[i, j]
        for c in DISPLACEMENTS
    ]
    return np.concatenate([stress, shift])


def worst_errors(load: int) -> tuple[float, float]:
    """Largest error of the stresses and of the displacements, each relative to the largest component at that
    point.
    """
    stress, shift = [], []
    for nu in POISSON:
        for i, j in LAGS:
            for z in DEPTHS:
                answer = patch_response(load, (i * HX, j * HY, z), (HX / 2, HY / 2), nu)
                error = np.abs(coefficients(load, (i, j), z, nu) - answer)
                stress.append(error[:6].max() / np.abs(answer[:6]).max())
                shift.append(error[6:].max() / np.abs(answer[6:]).max())
            at_surface = patch_response(load, (i * HX, j * HY, 0.0), (HX / 2, HY / 2), nu)[6:]
            error = np.abs(coefficients(load, (i, j), 0.0, nu)[6:] - at_surface)
            shift.append(error.max() / np.abs(at_surface).max())
    return max(stress), max(shift)


def convolution_error(load: int) -> float:
    """DC-FFT of all six stresses against the sum over source cells, relative to the largest value."""
    source, observed = Window(3, 2, 8, 7), Window(0, 0, 14, 12)
    field = np.random.default_rng(load).standard_normal(source.shape)
    kernels = stress_coefficients(
        Lags(*Convolution.lags_needed(source, observed), HX, HY), 0.4, 0.3, load=load
    )[:, 0]
    signs = [parity(name, load) for name in STRESS]
    fast = Convolution(kernels, signs, source, observed)(field)
    lx = np.arange(observed.nx)[:, None] - source.i0 - np.arange(source.nx)
    ly = np.arange(observed.ny)[:, None] - source.j0 - np.arange(source.ny)
    slow = []
    for kernel, (px, py) in zip(kernels, signs, strict=True):
        # (observed x, source x, observed y, source y)
        matrix = kernel[np.abs(lx)[:, :, None, None], np.abs(ly)[None, None]]
        matrix = matrix * np.where(lx < 0, px, 1)[:, :, None, None] * np.where(ly < 0, py, 1)[None, None]
        slow.append(np.einsum("ikjm,km->ij", matrix, field))
    return float(np.abs(fast - slow).max() / np.abs(slow).max())


def frame(context: Context) -> Iterator[dict[str, object]]:
    """The largest errors under each load, relative to the largest component at the same point."""
    for load, words in LOADS.items():
        context.progress(f"{context.case}: loads", load, len(LOADS))
        stress, shift = worst_errors(load)
        errors = {"stress": stress, "displacement": shift, "dc-fft": convolution_error(load)}
        yield {"load": load, "direction": words, **errors}
