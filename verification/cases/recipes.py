# SPDX-License-Identifier: MIT
"""What a case may change of its scene beside single keys, `vary = {NAME = value}`."""

import math
from collections.abc import Callable, Mapping, Sequence
from importlib import import_module
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np

from sam.scene import (
    Coating,
    CounterBody,
    CounterSurface,
    Friction,
    Grid,
    Loading,
    Path,
    Plasticity,
    Problem,
    Scene,
    SceneError,
    in_unit,
    spelling,
    unit_of_key,
)
from verification.cases.case import with_body, with_grid, with_keys, with_loading, with_mesh
from verification.quantities import modulus_of
from verification.reference.coated_sphere import CoatedContact
from verification.reference.hertz import CircularContact, effective_modulus
from verification.reference.hertz_line import LineContact
from verification.references import coated_contact, contact_of, growing_sphere, rounded_contact
from verification.rows import CaseFile
from verification.scenes import asperities

REACH = 2.2  # half of the extent: the plastic zone reaches 1.6 a in the surface at 6.2 times the yield stress
EVEN, DEEPEST = 1.0, 2.2  # layers are even to 1 a; at "even depth" 2.2 they have reached 3.3 a
LINE_REACH, LINE_DEEPEST = 4.0, 3.3  # below a cylinder stress falls as 1/r: 7.3 a down
GROWTH = 0.75
FILM_SIDE = 1 - 1e-6  # thicknesses: the side of the interface on which the stresses are those of the film
ROOM = 1.06  # half a side of the grid over the larger of the contact radii with and without film


class Resolution(NamedTuple):
    """Cells (SAM) and elements (FEM) in the elastic contact radius."""

    sam: int
    fem: int


def initial_yield(scene: Scene) -> float:
    """Yield stress of the virgin body in Pa."""
    return float(scene.body.plasticity.curve().stress(0.0))


def at_ratio(scene: Scene, ratio: float) -> Scene:
    """The force that gives the elastic contact the peak pressure ratio * initial yield stress."""
    elastic, p0 = contact_of(scene), ratio * initial_yield(scene)
    if isinstance(elastic, LineContact):
        return with_loading(scene, force=elastic.at_pressure(p0).force)
    force = CircularContact.from_peak_pressure(p0, elastic.radius, elastic.modulus).force
    return with_loading(scene, force=force)


def resolved_at(scene: Scene, resolution: Resolution) -> Scene:
    """The scene with cells of a/sam and elements of a/fem, a the radius of the elastic contact under its
    force; 2.2 radii each way, a cell centre on the apex; below a cylinder a row of them over 4 half-widths.
    """
    cells, elements = resolution
    a, length = contact_of(scene).contact_radius, scene.counterbody.length
    n = 2 * round((LINE_REACH if length else REACH) * cells) + 1
    extent = n * a / cells
    depths = tuple(float(z) for z in a * layer_faces(cells, LINE_DEEPEST if length else DEEPEST))
    across = (1, length) if length else (n, extent)
    grid = {"cells": (n, across[0]), "extent": (extent, across[1]), "depths": depths}
    return with_mesh(with_grid(scene, **grid), elements)


def layer_faces(cells: int, deepest: float = DEEPEST) -> np.ndarray:
    """Depths of the faces of layers in a: even to 1, then ever thicker, halved where `cells` doubles."""
    even = np.arange(round(deepest * cells) + 1) / cells
    return even + GROWTH * np.maximum(even - EVEN, 0.0) ** 2


def even_cells(scene: Scene, reach: Sequence[float]) -> Scene:
    """Cubes of a/size for a given pressure. reach in a: size, along x beyond its path, along y, and down."""
    size, along, across, below = reach
    a, path = scene.loading.radius, scene.loading.path
    h, half = a / size, path.end[0] / a if path else 0.0
    cells = tuple(2 * round(each * size) + 1 for each in (half + along, across))
    depths = tuple(h * np.arange(round(below * size) + 1))
    return with_grid(scene, cells=cells, extent=tuple(n * h for n in cells), depths=depths)


