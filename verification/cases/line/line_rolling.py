# SPDX-License-Identifier: MIT
"""A rigid cylinder that rolls over a body again and again, on either side of its shakedown limit."""

import numpy as np

from sam.scene import Plasticity, Result, Scene
from verification.cases.case import with_body
from verification.cases.recipes import initial_yield, on_track
from verification.quantities import Reference, contact_of, of_passes
from verification.reference.merwin_johnson import plastic_shear

DEPTHS = np.linspace(0.3, 1.2, 46)
"""In half-widths, of the analysis by Merwin & Johnson: the largest shear is half a half-width deep."""


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


def over_analysis(scene: Scene, result: Result, reference: Reference | None) -> float:
    """`sheared` over what the analysis by Merwin & Johnson has for the same pass."""
    over_shear = np.sqrt(3.0) * contact_of(scene).peak_pressure / initial_yield(scene)
    _, ways = plastic_shear(over_shear, DEPTHS, nu=scene.body.poisson, passes=scene.loading.cycles)
    return float(sheared(scene, result, reference) / ways[-1].max())


__all__ = ["over_analysis"]  # named in the case file alone
