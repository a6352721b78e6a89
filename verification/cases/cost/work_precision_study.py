# SPDX-License-Identifier: MIT
"""The measurement of case work-precision: each solve in a process of its own, the methods of a problem in
turn, with the time of a fixed kernel beside them; errors against references that know their own uncertainty.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, partial
from itertools import zip_longest
from statistics import median

import numpy as np

from sam.scene import Result, Scene
from verification.cases.case import Context
from verification.cases.cost.work_precision_problems import COUPLED, Method, Problem
from verification.cost import measured
from verification.cost.precision import Ladder, Reached, Reference, agreed, at_error
from verification.runs.sampling import peak

FAST_S, REPEATS = 1.0, 3
"""A solve of less processor time is repeated, in rounds with the others; its median counts."""
OLD_S = 30.0
"""After so long the calibration kernel is run again; it takes 1.5 s with its process."""
EXACT = 1e-8
"""Uncertainty of the closed forms: of the spectral solution of the coated sphere, and more than that of the
others.
"""
FEWEST = 3  # points of an extrapolation
Solve = Callable[[Scene, str], Result]


@dataclass(frozen=True)
class SolvePoint:
    """One solve: what it cost (medians where it was repeated) and what it found.

    kernel_s: of the calibration kernel beside it; spread: largest over smallest processor time of the
    repeats; counters: see sam.scene.result.COST.
    """

    method: str
    resolution: int
    status: str
    cpu_s: float = math.nan
    setup_s: float = math.nan
    solve_s: float = math.nan
    peak_memory_bytes: float = math.nan
    kernel_s: float = math.nan
    repeats: int = 1
    spread: float = 1.0
    values: Mapping[str, float | None] = field(default_factory=dict)
    counters: Mapping[str, int | None] = field(default_factory=dict)
    profile: tuple[np.ndarray, np.ndarray] | None = None

    @property
    def kernels(self) -> float:
        """Processor time in runs of the calibration kernel."""
        return self.cpu_s / self.kernel_s


COUNTERS = (
    *(
        "contact_iterations",
        "plastic_iterations",
        "operator_applications",
        "displacement_applications",
        "newton_iterations",
    ),
    "step_cuts",
)


def point_of(problem: Problem, method: Method, resolution: int, result: Result) -> SolvePoint:
    """Of a single solve; values are left out where they do not count, or the peak was not reached."""
    usable = result.converged or (not method.strict and not result.last_fitting)
    cost, values = result.cost, {name: result.quantities[name] for name in problem.measures}
    return SolvePoint(
        method.name,
        resolution,
        result.status.value,
        **{name: float(cost[name]) for name in ("cpu_s", "setup_s", "solve_s", "peak_memory_bytes")},
        values=values if usable else {},
        counters={name: cost.get(name) for name in COUNTERS},
        profile=_profile(problem, result) if usable else None,
    )


def _profile(problem: Problem, result: Result) -> tuple[np.ndarray, np.ndarray] | None:
    return peak(result.tables["axis"], "z_m", problem.profile) if problem.profile else None


@dataclass(frozen=True)
class ErrorCurve:
    """The points of a method, coarse to fine, with their errors, nan where there is no answer; floor: the
    uncertainty of the references, below which no error is claimed.
    """

    points: Sequence[SolvePoint]
    errors: np.ndarray
    floor: float

    @property
    def seconds(self) -> np.ndarray:
        """Processor time of each point, s."""
        return np.array([point.cpu_s for point in self.points])

    def reached(self, values: Sequence[float], target: float) -> Reached:
        """`values` where the error is `target`, from the points that cost anything."""
        solved = np.isfinite(self.seconds)
        return at_error(np.asarray(values)[solved], self.errors[solved], target, self.floor)

    def time(self, target: float) -> Reached:
        """Processor time to an error."""
        return self.reached(self.seconds, target)

    def fineness(self, target: float) -> Reached:
        """The resolution at an error."""
        return self.reached([float(point.resolution) for point in self.points], target)

    def kernels(self, target: float) -> float | None:
        """Runs of the calibration kernel to an error."""
        return self.reached([point.kernels for point in self.points], target).value


@dataclass(frozen=True)
class ProblemStudy:
    """A problem, solved. references: quantity -> reference, of the resolutions; step_references: of the load
    steps.
    """

    problem: Problem
    scene: Scene
    points: Mapping[str, Sequence[SolvePoint]]
    step_points: Mapping[str, Sequence[SolvePoint]]

    @cached_property
    def references(self) -> Mapping[str, Reference]:
        """Quantity -> what its errors are measured against."""
        problem = self.problem
        if problem.exact is not None:
            return {
                name: Reference(value, EXACT, "closed form")
                for name, value in problem.exact(self.scene).items()
            }
        tops = {name: usable(self.points[name])[-problem.tops :] for name in problem.references}
        return {q: agreed(*(ladder(name, top, q) for name, top in tops.items())) for q in problem.measures}

    @cached_property
    def step_references(self) -> Mapping[str, Reference]:
        """Infinitely many load steps at one resolution, by the default loop."""
        top = usable(self.step_points[COUPLED])[-self.problem.tops :]
        return {q: agreed(ladder(COUPLED, top, q)) for q in self.problem.measures}

    @cached_property
    def floor(self) -> float:
        """Uncertainty of the references, below which no error is claimed."""
        return max(reference.uncertainty for reference in self.references.values())

    @cached_property
    def curves(self) -> Mapping[str, ErrorCurve]:
        """Method -> its curve over the resolutions."""
        return {m.name: curve(self.points[m.name], self.references) for m in self.problem.methods}

    @cached_property
    def step_curves(self) -> Mapping[str, ErrorCurve]:
        """Method -> its curve over the load steps."""
        return {m.name: curve(self.step_points[m.name], self.step_references) for m in self.problem.steps}

    def with_references(self, share: float) -> ProblemStudy:
        """The study against references that are off by a share of their uncertainty."""
        moved = {
            name: replace(one, value=one.value * (1.0 + share * one.uncertainty))
            for name, one in self.references.items()
        }
        other = replace(self)
        other.__dict__["references"] = moved  # in place of what the cached property would compute
        return other

    def profile_errors(self, name: str) -> list[float]:
        """L2 distances of the profiles on the axis from the finest of the reference, nan where there is
        none.
        """
        best = next(
            (p.profile for p in reversed(self.points[self.problem.references[-1]]) if p.profile), None
        )
        return [profile_distance(point.profile, best) for point in self.points[name]]


def studied(context: Context, problem: Problem, solve: Solve) -> ProblemStudy:
    """Solve a problem with every method at every resolution, and at every number of load steps."""
    scene = problem.scene(context.scene(problem.file))
    jobs = {("grid", method.name): method for method in problem.methods}
    jobs |= {("steps", method.name): method for method in problem.steps}
    found = solved(
        jobs, problem, scene, solve, progress=partial(context.progress, f"{context.case}, {problem.name}")
    )
    points = {name: found["grid", name] for kind, name in jobs if kind == "grid"}
    return ProblemStudy(
        problem, scene, points, {name: found["steps", name] for kind, name in jobs if kind == "steps"}
    )


def solved(jobs: Mapping, problem: Problem, scene: Scene, solve: Solve, *, progress: Callable) -> dict:
    """Job -> points, coarse to fine. The jobs take turns, a rung each, so that a slow minute of the machine
    hits all of them.
    """
    turns = list(in_turn({job: method.ladder for job, method in jobs.items()}))
    runs: dict[tuple, list[SolvePoint]] = {turn: [] for turn in turns}
    kernel = Kernel()
    for repeat in range(REPEATS):
        chosen = [turn for turn in turns if not repeat or runs[turn][0].cpu_s < FAST_S]
        for done, (job, resolution) in enumerate(chosen):
            progress(done, len(chosen))
            beside = kernel.seconds()
            point = once(problem, jobs[job], scene, resolution, solve=solve)
            runs[job, resolution].append(replace(point, kernel_s=beside))
    return {job: [merged(runs[job, n]) for n in method.ladder] for job, method in jobs.items()}


class Kernel:
    """The calibration kernel, run again when the last run is `OLD_S` old."""

    def __init__(self) -> None:
        self._seconds, self._at = math.nan, -math.inf

    def seconds(self) -> float:
        """The last run of the kernel, s."""
        if time.monotonic() - self._at > OLD_S:
            self._seconds, self._at = measured.alone(measured.calibration_s), time.monotonic()
        return self._seconds


def in_turn(ladders: Mapping[object, Sequence[int]]) -> Iterator[tuple]:
    """(job, resolution): the first of every ladder, then the second, and so on."""
    for rung in zip_longest(*([(job, n) for n in ladder] for job, ladder in ladders.items())):
        yield from (turn for turn in rung if turn is not None)


def once(problem: Problem, method: Method, scene: Scene, resolution: int, *, solve: Solve) -> SolvePoint:
    """One solve; one that breaks off is a point without values that says why."""
    try:
        result = solve(method.at(scene, resolution), method.model)
    except (ValueError, ArithmeticError, MemoryError, RuntimeError) as error:
        return SolvePoint(method.name, resolution, f"{type(error).__name__}: {error}"[:80])
    return point_of(problem, method, resolution, result)


def merged(points: Sequence[SolvePoint]) -> SolvePoint:
    """One point of the repeats of a solve: medians of times and memory, and the spread of the processor
    time.
    """
    medians = {
        name: median(getattr(point, name) for point in points)
        for name in ("cpu_s", "setup_s", "solve_s", "peak_memory_bytes", "kernel_s")
    }
    times = [point.cpu_s for point in points]
    return replace(
        points[0], **medians, repeats=len(points), spread=max(times) / min(times) if min(times) > 0 else 1.0
    )


def usable(points: Sequence[SolvePoint]) -> list[SolvePoint]:
    """Points with an answer."""
    return [point for point in points if point.values]


def ladder(name: str, points: Sequence[SolvePoint], quantity: str) -> Ladder:
    """For an extrapolation. RuntimeError where too few points have an answer."""
    if len(points) < FEWEST:
        raise RuntimeError(f"{name}: {len(points)} usable resolutions, {FEWEST} are needed for a reference")
    return Ladder(
        name, [1.0 / point.resolution for point in points], [point.values[quantity] for point in points]
    )


def curve(points: Sequence[SolvePoint], references: Mapping[str, Reference]) -> ErrorCurve:
    """Errors: the largest over the quantities."""
    errors = [
        max(reference.error(point.values.get(name)) for name, reference in references.items())
        if point.values
        else math.nan
        for point in points
    ]
    return ErrorCurve(points, np.array(errors), max(each.uncertainty for each in references.values()))


def profile_distance(own: tuple | None, best: tuple | None) -> float:
    """Relative L2 over the depths of the better one, within those of both."""
    if own is None or best is None:
        return math.nan
    (z, value), (depths, reference) = own, best
    shared = (depths >= z[0]) & (depths <= z[-1])
    at, weight = depths[shared], np.gradient(depths[shared])
    apart = np.interp(at, z, value) - reference[shared]
    return float(np.sqrt(np.sum(weight * apart**2) / np.sum(weight * reference[shared] ** 2)))
