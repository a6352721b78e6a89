# SPDX-License-Identifier: MIT
"""The independent answers that a case may name, each a function of the scene by `verification.reference`."""

import math
from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import cache
from typing import cast

import numpy as np

from sam.scene import Scene
from verification.quantities import Reference, contact_of, modulus_of
from verification.reference.capped import capped_pressure
from verification.reference.coated_changes import (
    film_contact,
    largest_bare_mises,
    largest_mises,
    mises_change,
    pressure_change,
)
from verification.reference.coated_sphere import CoatedContact, solve_force
from verification.reference.coated_traction import (
    coated_sliding_stress,
    largest_von_mises as coated_traction_mises,
)
from verification.reference.elliptic import EllipticContact
from verification.reference.flat_punch import FlatPunch
from verification.reference.hamilton import sliding_stress
from verification.reference.hertz import CircularContact, axis_stress, largest_von_mises
from verification.reference.hertz_line import LineContact
from verification.reference.layered_axisymmetric import CoatedHalfSpace
from verification.reference.misfit_sphere import GrowingSphere
from verification.reference.rounded_punch import RoundedPunch
from verification.reference.shakedown import upper_bound
from verification.reference.stress import von_mises
from verification.reference.westergaard import DoublyWavyContact, WavyContact


def elliptic_contact(scene: Scene) -> EllipticContact:
    """The elastic contact of a scene with a rigid ellipsoid."""
    other = scene.counterbody
    return EllipticContact(scene.loading.force, other.radius_x, other.radius_y, modulus_of(scene))


def _pressed(
    exact: CircularContact | FlatPunch | RoundedPunch | LineContact,
    stress: Callable[[np.ndarray], np.ndarray],
    values: Mapping[str, float],
    *,
    p0: float,
    inside: float = np.inf,
    share: float = 1.0,
) -> Reference:
    """What round and line contacts share; stress: (..., 6) on the axis; share: of uz in one body."""
    a = exact.contact_radius
    known = {
        "approach": exact.approach,
        "pressure": lambda x, y: exact.pressure(np.hypot(x, y)),
        "mises-axis": lambda z: von_mises(stress(z)),
        **values,
    }
    curves = {
        ("line", "p_Pa"): lambda x: exact.pressure(np.abs(x)),
        ("line", "uz_m"): lambda x: share * exact.displacement(np.abs(x)),
        ("axis", "szz_Pa"): lambda z: stress(z)[..., 2],
        ("axis", "sxx_Pa"): lambda z: stress(z)[..., 0],
        ("axis", "mises_Pa"): lambda z: von_mises(stress(z)),
    }
    return Reference(known, {"a": a, "p0": p0, "approach": exact.approach}, curves, 2.0 * a, inside)


def hertz_sphere(scene: Scene) -> Reference:
    """Hertz (1882), Huber (1904)."""
    exact, nu = cast(CircularContact, contact_of(scene)), scene.body.poisson
    a, p0 = exact.contact_radius, exact.peak_pressure
    largest, depth = largest_von_mises(p0, a, nu)
    share = exact.modulus * (1.0 - nu**2) / scene.body.young
    values = {
        "p-max": p0,
        "load": exact.force,
        "radius": a,
        "area": math.pi * a**2,
        "mises-max": largest,
        "mises-depth": depth,
        "peeq-max": 0.0,
    }
    found = _pressed(exact, lambda z: axis_stress(np.abs(z), p0, a, nu), values, p0=p0, share=share)
    return replace(found, curves={**found.curves, ("line", "gap_m"): lambda x: exact.gap(np.abs(x))})


def hertz_line(scene: Scene) -> Reference:
    """Hertz's line contact with the stresses of McEwen (1949); friction: that of full slip."""
    exact, nu = cast(LineContact, contact_of(scene)), scene.body.poisson
    a, p0, friction = exact.contact_radius, exact.peak_pressure, scene.coefficient
    largest, depth = exact.largest_von_mises(nu)

    def axis(z: np.ndarray) -> np.ndarray:
        return exact.stress(0.0, z, nu, friction=friction)

    values = {
        "p-max": p0,
        "half-width": a,
        "mises-max": largest,
        "mises-depth": depth,
        "stress": lambda x, _, z: exact.stress(x, z, nu, friction=friction) / p0,
        "pressure": lambda x, _: exact.pressure(x),
    }
    share = exact.modulus * (1.0 - nu**2) / scene.body.young
    found = _pressed(exact, axis, values, p0=p0, share=share)
    return replace(found, curves={**found.curves, ("line", "gap_m"): exact.gap})


def hertz_ellipse(scene: Scene) -> Reference:
    """Hertz (1882) in Carlson's integrals."""
    exact, nu = elliptic_contact(scene), scene.body.poisson
    largest, depth = exact.largest_axis_von_mises(nu)
    (a, b), p0 = exact.semi_axes, exact.peak_pressure

    def mises(z: np.ndarray) -> np.ndarray:
        return von_mises(exact.axis_stress(z, nu))

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
        {("line", "p_Pa"): lambda x: exact.pressure(x, 0.0), ("axis", "mises_Pa"): mises},
        deepest=2.0 * min(a, b),
    )