def sphere_cells(scene: Scene, size: int) -> Scene:
    """Cubes of radius/size about the plastic zone of a misfit sphere, one of them at the centre; above, where
    nothing yields, a layer more. The tolerance is a tenth of the errors that are judged, in single precision.
    """
    cell, depth = scene.loading.radius / size, scene.loading.depth
    half = math.ceil(growing_sphere(scene).zone()[1] / cell) + 2
    faces = depth + cell * (np.arange(-half, half + 1) + 0.5)
    faces = np.append(faces[0] - cell, faces)
    cells = 2 * half + 3
    depths = (0.0, *(float(z) for z in faces if z > cell / 2))
    scene = with_grid(scene, cells=(cells, cells), extent=(cells * cell,) * 2, depths=depths)
    return with_keys(scene, "solver", tolerance=1e-4)


def with_layer(scene: Scene, law: Mapping[str, str | float]) -> Scene:
    """The scene with another law of its layer."""
    content = scene.body.plasticity.model_dump() | {"layer": dict(law)}
    return with_body(scene, plasticity=Plasticity(**content))


def depths_over_radius(scene: Scene, depths: Sequence[float]) -> Scene:
    """Output depths, given over the radius of the elastic contact."""
    a = contact_of(scene).contact_radius
    return with_grid(scene, depths=tuple(a * z for z in depths))


def grid_over_rounded_punch(scene: Scene, grid: tuple[int, float]) -> Scene:
    """n by n cells over so many radii of the contact of a punch with a rounded edge; the depths of SAM."""
    cells, sides = grid
    side = sides * rounded_contact(scene).contact_radius
    return scene.model_copy(update={"grid": Grid(cells=(cells, cells), extent=(side, side))})


COUNTERBODIES = {"rigid": {}, "steel": {"young": 210e9, "poisson": 0.3}}


def coated_scene(base: Scene, ratio: float, thickness: float, counterbody: str) -> Scene:
    """The sphere of `base` on another film. ratio: E1/E2; thickness: over the contact radius without film."""
    other = CounterBody(shape="sphere", radius=base.counterbody.radius, **COUNTERBODIES[counterbody])
    bare = base.model_copy(update={"counterbody": other})
    coating = Coating(
        young=ratio * base.body.young,
        poisson=base.body.coating.poisson,
        thickness=thickness * contact_of(bare).contact_radius,
    )
    return with_body(bare, coating=coating)


def resolved_grid(scene: Scene, contact: CoatedContact, cells: int = 48) -> Scene:
    """The scene on square cells, so many in the contact radius; a contact without film has room as well."""
    cell = contact.contact_radius / cells
    count = 2 * math.ceil(ROOM * max(contact.contact_radius, contact.bare.contact_radius) / cell) + 1
    return with_grid(scene, cells=(count, count), extent=(count * cell, count * cell))


def cells_in_coated_contact(scene: Scene, cells: int) -> Scene:
    """So many cells in the contact radius, and a few depths: nothing is looked at there."""
    contact, h = coated_contact(scene), scene.body.coating.thickness
    return with_grid(resolved_grid(scene, contact, cells), depths=(0.0, h, h + 0.5 * contact.contact_radius))


BOX = 6.0  # elastic contact radii: the far field of the point forces is prescribed there


def sliding_scene(base: Scene, ratio: float, friction: float, resolution: Resolution) -> Scene:
    """Loading to p0 = ratio times the initial yield stress with friction, on these grids."""
    scene = resolved_at(with_loading(at_ratio(base, ratio), unload=False), resolution)
    return rubbed(with_keys(scene, "fem", box=BOX), friction)


def rubbed(scene: Scene, friction: Mapping[str, Any] | float | str) -> Scene:
    """The scene with friction: its keys, its coefficient, 0 for none, or "map": high on the middle one."""
    law = None
    if friction == "map":
        law = Friction(law="map", path=asperities.friction_map(asperities.CELLS))
    elif friction:
        law = Friction(**friction) if isinstance(friction, Mapping) else Friction(coefficient=friction)
    return scene.model_copy(update={"friction": law})


def given_tractions(scene: Scene, friction: float) -> Scene:
    """The scene with the Hertz pressure of its elastic contact in place of the counter-body, and traction."""
    elastic, steps = contact_of(scene), scene.loading.steps
    size = {"p0": elastic.peak_pressure, "radius": elastic.contact_radius}
    loading = Loading(prescribed="hertz", **size, steps=steps)
    changed = {"counterbody": None, "loading": loading, "friction": Friction(coefficient=friction)}
    return scene.model_copy(update=changed)


