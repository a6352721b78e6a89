# SPDX-License-Identifier: MIT
"""Error against run time for every kind of contact, in every form of SAM and both finite-element models. Each
solve is made in a process of its own, the methods of a problem in turn, with the time of a fixed kernel
beside them; errors are against references that know their own uncertainty.
"""

import math
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial
from itertools import pairwise, zip_longest
from typing import Any

import numpy as np

from sam.scene import Result, Scene
from verification.cases.case import FEM, FEM_3D, SAM, Context, DataFrame, Plot, SmallTable, number
from verification.cases.cost.work_precision_problems import (
    AXISYMMETRIC,
    COUPLED,
    ELLIPSOID,
    MEASURES,
    PROBLEMS,
    SPATIAL,
    TWICE,
    Method,
    Problem,
)
from verification.cost import measured
from verification.cost.advice import BELOW, COLUMNS, LOAD_STEPS, NEVER, ON_TWO_GRIDS, AdviceRow, texts_of
from verification.cost.precision import TARGETS, Ladder, Reached, Reference, agreed, at_error
from verification.figures.style import Drawing
from verification.figures.work_precision import curves, overview
from verification.rows import CaseFile

__all__ = ["beside_elements", "to_one_percent"]  # named by the file of the case

STUDIED = {problem.name: problem for problem in (*PROBLEMS, ELLIPSOID)}
ADVISED = {COUPLED: SAM, TWICE: ON_TWO_GRIDS, AXISYMMETRIC: FEM, SPATIAL: FEM_3D}
"""Methods that a user is advised to take, and the names of their models."""
ONES = (COUPLED, TWICE)
"""SAM as it is held against finite elements: the better one counts."""
KNOWN = 3.0
"""Times better than an error that two methods are held against each other at, its reference has to be known:
below that their curves are those of the reference."""
FAST_S, REPEATS = 1.0, 3
"""A solve of less processor time is repeated, in rounds with the others; its median counts."""
OLD_S = 30.0
"""After so long the calibration kernel is run again; it takes 1.5 s with its process."""
EXACT = 1e-8
"""Uncertainty of the closed forms: that of the spectral solution of the coated sphere, the largest."""
FEWEST = 3  # points of an extrapolation
STEPS = "load steps"
Solve = Callable[[Scene, str], Result]


def frame(context: Context, names: Sequence[str] = tuple(STUDIED), solve: Solve | None = None) -> Iterator:
    """A row for each solve: problem, what is refined, method, cost, error. solve: in a process of its own."""
    for name in names:
        problem = STUDIED[name]
        scene = problem.scene(context.scene(problem.file))
        context.progress(f"{context.case}, {name}", 0, 1)
        yield from with_errors(problem, scene, solved(problem, scene, solve or measured.solve_forked))


def solved(problem: Problem, scene: Scene, solve: Solve) -> list[dict[str, Any]]:
    """A row for each method and resolution, coarse to fine, without errors. The methods take turns, a rung
    each, so that a slow minute of the machine hits all of them. kernel: seconds of the calibration kernel
    beside it; spread: largest over smallest processor time of the repeats.
    """
    jobs = [("resolution", method) for method in problem.methods]
    jobs += [(STEPS, problem.steps)] if problem.steps else []
    runs: dict[tuple, list[dict[str, Any]]] = {turn: [] for turn in in_turn([m.ladder for _, m in jobs])}
    kernel, ran_at = math.nan, -math.inf
    for repeat in range(REPEATS):
        for job, rung in [turn for turn, made in runs.items() if not repeat or made[0]["cpu_s"] < FAST_S]:
            if time.monotonic() - ran_at > OLD_S:
                kernel, ran_at = measured.alone(measured.calibration_s), time.monotonic()
            row = once(problem, jobs[job][1], scene, rung, solve=solve)
            runs[job, rung].append(row | {"kernel": kernel})
    return [
        {"refined": jobs[job][0], **merged(runs[job, rung])}
        for job in range(len(jobs))
        for rung in jobs[job][1].ladder
    ]


