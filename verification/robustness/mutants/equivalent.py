# SPDX-License-Identifier: MIT
"""Equivalent mutants: what a perturbation changes in the numbers that small scenes return."""

import sys
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from importlib import import_module

import numpy as np

from sam.scene import Scene
from verification.robustness.mutants import inject
from verification.robustness.mutants.changes import Mutant
from verification.robustness.mutants.judge import forked
from verification.robustness.mutants.scope import constants
from verification.runs import models

WITHIN = 10.0
"""A number may change by this many tolerances of its solver."""
SECONDS = 60.0
STEEL = {"young": 210e9, "poisson": 0.3}
SWIFT = {"law": "swift", "B": 945e6, "C": 20.0, "n": 0.121}
YIELDING = STEEL | {"plasticity": SWIFT}
KINEMATIC = {"kinematic": {"modulus": (60e9, 6e9), "recovery": (300.0, 3.0)}}
COATED = STEEL | {"coating": {"thickness": 1e-6, "young": 400e9, "poisson": 0.2}}
LINEAR = STEEL | {"plasticity": {"law": "linear", "yield_stress": 1e9, "modulus": 10e9}}
SPHERE = {"shape": "sphere", "radius": 105e-6}
TWO_STEPS, THREE_STEPS = ({"steps": steps, "unload": True} for steps in (2, 3))
GROWTH = {"prescribed": "misfit-sphere", "depth": 35e-6, "radius": 10e-6, "misfit": 0.02, "steps": 2}
GROWTH |= {"profile": "gauss", "surface": "held"}
ELEMENTS = {"fem": {"cells_per_radius": 4}}


def pressed(body: Mapping, counter: Mapping, force: float, **loading) -> dict:
    """The tables of a contact."""
    return {"body": body, "counterbody": counter, "loading": {"force": force, **loading}}


def on(cells: int, tolerance: float, **solver) -> dict:
    """The tables of a square grid."""
    return {"grid": {"cells": (cells, cells)}, "solver": {"tolerance": tolerance, **solver}}


def sliding(coefficient: float) -> dict:
    """The table of friction."""
    return {"friction": {"coefficient": coefficient}}


ELASTIC = SPHERE | {"young": 70e9, "poisson": 0.2}
BACK = STEEL | {"plasticity": SWIFT | KINEMATIC}
PUNCH = {"shape": "rounded-punch", "flat_radius": 5e-6, "radius": 100e-6}
FILM = {"law": "chemical-film", "low": 0.1, "high": 0.4, "strain_limit": 0.0204}
FILM |= {"film_thickness": 100e-9, "film_young": 80e9, "film_poisson": 0.3, "film_yield": 0.67e9}
SURFACE = {"kind": "self-affine", "ra": 1e-7, "cutoff_long": 16e-6, "cutoff_short": 8e-6}
DEPTHS = (0.0, 0.2e-6, 0.4e-6, 0.7e-6, 1.2e-6, 2e-6, 3.5e-6, 6e-6)
RUNNING_IN = pressed(YIELDING, {"shape": "flat"}, 0.06, **TWO_STEPS) | {
    "surface": SURFACE | {"hurst": 0.8, "seed": 1},
    "friction": FILM,
    "wear": {"strain_limit": 0.002},
    "grid": {"cells": (24, 24), "extent": (16e-6, 16e-6), "depths": DEPTHS, "border": "relief"},
    "solver": {"tolerance": 1e-5},
}
BY_APPROACH = {"body": STEEL, "counterbody": PUNCH, "loading": {"approach": 1e-7}}
GROWING = {"body": LINEAR, "loading": GROWTH}
PROBES: Mapping[str, Mapping[str, Mapping]] = {
    models.SAM: {
        "elastic sphere that slides": pressed(STEEL, ELASTIC, 0.1) | sliding(0.3) | on(49, 1e-9),
        "coated half-space that slides": pressed(COATED, ELASTIC, 0.1) | sliding(0.2) | on(33, 1e-8),
        "plastic sphere": pressed(YIELDING, SPHERE, 0.17, **THREE_STEPS) | on(33, 1e-6),
        "sphere with back-stresses": pressed(BACK, SPHERE, 0.17, **TWO_STEPS) | on(17, 1e-6),
        "punch with a rounded edge": BY_APPROACH | on(65, 1e-9),
        "the loops of the paper": pressed(YIELDING, SPHERE, 0.1, steps=2) | on(17, 1e-4, method="paper"),
        "running-in": RUNNING_IN,
        "misfit sphere": GROWING | on(13, 1e-6),
    },
    models.FEM: {
        "plastic sphere of elements": pressed(YIELDING, SPHERE, 0.17, **THREE_STEPS) | ELEMENTS,
        "elements with back-stresses": pressed(BACK, SPHERE, 0.17, **TWO_STEPS) | ELEMENTS,
        "misfit sphere of elements": GROWING | ELEMENTS,
        "coated sphere of elements": pressed(COATED, SPHERE, 0.1) | ELEMENTS,
    },
    models.FEM_3D: {
        "coated sphere of hexahedra that slides": pressed(COATED, SPHERE, 0.1)
        | sliding(0.2)
        | {"fem": {"cells_per_radius": 4, "box": 5.0}}
    },
}
"""Solver -> title -> tables of a scene."""
NO_ANSWER = ("iterations", "residual", "operator_applications")


