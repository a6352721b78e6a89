# SPDX-License-Identifier: MIT
"""The elastic bodies of a scene, their friction, and how large their contact is to be."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import inf, pi, sqrt
from typing import TYPE_CHECKING

import numpy as np

from sam.arrays import Array
from sam.elastic.problem import Looked
from sam.grid.cells import CellGrid
from sam.grid.gap import NoCounterBody, Paraboloid, Plane, Punch, Shape
from sam.grid.smooth import DEFAULT_EXTENT, PUNCH_EXTENT, ROUNDED_EXTENT
from sam.half_space import ElasticConstants, ElasticPair, circular_contact_radius
from sam.planner import parts
from sam.results.advice import Remedies
from sam.scene import CounterBody, Friction, Scene, remedies
from sam.scene.section import stated
from sam.schedule import Schedule
from sam.slip import Coefficient, FullSlip

if TYPE_CHECKING:
    from sam.elastic.misfit import MisfitSphere

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
