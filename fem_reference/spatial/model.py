# SPDX-License-Identifier: MIT
"""The three-dimensional model of a smooth body: mesh, contact problem, and what a solved state says of the
contact.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Self

import numpy as np

from fem_reference.common.arrays import Array, Bools, Integers
from fem_reference.common.contact import Equilibrium
from fem_reference.common.elasticity import on_grid
from fem_reference.common.hertz import hertz_pressure
from fem_reference.common.mesh_lines import Lines
from fem_reference.common.model import HERTZ_GROWTH, PLASTIC_GROWTH, ContactModel, material
from fem_reference.common.schedule import Load
from fem_reference.spatial.hexahedra import HexSolid, block
from fem_reference.spatial.planner import SpatialPlan
from fem_reference.spatial.problem import Candidates, SlidingProblem
from fem_reference.spatial.surface import contact_area, hertz_forces
from sam.scene.result import Table


@dataclass(frozen=True)
class Model(ContactModel):
    """The three-dimensional model of a plan.

    problem: the body in contact; surface: (nx + 1, ny + 1) numbers of the surface nodes; candidates:
    (n_candidates,) places in the flat `surface` of those that may touch, from the origin outwards; place: (x,
    y) of the apex of the counter-body.
    """

    plan: SpatialPlan
    problem: SlidingProblem
    surface: Integers
    candidates: Integers
    place: tuple[float, float] = field(default=(0.0, 0.0), kw_only=True)

    @property
    def centred(self) -> bool:
        """Not of a rough body: nothing says where the middle is."""
        return self.plan.patch is None

    @property
    def part(self) -> float:
        """Modelled part of every force."""
        return self.problem.share

    @property
    def lines(self) -> Lines:
        """Planes of the mesh."""
        return self.plan.lines

    @property
    def body(self) -> HexSolid:
        """The half-space of the scene."""
        return self.problem.solid

    @cached_property
    def places(self) -> tuple[Array, Array]:
        """x and y of the candidates."""
        i, j = np.unravel_index(self.candidates, self.surface.shape)
        return self.lines.x[i], self.lines.y[j]

    @cached_property
    def elements(self) -> Integers:
        """(nx, ny, nz) numbers of the elements."""
        mesh = self.problem.mesh
        return on_grid(mesh.p[:, mesh.t].mean(axis=1), self.lines.shape)

    @cached_property
    def initial_gap(self) -> Array:
        """(nx + 1, ny + 1) gap before loading, of the paraboloid."""
        x, y = self.lines.x - self.place[0], self.lines.y - self.place[1]
        return paraboloid(self.plan.curvature, x[:, None], y[None, :])

    def at(self, load: Load) -> Self:
        """The model with the counter-body where a load has it; the same unless that moves."""
        if not self.plan.sliding.moves:
            return self
        moved = self.placed(load)
        return replace(moved, problem=self.problem.with_gap(moved.initial_gap.ravel()[self.candidates]))

    def placed(self, load: Load) -> Self:
        """The same with the counter-body at the place of a load."""
        return replace(self, place=(load.x, load.y))

    def offsets(self, x: float, y: float) -> tuple[Array, Array]:
        """(nx + 1, ny + 1) distances from a place along x and y; of a half none along y, as the other one has
        the opposite sign.
        """
        along, across = np.meshgrid(self.lines.x - x, self.lines.y - y, indexing="ij")
        return along, np.zeros_like(across) if self.lines.half else across

    def slope(self, load: Load, direction: Array) -> Array:
        """(nx + 1, ny + 1) slope of the gap along a direction, with the counter-body where a load has it."""
        (x, y), (tx, ty) = self.offsets(load.x, load.y), direction
        cx, cy = (self.scales.strain * curvature for curvature in self.plan.curvature)
        return tx * cx * x + ty * cy * y

    def on_surface(self, values: Array) -> Array:
        """(nx + 1, ny + 1) from values at the candidates, zero elsewhere."""
        field = np.zeros(self.surface.size)
        field[self.candidates] = values
        return field.reshape(self.surface.shape)

    def nodal_pressure(self, state: Equilibrium) -> Array:
        """(nx + 1, ny + 1) multipliers over the areas of the nodes; the given pressure where it is given."""
        if self.plan.prescribed:
            x, y = self.lines.x[:, None] - state.load.x, self.lines.y[None, :] - state.load.y
            return state.force * hertz_pressure(np.hypot(x, y))
        return self.on_surface(state.multipliers) / self.lines.areas

    def area(self, state: Equilibrium) -> float:
        """Area of the contact, of both halves, in the units of the model."""
        if self.plan.prescribed:
            return np.pi if state.force else 0.0
        return contact_area(*self._edge_fields(state), half=self.lines.half)

    def _edge_fields(self, state: Equilibrium) -> tuple[Array, Array, Array, Array]:
        """Mesh lines, pressure and gap, not negative, of which the edge is read."""
        gap = np.clip(self.on_surface(state.gap), 0.0, None)
        return self.lines.x, self.lines.y, np.clip(self.nodal_pressure(state), 0.0, None), gap

    def contact_area(self, state: Equilibrium) -> float:
        """Area of the contact in m^2."""
        return self.area(state) * self.scales.length**2

    def contact_forces(self, state: Equilibrium) -> Array:
        """(n_candidates,) forces of the counter-body on the nodes, from the displacements."""
        return self.body.internal_force(self.stress(state))[self.problem.normal]

    def ratio(self, state: Equilibrium) -> Array:
        """(nx + 1, ny + 1) tangential over normal traction."""
        return state.load.ratio * self.plan.weights * np.ones(self.surface.shape)

    def friction(self, state: Equilibrium) -> float:
        """Size of the tangential force over the normal one; the largest coefficient without any."""
        weights, coefficient = self.plan.weights, self.plan.sliding.coefficient
        if np.all(weights == 1.0) or not state.multipliers.any():
            return coefficient
        return coefficient * float(np.average(weights.ravel()[self.candidates], weights=state.multipliers))

    def outgrown(self, states: Sequence[Equilibrium]) -> bool:
        """Whether a contact reaches beyond the uniform part of the mesh."""
        (x, y), (low, high, wide) = self.places, self.plan.core
        beyond = (x <= low) | (x >= high) | (np.abs(y) >= wide)
        return any(bool((state.active & beyond).any()) for state in states)

    def yields_at_edge(self, peeq: Array) -> bool:
        """Whether an element at the sides or the bottom has yielded; peeq: (nx, ny, nz)."""
        yielded = peeq > 0.0
        return any(np.any(side) for side in (yielded[[0, -1]], yielded[:, -1], yielded[:, :, -1]))

    def size(self, state: Equilibrium) -> float:
        """Radius of a circle of the area of the contact."""
        return float(np.sqrt(self.area(state) / np.pi))

    def centroid(self, state: Equilibrium) -> float:
        """x of the resultant of the pressure."""
        forces = self.nodal_pressure(state) * self.lines.areas
        return float((forces.sum(axis=1) * self.lines.x).sum() / (forces.sum() or 1.0))

    def starting_set(self, force: float, previous: Equilibrium) -> Bools:
        """Nodes that probably touch: Hertz's ellipse, or of the previous area, scaled."""
        radius, share = self.plan.expected, force / self.scales.peak_force
        if previous.force > 0.0:
            radius, share = self.size(previous), force / previous.force
        radius *= share ** (PLASTIC_GROWTH if previous.yielded else HERTZ_GROWTH)
        (x, y), (a, b) = self.places, self.plan.axes
        return np.hypot((x - self.place[0]) / a, (y - self.place[1]) / b) <= radius

    def quantities_of_patch(self, _state: Equilibrium) -> dict[str, float]:
        """What only a rough body has."""
        return {}

    def tables_of_patch(self, states: Mapping[str, Equilibrium]) -> dict[str, Table]:
        """The tables that smooth bodies do not have: none."""
        return {}


