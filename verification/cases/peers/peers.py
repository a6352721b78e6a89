# SPDX-License-Identifier: MIT
"""SAM beside Tamaas, ContactMechanics and aspher: same problem, error measure and machine, in one run."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from functools import partial
from itertools import cycle
from typing import TYPE_CHECKING, Any

import numpy as np

from verification.cases.case import FEM, Context, Plot, SmallTable, number, with_mesh
from verification.cost.precision import at_error
from verification.figures.lines import CYCLES, Curve, curves
from verification.peers import elastic, plastic, problems
from verification.peers.plastic import StoredReference, between, periodic
from verification.peers.programs import sam as ours
from verification.peers.running import (
    CONTACT_MECHANICS,
    NAMES,
    SAM,
    TAMAAS,
    cells_in_words,
    installed,
    interpreter,
    missing,
    pythons_of,
)
from verification.rows import CaseFile

if TYPE_CHECKING:
    from pandas import DataFrame

__all__ = ["missing"]  # named by the file of the case
ROUNDS = {"quick": 1, "full": 3}
MESHES = (32, 48)  # elements in the Hertz radius of the finite-element reference of the step
# on one grid, settings are compared whose error is at most this many times the smallest one there
AS_GOOD = 1.5
LOOKS = dict(zip(NAMES, CYCLES, strict=False))
REFERENCES = "Step: references, with the distance of the next coarser grid as uncertainty"


def frame(context: Context) -> Iterator[dict[str, Any]]:
    """Every program in turn, in rounds: a row a measurement, led by what is compared, and how well."""
    python = interpreter()
    versions = installed(python)
    pythons, rounds = pythons_of(python, versions), ROUNDS[context.level]
    for program, name in NAMES.items():
        version = "this one" if program == SAM else versions.get(program, "not built, hence not measured")
        yield {"sweep": "programs", "model": program, "program": name, "version": version}
    for problem, n in ((problems.HERTZ, 128), (problems.ROUGH, 256)):
        for program, apart in elastic.disagreements(problem, n, pythons).items():
            row = {"sweep": "agreement", "model": program, "problem": problem, "cells": cells_in_words(n)}
            yield row | {"distance": apart}

    def told(stage: str, k: int, n: int) -> None:
        context.progress(f"{context.case}: {stage}", k, n)

    measured = [elastic.hertz(pythons, rounds, told), elastic.rough(pythons, rounds, told)]
    if TAMAAS in pythons:
        references = {SAM: half_space(context), TAMAAS: periodic()}
        pair = {name: pythons[name] for name in references}
        measured.append(plastic.step(pair, rounds, references, told))
        for program, each in references.items():
            row = {"sweep": REFERENCES, "model": program, "for": NAMES[program], "what": each.text}
            yield row | {"uncertainty of the profile, L2": each.uncertainty}
    for rows, kernel in measured:
        unit = float(np.median(kernel))
        yield from (row | {"in kernels": row["seconds"] / unit, "kernel": unit} for row in rows)


def half_space(context: Context) -> StoredReference:
    """The limit of SAM's step: the axisymmetric finite-element model on its finest mesh."""
    found = []
    for mesh in MESHES:
        result = context.solve(FEM, with_mesh(ours.scene_of(9, 4, 1e-6), mesh), f"step-fem-{mesh}")
        counts, fields = ours.step_of(result)
        if not counts["converged"]:
            raise RuntimeError(f"the step with {mesh} elements in the contact radius is not one step of FEM")
        found.append((fields["z"], fields["peeq"]))
    words = f"axisymmetric FEM, {MESHES[1]} elements in the Hertz radius, half-space"
    return between(found[1], found[0], words)


# what rows take


def reached(rows: DataFrame, target: float, floor: float = 0.0) -> dict[str, tuple[str, float | None]]:
    """Program -> its curve that first is at an error of `target`, and when; last are those never there."""
    found: dict[str, tuple[str, float | None]] = {}
    solved = rows[rows["seconds"].notna()]
    for (program, curve), own in solved.groupby(["model", "curve"], sort=False):
        time = at_error(own["seconds"], own["error"], target, floor).value
        if program not in found or (time or math.inf) < (found[program][1] or math.inf):
            found[program] = curve, time
    return found


def fastest(rows: DataFrame, cells: str, error: float = math.inf) -> DataFrame:
    """Program -> its fastest row on these cells with at most this error."""
    good = rows[(rows["cells"] == cells) & rows["seconds"].notna() & (rows["error"] <= error)]
    return good.sort_values("seconds", kind="stable").drop_duplicates("model").set_index("model")


def ratio(slower: float | None, faster: float | None) -> float:
    """slower/faster; nan where one of them is missing."""
    return slower / faster if slower and faster else math.nan


def _over_sam(rows: DataFrame, _: str, *, program: str) -> float:
    """Its time over SAM's to an error of the sphere; aspher's times are the target."""
    times = reached(rows, elastic.HERTZ_ERROR)
    return ratio(*(times.get(name, ("", None))[1] for name in (program, SAM)))


tamaas_to_error = partial(_over_sam, program=TAMAAS)
contact_mechanics_to_error = partial(_over_sam, program=CONTACT_MECHANICS)


def contact_mechanics_on_finest(rows: DataFrame, _: str) -> float:
    """Its time over SAM's on the finest grid of the rough patch."""
    times = fastest(rows, cells_in_words(elastic.ROUGH_SIZES[-1]), elastic.ROUGH_ERROR)["seconds"]
    return ratio(times.get(CONTACT_MECHANICS), times.get(SAM))


