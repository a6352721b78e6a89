# SPDX-License-Identifier: MIT
"""What a right cell of the robustness matrix is compared with: closed forms, limits, invariances, the other
model.
"""

import warnings
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from math import isfinite, pi, sqrt
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np

from sam.scene import HeightMap, Result, Scene
from verification.cost.accuracy import solve
from verification.quantities import contact_of, modulus_of
from verification.reference.coated_sphere import thin_layer
from verification.reference.flat_punch import FlatPunch
from verification.reference.hertz import CircularContact, effective_modulus, largest_von_mises
from verification.references import coated_contact, elliptic_contact, layers_of, rounded_contact
from verification.robustness.matrix.scenes import HERTZ, PATCH, RADIUS, SIDE, other, scene_with
from verification.runs.models import FEM, SAM

TOLERANCE = "the tolerance of the scene"
"""Why a certificate has its bound. A solver stops as near to it as it can: such a comparison tells least of a
cell."""
COARSE = {SAM: "8 cells of equal pressure in the contact radius", FEM: "8 elements in the contact radius"}
KING = 1.012  # compliance of a disc over that of a square of its area: Int. J. Solids Struct. 23 (1987) 1657


@dataclass(frozen=True)
class Deviation:
    """One comparison. error: of `what`, with the sign taken off; bound: largest allowed, with the reason for
    its size.
    """

    what: str
    error: float
    bound: float
    reason: str

    @property
    def share(self) -> float:
        """Error over bound; infinite for what is not a number."""
        return self.error / self.bound if isfinite(self.error) else float("inf")


class Bench:
    """Solves scenes, each once: what one row compares with may be the cell of another."""

    def __init__(self):
        self._solved: dict[tuple[str, str], tuple[Result, str]] = {}

    def solve(self, scene: Scene, model: str) -> Result:
        """The result, whatever its status. Raises ModelError, and RuntimeError for a solve that was not
        silent.
        """
        if model == FEM:
            scene = scene.model_copy(update={"grid": None})  # it has a mesh of its own
        key = scene.model_dump_json(), model
        if key not in self._solved:
            with warnings.catch_warnings(record=True) as heard, np.errstate(all="warn", under="ignore"):
                warnings.simplefilter("always")
                result = solve(scene, model)
            texts = (f"{each.message} ({Path(each.filename).name})" for each in heard[:3])
            self._solved[key] = result, "; ".join(texts)
        result, said = self._solved[key]
        if said:
            raise RuntimeError(said)
        return result

    def converged(self, scene: Scene, model: str) -> Result:
        """For a comparison. RuntimeError when it did not converge."""
        result = self.solve(scene, model)
        if not result.converged:
            raise RuntimeError(f"{model} for comparison ended {result.status}: {result.message}")
        return result


@dataclass(frozen=True)
class Trial:
    """A solved cell, for its checks."""

    scene: Scene
    model: str
    result: Result
    bench: Bench

    def __getitem__(self, quantity: str) -> float:
        return self.result.quantities[quantity]

    def of(self, scene: Scene) -> Result:
        """The result of another scene in the same model."""
        return self.bench.converged(scene, self.model)


Check = Callable[[Trial], list[Deviation]]


def given_approach(scene: Scene) -> CircularContact:
    """Of a sphere, by the force that its approach takes (Johnson 1985, Eq. 4.23)."""
    modulus, approach, radius = modulus_of(scene), scene.loading.approach, scene.counterbody.radius
    return CircularContact(4 / 3 * modulus * sqrt(radius * approach) * approach, radius, modulus)


def squeezed(scene: Scene) -> SimpleNamespace:
    """A thin soft film on a rigid body (Johnson 1985, 5.8): p0, and the approach a^2/(2 R), where a goes with
    the force to the power 1/4.
    """
    layers = layers_of(scene)
    _, unit = thin_layer(layers, RADIUS, HERTZ)
    a = HERTZ * (scene.loading.force / unit) ** 0.25
    largest = thin_layer(layers, RADIUS, a)[0]
    return SimpleNamespace(pressure=lambda r: largest, approach=a**2 / (2 * RADIUS))


def film_alone(scene: Scene) -> CircularContact:
    """The film as a half-space."""
    film = scene.body.coating
    return CircularContact(scene.loading.force, RADIUS, effective_modulus(film.young, film.poisson))


