# SPDX-License-Identifier: MIT
"""Where a key of a scene belongs: for a table or value that is written in the wrong place, or under a common
other name.
"""

from __future__ import annotations

import difflib
from functools import cached_property
from typing import get_args

from sam.scene.section import Section

OTHER_NAMES = {
    "film": ("[body.coating]", '[friction] with law = "chemical-film"'),
    "layer": ("[body.coating]",),
    "hardening": ("[body.plasticity]",),
    "substrate": ("[body]",),
    "halfspace": ("[body]",),
    "indenter": ("[counterbody]",),
    "ball": ("[counterbody]",),
    "sphere": ("[counterbody]",),
    "punch": ("[counterbody]",),
    "roughness": ("[surface]",),
    "mesh": ("[fem]", "[grid]"),
}
"""What others call a table -> where it is here."""
MOST_PLACES = 4  # of one name in a message
CLOSE = 0.75  # of difflib: a slip of one or two letters


def _section_of(annotation: object) -> type[Section] | None:
    """The section that a field holds, if it holds one."""
    for one in (annotation, *get_args(annotation)):
        if isinstance(one, type) and issubclass(one, Section):
            return one
    return None


class Places:
    """Where each key of a scene is, as a scene file spells it: "[body.coating]", "body.young"."""

    def __init__(self, scene: type[Section]):
        self.scene = scene

    @cached_property
    def known(self) -> dict[str, tuple[str, ...]]:
        """Key -> every place that has it."""
        found: dict[str, list[str]] = {}

        def walk(section: type[Section], above: str) -> None:
            for key, field in section.model_fields.items():
                name = field.alias or key
                inner = _section_of(field.annotation)
                found.setdefault(name, []).append(f"[{above}{name}]" if inner else f"{above}{name}")
                if inner:
                    walk(inner, f"{above}{name}.")

        walk(self.scene, "")
        return {name: tuple(places) for name, places in found.items()}

    def of(self, name: str, is_table: bool) -> tuple[str, ...]:
        """Where a key of this name belongs, or a table of another name for it, at most MOST_PLACES; or
        nothing.

        is_table: tables are preferred to values then, and values to tables if not.
        """
        found, others = self.known.get(name, ()), OTHER_NAMES.get(name.lower(), ()) if is_table else ()
        alike = [place for place in found if place.startswith("[") == is_table]
        return (*others, *(alike or found))[:MOST_PLACES]

    def nearest(self, name: str) -> tuple[str, ...]:
        """Where a key of nearly this name belongs, at most MOST_PLACES; or nothing."""
        near = difflib.get_close_matches(name, self.known, n=1, cutoff=CLOSE)
        return self.known[near[0]][:MOST_PLACES] if near else ()
