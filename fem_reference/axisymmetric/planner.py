# SPDX-License-Identifier: MIT
"""The planner of the axisymmetric model: what it can represent, and the plan of a scene. Loads no library
but numpy.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fem_reference.axisymmetric.lines import choose_core, choose_lines, flat_end, is_punch, sphere_lines
from fem_reference.axisymmetric.misfit import MisfitSphere
from fem_reference.common.arrays import Array
from fem_reference.common.bodies import Elastic
from fem_reference.common.hertz import Scales, relative_moduli, required, scales
from fem_reference.common.plan import Plan, shared_fields, stages_of, with_bare_contact
from fem_reference.common.refusals import (
    box_problems,
    coating_problems,
    incompressible,
    refuse,
    running_in_problems,
    shape_problems,
)
from fem_reference.common.rounded import ROUNDED
from sam.scene.result import LeftOut, Stage
from sam.scene.schema import Scene
from sam.scene.section import Problem, spelling

MODEL = "fem-axisymmetric"
SHAPES = ("sphere", "punch", ROUNDED)
ELASTIC_CORE = 1.3
"""Radii of a misfit sphere up to which its mesh is uniform where nothing yields."""
NARROWEST = 1e-4
"""Smallest part of a contact beyond a flat end, over its radius: with 4e-4 a solve takes seconds, with 1e-6
minutes.
"""
BEYOND_ZONE = 1.1
"""The same in radii of its plastic zone, whose strain falls to zero there."""


@dataclass(frozen=True, kw_only=True)
class AxisymmetricPlan(Plan):
    """What the axisymmetric model solves of a scene; see `fem_reference.common.plan.Plan`.

    Attributes
    ----------
    r, z : (n,) arrays
        Mesh lines of each body.
    punch : bool
        The counter-body is a flat-ended cylinder.
    flat, opening : float
        The gap is opening (r - flat)^2/2 beyond a flat end, and zero below that; not used of a punch.
    edge : float
        Radius up to which the mesh resolves a smooth contact.
    interface : float or None
        Depth of the lower face of the coating, also where the material of the half-space takes its place.
    misfit : MisfitSphere or None
        A misfit strain in place of the counter-body.
    """

    r: Array
    z: Array
    punch: bool
    edge: float
    interface: float | None
    misfit: MisfitSphere | None = None
    flat: float = 0.0
    opening: float = 1.0

    def gap(self, r: Array) -> Array:
        """Gap of the unloaded bodies at radii, infinite beside a punch."""
        if self.punch:
            return np.where(r <= 1.0, 0.0, np.inf)
        return 0.5 * self.opening * np.maximum(r - self.flat, 0.0) ** 2


def plan(scene: Scene) -> AxisymmetricPlan:
    """Return what the axisymmetric model solves of a scene.

    Parameters
    ----------
    scene : Scene
        Any valid scene.

    Returns
    -------
    AxisymmetricPlan
        Units, bodies, mesh lines, load schedule, and the stages with their sizes and reasons.

    Raises
    ------
    UnsupportedScene
        If `check` does.

    Examples
    --------
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
    units = scales(scene)
    misfit = misfit_of(scene)
    r, z = choose_lines(scene) if misfit is None else lines_about(scene, misfit)
    fields = shared_fields(scene, units)
    coating, bodies = fields["bodies"].coating, len(fields["bodies"].elastic)
    columns, rows = r.size - 1, z.size - 1
    nodes = (columns + 1) * (rows + 1) + columns * (rows + 1) + rows * (columns + 1)
    elements, unknowns = bodies * columns * rows, 2 * bodies * nodes
    stages = _meshes(scene, {"elements": elements, "bodies": bodies, "unknowns": unknowns}, columns * rows)
    points = 4 * columns * rows
    stresses = Stage("stresses at the Gauss points", True, "at peak load", {"points": points})
    made = AxisymmetricPlan(
        model=MODEL,
        **fields,
        r=r,
        z=z,
        punch=is_punch(scene),
        edge=np.inf if is_punch(scene) or misfit is not None else choose_core(scene).radius,
        interface=None if coating is None else coating.thickness,
        misfit=misfit,
        flat=flat_end(scene),
        opening=opening(scene, units),
        elements=elements,
        unknowns=unknowns,
        points=points,
        stages=stages_of(scene, stages, stresses),
    )
    return with_bare_contact(made, scene)


def _meshes(scene: Scene, size: dict[str, int], elements: int) -> list[Stage]:
    """The stages of the mesh; elements: of one body."""
    where = "radius of the sphere" if scene.loading.misfit_sphere else "contact radius"
    reason = f"{scene.fem.cells_per_radius} cells in the {where}, box of {scene.fem.box:g} radii"
    stages = [Stage("mesh", True, reason, size)]
    if size["bodies"] > 1:
        words = "elastic: that of the body, turned over"
        stages.append(Stage("mesh of the counter-body", True, words, {"elements": elements}))
    return stages


