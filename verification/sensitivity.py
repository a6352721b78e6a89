# SPDX-License-Identifier: MIT
"""Global sensitivity: which factors move a result, from its values at the points of a design.

A design has shares in [0, 1] of each factor. Morris, Technometrics 33 (1991) 161: trajectories in which one
factor after the other moves by 2/3; the mean size mu* of its effects is that of Campolongo, Cariboni &
Saltelli, Environ. Model. Softw. 22 (2007) 1509. Saltelli et al., Comput. Phys. Commun. 181 (2010) 259: pairs
of points A, B of a Sobol sequence, and A with one factor of B; the shares of the variance by the estimators
of Jansen, Comput. Phys. Commun. 117 (1999) 35. Uniform: points of a Sobol sequence, and Spearman's
correlation of ranks.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

LEVELS = 4  # of Morris: shares 0, 1/3, 2/3, 1
RESAMPLES, CONFIDENCE = 1000, 0.9  # of the bootstrap over trajectories or pairs
MORRIS, SOBOL, UNIFORM = METHODS = "morris", "sobol", "uniform"


@dataclass(frozen=True)
class Index:
    """Values (factors,), bounds (2, factors) of confidence, and number (factors,) of samples of an index."""

    name: str
    values: np.ndarray
    bounds: np.ndarray
    count: np.ndarray


def size(method: str, factors: int) -> int:
    """Points of one sample: a trajectory of Morris, a pair of points and what is between them, or one."""
    return {MORRIS: factors + 1, SOBOL: factors + 2, UNIFORM: 1}[method]


def design(method: str, factors: int, samples: int, seed: int) -> np.ndarray:
    """Shares (samples * size, factors); more samples of the same seed begin with those of fewer."""
    rng = np.random.default_rng(seed)
    if method == MORRIS:
        return np.concatenate([_trajectory(rng, factors) for _ in range(samples)])
    power = max(samples - 1, 0).bit_length()  # the sequence is balanced at powers of two
    width = factors if method == UNIFORM else 2 * factors
    from scipy.stats import qmc  # noqa: PLC0415 - 0.4 s, for designs alone

    points = qmc.Sobol(width, rng=rng).random_base2(power)[:samples]
    if method == UNIFORM:
        return points
    pairs = points.reshape(samples, 2, factors)
    between = np.where(np.eye(factors, dtype=bool), pairs[:, 1:], pairs[:, :1])
    return np.concatenate([pairs, between], axis=1).reshape(-1, factors)


def _trajectory(rng: np.random.Generator, factors: int) -> np.ndarray:
    start = rng.integers(0, LEVELS, factors)
    step = np.where(start < LEVELS / 2, LEVELS / 2, -LEVELS / 2)
    moved = np.zeros((factors + 1, factors))
    for k, factor in enumerate(rng.permutation(factors), start=1):
        moved[k:, factor] = step[factor]
    return (start + moved) / (LEVELS - 1)


def indices(method: str, shares: np.ndarray, values: np.ndarray, seed: int) -> list[Index]:
    """Indices of a result whose values (points,) at the points of a design are known, NaN where it has none.
    morris: mu* (mean size of the effect of the whole range), mu, sigma (spread of the effects: interaction or
    curvature); sobol: first-order and total shares of the variance; uniform: correlation of ranks. Effects,
    or samples, without a value are left out. None of a result that never changes, or of fewer than two
    samples.
    """
    factors = shares.shape[1]
    values = np.asarray(values, dtype=float).reshape(-1, size(method, factors))
    if method == MORRIS:
        samples = effects(shares.reshape(*values.shape, factors), values)
        count = np.isfinite(samples).sum(axis=0)
    else:
        there = np.isfinite(values).all(axis=1)
        samples = values[there] if method == SOBOL else np.column_stack([values, shares])[there]
        count = np.full(factors, len(samples))
    if len(samples) < 2 or len(np.unique(values[np.isfinite(values)])) < 2:
        return []
    return [
        Index(name, of(samples), _bounds(of, samples, seed), count) for name, of in OF_SAMPLES[method].items()
    ]


def effects(shares: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Elementary effects (trajectories, factors), per share 1: Morris (1991), Eq. 1."""
    moved = np.diff(shares, axis=1)
    which = np.abs(moved).argmax(axis=2)
    slopes = np.diff(values, axis=1) / np.take_along_axis(moved, which[..., None], axis=2)[..., 0]
    found = np.empty_like(slopes)
    np.put_along_axis(found, which, slopes, axis=1)
    return found


def _ranked(samples: np.ndarray) -> np.ndarray:
    """Spearman's correlation of the first column with each of the others; 0 where that one does not vary."""
    from scipy.stats import rankdata  # noqa: PLC0415 - 0.4 s, for designs alone

    ranks = rankdata(samples, axis=0)
    away = ranks - ranks.mean(axis=0)
    scale = np.sqrt((away**2).sum(axis=0))
    return (away[:, :1] * away[:, 1:]).sum(axis=0) / np.maximum(scale[0] * scale[1:], np.finfo(float).tiny)


OF_SAMPLES: Mapping[str, Mapping[str, Callable[[np.ndarray], np.ndarray]]] = {
    MORRIS: {
        "mu_star": lambda effects: np.ma.masked_invalid(np.abs(effects)).mean(axis=0).filled(np.nan),
        "mu": lambda effects: np.ma.masked_invalid(effects).mean(axis=0).filled(np.nan),
        "sigma": lambda effects: np.ma.masked_invalid(effects).std(axis=0, ddof=1).filled(np.nan),
    },
    SOBOL: {  # 1 - E[(f_B - f_AB)^2]/(2 V), and E[(f_A - f_AB)^2]/(2 V): Jansen (1999)
        "first": lambda f: 1.0 - np.mean((f[:, 1:2] - f[:, 2:]) ** 2, axis=0) / (2.0 * np.var(f[:, :2])),
        "total": lambda f: np.mean((f[:, :1] - f[:, 2:]) ** 2, axis=0) / (2.0 * np.var(f[:, :2])),
    },
    UNIFORM: {"rank_correlation": _ranked},
}
"""Method -> index -> how it follows from the samples, or their effects; NaN: not known."""


def _bounds(of: Callable, samples: np.ndarray, seed: int) -> np.ndarray:
    """Ends (2, factors) of the interval that holds CONFIDENCE of the indices of resampled samples."""
    rng = np.random.default_rng(seed)
    drawn = [of(samples[rng.integers(0, len(samples), len(samples))]) for _ in range(RESAMPLES)]
    return np.nanquantile(drawn, [(1.0 - CONFIDENCE) / 2.0, (1.0 + CONFIDENCE) / 2.0], axis=0)