def flat_punch(scene: Scene) -> Reference:
    """Boussinesq (1885), Sneddon (1946); the pressure to 0.8 a, as it is unbounded at the edge."""
    exact = FlatPunch(scene.loading.force, scene.counterbody.radius, modulus_of(scene))
    nu = scene.body.poisson
    centre, inside = float(exact.pressure(0.0)), 0.8 * exact.contact_radius
    return _pressed(exact, lambda z: exact.axis_stress(z, nu), {"p-center": centre}, p0=centre, inside=inside)


def rounded_contact(scene: Scene) -> RoundedPunch:
    """The elastic contact of a scene with a punch with a rounded edge."""
    other = scene.counterbody
    return RoundedPunch(scene.loading.force, other.flat_radius, other.radius, modulus_of(scene))


def rounded_punch(scene: Scene) -> Reference:
    """Ciavarella, Hills & Monno (1998); the largest pressure on 4001 places in the edge, within 1e-6; the
    pressure to the flat end, beyond which it is steeper than any power.
    """
    exact, nu = rounded_contact(scene), scene.body.poisson
    a, b, centre = exact.contact_radius, exact.flat, float(exact.pressure(0.0))
    largest = float(exact.pressure(np.linspace(b, a, 4001)).max())
    values = {"radius": a, "p-center": centre, "p-max": largest}
    return _pressed(exact, lambda z: exact.axis_stress(z, nu), values, p0=centre, inside=b)


@cache
def _coated_contact(layers: CoatedHalfSpace, radius: float, force: float, counter: float) -> CoatedContact:
    return solve_force(layers, radius, force, counter)


def layers_of(scene: Scene) -> CoatedHalfSpace:
    """The body with its coating."""
    film, body = scene.body.coating, scene.body
    return CoatedHalfSpace(film.young, film.poisson, film.thickness, body.young, body.poisson)


def _counter_modulus(scene: Scene) -> float:
    """E/(1 - nu^2) of the counter-body in Pa, infinite if rigid."""
    other = scene.counterbody
    return other.young / (1.0 - other.poisson**2) if other.elastic else math.inf


def coated_contact(scene: Scene) -> CoatedContact:
    """The elastic contact of a scene with a sphere and a coating, by a spectral solution."""
    radius, force = scene.counterbody.radius, scene.loading.force
    return _coated_contact(layers_of(scene), radius, force, _counter_modulus(scene))


def coated_sphere(scene: Scene) -> Reference:
    """A spectral solution on a coated half-space; film and body apart, the body also without film."""
    exact = coated_contact(scene)
    a, p0, body = exact.contact_radius, exact.central_pressure, largest_mises(exact).value

    @cache
    def stress(depths: tuple[float, ...]) -> np.ndarray:
        return exact.stress(0.0, np.array(depths))[0]

    return Reference(
        {
            "p-center": p0,
            "approach": exact.approach,
            "radius": a,
            "pressure": lambda x, y: exact.pressure(np.hypot(x, y)),
            "mises-body": body,
            "mises-film": largest_mises(exact, film=True).value,
            "p-change": pressure_change(exact),
            "mises-change": body / largest_bare_mises(exact).value - 1.0,
            "residual": exact.residual(),
        },
        {"a": a, "p0": p0, "approach": exact.approach},
        {
            ("line", "p_Pa"): lambda x: exact.pressure(np.abs(x)),
            ("axis", "szz_Pa"): lambda z: stress(tuple(z))[..., 2],
            ("axis", "sxx_Pa"): lambda z: stress(tuple(z))[..., 0],
            ("axis", "mises_Pa"): lambda z: von_mises(stress(tuple(z))),
        },
    )


def hamilton(scene: Scene) -> Reference:
    """Hamilton (1983): stresses over p0, (..., 6), under a given Hertz pressure and traction."""
    a, p0 = scene.loading.radius, scene.loading.p0
    unit = {"contact_radius": a, "nu": scene.body.poisson, "friction": scene.coefficient}
    return Reference({"stress": lambda x, y, z: sliding_stress(x, y, z, 1.0, **unit)}, {"a": a, "p0": p0})


def travelling_load(scene: Scene) -> Reference:
    """The shakedown limit below a Hertz pressure that travels."""
    bound = upper_bound(scene.coefficient, nu=scene.body.poisson)
    return Reference({"bound of p0/k": bound}, {"a": scene.loading.radius, "p0": scene.loading.p0})


