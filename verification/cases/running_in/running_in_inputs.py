# SPDX-License-Identifier: MIT
"""What the paper leaves open about its running-in, as inputs with ranges, put into the scene of a material.

Ranges are those that the paper, the literature on this steel and the readings of its figures allow; within
them every value counts as equally likely, and inputs as independent.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from scipy.stats import binomtest

from sam.scene import CounterSurface, Hardening, Scene
from verification.cases.case import with_keys, with_loading
from verification.cases.running_in.running_in_scenes import (
    DEEPER,
    ROUGHNESS,
    deeper,
    with_constant,
    with_deviation,
    with_plasticity,
    with_seed,
)

LAYER_LIMIT = 0.02  # of the layers of the printed scenes; curve B with 5 % keeps its 2.5 times as much
SMOOTH = 0.5e-9  # m: below it the counter-surface is a plane
NOMINAL = 1e-6  # m: printed thickness of the layer


@dataclass(frozen=True)
class Input:
    """An input between two ends, which are SI, or one of its levels; words, factor: for the reader."""

    name: str
    words: str
    ends: tuple[float, float]
    put: Callable[[Scene, float], Scene]
    factor: float = 1.0
    logarithmic: bool = False
    levels: tuple[int, ...] = ()

    def value(self, share: float) -> float:
        """At a share (0 to 1) of the way from one end to the other."""
        if self.levels:
            return self.levels[min(int(share * len(self.levels)), len(self.levels) - 1)]
        low, high = self.ends
        return low * (high / low) ** share if self.logarithmic else low + (high - low) * share

    def shown(self, share: float) -> str:
        """For the reader."""
        return f"{self.factor * self.value(share):.3g}"


def _surface(key: str) -> Callable[[Scene, float], Scene]:
    return lambda scene, value: with_keys(scene, "surface", **{key: value})


def _friction(key: str) -> Callable[[Scene, float], Scene]:
    return lambda scene, value: with_keys(scene, "friction", **{key: value})


def _layer_alpha(scene: Scene, alpha: float) -> Scene:
    """The layer with Swift's law of its own: hardening by alpha times the strain in place of 1e6 times."""
    plasticity = scene.body.plasticity
    if plasticity.layer_thickness is None:
        return scene
    own = plasticity.model_dump(include={"law", "B", "C", "n"})
    return with_plasticity(scene, layer=Hardening(**own, alpha=alpha))


def _layer_depth(scene: Scene, thickness: float) -> Scene:
    """The profile over depth, and the layer if there is one, so much thinner."""
    plasticity, share = scene.body.plasticity, thickness / NOMINAL
    if plasticity.profile is None:
        return scene
    keys = {"profile": tuple((share * z, factor) for z, factor in plasticity.profile)}
    if plasticity.layer_thickness is not None:
        keys["layer_thickness"] = share * plasticity.layer_thickness
    return with_plasticity(scene, **keys)


def _deviation(scene: Scene, scale: float) -> Scene:
    return scene if scene.body.plasticity.profile is None else with_deviation(scene, scale)


def _layer_limit(scene: Scene, limit: float) -> Scene:
    printed = scene.wear.strain_limit_layer
    if printed is None:
        return scene
    return with_keys(scene, "wear", strain_limit_layer=limit * printed / LAYER_LIMIT)


def _counter_roughness(scene: Scene, sq: float) -> Scene:
    """A rough counter-surface, another one in each cycle."""
    if sq < SMOOTH:
        return scene
    keys = {**ROUGHNESS, "sq": sq, "seed": 1000 * scene.surface.seed + 1}
    return with_keys(scene, "counterbody", surface=CounterSurface(kind="self-affine", **keys, renew=True))


INPUTS = (
    Input("feed", "share of the feed in Ra", (0.2, 0.6), _surface("feed_share")),
    Input("shortest", "shortest wave [µm]", (8e-6, 20e-6), _surface("cutoff_short"), 1e6),
    Input("hurst", "Hurst exponent", (0.6, 0.95), _surface("hurst")),
    Input("anisotropy", "anisotropy", (1.0, 3.0), _surface("anisotropy")),
    Input("B", "B of Swift's law [MPa]", (1280e6, 1780e6), with_constant, 1e-6),
    Input("depth", "depth of the layer [µm]", (0.3e-6, 1e-6), _layer_depth, 1e6),
    Input("deviation", "deviation of the layer, factor", (0.8, 1.4), _deviation),
    Input("hardening", "hardening α of the layer", (1e1, 1e6), _layer_alpha, logarithmic=True),
    Input(
        "limit",
        "strain limit of the bulk [%]",
        (0.001, 0.004),
        lambda scene, value: with_keys(scene, "wear", strain_limit=value),
        1e2,
        logarithmic=True,
    ),
    Input("layer-limit", "strain limit of the layer [%]", (0.01, 0.05), _layer_limit, 1e2, logarithmic=True),
    Input("growth", "growth of the film [nm/√s]", (1.8e-9, 7.3e-9), _friction("growth_coefficient"), 1e9),
    Input("film-yield", "yield stress of the film [GPa]", (0.55e9, 0.8e9), _friction("film_yield"), 1e-9),
    Input("high", "friction of the failed film", (0.2, 0.4), _friction("high")),
    Input(
        "load",
        "load [N]",
        (0.3, 1.2),
        lambda scene, value: with_loading(scene, force=value * scene.loading.force / 0.6),
        logarithmic=True,
    ),
    Input("counter", "roughness of the counter-surface [nm rms]", (0.0, 30e-9), _counter_roughness, 1e9),
    Input(
        "window",
        "window of smoothing [cells]",
        (0.0, 9.0),
        lambda scene, value: with_keys(scene, "wear", smoothing_window=value),
        levels=(0, 3, 5, 7, 9),
    ),
)
"""In the order in which they are put into a scene: a law of the layer takes the constants of the body."""


def scene_at(scene: Scene, shares: Sequence[float], surface: int) -> Scene:
    """The scene of a material with every input at its share, on a surface of its own."""
    scene = with_seed(scene, surface)
    for each, share in zip(INPUTS, shares, strict=True):
        scene = each.put(scene, each.value(float(share)))
    while (
        scene.loading.force * (64e-6 / scene.grid.extent[0]) ** 2 > 0.7
        and scene.grid.depths[-1] < DEEPER[0][1]
    ):
        scene = deeper(scene)
    return scene


def wilson(held: int, of: int, level: float = 0.9) -> tuple[float, float]:
    """Bounds of a probability of which `held` of `of` draws are known: Wilson (1927)."""
    if not of:
        return 0.0, 1.0
    found = binomtest(held, of).proportion_ci(level, method="wilson")
    return float(found.low), float(found.high)
