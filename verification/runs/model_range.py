# SPDX-License-Identifier: MIT
"""By how much the model of every scene, small strains of a flat half-space, is off, and where it ends.

Of a sphere the errors are those that the cases model-limits measured against finite strain and true geometry
at equal force, over its own a/R, in data/model_range.csv: chosen by hardening, linear in between, also
between two Poisson's ratios. Any other contact is likened to a sphere: an ellipsoid to the one of its larger
a_i/R_i, the edge of a punch to the one of the same slope, a rough body to the one of the same rms slope in
contact, and what yields otherwise to the one of the same plastic strain. The last three are rules of thumb.
Below a smooth cylinder, in plane strain, nothing was measured, and that is said.

Before a solve a/R is the larger of Hertz and a fully plastic contact, F = H pi a^2, H three times the yield
stress at the strain 0.2 a/R (Tabor 1951; Johnson, Contact Mechanics (1985), section 6.3).
"""

import csv
from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from functools import cache
from importlib import resources
from math import asin, cos, pi, sin, sqrt
from typing import Any

import numpy as np

from sam.scene import COUNTER_HEIGHT, PEAK, Plasticity, Result, Scene, Status
from sam.scene.surface import heights, roughness

KEPT = "model_range.csv"
LARGEST, STEEPEST = 0.5, 0.58
"""a/R, and slope at the edge of a rounded punch, beyond which nothing is solved unless the scene asks for
it."""
LARGER = "the larger a_i/R_i"
CYLINDER, UNMEASURED = "a cylinder", 0.05
"""What a line contact is like, and its a/R from which on it is said that nothing was measured."""
OUTSIDE = "outside_of_model"
"""Last column of every table, and a field of every mesh, of a contact that is: its a/R."""
SAID = 0.01
"""Error from which on a quantity is named."""
WORDS = {
    "mean_pressure": "mean pressure",
    "contact_radius": "contact radius",
    "approach": "approach",
    "peeq_max": "largest plastic strain",
}
COLUMNS = ("law", "poisson", "a_over_R", *WORDS, *(f"u_{name}" for name in WORDS))
ELASTIC, SWIFT, PERFECT = "elastic", "Swift steel", "perfectly plastic"
FIRST_YIELD = 1.6  # p0 over the yield stress below a sphere, nu = 0.3: Johnson (1985), section 6.1
HARDENS = 1.05  # flow stress at a plastic strain of 5 % over that at none
STRAIN_OF_SPHERE = {SWIFT: 0.4, PERFECT: 0.9}
"""Largest plastic strain over a/R below a sphere at a/R = 0.2, by small strains: model-limits-plastic."""
RMS_OF_SLOPE = sqrt(0.5)  # rms over the contact area of the slope of a sphere, over that at its edge


@cache
def measured() -> dict[tuple[str, float], dict[str, np.ndarray]]:
    """Law and Poisson's ratio of a measurement -> the columns of its rows in the table, a/R ascending."""
    text = resources.files("verification").joinpath("data", KEPT).read_text(encoding="utf-8")
    found: dict[tuple[str, float], list[dict[str, str]]] = {}
    for row in csv.DictReader(text.splitlines()):
        found.setdefault((row["law"], float(row["poisson"])), []).append(row)
    return {
        key: {name: np.array([float(row[name]) for row in rows if row[name]]) for name in COLUMNS[2:]}
        for key, rows in found.items()
    }


def errors(law: str, poisson: float, ratio: float) -> dict[str, tuple[float, float]]:
    """Quantity -> relative error of the flat half-space of small strains, and its uncertainty, on a sphere.
    ratio: a/R; beyond what was measured, of it and of Poisson's ratio, the nearest counts.
    """
    own = {nu: columns for (name, nu), columns in sorted(measured().items()) if name == law}

    def at(name: str) -> float:
        x = {nu: np.concatenate([[0.0], each["a_over_R"]]) for nu, each in own.items()}
        values = [np.interp(ratio, x[nu], np.concatenate([[0.0], each[name]])) for nu, each in own.items()]
        return float(np.interp(poisson, list(own), values))

    quantities = [name for name in WORDS if all(each[name].size for each in own.values())]
    return {name: (at(name), at(f"u_{name}")) for name in quantities}


