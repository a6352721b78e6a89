# SPDX-License-Identifier: MIT
"""What a case may change of its scene beside single keys, `vary = {NAME = value}`: each a function of the
scene and the value.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from importlib import import_module
from typing import Any, NamedTuple

import numpy as np

from sam.scene import Coating, CounterBody, Scene
from verification.cases.case import with_body, with_grid, with_keys, with_loading, with_mesh
from verification.reference.coated_sphere import CoatedContact
from verification.reference.hertz import CircularContact
from verification.references import coated_contact, contact_of
from verification.rows import CaseFile

REACH = 2.2  # half of the extent: the plastic zone reaches 1.6 a in the surface at 6.2 times the yield stress
EVEN, DEEPEST = 1.0, 2.2  # layers are even to 1 a; at "even depth" 2.2 they have reached 3.3 a
GROWTH = 0.75
ROOM = 1.06  # half a side of the grid over the larger of the contact radii with and without film


class Resolution(NamedTuple):
    """Cells (SAM) and elements (FEM) in the elastic contact radius."""

    sam: int
    fem: int


def initial_yield(scene: Scene) -> float:
    """Yield stress of the virgin body in Pa."""
    return float(scene.body.plasticity.curve().stress(0.0))


def at_ratio(scene: Scene, ratio: float) -> Scene:
    """The force that gives the elastic contact the peak pressure ratio * initial yield stress."""
    elastic, p0 = contact_of(scene), ratio * initial_yield(scene)
    force = CircularContact.from_peak_pressure(p0, elastic.radius, elastic.modulus).force
    return with_loading(scene, force=force)


def resolved_at(scene: Scene, resolution: Resolution) -> Scene:
    """The scene with cells of a/sam and elements of a/fem, a the radius of the elastic contact under its
    force; 2.2 radii each way, a cell centre on the apex.
    """
    cells, elements = resolution
    a = contact_of(scene).contact_radius
    n = 2 * round(REACH * cells) + 1
    extent = n * a / cells
    depths = tuple(float(z) for z in a * layer_faces(cells))
    return with_mesh(with_grid(scene, cells=(n, n), extent=(extent, extent), depths=depths), elements)


def layer_faces(cells: int) -> np.ndarray:
    """Depths of the faces of the layers in a: even to 1, then each thicker than the last, halved where
    `cells` doubles.
    """
    even = np.arange(round(DEEPEST * cells) + 1) / cells
    return even + GROWTH * np.maximum(even - EVEN, 0.0) ** 2


def cells_a_side(scene: Scene, n: int) -> Scene:
    """A grid of n by n cells over the extent of the scene."""
    return with_grid(scene, cells=(n, n))


def depths_over_radius(scene: Scene, depths: Sequence[float]) -> Scene:
    """Output depths, given over the radius of the elastic contact."""
    a = contact_of(scene).contact_radius
    return with_grid(scene, depths=tuple(a * z for z in depths))


COUNTERBODIES = {"rigid": {}, "steel": {"young": 210e9, "poisson": 0.3}}


def coated_scene(base: Scene, ratio: float, thickness: float, counterbody: str) -> Scene:
    """The sphere of `base` on another film. ratio: E1/E2; thickness: over the contact radius without film."""
    other = CounterBody(shape="sphere", radius=base.counterbody.radius, **COUNTERBODIES[counterbody])
    bare = base.model_copy(update={"counterbody": other})
    coating = Coating(
        young=ratio * base.body.young,
        poisson=base.body.coating.poisson,
        thickness=thickness * contact_of(bare).contact_radius,
    )
    return with_body(bare, coating=coating)


def resolved_grid(scene: Scene, contact: CoatedContact, cells: int = 48) -> Scene:
    """The scene on square cells, so many in the contact radius; a contact without film has room as well."""
    cell = contact.contact_radius / cells
    count = 2 * math.ceil(ROOM * max(contact.contact_radius, contact.bare.contact_radius) / cell) + 1
    return with_grid(scene, cells=(count, count), extent=(count * cell, count * cell))


def cells_in_coated_contact(scene: Scene, cells: int) -> Scene:
    """So many cells in the contact radius, and a few depths: nothing is looked at there."""
    contact, h = coated_contact(scene), scene.body.coating.thickness
    return with_grid(resolved_grid(scene, contact, cells), depths=(0.0, h, h + 0.5 * contact.contact_radius))


RECIPES: Mapping[str, Callable[[Scene, Any], Scene]] = {
    "p0-over-yield": at_ratio,
    "resolution": resolved_at,
    "cells": cells_a_side,
    "depths-over-radius": depths_over_radius,
    "elements": with_mesh,
    "film": lambda scene, film: coated_scene(scene, *film),
    "cells-in-coated-contact": cells_in_coated_contact,
}
"""Name in a case file -> what it does to the scene."""


def beside(file: CaseFile, name: str, known: Mapping[str, Any]) -> Any:
    """What a name in a case file stands for: of a registry, or a function of the module beside the file."""
    if name in known:
        return known[name]
    if not file.path.with_suffix(".py").exists():
        raise KeyError(f"{file.path.name}: {name} is none of {', '.join(known)}")
    module = import_module(f"verification.cases.{file.path.parent.name}.{file.path.stem}")
    return getattr(module, name.replace("-", "_"))


def changed(scene: Scene, changes: Mapping[str, Any], file: CaseFile) -> Scene:
    """The scene with keys set and recipes applied, in their order."""
    for key, value in changes.items():
        section, _, name = key.rpartition(".")
        if section:
            scene = with_keys(scene, section, **{name: tuple(value) if isinstance(value, list) else value})
        else:
            scene = beside(file, name, RECIPES)(scene, value)
    return scene
