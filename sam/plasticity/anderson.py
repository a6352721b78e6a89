# SPDX-License-Identifier: MIT
"""Anderson acceleration of a fixed point x = g(x) (Walker & Ni 2011, type II)."""

from __future__ import annotations

import numpy as np

from sam.arrays import Array


class Anderson:
    """Combines the last `window` iterates so that their residuals g(x) - x cancel best.

    weight: of each entry in the least-squares sense, broadcast against x. The normal equations are scaled to
    a unit diagonal, and their singular values below `cutoff` dropped: directions the window already holds.
    """

    def __init__(self, window: int, weight: Array, cutoff: float = 1e-12):
        self.window, self.weight, self.cutoff = window, weight, cutoff
        self.count = 0  # differences so far; they take turns in the rows of
        self.steps = self.changes = np.empty((window, 0))  # g(x), and of the weighted residual
        self.gram = np.zeros((window, window))
        self.last: tuple[Array, Array] | None = None

    def next(self, x: Array, image: Array) -> Array:
        """The next iterate after g(x) = image."""
        flat, residual = image.ravel(), ((image - x) * self.weight).ravel()
        if self.last is not None:
            self._add(flat - self.last[0], residual - self.last[1])
        self.last = (flat, residual)
        n = min(self.count, self.window)
        if not n:
            return image
        gram = self.gram[:n, :n]
        size = np.sqrt(np.maximum(gram.diagonal(), np.finfo(float).tiny))
        right = self.changes[:n] @ residual / size
        coefficients = np.linalg.lstsq(gram / np.outer(size, size), right, rcond=self.cutoff)[0] / size
        following: Array = (flat - coefficients @ self.steps[:n]).reshape(image.shape)
        return following

    def _add(self, step: Array, change: Array) -> None:
        """The newest differences, in place of the oldest, and the products of the change with those in the
        window.
        """
        if not self.count:
            self.steps, self.changes = np.empty((2, self.window, step.size))
        row, self.count = self.count % self.window, self.count + 1
        self.steps[row], self.changes[row] = step, change
        n = min(self.count, self.window)
        self.gram[row, :n] = self.gram[:n, row] = self.changes[:n] @ change
