# SPDX-License-Identifier: MIT
"""The planner of the axisymmetric model: what it can represent, and the plan of a scene. Loads no library
but numpy.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fem_reference.axisymmetric.lines import choose_core, choose_lines, is_punch
from fem_reference.common.arrays import Array
from fem_reference.common.hertz import scales
from fem_reference.common.plan import Plan, shared_fields, stages_of, with_bare_contact
from fem_reference.common.refusals import (
    box_problems,
    coating_problems,
    incompressible,
    misfit_problems,
    refuse,
    running_in_problems,
    shape_problems,
)
from sam.scene.errors import Problem, spelling
from sam.scene.result import LeftOut, Stage
from sam.scene.schema import Scene

MODEL = "fem-axisymmetric"
SHAPES = ("sphere", "punch")


@dataclass(frozen=True, kw_only=True)
class AxisymmetricPlan(Plan):
    """What the axisymmetric model solves of a scene; see `fem_reference.common.plan.Plan`.

    Attributes
    ----------
    r, z : (n,) arrays
        Mesh lines of each body.
    punch : bool
        The counter-body is a flat-ended cylinder.
    edge : float
        Radius up to which the mesh resolves a smooth contact.
    interface : float or None
        Depth of the lower face of the coating, also where the material of the half-space takes its place.
    """

    r: Array
    z: Array
    punch: bool
    edge: float
    interface: float | None


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
    r, z = choose_lines(scene)
    fields = shared_fields(scene, units)
    coating, bodies = fields["bodies"].coating, len(fields["bodies"].elastic)
    columns, rows = r.size - 1, z.size - 1
    nodes = (columns + 1) * (rows + 1) + columns * (rows + 1) + rows * (columns + 1)
    elements, unknowns = bodies * columns * rows, 2 * bodies * nodes
    reason = f"{scene.fem.cells_per_radius} cells in the contact radius, box of {scene.fem.box:g} radii"
    stages = [Stage("mesh", True, reason, {"elements": elements, "bodies": bodies, "unknowns": unknowns})]
    if bodies > 1:
        words = "elastic: that of the body, turned over"
        stages.append(Stage("mesh of the counter-body", True, words, {"elements": columns * rows}))
    points = 4 * columns * rows
    stresses = Stage("stresses at the Gauss points", True, "at peak load", {"points": points})
    made = AxisymmetricPlan(
        model=MODEL,
        **fields,
        r=r,
        z=z,
        punch=is_punch(scene),
        edge=np.inf if is_punch(scene) else choose_core(scene).radius,
        interface=None if coating is None else coating.thickness,
        elements=elements,
        unknowns=unknowns,
        points=points,
        stages=stages_of(scene, stages, stresses),
    )
    return with_bare_contact(made, scene)


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
    problems = shape_problems(scene, SHAPES, "axisymmetric") + misfit_problems(scene, "axisymmetric")
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
    refuse(coating_problems(scene))  # these need the contact radius of a shape that is allowed
    if scene.body.plasticity is not None or scene.body.coating is not None:
        core, kind = choose_core(scene), "coated" if scene.body.plasticity is None else "plastic"
        reach = max(core.radius, core.depth) + 1.0 / scene.fem.cells_per_radius
        refuse(box_problems(scene, reach, f"{kind} contact"))
