# SPDX-License-Identifier: MIT
"""The stages of a plan, in the order in which they begin: those that run with their sizes, and why others are
left out.

A stage runs where the plan has the part that it works on; nothing else decides on it. What only the solve can
tell, as the size of the plastic zone, is not among the sizes.
"""

from __future__ import annotations

from collections.abc import Iterator
from math import ceil

from sam.arrays import ROUNDING
from sam.elastic.problem import Plan
from sam.scene import LeftOut, Path, Scene, Stage
from sam.scene.result import NO_FORCE
from sam.scene.verdict import VERDICT, periods_of, reason_without

LEFT_ORDER = (
    "tangential kernels; coupling; contact search; surface coefficients; volume grid; eigenstrain kernels; "
    "plastic loop; layered coefficients; bare comparison; stresses in the film; stresses in the substrate; "
    "chemical film; worn geometry; stress outside the plane y = 0; surface heights; counter-surface heights; "
    "padding; edge of the patch; images of the period; box around the contact; "
    f"unloading; unloading steps; cycles after the first; back-stresses; {VERDICT}; strain limit of the layer"
).split("; ")
"""The order in which stages that do not run are told."""
# (c, n) of errors in percent, c times the step in contact radii to the power n, of Swift steel at p0 = 4
# sigma_y0: steps of a/2 to a/32 against the limit of short ones (case moving-steps).
LEFT_OF_GROOVE, LEFT_OF_STRAIN = (9.0, 1.5), (23.0, 0.77)
UNTOUCHED = "loading.misfit: nothing touches the surface"
UNYIELDING = "the elastic stress at the peak yields nowhere"


def stages_of(scene: Scene, plan: Plan) -> tuple[Stage, ...]:
    """The stages of a scene: those that it needs in their order, then those that it does not need."""
    solving = [*_surface(scene, plan), *_load(scene, plan), *_plastic(scene, plan), *_output(scene, plan)]
    if plan.schedule.peak.rests:
        solving = [Stage(stage.stage, False, NO_FORCE) if stage.runs else stage for stage in solving]
    stages = [*_cells(scene, plan), *solving]
    needed = [stage for stage in stages if stage.runs or stage.reason == NO_FORCE]
    left = [stage for stage in stages if not stage.runs and stage.reason != NO_FORCE]
    return (*needed, *sorted(left, key=lambda each: LEFT_ORDER.index(each.stage)))


def left_out_of_unyielding(plan: Plan) -> list[LeftOut]:
    """What a scene with plasticity turns out not to need when it stays elastic."""
    stages = ["eigenstrain kernels", "plastic loop", *["worn geometry"] * (plan.wear is not None)]
    return [LeftOut(stage, UNYIELDING) for stage in stages]


def _stage(name: str, why_not: str, words: str = "", **size: object) -> Stage:
    """A stage that runs, in words and with its sizes, unless there is a reason why not."""
    return Stage(name, not why_not, why_not or words, {} if why_not else size)


def _cells(scene: Scene, plan: Plan) -> Iterator[Stage]:
    """Cells, layers and heights, those of the counter-body in each cycle others if it is renewed."""
    grid, surface, counter = plan.grid, scene.surface, scene.counter_surface
    cells = [grid.nx, grid.ny]
    yield _stage("grid", "", _grid_reason(scene), cells=cells, cell_m=[grid.hx, grid.hy])
    if grid.faces is None:
        yield _stage("volume grid", "no [body.plasticity]: stresses at the output depths only")
    else:
        words = f"layers chosen from the {_length(scene)} and the load, further ones if the plastic zone "
        words += "reaches the last"
        if scene.grid is not None and (scene.grid.depths or scene.grid.layers):
            words = "layers of [grid]"
        layers, deepest = max(len(grid.faces) - 1, 1), float(grid.faces[-1])
        yield _stage("volume grid", "", words, layers=layers, largest_depth_m=deepest)
    words = "" if surface is None else f'[surface], kind "{surface.kind}", at the cell centres'
    yield _stage("surface heights", "no [surface]" * (surface is None), words, cells=cells)
    if counter is None:
        yield _stage("counter-surface heights", "no [counterbody.surface]")
        return
    words = f'[{counter.table}], kind "{counter.kind}", at the cell centres'
    words += ", another stretch in each cycle" * counter.renewed
    if (strip := scene.counter_strip) is not None:
        words, cells = f"{words}, as long as the patch and the way", list(strip.whole)
    count = plan.schedule.cycles if plan.schedule.renews else 1
    yield _stage("counter-surface heights", "", words, cells=cells, stretches=count)


