# SPDX-License-Identifier: MIT
"""SAM beside Tamaas, ContactMechanics and aspher: same problem, same error measure, one run on one
machine.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from verification.cases.case import FEM, Case, Context, Plot, SmallTable, number, with_mesh
from verification.cost.precision import at_error
from verification.figures.lines import of_programs
from verification.peers import elastic, plastic, problems
from verification.peers.points import PeerPoint, curves, fastest, ratio, reached
from verification.peers.programs import sam as ours
from verification.peers.reference import StoredReference, between, periodic
from verification.peers.running import (
    CONTACT_MECHANICS,
    NAMES,
    SAM,
    TAMAAS,
    installed,
    interpreter,
    missing,
    pythons_of,
)

ROUNDS = {"quick": 1, "full": 3}
MESHES = (32, 48)  # elements in the Hertz radius of the finite-element reference of the step
# on one grid, settings are compared whose error is at most this many times the smallest one there
AS_GOOD = 1.5
OURS = NAMES[SAM]


@dataclass
class ProgramTimes:
    """What the problems add to the page. kernel: seconds of the calibration kernel, of all rounds."""

    peers: Mapping[str, str]
    pythons: Mapping[str, Path]
    rounds: int
    values: dict[str, float] = field(default_factory=dict)
    tables: list[SmallTable] = field(default_factory=list)
    plots: list[Plot] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)
    kernel: list[float] = field(default_factory=list)

    def add(self, caption: str, columns: Sequence[str], rows: Sequence[Sequence[str]]) -> None:
        """A table."""
        self.tables.append(SmallTable(caption, columns, rows))

    def told(self, context: Context, problem: str) -> Callable[[str, int, int], None]:
        """Reports the progress of a problem."""
        return lambda stage, k, n: context.progress(f"{context.case}, {problem}: {stage}", k, n)


class Peers(Case):
    """Every program in turn, in several rounds."""

    def solve(self, context: Context) -> ProgramTimes:
        python = interpreter()
        peers = installed(python)
        found = ProgramTimes(peers, pythons_of(python, peers), ROUNDS[context.level])
        found.notes += [
            f"{NAMES[name]}: not built, hence not measured." for name in NAMES if name not in found.pythons
        ]
        agreement(found)
        for problem in (hertz, rough, step) if TAMAAS in found.pythons else (hertz, rough):
            problem(context, found)
        return found

    def measure(self, found: ProgramTimes) -> dict[str, float]:
        return found.values

    def setup(self, found: ProgramTimes) -> Iterator[tuple[str, str]]:
        versions = ", ".join(f"{NAMES[name]} {version}" for name, version in found.peers.items())
        yield "Programs", f"SAM and {versions}"
        yield (
            "Time",
            "processor time of set-up and solution, one thread, a process a measurement, a smaller "
            f"problem before it untimed; medians of {found.rounds} rounds, of fewer for what takes more "
            "than 2 s and 20 s; again: solved a second time in one process, with what the program keeps "
            "of the first",
        )
        grid = f"a grid of {problems.SIDE:g} a, apex on a cell centre"
        yield "Hertz", f"rigid paraboloid, not periodic, {grid}"
        yield (
            "Rough",
            f"self-affine, Hurst exponent {problems.HURST:g}, {problems.LONGEST} to {problems.WAVES} "
            f"waves on the side, the same surface on each grid, mean pressure {problems.MEAN_PRESSURE:g} "
            f"E*, rms height {problems.RMS:g} sides",
        )
        law = f"dσ_y/dε_p = {problems.HARDENING:g} E, ν = {problems.POISSON:g}"
        yield "Step", f"p₀/σ_y = 3, {law}, one load step, box 6a × 6a × 2.5a"
        kernel = (number(of(found.kernel), 3) for of in (np.median, min, max))
        words = "median {} s, from {} to {} s over {} times in between"
        yield "Calibration kernel", words.format(*kernel, len(found.kernel))

    def tables(self, found: ProgramTimes) -> list[SmallTable]:
        return found.tables

    def notes(self, found: ProgramTimes) -> list[str]:
        return found.notes

    def figures(self, found: ProgramTimes) -> list[Plot]:
        return found.plots


def agreement(found: ProgramTimes) -> None:
    """That all solve one discrete problem: their tight solutions on a grid of each kind."""
    rows, worst = [], 0.0
    for name, n in ((problems.HERTZ, 128), (problems.ROUGH, 256)):
        apart = elastic.disagreements(name, n, found.pythons)
        worst = max(worst, *apart.values())
        rows += [(f"{name}, {n}²", NAMES[program], number(value, 2)) for program, value in apart.items()]
    found.values["same-solution"] = worst
    found.add(
        "Pressure of each program with a tight tolerance: one discrete problem",
        ("problem", "program", "relative L2 distance from SAM"),
        rows,
    )


def hertz(context: Context, found: ProgramTimes) -> None:
    """Elastic Hertz: time to an error of the largest pressure."""
    points, kernel = elastic.hertz(found.pythons, found.rounds, found.told(context, "Hertz"), elastic.SIZES)
    times = reached(points, elastic.HERTZ_ERROR)
    own = times[OURS][1].value
    rows = []
    for name, (label, time) in times.items():
        same = [number(same_grid(points, n).get(name), 3) for n in elastic.COMPARED]
        rows.append((name, label, number(time.value, 3), number(finite(ratio(time.value, own)), 3), *same))
    for name, gate in ((TAMAAS, "tamaas"), (CONTACT_MECHANICS, "contact-mechanics")):
        theirs = times[NAMES[name]][1].value if name in found.pythons else None
        found.values[f"hertz-{gate}"] = ratio(theirs, own)  # aspher's times are the target
    at = number(elastic.HERTZ_ERROR, 1)
    words = "of the largest pressure, and ratios to SAM's time, there and on the same grid"
    found.add(
        f"Hertz: time to an error of {at} {words}",
        ("program", "curve", f"time to {at} [s]", "over SAM's", *(f"on {n}²" for n in elastic.COMPARED)),
        rows,
    )
    also = {"as_found": "as found", "l2": "L2"}
    found.tables.append(
        points_table("Hertz: all measurements", points, "error of p_max", also=also, kernel=kernel)
    )
    found.notes.append(
        "Hertz: the error of the largest pressure that counts is the larger of that found and that of the "
        "discrete problem solved tightly, so that no iteration wins by stopping where its error cancels that "
        "of the grid. L2: pressure of all cells against the exact mean over each; the ring at r = a rules "
        "it, and no tolerance changes it."
    )
    labels = "error of the largest pressure", "Elastic Hertz"
    found.plots.append(errors_over_time("hertz", points, labels, target=elastic.HERTZ_ERROR))
    found.kernel += kernel


def rough(context: Context, found: ProgramTimes) -> None:
    """The rough patch: time at an error of the pressure that all reach."""
    points, kernel = elastic.rough(
        found.pythons, found.rounds, found.told(context, "rough"), elastic.ROUGH_SIZES
    )
    fast = {n: fastest(points, n, elastic.ROUGH_ERROR) for n in elastic.ROUGH_SIZES}
    rows = []
    for n, each in fast.items():
        for name, p in each.items():
            over = ratio(p.seconds, each[OURS].seconds if OURS in each else None)
            rows.append((f"{n}²", name, number(p.seconds, 3), number(p.error, 2), number(finite(over), 3)))
    largest, names = fast[elastic.ROUGH_SIZES[-1]], (NAMES[CONTACT_MECHANICS], OURS)
    times = (largest[name].seconds if name in largest else None for name in names)
    found.values["rough-contact-mechanics"] = ratio(*times)
    at = number(elastic.ROUGH_ERROR, 1)
    found.add(
        f"Rough: each program at the loosest tolerance of its ladder that reaches an error of {at}",
        ("grid", "program", "time [s]", "error, L2 of the pressure", "over SAM's"),
        rows,
    )
    also = {"p_max": "of p_max"}
    found.tables.append(
        points_table("Rough: all measurements", points, "error, L2", also=also, kernel=kernel)
    )
    series = {
        name: (name, np.array(sizes), np.array([fast[n][name].seconds for n in sizes]))
        for name in NAMES.values()
        if (sizes := [n for n, each in fast.items() if name in each])
    }
    found.plots.append(
        Plot(
            of_programs(series, "cells a side", "processor time [s]"),
            "rough",
            "Rough patch: time over size",
            f"Processor time over cells a side for {', '.join(series)}.",
            f"Each at the loosest tolerance with an error of at most {at} on that grid.",
        )
    )
    found.kernel += kernel


def step(context: Context, found: ProgramTimes) -> None:
    """The elastic-plastic step of Tamaas, and of SAM in its box and on a grid of its own."""
    references = {SAM: half_space(context), TAMAAS: periodic()}
    pair = {name: found.pythons[name] for name in (SAM, TAMAAS)}
    points, kernel = plastic.step(pair, found.rounds, references, found.told(context, "step"))
    floor = references[SAM].profile_uncertainty
    own = [p for p in points if p.program == SAM]
    peer = [p for p in points if p.program == TAMAAS]
    rows = []
    for cells in plastic.COMPARED:
        theirs = fastest(peer, cells).get(NAMES[TAMAAS])
        if theirs is None:
            continue
        equal, again = soonest(own, theirs.error, floor), soonest(own, theirs.error, floor, again=True)
        same = fastest(own, cells).get(OURS)
        n, layers = cells
        found.values[f"step-{layers}"] = over = ratio(theirs.seconds, equal[1])
        second, there = (
            ratio(theirs.measurement.again, again[1]),
            ratio(theirs.seconds, same and same.seconds),
        )
        ratios = (number(finite(each), 3) for each in (over, second, there))
        own_time = f"{number(equal[1], 3)} ({equal[0]})"
        times = (number(theirs.seconds, 3), number(theirs.error, 2), own_time)
        rows.append((f"{layers} × {n} × {n}", *times, *ratios, number(same and same.error, 2)))
    columns = "cells|Tamaas [s]|its error|SAM at that error [s]|ratio|ratio of second solves"
    columns += "|ratio on the same cells|SAM's error there"
    words = "plastic strain below the apex, relative L2 error, each against what it tends to itself"
    found.add(f"Elastic-plastic step: {words}", columns.split("|"), rows)
    also = {"largest": "of the largest"}
    found.tables += [
        points_table("Step: all measurements", points, "error, L2", also=also, kernel=kernel),
        reference_table(references),
    ]
    found.notes.append(STEP_NOTE)
    least = max(reference.profile_uncertainty for reference in references.values())
    labels = "error of the plastic strain below the apex, L2", "Elastic-plastic step"
    found.plots.append(errors_over_time("step", points, labels, floor=least))
    found.kernel += kernel


STEP_NOTE = (
    "Step: Tamaas' box is periodic and SAM's half-space is not, so each has its own limit. Tamaas' reference "
    "is its own on a finer grid, which shares the error of its grids and makes those on coarser ones look "
    "smaller rather than larger. SAM's values on the axis are those of its cells, which are means, less "
    "second differences over 24; Tamaas' are those of its points. SAM's time is that of the whole solve of "
    "the scene, with what it tabulates; elastic contacts are its solve_contact, as the peers' are their "
    "contact solvers."
)


def half_space(context: Context) -> StoredReference:
    """The limit of SAM's step: the axisymmetric finite-element model on its finest mesh."""
    found = []
    for mesh in MESHES:
        result = context.solve(FEM, with_mesh(ours.scene_of(9, 4, 1e-6), mesh), f"step-fem-{mesh}")
        counts, fields = ours.step_of(result)
        if not counts["converged"]:
            raise RuntimeError(f"the step with {mesh} elements in the contact radius is not one step of FEM")
        found.append((fields["z"], fields["peeq"]))
    return between(
        found[1], found[0], f"axisymmetric FEM, {MESHES[1]} elements in the Hertz radius, half-space"
    )