def solved(solver: str, title: str) -> dict[str, np.ndarray]:
    """All numbers of the result of a probe but its work: the quantities, and the columns of the tables but
    those of NO_ANSWER. The table of all residuals has a row for each iteration, and the goals that the
    constants set.
    """
    result = models.solve(Scene.model_validate({"title": title, **PROBES[solver][title]}), solver)
    if not result.converged:
        raise ArithmeticError(f"{title} ended {result.status}: {result.message}")
    found = {name: np.array([value]) for name, value in result.quantities.items() if value is not None}
    for table in result.tables.keys() - {"residuals"}:
        for name, column in result.tables[table].items():
            if (values := np.asarray(column)).dtype.kind == "f" and name not in NO_ANSWER:
                found[f"{table}.{name}"] = values
    return found


SHARES = {"_Pa": 1e-3, "_m": 1e-6, "_N": 1e-6}
"""By unit: share of the largest number in it, below which the numbers of a column are rounding by symmetry.
"""


def change(before: Mapping[str, np.ndarray], after: Mapping[str, np.ndarray]) -> float:
    """Largest change of a number over the largest of its column, or of its unit times SHARES."""
    if before.keys() != after.keys() or any(before[name].shape != after[name].shape for name in before):
        return np.inf
    tops = {name: np.abs(np.nan_to_num(values)).max(initial=0.0) for name, values in before.items()}
    worst = 0.0
    for name, values in before.items():
        unit = next((unit for unit in SHARES if name.endswith(unit)), "")
        alike = (top for other, top in tops.items() if other.endswith(unit))
        floor = SHARES[unit] * max(alike) if unit else 0.0
        if (scale := max(tops[name], floor)) > 0:
            worst = max(worst, float(np.abs(np.nan_to_num(after[name] - values)).max(initial=0.0) / scale))
    return worst


@dataclass(frozen=True)
class Shown:
    """change: largest, in tolerances of the solver; probes: how many of them run the module."""

    mutant: Mutant
    reason: str
    change: float
    probes: int

    @property
    def equivalent(self) -> bool:
        return self.probes > 0 and self.change <= WITHIN


def observed(solver: str, title: str) -> tuple[dict[str, np.ndarray], set[str]]:
    """The numbers of a probe, and the files of the project that ran."""
    files: set[str] = set()
    sys.settrace(lambda frame, event, argument: files.add(frame.f_code.co_filename))
    try:
        return solved(solver, title), files
    finally:
        sys.settrace(None)


def changed(mutant: Mutant, before: Mapping[tuple[str, str], Mapping[str, np.ndarray]]) -> float:
    """Largest change of these probes in tolerances of their solver; in a fork, since the mutant stays."""
    inject.put([mutant])
    worst = 0.0
    for (solver, title), numbers in before.items():
        tolerance = PROBES[solver][title].get("solver", {}).get("tolerance", 1e-9)
        try:
            worst = max(worst, change(numbers, solved(solver, title)) / tolerance)
        except ArithmeticError:
            return float("inf")
    return worst


def show(mutants: Iterable[Mutant]) -> list[Shown]:
    """What each of the mutants changes in the probes that run its module."""
    every = [(solver, title) for solver, titles in PROBES.items() for title in titles]
    known = dict(forked([(probe, lambda probe=probe: observed(*probe)) for probe in every], SECONDS))
    tasks, counts = [], {}
    for mutant in mutants:
        file = import_module(mutant.module).__file__
        before = {probe: known[probe][0] for probe in every if file in known[probe][1]}
        counts[mutant] = len(before)
        tasks.append((mutant, lambda mutant=mutant, before=before: changed(mutant, before)))
    reasons = constants("equivalent")
    return [
        Shown(mutant, reasons[mutant.key], float("inf") if answer is None else answer, counts[mutant])
        for mutant, answer in forked(tasks, SECONDS)
    ]
