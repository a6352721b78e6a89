# SPDX-License-Identifier: MIT
"""Units of a scene from Hertz's formulas, and estimates of its contact: they set meshes and starting sets,
never a result.

What takes a scene here is part of the planners.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from fem_reference.common.arrays import Array
from sam.scene import CounterBody, Scene
from sam.scene.section import stated

ROUNDED = "rounded-punch"
HALVINGS = 60
"""Of the range of the angle of a rounded edge: to the last digit."""
PUNCHES = ("punch", ROUNDED)
"""Shapes whose contact with a flat end has the units of a flat-ended cylinder."""
DECAY = 1.7
"""A coating's share in the compliance is 1 - exp(-DECAY h/a), within 0.07 for moduli 0.4 to 2."""
UNLOADED_RADIUS = 0.01
"""Reference length over radius of curvature when there is no force, and therefore no contact radius."""


@dataclass(frozen=True)
class Scales:
    """Units in which a contact problem is the same, to the last digit, whatever the units of the scene.

    length (m): contact radius (Hertz's of a sphere, punches), half-width (cylinder), radius (misfit sphere);
    displacement (m); modulus (Pa): contact modulus E*. peak_force: in these units, 4/3 (sphere), pi/4 times
    the length in half-widths (cylinder), 2 (punches), 1 (misfit sphere, whose share of the full strain takes
    the place of the force) or 0.
    """

    length: float
    displacement: float
    modulus: float
    peak_force: float

    @property
    def strain(self) -> float:
        """Unit of strain."""
        return self.displacement / self.length

    @property
    def pressure(self) -> float:
        """Unit of stress in Pa."""
        return self.modulus * self.displacement / self.length

    @property
    def force(self) -> float:
        """Force at the peak in N."""
        return self.peak_force * self.pressure * self.length**2


def relative_moduli(scene: Scene) -> tuple[float, ...]:
    """E1/E* (and E2/E* of an elastic counter-body), from Poisson's ratios and E1/E2 alone.

    1/E* = (1 - nu1^2)/E1 + (1 - nu2^2)/E2 (Johnson, Contact Mechanics, 1985, Eq. 4.24), without the second
    term for a rigid counter-body.
    """
    body, counter = scene.body, scene.counterbody
    if counter is None or not counter.elastic:
        return (1.0 - body.poisson**2,)
    ratio = body.young / stated(counter.young)
    first = 1.0 - body.poisson**2 + (1.0 - stated(counter.poisson) ** 2) * ratio
    return first, first / ratio


def contact_modulus(scene: Scene) -> float:
    """E* in Pa, see `relative_moduli`."""
    return scene.body.young / relative_moduli(scene)[0]


def contact_radius(force: float, modulus: float, radius: float) -> float:
    """a = (3 F R / (4 E*))^(1/3), Johnson 1985, Eq. (4.22)."""
    return float((3.0 * force * radius / (4.0 * modulus)) ** (1.0 / 3.0))


def scales(scene: Scene) -> Scales:
    """Units for a sphere (a, a^2/R) or a punch (a, F/(2 E* a), Johnson 1985, Eq. 3.36), at the peak force.

    For a cylinder (a, a^2/R) with the half-width a = (4 F R/(pi length E*))^(1/2) (Eq. 4.43). For an
    ellipsoid R^2 = Rx Ry; for a given pressure of Hertz its own radius a, and pi a p0/(2 E*) (Eq. 3.42); for
    a misfit sphere its radius, and that times the strain at its centre. Without force both are arbitrary, as
    nothing is deformed: see UNLOADED_RADIUS.
    """
    loading, modulus = scene.loading, contact_modulus(scene)
    if loading.misfit_sphere:
        radius = stated(loading.radius)
        return Scales(radius, stated(loading.misfit) * radius, modulus, 1.0)
    if loading.prescribed is not None:
        radius = stated(loading.radius)
        return Scales(radius, np.pi * radius * stated(loading.p0) / (2.0 * modulus), modulus, 4.0 / 3.0)
    force, counter = peak_force(scene), stated(scene.counterbody)
    radius = equivalent_radius(counter)
    if counter.shape in PUNCHES:
        if counter.shape == ROUNDED:
            radius = _radius(counter, lambda a, t: force_at(counter, a, t) < force / modulus)
        displacement = force / (2.0 * modulus * radius) if force > 0.0 else radius
        return Scales(radius, displacement, modulus, 2.0 if force > 0.0 else 0.0)
    if counter.length is not None:
        length = np.sqrt(4.0 / np.pi * force / counter.length * radius / modulus) or UNLOADED_RADIUS * radius
        share = length / counter.length  # of the force, on a length of one half-width
        return Scales(length, length**2 / radius, modulus, np.pi / 4.0 / share if force > 0.0 else 0.0)
    length = contact_radius(force, modulus, radius) if force > 0.0 else UNLOADED_RADIUS * radius
    return Scales(length, length**2 / radius, modulus, 4.0 / 3.0 if force > 0.0 else 0.0)


def equivalent_radius(counter: CounterBody) -> float:
    """Radius of a sphere, a punch or a rounded edge; of an ellipsoid the geometric mean."""
    radii = counter.radii
    return stated(counter.radius) if radii is None else float(np.sqrt(radii[0] * radii[1]))


def peak_force(scene: Scene) -> float:
    """Normal force at the peak in N, 2/3 pi a^2 p0 of Hertz (Johnson 1985, Eq. 3.40), or an
    estimate.
    """
    loading = scene.loading
    if loading.approach is not None:
        return force_of_approach(scene, loading.approach)
    if loading.misfit_sphere:
        return 0.0
    if loading.prescribed is None:
        return stated(loading.force)
    return 2.0 / 3.0 * np.pi * stated(loading.radius) ** 2 * stated(loading.p0)


