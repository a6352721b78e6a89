# SPDX-License-Identifier: MIT
"""The contact problem of a scene, in the units of its Hertz contact."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from skfem import MeshQuad

from fem_reference.axisymmetric import mesh as meshes
from fem_reference.common.contact import (
    Block,
    ContactProblem,
    Equilibrium,
    Load,
    equilibrium,
    without_contact,
)
from fem_reference.common.elasticity import AxisymmetricSolid, Solid, surface_weights
from fem_reference.common.film import coated_core, coated_lines, expected_radius, film_of
from fem_reference.common.hertz import Scales, hertz_pressure, plastic_radius, scales
from fem_reference.common.plasticity import J2, CurveInUnits, History, Material, Parts
from sam.scene.schema import Scene
from sam.scene.yield_curve import DepthProfile, Linear, YieldCurve

UNYIELDING = Linear(np.inf)
"""Yield curve of a material that stays elastic."""
EVEN = DepthProfile()
"""Of a body whose yield stress does not depend on depth."""


@dataclass(frozen=True)
class Model:
    """Everything that is fixed during the loading, in the units of `scales`.

    surface: (n_surface,) radii of the surface nodes; candidates: how many of them, from the axis, may touch; edge: radius
    up to which the mesh resolves a smooth contact; prescribed: the pressure of Hertz is given, at its place; expected: radius
    of the elastic contact at the peak, about; interface: depth of the film's lower face, also where the body's material fills
    it for comparison, None without a coating; profile: of the yield stress of the body over depth in m.
    """

    scales: Scales
    mesh: MeshQuad
    problem: ContactProblem
    surface: np.ndarray
    candidates: int
    punch: bool
    cells_per_radius: float
    edge: float
    prescribed: bool = False
    expected: float = 1.0
    interface: float | None = None
    profile: DepthProfile = EVEN

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
        if self.prescribed:
            return state.force * hertz_pressure(self.surface)
        area = surface_weights(self.surface)
        p = np.zeros(self.surface.size)
        p[1 : self.candidates] = state.multipliers[1:] / area[1 : self.candidates]
        p[0] = axis_pressure(self.surface[1:5], p[1:5], area[1:5]) if p.any() else 0.0
        return p

    def contact_radius(self, state: Equilibrium) -> float:
        """Radius of the last node in contact of a punch, or the given one; otherwise fitted to the gap, see `edge_radius`."""
        if self.prescribed:
            return 1.0 if state.force else 0.0
        if not state.active.any():
            return 0.0
        last = int(np.flatnonzero(state.active)[-1])
        if self.punch:
            return float(self.radii[last])
        film = self.body.film  # the gap opens as assumed within a distance of the thickness
        reach = 1.3 if film is None else float(np.clip(1.0 + film.thickness, 1.1, 1.3))
        return edge_radius(self.radii, state.gap, last, reach)

    def load(self, load: Load, previous: Equilibrium, cut: bool = False) -> Equilibrium:
        """Equilibrium under `load`, a step from the previous one; without force nothing touches.

        cut: a part of a step that did not converge begins with the nodes of the previous step: a node too many squeezes a soft
        body so far that Newton's method is lost.
        """
        if load.force == 0.0 and not previous.yielded:
            return self.virgin()
        if load.force == 0.0 or self.prescribed:
            return without_contact(self.problem, load, self.scales.peak_force, previous.u, previous.history)
        start = previous.active if cut and previous.active.any() else self.starting_set(load.force, previous)
        return equilibrium(self.problem, load, start, previous.u, previous.history)

    def starting_set(self, force: float, previous: Equilibrium) -> np.ndarray:
        """Nodes (bool) that probably touch under `force`: those of the previous step, for a smooth contact scaled.

        Radius ~ force^(1/3) as in Hertz, force^0.45 once the body has yielded; from no force, the radius of Hertz itself. Under
        a film that has yielded those of the previous step: a node too many squeezes it so far that Newton's method is lost.
        """
        if previous.yielded and previous.force > 0.0 and self.body.film is not None:
            return previous.active
        if self.punch:
            return previous.active if previous.force > 0.0 else self.radii <= 1.0
        if previous.force == 0.0:
            return self.radii <= self.expected * (force / self.scales.peak_force) ** (1.0 / 3.0)
        exponent = 0.45 if previous.yielded else 1.0 / 3.0
        return self.radii <= self.contact_radius(previous) * (force / previous.force) ** exponent

    def virgin(self) -> Equilibrium:
        """The state before loading, and of an elastic body after it: touched at one point without pressure."""
        zeros = np.zeros(self.candidates)
        none = np.zeros(self.candidates, dtype=bool)
        history = None if self.elastic else History.virgin(self.problem.material.shape)
        return Equilibrium(
            np.zeros(self.problem.size), 0.0, Load(0.0), zeros, self.problem.gap0, none, history
        )


def axis_pressure(r: np.ndarray, p: np.ndarray, area: np.ndarray) -> float:
    """Pressure at r = 0 from neighbours, by least squares with an even parabola, weighted by area.

    The area weights cancel the alternating error of corner and mid nodes.
    """
    return float(np.polynomial.polynomial.polyfit(r**2, p, 1, w=np.sqrt(area))[0])


def edge_radius(r: np.ndarray, gap: np.ndarray, last: int, reach: float = 1.3) -> float:
    """Contact radius from the gap outside, which opens with (r - a)^(3/2) at the edge of any smooth contact.

    Value at zero gap of a parabola r(gap^(2/3)) through the nodes up to `reach` r[last], without the first; within one
    element of the last node in contact. r, gap: (n,) nodes by radius; last: number of the last one in contact.
    """
    use = np.flatnonzero(r <= reach * r[last])
    use = np.union1d(use[use > last + 1], np.arange(last + 2, last + 6))  # a contact of one or two elements
    if use[-1] >= r.size:
        return float(r[last])
    opening = np.cbrt(gap[use]) ** 2
    radius = np.polynomial.polynomial.polyfit(opening, r[use], 2)[0]
    return float(np.clip(radius, r[max(last - 2, 0)], r[last + 2]))


def build(scene: Scene, film: bool = True) -> Model:
    """Mesh, bodies, material and contact candidates of a scene that passed `support.check`.

    film: False for the same mesh with the material of the body in place of the coating.
    """
    units, prescribed = scales(scene), scene.loading.prescribed is not None
    punch = not prescribed and scene.counterbody.shape == "punch"
    mesh = meshes.half_plane(*choose_lines(scene))
    layers = (film_of(scene, units) if film else None, None)
    # both bodies use one mesh, each in its own coordinates, so that their surface nodes match
    blocks = [
        Block(AxisymmetricSolid(mesh, young, body.poisson, film=layer), young, body.poisson)
        for young, body, layer in zip(units.young, (scene.body, scene.counterbody), layers, strict=False)
    ]
    solid = blocks[0].solid
    surface = solid.basis.doflocs[0, solid.boundary_dofs("surface", 1)]
    # the node of the outer boundary has a prescribed displacement
    candidates = int(np.searchsorted(surface, 1.0, side="right")) if punch else surface.size - 1
    gap0 = np.zeros(candidates) if punch else 0.5 * surface[:candidates] ** 2
    pressed = 0.0
    if prescribed:
        pressed = np.zeros(solid.size)
        pressed[solid.boundary_dofs("surface", 1)] = hertz_forces(surface)
    problem = ContactProblem(blocks, gap0, material(scene, units, solid), pressed)
    edge, expected = np.inf if punch else choose_core(scene).radius, expected_radius(scene)
    cells = scene.fem.cells_per_radius / min(1.0, expected)
    interface = scene.body.coating and scene.body.coating.thickness / units.length
    expected = expected if film else 1.0
    profile = profile_of(scene)
    return Model(
        units,
        mesh,
        problem,
        surface,
        candidates,
        punch,
        cells,
        edge,
        prescribed,
        expected,
        interface,
        profile,
    )


def hertz_forces(r: np.ndarray, points: int = 20) -> np.ndarray:
    """(2 n + 1,) consistent nodal forces of `hertz_pressure` on quadratic edges with the nodes r, corner and mid in turn.

    One corner is at r = 1. Gauss points in t of r = b - (b - a) t^2, in which sqrt(1 - r) is smooth up to an edge from a to
    b = 1. Exact to rounding.
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


