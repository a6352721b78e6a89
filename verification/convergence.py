# SPDX-License-Identifier: MIT
"""Observed order of convergence."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Order:
    """error ~ factor h^order, fitted by least squares in log-log; scatter: largest |error/fit - 1| of the points."""

    order: float
    factor: float
    scatter: float

    def __call__(self, h: np.ndarray) -> np.ndarray:
        return self.factor * np.asarray(h) ** self.order


def fit_order(h: Sequence[float], error: Sequence[float]) -> Order:
    """Fit error ~ factor h^order to all points.

    h: (n,) cell sizes, n >= 3, all different; error: (n,), positive. ValueError otherwise: an order from two points, or
    from an error that is exactly zero, is no observation.
    """
    h, error = np.asarray(h, dtype=float), np.asarray(error, dtype=float)
    if h.shape != error.shape or h.ndim != 1 or np.unique(h).size < 3:
        raise ValueError(f"h and error: at least three different cell sizes with one error each, not {h} and {error}")
    if not (np.all(np.isfinite(error)) and np.all(error > 0.0) and np.all(h > 0.0)):
        raise ValueError(f"h and error: positive and finite, not {h} and {error}")
    order, log_factor = np.polyfit(np.log(h), np.log(error), 1)
    fit = np.exp(log_factor) * h**order
    return Order(float(order), float(np.exp(log_factor)), float(np.max(np.abs(error / fit - 1.0))))
