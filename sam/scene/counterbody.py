# SPDX-License-Identifier: MIT
"""The table [counterbody] of a scene: what is pressed on the body."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any, Literal

from sam.scene.section import Conflict, Section, stated
from sam.scene.units import Length, Poisson, Pressure

MOST_SLENDER = 1e4  # ratio of the radii; beyond it the contact is a line for every grid that is allowed
RADII = {"sphere": ("radius",), "punch": ("radius",), "ellipsoid": ("radius_x", "radius_y"), "flat": ()}
"""Shapes and the keys that each needs."""


class CounterBody(Section):
    """The smooth counter-body. Rigid without young and poisson, elastic with both.
    Lengths in m, young in Pa.
    """

    shape: Literal["sphere", "ellipsoid", "punch", "flat"]
    radius: Length | None = None
    radius_x: Length | None = None
    radius_y: Length | None = None
    young: Pressure | None = None
    poisson: Poisson | None = None

    @property
    def elastic(self) -> bool:
        """Whether it is elastic; else it is rigid."""
        return self.young is not None

    @property
    def radii(self) -> tuple[float, float]:
        """(Rx, Ry) in m of a sphere or an ellipsoid."""
        if self.shape == "ellipsoid":
            return stated(self.radius_x), stated(self.radius_y)
        return stated(self.radius), stated(self.radius)

    @classmethod
    def conflicts(cls, given: Mapping[str, Any]) -> Iterator[Conflict]:
        """Radii that the shape needs, or has no use for; one elastic constant without the other."""
        shape = given.get("shape")
        needed = RADII.get(shape) if isinstance(shape, str) else None
        for key in ("radius", "radius_x", "radius_y"):
            if needed is not None and (key in needed) != (key in given):
                words = " and ".join(needed) or "no radius"
                yield key, f'shape = "{shape}" takes {words}' + ("" if key in needed else ": remove it")
        if ("young" in given) != ("poisson" in given):
            missing = "poisson" if "young" in given else "young"
            yield missing, "required: young and poisson together (elastic counter-body), or neither (rigid)"

    def excesses(self) -> Iterator[Conflict]:
        """An ellipsoid that is too slender for any grid."""
        if self.shape != "ellipsoid":
            return
        along, across = self.radii
        if not 1 / MOST_SLENDER <= along / across <= MOST_SLENDER:
            yield "radius_y", f"radius_x/radius_y from {1 / MOST_SLENDER:g} to {MOST_SLENDER:g}"