def soonest(
    points: Sequence[PeerPoint], error: float, floor: float, again: bool = False
) -> tuple[str, float | None]:
    """(label, time) of the curve that first is at an error; the error counts as no smaller than the floor.

    again: the time of a second solution in the process of the first.
    """
    found = []
    for label, own in curves(points).items():
        solved = [p for p in own if p.measurement.solved]
        if again:
            solved = [p for p in solved if p.measurement.again_s]
        times = [p.measurement.again if again else p.seconds for p in solved]
        time = at_error(times, [p.error for p in solved], max(error, floor), floor).value
        found.append((time if time is not None else float("inf"), label, time))
    _, label, time = min(found, key=lambda each: each[0])
    return label, time


def same_grid(points: Sequence[PeerPoint], n: int) -> dict[str, float]:
    """Program -> its time over SAM's on n^2 cells of one grid, with settings whose error is that of the
    grid.
    """
    errors = [p.error for p in points if p.cells == n and p.measurement.solved]
    found = fastest(points, n, AS_GOOD * min(errors, default=0.0))
    return {name: ratio(p.seconds, found[OURS].seconds) for name, p in found.items()} if OURS in found else {}


def finite(value: float) -> float | None:
    """A number, or None where it is not finite."""
    return value if np.isfinite(value) else None


