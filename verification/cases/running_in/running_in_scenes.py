# SPDX-License-Identifier: MIT
"""The scenes of the running-in cases: the five of verification/scenes/running-in-*.toml with the printed
inputs, their second reading, and what is varied in them.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

from sam.scene import CounterSurface, Hardening, Result, Scene, Status
from verification.cases.case import with_grid, with_keys, with_loading

LITERATURE_B = 1280e6  # Pa: of the steel with the paper's C and n in the literature; the paper takes 1780 MPa
DEVIATIONS = (0.8, 1.25)
DEEPER = ((14.2e-6, 19.4e-6), (26.5e-6, 36.2e-6))  # m: further faces of layers, each 1.366 times as deep
LAYER_ALPHA = 1e3  # of Swift's law in the layer: 2.4 GPa at a strain of 2 %, where 1e6 gives 4.6 GPa
ROUGHNESS = {"sq": 10e-9, "cutoff_long": 32e-6, "cutoff_short": 12e-6, "hurst": 0.8}


class Reading(StrEnum):
    """How the paper is read, in words. PRINTED: with its numbers, by our plastic loop; RENEWED: with what it
    leaves open chosen otherwise, see `renewed`.
    """

    PRINTED = "with the printed inputs"
    RENEWED = "weakly hardening layer, renewed counter-surface"

    @property
    def short(self) -> str:
        """For columns of tables and names of files."""
        return "printed inputs" if self is Reading.PRINTED else "renewed"


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


def with_constant(scene: Scene, B: float) -> Scene:
    """With another constant B, in Pa, in the body and in a layer with a law of its own."""
    layer = scene.body.plasticity.layer
    return with_plasticity(scene, B=B, layer=layer and layer.model_copy(update={"B": B}))


def read_as(reading: Reading, scene: Scene) -> Scene:
    """The scene in one of the readings."""
    return renewed(scene) if reading is Reading.RENEWED else scene


def renewed(scene: Scene) -> Scene:
    """The second reading of a scene: its layer, if it has one, hardens little; the counter-surface is rough
    and another one in each cycle; layers of cells reach deeper. Its seeds, one for each cycle, are neither
    those of the surfaces nor those of another surface's counter-surface.
    """
    plasticity = scene.body.plasticity
    if plasticity.layer_thickness is not None:
        own = plasticity.model_dump(include={"law", "B", "C", "n"})
        scene = with_plasticity(scene, layer=Hardening(**own, alpha=LAYER_ALPHA))
    seed = 1000 * scene.surface.seed + 1
    surface = CounterSurface(kind="self-affine", **ROUGHNESS, seed=seed, renew=True)
    scene = with_keys(scene, "counterbody", surface=surface)
    return deeper(scene).model_copy(update={"title": f"{scene.title}, {Reading.RENEWED}"})


def deeper(scene: Scene) -> Scene:
    """With the next faces of DEEPER: softer steel, and the summits of some surfaces, let the body yield below
    the layers of the printed scenes.
    """
    depths = scene.grid.depths
    return with_grid(scene, depths=(*depths, *next(faces for faces in DEEPER if faces[0] > depths[-1])))


def deeper_after(scene: Scene, result: Result) -> Scene | None:
    """The scene with deeper layers where its plastic zone reached the last one and there are deeper ones."""
    at_edge = result.status is Status.PLASTIC_ZONE_AT_GRID_EDGE
    return deeper(scene) if at_edge and scene.grid.depths[-1] < DEEPER[-1][0] else None


def with_deviation(scene: Scene, scale: float) -> Scene:
    """With so much of the layer's deviation from the bulk; scaling the factors would change the bulk below it
    too.
    """
    return with_plasticity(
        scene, profile=tuple((z, 1.0 + scale * (factor - 1.0)) for z, factor in scene.body.plasticity.profile)
    )
