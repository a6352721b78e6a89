# SPDX-License-Identifier: MIT
"""The scene that every row of the matrix changes: a rigid sphere on steel, small enough for a second in
either model.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from sam.scene import Scene

RADIUS, FORCE, YOUNG, POISSON = 1e-4, 0.17, 210e9, 0.3
HERTZ = (0.75 * FORCE * RADIUS * (1 - POISSON**2) / YOUNG) ** (1 / 3)  # contact radius in m
CELLS, MESH = 33, 8  # over four contact radii; in the contact radius
BEYOND = {"solver.beyond_model": True}
"""Of a contact wider than half the radius of the sphere: small strains of a flat half-space, for the numbers
alone."""
BASE = {
    "title": "Stability",
    "body": {"young": YOUNG, "poisson": POISSON},
    "counterbody": {"shape": "sphere", "radius": RADIUS},
    "loading": {"force": FORCE},
    "grid": {"cells": (CELLS, CELLS)},
    "fem": {"cells_per_radius": MESH},
}


def changed(table: Mapping, changes: Mapping[str, Any]) -> dict:
    """The table with other values, by dotted keys; None takes a key or a whole table away."""
    out = dict(table)
    for key, value in changes.items():
        head, _, rest = key.partition(".")
        if rest:
            out[head] = changed(out.get(head, {}), {rest: value})
        elif value is None:
            out.pop(head, None)
        else:
            out[head] = value
    return out


def scene_with(changes: Mapping[str, Any]) -> Scene:
    """The base with other values. Raises pydantic.ValidationError for what is no scene."""
    return Scene.model_validate(changed(BASE, changes))


def other(scene: Scene, changes: Mapping[str, Any]) -> Scene:
    """A scene with other values, checked anew; a height map stays what it is."""
    table = scene.model_dump(exclude_none=True)
    if scene.surface is not None:
        table["surface"] = {key: value for key, value in scene.surface if value is not None}
    return Scene.model_validate(changed(table, changes))
