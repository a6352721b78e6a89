# SPDX-License-Identifier: MIT
"""The bodies of a contact in the units of a model."""

from __future__ import annotations

from dataclasses import dataclass, replace

from sam.scene.yield_curve import Kinks, Strength

EVEN = Kinks()
"""Those of a body whose yield stress does not depend on depth."""


@dataclass(frozen=True)
class Elastic:
    """Constants of an isotropic elastic body.

    Attributes
    ----------
    young : float
        Young's modulus in any unit of stress.
    poisson : float
        Poisson's ratio, 0 <= poisson < 0.5.
    """

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
        return self.strength is not None or self.coating_yields

    @property
    def kinks(self) -> Kinks:
        """Depths in m at which the yield stress has a kink or a jump."""
        return EVEN if self.strength is None else self.strength.kinks

    @property
    def coating_yields(self) -> bool:
        """Whether there is a coating with a yield stress."""
        return self.coating is not None and self.coating_yield is not None

    def without_coating(self) -> Bodies:
        """The same with the material of the half-space in place of its coating."""
        return replace(self, coating=None)
