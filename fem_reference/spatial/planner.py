# SPDX-License-Identifier: MIT
"""The planner of the three-dimensional model: what it can represent, and the plan of a scene. Loads no
library but numpy.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from fem_reference.common.arrays import Array
from fem_reference.common.bodies import coating_of, expected_radius, yielded_radius
from fem_reference.common.hertz import Scales, contact_modulus, kinks_of, plastic_radius, scales
from fem_reference.common.mesh_lines import (
    Lines,
    Sizes,
    coated_depths,
    two_sided,
    uniform_then_growing,
    widened,
)
from fem_reference.common.plan import Plan, planned, slide, stages_of
from fem_reference.common.refusals import box_problems, coating_problems, problems_of, refuse
from sam.scene.result import LeftOut, Stage
from sam.scene.schema import Scene
from sam.scene.section import Problem, spelling, stated
from sam.scene.surface import CounterSurface, Strip, Surface

MODEL = "fem-3d"
ALLOWS = "the three-dimensional finite-element model allows"
SHAPES = ("sphere", "ellipsoid")
ROUGH_SHAPES = (*SHAPES, "flat")
GROWTH = 1.7
"""Ratio of neighbouring elements outside the uniform part; 1.4 changes scalar results by up to 5e-3."""
WIDTH = 1.4
"""Uniform part of the mesh to both sides of the contact in its radii: the edge stays inside."""
DEPTH = 1.2
"""Uniform part of the mesh in depth, in radii of the contact: the largest plastic strain is well inside."""


@dataclass(frozen=True, kw_only=True)
class SpatialPlan(Plan):
    """What the three-dimensional model solves of a scene; see `fem_reference.common.plan.Plan`.

    lines: planes of the mesh; core: (low x, high x, high y) of its uniform part; curvature: of the gap along
    x and y, zero under a patch, which has a gap of its own; weights: (nx + 1, ny + 1) local coefficient of
    friction over the largest one, at the surface nodes; radius: semi-axis along x of the elastic contact at
    the peak, in m, infinite below a plane; patch: the rough surface, None if the body is smooth.
    """

    lines: Lines
    core: tuple[float, float, float]
    curvature: tuple[float, float]
    weights: Array
    radius: float
    patch: Patch | None = None

    @property
    def coating_layers(self) -> int | None:
        """Layers of elements above the lower face of the coating."""
        return None if self.interface is None else int(np.searchsorted(self.lines.z, self.interface))

    @property
    def axes(self) -> tuple[float, float]:
        """Semi-axes along x and y of the elastic contact of a smooth body at the peak."""
        return semi_axes(self.curvature)


def plan(scene: Scene) -> SpatialPlan:
    """What the three-dimensional model solves of a scene; UnsupportedScene as of `check`."""
    check(scene)
    patch: Patch | None = None
    if scene.patch_surface is None:
        units, curvature = scales(scene), curvatures(scene)
        lines, core = choose_lines(scene)
    else:
        (cells, sides), radii = scene.patch, stated(scene.counterbody).radii  # of a file, or of the scene
        relief = scene.grid is not None and scene.grid.border == "relief"
        patch = Patch(scene.surface, scene.counter_surface, cells, sides, relief, radii, scene.counter_strip)
        units, curvature = rough_scales(scene, patch), (0.0, 0.0)
        lines = rough_lines(patch, units.length, scene.fem.box, marks=kinks_of(scene, units))
        x, y = (line / units.length for line in patch.centres)
        core = float(x[0]), float(x[-1]), float(y[-1])
    elements, nodes = (int(np.prod([n + k for n in lines.shape])) for k in (0, 1))
    words = (
        "half of the body, y >= 0" if lines.half else "the whole body: the scene is not symmetric to y = 0"
    )
    mesh = [Stage("mesh", True, words, {"elements": elements, "unknowns": 3 * nodes})]
    for name in () if patch is None else ("surface", "counter"):
        if (surface := getattr(patch, name)) is not None:
            words = f'[{surface.table}], kind "{surface.kind}", at the nodes of the patch'
            stage = f"{name} heights".replace("counter", "counter-surface")
            mesh.append(Stage(stage, True, words, {"nodes": list(stated(patch).cells)}))
    stresses = Stage("stresses in the elements", True, "at peak load", {"points": 8 * elements})
    stages = stages_of(scene, mesh, stresses)
    below_plane = scene.counterbody is not None and scene.counterbody.radii is None
    if scene.friction is not None and not scene.friction.coupling:
        words = "friction.coupling = false is a choice of the semi-analytical model: a continuum is always"
        stages += (Stage("decoupled traction", False, f"{words} coupled"),)
    return planned(
        SpatialPlan,
        scene,
        units,
        model=MODEL,
        lines=lines,
        core=core,
        curvature=curvature,
        weights=friction_weights(scene, lines, units),
        radius=np.inf if below_plane else semi_axes(curvatures(scene))[0] * scales(scene).length,
        patch=patch,
        elements=elements,
        unknowns=3 * nodes,
        points=8 * elements,
        stages=stages,
    )


def left_out(scene: Scene) -> list[LeftOut]:
    """Stages that a scene does not need, with the reason, as a result of `solve` has them."""
    return plan(scene).left_out


def check(scene: Scene) -> None:
    """Raise UnsupportedScene with every reason at once, key, value and what is allowed, for a scene that the
    three-dimensional model cannot represent.
    """
    counter, rough = scene.counterbody, scene.patch_surface is not None
    problems = problems_of(scene, ROUGH_SHAPES if rough else SHAPES, "three-dimensional")
    if scene.loading.misfit_sphere:
        words = f'{ALLOWS} "hertz", or a counter-body; the axisymmetric one solves it'
        problems.append(Problem("loading.prescribed", spelling(scene.loading.prescribed), words))
    if counter is not None and counter.elastic:
        words = f"{ALLOWS} only a rigid counter-body: remove young and poisson"
        problems.append(Problem("counterbody.young", spelling(counter.young, "Pa"), words))
    refuse(problems + _combinations(scene))
    refuse(coating_problems(scene))  # these need the contact radius of a shape that is allowed
    if not rough:  # half of a rough patch is less than the smallest box
        reach = DEPTH * _grown(scene) + 1.0 / scene.fem.cells_per_radius
        refuse(box_problems(scene, reach, "contact"))


def _combinations(scene: Scene) -> list[Problem]:
    """What cannot be put together: rough and coated, a renewed surface, a pressure and a map."""
    problems, coating = [], scene.body.coating
    first, opposite = scene.patch_surface, scene.counter_surface
    if first is not None and coating is not None:
        words = f"{ALLOWS} no film in a rough contact: remove it, or [{first.table}]"
        problems.append(Problem("body.coating.thickness", spelling(coating.thickness, "m"), words))
    if opposite is not None and opposite.renewed and scene.loading.cycles > 1:
        words = f"{ALLOWS} the same counter-surface in every cycle: false"
        problems.append(Problem("counterbody.surface.renew", "true", words))
    friction = scene.friction
    if scene.loading.prescribed is not None and friction is not None and not scene.constant_friction:
        words = f'{ALLOWS} "constant" where the pressure is given'
        problems.append(Problem("friction.law", spelling(friction.law), words))
    return problems


def curvatures(scene: Scene) -> tuple[float, float]:
    """Curvatures of the gap along x and y over their geometric mean."""
    if scene.counterbody is None:
        return 1.0, 1.0
    rx, ry = stated(scene.counterbody.radii)
    return float(np.sqrt(ry / rx)), float(np.sqrt(rx / ry))


def semi_axes(curvature: tuple[float, float]) -> tuple[float, float]:
    """Semi-axes along x and y over a sphere's contact radius: (ratio of curvatures)^(1/3)."""
    along_x, along_y = curvature
    return (along_y / along_x) ** (1.0 / 3.0), (along_x / along_y) ** (1.0 / 3.0)


