# SPDX-License-Identifier: MIT
"""The load history of a body that yields, one attempt at a time: from a frozen record to the next one.

Unloading takes one step if that strains nothing, else `unload_steps`. A step that does not converge is
halved; one that was halved too often is made whole again by a longer iteration, and so are all that follow.
`onward` changes nothing but counters: the same record gives the same next one, and an attempt that is
discarded leaves no trace.

An elasto-plastic scene: its load history solved, and what is found of it.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from sam.contact.stress import von_mises
from sam.elastic.history import UNLOADING
from sam.elastic.problem import ElasticProblem
from sam.elastic.stress import ElasticPeak
from sam.grid.cells import CellGrid, Sides, Window
from sam.plasticity.box import edge_reached, first_extent, grown
from sam.plasticity.load_step import ITERATIONS, LONG_ITERATIONS
from sam.plasticity.measure import (
    contact_in_box,
    cycle_end,
    dissipated_by,
    moved,
    pass_end,
    problem_now,
    snapshot,
    start_of,
    strained_in_cycle,
    with_last_period,
    with_loops,
    with_outside,
)
from sam.plasticity.model import Model
from sam.plasticity.progress import Begun, CycleStart, Parts, Progressed, floor
from sam.plasticity.state import Extent, MaterialFields, State, Trial, on_larger_box
from sam.results.history import Effort, History, Row, row_of
from sam.scene import Status
from sam.scene.residuals import unfinished
from sam.scene.result import LAST, PEAK, UNLOADED, Progress
from sam.schedule import Load, Target
from sam.surface_state import TribofilmState

MOST_CUTS = 6  # halvings of a load step: a part is then 1/64 of it
# Tolerance of a step after which the tribofilm is tested first, before that of the solved step: a small
# running-in takes 12 operator applications with 0.01, 11 with 0.1 and 10 with 1.
FIRST_TEST = 0.1
LONGER = "longer plastic iteration"
"""Note of a load step that is made so."""


def onward(model: Model, now: Progressed) -> Progressed:
    """Make one attempt further: a committed step or part of one, or the same state and smaller steps.

    Parameters
    ----------
    model
        What stays the same; only its counters change.
    now
        The record before, of a history that has not ended.

    Returns
    -------
    Progressed
        The record after.
    """
    target = now.targets[0]
    if target.step == 1 and not now.cuts:
        now = _with_new_film(model, _counted_from_here(model, now))
    step = _unloaded_elastically if target.elastic_unloading else _towards
    now = step(model, now, target)
    return replace(now, counters=replace(model.counters))


def _towards(model: Model, now: Progressed, target: Target) -> Progressed:
    """One attempt at the next load on the way to a target."""
    now = replace(now, cuts=now.cuts or (target.load,))
    now, trial = attempt(model, now, now.cuts[0])
    if trial is None:
        return now
    if not trial.converged:
        return _cut(model, now, trial)
    now = replace(now, cuts=now.cuts[1:], parts=now.parts.with_(trial))
    return now if now.cuts else _reached(model, now, target, trial)


def _ended(record: Progressed, status: Status, words: str, reached: Sides) -> Progressed:
    """The record of a history that ends before its last load."""
    history = replace(record.history, status=status, reached=reached, ending=words)
    return replace(record, history=history)


def _residuals(trial: Trial) -> dict[str, float]:
    """What a load step leaves of the yield condition and of the flow rule."""
    return {"yield_excess": trial.yield_excess, "flow_residual": trial.flow_residual}


def _cut(model: Model, now: Progressed, trial: Trial) -> Progressed:
    """Half of the way to the next load comes first, after an attempt at all of it; if it was halved too
    often, the longer iteration, or the end.
    """
    now = replace(now, parts=now.parts.tried(trial))
    if len(now.cuts) > MOST_CUTS:
        if now.longer or model.plan.paper:
            return _given_up(now, trial)
        return replace(now, longer=True, cuts=now.cuts[-1:])
    model.counters.step_cuts += 1
    return replace(now, cuts=(now.state.load.halfway_to(now.cuts[0]), *now.cuts))


def _given_up(now: Progressed, trial: Trial) -> Progressed:
    """The record of a history that ends with an attempt that did not converge."""
    words = f"the plastic iteration of the last attempt, to {trial.load.force:.6g} N,"
    ending = unfinished(words, trial.history, trial.goal)
    return _ended(now, Status.STEP_CUT_LIMIT, ending, Sides())


def _unloaded_elastically(model: Model, now: Progressed, target: Target) -> Progressed:
    """Unloaded in one step if that strains nothing; else the only thing done is to plan the steps of the
    scene.
    """
    problem, peak = problem_now(model, now), model.schedule.peak.found(now.state.load.force)
    in_steps = replace(now, targets=(*model.schedule.in_steps(target, peak), *now.targets[1:]))
    # with back-stresses the elastic range is twice the yield stress wide: a path may leave it and come back
    if problem.material.hardens_back or not problem.stays_elastic(now.state):
        return in_steps
    trial = problem.step(now.state, target.load)
    if not trial.converged or trial.plastic:
        return in_steps
    now = committed(model, now, trial, now.tribofilm)
    now = replace(now, parts=now.parts.with_(trial))
    return _reached(model, now, target, trial, note=UNLOADING)


def attempt(model: Model, now: Progressed, load: Load) -> tuple[Progressed, Trial | None]:
    """A step to a load on a box that holds it, and the record after it, committed if the step converged.

    The box grows, and the tribofilm is tested, until neither changes any more; each time the step is made
    again from the committed state. None, and a record that has ended, if the grid cannot hold the step.
    """
    film = before = _entered(model, now, load)
    guess, start = now.guess(load), start_of(model, now, load)
    until = model.tolerance if film is None else max(FIRST_TEST, model.tolerance)
    while True:
        problem = replace(model.problem(now.extent, film, now.wear), longer=now.longer)
        trial = problem.step(now.state, load, guess=guess, start=start, tolerance=until)
        if not trial.converged:
            return now, trial
        extent = grown(now.extent, trial, model.grid)
        if extent != now.extent:
            now = _on_larger_box(model, now, extent, film)
            guess, start = now.guess(load), start_of(model, now, load)
            continue  # on the larger box
        reached = edge_reached(trial, cut_beside=model.plan.places.anywhere)
        if reached.beside or reached.below:
            return _ended(now, Status.PLASTIC_ZONE_AT_GRID_EDGE, model.place(load), reached), None
        if model.leaves_grid(now.extent.window, trial.pressure):
            return _ended(now, Status.CONTACT_AT_GRID_EDGE, model.place(load), Sides(beside=True)), None
        tested = _tested(model, now, trial, before=before, film=film)
        film_unchanged = tested is None or film is None or tested.film.failed is film.film.failed
        film = tested
        if film_unchanged and until <= model.tolerance:
            return committed(model, now, trial, film), trial
        guess, start = trial.change(now.state), trial.pressure  # again, with more friction or more exactly
        until = model.tolerance if film_unchanged else until


def committed(model: Model, now: Progressed, trial: Trial, film: TribofilmState | None) -> Progressed:
    """The record after a converged step; fields outside of the box stay where nothing yields."""
    state, recalled = now.state.after(trial), now.recalled
    if trial.load.force and model.schedule.cycles > 1 and model.track is None:
        recalled = {**recalled, repr(trial.load.level): trial.pressure}
    return replace(
        now,
        state=state,
        last=trial,
        change=trial.change(now.state),
        tribofilm=film,
        recalled=recalled,
        dissipated=now.dissipated + dissipated_by(model, now, trial),
        outside=now.outside if state.points is now.state.points else None,
    )


def _on_larger_box(model: Model, now: Progressed, extent: Extent, film: TribofilmState | None) -> Progressed:
    """The record with the committed state on a larger box; its residual fields are computed anew there."""
    problem = model.problem(extent, film, now.wear)
    state = on_larger_box(now.state, now.extent, extent, problem.residual_of)
    return replace(now, state=state, extent=extent, outside=None)


def _counted_from_here(model: Model, now: Progressed) -> Progressed:
    """The record that counts the strain of a cycle from here on."""
    if model.schedule.cycles == 1:
        return now
    material = now.state.material
    now = replace(now, cycle_start=CycleStart(now.extent, material.peeq))
    if model.judging is None or now.periods.begun is not None:
        return now
    worn = None if now.wear is None else now.wear.depth
    begun = Begun(now.extent, material.strain, material.peeq, worn)
    return replace(now, periods=replace(now.periods, begun=begun))


def _with_new_film(model: Model, now: Progressed) -> Progressed:
    """The record with a new tribofilm on the surface as it is, at the start of a cycle; below a counter-body
    that moves with the strain of the unloaded surface only, as its film is made anew in each visit.
    """
    if model.tribofilm is None:
        return now
    state, film = now.state, now.tribofilm
    if film is not None and film.visits is not None and state.load.force > 0:
        return now
    strain = model.surface_strain(now.extent, state.residual.stress, state.material.strain)
    if film is None or film.visits is None:
        return replace(now, tribofilm=model.tribofilm.fresh(strain))
    return replace(now, tribofilm=replace(film, visits=film.visits.unloaded(strain)))


def _entered(model: Model, now: Progressed, load: Load) -> TribofilmState | None:
    """The tribofilm at the beginning of a step to a load."""
    film, track = now.tribofilm, model.track
    if model.tribofilm is None or film is None or track is None:
        return film
    return model.tribofilm.entered(film, track.clock(now.targets[0].cycle, load))


def _tested(
    model: Model, now: Progressed, trial: Trial, *, before: TribofilmState | None, film: TribofilmState | None
) -> TribofilmState | None:
    """The tribofilm at the end of a step from `before` that was solved with the friction of `film`."""
    if model.tribofilm is None or film is None or before is None:
        return film
    pressure = np.zeros((model.grid.nx, model.grid.ny))
    pressure[now.extent.window.slices] = trial.pressure * model.unit
    plastic = now.state.material.strain + trial.increment.strain
    strain = model.surface_strain(now.extent, trial.stress, plastic)
    return model.tribofilm.tested(before, film, strain, pressure=pressure, sign=trial.load.sign)


def _reached(model: Model, now: Progressed, target: Target, trial: Trial, *, note: str = "") -> Progressed:
    """The record with the step that `trial` ends."""
    parts, note = now.parts, note or target.note
    if parts.count > 1:
        note = _joined(note, f"cut into {parts.count} steps")
    if now.longer and note != UNLOADING:
        note = _joined(note, LONGER)
    effort = Effort(parts.iterations, parts.worst, note, float(now.state.material.peeq.max()), parts.attempts)
    row = row_of(
        model.grid,
        target,
        contact_in_box(model, now, trial),
        effort,
        coefficient=problem_now(model, now).coefficient,
        whole=model.plan.slip.whole,
    )
    if model.track is not None:
        row = replace(row, moved=moved(model, now, trial))
    history = replace(now.history, rows=(*now.history.rows, row))
    now = replace(now, targets=now.targets[1:], parts=Parts(), history=history)
    following = now.targets[0] if now.targets else None
    if _ends_period(model, target, following):
        now = replace(now, periods=now.periods.ended(model, now.state, now.extent))
    if following is None or following.cycle > target.cycle:
        now, trial = _cycle_ended(model, now, target.cycle, trial)
    now = with_loops(model, now, target, trial)
    if not target.snapshot:
        return now
    now = with_outside(model, now, stress=True)
    history = now.history
    if target.snapshot == PEAK:
        history = replace(history, certificate=_residuals(trial))
    state = snapshot(model, now, target.snapshot, trial)
    return replace(now, history=replace(history, snapshots={**history.snapshots, target.snapshot: state}))


def _ends_period(model: Model, target: Target, following: Target | None) -> bool:
    """Whether a step is the last one of a period of a scene that is judged."""
    if model.judging is None or target.cycle % model.judging.period:
        return False
    ends = following is None or following.cycle > target.cycle
    if not model.judging.loaded:
        return ends
    return target.rises and (ends or (following is not None and not following.rises))


def _cycle_ended(model: Model, now: Progressed, cycle: int, trial: Trial) -> tuple[Progressed, Trial]:
    """The record at the end of a cycle, after wear if the body is unloaded, and the trial that ends it."""
    strained = strained_in_cycle(now)
    if trial.load.force == 0 and now.wear is not None:
        now, trial = _worn(model, now, trial)
    now = with_outside(model, now)
    history = replace(now.history, ends=(*now.history.ends, cycle_end(model, now, cycle, strained)))
    if model.track is not None:
        passes = (*history.passes, pass_end(model, now, model.track, cycle))
        history = replace(history, passes=passes)
    return replace(now, history=history, dissipated=0.0), trial


def _worn(model: Model, now: Progressed, trial: Trial) -> tuple[Progressed, Trial]:
    """Material that is strained too much is removed, and equilibrium found again; the same trial if nothing
    is removed.
    """
    if model.plan.wear is None or now.wear is None:
        return now, trial
    peeq, points, faces = now.state.material.peeq, now.state.points.by_name(), model.faces(now.extent)
    wear, below = model.plan.wear.removed(now.wear, points, faces, now.extent.window, peeq=peeq)
    now = replace(now, wear=wear)
    if not wear.volumes[-1]:
        return now, trial
    rows = now.history.rows
    problem, left = problem_now(model, now), MaterialFields(**below)
    state = State(left, problem.residual_of(left.means()), trial.pressure, trial.load)
    now = replace(now, state=state, outside=None)
    after = replace(problem, longer=now.longer).step(state, trial.load)
    note = f"{wear.volumes[-1]:.6g} m3 removed"
    if not after.converged and not model.plan.paper and not now.longer:  # there is no load to halve
        now, note = replace(now, longer=True), _joined(note, LONGER)
        after = replace(problem, longer=True).step(state, trial.load)
    worn = replace(rows[-1], note=_joined(rows[-1].note, note))
    now = replace(now, history=replace(now.history, rows=(*rows[:-1], worn)))
    if not after.converged:
        return _given_up(now, after), trial
    return committed(model, now, after, now.tribofilm), after


def _joined(*notes: str) -> str:
    return "; ".join(filter(None, notes))


def solve_plastic(
    problem: ElasticProblem,
    report: Progress,
    *,
    keep: Callable[[Progressed, int, int], None] | None = None,
    start: Progressed | None = None,
    peak: ElasticPeak | None = None,
) -> tuple[History, Progressed]:
    """The load history of a body that yields, from its beginning or from a record on, and the last record.

    keep: called as keep(record, done, total) after each committed step, or part of one, with the number of
    load steps; peak: of the body if it stayed elastic, which the first box is chosen from.
    """
    model = Model(problem)
    if start is not None:
        now = continued(model, start)
    elif peak is not None:
        now = begun(model, model.schedule.targets, first_box(model, peak))
    else:
        raise ValueError("either a record or the elastic peak is needed")
    total = len(model.schedule.targets)
    while not now.ended:
        before, now = now, onward(model, now)
        done = len(now.history.rows)
        if keep is not None and now.last is not before.last:
            keep(now, done, done + len(now.targets))
        if before.targets[0].rises and done > len(before.history.rows):
            report("load steps", done, total)
    history = finished(model, now)
    return history, replace(now, counters=replace(model.counters))


def begun(model: Model, targets: Sequence[Target], extent: Extent) -> Progressed:
    """The record before the first step, on a first box."""
    film = None
    if model.tribofilm is not None:
        film = model.tribofilm.fresh(model.nothing_strained())
    wear = model.plan.wear.fresh() if model.plan.wear is not None else None
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
        model.plan.initial_yield,
        anywhere=model.plan.places.anywhere,
        both_ways=model.schedule.alternates,
        path=model.schedule.path,
    )


def on_larger_grid(record: Progressed, grid: CellGrid, larger: CellGrid) -> Progressed | None:
    """The same record in the middle of a grid with further cells of the same size, or above further layers;
    None if it has fields of the whole grid, or layers that the other has not.
    """
    wider, faces = grid.shape != larger.shape, grid.layer_faces
    of_whole_grid = wider and (record.wear is not None or record.tribofilm is not None)
    same_layers = np.array_equal(faces, larger.layer_faces[: len(faces)])
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


def finished(model: Model, now: Progressed) -> History:
    """The history of a record that has ended, with what is measured at its end; of one that broke off before
    the peak with the last state that it reached, as LAST.
    """
    history = now.history
    snapshots, residuals, plan = dict(history.snapshots), history.certificate, model.plan
    if not residuals:
        last = now.last
        if (
            last is None or last.increment.strain.shape != now.state.material.strain.shape
        ):  # the box has grown
            last = problem_now(model, now).step(now.state, now.state.load)
        now = with_outside(model, now, stress=True)
        snapshots[LAST], residuals = snapshot(model, now, LAST, last), _residuals(last)
    states = {
        name: with_last_period(model, now, snapshots[name])
        for name in (PEAK, LAST, UNLOADED)
        if name in snapshots
    }
    first, window = next(iter(states.values())), now.extent.window
    # of the stress in y = 0 outside the box, where no plastic strain was allowed
    excess = von_mises(first.in_plane) / plan.initial_yield[:, None] - 1
    excess[: now.extent.layers, window.i0 : window.i0 + window.nx] = 0.0
    warnings = _lengthened(history.rows)
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
            "plastic_tolerance": model.tolerance,
        },
        discretisation={
            "plastic_box_cells": [window.nx, window.ny],
            "plastic_box_layers": now.extent.layers,
            "layers": len(model.grid.depths),
            "operator_bytes": problem_now(model, now).operator.memory,
        },
        warnings=warnings,
        unfinished=tuple((target.cycle, target.step, now.parts.attempts) for target in now.targets[:1]),
        floor=float(floor(model, now.extent).min()) if model.judging is not None else 0.0,
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
