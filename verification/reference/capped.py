# SPDX-License-Identifier: MIT
"""Elastic contact of a periodic rough surface whose pressure is cut off at a hardness, as codes of rough
contact do in place of plastic flow.

The pressure p minimises p.(G p)/2 - p.heights under 0 <= p <= hardness and a given mean; G = 2/(E* q) in wave
numbers q (Johnson, Contact Mechanics (1985), Sec. 13.2) at points, not the cells of SAM. Where p is at the
hardness the plane penetrates, and what it penetrates counts as flowed away. Source of the cut-off: Almqvist,
Sahlin, Larsson & Glavatskih, Tribol. Int. 40 (2007) 574; of the search, projected gradients with the step of
Barzilai & Borwein: Birgin, Martinez & Raydan, SIAM J. Optim. 10 (2000) 1196.
"""

import numpy as np
from scipy import fft
from scipy.optimize import brentq


def wave_numbers(shape: tuple[int, int], extent: tuple[float, float]) -> tuple[np.ndarray, np.ndarray]:
    """q_x (nx, 1) and q_y (1, ny//2 + 1) in rad/m of a periodic field with sides in m."""
    (nx, ny), (lx, ly) = shape, extent
    qx, qy = 2.0 * np.pi * fft.fftfreq(nx, lx / nx), 2.0 * np.pi * fft.rfftfreq(ny, ly / ny)
    return qx[:, None], qy[None, :]


def rms_slope(heights: np.ndarray, extent: tuple[float, float]) -> float:
    """Root mean square of the gradient of a periodic field (nx, ny) in m, by its spectrum."""
    spectrum = fft.rfft2(heights)
    parts = (fft.irfft2(1j * q * spectrum, s=heights.shape) for q in wave_numbers(heights.shape, extent))
    return float(np.sqrt(sum(np.mean(part**2) for part in parts)))


def capped_pressure(
    heights: np.ndarray,
    extent: tuple[float, float],
    modulus: float,
    mean: float,
    *,
    hardness: float = np.inf,
    tolerance: float = 1e-4,
    most: int = 5000,
) -> np.ndarray:
    """The pressure (nx, ny) in Pa of heights in m that repeat below a rigid plane; modulus: E* in Pa; mean:
    pressure in Pa; tolerance: of gap and penetration, over the standard deviation of the heights. ValueError
    for a mean not between 0 and the hardness, RuntimeError without convergence.
    """
    if not 0.0 < mean < hardness:
        raise ValueError(f"the mean pressure must lie between 0 and the hardness {hardness:g}, not {mean:g}")
    q = np.hypot(*wave_numbers(heights.shape, extent))
    q[0, 0] = np.inf
    allowed, step = tolerance * float(np.std(heights)), 0.5 * modulus * float(q[q > 0.0].min())

    def bounded(trial: np.ndarray) -> np.ndarray:
        """The nearest admissible field: less a constant, then cut off."""

        def excess(level: float) -> float:
            return float(np.clip(trial - level, 0.0, hardness).mean()) - mean

        level = brentq(excess, trial.min() - mean, trial.max(), xtol=1e-14 * mean)
        return np.clip(trial - level, 0.0, hardness)

    p, gap = np.full(heights.shape, mean), -heights
    for _ in range(most):
        last, p = (p, gap), bounded(p - step * gap)
        gap = fft.irfft2(2.0 / (modulus * q) * fft.rfft2(p), s=heights.shape) - heights
        free = (p > 0.0) & (p < hardness)
        off = gap - (gap[free].mean() if free.any() else gap.mean())
        if np.where(free, np.abs(off), np.where(p > 0.0, off, -off)).max() <= allowed:
            return p
        change, turn = p - last[0], gap - last[1]
        if (curvature := float(np.sum(change * turn))) > 0.0:
            step = float(np.sum(change**2)) / curvature
    raise RuntimeError(f"the capped pressure is not found in {most} iterations")
