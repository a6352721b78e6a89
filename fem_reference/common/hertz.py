# SPDX-License-Identifier: MIT
"""Scales of a contact from Hertz's formulas: they set units, mesh size and starting set, never a result."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sam.scene.schema import Scene

UNLOADED_RADIUS = 0.01
"""Reference length over radius of curvature when there is no force, and therefore no contact radius."""


@dataclass(frozen=True)
class Scales:
    """Units in which a contact problem is the same, to the last digit, whatever the units of the scene.

    length (m): contact radius of Hertz (sphere), radius (punch); displacement (m); modulus (Pa): contact modulus E*.
    In these units: peak_force, 4/3 (sphere), 2 (punch) or 0; young: Young's modulus of each deformable body.
    """

    length: float
    displacement: float
    modulus: float
    peak_force: float
    young: tuple[float, ...]

    @property
    def pressure(self) -> float:
        """Unit of stress in Pa."""
        return self.modulus * self.displacement / self.length


def relative_moduli(scene: Scene) -> tuple[float, ...]:
    """E1/E* (and E2/E* of an elastic counter-body), from Poisson's ratios and E1/E2 alone.

    1/E* = (1 - nu1^2)/E1 + (1 - nu2^2)/E2 (Johnson, Contact Mechanics, 1985, Eq. 4.24), without the second term for a
    rigid counter-body.
    """
    body, counter = scene.body, scene.counterbody
    if counter is None or not counter.elastic:
        return (1.0 - body.poisson**2,)
    ratio = body.young / counter.young
    first = 1.0 - body.poisson**2 + (1.0 - counter.poisson**2) * ratio
    return first, first / ratio


def contact_radius(force: float, modulus: float, radius: float) -> float:
    """a = (3 F R / (4 E*))^(1/3), Johnson 1985, Eq. (4.22)."""
    return (3.0 * force * radius / (4.0 * modulus)) ** (1.0 / 3.0)


def scales(scene: Scene) -> Scales:
    """Units for a sphere (a, a^2/R) or a punch (R, F/(2 E* R), Johnson 1985, Eq. 3.36), at the peak force.

    For an ellipsoid R^2 = Rx Ry; for a given pressure of Hertz its own radius a, and pi a p0/(2 E*) (Eq. 3.42).
    Without force both are arbitrary, as nothing is deformed: see UNLOADED_RADIUS.
    """
    young, loading = relative_moduli(scene), scene.loading
    modulus, force = scene.body.young / young[0], loading.force
    if loading.prescribed is not None:
        return Scales(
            loading.radius, np.pi * loading.radius * loading.p0 / (2.0 * modulus), modulus, 4.0 / 3.0, young
        )
    radius = equivalent_radius(scene)
    if scene.counterbody.shape == "punch":
        displacement = force / (2.0 * modulus * radius) if force > 0.0 else radius
        return Scales(radius, displacement, modulus, 2.0 if force > 0.0 else 0.0, young)
    length = contact_radius(force, modulus, radius) if force > 0.0 else UNLOADED_RADIUS * radius
    return Scales(length, length**2 / radius, modulus, 4.0 / 3.0 if force > 0.0 else 0.0, young)


def equivalent_radius(scene: Scene) -> float:
    """Radius of the sphere, or geometric mean of those of the ellipsoid; of a punch, that of its end."""
    counter = scene.counterbody
    return (
        float(np.sqrt(counter.radius_x * counter.radius_y))
        if counter.shape == "ellipsoid"
        else counter.radius
    )


def peak_force(scene: Scene) -> float:
    """Normal force at the peak in N; of a given pressure 2/3 pi a^2 p0 (Johnson 1985, Eq. 3.40)."""
    loading = scene.loading
    return loading.force if loading.prescribed is None else 2.0 / 3.0 * np.pi * loading.radius**2 * loading.p0


def hertz_pressure(r: np.ndarray) -> np.ndarray:
    """3/(2 pi) sqrt(1 - r^2), zero outside r = 1: Johnson 1985, Eq. (3.39), for unit force and radius."""
    return 1.5 / np.pi * np.sqrt(np.clip(1.0 - r**2, 0.0, None))


def largest_mises(poisson: float) -> float:
    """Largest von Mises stress under a sphere over p0: on the axis, |s_rr - s_zz| of Johnson 1985, Eq. (3.45)."""
    z = np.linspace(0.0, 2.0, 2001)
    return float(np.abs(-(1.0 + poisson) * (1.0 - z * np.arctan2(1.0, z)) + 1.5 / (1.0 + z**2)).max())


def plastic_radius(scene: Scene) -> float | None:
    """Estimate of the contact radius of a sphere over that of Hertz, never below it; None if nothing yields.

    A given pressure keeps its radius.

    Mean pressure of Johnson's expanding cavity (1985, Sec. 6.3), at most 3 Y, with the yield stress Y at Tabor's
    representative strain 0.2 a/R: p/Y = 2/3 (2 + ln((E* a/(Y R) + 4 (1 - 2 nu))/(6 (1 - nu)))).
    """
    body, unit = scene.body, scales(scene)
    if body.plasticity is None or unit.peak_force == 0.0:
        return None
    curve, factor = body.plasticity.curve(), min(body.plasticity.depth_profile().factor)
    peak = 1.5 * unit.peak_force / np.pi * unit.pressure
    if largest_mises(body.poisson) * peak <= factor * curve.stress(0.0):
        return None
    if scene.counterbody is None:
        return 1.0
    slope = unit.length / equivalent_radius(scene)
    strength = factor * float(curve.stress(0.2 * slope))
    ratio = (unit.modulus * slope / strength + 4.0 * (1.0 - 2.0 * body.poisson)) / (
        6.0 * (1.0 - body.poisson)
    )
    mean = strength * min(3.0, 2.0 / 3.0 * (2.0 + np.log(max(ratio, 1.0))))
    return float(max(1.0, np.sqrt(2.0 / 3.0 * peak / mean)))