def in_turn(ladders: Sequence[Sequence[int]]) -> Iterator[tuple[int, int]]:
    """(number of the ladder, rung): the first of every ladder, then the second, and so on."""
    for rung in zip_longest(*([(job, n) for n in ladder] for job, ladder in enumerate(ladders))):
        yield from (turn for turn in rung if turn is not None)


def once(problem: Problem, method: Method, scene: Scene, resolution: int, *, solve: Solve) -> dict[str, Any]:
    """One solve. Values are left out where they do not count; one that breaks off is a row that says why."""
    row: dict[str, Any] = {"method": method.name, "resolution": resolution, "cpu_s": math.nan, "values": {}}
    try:
        result = solve(method.at(scene, resolution), method.model)
    except (ValueError, ArithmeticError, MemoryError, RuntimeError) as error:
        return row | {"status": f"{type(error).__name__}: {error}"[:80]}
    row |= {"cpu_s": float(result.cost["cpu_s"]), "status": result.status.value}
    if result.converged or (not method.strict and not result.last_fitting):
        row["values"] = {name: result.quantities[name] for name in problem.measures}
    return row


def merged(repeats: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    """One row of the repeats of a solve: medians of times, and the spread of processor time."""
    times = [row["cpu_s"] for row in repeats]
    medians = {name: float(np.median([row[name] for row in repeats])) for name in ("cpu_s", "kernel")}
    return {**repeats[0], **medians, "spread": max(times) / min(times) if min(times) > 0 else 1.0}


def with_errors(problem: Problem, scene: Scene, rows: Sequence[dict[str, Any]]) -> Iterator[dict[str, Any]]:
    """The rows with the largest error of their quantities, against a closed form or the limits of the finest,
    nan where there is no answer; with the uncertainty of the references as `floor`, below which no error is
    claimed; and with what the advice calls a resolution of 1, its name and size.
    """
    if problem.exact is None:
        found = limits(problem, [row for row in rows if row["refined"] != STEPS], problem.references)
    else:
        found = {name: Reference(value, EXACT, "closed form") for name, value in problem.exact(scene).items()}
    references = {"resolution": found}
    values = {name: reference.value for name, reference in references["resolution"].items()}
    unit, size = problem.advised(scene, values)
    if problem.steps:  # infinitely many load steps at one resolution, by the default loop
        references[STEPS] = limits(problem, [row for row in rows if row["refined"] == STEPS], [COUPLED])
    for row in rows:
        against = references[row["refined"]]
        errors = [one.error(row["values"].get(name)) for name, one in against.items()]
        yield row | {
            "sweep": problem.name,
            "model": ADVISED.get(row["method"], row["method"]),
            "error": max(errors) if row["values"] else math.nan,
            "floor": max(one.uncertainty for one in against.values()),
            "kernels": row["cpu_s"] / row["kernel"],
            "references": against,
            "advised": (unit, size) if row["refined"] != STEPS else (LOAD_STEPS, 1.0),
            "load_steps": scene.loading.steps,
        }


def limits(problem: Problem, rows: Sequence[Mapping], methods: Sequence[str]) -> Mapping[str, Reference]:
    """Quantity -> limit of the finest points of some methods. RuntimeError where too few have an answer."""
    tops = {name: [r for r in rows if r["method"] == name and r["values"]] for name in methods}
    for name, own in tops.items():
        if len(own) < FEWEST:
            raise RuntimeError(f"{name}: {len(own)} usable resolutions, {FEWEST} are needed for a reference")
    ladders = {
        quantity: [
            Ladder(name, [1.0 / r["resolution"] for r in top], [r["values"][quantity] for r in top])
            for name, own in tops.items()
            for top in [own[-problem.tops :]]
        ]
        for quantity in problem.measures
    }
    return {quantity: agreed(*each) for quantity, each in ladders.items()}


# what rows take


def reached(rows: DataFrame, method: str, target: float, column: str = "cpu_s") -> Reached:
    """A column where a method reaches an error, from the points that cost anything."""
    own = rows[(rows["method"] == method) & np.isfinite(rows["cpu_s"])]
    return at_error(own[column], own["error"], target, max(rows["floor"]))


def ratio_at(rows: DataFrame, _: str, *, target: float) -> float:
    """Time of SAM, on one grid or on two, over that of the axisymmetric model for one error; infinite where
    SAM never reaches it. A model that never reaches it needs more than its finest point took: that time is
    taken, which is in its favour.
    """
    own, its = ([reached(rows, n, target).value for n in names] for names in (ONES, [AXISYMMETRIC]))
    least = min((each for each in own if each is not None), default=math.inf)
    slowest = float(rows["cpu_s"][rows["method"] == AXISYMMETRIC].max())
    return least / (slowest if its[0] is None else its[0])


ratio_at_one, ratio_at_a_third = (partial(ratio_at, target=target) for target in TARGETS[1:3])


def faster(rows: DataFrame, other: str) -> tuple[float, float]:
    """How many times the processor time of SAM, on one grid or on two, another method takes to the smallest
    error that both reach, and that error; nan where one of them reaches none. The error is that of the finest
    point of the one that ends at the larger, and at least KNOWN times the floor.
    """
    last = {name: float(own.iloc[-1]) for name, own in rows["error"].groupby(rows["method"])}
    least = KNOWN * max(rows["floor"])
    ends = {name: max(error, least) for name, error in last.items() if math.isfinite(error)}
    own = [name for name in ONES if name in ends]
    if other not in ends or not own:
        return math.nan, math.nan
    target = max(ends[other], min(ends[name] for name in own))
    seconds = [reached(rows, name, target).value for name in own]
    ours, its = min(each for each in seconds if each is not None), reached(rows, other, target).value
    return (math.nan if its is None else its / ours), target


def faster_than_spatial(rows: DataFrame, _: str) -> float:
    """SAM than the three-dimensional model: what no model in two dimensions can solve."""
    return faster(rows, SPATIAL)[0]


def growth(rows: DataFrame, column: str) -> float:
    """The largest ratio of successive errors of which the later is above the floor; 0 where there is none."""
    pairs = [(a, b) for a, b in pairwise(rows[column]) if not b <= max(rows["floor"])]
    return max((b / a for a, b in pairs), default=0.0)


# what is shown


def ladders(frame: DataFrame, refined: str = "resolution") -> Iterator[tuple[Problem, DataFrame]]:
    """The rows of each problem."""
    for name, rows in frame[frame["refined"] == refined].groupby("sweep", sort=False):
        yield STUDIED[name], rows


def methods(rows: DataFrame) -> list[str]:
    """In their order."""
    return list(dict.fromkeys(rows["method"]))


def advice_rows(frame: DataFrame) -> Iterator[AdviceRow]:
    """What each error takes, for the methods that a user is advised to take, and the load steps."""
    of_steps = {problem.name: rows for problem, rows in ladders(frame, STEPS)}
    for problem, rows in ladders(frame):
        if not problem.kind:
            continue
        found = [(ADVISED[name], rows, name) for name in methods(rows) if name in ADVISED]
        if problem.name in of_steps:
            found.append((LOAD_STEPS, of_steps[problem.name], COUPLED))
        words = " and ".join(MEASURES[measure] for measure in problem.measures)
        for target in TARGETS:
            every = [reached(own, name, target).value for label, own, name in found if label != LOAD_STEPS]
            least = min((each for each in every if each is not None), default=math.nan)
            for label, own, name in found:
                of = [reached(own, name, target, column) for column in ("cpu_s", "resolution", "kernels")]
                seconds, fineness, kernels = (math.nan if r.value is None else r.value for r in of)
                bound = NEVER if of[0].value is None else BELOW * of[0].coarsest
                (unit, size), steps = own["advised"].iloc[0], int(own["load_steps"].iloc[0])
                over = math.nan if label == LOAD_STEPS else seconds / least
                row = (problem.kind, words, label, target, bound, fineness * size, unit, steps)
                yield AdviceRow(*row, seconds, kernels, over)


def times(frame: DataFrame) -> SmallTable:
    """Processor seconds to each error, with the resolution; and the same in kernels for 1 %."""
    lines = []
    for problem, rows in ladders(frame):
        for name in methods(rows):
            cells = [spent(reached(rows, name, t), reached(rows, name, t, "resolution")) for t in TARGETS]
            kernels = reached(rows, name, 0.01, "kernels").value
            last = "" if kernels is None else number(kernels, 3)
            lines.append((problem.title, name, *cells, last))
    columns = ("problem", "method", *(f"{100.0 * t:g} %" for t in TARGETS), "1 %, in kernels")
    return SmallTable("Processor time in s to an error (resolution)", columns, lines)


def to_one_percent(frame: DataFrame) -> dict[str, Any]:
    """Under `times`: problem, quantities, and method -> seconds to 1 % or None, and whether a bound."""
    found = []
    for problem, rows in ladders(frame):
        words = dict.fromkeys(MEASURES[name] for name in rows["references"].iloc[0])
        times = {name: reached(rows, name, 0.01) for name in methods(rows)}
        seconds = {name: (time.value, time.coarsest) for name, time in times.items()}
        found.append((problem.title, " and ".join(words), seconds))
    return {"times": found}


def spent(seconds: Reached, fineness: Reached) -> str:
    """A cell of the table."""
    if seconds.value is None:
        return f"{NEVER} ({100.0 * seconds.smallest:.2g} %)"
    return f"{'< ' * seconds.coarsest}{number(seconds.value, 3)} ({number(fineness.value, 3)})"


def beside_elements(frame: DataFrame) -> SmallTable:
    """SAM beside both finite-element models, at the smallest error that both reach."""
    lines = []
    for problem, rows in ladders(frame):
        for other in (AXISYMMETRIC, SPATIAL):
            ratio, error = faster(rows, other)
            if math.isfinite(ratio):
                cells = (f"{100.0 * error:.2g} %", f"{100.0 * max(rows['floor']):.2g} %", number(ratio, 3))
                lines.append((problem.title, other, *cells))
    return SmallTable(
        "How many times the processor time of SAM the finite elements need, at the smallest error that both "
        f"reach and that is at least {KNOWN:g} times the uncertainty of the reference. A sphere at rest is a "
        "problem in two dimensions for the axisymmetric model and in three for SAM",
        "problem|method|error|uncertainty of the reference|times".split("|"),
        lines,
    )


def references(frame: DataFrame) -> SmallTable:
    """What the errors are measured against."""
    lines = [
        (problem.title, MEASURES[q], number(one.value, 6), f"{1e2 * one.uncertainty:.2g} %", one.origin)
        for problem, rows in ladders(frame)
        for q, one in rows["references"].iloc[0].items()
    ]
    return SmallTable("References", ("problem", "quantity (SI)", "value", "uncertainty", "from"), lines)


def advice(file: CaseFile, frame: DataFrame) -> Plot:
    """The time to 1 % in every kind of scene; its data are the advice of samfem plan."""
    to_1_percent = {
        problem.kind: {name: reached(rows, name, 0.01) for name in methods(rows)}
        for problem, rows in ladders(frame)
        if problem.kind
    }
    data = dict(zip(COLUMNS, map(list, zip(*map(texts_of, advice_rows(frame)), strict=True)), strict=True))
    return Plot(
        Drawing(overview(to_1_percent, "1 %").figure, data),
        "advice",
        "Processor time to 1 %",
        "The figure compares the processor time that each method needs for an error of 1 %. An arrow to the "
        "left marks an upper bound, as even the coarsest grid is better; a method without a mark does not "
        "reach 1 %. Two grids: quantities extrapolated from two; decoupled: the traction does not displace "
        "the surface along z. The data are the advice of samfem plan.",
    )


def errors(file: CaseFile, frame: DataFrame, name: str) -> Plot:
    """`errors PROBLEM`: error over processor time, the grid refined, or the load steps."""
    problem = STUDIED[name]
    words = " and ".join(MEASURES[measure] for measure in problem.measures)
    return Plot(
        curves(frame[frame["sweep"] == name], f"error of the {words}"),
        name,
        problem.title,
        f"The figure compares the error of the {words} of each method over its processor time, as the grid "
        "or the load steps are refined. In the shade, the uncertainty of the reference, nothing is claimed.",
    )
