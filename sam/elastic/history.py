# SPDX-License-Identifier: MIT
"""The load history of a body that stays elastic."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from sam.arrays import Array
from sam.contact.normal import fit_of
from sam.contact.stress import elastic_strain
from sam.elastic.problem import ElasticProblem, Loaded, contact_tolerance
from sam.elastic.stress import sliding_of, stress_at, stresses_of
from sam.results.history import History, Row, counted, largest_pressure, row_of
from sam.results.snapshots import Coated, Comparison, Cut, Snapshot, row_of_largest
from sam.results.tables import advice
from sam.scene import Status
from sam.scene.result import Attempt, Progress
from sam.schedule import UNLOADED, Load
from sam.tribofilm.state import FilmOnCells, TribofilmState

UNFIT = "bare body, for comparison: {}: its largest pressure and stress and their changes are not given"
UNLOADING = "elastic: unloading in one step"
CYCLE = "elastic: equal to cycle 1"


def solve_elastic(problem: ElasticProblem, report: Progress) -> History:
    """The load history of an elastic body: one cycle stands for all but on a renewed surface."""
    plan, grid = problem.plan, problem.plan.grid
    rows: list[Row] = []
    snapshots: dict[str, Snapshot] = {}
    schedule, tribofilm, track = plan.schedule, plan.tribofilm, plan.track
    steps, previous, before = sum(target.rises for target in schedule.different), None, UNLOADED
    film = None
    for k, target in enumerate(schedule.different, start=1):
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
        attempts = (Attempt(True, contact.residuals, contact_tolerance(plan.solver.tolerance)),)
        once = replace(target, cycle=1) if schedule.all_alike else target
        row = row_of(grid, once, contact, coefficient=state.coefficient, whole=plan.slip.whole)
        row = replace(row, iterations=contact.iterations, residual=contact.residual, note=note)
        moved = None
        if track is not None:
            mu = target.load.sign * state.coefficient
            moved = track.moved(grid, target.load, contact.pressure, window=grid.whole, traction=mu)
        row = replace(row, attempts=attempts, moved=moved)
        rows.append(row)
        previous, before = contact.pressure, target.load
        if target.rises:
            report("contact", k, steps)
        if target.snapshot:
            place = target.load.x, target.load.y
            snapshots[target.snapshot] = replace(
                snapshot_of(target.snapshot, state), stretch=target.load.stretch, place=place
            )
            report("stress", 1, 1)
    first = list(rows)
    for cycle in range(2, schedule.cycles + 1 if schedule.all_alike else 2):
        rows += [replace(row, cycle=cycle, iterations=0, note=CYCLE, attempts=()) for row in first]
    return History(tuple(rows), snapshots)


def step_with_tribofilm(
    problem: ElasticProblem,
    tribofilm: FilmOnCells,
    film: TribofilmState,
    load: Load,
    *,
    start: Array | None = None,
) -> tuple[Loaded, TribofilmState]:
    """State and tribofilm after a step, repeated until the film is the one whose friction it had."""
    tried, grid, body = film, problem.plan.grid, problem.plan.pair.body
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


def snapshot_of(name: str, state: Loaded) -> Snapshot:
    """The record of a state."""
    problem, plan, contact = state.problem, state.problem.plan, state.contact
    row = row_of_largest(contact, counted(contact, plan.grid)) if plan.places.off_origin else None
    stresses = stresses_of(state, row)
    cut = None
    if row is not None and stresses.in_row is not None:
        peeq = np.zeros(stresses.in_row.shape[1:])
        cut = Cut(float(plan.grid.y[row]), plan.grid.x, plan.grid.depths, stresses.in_row, peeq)
    coated = None
    if plan.coated is not None:  # with the bare body to compare with, under force
        comparison = bare_body(state) if state.load.force else None
        traction = state.traction if plan.slip.coupled else None
        moved = plan.coated.counter_uz(plan.grid, contact.pressure, traction, problem.counters)
        coated = Coated(plan.coated.thickness, moved, comparison)
    zero, unmoved = np.zeros_like(stresses.plane), np.zeros(contact.gap.shape)
    return Snapshot(
        name,
        contact,
        unmoved,
        stresses.plane,
        zero,
        zero[0],
        stresses.mises,
        sliding=sliding_of(state),
        coated=coated,
        cut=cut,
    )


def bare_body(state: Loaded) -> Comparison:
    """Contact of the bare body, from the coated pressure on, and its stress; a warning where it is unfit."""
    bare, load = state.problem.bare(), state.load.by_force()
    contact = bare.contact(load, start=state.contact.pressure)
    status = fit_of(contact, rough=bare.plan.places.anywhere)
    if status is not Status.CONVERGED:
        return Comparison(warning=UNFIT.format(advice(bare.plan.remedies, status)))
    mises = stresses_of(bare.state(load, contact)).mises
    return Comparison(largest_pressure(contact, bare.plan.grid), mises)
