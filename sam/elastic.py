# SPDX-License-Identifier: MIT
"""Elastic contact of a scene: load steps, and stresses at the output depths. Paper Eq. 5, 7, 9 and 10."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from sam.contact import Contact, no_contact, solve_contact
from sam.convolution import Counters
from sam.grid import CellGrid, contact_modulus, gap_of
from sam.record import Row, Snapshot
from sam.scene import Scene
from sam.scene.result import Progress
from sam.stress import stresses

SCENE_TO_CONTACT_TOLERANCE = 1e-4  # the contact is solved to this share of solver.tolerance
UNLOADING = "elastic: unloading in one step"
CYCLE = "elastic: equal to cycle 1"


def load_step(scene: Scene, grid: CellGrid, force: float, start: np.ndarray | None, counters: Counters) -> Contact:
    """Contact of the elastic bodies under `force`; start: pressure of the step before."""
    gap0 = gap_of(scene, grid)
    if force == 0:
        return no_contact(gap0)
    tolerance = SCENE_TO_CONTACT_TOLERANCE * scene.solver.tolerance
    modulus = contact_modulus(scene)
    return solve_contact(gap0, grid.hx, grid.hy, modulus, force, start=start, tolerance=tolerance, counters=counters)


def plane_stress(scene: Scene, grid: CellGrid, contact: Contact, counters: Counters) -> np.ndarray:
    """Stress in the rows that touch y = 0, (6, nz, nx, rows) in Pa."""
    tractions, nu = {3: contact.pressure}, scene.body.poisson
    return stresses(tractions, grid.hx, grid.hy, grid.depths, nu, grid.axis_rows, counters)


def solve_elastic(
    scene: Scene, grid: CellGrid, counters: Counters, report: Progress
) -> tuple[list[Row], list[Snapshot]]:
    """History and states of a scene that stays elastic: unloading in one step, later cycles equal to the first."""
    loading, rows, previous = scene.loading, [], None
    for k in range(1, loading.steps + 1):
        force = loading.force * k / loading.steps
        contact = load_step(scene, grid, force, previous, counters)
        rows.append(Row(1, k, force, contact, 0.0, contact.iterations, contact.residual))
        previous = contact.pressure
        report("contact", k, loading.steps)
    snapshots = [Snapshot.elastic("peak", contact, plane_stress(scene, grid, contact, counters))]
    report("stress", 1, 1)
    if loading.unload:
        empty = no_contact(gap_of(scene, grid))
        rows.append(Row(1, loading.steps + 1, 0.0, empty, note=UNLOADING))
        snapshots.append(Snapshot.elastic("unloaded", empty, np.zeros_like(snapshots[0].stress)))
    first = list(rows)
    for cycle in range(2, loading.cycles + 1):
        rows += [replace(row, cycle=cycle, iterations=0, note=CYCLE) for row in first]
    return rows, snapshots
