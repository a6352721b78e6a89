# SPDX-License-Identifier: MIT
"""The groove and the strain of a sphere that moves, SAM against the three-dimensional finite elements, both
on two grids and refined; and the processor time of both at the same error.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from sam.scene import Result
from verification.cases.case import (
    FEM_3D,
    SAM,
    Case,
    Context,
    Measured,
    Plot,
    SmallTable,
    with_keys,
)
from verification.cases.moving.moving_sphere_scenes import Setting, radius
from verification.figures.moving import grooves

CELLS, ELEMENTS = (8, 12), (6, 8)  # in the radius; 4 elements are not yet of second order
LADDER = {
    SAM: (4, 6, *CELLS, 16),
    FEM_3D: (4, 5, *ELEMENTS),
}  # whose two finest give the limit for the errors
LENGTH, BOX = 3.0, 12.0  # of the track and of the finite elements, radii; 6 lowers the groove by 0.9 %
WORDS = {SAM: "SAM", FEM_3D: "finite elements"}
WITHIN = 1.0  # of the compared part of the track, half its length in radii


@dataclass(frozen=True)
class Grooves:
    """Results by cells (SAM) and by elements in the radius a in m."""

    by_model: Mapping[str, Mapping[int, Result]]
    radius: float

    @property
    def finest(self) -> tuple[Result, Result]:
        """SAM and finite elements whose grooves are compared."""
        return self.by_model[SAM][CELLS[-1]], self.by_model[FEM_3D][ELEMENTS[-1]]

    def limits(self, value: Callable[[Result], float]) -> tuple[float, float]:
        """What a quantity of SAM and of finite elements tends to, by the sizes that are compared."""
        sam, fem = (
            refined(sizes, [value(self.by_model[model][n]) for n in sizes])
            for model, sizes in ((SAM, CELLS), (FEM_3D, ELEMENTS))
        )
        return sam, fem

    def precision(self, model: str) -> list[Precision]:
        """Cost and errors of each run of a model, the coarsest first, against the limit of the finest two."""
        runs = self.by_model[model]
        ends = LADDER[model][-2:]
        limits = [refined(ends, [value(runs[n]) for n in ends]) for value in QUANTITIES.values()]
        return [
            Precision(
                n,
                run.cost["cpu_s"],
                tuple(
                    abs(value(run) / limit - 1)
                    for value, limit in zip(QUANTITIES.values(), limits, strict=True)
                ),
            )
            for n, run in runs.items()
        ]


@dataclass(frozen=True)
class Precision:
    """A run. size: cells or elements in the radius; errors: relative ones of QUANTITIES."""

    size: int
    cpu_s: float
    errors: tuple[float, ...]

    @property
    def worst(self) -> float:
        """The largest of its errors."""
        return max(self.errors)


def refined(counts: Sequence[int], values: Sequence[float]) -> float:
    """Limit of two values of second order in 1/count."""
    weights = np.square(counts) * [-1.0, 1.0]
    return float(weights @ np.asarray(values) / weights.sum())


def largest_strain(result: Result) -> float:
    """After the pass."""
    return float(result.quantities["peeq_max"])


def groove_at(result: Result, place: float) -> float:
    """Depth of the groove in m at a place along the track."""
    track = result.tables["track"]
    return float(np.interp(place, track["x_m"], track["uz_m"]))


def deepest(result: Result) -> float:
    """Largest depth of the groove in m."""
    return float(result.quantities["groove_deepest_m"])


QUANTITIES: dict[str, Callable[[Result], float]] = {
    "groove in the middle": lambda result: groove_at(result, 0.0),
    "deepest": deepest,
    "largest plastic strain": largest_strain,
}


def precision_tables(found: Grooves) -> Iterator[SmallTable]:
    """Errors and processor time of all runs, and the time of SAM at the errors of finite elements."""
    by_model = {model: found.precision(model) for model in LADDER}
    yield SmallTable(
        "Error against the limit of each model, and processor time",
        ("model", "in a", *(f"error: {name}" for name in QUANTITIES), "processor time [s]"),
        [
            (WORDS[model], str(run.size), *(f"{100 * e:.2f} %" for e in run.errors), f"{run.cpu_s:.1f}")
            for model, runs in by_model.items()
            for run in runs
        ],
    )
    rows = []
    for fem in by_model[FEM_3D]:
        cpu_s = time_at(fem.worst, by_model[SAM])
        numbers = f"{100 * fem.worst:.2f} %", f"{fem.cpu_s:.1f}", f"{cpu_s:.1f}", f"{fem.cpu_s / cpu_s:.1f}"
        rows.append((f"a/{fem.size}", *numbers))
    columns = "elements", "largest error", "finite elements [s]", "SAM [s]", "ratio"
    yield SmallTable("Processor time at the same error", columns, rows)


def time_at(error: float, runs: Sequence[Precision]) -> float:
    """Processor time in s to an error, between the runs that bracket it, log-log; nan where none do."""
    errors, times = np.log([(run.worst, run.cpu_s) for run in runs[::-1]]).T
    return float(np.exp(np.interp(np.log(error), errors, times, left=np.nan, right=np.nan)))


class MovingSpatial(Case):
    """One pass in steps of a quarter of the radius, both models from the same scene."""

    def solve(self, context: Context) -> Grooves:
        scene = context.scene("moving-sphere")
        sam = {
            n: context.solve(SAM, Setting(cells=n, length=LENGTH).of(scene), f"sam-{n}") for n in LADDER[SAM]
        }
        moved = Setting(cells=CELLS[0], length=LENGTH).of(scene)
        fem = {
            n: context.solve(FEM_3D, with_keys(moved, "fem", cells_per_radius=n, box=BOX), f"spatial-{n}")
            for n in LADDER[FEM_3D]
        }
        return Grooves({SAM: sam, FEM_3D: fem}, radius(scene))

    def measure(self, found: Grooves) -> dict[str, Measured | float]:
        places = np.linspace(-WITHIN, WITHIN, 81) * found.radius
        on_sam, on_fem = (np.array([groove_at(each, place) for place in places]) for each in found.finest)
        limits = [Measured(*found.limits(value)) for value in QUANTITIES.values()]
        names = ("groove-refined", "deepest-refined", "strain-refined")
        return {
            "groove": float(np.abs(on_sam - on_fem).max() / on_fem.max()),
            **dict(zip(names, limits, strict=True)),
        }

    def setup(self, found: Grooves) -> list[tuple[str, str]]:
        return [
            ("Track", f"{LENGTH:g} a in steps of a/4, p₀ = 4 yield stresses, no friction"),
            ("SAM", ", ".join(map(str, LADDER[SAM])) + " cells in a"),
            ("Finite elements", ", ".join(map(str, LADDER[FEM_3D])) + f" elements in a, box {BOX:g} a"),
        ]

    def tables(self, found: Grooves) -> Iterator[SmallTable]:
        rows = []
        for model, counts in ((SAM, CELLS), (FEM_3D, ELEMENTS)):
            values = [[value(found.by_model[model][n]) for value in QUANTITIES.values()] for n in counts]
            limit = [refined(counts, column) for column in zip(*values, strict=True)]
            for count, (middle, most, strain) in zip(
                (*map(str, counts), "refined"), [*values, limit], strict=True
            ):
                scaled = (f"{1e3 * each / found.radius:.3f}" for each in (middle, most))
                rows.append((WORDS[model], count, *scaled, f"{100 * strain:.3f} %"))
        header = (
            "model",
            "in a",
            "groove in the middle [a/1000]",
            "deepest [a/1000]",
            "largest plastic strain",
        )
        yield SmallTable("Refinement of both models", header, rows)
        yield from precision_tables(found)

    def notes(self, found: Grooves) -> Iterator[str]:
        yield (
            "Errors are those of cells and elements, in the same steps along the path. The limit of each "
            "model is from its two finest runs, in second order; so are the errors of these two. Times "
            "at the same error, the largest of the three, are between those of the cells that bracket it."
        )

    def figures(self, found: Grooves) -> Iterator[Plot]:
        lines = {}
        names = f"SAM, {CELLS[-1]} cells in a", f"finite elements, {ELEMENTS[-1]} in a"
        for name, result in zip(names, found.finest, strict=True):
            x, depth = (np.asarray(result.tables["track"][column]) for column in ("x_m", "uz_m"))
            near = np.abs(x) <= (LENGTH / 2 + 2.0) * found.radius
            lines[name] = x[near] / found.radius + LENGTH / 2, depth[near] / found.radius
        yield Plot(
            grooves(lines, LENGTH),
            "groove",
            "Groove of one pass in both models",
            "Depth of the unloaded surface over the distance from the start, both models",
            "Unloaded surface along the track; a is the radius of Hertz. Their limits are in the table.",
        )


CASES = (MovingSpatial("moving-spatial"),)
