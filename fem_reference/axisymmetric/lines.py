# SPDX-License-Identifier: MIT
"""Lines of the plane mesh of a scene: (r, z), in radii of its Hertz contact. All that takes a scene is part
of the planner.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from fem_reference.common.arrays import Array
from fem_reference.common.coating import coating_of, expected_radius, yielded_radius
from fem_reference.common.hertz import kinks_of, plastic_radius, required, scales
from fem_reference.common.mesh_lines import (
    CLOSEST,
    GROWTH,
    Sizes,
    coated_depths,
    grow,
    marched,
    uniform_then_growing,
)
from sam.scene.schema import Scene


def sphere_lines(cells_per_radius: int, box: float, core: float, depth: float) -> tuple[Array, Array]:
    """(r, z) mesh lines about a misfit sphere of radius 1 with its centre on a line at `depth`: uniform up to
    `core` from the centre, then growing to the surface and to `box` below and beside it.
    """
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
    """The uniform part of a mesh for a smooth contact of radius 1: radius beyond the edge of the contact,
    depth.
    """

    radius: float = 1.3
    depth: float = 0.8


IN_ROUNDING = 4.0
"""Elements in a contact radius over those in its part beyond a flat end: with 8 there the largest pressure
errs by xxx.
"""
ELASTIC = Core()
"""The largest von Mises stress of Hertz is at the depth 0.48."""


def plastic_core(radius: float) -> Core:
    """Uniform part for a plastic contact whose radius is about `radius`; the largest plastic strain is well
    inside.

    With twice the depth, or elements that grow by 1.1, no scalar result changes by more than 1e-4.
    """
    return Core(1.3 * radius, 1.2 * radius)


def smooth_lines(
    cells_per_radius: int, box: float, core: Core = ELASTIC, marks: Sequence[float] | Array = ()
) -> tuple[Array, Array]:
    """(r, z) mesh lines for a smooth contact of radius 1: uniform in `core`, then growing to `box`.

    marks: depths at which the material changes; without lines there a layer would be up to a quarter of an
    element thicker or thinner, as its Gauss points are.
    """
    size = 1.0 / cells_per_radius
    r = uniform_then_growing(size, core.radius, box)
    return r, uniform_then_growing(size, core.depth, box, marks=marks)


def punch_lines(cells_per_radius: int, box: float) -> tuple[Array, Array]:
    """(r, z) mesh lines for a flat-ended cylinder of radius 1.

    Inside r = sin(i pi / (2 n)): in this variable the force of the pressure 1/sqrt(1 - r^2) is smooth up to
    the edge; outside, and in depth, elements grow from the size at the edge.
    """
    inside = np.sin(np.linspace(0.0, np.pi / 2.0, cells_per_radius + 1))
    inside[-1] = 1.0
    edge = inside[-1] - inside[-2]
    return np.concatenate([inside, grow(1.0, box, edge)]), np.concatenate([[0.0], grow(0.0, box, edge)])


def rounded_lines(scene: Scene, core: Core) -> tuple[Array, Array]:
    """(r, z) mesh lines for a punch with a rounded edge: finer in the contact beyond the flat end and as far
    beyond and below that as about a smooth contact of its size; lines at the flat end and in the depths of
    `smooth_lines`.
    """
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


def coated_core(scene: Scene, plastic: float | None) -> Core:
    """The well resolved part of the mesh: that of the larger contact, with and without the coating.

    plastic: estimate of the radius when the body yields, None if it does not.
    """
    flows = required(scene.body.coating).yield_stress is not None
    reach = max(1.0, expected_radius(scene), plastic or 1.0, yielded_radius(scene))
    if flows or plastic is not None:
        return plastic_core(reach)
    return Core(ELASTIC.radius * reach, ELASTIC.depth * reach)


def coated_lines(scene: Scene, core: Core) -> tuple[Array, Array]:
    """(r, z) mesh lines: as for the body alone, sized by the smaller contact near it and by the larger one
    beyond.

    The interface is a line; the coating has two elements or more through its thickness.
    """
    coating = required(coating_of(scene, scales(scene)))
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
    """The uniform part of the mesh: larger when Hertz's stresses are beyond yield, and for a softer
    coating.
    """
    radius = None if is_punch(scene) else plastic_radius(scene)
    if scene.body.coating is not None:
        return coated_core(scene, radius)
    return ELASTIC if radius is None else plastic_core(radius)


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
