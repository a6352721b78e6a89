# SPDX-License-Identifier: MIT
"""An elasto-plastic scene: its load history solved, and what is found of it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from sam.contact.stress import von_mises
from sam.elastic.onset import ElasticPeak
from sam.grid.cells import CellGrid, Window
from sam.grid.enlargement import Sides
from sam.plasticity.extent import first_extent
from sam.plasticity.history import LONGER, onward
from sam.plasticity.measure import problem_now, snapshot, with_last_period, with_outside
from sam.plasticity.model import Model
from sam.plasticity.periods import floor
from sam.plasticity.progress import Peak, Progressed
from sam.plasticity.state import Extent
from sam.plasticity.step import ITERATIONS, LONG_ITERATIONS
from sam.results.history import CycleEnd, Row
from sam.results.snapshots import Snapshot
from sam.scene import Status
from sam.scene.result import LAST, PEAK, UNLOADED, Attempt, Progress
from sam.scene.verdict import Verdict
from sam.schedule import Target
from sam.surface_state import WearState


@dataclass(frozen=True)
class Found:
    """The solved history. status: CONVERGED, or why not; ending: of the last iteration, in words.

    verdicts: after each period of a repeated load, with the floor of strain, of a scene that is judged;
    unfinished: the step that was not reached, see `residual_table`; reached: the sides of the grid at which
    the plastic zone ended the history; so_far: its record.
    """

    rows: Sequence[Row]
    snapshots: list[Snapshot]
    certificate: dict[str, float]
    discretisation: dict[str, object]
    status: Status
    reached: Sides
    so_far: Progressed
    warnings: tuple[str, ...] = ()
    ends: tuple[CycleEnd, ...] = ()
    wear: WearState | None = None
    ending: str = ""
    unfinished: tuple[tuple[int, int, Sequence[Attempt]], ...] = ()
    verdicts: tuple[Verdict, ...] = ()
    floor: float = 0.0


def solve_plastic(
    model: Model,
    now: Progressed,
    report: Progress,
    *,
    keep: Callable[[Progressed, int, int], None] | None = None,
    stop: str | None = None,
) -> Found:
    """History and states of a body that yields, from a record on: see `begun` and `continued`.

    keep: called as keep(progressed, done, total) after each committed step, or part of one, with the number
    of load steps; stop: of the paper's loops, None without them.
    """
    schedule = model.schedule
    total = len(schedule.targets)
    while not now.ended:
        before, now = now, onward(model, now)
        done = len(now.measured.rows)
        if keep is not None and now.last is not before.last:
            keep(now, done, done + len(now.targets))
        if before.targets[0].rises and done > len(before.measured.rows):
            report("load steps", done, total)
    return found_of(model, now, stop)


def begun(model: Model, targets: Sequence[Target], extent: Extent) -> Progressed:
    """The record before the first step, on a first box."""
    film = None
    if model.tribofilm is not None:
        film = model.tribofilm.fresh(model.nothing_strained())
    wear = model.wear.fresh() if model.wear is not None else None
    state = model.problem(extent, film, wear).virgin()
    return Progressed(state, extent, model.grid.room, tuple(targets), replace(model.counters), film, wear)


def continued(model: Model, start: Progressed) -> Progressed:
    """The record itself, after the model and its counters are as they were when it was made."""
    problem_now(model, start)
    vars(model.counters).update(vars(start.counters))
    return start


def first_box(model: Model, peak: ElasticPeak) -> Extent:
    """The first box of a history."""
    return first_extent(
        model.grid,
        peak,
        model.body.initial_yield(model.grid.depths),
        anywhere=model.elastic.looked.anywhere,
        both_ways=model.schedule.alternates,
        path=model.schedule.path,
    )


def on_larger_grid(so_far: Progressed, grid: CellGrid, larger: CellGrid) -> Progressed | None:
    """The same record in the middle of a grid with further cells of the same size, or above further layers;
    None if it has fields of the whole grid, or layers that the other has not.
    """
    wider, faces = grid.shape != larger.shape, grid.layer_faces
    of_whole_grid = wider and (so_far.wear is not None or so_far.tribofilm is not None)
    same_layers = np.array_equal(faces, larger.layer_faces[: len(faces)])
    if so_far.measured.snapshots or of_whole_grid or not same_layers:
        return None
    i, j = (larger.nx - grid.nx) // 2, (larger.ny - grid.ny) // 2

    def there(extent: Extent) -> Extent:
        """A box of the grid on the larger one."""
        own = extent.window
        return replace(extent, window=Window(own.i0 + i, own.j0 + j, own.nx, own.ny))

    start = so_far.cycle_start
    measured = so_far.measured
    if wider:
        ends = tuple(replace(end, moved=None, worn=None) for end in measured.ends)
        measured = replace(measured, ends=ends)
    moved = replace(
        so_far,
        extent=there(so_far.extent),
        outside=None,
        room=larger.room,
        measured=measured,
        cycle_start=start and replace(start, extent=there(start.extent)),
        periods=so_far.periods.at(there),
    )
    return replace(moved, status=Status.CONVERGED, reached=Sides(), ending="")


def found_of(model: Model, now: Progressed, stop: str | None) -> Found:
    """What is found of a history; of one that broke off the last state that it reached, as LAST.

    stop: of the paper's loops, None without them.
    """
    snapshots, peak = dict(now.measured.snapshots), now.measured.peak
    if peak is None:
        last = now.last
        material = now.state.material
        if last is None or last.increment.strain.shape != material.strain.shape:  # the box has grown since
            last = problem_now(model, now).step(now.state, now.state.load)
        now = with_outside(model, now, stress=True)
        snapshots[LAST] = snapshot(model, now, LAST, last)
        peak = Peak(last.yield_excess, last.flow_residual)
    found = (snapshots[name] for name in (PEAK, LAST, UNLOADED) if name in snapshots)
    states = [with_last_period(model, now, each) for each in found]
    certificate = {
        "yield_excess": peak.yield_excess,
        "flow_residual": peak.flow_residual,
        "yield_excess_outside_box": _excess_outside(model, now.extent, states[0]),
        "plastic_tolerance": model.tolerance,
    }
    discretisation = {
        "plastic_box_cells": [now.extent.window.nx, now.extent.window.ny],
        "plastic_box_layers": now.extent.layers,
        "layers": len(model.grid.depths),
        "operator_bytes": problem_now(model, now).operator.memory,
    }
    return Found(
        now.measured.rows,
        states,
        certificate,
        discretisation,
        now.status,
        now.reached,
        replace(now, counters=replace(model.counters)),
        warnings=(*_lengthened(now.measured.rows), *(() if stop is None else (_warning(stop, peak),))),
        ends=now.measured.ends,
        wear=now.wear,
        ending=now.ending,
        unfinished=tuple((target.cycle, target.step, now.parts.attempts) for target in now.targets[:1]),
        verdicts=now.periods.verdicts,
        floor=float(floor(model, now.extent).min()) if model.judging is not None else 0.0,
    )


def _warning(stop: str, peak: Peak) -> str:
    """The paper's loops stop by their own criterion: what they leave is said."""
    return (
        f'solver.method = "paper", stop = "{stop}": the last step leaves a yield excess of '
        f"{peak.yield_excess:.1e} and a flow-rule residual of {peak.flow_residual:.1e} of the yield stress"
    )


def _lengthened(rows: Sequence[Row]) -> tuple[str, ...]:
    """That steps needed the longer iteration, and how many."""
    steps = [row for row in rows if LONGER in row.note]
    if not steps:
        return ()
    first = f"cycle {steps[0].cycle}, step {steps[0].step}"
    words = f"{LONG_ITERATIONS} iterations in place of {ITERATIONS}"
    return (
        f"a load step did not converge however often it was halved; {len(steps)} of {len(rows)} load steps, "
        f"from {first} on, were made by a {LONGER}, of up to {words}",
    )


def _excess_outside(model: Model, extent: Extent, state: Snapshot) -> float:
    """max((mises - sigma_y)/sigma_y, 0) in the plane y = 0 outside the box, where no plastic strain was
    allowed.
    """
    window, limit = extent.window, model.body.initial_yield(model.grid.depths)
    excess = von_mises(state.in_plane) / limit[:, None] - 1
    excess[: extent.layers, window.i0 : window.i0 + window.nx] = 0.0
    return float(max(excess.max(), 0.0))
