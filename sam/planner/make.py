# SPDX-License-Identifier: MIT
"""From a scene to its plan, or to the reason why the semi-analytical model cannot solve it."""

from __future__ import annotations

from dataclasses import replace
from math import ceil, inf

import numpy as np

from sam.arrays import ROUNDING
from sam.contact.periodic import PeriodicHalfSpaces
from sam.elastic.problem import Places, Plan
from sam.grid.cells import CellGrid, Room
from sam.grid.rough import MOST_ACROSS, RoughPatch, step_across
from sam.grid.smooth import EVEN_DEPTH, MOST_CELLS, MOST_LAYERS, PLASTIC_CELLS, GridDemand
from sam.half_space import ElasticPair
from sam.moving import Growth, Track
from sam.planner.bodies import Bodies, coarse, given_sides
from sam.planner.stages import stages_of
from sam.results.tables import Remedies
from sam.scene import CounterBody, LeftOut, Scene, remedies
from sam.scene.section import stated
from sam.scene.verdict import counts_dissipation, judging_of
from sam.schedule import Coefficient, FullSlip, Load, Schedule, Target
from sam.tribofilm.law import FilmLaw
from sam.tribofilm.state import FilmOnCells, VisitLaw
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
        visited = None
        if track is not None:
            visited = VisitLaw(None if track.growth is None else track.growth.rate, track.period)
        film = FilmOnCells(FilmLaw.of(friction), grid.shape, visited)
    if scene.wear is not None and scene.wear.removes:
        limits = limit_by_depth(scene.wear, None if plasticity is None else plasticity.layer_thickness)
        wear = WearLaw(
            grid.shape,
            grid.hx,
            grid.hy,
            limits,
            scene.wear.interpolate,
            scene.wear.smoothing_window,
            scene.wear.smoothing_order,
            grid.wraps,
            roof_falls=scene.wear.roof == "falls",
            fills=scene.wear.smoothing_fills,
        )
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
        period=period_of(scene),
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


def period_of(scene: Scene) -> PeriodicHalfSpaces | None:
    """Both bodies of a patch that repeats; None if it does not."""
    if scene.grid is None or scene.grid.periodic != "xy":
        return None
    return PeriodicHalfSpaces(free=scene.loading.lateral == "free")


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
    plane, period, friction, growth = other.shape == "flat", path.length, scene.friction, None
    curvatures = (0.0, 0.0) if plane else None
    if other.radii is not None:
        curvatures = 1 / other.radii[0], 1 / other.radii[1]
    elif other.length is not None:
        curvatures = 1 / stated(other.radius), 0.0
    carries = 1.0
    if plane:  # summits carry it, of the counter-body alone or of both
        carries = stated(strip).slip if scene.surface is None else 0.0
    if friction is not None and friction.growth_rate is not None:
        growth = Growth(friction.growth_rate, stated(friction.speed))
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
        growth=growth,
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
