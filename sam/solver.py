# SPDX-License-Identifier: MIT
"""The semi-analytical model: it executes the plan of a scene, with nothing computed that the scene does not
need.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from sam.contact.convolution import Counters
from sam.contact.normal import Contact, fit_of
from sam.elastic.history import solve_elastic
from sam.elastic.problem import ElasticProblem
from sam.elastic.stress import elastic_peak, yields
from sam.grid.cells import CellGrid, Room, Sides, enlarged, enlargement, how_to_enlarge
from sam.planner import parts
from sam.planner.make import check, plan
from sam.planner.plan import Plan
from sam.planner.stages import left_out_of_unyielding
from sam.results.history import (
    CycleEnd,
    LoopRow,
    PassEnd,
    Row,
    cycles_table,
    history_table,
    loops_table,
    of_ends,
)
from sam.results.mesh import cycle_grids, field_mesh, state_grids
from sam.results.quantities import EVEN, quantities, with_extrapolation
from sam.results.snapshots import Snapshot
from sam.results.tables import advice, state_tables
from sam.scene import Result, Scene, Status
from sam.scene.checkpoint import Checkpoint, Keep, check_model
from sam.scene.residuals import Attempt, residual_table
from sam.scene.result import DISSIPATED, FRICTION_SIGN, ROOFED, Progress, of_load
from sam.scene.verdict import UNSTRAINED, Verdict, summary, verdict_columns

if TYPE_CHECKING:
    from sam.plasticity.progress import Progressed

MODEL = "sam"
AT_EDGE = (Status.CONVERGED, Status.CONTACT_AT_GRID_EDGE)  # of a contact that may have touched it on its way


def solve(
    scene: Scene,
    progress: Progress | None = None,
    checkpoint: Keep | None = None,
    start: Checkpoint | None = None,
) -> Result:
    """Solve a scene, at rest or sliding, smooth or rough, elastic or plastic.

    Parameters
    ----------
    scene : Scene
        What is in contact, its loads and its friction.
    progress : callable, optional
        Called as progress(stage, done, total) during the solve.
    checkpoint : callable, optional
        Called with a `Checkpoint` after each committed step of a scene that yields.
    start : Checkpoint, optional
        One of them, of the same scene, to go on from there to the same result.

    Returns
    -------
    Result
        Quantities, tables and fields in SI units; its status says whether it may be used.

    Raises
    ------
    UnsupportedScene
        For a scene that the model cannot solve, see `check`.
    ValueError
        For a `start` of another model.
    """
    check(scene)
    check_model(start, MODEL)
    planned = plan(scene)
    report = progress or (lambda *_: None)
    if planned.coarser is None:
        return _executed(planned, report, checkpoint, start)
    before = _executed(planned.coarser, report, None, None)
    fine = _executed(planned, report, checkpoint, start)
    return with_extrapolation(before, fine, finds_force=planned.schedule.peak.approach is not None)


@dataclass(frozen=True)
class _Outcome:
    """A load history on one grid. yields: whether the plastic loop ran; others as in
    `sam.plasticity.history.Found`.
    """

    rows: Sequence[Row]
    snapshots: list[Snapshot]
    status: Status
    reached: Sides
    yields: bool = False
    certificate: Mapping[str, float] = field(default_factory=dict)
    discretisation: Mapping[str, object] = field(default_factory=dict)
    warnings: tuple[str, ...] = ()
    ends: tuple[CycleEnd, ...] = ()
    volume: float = 0.0
    ending: str = ""
    unfinished: tuple[tuple[int, int, Sequence[Attempt]], ...] = ()
    so_far: Progressed | None = None
    verdicts: tuple[Verdict, ...] = ()
    floor: float = 0.0
    passes: tuple[PassEnd, ...] = ()
    loops: tuple[LoopRow, ...] = ()


class _Clock:
    """Times in s of set-up and solve, with those of the parts of the solve that an interruption ended."""

    def __init__(self, before: Mapping[str, Any] | None):
        self.before = before or {"setup_s": 0.0, "solve_s": 0.0}
        self.began = self.ready = time.perf_counter()

    def times(self) -> dict[str, float]:
        """Both times so far."""
        setup, solving = self.ready - self.began, time.perf_counter() - self.ready
        return {"setup_s": self.before["setup_s"] + setup, "solve_s": self.before["solve_s"] + solving}


KeepRecord = Callable[["Progressed", int, int], None]


def _executed(planned: Plan, report: Progress, checkpoint: Keep | None, start: Checkpoint | None) -> Result:
    """The result of a plan. Where the plastic zone or the contact reaches the edge of a chosen grid, on a
    larger one.
    """
    clock, counters = _Clock(start.cost if start else None), Counters()
    so_far: Progressed | None = parts.progressed(start) if start is not None else None
    now = planned if so_far is None else planned.on(so_far.room)
    clock.ready = time.perf_counter()

    def keep(record: Progressed, done: int, total: int) -> None:
        if checkpoint is not None:
            checkpoint(Checkpoint.of(MODEL, record, done=done, total=total, cost=clock.times()))

    kept = keep if checkpoint is not None else None
    found = _on_grid(now, counters, report, keep=kept, start=so_far)
    while room := enlarged(now.given_sides, now.grid.room, found.reached):
        larger = now.on(room)
        so_far = found.so_far and parts.on_larger_grid(found.so_far, now.grid, larger.grid)
        now = larger
        found = _on_grid(now, counters, report, keep=kept, start=so_far)
    result = _result(now, found, counters, clock.times() | _counts(counters))
    if now.grid.room == Room():
        return result
    extra, words = enlargement(planned.grid, now.grid)
    return replace(
        result, discretisation={**result.discretisation, **extra}, warnings=(*result.warnings, words)
    )


def _on_grid(
    planned: Plan, counters: Counters, report: Progress, *, keep: KeepRecord | None, start: Progressed | None
) -> _Outcome:
    """The load history on the grid of a plan, from its beginning or from a record on."""
    problem, peak = planned.problem(counters), None
    if planned.plasticity is None:
        return _elastic(planned, problem, report)
    if start is None:
        found_peaks = (elastic_peak(problem, load) for load in planned.schedule.peaks)
        peak = next((each for each in found_peaks if yields(each, planned.initial_yield)), None)
        if peak is None:
            return _elastic(planned, problem, report)
    found = parts.yielding()(planned, problem, report, keep=keep, start=start, peak=peak)
    status, contact = found.status, found.snapshots[0].contact
    if status is Status.CONVERGED:
        status = _status(found.rows, contact, planned)
    reached = found.reached
    so_far: Progressed | None = found.so_far
    if status is Status.CONTACT_AT_GRID_EDGE:
        reached, so_far = Sides(beside=True), None
    return _Outcome(
        found.rows,
        found.snapshots,
        status,
        reached,
        True,
        found.certificate,
        found.discretisation,
        (*found.warnings, *_warnings(planned, found.snapshots[0]), *_of_steps(planned)),
        found.ends,
        found.wear.volume if found.wear is not None else 0.0,
        found.ending,
        found.unfinished,
        so_far,
        found.verdicts,
        found.floor,
        found.so_far.measured.passes,
        found.so_far.measured.loops,
    )


def _elastic(planned: Plan, problem: ElasticProblem, report: Progress) -> _Outcome:
    """The load history of a body that stays elastic."""
    tribofilm = planned.tribofilm(planned.grid) if planned.tribofilm is not None else None
    rows, snapshots = solve_elastic(
        problem, planned.schedule, planned.remedies, report, tribofilm=tribofilm, track=planned.track
    )
    status, ending = _status(rows, snapshots[0].contact, planned), ""
    left = next((row for row in rows if row.moved is not None and row.moved.at_edge), None)
    if status in AT_EDGE and left is not None and planned.rough is None and left.moved is not None:
        status = Status.CONTACT_AT_GRID_EDGE
        ending = f"first {left.moved.way:.4g} m after the start of the path"
    reached, warnings = Sides(beside=status is Status.CONTACT_AT_GRID_EDGE), _warnings(planned, snapshots[0])
    return _Outcome(rows, snapshots, status, reached, warnings=warnings, ending=ending)


def _status(rows: Sequence[Row], peak: Contact, planned: Plan) -> Status:
    """All steps count for convergence, the contact at the peak (on the full grid) for the fit of the grid
    too.
    """
    if not all(row.converged for row in rows):
        return Status.NOT_CONVERGED
    return fit_of(peak, planned.rough is not None)


def _warnings(planned: Plan, peak: Snapshot) -> tuple[str, ...]:
    """What a user should know about a rough or coated peak."""
    out = planned.rough.warnings(planned.grid, peak.contact) if planned.rough is not None else ()
    comparison = peak.coated.comparison if peak.coated is not None else None
    return (*out, comparison.warning) if comparison is not None and comparison.warning else out


def _of_steps(planned: Plan) -> tuple[str, ...]:
    """What a user should know about the steps of a counter-body that moves."""
    return () if planned.track is None else planned.track.warnings


def _result(planned: Plan, found: _Outcome, counters: Counters, cost: Mapping[str, Any]) -> Result:
    """The record of what was found on the last grid."""
    grid, status, ending, left_out = planned.grid, found.status, found.ending, planned.left_out
    if planned.plasticity is not None and not found.yields:
        left_out += left_out_of_unyielding(planned)
    if status is Status.NOT_CONVERGED:
        ending = next((row.ending for row in found.rows if row.ending), "")
    peak, rough = found.snapshots[0], planned.rough
    heights, steps = rough.heights if rough is not None else None, planned.schedule
    words = advice(planned.remedies, status, how_to_enlarge(grid, found.reached))
    of_path = _of_path(planned, found)
    discretisation = _discretisation(grid, peak.contact) | (rough.discretisation() if rough else {})
    return Result(
        model=MODEL,
        status=status,
        **of_load(peak.state, _quantities(planned, found) | of_path[1]),
        tables=_tables(planned, found) | of_path[0],
        fields=field_mesh(grid, peak, heights),
        bodies={},
        grids=cycle_grids(grid, found.ends[: steps.cycles - 1], heights)
        | {each.state: state_grids(grid, each, planned.pair.share, heights) for each in found.snapshots},
        left_out=left_out,
        discretisation={
            **discretisation,
            "tangential_kernels": counters.tangential_kernels,
            **found.discretisation,
        },
        certificate={**_certificate(peak.contact), **found.certificate},
        cost=cost,
        message="; ".join(filter(None, (words, ending))),
        warnings=found.warnings,
        verdict=_verdict(planned, found),
    )


def _verdict(planned: Plan, found: _Outcome) -> Mapping[str, Any] | None:
    """On repeated loading; None where nothing is judged, or no period was finished."""
    verdicts = _verdicts(planned, found)
    if planned.judging is None or not verdicts:
        return None
    return summary(verdicts, planned.judging.period, found.floor)


def _verdicts(planned: Plan, found: _Outcome) -> Sequence[Verdict]:
    """After each period; a body that yields nowhere has them without any strain."""
    if planned.judging is None or found.yields:
        return found.verdicts
    return (UNSTRAINED,) * (planned.schedule.cycles // planned.judging.period)


def _quantities(planned: Plan, found: _Outcome) -> dict[str, float | None]:
    """The scalar results."""
    kinks = EVEN
    if found.yields and planned.plasticity is not None:
        kinks = planned.plasticity.strength().kinks
    return quantities(
        planned.grid,
        found.snapshots[0],
        found.snapshots[1] if len(found.snapshots) > 1 else None,
        wear_volume=found.volume,
        kinks=kinks,
        centred=planned.rough is None,
    )


def _of_path(planned: Plan, found: _Outcome) -> tuple[dict[str, Any], dict[str, float | None]]:
    """The tables and quantities that only a counter-body has that moves."""
    if planned.track is None:
        return {}, {}
    return parts.path_results(
        planned.track,
        planned.grid,
        found.snapshots[-1],
        rows=found.rows,
        passes=found.passes,
        ends=found.ends,
        film=None if found.so_far is None else found.so_far.tribofilm,
    )


def _tables(planned: Plan, found: _Outcome) -> dict[str, Any]:
    """The tables of a result."""
    grid, rough, steps = planned.grid, planned.rough, planned.schedule
    tables: dict[str, Any] = {"history": history_table(found.rows)}
    tables |= state_tables(grid, found.snapshots, planned.pair.share)
    if rough is not None:
        tables["surface"] = rough.table(grid, found.snapshots)
    tables["residuals"] = residual_table(
        [*((row.cycle, row.step, row.attempts) for row in found.rows), *found.unfinished]
    )
    if found.loops:
        tables["loops"] = loops_table(grid, found.loops)
    if steps.cycles > 1:
        original = rough.roughness() if rough is not None else None
        tables["cycles"] = cycles_table(found.rows, found.ends, at_peak=steps.at_peak, roughness=original)
        cycles = tables["cycles"]["cycle"]
        if planned.slip.slides and any(target.load.sign < 0 for target in steps.targets):
            tables["cycles"][FRICTION_SIGN] = [int(steps.sign_of(cycle)) for cycle in cycles]
        if planned.dissipates:
            tables["cycles"][DISSIPATED] = of_ends(cycles, found.ends, "dissipated")
        if planned.judging is not None:
            tables["cycles"] |= verdict_columns(cycles, _verdicts(planned, found), planned.judging.period)
        if planned.wear is not None:
            tables["cycles"][ROOFED] = of_ends(cycles, found.ends, "roofed")
    return tables


def _discretisation(grid: CellGrid, peak: Contact) -> dict[str, object]:
    return {
        "cells": [grid.nx, grid.ny],
        "cell_m": [grid.hx, grid.hy],
        "depths": len(grid.depths),
        "largest_depth_m": float(grid.depths[-1]),
        "contact_box_cells": [peak.box.nx, peak.box.ny],
        "contact_cells": int(np.count_nonzero(peak.pressure)),
    }


def _certificate(peak: Contact) -> dict[str, float]:
    """Residuals of the returned fields, see Contact."""
    return {
        "gap_in_contact": peak.gap_residual,
        "penetration": peak.penetration,
        "tension": peak.tension,
        "load_error": peak.load_error,
    }


def _counts(counters: Counters) -> dict[str, int]:
    return {
        "contact_iterations": counters.contact_iterations,
        "plastic_iterations": counters.plastic_iterations,
        "operator_applications": counters.operator_applications,
        "displacement_applications": counters.displacement_applications,
        "ffts": counters.ffts,
        "step_cuts": counters.step_cuts,
    }
