# SPDX-License-Identifier: MIT
"""The path of a load over the surface, and the passes over it: the schedule that all models share."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from math import ceil, copysign, hypot
from typing import Annotated, Any, ClassVar, Literal

from pydantic import ConfigDict, Field

from sam.scene.inputs import list_of
from sam.scene.section import Conflict, Section, stated
from sam.scene.units import COUNT, Coordinate, Count, PerRadius

Place = Annotated[tuple[Coordinate, Coordinate], list_of(2, 2)]
"""(x, y) on the surface in m."""
TO_AND_FRO = "to-and-fro"
ROUNDING = 1e-9  # of a number of steps: a path of exactly so many takes no further one


class Path(Section):
    """The way of the load over the surface, from start to end in equal steps at full size; a cycle is one
    pass over it.

    Either `steps` of them, or `step_per_radius` in each contact radius of Hertz, see
    `sam.scene.passes.contact_radius`. return "lifted": in every cycle the load is put on at start and taken
    off at end; "to-and-fro": odd cycles go forth and even ones back, and the load stays on between them
    unless the body wears.
    """

    model_config = ConfigDict(serialize_by_alias=True)
    start: Place
    end: Place
    steps: Count | None = None
    step_per_radius: PerRadius | None = None
    return_: Literal["lifted", "to-and-fro"] = Field("lifted", alias="return")

    either: ClassVar[str] = f"required: steps, {COUNT.allowed(True)}, or step_per_radius"

    @classmethod
    def conflicts(cls, given: Mapping[str, Any]) -> Iterator[Conflict]:
        """Neither a number of steps nor their size, or both."""
        if "steps" not in given and "step_per_radius" not in given:
            yield "steps", cls.either
        if "steps" in given and "step_per_radius" in given:
            yield "step_per_radius", "either steps or step_per_radius, not both"

    def excesses(self) -> Iterator[Conflict]:
        """A path without length."""
        if self.start == self.end:
            yield "end", "another place than start"

    @property
    def to_and_fro(self) -> bool:
        """Whether even cycles go back."""
        return self.return_ == TO_AND_FRO

    @property
    def length(self) -> float:
        """From start to end in m."""
        return hypot(self.end[0] - self.start[0], self.end[1] - self.start[1])

    def count(self, radius: float) -> int:
        """Steps from start to end; radius: of the contact in m, for a path that gives their size."""
        if self.steps is not None:
            return self.steps
        return max(1, ceil(self.length * stated(self.step_per_radius) / radius - ROUNDING))


@dataclass(frozen=True)
class Pass:
    """What the load does in one cycle.

    places: (x, y) in m at full size, in their order, the first where the cycle begins; pressed: whether it is
    put on there in `loading.steps` steps, else it is on; unloads: whether it is taken off at the last place;
    sign: of the traction on the body along x.
    """

    places: tuple[tuple[float, float], ...]
    pressed: bool = True
    unloads: bool = True
    sign: float = 1.0


@dataclass(frozen=True)
class Strokes:
    """The passes of a scene.

    path: None without; count: steps along it; cycles: how many passes; unload: whether the last one ends
    unloaded; alternates: whether the sign of the traction changes from cycle to cycle; with_motion: whether
    the traction is along the motion, as of a counter-body that slides; in_passes: whether the load is taken
    off at the end of every pass, as for wear.
    """

    path: Path | None
    count: int
    cycles: int
    unload: bool
    alternates: bool = False
    with_motion: bool = False
    in_passes: bool = False

    def places(self) -> tuple[tuple[float, float], ...]:
        """Places of the load on its way forth after each step, the start first; the origin alone without
        path.
        """
        if self.path is None:
            return ((0.0, 0.0),)
        (x0, y0), (x1, y1) = self.path.start, self.path.end
        shares = [k / self.count for k in range(self.count + 1)]
        return tuple((x0 + share * (x1 - x0), y0 + share * (y1 - y0)) for share in shares)

    def goes_back(self, cycle: int) -> bool:
        """Whether the pass of a cycle, counted from 1, begins at the end of the path."""
        return cycle % 2 == 0 and self.with_motion and self.path is not None and self.path.to_and_fro

    def of_cycle(self, cycle: int) -> Pass:
        """The pass of a cycle, counted from 1."""
        places, last, even = self.places(), cycle == self.cycles, cycle % 2 == 0
        unloads = self.unload if last else True
        if self.path is None or not self.with_motion:
            return Pass(places, unloads=unloads, sign=-1.0 if self.alternates and even else 1.0)
        back, stays = self.goes_back(cycle), self.path.to_and_fro and not self.in_passes
        along_x = (self.path.end[0] - self.path.start[0]) * (-1.0 if back else 1.0)
        return Pass(
            places[::-1] if back else places,
            pressed=cycle == 1 or not stays,
            unloads=unloads and (last or not stays),
            sign=copysign(1.0, along_x),
        )
