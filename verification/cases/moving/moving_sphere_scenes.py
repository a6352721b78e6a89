# SPDX-License-Identifier: MIT
"""The scenes of the cases of a sphere that moves."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sam.scene import Path, Scene
from verification.cases.case import with_grid, with_loading

RATIO = 4.0  # p0 over the initial yield stress
BESIDE, BEHIND, DEEP = 1.8, 2.2, 3.0  # contact radii of the grid beside the track, at its ends, and below
EVEN, LAYER_GROWTH = 1.2, 1.2  # radii down to which layers are as thick as a cell; ratio of deeper ones
LENGTH = 6.0  # of a track, radii: three to be steady, one and a half before its end


def modulus(scene: Scene) -> float:
    """E* of the body and a rigid sphere."""
    return scene.body.young / (1 - scene.body.poisson**2)


def yield_stress(scene: Scene) -> float:
    """Of unstrained material in Pa."""
    return float(scene.body.plasticity.strength().stress(0.0, np.zeros(1))[0])


def radius(scene: Scene, ratio: float = RATIO) -> float:
    """Hertz radius in m at p0 = ratio times the initial yield stress."""
    sphere = scene.counterbody.radius
    return float(np.pi * ratio * yield_stress(scene) * sphere / (2 * modulus(scene)))


@dataclass(frozen=True)
class Setting:
    """A track. cells, per_radius: cells and steps in a radius; length in radii; ratio: p0 over the yield
    stress; shift: of the track from the origin in cells; back: from its other end; cycles: passes, to and fro
    or one way.
    """

    cells: int = 6
    length: float = LENGTH
    per_radius: float = 4.0
    ratio: float = RATIO
    shift: float = 0.0
    back: bool = False
    cycles: int = 1
    to_and_fro: bool = False

    def of(self, scene: Scene) -> Scene:
        """The scene with this track, on a grid of its own."""
        a = radius(scene, self.ratio)
        h, faces = a / self.cells, [0.0]
        while faces[-1] < DEEP * a:
            even = len(faces) <= round(EVEN * self.cells)
            faces.append(faces[-1] + (h if even else (faces[-1] - faces[-2]) * LAYER_GROWTH))
        half = self.length / 2 + BEHIND + abs(self.shift) / self.cells
        cells = 2 * int(np.ceil(half * self.cells)) + 1, 2 * round(BESIDE * self.cells) + 1
        ends = [(x * a + self.shift * h, 0.0) for x in (-self.length / 2, self.length / 2)]
        start, end = ends[::-1] if self.back else ends
        steps = round(self.length * self.per_radius)
        path = Path(
            start=start, end=end, steps=steps, **{"return": "to-and-fro" if self.to_and_fro else "lifted"}
        )
        force = float(2 / 3 * np.pi * self.ratio * yield_stress(scene) * a**2)
        scene = with_loading(scene, force=force, path=path, cycles=self.cycles)
        return with_grid(scene, cells=cells, extent=(cells[0] * h, cells[1] * h), depths=tuple(faces))
