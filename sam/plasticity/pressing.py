# SPDX-License-Identifier: MIT
"""Where the pressure on a box comes from: a contact with the counter-body, or the scene itself."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from sam.contact.box import BoxContact
from sam.loading import Load

CONTACT_LIMIT = 400


class ContactPressure:
    """Contact of the surface that plastic strain has displaced.

    gap0: (nx, ny) in m on the box; hx: cell in m; force_unit: N per sum of p_hat.
    """

    def __init__(self, contact: BoxContact, gap0: np.ndarray, hx: float, force_unit: float):
        self.contact, self.gap0, self.hx, self.force_unit = contact, gap0, hx, force_unit
        self.start = np.isfinite(gap0).astype(float)

    def __call__(self, lift: np.ndarray, load: Load, start: np.ndarray, tolerance: float) -> np.ndarray:
        """p_hat under a load on the surface displaced by `lift` (m); zero without force.

        start: p_hat to start from; a uniform one where that is zero.
        """
        if load.force == 0:
            return np.zeros(self.gap0.shape)
        gap = (self.gap0 + lift) / self.hx
        start = start if start.any() else self.start
        total = load.force / self.force_unit
        return self.contact.solve(
            gap - gap.min(), total, start, tolerance=tolerance, limit=CONTACT_LIMIT, sign=load.sign
        ).p


class GivenPressure:
    """The pressure of the scene, whatever the surface does. pressure: of a load, p_hat on the box."""

    def __init__(self, pressure: Callable[[Load], np.ndarray], shape: tuple[int, int]):
        self.pressure, self.start = pressure, np.zeros(shape)

    def __call__(self, lift: np.ndarray, load: Load, start: np.ndarray, tolerance: float) -> np.ndarray:
        """As of `ContactPressure`; only the load counts."""
        return self.pressure(load)