def even_depths(scene: Scene, deepest: float) -> Scene:
    """81 output depths from 0 to `deepest` radii of a given pressure."""
    depths = scene.loading.radius * np.linspace(0, deepest, 81)
    return with_grid(scene, depths=tuple(map(float, depths)))


WAY, PASS_STEPS, PASS_CELLS = 2.0, 20, 6  # half of the way in radii, its steps, cells in the radius
BESIDE = (2.0, 1.8, 2.0)  # grid beyond the way of the centre along x, to its sides and in depth, in radii


def travelling(scene: Scene, keys: Mapping[str, float]) -> Scene:
    """A Hertz pressure of radius 10 um along x in so many passes; over_shear: p0 over the shear yield."""
    radius, (ahead, beside, below) = 1e-5, BESIDE
    h = radius / PASS_CELLS
    nx, ny = (2 * round(half * PASS_CELLS) + 1 for half in (WAY + ahead, beside))
    path = Path(start=(-WAY * radius, 0.0), end=(WAY * radius, 0.0), steps=PASS_STEPS)
    size = {"p0": keys["over_shear"] * initial_yield(scene) / np.sqrt(3.0), "radius": radius}
    loading = Loading(prescribed="hertz", **size, path=path, steps=2, unload=True, cycles=int(keys["passes"]))
    depths = tuple(h * np.arange(round(below * PASS_CELLS) + 1))
    grid = Grid(cells=(nx, ny), extent=(nx * h, ny * h), depths=depths)
    return scene.model_copy(update={"counterbody": None, "loading": loading, "grid": grid})


BESIDE_TRACK, BEHIND, DEEP = 1.8, 2.2, 3.0  # radii of the grid beside a track, at its ends, and below
EVEN_TO, LAYER_GROWTH = 1.2, 1.2  # radii down to which layers are as thick as a cell; ratio of deeper ones
TRACK = 6.0  # radii of a track: three to be steady, one and a half before its end
TRACK_RATIO = 4.0  # p0 over the initial yield stress


def radius_at(scene: Scene, ratio: float = TRACK_RATIO) -> float:
    """Hertz radius in m of a rigid sphere, half-width below a cylinder, at p0 = ratio yield stresses."""
    modulus = scene.body.young / (1 - scene.body.poisson**2)
    if scene.counterbody.length:
        return contact_of(at_ratio(scene, ratio)).contact_radius
    return float(np.pi * ratio * initial_yield(scene) * scene.counterbody.radius / (2 * modulus))


def on_track(scene: Scene, keys: Mapping[str, Any]) -> Scene:
    """The scene with a track along x on a grid of its own. cells, per_radius: cells and steps in a radius;
    length in radii; ratio: p0 over the yield stress; shift: of the track in cells; back: from its other end;
    cycles: passes; to_and_fro, or one way.
    """
    cells, length, shift = keys["cells"], keys.get("length", TRACK), keys.get("shift", 0.0)
    ratio = keys.get("ratio", TRACK_RATIO)
    a = radius_at(scene, ratio)
    h, faces = a / cells, [0.0]
    while faces[-1] < DEEP * a:
        even = len(faces) <= round(EVEN_TO * cells)
        faces.append(faces[-1] + (h if even else (faces[-1] - faces[-2]) * LAYER_GROWTH))
    half = length / 2 + BEHIND + abs(shift) / cells
    across = scene.counterbody.length
    count = 2 * int(np.ceil(half * cells)) + 1, 1 if across else 2 * round(BESIDE_TRACK * cells) + 1
    ends = [(x * a + shift * h, 0.0) for x in (-length / 2, length / 2)]
    start, end = ends[::-1] if keys.get("back") else ends
    comes_back = {"return": "to-and-fro" if keys.get("to_and_fro") else "lifted"}
    path = Path(start=start, end=end, steps=round(length * keys.get("per_radius", 4.0)), **comes_back)
    force = float(2 / 3 * np.pi * ratio * initial_yield(scene) * a**2)
    force = at_ratio(scene, ratio).loading.force if across else force
    scene = with_loading(scene, force=force, path=path, cycles=keys.get("cycles", 1))
    return with_grid(scene, cells=count, extent=(count[0] * h, across or count[1] * h), depths=tuple(faces))


KINEMATIC = {"law": "perfect", "yield_stress": 1e9, "kinematic": {"modulus": (20e9,), "recovery": (0.0,)}}
"""Steel of Prager's law."""


