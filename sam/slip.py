# SPDX-License-Identifier: MIT
"""Friction in full slip: the coefficient at the cells of a grid, and how its traction enters the gap."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sam.arrays import Array

Coefficient = float | Array
"""A number, or one for each cell, (nx, ny)."""


@dataclass(frozen=True)
class FullSlip:
    """The traction q = coefficient * p along x, at every step.

    slides: whether there is a traction anywhere; coefficient: at the cells, with a tribofilm the low one, as
    long as it is whole; highest: where a tribofilm has failed everywhere, else the same; coupled: whether the
    traction moves the surfaces normally; coupling: 2 beta, the factor of the coefficient in the gap (1 with a
    coating, where 2 beta is a function of the wave number, see `sam.contact.bodies`); whole: coefficient
    under a whole tribofilm, None without one.
    """

    slides: bool = False
    coefficient: Coefficient = 0.0
    highest: Coefficient = 0.0
    coupled: bool = False
    coupling: float = 0.0
    whole: float | None = None

    @property
    def uniform(self) -> bool:
        """Whether one coefficient holds everywhere and always."""
        return self.whole is None and np.ndim(self.coefficient) == 0
