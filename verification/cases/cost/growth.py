# SPDX-License-Identifier: MIT
"""How time and memory grow with cells, cycles and unknowns, and how well `samfem plan` predicts both."""

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from verification.cases.case import FEM_3D, Context, DataFrame, Plot
from verification.cost import growth
from verification.figures.lines import Curve, curves
from verification.reference.convergence import fit_power
from verification.rows import CaseFile

ERROR = 1e-4  # of the stress/mu of a unit strain by sweeps
BOXES = {
    "dense": ((16, 16, 8, 0.0), (32, 32, 16, 0.0), (64, 64, 32, 0.0)),
    "plane": tuple((n, n, 32, ERROR) for n in (64, 128, 256, 512)),
    "depth": tuple((128, 128, layers, ERROR) for layers in (16, 24, 32, 48, 64)),
}
"""What grows -> boxes of the residual-stress operator by itself, as it is called."""
OPERATOR = "residual-stress operator"
EXPONENTS = {
    "elastic contact, whole solve, in cells": ("contact", "cpu-s", 257**2),
    "elastic stresses at all depths, in cells": ("stresses", "further-s", 0),
    f"{OPERATOR}, dense, an application, in cells of the box": ("operator-dense", "cpu-s", 0),
    f"{OPERATOR}, swept, more cells in the plane, in cells of the box": ("operator-plane", "cpu-s", 0),
    f"{OPERATOR}, swept, more layers, in layers of 128 × 128 cells": ("operator-depth", "cpu-s", 0),
    f"{OPERATOR}, swept, set-up, in cells of the box": ("operator-plane", "set-up-s", 0),
    "running-in, whole solve, in cycles": ("cycles", "cpu-s", 2),
    "axisymmetric finite elements, elastic, in unknowns": ("axisymmetric", "cpu-s", 0),
    "finite elements in 3D, elastic, in unknowns": ("spatial", "cpu-s", 0),
}
"""What -> ladder, column and first size of its exponent. Smaller contacts are fixed costs, some milliseconds
of setting up, arrays in the caches; the first cycle has the set-up in it."""


def frame(context: Context) -> Iterator[dict[str, Any]]:
    """A row for each solve of the ladders and for each box."""
    rungs = {name: make() for name, make in growth.FAMILIES.items()}
    taken = iter(growth.climb([rung for each in rungs.values() for rung in each], context.progress))
    found = {name: [next(taken) for _ in each] for name, each in rungs.items()}
    yield from rows_of(found, {name: [growth.applied(*box) for box in each] for name, each in BOXES.items()})


def rows_of(found: Mapping[str, list[dict]], boxes: Mapping[str, list[dict]]) -> Iterator[dict[str, Any]]:
    """The rows of climbed ladders, and of boxes. further-s: of the stresses, beyond the contact alone."""
    contact = {row["size"]: row["cpu-s"] for row in found["contact"]}
    for name, taken in found.items():
        for row in taken:
            own = {"time-factor": factor(row["cpu-s"], row["predicted-s"])}
            own["memory-error"] = factor(row["memory"], row["predicted-memory"]) - 1.0
            own["unconverged"] = float(not row["converged"] and row["model"] != FEM_3D)
            own |= {"further-s": row["cpu-s"] - contact[row["size"]]} if name == "stresses" else {}
            yield {"sweep": name} | row | own
    for name, applied in boxes.items():
        size = "depth" if name == "depth" else "cells"
        yield from ({"sweep": f"operator-{name}"} | row | {"size": float(row[size])} for row in applied)


def factor(measured: float, expected: float) -> float:
    """Between both, one way or the other."""
    with np.errstate(divide="ignore"):
        return float(np.exp(np.abs(np.log(np.float64(expected) / measured))))


def exponent(rows: DataFrame, column: str) -> float:
    """The exponent of a column in the size."""
    return fit_power(rows["size"], rows[column]).exponent


def times(file: CaseFile, frame: DataFrame) -> Plot:
    """Over the size, a panel for each exponent."""
    panels, sizes = {}, {}
    for what, (ladder, column, first) in EXPONENTS.items():
        own, (title, _, sizes[title]) = frame[frame["sweep"] == ladder], what.rpartition(", in ")
        power = fit_power(own["size"], own[column], first)
        values, ends = own[column].to_numpy(dtype=float), (power.first, power.last)
        panels[title] = {f"exponent {power}": Curve(own["size"].to_numpy(), values, power, span=ends)}
    how = {"logarithmic": "xy", "legend": "each", "size": (3.2, 2.7)}
    drawing = curves(panels, sizes, dict.fromkeys(panels, "processor time [s]"), **how)
    caption = (
        "The figure shows the processor time over the size of the problem; the lines are least-squares fits "
        "through the points that they cover, with their exponents and standard errors."
    )
    return Plot(drawing, "time", "Time over size", caption)
