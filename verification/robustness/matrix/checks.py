# SPDX-License-Identifier: MIT
"""What a right cell of the robustness matrix is compared with: closed forms, limits, invariances, the other
model.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from math import pi, sqrt
from typing import Any

import numpy as np

from sam.scene import HeightMap, Result, Scene
from verification.quantities import contact_of, modulus_of
from verification.reference.coated_sphere import thin_layer
from verification.reference.hertz import CircularContact, effective_modulus
from verification.references import (
    coated_contact,
    elliptic_contact,
    flat_punch,
    hertz_sphere,
    layers_of,
    rounded_contact,
)
from verification.robustness.matrix.row import (
    FORCE,
    HERTZ,
    PATCH,
    POISSON,
    RADIUS,
    SIDE,
    TOLERANCE,
    YOUNG,
    Check,
    Deviation,
    Trial,
    other,
    scene_with,
)
from verification.runs.models import FEM, SAM

COARSE = {SAM: "8 cells of equal pressure in the contact radius", FEM: "8 elements in the contact radius"}
# compliance of a square punch over that of a disc of its area, inverse: King, Int. J. Solids Struct. 23
# (1987) 1657
KING = 1.012


def hertz(trial: Trial) -> dict[str, float]:
    """Circular contact in closed form."""
    exact = hertz_sphere(trial.scene).values
    return {
        "p_center_Pa": exact["p-max"],
        "approach_m": exact["approach"],
        "mises_max_Pa": exact["mises-max"],
    }


def given_approach(trial: Trial) -> dict[str, float]:
    """The force and the largest pressure that a given approach of a sphere takes (Johnson 1985, Eq. 4.23)."""
    scene, modulus = trial.scene, modulus_of(trial.scene)
    approach, radius = scene.loading.approach, scene.counterbody.radius
    force, pressure = 4 / 3 * sqrt(radius * approach) * approach, 2 / pi * sqrt(approach / radius)
    return {"force_N": modulus * force, "p_center_Pa": modulus * pressure, "approach_m": approach}


def ellipse(trial: Trial) -> dict[str, float]:
    """Elliptic contact in closed form."""
    exact = elliptic_contact(trial.scene)
    return {"p_max_Pa": exact.peak_pressure, "approach_m": exact.approach}


def rounded_punch(trial: Trial) -> dict[str, float]:
    """Punch with a rounded edge in closed form."""
    exact = rounded_contact(trial.scene)
    return {"approach_m": exact.approach, "p_center_Pa": float(exact.pressure(0.0))}


def coated(trial: Trial) -> dict[str, float]:
    """A sphere on a coated half-space, by dual integral equations: p0 and approach."""
    exact = coated_contact(trial.scene)
    return {"p_center_Pa": float(exact.pressure(0.0)), "approach_m": exact.approach}


def squeezed(trial: Trial) -> dict[str, float]:
    """A thin soft film on a rigid body (Johnson 1985, 5.8): p0, and the approach a^2/(2 R), where a goes with
    the force to the power 1/4.
    """
    layers = layers_of(trial.scene)
    _, unit = thin_layer(layers, RADIUS, HERTZ)
    a = HERTZ * (trial.scene.loading.force / unit) ** 0.25
    return {"p_center_Pa": thin_layer(layers, RADIUS, a)[0], "approach_m": a**2 / (2 * RADIUS)}


def film_alone(trial: Trial) -> dict[str, float]:
    """The film as a half-space: Hertz's p0."""
    film, load = trial.scene.body.coating, trial.scene.loading.force
    exact = CircularContact(load, RADIUS, effective_modulus(film.young, film.poisson))
    return {"p_center_Pa": exact.peak_pressure}


def bare_body(_: Trial) -> dict[str, float]:
    """A film that is none, or next to none: Hertz for the body."""
    exact = CircularContact(FORCE, RADIUS, effective_modulus(YOUNG, POISSON))
    return {"p_center_Pa": exact.peak_pressure, "approach_m": exact.approach}


