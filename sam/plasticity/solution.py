# SPDX-License-Identifier: MIT
"""An elasto-plastic scene: its load history solved, and what is found of it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from sam.contact.convolution import Counters
from sam.contact.stress import von_mises
from sam.grid.cells import CellGrid, Window
from sam.grid.enlargement import Sides
from sam.loading import path_of, targets_of
from sam.plasticity.extent import ElasticPeak, elastic_peak, first_extent, initial_yield
from sam.plasticity.history import History, Peak, Progressed
from sam.plasticity.run import Run
from sam.record import CycleEnd, Row, Snapshot
from sam.scene import Scene, Status
from sam.scene.residuals import Attempt
from sam.scene.result import LAST, PEAK, UNLOADED, Progress

if TYPE_CHECKING:
    from sam.wear.ledger import Ledger


@dataclass(frozen=True)
class Found:
    """The solved history. status: CONVERGED, or why not; ending: of the last iteration, in words.

    unfinished: the step that was not reached, see
    `residual_table`; reached: the sides of the grid at which the plastic zone ended the history; so_far: its record.
    """

    rows: list[Row]
    snapshots: list[Snapshot]
    certificate: dict[str, float]
    discretisation: dict[str, object]
    status: Status
    reached: Sides
    warnings: tuple[str, ...] = ()
    ends: tuple[CycleEnd, ...] = ()
    ledger: Ledger | None = None
    ending: str = ""
    unfinished: tuple[tuple[int, int, Sequence[Attempt]], ...] = ()
    so_far: Progressed | None = None


def solve_plastic(
    scene: Scene,
    grid: CellGrid,
    counters: Counters,
    report: Progress,
    keep: Callable[[Progressed, int, int], None] | None = None,
    start: Progressed | None = None,
    peak: ElasticPeak | None = None,
) -> Found:
    """History and states of a scene that yields.

    keep: called as keep(progressed, done, total) after each committed step, or part of one, with the number of load steps;
    start: such a record, to go on from there; peak: of the body if it stayed elastic, else found here.
    """

    def committed(history: History) -> None:
        if keep is not None:
            done = len(history.rows)
            keep(history.progressed(), done, done + len(history.targets))

    if start is None:
        run = Run(
            scene, grid, counters, first_extent(scene, grid, peak or elastic_peak(scene, grid, counters))
        )
        history = History(run, committed, targets_of(scene))
    else:
        run = Run.continued(scene, grid, counters, start)
        history = History.continued(run, committed, start)
    loading, moves = scene.loading, len(path_of(scene)) - 1
    total = loading.cycles * (loading.steps + moves + loading.unload)
    while history.targets:
        rises = history.targets[0].rises
        if not history.advance():
            break
        if rises:
            report("load steps", len(history.rows), total)
    return _found(run, history)


def _found(run: Run, history: History) -> Found:
    """The record of a run; of one that broke off the last state that it reached, as LAST."""
    snapshots, peak = dict(history.snapshots), history.peak
    if peak is None:
        last = run.last
        if last is None or last.increment.shape != run.state.strain.shape:  # the box has grown since
            last = run.problem.step(run.state, run.state.load)
        snapshots[LAST] = history.recorder.snapshot(LAST, last)
        peak = Peak(last.yield_excess, last.flow_residual)
    states = [snapshots[name] for name in (PEAK, LAST, UNLOADED) if name in snapshots]
    extent, operator = run.extent, run.problem.operator
    certificate = {
        "yield_excess": peak.yield_excess,
        "flow_residual": peak.flow_residual,
        "yield_excess_outside_box": _excess_outside(run, states[0]),
        "plastic_tolerance": run.scene.solver.tolerance,
    }
    discretisation = {
        "plastic_box_cells": [extent.window.nx, extent.window.ny],
        "plastic_box_layers": extent.layers,
        "layers": len(run.grid.depths),
        "operator_bytes": operator.memory,
    }
    unfinished = tuple((target.cycle, target.step, history.parts.attempts) for target in history.targets[:1])
    return Found(
        history.rows, states, certificate, discretisation, run.status, run.reached, _warnings(run, peak),
        tuple(history.ends), run.ledger, run.ending, unfinished, history.progressed(),
    )  # fmt: skip


def on_larger_grid(so_far: Progressed, grid: CellGrid, larger: CellGrid) -> Progressed | None:
    """The same record in the middle of a grid with further cells of the same size; None if it has fields of the whole grid."""
    if so_far.snapshots or so_far.ledger is not None or so_far.film is not None:
        return None
    window = so_far.extent.window
    moved = Window(
        window.i0 + (larger.nx - grid.nx) // 2, window.j0 + (larger.ny - grid.ny) // 2, window.nx, window.ny
    )  # fmt: skip
    return replace(so_far, extent=replace(so_far.extent, window=moved), outside={}, room=larger.room)


def _warnings(run: Run, peak: Peak) -> tuple[str, ...]:
    """The paper's loops stop by their own criterion: what they leave is said."""
    solver = run.scene.solver
    if solver.method != "paper":
        return ()
    return (
        f'solver.method = "paper", stop = "{solver.stop}": the last step leaves a yield excess of {peak.yield_excess:.1e} and '
        f"a flow-rule residual of {peak.flow_residual:.1e} of the yield stress",
    )


def _excess_outside(run: Run, snapshot: Snapshot) -> float:
    """max((mises - sigma_y)/sigma_y, 0) in the plane y = 0 outside the box, where no plastic strain was allowed."""
    window, limit = run.extent.window, initial_yield(run.scene, run.grid)
    excess = von_mises(snapshot.in_plane) / limit[:, None] - 1
    excess[: run.extent.layers, window.i0 : window.i0 + window.nx] = 0.0
    return float(max(excess.max(), 0.0))