def friction_weights(scene: Scene, lines: Lines, units: Scales) -> Array:
    """(nx + 1, ny + 1) coefficient of friction at the nodes over the largest one."""
    if scene.constant_friction or scene.coefficient == 0.0:
        return np.ones((lines.x.size, lines.y.size))
    grid_map, cells = stated(stated(scene.friction).path), []
    for line, side, n in zip((lines.x, lines.y), grid_map.extent, grid_map.cells, strict=True):
        cells.append(np.clip(np.floor((line * units.length / side + 0.5) * n), 0, n - 1).astype(int))
    return stated(grid_map.values)[np.ix_(*cells)] / scene.coefficient


def _grown(scene: Scene) -> float:
    """Estimate of the largest contact radius over that of Hertz."""
    return max(plastic_radius(scene) or 1.0, expected_radius(scene), yielded_radius(scene))


def choose_lines(scene: Scene) -> tuple[Lines, tuple[float, float, float]]:
    """Mesh planes, and (low x, high x, high y) of their uniform part. A half where path and friction are
    symmetric to y = 0.

    Uniform are WIDTH to both sides of the contact, wherever it goes, and DEPTH below it, larger where it
    outgrows Hertz's.
    """
    (a, b), sliding, box = semi_axes(curvatures(scene)), slide(scene, scales(scene).length), scene.fem.box
    grown, expected, cells = _grown(scene), expected_radius(scene), float(scene.fem.cells_per_radius)
    cells = cells if expected >= 1.0 else cells / expected
    (low_x, low_y), (high_x, high_y) = sliding.places.min(axis=0), sliding.places.max(axis=0)
    reach = WIDTH * grown
    half = scene.constant_friction and not sliding.places[:, 1].any()
    core = min(low_x, 0.0) - reach * a, max(high_x, 0.0) + reach * a, max(high_y, 0.0) + reach * b
    x = two_sided(core[0], core[1], a / cells, box, growth=GROWTH)
    y = two_sided(min(low_y, 0.0) - reach * b, core[2], b / cells, box, growth=GROWTH)
    size, depth, coating = min(a, b) / cells, DEPTH * grown * min(a, b), coating_of(scene, scales(scene))
    if coating is None:
        z = uniform_then_growing(size, depth, box, growth=GROWTH, marks=kinks_of(scene, scales(scene)))
    else:
        z = coated_depths(coating.thickness, box, Sizes(size, size, (depth, depth)), growth=GROWTH)
    return Lines(x, y[y >= 0.0] if half else y, z, half), core


