# SPDX-License-Identifier: MIT
"""The scenes that the uncertainty of one is taken from: coarser cells, fewer load steps, a smaller box.

Cells and layers become coarser together, by the same factor; the layers of a box are interpolated in their
number. The load steps, and the box of the finite elements, are varied on the coarsest cells: relative changes
are much the same there, at a small part of the cost. Where load steps decide nothing the others have one.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import floor, sqrt

import numpy as np

import sam
from sam.grid import CellGrid, Room
from sam.scene import Grid, Result, Scene
from verification.runs import models

RATIO = 1.5  # of neighbouring cell sizes and load steps
# The same of elements of the axisymmetric model, at most, and elements that are left in the radius: 96 % of
# the errors of seven spheres with 9 to 24 elements are covered, as many as with 1.5, which costs more.
WIDEST, LEFT = 2.0, 5.0
LEAST_IN_RADIUS = 4.0  # cells in the contact radius of the coarsest: below it the rule covers less
LEAST_BOX = 3.0  # of [fem], in radii
# Of the largest von Mises stress: at depths with less its largest value is not looked for. It then takes a
# third of the depths, and 1.4 to 1.5 times the cost of the plain solve in place of 2.2 for a coated sphere.
LARGE = 0.85
FEWEST_STEPS = 4  # from so many on the others have fewer, else more


@dataclass(frozen=True)
class Member:
    """label: for the reader; number: of cells or load steps; size: what its error falls with."""

    scene: Scene
    label: str
    number: float
    size: float


@dataclass(frozen=True)
class Family:
    """The scenes that an uncertainty needs. cells: finest first; steps: on the coarsest of them, beginning
    with it; box: beginning with the last of steps, or of cells; empty where history or box decide nothing.
    """

    cells: tuple[Member, ...]
    steps: tuple[Member, ...] = ()
    box: tuple[Member, ...] = ()

    @property
    def all(self) -> tuple[Member, ...]:
        """Every scene once, the finest first."""
        return (*self.cells, *self.steps[1:], *self.box[1:])


class NoFamilyError(ValueError):
    """A scene that cannot be put on coarser cells; the message says why."""


def alone(scene: Scene) -> Scene:
    """The scene without its uncertainty, and asked for no accuracy: what a model solves."""
    plain = {"uncertainty": False, "accuracy": None, "accuracy_of": None}
    return scene.model_copy(update={"solver": scene.solver.model_copy(update=plain)})


def family(
    scene: Scene, model: str, room: Room | None = None, depths: Sequence[float] | None = None
) -> Family:
    """The scenes that the uncertainty of a scene is taken from; room: of a grid that was enlarged;
    depths: to which the coarser ones of an elastic body are limited, see `depths_of_maxima`. Raises
    NoFamilyError.
    """
    scene = alone(scene)
    cells = tuple(_cell_members(scene, model, room or Room(), depths))
    for member in cells[1:]:
        for key, allowed in member.scene.excesses():
            raise NoFamilyError(f"{member.label}: {key}: {allowed}")
        try:
            models.check(member.scene, model)
        except models.ModelError as reason:
            raise NoFamilyError(f"{member.label}: {reason}") from None
    steps = members_of_steps(cells[-1]) if has_history(scene) else ()
    box = members_of_box((steps or cells)[-1]) if model != models.SAM else ()
    return Family(cells, steps, box)


def cells_in_radius(scene: Scene, fine: Result, family: Family) -> float:
    """Cells in the contact radius (of a misfit sphere: in its radius) of the coarsest member; infinite for
    rough bodies, whose members say themselves whether they resolve the spots.
    """
    coarsest = family.cells[-1]
    if scene.patch_surface is not None:
        return np.inf
    if fine.model != models.SAM:
        return coarsest.number
    radius = scene.loading.radius or fine.quantities["contact_radius_m"]
    return (radius or 0.0) / coarsest.size


def cells_to_edge(scene: Scene, fine: Result, family: Family) -> float:
    """Cells of a result in the radius of its contact; infinite where no edge falls between cells: given
    pressures, rough bodies, and finite elements of a bare elastic body, which have a node at the edge.
    """
    area = fine.quantities.get("contact_area_m2")
    if scene.counterbody is None or scene.patch_surface is not None or not area:
        return np.inf
    if fine.model != models.SAM:
        moved = scene.body.plasticity is not None or scene.body.coating is not None
        return family.cells[0].number if moved else np.inf
    return sqrt(area / np.pi) / family.cells[0].size


def coarser(count: int, factor: float) -> int:
    """A number of cells over a factor, odd if the number is: a cell centre then stays on the apex."""
    odd = count % 2
    return 2 * floor((count / factor - odd) / 2 + 0.5) + odd


def step_counts(count: int) -> tuple[int, int, int]:
    """Three numbers of load steps, that of the scene first."""
    if count >= FEWEST_STEPS:
        return count, _whole(count / RATIO), max(_whole(count / RATIO**2), 2)
    middle = max(_whole(count * RATIO), count + 1)
    return count, middle, max(_whole(count * RATIO**2), middle + 1)


def _whole(value: float) -> int:
    return floor(value + 0.5)


def has_history(scene: Scene) -> bool:
    """Whether load steps decide anything: something yields, or a film breaks down."""
    coating, friction = scene.body.coating, scene.friction
    if scene.body.plasticity is not None or (friction is not None and friction.film):
        return True
    return coating is not None and coating.yield_stress is not None


def depths_of_maxima(scene: Scene, fine: Result) -> tuple[float, ...] | None:
    """The output depths about the largest stresses of an elastic body, in its film and below, which decide
    all that its coarser companions are asked for; any one below a rough body, where they are asked for no
    stress. None where the depths of a body that yields are its layers, or for finite elements.
    """
    table = fine.tables.get("plane")
    if fine.model != models.SAM or has_history(scene) or not table:
        return None
    z, mises = (np.asarray(table[name], dtype=float) for name in ("z_m", "mises_Pa"))
    depths, place = np.unique(z, return_inverse=True)
    if scene.patch_surface is not None:
        return (float(depths[0]),)
    largest = np.zeros(depths.size)
    np.maximum.at(largest, place, mises)
    film = depths < (0.0 if scene.body.coating is None else scene.body.coating.thickness)
    kept = [each & (largest >= LARGE * largest[each].max()) for each in (film, ~film) if each.any()]
    return tuple(map(float, depths[np.logical_or.reduce(kept)]))


def _cell_members(scene: Scene, model: str, room: Room, depths: Sequence[float] | None) -> list[Member]:
    other = scene if has_history(scene) else in_one_step(scene)
    if scene.patch_surface is None and model != models.SAM:
        count = scene.fem.cells_per_radius
        ratio = min(max(sqrt(count / LEFT), RATIO), WIDEST) if model == models.FEM else RATIO
        counts = (max(_whole(count / ratio**k), 2) for k in (1, 2))
        return [_of_mesh(scene, count), *(_of_mesh(other, each) for each in counts)]
    grid = sam.plan(scene).on(room).grid
    first = Member(scene, f"{grid.nx} cells", grid.nx, sqrt(grid.hx * grid.hy))
    return [first, *(_of_grid(other, grid, RATIO**k, depths) for k in (1, 2))]


def in_one_step(scene: Scene) -> Scene:
    """The same load of an elastic body at once; a way is gone as it is."""
    if scene.strokes.count:
        return scene
    loading = scene.loading.model_copy(update={"steps": 1, "unload_steps": None})
    return scene.model_copy(update={"loading": loading})


def _of_mesh(scene: Scene, count: int) -> Member:
    fem = scene.fem.model_copy(update={"cells_per_radius": count})
    return Member(
        scene.model_copy(update={"fem": fem}), f"{count} elements in the radius", count, 1.0 / count
    )


def _of_grid(scene: Scene, grid: CellGrid, factor: float, depths: Sequence[float] | None) -> Member:
    """The scene on a grid with larger cells over the same sides; depths: as those of `family`."""
    nx, ny = (max(coarser(count, factor), 3) for count in grid.shape)
    sides = grid.nx * grid.hx, grid.ny * grid.hy
    change: dict[str, object] = {"cells": (nx, ny)}
    if scene.patch_surface is None:
        change["extent"] = sides
    if grid.faces is not None:
        change |= {"depths": _faces(scene, grid.faces, nx / grid.nx), "layers": None, "depth": None}
    elif depths is not None:
        change |= {"depths": tuple(depths), "layers": None, "depth": None}
    given = (scene.grid or Grid()).model_copy(update=change)
    size = sqrt(sides[0] * sides[1] / (nx * ny))
    return Member(scene.model_copy(update={"grid": given}), f"{nx} cells", nx, size)


def _faces(scene: Scene, faces: np.ndarray, share: float) -> tuple[float, ...]:
    """Fewer faces of layers, interpolated in their number; those where the yield stress has a kink stay."""
    layers = len(faces) - 1
    places = np.linspace(0.0, layers, max(_whole(layers * share), 2) + 1)
    found = np.interp(places, np.arange(layers + 1), faces)
    for kink in scene.body.plasticity.strength().kinks.depths:
        if np.isclose(faces[1:-1], kink, rtol=1e-9, atol=0.0).any():
            found[1 + np.abs(found[1:-1] - kink).argmin()] = kink
    return tuple(map(float, np.unique(found)))


def members_of_steps(coarsest: Member) -> tuple[Member, ...]:
    """A scene with its number of load steps and two others, its own first."""
    loading = coarsest.scene.loading
    along = coarsest.scene.strokes.count
    whole = loading.steps + along
    members = []
    for count in step_counts(whole):
        share = count / whole
        change: dict[str, object] = {"steps": _share(loading.steps, share) if along else count}
        if loading.unload_steps:
            change["unload_steps"] = _share(loading.unload_steps, share)
        if along:
            own = {"steps": _share(along, share), "step_per_radius": None}
            change["path"] = loading.path.model_copy(update=own)
        scene = coarsest.scene.model_copy(update={"loading": loading.model_copy(update=change)})
        members.append(Member(scene, f"{count} load steps on {coarsest.label}", count, 1.0 / count))
    return tuple(members)


def _share(count: int, share: float) -> int:
    return max(_whole(count * share), 1)


def members_of_box(coarsest: Member) -> tuple[Member, ...]:
    """A scene with its finite-element box and a smaller one; none where that would be too small."""
    fem, members = coarsest.scene.fem, []
    for box in (fem.box, fem.box / RATIO):
        scene = coarsest.scene.model_copy(update={"fem": fem.model_copy(update={"box": box})})
        members.append(Member(scene, f"a box of {box:.3g} radii on {coarsest.label}", box, 1.0 / box))
    return tuple(members) if fem.box / RATIO >= LEAST_BOX else ()
