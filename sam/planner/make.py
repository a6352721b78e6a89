# SPDX-License-Identifier: MIT
"""From a scene to its plan, or to the reason why the semi-analytical model cannot solve it; and the stages of
a plan, in the order in which they begin: those that run with their sizes, and why others are left out.

A stage runs where the plan has the part that it works on; nothing else decides on it. What only the solve can
tell, as the size of the plastic zone, is not among the sizes.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from math import ceil, inf, nan

import numpy as np

from sam.arrays import ROUNDING
from sam.contact.operators import PeriodicHalfSpaces
from sam.elastic.problem import Places, Plan
from sam.grid.cells import CellGrid, Room
from sam.grid.demands import (
    EVEN_DEPTH,
    MOST_ACROSS,
    MOST_CELLS,
    MOST_LAYERS,
    PLASTIC_CELLS,
    GridDemand,
    RoughPatch,
    step_across,
)
from sam.half_space import ElasticPair
from sam.moving import Track
from sam.planner.bodies import Bodies, coarse, given_sides
from sam.results.tables import Remedies
from sam.scene import CounterBody, LeftOut, Path, Scene, Stage, remedies
from sam.scene.result import NO_FORCE
from sam.scene.section import stated
from sam.scene.verdict import VERDICT, counts_dissipation, judging_of, periods_of, reason_without
from sam.schedule import Coefficient, FullSlip, Load, Schedule, Target
from sam.tribofilm.law import FilmLaw
from sam.tribofilm.state import FilmOnCells
from sam.wear import WearLaw, limit_by_depth

WHOLE = 1e-6  # of a wave: so much more or less still repeats
STRONG = 3.0  # coefficient of friction, beyond that in air, that may keep a contact from being found


def plan(scene: Scene) -> Plan:
    """The plan of a scene that `check` allows: what runs, on which grid, through which load steps, and what
    is left out and why. ValueError for a map of friction that is of another grid.
    """
    return plan_of(Bodies(scene))


def plan_of(bodies: Bodies) -> Plan:
    """The plan of the scene of some bodies, see `plan`."""
    scene, schedule, words = bodies.scene, schedule_of(bodies.scene), remedies_of(bodies.scene)
    friction, plasticity = scene.friction, scene.body.plasticity
    grid = bodies.demand.grid(Room())
    track = track_of(scene, bodies.axes) if scene.moves else None
    film = wear = None
    if friction is not None and friction.film:
        visits = (None, None) if track is None else (track.growth_rate, track.period)
        film = FilmOnCells(FilmLaw.of(friction), grid.shape, *visits)
    if scene.wear is not None and scene.wear.removes:
        limits = limit_by_depth(scene.wear, None if plasticity is None else plasticity.layer_thickness)
        wear = WearLaw(grid.shape, grid.hx, grid.hy, limits, scene.wear, grid.wraps)
    rough, last = bodies.patch, schedule.targets[-1].load
    made = Plan(
        grid=grid,
        pair=bodies.pair,
        shape=bodies.shape,
        axes=bodies.axes,
        schedule=schedule,
        slip=slip_of(scene, bodies.pair, grid),
        places=Places(rough is not None, last.y != 0.0, rough is not None or bool(last.x or last.y)),
        solver=scene.solver,
        remedies=words,
        given_sides=given_sides(scene),
        demand=bodies.demand,
        given=bodies.given,
        misfit=bodies.misfit,
        track=track,
        coated=bodies.coated,
        rough=rough,
        plasticity=plasticity,
        tribofilm=film,
        wear=wear,
        judging=judging_of(scene),
        dissipates=counts_dissipation(scene),
        period=PeriodicHalfSpaces(free=scene.loading.lateral == "free") if grid.periodic else None,
        coarser=plan(coarse(scene, grid)) if scene.solver.extrapolate else None,
    )
    return replace(made, stages=stages_of(scene, made))


def schedule_of(scene: Scene) -> Schedule:
    """All load steps of a scene, unloading in one."""
    loading, strokes, counter = scene.loading, scene.strokes, scene.counter_surface
    if loading.misfit_sphere:
        peak = Load(0.0, misfit=1.0)
    elif loading.approach is not None:
        peak = Load.by_approach(loading.approach)
    else:
        given = Bodies(scene).given
        peak = Load(stated(scene.force) if given is None else given.peak_force)
    empty = Schedule(
        (),
        peak,
        loading.unload_steps or loading.steps,
        strokes.places(),
        loading.cycles,
        strokes.of_cycle(2).sign != strokes.of_cycle(1).sign,
        renews=counter is not None and counter.renewed,
        returns=loading.path is not None and loading.path.to_and_fro,
        remembers=scene.moves and scene.friction is not None and scene.friction.film,
        varies=scene.moves and scene.patch_surface is not None,
    )
    cycles = range(1, loading.cycles + 1)
    targets = [target for cycle in cycles for target in _targets_of_cycle(scene, empty, cycle)]
    return replace(empty, targets=tuple(targets))


def _targets_of_cycle(scene: Scene, schedule: Schedule, cycle: int) -> list[Target]:
    """Loading, at the start of the path if there is one, the way along it, and unloading."""
    loading, stroke, last = scene.loading, scene.strokes.of_cycle(cycle), cycle == scene.loading.cycles
    sign, stretch, places = stroke.sign, cycle - 1 if schedule.renews else 0, stroke.places
    start, *along = (replace(schedule.peak, sign=sign, x=x, y=y, stretch=stretch) for x, y in places)
    targets = []
    for k in range(1, loading.steps + 1) if stroke.pressed else ():
        load, note = start.part(k, loading.steps), ""  # what the history has no column for
        if loading.misfit_sphere:
            note = f"misfit strain {stated(loading.misfit) * load.misfit:.6g}"
        targets.append(Target(cycle, k, load, True, note=note))
    for k, load in enumerate(along, start=len(targets) + 1):
        note = f"load at x = {load.x:.6g} m, y = {load.y:.6g} m" if scene.counterbody is None else ""
        targets.append(Target(cycle, k, load, True, note=note))
    if last:
        targets[-1] = replace(targets[-1], snapshot="peak")
    if stroke.unloads:
        name, zero = "unloaded" if last else "", Load(0.0, sign, *places[-1], stretch=stretch)
        targets.append(Target(cycle, len(targets) + 1, zero, False, name, elastic_unloading=True))
    return targets


def slip_of(scene: Scene, pair: ElasticPair, grid: CellGrid) -> FullSlip:
    """The friction of a scene at the cells of a grid; ValueError for a map of another grid."""
    friction = scene.friction
    if friction is None:
        return FullSlip()
    mu: Coefficient
    if friction.law == "map":
        heights = stated(friction.path)
        if heights.cells != grid.shape:
            raise ValueError(f"{heights!r} is no map of {grid.nx} x {grid.ny} cells")
        mu = stated(heights.values)
    else:
        mu = stated(friction.low if friction.film else friction.coefficient)
    coupling = 0.0
    if friction.coupling:
        coupling = pair.tangential_mismatch if scene.body.coating is None else 1.0
    return FullSlip(
        slides=scene.coefficient > 0,
        coefficient=mu,
        highest=stated(friction.high) if friction.film else mu,
        coupled=friction.coupling,
        coupling=coupling,
        whole=friction.low if friction.film else None,
    )


def track_of(scene: Scene, axes: tuple[float, float]) -> Track:
    """The track of a counter-body that moves; axes: of the contact in m."""
    path, other, strip = stated(scene.loading.path), stated(scene.counterbody), scene.counter_strip
    plane, period, friction, rate = other.shape == "flat", path.length, scene.friction, None
    curvatures = (0.0, 0.0) if plane else None
    if other.radii is not None:
        curvatures = 1 / other.radii[0], 1 / other.radii[1]
    elif other.length is not None:
        curvatures = 1 / stated(other.radius), 0.0
    carries = 1.0
    if plane:  # summits carry it, of the counter-body alone or of both
        carries = stated(strip).slip if scene.surface is None else 0.0
    if friction is not None and friction.growth_rate is not None:
        rate = friction.growth_rate
        if not (plane or path.to_and_fro):
            period = stated(friction.track)
    return Track(
        path.start,
        path.end,
        axes[0],
        curvatures,
        path.length / scene.strokes.count,
        plane=plane,
        carries=carries,
        strip=strip,
        period=period,
        returns=path.to_and_fro,
        growth_rate=rate,
        speed=nan if friction is None or rate is None else stated(friction.speed),
    )


def remedies_of(scene: Scene) -> Remedies:
    """What may be changed of a scene, in words."""
    return Remedies(
        finer_cells=remedies.finer_cells(scene),
        smaller_patch=remedies.smaller_patch(scene),
        larger_patch=remedies.larger_patch(scene),
        less_load=remedies.less_load(scene),
        slower=remedies.less_friction(scene) if scene.coefficient > STRONG else "",
        more_steps=remedies.more_steps(scene),
        looser=remedies.looser(scene),
    )


def left_out(scene: Scene) -> list[LeftOut]:
    """The stages that a scene does not need, and why, as its plan has them."""
    return plan(scene).left_out


def choose_grid(scene: Scene) -> CellGrid:
    """The cells and depths of a scene, as its plan has them: those of [grid], and what it leaves out chosen
    from the contact and the plastic zone that are to be expected.
    """
    return plan(scene).grid


class UnsupportedScene(ValueError):  # noqa: N818 - the name that callers of both models know
    """A valid scene that the model cannot solve; the message names key, value and what is allowed."""


def check(scene: Scene) -> None:
    """Raise UnsupportedScene for a scene that the model cannot solve.

    That is for a coating where anything yields, as the coefficients of plastic strain hold for a homogeneous
    body; for no force on a shape from which no size of the grid follows; for a plastic scene whose cells are
    so small that layers as thick would be too many; for a rounded edge that the cells do not resolve; for a
    surface of which only the digest is known, or that does not repeat as it is to.
    """
    check_bodies(Bodies(scene))


def check_bodies(bodies: Bodies) -> None:
    """Refuse the scene of some bodies, see `check`."""
    scene = bodies.scene
    plasticity, other = scene.body.plasticity, scene.counterbody
    _check_coating(scene)
    if other is not None and other.radii is None and min(bodies.axes) == 0.0:
        raise UnsupportedScene(
            f'loading.force = {scene.loading.force} N: with counterbody.shape = "{other.shape}" the '
            f"semi-analytical model allows a force above 0, as nothing else says how large the grid is"
        )
    # a plastic zone that reaches a held surface would change the tractions that hold it
    if (sphere := bodies.misfit) is not None and not sphere.free and bodies.zone >= sphere.depth:
        raise UnsupportedScene(
            f'loading.depth = {sphere.depth:g} m: with surface = "held" more than {bodies.zone:g} m is '
            f"allowed, the radius of the plastic zone"
        )
    if other is not None and scene.patch_surface is None and bodies.largest_cell < inf:
        _check_cells(scene, other, bodies.smooth_demand)
    for surface in (scene.surface, scene.counter_surface):
        if surface is not None and surface.path is not None and surface.path.values is None:
            raise UnsupportedScene(
                f"{surface.table}.path = {surface.path!r}: only its digest is at hand, read the scene file"
            )
    if bodies.patch is not None and scene.grid is not None and scene.grid.periodic is not None:
        _check_period(scene, bodies.patch)
    given = scene.grid
    if plasticity is None or given is None or given.extent is None or given.depths or given.layers:
        return
    thickness = min(np.divide(given.extent, given.cells or (PLASTIC_CELLS, PLASTIC_CELLS)))
    axes = (2 * sphere.depth,) * 2 if sphere is not None else bodies.axes
    layers = EVEN_DEPTH * min(axes) / thickness
    if layers > MOST_LAYERS:
        extent = " and ".join(f"{side:g} m" for side in given.extent)
        raise UnsupportedScene(
            f"grid.extent = {extent}: {layers:.3g} layers as thick as a cell, at most {MOST_LAYERS} are "
            f"allowed: raise it, or give grid.layers and grid.depth"
        )


def _check_period(scene: Scene, patch: RoughPatch) -> None:
    """Surfaces that do not repeat, an approach at which the patch touches all over, and cells and operators
    that there are not; below a cylinder what does not repeat along y.
    """
    axes = (0, 1) if patch.periodic else (1,)
    counter, approach, wrong = scene.counter_surface, scene.loading.approach, list[str]()
    for stretch in range(scene.loading.cycles if counter is not None and counter.renewed else 1):
        opposite = np.zeros(patch.cells) if counter is None else patch.counter_heights(stretch, (0.0, 0.0))
        for surface, heights in ((patch.surface, patch.of_body), (counter, opposite)):
            if surface is None:
                continue
            along = surface.feed or surface.wavelength_x, surface.wavelength_y
            wrong += [
                f"grid.extent = {side:g} m: a whole multiple of {wave:g} m, a wave of the {surface.words},"
                for side, wave in ((patch.extent[axis], along[axis]) for axis in axes)
                if wave is not None and abs(side / wave - round(side / wave)) > WHOLE
            ]
            if surface.kind == "file" and (step := step_across(heights, axes)) > MOST_ACROSS:
                wrong.append(
                    f"{surface.table}.path = {surface.path!r}: a step across the border of "
                    f"{MOST_ACROSS:g} times the rms step between neighbouring cells, not {step:.3g}, or "
                    f"{surface.table}.taper"
                )
        gap = patch.of_body + opposite
        if approach is not None and approach >= (most := float(gap.max() - gap.mean())):
            words = "the mean of the gap at first touch, at which all of the patch touches,"
            wrong.append(
                f"loading.approach = {approach:g} m: to give a force, or less than {most:.4g} m, {words}"
            )
    if patch.periodic and scene.body.plasticity is not None and any(n % 2 for n in patch.cells):
        wrong.append(f"grid.cells = {list(patch.cells)}: with [body.plasticity] even numbers of cells")
    if scene.solver.operator == "dense":
        wrong.append('solver.operator = "dense": "swept"')
    if wrong:
        raise UnsupportedScene("; ".join(f"{each} is allowed with grid.periodic" for each in wrong))


def _check_coating(scene: Scene) -> None:
    coating, plasticity = scene.body.coating, scene.body.plasticity
    if coating is not None:
        allowed = "the semi-analytical model allows an elastic coating on an elastic body; fem-axisymmetric"
        if plasticity is not None:
            raise UnsupportedScene(
                f'body.coating together with body.plasticity (law = "{plasticity.law}"): {allowed} solves it'
            )
        if coating.yield_stress is not None:
            stress = f"body.coating.yield_stress = {coating.yield_stress:g} Pa"
            raise UnsupportedScene(f"{stress}: {allowed} solves it")


def _check_cells(scene: Scene, other: CounterBody, demand: GridDemand) -> None:
    """A contact that the cells of a smooth scene do not resolve: too few of them, or too many needed."""
    given = scene.grid
    needs = f"the rounded edge in contact needs cells of at most {demand.largest_cell:.3g} m"
    if given is not None and given.cells:
        cell = max(np.divide(demand.sides((demand.usual,) * 2), given.cells))
        if cell > demand.largest_cell * (1 + ROUNDING):
            least = ceil(max(given.cells) * cell / demand.largest_cell - ROUNDING)
            raise UnsupportedScene(
                f"grid.cells = {list(given.cells)}: {needs}, these have {cell:.3g} m: at least "
                f"{least} x {least} are allowed, fewer with a smaller grid.extent, or leave out [grid]"
            )
    elif demand.usual > MOST_CELLS:
        raise UnsupportedScene(
            f"counterbody.radius = {other.radius} m: {needs}, {demand.usual} x {demand.usual} of them; at "
            f"most {MOST_CELLS} x {MOST_CELLS} are chosen: raise it, give grid.cells, or take "
            f'shape = "punch"'
        )


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
        steps = {"steps": plan.steps} | ({"unload_steps": plan.unload_steps} if plan.schedule.unloads else {})
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
    if plan.schedule.unloads and not yielding:
        yield _stage("unloading", "", "elastic: in one step", steps=1)
        yield _stage("unloading steps", "elastic: unloading in one step is exact")
    else:
        why_not, words = "loading.unload = false", "in one step if that strains nothing, else in equal ones"
        yield _stage("unloading", why_not * (not plan.schedule.unloads), words, steps=plan.unload_steps)
    words = f"in the plane y = 0 at peak load{' and unloaded' if plan.schedule.unloads and yielding else ''}"
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
