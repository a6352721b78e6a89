# SPDX-License-Identifier: MIT
"""The planner of the plane-strain model: what it can represent, and the plan of a scene. Loads no library
but numpy.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fem_reference.common.arrays import Array
from fem_reference.common.hertz import kinks_of, scales
from fem_reference.common.mesh_lines import two_sided, uniform_then_growing
from fem_reference.common.plan import Plan, planned, section_of, slide
from fem_reference.common.refusals import box_problems, problems_of, refuse
from sam.scene.result import LeftOut
from sam.scene.schema import Scene
from sam.scene.section import Problem, spelling, stated

MODEL = "fem-plane-strain"
ALLOWS = "the plane-strain finite-element model allows"
WIDTH = 1.4
"""Uniform part of the mesh to both sides of the contact in its half-widths: the edge stays inside."""
ELASTIC_DEPTH, PLASTIC_DEPTH = 1.2, 1.5
"""Uniform part of the mesh in depth, in half-widths; the largest von Mises stress of Hertz is at 0.7."""
GROWTH = 1.4
"""Ratio of neighbouring elements outside the uniform part."""
FIRST_YIELD = 0.558
"""Largest von Mises stress over p0 on the axis below a cylinder, nu = 0.3, that sets meshes."""
FULL = 2.3
"""Mean pressure over the yield stress beyond which the contact grows with the force; with friction less by
about 1 + friction: at 0.4 a body that hardens by E/20 is a third wider than Hertz, p0 = 3 yield stresses.
"""


@dataclass(frozen=True, kw_only=True)
class PlaneStrainPlan(Plan):
    """What the plane-strain model solves of a scene; see `fem_reference.common.plan.Plan`.

    x, z: (n,) mesh lines of each body, x from 0 if half of the section is modelled; core: (low x, high x) of
    the uniform part; length: of the cylinder, in half-widths.
    """

    x: Array
    z: Array
    half: bool
    core: tuple[float, float]
    length: float

    @property
    def radius(self) -> float:
        """Half-width of the elastic contact at the peak in m."""
        return self.scales.length


def plan(scene: Scene) -> PlaneStrainPlan:
    """What the plane-strain model solves of a scene; UnsupportedScene as of `check`."""
    check(scene)
    units, counter = scales(scene), stated(scene.counterbody)
    half, (x, z), core = is_half(scene), *choose_lines(scene)
    words = f"{'half of the section, x >= 0' if half else 'the whole section'}, plane strain"
    return planned(
        PlaneStrainPlan,
        scene,
        units,
        model=MODEL,
        x=x,
        z=z,
        half=half,
        core=core,
        length=stated(counter.length) / units.length,
        **section_of(scene, x, z, words),
    )


def left_out(scene: Scene) -> list[LeftOut]:
    """Stages that a scene does not need, with the reason, as a result of `solve` has them."""
    return plan(scene).left_out


def check(scene: Scene) -> None:
    """Raise UnsupportedScene with every reason at once, key, value and what is allowed, for a scene that the
    plane-strain model cannot represent.
    """
    loading, coating = scene.loading, scene.body.coating
    problems = problems_of(scene, ("cylinder",), "plane-strain")
    if loading.prescribed is not None:
        words = f'{ALLOWS} a counter-body of shape "cylinder"'
        problems.append(Problem("loading.prescribed", spelling(loading.prescribed), words))
    if coating is not None:
        words = f"{ALLOWS} no film: remove [body.coating]"
        problems.append(Problem("body.coating.thickness", spelling(coating.thickness, "m"), words))
    for key, surface in (("surface", scene.surface), ("counterbody.surface", scene.counter_surface)):
        if surface is not None:
            words = f"{ALLOWS} smooth bodies: remove [{key}]"
            problems.append(Problem(f"{key}.kind", spelling(surface.kind), words))
    refuse(problems)
    depth = _grown(scene)[1] + 1.0 / scene.fem.cells_per_radius
    refuse(box_problems(scene, depth, "contact"))


def is_half(scene: Scene) -> bool:
    """Whether the section is symmetric to x = 0: no friction, no load beside it."""
    return scene.coefficient == 0.0 and not slide(scene, 1.0).places.any()


def _grown(scene: Scene) -> tuple[float, float]:
    """Half-width of the largest contact, and depth of the uniform part, in those of Hertz."""
    units, plasticity = scales(scene), scene.body.plasticity
    peak = 0.5 * units.pressure  # p0 = E* a/(2 R), Johnson 1985, Eq. (4.44)
    if plasticity is None or FIRST_YIELD * peak * (1.0 + scene.coefficient) <= plasticity.strength().least(
        0.0
    ):
        return 1.0, ELASTIC_DEPTH
    full = FULL / (1.0 + scene.coefficient)
    grown = np.pi / 4.0 * peak / (full * plasticity.strength().least(0.2 * units.strain))
    return max(1.0, float(grown)), PLASTIC_DEPTH * max(1.0, float(grown))


def choose_lines(scene: Scene) -> tuple[tuple[Array, Array], tuple[float, float]]:
    """(x, z) mesh lines in Hertz half-widths, and (low x, high x) of their uniform part: WIDTH to both sides
    of the contact, wherever it goes.
    """
    units, size, box = scales(scene), 1.0 / scene.fem.cells_per_radius, scene.fem.box
    grown, depth = _grown(scene)
    z = uniform_then_growing(size, depth, box, growth=GROWTH, marks=kinks_of(scene, units))
    reach, along = WIDTH * grown, slide(scene, units.length).places[:, 0]
    core = min(float(along.min()), 0.0) - reach, max(float(along.max()), 0.0) + reach
    if is_half(scene):
        return (uniform_then_growing(size, core[1], box, growth=GROWTH), z), core
    return (two_sided(*core, size, box, growth=GROWTH), z), core
