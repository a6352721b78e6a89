# SPDX-License-Identifier: MIT
"""What is recorded of a load history: contacts, states and cycles, measured on the records that the steps
make.

Nothing here changes a step. Fields outside of the box are computed once for a strain, and kept in the record.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from sam.arrays import Array, Mask
from sam.contact.normal import Contact, Found, Units, around, measured, no_contact
from sam.contact.stress import von_mises
from sam.elastic.sliding import sliding_of
from sam.elastic.stress import plane_stress
from sam.grid.cells import Window
from sam.plasticity.model import Model
from sam.plasticity.outside import Strained, residual_stress, surface_displacement
from sam.plasticity.pointwise import at_centres, largest
from sam.plasticity.pressure import ContactPressure
from sam.plasticity.progress import Outside, Progressed
from sam.plasticity.state import Extent, Trial
from sam.plasticity.step import Problem
from sam.results.history import CycleEnd, CycleStrain, Moved, PassEnd, counted
from sam.results.snapshots import Box, Cut, Snapshot, row_of_largest
from sam.scene.result import BACK_STRESS, unfinished
from sam.schedule import Load

if TYPE_CHECKING:
    from sam.moving.track import Track

ROUNDING = 1e-9  # of a pressure: the transforms of another window round differently


def problem_now(model: Model, now: Progressed) -> Problem:
    """The problem of a step from a record."""
    return model.problem(now.extent, now.tribofilm, now.wear)


def contact_in_box(model: Model, now: Progressed, trial: Trial) -> Contact:
    """The contact of a step in its box, with the residuals measured there."""
    load, p = trial.load, trial.pressure
    gap = model.gap(load, now.wear)[now.extent.window.slices] + trial.residual.displacement
    if load.force == 0:
        return no_contact(gap, load.given)  # the row of a step asks for no displacement
    source = problem_now(model, now).pressure
    if not isinstance(source, ContactPressure):
        return _given(model, load, p, np.zeros_like(p))
    return _measured(model, source, load, gap, p=p, u=source.contact.displacement(p, load.sign))


def contact_on_grid(model: Model, now: Progressed, trial: Trial) -> Contact:
    """The contact on the full grid, its residuals measured there: pile-up outside the box counts.

    Where the displacement by plastic strain, a sum over the steps in single precision, misses the one of the
    full grid by more than the contact may, the pressure is found once more on that.
    """
    window, load, moved = now.extent.window, trial.load, known_outside(now).displacement
    gap = model.gap(load, now.wear) + moved
    if load.force == 0:
        return model.elastic.untouched(load, gap)
    source = problem_now(model, now).pressure
    if not isinstance(source, ContactPressure):
        return _given(model, load, *_on_grid(model, window, trial.pressure, load.sign))
    p, u = _on_grid(model, window, trial.pressure, load.sign)
    found = _measured(model, source, load, gap, p=p, u=u)
    if found.converged:
        return found
    goal = model.contact_share * model.tolerance
    p, u = _on_grid(model, window, source(moved[window.slices], load, trial.pressure, goal), load.sign)
    again = _measured(model, source, load, gap, p=p, u=u)
    return again if again.converged else found


def _on_grid(model: Model, window: Window, pressure: Array, sign: float) -> tuple[Array, Array]:
    """p_hat and u_hat on the full grid of p_hat in a window."""
    surface = model.surface
    p = np.zeros(surface.shape)
    p[window.slices] = pressure
    return p, surface.displacement(pressure, window, surface.whole, sign)


def _given(model: Model, load: Load, p: Array, u: Array) -> Contact:
    given = model.elastic.given
    if given is None:
        raise ValueError("the pressure is not given")
    return given.contact(model.grid, load, p * model.unit, u * model.grid.hx)


def _measured(
    model: Model, source: ContactPressure, load: Load, gap: Array, *, p: Array, u: Array
) -> Contact:
    """The contact of p_hat and u_hat, on the box or on the grid."""
    grid, tolerance = model.grid, model.contact_share * model.tolerance + ROUNDING
    units, fields = Units(grid.hx, grid.hy, 2 * model.unit), Found(p, u, around(p > 0))
    found = measured(model.surface, gap, fields, units, given=load.given, tolerance=tolerance)
    if found.converged:
        return found
    words = unfinished("the contact iteration of a load step", source.contact.residuals, tolerance)
    return replace(found, ending=words)


def with_outside(model: Model, now: Progressed, *, stress: bool = False) -> Progressed:
    """The record with the fields of its plastic strain outside of the box; stress: also that."""
    known = now.outside
    if known is None:
        whole = Window(0, 0, model.grid.nx, model.grid.ny)
        inside = now.state.residual.displacement
        known = Outside(inside if now.extent.window == whole else _moved(model, now, 3, whole))
    if stress and known.stress is None:
        known = replace(known, stress=_residual_stress(model, now))
    return now if known is now.outside else replace(now, outside=known)


def known_outside(now: Progressed) -> Outside:
    """The fields outside of the box; ValueError for a record without them, see `with_outside`."""
    if now.outside is None:
        raise ValueError("the record has no fields outside of its box")
    return now.outside


def _residual_stress(model: Model, now: Progressed) -> Array:
    """Stress of the plastic strain in the rows that touch y = 0, at all depths.

    Where the box covers the rows its own stresses are taken, see `snapshot`: zero there.
    """
    grid, window, rows = model.grid, now.extent.window, model.grid.axis_rows
    across = window.j0 <= rows.j0 and rows.j0 + rows.ny <= window.j0 + window.ny
    covered = now.extent.layers if across and window.nx == grid.nx else 0
    below = residual_stress(_strained(model, now), grid.depths[covered:], rows, mu=model.body.mu)
    return np.concatenate([np.zeros((6, covered, *below.shape[2:])), below], axis=1)


def _strained(model: Model, now: Progressed) -> Strained:
    """The plastic strain in its box."""
    return Strained(now.state.material.strain, now.extent.window, model.cuboids(now.extent))


def _moved(model: Model, now: Progressed, component: int, observed: Window) -> Array:
    """Displacement of a window of the surface by the plastic strain, (nx, ny) in m."""
    source, counters = _strained(model, now), model.counters
    return surface_displacement(source, observed, counters=counters, component=component)


def start_of(model: Model, now: Progressed, load: Load) -> Array | None:
    """p_hat to start a step from: of the same load in the cycle before, or moved with the counter-body; None:
    that of the state.
    """
    if model.track is None:
        return now.recall(load)
    return model.track.carried(model.grid, now.state.pressure, now.state.load, load)


def moved(model: Model, now: Progressed, trial: Trial) -> Moved | None:
    """What a step says of the motion of the counter-body; None of one in place."""
    if model.track is None:
        return None
    pressure, window = trial.pressure * model.unit, now.extent.window
    traction = trial.load.sign * problem_now(model, now).coefficient
    return model.track.moved(model.grid, trial.load, pressure, window=window, traction=traction)


def pass_end(model: Model, now: Progressed, track: Track, cycle: int) -> PassEnd:
    """What a pass over a path leaves; the record has the fields outside of the box."""
    start, uz = now.cycle_start, known_outside(now).displacement
    added = now.state.material.peeq if start is None else start.new_strain(now.state, now.extent)
    rows = now.measured.rows
    return track.pass_end(model.grid, cycle, uz=uz, added=added, window=now.extent.window, rows=rows)


def snapshot(model: Model, now: Progressed, name: str, trial: Trial) -> Snapshot:
    """Stress and strain in the plane y = 0: of the cells in the box, and at the cell centres outside it.

    The record has the fields outside of the box, see `with_outside`.
    """
    outside, material, rows = known_outside(now), now.state.material, model.grid.axis_rows
    extent = now.extent
    contact, mu = contact_on_grid(model, now, trial), model.coefficient(now.tribofilm)
    loaded = model.elastic.state(trial.load, contact, mu)
    stress = plane_stress(loaded)
    if outside.stress is not None:
        stress = stress + outside.stress
    stress = _filled(model, extent, stress, trial.stress)
    strain = _filled(model, extent, np.zeros_like(stress), material.strain)
    peeq = _filled(model, extent, np.zeros_like(stress[0]), material.peeq)
    sliding = sliding_of(loaded)
    if sliding is not None:
        sliding = sliding.strained(_moved(model, now, 1, rows), strain, np.diff(model.grid.layer_faces))
    back = model.material(extent).back_stress(now.state.points)
    kept = {} if back is None else {BACK_STRESS: back.mean(axis=1)}
    mises, flowed = _largest(model, now, trial, contact, plane=stress)
    return Snapshot(
        name,
        contact,
        outside.displacement,
        stress,
        strain,
        peeq,
        mises,
        flowed,
        sliding,
        top=_top(model, now),
        worn=None if now.wear is None else now.wear.depth,
        cut=_cut(model, now, trial, contact),
        box=replace(_box(model, now, trial), repeated=kept),
        stretch=trial.load.stretch,
        place=(trial.load.x, trial.load.y),
        repeated={
            each: _filled(model, extent, np.zeros_like(stress), values) for each, values in kept.items()
        },
    )


def with_last_period(model: Model, now: Progressed, state: Snapshot) -> Snapshot:
    """A snapshot with the fields of the last period of the history, also if it is of an earlier state."""
    fields, box = now.periods.fields(model, now.state, now.extent), state.box
    if box is None or not fields:
        return state
    own, (layers, nx, ny) = now.extent.window, box.peeq.shape
    i, j = (
        round(float(side[0] - lines[first]) / step + 0.5)
        for side, lines, first, step in (
            (box.x, model.grid.x, own.i0, model.grid.hx),
            (box.y, model.grid.y, own.j0, model.grid.hy),
        )
    )
    cells = {name: values[:layers, i : i + nx, j : j + ny] for name, values in fields.items()}
    plane = {
        name: _filled(model, now.extent, np.zeros_like(state.peeq), values) for name, values in fields.items()
    }
    plane["class"] = np.broadcast_to(plane["class"].max(axis=-1, keepdims=True), state.peeq.shape)
    box = replace(box, repeated={**box.repeated, **cells})
    return replace(state, box=box, repeated={**state.repeated, **plane})


def _filled(model: Model, extent: Extent, plane: Array, field: Array) -> Array:
    """A field in the rows that touch y = 0, (..., nz, nx, rows), with the values of the cells of a box."""
    rows, window = model.grid.axis_rows, extent.window
    inside = slice(window.i0, window.i0 + window.nx)
    for row, j in enumerate(range(rows.j0 - window.j0, rows.j0 - window.j0 + rows.ny)):
        if 0 <= j < window.ny:
            plane[..., : extent.layers, inside, row] = field[..., j]
    return plane


def _box(model: Model, now: Progressed, trial: Trial) -> Box:
    """The cells of the box."""
    grid, window, material = model.grid, now.extent.window, now.state.material
    x = (grid.x[window.i0] - grid.hx / 2) + grid.hx * np.arange(window.nx + 1)
    y = (grid.y[window.j0] - grid.hy / 2) + grid.hy * np.arange(window.ny + 1)
    return Box(x, y, model.faces(now.extent), trial.stress, material.strain, material.peeq)


def _cut(model: Model, now: Progressed, trial: Trial, contact: Contact) -> Cut | None:
    """The cells of the box in the row of the largest pressure; None without contact, or where that is around
    the origin.
    """
    if not model.elastic.looked.off_origin or trial.load.force == 0:
        return None
    window, layers, grid = now.extent.window, now.extent.layers, model.grid
    row = row_of_largest(contact, counted(contact, grid))
    if row is None or not window.j0 <= row < window.j0 + window.ny:
        return None
    x, j = grid.x[window.i0 : window.i0 + window.nx], row - window.j0
    stress, peeq = trial.stress[..., j].copy(), now.state.material.peeq[..., j].copy()
    return Cut(float(grid.y[row]), x, grid.depths[:layers], stress, peeq)


def _top(model: Model, now: Progressed) -> tuple[float, float] | None:
    """Depth in m and value of the largest plastic strain; cells hold means."""
    peeq, depths = now.state.material.peeq, model.grid.depths[: now.extent.layers]
    if not peeq.any():
        return None
    interval = model.body.strength.kinks.interval(depths)
    return largest(at_centres(peeq, model.faces(now.extent), interval), depths, interval)


def _largest(
    model: Model, now: Progressed, trial: Trial, contact: Contact, *, plane: Array
) -> tuple[Array, Mask]:
    """The largest von Mises stress at each depth in Pa, and whether its cell has plastic strain, both (nz,
    1): of all cells of the box, below it of those in y = 0.
    """
    window, layers = counted(contact, model.grid).slices, trial.stress.shape[1]
    mises = von_mises(plane).max(axis=(-2, -1))
    flowed = np.zeros(mises.shape, dtype=bool)
    inside = von_mises(trial.stress)[(..., *window)].reshape(layers, -1)
    at = np.arange(layers), inside.argmax(axis=1)
    mises[:layers] = inside[at]
    flowed[:layers] = now.state.material.peeq[(..., *window)].reshape(layers, -1)[at] > 0
    return mises[:, None], flowed[:, None]


def strained_in_cycle(now: Progressed) -> CycleStrain:
    """What the cycle has strained so far, before anything is removed; nothing where there is one cycle."""
    if now.cycle_start is None:
        return CycleStrain()
    added = now.cycle_start.new_strain(now.state, now.extent)
    return CycleStrain(float(added.max()), int(np.count_nonzero(added > 0)))


def dissipated_by(model: Model, now: Progressed, trial: Trial) -> float:
    """The energy in J that a step from a record dissipates; 0 where nobody asks for it."""
    if not (model.dissipates and trial.plastic):
        return 0.0
    flow = model.material(now.extent).flow(now.state.points)
    return float((model.volumes(now.extent) * flow.dissipated(trial.points).mean(axis=0)).sum())


def cycle_end(model: Model, now: Progressed, cycle: int, strained: CycleStrain) -> CycleEnd:
    """The surface at the end of a cycle, and how much is worn so far; the record has the fields outside of
    the box.
    """
    moved, roughness = known_outside(now).displacement, model.roughness
    worn = now.wear.depth if now.wear is not None else None
    lowered = moved if worn is None else moved + worn
    volume = now.wear.volume if now.wear is not None else 0.0
    found = roughness(lowered) if roughness is not None else None
    work, spent = model.counters.operator_applications, now.dissipated
    end = CycleEnd(cycle, volume, found, work, strained=strained, dissipated=spent)
    if model.wear is None or now.wear is None:
        return end
    margin = model.wear.margin(now.state.material.peeq, model.faces(now.extent))
    worn_now, roofed = 0.0, 0.0
    if len(now.wear.volumes) == cycle:
        worn_now, roofed = now.wear.volumes[-1], now.wear.roofed_volumes[-1]
    return replace(end, moved=moved, worn=worn, margin=margin, wear_of_cycle=worn_now, roofed=roofed)
