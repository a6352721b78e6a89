# SPDX-License-Identifier: MIT
"""The contact problem of a scene, in the units of its Hertz contact."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from skfem import MeshQuad

from fem_reference import mesh as meshes
from fem_reference.contact import Block, ContactProblem, Equilibrium, equilibrium
from fem_reference.elasticity import AxisymmetricSolid, surface_weights
from fem_reference.hertz import Scales, scales
from sam.scene.schema import Scene


@dataclass(frozen=True)
class Model:
    """Everything that is fixed during the loading, in the units of `scales`.

    surface: (n_surface,) radii of the surface nodes; candidates: how many of them, from the axis, may touch.
    """

    scales: Scales
    mesh: MeshQuad
    problem: ContactProblem
    surface: np.ndarray
    candidates: int
    punch: bool
    cells_per_radius: int

    @property
    def body(self) -> AxisymmetricSolid:
        """The half-space of the scene."""
        return self.problem.blocks[0].solid

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
        """Radius of a punch; otherwise fitted near the edge, see `edge_radius`."""
        if not state.active.any():
            return 0.0
        if self.punch:
            return 1.0
        last = int(np.flatnonzero(state.active)[-1])
        pressure = self.nodal_pressure(state)[: last + 1]
        return edge_radius(self.surface[: last + 1], pressure, surface_weights(self.surface))


def axis_pressure(r: np.ndarray, p: np.ndarray, area: np.ndarray) -> float:
    """Pressure at r = 0 from neighbours, by least squares with an even parabola, weighted by area.

    The area weights cancel the alternating error of corner and mid nodes.
    """
    return float(np.polynomial.polynomial.polyfit(r**2, p, 1, w=np.sqrt(area))[0])


def edge_radius(r: np.ndarray, p: np.ndarray, area: np.ndarray) -> float:
    """Contact radius from p^2 = p0^2 (1 - r^2/a^2), Hertz's form, which holds near the edge of any smooth contact.

    Zero of the area-weighted straight line p^2(r^2) through the nodes beyond half the last radius, the last one left
    out. r, p: (n,) nodes in contact, from the axis. With fewer than three such nodes, the last radius itself.
    """
    use = np.flatnonzero(r[:-1] >= 0.5 * r[-1])
    if use.size < 3:
        return float(r[-1])
    c0, c1 = np.polynomial.polynomial.polyfit(r[use] ** 2, p[use] ** 2, 1, w=np.sqrt(area[use]))
    return float(np.sqrt(-c0 / c1)) if c0 > 0.0 > c1 else float(r[-1])


def build(scene: Scene) -> Model:
    """Mesh, bodies and contact candidates of a scene that passed `support.check`."""
    units = scales(scene)
    punch = scene.counterbody.shape == "punch"
    lines = meshes.punch_lines if punch else meshes.smooth_lines
    mesh = meshes.half_plane(*lines(scene.fem.cells_per_radius, scene.fem.box))
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
    problem = ContactProblem(blocks, gap0)
    return Model(units, mesh, problem, surface, candidates, punch, scene.fem.cells_per_radius)


def load(model: Model, force: float, previous: Equilibrium | None) -> Equilibrium:
    """Equilibrium under `force`, from the previous step with its contact scaled as in Hertz (radius ~ force^(1/3)).

    The first step starts from the Hertz radius itself.
    """
    if previous is None:
        radius, u, known = 1.0, None, model.scales.peak_force
    else:
        radius, u, known = model.contact_radius(previous), previous.u, previous.force
    radius = 1.0 if model.punch else radius * (force / known) ** (1.0 / 3.0)
    return equilibrium(model.problem, force, model.radii <= radius, u)


def unloaded(model: Model) -> Equilibrium:
    """The state without force: an elastic body is as before, touched at one point without pressure."""
    zeros = np.zeros(model.candidates)
    none = np.zeros(model.candidates, dtype=bool)
    return Equilibrium(np.zeros(model.problem.size), 0.0, 0.0, zeros, model.problem.gap0, none, 0.0, 0, True)
