# SPDX-License-Identifier: MIT
"""What a case may change of its scene beside single keys, `vary = {NAME = value}`: each a function of the
scene and the value.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

import numpy as np

from sam.scene import Scene
from verification.cases.case import with_grid, with_loading, with_mesh
from verification.reference.hertz import CircularContact
from verification.references import contact_of

REACH = 2.2  # half of the extent: the plastic zone reaches 1.6 a in the surface at 6.2 times the yield stress
EVEN, DEEPEST = 1.0, 2.2  # layers are even to 1 a; at "even depth" 2.2 they have reached 3.3 a
GROWTH = 0.75


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


RECIPES: Mapping[str, Callable[[Scene, Any], Scene]] = {"p0-over-yield": at_ratio, "resolution": resolved_at}
"""Name in a case file -> what it does to the scene."""
