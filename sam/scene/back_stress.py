# SPDX-License-Identifier: MIT
"""Kinematic hardening as a parameter of both models: the constants of the back-stresses, and the table
[body.plasticity.kinematic] that holds them.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from math import inf
from typing import Annotated, Any

from sam.scene.inputs import list_of
from sam.scene.section import Conflict, Section
from sam.scene.units import Pressure, Recovery

MOST = 8  # back-stresses: each adds six numbers a cell to the state


@dataclass(frozen=True)
class BackStress:
    """Back-stresses X_k with d X_k = 2/3 C_k d eps_p - g_k X_k dp (Armstrong & Frederick 1966; several:
    Chaboche 1986); g_k = 0: Prager's linear law.

    Parameters
    ----------
    modulus
        C_k in Pa, the slope d sigma/d eps_p in tension at the start.
    recovery
        g_k >= 0. In tension X_k tends to C_k/g_k.
    """

    modulus: tuple[float, ...]
    recovery: tuple[float, ...]

    @property
    def saturation(self) -> float:
        """The largest back-stress in tension in Pa, sum of C_k/g_k; infinite with Prager's law."""
        return sum(
            modulus / recovery if recovery else inf
            for modulus, recovery in zip(self.modulus, self.recovery, strict=True)
        )


class Kinematic(Section):
    """Kinematic hardening beside the isotropic law. modulus: of each back-stress in Pa; recovery: of each, 0
    (Prager's law) if not given.
    """

    modulus: Annotated[tuple[Pressure, ...], list_of(1, MOST)]
    recovery: Annotated[tuple[Recovery, ...], list_of(1, MOST)] | None = None

    @classmethod
    def conflicts(cls, given: Mapping[str, Any]) -> Iterator[Conflict]:
        """A recovery for each modulus, or for none."""
        counts = [
            len(values)
            for key in ("modulus", "recovery")
            if isinstance(values := given.get(key), list | tuple)
        ]
        if len(set(counts)) > 1:
            yield "recovery", f"as many numbers as modulus has: {counts[0]}"

    def back_stress(self) -> BackStress:
        """The constants."""
        return BackStress(self.modulus, self.recovery or (0.0,) * len(self.modulus))