def points_table(
    caption: str, points: Sequence[PeerPoint], error: str, *, also: Mapping[str, str], kernel: Sequence[float]
) -> SmallTable:
    """A row a measurement; those without an answer say why."""
    unit, rows = float(np.median(kernel)), []
    for p in points:
        m = p.measurement
        sides = [p.cells] if isinstance(p.cells, int) else [p.cells[1], p.cells[0], p.cells[0]]
        cells = f"{p.cells}²" if len(sides) == 1 else " × ".join(map(str, sides))
        if not m.solved:
            rows.append((p.label, cells, m.failure or "not converged", *("",) * (len(also) + 8)))
            continue
        between = f"{min(m.cpu_s):.3g}, {max(m.cpu_s):.3g}"
        parts = (
            number(float(np.median(m.setup_s)), 2),
            number(finite(m.again), 3),
            number(p.seconds / unit, 3),
        )
        errors = (number(p.error, 2), *(number(p.also.get(name), 2) for name in also))
        rest = (number(m.record.get("iterations")), f"{m.record['peak_memory_bytes'] / 1e6:.0f}")
        times = (number(p.seconds, 3), between, str(len(m.cpu_s)))
        rows.append((p.label, cells, *times, *parts, *errors, *rest))
    columns = "curve|cells|time [s]|least, most|rounds|set-up [s]|again [s]|/ kernel".split("|")
    return SmallTable(caption, (*columns, error, *also.values(), "iterations", "memory [MB]"), rows)


