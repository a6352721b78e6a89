# SPDX-License-Identifier: MIT
"""Error against run time for every kind of contact: SAM in its forms and both finite-element models; what to take when."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from itertools import pairwise
from statistics import median

import numpy as np

from verification.cost import measured
from verification.cost.advice import BELOW, LOAD_STEPS, NEVER, ON_TWO_GRIDS, AdviceRow, columns_of
from verification.cost.precision import TARGETS, Reached
from verification.figures.style import Drawing
from verification.figures.work_precision import Line, curves, overview
from verification.runs.models import FEM, FEM_3D, SAM
from verification.suite.cases.case import Case, Context, Outcome, SmallTable
from verification.suite.cases.work_precision_problems import (
    AXISYMMETRIC,
    COUPLED,
    MEASURES,
    PROBLEMS,
    SPATIAL,
    TWICE,
    Problem,
)
from verification.suite.cases.work_precision_study import FAST_S, REPEATS, Curve, Point, Solve, Study, studied
from verification.suite.gates import Measured
from verification.text.console import number

ADVISED = {COUPLED: SAM, TWICE: ON_TWO_GRIDS, AXISYMMETRIC: FEM, SPATIAL: FEM_3D}
"""Methods that a user is advised to take, and the names of their models."""
SAME_AT_MU_0 = ("hertz", "ratio-3", "ratio-6-2")
MONOTONE = (("hertz", COUPLED), ("hertz", AXISYMMETRIC), ("coated", COUPLED))
"""Smooth elastic contacts: the largest pressure converges from one side, at second order."""


def run(
    context: Context, problems: Sequence[Problem] = PROBLEMS, solve: Solve = measured.solve_alone
) -> Outcome:
    """Every problem, one after the other; figures, tables, the advice and its gates."""
    context.measures_anew = True  # times are of this run only
    studies = [studied(context, problem, solve) for problem in problems]
    outcome = Outcome(
        {f"{context.case}.{name}": value for name, value in gated(studies).items()}, setup(studies)
    )
    outcome.tables = [times_table(studies), references_table(studies), steps_table(studies)]
    outcome.tables += [points_table(study) for study in studies]
    outcome.figures = list(draw(context, studies))
    outcome.notes.append(
        "Processor time of the whole solve with one thread, in a new process: set-up, solution, stresses at the output depths "
        "and tables, without the loading of modules. The time to an error is interpolated between the two points that "
        "bracket it, log-log; errors that a finer grid does not keep do not count. The advice of `samfem plan` is the table "
        "beside the first figure, taken over by `python -m verification.cost.advice`. Every method takes the load steps of the "
        "reference, which is backward Euler's: what more steps would change is studied by itself, against their limit at one "
        "resolution."
    )
    return outcome


def gated(studies: Sequence[Study]) -> dict[str, Measured]:
    """Ratios of times at equal error, steadiness of the convergence, floors."""
    found, values = {study.problem.name: study for study in studies}, {}
    for name in SAME_AT_MU_0:
        for target in TARGETS[1:]:
            if name in found:
                values[f"{name}-{percent(target)}"] = Measured(time_ratio(found[name], AXISYMMETRIC, target))
    if "friction-0-2" in found:
        values["friction-0-2-1"] = Measured(time_ratio(found["friction-0-2"], SPATIAL, 0.01))
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


def time_ratio(study: Study, other: str, target: float) -> float:
    """Time of SAM, on one grid or on two, over that of another method for one error; infinite where SAM never reaches it.

    A method that never reaches it needs more than its finest point took: that time is taken, which is in its favour.
    """
    found = [study.time(name, target).value for name in (COUPLED, TWICE) if name in study.curves]
    own, its = (
        min((time for time in found if time is not None), default=None),
        study.time(other, target).value,
    )
    if own is None:
        return math.inf
    return own / (its if its is not None else float(np.nanmax(study.curves[other].seconds)))


def growth(errors: np.ndarray, floor: float) -> float:
    """The largest ratio of successive errors of which the later is above the floor; 0 where there is none."""
    pairs = [(a, b) for a, b in pairwise(errors) if not b <= floor]
    return max((b / a for a, b in pairs), default=0.0)


def advice_rows(studies: Sequence[Study]) -> list[AdviceRow]:
    """What each error takes, for the methods that a user is advised to take, and the load steps."""
    rows = []
    for study in studies:
        values = {name: reference.value for name, reference in study.references.items()}
        unit, size = study.problem.advised(study.scene, values)
        curves = {
            ADVISED[name]: (c, study.floor, unit, size) for name, c in study.curves.items() if name in ADVISED
        }
        if study.problem.steps:
            curves[LOAD_STEPS] = (study.step_curves[COUPLED], study.step_floor, "load steps", 1.0)
        for target in TARGETS:
            times = [
                c.time(target, floor).value for name, (c, floor, *_) in curves.items() if name != LOAD_STEPS
            ]
            least = min((time for time in times if time is not None), default=math.nan)
            rows += [row_of(study, name, target, least, *found) for name, found in curves.items()]
    return rows


def row_of(
    study: Study, name: str, target: float, least: float, curve: Curve, floor: float, unit: str, size: float
) -> AdviceRow:
    time, cells, kernels = (reach(target, floor) for reach in (curve.time, curve.fineness, curve.kernels))
    never = time.value is None
    seconds, resolution, runs = (
        math.nan if each.value is None else each.value for each in (time, cells, kernels)
    )
    return AdviceRow(
        study.problem.kind,
        " and ".join(MEASURES[measure] for measure in study.problem.measures),
        name,
        target,
        NEVER if never else BELOW * time.coarsest,
        resolution * size,
        unit,
        study.scene.loading.steps,
        seconds,
        runs,
        math.nan if name == LOAD_STEPS else seconds / least,
    )


def setup(studies: Sequence[Study]) -> list[tuple[str, str]]:
    """The numbers of the case for the reader."""
    kernels = [
        p.kernel_s
        for study in studies
        for ps in study.points.values()
        for p in ps
        if math.isfinite(p.kernel_s)
    ]
    repeated = f"Solves of less than {FAST_S:g} s are repeated {REPEATS} times, in rounds with the others; medians count"
    return [
        ("Problems", "; ".join(study.problem.title for study in studies)),
        (
            "Calibration kernel",
            f"{median(kernels):.3f} s, from {min(kernels):.3f} to {max(kernels):.3f} s between the solves",
        ),
        ("Repeats", repeated),
    ]


def times_table(studies: Sequence[Study]) -> SmallTable:
    """Processor seconds to each error, with the resolution; and the same in kernels for 1 %."""
    rows = []
    for study in studies:
        for name, found in study.curves.items():
            cells = [
                spent(found.time(target, study.floor), found.fineness(target, study.floor))
                for target in TARGETS
            ]
            kernels = found.kernels(0.01, study.floor).value
            rows.append((study.problem.title, name, *cells, "" if kernels is None else number(kernels, 3)))
    columns = ("problem", "method", *(f"{100.0 * t:g} %" for t in TARGETS), "1 %, in kernels")
    return SmallTable("Processor time in s to an error (resolution)", columns, rows)


def spent(time: Reached, fineness: Reached) -> str:
    """A cell of the table."""
    if time.value is None:
        return f"{NEVER} ({100.0 * time.smallest:.2g} %)"
    return f"{'< ' * time.coarsest}{number(time.value, 3)} ({number(fineness.value, 3)})"


def references_table(studies: Sequence[Study]) -> SmallTable:
    rows = [
        (
            study.problem.title,
            MEASURES[name],
            number(one.value, 6),
            f"{100.0 * one.uncertainty:.2g} %",
            one.origin,
        )
        for study in studies
        for name, one in study.references.items()
    ]
    return SmallTable("References", ("problem", "quantity (SI)", "value", "uncertainty", "from"), rows)


def steps_table(studies: Sequence[Study]) -> SmallTable:
    """Errors over the load steps."""
    rows = []
    for study in studies:
        for name, found in study.step_curves.items() if study.problem.steps else ():
            for point, error in zip(found.points, found.errors, strict=True):
                cells = (
                    f"{100.0 * error:.3g} %",
                    number(point.cpu_s, 3),
                    f"{point.counters.get('operator_applications')}",
                )
                rows.append((study.problem.title, name, f"{point.resolution}", *cells, point.status))
    columns = (
        "problem",
        "method",
        "load steps",
        "error",
        "processor time [s]",
        "operator applications",
        "status",
    )
    return SmallTable("Load steps at one resolution, against their extrapolation", columns, rows)


def points_table(study: Study) -> SmallTable:
    """One row a solve."""
    rows = []
    for name, found in study.curves.items():
        profiles = study.profile_errors(name) if study.problem.profile else [math.nan] * len(found.points)
        for point, error, profile in zip(found.points, found.errors, profiles, strict=True):
            rows.append((name, f"{point.resolution}", *_cells(point, error, profile)))
    columns = (
        *("method", study.problem.unit, "error", "axis, L2", "processor time [s]", "spread", "in kernels"),
        *("set-up [s]", "solution [s]", "memory [MB]", "counters", "status"),
    )
    return SmallTable(study.problem.title, columns, rows)


def _cells(point: Point, error: float, profile: float) -> tuple[str, ...]:
    counted = ", ".join(
        f"{name.replace('_', ' ')} {value}" for name, value in point.counters.items() if value
    )
    shares = tuple(f"{100.0 * value:.3g} %" if math.isfinite(value) else "" for value in (error, profile))
    seconds = (number(point.cpu_s, 3), f"{point.spread:.2f}", number(point.kernels, 3))
    rest = (number(point.setup_s, 3), number(point.solve_s, 3), number(point.peak_memory_bytes / 1e6, 3))
    return (*shares, *seconds, *rest, counted, point.status)


def draw(context: Context, studies: Sequence[Study]) -> Iterator:
    """The overview, whose data are the advice, and a figure a problem."""
    rows = advice_rows(studies)
    times = {study.problem.kind: {name: study.time(name, 0.01) for name in study.curves} for study in studies}
    drawing = overview(times, "1 %")
    yield context.save(
        Drawing(drawing.figure, columns_of(rows)),
        "advice",
        "Processor time to 1 %",
        "Marks on a logarithmic axis of processor time, one row a kind of scene and one mark a method.",
        "Hollow: even the coarsest point is better, the time is an upper bound. What never reaches 1 % has no mark. The data "
        "are the advice of samfem plan.",
    )
    for study in studies:
        panels = {"resolution": (lines_of(study.curves), study.floor)}
        if study.problem.steps:
            panels["load steps"] = (lines_of(study.step_curves), study.step_floor)
        words = " and ".join(MEASURES[name] for name in study.problem.measures)
        yield context.save(
            curves(panels, f"error of the {words}"),
            study.problem.name,
            study.problem.title,
            f"Log-log plot of the error of the {words} over processor time, a falling curve for each method.",
            "Shaded: uncertainty of the reference, below which nothing is claimed. Along a curve the grid is refined, or the "
            "load steps.",
        )


def lines_of(found: Mapping[str, Curve]) -> dict[str, Line]:
    return {
        name: Line(each.seconds, each.errors, np.array([point.resolution for point in each.points]))
        for name, each in found.items()
    }


CASES = (
    Case(
        "work-precision",
        "Error against run time",
        "Which method, and how fine, reaches a given error in the least time?",
        run,
        (
            (
                "Reference",
                "closed form, or the limits of SAM and of FEM, weighted with the inverse squares of their last corrections",
                "Richardson (1911); Roache, Verification and Validation in Computational Science and Engineering (1998)",
            ),
            (
                "Floor",
                "half the disagreement of the limits, at least a third of the smaller correction",
                "this case",
            ),
            (
                "Time to an error",
                "log-log between the last point above it and the next",
                "verification/cost/precision.py",
            ),
        ),
        ("full",),
    ),
)