def _surface(scene: Scene, plan: Plan) -> Iterator[Stage]:
    """Influence coefficients of the surface, and whether the traction is part of the gap."""
    cells, loads = plan.grid.nx * plan.grid.ny, 1 + plan.slip.slides  # pressure and traction
    if plan.coarser is not None:  # from which quantities are extrapolated
        words = "solver.extrapolate: all that follows on half as many cells first"
        yield _stage("coarser grid", "", words, cells=[plan.coarser.grid.nx, plan.coarser.grid.ny])
    touched = UNTOUCHED if plan.misfit is not None else ""
    words = "normal displacement under pressure"
    if plan.period is not None:
        words += ", about its mean: the approach is that of the mean planes of the deformed surfaces"
        left = ["padding", "edge of the patch"]
        left += ["images of the period", "box around the contact"] * (plan.plasticity is not None)
        yield from (_stage(each, 'grid.periodic = "xy": all repeats beside the patch') for each in left)
    yield _stage("surface coefficients", touched, words, coefficients=cells)
    if plan.coated is None:
        yield _stage("layered coefficients", "no [body.coating]")
    else:
        words = f"film of {plan.coated.thickness:g} m in the contact and at the output depths"
        count, tables = loads * (cells + stress_coefficients(plan)), loads * (1 + len(plan.grid.depths))
        yield _stage("layered coefficients", "", words, coefficients=count, tables=tables)
    if scene.friction is not None and plan.slip.slides:
        why_not = ""
        if not plan.slip.coupled:
            why_not = "friction.coupling = false: the traction moves no surface normally"
        elif plan.given is not None:
            why_not = "the pressure is given: the gap that the traction changes is not needed"
        elif plan.slip.coupling == 0:
            why_not = "like bodies, equal (1 - 2 nu)/mu: the traction moves both surfaces alike"
        words = "the traction moves the surfaces normally too: part of the gap"
        yield _stage("coupling", why_not, words, coefficients=cells)


def _load(scene: Scene, plan: Plan) -> Iterator[Stage]:
    """What puts the load on."""
    prescribed, steps = f'loading.prescribed = "{scene.loading.prescribed}"', plan.steps
    if plan.misfit is not None:
        words = f"{prescribed}: closed form of the elastic stress"
        yield _stage("misfit strain", "", words, steps=steps)
        yield _stage("contact search", UNTOUCHED)
    elif plan.given is not None:
        travels = ", and travels" if len(plan.schedule.path) > 1 else ""
        yield _stage("given pressure", "", prescribed + travels, steps=steps)
        yield _stage("contact search", f"{prescribed}: the pressure is given")
    else:
        way = ", then along the path" if scene.moves else ""
        yield _stage("contact search", "", f"load steps to the peak{way}", steps=steps)
        if scene.loading.path is not None:
            yield _moving(scene, scene.loading.path, plan)