def reference_table(references: Mapping[str, StoredReference]) -> SmallTable:
    """The references of the step."""
    rows = [
        (NAMES[name], each.text, number(each.peeq_max, 5), *(number(u, 2) for u in around))
        for name, each in references.items()
        if (around := (each.uncertainty, each.profile_uncertainty))
    ]
    columns = ("for", "what", "largest strain [σ_y/E]", "uncertainty", "of the profile, L2")
    words = "Step: references, with the distance of the next coarser grid as uncertainty"
    return SmallTable(words, columns, rows)


def errors_over_time(
    name: str,
    points: Sequence[PeerPoint],
    labels: tuple[str, str],
    *,
    target: float | None = None,
    floor: float = 0.0,
) -> Plot:
    """Error over processor time, a curve a program and setting. labels: of the error, and the title."""
    ylabel, title = labels
    series = {}
    for label, own in curves(points).items():
        if solved := [p for p in own if p.measurement.solved]:
            times, errors = (np.array([getattr(p, of) for p in solved]) for of in ("seconds", "error"))
            series[label] = (own[0].name, times, errors)
    drawing = of_programs(series, "processor time [s]", ylabel, target=target, floor=floor)
    dotted = "Dotted: the error whose times are compared."
    shade = "Shaded: the uncertainty of the references." if floor else dotted
    words = f"{title}: {ylabel} over processor time for {', '.join(series)}."
    return Plot(
        drawing, name, f"{title}: error over time", words, f"A marker a grid, coarse to fine. {shade}"
    )


CASES = (Peers("peers", needs=missing, alone=True),)
