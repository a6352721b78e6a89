# SPDX-License-Identifier: MIT
"""Elastic contact of a scene: load steps, and stresses at the output depths. Paper Eq. 5, 7, 9 and 10."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from sam.contact import Contact, Grid, no_contact, solve_contact
from sam.convolution import Counters
from sam.grid import CellGrid, contact_modulus, coupling_of, gap_of
from sam.loading import Load, given_contact, given_pressure, sign_of, targets_of_cycle
from sam.record import Row, Snapshot
from sam.scene import Scene
from sam.scene.result import Progress
from sam.sliding import Sliding
from sam.stress import stresses

SCENE_TO_CONTACT_TOLERANCE = 1e-4  # the contact is solved to this share of solver.tolerance
UNLOADING = "elastic: unloading in one step"
CYCLE = "elastic: equal to cycle 1"


def load_step(scene: Scene, grid: CellGrid, load: Load, start: np.ndarray | None, counters: Counters) -> Contact:
    """Contact of the elastic bodies under a load, or the pressure that the scene gives; start: that of the step before."""
    gap0, modulus = gap_of(scene, grid), contact_modulus(scene)
    if load.force == 0:
        return no_contact(gap0)
    coupling = load.sign * coupling_of(scene)
    if scene.loading.prescribed:
        surface = Grid(gap0.shape, grid.hy / grid.hx, counters, coupling)
        pressure = given_pressure(scene, load, grid.x, grid.y, grid.hx, grid.hy)
        u = surface.displacement(pressure * (2 / modulus), surface.whole, surface.whole) * grid.hx
        return given_contact(scene, load, pressure, u, grid.hx * grid.hy)
    tolerance = SCENE_TO_CONTACT_TOLERANCE * scene.solver.tolerance
    return solve_contact(
        gap0, grid.hx, grid.hy, modulus, load.force, coupling=coupling, start=start, tolerance=tolerance,
        counters=counters,
    )  # fmt: skip


def plane_stress(scene: Scene, grid: CellGrid, load: Load, contact: Contact, counters: Counters) -> np.ndarray:
    """Stress in the rows that touch y = 0, (6, nz, nx, rows) in Pa."""
    tractions, nu = {3: contact.pressure}, scene.body.poisson
    if scene.coefficient:
        tractions[1] = load.sign * scene.coefficient * contact.pressure
    return stresses(tractions, grid.hx, grid.hy, grid.depths, nu, grid.axis_rows, counters)


def solve_elastic(
    scene: Scene, grid: CellGrid, counters: Counters, report: Progress
) -> tuple[list[Row], list[Snapshot]]:
    """History and states of a scene that stays elastic: unloading in one step, the last cycle stands for all.

    Where the sign of the traction changes, the cycles are mirror images: what the history holds of them is equal.
    """
    targets, rows, snapshots, previous = targets_of_cycle(scene, scene.loading.cycles), [], [], None
    steps = sum(target.rises for target in targets)
    for k, target in enumerate(targets, start=1):
        contact = load_step(scene, grid, target.load, previous, counters)
        note = target.note if target.rises else UNLOADING
        rows.append(Row(1, target.step, target.load.force, contact, 0.0, contact.iterations, contact.residual, note))
        previous = contact.pressure
        if target.rises:
            report("contact", k, steps)
        if target.snapshot:
            stress = plane_stress(scene, grid, target.load, contact, counters)
            sliding = Sliding.elastic(scene, grid, target.load, contact, counters)
            snapshots.append(Snapshot.elastic(target.snapshot, contact, stress, sliding))
            report("stress", 1, 1)
    first = list(rows)
    for cycle in range(2, scene.loading.cycles + 1):
        rows += [replace(row, cycle=cycle, iterations=0, note=CYCLE) for row in first]
    return [replace(row, friction=_friction(scene, row)) for row in rows], snapshots


def _friction(scene: Scene, row: Row) -> float:
    """Sum of q over sum of p in a row of the history; zero without force."""
    return sign_of(scene, row.cycle) * scene.coefficient if row.force else 0.0
