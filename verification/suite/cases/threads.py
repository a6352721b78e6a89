# SPDX-License-Identifier: MIT
"""The same solve with one and with two threads, each in a process of its own."""

from __future__ import annotations

import os

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
from verification.cost.measured import solve_alone
from verification.runs.models import FEM, FEM_3D, SAM
from verification.suite.cases.case import Case, Context, Outcome, SmallTable, with_loading
from verification.suite.cases.plastic import at_ratio
from verification.suite.cases.resolution import Resolution, resolved_at
from verification.suite.gates import Measured

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
        surface=Surface(kind="self-affine", ra=0.1e-6, cutoff_long=16e-6, cutoff_short=8e-6, hurst=0.8, seed=1),
        loading=Loading(force=0.06, steps=3, unload=True, cycles=cycles),
        friction=Friction(
            law="chemical-film", low=0.1, high=0.4, film_thickness=100e-9, film_young=80e9, film_poisson=0.3,
            film_yield=2e9 / 3, strain_limit=0.0204,
        ),
        wear=Wear(strain_limit=0.002),
        grid=Grid(
            cells=(24, 24), extent=(16e-6, 16e-6), border="relief",
            depths=(0.0, 0.1e-6, 0.2e-6, 0.4e-6, 0.7e-6, 1.2e-6, 2e-6, 3.5e-6, 6e-6),
        ),
        solver=Solver(tolerance=1e-4),
    )  # fmt: skip


def needs() -> str:
    """A second thread on the same core is none to the library that computes with it."""
    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    return "" if cores >= max(COUNTS) else f"{max(COUNTS)} cores are needed, this process may use {cores}"


def run(context: Context) -> Outcome:
    """One load step of each model, and cycles of running-in, twice each."""
    resolution, cycles = LEVEL[context.level]
    base = at_ratio(context.scene("plastic-swift-rigid"), 4.0)
    step = resolved_at(with_loading(base, steps=1, unload=False), resolution)
    sliding = step.model_copy(update={"friction": Friction(coefficient=0.2)})
    solves = {("one step", SAM): step, ("one step, sliding", SAM): sliding, ("one step", FEM): step}
    if context.level == "full":
        solves["one step, sliding", FEM_3D] = resolved_at(sliding, Resolution(4, 4))
    outcome, rows, worst, late = Outcome(), [], 0.0, 0
    for (name, model), scene in solves.items():
        one, two = (solve_alone(scene, model, threads) for threads in COUNTS)
        same, apart = iterations(one) == iterations(two), difference(one, two)
        allowed = 1e-10 if same else scene.solver.tolerance
        worst, late = max(worst, apart / allowed), late + unfinished(one, two)
        rows.append(
            (name, model, f"{iterations(one)}", f"{iterations(two)}", f"{apart:.1e}", f"{allowed:.0e}")
        )
    one, two = (solve_alone(run_in(cycles), SAM, threads) for threads in COUNTS)
    cells, depth = cells_apart(one, two)
    rows.append((f"{cycles} cycles of running-in, depth worn", SAM, f"{iterations(one)}", f"{iterations(two)}", f"{depth:.1e}",
                 f"cells apart: {cells}"))  # fmt: skip
    outcome.values = {
        f"{context.case}.one-step": Measured(worst),
        f"{context.case}.cells": Measured(cells, 0),
        f"{context.case}.worn": Measured(depth),
        f"{context.case}.unfinished": Measured(late + unfinished(one, two), 0),
    }
    outcome.setup = [
        ("One step", "rigid sphere on Swift steel, p₀/σ_y0 = 4"),
        ("Running-in", f"24 × 24 cells, film and wear, {cycles} cycles of 3 steps"),
        ("Threads", " and ".join(map(str, COUNTS)) + ", each solve in a process of its own"),
    ]
    columns = (
        "solve",
        "model",
        "iterations, one thread",
        "two threads",
        "largest relative difference",
        "allowed",
    )
    outcome.tables.append(SmallTable("One and two threads", columns, rows))
    return outcome


def unfinished(one: Result, two: Result) -> int:
    """How many of both stopped above their tolerance, or ended otherwise than the other; a coarse grid is no matter here."""
    late = sum(result.status in (Status.NOT_CONVERGED, Status.STEP_CUT_LIMIT) for result in (one, two))
    return late + (one.status is not two.status)


def iterations(result: Result) -> tuple[int, ...]:
    """Counters of a solve."""
    names = ("contact_iterations", "plastic_iterations", "newton_iterations", "step_cuts")
    return tuple(result.cost[name] for name in names if result.cost.get(name) is not None)


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
    """Cells of the surface of which one is torn or has lost its film and the other not; largest difference of the worn depth."""
    first, second = one.tables["surface"], two.tables["surface"]
    apart = np.zeros(len(first["x_m"]), dtype=bool)
    for name, least in (("worn_m", 0.0), ("friction", 0.25)):  # between the low and the high coefficient
        a, b = (
            np.nan_to_num(np.asarray(table[name], dtype=float), nan=-1.0) > least for table in (first, second)
        )
        apart |= a != b
    return int(apart.sum()), relative(first["worn_m"], second["worn_m"])


CASES = (
    Case(
        "threads",
        "One thread and two",
        "Does the number of threads change a result?",
        run,
        needs=needs,
    ),
)
