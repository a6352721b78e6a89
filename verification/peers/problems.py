# SPDX-License-Identifier: MIT
"""The problems that every program solves, in plain numbers. Numpy only: imported in the environment of the
peers too.

Elastic: lengths in units of the sphere's radius or of the side of the patch, pressures in units of the
composite modulus E*. Elastic-plastic: the modulus E and the Hertz radius are the units.
"""

from dataclasses import dataclass

import numpy as np

HERTZ, ROUGH, STEP = "hertz", "rough", "step"

# Hertz: rigid paraboloid of radius 1 on a half-space with E* = 1, not periodic
A = 0.01
FORCE = 4 * A**3 / 3
P0 = 2 * A / np.pi
SIDE = 2.4  # of the grid, in contact radii

# a rough patch of side 1 pressed against a rigid plane, not periodic
WAVES = 64  # shortest wave: 1/64 of the side, the same on every grid
# wave number below which the spectrum is flat; Hurst exponent; of the generator
LONGEST, HURST, SEED = 4, 0.8, 1
RMS = 2e-3  # root mean square height
MEAN_PRESSURE = 5e-3

# one load step to p0 / sigma_y = 3, linear hardening
RADIUS, POISSON = 100.0, 0.3
STEP_MODULUS = 1 / (1 - POISSON**2)
STEP_P0 = 2 * STEP_MODULUS / (np.pi * RADIUS)
STEP_FORCE = 4 * STEP_MODULUS / (3 * RADIUS)
YIELD = STEP_P0 / 3
HARDENING = 0.02  # d sigma_y / d peeq
BOX = (6.0, 2.5)  # side and depth


@dataclass(frozen=True)
class Elastic:
    """gap: (n, n) at the cell centres; side: of the square; force: total, for a half-space with E* = 1."""

    gap: np.ndarray
    side: float
    force: float

    @property
    def cell(self) -> float:
        return self.side / self.gap.shape[0]


def elastic(name: str, n: int, side: float = SIDE) -> Elastic:
    """HERTZ on n x n cells over `side` contact radii, or ROUGH on n x n cells."""
    if name == HERTZ:
        # cell centres with the apex on one of them, on grids of even n too: each program has its best case
        x = (np.arange(n) - n // 2) * (side * A / n)
        return Elastic((x[:, None] ** 2 + x[None, :] ** 2) / 2, side * A, FORCE)
    if name == ROUGH:
        return Elastic(-RMS * rough_heights(n), 1.0, MEAN_PRESSURE)
    raise ValueError(f"no elastic problem {name!r}")


def rough_heights(n: int) -> np.ndarray:
    """Self-affine heights with root mean square 1: sums of the same waves on every grid, so that all n show
    one surface.

    Amplitudes fall like k^-(1 + HURST) from LONGEST to WAVES waves on the side, with random phases.
    """
    if n < 2 * WAVES + 1:
        raise ValueError(f"{n} cells do not carry {WAVES} waves on their side")
    k = np.hypot(*np.meshgrid(np.arange(-WAVES, WAVES + 1), np.arange(WAVES + 1), indexing="ij"))
    parts = np.random.default_rng(SEED).normal(size=(*k.shape, 2))
    amplitude = np.where((k > 0) & (k <= WAVES), np.maximum(k, LONGEST) ** (-1 - HURST), 0.0)
    waves = amplitude * (parts[..., 0] + 1j * parts[..., 1])
    spectrum = np.zeros((n, n // 2 + 1), complex)
    spectrum[np.arange(-WAVES, WAVES + 1) % n, : WAVES + 1] = waves
    column = spectrum[:, 0]  # of a real field: conjugate symmetric
    column[1:] = (column[1:] + column[:0:-1].conj()) / 2
    heights = np.fft.irfft2(spectrum, s=(n, n)) * n * n
    variance = np.sum(np.abs(spectrum[:, 0]) ** 2) + 2 * np.sum(np.abs(spectrum[:, 1:]) ** 2)
    return heights / np.sqrt(variance)


def step_centres(n: int) -> np.ndarray:
    """x of the n columns of the box of the elastic-plastic step, one of them under the apex."""
    return (np.arange(n) - n // 2) * (BOX[0] / n)
