# SPDX-License-Identifier: MIT
"""The elastic bodies and the grid of a scene, and the scenes that have none of a size that can be meant."""

from __future__ import annotations

from functools import partial
from math import sqrt

import numpy as np

from sam.arrays import Array
from sam.grid.cells import CellGrid, Room
from sam.grid.enlargement import Sides
from sam.grid.gap import NoCounterBody, Paraboloid, Plane, Punch, Shape, initial_gap
from sam.grid.smooth import (
    FIRST_CHOICE,
    MOST_LAYERS,
    PLASTIC_CELLS,
    GridDemand,
    PlasticDemand,
    layers_as_thick_as_a_cell,
    point_load_reach,
    smooth_grid,
    unchanged,
)
from sam.half_space import ElasticConstants, ElasticPair, circular_contact_radius
from sam.loading import peak_force
from sam.scene import Scene


class UnsupportedScene(ValueError):  # noqa: N818 - the name that callers of both models know
    """A valid scene that the model cannot solve; the message names key, value and what is allowed."""


def pair_of(scene: Scene) -> ElasticPair:
    """The elastic constants of the body and of an elastic counter-body."""
    body, other = scene.body, scene.counterbody
    elastic = other is not None and other.elastic
    return ElasticPair(
        ElasticConstants(body.young, body.poisson),
        ElasticConstants(other.young, other.poisson) if elastic else None,
    )


def shape_of(scene: Scene) -> Shape:
    """The shape of the counter-body."""
    other = scene.counterbody
    if other is None:
        return NoCounterBody()
    if other.shape == "punch":
        return Punch(other.radius)
    return Plane() if other.shape == "flat" else Paraboloid(other.radii)


def gap_of(scene: Scene, grid: CellGrid) -> Array:
    """Initial gap at the cell centres, (nx, ny) in m; see `sam.grid.gap.initial_gap`."""
    if scene.surface is None:
        return initial_gap(shape_of(scene), grid)
    from sam.grid.rough import RoughPatch

    return initial_gap(shape_of(scene), grid, RoughPatch.of(scene.surface, scene.grid).heights())


def coupling_of(scene: Scene, coefficient: float | Array) -> float | Array:
    """2 beta mu, with which the traction enters the gap (see sam.contact.normal); zero for the decoupled form
    of the paper.

    coefficient: mu, a number or (nx, ny). With a coating the result is mu: 2 beta is then a function of the
    wave number, and part of the coefficients (see sam.contact.bodies).
    """
    if scene.friction is None or not scene.friction.coupling:
        return 0.0
    if scene.body.coating is not None:
        return coefficient
    return pair_of(scene).tangential_mismatch * coefficient


def hertz_semi_axes(scene: Scene) -> tuple[float, float]:
    """Contact semi-axes (a along x, b along y) in m by Hertz, for the body without coating.

    The radius twice for a punch and for a given Hertz pressure; half the sides of the patch for a plane.
    """
    loading, other = scene.loading, scene.counterbody
    if loading.prescribed:
        return loading.radius, loading.radius
    if other.shape == "punch":
        return other.radius, other.radius
    if other.shape == "flat":
        from sam.scene.surface import patch_of

        lx, ly = patch_of(scene.surface, scene.grid)[1]
        return lx / 2, ly / 2
    modulus, (rx, ry) = pair_of(scene).contact_modulus, other.radii
    if rx == ry:
        a = circular_contact_radius(loading.force, rx, modulus)
        return a, a
    from sam.grid.ellipse import elliptic_contact

    return elliptic_contact(loading.force, other.radii, modulus)


def choose_grid(scene: Scene, room: Room = FIRST_CHOICE) -> CellGrid:
    """The grid of a scene.

    What `[grid]` leaves out is chosen: from the contact and the plastic zone that are to be expected
    (`sam.grid.smooth`), of a rough body from its cells (`sam.grid.rough`), of a coated one with depths in the
    coating too (`sam.grid.coated`). A scene without force has no contact radius; a thousandth of the radius
    of curvature takes its place.

    Parameters
    ----------
    scene : Scene
        A scene that `check` allows.
    room : Room, optional
        Factors on the sides and on the depth that are chosen, see `sam.grid.enlargement`.

    Returns
    -------
    CellGrid
        Cells and depths, in m.
    """
    with_coating = unchanged
    if scene.body.coating is not None:
        from sam.grid.coated import depths_with_film

        with_coating = partial(depths_with_film, thickness=scene.body.coating.thickness)
    if scene.surface is not None:
        from sam.grid.rough import RoughPatch, rough_grid

        patch = RoughPatch.of(scene.surface, scene.grid)
        return rough_grid(patch, scene.grid, scene.body.plasticity, with_coating)
    (a, b), wider = hertz_semi_axes(scene), 1.0
    if a == 0.0:
        a, b = (1e-3 * r for r in scene.counterbody.radii)
    elif scene.body.coating is not None:
        from sam.grid.coated import room_for_bare

        scale = contact_scale(scene)
        a, b, wider = a * scale, b * scale, room_for_bare(scale)
    punch = scene.counterbody is not None and scene.counterbody.shape == "punch"
    demand = GridDemand(
        scene.grid, (a, b), punch, wider, _farthest(scene), _plastic_demand(scene, min(a, b)), with_coating
    )
    return smooth_grid(demand, room)