FORMS: Mapping[str, Callable[[Trial], Mapping[str, float]]] = {
    "Hertz": hertz,
    "Hertz, given approach": given_approach,
    "elliptic Hertz": ellipse,
    "Boussinesq": lambda trial: {"approach_m": flat_punch(trial.scene).values["approach"]},
    "rounded punch": rounded_punch,
    "coated half-space": coated,
    "thin film": squeezed,
    "limit of a thick film": film_alone,
    "Hertz of the body": bare_body,
}
"""Closed forms by the names that rows give them: quantity -> expected value."""


def relative(what: str, value: float | None, expected: float, bound: float, *, reason: str) -> Deviation:
    """Of a value that is not 0; one that is missing is as far as can be."""
    error = float("nan") if value is None else abs(value / expected - 1.0)
    return Deviation(what, error, bound, reason)


def against(target: str | Mapping[str, Any], bounds: Mapping[str, float], reason: str = "") -> Check:
    """Quantities, each within its own bound, against a closed form of FORMS, against another model (which is
    itself compared with SAM), or against the scene with other values in the same model; no reason: it is the
    size of the cells.
    """

    def check(trial: Trial) -> Iterator[Deviation]:
        if not isinstance(target, str):
            words = f"as with {', '.join(f'{key} = {value}' for key, value in target.items())}"
            expected = trial.bench.converged(other(trial.scene, target), trial.model).quantities
        elif target in FORMS:
            words, expected = target, FORMS[target](trial)
        else:
            words = SAM if trial.model == target else target
            expected = trial.bench.converged(trial.scene, words).quantities
        for name, bound in bounds.items():
            why = reason or COARSE[trial.model]
            yield relative(f"{name}, {words}", trial.quantities[name], expected[name], bound, reason=why)

    return check


def coarser(scene: Scene, model: str, fine: Result) -> Scene:
    """The scene in cells 1.5 times as large: of SAM on the same sides of the grid, of FEM by its elements."""
    if model != SAM:
        return other(scene, {"fem.cells_per_radius": round(scene.fem.cells_per_radius / 1.5)})
    cells, sides = fine.discretisation["cells"], fine.discretisation["cell_m"]
    fewer = tuple(2 * round(n / 3) + 1 for n in cells)
    extent = tuple(n * h for n, h in zip(cells, sides, strict=True))
    return other(scene, {"grid": {"cells": fewer, "extent": extent}})


def within_refinement(name: str) -> Check:
    """A quantity of SAM and axisymmetric FEM, within the refinement uncertainties of both.

    The uncertainty is Richardson's for first order, the least that a converging value has: h/(1.5 h - h) = 2
    times what the step from cells 1.5 times as large changes.
    """

    def check(trial: Trial) -> Iterator[Deviation]:
        model = FEM if trial.model == SAM else SAM
        twin, sizes = trial.bench.converged(trial.scene, model), []
        for each, fine in ((trial.model, trial.result), (model, twin)):
            coarse = trial.bench.converged(coarser(trial.scene, each, fine), each)
            sizes.append(2.0 * abs(fine.quantities[name] - coarse.quantities[name]))
        value, difference = abs(trial.quantities[name]), abs(trial.quantities[name] - twin.quantities[name])
        shares = " + ".join(f"{1e2 * size / value:.2g}" for size in sizes)
        words = f"{name}, {model}, over both refinement uncertainties ({shares} %)"
        yield Deviation(words, difference / sum(sizes), 1.0, "cells 1.5 times as large, first order")
        yield Deviation(f"{name}, its uncertainties", sum(sizes) / value, 0.25, "or the row tests nothing")

    return check


def without(name: str, words: str) -> Check:
    """A quantity has no uncertainty, and the reason has these words."""

    def check(trial: Trial) -> Iterator[Deviation]:
        entry = trial.result.uncertainty[name]
        right = entry["u_num"] is None and words in entry["flag"]
        said = "0: it is as expected, 1: it is not"
        yield Deviation(f"no uncertainty of {name}", float(not right), 0.5, said)

    return check


