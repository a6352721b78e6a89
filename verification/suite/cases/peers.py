# SPDX-License-Identifier: MIT
"""SAM beside Tamaas, ContactMechanics and aspher: same problem, same error measure, one run on one machine."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from verification.cost.precision import at_error
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
from verification.runs.models import FEM
from verification.suite.cases.case import Case, Context, Figure, Outcome, SmallTable, with_mesh
from verification.suite.gates import Measured
from verification.text.console import number

ROUNDS = {"quick": 1, "full": 3}
MESHES = (32, 48)  # elements in the Hertz radius of the finite-element reference of the step
# on one grid, settings are compared whose error is at most this many times the smallest one there
AS_GOOD = 1.5
OURS = NAMES[SAM]


def run(context: Context) -> Outcome:
    """Every program in turn, in several rounds."""
    context.measures_anew = True  # times are those of this run
    python = interpreter()
    peers = installed(python)
    pythons = pythons_of(python, peers)
    outcome = Outcome(setup=setup(peers, ROUNDS[context.level]))
    outcome.notes += [
        f"{NAMES[name]}: not built, hence not measured." for name in NAMES if name not in pythons
    ]
    agreement(context, outcome, pythons)
    kernel = hertz(context, outcome, pythons) + rough(context, outcome, pythons)
    if TAMAAS in pythons:
        kernel += step(context, outcome, pythons)
    calibration = float(np.median(kernel))
    low, high = number(min(kernel), 3), number(max(kernel), 3)
    text = f"median {number(calibration, 3)} s, from {low} to {high} s over {len(kernel)} times in between"
    outcome.setup.append(("Calibration kernel", text))
    return outcome


def setup(peers: Mapping[str, str], rounds: int) -> list[tuple[str, str]]:
    versions = ", ".join(f"{NAMES[name]} {version}" for name, version in peers.items())
    return [
        ("Programs", f"SAM and {versions}"),
        (
            "Time",
            "processor time of set-up and solution, one thread, a process a measurement, a smaller problem before it untimed; "
            f"medians of {rounds} rounds, of fewer for what takes more than 2 s and 20 s; again: solved a second time in one "
            "process, with what the program keeps of the first",
        ),
        ("Hertz", f"rigid paraboloid, not periodic, a grid of {problems.SIDE:g} a, apex on a cell centre"),
        (
            "Rough",
            f"self-affine, Hurst exponent {problems.HURST:g}, {problems.LONGEST} to {problems.WAVES} waves on the side, the "
            f"same surface on each grid, mean pressure {problems.MEAN_PRESSURE:g} E*, rms height {problems.RMS:g} sides",
        ),
        (
            "Step",
            f"p₀/σ_y = 3, dσ_y/dε_p = {problems.HARDENING:g} E, ν = {problems.POISSON:g}, one load step, box 6a × 6a × 2.5a",
        ),
    ]


def agreement(context: Context, outcome: Outcome, pythons: Mapping[str, Path]) -> None:
    """That all solve one discrete problem: their tight solutions on a grid of each kind."""
    rows, worst = [], 0.0
    for name, n in ((problems.HERTZ, 128), (problems.ROUGH, 256)):
        found = elastic.disagreements(name, n, pythons)
        worst = max(worst, *found.values())
        rows += [(f"{name}, {n}²", NAMES[program], number(value, 2)) for program, value in found.items()]
    outcome.values[f"{context.case}.same-solution"] = Measured(worst)
    columns = ("problem", "program", "relative L2 distance from SAM")
    outcome.tables.append(
        SmallTable("Pressure of each program with a tight tolerance: one discrete problem", columns, rows)
    )


def hertz(context: Context, outcome: Outcome, pythons: Mapping[str, Path]) -> list[float]:
    """Elastic Hertz: time to an error of the largest pressure."""
    points, kernel = elastic.hertz(pythons, ROUNDS[context.level], told(context, "Hertz"), elastic.SIZES)
    times = reached(points, elastic.HERTZ_ERROR)
    own = times[OURS][1].value
    rows = []
    for name, (label, time) in times.items():
        same = [number(same_grid(points, n).get(name), 3) for n in elastic.COMPARED]
        rows.append((name, label, number(time.value, 3), number(finite(ratio(time.value, own)), 3), *same))
    for name, gate in (
        (TAMAAS, "tamaas"),
        (CONTACT_MECHANICS, "contact-mechanics"),
    ):  # aspher's times are the target
        value = ratio(times[NAMES[name]][1].value if name in pythons else None, own)
        outcome.values[f"{context.case}.hertz-{gate}"] = Measured(value)
    at = number(elastic.HERTZ_ERROR, 1)
    columns = ("program", "curve", f"time to {at} [s]", "over SAM's", *(f"on {n}²" for n in elastic.COMPARED))
    caption = f"Hertz: time to an error of {at} of the largest pressure, and ratios to SAM's time, there and on the same grid"
    outcome.tables.append(SmallTable(caption, columns, rows))
    also = {"as_found": "as found", "l2": "L2"}
    outcome.tables.append(points_table("Hertz: all measurements", points, "error of p_max", also, kernel))
    outcome.notes.append(
        "Hertz: the error of the largest pressure that counts is the larger of that found and that of the discrete problem "
        "solved tightly, so that no iteration wins by stopping where its error cancels that of the grid. L2: pressure of all "
        "cells against the exact mean over each; the ring at r = a rules it, and no tolerance changes it."
    )
    outcome.figures.append(
        save(context, "hertz", points, "error of the largest pressure", elastic.HERTZ_ERROR, "Elastic Hertz")
    )
    return kernel


def rough(context: Context, outcome: Outcome, pythons: Mapping[str, Path]) -> list[float]:
    """The rough patch: time at an error of the pressure that all reach."""
    points, kernel = elastic.rough(
        pythons, ROUNDS[context.level], told(context, "rough"), elastic.ROUGH_SIZES
    )
    found = {n: fastest(points, n, elastic.ROUGH_ERROR) for n in elastic.ROUGH_SIZES}
    rows = []
    for n, fast in found.items():
        for name, p in fast.items():
            over = ratio(p.seconds, fast[OURS].seconds if OURS in fast else None)
            rows.append((f"{n}²", name, number(p.seconds, 3), number(p.error, 2), number(finite(over), 3)))
    largest = found[elastic.ROUGH_SIZES[-1]]
    theirs, own = (
        largest[name].seconds if name in largest else None for name in (NAMES[CONTACT_MECHANICS], OURS)
    )
    outcome.values[f"{context.case}.rough-contact-mechanics"] = Measured(ratio(theirs, own))
    at = number(elastic.ROUGH_ERROR, 1)
    caption = f"Rough: each program at the loosest tolerance of its ladder that reaches an error of {at}"
    columns = ("grid", "program", "time [s]", "error, L2 of the pressure", "over SAM's")
    outcome.tables.append(SmallTable(caption, columns, rows))
    also = {"p_max": "of p_max"}
    outcome.tables.append(points_table("Rough: all measurements", points, "error, L2", also, kernel))
    series = {}
    for name in NAMES.values():
        if sizes := [n for n, fast in found.items() if name in fast]:
            series[name] = (name, np.array(sizes), np.array([found[n][name].seconds for n in sizes]))
    outcome.figures.append(draw_rough(context, series))
    return kernel


def step(context: Context, outcome: Outcome, pythons: Mapping[str, Path]) -> list[float]:
    """The elastic-plastic step of Tamaas, and of SAM in its box and on a grid of its own."""
    references = {SAM: half_space(context), TAMAAS: periodic()}
    pair = {name: pythons[name] for name in (SAM, TAMAAS)}
    points, kernel = plastic.step(pair, ROUNDS[context.level], references, told(context, "step"))
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
        over = ratio(theirs.seconds, equal[1])
        outcome.values[f"{context.case}.step-{layers}"] = Measured(over)
        rows.append(
            (
                f"{layers} × {n} × {n}",
                number(theirs.seconds, 3),
                number(theirs.error, 2),
                f"{number(equal[1], 3)} ({equal[0]})",
                number(finite(over), 3),
                number(finite(ratio(theirs.measurement.again, again[1])), 3),
                number(finite(ratio(theirs.seconds, same and same.seconds)), 3),
                number(same and same.error, 2),
            )
        )
    columns = (
        *("cells", "Tamaas [s]", "its error", "SAM at that error [s]", "ratio", "ratio of second solves"),
        *("ratio on the same cells", "SAM's error there"),
    )
    caption = "Elastic-plastic step: plastic strain below the apex, relative L2 error, each against what it tends to itself"
    outcome.tables.append(SmallTable(caption, columns, rows))
    also = {"largest": "of the largest"}
    outcome.tables.append(points_table("Step: all measurements", points, "error, L2", also, kernel))
    outcome.tables.append(reference_table(references))
    outcome.notes.append(
        "Step: Tamaas' box is periodic and SAM's half-space is not, so each has its own limit. Tamaas' reference is its own on "
        "a finer grid, which shares the error of its grids and makes those on coarser ones look smaller rather than larger. "
        "SAM's values on the axis are those of its cells, which are means, less second differences over 24; Tamaas' are those of "
        "its points. SAM's time is that of the whole solve of the scene, with what it tabulates; elastic contacts are its "
        "solve_contact, as the peers' are their contact solvers."
    )
    least = max(reference.profile_uncertainty for reference in references.values())
    outcome.figures.append(
        save(
            context,
            "step",
            points,
            "error of the plastic strain below the apex, L2",
            None,
            "Elastic-plastic step",
            least,
        )
    )
    return kernel


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
    """Program -> its time over SAM's on n^2 cells of one grid, with settings whose error is that of the grid."""
    errors = [p.error for p in points if p.cells == n and p.measurement.solved]
    found = fastest(points, n, AS_GOOD * min(errors, default=0.0))
    return {name: ratio(p.seconds, found[OURS].seconds) for name, p in found.items()} if OURS in found else {}