def refusal(scene: Scene) -> str:
    """Why a scene is not solved: key, value, what is allowed; empty in the range, or with beyond_model."""
    if scene.solver.beyond_model or (key := _load_key(scene)) is None:
        return ""
    load = getattr(scene.loading, key)
    if not _beyond(scene, ratio := _ratio(scene, load)):
        return ""
    most = _root(lambda share: _ratio(scene, share * load) - LARGEST, 1.0) * load
    unit, what = {"force": "N", "approach": "m", "p0": "Pa"}[key], _RATIOS[_shape(scene)]
    return (
        f"loading.{key} = {load:.6g} {unit}, allowed: at most about {most:.3g} {unit}: {what} is "
        f"estimated as {ratio:.3g}, and small strains of a flat half-space end at {LARGEST:g}; lower it, or "
        "give [solver] beyond_model = true"
    )


def with_range(scene: Scene, result: Result) -> Result:
    """The result with what is said of its model's range; beyond it, unasked, outside-of-model."""
    found = model_range(scene, result)
    if found is None:
        return result
    said = {"model_range": found, "warnings": (*result.warnings, *range_lines(found))}
    if found["outside"] and result.converged and not scene.solver.beyond_model:
        said["status"] = Status.OUTSIDE_OF_MODEL
        said["message"] = f"a/R = {found['a_over_R']:.3g}: {Status.OUTSIDE_OF_MODEL.advice}"
    return replace(result, **said)


def model_range(scene: Scene, result: Result | None = None) -> dict[str, Any] | None:
    """By how much the model is off, of the estimated contact or of the one that was solved; None where
    nothing is known, as below the flat end of a punch on an elastic body. a_over_R: of the sphere that the
    contact is likened to; like: by what, empty for a sphere; law, poisson, measured_to: of the measurement;
    quantities: name -> error, uncertainty; outside: whether the model ends before; lost_height: the largest
    worn depth over the height of the relief, where there is wear.
    """
    values = {} if result is None else result.last_fitting or result.quantities
    if _shape(scene) == "cylinder" and scene.patch_surface is None:
        force, other = scene.loading.force, scene.counterbody
        # the half-width of Hertz: Johnson (1985), Eq. 4.43
        a = values.get("contact_half_width_m") or sqrt(
            4.0 * force * other.radius / (pi * contact_modulus(scene) * other.length)
        )
        nothing = {"law": "", "poisson": [], "measured_to": 0.0, "quantities": {}, "outside": False}
        return {"a_over_R": a / other.radius, "like": CYLINDER, **nothing}
    likes = list(_likes(scene, result, values))
    if not likes:
        return None
    ratio, by = max(likes)
    law = _law(scene, ratio, values.get("peeq_max"))
    spheres = {nu: each["a_over_R"] for (name, nu), each in measured().items() if name == law}
    given, found = _given(scene), errors(law, scene.body.poisson, ratio)
    out = {
        "a_over_R": ratio,
        "like": by,
        "law": law,
        "poisson": list(spheres),
        "measured_to": float(min(x[-1] for x in spheres.values())),
        "quantities": {
            name: {"error": error, "uncertainty": around}
            for name, (error, around) in found.items()
            if name not in given
        },
        "outside": _load_key(scene) is not None and _beyond(scene, likes[0][0]),
    }
    lost = None if result is None else _lost_height(scene, result)
    return out if lost is None else {**out, "lost_height": lost}


def off_in_words(found: Mapping[str, Any]) -> str:
    """The quantities that are off by more than SAID and the uncertainty of that, and by how much."""
    if found.get("like") == CYLINDER:
        return "not measured in plane strain" if found["a_over_R"] > UNMEASURED else ""
    off = [
        f"{WORDS[name]} {_percent(**each)} too {'low' if each['error'] < 0.0 else 'high'}"
        for name, each in found["quantities"].items()
        if abs(each["error"]) > max(SAID, each["uncertainty"])
    ]
    lost = found.get("lost_height", 0.0)
    if lost > SAID:
        off.append(f"lost height {100 * lost:.2g} % of the relief")
    return ", ".join(off)


def in_a_sentence(off: str, about: str) -> str:
    """What `off_in_words` says, of the model; about: which contact that is."""
    return f"error of the model (small strains, flat half-space): {off} ({about})"


