# SPDX-License-Identifier: MIT
"""The grid of a scene, and what a larger one is chosen from."""

from __future__ import annotations

from math import sqrt
from typing import TYPE_CHECKING, Any

import numpy as np

from sam.grid.cells import CellGrid
from sam.grid.enlargement import Sides
from sam.grid.smooth import DEFAULT_EXTENT, FARTHEST, GridDemand, PlasticDemand, point_load_reach, unchanged
from sam.half_space import ElasticConstants, ElasticPair, circular_contact_radius
from sam.planner import parts
from sam.planner.bodies import SHAPES, expected_force, hertz_semi_axes, largest_cell, misfit_zone
from sam.planner.schedules import given_pressure_of
from sam.scene import Coating, Grid, Scene
from sam.scene.section import stated

if TYPE_CHECKING:
    from sam.elastic.misfit import MisfitSphere
    from sam.grid.misfit import MisfitDemand
    from sam.grid.rough import RoughDemand, RoughPatch

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