def finite(value: float) -> float | None:
    return value if np.isfinite(value) else None


def told(context: Context, problem: str):
    return lambda stage, k, n: context.progress(f"{context.case}, {problem}: {stage}", k, n)


def points_table(
    caption: str, points: Sequence[PeerPoint], error: str, also: Mapping[str, str], kernel: Sequence[float]
) -> SmallTable:
    """A row a measurement; those without an answer say why."""
    unit = float(np.median(kernel))
    columns = (
        *("curve", "cells", "time [s]", "least, most", "rounds", "set-up [s]", "again [s]", "/ kernel"),
        *(error, *also.values(), "iterations", "memory [MB]"),
    )
    return SmallTable(caption, columns, [_row(p, also, unit) for p in points])


def _row(p: PeerPoint, also: Mapping[str, str], unit: float) -> tuple[str, ...]:
    m = p.measurement
    cells = (
        f"{p.cells}²"
        if isinstance(p.cells, int)
        else " × ".join(str(n) for n in (p.cells[1], p.cells[0], p.cells[0]))
    )
    if not m.solved:
        why = m.failure or "not converged"
        return (p.label, cells, why, *("",) * (len(also) + 8))
    return (
        *(p.label, cells, number(p.seconds, 3), f"{min(m.cpu_s):.3g}, {max(m.cpu_s):.3g}", str(len(m.cpu_s))),
        *(number(float(np.median(m.setup_s)), 2), number(finite(m.again), 3)),
        *(number(p.seconds / unit, 3), number(p.error, 2)),
        *(number(p.also.get(name), 2) for name in also),
        *(number(m.record.get("iterations")), f"{m.record['peak_memory_bytes'] / 1e6:.0f}"),
    )