def choose_core(scene: Scene) -> meshes.Core:
    """The uniform part of the mesh: larger when Hertz's stresses are beyond yield, and for a softer film."""
    punch = scene.counterbody is not None and scene.counterbody.shape == "punch"
    radius = None if punch else plastic_radius(scene)
    if scene.body.coating is not None:
        return coated_core(scene, radius)
    return meshes.ELASTIC if radius is None else meshes.plastic_core(radius)


def choose_lines(scene: Scene) -> tuple[np.ndarray, np.ndarray]:
    """(r, z) mesh lines in Hertz radii."""
    cells, box = scene.fem.cells_per_radius, scene.fem.box
    punch = scene.counterbody is not None and scene.counterbody.shape == "punch"
    if scene.body.coating is not None:
        return coated_lines(scene, choose_core(scene), punch)
    if punch:
        return meshes.punch_lines(cells, box)
    return meshes.smooth_lines(
        cells, box, choose_core(scene), np.array(profile_of(scene).depth) / scales(scene).length
    )


def profile_of(scene: Scene) -> DepthProfile:
    """Of the yield stress of the body over depth in m."""
    plasticity = scene.body.plasticity
    return EVEN if plasticity is None else plasticity.depth_profile()


def material(scene: Scene, units: Scales, solid: Solid) -> Material | None:
    """Plasticity of the body in the units of the model, the yield stress of each Gauss point at its depth."""
    plasticity, coating, shears = scene.body.plasticity, scene.body.coating, len(solid.stiffness_tensor) - 3
    flows = solid.film is not None and coating.yield_stress is not None
    if plasticity is None and not flows:
        return None

    def in_units(curve: YieldCurve) -> CurveInUnits:
        return CurveInUnits(curve, units.displacement / units.length, units.pressure)

    curve = in_units(plasticity.curve() if plasticity else UNYIELDING)
    factor = profile_of(scene)(solid.points[-1] * units.length)
    if solid.film is None:
        return J2(units.young[0], scene.body.poisson, curve, factor, shears)
    film, inside = solid.film, solid.in_film
    perfect = in_units(Linear(coating.yield_stress) if flows else UNYIELDING)
    layer = J2(film.young, film.poisson, perfect, np.ones_like(factor[inside]), shears)
    return Parts(
        [(inside, layer), (~inside, J2(units.young[0], scene.body.poisson, curve, factor[~inside], shears))]
    )