FORMS: Mapping[str, Callable[[Scene], Any]] = {
    "Hertz": contact_of,
    "Hertz, given approach": given_approach,
    "elliptic Hertz": elliptic_contact,
    "Boussinesq": lambda scene: FlatPunch(scene.loading.force, scene.counterbody.radius, modulus_of(scene)),
    "rounded punch": rounded_contact,
    "coated half-space": coated_contact,
    "thin film": squeezed,
    "limit of a thick film": film_alone,
    "Hertz of the body": contact_of,
}
"""Closed forms by the names that rows give them: scene -> contact."""
VALUES: Mapping[str, Callable[[Any, float], float]] = {
    "force_N": lambda exact, nu: exact.force,
    "approach_m": lambda exact, nu: exact.approach,
    "p_center_Pa": lambda exact, nu: float(exact.pressure(0.0)),
    "p_max_Pa": lambda exact, nu: exact.peak_pressure,
    "mises_max_Pa": lambda exact, nu: largest_von_mises(exact.peak_pressure, exact.contact_radius, nu)[0],
}
"""Quantity -> its value in a contact on a body of Poisson's ratio nu."""


def relative(what: str, pair: tuple[float | None, float], bound: float, reason: str) -> Deviation:
    """Of a value that is not 0 from what it should be; one that is missing is as far as can be."""
    value, expected = pair
    error = float("nan") if value is None else abs(value / expected - 1.0)
    return Deviation(what, error, bound, reason)


def unless(right: bool, what: str, reason: str) -> list[Deviation]:
    """Of what is there or not: 0 where it is as expected, else 1."""
    return [Deviation(what, float(not right), 0.5, reason)]


def against(
    trial: Trial, target: str | Mapping[str, Any], bounds: Mapping[str, float], reason: str = ""
) -> list[Deviation]:
    """Quantities, each within its own bound, against a closed form of FORMS, against another model (which is
    itself compared with SAM), or against the scene with other values in the same model; no reason: it is the
    size of the cells.
    """
    expected: Mapping[str, Any]
    if not isinstance(target, str):
        words = f"as with {', '.join(f'{key} = {value}' for key, value in target.items())}"
        expected = trial.of(other(trial.scene, target)).quantities
    elif target in FORMS:
        words, exact = target, FORMS[target](trial.scene)
        expected = {name: VALUES[name](exact, trial.scene.body.poisson) for name in bounds}
    else:
        words = SAM if trial.model == target else target
        expected = trial.bench.converged(trial.scene, words).quantities
    return [
        relative(f"{name}, {words}", (trial[name], expected[name]), bound, reason or COARSE[trial.model])
        for name, bound in bounds.items()
    ]


def coarser(scene: Scene, model: str, fine: Result) -> Scene:
    """The scene in cells 1.5 times as large: of SAM on the same sides of the grid, of FEM by its elements."""
    if model != SAM:
        return other(scene, {"fem.cells_per_radius": round(scene.fem.cells_per_radius / 1.5)})
    cells, sides = fine.discretisation["cells"], fine.discretisation["cell_m"]
    fewer = tuple(2 * round(n / 3) + 1 for n in cells)
    extent = tuple(n * h for n, h in zip(cells, sides, strict=True))
    return other(scene, {"grid": {"cells": fewer, "extent": extent}})


def within_refinement(trial: Trial, name: str) -> list[Deviation]:
    """A quantity of SAM and axisymmetric FEM, within the refinement uncertainties of both.

    The uncertainty is Richardson's for first order, the least that a converging value has: h/(1.5 h - h) = 2
    times what the step from cells 1.5 times as large changes.
    """
    model = FEM if trial.model == SAM else SAM
    twin, sizes = trial.bench.converged(trial.scene, model), []
    for each, fine in ((trial.model, trial.result), (model, twin)):
        coarse = trial.bench.converged(coarser(trial.scene, each, fine), each)
        sizes.append(2.0 * abs(fine.quantities[name] - coarse.quantities[name]))
    value, difference = abs(trial[name]), abs(trial[name] - twin.quantities[name])
    shares = " + ".join(f"{1e2 * size / value:.2g}" for size in sizes)
    words = f"{name}, {model}, over both refinement uncertainties ({shares} %)"
    return [
        Deviation(words, difference / sum(sizes), 1.0, "cells 1.5 times as large, first order"),
        Deviation(f"{name}, its uncertainties", sum(sizes) / value, 0.25, "or the row tests nothing"),
    ]


