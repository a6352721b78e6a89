# SPDX-License-Identifier: MIT
"""The bodies of a scene, how large their contact is to be, and what the grid is chosen from."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from math import inf, nan, pi, sqrt
from typing import Any

import numpy as np

from sam.contact.operators import CoatedPair
from sam.elastic.problem import PROFILES, Demand, GivenHertz, MisfitSphere
from sam.grid.cells import CellGrid, Paraboloid, Punch, RoundedPunch, Shape, Sides, Uniform
from sam.grid.demands import (
    DEFAULT_EXTENT,
    FARTHEST,
    PUNCH_EXTENT,
    ROUNDED_EXTENT,
    GridDemand,
    MisfitDemand,
    PlasticDemand,
    RoughDemand,
    RoughPatch,
    contact_radius,
    elliptic_contact,
    line_load_reach,
    mean_compliance,
    point_load_reach,
    room_for_bare,
)
from sam.half_space import ElasticConstants, ElasticPair, circular_contact_radius
from sam.scene import CounterBody, Grid, Scene
from sam.scene.section import stated

SMALLEST = 1e-3  # of the radius of curvature: takes the place of the contact radius of a scene without force


class Bodies:
    """The bodies of a scene and what is estimated of their contact before the grid is chosen, each once."""

    def __init__(self, scene: Scene):
        self.scene = scene

    @cached_property
    def pair(self) -> ElasticPair:
        """The elastic constants of the body and of an elastic counter-body."""
        body, other = self.scene.body, self.scene.counterbody
        counterpart = None
        if other is not None and other.elastic:
            counterpart = ElasticConstants(stated(other.young), stated(other.poisson))
        return ElasticPair(ElasticConstants(body.young, body.poisson), counterpart)

    @cached_property
    def coated(self) -> CoatedPair | None:
        """Both bodies with the coating; None without one."""
        coating = self.scene.body.coating
        if coating is None:
            return None
        return CoatedPair.of(ElasticConstants(coating.young, coating.poisson), coating.thickness, self.pair)

    @cached_property
    def given(self) -> GivenHertz | None:
        """The pressure that a scene gives; None if a counter-body is pressed on."""
        loading = self.scene.loading
        return GivenHertz(stated(loading.p0), stated(loading.radius)) if loading.hertz else None

    @cached_property
    def misfit(self) -> MisfitSphere | None:
        """The misfit sphere that loads the body; None if it is loaded at its surface."""
        loading = self.scene.loading
        if not loading.misfit_sphere:
            return None
        return MisfitSphere(
            self.pair.body,
            stated(loading.depth),
            stated(loading.radius),
            stated(loading.misfit),
            PROFILES[stated(loading.profile)],
            free=loading.surface == "free",
        )

    @cached_property
    def shape(self) -> Shape:
        """The shape of the counter-body."""
        other = self.scene.counterbody
        return Uniform(nan) if other is None else SHAPES[other.shape].gap(other)

    @cached_property
    def force(self) -> float:
        """The force in N at the peak: the given one, or an estimate from the approach."""
        loading, other = self.scene.loading, stated(self.scene.counterbody)
        if loading.approach is None:
            return stated(self.scene.force)
        return SHAPES[other.shape].force(self, other, loading.approach)

    @cached_property
    def axes(self) -> tuple[float, float]:
        """Contact semi-axes in m, see `hertz_semi_axes`."""
        other = self.scene.counterbody
        if other is None:
            return stated(self.scene.loading.radius), stated(self.scene.loading.radius)
        return SHAPES[other.shape].semi_axes(self, other)

    @cached_property
    def zone(self) -> float:
        """Radius of the plastic zone in m, see `misfit_zone`."""
        plasticity = self.scene.body.plasticity
        if plasticity is None or self.misfit is None:
            return 0.0
        return self.misfit.zone(float(plasticity.strength().stress(self.misfit.depth, np.zeros(1))[0]))

    @cached_property
    def largest_cell(self) -> float:
        """The largest cell in m that resolves the contact of a smooth scene with its counter-body."""
        other = self.scene.counterbody
        return inf if other is None else SHAPES[other.shape].largest_cell(self, other)

    @cached_property
    def patch(self) -> RoughPatch | None:
        """The rough surfaces on their cells; None if both are smooth."""
        scene = self.scene
        if scene.patch_surface is None:
            return None
        return RoughPatch.of(scene.surface, scene.counter_surface, scene.grid, strip=scene.counter_strip)

    @cached_property
    def demand(self) -> Demand:
        """What the grid is chosen from; of a rough patch under a force with the plastic zone."""
        scene, sphere, patch = self.scene, self.misfit, self.patch
        film = None if scene.body.coating is None else scene.body.coating.thickness
        if sphere is not None:
            zone = None if scene.body.plasticity is None else self.zone
            return MisfitDemand(scene.grid, sphere.depth, sphere.radius, zone)
        if patch is None:
            return self.smooth_demand
        plastic = None
        if scene.loading.approach is None:
            widest = patch.extent[0] if self._line else min(patch.extent)
            plastic = self._plastic_demand(widest / 2 / FARTHEST)
        reach = 0.0 if plastic is None else plastic.reach
        return RoughDemand(patch, scene.grid, scene.body.plasticity, film, reach, self._line)

    @property
    def _line(self) -> bool:
        """Whether the counter-body is a cylinder."""
        return self.scene.counterbody is not None and self.scene.counterbody.length is not None

    @cached_property
    def smooth_demand(self) -> GridDemand:
        """What the grid of a smooth scene is chosen from: the contact and the plastic zone to be expected."""
        scene, coating, other = self.scene, self.scene.body.coating, self.scene.counterbody
        (a, b), wider, farthest = self.axes, 1.0, (0.0, 0.0)
        length = 0.0 if other is None else other.length or 0.0
        if length:
            b = a
        if a == 0.0:
            a, b = (SMALLEST * r for r in stated(stated(other).radii))
        elif coating is not None:
            a, b, wider = a * self.scale, b * self.scale, room_for_bare(self.scale)
        if (path := scene.loading.path) is not None:
            x, y = (max(map(abs, ends)) for ends in zip(path.start, path.end, strict=True))
            farthest = x, y
        return GridDemand(
            scene.grid,
            (a, b),
            DEFAULT_EXTENT if other is None else SHAPES[other.shape].extent,
            wider,
            farthest,
            self._plastic_demand(min(a, b)),
            None if coating is None else coating.thickness,
            moves=scene.moves,
            largest_cell=self.largest_cell,
            length=length,
        )

    @cached_property
    def scale(self) -> float:
        """Estimated contact radius of the coated body over that of the bare one; else 1."""
        other, pair, coated = self.scene.counterbody, self.pair, self.coated
        if other is None or SHAPES[other.shape].given or self.force == 0.0 or coated is None:
            return 1.0
        if other.radii is None:
            a, b = self.axes
            radius = 4 / 3 * pair.contact_modulus * sqrt(a * b) ** 3 / self.force  # Johnson 1985, Eq. 4.22
        else:
            radius = sqrt(other.radii[0] * other.radii[1])
        coating = stated(self.scene.body.coating)
        of_coating = 1 / (ElasticConstants(coating.young, coating.poisson).compliance + coated.compliance)
        bare = (
            circular_contact_radius(self.force, radius, pair.contact_modulus),
            circular_contact_radius(self.force, radius, of_coating),
        )
        return contact_radius(coated.response, self.force, radius, bare) / bare[0]

    def _plastic_demand(self, radius: float) -> PlasticDemand | None:
        """What plasticity asks of the grid; radius: of the contact in m, or of the widest that may be."""
        plasticity, poisson = self.scene.body.plasticity, self.scene.body.poisson
        if plasticity is None:
            return None
        force, other = self.force if self.given is None else self.given.peak_force, self.scene.counterbody
        strength, reach_of = plasticity.strength(), point_load_reach
        if other is not None and other.length is not None:
            force, reach_of = force / other.length, line_load_reach

        def reach(z: float) -> float:
            limit = float(strength.stress(z, np.zeros(1))[0])
            return reach_of(force, poisson, limit, radius)

        within = min(reach(np.nextafter(strength.thickness, 0.0)), strength.thickness)
        return PlasticDemand(max(reach(np.inf), within), strength.kinks.depths)


def _by_hertz(bodies: Bodies, other: CounterBody) -> tuple[float, float]:
    radii = rx, ry = stated(other.radii)
    if rx == ry:
        return (circular_contact_radius(bodies.force, rx, bodies.pair.contact_modulus),) * 2
    return elliptic_contact(bodies.force, radii, bodies.pair.contact_modulus)


def _fully_plastic(bodies: Bodies, strain: float) -> float:
    """Mean pressure in Pa that plastic material bears, 3 yield stresses at a strain (Tabor 1951), or inf."""
    plasticity = bodies.scene.body.plasticity
    if plasticity is None:
        return inf
    return 3 * float(plasticity.strength().stress(np.inf, np.array(strain)))


def _force_of_hertz(bodies: Bodies, other: CounterBody, approach: float) -> float:
    """With the geometric mean of the radii, and the mean compliance of a coated body."""
    rx, ry = stated(other.radii)
    radius = sqrt(rx * ry)
    compliance, a = 1 / bodies.pair.contact_modulus, sqrt(radius * approach)
    if bodies.coated is not None:
        compliance = mean_compliance(bodies.coated.response, a)
    force = 4 * a * approach / (3 * compliance)
    return min(force, _fully_plastic(bodies, 0.2 * sqrt(2) * a / radius) * 2 * pi * a**2)


def _rounded_punch(other: CounterBody) -> RoundedPunch:
    return RoundedPunch(stated(other.flat_radius), stated(other.radius))


def _by_rounded_edge(bodies: Bodies, other: CounterBody) -> tuple[float, float]:
    return (_rounded_punch(other).contact_radius(bodies.force, bodies.pair.contact_modulus),) * 2


def _force_on_rounded_edge(bodies: Bodies, other: CounterBody, approach: float) -> float:
    """At most 3 times the yield stress on the part of the punch that is below the surface."""
    punch = _rounded_punch(other)
    force = punch.force(punch.radius_at(approach), bodies.pair.contact_modulus)
    beyond = sqrt(2 * punch.radius * approach)
    return min(force, _fully_plastic(bodies, 0.2 * beyond / punch.radius) * pi * (punch.flat + beyond) ** 2)


def _by_line(bodies: Bodies, other: CounterBody) -> tuple[float, float]:
    """The half-width (Johnson 1985, Eq. 4.43) and half of the length."""
    length = stated(other.length)
    line_force = bodies.force / length
    half_width = sqrt(4 * line_force * stated(other.radius) / (pi * bodies.pair.contact_modulus))
    return half_width, length / 2


def _half_of_patch(bodies: Bodies, _: CounterBody) -> tuple[float, float]:
    lx, ly = bodies.scene.patch[1]
    return lx / 2, ly / 2


@dataclass(frozen=True)
class Opposite:
    """What the model asks of a shape: gap; semi-axes in m on the bare body, and whether given;
    force in N of an approach in m; sides of a grid in radii; largest cell in m.
    """

    gap: Callable[[CounterBody], Shape]
    semi_axes: Callable[[Bodies, CounterBody], tuple[float, float]]
    given: bool = False
    force: Callable[[Bodies, CounterBody, float], float] = _force_of_hertz
    extent: float = DEFAULT_EXTENT
    largest_cell: Callable[[Bodies, CounterBody], float] = lambda bodies, other: inf


SHAPES = {
    "sphere": Opposite(lambda other: Paraboloid(stated(other.radii)), _by_hertz),
    "ellipsoid": Opposite(lambda other: Paraboloid(stated(other.radii)), _by_hertz),
    "punch": Opposite(
        lambda other: Punch(stated(other.radius)),
        lambda bodies, other: (stated(other.radius),) * 2,
        True,
        lambda bodies, other, approach: 2 * bodies.pair.contact_modulus * stated(other.radius) * approach,
        PUNCH_EXTENT,
    ),
    "rounded-punch": Opposite(
        _rounded_punch,
        _by_rounded_edge,
        force=_force_on_rounded_edge,
        extent=ROUNDED_EXTENT,
        largest_cell=lambda bodies, other: _rounded_punch(other).largest_cell(bodies.axes[0]),
    ),
    "flat": Opposite(lambda other: Uniform(), _half_of_patch),
    "cylinder": Opposite(lambda other: Paraboloid((stated(other.radius), inf)), _by_line),
}
"""The shapes of a scene."""


def hertz_semi_axes(scene: Scene) -> tuple[float, float]:
    """Contact semi-axes (a along x, b along y) in m by Hertz or what takes his place, for the body without
    coating.

    The radius twice for a punch and for a given Hertz pressure; half the sides of the patch for a plane; half
    the width and half the length for a cylinder.
    """
    return Bodies(scene).axes


def expected_force(scene: Scene) -> float:
    """The force in N at the peak: the given one, or an estimate from the approach, from which the grid of a
    smooth scene is chosen. Of a body that yields not more than its fully plastic contact bears: a^2 = 2 R
    approach, and 3 times the yield stress at the strain 0.2 a/R (Tabor 1951).
    """
    return Bodies(scene).force


def misfit_zone(scene: Scene) -> float:
    """Radius in m of the plastic zone about a misfit sphere in an infinite body, of which the grid is chosen;
    0 where nothing yields, and without a misfit sphere.
    """
    return Bodies(scene).zone


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
