# SPDX-License-Identifier: MIT
"""The load history of a body that stays elastic."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from sam.arrays import Array
from sam.contact.normal import Contact
from sam.contact.stress import elastic_strain
from sam.elastic.comparison import coated_state
from sam.elastic.problem import ElasticProblem, Loaded
from sam.elastic.stress import sliding_of, stress_at, stresses_of
from sam.results.history import Effort, Row, counted, row_of
from sam.results.snapshots import Cut, Snapshot, row_of_largest
from sam.results.tables import Remedies
from sam.scene.residuals import Attempt
from sam.scene.result import Progress
from sam.schedule import UNLOADED, Load, Schedule
from sam.surface_state import Tribofilm, TribofilmState

if TYPE_CHECKING:
    from sam.moving import Track

UNLOADING = "elastic: unloading in one step"
CYCLE = "elastic: equal to cycle 1"


def solve_elastic(
    problem: ElasticProblem,
    schedule: Schedule,
    remedies: Remedies,
    report: Progress,
    *,
    tribofilm: Tribofilm | None = None,
    track: Track | None = None,
) -> tuple[list[Row], list[Snapshot]]:
    """History and states of a scene that stays elastic: unloading in one step, the last cycle stands for all
    unless the counter-surface is renewed.

    Where the sign of the traction changes, the cycles are mirror images: what the history holds of them is
    equal.
    """
    rows: list[Row] = []
    snapshots: list[Snapshot] = []
    targets, grid = schedule.different, problem.grid
    steps, previous, before = sum(target.rises for target in targets), None, UNLOADED
    film = None
    for k, target in enumerate(targets, start=1):
        if tribofilm is not None and target.step == 1 and (track is None or film is None):
            film = tribofilm.fresh(np.zeros((4, grid.nx, grid.ny)))
        if track is not None and previous is not None:
            previous = track.carried(grid, previous, before, target.load)
        if tribofilm is not None and film is not None and track is not None:
            film = tribofilm.entered(film, track.clock(target.cycle, target.load))
        if tribofilm is None or film is None:
            state = problem.state(target.load, problem.contact(target.load, start=previous))
        else:
            state, film = step_with_tribofilm(problem, tribofilm, film, target.load, start=previous)
        contact, note = state.contact, target.note if target.rises else UNLOADING
        attempts = (Attempt(True, contact.residuals, problem.tolerance),)
        effort = Effort(contact.iterations, contact.residual, note, attempts=attempts)
        once = replace(target, cycle=1) if schedule.all_alike else target
        row = row_of(grid, once, contact, effort, coefficient=state.coefficient, whole=problem.slip.whole)
        if track is not None:
            mu, whole = target.load.sign * state.coefficient, grid.whole
            moved = track.moved(grid, target.load, contact.pressure, window=whole, traction=mu)
            row = replace(row, moved=moved)
        rows.append(row)
        previous, before = contact.pressure, target.load
        if target.rises:
            report("contact", k, steps)
        if target.snapshot:
            found = snapshot_of(target.snapshot, state, remedies)
            place = target.load.x, target.load.y
            snapshots.append(replace(found, stretch=target.load.stretch, place=place))
            report("stress", 1, 1)
    first = list(rows)
    for cycle in range(2, schedule.cycles + 1 if schedule.all_alike else 2):
        rows += [replace(row, cycle=cycle, iterations=0, note=CYCLE, attempts=()) for row in first]
    return rows, snapshots


def step_with_tribofilm(
    problem: ElasticProblem,
    tribofilm: Tribofilm,
    film: TribofilmState,
    load: Load,
    *,
    start: Array | None = None,
) -> tuple[Loaded, TribofilmState]:
    """The state under a load and the tribofilm after the step, repeated until the film that breaks down in
    the state is the one whose friction it was solved with.
    """
    tried, grid, body = film, problem.grid, problem.pair.body
    while True:
        mu = tribofilm.coefficient(tried)
        state = problem.state(load, problem.contact(load, mu, start), mu)
        stress = stress_at(state, np.zeros(1), grid.whole)[:, 0]
        strain = elastic_strain(stress, body.young, body.poisson)
        pressure = state.contact.pressure
        tested = tribofilm.tested(film, tried, strain, pressure=pressure, sign=load.sign)
        if tested.film.failed is tried.film.failed:
            return replace(state, coefficient=tribofilm.coefficient(tested)), tested
        start, tried = pressure, tested


def snapshot_of(name: str, state: Loaded, remedies: Remedies) -> Snapshot:
    """The record of a state."""
    problem = state.problem
    row = _row_of_cut(problem, state.contact)
    found = stresses_of(state, row)
    cut = None
    if row is not None and found.in_row is not None:
        cut = Cut.elastic(problem.grid, row, found.in_row)
    coated = coated_state(problem.coated, state, remedies) if problem.coated is not None else None
    sliding = sliding_of(state)
    return Snapshot.elastic(
        name, state.contact, found.plane, found.mises, sliding=sliding, coated=coated, cut=cut
    )


def _row_of_cut(problem: ElasticProblem, contact: Contact) -> int | None:
    """The row of cells through the largest pressure; None without contact, or where that is around the
    origin.
    """
    if not problem.looked.off_origin:
        return None
    return row_of_largest(contact, counted(contact, problem.grid))
