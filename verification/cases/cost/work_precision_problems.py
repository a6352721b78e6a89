# SPDX-License-Identifier: MIT
"""The problems of case work-precision: scenes, methods with their ladders of resolutions, measures."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from sam.scene import Friction, Grid, Scene
from verification.cases.case import FEM, FEM_3D, SAM, with_body, with_grid, with_keys, with_loading, with_mesh
from verification.cases.recipes import BOX, Resolution, at_ratio, coated_scene, resolved_at, resolved_grid
from verification.cost.advice import (
    COATED,
    DEEP,
    ELASTIC,
    ROUGH,
    ROUGH_YIELDING,
    RUNNING_IN,
    SLIDING,
    YIELDING,
)
from verification.references import coated_contact, contact_of, elliptic_contact
from verification.scenes.asperities import height_map

COUPLED, DECOUPLED, PAPER, TWICE = "SAM", "SAM, decoupled", "SAM, the paper's loop", "SAM, two grids"
AXISYMMETRIC, SPATIAL = "FEM, axisymmetric", "FEM, 3D"

SPATIAL_MESHES = (4, 5, 6, 7, 8)
SLIDING_OTHER = (3, 4, 6, 8, 10)
TWICE_CELLS = (6, 7, 8, 10, 14)
LOAD_STEPS = (1, 2, 5, 10, 20, 40)

STEPS, ROUGH_STEPS, WORN_STEPS = 5, 2, 4
"""Load steps of the ladders of resolutions, the same in every method and in the reference."""
AT_STEPS = 6
"""Cells in the contact radius where the load steps are refined."""
ROOM = 1.1
"""Half a side of the grid of an elastic contact, over its radius."""
FILM = (80 / 210, 0.2, "rigid")
"""E1/E2, thickness over the contact radius without film, counter-body."""
LAYER, DEEPEST = 0.5, 3.6e-6
"""Thickness of the layers below the asperities over a cell, and depth of the lowest in m."""
PATCH = 32e-6
"""Side in m of the patch that runs in."""


@dataclass(frozen=True)
class Method:
    """A model as it is asked, and its ladder, coarse to fine. at: the scene of the problem at a resolution.
    strict: an answer that did not converge counts as none. The loop of the paper need not converge in our
    sense.
    """

    name: str
    model: str
    ladder: Sequence[int]
    at: Callable[[Scene, int], Scene]
    strict: bool = True


@dataclass(frozen=True)
class Problem:
    """One contact. scene: from that of `file`; kind: of the advice it gives, empty for none; measures:
    quantities of the result, the error being the largest of theirs. advised: what the advice calls a
    resolution of 1, its name and size, from the scene and the reference values. exact: closed form, quantity
    -> value; else the reference is extrapolated from the `tops` finest points of each of `references`, names
    of methods. steps: SAM with its load steps refined.
    """

    name: str
    title: str
    kind: str
    file: str
    scene: Callable[[Scene], Scene]
    measures: tuple[str, ...]
    methods: tuple[Method, ...]
    advised: Callable[[Scene, Mapping[str, float]], tuple[str, float]] = lambda *_: (IN_RADIUS, 1.0)
    exact: Callable[[Scene], Mapping[str, float]] | None = None
    references: tuple[str, ...] = ()
    tops: int = 4
    steps: Method | None = None


MEASURES = {
    "p_max_Pa": "largest pressure",
    "contact_area_m2": "contact area",
    "peeq_max": "largest plastic strain",
    "wear_volume_m3": "worn volume",
}


def loaded(scene: Scene, steps: int = 1) -> Scene:
    """To the peak in so many steps, and not back."""
    return with_loading(scene, steps=steps, unload=False)


def uncoupled(scene: Scene) -> Scene:
    """The traction moves no surface normally."""
    return with_keys(scene, "friction", coupling=False)


def by_paper(scene: Scene) -> Scene:
    """As Bosman & Schipper (2011) solve it: their loop, decoupled."""
    scene = uncoupled(scene) if scene.friction else scene
    return with_keys(scene, "solver", method="paper", stop="stress")


def elastic_cells(scene: Scene, n: int) -> Scene:
    """a/n cells on the contact of Hertz, a cell centre on the apex."""
    a, count = contact_of(scene).contact_radius, 2 * math.ceil(ROOM * n) + 1
    return with_grid(scene, cells=(count, count), extent=(count * a / n, count * a / n))


def elliptic_cells(scene: Scene, n: int) -> Scene:
    """Square cells, n of them in the smaller semi-axis of Hertz, a cell centre on the apex."""
    along_x, along_y = elliptic_contact(scene).semi_axes
    cell = min(along_x, along_y) / n
    counts = tuple(2 * math.ceil(ROOM * side / cell) + 1 for side in (along_x, along_y))
    return with_grid(scene, cells=counts, extent=tuple(count * cell for count in counts))


def plastic_cells(scene: Scene, n: int) -> Scene:
    """Cells of a/n on a contact beyond yield."""
    return resolved_at(scene, Resolution(n, scene.fem.cells_per_radius))


def on_two_grids(scene: Scene, n: int) -> Scene:
    """Extrapolated from a/n and twice that (solver.extrapolate), with an even number of layers."""
    scene = plastic_cells(scene, n)
    odd = (len(scene.grid.depths) - 1) % 2
    scene = with_grid(scene, depths=scene.grid.depths[: len(scene.grid.depths) - odd])
    return with_keys(scene, "solver", extrapolate=True)


def coated_cells(scene: Scene, n: int) -> Scene:
    """Cells of a/n on a coated contact."""
    return resolved_grid(scene, coated_contact(scene), n)


def smaller_box(scene: Scene, n: int) -> Scene:
    """The mesh of the three-dimensional model, its box as in the cases of friction."""
    return with_keys(with_mesh(scene, n), "fem", box=BOX)


def asperities(scene: Scene, n: int) -> Scene:
    """The three asperities on n x n cells."""
    surface = scene.surface.model_copy(update={"path": height_map(n)})
    layers = round(DEEPEST / (LAYER * surface.path.extent[0] / n))
    grid = Grid(layers=layers, depth=DEEPEST) if scene.body.plasticity else None
    return scene.model_copy(update={"surface": surface, "grid": grid})


def worn_cells(scene: Scene, n: int) -> Scene:
    """The patch on n x n cells; its layers, those of the file at cells of 1 um, are divided with them."""
    faces = np.asarray(scene.grid.depths)
    at = np.linspace(0.0, faces.size - 1.0, max(round((faces.size - 1) * n * 1e-6 / PATCH), 2) + 1)
    depths = np.interp(at, np.arange(faces.size), faces)
    return with_grid(scene, cells=(n, n), depths=tuple(float(z) for z in depths))


def changed(at: Callable[[Scene, int], Scene], change: Callable[[Scene], Scene]):
    """(scene, n) -> the changed scene at a resolution."""
    return lambda scene, n: change(at(scene, n))


def _sliding(base: Scene) -> Scene:
    return loaded(at_ratio(base, 4.0), STEPS).model_copy(update={"friction": Friction(coefficient=0.2)})


def _worn(base: Scene) -> Scene:
    """One cycle on a part of the patch, at the nominal pressure of the whole."""
    share = (PATCH / base.grid.extent[0]) ** 2
    keys = {"cycles": 1, "steps": WORN_STEPS, "unload_steps": WORN_STEPS}
    return with_loading(with_grid(base, extent=(PATCH, PATCH)), force=share * base.loading.force, **keys)


OVER_STEPS = Method(
    COUPLED, SAM, LOAD_STEPS, lambda scene, steps: with_loading(plastic_cells(scene, AT_STEPS), steps=steps)
)
"""Load steps refined at one resolution."""


def _sphere(name: str, ratio: float, kind: str, spatial: Sequence[int] = ()) -> Problem:
    methods = [
        Method(COUPLED, SAM, (3, 4, 5, 6, 7, 8, 10, 14, 20), plastic_cells),
        Method(TWICE, SAM, TWICE_CELLS, on_two_grids),
        Method(PAPER, SAM, (3, 4, 6, 8, 10), changed(plastic_cells, by_paper), strict=False),
        Method(AXISYMMETRIC, FEM, (4, 6, 8, 12, 16, 24, 32), with_mesh),
    ]
    if spatial:
        methods.append(Method(SPATIAL, FEM_3D, spatial, smaller_box))
    return Problem(
        name,
        f"Rigid sphere on Swift steel, p₀/σ_y0 = {ratio:g}, {STEPS} load steps",
        kind,
        "plastic-swift-rigid",
        lambda base: loaded(at_ratio(base, ratio), STEPS),
        ("peeq_max",),
        tuple(methods),
        references=(COUPLED, AXISYMMETRIC),
        steps=OVER_STEPS,
    )


IN_RADIUS, IN_WAVE = "cells in the contact radius", "cells in the shortest wave"
IN_SPOT = "cells in the mean radius of a spot"
SPOTS = 3


def _in_spot(scene: Scene, values: Mapping[str, float]) -> tuple[str, float]:
    """Of the asperities, each of which is a spot: resolutions are cells a side."""
    return IN_SPOT, math.sqrt(values["contact_area_m2"] / (SPOTS * math.pi)) / scene.surface.path.extent[0]


def _in_wave(scene: Scene, values: Mapping[str, float]) -> tuple[str, float]:
    """Of a generated surface; resolutions are cells a side."""
    return IN_WAVE, scene.surface.cutoff_short / scene.grid.extent[0]


PROBLEMS = (
    Problem(
        "hertz",
        "Elastic rigid sphere",
        ELASTIC,
        "hertz-sphere",
        loaded,
        ("p_max_Pa",),
        (
            Method(COUPLED, SAM, (3, 4, 5, 6, 8, 12, 16, 32), elastic_cells),
            Method(AXISYMMETRIC, FEM, (4, 6, 8, 12, 16, 32), with_mesh),
            Method(SPATIAL, FEM_3D, (4, 5, 6, 7, 8), smaller_box),
        ),
        exact=lambda scene: {"p_max_Pa": contact_of(scene).peak_pressure},
    ),
    _sphere("ratio-3", 3.0, YIELDING, SPATIAL_MESHES),
    _sphere("ratio-6-2", 6.2, DEEP),
    Problem(
        "friction-0-2",
        f"Rigid sphere on Swift steel in full slip, μ = 0.2, p₀/σ_y0 = 4, {STEPS} load steps",
        SLIDING,
        "plastic-swift-rigid",
        _sliding,
        ("peeq_max",),
        (
            Method(COUPLED, SAM, (3, 4, 5, 6, 8, 10, 14), plastic_cells),
            Method(TWICE, SAM, TWICE_CELLS, on_two_grids),
            Method(DECOUPLED, SAM, SLIDING_OTHER, changed(plastic_cells, uncoupled)),
            Method(PAPER, SAM, SLIDING_OTHER, changed(plastic_cells, by_paper), strict=False),
            Method(SPATIAL, FEM_3D, SPATIAL_MESHES, smaller_box),
        ),
        references=(COUPLED, SPATIAL),
        steps=OVER_STEPS,
    ),
    Problem(
        "coated",
        "Rigid sphere on a coated elastic body, E₁/E₂ = 0.38, h = 0.2 a₀",
        COATED,
        "coated-sphere",
        lambda base: coated_scene(base, *FILM),
        ("p_max_Pa",),
        (
            Method(COUPLED, SAM, (3, 4, 6, 8, 12, 16, 24), coated_cells),
            Method(AXISYMMETRIC, FEM, (4, 6, 8, 12, 16, 32), with_mesh),
            Method(SPATIAL, FEM_3D, (4, 5, 6), smaller_box),
        ),
        exact=lambda scene: {"p_max_Pa": coated_contact(scene).largest_pressure()[0]},
    ),
    Problem(
        "rough-elastic",
        "Three elastic asperities under a rigid plane",
        ROUGH,
        "rough-asperities",
        lambda base: loaded(with_body(base, plasticity=None)),
        ("p_max_Pa", "contact_area_m2"),
        (
            Method(COUPLED, SAM, (16, 20, 24, 32, 48, 64, 96, 192, 384), asperities),
            Method(SPATIAL, FEM_3D, (16, 24, 32), asperities),
        ),
        advised=_in_spot,
        references=(COUPLED,),
    ),
    Problem(
        "rough-plastic",
        f"Three asperities of Swift steel under a rigid plane, {ROUGH_STEPS} load steps",
        ROUGH_YIELDING,
        "rough-asperities",
        lambda base: loaded(base, ROUGH_STEPS),
        ("p_max_Pa", "contact_area_m2"),
        (
            Method(COUPLED, SAM, (16, 20, 24, 32, 48, 64), asperities),
            Method(SPATIAL, FEM_3D, (16, 24, 32), asperities),
        ),
        advised=_in_spot,
        references=(COUPLED,),
    ),
    Problem(
        "running-in",
        f"One cycle of running-in on {PATCH * 1e6:g} × {PATCH * 1e6:g} µm, {WORN_STEPS} steps each way",
        RUNNING_IN,
        "running-in-curve-b",
        _worn,
        ("wear_volume_m3",),
        (Method(COUPLED, SAM, (24, 32, 40, 48, 64), worn_cells),),
        advised=_in_wave,
        references=(COUPLED,),
    ),
)

ELLIPSOID = Problem(
    "ellipsoid",
    "Elastic rigid ellipsoid, radii 3 to 1",
    "",
    "hertz-ellipse",
    loaded,
    ("p_max_Pa",),
    (
        Method(COUPLED, SAM, (3, 4, 5, 6, 8, 12, 16), elliptic_cells),
        Method(SPATIAL, FEM_3D, (4, 5, 6, 7, 8), with_mesh),
    ),
    exact=lambda scene: {"p_max_Pa": elliptic_contact(scene).peak_pressure},
)
"""Beside the others, without advice: a smooth contact that no axisymmetric model can represent."""
