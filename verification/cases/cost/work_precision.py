# SPDX-License-Identifier: MIT
"""Error against run time for every kind of contact: SAM in its forms and both finite-element models; what to
take when.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from statistics import median

import numpy as np

from verification.cases.case import FEM, FEM_3D, SAM, Case, Context, Measured, Plot, SmallTable, number
from verification.cases.cost.work_precision_problems import (
    AXISYMMETRIC,
    COUPLED,
    ELLIPSOID,
    MEASURES,
    PROBLEMS,
    SPATIAL,
    TWICE,
    Problem,
)
from verification.cases.cost.work_precision_study import (
    FAST_S,
    REPEATS,
    ErrorCurve,
    ProblemStudy,
    Solve,
    studied,
)
from verification.cost import measured
from verification.cost.advice_rows import BELOW, LOAD_STEPS, NEVER, ON_TWO_GRIDS, AdviceRow, columns_of
from verification.cost.precision import TARGETS, Reached
from verification.figures.style import Drawing
from verification.figures.work_precision import Line, curves, overview

ADVISED = {COUPLED: SAM, TWICE: ON_TWO_GRIDS, AXISYMMETRIC: FEM, SPATIAL: FEM_3D}
"""Methods that a user is advised to take, and the names of their models."""
SPATIALLY = ("ellipsoid", "friction-0-2", "rough-elastic", "rough-plastic")
"""What no model in two dimensions can solve: there SAM is held against the three-dimensional one."""
KNOWN = 3.0
"""Times better than an error that two methods are held against each other at, its reference has to be known:
below that their curves are those of the reference."""
ASKED = 50.0
"""How many times faster SAM is to be there: the goal, which is said beside what was measured."""
MONOTONE = (("hertz", COUPLED), ("hertz", AXISYMMETRIC), ("coated", COUPLED))
"""Smooth elastic contacts: the largest pressure converges from one side, at second order."""


@dataclass(frozen=True)
class WorkPrecision(Case):
    """Every problem, one after the other: the times to an error, and the advice.

    problems, solver: what is studied, and how a scene is solved (in a process of its own).
    """

    problems: Sequence[Problem] = (*PROBLEMS, ELLIPSOID)
    solver: Solve = measured.solve_alone

    def solve(self, context: Context) -> list[ProblemStudy]:
        return [studied(context, problem, self.solver) for problem in self.problems]

    def measure(self, studies: Sequence[ProblemStudy]) -> dict[str, Measured]:
        return gated(studies)

    def setup(self, studies: Sequence[ProblemStudy]) -> Iterator[tuple[str, str]]:
        yield "Problems", "; ".join(study.problem.title for study in studies)
        points = (point for study in studies for each in study.points.values() for point in each)
        kernels = [point.kernel_s for point in points if math.isfinite(point.kernel_s)]
        between = f"from {min(kernels):.3f} to {max(kernels):.3f} s between the solves"
        yield "Calibration kernel", f"{median(kernels):.3f} s, {between}"
        repeated = f"repeated {REPEATS} times, in rounds with the others; medians count"
        yield "Repeats", f"Solves of less than {FAST_S:g} s are {repeated}"

    def tables(self, studies: Sequence[ProblemStudy]) -> Iterator[SmallTable]:
        for table in (times_table, faster_table, references_table, steps_table):
            yield table(studies)
        yield from map(points_table, studies)

    def notes(self, studies: Sequence[ProblemStudy]) -> Iterator[str]:
        yield (
            "Processor time of the whole solve with one thread, in a new process: set-up, solution, stresses "
            "at the output depths and tables, without the loading of modules. The time to an error is "
            "interpolated between the two points that bracket it, log-log; errors that a finer grid does not "
            "keep do not count. The advice of `samfem plan` is the table beside the first figure, taken over "
            "by `python -m verification.cost.advice`. Every method takes the load steps of the reference, "
            "which is backward Euler's: what more steps would change is studied by itself, against their "
            "limit at one resolution."
        )

    def figures(self, studies: Sequence[ProblemStudy]) -> Iterator[Plot]:
        advising = [each for each in studies if each.problem.kind]
        times = {
            each.problem.kind: {name: curve.time(0.01) for name, curve in each.curves.items()}
            for each in advising
        }
        yield Plot(
            Drawing(overview(times, "1 %").figure, columns_of(advice_rows(studies))),
            "advice",
            "Processor time to 1 %",
            "Marks on a logarithmic axis of processor time, one row a kind of scene and one mark a method.",
            "Hollow: even the coarsest point is better, the time is an upper bound. What never reaches 1 % "
            "has no mark. The data are the advice of samfem plan.",
        )
        for study in studies:
            panels = {"resolution": (lines_of(study.curves), study.floor)}
            if study.problem.steps:
                panels["load steps"] = (lines_of(study.step_curves), study.step_curves[COUPLED].floor)
            words = " and ".join(MEASURES[name] for name in study.problem.measures)
            yield Plot(
                curves(panels, f"error of the {words}"),
                study.problem.name,
                study.problem.title,
                f"Log-log plot of the error of the {words} over processor time, a falling curve for each "
                "method.",
                "Shaded: uncertainty of the reference, below which nothing is claimed. Along a curve the "
                "grid is refined, or the load steps.",
            )


def gated(studies: Sequence[ProblemStudy]) -> dict[str, Measured]:
    """Ratios of times at equal error, steadiness of the convergence, floors."""
    found, values = {study.problem.name: study for study in studies}, {}
    if "hertz" in found:
        for target in TARGETS[1:]:
            ratio = time_ratio(found["hertz"], AXISYMMETRIC, target)
            values[f"hertz-{percent(target)}"] = Measured(ratio)
    for name in SPATIALLY:
        if name in found:
            values[f"{name}-faster"] = Measured(faster(found[name], SPATIAL)[0])
    for name, method in MONOTONE:
        if name in found:
            label = "sam" if method == COUPLED else "fem"
            study = found[name]
            values[f"{name}-monotone-{label}"] = Measured(growth(study.curves[method].errors, study.floor))
    for name in ("ratio-3", "ratio-6-2"):
        if name in found:
            values[f"{name}-floor"] = Measured(found[name].floor)
    return values


def percent(target: float) -> str:
    """For the id of a gate: 0.003 -> 0-3."""
    return f"{100.0 * target:g}".replace(".", "-")


def time_ratio(study: ProblemStudy, other: str, target: float) -> float:
    """Time of SAM, on one grid or on two, over that of another method for one error; infinite where SAM never
    reaches it.

    A method that never reaches it needs more than its finest point took: that time is taken, which is in its
    favour.
    """
    found = [study.curves[name].time(target).value for name in (COUPLED, TWICE) if name in study.curves]
    own, its = (
        min((time for time in found if time is not None), default=None),
        study.curves[other].time(target).value,
    )
    if own is None:
        return math.inf
    return own / (its if its is not None else float(np.nanmax(study.curves[other].seconds)))


def faster(study: ProblemStudy, other: str) -> tuple[float, float]:
    """How many times the processor time of SAM, on one grid or on two, another method takes to the smallest
    error that both reach, and that error; nan where one of them reaches none.

    The error is that of the finest point of the one that ends at the larger, and at least KNOWN times the
    floor.
    """
    curves = study.curves

    def ends(name: str) -> float:
        return max(float(curves[name].errors[-1]), KNOWN * study.floor)

    own = [name for name in (COUPLED, TWICE) if name in curves and math.isfinite(ends(name))]
    if other not in curves or not own or not math.isfinite(ends(other)):
        return math.nan, math.nan
    target = max(ends(other), min(map(ends, own)))
    times = (study.curves[name].time(target).value for name in own)
    least, its = min(time for time in times if time is not None), study.curves[other].time(target).value
    return (math.nan if its is None else its / least), target


def faster_range(study: ProblemStudy, other: str) -> tuple[float, float]:
    """The least and the largest of `faster` where the reference is off by its uncertainty, either way."""
    found = [faster(study.with_references(share), other)[0] for share in (-1.0, 0.0, 1.0)]
    return min(found), max(found)


def growth(errors: np.ndarray, floor: float) -> float:
    """The largest ratio of successive errors of which the later is above the floor; 0 where there is none."""
    pairs = [(a, b) for a, b in pairwise(errors) if not b <= floor]
    return max((b / a for a, b in pairs), default=0.0)


def advice_rows(studies: Sequence[ProblemStudy]) -> list[AdviceRow]:
    """What each error takes, for the methods that a user is advised to take, and the load steps."""
    rows = []
    for study in (each for each in studies if each.problem.kind):
        values = {name: reference.value for name, reference in study.references.items()}
        of_grid = study.problem.advised(study.scene, values)  # what the advice calls a resolution of 1
        methods = {ADVISED[name]: curve for name, curve in study.curves.items() if name in ADVISED}
        found = [(name, curve, *of_grid) for name, curve in methods.items()]
        if study.problem.steps:
            found.append((LOAD_STEPS, study.step_curves[COUPLED], "load steps", 1.0))
        said = study.problem.kind, " and ".join(MEASURES[measure] for measure in study.problem.measures)
        for target in TARGETS:
            every = [curve.time(target).value for curve in methods.values()]
            least = min((time for time in every if time is not None), default=math.nan)
            for name, curve, unit, size in found:
                time = curve.time(target)
                numbers = (time.value, curve.fineness(target).value, curve.kernels(target))
                seconds, fineness, kernels = (math.nan if each is None else each for each in numbers)
                bound = NEVER if time.value is None else BELOW * time.coarsest
                relative = math.nan if name == LOAD_STEPS else seconds / least
                steps = study.scene.loading.steps
                row = (*said, name, target, bound, fineness * size, unit, steps, seconds, kernels, relative)
                rows.append(AdviceRow(*row))
    return rows


def times_table(studies: Sequence[ProblemStudy]) -> SmallTable:
    """Processor seconds to each error, with the resolution; and the same in kernels for 1 %."""
    rows = []
    for study in studies:
        for name, found in study.curves.items():
            reached, kernels = ((found.time(t), found.fineness(t)) for t in TARGETS), found.kernels(0.01)
            last = "" if kernels is None else number(kernels, 3)
            rows.append((study.problem.title, name, *(spent(*each) for each in reached), last))
    columns = ("problem", "method", *(f"{100.0 * t:g} %" for t in TARGETS), "1 %, in kernels")
    return SmallTable("Processor time in s to an error (resolution)", columns, rows)


def spent(time: Reached, fineness: Reached) -> str:
    """A cell of the table."""
    if time.value is None:
        return f"{NEVER} ({100.0 * time.smallest:.2g} %)"
    return f"{'< ' * time.coarsest}{number(time.value, 3)} ({number(fineness.value, 3)})"


def faster_table(studies: Sequence[ProblemStudy]) -> SmallTable:
    """SAM beside both finite-element models, at the smallest error that both reach."""
    rows = []
    for study in studies:
        for other in (AXISYMMETRIC, SPATIAL):
            ratio, error = faster(study, other)
            if math.isfinite(ratio):
                least, most = faster_range(study, other)
                goal = study.problem.name in SPATIALLY and other == SPATIAL
                of_goal = f"{number(ratio / ASKED, 2)} of {ASKED:g}" if goal else ""
                cells = (f"{100.0 * error:.2g} %", f"{100.0 * study.floor:.2g} %", number(ratio, 3))
                between = f"{number(least, 3)} to {number(most, 3)}"
                rows.append((study.problem.title, other, *cells, between, of_goal))
    return SmallTable(
        "How many times the time of SAM finite elements take at the smallest error that both reach, and that "
        f"is {KNOWN:g} times the uncertainty of the reference. A sphere at rest is a problem in two "
        "dimensions for the axisymmetric model and in three for SAM",
        "problem|beside|error|uncertainty of the reference|times|with the reference off by its uncertainty"
        "|share of the goal".split("|"),
        rows,
    )


def references_table(studies: Sequence[ProblemStudy]) -> SmallTable:
    """What the errors are measured against."""
    rows = [
        (study.problem.title, MEASURES[q], number(one.value, 6), f"{1e2 * one.uncertainty:.2g} %", one.origin)
        for study in studies
        for q, one in study.references.items()
    ]
    return SmallTable("References", ("problem", "quantity (SI)", "value", "uncertainty", "from"), rows)


def steps_table(studies: Sequence[ProblemStudy]) -> SmallTable:
    """Errors over the load steps."""
    rows = [
        (
            *(study.problem.title, name, f"{point.resolution}", f"{100.0 * error:.3g} %"),
            *(number(point.cpu_s, 3), f"{point.counters.get('operator_applications')}", point.status),
        )
        for study in studies
        if study.problem.steps
        for name, found in study.step_curves.items()
        for point, error in zip(found.points, found.errors, strict=True)
    ]
    columns = "problem|method|load steps|error|processor time [s]|operator applications|status"
    words = "Load steps at one resolution, against their extrapolation"
    return SmallTable(words, columns.split("|"), rows)


def points_table(study: ProblemStudy) -> SmallTable:
    """One row a solve."""
    rows = []
    for name, found in study.curves.items():
        profiles = study.profile_errors(name) if study.problem.profile else [math.nan] * len(found.points)
        for point, *both in zip(found.points, found.errors, profiles, strict=True):
            shares = (f"{100.0 * value:.3g} %" if math.isfinite(value) else "" for value in both)
            numbers = (point.kernels, point.setup_s, point.solve_s, point.peak_memory_bytes / 1e6)
            cost = (number(point.cpu_s, 3), f"{point.spread:.2f}", *(number(value, 3) for value in numbers))
            counters = (f"{key.replace('_', ' ')} {value}" for key, value in point.counters.items() if value)
            row = (name, f"{point.resolution}", *shares, *cost, ", ".join(counters), point.status)
            rows.append(row)
    columns = "error|axis, L2|processor time [s]|spread|in kernels|set-up [s]|solution [s]|memory [MB]"
    columns = ("method", study.problem.unit, *columns.split("|"), "counters", "status")
    return SmallTable(study.problem.title, columns, rows)


def lines_of(found: Mapping[str, ErrorCurve]) -> dict[str, Line]:
    """The curves for the figure."""
    return {
        name: Line(each.seconds, each.errors, np.array([point.resolution for point in each.points]))
        for name, each in found.items()
    }


CASES = (WorkPrecision("work-precision", alone=True),)
