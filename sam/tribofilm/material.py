# SPDX-License-Identifier: MIT
"""What a tribofilm is made of, and what acts on its cells in a load step."""

from __future__ import annotations

from dataclasses import dataclass

from sam.arrays import Array


@dataclass(frozen=True)
class Material:
    """An elastic, perfectly plastic film; young and yield_stress in Pa."""

    young: float
    poisson: float
    yield_stress: float

    @property
    def twice_shear(self) -> float:
        """2 G = E/(1 + nu) in Pa."""
        return self.young / (1.0 + self.poisson)


@dataclass(frozen=True)
class Loads:
    """What acts on n whole cells of a film at the end of a load step.

    plastic: strain at its beginning, (6, n), order 11 22 33 23 13 12; strain: of the body's surface since the
    start of the cycle, xx, yy, xy, (3, n), and bulk_normal its zz, (n,), for the printed form only; pressure
    and shear: P and s_xz in Pa, (n,).
    """

    plastic: Array
    strain: Array
    pressure: Array
    shear: Array
    bulk_normal: Array | None = None
