# SPDX-License-Identifier: MIT
"""Stresses of an elastic state at the output depths, and where the largest of them is looked for. Paper Eq.
7, first sum.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sam.arrays import Array
from sam.contact.stress import stresses, von_mises
from sam.elastic.problem import Loaded
from sam.grid.cells import CellGrid, Window
from sam.results.history import counted

BYTES_AT_ONCE = 2e8  # of the spectra of a block of depths, which bounds the memory


def stress_at(state: Loaded, depths: Array, window: Window) -> Array:
    """Stress in a window of cells at some depths, (6, nz, nx, ny) in Pa."""
    problem, tractions = state.problem, {3: state.contact.pressure}
    if (traction := state.traction) is not None:
        tractions[1] = traction
    found = stresses(
        tractions,
        (problem.grid.hx, problem.grid.hy),
        depths,
        window,
        nu=problem.pair.body.poisson,
        layered=None if problem.coated is None else problem.coated.layered,
        counters=problem.counters,
    )
    if problem.misfit is None or not state.load.misfit:
        return found
    (i, j), grid = window.slices, problem.grid
    at = grid.x[i, None], grid.y[j], np.asarray(depths)[:, None, None]
    return found + state.load.misfit * problem.misfit.stress(*at)


def plane_stress(state: Loaded) -> Array:
    """Stress in the rows of cells that touch y = 0, (6, nz, nx, rows) in Pa."""
    grid = state.problem.grid
    return stress_at(state, grid.depths, grid.axis_rows)


@dataclass(frozen=True)
class Stresses:
    """Stresses of a state.

    plane: in the rows that touch y = 0, (6, nz, nx, rows) in Pa; mises: the von Mises stress among which the
    largest is, (nz, n) in Pa; in_row: in another row of cells, (6, nz, nx) in Pa, None if none is asked for.
    """

    plane: Array
    mises: Array
    in_row: Array | None = None


def stresses_of(state: Loaded, row: int | None = None) -> Stresses:
    """Stresses of a state, also in a row of cells.

    The largest von Mises stress is looked for in the rows at y = 0, n = nx rows, or in the row if the load
    ends beside it; under a rough body on the whole grid, n = 1. Without friction it lies below the middle
    of the contact, with friction in the plane along x through it: the other cells of the grid would take
    eight to twenty times as long.
    """
    problem = state.problem
    if problem.looked.anywhere:
        return _stresses_anywhere(state, counted(state.contact, problem.grid), row)
    plane, rows = plane_stress(state), problem.grid.axis_rows
    if row is None:
        return Stresses(plane, _in_cells(plane))
    if rows.j0 <= row < rows.j0 + rows.ny:
        in_row = plane[..., row - rows.j0]
    else:
        in_row = stress_at(state, problem.grid.depths, Window(0, row, problem.grid.nx, 1))[..., 0]
    return Stresses(plane, _in_cells(in_row[..., None] if problem.looked.beside else plane), in_row)


def _in_cells(rows: Array) -> Array:
    """Von Mises stress of rows of cells, (nz, nx rows) in Pa, of their stress, (6, nz, nx, rows)."""
    found: Array = von_mises(rows).reshape(rows.shape[1], -1)
    return found


def depths_at_once(grid: CellGrid) -> int:
    """How many depths a block has: six spectra each, of complex numbers on a grid twice as long each way."""
    return int(max(1, BYTES_AT_ONCE // (6 * 16 * 2 * grid.nx * (grid.ny + 1))))


def _stresses_anywhere(state: Loaded, window: Window, row: int | None) -> Stresses:
    """The largest von Mises stress in a window of the grid, for blocks of depths, so that the memory is
    bounded.
    """
    grid = state.problem.grid
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
