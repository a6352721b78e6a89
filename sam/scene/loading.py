# SPDX-License-Identifier: MIT
"""The table [loading] of a scene: a force, an approach or a given pressure, its steps and its path."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Annotated, Any, Literal

from sam.scene.inputs import list_of
from sam.scene.section import Conflict, Section
from sam.scene.units import Coordinate, Count, Force, Length, Pressure

Place = Annotated[tuple[Coordinate, Coordinate], list_of(2, 2)]
"""(x, y) on the surface in m."""


class Path(Section):
    """The way of a given pressure over the surface, from start to end in `steps` equal steps at full size.

    Before it the load is put on at start, after it taken off at end: one pass in every cycle.
    """

    start: Place
    end: Place
    steps: Count

    def excesses(self) -> Iterator[Conflict]:
        """A path without length."""
        if self.start == self.end:
            yield "end", "another place than start"


GIVEN_PRESSURE = ("p0", "radius")
"""Keys that a given pressure needs."""


class Loading(Section):
    """`steps` equal steps to the peak, and back to zero in `unload_steps` when `unload`; so in every one of
    the cycles.

    The load is a normal force in N, by which a counter-body is pressed on, or in its place the approach of
    the bodies in m, whose force is then a result; or with prescribed = "hertz" the
    pressure itself: at step k (k/steps) p0 sqrt(1 - r^2/radius^2), p0 in Pa, radius in m the same in all
    steps; it may travel on a path.
    """

    force: Force | None = None
    approach: Length | None = None
    prescribed: Literal["hertz"] | None = None
    p0: Pressure | None = None
    radius: Length | None = None
    path: Path | None = None
    steps: Count = 1
    unload: bool = False
    unload_steps: Count | None = None
    cycles: Count = 1

    @classmethod
    def conflicts(cls, given: Mapping[str, Any]) -> Iterator[Conflict]:
        """None of force, approach and pressure, or more than one; keys without the one that they need."""
        words = 'prescribed = "hertz" with p0 and radius'
        if "prescribed" in given:
            yield from ((key, f"required: {words}") for key in GIVEN_PRESSURE if key not in given)
            for key in ("force", "approach"):
                if key in given:
                    yield key, f"either {key}, or {words}, not both"
        else:
            if "force" in given and "approach" in given:
                yield "approach", "either force or approach, not both"
            if "force" not in given and "approach" not in given:
                yield "force", f"required: force, approach, or {words}"
            yield from ((key, f"only as part of {words}") for key in GIVEN_PRESSURE if key in given)
            if "path" in given:
                yield "path", 'only together with prescribed = "hertz"'
        if "unload_steps" in given and given.get("unload", False) is False:
            yield "unload_steps", "only together with unload = true"