UNIFORM_DEPTH = 0.2
"""Depth of the cubes over the shorter side of a patch; spots of a few asperities take a tenth."""
DEPTH_GROWTH = 1.6
"""Ratio of neighbouring elements below the cubes; 1.2 changes pressures and loads of spots by 3e-4."""
SIDE_GROWTH = 2.2
"""Ratio of neighbouring elements beside the patch; 1.4 changes pressures and loads of spots by 3e-4."""
UNLOADED = 0.01
"""Unit of displacement over that of length when there is no force: arbitrary, as nothing is deformed."""


@dataclass(frozen=True)
class Patch:
    """A rough body in SI units and the counter-body above it; None of a surface that is smooth.

    The surface nodes of the patch are the centres of the scene's cells, so that a node stands for a cell: its
    height, its local coefficient of friction. Beyond the patch the surface is free. The whole body is
    modelled, its unit of length is half of the longer side.

    cells: (nx, ny); sides: (Lx, Ly); relief: the border of the patch is that of a relief in a plane; radii:
    of the counter-body along x and y, None if it is flat; strip: of a rough counter-body that moves.
    """

    surface: Surface | None
    counter: CounterSurface | None
    cells: tuple[int, int]
    sides: tuple[float, float]
    relief: bool
    radii: tuple[float, float] | None
    strip: Strip | None = None

    @property
    def centres(self) -> tuple[Array, Array]:
        """x (nx,) and y (ny,) of the cells."""
        x, y = (
            ((np.arange(n) + 0.5) / n - 0.5) * side for n, side in zip(self.cells, self.sides, strict=True)
        )
        return x, y


def rough_scales(scene: Scene, patch: Patch) -> Scales:
    """Units of a rough contact: half the longer side; the approach, or what makes the force 4/3."""
    modulus, length = contact_modulus(scene), 0.5 * max(patch.sides)
    if scene.loading.approach is not None:
        return Scales(length, scene.loading.approach, modulus, 4.0 / 3.0)
    force = stated(scene.loading.force)
    displacement = 0.75 * force / (modulus * length) if force > 0.0 else UNLOADED * length
    return Scales(length, displacement, modulus, 4.0 / 3.0 if force > 0.0 else 0.0)


def rough_lines(patch: Patch, unit: float, box: float, *, marks: Sequence[float] | Array = ()) -> Lines:
    """Mesh planes through the centres of the cells, growing from there to the box, of so many half sides.

    unit: of length, in m; marks: depths in this unit that are planes too, see `uniform_then_growing`.
    Elements next to the surface are as high as the shorter side of a cell, or lower above a mark.
    """
    cores = (line / unit for line in patch.centres)
    x, y = (widened(core, core[1] - core[0], box, SIDE_GROWTH) for core in cores)
    size = min(side / n for side, n in zip(patch.sides, patch.cells, strict=True)) / unit
    depth = UNIFORM_DEPTH * (min(patch.cells) - 1) * size
    return Lines(x, y, uniform_then_growing(size, depth, box, growth=DEPTH_GROWTH, marks=marks), half=False)
