# SPDX-License-Identifier: MIT
"""The planner of the axisymmetric model: what it can represent, and the plan of a scene. Loads no library
but numpy.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from fem_reference.axisymmetric.misfit import MisfitSphere
from fem_reference.common.arrays import Array
from fem_reference.common.bodies import Elastic, coating_of, expected_radius, yielded_radius
from fem_reference.common.hertz import ROUNDED, kinks_of, plastic_radius, relative_moduli, scales
from fem_reference.common.mesh_lines import (
    CLOSEST,
    GROWTH,
    Sizes,
    coated_depths,
    grow,
    marched,
    uniform_then_growing,
)
from fem_reference.common.plan import Plan, planned, section_of
from fem_reference.common.refusals import box_problems, coating_problems, problems_of, refuse
from sam.scene.result import LeftOut
from sam.scene.schema import Scene
from sam.scene.section import Problem, spelling, stated

MODEL = "fem-axisymmetric"
SHAPES = ("sphere", "punch", ROUNDED)
ELASTIC_CORE = 1.3
"""Radii of a misfit sphere up to which its mesh is uniform where nothing yields."""
NARROWEST = 1e-4
"""Smallest share of a contact beyond a flat end: 4e-4 takes seconds, 1e-6 minutes."""
BEYOND_ZONE = 1.1
"""The same in radii of its plastic zone, whose strain falls to zero there."""


@dataclass(frozen=True, kw_only=True)
class AxisymmetricPlan(Plan):
    """What the axisymmetric model solves of a scene; see `fem_reference.common.plan.Plan`.

    r, z: (n,) mesh lines of each body; punch: the counter-body is a flat-ended cylinder; flat, opening: the
    gap is opening (r - flat)^2/2 beyond a flat end, and zero below that, not used of a punch; edge: radius up
    to which the mesh resolves a smooth contact; misfit: a misfit strain in place of the counter-body.
    """

    r: Array
    z: Array
    punch: bool
    edge: float
    misfit: MisfitSphere | None = None
    flat: float = 0.0
    opening: float = 1.0

    def gap(self, r: Array) -> Array:
        """Gap of the unloaded bodies at radii, infinite beside a punch."""
        if self.punch:
            return np.where(r <= 1.0, 0.0, np.inf)
        return 0.5 * self.opening * np.maximum(r - self.flat, 0.0) ** 2


def plan(scene: Scene) -> AxisymmetricPlan:
    """What the axisymmetric model solves of a scene; UnsupportedScene as of `check`.

    >>> sphere = Scene(
    ...     body={"young": 210e9, "poisson": 0.3},
    ...     counterbody={"shape": "sphere", "radius": 1e-4},
    ...     loading={"force": 1.0},
    ... )
    >>> made = plan(sphere)
    >>> made.elements, made.unknowns, len(made.schedule.targets)
    (1140, 7114, 1)
    >>> [stage.stage for stage in made.stages if stage.runs]
    ['mesh', 'contact search', 'stresses at the Gauss points']
    """
    check(scene)
    units, fem, counter, misfit = scales(scene), scene.fem, scene.counterbody, misfit_of(scene)
    if misfit is None:
        r, z = choose_lines(scene)
    else:
        r, z = sphere_lines(fem.cells_per_radius, fem.box, core_about(scene, misfit), misfit.depth)
    where = "contact radius" if misfit is None else "radius of the sphere"
    words = f"{fem.cells_per_radius} cells in the {where}, box of {fem.box:g} radii"
    opening = 1.0  # the units are those of a sphere but for a rounded edge
    if counter is not None and counter.shape == ROUNDED:
        opening = units.length / stated(counter.radius) / units.strain
    return planned(
        AxisymmetricPlan,
        scene,
        units,
        model=MODEL,
        r=r,
        z=z,
        punch=is_punch(scene),
        edge=np.inf if is_punch(scene) or misfit is not None else choose_core(scene).radius,
        misfit=misfit,
        flat=flat_end(scene),
        opening=opening,
        **section_of(scene, r, z, words),
    )


def left_out(scene: Scene) -> list[LeftOut]:
    """Stages that a scene does not need, with the reason, as a result of `solve` has them."""
    return plan(scene).left_out


def check(scene: Scene) -> None:
    """Raise UnsupportedScene with every reason at once, key, value and what is allowed, for a scene that the
    axisymmetric model cannot represent.
    """
    problems, allows = (
        problems_of(scene, SHAPES, "axisymmetric"),
        "the axisymmetric finite-element model allows",
    )
    if scene.coefficient > 0:
        words = f"{allows} 0: friction leaves no symmetry of rotation"
        problems.append(Problem("friction.coefficient", spelling(scene.coefficient), words))
    if scene.loading.path:
        words = "a load that stays on the axis of symmetry: remove it"
        problems.append(Problem("loading.path", "a table", words))
    if scene.surface is not None:
        words = f"{allows} a smooth body: remove [surface]"
        problems.append(Problem("surface.kind", spelling(scene.surface.kind), words))
    if scene.counter_surface is not None:
        words = f"{allows} a smooth counter-body: remove the table"
        problems.append(Problem("counterbody.surface.kind", spelling(scene.counter_surface.kind), words))
    refuse(problems)
    problems, end = coating_problems(scene), flat_end(scene)  # these need the contact radius of a shape
    if end and 0.0 < 1.0 - end < NARROWEST:
        words = f"more: the contact ends {1.0 - end:.2g} of its radius beyond the flat end, the mesh allows "
        words += f'{NARROWEST:g}; or shape = "punch"'
        problems.append(Problem("counterbody.radius", spelling(stated(scene.counterbody).radius, "m"), words))
    refuse(problems)
    if (misfit := misfit_of(scene)) is not None:
        zone = _zone(scene, misfit)
        if not misfit.free and zone >= misfit.depth:  # it would change the tractions that hold the surface
            least = zone * scales(scene).length
            words = f'with surface = "held" more than {least:g} m is allowed, the radius of the plastic zone'
            refuse([Problem("loading.depth", spelling(scene.loading.depth, "m"), words)])
        reach = core_about(scene, misfit) + 1.0 / scene.fem.cells_per_radius
        refuse(box_problems(scene, reach, "misfit sphere"))
    elif scene.body.plasticity is not None or scene.body.coating is not None:
        core, kind = choose_core(scene), "coated" if scene.body.plasticity is None else "plastic"
        reach = max(core.radius, core.depth) + 1.0 / scene.fem.cells_per_radius
        refuse(box_problems(scene, reach, f"{kind} contact"))


def misfit_of(scene: Scene) -> MisfitSphere | None:
    """The misfit sphere of a scene in the units of the model; None if it is loaded at its surface."""
    loading = scene.loading
    if not loading.misfit_sphere:
        return None
    elastic = Elastic(relative_moduli(scene)[0], scene.body.poisson)
    depth = stated(loading.depth) / stated(loading.radius)
    return MisfitSphere(elastic, depth, stated(loading.profile), free=loading.surface == "free")


def core_about(scene: Scene, sphere: MisfitSphere) -> float:
    """Radius of the uniform part of the mesh about a misfit sphere."""
    return max(ELASTIC_CORE, BEYOND_ZONE * _zone(scene, sphere))


def _zone(scene: Scene, sphere: MisfitSphere) -> float:
    """Radius of the plastic zone about a misfit sphere in an infinite body; 0 where nothing yields."""
    plasticity, units = scene.body.plasticity, scales(scene)
    if plasticity is None:
        return 0.0
    limit = plasticity.strength().stress(sphere.depth * units.length, 0.0)
    return sphere.zone(float(limit) / units.pressure)


def sphere_lines(cells_per_radius: int, box: float, core: float, depth: float) -> tuple[Array, Array]:
    """(r, z) mesh lines about a misfit sphere of radius 1 at `depth`, uniform up to `core`."""
    size = 1.0 / cells_per_radius
    beside = uniform_then_growing(size, core, box)
    if core + size < depth:
        above = uniform_then_growing(size, core, depth)
    else:
        above = np.linspace(0.0, depth, int(np.ceil(round(depth / size, 9))) + 1)
    upper = depth - above[:0:-1]
    upper[0] = 0.0
    return beside, np.concatenate([upper, depth + beside])


@dataclass(frozen=True)
class Core:
    """Radius and depth of the uniform part of a mesh for a smooth contact of radius 1."""

    radius: float = 1.3
    depth: float = 0.8


IN_ROUNDING = 4.0
"""Elements in a contact radius over those in its part beyond a flat end."""
ELASTIC = Core()
"""The largest von Mises stress of Hertz is at the depth 0.48."""


def plastic_core(radius: float) -> Core:
    """Uniform part for a plastic contact of about `radius`: twice the depth changes scalars by 1e-4."""
    return Core(1.3 * radius, 1.2 * radius)


def smooth_lines(
    cells_per_radius: int, box: float, core: Core = ELASTIC, marks: Sequence[float] | Array = ()
) -> tuple[Array, Array]:
    """(r, z) mesh lines for a smooth contact of radius 1; marks: depths of other materials."""
    size = 1.0 / cells_per_radius
    r = uniform_then_growing(size, core.radius, box)
    return r, uniform_then_growing(size, core.depth, box, marks=marks)


def punch_lines(cells_per_radius: int, box: float) -> tuple[Array, Array]:
    """(r, z) mesh lines for a punch of radius 1: inside r = sin(i pi / (2 n)), where the force of
    its pressure 1/sqrt(1 - r^2) is smooth up to the edge; outside, and in depth, growing from the
    size there.
    """
    inside = np.sin(np.linspace(0.0, np.pi / 2.0, cells_per_radius + 1))
    inside[-1] = 1.0
    edge = inside[-1] - inside[-2]
    return np.concatenate([inside, grow(1.0, box, edge)]), np.concatenate([[0.0], grow(0.0, box, edge)])


def rounded_lines(scene: Scene, core: Core) -> tuple[Array, Array]:
    """(r, z) mesh lines for a punch with a rounded edge, finer beyond its flat end."""
    flat, coating, box = flat_end(scene), coating_of(scene, scales(scene)), scene.fem.box
    coarse = 1.0 / scene.fem.cells_per_radius
    fine = min(1.0, IN_ROUNDING * (1.0 - flat)) * coarse if flat < 1.0 else coarse  # no force: no edge
    beyond = core.radius / ELASTIC.radius - flat
    radial = Sizes(fine, coarse, (flat + ELASTIC.radius * beyond, core.radius))
    axial = Sizes(fine, coarse, (ELASTIC.depth * beyond, core.depth))
    inside = flat - marched(0.0, flat, fine, lambda _: coarse)[::-1]
    inside[0] = 0.0
    edge = np.linspace(flat, 1.0, round((1.0 - flat) / fine) + 1)
    r = np.concatenate([inside, edge, marched(1.0, box, fine, radial)])
    if coating is not None:
        return r, coated_depths(coating.thickness, box, axial)
    z = [0.0]
    for mark in (*kinks_of(scene, scales(scene)), box):
        if mark == box or z[-1] + fine / CLOSEST <= mark < core.depth:
            size = fine if len(z) == 1 else GROWTH * (z[-1] - z[-2])
            z.extend(marched(z[-1], mark, size, axial))
    return r, np.array(z)


def coated_lines(scene: Scene, core: Core) -> tuple[Array, Array]:
    """(r, z) mesh lines, sized by the smaller contact, with and without coating, near it."""
    coating = stated(coating_of(scene, scales(scene)))
    cells, box = scene.fem.cells_per_radius, scene.fem.box
    if is_punch(scene):
        r, z = punch_lines(cells, box)
        return r, coated_depths(coating.thickness, box, Sizes(z[1], np.inf, (0.0, 0.0)))
    small, large = min(1.0, expected_radius(scene)), core.radius / ELASTIC.radius
    fine = small / cells
    coarse = fine if large < 2.0 * small else large / cells
    near = small if large >= 2.0 * small else large
    radial, axial = (Sizes(fine, coarse, (near * edge / large, edge)) for edge in (core.radius, core.depth))
    uniform = fine * np.arange(int(np.ceil(round(radial.limits[0] / fine, 9))) + 1)
    r = np.concatenate([uniform, marched(uniform[-1], box, GROWTH * fine, radial)])
    return r, coated_depths(coating.thickness, box, axial)


def is_punch(scene: Scene) -> bool:
    """Whether the counter-body is a flat-ended cylinder."""
    return scene.counterbody is not None and scene.counterbody.shape == "punch"


def flat_end(scene: Scene) -> float:
    """Radius of the flat end of a punch with a rounded edge, in contact radii; 0 of other shapes."""
    counter = scene.counterbody
    if counter is None or counter.flat_radius is None:
        return 0.0
    return counter.flat_radius / scales(scene).length


def choose_core(scene: Scene) -> Core:
    """The uniform part of the mesh: larger if Hertz's stresses yield, and for a softer coating."""
    coating, radius = scene.body.coating, None if is_punch(scene) else plastic_radius(scene)
    if coating is None:
        return ELASTIC if radius is None else plastic_core(radius)
    reach = max(1.0, expected_radius(scene), radius or 1.0, yielded_radius(scene))
    if coating.yield_stress is not None or radius is not None:
        return plastic_core(reach)
    return Core(ELASTIC.radius * reach, ELASTIC.depth * reach)


def choose_lines(scene: Scene) -> tuple[Array, Array]:
    """(r, z) mesh lines in Hertz radii."""
    cells, box = scene.fem.cells_per_radius, scene.fem.box
    if flat_end(scene) > 0.0:
        return rounded_lines(scene, choose_core(scene))
    if scene.body.coating is not None:
        return coated_lines(scene, choose_core(scene))
    if is_punch(scene):
        return punch_lines(cells, box)
    return smooth_lines(cells, box, choose_core(scene), kinks_of(scene, scales(scene)))
