# SPDX-License-Identifier: MIT
"""The plane-strain model of a plan: mesh, bodies, contact problem, and what a solved state says of the
contact.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Self

import numpy as np

from fem_reference.common.arrays import Array, Bools
from fem_reference.common.contact import Equilibrium
from fem_reference.common.elasticity import Solid
from fem_reference.common.model import ContactModel, material
from fem_reference.common.quadrilaterals import PlaneSolid, edge_weights, tensor_mesh
from fem_reference.common.recovery import edge_radius
from fem_reference.common.schedule import Load
from fem_reference.plane_strain.planner import PlaneStrainPlan
from fem_reference.plane_strain.problem import LineProblem

HERTZ_GROWTH, PLASTIC_GROWTH = 0.5, 0.75
"""Power of the force with which the half-width grows, elastic (Johnson 1985, Eq. 4.43) and after yield,
below 1 of constant mean pressure; for starting sets only.
"""


@dataclass(frozen=True)
class Model(ContactModel):
    """The plane-strain model of a plan.

    problem: the bodies in contact; surface: (n_surface,) x of the surface nodes, ascending; candidates: those
    that may touch, all but the ones on the outer boundary; place: x of the apex of the counter-body.
    """

    plan: PlaneStrainPlan
    problem: LineProblem
    surface: Array
    candidates: slice
    place: float = field(default=0.0, kw_only=True)

    @property
    def part(self) -> float:
        """Modelled part of every force: that on a length of one half-width, or half of that."""
        return self.problem.share

    @property
    def body(self) -> Solid:
        """The half-space of the scene."""
        return self.problem.solids[0]

    @property
    def initial_gap(self) -> Array:
        """(n_surface,) gap of the unloaded bodies."""
        return 0.5 * (self.surface - self.place) ** 2

    def at(self, load: Load) -> Self:
        """The model with the counter-body where a load has it."""
        if load.x == self.place:
            return self
        moved = replace(self, place=load.x)
        return replace(moved, problem=self.problem.with_gap(moved.initial_gap[self.candidates]))

    def on_surface(self, values: Array) -> Array:
        """(n_surface,) from values at the candidates, zero elsewhere."""
        out = np.zeros(self.surface.size)
        out[self.candidates] = values
        return out

    def nodal_pressure(self, state: Equilibrium) -> Array:
        """(n_surface,) multiplier over the area of the node."""
        return self.on_surface(state.multipliers) * self.part / edge_weights(self.surface)

    def edges(self, state: Equilibrium) -> tuple[float, float]:
        """x of the ends of the contact, each by `edge_radius`; equal without contact."""
        if not state.active.any():
            return self.place, self.place
        x, touching = self.surface[self.candidates], np.flatnonzero(state.active)
        centre = 0.0 if self.plan.half else 0.5 * float(x[touching[0]] + x[touching[-1]])
        right, gap = x >= centre, np.maximum(state.gap, 0.0)
        end = centre + edge_radius(
            x[right] - centre, gap[right], int(np.flatnonzero(state.active[right])[-1])
        )
        if self.plan.half:
            return -end, end
        left = np.flatnonzero(x <= centre)[::-1]
        start = centre - edge_radius(centre - x[left], gap[left], int(np.flatnonzero(state.active[left])[-1]))
        return start, end

    def size(self, state: Equilibrium) -> float:
        """Half of the distance of the ends of the contact."""
        start, end = self.edges(state)
        return 0.5 * (end - start)

    def contact_area(self, state: Equilibrium) -> float:
        """Area of the contact in m^2, on the length of the cylinder."""
        return 2.0 * self.size(state) * self.plan.length * self.scales.length**2

    def contact_forces(self, state: Equilibrium) -> Array:
        """(n_candidates,) modelled forces of the counter-body on the nodes, from the displacements."""
        return self.body.internal_force(self.stress(state))[self.problem.normal[0]]

    def centroid(self, state: Equilibrium) -> float:
        """x of the resultant of the pressure."""
        if self.plan.half:
            return 0.0
        return float(state.multipliers @ self.surface[self.candidates] / (state.multipliers.sum() or 1.0))

    def starting_set(self, force: float, previous: Equilibrium) -> Bools:
        """Nodes that probably touch: Hertz's, or those of the previous step, scaled, below the apex."""
        start, end, share = -1.0, 1.0, force / self.scales.peak_force
        if previous.force > 0.0:
            (start, end), share = self.edges(previous), force / previous.force
            start, end = start - previous.load.x, end - previous.load.x
        growth = share ** (PLASTIC_GROWTH if previous.yielded else HERTZ_GROWTH)
        x = self.surface[self.candidates] - self.place
        return (x >= growth * start) & (x <= growth * end)

    def outgrown(self, states: Sequence[Equilibrium]) -> bool:
        """Whether a contact reaches beyond the uniform part of the mesh."""
        (low, high), x = self.plan.core, self.surface[self.candidates]
        return any(bool((state.active & ((x <= low) | (x >= high))).any()) for state in states)

    def yields_at_edge(self, peeq: Array) -> bool:
        """Whether a point at the sides or the bottom has yielded; peeq: (2 nx, 2 nz)."""
        sides = peeq[-1], peeq[:, -1], peeq[-1 if self.plan.half else 0]
        return any(bool(np.any(side > 0.0)) for side in sides)


def build(plan: PlaneStrainPlan) -> Model:
    """Mesh, bodies, material and contact candidates of a plan."""
    mesh, bodies = tensor_mesh(plan.x, plan.z, half=plan.half), plan.bodies
    # both bodies use one mesh, each in its own coordinates, so that their surface nodes match
    solids = [PlaneSolid(mesh, elastic) for elastic in bodies.elastic]
    surface = solids[0].basis.doflocs[0, solids[0].boundary_dofs("surface", 1)]
    candidates = slice(0 if plan.half else 1, surface.size - 1)
    problem = LineProblem(
        solids,
        candidates,
        0.5 * surface[candidates] ** 2,
        length=plan.length,
        material=material(bodies, plan.scales, solids[0]),
    )
    return Model(plan, problem, surface, candidates)
