# SPDX-License-Identifier: MIT
"""What a right cell of the robustness matrix is compared with: closed forms, limits, invariances, the other
model.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from math import pi, sqrt
from typing import Any

from sam.scene import Result, Scene
from verification.quantities import modulus_of
from verification.references import elliptic_contact, flat_punch, hertz_sphere, rounded_contact
from verification.robustness.matrix.row import TOLERANCE, Check, Deviation, Trial, other
from verification.runs.models import FEM, SAM

COARSE = {SAM: "8 cells of equal pressure in the contact radius", FEM: "8 elements in the contact radius"}
ROUNDING = 1e-9


def relative(what: str, value: float | None, expected: float, bound: float, *, reason: str) -> Deviation:
    """Of a value that is not 0; one that is missing is as far as can be."""
    error = float("nan") if value is None else abs(value / expected - 1.0)
    return Deviation(what, error, bound, reason)


def against(
    words: str,
    expected: Callable[[Trial], Mapping[str, float]],
    bounds: Mapping[str, float],
    reason: str = "",
) -> Check:
    """Quantities against expected ones, each within its own bound; no reason: it is the size of the cells."""

    def check(trial: Trial) -> Iterator[Deviation]:
        values, why = expected(trial), reason or COARSE[trial.model]
        for name, bound in bounds.items():
            yield relative(f"{name}, {words}", trial.quantities[name], values[name], bound, reason=why)

    return check


def hertz(pressure: float = 0.005, approach: float = 0.002, mises: float | None = 0.01) -> Check:
    """Circular contact in closed form, with bounds for p0, approach and von Mises stress (None: not
    compared).
    """
    keys = {"p_center_Pa": "p-max", "approach_m": "approach", "mises_max_Pa": "mises-max"}

    def expected(trial: Trial) -> dict[str, float]:
        exact = hertz_sphere(trial.scene).values
        return {name: exact[key] for name, key in keys.items()}

    bounds = {"p_center_Pa": pressure, "approach_m": approach} | ({"mises_max_Pa": mises} if mises else {})
    return against("Hertz", expected, bounds)


def force_of_hertz(trial: Trial) -> Iterator[Deviation]:
    """The force and the largest pressure that a given approach of a sphere takes (Johnson 1985, Eq. 4.23)."""
    scene, modulus = trial.scene, modulus_of(trial.scene)
    approach, radius = scene.loading.approach, scene.counterbody.radius
    force, pressure = 4 / 3 * sqrt(radius * approach) * approach, 2 / pi * sqrt(approach / radius)
    expected = {"force_N": modulus * force, "p_center_Pa": modulus * pressure}
    yield from against("Hertz", lambda _: expected, {"force_N": 0.003, "p_center_Pa": 0.005})(trial)
    yield relative("approach_m", trial.quantities["approach_m"], approach, ROUNDING, reason="it is given")


def ellipse() -> Check:
    """Elliptic contact in closed form."""

    def expected(trial: Trial) -> dict[str, float]:
        exact = elliptic_contact(trial.scene)
        return {"p_max_Pa": exact.peak_pressure, "approach_m": exact.approach}

    return against("elliptic Hertz", expected, {"p_max_Pa": 0.01, "approach_m": 0.005})


def punch(approach: float) -> Check:
    """Flat-ended cylinder in closed form."""

    def expected(trial: Trial) -> dict[str, float]:
        return {"approach_m": flat_punch(trial.scene).values["approach"]}

    reason = "the edge, where the pressure is singular, is one cell wide"
    return against("Boussinesq", expected, {"approach_m": approach}, reason)


def rounded_punch() -> Check:
    """Punch with a rounded edge in closed form."""

    def expected(trial: Trial) -> dict[str, float]:
        exact = rounded_contact(trial.scene)
        return {"approach_m": exact.approach, "p_center_Pa": float(exact.pressure(0.0))}

    return against("rounded punch", expected, {"approach_m": 0.01, "p_center_Pa": 0.01})


def nothing_touches(trial: Trial) -> Iterator[Deviation]:
    """No force: no approach, area, pressure and stress, exactly."""
    for name in ("approach_m", "contact_area_m2", "p_max_Pa", "mises_max_Pa"):
        yield Deviation(f"{name} without force", abs(trial.quantities[name]), 1e-300, "nothing touches")


def same_as(
    changes: Mapping[str, Any], bound: float, reason: str, names=("p_max_Pa", "approach_m", "mises_max_Pa")
) -> Check:
    """The same quantities as of the scene with other values, in the same model."""

    def twin(trial: Trial) -> Mapping[str, float]:
        return trial.bench.converged(other(trial.scene, changes), trial.model).quantities

    words = f"as with {', '.join(f'{key} = {value}' for key, value in changes.items())}"
    return against(words, twin, dict.fromkeys(names, bound), reason)


def as_other_model(model: str, bounds: Mapping[str, float], reason: str) -> Check:
    """Quantities of another model, each within its own bound."""
    return against(model, lambda trial: trial.bench.converged(trial.scene, model).quantities, bounds, reason)


def within_refinement(
    model: str, name: str, coarser: Mapping[str, Callable[[Scene, Result], Scene]]
) -> Check:
    """A quantity of another model, within the refinement uncertainties of both.

    The uncertainty is Richardson's for first order, the least that a converging value has: h/(1.5 h - h) = 2
    times what the step from cells 1.5 times as large changes. coarser: model -> the scene with such cells.
    """

    def check(trial: Trial) -> Iterator[Deviation]:
        twin, sizes = trial.bench.converged(trial.scene, model), []
        for each, fine in ((trial.model, trial.result), (model, twin)):
            coarse = trial.bench.converged(coarser[each](trial.scene, fine), each)
            sizes.append(2.0 * abs(fine.quantities[name] - coarse.quantities[name]))
        value, difference = abs(trial.quantities[name]), abs(trial.quantities[name] - twin.quantities[name])
        shares = " + ".join(f"{1e2 * size / value:.2g}" for size in sizes)
        words = f"{name}, {model}, over both refinement uncertainties ({shares} %)"
        yield Deviation(words, difference / sum(sizes), 1.0, "cells 1.5 times as large, first order")
        yield Deviation(f"{name}, its uncertainties", sum(sizes) / value, 0.25, "or the row tests nothing")

    return check


def balanced(trial: Trial) -> Iterator[Deviation]:
    """The force is that of the scene, and the certificate of the contact holds."""
    yield relative(
        "force_N", trial.quantities["force_N"], trial.scene.loading.force, ROUNDING, reason="rounding"
    )
    yield from within_tolerance(trial, "gap_in_contact", "penetration")


def residuals_hold(trial: Trial) -> Iterator[Deviation]:
    """No stress beyond yield, and the flow rule, on the returned fields."""
    yield from within_tolerance(trial, "yield_excess", "flow_residual")


def within_tolerance(trial: Trial, *names: str) -> Iterator[Deviation]:
    """Those of the certificates that there are."""
    for name in names:
        if name in trial.result.certificate:
            yield Deviation(name, trial.result.certificate[name], trial.scene.solver.tolerance, TOLERANCE)


def yields(trial: Trial) -> Iterator[Deviation]:
    """The extreme is one: there is plastic strain."""
    none = float(not trial.quantities["peeq_max"] > 0.0)
    yield Deviation("no plastic strain", none, 0.5, "or the row tests nothing")
