# SPDX-License-Identifier: MIT
"""The three-dimensional contact problem of a scene, in the units of its Hertz contact."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from fem_reference.axisymmetric.mesh import Sizes, film_depths, uniform_then_growing
from fem_reference.axisymmetric.model import EVEN, material, profile_of
from fem_reference.common.contact import Equilibrium, Load, equilibrium, without_contact
from fem_reference.common.film import expected_radius, film_of, yielded_radius
from fem_reference.common.hertz import Scales, hertz_pressure, plastic_radius, scales
from fem_reference.common.loading import Sliding
from fem_reference.common.messages import FEWEST_ELEMENTS
from fem_reference.common.plasticity import History
from fem_reference.spatial.hexahedra import GROWTH, HexSolid, Lines, block, on_grid, two_sided
from fem_reference.spatial.problem import SlidingProblem
from fem_reference.spatial.surface import contact_area, hertz_forces
from sam.scene.schema import Scene
from sam.scene.yield_curve import DepthProfile

WIDTH, DEPTH = 1.4, 1.2
"""Uniform part of the mesh, in radii of the contact: to both sides, and in depth."""


@dataclass(frozen=True)
class Model:
    """Everything that is fixed during the loading, in the units of `scales`.

    axes: semi-axes along x and y of the elastic contact at the peak; core: (low x, high x, high y) of the uniform mesh;
    curvature: of the gap along x and y; candidates: places in the flat (nx + 1, ny + 1) array of surface nodes of those that
    may touch, the apex first; prescribed: the pressure of Hertz is given instead of a counter-body; expected, film_layers: as
    in fem_reference.axisymmetric.model, and the layers of elements above the interface, None without a coating;
    weights: (nx + 1, ny + 1)
    local coefficient of friction over the largest one; profile: as in fem_reference.axisymmetric.model.
    """

    scales: Scales
    lines: Lines
    problem: SlidingProblem
    axes: tuple[float, float]
    core: tuple[float, float, float]
    curvature: tuple[float, float]
    candidates: np.ndarray
    surface: np.ndarray
    cells_per_radius: float
    sliding: Sliding
    prescribed: bool
    expected: float = 1.0
    film_layers: int | None = None
    weights: np.ndarray | float = 1.0
    profile: DepthProfile = EVEN

    @property
    def elastic(self) -> bool:
        """Whether the body has no plastic history."""
        return self.problem.material is None

    @property
    def body(self) -> HexSolid:
        return self.problem.solid

    @cached_property
    def places(self) -> tuple[np.ndarray, np.ndarray]:
        """x and y of the candidates."""
        i, j = np.unravel_index(self.candidates, self.surface.shape)
        return self.lines.x[i], self.lines.y[j]

    @cached_property
    def elements(self) -> np.ndarray:
        """(nx, ny, nz) numbers of the elements."""
        mesh = self.problem.mesh
        return on_grid(mesh.p[:, mesh.t].mean(axis=1), self.lines.shape)

    @property
    def initial_gap(self) -> np.ndarray:
        """(nx + 1, ny + 1) gap of the paraboloid."""
        x, y = self.lines.x[:, None], self.lines.y[None, :]
        return 0.5 * (self.curvature[0] * x**2 + self.curvature[1] * y**2)

    def on_surface(self, values: np.ndarray) -> np.ndarray:
        """(nx + 1, ny + 1) from values at the candidates, zero elsewhere."""
        field = np.zeros(self.surface.size)
        field[self.candidates] = values
        return field.reshape(self.surface.shape)

    def nodal_pressure(self, state: Equilibrium) -> np.ndarray:
        """(nx + 1, ny + 1) multipliers over the areas of the nodes; the given pressure where it is given."""
        if self.prescribed:
            x, y = self.lines.x[:, None] - state.load.x, self.lines.y[None, :] - state.load.y
            return state.force * hertz_pressure(np.hypot(x, y))
        return self.on_surface(state.multipliers) / self.lines.areas

    def area(self, state: Equilibrium) -> float:
        """Area of the contact, of both halves."""
        if self.prescribed:
            return np.pi if state.force else 0.0
        gap = np.clip(self.on_surface(state.gap), 0.0, None)
        pressure = np.clip(self.nodal_pressure(state), 0.0, None)
        return contact_area(self.lines.x, self.lines.y, pressure, gap, self.lines.half)

    def ratio(self, state: Equilibrium) -> np.ndarray:
        """(nx + 1, ny + 1) tangential over normal traction."""
        return state.load.ratio * self.weights * np.ones(self.surface.shape)

    def friction(self, state: Equilibrium) -> float:
        """Size of the tangential force over the normal one; the largest coefficient without any."""
        if np.all(self.weights == 1.0) or not state.multipliers.any():
            return self.sliding.coefficient
        shares = self.weights.ravel()[self.candidates]
        return self.sliding.coefficient * float(np.average(shares, weights=state.multipliers))

    def outgrown(self, state: Equilibrium) -> bool:
        """Whether the contact reaches beyond the uniform part of the mesh."""
        (x, y), (low, high, wide) = self.places, self.core
        return bool((state.active & ((x <= low) | (x >= high) | (np.abs(y) >= wide))).any())

    def too_coarse(self, states: Sequence[Equilibrium]) -> bool:
        """Whether the largest contact has fewer elements in its radius than FEWEST_ELEMENTS."""
        radius = np.sqrt(max(self.area(state) for state in states) / np.pi)
        return round(radius * self.cells_per_radius) < FEWEST_ELEMENTS

    def centroid(self, state: Equilibrium) -> float:
        """x of the resultant of the pressure."""
        forces = self.nodal_pressure(state) * self.lines.areas
        return float((forces.sum(axis=1) * self.lines.x).sum() / (forces.sum() or 1.0))

    def load(self, load: Load, previous: Equilibrium, cut: bool = False) -> Equilibrium:
        """Equilibrium under `load`, a step from the previous one; without force nothing touches.

        cut: a part of a step that did not converge begins with the nodes of the previous step: a node too many squeezes a soft
        body so far that Newton's method is lost.
        """
        if load.force == 0.0 and not previous.yielded:
            return self.virgin(load)
        if load.force == 0.0 or self.prescribed:
            return without_contact(self.problem, load, self.scales.peak_force, previous.u, previous.history)
        start = previous.active if cut and previous.active.any() else self.starting_set(load.force, previous)
        return equilibrium(self.problem, load, start, previous.u, previous.history)

    def starting_set(self, force: float, previous: Equilibrium) -> np.ndarray:
        """Nodes (bool) that probably touch: the ellipse of Hertz, or that of the previous area, scaled with the force."""
        radius, share = self.expected, force / self.scales.peak_force
        if previous.force > 0.0:
            radius, share = np.sqrt(self.area(previous) / np.pi), force / previous.force
        radius *= share ** (0.45 if previous.yielded else 1.0 / 3.0)
        (x, y), (a, b) = self.places, self.axes
        return np.hypot(x / a, y / b) <= radius

    def virgin(self, load: Load | None = None) -> Equilibrium:
        """The state before loading, and of an elastic body after it: touched at one point without pressure."""
        none = np.zeros(self.candidates.size)
        history = None if self.elastic else History.virgin(self.problem.material.shape, components=6)
        u = np.zeros(self.problem.size)
        return Equilibrium(u, 0.0, load or Load(0.0), none, self.problem.gap0, none.astype(bool), history)


def build(scene: Scene, film: bool = True) -> Model:
    """Mesh, body, material and contact candidates of a scene that passed `support.check`; film as in the
    axisymmetric model."""
    if scene.surface is not None:
        from fem_reference.spatial.rough import build as build_rough  # a smooth body does without

        return build_rough(scene)
    units, curvature, sliding = scales(scene), curvatures(scene), slide(scene)
    axes = tuple((curvature[1 - i] / curvature[i]) ** (1.0 / 3.0) for i in (0, 1))
    lines, core = choose_lines(scene)
    layer = film_of(scene, units)
    solid = HexSolid(block(lines), units.young[0], scene.body.poisson, film=layer if film else None)
    surface = surface_nodes(solid, lines)
    x, y = solid.basis.mesh.p[:2, surface.ravel()]
    inside = (x > lines.x[0]) & (x < lines.x[-1]) & (y < lines.y[-1]) & ((y > lines.y[0]) | lines.half)
    places = np.flatnonzero(inside)
    candidates = places[np.argsort(np.hypot(x, y)[places], kind="stable")]
    gap0 = 0.5 * (curvature[0] * x**2 + curvature[1] * y**2)[candidates]
    prescribed, weights = scene.loading.prescribed is not None, friction_weights(scene, lines, units)

    def pressed(load: Load) -> np.ndarray:
        forces = load.force * hertz_forces(lines.x, lines.y, (load.x, load.y))
        nodal = np.zeros(solid.size)
        dofs = solid.basis.nodal_dofs[:, surface]
        nodal[dofs[2]], nodal[dofs[0]] = forces, load.ratio * forces
        return nodal

    problem = SlidingProblem(
        solid,
        (units.young[0], scene.body.poisson),
        lines.share,
        surface.ravel()[candidates],
        gap0,
        material(scene, units, solid),
        pressed if prescribed else None,
        weights=weights.ravel()[candidates],
    )
    expected = expected_radius(scene)
    size, layers = (
        scene.fem.cells_per_radius / min(1.0, expected),
        layer and int(np.searchsorted(lines.z, layer.thickness)),
    )
    fixed = units, lines, problem, axes, core, curvature, candidates, surface, size, sliding, prescribed
    return Model(*fixed, expected if film else 1.0, layers, weights, profile_of(scene))


def surface_nodes(solid: HexSolid, lines: Lines) -> np.ndarray:
    """(nx + 1, ny + 1) numbers of the nodes at z = 0."""
    p = solid.basis.mesh.p
    top = np.flatnonzero(p[2] == 0.0)
    return top[on_grid(p[:, top], (lines.x.size, lines.y.size))]


def friction_weights(scene: Scene, lines: Lines, units: Scales) -> np.ndarray:
    """(nx + 1, ny + 1) coefficient of friction over the largest one: of the map's cell that holds the node, or the nearest."""
    if scene.constant_friction or scene.coefficient == 0.0:
        return np.ones((lines.x.size, lines.y.size))
    found, cells = scene.friction.path, []
    for line, side, n in zip((lines.x, lines.y), found.extent, found.cells, strict=True):
        cells.append(np.clip(np.floor((line * units.length / side + 0.5) * n), 0, n - 1).astype(int))
    return found.values[np.ix_(*cells)] / scene.coefficient


