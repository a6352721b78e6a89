# SPDX-License-Identifier: MIT
"""Anderson acceleration of a fixed point x = g(x) (Walker & Ni 2011, type II)."""

from __future__ import annotations

import numpy as np


class Anderson:
    """Combines the last `window` iterates so that their residuals g(x) - x cancel best.

    weight: of each entry in the least-squares sense, broadcast against x. The normal equations are scaled to a unit
    diagonal, and their singular values below `cutoff` cut: directions that the window already holds.
    """

    def __init__(self, window: int, weight: np.ndarray, cutoff: float = 1e-12):
        self.window, self.weight, self.cutoff = window, weight, cutoff
        self.steps: list[np.ndarray] = []  # differences of g(x)
        self.changes: list[np.ndarray] = []  # differences of the weighted residual
        self.last: tuple[np.ndarray, np.ndarray] | None = None
        self.gram = np.zeros((0, 0))

    def next(self, x: np.ndarray, image: np.ndarray) -> np.ndarray:
        """The next iterate after g(x) = image."""
        residual = ((image - x) * self.weight).ravel()
        if self.last is not None:
            self.steps.append(image - self.last[0])
            self.changes.append(residual - self.last[1])
            del self.steps[: -self.window], self.changes[: -self.window]
            self._add_to_gram()
        self.last = (image, residual)
        if not self.steps:
            return image
        gram = self.gram
        size = np.sqrt(np.maximum(gram.diagonal(), np.finfo(float).tiny))
        right = np.array([np.vdot(change, residual) for change in self.changes]) / size
        coefficients = np.linalg.lstsq(gram / np.outer(size, size), right, rcond=self.cutoff)[0] / size
        return image - sum(c * step for c, step in zip(coefficients, self.steps, strict=True))

    def _add_to_gram(self) -> None:
        """Products of the newest change with those in the window."""
        row = np.array([np.vdot(self.changes[-1], change) for change in self.changes])
        kept = self.gram[-(len(row) - 1) :, -(len(row) - 1) :] if len(row) > 1 else self.gram[:0, :0]
        self.gram = np.block([[kept, row[:-1, None]], [row[None, :-1], row[-1:, None]]])
