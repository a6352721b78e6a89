# SPDX-License-Identifier: MIT
"""Elastic contact of a scene by the semi-analytical method: load steps, and stresses at the output depths."""

from __future__ import annotations

import time

import numpy as np

from sam.contact import Contact, no_contact, solve_contact
from sam.convolution import Counters
from sam.grid import CellGrid, choose_grid, contact_modulus, gap_of
from sam.record import cycles, fields, history, quantities, tables
from sam.scene import LeftOut, Result, Scene, Status
from sam.scene.result import Progress
from sam.stress import stresses

MODEL = "sam"
SCENE_TO_CONTACT_TOLERANCE = 1e-4  # the contact is solved to this share of solver.tolerance
FEWEST_CELLS = 3.0  # cells in the contact radius; with fewer the largest pressure is off by up to 4 %, from here on by 1 %


def left_out(scene: Scene) -> list[LeftOut]:
    """The stages that this scene does not need, with reasons."""
    out = [
        LeftOut("tangential kernels", "no [friction]"),
        LeftOut("volume grid", "no [body.plasticity]: stresses at the output depths only"),
        LeftOut("eigenstrain kernels", "no [body.plasticity]"),
        LeftOut("layered coefficients", "no [body.coating]"),
        LeftOut("worn geometry", "no [wear]"),
        LeftOut("stress outside the plane y = 0", "smooth, no friction: the largest von Mises stress lies in y = 0"),
    ]
    if scene.loading.unload:
        out.append(LeftOut("unloading steps", "elastic: unloading in one step is exact"))
    if scene.loading.cycles > 1:
        out.append(LeftOut("cycles after the first", "elastic: all cycles are equal"))
    return out


def _touches_edge(contact: Contact) -> bool:
    p = contact.pressure
    return bool(p[[0, -1], :].any() or p[:, [0, -1]].any())


def _status(steps: list[Contact], grid: CellGrid) -> Status:
    """All steps count for convergence, the peak for the fit of the grid."""
    if not all(contact.converged for contact in steps):
        return Status.NOT_CONVERGED
    peak = steps[-1]
    touching = peak.pressure > 0
    if not touching.any():
        return Status.CONVERGED
    if _touches_edge(peak):
        return Status.CONTACT_AT_GRID_EDGE
    if min(touching.any(axis=1).sum(), touching.any(axis=0).sum()) < 2 * FEWEST_CELLS:
        return Status.UNDER_RESOLVED
    return Status.CONVERGED


def load_steps(scene: Scene, grid: CellGrid, counters: Counters, report: Progress) -> list[Contact]:
    """Contact at equal force steps up to the peak, each started from the one before."""
    gap0, modulus, loading = gap_of(scene, grid), contact_modulus(scene), scene.loading
    tolerance = SCENE_TO_CONTACT_TOLERANCE * scene.solver.tolerance
    if loading.force == 0:
        return [no_contact(gap0)] * loading.steps
    steps: list[Contact] = []
    for k in range(1, loading.steps + 1):
        force = loading.force * k / loading.steps
        start = steps[-1].pressure if steps else None
        steps.append(
            solve_contact(gap0, grid.hx, grid.hy, modulus, force, start=start, tolerance=tolerance, counters=counters)
        )
        report("contact", k, loading.steps)
    return steps


def solve(scene: Scene, progress: Progress | None = None) -> Result:
    """Solve an elastic, frictionless, smooth scene. Paper Eq. 5, 7, 9 and 10.

    Returns a Result; its status says whether it may be used. Raises nothing for a scene that was validated.
    """
    began = time.perf_counter()
    report = progress or (lambda *_: None)
    counters = Counters()
    grid = choose_grid(scene)
    ready = time.perf_counter()
    steps = load_steps(scene, grid, counters, report)
    peak = steps[-1]
    stress = stresses({3: peak.pressure}, grid.hx, grid.hy, grid.depths, scene.body.poisson, grid.axis_rows, counters)
    report("stress", 1, 1)
    done = time.perf_counter()
    status = _status(steps, grid)
    record = {"history": history(scene, steps, grid)} | tables(scene, grid, peak, stress)
    if scene.loading.cycles > 1:
        record["cycles"] = cycles(scene, peak)
    return Result(
        model=MODEL,
        status=status,
        quantities=quantities(scene, grid, peak, stress),
        tables=record,
        fields=fields(grid, peak, stress),
        left_out=left_out(scene),
        discretisation=_discretisation(grid, peak),
        certificate=_certificate(peak),
        cost=_cost(counters, ready - began, done - ready),
        message=status.advice,
    )


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


def _cost(counters: Counters, setup: float, solve: float) -> dict[str, float | int]:
    return {
        "setup_s": setup,
        "solve_s": solve,
        "contact_iterations": counters.contact_iterations,
        "plastic_iterations": 0,
        "operator_applications": 0,
        "displacement_applications": counters.displacement_applications,
        "ffts": counters.ffts,
        "step_cuts": 0,
    }
