# SPDX-License-Identifier: MIT
"""Elastic contact of a scene: load steps, and stresses at the output depths. Paper Eq. 5, 7, 9 and 10."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from sam.cell_row import Cut
from sam.contact.bodies import HALF_SPACES
from sam.contact.convolution import Counters
from sam.contact.normal import Contact, Search, no_contact, solve_contact
from sam.contact.operators import SurfaceOperators
from sam.contact.stress import stresses, von_mises
from sam.contact.surface_strain import elastic_strain
from sam.friction import Coefficient, coefficient_on
from sam.grid.cells import CellGrid, Window
from sam.loading import (
    Load,
    given_contact,
    given_pressure,
    leaves_axis,
    off_origin,
    sign_of,
    targets_of_cycle,
)
from sam.planner.grids import coupling_of, gap_of, pair_of
from sam.record import Row, Snapshot, counted, row_of
from sam.scene import Scene
from sam.scene.residuals import Attempt
from sam.scene.result import Progress
from sam.sliding import Sliding
from sam.surface_state import Tribofilm, TribofilmState

if TYPE_CHECKING:
    from sam.coating import Coated, Film

SCENE_TO_CONTACT_TOLERANCE = 1e-4  # the contact is solved to this share of solver.tolerance
REACHED = 1e-12  # residuals that rounding allows on grids of usual size (2e-13 on 513 x 513 cells)
UNLOADING = "elastic: unloading in one step"
CYCLE = "elastic: equal to cycle 1"
BYTES_AT_ONCE = (
    2e8  # of the spectra of a block of depths: four of them fit into the memory of a small machine
)


def contact_tolerance(scene: Scene) -> float:
    """On the residuals of the contact: a share of that of the scene, but what rounding allows where that is less."""
    asked = scene.solver.tolerance
    return max(SCENE_TO_CONTACT_TOLERANCE * asked, min(asked, REACHED))


def load_step(
    scene: Scene,
    grid: CellGrid,
    load: Load,
    start: np.ndarray | None,
    counters: Counters,
    film: Film | None = None,
    coefficient: Coefficient | None = None,
) -> Contact:
    """Contact of the elastic bodies under a load, or the pressure that the scene gives.

    start: pressure of the step before; film: of a coated scene; coefficient: of friction, if it is not that of the scene.
    """
    gap0, modulus = gap_of(scene, grid), pair_of(scene).contact_modulus
    if load.force == 0:
        return no_contact(gap0)
    if coefficient is None:
        coefficient = coefficient_on(scene, grid)
    coupling, bodies = load.sign * coupling_of(scene, coefficient), film.bodies(grid) if film else HALF_SPACES
    if scene.loading.prescribed:
        surface = SurfaceOperators(gap0.shape, grid.hy / grid.hx, counters, coupling=coupling, bodies=bodies)
        pressure = given_pressure(scene, load, grid.x, grid.y, grid.hx, grid.hy)
        u = surface.displacement(pressure * (2 / modulus), surface.whole, surface.whole) * grid.hx
        return given_contact(scene, load, pressure, u, grid.hx * grid.hy)
    search, cell = Search(contact_tolerance(scene), start, counters=counters), (grid.hx, grid.hy)
    return solve_contact(gap0, cell, modulus, load.force, coupling=coupling, bodies=bodies, search=search)


def plane_stress(
    scene: Scene,
    grid: CellGrid,
    load: Load,
    contact: Contact,
    counters: Counters,
    film: Film | None = None,
    coefficient: Coefficient | None = None,
) -> np.ndarray:
    """Stress in the rows that touch y = 0, (6, nz, nx, rows) in Pa; film, coefficient: see `load_step`."""
    return _stress(scene, grid, load, contact, counters, film, coefficient, grid.depths, grid.axis_rows)


def stress_and_mises(
    scene: Scene,
    grid: CellGrid,
    load: Load,
    contact: Contact,
    counters: Counters,
    film: Film | None = None,
    coefficient: Coefficient | None = None,
    row: int | None = None,
) -> tuple[np.ndarray, np.ndarray, np.ndarray | None]:
    """`plane_stress`, the von Mises stress among which the largest is, (nz, n) in Pa, and the stress in a row of cells.

    Under a smooth body in the plane y = 0, n = nx, or if that ends beside it in the row; under a rough one the largest of
    the whole grid, n = 1. The stress in the row, (6, nz, nx) in Pa: None if row is.
    """

    def stress_at(depths: np.ndarray, window: Window) -> np.ndarray:
        return _stress(scene, grid, load, contact, counters, film, coefficient, depths, window)

    if scene.surface is not None:
        return largest_mises(stress_at, grid, counted(contact, grid), row)
    stress = stress_at(grid.depths, grid.axis_rows)
    if row is None:
        return stress, von_mises(stress.mean(axis=-1)), None
    rows = grid.axis_rows
    if rows.j0 <= row < rows.j0 + rows.ny:
        in_row = stress[..., row - rows.j0]
    else:
        in_row = stress_at(grid.depths, Window(0, row, grid.nx, 1))[..., 0]
    return stress, von_mises(in_row if leaves_axis(scene) else stress.mean(axis=-1)), in_row


def _stress(
    scene: Scene,
    grid: CellGrid,
    load: Load,
    contact: Contact,
    counters: Counters,
    film: Film | None,
    coefficient: Coefficient | None,
    depths: np.ndarray,
    window: Window,
) -> np.ndarray:
    """Stress in a window of cells at some depths, (6, nz, nx, ny) in Pa."""
    tractions, nu = {3: contact.pressure}, scene.body.poisson
    if scene.coefficient:
        mu = coefficient_on(scene, grid) if coefficient is None else coefficient
        tractions[1] = load.sign * mu * contact.pressure
    layered = film.layered if film else None
    cell = grid.hx, grid.hy
    return stresses(tractions, cell, depths, window, nu=nu, layered=layered, counters=counters)


def settled_step(
    scene: Scene,
    grid: CellGrid,
    load: Load,
    start: np.ndarray | None,
    counters: Counters,
    film: Film | None,
    tribofilm: Tribofilm,
    state: TribofilmState,
) -> tuple[Contact, TribofilmState]:
    """Contact under a load, settled with the tribofilm that decides on the friction, and the state of that after the step."""
    tried = state
    while True:
        mu = tribofilm.coefficient(tried)
        contact = load_step(scene, grid, load, start, counters, film, mu)
        whole = Window(0, 0, grid.nx, grid.ny)
        stress = _stress(scene, grid, load, contact, counters, film, mu, np.zeros(1), whole)[:, 0]
        strain = elastic_strain(stress, scene.body.young, scene.body.poisson)
        tested = tribofilm.tested(state, tried, strain, pressure=contact.pressure, sign=load.sign)
        if tested.film.failed is tried.film.failed:
            return contact, tested
        start, tried = contact.pressure, tested


def solve_elastic(
    scene: Scene, grid: CellGrid, counters: Counters, report: Progress
) -> tuple[list[Row], list[Snapshot]]:
    """History and states of a scene that stays elastic: unloading in one step, the last cycle stands for all.

    Where the sign of the traction changes, the cycles are mirror images: what the history holds of them is equal.
    """
    targets, rows, snapshots, previous = targets_of_cycle(scene, scene.loading.cycles), [], [], None
    steps, film = sum(target.rises for target in targets), _film_of(scene)
    tribofilm, mu = tribofilm_of(scene, grid), coefficient_on(scene, grid)
    state = tribofilm and tribofilm.fresh(np.zeros((4, grid.nx, grid.ny)))
    for k, target in enumerate(targets, start=1):
        if tribofilm is None or state is None:
            contact = load_step(scene, grid, target.load, previous, counters, film, mu)
        else:
            contact, state = settled_step(
                scene, grid, target.load, previous, counters, film, tribofilm, state
            )
            mu = tribofilm.coefficient(state)
        note = target.note if target.rises else UNLOADING
        numbers = contact.iterations, contact.residual
        attempts = (Attempt(True, contact.residuals, contact_tolerance(scene)),)
        rows.append(
            row_of(
                scene, grid, 1, target.step, target.load.force, contact, mu, *numbers, note, attempts=attempts
            )
        )
        previous = contact.pressure
        if target.rises:
            report("contact", k, steps)
        if target.snapshot:
            row = _row_of_cut(scene, grid, contact)
            stress, mises, in_row = stress_and_mises(
                scene, grid, target.load, contact, counters, film, mu, row
            )
            sliding = Sliding.elastic(scene, grid, target.load, contact, counters, film, mu)
            coated = _coated(film, grid, target.load, contact, counters) if film else None
            cut = _cut(grid, row, in_row) if in_row is not None else None
            snapshots.append(Snapshot.elastic(target.snapshot, contact, stress, mises, sliding, coated, cut))
            report("stress", 1, 1)
    first = list(rows)
    for cycle in range(2, scene.loading.cycles + 1):
        rows += [replace(row, cycle=cycle, iterations=0, note=CYCLE, attempts=()) for row in first]
    return [replace(row, friction=sign_of(scene, row.cycle) * row.friction) for row in rows], snapshots


def _row_of_cut(scene: Scene, grid: CellGrid, contact: Contact) -> int | None:
    """The row of cells through the largest pressure; None without contact, or where that is around the origin."""
    if not off_origin(scene):
        return None
    from sam.cut import row_of_largest

    return row_of_largest(contact, counted(contact, grid))


def _cut(grid: CellGrid, row: int, stress: np.ndarray) -> Cut:
    from sam.cut import elastic_cut

    return elastic_cut(grid, row, stress)


def tribofilm_of(scene: Scene, grid: CellGrid) -> Tribofilm | None:
    """The law of the tribofilm; None without one, then nothing of it is loaded."""
    if scene.friction is None or not scene.friction.film:
        return None
    from sam.tribofilm.law import FilmLaw
    from sam.tribofilm.state import FilmOnCells

    return FilmOnCells(FilmLaw.of(scene.friction), (grid.nx, grid.ny))


def _film_of(scene: Scene) -> Film | None:
    """The coated body, for all steps of a scene; None without coating, then nothing of it is loaded."""
    if scene.body.coating is None:
        return None
    from sam.coating import Film

    return Film(scene)


def _coated(film: Film, grid: CellGrid, load: Load, contact: Contact, counters: Counters) -> Coated:
    """The record of a coated state, under force with the bare body to compare with."""
    from sam.comparison import bare_body

    comparison = bare_body(film.scene, grid, load, contact, counters) if load.force else None
    return film.state(grid, load, contact, counters, comparison)


def depths_at_once(grid: CellGrid) -> int:
    """How many depths a block has: six spectra each, of complex numbers on a grid twice as long each way."""
    return int(max(1, BYTES_AT_ONCE // (6 * 16 * 2 * grid.nx * (grid.ny + 1))))


def largest_mises(
    stress_at: Callable[[np.ndarray, Window], np.ndarray], grid: CellGrid, window: Window, row: int | None
) -> tuple[np.ndarray, np.ndarray, np.ndarray | None]:
    """Stress in the rows of cells that touch y = 0, at each depth the largest von Mises stress in a window, stress in a row.

    stress_at: (depths, window) -> (6, nz, nx, ny) in Pa; called for blocks of depths, so that the memory is bounded.
    Returns (stress, largest, stress of the row or None), (6, nz, nx, rows), (nz, 1) and (6, nz, nx) in Pa.
    """
    block = depths_at_once(grid)
    rows, whole = grid.axis_rows.slices[1], Window(0, 0, grid.nx, grid.ny)
    largest, plane, cut = [], [], []
    for k in range(0, len(grid.depths), block):
        stress = stress_at(grid.depths[k : k + block], whole)
        largest.append(von_mises(stress[(..., *window.slices)]).max(axis=(-2, -1)))
        plane.append(stress[..., rows].copy())
        if row is not None:
            cut.append(stress[..., row].copy())
    in_row = np.concatenate(cut, axis=1) if cut else None
    return np.concatenate(plane, axis=1), np.concatenate(largest)[:, None], in_row
