# SPDX-License-Identifier: MIT
"""The semi-analytical model: a scene in, a result out, with nothing computed that the scene does not need."""

from __future__ import annotations

import time
from collections.abc import Mapping
from dataclasses import asdict

import numpy as np

from sam.advice import advice
from sam.contact import Contact
from sam.convolution import Counters
from sam.elastic import solve_elastic
from sam.fit import fit_of
from sam.grid import CellGrid, check, choose_grid, tangential_mismatch
from sam.loading import leaves_axis, peak_force
from sam.record import EVEN, Row, Snapshot, cycles, fields, history, quantities, tables
from sam.scene import LeftOut, Result, Scene, Status
from sam.scene.checkpoint import Checkpoint, Keep, check_model
from sam.scene.residuals import residual_table
from sam.scene.result import Progress, of_load

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
    elif scene.body.coating is None and tangential_mismatch(scene) == 0:
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


def _solve(
    scene: Scene, progress: Progress | None, checkpoint: Keep | None, start: Checkpoint | None
) -> Result:
    """On the one grid of the scene."""
    began = time.perf_counter()
    report = progress or (lambda *_: None)
    counters = Counters()
    grid = choose_grid(scene)
    ready = time.perf_counter()
    before = start.cost if start else {"setup_s": 0.0, "solve_s": 0.0}
    omitted, certificate, extra, warnings, ends, volume = left_out(scene), {}, {}, (), (), 0.0
    ending, unfinished = "", ()
    plastic, peak = start is not None, None
    if scene.body.plasticity is not None and start is None:
        from sam.plastic.extent import elastic_peak, yields

        peak = elastic_peak(scene, grid, counters)
        plastic = yields(scene, grid, peak)
    if not plastic:
        rows, snapshots = solve_elastic(scene, grid, counters, report)
        status = _status(rows, snapshots[0].contact, scene.surface is not None)
        warnings = _warnings(scene, grid, snapshots[0])
        if scene.body.plasticity is not None:
            omitted += _left_out_of_unyielding(scene)
    else:
        from sam.plastic.history import Progressed
        from sam.plastic.solution import solve_plastic

        def keep(record: Progressed, done: int, total: int) -> None:
            checkpoint(
                Checkpoint.of(MODEL, record, done, total, _times(before, began, ready, time.perf_counter()))
            )

        resumed = Progressed.from_tree(start.tree()) if start else None
        found = solve_plastic(scene, grid, counters, report, keep if checkpoint else None, resumed, peak)
        rows, snapshots, certificate, extra = (
            found.rows,
            found.snapshots,
            found.certificate,
            found.discretisation,
        )
        warnings, ends, ending, unfinished = found.warnings, found.ends, found.ending, found.unfinished
        volume = found.ledger.volume if found.ledger is not None else 0.0
        if scene.surface is not None:
            warnings = (*warnings, *_warnings(scene, grid, snapshots[0]))
        status = found.status
        if status is Status.CONVERGED:
            status = _status(rows, snapshots[0].contact, scene.surface is not None)
    done = time.perf_counter()
    record = {"history": history(rows, grid)} | tables(scene, grid, snapshots)
    record["residuals"] = residual_table(
        [*((row.cycle, row.step, row.attempts) for row in rows), *unfinished]
    )
    if status is Status.NOT_CONVERGED:
        ending = next((row.ending for row in rows if row.ending), "")
    if scene.loading.cycles > 1:
        record["cycles"] = cycles(scene, grid, rows, ends)
    peak, unloaded = snapshots[0], snapshots[1] if len(snapshots) > 1 else None
    return Result(
        model=MODEL,
        status=status,
        **of_load(
            peak.state,
            quantities(
                grid,
                peak,
                unloaded,
                volume,
                scene.body.plasticity.depth_profile() if plastic else EVEN,
                scene.surface is not None,
            ),
        ),
        tables=record,
        fields=fields(grid, peak, _heights(scene, grid)),
        left_out=omitted,
        discretisation=_discretisation(grid, peak.contact)
        | _roughness(scene, grid)
        | {"tangential_kernels": counters.tangential_kernels}
        | extra,
        certificate=_certificate(peak.contact) | certificate,
        cost=_times(before, began, ready, done) | _counts(counters),
        message="; ".join(filter(None, (advice(scene, status), ending))),
        warnings=warnings,
    )


def _heights(scene: Scene, grid: CellGrid) -> np.ndarray | None:
    """Of a rough body at the cells, (nx, ny) in m."""
    if scene.surface is None:
        return None
    from sam.rough import heights_on

    return heights_on(scene, grid)


def _warnings(scene: Scene, grid: CellGrid, peak: Snapshot) -> tuple[str, ...]:
    """Of a rough or coated scene that stays elastic."""
    out = ()
    if scene.surface is not None:
        from sam.rough import warnings_of

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
    from sam.rough import roughness_of
    from sam.scene.surface import roughness_as_read

    out = {"roughness": asdict(roughness_of(scene, grid))}
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


def _times(before: Mapping[str, float], began: float, ready: float, now: float) -> dict[str, float]:
    """Times in s, with those of the parts of the solve that an interruption ended."""
    return {"setup_s": before["setup_s"] + ready - began, "solve_s": before["solve_s"] + now - ready}


def _counts(counters: Counters) -> dict[str, int]:
    return {
        "contact_iterations": counters.contact_iterations,
        "plastic_iterations": counters.plastic_iterations,
        "operator_applications": counters.operator_applications,
        "displacement_applications": counters.displacement_applications,
        "ffts": counters.ffts,
        "step_cuts": counters.step_cuts,
    }
