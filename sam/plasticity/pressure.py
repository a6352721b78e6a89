# SPDX-License-Identifier: MIT
"""Where the pressure on a box comes from: the contact with the counter-body, or a pressure that is given.

Both know the load by a function of it, so a gap or a pressure may move from step to step.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from sam.arrays import Array
from sam.contact.box import BoxContact
from sam.contact.normal import control_of
from sam.schedule import Load

CONTACT_LIMIT = 400  # iterations of a contact solve, ten times what a step takes; more halve the step


class PressureSource(Protocol):
    """What a plastic step asks for the pressure on its box."""

    def start(self, load: Load) -> Array:
        """p_hat to start from where nothing is known, (nx, ny)."""

    def __call__(self, displacement: Array, load: Load, start: Array, tolerance: float) -> Array:
        """p_hat under a load on the surface that plastic strain has displaced, (nx, ny) in m; zero without
        force.
        """

    def found(self, load: Load, pressure: Array) -> Load:
        """A load that p_hat is solved for, with its force."""


@dataclass(frozen=True)
class ContactPressure:
    """The contact solve on a surface that plastic strain has displaced.

    gap: of a load, (nx, ny) in m on the box, of the surfaces without displacement; hx: cell in m; force_unit:
    N per sum of p_hat.
    """

    contact: BoxContact
    gap: Callable[[Load], Array]
    hx: float
    force_unit: float

    def start(self, load: Load) -> Array:
        """A uniform pressure where there is a counter-body."""
        return np.isfinite(self.gap(load)).astype(float)

    def __call__(self, displacement: Array, load: Load, start: Array, tolerance: float) -> Array:
        """p_hat to a tolerance on the residual of the contact, from `start`, or a uniform one where that is
        zero.
        """
        if load.force == 0:
            return np.zeros(displacement.shape)
        gap = (self.gap(load) + displacement) / self.hx
        start = start if start.any() else self.start(load)
        lowest, control = float(gap.min()), control_of(load.given, self.hx, self.force_unit)
        return self.contact.solve(
            gap - lowest,
            control.less(lowest),
            start,
            tolerance=tolerance,
            limit=CONTACT_LIMIT,
            sign=load.sign,
        ).p

    def found(self, load: Load, pressure: Array) -> Load:
        """The load with the sum of the pressure as its force."""
        return load.found(float(pressure.sum()) * self.force_unit)


@dataclass(frozen=True)
class NoPressure:
    """Nothing touches a box of (nx, ny) cells."""

    shape: tuple[int, int]

    def start(self, load: Load) -> Array:
        """Nothing."""
        return np.zeros(self.shape)

    def __call__(self, displacement: Array, load: Load, start: Array, tolerance: float) -> Array:
        """Nothing."""
        return np.zeros(self.shape)

    def found(self, load: Load, pressure: Array) -> Load:
        """The load itself."""
        return load


@dataclass(frozen=True)
class GivenPressure:
    """A pressure that acts whatever the surface does. pressure: of a load, p_hat on the box, (nx, ny)."""

    pressure: Callable[[Load], Array]
    shape: tuple[int, int]

    def start(self, load: Load) -> Array:
        """Nothing."""
        return np.zeros(self.shape)

    def __call__(self, displacement: Array, load: Load, start: Array, tolerance: float) -> Array:
        """p_hat of the load; nothing else counts."""
        return self.pressure(load)

    def found(self, load: Load, pressure: Array) -> Load:
        """The load itself, whose force is given."""
        return load
