# SPDX-License-Identifier: MIT
"""The scenes of the running-in cases: the five of verification/scenes/running-in-*.toml, and what is varied
in them.
"""

from __future__ import annotations

from dataclasses import dataclass

from sam.scene import Scene
from verification.suite.cases.case import with_grid, with_keys, with_loading

LITERATURE_B = 1280e6  # Pa: of the steel with the paper's C and n in the literature; the paper takes 1780 MPa
DEVIATIONS = (0.8, 1.25)


@dataclass(frozen=True)
class Effort:
    """How much of the paper's section 7 is run: names of scenes, seeds, cycles, load steps each way, cells of
    1 um a side.
    """

    cases: tuple[str, ...]
    seeds: tuple[int, ...]
    cycles: int
    steps: int
    cells: int
    varied: bool = False


def reduced(scene: Scene, effort: Effort) -> Scene:
    """The scene on a patch of so many cells, at its nominal pressure, for so many cycles and steps."""
    if effort.cells != scene.grid.cells[0]:
        share = effort.cells / scene.grid.cells[0]
        scene = with_grid(
            scene, cells=(effort.cells,) * 2, extent=tuple(share * side for side in scene.grid.extent)
        )
        scene = with_loading(scene, force=share**2 * scene.loading.force)
    return with_loading(scene, cycles=effort.cycles, steps=effort.steps, unload_steps=effort.steps)


def with_seed(scene: Scene, seed: int) -> Scene:
    """Another surface of the same statistics."""
    return with_keys(scene, "surface", seed=seed)


def with_plasticity(scene: Scene, **keys) -> Scene:
    """With other keys in [body.plasticity]."""
    return with_keys(scene, "body.plasticity", **keys)


def with_deviation(scene: Scene, scale: float) -> Scene:
    """With so much of the layer's deviation from the bulk; scaling the factors would change the bulk below it
    too.
    """
    return with_plasticity(
        scene, profile=tuple((z, 1.0 + scale * (factor - 1.0)) for z, factor in scene.body.plasticity.profile)
    )
