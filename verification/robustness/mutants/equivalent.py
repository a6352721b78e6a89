# SPDX-License-Identifier: MIT
"""Equivalent mutants: constants that must not change an answer, and what a perturbation of them changes in
the numbers that small scenes return.
"""

from __future__ import annotations

import sys
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from importlib import import_module

import numpy as np

from sam.scene import Result, parse_scene
from verification.robustness.mutants import inject
from verification.robustness.mutants.changes import Mutant
from verification.robustness.mutants.judge import forked
from verification.robustness.mutants.scope import constants
from verification.runs import models

WITHIN = 10.0
"""A number may change by this many tolerances of its solver."""
SECONDS = 60.0
STEEL = '[body]\nyoung = "210 GPa"\npoisson = 0.3\n'
SPHERE = '[counterbody]\nshape = "sphere"\nradius = "105 um"\n'
PUNCH = '[counterbody]\nshape = "rounded-punch"\nflat_radius = "5 um"\nradius = "100 um"\n'
ELASTIC = SPHERE + 'young = "70 GPa"\npoisson = 0.2\n'
SWIFT = '[body.plasticity]\nlaw = "swift"\nB = "945 MPa"\nC = 20\nn = 0.121\n'
FILM = '[body.coating]\nthickness = "1 um"\nyoung = "400 GPa"\npoisson = 0.2\n'
LAW = """[friction]
law = "chemical-film"
low = 0.1
high = 0.4
film_thickness = "100 nm"
film_young = "80 GPa"
film_poisson = 0.3
film_yield = "0.67 GPa"
strain_limit = 0.0204
"""
MISFIT = """[body.plasticity]
law = "linear"
yield_stress = "1 GPa"
modulus = "10 GPa"
[loading]
prescribed = "misfit-sphere"
depth = "35 um"
radius = "10 um"
misfit = 0.02
profile = "gauss"
surface = "held"
steps = 2
"""
BACK = """[body.plasticity.kinematic]
modulus = ["60 GPa", "6 GPa"]
recovery = [300, 3]
"""
ROUGH = """[surface]
kind = "self-affine"
ra = "0.1 um"
cutoff_long = "16 um"
cutoff_short = "8 um"
hurst = 0.8
seed = 1
"""


@dataclass(frozen=True)
class Probe:
    """A scene for one solver; tolerance: that of the solver, of which a number may change by ten times,
    relatively.
    """

    name: str
    solver: str
    text: str
    tolerance: float

    def solve(self) -> Result:
        scene = parse_scene(f'title = "{self.name}"\n{self.text}'.encode(), self.name)
        result = models.solve(scene, self.solver)
        if not result.converged:
            raise ArithmeticError(f"{self.name} ended {result.status}: {result.message}")
        return result


def _sam(
    name: str, text: str, force: str, cells: int, *, tolerance: float, loading: str = "", solver: str = ""
) -> Probe:
    loads = f'[loading]\nforce = "{force}"\n{loading}'
    end = f"[grid]\ncells = [{cells}, {cells}]\n[solver]\ntolerance = {tolerance}\n{solver}"
    return Probe(name, models.SAM, text + loads + end, tolerance)


PROBES = (
    _sam(
        "elastic sphere that slides",
        STEEL + ELASTIC + "[friction]\ncoefficient = 0.3\n",
        "0.1 N",
        49,
        tolerance=1e-9,
    ),
    _sam(
        "coated half-space that slides",
        STEEL + FILM + ELASTIC + "[friction]\ncoefficient = 0.2\n",
        "0.1 N",
        33,
        tolerance=1e-8,
    ),
    _sam(
        "plastic sphere",
        STEEL + SWIFT + SPHERE,
        "0.17 N",
        33,
        tolerance=1e-6,
        loading="steps = 3\nunload = true\n",
    ),
    _sam(
        "sphere with back-stresses",
        STEEL + SWIFT + BACK + SPHERE,
        "0.17 N",
        17,
        tolerance=1e-6,
        loading="steps = 2\nunload = true\n",
    ),
    Probe(
        "punch with a rounded edge",
        models.SAM,
        STEEL
        + PUNCH
        + '[loading]\napproach = "0.1 um"\n[grid]\ncells = [65, 65]\n[solver]\ntolerance = 1e-9\n',
        1e-9,
    ),
    _sam(
        "the loops of the paper",
        STEEL + SWIFT + SPHERE,
        "0.1 N",
        17,
        tolerance=1e-4,
        loading="steps = 2\n",
        solver='method = "paper"\n',
    ),
    Probe(
        "running-in",
        models.SAM,
        STEEL + SWIFT + '[counterbody]\nshape = "flat"\n' + ROUGH + LAW + "[wear]\nstrain_limit = 0.002\n"
        '[loading]\nforce = "0.06 N"\nsteps = 2\nunload = true\n'
        '[grid]\ncells = [24, 24]\nextent = ["16 um", "16 um"]\n'
        'depths = ["0 um", "0.2 um", "0.4 um", "0.7 um", "1.2 um", "2 um", "3.5 um", "6 um"]\n'
        'border = "relief"\n'
        "[solver]\ntolerance = 1e-5\n",
        1e-5,
    ),
    Probe(
        "plastic sphere of finite elements",
        models.FEM,
        STEEL
        + SWIFT
        + SPHERE
        + '[loading]\nforce = "0.17 N"\nsteps = 3\nunload = true\n[fem]\ncells_per_radius = 4\n',
        1e-9,
    ),
    Probe(
        "finite elements with back-stresses",
        models.FEM,
        f"{STEEL}{SWIFT}{BACK}{SPHERE}"
        '[loading]\nforce = "0.17 N"\nsteps = 2\nunload = true\n[fem]\ncells_per_radius = 4\n',
        1e-9,
    ),
    Probe(
        "misfit sphere of finite elements",
        models.FEM,
        f"{STEEL}{MISFIT}[fem]\ncells_per_radius = 4\n",
        1e-9,
    ),
    Probe(
        "misfit sphere",
        models.SAM,
        f"{STEEL}{MISFIT}[grid]\ncells = [13, 13]\n[solver]\ntolerance = 1e-6\n",
        1e-6,
    ),
    Probe(
        "coated sphere of finite elements",
        models.FEM,
        STEEL + FILM + SPHERE + '[loading]\nforce = "0.1 N"\n[fem]\ncells_per_radius = 4\n',
        1e-9,
    ),
    Probe(
        "coated sphere of hexahedra that slides",
        models.FEM_3D,
        STEEL + FILM + SPHERE + '[friction]\ncoefficient = 0.2\n[loading]\nforce = "0.1 N"\n'
        "[fem]\ncells_per_radius = 4\nbox = 5\n",
        1e-9,
    ),
)