def range_lines(found: Mapping[str, Any]) -> list[str]:
    """What is said about it: that it is outside of the model, and what is off, in one line each."""
    off, ratio, by = off_in_words(found), found["a_over_R"], found["like"]
    if by == CYLINDER:
        return [in_a_sentence(off, f"{by} with a/R = {ratio:.2g}")] if off else []
    like = f"{by}, as of a sphere at " if by else ""
    parts = [f"{like}a/R = {ratio:.2g}", f"measured on spheres, {found['law']}"]
    if ratio > found["measured_to"]:
        parts.append(f"only up to {found['measured_to']:.2g}: more is to be expected")
    if by not in ("", LARGER):
        parts.append("a rule of thumb")
    words = [in_a_sentence(off, "; ".join(parts))] if off else []
    return [*([outside_in_words(ratio)] if found["outside"] else []), *words]


def _percent(error: float, uncertainty: float) -> str:
    """The size of an error, with its uncertainty where that is more than half of it."""
    around = f" (+-{100 * uncertainty:.1g})" if uncertainty > abs(error) / 2.0 else ""
    return f"{100 * abs(error):.2g}{around} %"


def outside_of_model(result: Any) -> float | None:
    """a/R of a result or a run whose contact lies beyond the model; None of all others."""
    found = getattr(result, "model_range", None)
    return found["a_over_R"] if found is not None and found["outside"] else None


def outside_in_words(ratio: float) -> str:
    """The foot note of a figure."""
    return f"outside of the model: a/R = {ratio:.3g}, small strains of a flat half-space end at {LARGEST:g}"


_RATIOS = {
    "": "a/R of the sphere that makes this pressure",
    "sphere": "a/R, contact radius over counterbody.radius,",
    "ellipsoid": "the larger a_i/R_i of the semi-axes of contact and the radii of the ellipsoid",
    "rounded-punch": "the contact beside the flat end over the radius of the edge",
}
"""Shape of the counter-body -> what is limited."""


def _shape(scene: Scene) -> str:
    return "" if scene.counterbody is None else scene.counterbody.shape


def _beyond(scene: Scene, ratio: float) -> bool:
    """Whether a contact is larger than the model is good for."""
    if _shape(scene) == "rounded-punch":
        return ratio >= 1.0 or ratio / sqrt(1.0 - ratio**2) > STEEPEST
    return ratio > LARGEST


def _given(scene: Scene) -> tuple[str, ...]:
    """Quantities that a scene gives, and those that it does not have."""
    if scene.counterbody is None:
        return "mean_pressure", "contact_radius", "approach"
    return ("approach",) if scene.loading.approach is not None else ()


def _load_key(scene: Scene) -> str | None:
    """The key of [loading] that decides how large the contact is; None where nothing is curved."""
    if scene.loading.hertz:
        return "p0"
    if _shape(scene) not in ("sphere", "ellipsoid", "rounded-punch"):
        return None
    return "force" if scene.loading.approach is None else "approach"


def _likes(
    scene: Scene, result: Result | None, values: Mapping[str, float | None]
) -> Iterator[tuple[float, str]]:
    """a/R of the spheres that a scene can be likened to, and by what; the one of its counter-body first."""
    if (key := _load_key(scene)) is not None:
        radius = values.get("contact_radius_m")
        smooth = scene.patch_surface is None and not scene.loading.hertz
        load = getattr(scene.loading, key)
        ratio = _ratio_of(scene, radius) if smooth and radius is not None else _ratio(scene, load)
        yield ratio, {"ellipsoid": LARGER, "rounded-punch": "slope at the edge"}.get(_shape(scene), "")
    if scene.patch_surface is not None:
        slope = rms_slope(scene) if result is None else _slope_in_contact(result)
        if slope:
            edge = slope / RMS_OF_SLOPE
            yield edge / sqrt(1.0 + edge**2), f"rms slope {slope:.2g}"
    strain, plasticity = values.get("peeq_max"), scene.body.plasticity
    if strain and plasticity is not None and (scene.patch_surface is not None or _load_key(scene) is None):
        like = strain / STRAIN_OF_SPHERE[_hardening(plasticity)]
        yield like, f"plastic strain {100 * strain:.2g} %"