def film_sliding(scene: Scene, share: float) -> Scene:
    """A film of `share` of the bare radius in sliding: 16 cells, 10 elements, depths at the interface."""
    a = contact_of(scene).contact_radius
    h, n = share * a, 2 * round(1.6 * 16) + 1
    even = 0.04 * a * np.arange(round(1.6 / 0.04) + 1)
    depths = np.union1d(even[np.abs(even - h) > 1e-3 * a], [FILM_SIDE * h, h])
    scene = with_grid(scene, cells=(n, n), extent=(n * a / 16,) * 2, depths=tuple(map(float, depths)))
    return with_keys(with_keys(scene, "body.coating", thickness=h), "fem", box=6.0, cells_per_radius=10)


def film_dragged(scene: Scene, share: float) -> Scene:
    """The Hertz pressure without film on a film of `share` of its radius: 24 cells and 6 elements in that."""
    hertz = contact_of(scene)
    a, n = hertz.contact_radius, 2 * round(1.6 * 24) + 1
    depths = (0.0, 0.25, 0.5, 0.75, FILM_SIDE, 1.0, 1.5, 2.0, 3.0, 4.0, 6.0, 8.0)
    scene = with_keys(scene, "body.coating", thickness=share * a)
    load = Loading(prescribed="hertz", p0=hertz.peak_pressure, radius=a, steps=1)
    scene = scene.model_copy(update={"counterbody": None, "loading": load})
    depths = tuple(z * (share * a) for z in depths)
    scene = with_grid(scene, cells=(n, n), extent=(n * a / 24,) * 2, depths=depths)
    return with_keys(scene, "fem", box=6.0, cells_per_radius=6)


def film_under(scene: Scene, film: tuple[str, float, float, float]) -> Scene:
    """A film under 6.5 GPa: counter-body, contact radius without film in m, thickness in m, E1/E2."""
    (counterbody, radius, thickness, ratio), p0 = film, 6.5e9
    body, other = scene.body, CounterBody(shape="sphere", radius=1.0, **COUNTERBODIES[counterbody])
    modulus = effective_modulus(body.young, body.poisson, other.young, other.poisson)
    curvature = 2.0 * modulus * radius / (math.pi * p0)  # p0 = 2 E* a/(pi R)
    force = CircularContact.from_peak_pressure(p0, curvature, modulus).force
    coating = Coating(young=ratio * body.young, poisson=0.3, thickness=thickness)
    other = other.model_copy(update={"radius": curvature})
    scene = scene.model_copy(update={"counterbody": other, "loading": Loading(force=force)})
    return with_body(scene, coating=coating)


def on_counterbody(scene: Scene, _: bool) -> Scene:
    """The heights of the body on the counter-body, and the body smooth."""
    heights = CounterSurface(kind="file", path=scene.surface.path)
    return with_keys(scene, "counterbody", surface=heights).model_copy(update={"surface": None})


def cells_of_asperities(scene: Scene, cells: int) -> Scene:
    """The asperities, and a map of friction, on cells x cells; even layers, a face where the law changes."""
    section = "surface" if scene.surface else "counterbody.surface"
    scene = with_keys(scene, section, path=asperities.height_map(cells))
    if scene.friction and scene.friction.law == "map":
        scene = with_keys(scene, "friction", path=asperities.friction_map(cells))
    thickness, deep = 0.5 * asperities.SIDE / cells, 3.6e-6
    if not scene.body.plasticity.layer:
        return scene.model_copy(update={"grid": Grid(layers=round(deep / thickness), depth=deep)})
    ends = 0.0, scene.body.plasticity.layer_thickness, deep
    parts = [np.linspace(a, b, round((b - a) / thickness) + 1) for a, b in pairwise(ends)]
    faces = *parts[0], *parts[1][1:]
    return scene.model_copy(update={"grid": Grid(depths=tuple(map(float, faces)))})


def load_ratio(scene: Scene, share: float) -> Scene:
    """The mean pressure on a wavy surface over that of complete contact."""
    surface = scene.surface
    waves = math.hypot(1.0 / surface.wavelength_x, 1.0 / (surface.wavelength_y or math.inf))
    return with_loading(scene, mean_pressure=share * math.pi * modulus_of(scene) * surface.amplitude * waves)


