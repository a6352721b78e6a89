# SPDX-License-Identifier: MIT
"""The elastic contact that is expected of a scene: estimated before a solve, by Hertz beside a result."""

from collections.abc import Mapping
from math import inf, pi, prod, sqrt
from typing import Any

from sam.scene import Scene
from verification.cost import estimates
from verification.runs.model_range import contact_modulus, rms_slope
from verification.text.readable import with_prefix

YIELDS_AT = 1.6
"""p0 over the yield stress at first yield below a sphere: 1.61 (nu = 0.3; Johnson 1985, section 6.1)."""
YIELDS_AT_LINE = 1.79  # below a cylinder, by von Mises (nu = 0.3)


def hertz_of(scene: Scene) -> dict[str, float]:
    """Quantity -> its value by Hertz, below a smooth sphere, ellipsoid or cylinder without film; or none."""
    other, loading, body = scene.counterbody, scene.loading, scene.body
    if other is None or scene.patch_surface is not None or body.coating is not None or loading.force == 0.0:
        return {}
    if other.length is not None:
        from verification.reference.hertz_line import LineContact

        line = LineContact(loading.force, other.radius, contact_modulus(scene), other.length)
        a = line.contact_radius
        area = {"contact_area_m2": 2 * a * other.length, "contact_half_width_m": a}
        return {"approach_m": line.approach, **area, "p_max_Pa": line.peak_pressure}
    if other.radii is None:
        return {}
    from verification.reference.elliptic import EllipticContact

    force, modulus = loading.force, contact_modulus(scene)
    if loading.approach is not None:  # grows with the force to the power 2/3
        force = (loading.approach / EllipticContact(1.0, *other.radii, modulus).approach) ** 1.5
    exact = EllipticContact(force, *other.radii, modulus)
    a, b = exact.semi_axes
    found = {"approach_m": exact.approach} if loading.approach is None else {"force_N": force}
    area = {"contact_area_m2": pi * a * b, "contact_radius_m": sqrt(a * b)}
    return found | area | {"p_max_Pa": exact.peak_pressure}


def expected_contact(scene: Scene) -> dict[str, Any]:
    """The estimated elastic contact as a mapping that JSON can hold, in SI, with the words of a plan."""
    other, plasticity = scene.counterbody, scene.body.plasticity
    least = None if plasticity is None else float(plasticity.strength().least(0.0))

    def beyond(pressure: float) -> dict[str, float]:
        return {} if not least else {"over_yield": pressure / least}

    if scene.loading.force == 0.0:
        return {"words": "no load: loading.force is zero"}
    if scene.loading.misfit_sphere:
        stress = estimates.MISES * estimates.peak_pressure(scene)
        radius = with_prefix(scene.loading.radius, "m")
        found = {"mises_Pa": stress, **beyond(stress)}
        words = f"misfit sphere: radius {radius}, no contact{_over(found, 'largest stress')}"
        return found | {"words": words}
    if other is not None and other.shape == "flat":
        return _of_plane(scene, beyond)
    from sam import expected_force, hertz_semi_axes

    (a, b), p0 = hertz_semi_axes(scene), estimates.peak_pressure(scene)
    found = {"p0_Pa": p0, "a_m": a, "b_m": b, **beyond(p0)}
    size = f"a = {with_prefix(a, 'm')}"
    if a != b and (other is None or other.length is None):
        size = f"a x b = {with_prefix(a, 'm')} x {with_prefix(b, 'm')}"
    if other is None:
        words = f"given pressure: p0 = {with_prefix(p0, 'Pa')}, {size}{_over(found, 'p0')}"
    elif other.radii is None and other.length is None:
        mean = p0 / 1.5
        found = {"p_mean_Pa": mean, "a_m": a, "b_m": b, **beyond(mean)}
        words = f"{other.shape}: mean pressure {with_prefix(mean, 'Pa')}, contact radius {size}"
        words += _over(found, "mean pressure")
    else:
        words = _of_hertz(scene, found, size)
    if scene.loading.approach is not None:
        found["force_N"] = expected_force(scene)
        words += f", force about {with_prefix(found['force_N'], 'N')}"
    if scene.patch_surface is not None:
        found["rms_slope"] = rms_slope(scene)
        words += f"; rough: rms slope {found['rms_slope']:.2g}"
    return found | {"words": words}


def _of_hertz(scene: Scene, found: dict[str, Any], size: str) -> str:
    """The words of a sphere, an ellipsoid or a cylinder; found: adds a/R."""
    other, line = scene.counterbody, scene.counterbody.length is not None
    rx, ry = (other.radius, inf) if line else other.radii
    found["a_over_R"] = max(found["a_m"] / rx, found["b_m"] / ry)
    bare = "" if scene.body.coating is None else " (without coating)"
    size = f"half-width {size}" if line else size
    words = f"Hertz{bare}: p0 = {with_prefix(found['p0_Pa'], 'Pa')}, {size}, a/R = {found['a_over_R']:.2g}"
    return words + _over(found, "p0", YIELDS_AT_LINE if line else YIELDS_AT)


def _over(found: Mapping[str, Any], what: str, yields_at: float = YIELDS_AT) -> str:
    """How large a stress is beside the yield stress; of an elastic body that it is."""
    if "over_yield" not in found:
        return ", elastic body"
    ratio = found["over_yield"]
    first = f" (yields from {yields_at})" if what == "p0" else ""
    return f", {what} = {ratio:.2g} yield stresses{first}"


def _of_plane(scene: Scene, beyond: Any) -> dict[str, Any]:
    """A plane on a rough body: nominal pressure, share in contact, E*/2 times the rms slope."""
    slope, modulus = rms_slope(scene), contact_modulus(scene)
    found: dict[str, Any] = {"rms_slope": slope}
    words = f"rough: rms slope {slope:.2g}" if slope else "rough: rms slope unknown"
    if scene.loading.force is not None:
        found["p_nominal_Pa"] = nominal = scene.loading.force / prod(scene.patch[1])
        words += f", nominal pressure {with_prefix(nominal, 'Pa')}"
        if slope:
            found["contact_share"] = share = estimates.contact_share(scene, nominal)
            words += f", elastic contact on about {100 * share:.2g} % of the patch"
    if slope:
        spots = modulus * slope / 2
        found |= {"p_spots_Pa": spots, **beyond(spots)}
        words += f" at {with_prefix(spots, 'Pa')}"
        words += f" = {found['over_yield']:.2g} yield stresses" if "over_yield" in found else ""
    return found | {"words": words}