def _ratio(scene: Scene, load: float) -> float:
    """The estimated a/R of a contact: the larger a_i/R_i of an ellipsoid, (a - b)/R of a punch with the flat
    end b and the radius R of its edge, and under a given pressure that of the sphere which makes it.
    """
    plasticity, loading, other = scene.body.plasticity, scene.loading, scene.counterbody
    modulus = contact_modulus(scene)
    if load == 0.0:
        return 0.0
    if other is None:
        return pi * load / (2.0 * modulus)
    if other.radii is None:
        return _ratio_of_edge(scene, load)
    mean, (a, b, approach) = sqrt(other.radii[0] * other.radii[1]), _hertz(*other.radii)
    force = load if loading.approach is None else modulus * (load / approach) ** 1.5
    radius = sqrt(a * b) * (force / modulus) ** (1.0 / 3.0)
    ratio = _ratio_of(scene, radius, elastic=True)
    if plasticity is None:
        return ratio
    if loading.approach is not None:  # the material beside neither sinks in nor piles up
        radius = sqrt(2.0 * mean * load)
        if _hardness(plasticity, radius, radius / mean) * pi * radius**2 >= force:
            return ratio
    else:
        radius = _fully_plastic(plasticity, force, lambda a: a / mean)
    return max(ratio, _ratio_of(scene, radius))


def _ratio_of_edge(scene: Scene, load: float) -> float:
    """The same of a rounded punch: Sneddon, Int. J. Eng. Sci. 3 (1965) 47, with cos t = b/a."""
    other, plasticity, modulus = scene.counterbody, scene.body.plasticity, contact_modulus(scene)
    flat, edge, by_force = other.flat_radius, other.radius, scene.loading.approach is None

    def excess(ratio: float) -> float:
        a = flat + ratio * edge
        t = 2.0 * asin(sqrt(ratio * edge / (2.0 * a)))
        if by_force:
            bracket = sin(t) * (3.0 + sin(t) ** 2) - 3.0 * t * cos(t)
            return modulus * a**3 / (3.0 * edge) * bracket - load
        return a**2 / edge * (sin(t) - t * cos(t)) - load

    if by_force:
        ratio = _root(excess, (0.75 * load / (modulus * edge**2)) ** (1.0 / 3.0))
        if plasticity is not None:
            a = _fully_plastic(plasticity, load, lambda a: max(a - flat, 0.0) / edge)
            ratio = max(ratio, (a - flat) / edge)
        return ratio
    steepest = sqrt(2.0 * load / edge)  # the profile as deep as the approach: all of it in contact
    return _root(excess, steepest) if plasticity is None else steepest


def _ratio_of(scene: Scene, radius: float, *, elastic: bool = False) -> float:
    """a/R of a contact with the area of a circle of that radius in m."""
    other = scene.counterbody
    if other.radii is None:
        return max(radius - other.flat_radius, 0.0) / other.radius
    rx, ry = other.radii
    if elastic or scene.body.plasticity is None:
        a, b, _ = _hertz(rx, ry)
    else:  # the part of the ellipsoid below a plane
        a, b = sqrt(rx), sqrt(ry)
    return radius / sqrt(a * b) * max(a / rx, b / ry)


def contact_modulus(scene: Scene) -> float:
    """E* in Pa of the body without its coating and of the counter-body."""
    body, other = scene.body, scene.counterbody
    compliance = (1.0 - body.poisson**2) / body.young
    if other is not None and other.elastic:
        compliance += (1.0 - other.poisson**2) / other.young
    return 1.0 / compliance


@cache
def _hertz(rx: float, ry: float) -> tuple[float, float, float]:
    """Semi-axes a along x, b along y and approach in m of an ellipsoid by Hertz under F/E* = 1 m^2. With w =
    1/sqrt(cos^2 + k^2 sin^2), k = b/a, and means over a quarter of a circle: Rx/Ry = <cos^2 w>/(k^2 <sin^2
    w>), a^3 = 3/2 Rx <sin^2 w> F/E*, approach = 3/4 <w> F/(E* a): Johnson (1985), section 4.2.
    """
    if ry > rx:
        b, a, approach = _hertz(ry, rx)
        return a, b, approach
    sin2 = np.sin((np.arange(4000) + 0.5) * pi / 8000.0) ** 2

    def means(k: float) -> np.ndarray:
        w = 1.0 / np.sqrt(1.0 - sin2 + k**2 * sin2)
        return np.array([(sin2 * w).mean(), ((1.0 - sin2) * w).mean() / k**2, w.mean()])

    def excess(ratio: float) -> float:
        along, across, _ = means(1.0 - ratio)
        return float(across / along) - rx / ry

    k = 1.0 - _root(excess, 1.0 - ry / rx) if rx > ry else 1.0
    along, _, every = means(k)
    a = float(1.5 * rx * along) ** (1.0 / 3.0)
    return a, k * a, 0.75 * float(every) / a