def reference_table(references: Mapping[str, StoredReference]) -> SmallTable:
    rows = [
        (
            NAMES[name],
            each.text,
            number(each.peeq_max, 5),
            number(each.uncertainty, 2),
            number(each.profile_uncertainty, 2),
        )
        for name, each in references.items()
    ]
    columns = ("for", "what", "largest strain [σ_y/E]", "uncertainty", "of the profile, L2")
    return SmallTable(
        "Step: references, with the distance of the next coarser grid as uncertainty", columns, rows
    )


def save(
    context: Context,
    name: str,
    points: Sequence[PeerPoint],
    ylabel: str,
    target: float | None,
    title: str,
    floor: float = 0.0,
) -> Figure:
    """Error over processor time, a curve a program and setting."""
    from verification.figures.peers import curves as drawn  # loads matplotlib

    series = {}
    for label, own in curves(points).items():
        if solved := [p for p in own if p.measurement.solved]:
            series[label] = (
                own[0].name,
                np.array([p.seconds for p in solved]),
                np.array([p.error for p in solved]),
            )
    drawing = drawn(series, "processor time [s]", ylabel, ("cpu_s", "error"), target, floor)
    shade = (
        " Shaded: the uncertainty of the references."
        if floor
        else " Dotted: the error whose times are compared."
    )
    alt = f"{title}: {ylabel} over processor time for {', '.join(series)}."
    return context.save(
        drawing, name, f"{title}: error over time", alt, f"A marker a grid, coarse to fine.{shade}"
    )


def draw_rough(context: Context, series: Mapping) -> Figure:
    from verification.figures.peers import curves as drawn

    drawing = drawn(series, "cells a side", "processor time [s]", ("cells", "cpu_s"))
    title = "Rough patch: time over size"
    alt = f"Processor time over cells a side for {', '.join(series)}."
    caption = f"Each at the loosest tolerance with an error of at most {number(elastic.ROUGH_ERROR, 1)} on that grid."
    return context.save(drawing, "rough", title, alt, caption)


CASES = (
    Case(
        "peers",
        "Beside other programs",
        "How long do SAM, Tamaas, ContactMechanics and aspher take to the same error of the same problem?",
        run,
        (
            (
                "Largest pressure",
                "p₀ = 2 E* a / (π R), a³ = 3 F R / (4 E*)",
                "Johnson, Contact Mechanics (1985), ch. 4",
            ),
            (
                "Peers",
                "contact after Polonsky & Keer with Love's coefficients",
                "Wear 231 (1999) 206; Love (1929)",
            ),
            (
                "Tamaas' plasticity",
                "volume integrals, periodic, linear isotropic hardening",
                "Frérot, Bonnet, Molinari & Anciaux, CMAME 351 (2019) 951",
            ),
        ),
        levels=(),
        needs=missing,
    ),
)
