# SPDX-License-Identifier: MIT
"""The elastic bodies of a scene, their friction, and how large their contact is to be.

The load schedule of a scene, and the pressure that it may give in place of a force.

The grid of a scene, and what a larger one is chosen from.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from math import inf, pi, sqrt
from typing import TYPE_CHECKING, Any

import numpy as np

from sam.arrays import Array
from sam.elastic.problem import GivenHertz, Looked
from sam.grid.cells import CellGrid, Sides
from sam.grid.gap import NoCounterBody, Paraboloid, Plane, Punch, Shape
from sam.grid.smooth import (
    DEFAULT_EXTENT,
    FARTHEST,
    PUNCH_EXTENT,
    ROUNDED_EXTENT,
    GridDemand,
    PlasticDemand,
    point_load_reach,
    unchanged,
)
from sam.half_space import ElasticConstants, ElasticPair, circular_contact_radius
from sam.planner import parts
from sam.results.tables import Remedies
from sam.scene import Coating, CounterBody, Friction, Grid, Loading, Scene, remedies
from sam.scene.section import stated
from sam.schedule import Coefficient, FullSlip, Load, Schedule, Target

if TYPE_CHECKING:
    from sam.elastic.misfit import MisfitSphere
    from sam.grid.rough import RoughDemand, RoughPatch
    from sam.grid.smooth import MisfitDemand


def given_pressure_of(scene: Scene) -> GivenHertz | None:
    """The pressure that a scene gives; None if a counter-body is pressed on."""
    loading = scene.loading
    return GivenHertz(stated(loading.p0), stated(loading.radius)) if loading.hertz else None


def schedule_of(scene: Scene) -> Schedule:
    """All load steps of a scene, unloading in one."""
    loading, given, strokes = scene.loading, given_pressure_of(scene), scene.strokes
    counter = scene.counter_surface
    empty = Schedule(
        (),
        _peak_of(loading, given),
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


def _peak_of(loading: Loading, given: GivenHertz | None) -> Load:
    """The largest load."""
    if loading.misfit_sphere:
        return Load(0.0, misfit=1.0)
    if loading.approach is not None:
        return Load.by_approach(loading.approach)
    return Load(stated(loading.force) if given is None else given.peak_force)


def _note(loading: Loading, load: Load) -> str:
    """What the history has no column for."""
    return f"misfit strain {stated(loading.misfit) * load.misfit:.6g}" if loading.misfit_sphere else ""


def _targets_of_cycle(scene: Scene, schedule: Schedule, cycle: int) -> list[Target]:
    """Loading, at the start of the path if there is one, the way along it, and unloading."""
    loading, stroke, last = scene.loading, scene.strokes.of_cycle(cycle), cycle == scene.loading.cycles
    sign, stretch, places = stroke.sign, schedule.stretch_of(cycle), stroke.places
    start, *along = (replace(schedule.peak, sign=sign, x=x, y=y, stretch=stretch) for x, y in places)
    up = [start.part(k, loading.steps) for k in range(1, loading.steps + 1)] if stroke.pressed else []
    targets = [Target(cycle, k, load, True, note=_note(loading, load)) for k, load in enumerate(up, start=1)]
    for k, load in enumerate(along, start=len(up) + 1):
        note = f"load at x = {load.x:.6g} m, y = {load.y:.6g} m" if scene.counterbody is None else ""
        targets.append(Target(cycle, k, load, True, note=note))
    if last:
        targets[-1] = replace(targets[-1], snapshot="peak")
    if stroke.unloads:
        name, zero = "unloaded" if last else "", Load(0.0, sign, *places[-1], stretch=stretch)
        targets.append(Target(cycle, len(targets) + 1, zero, False, name, elastic_unloading=True))
    return targets


STRONG = (
    3.0  # coefficient of friction, beyond that of surfaces in air, that may keep a contact from being found
)


def pair_of(scene: Scene) -> ElasticPair:
    """The elastic constants of the body and of an elastic counter-body."""
    body, other = scene.body, scene.counterbody
    counterpart = None
    if other is not None and other.elastic:
        counterpart = ElasticConstants(stated(other.young), stated(other.poisson))
    return ElasticPair(ElasticConstants(body.young, body.poisson), counterpart)


def _by_hertz(scene: Scene, other: CounterBody) -> tuple[float, float]:
    radii = rx, ry = stated(other.radii)
    force, modulus = expected_force(scene), pair_of(scene).contact_modulus
    if rx == ry:
        a = circular_contact_radius(force, rx, modulus)
        return a, a
    return parts.ellipse(force, radii, modulus)


def _force_of_hertz(scene: Scene, other: CounterBody, approach: float) -> float:
    """With the geometric mean of the radii, and the mean compliance of a coated body."""
    pair, coating, plasticity = pair_of(scene), scene.body.coating, scene.body.plasticity
    rx, ry = stated(other.radii)
    radius = sqrt(rx * ry)
    compliance, a = 1 / pair.contact_modulus, sqrt(radius * approach)
    if coating is not None:
        compliance = parts.coated_compliance(parts.coated_pair(coating, pair), a)
    force = 4 * a * approach / (3 * compliance)
    if plasticity is None:
        return force
    bulk = float(plasticity.strength().stress(np.inf, np.array(0.2 * sqrt(2) * a / radius)))
    return min(force, 3 * bulk * 2 * pi * a**2)


def _end_of_punch(_: Scene, other: CounterBody) -> tuple[float, float]:
    return stated(other.radius), stated(other.radius)


def _force_on_punch(scene: Scene, other: CounterBody, approach: float) -> float:
    return 2 * pair_of(scene).contact_modulus * stated(other.radius) * approach


def _by_rounded_edge(scene: Scene, other: CounterBody) -> tuple[float, float]:
    modulus = pair_of(scene).contact_modulus
    a = parts.rounded_punch(other).contact_radius(expected_force(scene), modulus)
    return a, a


def _force_on_rounded_edge(scene: Scene, other: CounterBody, approach: float) -> float:
    """At most 3 times the yield stress on the part of the punch that is below the surface."""
    punch, plasticity = parts.rounded_punch(other), scene.body.plasticity
    force = punch.force(punch.radius_at(approach), pair_of(scene).contact_modulus)
    if plasticity is None:
        return force
    beyond = sqrt(2 * punch.radius * approach)
    bulk = float(plasticity.strength().stress(np.inf, np.array(0.2 * beyond / punch.radius)))
    return min(force, 3 * bulk * pi * (punch.flat + beyond) ** 2)


def _finest_of_rounded_edge(scene: Scene, other: CounterBody) -> float:
    return parts.rounded_punch(other).largest_cell(_by_rounded_edge(scene, other)[0])


def _half_of_patch(scene: Scene, _: CounterBody) -> tuple[float, float]:
    lx, ly = scene.patch[1]
    return lx / 2, ly / 2


@dataclass(frozen=True)
class Opposite:
    """What the model asks of a shape: its gap; the semi-axes (a along x, b along y) in m of its contact with
    the body without coating, 0 where there is none without force; whether the force leaves them as they are;
    about which force in N an approach in m takes; the sides of a chosen grid in contact radii, and the
    largest cell in m that resolves the contact.
    """

    gap: Callable[[CounterBody], Shape]
    semi_axes: Callable[[Scene, CounterBody], tuple[float, float]]
    given: bool = False
    force: Callable[[Scene, CounterBody, float], float] = _force_of_hertz
    extent: float = DEFAULT_EXTENT
    largest_cell: Callable[[Scene, CounterBody], float] = lambda scene, other: inf


SHAPES = {
    "sphere": Opposite(lambda other: Paraboloid(stated(other.radii)), _by_hertz),
    "ellipsoid": Opposite(lambda other: Paraboloid(stated(other.radii)), _by_hertz),
    "punch": Opposite(
        lambda other: Punch(stated(other.radius)), _end_of_punch, True, _force_on_punch, PUNCH_EXTENT
    ),
    "rounded-punch": Opposite(
        parts.rounded_punch,
        _by_rounded_edge,
        force=_force_on_rounded_edge,
        extent=ROUNDED_EXTENT,
        largest_cell=_finest_of_rounded_edge,
    ),
    "flat": Opposite(lambda other: Plane(), _half_of_patch),
}
"""The shapes of a scene."""


def shape_of(scene: Scene) -> Shape:
    """The shape of the counter-body."""
    other = scene.counterbody
    return NoCounterBody() if other is None else SHAPES[other.shape].gap(other)


def hertz_semi_axes(scene: Scene) -> tuple[float, float]:
    """Contact semi-axes (a along x, b along y) in m by Hertz or what takes his place, for the body without
    coating.

    The radius twice for a punch and for a given Hertz pressure; half the sides of the patch for a plane.

    Parameters
    ----------
    scene
        Any valid scene.

    Returns
    -------
    tuple of float
        a and b in m.
    """
    other = scene.counterbody
    if other is None:
        return stated(scene.loading.radius), stated(scene.loading.radius)
    return SHAPES[other.shape].semi_axes(scene, other)


def largest_cell(scene: Scene) -> float:
    """The largest cell in m that resolves the contact of a smooth scene with its counter-body."""
    other = scene.counterbody
    return inf if other is None else SHAPES[other.shape].largest_cell(scene, other)


def expected_force(scene: Scene) -> float:
    """The force in N at the peak: the given one, or an estimate from the approach, from which the grid of a
    smooth scene is chosen.

    Parameters
    ----------
    scene
        Any valid scene with a counter-body.

    Returns
    -------
    float
        In N. Of a body that yields not more than its fully plastic contact bears: a^2 = 2 R approach, and 3
        times the yield stress at the strain 0.2 a/R (Tabor 1951).
    """
    approach, other = scene.loading.approach, stated(scene.counterbody)
    if approach is None:
        return stated(scene.loading.force)
    return SHAPES[other.shape].force(scene, other, approach)


def misfit_of(scene: Scene) -> MisfitSphere | None:
    """The misfit sphere that loads the body; None if it is loaded at its surface."""
    if not scene.loading.misfit_sphere:
        return None
    return parts.misfit_sphere(scene, ElasticConstants(scene.body.young, scene.body.poisson))


def misfit_zone(scene: Scene) -> float:
    """Radius of the plastic zone about a misfit sphere in an infinite body, from which the grid is chosen.

    Parameters
    ----------
    scene
        Any valid scene.

    Returns
    -------
    float
        In m; 0 where nothing yields, as in an elastic body, and without a misfit sphere.
    """
    plasticity, sphere = scene.body.plasticity, misfit_of(scene)
    if plasticity is None or sphere is None:
        return 0.0
    return sphere.zone(float(plasticity.strength().stress(sphere.depth, np.zeros(1))[0]))


def slip_of(scene: Scene, pair: ElasticPair, grid: CellGrid) -> FullSlip:
    """The friction of a scene at the cells of a grid."""
    friction = scene.friction
    if friction is None:
        return FullSlip()
    mu = _coefficient(friction, grid)
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


def _coefficient(friction: Friction, grid: CellGrid) -> Coefficient:
    """The coefficient that a scene gives: a number, or a map at the cells. With a tribofilm that of a whole
    one.
    """
    if friction.law == "map":
        found = stated(friction.path)
        if found.cells != grid.shape:
            raise ValueError(f"{found!r} is no map of {grid.nx} x {grid.ny} cells")
        values: Array = stated(found.values)
        return values
    return stated(friction.low if friction.film else friction.coefficient)


def looked_of(scene: Scene, schedule: Schedule) -> Looked:
    """Where the largest stress and the contact may be."""
    rough, last = scene.patch_surface is not None, schedule.targets[-1].load
    end = last.x, last.y
    return Looked(anywhere=rough, beside=end[1] != 0.0, off_origin=rough or any(end))


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


SMALLEST = 1e-3  # of the radius of curvature: takes the place of the contact radius of a scene without force


def demand_of(scene: Scene, pair: ElasticPair) -> GridDemand:
    """What the grid of a smooth scene is chosen from: the contact and the plastic zone that are to be
    expected.
    """
    coating, other = scene.body.coating, scene.counterbody
    (a, b), wider = hertz_semi_axes(scene), 1.0
    if a == 0.0:
        a, b = (SMALLEST * r for r in stated(stated(other).radii))
    elif coating is not None:
        scale = contact_scale(scene, pair, coating)
        a, b, wider = a * scale, b * scale, parts.room_for_bare(scale)
    return GridDemand(
        scene.grid,
        (a, b),
        DEFAULT_EXTENT if other is None else SHAPES[other.shape].extent,
        wider,
        _farthest(scene),
        _plastic_demand(scene, min(a, b)),
        unchanged if coating is None else parts.coated_depths(coating.thickness),
        moves=scene.moves,
        largest_cell=largest_cell(scene),
    )


def rough_demand_of(scene: Scene, patch: RoughPatch) -> RoughDemand:
    """What the grid of a rough scene is chosen from: the patch, and the plastic zone that is to be expected
    under a force; under a given approach only the patch.
    """
    coating, widest, reach = scene.body.coating, min(patch.extent) / 2, 0.0
    plastic = None if scene.loading.approach is not None else _plastic_demand(scene, widest / FARTHEST)
    if plastic is not None:
        reach = plastic.reach
    with_coating = unchanged if coating is None else parts.coated_depths(coating.thickness)
    return parts.rough_demand(patch, scene.grid, scene.body.plasticity, with_coating, reach=reach)


def misfit_demand_of(scene: Scene, sphere: MisfitSphere) -> MisfitDemand:
    """What the grid about a misfit sphere is chosen from."""
    zone = None if scene.body.plasticity is None else misfit_zone(scene)
    return parts.misfit_demand(scene.grid, sphere.depth, sphere.radius, zone)


def contact_scale(scene: Scene, pair: ElasticPair, coating: Coating) -> float:
    """Estimated contact radius over that of the bare body; 1 where the radius is given (punch, given
    pressure) and without force.

    An ellipse is scaled like the circle under a sphere with the geometric mean of its radii, and what has no
    radii of curvature like the sphere of the same contact with the bare body.
    """
    other = scene.counterbody
    if other is None or SHAPES[other.shape].given:
        return 1.0
    force, radii = expected_force(scene), other.radii
    if force == 0.0:
        return 1.0
    coated = parts.coated_pair(coating, pair)
    if radii is None:
        a, b = hertz_semi_axes(scene)
        radius = 4 / 3 * pair.contact_modulus * sqrt(a * b) ** 3 / force  # Johnson 1985, Eq. 4.22
    else:
        radius = sqrt(radii[0] * radii[1])
    of_coating = 1 / (ElasticConstants(coating.young, coating.poisson).compliance + coated.compliance)
    bare = (
        circular_contact_radius(force, radius, pair.contact_modulus),
        circular_contact_radius(force, radius, of_coating),
    )
    return parts.coated_scale(coated, force, radius, bare)


def _farthest(scene: Scene) -> tuple[float, float]:
    """Largest |x| and |y| in m of the centre of a travelling load; zero without path."""
    path = scene.loading.path
    if path is None:
        return 0.0, 0.0
    x, y = (max(map(abs, ends)) for ends in zip(path.start, path.end, strict=True))
    return x, y


def _plastic_demand(scene: Scene, radius: float) -> PlasticDemand | None:
    """What plasticity asks of the grid of a scene; radius: of the contact in m, or of the widest one that
    there may be.
    """
    plasticity, given = scene.body.plasticity, given_pressure_of(scene)
    if plasticity is None:
        return None
    force = expected_force(scene) if given is None else given.peak_force
    strength = plasticity.strength()

    def reach(z: float) -> float:
        limit = float(strength.stress(z, np.zeros(1))[0])
        return point_load_reach(force, scene.body.poisson, limit, radius)

    within = min(reach(np.nextafter(strength.thickness, 0.0)), strength.thickness)
    return PlasticDemand(max(reach(np.inf), within), strength.kinks.depths)


def halved(count: int) -> int:
    """About half of a number of cells, odd if it is odd: a cell centre then stays on the apex."""
    return 2 * round((count - 1) / 4) + 1 if count % 2 else 2 * round(count / 4)


def coarse(scene: Scene, grid: CellGrid) -> Scene:
    """The scene on half as many cells over the same extent, its layers twice as thick if it gives them."""
    given, cells = scene.grid or Grid(), (halved(grid.nx), halved(grid.ny))
    change: dict[str, Any] = {"cells": cells, "extent": (grid.nx * grid.hx, grid.ny * grid.hy)}
    if scene.body.plasticity is not None and given.depths:
        change["depths"] = given.depths[::2]
    elif scene.body.plasticity is not None and given.layers:
        change["layers"] = given.layers // 2
    solver = scene.solver.model_copy(update={"extrapolate": False})
    return scene.model_copy(update={"grid": given.model_copy(update=change), "solver": solver})


def given_sides(scene: Scene) -> Sides:
    """The sides of the grid that the scene gives; a rough one gives those of its patch."""
    given, rough = scene.grid, scene.patch_surface is not None
    return Sides(
        beside=rough or (given is not None and bool(given.cells or given.extent)),
        below=given is not None and bool(given.depths or given.layers),
    )
