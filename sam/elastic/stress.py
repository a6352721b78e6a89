# SPDX-License-Identifier: MIT
"""Stresses of an elastic state at the output depths (paper Eq. 7, first sum), how friction moves its surface,
and the onset of yield: whether the stress of the largest load yields anywhere.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sam.arrays import Array
from sam.contact.normal import Contact
from sam.contact.operators import moved_rows
from sam.contact.stress import stresses, von_mises, yielding
from sam.elastic.problem import ElasticProblem, Loaded, depths_at_once
from sam.grid.cells import Window
from sam.kernels.patches import Lags
from sam.results.history import counted
from sam.results.snapshots import Sliding
from sam.schedule import Load


def stress_at(state: Loaded, depths: Array, window: Window) -> Array:
    """Stress in a window of cells at some depths, (6, nz, nx, ny) in Pa."""
    problem, tractions = state.problem, {3: state.contact.pressure}
    if (traction := state.traction) is not None:
        tractions[1] = traction
    plan = problem.plan
    cell, nu = (plan.grid.hx, plan.grid.hy), plan.pair.body.poisson
    if plan.period is not None:
        return plan.period.stresses(tractions, cell, depths, window, nu=nu, counters=problem.counters)
    stress = stresses(
        tractions,
        (*cell, plan.grid.period),
        depths,
        window,
        nu=nu,
        layered=None if plan.coated is None else plan.coated.layered,
        counters=problem.counters,
    )
    if plan.misfit is None or not state.load.misfit:
        return stress
    (i, j), grid = window.slices, plan.grid
    at = grid.x[i, None], grid.y[j], np.asarray(depths)[:, None, None]
    return stress + state.load.misfit * plan.misfit.stress(*at)


def plane_stress(state: Loaded) -> Array:
    """Stress in the rows of cells that touch y = 0, (6, nz, nx, rows) in Pa."""
    grid = state.problem.plan.grid
    return stress_at(state, grid.depths, grid.axis_rows)


@dataclass(frozen=True)
class Stresses:
    """In Pa: in the rows at y = 0, (6, nz, nx, rows); von Mises, (nz, n); in another row, (6, nz, nx)."""

    plane: Array
    mises: Array
    in_row: Array | None = None


def stresses_of(state: Loaded, row: int | None = None) -> Stresses:
    """Stresses of a state, with the largest von Mises stress in the plane through the contact; on
    the whole grid, which takes eight to twenty times as long, under a rough body.
    """
    problem = state.problem
    if problem.plan.places.anywhere:
        return _stresses_anywhere(state, counted(state.contact, problem.plan.grid), row)
    plane, rows = plane_stress(state), problem.plan.grid.axis_rows
    if row is None:
        return Stresses(plane, _in_cells(plane))
    if rows.j0 <= row < rows.j0 + rows.ny:
        in_row = plane[..., row - rows.j0]
    else:
        in_row = stress_at(state, problem.plan.grid.depths, Window(0, row, problem.plan.grid.nx, 1))[..., 0]
    return Stresses(plane, _in_cells(in_row[..., None] if problem.plan.places.beside else plane), in_row)


def _in_cells(rows: Array) -> Array:
    """Von Mises stress of rows of cells, (nz, nx rows) in Pa, of their stress, (6, nz, nx, rows)."""
    return von_mises(rows).reshape(rows.shape[1], -1)


def _stresses_anywhere(state: Loaded, window: Window, row: int | None) -> Stresses:
    """The largest von Mises stress in a window of the grid, in blocks of depths, which bounds the memory."""
    grid = state.problem.plan.grid
    block, rows = depths_at_once(grid), grid.axis_rows.slices[1]
    largest, plane, cut = [], [], []
    for k in range(0, len(grid.depths), block):
        stress = stress_at(state, grid.depths[k : k + block], grid.whole)
        largest.append(von_mises(stress[(..., *window.slices)]).max(axis=(-2, -1)))
        plane.append(stress[..., rows].copy())
        if row is not None:
            cut.append(stress[..., row].copy())
    in_row = np.concatenate(cut, axis=1) if cut else None
    return Stresses(np.concatenate(plane, axis=1), np.concatenate(largest)[:, None], in_row)


def sliding_of(state: Loaded) -> Sliding | None:
    """What friction adds to an elastic state; None without friction, then nothing is computed."""
    problem, pressure, traction = state.problem, state.contact.pressure, state.traction
    if traction is None:
        return None
    grid, counters, coated = problem.plan.grid, problem.counters, problem.plan.coated
    zero = np.zeros(grid.axis_rows.shape)
    if not traction.any():
        return Sliding(traction, zero, zero, zero, zero)
    if coated is not None:  # u_z: the contact's less that of the counter-body, see `CoatedPair`

        def layered(nx: int, ny: int, *, component: int, load: int) -> Array:
            lags = Lags(nx, ny, grid.hx, grid.hy)
            return coated.layered.displacement(lags, component=component, load=load)

        ux = moved_rows(grid, pressure, layered, (1, 3), counters=counters)
        ux = ux + moved_rows(grid, traction, layered, (1, 1), counters=counters)
        return Sliding(traction, ux, zero, zero, zero)
    pair = problem.plan.pair
    bodies = problem.plan.bodies
    kernel = bodies.kernel(grid, pair.body.poisson)
    ux = grid.hx * moved_rows(grid, pressure, kernel, (1, 3), counters=counters) / pair.body.shear
    ux = ux + grid.hx * moved_rows(grid, traction, kernel, (1, 1), counters=counters) / pair.body.shear
    # nu = 0 leaves out the factor 1 - 2 nu of D_31, which is a difference where the contact has it
    extra = 0.0
    if problem.plan.slip.coupled and pair.other is not None:
        share = pair.body.compliance  # times E*: of the body in the displacement of both
        extra = pair.body.tangential_compliance - 2 * share * pair.tangential_mismatch
    uz = zero
    if extra:
        kernel = bodies.kernel(grid, 0.0)
        uz = extra * (grid.hx * moved_rows(grid, traction, kernel, (3, 1), counters=counters))
    return Sliding(traction, ux, zero, uz, zero)


@dataclass(frozen=True)
class ElasticPeak:
    """The contact at the largest load of an elastic body, and von Mises stress (nz, n) in Pa: in y
    = 0, of a rough one the largest; of a tribofilm with its high coefficient.
    """

    contact: Contact
    mises: Array


def elastic_peak(problem: ElasticProblem, load: Load) -> ElasticPeak | None:
    """The elastic state under the largest load; None without any."""
    if load.rests:
        return None
    high = problem.plan.slip.highest
    state = problem.state(load, problem.contact(load, high), high)
    if problem.plan.places.anywhere:
        return ElasticPeak(state.contact, stresses_of(state).mises)
    return ElasticPeak(state.contact, von_mises(plane_stress(state)).max(axis=-1))


def yields(peak: ElasticPeak | None, limit: Array) -> bool:
    """Whether the elastic stress at the peak exceeds the yield stress (nz,) in Pa anywhere. Paper Eq. 8."""
    return peak is not None and bool(yielding(peak.mises, limit[:, None]).any())