def _moving(scene: Scene, path: Path, plan: Plan) -> Stage:
    """A counter-body that moves: its passes, the cells that it sweeps, and what is not used of symmetry."""
    strokes, grid = scene.strokes, plan.grid
    step = path.length / strokes.count
    way = "to and fro, the load stays on" if path.to_and_fro else "one way, unloaded at its end"
    plane = plan.track is not None and plan.track.plane
    line, radius = grid.line, plan.axes[0] if grid.line else min(plan.axes)
    of = "half-width of the contact" if line else "contact radius"
    in_steps = "" if plane else f" in steps of {step / radius:.3g} of the {of};"
    words = (
        f"the gap moves over the body, {way};{in_steps} no mirror image in x, no exchange of x and y, no "
        "pressure of an earlier pass"
    )
    if plan.plasticity is not None and not (plane or line):
        groove, strain = (c * (step / min(plan.axes)) ** n for c, n in (LEFT_OF_GROOVE, LEFT_OF_STRAIN))
        words += f"; the steps leave about {groove:.0f} % of the groove, {strain:.0f} % of the plastic strain"
    sides = zip(path.start, path.end, plan.axes, (grid.hx, grid.hy), strict=True)
    swept = [ceil((abs(end - start) + 2 * axis) / h - ROUNDING) for start, end, axis, h in sides]
    if plane:  # all of the patch stays in the apparent contact
        swept = [grid.nx, grid.ny]
    size = {"passes": strokes.cycles, "steps": strokes.count, "step_m": step, "cells": swept}
    return Stage("moving counter-body", True, words, size)


def _plastic(scene: Scene, plan: Plan) -> Iterator[Stage]:
    """What plasticity, a tribofilm and wear add; of an elastic body the film is solved in one cycle."""
    plasticity, cycles, elastic = plan.plasticity, plan.schedule.cycles, "elastic: all cycles are equal"
    if plasticity is None:
        yield _stage("eigenstrain kernels", "no [body.plasticity]")
        yield _stage("plastic loop", "no [body.plasticity]")
    else:
        words = "whether and where the elastic stress exceeds the yield stress"
        words += ", with friction.high everywhere" * (plan.slip.whole is not None)
        yield _stage("elastic peak", "", words, depths=len(plan.grid.depths))
        words = "residual stress and displacement of the plastic strain, in a box that grows"
        yield _stage("eigenstrain kernels", "", words)
        where = "the contact" if plan.given is None else "the given pressure"
        where = "the misfit strain" if plan.misfit is not None else where
        words = f"method {plan.solver.method}, {where} inside it{plasticity.of_layer}"
        steps = {"steps": plan.steps} | ({"unload_steps": plan.unload_steps} if plan.unloads else {})
        if plan.period is not None:
            held = "stress" if plan.period.free else "strain"
            words += f"; the mean of the lateral {held} is zero at each depth"
        yield Stage("plastic loop", True, words, steps)
    if cycles > 1:
        why_not = elastic * (plasticity is None)
        words = "each starts from the strain that the others left"
        yield _stage("cycles after the first", why_not, words, cycles=cycles)
    yield from _running_in(scene, plan, 1 if plasticity is None else cycles)
    if plasticity is None:
        return
    why_not, count = "", plasticity.back_stresses
    settles = "; the isotropic hardening never ends: every load settles in the end"
    words = f"exact along a constant direction of flow{settles * plasticity.grows_for_ever}"
    yield _stage("back-stresses", "no [body.plasticity.kinematic]" * (not count), words, back_stresses=count)
    words = "strains of the unloaded body after each period"
    yield _stage(VERDICT, reason_without(scene), words, periods=periods_of(scene))
    if plasticity.layer_thickness is not None and scene.wear is None:
        idle = ": body.plasticity.layer_thickness changes nothing" * (plasticity.layer is None)
        yield _stage("strain limit of the layer", f"no [wear]{idle}")


def _running_in(scene: Scene, plan: Plan, cycles: int) -> Iterator[Stage]:
    """Tribofilm and wear."""
    friction, why_not, words = scene.friction, "", ""
    if friction is None:
        why_not = "no [friction]"
    elif plan.tribofilm is None:
        why_not = f'friction.law = "{friction.law}": the coefficient is given'
    else:
        words = f"fails where it thins by more than {friction.thinning_limit:.4g}"
        if scene.moves and friction.growth_rate is not None:
            words += " in the first visit, later by the time out of contact"
        words += ", solved together with the contact in each step"
    yield _stage("chemical film", why_not, words, cycles=cycles)
    why_not = "" if plan.wear is not None else "wear.strain_limit = inf: nothing is removed"
    why_not = "no [wear]" if scene.wear is None else why_not
    words = "removal, smoothing, remap and equilibrium after each cycle"
    yield _stage("worn geometry", why_not, words, cycles=cycles)


