# SPDX-License-Identifier: MIT
"""The load history of a body that yields, one attempt at a time: from a frozen record to the next one.

Unloading takes one step if that strains nothing, else `unload_steps`. A step that does not converge is
halved; one that was halved too often is made whole again by a longer iteration, and so are all that follow.
`onward` changes nothing but counters: the same record gives the same next one, and an attempt that is
discarded leaves no trace.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from sam.arrays import Array
from sam.contact.operators import von_mises
from sam.elastic.problem import UNLOADING, ElasticPeak, ElasticProblem
from sam.grid.cells import CellGrid, Sides, Window
from sam.plasticity.box import edge_reached, first_extent, grown, holding
from sam.plasticity.load_step import ITERATIONS, LONG_ITERATIONS, Problem
from sam.plasticity.measure import (
    contact_in_box,
    cycle_end,
    dissipated_by,
    penetrated,
    problem_of,
    snapshot,
    with_last_period,
    with_loops,
    with_outside,
)
from sam.plasticity.model import Begun, Model, Parts, Progressed, floor
from sam.plasticity.state import (
    CellFields,
    Change,
    Extent,
    MaterialFields,
    State,
    Trial,
    on_larger_box,
    surrounded,
)
from sam.results.history import History, row_of
from sam.scene import Status
from sam.scene.result import LAST, PEAK, UNLOADED, Progress, unfinished
from sam.scene.section import stated
from sam.schedule import Load, Target
from sam.tribofilm.state import TribofilmState

MOST_CUTS = 6  # halvings of a load step: a part is then 1/64 of it
LONGER = "longer plastic iteration"
"""Note of a load step that is made so."""


def solve_plastic(
    problem: ElasticProblem,
    report: Progress,
    *,
    keep: Callable[[Progressed, int, int], None] | None = None,
    start: Progressed | None = None,
    peak: ElasticPeak | None = None,
) -> tuple[History, Progressed]:
    """The load history of a body that yields, from its beginning or a record, and the last record;
    keep: called as keep(record, done, total); peak: of an elastic body, for the first box.
    """
    model = Model(problem.plan, problem.counters)
    if start is not None:  # the model and its counters as they were when the record was made
        record = start
        problem_of(model, record)
        vars(model.counters).update(vars(record.counters))
    else:
        record = begun(model, model.plan.schedule.targets, first_box(model, stated(peak)))
    while not record.ended:
        before = len(record.history.rows), record.parts.count
        record = onward(model, record)
        done = len(record.history.rows)
        total = done + len(record.targets)
        if keep is not None and (done, record.parts.count) != before:
            keep(record, done, total)
        if done > before[0]:
            report("load steps", done, total)
    history = finished(model, record)
    return history, replace(record, counters=replace(model.counters))


def begun(model: Model, targets: Sequence[Target], extent: Extent) -> Progressed:
    """The record before the first step, on a first box."""
    law, unstrained = model.plan.tribofilm, np.zeros((4, *model.grid.shape))
    film = None if law is None else law.fresh(unstrained)
    wear = None if model.plan.wear is None else model.plan.wear.fresh()
    state = model.problem(extent, film, wear).virgin()
    return Progressed(state, extent, model.grid.room, tuple(targets), replace(model.counters), film, wear)


def first_box(model: Model, peak: ElasticPeak) -> Extent:
    """The first box of a history; the whole grid below a rough patch that touches elsewhere later."""
    schedule, anywhere, limit = model.plan.schedule, model.plan.places.anywhere, model.plan.initial_yield
    both_ways, path = schedule.alternates, schedule.path
    slides = model.plan.slip.slides or len(path) > 1
    extent = first_extent(
        model.grid, peak, limit, anywhere=anywhere, both_ways=both_ways, slides=slides, path=path
    )
    elsewhere = anywhere and (len(path) > 1 or schedule.renews or model.plan.period is not None)
    return replace(extent, window=model.grid.whole) if elsewhere else extent


def onward(model: Model, record: Progressed) -> Progressed:
    """Make one attempt further: a step or a part of one, or the same state and smaller steps."""
    target = record.targets[0]
    if target.step == 1 and not record.cuts:
        record = _cycle_begun(model, record)
    if target.elastic_unloading:
        record = _unloaded_elastically(model, record, target)
        return replace(record, counters=replace(model.counters))
    record = replace(record, cuts=record.cuts or (target.load,))
    record, trial = attempt(model, record, record.cuts[0])
    if trial is not None and not trial.converged:  # half of the way comes first
        record = replace(record, parts=record.parts.tried(trial))
        if len(record.cuts) <= MOST_CUTS:
            model.counters.step_cuts += 1
            halfway = record.state.load.halfway_to(record.cuts[0])
            record = replace(record, cuts=(halfway, *record.cuts))
        elif record.longer or model.plan.paper:
            record = _given_up(record, trial)
        else:
            record = replace(record, longer=True, cuts=record.cuts[-1:])
    elif trial is not None:
        record = replace(record, cuts=record.cuts[1:], parts=record.parts.with_(trial))
        record = record if record.cuts else _reached(model, record, target, trial)
    return replace(record, counters=replace(model.counters))


def _cycle_begun(model: Model, record: Progressed) -> Progressed:
    """The record that counts a cycle and period from here, with a new tribofilm on the surface."""
    material, state, film = record.state.material, record.state, record.tribofilm
    if model.plan.schedule.cycles > 1:
        record = replace(record, cycle_start=Begun(record.extent, material))
        if model.plan.judging is not None and record.periods.begun is None:
            worn = None if record.wear is None else record.wear.depth
            period = Begun(record.extent, material, worn)
            record = replace(record, periods=replace(record.periods, begun=period))
    if model.plan.tribofilm is None or (
        film is not None and film.visits is not None and state.load.force > 0
    ):
        return record
    strain = model.surface_strain(record.extent, state.residual.stress, material.strain)
    if film is None or film.visits is None:
        return replace(record, tribofilm=model.plan.tribofilm.fresh(strain))
    return replace(record, tribofilm=replace(film, visits=film.visits.unloaded(strain)))


def attempt(model: Model, record: Progressed, load: Load) -> tuple[Progressed, Trial | None]:
    """A step to a load, and the record after it, committed if it converged: made again from the
    committed state until box and film stay; None and a record that has ended if the grid cannot
    hold it.
    """
    law, track, grid, guess = model.plan.tribofilm, model.plan.track, model.grid, record.guess(load)
    start, before = _begun_at(model, record, load)
    film = before

    def changed(trial: Trial) -> Problem | None:
        """The problem with the friction that a trial makes, None if the film stays as it is."""
        nonlocal film
        if law is None or film is None or before is None:
            return None
        extent, pressure, tried = record.extent, np.zeros(grid.shape), film
        pressure[extent.window.slices] = trial.pressure * model.unit
        plastic = record.state.material.strain + trial.increment.strain
        strain = model.surface_strain(extent, trial.stress, plastic)
        film = law.tested(before, tried, strain, pressure=pressure, sign=trial.load.sign)
        return None if film.film.failed is tried.film.failed else model.problem(extent, film, record.wear)

    while True:
        problem = replace(model.problem(record.extent, film, record.wear), longer=record.longer)
        trial = problem.step(
            record.state, load, guess=guess, start=start, retest=None if film is None else changed
        )
        if not trial.converged:
            return record, trial
        extent = grown(record.extent, trial, grid)
        if extent != record.extent:
            return attempt(model, _enlarged(model, record, extent), load)
        place, rough = "" if track is None else track.place(load), model.plan.places.anywhere
        reached = edge_reached(trial, grid, cut_beside=rough)
        if reached.beside or reached.below:
            return _ended(record, Status.PLASTIC_ZONE_AT_GRID_EDGE, place, reached), None
        if track is not None and not rough and track.at_edge(grid, trial.pressure, extent.window):
            return _ended(record, Status.CONTACT_AT_GRID_EDGE, place, Sides(beside=True)), None
        if changed(trial) is None:
            after, extent = _beside(model, committed(model, record, trial, film), trial)
            if extent != record.extent:
                return attempt(model, _enlarged(model, record, extent), load)
            return after, trial
        guess, start = trial.change(record.state), trial.pressure  # the paper's loops, with more friction
        del trial  # its fields are large


def _begun_at(model: Model, record: Progressed, load: Load) -> tuple[Array | None, TribofilmState | None]:
    """p_hat that a step starts from, of the cycle before or moved with the counter-body, None: that of the
    state; and the film at its beginning.
    """
    law, track, film = model.plan.tribofilm, model.plan.track, record.tribofilm
    if track is None:
        start = record.recalled.get(repr(load.level))
        return start if start is not None and start.shape == record.extent.window.shape else None, film
    if law is not None and film is not None:
        film = law.entered(film, track.clock(record.targets[0].cycle, load))
    return track.carried(model.grid, record.state.pressure, record.state.load, load), film


def _beside(model: Model, record: Progressed, trial: Trial) -> tuple[Progressed, Extent]:
    """The record after a step, and its box; below a rough patch the one that also holds the cells
    beside it that the counter-body penetrates.
    """
    if not model.plan.places.anywhere or record.extent.window == model.grid.whole:
        return record, record.extent
    record = with_outside(model, record)
    cells = penetrated(model, record, trial)
    return record, holding(record.extent, cells, model.grid) if cells.any() else record.extent


def _enlarged(model: Model, record: Progressed, extent: Extent) -> Progressed:
    """The record on a larger box, where the next attempt is the one of a history that began on it:
    residual fields are computed anew, and steps start from the same guess.
    """
    larger, old, change = model.problem(extent, record.tribofilm, record.wear), record.extent, record.change
    state = on_larger_box(record.state, old, extent, larger.residual_of)
    if change is not None:
        increment = change.increment.on_box(old, extent)
        change = Change(increment, larger.residual_of(increment))
    recalled = {
        load: surrounded(pressure, old.inside(extent)[1:], extent.window.shape)
        for load, pressure in record.recalled.items()
    }
    return replace(record, state=state, extent=extent, outside=None, change=change, recalled=recalled)


def committed(model: Model, record: Progressed, trial: Trial, film: TribofilmState | None) -> Progressed:
    """The record after a converged step; fields outside of the box stay where nothing yields."""
    state, recalled = record.state.after(trial), record.recalled
    if trial.load.force and model.plan.schedule.cycles > 1 and model.plan.track is None:
        recalled = {**recalled, repr(trial.load.level): trial.pressure}
    return replace(
        record,
        state=state,
        last=trial,
        change=trial.change(record.state),
        tribofilm=film,
        recalled=recalled,
        dissipated=record.dissipated + dissipated_by(model, record, trial),
        left=(max(record.left[0], trial.yield_excess), max(record.left[1], trial.flow_residual)),
        outside=record.outside if state.material is record.state.material else None,
    )


def _ended(record: Progressed, status: Status, words: str, reached: Sides) -> Progressed:
    """The record of a history that ends before its last load."""
    history = replace(record.history, status=status, reached=reached, ending=words)
    return replace(record, history=history)


def _given_up(record: Progressed, trial: Trial) -> Progressed:
    """The record of a history that ends with an attempt that did not converge."""
    words = f"the plastic iteration of the last attempt, to {trial.load.force:.6g} N,"
    ending = unfinished(words, trial.history, trial.goal)
    return _ended(record, Status.STEP_CUT_LIMIT, ending, Sides())


def _unloaded_elastically(model: Model, record: Progressed, target: Target) -> Progressed:
    """Unloaded in one step if that strains nothing; else nothing but the steps of the scene is planned."""
    problem, peak = problem_of(model, record), model.plan.schedule.peak.found(record.state.load.force)
    in_steps = replace(record, targets=(*model.plan.schedule.in_steps(target, peak), *record.targets[1:]))
    # with back-stresses the elastic range is twice the yield stress wide: a path may leave it and come back
    if problem.material.hardens_back or not problem.stays_elastic(record.state):
        return in_steps
    trial = problem.step(record.state, target.load)
    if not trial.converged or trial.plastic:
        return in_steps
    record = committed(model, record, trial, record.tribofilm)
    record = replace(record, parts=record.parts.with_(trial))
    return _reached(model, record, target, trial, note=UNLOADING)


def _reached(model: Model, record: Progressed, target: Target, trial: Trial, *, note: str = "") -> Progressed:
    """The record with the step that `trial` ends, and with the period and the cycle that the step ends."""
    parts, note, judging = record.parts, note or target.note, model.plan.judging
    if parts.count > 1:
        note = _joined(note, f"cut into {parts.count} steps")
    if record.longer and note != UNLOADING:
        note = _joined(note, LONGER)
    mu, contact = problem_of(model, record).coefficient, contact_in_box(model, record, trial)
    track, window, moved = model.plan.track, record.extent.window, None
    if track is not None:
        pressure, traction = trial.pressure * model.unit, trial.load.sign * mu
        moved = track.moved(model.grid, trial.load, pressure, window=window, traction=traction)
    row = replace(
        row_of(model.grid, target, contact, coefficient=mu, whole=model.plan.slip.whole),
        iterations=parts.iterations,
        residual=parts.worst,
        note=note,
        peeq_max=float(record.state.material.peeq.max()),
        attempts=parts.attempts,
        moved=moved,
    )
    history = replace(record.history, rows=(*record.history.rows, row))
    record = replace(record, targets=record.targets[1:], parts=Parts(), history=history)
    following = record.targets[0] if record.targets else None
    ends_cycle = following is None or following.cycle > target.cycle
    if judging is not None and target.cycle % judging.period == 0:
        ends_loading = target.rises and (ends_cycle or (following is not None and not following.rises))
        if ends_loading if judging.loaded else ends_cycle:
            periods = record.periods.ended(model, record.state, record.extent)
            record = replace(record, periods=periods)
    if ends_cycle:
        record, trial = _cycle_ended(model, record, target.cycle, trial)
    record = with_loops(model, record, target, trial)
    if not target.snapshot:
        return record
    record = with_outside(model, record, stress=True)
    history = record.history
    if target.snapshot == PEAK:
        history = replace(history, certificate=trial.excesses)
    snapshots = {**history.snapshots, target.snapshot: snapshot(model, record, target.snapshot, trial)}
    return replace(record, history=replace(history, snapshots=snapshots))


def _cycle_ended(model: Model, record: Progressed, cycle: int, trial: Trial) -> tuple[Progressed, Trial]:
    """The record at the end of a cycle, after wear if the body is unloaded, and the trial that ends it."""
    start = record.cycle_start  # None where there is one cycle
    new = None if start is None else start.new_strain(record.state, record.extent)  # before removal
    if trial.load.force == 0 and record.wear is not None:
        record, trial = _worn(model, record, trial)
    record = with_outside(model, record)
    history, extent, track = record.history, record.extent, model.plan.track
    end = cycle_end(model, record, cycle, np.zeros(extent.shape) if new is None else new)
    history = replace(history, ends=(*history.ends, end))
    if track is not None:
        uz, rows = stated(record.outside).displacement, history.rows
        added = record.state.material.peeq if start is None else start.new_strain(record.state, extent)
        last = track.pass_end(model.grid, cycle, uz=uz, added=added, window=extent.window, rows=rows)
        history = replace(history, passes=(*history.passes, last))
    return replace(record, history=history, dissipated=0.0, left=(0.0, 0.0)), trial


def _worn(model: Model, record: Progressed, trial: Trial) -> tuple[Progressed, Trial]:
    """What is strained too much is removed, and equilibrium found again; the same trial if nothing is."""
    if model.plan.wear is None or record.wear is None:
        return record, trial
    material, faces = record.state.material, model.faces(record.extent)
    wear, cells, below = model.plan.wear.removed(
        record.wear,
        material.points.by_name(),
        faces,
        record.extent.window,
        cells=material.cells,
        peeq=material.peeq,
    )
    record = replace(record, wear=wear)
    if not wear.volumes[-1]:
        return record, trial
    rows = record.history.rows
    problem, left = problem_of(model, record), CellFields(cells, MaterialFields(**below))
    state = State(left, problem.residual_of(left), trial.pressure, trial.load)
    record = replace(record, state=state, outside=None)
    after = replace(problem, longer=record.longer).step(state, trial.load)
    note = f"{wear.volumes[-1]:.6g} m3 removed"
    if not after.converged and not model.plan.paper and not record.longer:  # there is no load to halve
        record, note = replace(record, longer=True), _joined(note, LONGER)
        after = replace(problem, longer=True).step(state, trial.load)
    rows = (*rows[:-1], replace(rows[-1], note=_joined(rows[-1].note, note)))
    record = replace(record, history=replace(record.history, rows=rows))
    if not after.converged:
        return _given_up(record, after), trial
    return committed(model, record, after, record.tribofilm), after


def _joined(*notes: str) -> str:
    return "; ".join(filter(None, notes))


def on_larger_grid(record: Progressed, grid: CellGrid, larger: CellGrid) -> Progressed | None:
    """The same record in the middle of a larger grid of equal cells, or None if it cannot be."""
    wider, faces = grid.shape != larger.shape, stated(grid.faces)
    of_whole_grid = wider and (record.wear is not None or record.tribofilm is not None)
    same_layers = np.array_equal(faces, stated(larger.faces)[: len(faces)])
    if record.history.snapshots or of_whole_grid or not same_layers:
        return None
    i, j = (larger.nx - grid.nx) // 2, (larger.ny - grid.ny) // 2

    def there(extent: Extent) -> Extent:
        """A box of the grid on the larger one."""
        inside = extent.window
        return replace(extent, window=Window(inside.i0 + i, inside.j0 + j, inside.nx, inside.ny))

    start, ends = record.cycle_start, record.history.ends
    if wider:
        ends = tuple(replace(end, moved=None, worn=None) for end in ends)
    history = replace(record.history, ends=ends, status=Status.CONVERGED, reached=Sides(), ending="")
    return replace(
        record,
        extent=there(record.extent),
        outside=None,
        room=larger.room,
        history=history,
        cycle_start=start and replace(start, extent=there(start.extent)),
        periods=record.periods.at(there),
    )


def finished(model: Model, record: Progressed) -> History:
    """The history of a record that has ended, with what is measured at its end, or its LAST state."""
    history = record.history
    snapshots, residuals, plan = dict(history.snapshots), history.certificate, model.plan
    if not residuals:
        last = record.last
        if last is None or last.increment.cells.shape != record.extent.shape:  # the box has grown
            last = problem_of(model, record).step(record.state, record.state.load)
        record = with_outside(model, record, stress=True)
        snapshots[LAST], residuals = snapshot(model, record, LAST, last), last.excesses
    names = [name for name in (PEAK, LAST, UNLOADED) if name in snapshots]
    states = {name: with_last_period(model, record, snapshots[name]) for name in names}
    first, window = next(iter(states.values())), record.extent.window
    # of the stress in y = 0 outside the box, where no plastic strain was allowed
    excess = von_mises(first.in_plane) / plan.initial_yield[:, None] - 1
    excess[: record.extent.layers, window.i0 : window.i0 + window.nx] = 0.0
    warnings: tuple[str, ...] = ()
    if steps := [row for row in history.rows if LONGER in row.note]:
        warnings += (
            f"a load step did not converge however often it was halved; {len(steps)} of {len(history.rows)} "
            f"load steps, from cycle {steps[0].cycle}, step {steps[0].step} on, were made by a {LONGER}, of "
            f"up to {LONG_ITERATIONS} iterations in place of {ITERATIONS}",
        )
    if plan.paper:
        warnings += (
            f'solver.method = "paper", stop = "{plan.solver.stop}": the last step leaves a yield excess of '
            f"{residuals['yield_excess']:.1e} and a flow-rule residual of {residuals['flow_residual']:.1e} "
            "of the yield stress",
        )
    return replace(
        history,
        snapshots=states,
        certificate={
            **residuals,
            "yield_excess_outside_box": float(max(excess.max(), 0.0)),
            "plastic_tolerance": model.plan.solver.tolerance,
        },
        discretisation={
            "plastic_box_cells": [window.nx, window.ny],
            "plastic_box_layers": record.extent.layers,
            "layers": len(model.grid.depths),
            "operator_bytes": problem_of(model, record).operator.memory,
        },
        warnings=warnings,
        unfinished=tuple((target.cycle, target.step, record.parts.attempts) for target in record.targets[:1]),
        floor=float(floor(model, record.extent).min()) if model.plan.judging is not None else 0.0,
    )
