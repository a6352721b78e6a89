# SPDX-License-Identifier: MIT
"""What is given of a contact: its force, or how far the bodies approach; units as of `sam.contact.normal`.

The conjugate gradients of `sam.contact.box` are the same for both. Under force control the rigid approach is
the mean separation of the cells in contact, and each change of the pressure has no sum; under displacement
control the approach is known, and the sum of the pressure follows (Polonsky & Keer 1999 with the force
balance left out).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import pi, sqrt
from typing import Any, Protocol

import numpy as np

from sam.arrays import Array, Mask

Counted = np.ndarray[Any, np.dtype[np.floating[Any]]]
Begun = tuple[Array, Array]
"""p_hat and its u_hat."""


class Control(Protocol):
    """What is given of a contact. p: p_hat; counted: how many cells each stands for, 0 out of contact."""

    def coarser(self) -> Control:
        """The same for cells twice as large."""

    def less(self, offset: float) -> Control:
        """The same for gaps that are smaller by an offset in cells hx."""

    def touches(self, gap0: Array) -> bool:
        """Whether there is any contact at this initial gap, in cells hx."""

    def start(self, gap0: Array) -> Array:
        """A pressure to start from where nothing is known."""

    def scaled(self, p: Array, count: Array | float = 1.0) -> Array:
        """The pressure with the sum that is given, if one is."""

    def begun(self, p: Array, gap0: Array, count: Array | float, apply: Callable[[Array], Array]) -> Begun:
        """The first iterate from a start; apply: p_hat -> u_hat."""

    def shares(self, counted: Counted) -> Array:
        """Share of each cell in what is taken off a change of the pressure."""

    def level(self, separation: Array, counted: Counted) -> float:
        """Rigid approach of an iterate with a separation gap0 + u_hat."""

    def approach(self, contact: Mask, separation: Array) -> float:
        """The same of a result; contact: the cells in contact."""


@dataclass(frozen=True)
class ForceControl:
    """The force is given: total, the sum of p_hat. Methods as of `Control`."""

    total: float

    def coarser(self) -> ForceControl:
        """The same for cells twice as large."""
        return ForceControl(self.total / 4)

    def less(self, offset: float) -> ForceControl:
        """The same: a force does not depend on where gaps are counted from."""
        return self

    def touches(self, gap0: Array) -> bool:
        """Whether there is a force, and a counter-body opposite any cell."""
        return self.total > 0 and bool(np.isfinite(gap0).any())

    def start(self, gap0: Array) -> Array:
        """Uniform where there is a counter-body."""
        return np.isfinite(gap0).astype(float)

    def scaled(self, p: Array, count: Array | float = 1.0) -> Array:
        """The pressure with the given sum."""
        found: Array = p * (self.total / (p * count).sum())
        return found

    def begun(self, p: Array, gap0: Array, count: Array | float, apply: Callable[[Array], Array]) -> Begun:
        """The start with the given sum."""
        p = self.scaled(p, count)
        return p, apply(p)

    def shares(self, counted: Counted) -> Array:
        """Equal ones: a change of the pressure has no sum."""
        found: Array = counted / counted.sum()
        return found

    def level(self, separation: Array, counted: Counted) -> float:
        """Mean separation of the cells in contact."""
        found: float = np.vdot(counted, separation) / counted.sum()
        return found

    def approach(self, contact: Mask, separation: Array) -> float:
        """Mean separation of the cells in contact."""
        return float(separation[contact].mean())


@dataclass(frozen=True)
class ApproachControl:
    """The rigid approach is given: distance, in cells hx. Methods as of `Control`."""

    distance: float

    def coarser(self) -> ApproachControl:
        """The same for cells twice as large."""
        return ApproachControl(self.distance / 2)

    def less(self, offset: float) -> ApproachControl:
        """The same for gaps that are smaller by an offset."""
        return ApproachControl(self.distance - offset)

    def touches(self, gap0: Array) -> bool:
        """Whether the bodies would overlap in any cell."""
        return bool(gap0.min() < self.distance)

    def start(self, gap0: Array) -> Array:
        """In proportion to the overlap, as large as that of Hertz: half of the cells that overlap touch, and
        p_hat = 4 a/(pi R) under an overlap a^2/R.
        """
        overlap = np.maximum(self.distance - gap0, 0.0)
        radius = sqrt(max(int(np.count_nonzero(overlap)), 1) / (2 * pi))
        found: Array = 4 / (pi * radius) * overlap
        return found

    def scaled(self, p: Array, count: Array | float = 1.0) -> Array:
        """The pressure itself: its sum is a result."""
        return p

    def begun(self, p: Array, gap0: Array, count: Array | float, apply: Callable[[Array], Array]) -> Begun:
        """The start times the number that fits its displacement best; `start` where none is positive."""
        overlap, u = self.distance - gap0, apply(p)
        if np.vdot(p * count, overlap) <= 0:
            p = self.start(gap0)
            u = apply(p)
        factor = np.vdot(p * count, overlap) / np.vdot(p * count, u)
        return factor * p, factor * u

    def shares(self, counted: Counted) -> Array:
        """None: the sum of the pressure may change."""
        return np.zeros_like(counted)

    def level(self, separation: Array, counted: Counted) -> float:
        """The given approach."""
        return self.distance

    def approach(self, contact: Mask, separation: Array) -> float:
        """The given approach."""
        return self.distance
