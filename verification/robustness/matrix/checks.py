# SPDX-License-Identifier: MIT
"""What a right cell of the robustness matrix is compared with: closed forms, limits, invariances, the other
model.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from math import pi, sqrt
from typing import Any

from sam.scene import Result, Scene
from verification.reference.elliptic import EllipticContact
from verification.reference.flat_punch import FlatPunch
from verification.reference.hertz import CircularContact, effective_modulus, largest_von_mises
from verification.reference.rounded_punch import RoundedPunch
from verification.robustness.matrix.row import TOLERANCE, Check, Deviation, Trial
from verification.robustness.matrix.scenes import other
from verification.runs.models import FEM, SAM

COARSE = {SAM: "8 cells of equal pressure in the contact radius", FEM: "8 elements in the contact radius"}
ROUNDING = 1e-9


def relative(what: str, value: float | None, expected: float, bound: float, *, reason: str) -> Deviation:
    """Of a value that is not 0; one that is missing is as far as can be."""
    error = float("nan") if value is None else abs(value / expected - 1.0)
    return Deviation(what, error, bound, reason)


def modulus_of(scene: Scene) -> float:
    """E* in Pa of the body without coating and its counter-body."""
    counter = scene.counterbody
    return effective_modulus(scene.body.young, scene.body.poisson, counter.young, counter.poisson)


def hertz(pressure: float = 0.005, approach: float = 0.002, mises: float | None = 0.01) -> Check:
    """Circular contact in closed form, with bounds for p0, approach and von Mises stress (None: not
    compared).
    """

    def check(trial: Trial) -> Iterator[Deviation]:
        scene, found = trial.scene, trial.quantities
        exact = CircularContact(scene.loading.force, scene.counterbody.radius, modulus_of(scene))
        reason = COARSE[trial.model]
        yield relative("p0, Hertz", found["p_center_Pa"], exact.peak_pressure, pressure, reason=reason)
        yield relative("approach, Hertz", found["approach_m"], exact.approach, approach, reason=reason)
        if mises is not None:
            largest, _ = largest_von_mises(exact.peak_pressure, exact.contact_radius, scene.body.poisson)
            yield relative(
                "largest von Mises stress, Hertz", found["mises_max_Pa"], largest, mises, reason=reason
            )

    return check


def force_of_hertz(trial: Trial) -> Iterator[Deviation]:
    """The force and the largest pressure that a given approach of a sphere takes (Johnson 1985, Eq. 4.23)."""
    scene, found, reason = trial.scene, trial.quantities, COARSE[trial.model]
    approach, radius, modulus = scene.loading.approach, scene.counterbody.radius, modulus_of(scene)
    force, pressure = 4 / 3 * sqrt(radius * approach) * approach, 2 / pi * sqrt(approach / radius)
    yield relative("force, Hertz", found["force_N"], modulus * force, 0.003, reason=reason)
    yield relative("p0, Hertz", found["p_center_Pa"], modulus * pressure, 0.005, reason=reason)
    yield relative("approach", found["approach_m"], approach, ROUNDING, reason="it is given")


def ellipse(pressure: float = 0.01, approach: float = 0.005) -> Check:
    """Elliptic contact in closed form."""

    def check(trial: Trial) -> Iterator[Deviation]:
        scene, found = trial.scene, trial.quantities
        exact = EllipticContact(scene.loading.force, *scene.counterbody.radii, modulus_of(scene))
        yield relative(
            "p0, elliptic Hertz", found["p_max_Pa"], exact.peak_pressure, pressure, reason=COARSE[trial.model]
        )
        yield relative(
            "approach, elliptic Hertz",
            found["approach_m"],
            exact.approach,
            approach,
            reason=COARSE[trial.model],
        )

    return check


def punch(approach: float) -> Check:
    """Flat-ended cylinder in closed form."""

    def check(trial: Trial) -> Iterator[Deviation]:
        scene = trial.scene
        exact = FlatPunch(scene.loading.force, scene.counterbody.radius, modulus_of(scene))
        reason = "the edge, where the pressure is singular, is one cell wide"
        yield relative(
            "approach, Boussinesq", trial.quantities["approach_m"], exact.approach, approach, reason=reason
        )

    return check


def rounded_punch() -> Check:
    """Punch with a rounded edge in closed form."""

    def check(trial: Trial) -> Iterator[Deviation]:
        scene, other = trial.scene, trial.scene.counterbody
        exact = RoundedPunch(scene.loading.force, other.flat_radius, other.radius, modulus_of(scene))
        reason = COARSE[trial.model]
        for name, value in (("approach_m", exact.approach), ("p_center_Pa", float(exact.pressure(0.0)))):
            yield relative(f"{name}, rounded punch", trial.quantities[name], value, 0.01, reason=reason)

    return check


def nothing_touches(trial: Trial) -> Iterator[Deviation]:
    """No force: no approach, area, pressure and stress, exactly."""
    for name in ("approach_m", "contact_area_m2", "p_max_Pa", "mises_max_Pa"):
        yield Deviation(f"{name} without force", abs(trial.quantities[name]), 1e-300, "nothing touches")


def same_as(
    changes: Mapping[str, Any], bound: float, reason: str, names=("p_max_Pa", "approach_m", "mises_max_Pa")
) -> Check:
    """The same quantities as of the scene with other values, in the same model."""

    def check(trial: Trial) -> Iterator[Deviation]:
        twin = trial.bench.converged(other(trial.scene, changes), trial.model)
        for name in names:
            expected = twin.quantities[name]
            words = f"{name}, as with {', '.join(f'{key} = {value}' for key, value in changes.items())}"
            yield relative(words, trial.quantities[name], expected, bound, reason=reason)

    return check


def as_other_model(model: str, bounds: Mapping[str, float], reason: str) -> Check:
    """Quantities of another model, each within its own bound."""

    def check(trial: Trial) -> Iterator[Deviation]:
        twin = trial.bench.converged(trial.scene, model)
        for name, bound in bounds.items():
            yield relative(
                f"{name}, {model}", trial.quantities[name], twin.quantities[name], bound, reason=reason
            )

    return check


def within_refinement(
    model: str, name: str, coarser: Mapping[str, Callable[[Scene, Result], Scene]]
) -> Check:
    """A quantity of another model, within the refinement uncertainties of both.

    The uncertainty is Richardson's for first order, the least that a converging value has: h/(1.5 h - h) = 2
    times what the step from cells 1.5 times as large changes. coarser: model -> the scene with such cells.
    """

    def uncertainty(trial: Trial, scene: Scene, each: str, fine: Result) -> float:
        coarse = trial.bench.converged(coarser[each](scene, fine), each)
        return 2.0 * abs(fine.quantities[name] - coarse.quantities[name])

    def check(trial: Trial) -> Iterator[Deviation]:
        twin = trial.bench.converged(trial.scene, model)
        difference = abs(trial.quantities[name] - twin.quantities[name])
        sizes = [
            uncertainty(trial, trial.scene, each, result)
            for each, result in ((trial.model, trial.result), (model, twin))
        ]
        value = abs(trial.quantities[name])
        shares = " + ".join(f"{1e2 * size / value:.2g}" for size in sizes)
        words = f"{name}, {model}, over both refinement uncertainties ({shares} %)"
        yield Deviation(words, difference / sum(sizes), 1.0, "cells 1.5 times as large, first order")
        yield Deviation(f"{name}, its uncertainties", sum(sizes) / value, 0.25, "or the row tests nothing")

    return check


def balanced(trial: Trial) -> Iterator[Deviation]:
    """The force is that of the scene, and the certificate of the contact holds."""
    certificate, force = trial.result.certificate, trial.scene.loading.force
    yield relative("force_N", trial.quantities["force_N"], force, ROUNDING, reason="rounding")
    for name in ("gap_in_contact", "penetration"):
        if name in certificate:
            yield Deviation(name, certificate[name], trial.scene.solver.tolerance, TOLERANCE)
