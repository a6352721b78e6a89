# SPDX-License-Identifier: MIT
"""The grids and meshes of the elasto-plastic cases: one number for each model, lengths in elastic contact
radii.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sam.scene import Scene
from verification.suite.cases.case import with_grid, with_mesh
from verification.suite.cases.hertz import contact_of

REACH = 2.2  # half of the extent: the plastic zone reaches 1.6 a in the surface at 6.2 times the yield stress
EVEN, DEEPEST = 1.0, 2.2  # layers are even to 1 a; at "even depth" 2.2 they have reached 3.3 a
GROWTH = 0.75


@dataclass(frozen=True)
class Resolution:
    """Cells (SAM) and elements (FEM) in the elastic contact radius."""

    sam: int
    fem: int


def resolved_at(scene: Scene, resolution: Resolution) -> Scene:
    """The scene with cells of a/sam and elements of a/fem, a the radius of the elastic contact under its
    force.
    """
    a = contact_of(scene).contact_radius
    n = 2 * round(REACH * resolution.sam) + 1  # odd: a cell centre on the apex
    extent = n * a / resolution.sam
    depths = tuple(float(z) for z in a * layer_faces(resolution.sam))
    return with_mesh(with_grid(scene, cells=(n, n), extent=(extent, extent), depths=depths), resolution.fem)


def layer_faces(cells: int) -> np.ndarray:
    """Depths of the faces of the layers in a: even to 1, then each thicker than the last, halved where
    `cells` doubles.
    """
    even = np.arange(round(DEEPEST * cells) + 1) / cells
    return even + GROWTH * np.maximum(even - EVEN, 0.0) ** 2
