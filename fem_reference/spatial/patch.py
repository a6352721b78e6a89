# SPDX-License-Identifier: MIT
"""The rough surfaces of a scene: units and mesh planes of their patch. Lengths are in half of the longer side
of the patch.

The surface nodes of the patch are the centres of the scene's cells, so that a node stands for a cell: its
height, its local coefficient of friction. Beyond the patch the surface is free. The whole body is modelled,
and nothing but the patch is known of the size of the contact. What takes a scene here is part of the
planner.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from fem_reference.common.arrays import Array
from fem_reference.common.hertz import Scales, contact_modulus, required
from fem_reference.common.mesh_lines import grow, uniform_then_growing
from fem_reference.spatial.lines import Lines
from sam.scene.schema import Scene
from sam.scene.surface import CounterSurface, Strip, Surface

UNIFORM_DEPTH = 0.2
"""Depth over the shorter side of a patch of square cells down to which elements are cubes; spots of a few
asperities take a tenth.
"""
DEPTH_GROWTH = 1.6
"""Ratio of neighbouring elements below the cubes; 1.2 changes pressures and loads of spots by 3e-4."""
SIDE_GROWTH = 2.2
"""Ratio of neighbouring elements beside the patch; 1.4 changes pressures and loads of spots by 3e-4."""
UNLOADED = 0.01
"""Unit of displacement over that of length when there is no force: arbitrary, as nothing is deformed."""


@dataclass(frozen=True)
class Patch:
    """A rough body in SI units and the counter-body above it; None of a surface that is smooth.

    cells: (nx, ny); sides: (Lx, Ly); relief: the border of the patch is that of a relief in a plane; radii:
    of the counter-body along x and y, None if it is flat; strip: of a rough counter-body that moves.
    """

    surface: Surface | None
    counter: CounterSurface | None
    cells: tuple[int, int]
    sides: tuple[float, float]
    relief: bool
    radii: tuple[float, float] | None
    strip: Strip | None = None

    @property
    def centres(self) -> tuple[Array, Array]:
        """x (nx,) and y (ny,) of the cells."""
        x, y = (
            ((np.arange(n) + 0.5) / n - 0.5) * side for n, side in zip(self.cells, self.sides, strict=True)
        )
        return x, y


def choose_patch(scene: Scene) -> Patch:
    """The patch of a rough scene: cells and sides of a file, or those that the scene gives."""
    cells, sides = scene.patch
    relief = scene.grid is not None and scene.grid.border == "relief"
    radii = required(scene.counterbody).radii
    return Patch(scene.surface, scene.counter_surface, cells, sides, relief, radii, scene.counter_strip)


def rough_scales(scene: Scene, patch: Patch) -> Scales:
    """Units of a rough contact: half of the longer side, and the displacement that makes the force 4/3, as
    of a sphere; or the approach that is given.
    """
    modulus, length = contact_modulus(scene), 0.5 * max(patch.sides)
    if scene.loading.approach is not None:
        return Scales(length, scene.loading.approach, modulus, 4.0 / 3.0)
    force = required(scene.loading.force)
    displacement = 0.75 * force / (modulus * length) if force > 0.0 else UNLOADED * length
    return Scales(length, displacement, modulus, 4.0 / 3.0 if force > 0.0 else 0.0)


def rough_lines(patch: Patch, unit: float, box: float, *, marks: Sequence[float] | Array = ()) -> Lines:
    """Mesh planes through the centres of the cells, growing from there to the box, of so many half sides.

    unit: of length, in m; marks: depths in this unit that are planes too, see `uniform_then_growing`.
    Elements next to the surface are as high as the shorter side of a cell, or lower above a mark.
    """
    x, y = (_widened(line / unit, box) for line in patch.centres)
    size = min(side / n for side, n in zip(patch.sides, patch.cells, strict=True)) / unit
    depth = UNIFORM_DEPTH * (min(patch.cells) - 1) * size
    return Lines(x, y, uniform_then_growing(size, depth, box, growth=DEPTH_GROWTH, marks=marks), half=False)


def _widened(core: Array, box: float) -> Array:
    """Equidistant lines continued by growing ones over `box` beyond both ends."""
    outside = grow(0.0, box, core[1] - core[0], SIDE_GROWTH)
    return np.concatenate([core[0] - outside[::-1], core, core[-1] + outside])
