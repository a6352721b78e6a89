# SPDX-License-Identifier: MIT
"""The contact problem of a scene, in the units of its Hertz contact."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from skfem import MeshQuad

from fem_reference import mesh as meshes
from fem_reference.contact import Block, ContactProblem, Equilibrium, equilibrium, released
from fem_reference.elasticity import AxisymmetricSolid, surface_weights
from fem_reference.hertz import Scales, plastic_radius, scales
from fem_reference.plasticity import J2, CurveInUnits, History
from sam.scene.schema import Scene


@dataclass(frozen=True)
class Model:
    """Everything that is fixed during the loading, in the units of `scales`.

    surface: (n_surface,) radii of the surface nodes; candidates: how many of them, from the axis, may touch; edge: radius
    up to which the mesh resolves a smooth contact.
    """

    scales: Scales
    mesh: MeshQuad
    problem: ContactProblem
    surface: np.ndarray
    candidates: int
    punch: bool
    cells_per_radius: int
    edge: float

    @property
    def elastic(self) -> bool:
        """Whether no body has a plastic history."""
        return self.problem.material is None

    @property
    def body(self) -> AxisymmetricSolid:
        """The half-space of the scene."""
        return self.problem.blocks[0].solid

    @property
    def outermost(self) -> np.ndarray:
        """Elements (bool) of the ring along the outer boundary."""
        return (self.mesh.p[:, self.mesh.t] == self.mesh.p.max(axis=1)[:, None, None]).any(axis=(0, 1))

    @property
    def radii(self) -> np.ndarray:
        """(n_candidates,) radii of the nodes that may touch."""
        return self.surface[: self.candidates]

    def initial_gap(self, r: np.ndarray) -> np.ndarray:
        """r^2/2 of the paraboloid; zero below a punch and infinite beside it."""
        return np.where(r <= 1.0, 0.0, np.inf) if self.punch else 0.5 * r**2

    def nodal_pressure(self, state: Equilibrium) -> np.ndarray:
        """(n_surface,) multiplier over the area of the node; on the axis, where that is zero, see `axis_pressure`."""
        area = surface_weights(self.surface)
        p = np.zeros(self.surface.size)
        p[1 : self.candidates] = state.multipliers[1:] / area[1 : self.candidates]
        p[0] = axis_pressure(self.surface[1:5], p[1:5], area[1:5]) if p.any() else 0.0
        return p

    def contact_radius(self, state: Equilibrium) -> float:
        """Radius of the last node in contact of a punch; otherwise fitted to the gap outside, see `edge_radius`."""
        if not state.active.any():
            return 0.0
        last = int(np.flatnonzero(state.active)[-1])
        return float(self.radii[last]) if self.punch else edge_radius(self.radii, state.gap, last)


def axis_pressure(r: np.ndarray, p: np.ndarray, area: np.ndarray) -> float:
    """Pressure at r = 0 from neighbours, by least squares with an even parabola, weighted by area.

    The area weights cancel the alternating error of corner and mid nodes.
    """
    return float(np.polynomial.polynomial.polyfit(r**2, p, 1, w=np.sqrt(area))[0])


def edge_radius(r: np.ndarray, gap: np.ndarray, last: int) -> float:
    """Contact radius from the gap outside, which opens with (r - a)^(3/2) at the edge of any smooth contact.

    Value at zero gap of a parabola r(gap^(2/3)) through the nodes up to 1.3 r[last], without the first; within one
    element of the last node in contact. r, gap: (n,) nodes by radius; last: number of the last one in contact.
    """
    use = np.flatnonzero(r <= 1.3 * r[last])
    use = np.union1d(use[use > last + 1], np.arange(last + 2, last + 6))  # a contact of one or two elements
    if use[-1] >= r.size:
        return float(r[last])
    opening = np.cbrt(gap[use]) ** 2
    radius = np.polynomial.polynomial.polyfit(opening, r[use], 2)[0]
    return float(np.clip(radius, r[max(last - 2, 0)], r[last + 2]))


def build(scene: Scene) -> Model:
    """Mesh, bodies, material and contact candidates of a scene that passed `support.check`."""
    units = scales(scene)
    punch = scene.counterbody.shape == "punch"
    core = choose_core(scene)
    size = scene.fem.cells_per_radius, scene.fem.box
    mesh = meshes.half_plane(*(meshes.punch_lines(*size) if punch else meshes.smooth_lines(*size, core)))
    # both bodies use one mesh, each in its own coordinates, so that their surface nodes match
    blocks = [
        Block(AxisymmetricSolid(mesh, young, body.poisson), young, body.poisson)
        for young, body in zip(units.young, (scene.body, scene.counterbody), strict=False)
    ]
    solid = blocks[0].solid
    surface = solid.basis.doflocs[0, solid.boundary_dofs("surface", 1)]
    # the node of the outer boundary has a prescribed displacement
    candidates = int(np.searchsorted(surface, 1.0, side="right")) if punch else surface.size - 1
    gap0 = np.zeros(candidates) if punch else 0.5 * surface[:candidates] ** 2
    problem = ContactProblem(blocks, gap0, material(scene, units, solid))
    edge = np.inf if punch else core.radius
    return Model(units, mesh, problem, surface, candidates, punch, scene.fem.cells_per_radius, edge)


def choose_core(scene: Scene) -> meshes.Core:
    """The uniform part of the mesh: larger when Hertz's stresses are beyond yield."""
    radius = None if scene.counterbody.shape == "punch" else plastic_radius(scene)
    return meshes.ELASTIC if radius is None else meshes.plastic_core(radius)


def material(scene: Scene, units: Scales, solid: AxisymmetricSolid) -> J2 | None:
    """Plasticity of the body in the units of the model, the yield stress of each Gauss point at its depth."""
    plasticity = scene.body.plasticity
    if plasticity is None:
        return None
    curve = CurveInUnits(plasticity.curve(), units.displacement / units.length, units.pressure)
    return J2(units.young[0], scene.body.poisson, curve, plasticity.depth_profile()(solid.points[1] * units.length))


def load(model: Model, force: float, previous: Equilibrium) -> Equilibrium:
    """Equilibrium under `force`, a step from the previous one; without force nothing touches, see `released`."""
    if force == 0.0 and not previous.yielded:
        return virgin(model)
    if force == 0.0:
        return released(model.problem, model.scales.peak_force, previous.u, previous.history)
    return equilibrium(model.problem, force, starting_set(model, force, previous), previous.u, previous.history)


def starting_set(model: Model, force: float, previous: Equilibrium) -> np.ndarray:
    """Nodes (bool) that probably touch under `force`: those of the previous step, for a smooth contact scaled.

    Radius ~ force^(1/3) as in Hertz, force^0.45 once the body has yielded; from no force, the radius of Hertz itself.
    """
    if model.punch:
        return previous.active if previous.force > 0.0 else model.radii <= 1.0
    if previous.force == 0.0:
        return model.radii <= (force / model.scales.peak_force) ** (1.0 / 3.0)
    exponent = 0.45 if previous.yielded else 1.0 / 3.0
    return model.radii <= model.contact_radius(previous) * (force / previous.force) ** exponent


def virgin(model: Model) -> Equilibrium:
    """The state before loading, and of an elastic body after it: touched at one point without pressure."""
    zeros = np.zeros(model.candidates)
    none = np.zeros(model.candidates, dtype=bool)
    history = None if model.elastic else History.virgin(model.problem.material.factor.shape)
    return Equilibrium(np.zeros(model.problem.size), 0.0, 0.0, zeros, model.problem.gap0, none, history)