def as_twin(words: str, reason: str, twin: Callable[[Scene], Scene]) -> Check:
    """The same approach as of another scene, and on the whole patch (maxima leave its border out) the same
    largest pressure and cells in contact.
    """

    def whole(result: Result) -> dict[str, float]:
        pressure, approach = np.asarray(result.fields.cell_data["p_Pa"]), result.quantities["approach_m"]
        touching = float(np.count_nonzero(pressure > 0))
        return {"approach": approach, "largest pressure": np.nanmax(pressure), "cells in contact": touching}

    def check(trial: Trial) -> Iterator[Deviation]:
        expected = whole(trial.bench.converged(twin(trial.scene), trial.model))
        for name, value in whole(trial.result).items():
            yield relative(f"{name}, {words}", value, expected[name], 1e-6, reason=reason)

    return check


def pressed(name: str, force: float) -> Scene:
    """A plane pressed on heights of that name."""
    surface = {"kind": "file", "path": name}
    return scene_with(
        {"counterbody": {"shape": "flat"}, "grid": "none", "loading.force": force, "surface": surface}
    )


def as_patch(name: str) -> Check:
    """As of a smaller patch that holds all that touches."""
    reason = "the cells beside are not touched: one discrete problem"
    return as_twin("the part alone", reason, lambda scene: pressed(name, scene.loading.force))


def as_sum(name: str) -> Check:
    """As of the sum of the heights on the body under a plane."""
    return as_twin(
        "heights on the body", "the same gap, rounded differently", lambda scene: pressed(name, 1.0)
    )


def turned(scene: Scene) -> Scene:
    """The scene with its surface turned over in x."""
    path = scene.surface.path
    return other(scene, {"surface.path": HeightMap(path.values[::-1], path.extent)})


def nothing_touches(trial: Trial) -> Iterator[Deviation]:
    """No force: no approach, area, pressure and stress, exactly."""
    for name in ("approach_m", "contact_area_m2", "p_max_Pa", "mises_max_Pa"):
        yield Deviation(f"{name} without force", abs(trial.quantities[name]), 1e-300, "nothing touches")


def balanced(trial: Trial) -> Iterator[Deviation]:
    """The force is that of the scene, and the certificate of the contact holds."""
    yield relative("force_N", trial.quantities["force_N"], trial.scene.loading.force, 1e-9, reason="rounding")
    yield from within_tolerance(trial, "gap_in_contact", "penetration")


def balanced_sam(trial: Trial) -> Iterator[Deviation]:
    """The same, asked of SAM alone."""
    if trial.model == SAM:
        yield from balanced(trial)


def within_tolerance(trial: Trial, *names: str) -> Iterator[Deviation]:
    """Those of the certificates that there are."""
    for name in names:
        if name in trial.result.certificate:
            yield Deviation(name, trial.result.certificate[name], trial.scene.solver.tolerance, TOLERANCE)


def yields(trial: Trial) -> Iterator[Deviation]:
    """The extreme is one: there is plastic strain."""
    none = float(not trial.quantities["peeq_max"] > 0.0)
    yield Deviation("no plastic strain", none, 0.5, "or the row tests nothing")


def carries(trial: Trial) -> Iterator[Deviation]:
    """Sum of q over sum of p is the coefficient."""
    found, expected = trial.quantities["friction_coefficient"], trial.scene.friction.coefficient
    yield relative("sum of q over sum of p", found, expected, 1e-9, reason="q = mu p in each cell: rounding")


def frictionless(trial: Trial) -> Iterator[Deviation]:
    """Without friction there is no tangential traction."""
    found = abs(trial.quantities["friction_coefficient"])
    yield Deviation("sum of q over sum of p", found, 1e-300, "there is no q")


