# SPDX-License-Identifier: MIT
"""Elastic contact of a scene: load steps, and stresses at the output depths. Paper Eq. 5, 7, 9 and 10."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from sam.bodies import HALF_SPACES
from sam.contact import Contact, Grid, no_contact, solve_contact
from sam.convolution import Counters, Window
from sam.grid import CellGrid, contact_modulus, coupling_of, gap_of
from sam.loading import Load, given_contact, given_pressure, sign_of, targets_of_cycle
from sam.record import Row, Snapshot, counted
from sam.scene import Scene
from sam.scene.result import Progress
from sam.sliding import Sliding
from sam.stress import stresses, von_mises

if TYPE_CHECKING:
    from sam.coating import Coated, Film

SCENE_TO_CONTACT_TOLERANCE = 1e-4  # the contact is solved to this share of solver.tolerance
UNLOADING = "elastic: unloading in one step"
CYCLE = "elastic: equal to cycle 1"


def load_step(
    scene: Scene, grid: CellGrid, load: Load, start: np.ndarray | None, counters: Counters, film: Film | None = None
) -> Contact:
    """Contact of the elastic bodies under a load, or the pressure that the scene gives.

    start: pressure of the step before; film: of a coated scene.
    """
    gap0, modulus = gap_of(scene, grid), contact_modulus(scene)
    if load.force == 0:
        return no_contact(gap0)
    coupling, bodies = load.sign * coupling_of(scene), film.bodies(grid) if film else HALF_SPACES
    if scene.loading.prescribed:
        surface = Grid(gap0.shape, grid.hy / grid.hx, counters, coupling, bodies)
        pressure = given_pressure(scene, load, grid.x, grid.y, grid.hx, grid.hy)
        u = surface.displacement(pressure * (2 / modulus), surface.whole, surface.whole) * grid.hx
        return given_contact(scene, load, pressure, u, grid.hx * grid.hy)
    tolerance = SCENE_TO_CONTACT_TOLERANCE * scene.solver.tolerance
    return solve_contact(
        gap0, grid.hx, grid.hy, modulus, load.force, coupling=coupling, bodies=bodies, start=start,
        tolerance=tolerance, counters=counters,
    )  # fmt: skip


def plane_stress(
    scene: Scene, grid: CellGrid, load: Load, contact: Contact, counters: Counters, film: Film | None = None
) -> np.ndarray:
    """Stress in the rows that touch y = 0, (6, nz, nx, rows) in Pa; film: of a coated scene."""
    return _stress(scene, grid, load, contact, counters, film, grid.depths, grid.axis_rows)


def stress_and_mises(
    scene: Scene, grid: CellGrid, load: Load, contact: Contact, counters: Counters, film: Film | None = None
) -> tuple[np.ndarray, np.ndarray]:
    """`plane_stress`, and the von Mises stress among which the largest is, (nz, n) in Pa.

    Under a smooth body in the plane y = 0, n = nx; under a rough one the largest of the whole grid, n = 1.
    """
    if scene.surface is None:
        stress = plane_stress(scene, grid, load, contact, counters, film)
        return stress, von_mises(stress.mean(axis=-1))
    from sam.rough import largest_mises

    def stress_at(depths: np.ndarray, window: Window) -> np.ndarray:
        return _stress(scene, grid, load, contact, counters, film, depths, window)

    return largest_mises(stress_at, grid, counted(contact, grid))


def _stress(
    scene: Scene, grid: CellGrid, load: Load, contact: Contact, counters: Counters, film: Film | None, depths, window
) -> np.ndarray:
    """Stress in a window of cells at some depths, (6, nz, nx, ny) in Pa."""
    tractions, nu = {3: contact.pressure}, scene.body.poisson
    if scene.coefficient:
        tractions[1] = load.sign * scene.coefficient * contact.pressure
    layered = film.layered if film else None
    return stresses(tractions, grid.hx, grid.hy, depths, nu, window, counters, layered)


def solve_elastic(
    scene: Scene, grid: CellGrid, counters: Counters, report: Progress
) -> tuple[list[Row], list[Snapshot]]:
    """History and states of a scene that stays elastic: unloading in one step, the last cycle stands for all.

    Where the sign of the traction changes, the cycles are mirror images: what the history holds of them is equal.
    """
    targets, rows, snapshots, previous = targets_of_cycle(scene, scene.loading.cycles), [], [], None
    steps, film = sum(target.rises for target in targets), _film_of(scene)
    for k, target in enumerate(targets, start=1):
        contact = load_step(scene, grid, target.load, previous, counters, film)
        note = target.note if target.rises else UNLOADING
        rows.append(Row(1, target.step, target.load.force, contact, 0.0, contact.iterations, contact.residual, note))
        previous = contact.pressure
        if target.rises:
            report("contact", k, steps)
        if target.snapshot:
            stress, mises = stress_and_mises(scene, grid, target.load, contact, counters, film)
            sliding = Sliding.elastic(scene, grid, target.load, contact, counters, film)
            coated = _coated(film, grid, target.load, contact, counters) if film else None
            snapshots.append(Snapshot.elastic(target.snapshot, contact, stress, mises, sliding, coated))
            report("stress", 1, 1)
    first = list(rows)
    for cycle in range(2, scene.loading.cycles + 1):
        rows += [replace(row, cycle=cycle, iterations=0, note=CYCLE) for row in first]
    return [replace(row, friction=_friction(scene, row)) for row in rows], snapshots


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


def _friction(scene: Scene, row: Row) -> float:
    """Sum of q over sum of p in a row of the history; zero without force."""
    return sign_of(scene, row.cycle) * scene.coefficient if row.force else 0.0
