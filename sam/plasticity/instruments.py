# SPDX-License-Identifier: MIT
"""What a load history asks of the elastic body and of the scene to record a state: functions that know their scene."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

from sam.arrays import Array
from sam.contact.normal import Contact
from sam.friction import Coefficient
from sam.loading import Load, Target
from sam.plasticity.progress import Parts
from sam.record import Row
from sam.scene.surface import Roughness
from sam.sliding import Sliding


class RowMaker(Protocol):
    """Makes the row of a load step in the history; see `sam.record.row_of`."""

    def __call__(
        self,
        target: Target,
        contact: Contact,
        coefficient: Coefficient,
        *,
        parts: Parts,
        note: str,
        peeq_max: float,
    ) -> Row:
        """The row of a step to a target that was made in some parts."""


@dataclass(frozen=True)
class Instruments:
    """What is measured, and how.

    stress: of a load, its contact and the coefficient of friction, in the rows of cells that touch y = 0,
    (6, nz, nx, rows) in Pa; sliding: of the same, None without friction; given: the contact of a load whose pressure
    is given, from pressure in Pa and displacement in m; row: of the history; in_steps: unloading in several steps;
    roughness: of a surface that was lowered by so much, (nx, ny) in m, None if it is smooth; anywhere: whether the largest
    stress may lie beside y = 0; off_origin: whether the contact may be elsewhere than around the origin.
    """

    stress: Callable[[Load, Contact, Coefficient], Array]
    sliding: Callable[[Load, Contact, Coefficient], Sliding | None]
    given: Callable[[Load, Array, Array], Contact]
    row: RowMaker
    in_steps: Callable[[Target], list[Target]]
    roughness: Callable[[Array], Roughness] | None = None
    anywhere: bool = False
    off_origin: bool = False
