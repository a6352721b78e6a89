# SPDX-License-Identifier: MIT
"""The scenes, and the fits, of the robustness matrix: a base, and what `rows.toml` changes of it."""

import re
from collections.abc import Mapping
from math import pi
from typing import Any

import numpy as np

from sam.scene import HeightMap, Scene
from verification.fit import definition_of

RADIUS, FORCE, YOUNG, POISSON = 1e-4, 0.17, 210e9, 0.3
HERTZ = (0.75 * FORCE * RADIUS * (1 - POISSON**2) / YOUNG) ** (1 / 3)  # contact radius in m
UNITS = {"a": HERTZ, "E": YOUNG, "p0": 1.5 * FORCE / (pi * HERTZ**2)}
"""Of the numbers in `rows.toml`: contact radius in m, modulus and largest pressure in Pa of the base."""
BASE = {
    "title": "Stability",
    "body": {"young": YOUNG, "poisson": POISSON},
    "counterbody": {"shape": "sphere", "radius": RADIUS},
    "loading": {"force": FORCE},
    "grid": {"cells": (33, 33)},  # over four contact radii
    "fem": {"cells_per_radius": 8},
}
"""The scene that every row changes: a rigid sphere on steel, small enough for a second in either model."""
SIDE, PATCH, HIGH = 32e-6, 32, 1e-6  # of a rough patch: side in m, cells, what stands out of it in m


def heights(name: str) -> HeightMap:
    """A surface by its name: (nx, ny) heights in m on cells of SIDE/PATCH."""
    plain, x = np.zeros((PATCH, PATCH)), 2 * pi * (np.arange(PATCH) + 0.5) / PATCH
    wave = np.cos(x)[:, None] * np.ones(PATCH)
    raised: dict[str, tuple[Any, float]] = {
        "step": (np.s_[: PATCH // 2], HIGH),
        "ridge": (np.s_[:4], HIGH),
        "spike": (np.s_[PATCH // 2, PATCH // 2], HIGH),
        "hole": (np.s_[3, 3], np.nan),
        "endless": (np.s_[3, 3], np.inf),
        "raised": (np.s_[:], 1e-3),
    }
    if name in raised:
        where, height = raised[name]
        plain[where] = height
    values = {
        "half": plain[: PATCH // 2],
        "strip": plain[:4],
        "short": plain[:16, :16],
        "wave": 1e-8 * wave,
        "wave-twice": 2e-8 * wave,
        "wave-down": -2e-8 * wave,
        "two-parts": np.concatenate([plain, 2e-8 * wave]),
    }.get(name, plain)
    return HeightMap(values, tuple(SIDE * n / PATCH for n in values.shape))


def wide(radii: float, cells: int, depth: float, *, thickness: float = 0.0, even: int = 9) -> dict:
    """A grid over so many Hertz radii, its layers growing below the first `even`; their thickness in m, of a
    cell if 0.
    """
    thickness, faces = thickness or radii * HERTZ / cells, [0.0]
    while faces[-1] < depth * HERTZ:
        faces.append(faces[-1] + thickness * max(1.0, 1.2 ** (len(faces) - even)))
    sides = radii * HERTZ, radii * HERTZ
    return {"cells": (cells, cells), "extent": sides, "depths": tuple(faces)}


SHORT = {
    "film": lambda film: ("body.coating", {"thickness": film[0], "young": film[1], "poisson": POISSON}),
    "perfect": lambda stress: ("body.plasticity", {"law": "perfect", "yield_stress": stress}),
}
"""Keys of `rows.toml` that stand for longer ones: value -> key and value."""


def meant(value: Any, key: str = "") -> Any:
    """A value of `rows.toml` as a scene has it: "none" takes a key away, "2 a" and "p0/3" are numbers in
    UNITS; names of heights, keys of SHORT, and arguments of `wide`.
    """
    if isinstance(value, Mapping):
        pairs = ((name, meant(each, name)) for name, each in value.items())
        own = dict(SHORT[name](each) if name in SHORT else (name, each) for name, each in pairs)
        return wide(*own.pop("wide"), **own) if "wide" in own else own
    if isinstance(value, list):
        return tuple(meant(each, key) for each in value)
    if value == "none":
        return None
    if not isinstance(value, str):
        return value
    if key.endswith("path"):
        return heights(value)
    if product := re.fullmatch(r"(\S+) (a|E|p0)", value):
        return float(product[1]) * UNITS[product[2]]
    return UNITS["p0"] / float(value[3:]) if value.startswith("p0/") else value


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
    """The base with other values, as in `rows.toml`. Raises pydantic.ValidationError for what is no scene."""
    return Scene.model_validate(changed(BASE, meant(changes)))


def other(scene: Scene, changes: Mapping[str, Any]) -> Scene:
    """A scene with other values, checked anew; a height map stays what it is."""
    table = scene.model_dump(exclude_none=True)
    if scene.surface is not None:
        table["surface"] = {key: value for key, value in scene.surface if value is not None}
    return Scene.model_validate(changed(table, meant(changes)))


def fit_with(changes: Mapping[str, Any]) -> None:
    """A fit of E to a measured loading of the base, which Hertz gives; raises SceneError where it is refused.

    take: rows of the test, in order; times, plus: name of a column -> factor, summand; rename: its new name;
    unknown: as in a fit; the rest is of the test.
    """
    from pandas import DataFrame

    own, share = dict(meant(changed({}, changes))["fit"]), np.linspace(0.05, 1.0, 20)
    frame = DataFrame({"force_N": share * FORCE, "depth_m": share ** (2 / 3) * HERTZ**2 / RADIUS})
    frame = frame.iloc[list(own.pop("take", range(20)))].reset_index(drop=True)
    for name, factor in own.pop("times", {}).items():
        frame[name] *= factor
    for name, more in own.pop("plus", {}).items():
        frame[name] += more
    frame = frame.rename(columns=own.pop("rename", {}))
    unknown = own.pop("unknown", {"body.young": (1e11, 4e11)})
    tests = [own if own.get("kind") == "depth" else {"data": frame, **own}]
    definition_of({"scene": Scene.model_validate(BASE), "tests": tests, "unknown": unknown})