def _output(scene: Scene, plan: Plan) -> Iterator[Stage]:
    """The way back to no force, and what is computed of the solved contact."""
    grid, yielding = plan.grid, plan.plasticity is not None
    depths, deepest = len(grid.depths), float(grid.depths[-1])
    coefficients = stress_coefficients(plan) if plan.misfit is None else 0
    if plan.unloads and not yielding:
        yield _stage("unloading", "", "elastic: in one step", steps=1)
        yield _stage("unloading steps", "elastic: unloading in one step is exact")
    else:
        why_not, words = "loading.unload = false", "in one step if that strains nothing, else in equal ones"
        yield _stage("unloading", why_not * (not plan.unloads), words, steps=plan.unload_steps)
    words = f"in the plane y = 0 at peak load{' and unloaded' if plan.unloads and yielding else ''}"
    size = {"depths": depths, "largest_depth_m": deepest, "coefficients": coefficients}
    yield Stage("stresses at the output depths", True, words, size)
    stage = "stress outside the plane y = 0"
    if plan.places.anywhere:
        words = "rough: the largest von Mises stress lies anywhere below the patch"
        yield _stage(stage, "", words, cells=[grid.nx, grid.ny], depths=depths)
    elif plan.places.beside:
        words = "the load ends beside y = 0: the largest von Mises stress lies below it"
        yield _stage(stage, "", words, cells=[grid.nx, 1], depths=depths)
    elif grid.line:
        yield _stage(stage, "a line contact: the same at every y")
    else:
        yield _stage(stage, "smooth, sliding along x: the largest von Mises stress lies in y = 0")
    why_not = "no [friction]" if scene.friction is None else "friction.coefficient = 0"
    words = "stresses of the traction, displacements along x"
    yield _stage("tangential kernels", why_not * (not plan.slip.slides), words, coefficients=coefficients)
    if plan.coated is None:
        return
    why_not = "loading.force = 0: no contact" * plan.schedule.peak.rests
    words = "the same contact and stresses without film, from the coated pressure on"
    thickness = plan.coated.thickness
    yield _stage("bare comparison", why_not, words, steps=1)
    if grid.depths[0] >= thickness:
        yield _stage("stresses in the film", f"no output depth above the interface, z = {thickness:g} m")
    if deepest < thickness:
        words = f"no output depth at or below the interface, z = {thickness:g} m"
        yield _stage("stresses in the substrate", words)


def stress_coefficients(plan: Plan) -> int:
    """Coefficients of the stresses at the output depths, of one load; below a patch all lags."""
    grid = plan.grid
    if plan.places.anywhere:
        return 6 * len(grid.depths) * grid.nx * grid.ny
    a, b = plan.axes
    lags = min(ceil(grid.nx / 2 + a / grid.hx), grid.nx) * min(ceil(b / grid.hy), grid.ny)
    return (4 if grid.ny % 2 else 6) * len(grid.depths) * lags


def _length(scene: Scene) -> str:
    """What grids are chosen from."""
    if scene.patch_surface is not None:
        return "cells and the sides of the patch"
    if scene.loading.misfit_sphere:
        return "radius of the sphere"
    if scene.counterbody is not None and scene.counterbody.length is not None:
        return "half-width of the contact"
    return "Hertz radius" if scene.body.coating is None else "estimated contact radius"


def _grid_reason(scene: Scene) -> str:
    """Where the cells come from."""
    given = scene.grid
    named = [name for name in ("cells", "extent") if given is not None and getattr(given, name) is not None]
    chosen = [name for name in ("cells", "extent") if name not in named]
    first = scene.patch_surface
    if first is not None and first.kind == "file" and (first is scene.surface or not scene.moves):
        return f"that of {first.table}.path" + (", resampled" if first.resample and "cells" in named else "")
    source = _length(scene)
    if scene.body.plasticity is not None and first is None:
        source += " and the plastic zone, enlarged if that goes further"
    parts = [f"{' and '.join(named)} from [grid]"] if named else []
    return ", ".join(parts + ([f"{' and '.join(chosen)} chosen from the {source}"] if chosen else []))
