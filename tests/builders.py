# SPDX-License-Identifier: MIT
"""The scenes that tests share: the text of a scene file, and small scenes with tables changed."""

import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from sam.scene import Scene, load_scene, parse_scene
from verification.robustness.fuzz import good_heights
from verification.robustness.hostile import ROUGH

STEEL = {"young": 210e9, "poisson": 0.3}
MODULUS = 210e9 / (1 - 0.3**2)
RADIUS = 105e-6
SPHERE = {"shape": "sphere", "radius": RADIUS}
SWIFT = {"law": "swift", "B": 945e6, "C": 20.0, "n": 0.121}
SWIFT_YIELD = 945e6 * 20**0.121
PERFECT = {"law": "perfect", "yield_stress": 1e9}
LINEAR = {"law": "linear", "yield_stress": 1e9, "modulus": 10.5e9}
RUN_IN_STEEL = {"law": "swift", "B": 1780e6, "C": 4.0, "n": 0.095}
CHEMICAL_FILM = {
    "law": "chemical-film",
    "low": 0.1,
    "high": 0.4,
    "film_thickness": 100e-9,
    "film_young": 80e9,
    "film_poisson": 0.3,
    "film_yield": 2e9 / 3,
    "strain_limit": 0.0204,
}
HARDENING = {
    "swift": 'law = "swift"\nB = "945 MPa"\nC = 20\nn = 0.121\n',
    "linear": 'law = "linear"\nyield_stress = "1 GPa"\nmodulus = "10.5 GPa"\n',
    "perfect": 'law = "perfect"\nyield_stress = "1 GPa"\n',
    "table": 'law = "table"\nfile = "curve.csv"\n',
}
"""An example of each hardening law, in a scene file; that of the table has `YIELD_CURVE` in its file."""
YIELD_CURVE = "peeq,yield_stress_Pa\n0,1e9\n0.01,1.5e9\n"
SHAPES = {
    "sphere": SPHERE,
    "ellipsoid": {"shape": "ellipsoid", "radius_x": RADIUS, "radius_y": 2 * RADIUS},
    "punch": {"shape": "punch", "radius": 5e-6},
    "rounded-punch": {"shape": "rounded-punch", "flat_radius": 5e-6, "radius": 50e-6},
    "flat": {"shape": "flat"},
    "cylinder": {"shape": "cylinder", "radius": RADIUS, "length": 1e-3},
}
"""An example of each shape."""


def hertz_force(p0: float, radius: float = RADIUS, modulus: float = MODULUS) -> float:
    """The force at which Hertz's largest pressure on a sphere is p0 (Johnson 1985, Eq. 4.24)."""
    return (math.pi * p0) ** 3 * radius**2 / (6 * modulus**2)


def scene(**tables: Any) -> Scene:
    """A rigid sphere of 105 um pressed on steel by 0.65 N, with the keys of its tables replaced.

    A table that is None is left out, and so are the counter-body and the force if the pressure is prescribed.
    friction may be a coefficient.
    """
    given = "prescribed" in tables.get("loading", {})
    content: dict[str, Any] = {"body": STEEL, "loading": {} if given else {"force": 0.65}}
    if not given:
        content["counterbody"] = SPHERE
    for name, table in tables.items():
        if name == "counterbody" and given:
            continue
        if name == "friction" and isinstance(table, float | int):
            table = {"coefficient": table} if table else None
        whole = name == "counterbody" and isinstance(table, Mapping) and "shape" in table
        changed = isinstance(table, Mapping) and not whole
        content[name] = {**content.get(name, {}), **table} if changed else table
    return Scene(**{name: table for name, table in content.items() if table is not None})


def yielding(ratio: float, plasticity: Mapping = SWIFT, **tables: Any) -> Scene:
    """`scene` at the force at which Hertz's largest pressure is `ratio` times the first yield stress."""
    first = plasticity.get("yield_stress", SWIFT_YIELD)
    loading = {"force": hertz_force(ratio * first), "unload": True, **tables.pop("loading", {})}
    return scene(body={"plasticity": plasticity}, loading=loading, **tables)


def running_in(
    *, cycles=2, steps=3, film=CHEMICAL_FILM, wear=0.002, counterbody=None, **tables: Any
) -> Scene:
    """A rough patch with a chemical film that fails in some cells, and wear, in a second or two.

    24 x 24 cells over 16 um. wear: limit, keys of [wear], or None; counterbody: keys, or a rigid plane.
    """
    surface = {"kind": "self-affine", "ra": 0.1e-6, "cutoff_long": 16e-6, "cutoff_short": 8e-6}
    surface |= {"hurst": 0.8, "seed": 1, **tables.pop("surface", {})}
    loading = {"force": 0.06, "steps": steps, "unload": True, "cycles": cycles, **tables.pop("loading", {})}
    depths = (0.0, 0.1e-6, 0.2e-6, 0.4e-6, 0.7e-6, 1.2e-6, 2e-6, 3.5e-6, 6e-6)
    return scene(
        body={"plasticity": tables.pop("plasticity", RUN_IN_STEEL)},
        counterbody={"shape": "flat", **(counterbody or {})},
        surface=surface,
        loading=loading,
        friction=film,
        wear={"strain_limit": wear} if isinstance(wear, float) else wear,
        grid={"cells": (24, 24), "extent": (16e-6, 16e-6), "depths": depths, "border": "relief"},
        **{"solver": {"tolerance": 1e-4}} | tables,
    )


SPHERE_TEXT = """title = "Sphere"
[body]
young = "210 GPa"
poisson = 0.3
[counterbody]
shape = "sphere"
radius = "105 um"
[loading]
force = "0.65 N"
"""
COARSE = '[grid]\ncells = [33, 33]\nlayers = 40\ndepth = "12 um"\n[fem]\ncells_per_radius = 8\nbox = 6\n'
"""A few hundredths of a second a model."""
GIVEN = 'prescribed = "hertz"\np0 = "4 GPa"\nradius = "6 um"\n'
PATH = 'path = { start = ["-9 um", "0 um"], end = ["9 um", "0 um"], steps = 4 }\n'


def scene_text(*edits: tuple[str, str], add: str = "") -> str:
    """SPHERE_TEXT with pieces replaced, and text at the end (inside [loading])."""
    text = SPHERE_TEXT
    for old, new in edits:
        assert old in text
        text = text.replace(old, new)
    return text + add


def parsed(*edits: tuple[str, str], add: str = "") -> Scene:
    """The scene of `scene_text`."""
    return parse_scene(scene_text(*edits, add=add).encode(), "scene.toml")


def friction_text(lines: str) -> str:
    return scene_text(add=f"[friction]\n{lines}\n")


def given_pressure(lines: str) -> str:
    """SPHERE_TEXT without counter-body and force, with these lines in [loading]."""
    return SPHERE_TEXT[: SPHERE_TEXT.index("[counterbody]")] + "[loading]\n" + lines


def measured_scene(
    folder: Path, name: str = "heights.npz", content: bytes | None = None, keys: str = "", more: str = ""
) -> Scene:
    """A scene whose surface is a file with this content; keys: more of [surface]; more: at the end."""
    (folder / name).write_bytes(good_heights() if content is None else content)
    (folder / "s.toml").write_text(ROUGH.replace('"heights.npz"\n', f'"{name}"\n{keys}') + more)
    return load_scene(folder / "s.toml")