def force_of_approach(scene: Scene, approach: float) -> float:
    """Estimate of the force in N at an approach in m: of Hertz, with the share of the coating as in
    `fem_reference.common.bodies`; of a body that yields at most 3 yield stresses on a^2 = 2 R approach.

    The yield stress is that at Tabor's representative strain 0.2 a/R.
    """
    modulus, counter = contact_modulus(scene), stated(scene.counterbody)
    radius = equivalent_radius(counter)
    if counter.shape == "punch":
        return 2.0 * modulus * radius * approach
    if counter.shape == ROUNDED:
        return force_of_rounded(scene, counter, approach)
    a, coating, plasticity = np.sqrt(radius * approach), scene.body.coating, scene.body.plasticity
    compliance = 1.0 / modulus
    if coating is not None:
        other = (1.0 - coating.poisson**2) / coating.young
        other -= (1.0 - scene.body.poisson**2) / scene.body.young
        compliance -= other * np.expm1(-DECAY * coating.thickness / a)
    force = 4.0 / 3.0 * a * approach / compliance
    if plasticity is None:
        return float(force)
    strength = plasticity.strength().least(0.2 * np.sqrt(2.0) * a / radius)
    return float(min(force, 3.0 * strength * 2.0 * np.pi * a**2))


def force_of_rounded(scene: Scene, counter: CounterBody, approach: float) -> float:
    """The same of a punch with a rounded edge at an approach a b (tan t - t)/R, at most 3 yield stresses on
    its part below the surface.
    """
    flat, radius = stated(counter.flat_radius), stated(counter.radius)
    a = _radius(counter, lambda a, t: a * flat * (np.tan(t) - t) / radius < approach)
    force = contact_modulus(scene) * force_at(counter, a)
    if scene.body.plasticity is None:
        return force
    beyond = np.sqrt(2.0 * radius * approach)
    strength = scene.body.plasticity.strength().least(0.2 * beyond / radius)
    return float(min(force, 3.0 * strength * np.pi * (flat + beyond) ** 2))


def kinks_of(scene: Scene, units: Scales) -> Array:
    """Depths in the units of a model at which the yield stress has a kink or a jump."""
    plasticity = scene.body.plasticity
    return np.array(() if plasticity is None else plasticity.strength().kinks.depths) / units.length


def hertz_pressure(r: Array) -> Array:
    """3/(2 pi) sqrt(1 - r^2), zero outside r = 1: Johnson 1985, Eq. (3.39), for unit force and radius."""
    return 1.5 / np.pi * np.sqrt(np.clip(1.0 - r**2, 0.0, None))


def largest_mises(poisson: float) -> float:
    """Largest |s_rr - s_zz| below a sphere over p0, on the axis: Johnson 1985, Eq. (3.45)."""
    z = np.linspace(0.0, 2.0, 2001)
    return float(np.abs(-(1.0 + poisson) * (1.0 - z * np.arctan2(1.0, z)) + 1.5 / (1.0 + z**2)).max())


def plastic_radius(scene: Scene) -> float | None:
    """Estimate of the contact radius of a sphere, or an ellipsoid, on a plastic body over that of Hertz, 1 or
    more (1 of a given pressure); None if nothing yields.

    Mean pressure of Johnson's expanding cavity (1985, Sec. 6.3), at most 3 Y, with the yield stress Y at
    Tabor's representative strain 0.2 a/R: p/Y = 2/3 (2 + ln((E* a/(Y R) + 4 (1 - 2 nu))/(6 (1 - nu)))).
    """
    body, unit = scene.body, scales(scene)
    if body.plasticity is None or unit.peak_force == 0.0:
        return None
    yield_stress = body.plasticity.strength()
    peak = 1.5 * unit.peak_force / np.pi * unit.pressure
    if largest_mises(body.poisson) * peak <= yield_stress.least(0.0):
        return None
    if scene.counterbody is None:
        return 1.0
    rounded = scene.counterbody.shape == ROUNDED  # its edge alone is steep
    slope = unit.strain if rounded else unit.length / equivalent_radius(scene.counterbody)
    strength = yield_stress.least(0.2 * slope)
    ratio = (unit.modulus * slope / strength + 4.0 * (1.0 - 2.0 * body.poisson)) / (
        6.0 * (1.0 - body.poisson)
    )
    mean = strength * min(3.0, 2.0 / 3.0 * (2.0 + np.log(max(ratio, 1.0))))
    return float(max(1.0, np.sqrt(2.0 / 3.0 * peak / mean)))


def force_at(counter: CounterBody, a: float, t: float | None = None) -> float:
    """Force in N over E* at a contact radius in m, a^3/R [4/3 sin^3 t - cos t (t - sin t cos t)], cos t =
    b/a; t: its angle.
    """
    flat, radius = stated(counter.flat_radius), stated(counter.radius)
    angle = np.arccos(min(1.0, flat / a)) if t is None else t
    beyond = angle - np.sin(angle) * np.cos(angle)
    return float(a**3 / radius * (4.0 / 3.0 * np.sin(angle) ** 3 - np.cos(angle) * beyond))


def _radius(counter: CounterBody, smaller: Callable[[float, float], bool]) -> float:
    """The radius b/cos t at which something that grows with it is no longer smaller than wanted."""
    flat, low, high = stated(counter.flat_radius), 0.0, 0.5 * np.pi
    for _ in range(HALVINGS):
        t = 0.5 * (low + high)
        low, high = (t, high) if smaller(flat / np.cos(t), t) else (low, t)
    return float(flat / np.cos(low))
