# SPDX-License-Identifier: MIT
"""The table [loading] of a scene: a force, an approach or a given pressure, its steps and its path."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

from sam.scene.path import Path
from sam.scene.section import Conflict, Section, stated
from sam.scene.units import Count, Force, Length, Misfit, Pressure

HERTZ, MISFIT_SPHERE = "hertz", "misfit-sphere"


@dataclass(frozen=True)
class Prescribed:
    """A load that is given in place of a force: the keys that it needs, those that it may have with their
    defaults (None: none), and both in words.
    """

    needed: tuple[str, ...]
    further: Mapping[str, str | None]
    words: str

    @property
    def keys(self) -> tuple[str, ...]:
        """All keys of it."""
        return *self.needed, *self.further


PRESCRIBED = {
    HERTZ: Prescribed(("p0", "radius"), {"path": None}, 'prescribed = "hertz" with p0 and radius'),
    MISFIT_SPHERE: Prescribed(
        ("depth", "radius", "misfit"),
        {"profile": "smooth", "surface": "free"},
        'prescribed = "misfit-sphere" with depth, radius and misfit',
    ),
}
"""Loads that a scene may give in place of a force, by their names."""
DEEPER = {"smooth": 1.0, "ball": 1.0, "gauss": 3.0}
"""Profiles of a misfit sphere, and the depth of its centre over its radius, which it has to exceed."""
if TYPE_CHECKING:
    PrescribedName = str
    ProfileName = str
else:
    PrescribedName, ProfileName = Literal[tuple(PRESCRIBED)], Literal[tuple(DEEPER)]


class Loading(Section):
    """`steps` equal steps to the peak, and back to zero in `unload_steps` when `unload`; so in every one of
    the cycles.

    The load is a normal force in N, by which a counter-body is pressed on, or in its place the approach of
    the bodies in m, whose force is then a result; or with prescribed = "hertz" the
    pressure itself: at step k (k/steps) p0 sqrt(1 - r^2/radius^2), p0 in Pa, radius in m the same in all
    steps. Each of these may travel on a path at full size; a cycle is then one pass.

    With prescribed = "misfit-sphere" nothing touches the body: material about
    a centre at `depth` would grow by a linear strain in all directions if it were free, at step k (k/steps)
    misfit f(r/radius), r the distance from the centre, f = (1 - x^2)^2 inside x = 1 ("smooth"), 1 inside it
    ("ball") or exp(-x^2) ("gauss"). surface: "free", or "held" by the tractions of the infinite body.
    """

    force: Force | None = None
    approach: Length | None = None
    prescribed: PrescribedName | None = None
    p0: Pressure | None = None
    radius: Length | None = None
    depth: Length | None = None
    misfit: Misfit | None = None
    profile: ProfileName | None = None
    surface: Literal["free", "held"] | None = None
    path: Path | None = None
    steps: Count = 1
    unload: bool = False
    unload_steps: Count | None = None
    cycles: Count = 1

    @property
    def hertz(self) -> bool:
        """Whether the pressure is given."""
        return self.prescribed == HERTZ

    @property
    def misfit_sphere(self) -> bool:
        """Whether a misfit strain inside the body is the load."""
        return self.prescribed == MISFIT_SPHERE

    @classmethod
    def implied(cls, given: Mapping[str, Any]) -> Mapping[str, Any]:
        """The defaults of the load that is given in place of a force."""
        own = _prescribed_of(given)
        return {} if own is None else {key: value for key, value in own.further.items() if value is not None}

    @classmethod
    def conflicts(cls, given: Mapping[str, Any]) -> Iterator[Conflict]:
        """None of force, approach and what is given in their place, or more than one; keys without the one
        that they need.
        """
        own = _prescribed_of(given)
        if "prescribed" not in given or own is not None:
            foreign = dict.fromkeys(key for each in PRESCRIBED.values() for key in each.keys)
            own_keys = ("path",) if own is None else own.keys
            yield from ((key, _only_with(key)) for key in foreign if key in given and key not in own_keys)
        yield from _conflicts_of_force(given) if own is None else _conflicts_of_prescribed(given, own)
        if "unload_steps" in given and given.get("unload", False) is False:
            yield "unload_steps", "only together with unload = true"

    def excesses(self) -> Iterator[Conflict]:
        """A misfit sphere that reaches the surface."""
        if self.misfit_sphere:
            least = DEEPER[stated(self.profile)]
            if stated(self.depth) <= least * stated(self.radius):
                words = "the radius" if least == 1.0 else f'{least:g} times the radius with profile = "gauss"'
                yield "depth", f"more than {words}, {least * stated(self.radius):g} m"


def _prescribed_of(given: Mapping[str, Any]) -> Prescribed | None:
    """What is given in place of a force; None if that is nothing, or has no name of these."""
    name = given.get("prescribed")
    return PRESCRIBED.get(name) if isinstance(name, str) else None


def _only_with(key: str) -> str:
    """Of what a key is a part."""
    needed = [each.words for each in PRESCRIBED.values() if key in each.needed]
    if needed:
        return f"only as part of {', or of '.join(needed)}"
    named = [f'prescribed = "{name}"' for name, each in PRESCRIBED.items() if key in each.further]
    return f"only together with {' or '.join(named)}"


def _conflicts_of_prescribed(given: Mapping[str, Any], own: Prescribed) -> Iterator[Conflict]:
    yield from ((key, f"required: {own.words}") for key in own.needed if key not in given)
    for key in ("force", "approach"):
        if key in given:
            yield key, f"either {key}, or {own.words}, not both"


def _conflicts_of_force(given: Mapping[str, Any]) -> Iterator[Conflict]:
    if "prescribed" in given:
        return
    if "force" in given and "approach" in given:
        yield "approach", "either force or approach, not both"
    if "force" not in given and "approach" not in given:
        yield "force", f"required: force, approach, or {PRESCRIBED[HERTZ].words}"