def _flow(plasticity: Plasticity, z: float, strain: float) -> float:
    """Stress in tension in Pa at depth z and a plastic strain, with the back-stresses."""
    strength = plasticity.strength()
    stress = float(strength.stress(z, strain))
    for modulus, recovery in zip(*(strength.back_at(z) or ((), ())), strict=True):
        stress += float(modulus) * (-np.expm1(-recovery * strain) / recovery if recovery else strain)
    return stress


def _hardness(plasticity: Plasticity, radius: float, ratio: float) -> float:
    """Mean pressure in Pa of a fully plastic contact, by the material half a radius below it."""
    return 3.0 * _flow(plasticity, 0.5 * radius, 0.2 * ratio)


def _fully_plastic(plasticity: Plasticity, force: float, ratio_of: Callable[[float], float]) -> float:
    """Contact radius in m at which a fully plastic contact bears a force."""
    most = sqrt(force / (3.0 * pi * plasticity.strength().least(0.0)))
    return _root(lambda a: _hardness(plasticity, a, ratio_of(a)) * pi * a**2 - force, most)


def _root(excess: Callable[[float], float], most: float) -> float:
    """Where a function that rises from below 0 at 0 is 0, by halving; `most` if it is not before that."""
    low, high = 0.0, most
    for _ in range(60):
        middle = (low + high) / 2.0
        low, high = (low, middle) if excess(middle) > 0.0 else (middle, high)
    return (low + high) / 2.0


def _law(scene: Scene, ratio: float, strain: float | None) -> str:
    """The measurement that is the nearest. strain: of a result; by the estimated pressure without it."""
    plasticity = scene.body.plasticity
    if plasticity is None:
        return ELASTIC
    least = plasticity.strength().least(0.0)
    modulus = scene.body.young / (1.0 - scene.body.poisson**2)
    if strain == 0.0 or (strain is None and 2.0 / pi * modulus * ratio < FIRST_YIELD * least):
        return ELASTIC
    return _hardening(plasticity)


def _hardening(plasticity: Plasticity) -> str:
    """Which of the bodies that yield is the nearest."""
    deep = np.inf
    return SWIFT if _flow(plasticity, deep, 0.05) > HARDENS * _flow(plasticity, deep, 0.0) else PERFECT


def rms_slope(scene: Scene) -> float:
    """rms slope of the patch before a solve, of both surfaces together; where the counter-body moves, of the
    body alone. A surface of which only the digest of its file is at hand counts as smooth.
    """
    (nx, ny), extent = scene.patch
    hx, hy = extent[0] / nx, extent[1] / ny
    x, y = ((np.arange(n) - (n - 1) / 2) * h for n, h in ((nx, hx), (ny, hy)))
    total = 0.0
    for surface in (scene.surface, None if scene.moves else scene.counter_surface):
        if surface is not None and not (surface.kind == "file" and surface.measured.values is None):
            total += roughness(heights(surface, x, y, extent), hx, hy).sdq ** 2
    return sqrt(total)


def _slope_in_contact(result: Result) -> float:
    """rms slope of the surfaces where they touch at the peak, before they deform; 0 where none does."""
    found = result.tables.get("surface")
    if found is None:
        return 0.0
    states = np.asarray(found["state"])
    first = states == (PEAK if PEAK in states else states[0])
    columns = ("x_m", "y_m", "height_m", "p_Pa", "worn_m", COUNTER_HEIGHT)
    rough = {name: np.asarray(found[name], dtype=float)[first] for name in columns if name in found}
    x, y = (np.unique(rough[name]) for name in ("x_m", "y_m"))
    if x.size * y.size != rough["x_m"].size:  # no grid
        return 0.0
    together = rough["height_m"] - rough["worn_m"] + rough.get(COUNTER_HEIGHT, 0.0)
    slopes = np.gradient(together.reshape(x.size, y.size), x, y)
    touching = rough["p_Pa"].reshape(x.size, y.size) > 0.0
    square = sum(slope**2 for slope in slopes)[touching]
    return float(np.sqrt(np.nanmean(square))) if square.size else 0.0


def _lost_height(scene: Scene, result: Result) -> float | None:
    """The largest worn depth over the height of the relief; None without wear or relief."""
    if scene.wear is None or "surface" not in result.tables:
        return None
    relief = float(np.ptp(np.asarray(result.tables["surface"]["height_m"], dtype=float)))
    worn = float(np.max(np.asarray(result.tables["surface"]["worn_m"], dtype=float)))
    return worn / relief if relief > 0.0 else None