def contact_scale(scene: Scene) -> float:
    """Estimated contact radius over that of the bare body; 1 where the radius is given (punch, given
    pressure).

    An ellipse is scaled like the circle under a sphere with the geometric mean of its radii.
    """
    other = scene.counterbody
    if other is None or other.shape == "punch":
        return 1.0
    from sam.coating import Film
    from sam.grid.coated import contact_radius

    film, force, radius = Film(scene), scene.loading.force, sqrt(other.radii[0] * other.radii[1])
    coating, pair = scene.body.coating, pair_of(scene)
    of_film = 1 / (ElasticConstants(coating.young, coating.poisson).compliance + film.compliance)
    bare = (
        circular_contact_radius(force, radius, pair.contact_modulus),
        circular_contact_radius(force, radius, of_film),
    )
    return contact_radius(film.response, force, radius, bare) / bare[0]


def _farthest(scene: Scene) -> tuple[float, float]:
    """Largest |x| and |y| in m of the centre of a travelling load; zero without path."""
    path = scene.loading.path
    if path is None:
        return 0.0, 0.0
    x, y = (max(map(abs, ends)) for ends in zip(path.start, path.end, strict=True))
    return x, y


def _plastic_demand(scene: Scene, radius: float) -> PlasticDemand | None:
    """What the plasticity of a smooth scene asks of its grid; radius: of the contact in m."""
    plasticity = scene.body.plasticity
    if plasticity is None:
        return None
    profile = plasticity.depth_profile()
    bulk = float(plasticity.curve().stress(np.zeros(1))[0]) * profile.factor[-1]
    reach = point_load_reach(peak_force(scene), scene.body.poisson, bulk, radius)
    return PlasticDemand(reach, profile.depth)


def given_sides(scene: Scene) -> Sides:
    """The sides of the grid that the scene gives; a rough one gives all."""
    given, rough = scene.grid, scene.surface is not None
    return Sides(
        beside=rough or (given is not None and bool(given.cells or given.extent)),
        below=rough or (given is not None and bool(given.depths or given.layers)),
    )


def check(scene: Scene) -> None:
    """Refuse a scene that the model cannot solve.

    Parameters
    ----------
    scene : Scene
        Any valid scene.

    Raises ------ UnsupportedScene For a coating where anything yields, as the coefficients of plastic strain
        hold for a homogeneous body; for a plastic scene whose cells are so small that layers as thick would
        be too many; for a surface of which only the digest is known.
    """
    _check_coating(scene)
    surface = scene.surface
    if surface is not None and surface.path is not None and surface.path.values is None:
        raise UnsupportedScene(
            f"surface.path = {surface.path!r}: only its digest is at hand, read the scene file"
        )
    given = scene.grid
    if scene.body.plasticity is None or given is None or given.extent is None or given.depths or given.layers:
        return
    thickness = min(np.divide(given.extent, given.cells or (PLASTIC_CELLS, PLASTIC_CELLS)))
    layers = layers_as_thick_as_a_cell(hertz_semi_axes(scene), thickness)
    if layers > MOST_LAYERS:
        extent = " and ".join(f"{side:g} m" for side in given.extent)
        raise UnsupportedScene(
            f"grid.extent = {extent}: {layers:.3g} layers as thick as a cell, at most {MOST_LAYERS} are "
            f"allowed: raise it, or give grid.layers and grid.depth"
        )


def _check_coating(scene: Scene) -> None:
    coating, plasticity = scene.body.coating, scene.body.plasticity
    if coating is None:
        return
    allowed = (
        "the semi-analytical model allows an elastic coating on an elastic body; fem-axisymmetric solves it"
    )
    if plasticity is not None:
        raise UnsupportedScene(
            f'body.coating together with body.plasticity (law = "{plasticity.law}"): {allowed}'
        )
    if coating.yield_stress is not None:
        raise UnsupportedScene(f"body.coating.yield_stress = {coating.yield_stress:g} Pa: {allowed}")
