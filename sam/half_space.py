# SPDX-License-Identifier: MIT
"""Elastic constants of a half-space and of two in contact, and the contact radius of Hertz. A leaf: it
imports nothing of sam.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import pi, sqrt


@dataclass(frozen=True)
class ElasticConstants:
    """An isotropic elastic body: Young's modulus in Pa and Poisson's ratio.

    >>> round(ElasticConstants(210e9, 0.3).shear / 1e9, 1)
    80.8
    """

    young: float
    poisson: float

    @property
    def shear(self) -> float:
        """Shear modulus mu = E/(2 (1 + nu)) in Pa."""
        return self.young / (2 * (1 + self.poisson))

    @property
    def compliance(self) -> float:
        """(1 - nu^2)/E in 1/Pa, with which a pressure moves the surface normally."""
        return (1 - self.poisson**2) / self.young

    @property
    def tangential_compliance(self) -> float:
        """(1 - 2 nu)/mu in 1/Pa, with which a traction moves the surface normally (paper: D_31 of Eq. 5)."""
        return (1 - 2 * self.poisson) * 2 * (1 + self.poisson) / self.young


@dataclass(frozen=True)
class ElasticPair:
    """The body, of a coated one the material below the coating, and the counter-body; None if it is rigid, or
    if a scene gives the pressure in place of it.

    >>> steel = ElasticConstants(210e9, 0.3)
    >>> round(ElasticPair(steel).contact_modulus / 1e9, 1)  # on a rigid body: E/(1 - nu^2)
    230.8
    >>> ElasticPair(steel, steel).tangential_mismatch  # like bodies move alike
    0.0
    """

    body: ElasticConstants
    other: ElasticConstants | None = None

    @property
    def contact_modulus(self) -> float:
        """E* in Pa, 1/E* = sum (1 - nu^2)/E (Johnson 1985, Eq. 4.23), in D_33 of paper Eq. 5."""
        compliance = self.body.compliance
        if self.other is not None:
            compliance += self.other.compliance
        return 1 / compliance

    @property
    def share(self) -> float:
        """Share of the body in the normal displacement of both surfaces by a pressure."""
        return self.body.compliance * self.contact_modulus

    @property
    def tangential_mismatch(self) -> float:
        """2 beta of Dundurs (1969), E*/2 [(1 - 2 nu1)/mu1 - (1 - 2 nu2)/mu2]; printed without nu2."""
        compliance = self.body.tangential_compliance
        if self.other is not None:
            compliance -= self.other.tangential_compliance
        return self.contact_modulus / 2 * compliance


def circular_contact_radius(force: float, radius: float, modulus: float) -> float:
    """Contact radius in m of Hertz of a sphere (radius in m), force in N, E* in Pa (Johnson 1985, 4.22)."""
    return float((3 * force * radius / (4 * modulus)) ** (1 / 3))


def equivalent_radius(area: float) -> float:
    """Radius in m of the circle with that area in m^2."""
    return sqrt(area / pi)
