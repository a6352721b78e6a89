# SPDX-License-Identifier: MIT
"""The axisymmetric model of a plan: mesh, bodies, contact problem, and what a solved state says of the
contact.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np

from fem_reference.axisymmetric.misfit import MisfitSphere
from fem_reference.axisymmetric.planner import AxisymmetricPlan
from fem_reference.axisymmetric.problem import ContactProblem
from fem_reference.common.arrays import Array, Bools
from fem_reference.common.contact import Equilibrium
from fem_reference.common.elasticity import Solid
from fem_reference.common.hertz import hertz_pressure
from fem_reference.common.model import HERTZ_GROWTH, PLASTIC_GROWTH, ContactModel, material
from fem_reference.common.plasticity import History
from fem_reference.common.quadrilaterals import AxisymmetricSolid, surface_weights, tensor_mesh
from fem_reference.common.recovery import REACH, edge_radius
from fem_reference.common.schedule import Load


@dataclass(frozen=True)
class Model(ContactModel):
    """The axisymmetric model of a plan.

    problem: the bodies in contact; surface: (n_surface,) radii of the surface nodes, ascending, the first
    `candidates` of which may touch; misfit: (4, n_elements, 4) misfit strain under a unit of the load.
    """

    plan: AxisymmetricPlan
    problem: ContactProblem
    surface: Array
    misfit: Array | None = None

    on_axis: ClassVar[int] = 1

    @property
    def candidates(self) -> int:
        """Number of surface nodes, from the axis, that may touch."""
        return self.problem.gap0.size

    @property
    def body(self) -> Solid:
        """The half-space of the scene."""
        return self.problem.solids[0]

    @property
    def radii(self) -> Array:
        """(n_candidates,) radii of the nodes that may touch."""
        return self.surface[: self.candidates]

    @property
    def initial_gap(self) -> Array:
        """(n_surface,) gap of the unloaded bodies."""
        return self.plan.gap(self.surface)

    def nodal_pressure(self, state: Equilibrium) -> Array:
        """(n_surface,) multiplier over the area of the node; on the axis of `axis_pressure`."""
        if self.misfit is not None:
            return np.zeros(self.surface.size)
        if self.plan.prescribed:
            return state.force * hertz_pressure(self.surface)
        area = surface_weights(self.surface)
        p = np.zeros(self.surface.size)
        p[1 : self.candidates] = state.multipliers[1:] / area[1 : self.candidates]
        p[0] = axis_pressure(self.surface[1:5], p[1:5], area[1:5]) if p.any() else 0.0
        return p

    def contact_radius(self, state: Equilibrium) -> float:
        """Contact radius: of a punch that of the last node in contact, else of `edge_radius`."""
        if self.plan.prescribed:
            return 1.0 if state.force and self.misfit is None else 0.0
        if not state.active.any():
            return 0.0
        last = int(np.flatnonzero(state.active)[-1])
        if self.plan.punch:
            return float(self.radii[last])
        coating = self.body.coating  # the gap opens as assumed within a distance of the thickness
        reach = REACH if coating is None else float(np.clip(1.0 + coating.thickness, 1.1, REACH))
        reach = 1.0 + (reach - 1.0) * (1.0 - self.plan.flat)  # and of the size of a rounded edge
        return edge_radius(self.radii, state.gap, last, reach)

    def contact_area(self, state: Equilibrium) -> float:
        """Area of the contact in m^2."""
        return float(np.pi * (self.contact_radius(state) * self.scales.length) ** 2)

    def contact_forces(self, state: Equilibrium) -> Array:
        """(n_candidates,) forces of the counter-body on the nodes, from the displacements."""
        return self.problem.internal_force(state.u, state.history)[self.problem.normal[self.problem.slave]]

    def with_misfit(self, history: History | None, load: Load) -> History | None:
        """The history with the misfit strain of a load."""
        if self.misfit is None or history is None:
            return history
        return replace(history, misfit=load.force * self.misfit)

    def starting_set(self, force: float, previous: Equilibrium) -> Bools:
        """Nodes that probably touch under `force`: those of the previous step, for a smooth contact scaled.

        Radius ~ force^(1/3) as in Hertz, force^0.45 once the body has yielded, and never within a flat end;
        from no force, the radius of Hertz itself. Under a coating that has yielded those of the previous
        step: a node too many squeezes it so far that Newton's method is lost.
        """
        if previous.yielded and previous.force > 0.0 and self.body.coating is not None:
            return previous.active
        if self.plan.punch:
            return previous.active if previous.force > 0.0 else self.radii <= 1.0
        if previous.force == 0.0:
            radius = self.plan.expected * (force / self.scales.peak_force) ** HERTZ_GROWTH
        else:
            exponent = PLASTIC_GROWTH if previous.yielded else HERTZ_GROWTH
            radius = self.contact_radius(previous) * (force / previous.force) ** exponent
        return self.radii <= max(radius, self.plan.flat)

    def outgrown(self, states: Sequence[Equilibrium]) -> bool:
        """Whether a contact reaches beyond the uniform part of the mesh."""
        return max(self.contact_radius(state) for state in states) >= self.plan.edge

    def yields_at_edge(self, peeq: Array) -> bool:
        """Whether an element of the ring along the outer boundary has yielded; peeq: (n_elements, 4)."""
        p, t = self.body.basis.mesh.p, self.body.basis.mesh.t
        outermost = (p[:, t] == p.max(axis=1)[:, None, None]).any(axis=(0, 1))
        return bool((peeq > 0.0)[outermost].any())

    def size(self, state: Equilibrium) -> float:
        """Radius of the contact, or of a misfit sphere."""
        return self.contact_radius(state) if self.misfit is None else 1.0


def axis_pressure(r: Array, p: Array, area: Array) -> float:
    """Pressure at r = 0 by least squares with a parabola: weights of area cancel its alternation."""
    return float(np.polynomial.polynomial.polyfit(r**2, p, 1, w=np.sqrt(area))[0])


def build(plan: AxisymmetricPlan) -> Model:
    """Mesh, bodies, material and contact candidates of a plan."""
    mesh, bodies = tensor_mesh(plan.r, plan.z, half=True), plan.bodies
    # both bodies use one mesh, each in its own coordinates, so that their surface nodes match
    solids = [
        AxisymmetricSolid(mesh, elastic, coating=coating)
        for elastic, coating in zip(bodies.elastic, (bodies.coating, None), strict=False)
    ]
    solid = solids[0]
    surface = solid.basis.doflocs[0, solid.boundary_dofs("surface", 1)]
    # the node of the outer boundary has a prescribed displacement
    candidates = int(np.searchsorted(surface, 1.0, side="right")) if plan.punch else surface.size - 1
    gap0 = plan.gap(surface[:candidates])
    if plan.misfit is not None:
        return with_misfit(plan, plan.misfit, solid, gap0)
    tractions: Array | float = 0.0
    if plan.prescribed:
        tractions = np.zeros(solid.size)
        tractions[solid.boundary_dofs("surface", 1)] = hertz_forces(surface)
    problem = ContactProblem(solids, gap0, material(bodies, plan.scales, solid), tractions)
    return Model(plan, problem, surface)


def with_misfit(plan: AxisymmetricPlan, sphere: MisfitSphere, solid: AxisymmetricSolid, gap0: Array) -> Model:
    """The model of a body with a misfit sphere, whose elastic fields hold the outer boundary."""
    forces, far, places = np.zeros(solid.size), np.zeros(solid.size), solid.basis.doflocs
    on_surface = [solid.boundary_dofs("surface", component) for component in (0, 1)]
    surface = places[0, on_surface[1]]
    for component, held in enumerate(sphere.surface_forces(surface)):
        forces[on_surface[component]] = held
        outer = solid.boundary_dofs("far", component)
        far[outer] = sphere.displacement(*places[:, outer])[component]
    yields = material(plan.bodies, plan.scales, solid, misfit=True)
    problem = ContactProblem([solid], gap0, yields, forces, far=far)
    return Model(plan, problem, surface, sphere.strain(*solid.points))


def hertz_forces(r: Array, points: int = 20) -> Array:
    """(2 n + 1,) consistent nodal forces of `hertz_pressure` on quadratic edges with the nodes r, corner
    and mid in turn.

    One corner is at r = 1. Gauss points in t of r = b - (b - a) t^2, in which sqrt(1 - r) is smooth up to
    an edge from a to b = 1. Exact to rounding.
    """
    t, w = np.polynomial.legendre.leggauss(points)
    t, w = 0.5 * (t + 1.0), 0.5 * w
    a, b = r[:-2:2, None], r[2::2, None]
    s = 1.0 - t**2  # place in the edge, from 0 to 1
    at = a + (b - a) * s
    ring = 2.0 * np.pi * at * hertz_pressure(at) * (b - a) * 2.0 * t * w
    forces = np.zeros_like(r)
    forces[:-2:2] += ring @ ((1.0 - s) * (1.0 - 2.0 * s))
    forces[1::2] += ring @ (4.0 * s * (1.0 - s))
    forces[2::2] += ring @ (s * (2.0 * s - 1.0))
    return forces