def without(trial: Trial, name: str, words: str) -> list[Deviation]:
    """A quantity has no uncertainty, and the reason has these words."""
    entry = trial.result.uncertainty[name]
    right = entry["u_num"] is None and words in entry["flag"]
    return unless(right, f"no uncertainty of {name}", "0: it is as expected, 1: it is not")


def as_twin(trial: Trial, words: str, reason: str, twin: Scene) -> list[Deviation]:
    """The same approach as of another scene, and on the whole patch (maxima leave its border out) the same
    largest pressure and cells in contact.
    """

    def whole(result: Result) -> dict[str, float]:
        pressure, approach = np.asarray(result.fields.cell_data["p_Pa"]), result.quantities["approach_m"]
        touching = float(np.count_nonzero(pressure > 0))
        return {"approach": approach, "largest pressure": np.nanmax(pressure), "cells in contact": touching}

    expected = whole(trial.of(twin))
    return [
        relative(f"{name}, {words}", (value, expected[name]), 1e-6, reason)
        for name, value in whole(trial.result).items()
    ]


def pressed(name: str, force: float) -> Scene:
    """A plane pressed on heights of that name."""
    rough = {"counterbody": {"shape": "flat"}, "surface": {"kind": "file", "path": name}}
    return scene_with(rough | {"grid": "none", "loading.force": force})


def as_patch(trial: Trial, name: str) -> list[Deviation]:
    """As of a smaller patch that holds all that touches."""
    reason = "the cells beside are not touched: one discrete problem"
    return as_twin(trial, "the part alone", reason, pressed(name, trial.scene.loading.force))


def as_sum(trial: Trial, name: str) -> list[Deviation]:
    """As of the sum of the heights on the body under a plane."""
    return as_twin(trial, "heights on the body", "the same gap, rounded differently", pressed(name, 1.0))


def mirrored(trial: Trial) -> list[Deviation]:
    """As of the surface turned over in x."""
    path = trial.scene.surface.path
    turned = other(trial.scene, {"surface.path": HeightMap(path.values[::-1], path.extent)})
    return as_twin(trial, "mirrored in x", "a reflection", turned)


def balanced(trial: Trial) -> list[Deviation]:
    """The force is that of the scene, and the certificate of the contact holds."""
    force = relative("force_N", (trial["force_N"], trial.scene.loading.force), 1e-9, "rounding")
    return [force, *within_tolerance(trial, "gap_in_contact", "penetration")]


def within_tolerance(trial: Trial, *names: str) -> list[Deviation]:
    """Those of the certificates that there are."""
    found, tolerance = trial.result.certificate, trial.scene.solver.tolerance
    return [Deviation(name, found[name], tolerance, TOLERANCE) for name in names if name in found]


def carries(trial: Trial) -> list[Deviation]:
    """Sum of q over sum of p is the coefficient."""
    pair = trial["friction_coefficient"], trial.scene.friction.coefficient
    return [relative("sum of q over sum of p", pair, 1e-9, "q = mu p in each cell: rounding")]


