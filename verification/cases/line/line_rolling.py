# SPDX-License-Identifier: MIT
"""A rigid cylinder that rolls over a body again and again, on either side of its shakedown limit."""

from __future__ import annotations

import numpy as np

from sam.scene import Plasticity, Result, Scene
from verification.cases.case import with_body
from verification.cases.recipes import initial_yield, on_track
from verification.quantities import Reference, of_passes


def rolls(scene: Scene, keys: dict[str, float]) -> Scene:
    """Passes over a track, see `on_track`; over_shear: p0 over the shear yield stress."""
    scene = on_track(scene, {**keys, "ratio": keys["over_shear"] / np.sqrt(3.0)})
    return scene.model_copy(update={"fem": scene.fem.model_copy(update={"cells_per_radius": keys["cells"]})})


def perfect(scene: Scene, _: bool) -> Scene:
    """The body without its back-stress."""
    return with_body(scene, plasticity=Plasticity(law="perfect", yield_stress=initial_yield(scene)))


def dissipates(scene: Scene, result: Result, _: Reference | None) -> float:
    """Energy that the last pass dissipates over that of the first."""
    energy = of_passes(result, "energy")
    return float(energy[-1] / energy[0])


def sheared(scene: Scene, result: Result, _: Reference | None) -> float:
    """Largest plastic strain that the last pass adds in the steady part, times sqrt(3) G/k: of shear alone
    its plastic shear over the yield strain in shear k/G.
    """
    body = scene.body
    shear = body.young / (2.0 * (1.0 + body.poisson))
    yields = initial_yield(scene) / np.sqrt(3.0) / shear
    return float(np.sqrt(3.0) * of_passes(result, "strain")[-1] / yields)
