# SPDX-License-Identifier: MIT
"""The scenes of the running-in cases: the five of verification/scenes/running-in-*.toml, and what is varied in them."""

from __future__ import annotations

from dataclasses import dataclass

from sam.scene import Scene
from verification.reference.regime import film_pressure, swift, tear_pressure
from verification.suite.cases.case import with_grid, with_loading

# Pa: the paper's section 6, and the steel with its C and n in the literature
PAPER_B, LITERATURE_B = 1780e6, 1280e6
DEVIATIONS = (0.8, 1.25)


@dataclass(frozen=True)
class Effort:
    """How much of the paper's section 7 is run: names of scenes, seeds, cycles, load steps each way, cells of 1 um a side."""

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
    return scene.model_copy(update={"surface": scene.surface.model_copy(update={"seed": seed})})


def with_plasticity(scene: Scene, **keys) -> Scene:
    """With other keys in [body.plasticity]."""
    plasticity = scene.body.plasticity.model_copy(update=keys)
    return scene.model_copy(update={"body": scene.body.model_copy(update={"plasticity": plasticity})})


def with_wear(scene: Scene, **keys) -> Scene:
    """With other keys in [wear]."""
    return scene.model_copy(update={"wear": scene.wear.model_copy(update=keys)})


def with_deviation(scene: Scene, scale: float) -> Scene:
    """With so much of the layer's deviation from the bulk; scaling the factors would change the bulk below it too."""
    rows = tuple((z, 1.0 + scale * (factor - 1.0)) for z, factor in scene.body.plasticity.profile)
    return with_plasticity(scene, profile=rows)


@dataclass(frozen=True)
class Limits:
    """What decides the regime of a scene's spots, in Pa. strength: of the surface at its strain limit; tears: pressure above
    which the traction of a failed film tears it; first: the same for the middle of the first layer of cells, where a solver
    looks; film: pressure above which the film fails; tears_whole: like tears, below a whole film."""

    strength: float
    tears: float
    first: float
    film: float
    tears_whole: float

    @classmethod
    def of(cls, scene: Scene) -> Limits:
        friction, depths = scene.friction, scene.grid.depths
        surface, first = (strength_at(scene, z) for z in (0.0, 0.5 * (depths[0] + depths[1])))
        film = friction.film_young, friction.film_poisson, friction.film_yield
        fails = film_pressure(
            friction.thinning_limit, friction.low, film, (scene.body.young, scene.body.poisson)
        )
        tears, lower, whole = (
            tear_pressure(strength, mu)
            for strength, mu in ((surface, friction.high), (first, friction.high), (surface, friction.low))
        )
        return cls(surface, tears, lower, fails, whole)


def strength_at(scene: Scene, z: float) -> float:
    """Yield stress in Pa at depth z of material strained to its limit of wear."""
    plasticity, wear = scene.body.plasticity, scene.wear
    inside = plasticity.layer_thickness is not None and z < plasticity.layer_thickness
    limit = wear.strain_limit_layer if inside and wear.strain_limit_layer is not None else wear.strain_limit
    return float(plasticity.depth_profile()(z)) * swift(plasticity.B, plasticity.C, plasticity.n, limit)