def signs(trial: Trial) -> list[Deviation]:
    """The coefficient of friction is never negative; the sign of the traction is a column of its own."""
    cycles, mu = trial.result.tables["cycles"], trial.scene.friction.coefficient
    found = [
        Deviation(f"coefficient of cycle {k}", abs(each - mu), 1e-9, "q = mu p: rounding")
        for k, each in enumerate(cycles["friction_coefficient"], start=1)
    ]
    right = list(cycles.get("friction_sign", [])) == [1, -1] * (len(cycles["cycle"]) // 2)
    return found + unless(right, "sign of the traction by cycle", "+x in odd cycles, -x in even ones")


def stays_elastic(trial: Trial) -> list[Deviation]:
    """The largest von Mises stress of the elastic sphere, 0.28 E e/(1 - nu) but for the image."""
    body, misfit = trial.scene.body, trial.scene.loading.misfit
    pair = trial["mises_max_Pa"], 0.28 * body.young * misfit / (1.0 - body.poisson)
    return [
        relative("largest von Mises stress", pair, 0.05, "8 cells in the radius, and the free surface"),
        Deviation("plastic strain", trial["peeq_max"], 1e-15, TOLERANCE),
    ]


def square_punch(trial: Trial) -> list[Deviation]:
    """A square pressed by a plane: F = 2 beta E* sqrt(A/pi) approach (King 1987)."""
    exact = trial.scene.loading.force / (2 * KING * modulus_of(trial.scene) * SIDE / sqrt(pi))
    pair = trial["approach_m"], exact
    return [relative("approach, square punch", pair, 0.005, "32 cells along the side")]


def warned(trial: Trial) -> list[Deviation]:
    """Contact at the border of a patch is said."""
    said = any("border" in text or "edge" in text for text in trial.result.warnings)
    return unless(said, "no warning of the border", "a patch is cut out of a surface")


def all_touch(trial: Trial) -> list[Deviation]:
    """Every cell is in contact; then the problem is linear: equal increments of the force, equal ones of the
    approach.
    """
    forces = [factor * trial.scene.loading.force for factor in (1.25, 1.5)]
    twins = [trial.of(other(trial.scene, {"loading.force": force})) for force in forces]
    first, second = np.diff([trial["approach_m"], *(twin.quantities["approach_m"] for twin in twins)])
    apart = PATCH**2 - trial.result.discretisation["contact_cells"]
    return [
        Deviation("cells that do not touch", apart, 0.5, "all do"),
        relative("increment of the approach", (second, first), 1e-6, "all cells touch: linear"),
    ]


def covers(trial: Trial) -> list[Deviation]:
    """The error of Hertz's pressure and approach is no larger than the uncertainty."""
    exact, found = contact_of(trial.scene), trial.result.uncertainty
    deviations = []
    for name, value in (("p_max_Pa", exact.peak_pressure), ("approach_m", exact.approach)):
        share, what = abs(trial[name] - value) / found[name]["u_num"], f"error of {name} over its uncertainty"
        deviations.append(Deviation(what, share, 1.0, "what an uncertainty is"))
    return deviations


def zero(trial: Trial) -> list[Deviation]:
    """Nothing is uncertain where nothing happens."""
    largest = max(entry["u_num"] or 0.0 for entry in trial.result.uncertainty.values())
    return [Deviation("uncertainty", largest, 1e-30, "no load")]


def reached(trial: Trial) -> list[Deviation]:
    """The accuracy that was asked for."""
    found = trial.result.discretisation["accuracy"]
    return [Deviation("uncertainty over accuracy", found["relative"] / found["asked"], 1.0, "as asked")]


def nothing(trial: Trial, names: str, reason: str) -> list[Deviation]:
    """Quantities are 0."""
    return [Deviation(f"{name}, which is 0", abs(trial[name]), 1e-300, reason) for name in names.split()]


NONE = "approach_m contact_area_m2 p_max_Pa mises_max_Pa"
CHECKS: Mapping[str, Check] = {
    "all-touch": all_touch,
    "balanced": balanced,
    "balanced-sam": lambda trial: balanced(trial) if trial.model == SAM else [],
    "carries": carries,
    "covers": covers,
    "flow": lambda trial: within_tolerance(trial, "yield_excess", "flow_residual"),
    "frictionless": lambda trial: nothing(trial, "friction_coefficient", "there is no q"),
    "mirrored": mirrored,
    "no yield beyond": lambda trial: within_tolerance(trial, "yield_excess"),
    "nothing-touches": lambda trial: nothing(trial, NONE, "nothing touches"),
    "reached": reached,
    "signs": signs,
    "square-punch": square_punch,
    "stays-elastic": stays_elastic,
    "warned": warned,
    "yields": lambda trial: unless(trial["peeq_max"] > 0.0, "no plastic strain", "or the row tests nothing"),
    "zero": zero,
}
"""Checks by the names that rows give them."""
MADE: Mapping[str, Callable[..., list[Deviation]]]
MADE = {"refinement": within_refinement, "without": without, "patch": as_patch, "sum": as_sum}
"""Checks that rows name with what they are about; every other one is a comparison as `against` makes it."""


def check_of(said: str | list) -> Check:
    """A check as a row says it: a name, or what to compare with and how."""
    if isinstance(said, str):
        return CHECKS[said]
    target, *how = said
    if isinstance(target, str) and target in MADE:
        return lambda trial: MADE[target](trial, *how)
    return lambda trial: against(trial, target, *how)