RECIPES: Mapping[str, Callable[[Scene, Any], Scene]] = {
    "layer": with_layer,
    "p0-over-yield": at_ratio,
    "resolution": resolved_at,
    "cells": lambda scene, n: with_grid(scene, cells=(n, n)),
    "depths-over-radius": depths_over_radius,
    "elements": with_mesh,
    "grid-over-rounded-punch": grid_over_rounded_punch,
    "film": lambda scene, film: coated_scene(scene, *film),
    "cells-in-coated-contact": cells_in_coated_contact,
    "elastic": lambda scene, on: with_body(scene, plasticity=None) if on else scene,
    "friction": rubbed,
    "even-cells": even_cells,
    "sphere-depth": lambda scene, radii: with_loading(scene, depth=radii * scene.loading.radius),
    "sphere-cells": sphere_cells,
    "coupling": lambda scene, on: with_keys(scene, "friction", coupling=on) if scene.friction else scene,
    "given": given_tractions,
    "depths": even_depths,
    "travelling": travelling,
    "kinematic": lambda scene, _: with_body(scene, plasticity=Plasticity(**KINEMATIC)),
    "track": on_track,
    "coated-grid": lambda scene, cells: resolved_grid(scene, coated_contact(scene), cells),
    "film-under": film_under,
    "film-sliding": film_sliding,
    "film-dragged": film_dragged,
    "on-counterbody": on_counterbody,
    "asperities": cells_of_asperities,
    "load-ratio": load_ratio,
    "contact-fraction": lambda scene, share: load_ratio(scene, math.sin(0.5 * math.pi * share) ** 2),
    "wave-cells": lambda scene, n: with_grid(
        scene, cells=(n, 8), extent=(scene.surface.wavelength_x, 8 * scene.surface.wavelength_x / n)
    ),
}
"""Name in a case file -> what it does to the scene, in the order in which those of a case are applied."""
VALUES = {
    "layer": "the keys of a law, as body.plasticity.layer has them",
    "p0-over-yield": "a number > 0, for a body that yields",
    "resolution": "[cells, elements] in the contact radius, two whole numbers > 0",
    "cells": "a whole number > 0, of a side",
    "depths-over-radius": "a list of numbers, 0 first",
    "elements": "a whole number > 0, in the contact radius",
    "friction": "a coefficient, or the keys of [friction]",
    "even-cells": "[cells in the radius, reach along x, along y, in depth], of a given pressure",
    "depths": "a number > 0, radii of a given pressure",
    "load-ratio": "a number > 0, for a wavy surface",
    "contact-fraction": "a number from 0 to 1, for a wavy surface",
    "wave-cells": "a whole number > 0, for a wavy surface",
}
"""Recipe -> what is allowed, of those that suit any scene."""


def beside(file: CaseFile, name: str, known: Mapping[str, Any]) -> Any:
    """What a name in a case file means: of the module beside it, a registry, or what that module imports."""
    own = None
    if not file.own and file.path.with_suffix(".py").exists():
        module = import_module(f"verification.cases.{file.path.parent.name}.{file.path.stem}")
        own = getattr(module, name.replace("-", "_"), None)
        if getattr(own, "__module__", "") == module.__name__:
            return own
    if name not in known and own is None:
        raise KeyError(f"{file.path.name}: {name} is none of {', '.join(known)}")
    return known.get(name, own)


def changed(scene: Scene, changes: Mapping[str, Any], file: CaseFile) -> Scene:
    """The scene with keys set, numbers in SI or with their units, and recipes applied, in their order.
    Raises SceneError: key, value, and what is allowed.
    """
    for key, value in changes.items():
        section, _, name = key.rpartition(".")
        known = (
            "as in the cases of the suite that use it" if name in RECIPES else f"one of {', '.join(VALUES)}"
        )
        allowed = f"a key of [{section}]" if section else VALUES.get(name, known)
        try:
            if isinstance(value, str) and (unit := section and unit_of_key(Scene, key)):
                allowed = f"a number in units of {unit}"
                value = float(in_unit(value, unit))
            if section:
                scene = with_keys(
                    scene, section, **{name: tuple(value) if isinstance(value, list) else value}
                )
            else:
                scene = beside(file, name, RECIPES)(scene, value)
        except (ArithmeticError, AttributeError, LookupError, TypeError, ValueError) as error:
            where = f"set.{key}" if section else f"vary.{name}"
            raise SceneError([Problem(where, spelling(value), allowed)], str(file.path)) from error
    return scene