def left_out(scene: Scene) -> list[LeftOut]:
    """Return the stages of the axisymmetric model that a scene does not need, with the reason.

    Parameters
    ----------
    scene : Scene
        Any valid scene.

    Returns
    -------
    list of LeftOut
        As a result of `solve` has them.

    Raises
    ------
    UnsupportedScene
        If `check` does.
    """
    return plan(scene).left_out


def check(scene: Scene) -> None:
    """Check that the axisymmetric model can represent a scene.

    Parameters
    ----------
    scene : Scene
        Any valid scene.

    Raises
    ------
    UnsupportedScene
        With every reason at once: key, value and what is allowed.
    """
    problems = shape_problems(scene, SHAPES, "axisymmetric")
    if scene.coefficient > 0:
        words = "the axisymmetric finite-element model allows 0: friction leaves no symmetry of rotation"
        problems.append(Problem("friction.coefficient", spelling(scene.coefficient), words))
    if scene.loading.path:
        words = "a load that stays on the axis of symmetry: remove it"
        problems.append(Problem("loading.path", "a table", words))
    for key, body in (("body", scene.body), ("counterbody", scene.counterbody)):
        problems += [] if body is None else incompressible(key, body.poisson)
    if scene.surface is not None:
        words = "the axisymmetric finite-element model allows a smooth body: remove [surface]"
        problems.append(Problem("surface.kind", spelling(scene.surface.kind), words))
    if scene.counter_surface is not None:
        words = "the axisymmetric finite-element model allows a smooth counter-body: remove the table"
        problems.append(Problem("counterbody.surface.kind", spelling(scene.counter_surface.kind), words))
    problems += running_in_problems(scene)
    refuse(problems)
    refuse([*coating_problems(scene), *_edge_problems(scene)])  # these need the contact radius of a shape
    misfit = misfit_of(scene)
    if misfit is not None:
        refuse(_held_problems(scene, misfit))
        refuse(
            box_problems(scene, core_about(scene, misfit) + 1.0 / scene.fem.cells_per_radius, "misfit sphere")
        )
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
    depth = required(loading.depth) / required(loading.radius)
    return MisfitSphere(elastic, depth, required(loading.profile), free=loading.surface == "free")


def opening(scene: Scene, units: Scales) -> float:
    """Curvature of the gap in the units of the model, which are those of a sphere but for a rounded edge."""
    counter = scene.counterbody
    if counter is None or counter.shape != ROUNDED:
        return 1.0
    return units.length / required(counter.radius) / units.strain


def core_about(scene: Scene, sphere: MisfitSphere) -> float:
    """Radius of the uniform part of the mesh about a misfit sphere."""
    return max(ELASTIC_CORE, BEYOND_ZONE * _zone(scene, sphere))


def lines_about(scene: Scene, sphere: MisfitSphere) -> tuple[Array, Array]:
    """(r, z) mesh lines about a misfit sphere."""
    fem = scene.fem
    return sphere_lines(fem.cells_per_radius, fem.box, core_about(scene, sphere), sphere.depth)


def _zone(scene: Scene, sphere: MisfitSphere) -> float:
    """Radius of the plastic zone about a misfit sphere in an infinite body; 0 where nothing yields."""
    plasticity, units = scene.body.plasticity, scales(scene)
    if plasticity is None:
        return 0.0
    limit = plasticity.strength().stress(sphere.depth * units.length, 0.0)
    return sphere.zone(float(limit) / units.pressure)


def _edge_problems(scene: Scene) -> list[Problem]:
    """A rounded edge so sharp that its part in contact is too small for a mesh."""
    end = flat_end(scene)
    if end == 0.0 or not 0.0 < 1.0 - end < NARROWEST:
        return []
    words = f"more: the contact ends {1.0 - end:.2g} of its radius beyond the flat end, the mesh allows "
    words += f'{NARROWEST:g}; or shape = "punch"'
    return [Problem("counterbody.radius", spelling(required(scene.counterbody).radius), words)]


def _held_problems(scene: Scene, sphere: MisfitSphere) -> list[Problem]:
    """A plastic zone that reaches a held surface, whose tractions it would change."""
    zone = _zone(scene, sphere)
    if sphere.free or zone < sphere.depth:
        return []
    least = zone * scales(scene).length
    words = f'with surface = "held" more than {least:g} m is allowed, the radius of the plastic zone'
    return [Problem("loading.depth", spelling(scene.loading.depth), words)]