def curvatures(scene: Scene) -> tuple[float, float]:
    """Curvatures of the gap along x and y over their geometric mean."""
    if scene.counterbody is None:
        return 1.0, 1.0
    rx, ry = scene.counterbody.radii
    return float(np.sqrt(ry / rx)), float(np.sqrt(rx / ry))


def slide(scene: Scene) -> Sliding:
    """Friction and path of the scene, in the units of the model."""
    alternating = scene.friction is not None and scene.friction.direction == "alternating"
    path, places = scene.loading.path, np.zeros((1, 2))
    if path is not None:
        places = np.linspace(path.start, path.end, path.steps + 1) / scene.loading.radius
    return Sliding(scene.coefficient, alternating, places)


def mesh_lines(scene: Scene) -> Lines:
    """Mesh planes of any scene, smooth or rough."""
    if scene.surface is not None:
        from fem_reference.spatial.rough import choose_lines as choose_rough_lines

        return choose_rough_lines(scene)
    return choose_lines(scene)[0]


def choose_lines(scene: Scene) -> tuple[Lines, tuple[float, float, float]]:
    """Mesh planes, and (low x, high x, high y) of their uniform part. A half where path and friction are symmetric to y = 0.

    Uniform are WIDTH to both sides of the contact, wherever it goes, and DEPTH below it, larger where it outgrows Hertz's.
    """
    curvature, sliding = curvatures(scene), slide(scene)
    a, b = ((curvature[1 - i] / curvature[i]) ** (1.0 / 3.0) for i in (0, 1))
    box, expected = scene.fem.box, expected_radius(scene)
    grown, cells = (
        max(plastic_radius(scene) or 1.0, expected, yielded_radius(scene)),
        scene.fem.cells_per_radius,
    )
    cells = cells if expected >= 1.0 else cells / expected
    (low_x, low_y), (high_x, high_y) = sliding.places.min(axis=0), sliding.places.max(axis=0)
    reach = WIDTH * grown
    half = scene.constant_friction and not sliding.places[:, 1].any()
    x = two_sided(min(low_x, 0.0) - reach * a, max(high_x, 0.0) + reach * a, a / cells, box)
    core = min(low_x, 0.0) - reach * a, max(high_x, 0.0) + reach * a, max(high_y, 0.0) + reach * b
    y = two_sided(min(low_y, 0.0) - reach * b, core[2], b / cells, box)
    size, depth, film = min(a, b) / cells, DEPTH * grown * min(a, b), film_of(scene, scales(scene))
    if film is None:
        z = uniform_then_growing(size, depth, box, GROWTH)
    else:
        z = film_depths(film.thickness, box, Sizes(size, size, (depth, depth)), GROWTH)
    return Lines(x, y[y >= 0.0] if half else y, z, half), core


def uniform_depth(scene: Scene) -> float:
    """Depth of the uniform part of the mesh, at most."""
    grown = max(plastic_radius(scene) or 1.0, expected_radius(scene), yielded_radius(scene))
    return DEPTH * grown + 1.0 / scene.fem.cells_per_radius
