# SPDX-License-Identifier: MIT
"""The semi-analytical model: it executes the plan of a scene, with nothing computed that the scene does not
need.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from sam.contact.convolution import Counters
from sam.contact.normal import Contact, fit_of
from sam.elastic.problem import ElasticProblem, Plan, elastic_peak, solve_elastic, yields
from sam.grid.cells import Room, Sides, enlarged, enlargement, how_to_enlarge
from sam.moving import path_quantities, path_tables
from sam.planner.bodies import Bodies
from sam.planner.make import check_bodies, left_out_of_unyielding, plan_of
from sam.plasticity.history import on_larger_grid, solve_plastic
from sam.plasticity.model import Progressed
from sam.results.history import History, Row, Snapshot, cycles_table, history_table, loops_table, of_ends
from sam.results.tables import (
    EVEN,
    advice,
    cycle_grids,
    field_mesh,
    quantities,
    rough_discretisation,
    rough_quantities,
    rough_warnings,
    state_grids,
    state_tables,
    surface_table,
    with_extrapolation,
)
from sam.scene import Result, Scene, Status
from sam.scene.checkpoint import Checkpoint, Keep, check_model
from sam.scene.result import (
    DISSIPATED,
    FRICTION_SIGN,
    LEFT,
    ROOFED,
    WEAR_PARTS,
    Progress,
    of_load,
    residual_table,
)
from sam.scene.verdict import UNSTRAINED, Verdict, summary, verdict_columns

MODEL = "sam"
COUNTED = (
    "contact_iterations plastic_iterations operator_applications displacement_applications ffts step_cuts"
)
AT_EDGE = (Status.CONVERGED, Status.CONTACT_AT_GRID_EDGE)  # of a contact that may have touched it on its way


def solve(
    scene: Scene,
    progress: Progress | None = None,
    checkpoint: Keep | None = None,
    start: Checkpoint | None = None,
    *,
    plan: Plan | None = None,
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
    plan : Plan, optional
        What `sam.plan` made of the scene, once `sam.check` allowed it; without it both are done here.

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
    if plan is None:
        bodies = Bodies(scene)
        check_bodies(bodies)
        plan = plan_of(bodies)
    check_model(start, MODEL)
    report = progress or (lambda *_: None)
    if plan.coarser is None:
        return _executed(plan, report, checkpoint, start)
    before = _executed(plan.coarser, report, None, None)
    fine = _executed(plan, report, checkpoint, start)
    return with_extrapolation(before, fine, finds_force=plan.schedule.peak.approach is not None)


KeepRecord = Callable[[Progressed, int, int], None]


def _executed(plan: Plan, report: Progress, checkpoint: Keep | None, start: Checkpoint | None) -> Result:
    """The result of a plan, on a larger grid where plastic zone or contact reach the edge of a chosen one."""
    began, counters, first = time.perf_counter(), Counters(), plan.grid
    earlier = start.cost if start else {"setup_s": 0.0, "solve_s": 0.0}  # before an interruption
    record = start.record(Progressed) if start is not None else None
    plan = plan if record is None else plan.on(record.room)
    ready = time.perf_counter()

    def times() -> dict[str, float]:
        solving = time.perf_counter() - ready
        return {"setup_s": earlier["setup_s"] + (ready - began), "solve_s": earlier["solve_s"] + solving}

    def keep(record: Progressed, done: int, total: int) -> None:
        if checkpoint is not None:
            checkpoint(Checkpoint.of(MODEL, record, done=done, total=total, cost=times()))

    keeper = keep if checkpoint is not None else None
    history, record = _on_grid(plan, counters, report, keep=keeper, start=record)
    while room := enlarged(plan.given_sides, plan.grid.room, history.reached):
        larger = plan.on(room)
        anew = record is None or history.status is Status.CONTACT_AT_GRID_EDGE
        record = None if anew or record is None else on_larger_grid(record, plan.grid, larger.grid)
        plan = larger
        history, record = _on_grid(plan, counters, report, keep=keeper, start=record)
    result = _result(
        plan,
        history,
        record,
        counters=counters,
        cost=times() | {name: getattr(counters, name) for name in COUNTED.split()},
    )
    if plan.grid.room == Room():
        return result
    extra, words = enlargement(first, plan.grid)
    return replace(
        result, discretisation={**result.discretisation, **extra}, warnings=(*result.warnings, words)
    )


def _on_grid(
    plan: Plan, counters: Counters, report: Progress, *, keep: KeepRecord | None, start: Progressed | None
) -> tuple[History, Progressed | None]:
    """The history on the grid of a plan, from its beginning or a record on, and the last plastic record."""
    problem, peak = plan.problem(counters), None
    if plan.plasticity is None:
        return _elastic(problem, report), None
    if start is None:
        peaks = (elastic_peak(problem, load) for load in plan.schedule.peaks)
        peak = next((peak for peak in peaks if yields(peak, plan.initial_yield)), None)
        if peak is None:
            return _elastic(problem, report), None
    history, record = solve_plastic(problem, report, keep=keep, start=start, peak=peak)
    state = next(iter(history.snapshots.values()))
    status, reached = history.status, history.reached
    if status is Status.CONVERGED:
        status = _status(history.rows, state.contact, plan)
    if status is Status.CONTACT_AT_GRID_EDGE:
        reached = Sides(beside=True)
    of_steps = () if plan.track is None else plan.track.warnings
    warnings = (*history.warnings, *_warnings(plan, state), *of_steps)
    return replace(history, status=status, reached=reached, warnings=warnings), record


def _elastic(problem: ElasticProblem, report: Progress) -> History:
    """The load history of a body that stays elastic."""
    plan, history = problem.plan, solve_elastic(problem, report)
    peak = next(iter(history.snapshots.values()))
    status, ending = _status(history.rows, peak.contact, plan), ""
    left = next((row for row in history.rows if row.moved is not None and row.moved.at_edge), None)
    if status in AT_EDGE and left is not None and plan.rough is None and left.moved is not None:
        status = Status.CONTACT_AT_GRID_EDGE
        ending = f"first {left.moved.way:.4g} m after the start of the path"
    reached = Sides(beside=status is Status.CONTACT_AT_GRID_EDGE)
    return replace(history, status=status, reached=reached, ending=ending, warnings=_warnings(plan, peak))


def _status(rows: Sequence[Row], peak: Contact, plan: Plan) -> Status:
    """All steps count for convergence, the contact at the peak (on the full grid) for the fit too."""
    if not all(row.converged for row in rows):
        return Status.NOT_CONVERGED
    return fit_of(peak, plan.rough is not None, plan.grid.line)


def _warnings(plan: Plan, peak: Snapshot) -> tuple[str, ...]:
    """What a user should know about a rough or coated peak."""
    rough = plan.rough
    out = () if rough is None else rough_warnings(rough, plan.remedies, plan.grid, peak.contact)
    comparison = peak.coated.comparison if peak.coated is not None else None
    return (*out, comparison.warning) if comparison is not None and comparison.warning else out


def _result(
    plan: Plan, history: History, record: Progressed | None, *, counters: Counters, cost: Mapping[str, Any]
) -> Result:
    """The result of a history on the last grid; record: the last one of a body that yields."""
    grid, status, ending, left_out = plan.grid, history.status, history.ending, plan.left_out
    states, judging, rough, steps = list(history.snapshots.values()), plan.judging, plan.rough, plan.schedule
    if plan.plasticity is not None and record is None:
        left_out += left_out_of_unyielding(plan)
    if status is Status.NOT_CONVERGED:
        ending = next((row.ending for row in history.rows if row.ending), "")
    peak, heights = states[0], rough.of_body if rough is not None else None
    verdicts: Sequence[Verdict] = ()
    if judging is not None:  # a body that yields nowhere has them without any strain
        verdicts = (UNSTRAINED,) * (steps.cycles // judging.period)
        verdicts = verdicts if record is None else record.periods.verdicts
    values = quantities(
        grid,
        peak,
        states[1] if len(states) > 1 else None,
        wear_volume=record.wear.volume if record is not None and record.wear is not None else 0.0,
        kinks=EVEN if plan.plasticity is None or record is None else plan.plasticity.strength().kinks,
        centred=rough is None,
    )
    values |= {} if rough is None else rough_quantities(grid, peak.contact)
    tables = _tables(plan, history, verdicts)
    if plan.track is not None:
        at_edge = status is Status.CONTACT_AT_GRID_EDGE
        film = None if record is None or at_edge else record.tribofilm
        tables |= path_tables(plan.track, grid, history, film)
        values |= path_quantities(plan.track, grid, history)
    words = advice(plan.remedies, status, how_to_enlarge(grid, history.reached))
    return Result(
        model=MODEL,
        status=status,
        **of_load(peak.state, values),
        tables=tables,
        fields=field_mesh(grid, peak, heights),
        bodies={},
        grids=cycle_grids(grid, history.ends[: steps.cycles - 1], heights)
        | {each.state: state_grids(grid, each, plan.pair.share, heights) for each in states},
        left_out=left_out,
        discretisation={
            "cells": [grid.nx, grid.ny],
            "cell_m": [grid.hx, grid.hy],
            "depths": len(grid.depths),
            "largest_depth_m": float(grid.depths[-1]),
            "contact_box_cells": [peak.contact.box.nx, peak.contact.box.ny],
            "contact_cells": int(np.count_nonzero(peak.contact.pressure)),
            **(rough_discretisation(rough) if rough is not None else {}),
            "tangential_kernels": counters.tangential_kernels,
            **history.discretisation,
        },
        certificate={
            "gap_in_contact": peak.contact.gap_residual,
            "penetration": peak.contact.penetration,
            "tension": peak.contact.tension,
            "load_error": peak.contact.load_error,
            **history.certificate,
        },
        cost=cost,
        message="; ".join(filter(None, (words, ending))),
        warnings=history.warnings,
        verdict=summary(verdicts, judging.period, history.floor)
        if judging is not None and verdicts
        else None,
    )


def _tables(plan: Plan, history: History, verdicts: Sequence[Verdict]) -> dict[str, Any]:
    """The tables of a result, but for those of a path."""
    grid, rough, steps, states = plan.grid, plan.rough, plan.schedule, list(history.snapshots.values())
    tables: dict[str, Any] = {"history": history_table(history.rows)}
    tables |= state_tables(grid, states, plan.pair.share)
    if rough is not None:
        tables["surface"] = surface_table(rough, grid, states)
    tables["residuals"] = residual_table(
        [*((row.cycle, row.step, row.attempts) for row in history.rows), *history.unfinished]
    )
    if history.loops:
        tables["loops"] = loops_table(grid, history.loops)
    if steps.cycles > 1:
        original, ends = rough.roughness() if rough is not None else None, history.ends
        tables["cycles"] = cycles_table(history.rows, ends, at_peak=steps.at_peak, roughness=original)
        cycles = tables["cycles"]["cycle"]
        if plan.slip.slides and any(target.load.sign < 0 for target in steps.targets):
            signs = {target.cycle: int(target.load.sign) for target in reversed(steps.targets)}
            tables["cycles"][FRICTION_SIGN] = [signs[cycle] for cycle in cycles]
        if plan.dissipates:
            tables["cycles"][DISSIPATED] = of_ends(cycles, ends, "dissipated")
        if plan.judging is not None:
            tables["cycles"] |= verdict_columns(cycles, verdicts, plan.judging.period)
        if plan.wear is not None:
            tables["cycles"][ROOFED] = of_ends(cycles, ends, "roofed")
            if plan.wear.rule.roof == "falls" or plan.wear.rule.smoothing_fills:
                parts = {column: of_ends(cycles, ends, name) for column, name in WEAR_PARTS.items()}
                tables["cycles"] |= parts
        if plan.paper:
            tables["cycles"] |= {name: of_ends(cycles, ends, name) for name in LEFT}
    return tables
