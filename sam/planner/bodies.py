# SPDX-License-Identifier: MIT
"""The elastic bodies of a scene, their friction, and how large their contact is to be."""

from __future__ import annotations

from sam.arrays import Array
from sam.elastic.problem import Looked
from sam.grid.cells import CellGrid
from sam.grid.gap import NoCounterBody, Paraboloid, Plane, Punch, Shape
from sam.half_space import ElasticConstants, ElasticPair, circular_contact_radius
from sam.planner import parts
from sam.results.advice import Remedies
from sam.scene import Friction, Scene, remedies
from sam.scene.section import stated
from sam.scene.surface import patch_of
from sam.schedule import Schedule
from sam.slip import Coefficient, FullSlip

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


def shape_of(scene: Scene) -> Shape:
    """The shape of the counter-body."""
    other = scene.counterbody
    if other is None:
        return NoCounterBody()
    if other.shape == "punch":
        return Punch(stated(other.radius))
    return Plane() if other.shape == "flat" else Paraboloid(other.radii)


def hertz_semi_axes(scene: Scene) -> tuple[float, float]:
    """Contact semi-axes (a along x, b along y) in m by Hertz, for the body without coating.

    The radius twice for a punch and for a given Hertz pressure; half the sides of the patch for a plane.
    """
    loading, other = scene.loading, scene.counterbody
    if other is None or other.shape == "punch":
        a = stated(loading.radius if other is None else other.radius)
        return a, a
    if other.shape == "flat":
        lx, ly = patch_of(stated(scene.surface), scene.grid)[1]
        return lx / 2, ly / 2
    force, modulus, (rx, ry) = stated(loading.force), pair_of(scene).contact_modulus, other.radii
    if rx == ry:
        a = circular_contact_radius(force, rx, modulus)
        return a, a
    return parts.ellipse(force, other.radii, modulus)


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
    rough, end = scene.surface is not None, schedule.path[-1]
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
