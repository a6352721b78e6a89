# SPDX-License-Identifier: MIT
"""An elasto-plastic scene: its load history solved, and what is found of it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial

from sam.arrays import Array
from sam.contact.convolution import Counters
from sam.contact.normal import Contact
from sam.contact.stress import von_mises
from sam.elastic import plane_stress, tribofilm_of
from sam.friction import Coefficient, coefficient_on
from sam.grid.cells import CellGrid, Window
from sam.grid.enlargement import Sides
from sam.loading import (
    Load,
    Target,
    given_contact,
    given_pressure,
    in_steps,
    leaves_axis,
    off_origin,
    path_of,
    sign_of,
    targets_of,
)  # fmt: skip
from sam.onset import ElasticPeak, elastic_peak
from sam.planner.grids import coupling_of, gap_of, pair_of
from sam.plasticity.extent import first_extent
from sam.plasticity.history import onward
from sam.plasticity.instruments import Instruments
from sam.plasticity.measure import problem_now, snapshot, with_outside
from sam.plasticity.model import Model, Pressing, Slip, YieldingBody
from sam.plasticity.progress import Parts, Peak, Progressed
from sam.plasticity.state import Extent
from sam.plasticity.step import CONTACT_SHARE, Problem
from sam.record import CycleEnd, Row, Snapshot, row_of
from sam.scene import Scene, Status
from sam.scene.residuals import Attempt
from sam.scene.result import LAST, PEAK, UNLOADED, Progress
from sam.scene.surface import Roughness
from sam.sliding import Sliding
from sam.surface_state import Wear, WearState

PAPER_SHARE = (
    1e2  # residual of a contact over the tolerance: what the last move in the paper's loops leaves of it
)


@dataclass(frozen=True)
class Found:
    """The solved history. status: CONVERGED, or why not; ending: of the last iteration, in words.

    unfinished: the step that was not reached, see `residual_table`; reached: the sides of the grid at which the plastic
    zone ended the history; so_far: its record.
    """

    rows: Sequence[Row]
    snapshots: list[Snapshot]
    certificate: dict[str, float]
    discretisation: dict[str, object]
    status: Status
    reached: Sides
    so_far: Progressed
    warnings: tuple[str, ...] = ()
    ends: tuple[CycleEnd, ...] = ()
    wear: WearState | None = None
    ending: str = ""
    unfinished: tuple[tuple[int, int, Sequence[Attempt]], ...] = ()


def solve_plastic(
    scene: Scene,
    grid: CellGrid,
    counters: Counters,
    report: Progress,
    *,
    keep: Callable[[Progressed, int, int], None] | None = None,
    start: Progressed | None = None,
    peak: ElasticPeak | None = None,
) -> Found:
    """History and states of a scene that yields.

    keep: called as keep(progressed, done, total) after each committed step, or part of one, with the number of load steps;
    start: such a record, to go on from there; peak: of the body if it stayed elastic, else found here.
    """
    model = model_of(scene, grid, counters)
    if start is None:
        now = begun(
            model, targets_of(scene), first_box(scene, model, peak or elastic_peak(scene, grid, counters))
        )
    else:
        now = continued(model, start)
    loading, moves = scene.loading, len(path_of(scene)) - 1
    total = loading.cycles * (loading.steps + moves + loading.unload)
    while not now.ended:
        before, now = now, onward(model, now)
        done = len(now.measured.rows)
        if keep is not None and now.last is not before.last:
            keep(now, done, done + len(now.targets))
        if before.targets[0].rises and done > len(before.measured.rows):
            report("load steps", done, total)
    return found_of(model, now, stop=scene.solver.stop if scene.solver.method == "paper" else None)


def begun(model: Model, targets: Sequence[Target], extent: Extent) -> Progressed:
    """The record before the first step, on a first box."""
    film = None
    if model.tribofilm is not None:
        film = model.tribofilm.fresh(model.nothing_strained())
    wear = model.wear.fresh() if model.wear is not None else None
    state = model.problem(extent, film, wear).virgin()
    return Progressed(state, extent, model.grid.room, tuple(targets), replace(model.counters), film, wear)


def continued(model: Model, start: Progressed) -> Progressed:
    """The record itself, after the model and its counters are as they were when it was made."""
    problem_now(model, start)
    vars(model.counters).update(vars(start.counters))
    return start


def on_larger_grid(so_far: Progressed, grid: CellGrid, larger: CellGrid) -> Progressed | None:
    """The same record in the middle of a grid with further cells of the same size; None if it has fields of the whole grid."""
    if so_far.measured.snapshots or so_far.wear is not None or so_far.tribofilm is not None:
        return None
    window = so_far.extent.window
    i, j = window.i0 + (larger.nx - grid.nx) // 2, window.j0 + (larger.ny - grid.ny) // 2
    extent = replace(so_far.extent, window=Window(i, j, window.nx, window.ny))
    goes_on = {"status": Status.CONVERGED, "reached": Sides(), "ending": ""}
    return replace(so_far, extent=extent, outside=None, room=larger.room, **goes_on)


def found_of(model: Model, now: Progressed, stop: str | None) -> Found:
    """What is found of a history; of one that broke off the last state that it reached, as LAST.

    stop: of the paper's loops, None without them.
    """
    snapshots, peak = dict(now.measured.snapshots), now.measured.peak
    if peak is None:
        last = now.last
        if (
            last is None or last.increment.strain.shape != now.state.material.strain.shape
        ):  # the box has grown since
            last = problem_now(model, now).step(now.state, now.state.load)
        now = with_outside(model, now, stress=True)
        snapshots[LAST] = snapshot(model, now, LAST, last)
        peak = Peak(last.yield_excess, last.flow_residual)
    states = [snapshots[name] for name in (PEAK, LAST, UNLOADED) if name in snapshots]
    certificate = {
        "yield_excess": peak.yield_excess,
        "flow_residual": peak.flow_residual,
        "yield_excess_outside_box": _excess_outside(model, now.extent, states[0]),
        "plastic_tolerance": model.tolerance,
    }
    discretisation = {
        "plastic_box_cells": [now.extent.window.nx, now.extent.window.ny],
        "plastic_box_layers": now.extent.layers,
        "layers": len(model.grid.depths),
        "operator_bytes": problem_now(model, now).operator.memory,
    }
    return Found(
        now.measured.rows,
        states,
        certificate,
        discretisation,
        now.status,
        now.reached,
        replace(now, counters=replace(model.counters)),
        warnings=() if stop is None else (_warning(stop, peak),),
        ends=now.measured.ends,
        wear=now.wear,
        ending=now.ending,
        unfinished=tuple((target.cycle, target.step, now.parts.attempts) for target in now.targets[:1]),
    )


def _warning(stop: str, peak: Peak) -> str:
    """The paper's loops stop by their own criterion: what they leave is said."""
    return (
        f'solver.method = "paper", stop = "{stop}": the last step leaves a yield excess of {peak.yield_excess:.1e} and '
        f"a flow-rule residual of {peak.flow_residual:.1e} of the yield stress"
    )


