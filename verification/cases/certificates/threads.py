# SPDX-License-Identifier: MIT
"""The same solve with one and with two threads, each in a process of its own."""

from __future__ import annotations

import math
import os
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from sam.scene import (
    Body,
    CounterBody,
    Friction,
    Grid,
    Loading,
    Plasticity,
    Result,
    Scene,
    Solver,
    Status,
    Surface,
    Wear,
)
from verification.cases.case import FEM, FEM_3D, SAM, Case, Context, Measured, SmallTable, with_loading
from verification.cases.recipes import Resolution, at_ratio, resolved_at
from verification.cost.measured import solve_alone

COUNTS = (1, 2)
LEVEL = {"quick": (Resolution(8, 8), 3), "full": (Resolution(14, 20), 25)}  # and cycles of running-in
TABLES = ("axis", "line", "plane")
# of the largest pressure, or of the approach: what is less everywhere is zero but for rounding
NOTHING = 1e-9


def run_in(cycles: int) -> Scene:
    """A small rough patch with a film that fails in some cells, and wear."""
    return Scene(
        title="Small patch",
        body=Body(young=210e9, poisson=0.3, plasticity=Plasticity(law="swift", B=1780e6, C=4.0, n=0.095)),
        counterbody=CounterBody(shape="flat"),
        surface=Surface(
            kind="self-affine", ra=0.1e-6, cutoff_long=16e-6, cutoff_short=8e-6, hurst=0.8, seed=1
        ),
        loading=Loading(force=0.06, steps=3, unload=True, cycles=cycles),
        friction=Friction(
            law="chemical-film",
            low=0.1,
            high=0.4,
            film_thickness=100e-9,
            film_young=80e9,
            film_poisson=0.3,
            film_yield=2e9 / 3,
            strain_limit=0.0204,
        ),
        wear=Wear(strain_limit=0.002),
        grid=Grid(
            cells=(24, 24),
            extent=(16e-6, 16e-6),
            border="relief",
            depths=(0.0, 0.1e-6, 0.2e-6, 0.4e-6, 0.7e-6, 1.2e-6, 2e-6, 3.5e-6, 6e-6),
        ),
        solver=Solver(tolerance=1e-4),
    )


def needs() -> str:
    """A second thread on the same core is none to the library that computes with it."""
    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    return "" if cores >= max(COUNTS) else f"{max(COUNTS)} cores are needed, this process may use {cores}"


@dataclass(frozen=True)
class Both:
    """The same solve with one and with two threads. allowed: their largest relative difference."""

    words: str
    model: str
    one: Result
    two: Result
    allowed: float = math.nan

    @property
    def iterations(self) -> tuple[str, str]:
        """Counters with one and with two threads."""
        return f"{iterations(self.one)}", f"{iterations(self.two)}"

    @property
    def late(self) -> int:
        """See `unfinished`."""
        return unfinished(self.one, self.two)

    @property
    def apart(self) -> float:
        """See `difference`."""
        return difference(self.one, self.two)


@dataclass(frozen=True)
class Twice:
    """One load step of each model, and `cycles` of running-in."""

    steps: list[Both]
    running_in: Both
    cycles: int