def signs(trial: Trial) -> Iterator[Deviation]:
    """The coefficient of friction is never negative; the sign of the traction is a column of its own."""
    cycles, mu = trial.result.tables["cycles"], trial.scene.friction.coefficient
    for k, found in enumerate(cycles["friction_coefficient"], start=1):
        yield Deviation(f"coefficient of cycle {k}", abs(found - mu), 1e-9, "q = mu p: rounding")
    wanted = [1, -1] * (len(cycles["cycle"]) // 2)
    wrong = float(list(cycles.get("friction_sign", [])) != wanted)
    yield Deviation("sign of the traction by cycle", wrong, 0.5, "+x in odd cycles, -x in even ones")


def stays_elastic(trial: Trial) -> Iterator[Deviation]:
    """The largest von Mises stress of the elastic sphere, 0.28 E e/(1 - nu) but for the image."""
    body, misfit = trial.scene.body, trial.scene.loading.misfit
    exact = 0.28 * body.young * misfit / (1.0 - body.poisson)
    off = abs(trial.quantities["mises_max_Pa"] / exact - 1.0)
    yield Deviation("largest von Mises stress", off, 0.05, "8 cells in the radius, and the free surface")
    yield Deviation("plastic strain", trial.quantities["peeq_max"], 1e-15, TOLERANCE)


def square_punch(trial: Trial) -> Iterator[Deviation]:
    """A square pressed by a plane: F = 2 beta E* sqrt(A/pi) approach (King 1987)."""
    expected = trial.scene.loading.force / (2 * KING * modulus_of(trial.scene) * SIDE / sqrt(pi))
    found, reason = trial.quantities["approach_m"], "32 cells along the side"
    yield relative("approach, square punch", found, expected, 0.005, reason=reason)


def warned(trial: Trial) -> Iterator[Deviation]:
    """Contact at the border of a patch is said."""
    said = any("border" in text or "edge" in text for text in trial.result.warnings)
    yield Deviation("no warning of the border", float(not said), 0.5, "a patch is cut out of a surface")


def all_touch(trial: Trial) -> Iterator[Deviation]:
    """Every cell is in contact; then the problem is linear: equal increments of the force, equal ones of the
    approach.
    """
    force, found = trial.scene.loading.force, [trial.quantities["approach_m"]]
    apart = PATCH**2 - trial.result.discretisation["contact_cells"]
    yield Deviation("cells that do not touch", apart, 0.5, "all do")
    for factor in (1.25, 1.5):
        twin = trial.bench.converged(other(trial.scene, {"loading.force": factor * force}), trial.model)
        found.append(twin.quantities["approach_m"])
    first, second = np.diff(found)
    yield relative("increment of the approach", second, first, 1e-6, reason="all cells touch: linear")


def covers(trial: Trial) -> Iterator[Deviation]:
    """The error of Hertz's pressure and approach is no larger than the uncertainty."""
    exact = contact_of(trial.scene)
    for name, value in (("p_max_Pa", exact.peak_pressure), ("approach_m", exact.approach)):
        share = abs(trial.quantities[name] - value) / trial.result.uncertainty[name]["u_num"]
        yield Deviation(f"error of {name} over its uncertainty", share, 1.0, "what an uncertainty is")


def zero(trial: Trial) -> Iterator[Deviation]:
    """Nothing is uncertain where nothing happens."""
    entries = trial.result.uncertainty.values()
    yield Deviation("uncertainty", max(entry["u_num"] or 0.0 for entry in entries), 1e-30, "no load")


def reached(trial: Trial) -> Iterator[Deviation]:
    """The accuracy that was asked for."""
    found = trial.result.discretisation["accuracy"]
    yield Deviation("uncertainty over accuracy", found["relative"] / found["asked"], 1.0, "as asked")


CHECKS: Mapping[str, Check] = {
    "balanced": balanced,
    "balanced-sam": balanced_sam,
    "no yield beyond": lambda trial: within_tolerance(trial, "yield_excess"),
    "flow": lambda trial: within_tolerance(trial, "yield_excess", "flow_residual"),
    "mirrored": as_twin("mirrored in x", "a reflection", turned),
} | {
    check.__name__.replace("_", "-"): check
    for check in (
        *(nothing_touches, yields, carries, frictionless, signs, stays_elastic),
        *(square_punch, warned, all_touch, covers, zero, reached),
    )
}
"""Checks by the names that rows give them."""
MADE: Mapping[str, Callable[..., Check]] = {
    "refinement": within_refinement,
    "without": without,
    "patch": as_patch,
    "sum": as_sum,
}
"""Checks that rows name with what they are about; every other one is a comparison as `against` makes it."""


def check_of(said: str | list) -> Check:
    """A check as a row says it: a name, or what to compare with and how."""
    if isinstance(said, str):
        return CHECKS[said]
    target, *how = said
    return MADE[target](*how) if isinstance(target, str) and target in MADE else against(target, *how)
