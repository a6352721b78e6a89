# SPDX-License-Identifier: MIT
"""The table [counterbody] of a scene: what is pressed on the body."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, ClassVar, Literal

from sam.scene.section import Conflict, Given, Section, of_choice, stated
from sam.scene.surface.counter import CounterSurface
from sam.scene.units import Length, Poisson, Pressure, Share

MOST_SLENDER = 1e4  # ratio of the radii; beyond it the contact is a line for every grid that is allowed
SHAPES = {
    "sphere": ("radius",),
    "ellipsoid": ("radius_x", "radius_y"),
    "punch": ("radius",),
    "rounded-punch": ("flat_radius", "radius"),
    "flat": (),
    "cylinder": ("radius", "length"),
}
"""The shapes of a scene and the keys that each needs."""
CURVED = ("sphere", "ellipsoid")  # the shapes that have radii of curvature: their own keys
if TYPE_CHECKING:
    ShapeName = str
else:
    ShapeName = Literal[tuple(SHAPES)]


class CounterBody(Section):
    """The counter-body. Rigid without young and poisson, elastic with both; it neither yields nor wears.
    Smooth without surface. radius: of a sphere, of the flat end of a punch, of the rounded edge of a
    rounded-punch, whose flat end has flat_radius, of a cylinder, whose axis lies along y and whose length
    bears the force: a line contact, the same at every y. Lengths in m, young in Pa. slip: of one that moves
    (loading.path), the share of its way by which it slides over the body, 1 if not given; 0: it rolls.
    """

    shape: ShapeName
    radius: Length | None = None
    flat_radius: Length | None = None
    radius_x: Length | None = None
    radius_y: Length | None = None
    length: Length | None = None
    young: Pressure | None = None
    poisson: Poisson | None = None
    surface: CounterSurface | None = None
    slip: Share | None = None
    unwritten: ClassVar[tuple[str, ...]] = ("length",)

    @property
    def elastic(self) -> bool:
        """Whether it is elastic; else it is rigid."""
        return self.young is not None

    @property
    def radii(self) -> tuple[float, float] | None:
        """Radii of curvature (Rx, Ry) in m; None of a shape that has none."""
        if self.shape not in CURVED:
            return None
        values = [stated(getattr(self, key)) for key in SHAPES[self.shape]]
        return values[0], values[-1]

    @classmethod
    def conflicts(cls, given: Given) -> Iterator[Conflict]:
        """Radii that the shape needs, or has no use for; one elastic constant without the other."""
        shape, of_some_shape = given.text("shape"), {key for keys in SHAPES.values() for key in keys}
        if (needed := SHAPES.get(shape)) is not None:
            keys = [key for key in cls.model_fields if key in of_some_shape]
            words = f'shape = "{shape}" takes {" and ".join(needed) or "no radius"}'
            yield from of_choice(given, keys, (needed, needed), (words, f"{words}: remove it"))
        if ("young" in given) != ("poisson" in given):
            missing = "poisson" if "young" in given else "young"
            yield missing, "required: young and poisson together (elastic counter-body), or neither (rigid)"

    def excesses(self) -> Iterator[Conflict]:
        """An ellipsoid that is too slender for any grid."""
        along, across = self.radii or (1.0, 1.0)
        if not 1 / MOST_SLENDER <= along / across <= MOST_SLENDER:
            yield "radius_y", f"radius_x/radius_y from {1 / MOST_SLENDER:g} to {MOST_SLENDER:g}"
