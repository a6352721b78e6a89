# SPDX-License-Identifier: MIT
"""The semi-analytical model: a scene in, a result out, with nothing computed that the scene does not need."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass, field, replace
from typing import TYPE_CHECKING

import numpy as np

from sam.advice import advice
from sam.contact.convolution import Counters
from sam.contact.fit import fit_of
from sam.contact.normal import Contact
from sam.elastic import solve_elastic
from sam.grid.cells import CellGrid, Room
from sam.grid.enlargement import Sides, enlarged, enlargement, how_to_enlarge
from sam.loading import leaves_axis, peak_force
from sam.planner.grids import check, choose_grid, given_sides, pair_of
from sam.record import EVEN, CycleEnd, Row, Snapshot, cycles, fields, history, quantities, tables
from sam.scene import LeftOut, Result, Scene, Status
from sam.scene.checkpoint import Checkpoint, Keep, check_model
from sam.scene.residuals import residual_table
from sam.scene.result import Progress, of_load

if TYPE_CHECKING:
    from sam.plasticity.progress import Progressed

MODEL = "sam"


def left_out(scene: Scene) -> list[LeftOut]:
    """The stages that this scene does not need, with reasons."""
    out = _left_out_of_friction(scene)
    if scene.loading.prescribed:
        out.append(
            LeftOut(
                "contact search", f'loading.prescribed = "{scene.loading.prescribed}": the pressure is given'
            )
        )
    if scene.body.plasticity is None:
        out += [
            LeftOut("volume grid", "no [body.plasticity]: stresses at the output depths only"),
            LeftOut("eigenstrain kernels", "no [body.plasticity]"),
            LeftOut("plastic loop", "no [body.plasticity]"),
        ]
    out += _left_out_of_coating(scene)
    if scene.friction is None:
        out.append(LeftOut("chemical film", "no [friction]"))
    elif not scene.friction.film:
        out.append(
            LeftOut("chemical film", f'friction.law = "{scene.friction.law}": the coefficient is given')
        )
    if scene.wear is None:
        out.append(LeftOut("worn geometry", "no [wear]"))
    elif not scene.wear.tears:
        out.append(LeftOut("worn geometry", "wear.strain_limit = inf: nothing tears"))
    if scene.surface is None:
        if not leaves_axis(scene):
            reason = "smooth, sliding along x: the largest von Mises stress lies in y = 0"
            out.append(LeftOut("stress outside the plane y = 0", reason))
        out.append(LeftOut("surface heights", "no [surface]"))
    if not scene.loading.unload:
        out.append(LeftOut("unloading", "loading.unload = false"))
    if scene.body.plasticity is None:
        if scene.loading.unload:
            out.append(LeftOut("unloading steps", "elastic: unloading in one step is exact"))
        if scene.loading.cycles > 1:
            out.append(LeftOut("cycles after the first", "elastic: all cycles are equal"))
    elif scene.body.plasticity.layer_thickness is not None and scene.wear is None:
        out.append(
            LeftOut("strain limit of the layer", "no [wear]: body.plasticity.layer_thickness changes nothing")
        )
    return out


def _left_out_of_unyielding(scene: Scene) -> list[LeftOut]:
    """What a scene with [body.plasticity] turns out not to need when it stays elastic."""
    reason = "the elastic stress at the peak yields nowhere"
    stages = ["eigenstrain kernels", "plastic loop"]
    if scene.wear is not None and scene.wear.tears:
        stages.append("worn geometry")
    return [LeftOut(stage, reason) for stage in stages]


def _left_out_of_coating(scene: Scene) -> list[LeftOut]:
    """What a scene without coating does not need; with one, what its depths or its load leave out."""
    coating = scene.body.coating
    if coating is None:
        return [LeftOut("layered coefficients", "no [body.coating]")]
    out, depths = [], choose_grid(scene).depths
    if peak_force(scene) == 0:
        out.append(LeftOut("bare comparison", "loading.force = 0: no contact"))
    for part, there, where in (
        ("film", depths[0] < coating.thickness, "above"),
        ("substrate", depths[-1] >= coating.thickness, "at or below"),
    ):
        if not there:
            reason = f"no output depth {where} the interface, z = {coating.thickness:g} m"
            out.append(LeftOut(f"stresses in the {part}", reason))
    return out


def _left_out_of_friction(scene: Scene) -> list[LeftOut]:
    """What a scene without friction, or with friction that moves no surface normally, does not need."""
    if scene.friction is None:
        return [LeftOut("tangential kernels", "no [friction]")]
    if scene.coefficient == 0:
        return [LeftOut("tangential kernels", "friction.coefficient = 0")]
    reason = None
    if not scene.friction.coupling:
        reason = "friction.coupling = false: the traction moves no surface normally"
    elif scene.loading.prescribed:
        reason = "the pressure is given: the gap that the traction changes is not needed"
    elif scene.body.coating is None and pair_of(scene).tangential_mismatch == 0:
        reason = "like bodies, equal (1 - 2 nu)/mu: the traction moves both surfaces alike"
    return [LeftOut("coupling", reason)] if reason else []


def solve(
    scene: Scene,
    progress: Progress | None = None,
    checkpoint: Keep | None = None,
    start: Checkpoint | None = None,
) -> Result:
    """Solve a scene, at rest or sliding, smooth or rough, elastic or plastic.

    checkpoint: called with a Checkpoint after each committed step of a scene that yields; start: one of them, of the same
    scene, to go on from there to the same result. Returns a Result; its status says whether it may be used. Raises
    UnsupportedScene for a coating where anything yields (see `check`), ValueError for a `start` of another model.
    """
    check(scene)
    check_model(start, MODEL)
    if not scene.solver.extrapolate:
        return _solve(scene, progress, checkpoint, start)
    from sam.extrapolation import solve_on_two

    def either(one: Scene) -> Result:
        return _solve(one, progress, *((checkpoint, start) if one is scene else (None, None)))

    return solve_on_two(scene, either)


@dataclass(frozen=True)
class _Found:
    """A load history on one grid. yields: whether the plastic loop ran; others as in `sam.plasticity.solution.Found`."""

    rows: list[Row]
    snapshots: list[Snapshot]
    status: Status
    reached: Sides
    yields: bool = False
    certificate: Mapping[str, float] = field(default_factory=dict)
    discretisation: Mapping[str, object] = field(default_factory=dict)
    warnings: tuple[str, ...] = ()
    ends: tuple[CycleEnd, ...] = ()
    volume: float = 0.0
    ending: str = ""
    unfinished: tuple = ()
    so_far: Progressed | None = None


class _Clock:
    """Times in s of set-up and solve, with those of the parts of the solve that an interruption ended."""

    def __init__(self, before: Mapping[str, float] | None):
        self.before = before or {"setup_s": 0.0, "solve_s": 0.0}
        self.began = self.ready = time.perf_counter()

    def times(self) -> dict[str, float]:
        setup, solving = self.ready - self.began, time.perf_counter() - self.ready
        return {"setup_s": self.before["setup_s"] + setup, "solve_s": self.before["solve_s"] + solving}


def _solve(
    scene: Scene, progress: Progress | None, checkpoint: Keep | None, start: Checkpoint | None
) -> Result:
    """On the grid of the scene. Where the plastic zone or the contact reaches the edge of a chosen one, on a larger one."""
    clock, counters, resumed = _Clock(start.cost if start else None), Counters(), None
    if start:
        from sam.plasticity.progress import Progressed

        resumed = start.record(Progressed)
    grid = choose_grid(scene, resumed.room) if resumed else choose_grid(scene)
    clock.ready = time.perf_counter()

    def keep(record: Progressed, done: int, total: int) -> None:
        checkpoint(Checkpoint.of(MODEL, record, done=done, total=total, cost=clock.times()))

    fixed = counters, progress or (lambda *_: None), keep if checkpoint else None
    found = _on_grid(scene, grid, *fixed, resumed)
    while room := enlarged(given_sides(scene), grid.room, found.reached):
        larger = choose_grid(scene, room)
        found = _on_grid(scene, larger, *fixed, _continued(found.so_far, grid, larger))
        grid = larger
    cost = clock.times() | _counts(counters)
    result = _result(scene, grid, found, counters, cost)
    if grid.room == Room():
        return result
    extra, words = enlargement(choose_grid(scene), grid)
    return replace(
        result, discretisation=result.discretisation | extra, warnings=(*result.warnings, words)
    )  # fmt: skip


def _continued(so_far: Progressed | None, grid: CellGrid, larger: CellGrid) -> Progressed | None:
    """The record on a larger grid; None if the history begins anew there."""
    if so_far is None:
        return None
    from sam.plasticity.solution import on_larger_grid

    return on_larger_grid(so_far, grid, larger)


def _on_grid(
    scene: Scene,
    grid: CellGrid,
    counters: Counters,
    report: Progress,
    keep: Callable[[Progressed, int, int], None] | None,
    start: Progressed | None,
) -> _Found:
    """The load history on one grid, from its beginning or from a record on."""
    peak, rough = None, scene.surface is not None
    if scene.body.plasticity is None:
        return _elastic(scene, grid, counters, report)
    if start is None:
        from sam.onset import elastic_peak, initial_yield, yields

        peak = elastic_peak(scene, grid, counters)
        if not yields(peak, initial_yield(scene, grid)):
            return _elastic(scene, grid, counters, report)
    from sam.plasticity.solution import solve_plastic

    found = solve_plastic(scene, grid, counters, report, keep=keep, start=start, peak=peak)
    status, contact = found.status, found.snapshots[0].contact
    if status is Status.CONVERGED:
        status = _status(found.rows, contact, rough)
    warnings = (*found.warnings, *_warnings(scene, grid, found.snapshots[0])) if rough else found.warnings
    reached, so_far = found.reached, found.so_far
    if status is Status.CONTACT_AT_GRID_EDGE:
        reached, so_far = Sides(beside=True), None
    return _Found(
        found.rows, found.snapshots, status, reached, True, found.certificate, found.discretisation, warnings, found.ends,
        found.wear.volume if found.wear is not None else 0.0, found.ending, found.unfinished, so_far,
    )  # fmt: skip


def _elastic(scene: Scene, grid: CellGrid, counters: Counters, report: Progress) -> _Found:
    """The same of a body that stays elastic."""
    rows, snapshots = solve_elastic(scene, grid, counters, report)
    status = _status(rows, snapshots[0].contact, scene.surface is not None)
    reached = Sides(beside=status is Status.CONTACT_AT_GRID_EDGE)
    return _Found(rows, snapshots, status, reached, warnings=_warnings(scene, grid, snapshots[0]))


def _result(scene: Scene, grid: CellGrid, found: _Found, counters: Counters, cost: Mapping) -> Result:
    """The record of what was found on the last grid."""
    rows, status, ending, omitted = found.rows, found.status, found.ending, left_out(scene)
    if scene.body.plasticity is not None and not found.yields:
        omitted += _left_out_of_unyielding(scene)
    record = {"history": history(rows, grid)} | tables(scene, grid, found.snapshots)
    record["residuals"] = residual_table(
        [*((row.cycle, row.step, row.attempts) for row in rows), *found.unfinished]
    )
    if status is Status.NOT_CONVERGED:
        ending = next((row.ending for row in rows if row.ending), "")
    if scene.loading.cycles > 1:
        record["cycles"] = cycles(scene, grid, rows, found.ends)
    peak, unloaded = found.snapshots[0], found.snapshots[1] if len(found.snapshots) > 1 else None
    profile = scene.body.plasticity.depth_profile() if found.yields else EVEN
    words = advice(scene, status, how_to_enlarge(grid, found.reached))
    return Result(
        model=MODEL,
        status=status,
        **of_load(
            peak.state,
            quantities(grid, peak, unloaded, found.volume, profile, scene.surface is not None),
        ),
        tables=record,
        fields=fields(grid, peak, _heights(scene, grid)),
        left_out=omitted,
        discretisation=_discretisation(grid, peak.contact)
        | _roughness(scene, grid)
        | {"tangential_kernels": counters.tangential_kernels}
        | found.discretisation,
        certificate=_certificate(peak.contact) | found.certificate,
        cost=cost,
        message="; ".join(filter(None, (words, ending))),
        warnings=found.warnings,
    )


def _heights(scene: Scene, grid: CellGrid) -> np.ndarray | None:
    """Of a rough body at the cells, (nx, ny) in m."""
    if scene.surface is None:
        return None
    from sam.grid.rough import RoughPatch

    return RoughPatch.of(scene.surface, scene.grid).heights()


def _warnings(scene: Scene, grid: CellGrid, peak: Snapshot) -> tuple[str, ...]:
    """Of a rough or coated scene that stays elastic."""
    out = ()
    if scene.surface is not None:
        from sam.results.rough import warnings_of

        out = warnings_of(scene, grid, peak.contact)
    comparison = peak.coated.comparison if peak.coated else None
    return (*out, comparison.warning) if comparison and comparison.warning else out


def _status(rows: list[Row], peak: Contact, rough: bool = False) -> Status:
    """All steps count for convergence, the contact at the peak (on the full grid) for the fit of the grid too."""
    return fit_of(peak, rough) if all(row.converged for row in rows) else Status.NOT_CONVERGED


def _discretisation(grid: CellGrid, peak: Contact) -> dict[str, object]:
    return {
        "cells": [grid.nx, grid.ny],
        "cell_m": [grid.hx, grid.hy],
        "depths": len(grid.depths),
        "largest_depth_m": float(grid.depths[-1]),
        "contact_box_cells": [peak.box.nx, peak.box.ny],
        "contact_cells": int(np.count_nonzero(peak.pressure)),
    }


def _roughness(scene: Scene, grid: CellGrid) -> dict[str, object]:
    """Of a rough body before the first load; of a file also as it was read, before form, gaps and other cells."""
    if scene.surface is None:
        return {}
    from sam.grid.rough import RoughPatch
    from sam.scene.surface import roughness_as_read

    out = {"roughness": asdict(RoughPatch.of(scene.surface, scene.grid).roughness())}
    if scene.surface.kind == "file":
        out["roughness_as_read"] = asdict(roughness_as_read(scene.surface))
    return out


def _certificate(peak: Contact) -> dict[str, float]:
    """Residuals of the returned fields, see Contact."""
    return {
        "gap_in_contact": peak.gap_residual,
        "penetration": peak.penetration,
        "tension": peak.tension,
        "load_error": peak.load_error,
    }


def _counts(counters: Counters) -> dict[str, int]:
    return {
        "contact_iterations": counters.contact_iterations,
        "plastic_iterations": counters.plastic_iterations,
        "operator_applications": counters.operator_applications,
        "displacement_applications": counters.displacement_applications,
        "ffts": counters.ffts,
        "step_cuts": counters.step_cuts,
    }
