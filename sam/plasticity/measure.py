# SPDX-License-Identifier: MIT
"""What is recorded of a load history: contacts, states and cycles, measured on the records that the steps
make.

Nothing here changes a step. Fields outside of the box are computed once for a strain, and kept in the record.

The plastic strain of a cell stands for its mean over the cell. Where it is smooth the value at the centre is
the mean less h^2/24 times the second derivative in each direction, to fourth order, and the largest value
lies between centres. It is not smooth where the yield stress has a kink over depth: just there a soft layer
strains most, and a curve across it overshoots. Three points do not do: where the maximum lies between two
layers, a parabola through the higher one and its neighbours is up to .5 % too high.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from sam.arrays import ROUNDING, Array, Mask
from sam.contact.convolution import FEW_ROWS, Convolution, Counters, row_sums
from sam.contact.normal import Contact, Solved, Units, around, measured, no_contact
from sam.contact.operators import von_mises
from sam.elastic.problem import plane_stress, sliding_of
from sam.grid.cells import Window
from sam.kernels.eigenstrain import surface_displacement_coefficients
from sam.kernels.layer_stress import residual_stress_coefficients
from sam.kernels.patches import ODD_X, ODD_Y, STRESS, Cuboids, Lags, parity
from sam.plasticity.box import ExpectedBox
from sam.plasticity.load_step import ContactPressure, PressureSource, Problem
from sam.plasticity.model import Model, Outside, Progressed
from sam.plasticity.spectra import spectra_of
from sam.plasticity.state import Extent, Trial, filled, surrounded
from sam.results.history import Box, Cut, CycleEnd, LoopRow, Snapshot, counted, row_of_largest
from sam.scene.result import BACK_STRESS, unfinished
from sam.scene.section import stated
from sam.scene.verdict import last_period, loop_places
from sam.schedule import Load, Target


def problem_of(model: Model, record: Progressed) -> Problem:
    """The problem of a step from a record."""
    return model.problem(record.extent, record.tribofilm, record.wear)


def contact_in_box(model: Model, record: Progressed, trial: Trial) -> Contact:
    """The contact of a step in its box, with the residuals measured there."""
    load, p, source = trial.load, trial.pressure, problem_of(model, record).pressure
    gap = model.worn_gap(load, record.wear)[record.extent.window.slices] + trial.residual.displacement
    if load.force == 0:
        return no_contact(gap, load.given)  # the row of a step asks for no displacement
    u = source.contact.displacement(p, load.sign) if isinstance(source, ContactPressure) else np.zeros_like(p)
    return _contact(model, source, load, gap, p=p, u=u)


def contact_on_grid(model: Model, record: Progressed, trial: Trial) -> Contact:
    """The contact on the full grid, found once more where single precision left it too far."""
    window, load, moved = record.extent.window, trial.load, stated(record.outside).displacement
    gap, source = model.worn_gap(load, record.wear) + moved, problem_of(model, record).pressure
    if load.force == 0:
        return model.untouched(load, gap)
    surface = stated(model.built.surface)

    def of(pressure: Array) -> Contact:
        p = np.zeros(surface.shape)
        p[window.slices] = pressure
        u = surface.displacement(pressure, window, surface.whole, load.sign)
        return _contact(model, source, load, gap, p=p, u=u)

    contact = of(trial.pressure)
    if contact.converged:
        return contact
    again = of(source(moved[window.slices], load, trial.pressure, model.contact_tolerance))
    return again if again.converged else contact


def penetrated(model: Model, record: Progressed, trial: Trial) -> Mask:
    """The cells of the grid, outside of the box, that the counter-body penetrates at the end of a
    step, (nx, ny); the record is that after it, with the fields outside.
    """
    contact = contact_on_grid(model, record, trial)
    least = 2 * model.contact_tolerance * contact.compliance * contact.pressure.max()
    outside = np.asarray(contact.gap < -least)
    outside[record.extent.window.slices] = False
    return outside


def _contact(model: Model, source: PressureSource, load: Load, gap: Array, *, p: Array, u: Array) -> Contact:
    """The contact of p_hat and u_hat, on the box or on the grid."""
    # the transforms of another window round differently
    grid, tolerance = model.grid, model.contact_tolerance + ROUNDING
    if not isinstance(source, ContactPressure):
        return stated(model.plan.given).contact(grid, load, p * model.unit, u * grid.hx)
    units, fields = Units(grid.hx, grid.hy, 2 * model.unit), Solved(p, u, around(p > 0))
    contact = measured(stated(model.built.surface), gap, fields, units, given=load.given, tolerance=tolerance)
    if contact.converged:
        return contact
    words = unfinished("the contact iteration of a load step", source.contact.residuals, tolerance)
    return replace(contact, ending=words)


def with_outside(model: Model, record: Progressed, *, stress: bool = False) -> Progressed:
    """The record with the fields of its plastic strain outside of the box; stress: also that."""
    known = record.outside
    if known is None:
        whole, inside = record.extent.window == model.grid.whole, record.state.residual.displacement
        known = Outside(inside if whole else _moved_grid(model, record))
    if stress and known.stress is None:
        known = replace(known, stress=_residual_stress(model, record))
    return record if known is record.outside else replace(record, outside=known)


def _residual_stress(model: Model, record: Progressed) -> Array:
    """Stress of plastic strain in the rows that touch y = 0; zero where the box covers them."""
    grid, window, rows = model.grid, record.extent.window, model.grid.axis_rows
    across = window.j0 <= rows.j0 and rows.j0 + rows.ny <= window.j0 + window.ny
    covered = record.extent.layers if across and window.nx == grid.nx else 0
    exchange = problem_of(model, record).operator.exchange
    expected = ExpectedBox(*window.shape, record.extent.layers, model.plan.solver.tolerance, exchange)
    large = (expected.large and model.asked_operator != "dense") or model.plan.period is not None
    if large and covered < len(grid.depths):
        return _swept_stress(model, record)
    strained, mu = _strained(model, record), model.plan.pair.body.shear
    below = residual_stress(strained, grid.depths[covered:], rows, mu=mu)
    return np.concatenate([np.zeros((6, covered, *below.shape[2:])), below], axis=1)


def _swept_stress(model: Model, record: Progressed) -> Array:
    """The same everywhere in these rows by sweeps, which take less time where a box is large: means over the
    cells, from which those at their centres differ by h^2/24 times the second derivatives. Error: .1 % of
    the largest two cells beside strained ones, .001 % beside a patch with zones of tens of cells.
    """
    grid, rows, box = model.grid, model.grid.axis_rows, record.extent.window
    faces = stated(grid.faces)
    j0, j1 = min(box.j0, rows.j0 - 1), max(box.j0 + box.ny, rows.j0 + rows.ny + 1)
    extent = Extent(Window(0, j0, grid.nx, j1 - j0), len(grid.depths))
    operator = model.operator(extent, once=Counters())
    strain = surrounded(record.state.material.strain, record.extent.inside(extent), extent.shape)
    spectra_of.cache_clear()  # large, and not asked for again
    response = operator.response(operator.transformed(operator.keep(strain)))
    first = rows.j0 - 1 - j0
    means = operator.whole(operator.stress(None, response))[..., first : first + rows.ny + 2].astype(float)
    centres = means[..., 1:-1].copy()
    for axis, edges in enumerate((faces, np.arange(grid.nx + 1.0), np.arange(rows.ny + 3.0)), 1):
        bend = np.moveaxis(_bend(np.moveaxis(means, axis, 0), edges), 0, axis)
        ends = [(int(k == axis < 3),) * 2 for k in range(4)]
        centres -= np.pad(bend, ends, mode="edge")[..., slice(1, -1) if axis < 3 else slice(None)] / 24
    return centres


def _strained(model: Model, record: Progressed) -> Strained:
    """The plastic strain in its box."""
    return Strained(record.state.material.strain, record.extent.window, model.cuboids(record.extent))


def _moved(model: Model, record: Progressed, component: int, observed: Window) -> Array:
    """Displacement of a window of the surface by the plastic strain, (nx, ny) in m."""
    source, counters = _strained(model, record), model.counters
    if model.plan.period is not None:
        return model.plan.period.moved(source.strain, source.cuboids, component)[observed.slices]
    return surface_displacement(source, observed, counters=counters, component=component)


def _moved_grid(model: Model, record: Progressed) -> Array:
    """u_z of the surface of the grid by the plastic strain, (nx, ny) in m; below a rough patch, where
    each step asks for it, with kept coefficients.
    """
    if not model.plan.places.anywhere:
        return _moved(model, record, 3, model.grid.whole)
    built, source = model.built, _strained(model, record)
    if built.onto_grid is None or built.onto_grid[0] != record.extent:
        counted = vars(model.counters).copy()
        built.onto_grid = record.extent, source.onto(model.grid.whole, 3, model.counters)
        vars(model.counters).update(
            counted
        )  # coefficients that are kept are not counted: a continued solve makes them anew
    return np.asarray(model.grid.hx * built.onto_grid[1].summed(source.strain)[0])


def snapshot(model: Model, record: Progressed, name: str, trial: Trial) -> Snapshot:
    """A state in y = 0: of the cells in the box, and at the cell centres outside of it."""
    outside, material, rows = stated(record.outside), record.state.material, model.grid.axis_rows
    grid, extent, window, layers = model.grid, record.extent, record.extent.window, record.extent.layers
    contact, mu = contact_on_grid(model, record, trial), model.coefficient(record.tribofilm)
    loaded = model.state(trial.load, contact, mu)
    stress = plane_stress(loaded)
    if outside.stress is not None:
        stress = stress + outside.stress
    stress = _filled(model, extent, stress, trial.stress)
    strain = _filled(model, extent, np.zeros_like(stress), material.strain)
    sliding = sliding_of(loaded)
    if sliding is not None:
        sliding = sliding.strained(_moved(model, record, 1, rows), strain, np.diff(stated(grid.faces)))
    back = model.material(extent).at(material.cells).back_stress(material.points)
    repeated = {} if back is None else {BACK_STRESS: filled(back.mean(axis=1), material.cells)}

    # the largest von Mises stress at each depth of all cells of the box, below it of those in y = 0
    counts, mises = counted(contact, grid), von_mises(stress).max(axis=(-2, -1))
    flowed = np.zeros(mises.shape, dtype=bool)
    counting = np.zeros(grid.shape, dtype=bool)
    counting[counts.slices] = True
    inside = (von_mises(trial.stress) * counting[window.slices]).reshape(layers, -1)
    at = np.arange(layers), inside.argmax(axis=1)
    mises[:layers] = inside[at]
    flowed[:layers] = material.peeq.reshape(layers, -1)[at] > 0

    # the largest plastic strain; cells hold means
    top, interval = None, model.strength.kinks.interval(grid.depths[:layers])
    if material.peeq.any():
        wraps = grid.wraps
        peeq = np.pad(material.peeq, [(0, 0), *((int(wrap),) * 2 for wrap in wraps)], mode="wrap")
        centres = at_centres(peeq, model.faces(extent), interval)
        for axis, wrap in enumerate(wraps, start=1):
            if wrap:  # the largest in the middle: it has neighbours on all sides
                centres = centres.take(range(1, centres.shape[axis] - 1), axis)
                place = np.unravel_index(int(centres.argmax()), centres.shape)[axis]
                centres = np.roll(centres, centres.shape[axis] // 2 - int(place), axis)
        top = largest(centres, grid.depths[:layers], interval)

    # the cells of the box in the row of the largest pressure, where that need not be at the origin
    cut, row = None, None
    if model.plan.places.off_origin and trial.load.force != 0:
        row = row_of_largest(contact, counts)
    if row is not None and window.j0 <= row < window.j0 + window.ny:
        x, j = grid.x[window.i0 : window.i0 + window.nx], row - window.j0
        in_row, peeq = trial.stress[..., j].copy(), material.peeq[..., j].copy()
        cut = Cut(float(grid.y[row]), x, grid.depths[:layers], in_row, peeq)
    x = (grid.x[window.i0] - grid.hx / 2) + grid.hx * np.arange(window.nx + 1)
    y = (grid.y[window.j0] - grid.hy / 2) + grid.hy * np.arange(window.ny + 1)
    return Snapshot(
        name,
        contact,
        outside.displacement,
        stress,
        strain,
        _filled(model, extent, np.zeros_like(stress[0]), material.peeq),
        mises[:, None],
        flowed[:, None],
        sliding,
        top=top,
        worn=None if record.wear is None else record.wear.depth,
        cut=cut,
        box=Box(x, y, model.faces(extent), trial.stress, material.strain, material.peeq, repeated),
        stretch=trial.load.stretch,
        place=(trial.load.x, trial.load.y),
        repeated={
            each: _filled(model, extent, np.zeros_like(stress), values) for each, values in repeated.items()
        },
    )


def with_last_period(model: Model, record: Progressed, state: Snapshot) -> Snapshot:
    """A snapshot with the fields of the last period of the history, also if it is of an earlier state."""
    fields, box = record.periods.fields(model, record.state, record.extent), state.box
    if box is None or not fields:
        return state
    window, (layers, nx, ny) = record.extent.window, box.peeq.shape
    i, j = (
        int(np.searchsorted(lines, side[0])) - first
        for side, lines, first in ((box.x, model.grid.x, window.i0), (box.y, model.grid.y, window.j0))
    )
    cells = {name: values[:layers, i : i + nx, j : j + ny] for name, values in fields.items()}
    plane = {
        name: _filled(model, record.extent, np.zeros_like(state.peeq), values)
        for name, values in fields.items()
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


def dissipated_by(model: Model, record: Progressed, trial: Trial) -> float:
    """The energy in J that a step from a record dissipates; 0 where nobody asks for it."""
    if not (model.plan.dissipates and trial.plastic):
        return 0.0
    extent, before = record.extent, record.state.material
    cells = before.cells | trial.increment.cells
    dissipated = model.material(extent).at(cells).flow(before.on(cells)).dissipated(trial.increment.on(cells))
    return float(
        np.sum(np.broadcast_to(model.volumes(extent), extent.shape)[cells] * dissipated.mean(axis=0))
    )


def cycle_end(model: Model, record: Progressed, cycle: int, new: Array) -> CycleEnd:
    """The surface at the end of a cycle, and how much is worn so far."""
    moved, rough, wear = stated(record.outside).displacement, model.plan.rough, record.wear
    lowered = moved if wear is None else moved + wear.depth
    end = CycleEnd(
        cycle,
        wear.volume if wear is not None else 0.0,
        rough.roughness(lowered) if rough is not None else None,
        model.counters.operator_applications,
        new_strain=float(new.max()),
        yielding=int(np.count_nonzero(new > 0)),
        dissipated=record.dissipated,
        yield_excess=record.left[0],
        flow_residual=record.left[1],
    )
    if model.plan.wear is None or wear is None:
        return end
    margin = model.plan.wear.margin(record.state.material.peeq, model.faces(record.extent))
    end = replace(end, moved=moved, worn=wear.depth, margin=margin)
    if len(wear.volumes) != cycle:
        return end
    return replace(
        end,
        wear_of_cycle=wear.volumes[-1],
        raw=wear.raw_volumes[-1],
        roofed=wear.roofed_volumes[-1],
        roof=wear.roof_volumes[-1],
        filled=wear.filled_volumes[-1],
    )


def with_loops(model: Model, record: Progressed, target: Target, trial: Trial) -> Progressed:
    """The record with the cells at the end of a step of the last period, or at its beginning."""
    if model.plan.judging is None or not record.periods.last:
        return record
    period, ends = last_period(model.plan.judging, model.plan.schedule.cycles), record.periods.begun is None
    if not (target.cycle in period or (target.cycle == period.start - 1 and ends)):
        return record
    rows, window, material = record.history.loops, record.extent.window, record.state.material
    at = [(layer, i - window.i0, j - window.j0) for layer, i, j in (row.place for row in rows[:3])]
    if not rows:
        added = record.periods.last[-1].on(record.extent, None).accumulated
        places = loop_places(added, material.peeq.ravel())
        where = (np.unravel_index(place, record.extent.shape) for place in places)
        at = [(int(layer), int(i), int(j)) for layer, i, j in where]
    cells = [
        LoopRow(
            (cell[0], cell[1] + window.i0, cell[2] + window.j0),
            target.cycle,
            target.step,
            float(material.peeq[cell]),
            tuple(trial.stress[(slice(None), *cell)].tolist()),
            tuple(material.strain[(slice(None), *cell)].tolist()),
        )
        for cell in at
    ]
    return replace(record, history=replace(record.history, loops=(*rows, *cells)))


ODD = np.array([ODD_X, ODD_Y])
AT_ONCE = 1e6  # coefficients, 8 MB of them; ten times as many are no faster


@dataclass(frozen=True)
class Strained:
    """Plastic strain (6, n_layers, nx, ny) in a box of cells, whose window is on the grid, in m."""

    strain: Array
    window: Window
    cuboids: Cuboids

    def part(self) -> Strained | None:
        """The smallest box that holds all of the strain; None without any."""
        where = np.nonzero(self.strain.any(axis=0))
        if not where[0].size:
            return None
        (k0, i0, j0), (k1, i1, j1) = ([int(each(axis)) for axis in where] for each in (np.min, np.max))
        window = Window(int(self.window.i0 + i0), int(self.window.j0 + j0), i1 - i0 + 1, j1 - j0 + 1)
        lags = replace(self.cuboids.lags, nx=window.nx, ny=window.ny)
        cuboids = replace(self.cuboids, lags=lags, faces=self.cuboids.faces[k0 : k1 + 2])
        return Strained(self.strain[:, k0 : k1 + 1, i0 : i1 + 1, j0 : j1 + 1], window, cuboids)

    def seen_from(self, observed: Window) -> Cuboids:
        """Its cuboids with the lags to another window of the grid, in the unit of hx."""
        lags, cells = Convolution.lags_needed(self.window, observed), self.cuboids.lags
        faces = tuple(float(z / cells.hx) for z in self.cuboids.faces)
        return replace(self.cuboids, lags=Lags(*lags, 1.0, cells.hy / cells.hx, cells.period), faces=faces)

    def onto(self, observed: Window, component: int, counters: Counters) -> Convolution:
        """Its strain -> the displacement of a window of the surface, in hx. Paper Eq. 6."""
        kernels = surface_displacement_coefficients(self.seen_from(observed), component=component)[None]
        signs = [parity(name, component) for name in STRESS for _ in range(self.cuboids.layers)]
        return Convolution(kernels, signs, self.window, observed, counters=counters)


def residual_stress(source: Strained, depths: Array, observed: Window, *, mu: float) -> Array:
    """Stress of the plastic strain at depths in m, (6, n_depths, nx, ny) in Pa. Paper Eq. 7."""
    out = np.zeros((6, len(depths), *observed.shape))
    part = source.part()
    if part is None:
        return out
    cuboids, hx = part.seen_from(observed), part.cuboids.lags.hx
    at_once = max(1, int(AT_ONCE // (36 * cuboids.layers * cuboids.lags.nx * cuboids.lags.ny)))
    for first in range(0, len(depths), at_once):
        some = slice(first, first + at_once)
        kernels = residual_stress_coefficients(cuboids, depths[some] / hx)
        # paper Eq. 7, second sum
        out[:, some] = mu * row_sums(kernels, part.strain, part.window, observed, odd_out=ODD, odd_in=ODD)
    return out


def surface_displacement(
    source: Strained, observed: Window, *, counters: Counters, component: int = 3
) -> Array:
    """u_z (3, into the body) or u_x (1) of the plastic strain, (nx, ny) in m. Paper Eq. 6."""
    part = source.part()
    if part is None:
        return np.zeros(observed.shape)
    hx = part.cuboids.lags.hx
    if observed.ny > FEW_ROWS:
        return np.asarray(hx * part.onto(observed, component, counters).summed(part.strain)[0])
    kernels = surface_displacement_coefficients(part.seen_from(observed), component=component)
    odd = np.array([[component == 1], [component == 2]], dtype=int)
    rows = row_sums(
        kernels[None, :, None], part.strain, part.window, observed, odd_out=odd, odd_in=ODD
    )  # paper Eq. 6
    return np.asarray(hx * rows[0, 0])


def at_centres(means: Array, faces: Array, interval: NDArray[np.intp] | None = None) -> Array:
    """Values at centres from means (n_layers, nx, ny), where both neighbours are strained."""
    out = means.copy()
    for axis, edges in enumerate((faces, np.arange(means.shape[1] + 1.0), np.arange(means.shape[2] + 1.0))):
        if len(edges) > 3:
            v = np.moveaxis(means, axis, 0)
            smooth = (v[:-2] > 0) & (v[1:-1] > 0) & (v[2:] > 0)
            if axis == 0 and interval is not None:
                smooth &= (interval[:-2] == interval[2:])[:, None, None]
            np.moveaxis(out, axis, 0)[1:-1] -= np.where(smooth, _bend(v, edges) / 24, 0.0)
    np.maximum(out, 0.0, out=out)
    return out


def _bend(means: Array, edges: Array) -> Array:
    """h^2 v'' of the parabola with the means of a cell and its neighbours on the first axis, (n - 2, ...)."""
    width, centre = (
        part.reshape(-1, *[1] * (means.ndim - 1)) for part in (np.diff(edges), (edges[1:] + edges[:-1]) / 2)
    )

    def second(v: Array) -> Array:
        slope = np.diff(v, axis=0) / np.diff(centre, axis=0)
        return 2 * np.diff(slope, axis=0) / (centre[2:] - centre[:-2])

    return width[1:-1] ** 2 * second(means) / (1 + second(width**2) / 24)


def largest(values: Array, depths: Array, interval: NDArray[np.intp] | None = None) -> tuple[float, float]:
    """(depth, value) of the largest of (n_layers, nx, ny), from a cubic in each direction."""
    at = tuple(map(int, np.unravel_index(int(values.argmax()), values.shape)))
    depth, height = float(depths[at[0]]), float(values[at])
    for axis, k in enumerate(at):
        line = values[tuple(slice(None) if a == axis else i for a, i in enumerate(at))]
        place, same = depths, np.ones(len(line), bool)
        if axis > 0:
            place = np.arange(float(len(line)))
        elif interval is not None:
            same = interval == interval[k]
        shift, rise = _summit(place, line, k, same)
        height += rise
        depth += shift if axis == 0 else 0.0
    return depth, height


def _summit(x: Array, y: Array, k: int, same: NDArray[np.bool_]) -> tuple[float, float]:
    """Offset and height of the maximum over the k-th point, of three or four points; 0 at an end."""
    if not 0 < k < len(y) - 1 or not (same[k - 1] and same[k + 1]):
        return 0.0, 0.0
    ends = [k - 1, k + 1]
    side = 1 if y[k + 1] > y[k - 1] else -1
    fourth = k + 2 * side
    if 0 <= fourth < len(y) and same[fourth] and y[fourth] > 0:
        ends[(side + 1) // 2] = fourth
    near = slice(ends[0], ends[1] + 1)
    powers = np.vander(x[near] - x[k], increasing=True)
    _, slope, bend, third = (*np.linalg.solve(powers, y[near] - y[k]), 0.0)[:4]
    root = float(np.sqrt(max(bend**2 - 3 * slope * third, 0.0))) - bend
    place = float(slope / root) if root > 0 else 0.0  # the zero of the slope where the curve bends down
    return place, float(place * (slope + place * (bend + place * third)))
