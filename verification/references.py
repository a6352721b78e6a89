# SPDX-License-Identifier: MIT
"""The independent answers that a case may name, `reference = "..."`: each a function of the scene, made
of the library in `verification.reference`.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from functools import cache

import numpy as np

from sam.scene import Scene
from verification.quantities import Reference
from verification.reference.coated_sphere import CoatedContact, solve_force
from verification.reference.elliptic import EllipticContact
from verification.reference.flat_punch import FlatPunch
from verification.reference.hertz import CircularContact, axis_stress, effective_modulus, largest_von_mises
from verification.reference.layered_axisymmetric import CoatedHalfSpace
from verification.reference.stress import von_mises


def modulus_of(scene: Scene) -> float:
    """The contact modulus E* in Pa: 1/E* = (1 - nu_1^2)/E_1 + (1 - nu_2^2)/E_2."""
    body, other = scene.body, scene.counterbody
    return effective_modulus(body.young, body.poisson, other.young, other.poisson)


def contact_of(scene: Scene) -> CircularContact:
    """The elastic contact of a scene with a sphere."""
    return CircularContact(scene.loading.force, scene.counterbody.radius, modulus_of(scene))


def elliptic_contact(scene: Scene) -> EllipticContact:
    """The elastic contact of a scene with a rigid ellipsoid."""
    other = scene.counterbody
    return EllipticContact(scene.loading.force, other.radius_x, other.radius_y, modulus_of(scene))


def hertz_sphere(scene: Scene) -> Reference:
    """Hertz (1882), Huber (1904)."""
    exact, nu = contact_of(scene), scene.body.poisson
    a, p0, delta = exact.contact_radius, exact.peak_pressure, exact.approach
    largest, depth = largest_von_mises(p0, a, nu)
    share = exact.modulus * (1.0 - nu**2) / scene.body.young  # of the body in the displacement of both
    rise = np.cbrt(9.0 / (16.0 * exact.radius * exact.modulus**2))  # delta = rise F^(2/3)

    def stress(z: np.ndarray) -> np.ndarray:
        return axis_stress(np.abs(z), p0, a, nu)

    return Reference(
        {
            "p-max": p0,
            "approach": delta,
            "load": exact.force,
            "radius": a,
            "mises-max": largest,
            "mises-depth": depth,
            "pressure": lambda x, y: exact.pressure(np.hypot(x, y)),
            "mises-axis": lambda z: von_mises(stress(z)),
        },
        {"a": a, "p0": p0, "approach": delta},
        {
            ("line", "p_Pa"): lambda x: exact.pressure(np.abs(x)),
            ("line", "gap_m"): lambda x: exact.gap(np.abs(x)),
            ("line", "uz_m"): lambda x: share * exact.displacement(np.abs(x)),
            ("axis", "szz_Pa"): lambda z: stress(z)[..., 2],
            ("axis", "sxx_Pa"): lambda z: stress(z)[..., 0],
            ("axis", "mises_Pa"): lambda z: von_mises(stress(z)),
            ("history", "approach_m"): lambda force: rise * force ** (2.0 / 3.0),
        },
        deepest=2.0 * a,
        facts=(("Contact radius a, peak pressure p₀", f"{a * 1e6:.4f} µm, {p0 / 1e9:.4f} GPa"),),
    )


def hertz_ellipse(scene: Scene) -> Reference:
    """Hertz (1882) in Carlson's integrals."""
    exact, nu = elliptic_contact(scene), scene.body.poisson
    largest, depth = exact.largest_axis_von_mises(nu)
    (a, b), p0 = exact.semi_axes, exact.peak_pressure

    def mises(z: np.ndarray) -> np.ndarray:
        return von_mises(exact.axis_stress(z, nu))

    size = f"{a * 1e6:.4f} µm, {b * 1e6:.4f} µm"
    return Reference(
        {
            "p-max": p0,
            "approach": exact.approach,
            "load": exact.force,
            "mises-max": largest,
            "mises-depth": depth,
            "pressure": exact.pressure,
            "mises-axis": mises,
        },
        {"a": a, "b": b, "p0": p0, "approach": exact.approach},
        {("axis", "mises_Pa"): mises},
        deepest=2.0 * min(a, b),
        facts=(("Semi-axes a (along x), b (along y)", size), ("Peak pressure p₀", f"{p0 / 1e9:.4f} GPa")),
    )


def flat_punch(scene: Scene) -> Reference:
    """Boussinesq (1885), Sneddon (1946); the pressure to 0.8 a, as it is unbounded at the edge."""
    exact, nu = (
        FlatPunch(scene.loading.force, scene.counterbody.radius, modulus_of(scene)),
        scene.body.poisson,
    )
    a, centre = exact.contact_radius, float(exact.pressure(0.0))

    def mises(z: np.ndarray) -> np.ndarray:
        return von_mises(exact.axis_stress(z, nu))

    return Reference(
        {
            "approach": exact.approach,
            "p-center": centre,
            "pressure": lambda x, y: exact.pressure(np.hypot(x, y)),
            "mises-axis": mises,
        },
        {"a": a, "p0": centre, "approach": exact.approach},
        {
            ("line", "p_Pa"): lambda x: exact.pressure(np.abs(x)),
            ("line", "uz_m"): lambda x: exact.displacement(np.abs(x)),
            ("axis", "mises_Pa"): mises,
        },
        deepest=2.0 * a,
        inside=0.8 * a,
        facts=(
            ("Approach δ, pressure in the centre", f"{exact.approach * 1e6:.5f} µm, {centre / 1e9:.4f} GPa"),
        ),
    )


@cache
def _coated_contact(layers: CoatedHalfSpace, radius: float, force: float, counter: float) -> CoatedContact:
    return solve_force(layers, radius, force, counter)


def coated_contact(scene: Scene) -> CoatedContact:
    """The elastic contact of a scene with a sphere and a coating, by a spectral solution."""
    body, film, other = scene.body, scene.body.coating, scene.counterbody
    layers = CoatedHalfSpace(film.young, film.poisson, film.thickness, body.young, body.poisson)
    counter = other.young / (1.0 - other.poisson**2) if other.elastic else math.inf
    return _coated_contact(layers, other.radius, scene.loading.force, counter)


def coated_sphere(scene: Scene) -> Reference:
    """A spectral solution of the contact on a coated half-space."""
    exact = coated_contact(scene)
    a, p0 = exact.contact_radius, exact.central_pressure
    return Reference(
        {
            "p-center": p0,
            "approach": exact.approach,
            "radius": a,
            "pressure": lambda x, y: exact.pressure(np.hypot(x, y)),
        },
        {"a": a, "p0": p0, "approach": exact.approach},
    )


REFERENCES: Mapping[str, Callable[[Scene], Reference]] = {
    "hertz-sphere": hertz_sphere,
    "hertz-ellipse": hertz_ellipse,
    "flat-punch": flat_punch,
    "coated-sphere": coated_sphere,
}
"""Name in a case file -> the answer for a scene."""