def numbers(result: Result) -> dict[str, np.ndarray]:
    """All numbers of a result but its work: the quantities, and the columns of the tables but iterations and
    residuals.

    The table of all residuals has a row for each iteration, and the goals that the constants set.
    """
    found = {name: np.array([value]) for name, value in result.quantities.items() if value is not None}
    for table in result.tables.keys() - {"residuals"}:
        for name, column in result.tables[table].items():
            values = np.asarray(column)
            if values.dtype.kind == "f" and name not in ("iterations", "residual", "operator_applications"):
                found[f"{table}.{name}"] = values
    return found


SHARES = {"_Pa": 1e-3, "_m": 1e-6, "_N": 1e-6}
"""By unit: share of the largest number in it, below which the numbers of a column are rounding by symmetry.
"""


def change(before: Mapping[str, np.ndarray], after: Mapping[str, np.ndarray]) -> float:
    """Largest change of a number over the largest of its column, or over that of its unit times SHARES if
    that is more.
    """
    if before.keys() != after.keys() or any(before[name].shape != after[name].shape for name in before):
        return np.inf
    tops = {name: np.abs(np.nan_to_num(values)).max(initial=0.0) for name, values in before.items()}
    worst = 0.0
    for name, values in before.items():
        unit = next((unit for unit in SHARES if name.endswith(unit)), "")
        floor = (
            max(SHARES[unit] * top for other, top in tops.items() if other.endswith(unit)) if unit else 0.0
        )
        if (scale := max(tops[name], floor)) > 0:
            worst = max(worst, float(np.abs(np.nan_to_num(after[name] - values)).max(initial=0.0) / scale))
    return worst


@dataclass(frozen=True)
class Shown:
    """change: largest change of a number in tolerances of its solver; probes: how many of them run the
    module.
    """

    mutant: Mutant
    reason: str
    change: float
    probes: int

    @property
    def equivalent(self) -> bool:
        return self.probes > 0 and self.change <= WITHIN


def solved(probe: Probe) -> tuple[dict[str, np.ndarray], frozenset[str]]:
    """Its numbers, and the files of the project that ran."""
    files: set[str] = set()
    sys.settrace(lambda frame, event, argument: files.add(frame.f_code.co_filename))
    try:
        result = probe.solve()
    finally:
        sys.settrace(None)
    return numbers(result), frozenset(files)


def changed(mutants: list[Mutant], probes: list[tuple[Probe, dict]]) -> float:
    """Largest change in tolerances; in a fork, since the mutants stay."""
    inject.put(mutants)
    worst = 0.0
    for probe, before in probes:
        try:
            worst = max(worst, change(before, numbers(probe.solve())) / probe.tolerance)
        except ArithmeticError:
            return float("inf")
    return worst


def show(mutants: Iterable[Mutant]) -> list[Shown]:
    """What each of the mutants changes in the probes that run its module."""
    known = dict(forked([(p.name, lambda p=p: solved(p)) for p in PROBES], SECONDS))
    tasks, counts = [], {}
    for mutant in mutants:
        file = import_module(mutant.module).__file__
        relevant = [(probe, known[probe.name][0]) for probe in PROBES if file in known[probe.name][1]]
        counts[mutant] = len(relevant)
        tasks.append((mutant, lambda mutant=mutant, relevant=relevant: changed([mutant], relevant)))
    answers = forked(tasks, SECONDS)
    return [
        Shown(
            mutant,
            constants("equivalent")[mutant.key],
            float("inf") if answer is None else answer,
            counts[mutant],
        )
        for mutant, answer in answers
    ]
