# SPDX-License-Identifier: MIT
"""Equivalent mutants: constants that must not change an answer, each with the reason.

What a perturbation of them does change is measured in small solves.
"""

from __future__ import annotations

import sys
from collections.abc import Iterable
from dataclasses import dataclass
from importlib import import_module

import numpy as np

from verification.robustness.mutants import inject
from verification.robustness.mutants.numbers import Mutant
from verification.robustness.mutants.pool import forked
from verification.robustness.mutants.probes import PROBES, Probe, change, numbers

WITHIN = 10.0
"""A number may change by this many tolerances of its solver."""
SECONDS = 60.0

START, LIMIT, STOP, PATH, MEMORY, QUADRATURE, ROUNDING, LINEAR = (
    "where an iteration starts: it ends at the same answer",
    "limit of an iteration that ends before it",
    "inner tolerance: the answer is held to the tolerance of the scene",
    "way of an iteration to its solution, which does not depend on it",
    "how much is computed at once, or by which of two equal ways",
    "order of a quadrature or spline that is converged",
    "what counts as rounding",
    "iterations with a kept factorisation before a new one",
)
BRACKET = "how far a root is looked for"
NOTHING = "stands where there is nothing to scale"

EQUIVALENT: dict[tuple[str, str, str], str] = {
    ("sam.contact.normal", "", "COARSEST = 24"): START,
    ("sam.contact.normal", "", "COARSE_TOLERANCE = 0.001"): START,
    ("sam.contact.normal", "", "COARSE_LIMIT = 60"): START,
    ("sam.contact.normal", "Search", "tolerance = 1e-10"): STOP,
    ("sam.contact.normal", "_coarse_start", "2"): START,
    ("sam.contact.box", "ForceControl", "1.0"): START,
    ("sam.contact.box", "ApproachControl", "1.0"): "of a default that nothing uses",
    ("sam.contact.box", "ForceControl.coarser", "4"): START,
    ("sam.contact.box", "ApproachControl.coarser", "2"): START,
    ("sam.contact.box", "ApproachControl.start", "2"): START,
    ("sam.contact.box", "ApproachControl.start", "4"): START,
    ("sam.contact.box", "", "PASSES = 500"): LIMIT,
    ("sam.contact.box", "", "FIRST_PASS = 0.01"): STOP,
    ("sam.contact.box", "", "NEXT_PASS = 0.1"): STOP,
    ("sam.contact.box", "", "ANEW = 0.001"): PATH,
    ("sam.contact.box", "", "LONGEST = 20"): PATH,
    ("sam.contact.box", "", "NOTHING_OPPOSITE = 1e+100"): "a gap that nothing closes",
    ("sam.contact.box", "", "NEGLIGIBLE = 0.01"): PATH,
    ("sam.contact.box", "BoxContact.solve", "2"): STOP,
    ("sam.contact.box", "_Iteration.residual", "1.0"): NOTHING,
    ("sam.contact.operators", "SurfaceOperators.relaxation", "1"): PATH,
    ("sam.contact.operators", "SurfaceOperators.relaxation", "1.0"): PATH,
    ("sam.contact.operators", "SurfaceOperators.preconditioner", "2"): PATH,
    ("sam.contact.operators", "SurfaceOperators.preconditioner.apply", "1.0"): NOTHING,
    ("sam.contact.operators", "", "WAVES = 64"): PATH,
    ("sam.contact.operators", "HalfSpaces", "most_iterations = 1000"): LIMIT,
    ("sam.contact.operators", "HalfSpaces", "stagnation_limit = 100"): LIMIT,
    ("sam.contact.operators", "HalfSpaces", "restart_threshold = 0.4"): PATH,
    ("sam.contact.operators", "CoatedBodies", "most_iterations = 5000"): LIMIT,
    ("sam.contact.operators", "CoatedBodies", "stagnation_limit = 2000"): LIMIT,
    ("sam.contact.operators", "HalfSpaces.tangential_share", "0.5"): PATH,
    ("sam.contact.operators", "CoatedBodies.stiffness", "1"): PATH,
    ("sam.contact.operators", "CoatedBodies.stiffness", "2"): PATH,
    ("sam.contact.operators", "CoatedBodies.tangential_share", "2"): PATH,
    ("sam.contact.operators", "CoatedBodies.coarser", "2"): START,
    ("sam.contact.convolution", "", "FEW_ROWS = 2"): MEMORY,
    ("sam.contact.convolution", "BoxConvolution.single", "1.0"): NOTHING,
    ("sam.contact.convolution", "", "SHORT = 8500"): MEMORY,
    ("sam.contact.stress", "", "DEPTHS_AT_ONCE = 16"): MEMORY,
    ("sam.contact.stress", "", "MIRRORED = 1e-09"): ROUNDING,
    ("sam.kernels.layer_stress", "", "AT_ONCE = 100000.0"): MEMORY,
    ("sam.kernels.layer_stress", "", "IN_CACHE = 2500"): MEMORY,
    ("sam.kernels.layer_stress", "", "DIGITS = 9"): ROUNDING,
    ("sam.elastic.problem", "", "BYTES_AT_ONCE = 200000000.0"): MEMORY,
    ("sam.elastic.problem", "", "CONTACT_SHARE = 0.0001"): STOP,
    ("sam.elastic.problem", "", "REACHED = 1e-12"): STOP,
    ("sam.plasticity.spectra", "", "CACHED_BOXES = 4"): MEMORY,
    ("sam.plasticity.spectra", "", "SINGLE = 5e-05"): MEMORY,
    ("sam.plasticity.measure", "", "AT_ONCE = 1000000.0"): MEMORY,
    ("sam.plasticity.measure", "residual_stress", "36"): MEMORY,
    ("sam.plasticity.paper", "", "OUTER = 60"): LIMIT,
    ("sam.plasticity.paper", "", "INNER = 400"): LIMIT,
    ("fem_reference.common.layered_force", "", "SPREAD = 60.0"): QUADRATURE,
    ("fem_reference.common.layered_force", "", "PANELS = 24"): QUADRATURE,
    ("fem_reference.common.layered_force", "", "HALVINGS = 24"): QUADRATURE,
    ("fem_reference.common.layered_force", "", "POINTS = 10"): QUADRATURE,
    ("fem_reference.common.layered_force", "_wave_numbers", "30.0"): QUADRATURE,
    ("fem_reference.common.layered_force", "slanted_pair", "1.0"): NOTHING,
    ("fem_reference.spatial.problem", "", "ACCURACY = 0.003"): STOP,
    ("fem_reference.spatial.problem", "SlidingProblem.overall", "1.0"): MEMORY,
    ("fem_reference.spatial.problem", "SlidingProblem._solve", "1.0"): "a load whose answer is scaled",
    ("fem_reference.spatial.problem", "", "SLOWER = 2"): PATH,
    ("sam.layered.patches", "", "STEP = 0.1"): QUADRATURE,
    ("sam.layered.response", "sinh_excess", "1.0"): "where one of two equal formulas ends",
    ("sam.layered.patches", "", "COUNT = 2048"): QUADRATURE,
    ("sam.layered.patches", "", "REFINE = 4"): QUADRATURE,
    ("sam.layered.patches", "", "NEAR = 8"): QUADRATURE,
    ("sam.layered.patches", "", "NODES = 32"): QUADRATURE,
    ("sam.layered.patches", "", "16.0"): QUADRATURE,
    ("sam.layered.patches", "", "32.0"): QUADRATURE,
    ("sam.layered.patches", "", "64.0"): QUADRATURE,
    ("sam.layered.patches", "", "DISPLACEMENT_BIAS = 0.5"): QUADRATURE,
    ("sam.layered.patches", "", "STRESS_BIAS = 1.0"): QUADRATURE,
    ("sam.plasticity.flow", "", "ITERATIONS = 50"): LIMIT,
    ("sam.plasticity.flow", "", "ROUNDING = 1e-14"): ROUNDING,
    ("sam.plasticity.flow", "plastic_multiplier", "2"): PATH,
    ("sam.plasticity.flow", "", "KINEMATIC_ITERATIONS = 60"): LIMIT,
    ("sam.plasticity.flow", "", "KINEMATIC_ROUNDING = 1e-15"): ROUNDING,
    ("sam.plasticity.flow", "kinematic_multiplier", "2"): PATH,
    ("sam.plasticity.flow", "kinematic_multiplier", "0.5"): BRACKET,
    ("sam.grid.gap", "", "HALVINGS = 60"): LIMIT,
    ("sam.grid.gap", "RoundedPunch.force", "1.0"): ROUNDING,
    ("sam.grid.gap", "RoundedPunch.approach", "1.0"): ROUNDING,
    ("sam.grid.gap", "RoundedPunch.contact_radius", "1"): BRACKET,
    ("sam.grid.gap", "RoundedPunch.contact_radius", "3"): BRACKET,
    ("sam.grid.gap", "RoundedPunch.contact_radius", "4"): BRACKET,
    ("sam.grid.gap", "RoundedPunch.radius_at", "2"): BRACKET,
    ("sam.schedule", "Load", "sign = 1.0"): "of a default of loads without friction",
    ("sam.schedule", "Schedule", "cycles = 1"): "of a default that nothing uses",
    ("sam.scene.yield_curve", "", "POINTS = 24"): QUADRATURE,
    ("sam.scene.yield_curve", "", "GRADING = 4"): QUADRATURE,
    ("sam.scene.yield_curve", "", "SMALL = 0.5"): "where one of two equal formulas ends",
    ("sam.scene.yield_curve", "", "TERMS = 18"): "terms of a series that has converged",
    ("sam.plasticity.load_step", "Anderson", "1e-12"): ROUNDING,
    ("sam.plasticity.load_step", "", "WINDOW = 8"): PATH,
    ("sam.plasticity.load_step", "", "ITERATIONS = 60"): LIMIT,
    ("sam.plasticity.load_step", "", "LONG_WINDOW = 20"): PATH,
    ("sam.plasticity.load_step", "", "LONG_ITERATIONS = 600"): LIMIT,
    ("sam.plasticity.load_step", "", "CONTACT_SHARE = 0.01"): STOP,
    ("sam.plasticity.load_step", "", "AHEAD = 0.1"): STOP,
    ("sam.plasticity.load_step", "", "FIRST_CONTACT = 0.001"): STOP,
    ("sam.tribofilm.law", "", "ITERATIONS = 50"): LIMIT,
    ("sam.tribofilm.law", "", "ROUNDING = 1e-14"): ROUNDING,
    ("sam.wear", "", "UNREACHED = 1e+300"): "a limit that no strain reaches",
    ("fem_reference.common.plasticity", "", "ON_SURFACE = 1e-11"): ROUNDING,
    ("fem_reference.common.plasticity", "", "MAX_ITERATIONS = 100"): LIMIT,
    ("fem_reference.common.plasticity", "plastic_increment", "16.0"): ROUNDING,
    ("fem_reference.common.plasticity", "plastic_increment", "0.5"): PATH,
    ("fem_reference.common.contact", "", "EQUILIBRIUM = 1e-09"): STOP,
    ("fem_reference.common.contact", "", "SIGN = 1e-10"): ROUNDING,
    ("fem_reference.common.contact", "", "MAX_ITERATIONS = 60"): LIMIT,
    ("fem_reference.common.contact", "", "DIVERGED = 1.0"): LIMIT,
    ("fem_reference.common.contact", "", "NEGLIGIBLE = 0.3"): STOP,
    ("fem_reference.axisymmetric.problem", "", "FEW = 12"): LINEAR,
    ("fem_reference.common.contact", "", "STALLED = 10"): LIMIT,
    (
        "fem_reference.axisymmetric.problem",
        "ContactProblem._order",
        "2.0",
    ): "of a place among the nodes, rounded",
    ("fem_reference.axisymmetric.problem", "ContactProblem.newton_step", "1.0"): NOTHING,
    ("fem_reference.common.contact", "_iterate", "1.0"): NOTHING,
    ("fem_reference.axisymmetric.misfit", "", "EDGE_POINTS = 8"): QUADRATURE,
    ("fem_reference.axisymmetric.misfit", "_gauss", "0.1"): "where one of two equal formulas ends",
    ("fem_reference.common.back_stress", "", "MAX_ITERATIONS = 100"): LIMIT,
    ("fem_reference.common.back_stress", "KinematicJ2._increment", "16.0"): ROUNDING,
    ("fem_reference.common.back_stress", "KinematicJ2._increment", "0.5"): PATH,
    ("sam.elastic.misfit", "", "SMALL = 0.01"): "where one of two equal formulas ends",
    ("sam.elastic.misfit", "", "AT_ONCE = 200000"): MEMORY,
    ("sam.scene.verdict", "loop_places", "1.0"): NOTHING,
    ("fem_reference.axisymmetric.recovery", "on_face", "1e-06"): ROUNDING,
    ("fem_reference.axisymmetric.recovery", "on_face", "1.0"): ROUNDING,
    ("fem_reference.axisymmetric.recovery", "on_axis", "1e-06"): ROUNDING,
    (
        "fem_reference.common.hertz",
        "largest_mises",
        "2.0",
    ): "so deep is searched for the largest, which is at 0.5",
    ("fem_reference.common.hertz", "", "UNLOADED_RADIUS = 0.01"): "unit of length where nothing is loaded",
}


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


def reason_of(mutant: Mutant) -> str:
    """Why it must not change an answer; empty if it may."""
    return EQUIVALENT.get(mutant.key, "")


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
        Shown(mutant, reason_of(mutant), float("inf") if answer is None else answer, counts[mutant])
        for mutant, answer in answers
    ]