def _excess_outside(model: Model, extent: Extent, state: Snapshot) -> float:
    """max((mises - sigma_y)/sigma_y, 0) in the plane y = 0 outside the box, where no plastic strain was allowed."""
    window, limit = extent.window, model.body.initial_yield(model.grid.depths)
    excess = von_mises(state.in_plane) / limit[:, None] - 1
    excess[: extent.layers, window.i0 : window.i0 + window.nx] = 0.0
    return float(max(excess.max(), 0.0))


# from a scene to the numbers and laws above


def model_of(scene: Scene, grid: CellGrid, counters: Counters) -> Model:
    """The model of a scene that may yield, on a grid."""
    body, solver, paper = scene.body, scene.solver, scene.solver.method == "paper"
    return Model(
        grid,
        YieldingBody(body.young, body.poisson, body.plasticity.curve(), body.plasticity.depth_profile()),
        _pressing(scene, grid),
        Slip(scene.coefficient > 0, coefficient_on(scene, grid), coupling_of(scene, 1.0)),
        instruments_of(scene, grid, counters),
        counters,
        solver.tolerance,
        PAPER_SHARE if paper else CONTACT_SHARE,
        tribofilm_of(scene, grid),
        wear_of(scene, grid),
        cut_beside=scene.surface is not None,
        remembers=scene.loading.cycles > 1,
        make=paper_problem(solver.stop) if paper else Problem,
    )


