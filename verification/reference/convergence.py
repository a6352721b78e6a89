# SPDX-License-Identifier: MIT
"""Observed orders of convergence and growth."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.optimize import minimize_scalar

ORDERS = (0.5, 4.0)
"""Between these an order is looked for; a fit that ends on one of them has observed none."""


@dataclass(frozen=True)
class Limit:
    """value(h) ~ limit + factor h^order over a ladder; scatter: largest misfit over the finest value."""

    limit: float
    factor: float
    order: float
    finest: float
    scatter: float

    def __call__(self, h: np.ndarray) -> np.ndarray:
        return self.limit + self.factor * np.asarray(h) ** self.order

    @property
    def observed(self) -> bool:
        """Whether the values follow a power of h at all."""
        return ORDERS[0] * 1.01 < self.order < ORDERS[1] * 0.99

    @property
    def uncertainty(self) -> float:
        """Relative distance of the value on the finest grid from the limit."""
        return abs(self.finest / self.limit - 1.0)


def extrapolate(h: Sequence[float], values: Sequence[float]) -> Limit:
    """Richardson's extrapolation to h = 0 with the observed order (Roache, 1998), by least squares. h: (n,)
    cell sizes, n >= 3, all different; values: (n,). ValueError otherwise. For each order the limit and the
    factor are linear, so the order alone is searched.
    """
    h, values = np.asarray(h, dtype=float), np.asarray(values, dtype=float)
    if h.shape != values.shape or h.ndim != 1 or np.unique(h).size < 3 or not np.all(h > 0.0):
        needed = "at least three different cell sizes with one value each"
        raise ValueError(f"h and values: {needed}, not {h} and {values}")
    if not np.all(np.isfinite(values)):
        raise ValueError(f"values: finite, not {values}")

    def fitted(order: float) -> tuple[np.ndarray, np.ndarray]:
        matrix = np.stack([np.ones_like(h), (h / h.max()) ** order], axis=1)
        terms = np.linalg.lstsq(matrix, values, rcond=None)[0]
        return terms, matrix @ terms - values

    trials = np.linspace(*ORDERS, 75)  # coarse first: the misfit may have two minima
    best = trials[np.argmin([np.sum(fitted(order)[1] ** 2) for order in trials])]
    bounds = (max(best - 0.05, ORDERS[0]), min(best + 0.05, ORDERS[1]))
    close = {"bounds": bounds, "options": {"xatol": 1e-6}}
    order = minimize_scalar(lambda p: float(np.sum(fitted(p)[1] ** 2)), **close).x
    (limit, share), misfit = fitted(order)
    finest = values[np.argmin(h)]
    scatter = float(np.max(np.abs(misfit)) / abs(finest))
    return Limit(float(limit), float(share / h.max() ** order), float(order), float(finest), scatter)


@dataclass(frozen=True)
class Power:
    """y ~ factor x^exponent by least squares in log-log, first <= x <= last; error: of the exponent. An error
    over the sizes of cells has its order as exponent.
    """

    exponent: float
    error: float
    factor: float
    first: float
    last: float

    def __call__(self, x: np.ndarray) -> np.ndarray:
        return self.factor * np.asarray(x, dtype=float) ** self.exponent

    def __str__(self) -> str:
        return f"{self.exponent:.2f} ± {self.error:.2f}"


def fit_power(x: Sequence[float], y: Sequence[float], first: float = 0.0) -> Power:
    """Fit y ~ factor x^exponent to three or more x >= first, y > 0; ValueError for fewer, or a zero."""
    x, y = np.asarray(x, dtype=float), np.asarray(y, dtype=float)
    if x.shape != y.shape or x.ndim != 1 or np.unique(x[x >= first]).size < 3:
        raise ValueError(f"x and y: at least three different values with one y each, not {x} and {y}")
    x, y = x[x >= first], y[x >= first]
    if not (np.all(np.isfinite(y)) and np.all(y > 0.0) and np.all(x > 0.0)):
        raise ValueError(f"x and y: positive and finite, not {x} and {y}")
    along = np.log(x) - np.log(x).mean()
    exponent, log_factor = np.polyfit(along, np.log(y), 1)
    left = np.log(y) - log_factor - exponent * along
    error = np.sqrt(np.sum(left**2) / (x.size - 2) / np.sum(along**2))
    factor = np.exp(log_factor - exponent * np.log(x).mean())
    return Power(float(exponent), float(error), float(factor), float(x.min()), float(x.max()))