def step_on(rows: DataFrame, cells: tuple[int, int]) -> dict[str, Any]:
    """Tamaas' step on these cells beside SAM's at its error: ratios of times there, and on the same cells."""
    same, theirs = fastest(rows, cells_in_words(cells)).reindex([SAM, TAMAAS]).iloc
    own = rows[rows["model"] == SAM]
    floor = own["floor"].max()
    target = max(theirs["error"], floor)
    curve, time = reached(own, target, floor).get(SAM, ("", None))
    found = {"cells": cells_in_words(cells), "Tamaas [s]": theirs["seconds"], "its error": theirs["error"]}
    found |= {"SAM's curve": curve, "SAM at that error [s]": time, "ratio": ratio(theirs["seconds"], time)}
    on_same = ratio(theirs["seconds"], same["seconds"])
    return found | {"ratio on the same cells": on_same, "SAM's error there": same["error"]}


def _step(rows: DataFrame, _: str, *, place: int) -> float:
    """Tamaas' time over SAM's on the coarser or the finer cells; nan without Tamaas."""
    return step_on(rows, plastic.COMPARED[place])["ratio"] if len(rows) else math.nan


step_on_coarse, step_on_fine = (partial(_step, place=place) for place in (0, -1))


# what is shown


def _table(caption: str, lines: list[dict[str, Any]]) -> SmallTable:
    """A table of lines with the same keys."""
    known = [[None if each != each else each for each in line.values()] for line in lines]  # not nan
    cells = [[each if isinstance(each, str) else number(each, 3) for each in line] for line in known]
    return SmallTable(caption, tuple(lines[0]) if lines else (), cells)


def hertz_times(frame: DataFrame) -> SmallTable:
    """Elastic Hertz: time to an error of the largest pressure, and on the same grid at its error."""
    rows = frame[frame["sweep"] == problems.HERTZ]
    times, lines = reached(rows, elastic.HERTZ_ERROR), []
    at = number(elastic.HERTZ_ERROR, 1)
    for program, (curve, time) in times.items():
        line = {"program": NAMES[program], "curve": curve, f"time to {at} [s]": time}
        line["over SAM's"] = ratio(time, times[SAM][1])
        for cells in map(cells_in_words, elastic.COMPARED):
            least = rows[rows["cells"] == cells]["error"].min()
            there = fastest(rows, cells, AS_GOOD * least)
            for name, column in (("on", "seconds"), ("first solves on", "first")):
                line[f"{name} {cells}"] = ratio(there[column].get(program), there[column].get(SAM))
        lines.append(line)
    words = "of the largest pressure, and ratios to SAM's time, there and on the same grid"
    return _table(f"Hertz: time to an error of {at} {words}", lines)


def rough_times(frame: DataFrame) -> SmallTable:
    """The rough patch: time at an error of the pressure that all reach."""
    rows = frame[frame["sweep"] == problems.ROUGH]
    lines = [
        {"grid": n, "program": NAMES[program], "time [s]": row["seconds"]}
        | {"error, L2 of the pressure": row["error"]}
        | {"over SAM's": ratio(row["seconds"], own["seconds"].get(SAM))}
        for n in map(cells_in_words, elastic.ROUGH_SIZES)
        for own in [fastest(rows, n, elastic.ROUGH_ERROR)]
        for program, row in own.iterrows()
    ]
    at = number(elastic.ROUGH_ERROR, 1)
    words = f"each program at the loosest tolerance of its ladder that reaches an error of {at}"
    return _table(f"Rough: {words}", lines)


def step_times(frame: DataFrame) -> SmallTable:
    """The elastic-plastic step of Tamaas, and of SAM at its error."""
    rows = frame[frame["sweep"] == problems.STEP]
    lines = [step_on(rows, cells) for cells in plastic.COMPARED] if len(rows) else []
    words = "plastic strain below the apex, relative L2 error, each against what it tends to itself"
    return _table(f"Elastic-plastic step: {words}", lines)


def over_time(file: CaseFile, frame: DataFrame, problem: str) -> Plot:
    """`over-time PROBLEM`: error over processor time, a curve a program and setting."""
    rows = frame[(frame["sweep"] == problem) & frame["seconds"].notna()]
    title, of = {
        problems.HERTZ: ("Elastic Hertz", "error of the largest pressure"),
        problems.STEP: ("Elastic-plastic step", "error of the plastic strain below the apex, L2"),
    }[problem]
    drawn, looks, dashes = {}, {}, {program: cycle(("-", "--", ":")) for program in LOOKS}
    for (program, curve), own in rows.groupby(["model", "curve"], sort=False):
        label = re.sub(r"1e-(\d)", r"tolerance $10^{-\1}$", curve)
        drawn[label] = Curve(own["seconds"].to_numpy(), own["error"].to_numpy())
        looks[label] = LOOKS[program] | {"linestyle": next(dashes[program]), "fillstyle": "none"}
    floor = rows["floor"].max() if problem == problems.STEP else 0.0
    marks = (
        {"error whose times are compared": ("y", elastic.HERTZ_ERROR)} if problem == problems.HERTZ else {}
    )
    how = {"logarithmic": "xy", "marks": marks, "floor": floor, "size": (8.4, 4.2)}
    drawing = curves({"": drawn}, "processor time [s]", of, looks=looks, **how)
    text = f"The figure compares the {of} of each program over its processor time; each marker is one grid."
    shade = (
        "The uncertainty of the references is shaded." if floor else "Times are compared at the dotted error."
    )
    return Plot(drawing, problem, f"{title}: error over time", f"{text} {shade}")