def _pressing(scene: Scene, grid: CellGrid) -> Pressing:
    """Mirrored below a smooth body whose load does not leave the apex; what the paper's loops do is left as it is."""
    unit, gap, path = pair_of(scene).contact_modulus / 2, gap_of(scene, grid), scene.loading.path
    even = scene.surface is None and scene.solver.method != "paper" and scene.constant_friction
    in_y = even and (path is None or path.start[1] == path.end[1] == 0)

    def given(load: Load, window: Window) -> Array:
        i, j = window.slices
        return given_pressure(scene, load, grid.x[i], grid.y[j], grid.hx, grid.hy)

    return Pressing(
        unit, lambda load: gap, given if scene.loading.prescribed else None, (even and path is None, in_y)
    )


def first_box(scene: Scene, model: Model, peak: ElasticPeak) -> Extent:
    """The first box of a scene."""
    return first_extent(
        model.grid,
        peak,
        model.body.initial_yield(model.grid.depths),
        anywhere=scene.surface is not None,
        both_ways=sign_of(scene, 2) < 0,
        path=path_of(scene),
    )


def instruments_of(scene: Scene, grid: CellGrid, counters: Counters) -> Instruments:
    """What is measured of the states of a scene."""

    def stress(load: Load, contact: Contact, coefficient: Coefficient) -> Array:
        return plane_stress(scene, grid, load, contact, counters, coefficient=coefficient)

    def sliding(load: Load, contact: Contact, coefficient: Coefficient) -> Sliding | None:
        return Sliding.elastic(scene, grid, load, contact, counters, coefficient=coefficient)

    def given(load: Load, pressure: Array, displacement: Array) -> Contact:
        return given_contact(scene, load, pressure, displacement, grid.hx * grid.hy)

    def row(
        target: Target,
        contact: Contact,
        coefficient: Coefficient,
        *,
        parts: Parts,
        note: str,
        peeq_max: float,
    ) -> Row:
        force, numbers = target.load.force, (parts.iterations, parts.worst, note, peeq_max, parts.attempts)
        return row_of(scene, grid, target.cycle, target.step, force, contact, coefficient, *numbers)

    return Instruments(
        stress,
        sliding,
        given,
        row,
        partial(in_steps, scene=scene),
        roughness=roughness_of(scene),
        anywhere=scene.surface is not None or leaves_axis(scene),
        off_origin=off_origin(scene),
    )


# what only some scenes need


def paper_problem(stop: str) -> Callable[..., Problem]:
    """What makes a problem whose steps are the loops of the paper."""
    from sam.plasticity.paper import PaperProblem

    return partial(PaperProblem, stop=stop)


def wear_of(scene: Scene, grid: CellGrid) -> Wear | None:
    """The law of wear of a scene; None without one, then nothing of it is loaded."""
    wear = scene.wear
    if wear is None or not wear.tears:
        return None
    from sam.wear.depth import limit_by_depth
    from sam.wear.removal import WearLaw

    return WearLaw(
        (grid.nx, grid.ny),
        grid.hx,
        grid.hy,
        limit_by_depth(wear, scene.body.plasticity.layer_thickness),
        wear.interpolate,
        wear.smoothing_window,
        wear.smoothing_order,
    )


def roughness_of(scene: Scene) -> Callable[[Array], Roughness] | None:
    """What measures the roughness of a lowered surface; None of a smooth body."""
    if scene.surface is None:
        return None
    from sam.grid.rough import RoughPatch

    return RoughPatch.of(scene.surface, scene.grid).roughness
