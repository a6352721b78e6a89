# SPDX-License-Identifier: MIT
"""The yield stress as a function of the accumulated plastic strain, and its factor over depth: a parameter of
both models.

A curve knows `stress(peeq)` and `slope(peeq)`, d sigma_y/d peeq, for arrays of any shape; peeq >= 0, stresses
in Pa. How a model uses them (return mapping, tangent) is its own.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Protocol, cast

import numpy as np
from numpy.typing import NDArray

from sam.arrays import Array


class YieldCurve(Protocol):
    """Isotropic hardening law."""

    def stress(self, peeq: Array | float) -> Array:
        """The yield stress in Pa at an accumulated plastic strain."""

    def slope(self, peeq: Array | float) -> Array:
        """d sigma_y/d peeq in Pa; of a table that to the next row."""


@dataclass(frozen=True)
class Swift:
    """sigma_y = B (C + alpha peeq)^n; B in Pa. Paper Eq. 18 (alpha = 1e6: the strain in microstrain)."""

    B: float
    C: float
    n: float
    alpha: float = 1e6

    def stress(self, peeq: Array | float) -> Array:
        """The yield stress in Pa at an accumulated plastic strain."""
        return self.B * (self.C + self.alpha * np.asarray(peeq)) ** self.n  # paper Eq. 18

    def slope(self, peeq: Array | float) -> Array:
        """d sigma_y/d peeq in Pa."""
        return self.B * self.n * self.alpha * (self.C + self.alpha * np.asarray(peeq)) ** (self.n - 1)


@dataclass(frozen=True)
class Linear:
    """sigma_y = yield_stress + modulus peeq, both in Pa; modulus 0: perfect plasticity."""

    yield_stress: float
    modulus: float = 0.0

    def stress(self, peeq: Array | float) -> Array:
        """The yield stress in Pa at an accumulated plastic strain."""
        return self.yield_stress + self.modulus * np.asarray(peeq)

    def slope(self, peeq: Array | float) -> Array:
        """d sigma_y/d peeq in Pa."""
        return np.full_like(np.asarray(peeq, dtype=float), self.modulus)


@dataclass(frozen=True)
class Tabulated:
    """Linear between the rows (peeq, yield stress in Pa), constant after the last; the first row has peeq =
    0.
    """

    peeq: tuple[float, ...]
    yield_stress: tuple[float, ...]

    @classmethod
    def of_rows(cls, rows: Iterable[tuple[float, float]]) -> Tabulated:
        """The curve through the rows (peeq, yield stress in Pa)."""
        return cls(*zip(*rows, strict=True))

    def stress(self, peeq: Array | float) -> Array:
        """The yield stress in Pa at an accumulated plastic strain."""
        return cast(Array, np.interp(peeq, self.peeq, self.yield_stress))

    def slope(self, peeq: Array | float) -> Array:
        """The slope to the right of each point; 0 from the last row on."""
        slopes = np.append(np.diff(self.yield_stress) / np.diff(self.peeq), 0.0)
        row = np.searchsorted(self.peeq, peeq, side="right") - 1
        found: Array = slopes[np.clip(row, 0, len(slopes) - 1)]
        return found


@dataclass(frozen=True)
class DepthProfile:
    """Factor on the yield stress over depth (m, ascending): linear between the rows, constant before and
    after them.
    """

    depth: tuple[float, ...] = (0.0,)
    factor: tuple[float, ...] = (1.0,)

    def __call__(self, z: Array | float) -> Array:
        """The factor at depths z in m."""
        return cast(Array, np.interp(z, self.depth, self.factor))

    def interval(self, z: Array | float) -> NDArray[np.intp]:
        """How many rows lie at or above z: where the factor has no kink the number is the same, and fields
        are smooth.
        """
        return np.searchsorted(self.depth, z, side="right")