class Threads(Case):
    """One load step of each model, and cycles of running-in, twice each."""

    def solve(self, context: Context) -> Twice:
        resolution, cycles = LEVEL[context.level]
        base = at_ratio(context.scene("plastic-swift-rigid"), 4.0)
        step = resolved_at(with_loading(base, steps=1, unload=False), resolution)
        sliding = step.model_copy(update={"friction": Friction(coefficient=0.2)})
        solves = {("one step", SAM): step, ("one step, sliding", SAM): sliding, ("one step", FEM): step}
        if context.level == "full":
            solves["one step, sliding", FEM_3D] = resolved_at(sliding, Resolution(4, 4))
        steps = []
        for (words, model), scene in solves.items():
            one, two = (solve_alone(scene, model, threads) for threads in COUNTS)
            allowed = 1e-10 if iterations(one) == iterations(two) else scene.solver.tolerance
            steps.append(Both(words, model, one, two, allowed))
        worn = (solve_alone(run_in(cycles), SAM, threads) for threads in COUNTS)
        return Twice(steps, Both(f"{cycles} cycles of running-in, depth worn", SAM, *worn), cycles)

    def measure(self, found: Twice) -> dict[str, Measured | float]:
        cells, depth = cells_apart(found.running_in.one, found.running_in.two)
        return {
            "one-step": max(each.apart / each.allowed for each in found.steps),
            "cells": Measured(cells, 0),
            "worn": depth,
            "unfinished": Measured(sum(each.late for each in (*found.steps, found.running_in)), 0),
        }

    def setup(self, found: Twice) -> list[tuple[str, str]]:
        return [
            ("One step", "rigid sphere on Swift steel, p₀/σ_y0 = 4"),
            ("Running-in", f"24 × 24 cells, film and wear, {found.cycles} cycles of 3 steps"),
            ("Threads", " and ".join(map(str, COUNTS)) + ", each solve in a process of its own"),
        ]

    def tables(self, found: Twice) -> Iterator[SmallTable]:
        worn = found.running_in
        cells, depth = cells_apart(worn.one, worn.two)
        rows = [
            (each.words, each.model, *each.iterations, f"{each.apart:.1e}", f"{each.allowed:.0e}")
            for each in found.steps
        ]
        rows.append((worn.words, worn.model, *worn.iterations, f"{depth:.1e}", f"cells apart: {cells}"))
        counted = ("iterations, one thread", "two threads")
        yield SmallTable(
            "One and two threads",
            ("solve", "model", *counted, "largest relative difference", "allowed"),
            rows,
        )


def unfinished(one: Result, two: Result) -> int:
    """How many of both stopped above their tolerance, or ended otherwise than the other; a coarse grid is no
    matter here.
    """
    late = sum(result.status in (Status.NOT_CONVERGED, Status.STEP_CUT_LIMIT) for result in (one, two))
    return late + (one.status is not two.status)


def iterations(result: Result) -> tuple[int, ...]:
    """Counters of a solve."""
    return tuple(
        result.cost[name]
        for name in ("contact_iterations", "plastic_iterations", "newton_iterations", "step_cuts")
        if result.cost.get(name) is not None
    )


def difference(one: Result, two: Result) -> float:
    """Largest difference of quantities, tables and fields, over the largest value of each."""
    found, other = (each.last_fitting or each.quantities for each in (one, two))
    parts = [(one.tables[name], two.tables[name]) for name in TABLES] + [(found, other)]
    parts += [(one.fields.point_data, two.fields.point_data), (one.fields.cell_data, two.fields.cell_data)]
    sizes = {"Pa": found["p_max_Pa"], "m": found["approach_m"]}
    pairs = [(key, a[key], b[key]) for a, b in parts for key in a if key != "state" and a[key] is not None]
    return max(relative(a, b, NOTHING * sizes.get(key.rpartition("_")[2], 0.0)) for key, a, b in pairs)


def relative(a: np.ndarray | float, b: np.ndarray | float, least: float = 0.0) -> float:
    """Largest |a - b| over the largest |a|, not numbers left out where both are; infinite where one alone is.

    least: where nothing is larger, both are rounding about zero.
    """
    a, b = np.asarray(a, dtype=float), np.asarray(b, dtype=float)
    if not np.array_equal(np.isnan(a), np.isnan(b)):
        return np.inf
    size, apart = (np.abs(np.nan_to_num(values)).max(initial=0.0) for values in (a, a - b))
    return 0.0 if max(size, apart) <= least else float(apart / (size or apart))


def cells_apart(one: Result, two: Result) -> tuple[int, float]:
    """Cells of the surface of which one is worn or has lost its film and the other not; largest difference
    of the worn depth.
    """
    first, second = one.tables["surface"], two.tables["surface"]
    apart = np.zeros(len(first["x_m"]), dtype=bool)
    for name, least in (("worn_m", 0.0), ("friction", 0.25)):  # between the low and the high coefficient
        a, b = (
            np.nan_to_num(np.asarray(table[name], dtype=float), nan=-1.0) > least for table in (first, second)
        )
        apart |= a != b
    return int(apart.sum()), relative(first["worn_m"], second["worn_m"])


CASES = (Threads("threads", needs=needs),)