def build(plan: SpatialPlan) -> Model:
    """Mesh, body, material and contact candidates of the plan of a smooth body."""
    lines, bodies = plan.lines, plan.bodies
    solid = HexSolid(block(lines), bodies.elastic[0], coating=bodies.coating)
    surface = surface_nodes(solid, lines)
    x, y = solid.basis.mesh.p[:2, surface.ravel()]
    inside = (x > lines.x[0]) & (x < lines.x[-1]) & (y < lines.y[-1]) & ((y > lines.y[0]) | lines.half)
    places = np.flatnonzero(inside)
    candidates = places[np.argsort(np.hypot(x, y)[places], kind="stable")]
    gap0, moves = paraboloid(plan.curvature, x, y)[candidates], plan.sliding.moves

    def tractions(load: Load) -> Array:
        forces = load.force * hertz_forces(lines.x, lines.y, (load.x, load.y))
        nodal = np.zeros(solid.size)
        dofs = solid.basis.nodal_dofs[:, surface]
        nodal[dofs[2]], nodal[dofs[0]] = forces, load.ratio * forces
        return nodal

    problem = SlidingProblem(
        solid,
        Candidates(surface.ravel()[candidates], gap0, plan.weights.ravel()[candidates], anchored=not moves),
        share=lines.share,
        material=material(bodies, plan.scales, solid),
        tractions=tractions if plan.prescribed else None,
    )
    return Model(plan, problem, surface, candidates)


def paraboloid(curvature: tuple[float, float], x: Array, y: Array) -> Array:
    """Gap at a distance (x, y) from the apex of the counter-body."""
    return 0.5 * (curvature[0] * x**2 + curvature[1] * y**2)


def surface_nodes(solid: HexSolid, lines: Lines) -> Integers:
    """(nx + 1, ny + 1) numbers of the nodes at z = 0."""
    p = solid.basis.mesh.p
    top = np.flatnonzero(p[2] == 0.0)
    return top[on_grid(p[:, top], (lines.x.size, lines.y.size))]
