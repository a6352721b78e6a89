# SPDX-License-Identifier: MIT
"""The bodies of a contact in the units of a model, and estimates of the contact of a coated one, which set
meshes, never a result.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fem_reference.common.hertz import DECAY, Scales, largest_mises, relative_moduli, scales
from sam.scene.schema import Scene
from sam.scene.yield_curve import Kinks, Strength

EVEN = Kinks()
"""Those of a body whose yield stress does not depend on depth."""


@dataclass(frozen=True)
class Elastic:
    """Constants of an isotropic elastic body: Young's modulus in any unit of stress, 0 <= poisson < 0.5."""

    young: float
    poisson: float


@dataclass(frozen=True)
class Coating:
    """An elastic layer 0 <= z < thickness, bonded to a body of other constants; in consistent units."""

    thickness: float
    young: float
    poisson: float


@dataclass(frozen=True)
class Bodies:
    """The half-space of a scene, and its counter-body if that is elastic.

    elastic: their constants in the units of the model, the half-space first; coating: of the half-space;
    strength: yield stress of the half-space in SI units, None if it stays elastic; coating_yield: yield
    stress of the coating in Pa, None if that stays elastic.
    """

    elastic: tuple[Elastic, ...]
    coating: Coating | None = None
    strength: Strength | None = None
    coating_yield: float | None = None

    @property
    def yields(self) -> bool:
        """Whether any part of the half-space has a yield stress."""
        return self.strength is not None or (self.coating is not None and self.coating_yield is not None)

    @property
    def kinks(self) -> Kinks:
        """Depths in m at which the yield stress has a kink or a jump."""
        return EVEN if self.strength is None else self.strength.kinks


def coating_of(scene: Scene, units: Scales) -> Coating | None:
    """The coating in the units of the model."""
    coating = scene.body.coating
    if coating is None:
        return None
    return Coating(coating.thickness / units.length, coating.young / units.modulus, coating.poisson)


def expected_radius(scene: Scene) -> float:
    """Estimate of the contact radius of a smooth elastic contact with the coating over that without it
    (Hertz).

    a^3 is as the compliance, that of the coating's material in the share 1 - exp(-DECAY h/a) and of the
    body's in the rest; by bisection between the radii on either material alone. 1 without a coating, for a
    punch and a given pressure.
    """
    units = scales(scene)
    coating = coating_of(scene, units)
    smooth = scene.counterbody is not None and scene.counterbody.shape != "punch"
    if coating is None or not smooth or units.peak_force == 0.0:
        return 1.0
    body = (1.0 - scene.body.poisson**2) / relative_moduli(scene)[0]
    other = (1.0 - coating.poisson**2) / coating.young - body  # compliances over 1/E* of the bare contact
    low, high = sorted((1.0, float(np.cbrt(1.0 + other))))
    for _ in range(50):
        middle = 0.5 * (low + high)
        share = -np.expm1(-DECAY * coating.thickness / middle)
        low, high = (middle, high) if 1.0 + other * share > middle**3 else (low, middle)
    return high


def yielded_radius(scene: Scene) -> float:
    """Estimate of the contact radius over Hertz's when the coating flows at a mean pressure 3 Y."""
    coating, units = scene.body.coating, scales(scene)
    if (
        coating is None
        or coating.yield_stress is None
        or scene.counterbody is None
        or units.peak_force == 0.0
    ):
        return 1.0
    peak = 1.5 * units.peak_force / np.pi * units.pressure
    if largest_mises(coating.poisson) * peak <= coating.yield_stress:
        return 1.0
    flowing = max(1.0, float(np.sqrt(2.0 / 9.0 * peak / coating.yield_stress)))
    return 1.0 - (flowing - 1.0) * float(np.expm1(-DECAY * coating.thickness / units.length))
