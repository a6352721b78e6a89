# SPDX-License-Identifier: MIT
"""The three-dimensional model of a rough contact: heights of the patch at the nodes, any number of spots."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Self

import numpy as np
from scipy import ndimage

from fem_reference.common.arrays import Array, Bools
from fem_reference.common.contact import Equilibrium
from fem_reference.common.model import material
from fem_reference.common.refusals import FEWEST_NODES
from fem_reference.common.schedule import Load
from fem_reference.common.tables import columns, stacked
from fem_reference.spatial.area import area_of_spots
from fem_reference.spatial.hexahedra import HexSolid, block
from fem_reference.spatial.model import Model, surface_nodes
from fem_reference.spatial.planner import Patch, SpatialPlan
from fem_reference.spatial.problem import Candidates, SlidingProblem
from sam.scene.result import COUNTER_HEIGHT, SURFACE, Table
from sam.scene.section import stated
from sam.scene.surface import Surface, heights, mean_deviation, with_relief

OVERLAP_LENGTH = 0.75 * np.pi
"""Overlapping volume of a sphere and a plane times E* over the force, in contact radii: 3 pi/4 by Hertz."""
SPOTS_GROWTH = 2.0 / 3.0
"""Power of the force of the area of elastic spots (Hertz); of plastic ones it is 1."""
Place = tuple[float, float]
"""(x, y) of the counter-body."""


@dataclass(frozen=True)
class RoughModel(Model):
    """The model of a rough contact. heights, opposite: of the body and of the counter-body at its place, (nx,
    ny) in m at the nodes of the patch, positive out of each; first: gap in m where they touch first, of a
    counter-body that moves at its start.
    """

    heights: Array
    opposite: Array
    first: float

    @cached_property
    def initial_gap(self) -> Array:
        """(nx + 1, ny + 1) gap before loading, 0 at first touch, infinite beside the patch."""
        return gap_of(self.plan, between(self.plan, self.heights + self.opposite, self.place), self.first)

    def placed(self, load: Load) -> Self:
        """The same with the counter-body, and its summits, at the place of a load."""
        moved, patch = super().placed(load), stated(self.plan.patch)
        if patch.counter is None:
            return moved
        return replace(
            moved, opposite=counter_heights_of(patch, patch.counter, in_metres(self.plan, moved.place))
        )

    def slope(self, load: Load, direction: Array) -> Array:
        """(nx + 1, ny + 1) slope of the gap along a direction: of the counter-body and of its summits."""
        patch, (tx, ty) = stated(self.plan.patch), direction
        place, (x, y) = in_metres(self.plan, (load.x, load.y)), patch.centres
        rx, ry = patch.radii or (np.inf, np.inf)
        slope = tx * (x[:, None] - place[0]) / rx + ty * (y[None, :] - place[1]) / ry
        if patch.strip is not None:
            dx, dy = np.gradient(patch.strip.sliding(0, place), x, y)
            slope = slope - patch.strip.slip * (tx * dx + ty * dy)
        return on_mesh(self.plan, slope, 0.0)

    def area(self, state: Equilibrium) -> float:
        """Area of all spots, in the units of the model."""
        return area_of_spots(*self._edge_fields(state))

    def outgrown(self, states: Sequence[Equilibrium]) -> bool:
        """False: a patch may be cut, and its contact end where it does."""
        return False

    def too_coarse(self, states: Sequence[Equilibrium]) -> bool:
        """Whether fewer nodes ever touch than resolve one spot."""
        return max(int(state.active.sum()) for state in states) < FEWEST_NODES

    def starting_set(self, force: float, previous: Equilibrium) -> Bools:
        """Nodes that probably touch: `overlapping`, or by pressure, gap and force of before."""
        areas = self.lines.areas.ravel()[self.candidates]
        if previous.force == 0.0:
            return overlapping(self.initial_gap, self.lines.areas, force).ravel()[self.candidates]
        order = np.lexsort((previous.gap, -previous.multipliers / areas))
        if (previous.load.x, previous.load.y) != self.place:  # summits are elsewhere now
            order = np.argsort(self.problem.gap(previous.u, previous.approach), kind="stable")
        exponent = 1.0 if previous.yielded and force > previous.force else SPOTS_GROWTH
        wanted = areas[previous.active].sum() * (force / previous.force) ** exponent
        chosen = np.zeros(order.size, dtype=bool)
        chosen[order] = np.cumsum(areas[order]) <= wanted
        return chosen

    def expected_force(self, approach: float, scheduled: float, previous: Equilibrium) -> float:
        """Force that an approach probably needs: from no contact that of `overlap`."""
        if previous.force > 0.0:
            return super().expected_force(approach, scheduled, previous)
        radius, volume = overlap(self.initial_gap, self.lines.areas, approach - self.first_touch(previous))
        return volume / (OVERLAP_LENGTH * radius)

    def quantities_of_patch(self, state: Equilibrium) -> dict[str, float]:
        """Contact spots, which join along the lines of the mesh and may be cut by the edge of the patch; the
        share of the patch in contact; the mean of the gap over its nodes.
        """
        gap = self.on_surface(state.gap)[np.isfinite(self.initial_gap)]
        return {
            "contact_spots": float(ndimage.label(self.nodal_pressure(state) > 0.0)[1]),
            "contact_share": self.contact_area(state) / float(np.prod(stated(self.plan.patch).sides)),
            "mean_gap_m": float(gap.mean()) * self.scales.displacement,
        }

    def tables_of_patch(self, states: Mapping[str, Equilibrium]) -> dict[str, Table]:
        """The table of the surface in every state."""
        return {"surface": stacked([surface_table(name, self, state) for name, state in states.items()])}


def overlapping(gap: Array, areas: Array, force: float) -> Bools:
    """Nodes (bool, as gap) in contact under `force`, by Hertz's formulas for the mean of the spots; E* = 1.

    A rigid plane lowered by delta overlaps the heights in spots of twice the area of contact, and by the
    volume V; F = V/(3 pi/4 a), a: radius of the mean spot. Of each the lower half is in contact. gap,
    areas: (nx, ny).
    """
    low, high = 0.0, float(gap[np.isfinite(gap)].max())
    for _ in range(60):
        depth = 0.5 * (low + high)
        radius, volume = overlap(gap, areas, depth)
        low, high = (low, depth) if volume > OVERLAP_LENGTH * radius * force else (depth, high)
    return gap < 0.5 * high


def overlap(gap: Array, areas: Array, depth: float) -> tuple[float, float]:
    """Radius of the mean spot, and volume of the heights that a rigid plane lowered by `depth` overlaps."""
    inside = gap < depth
    spots = max(1, ndimage.label(inside)[1])
    volume = float(((depth - gap[inside]) * areas[inside]).sum())
    return float(np.sqrt(areas[inside].sum() / (2.0 * np.pi * spots))), volume


def build(plan: SpatialPlan) -> RoughModel:
    """Mesh, body, material and contact candidates of the plan of a rough body."""
    lines, bodies, patch = plan.lines, plan.bodies, stated(plan.patch)
    x, y = plan.sliding.places[0] if plan.sliding.moves else (0.0, 0.0)
    start = float(x), float(y)
    solid = HexSolid(block(lines), bodies.elastic[0])
    surface = surface_nodes(solid, lines)
    body = opposite = np.zeros(patch.cells)
    if patch.surface is not None:
        body = heights_of(patch, patch.surface)
    if patch.counter is not None:
        opposite = counter_heights_of(patch, patch.counter, in_metres(plan, start))
    inside = between(plan, body + opposite, start)
    gap = gap_of(plan, inside, float(inside.min()))
    candidates = np.argsort(gap, axis=None, kind="stable")[: patch.cells[0] * patch.cells[1]]
    touching = Candidates(
        surface.ravel()[candidates],
        gap.ravel()[candidates],
        plan.weights.ravel()[candidates],
        anchored=False,
        carried=patch.radii is not None,
    )
    problem = SlidingProblem(
        solid, touching, share=lines.share, material=material(bodies, plan.scales, solid)
    )
    return RoughModel(plan, problem, surface, candidates, body, opposite, float(inside.min()), place=start)


def heights_of(patch: Patch, surface: Surface) -> Array:
    """(nx, ny) heights of the body in m at the centres of the cells, positive out of it."""
    x, y = patch.centres
    raw = heights(surface, x, y, patch.sides)
    if not patch.relief:
        return raw
    return with_relief(raw, (x, y), patch.sides, mean_deviation(surface, patch.sides))


def counter_heights_of(patch: Patch, surface: Surface, place: Place) -> Array:
    """The same of the counter-body at a place in m, positive out of that."""
    return heights_of(patch, surface) if patch.strip is None else patch.strip.at(0, place)


def in_metres(plan: SpatialPlan, place: Place) -> Place:
    """A place of the model in m."""
    return place[0] * plan.scales.length, place[1] * plan.scales.length


def between(plan: SpatialPlan, both: Array, place: Place) -> Array:
    """(nx, ny) in m: the counter-body at a place less the heights of both bodies."""
    patch, (x0, y0), inside = stated(plan.patch), in_metres(plan, place), -both
    x, y = patch.centres
    if patch.radii is not None:
        rx, ry = patch.radii
        inside = inside + (x - x0)[:, None] ** 2 / (2.0 * rx) + (y - y0)[None, :] ** 2 / (2.0 * ry)
    return inside


def gap_of(plan: SpatialPlan, inside: Array, first: float) -> Array:
    """(nx + 1, ny + 1) initial gap, zero where it is `first` in m, infinite beside the patch."""
    return on_mesh(plan, (inside - first) / plan.scales.displacement, np.inf)


def on_mesh(plan: SpatialPlan, inside: Array, beside: float) -> Array:
    """(nx + 1, ny + 1) at all surface nodes, of values (nx, ny) at those of the patch."""
    field = np.full((plan.lines.x.size, plan.lines.y.size), beside)
    i, j = ((nodes - n) // 2 for nodes, n in zip(field.shape, inside.shape, strict=True))
    field[i : i + inside.shape[0], j : j + inside.shape[1]] = inside
    return field


def surface_table(state: str, model: RoughModel, equilibrium: Equilibrium) -> Table:
    """A row for each node of the patch, y running first; height_m: of the body before loading."""
    unit, inside = model.scales, np.isfinite(model.initial_gap)
    x, y = np.meshgrid(model.lines.x * unit.length, model.lines.y * unit.length, indexing="ij")
    pressure = model.nodal_pressure(equilibrium) * unit.pressure
    friction = np.where(pressure > 0.0, np.abs(model.ratio(equilibrium)), np.nan)
    place = [state, x[inside], y[inside], model.heights.ravel()]
    table = columns(SURFACE, [*place, pressure[inside], 0.0, friction[inside]])
    if stated(model.plan.patch).counter is not None:
        table[COUNTER_HEIGHT] = model.at(equilibrium.load).opposite.ravel()
    return table