def coated_traction(scene: Scene) -> Reference:
    """Given Hertz pressure and traction on a coated half-space: Hankel integrals by quadrature."""
    load, layers, h = scene.loading, layers_of(scene), scene.body.coating.thickness
    given = layers, load.p0, load.radius, scene.coefficient
    film, body = (coated_traction_mises(*given, film=side) for side in (True, False))

    def interface(x: np.ndarray) -> np.ndarray:
        return von_mises(coated_sliding_stress(*given, x=x, z=h)[:, 0])

    return Reference(
        {"mises-film": film.value, "mises-body": body.value, "mises-interface": interface},
        {"a": load.radius, "p0": load.p0, "h": h},
    )


def film_changes(scene: Scene) -> Reference:
    """What a film changes, by the spectral solution."""
    elastic, (p, mises) = contact_of(scene), changes_by_film(scene)
    units = {"a": elastic.contact_radius, "p0": elastic.peak_pressure, "approach": elastic.approach}
    return Reference({"p-change": p, "mises-change": mises}, units)


def changes_by_film(scene: Scene) -> tuple[float, float]:
    """What the film changes, as shares without it: largest pressure, and von Mises of the body."""
    body, film = scene.body, scene.body.coating
    counter = _counter_modulus(scene) / (body.young / (1.0 - body.poisson**2))
    thickness = film.thickness / contact_of(scene).contact_radius
    contact = film_contact(thickness, film.young / body.young, film.poisson, body.poisson, counter=counter)
    return pressure_change(contact), mises_change(contact)


def growing_sphere(scene: Scene, shares: tuple[float, ...] = (1.0,)) -> GrowingSphere:
    """The closed form of a held misfit sphere, with at most one back-stress."""
    body, loading, back = scene.body, scene.loading, scene.body.plasticity.kinematic
    law, constants = body.plasticity.curve().stress, (back.modulus[0], back.recovery[0]) if back else ()
    sphere = loading.misfit, loading.radius, loading.profile
    return GrowingSphere(body.young, body.poisson, law, *sphere, shares, *constants)


def _wavy(scene: Scene) -> tuple[float, float, float, float]:
    """Amplitude and wavelength in m, E* and mean pressure in Pa of a wavy patch below a plane."""
    surface, (lx, ly) = scene.surface, scene.patch[1]
    return surface.amplitude, surface.wavelength_x, modulus_of(scene), scene.force / (lx * ly)


def wave(scene: Scene) -> Reference:
    """Westergaard (1939). The largest pressure is that in the centre of the cell next to the crest."""
    exact = WavyContact(*_wavy(scene))
    (nx, _), (lx, _) = scene.patch
    p0, beside = exact.complete_pressure, 0.0 if nx % 2 else 0.5 * lx / nx
    values = {
        "p-max": float(exact.pressure(beside)),
        "approach": exact.approach,
        "strip-width": 2.0 * exact.half_width,
        "pressure": lambda x, y: exact.pressure(x) + 0.0 * y,
    }
    units = {"a": exact.half_width, "p0": p0, "approach": exact.approach, "wave": exact.wavelength}
    return Reference(values, units, {("line", "p_Pa"): exact.pressure, ("line", "gap_m"): exact.gap})


def double_wave(scene: Scene) -> Reference:
    """Johnson, Greenwood & Higginson (1985): both limits, a fit, Fourier series; the peak as of `wave`."""
    exact = DoublyWavyContact(*_wavy(scene))
    (nx, ny), (lx, ly) = scene.patch
    x, y = ((np.arange(n) + 0.5) * side / n - 0.5 * side for n, side in ((nx, lx), (ny, ly)))
    beside, light = (x[nx // 2], y[ny // 2]), exact.summit
    waves = [np.cos(2.0 * math.pi * c / exact.wavelength) for c in (x, y)]
    surface = exact.amplitude * np.outer(*waves)
    found = capped_pressure(surface, (lx, ly), exact.modulus, exact.mean_pressure, tolerance=1e-6)
    largest = exact.complete(*beside) if exact.load_ratio >= 1.0 else light.pressure(math.hypot(*beside))
    values = {
        "p-max": float(largest),
        "share": float(np.mean(found > 0.0)),
        "area": float(np.mean(found > 0.0)) * lx * ly,
        "fitted-share": exact.fitted_share,
        "open-share": 1.0 - exact.heavy_share,
        "pressure": exact.complete,
    }
    return Reference(values, {"a": light.contact_radius, "p0": exact.complete_pressure})


REFERENCES: Mapping[str, Callable[[Scene], Reference]] = {
    "hertz-sphere": hertz_sphere,
    "hertz-line": hertz_line,
    "hertz-ellipse": hertz_ellipse,
    "flat-punch": flat_punch,
    "rounded-punch": rounded_punch,
    "coated-sphere": coated_sphere,
    "hamilton": hamilton,
    "travelling-load": travelling_load,
    "coated-traction": coated_traction,
    "film-changes": film_changes,
    "wave": wave,
    "double-wave": double_wave,
}
"""Name in a case file -> the answer for a scene."""
