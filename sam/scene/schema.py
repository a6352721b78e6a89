# SPDX-License-Identifier: MIT
"""The scene: one contact, described once, solved by every model. In Python all quantities are SI floats.

Conventions: x along sliding, z into the body, z = 0 at its surface; the counter-body is a paraboloid with its
apex at the origin, gap0 = x^2/(2 Rx) + y^2/(2 Ry), the flat end of a cylinder (punch), gap0 = 0 for r <=
radius, the same with a rounded edge (rounded-punch), gap0 = (r - flat_radius)^2/(2 radius) for r >
flat_radius, or a plane (flat), gap0 = 0. A rough body has heights, positive out of it, and so has a rough
counter-body: gap0 less the heights of both, and shifted to touch first at 0, anew with each stretch of a
renewed counter-surface. A value out of range, an unknown key or keys that contradict each other raise
pydantic.ValidationError, all at once.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from math import isclose, sqrt
from typing import Any

from sam.scene.body import Body
from sam.scene.compare import Compare
from sam.scene.counterbody import CounterBody
from sam.scene.friction import Friction
from sam.scene.grid import Grid
from sam.scene.loading import MISFIT_SPHERE, Loading
from sam.scene.numerics import Fem, Solver
from sam.scene.passes import (
    conflicts_of_path,
    contact_radius,
    excesses_of_grid,
    excesses_of_path,
    excesses_of_steps,
)
from sam.scene.path import Strokes
from sam.scene.places import Places
from sam.scene.section import MISSING_INPUT, NOT_YET, Conflict, Section, stated, value_at
from sam.scene.surface import CounterSurface, Strip, Surface, leading, patch_of
from sam.scene.surface.height_map import FrictionMap
from sam.scene.surface.section import GENERATED, grid_excesses, patch_excesses
from sam.scene.units import STRAIN
from sam.scene.wear import Wear

OF_BACK_STRESSES = ("kinematic", "layer.kinematic")
"""Tables of [body.plasticity]."""


class Scene(Section):
    """One contact. There is no counter-body where the load is given in its place (loading.prescribed)."""

    title: str = ""
    body: Body
    counterbody: CounterBody | None = None
    surface: Surface | None = None
    loading: Loading
    friction: Friction | None = None
    wear: Wear | None = None
    grid: Grid | None = None
    solver: Solver = Solver()
    fem: Fem = Fem()
    compare: Compare | None = None

    @classmethod
    def conflicts(cls, given: Mapping[str, Any]) -> Iterator[Conflict]:
        """Tables and keys that need or exclude each other."""
        elastic = value_at(given, "body.plasticity") is MISSING_INPUT
        if elastic and value_at(given, "solver.method") == "paper":
            yield "solver.method", '"backward-euler": the loop of the paper needs [body.plasticity]'
        if value_at(given, "solver.method") == "paper" and any(
            value_at(given, f"body.plasticity.{table}") is not MISSING_INPUT for table in OF_BACK_STRESSES
        ):
            yield "solver.method", '"backward-euler": the loop of the paper knows no back-stress'
        free = value_at(given, "loading.prescribed") is MISSING_INPUT
        if free and "counterbody" not in given:
            yield "counterbody", 'required: a table [counterbody], or loading.prescribed = "hertz"'
        if not free:
            yield from _conflicts_of_prescribed(given)
        rough = "surface" in given or value_at(given, "counterbody.surface") is not MISSING_INPUT
        yield from (_conflicts_of_rough if rough else _conflicts_of_smooth)(given)
        yield from _conflicts_of_wear(given)
        yield from conflicts_of_path(given)
        claims = value_at(given, "compare.claim") is not MISSING_INPUT
        if claims and value_at(given, "body.coating") is MISSING_INPUT:
            yield "compare.claim", "only together with [body.coating]"

    @property
    def coefficient(self) -> float:
        """The coefficient of friction, the largest one where it varies; 0 without friction."""
        return self.friction.largest if self.friction else 0.0

    @property
    def constant_friction(self) -> bool:
        """Whether one coefficient holds everywhere and always."""
        return self.friction is None or self.friction.law == "constant"

    @property
    def seeds(self) -> tuple[int, ...]:
        """The seeds of what is drawn at random: of the surface, and of the counter-body's in each cycle."""
        seed = self.surface.seed if self.surface is not None else None
        counter = self.counter_surface
        opposite = () if counter is None else counter.seeds(self.loading.cycles)
        return opposite if seed is None else (seed, *opposite)

    @property
    def counter_surface(self) -> CounterSurface | None:
        """The heights of the counter-body; None if it is smooth."""
        return self.counterbody.surface if self.counterbody is not None else None

    @property
    def patch_surface(self) -> Surface | None:
        """The surface that says which cells the patch has, see `sam.scene.surface.leading`; None if both are
        smooth. That of the body before that of a counter-body that moves, which is longer than the patch.
        """
        if self.moves:
            return self.surface or self.counter_surface
        return leading(self.surface, self.counter_surface)

    @property
    def counter_strip(self) -> Strip | None:
        """What of a rough counter-body comes to lie opposite the patch while it moves; None of one in place
        or smooth.
        """
        surface, grid = self.counter_surface, self.grid
        if surface is None or not self.moves:
            return None
        path, slip = stated(self.loading.path), stated(self.counterbody).slip
        slip = 1.0 if slip is None else slip
        ways = [slip * (end - start) for start, end in zip(path.start, path.end, strict=True)]
        relief = grid is not None and grid.border == "relief"
        return Strip(surface, *self.patch, path.start, (ways[0], ways[1]), slip, relief)

    @property
    def patch(self) -> tuple[tuple[int, int], tuple[float, float]]:
        """(nx, ny) cells and sides (Lx, Ly) in m of the patch of a rough scene."""
        first, grid = stated(self.patch_surface), self.grid
        if self.moves and first is self.counter_surface:
            return stated(stated(grid).cells), stated(stated(grid).extent)
        return patch_of(first, grid)

    @property
    def moves(self) -> bool:
        """Whether a counter-body moves over the body."""
        return self.loading.path is not None and self.counterbody is not None

    @property
    def strokes(self) -> Strokes:
        """The passes of the load over its path, one in each cycle; all at the origin without path."""
        loading, count = self.loading, 0
        if loading.path is not None:
            count = loading.path.count(contact_radius(self.body, self.counterbody, loading))
        alternates = self.friction is not None and self.friction.direction == "alternating"
        moves = self.counterbody is not None
        worn = self.wear is not None
        return Strokes(loading.path, count, loading.cycles, loading.unload, alternates, moves, worn)

    def excesses(self) -> Iterator[Conflict]:
        """Good values that do not go together."""
        depths = self.grid.depths if self.grid else None
        if self.body.plasticity and depths and (depths[0] != 0 or len(depths) < 2):
            yield "grid.depths", "with plasticity the faces of the layers: two or more, the first 0"
        steps = []
        if self.loading.path is not None:
            radius = contact_radius(self.body, self.counterbody, self.loading)
            steps = list(excesses_of_steps(self.loading.path, radius))
            yield from steps
        if not steps:  # else the path has no places
            yield from _bad_patch(self)
            if self.moves:
                yield from _bad_path(self)
        if self.friction is not None and self.friction.path is not None:
            yield from _other_cells(self.friction.path, self)
        if self.solver.extrapolate:
            yield from _not_extrapolated(self)
        if self.solver.uncertainty:
            yield from _without_uncertainty(self)
        if self.solver.accuracy is not None:
            yield from _without_accuracy(self)
        yield from _beyond_shear_strength(self)


Section.places = Places(Scene)


def _bad_path(scene: Scene) -> Iterator[Conflict]:
    """A path that the counter-body or the grid is not fit for."""
    other, path = stated(scene.counterbody), stated(scene.loading.path)
    yield from excesses_of_path(scene.body, other, scene.loading, scene.coefficient)
    if scene.grid is not None and other.shape != "flat":
        radius = contact_radius(scene.body, other, scene.loading)
        yield from excesses_of_grid(scene.grid.extent, (path.start, path.end), radius)


def _bad_patch(scene: Scene) -> Iterator[Conflict]:
    """A grid that does not suit the surfaces, or surfaces that do not suit each other."""
    first, strip = scene.patch_surface, scene.counter_strip
    if first is None:
        return
    if strip is not None:
        found = [] if scene.surface is None else list(grid_excesses(scene.surface, scene.grid))
        yield from found or strip.excesses(scene.strokes.count)
        return
    found = list(grid_excesses(first, scene.grid))
    yield from found
    for other in (scene.surface, scene.counter_surface):
        if other is not None and other is not first and not found:
            yield from patch_excesses(other, *scene.patch)


def _conflicts_of_prescribed(given: Mapping[str, Any]) -> Iterator[Conflict]:
    """What a load in place of a force leaves no room for."""
    name = value_at(given, "loading.prescribed")
    misfit = name == MISFIT_SPHERE
    words, why = f'loading.prescribed = "{name}"', "the body" if misfit else "where the pressure is given"
    if "counterbody" in given:
        yield "counterbody", f"nothing presses {'on ' * misfit}{why}, {words}: remove it"
    if "surface" in given:
        yield "surface", f"with {words} {NOT_YET}"
    if not misfit:
        return
    for key in ("friction", "body.coating"):
        if value_at(given, key) is not MISSING_INPUT:
            yield key, f"not together with {words}: remove it"
    if value_at(given, "solver.method") == "paper":
        yield "solver.method", f'"backward-euler" with {words}: the loop of the paper solves a contact'


def _conflicts_of_smooth(given: Mapping[str, Any]) -> Iterator[Conflict]:
    """What only a rough body makes sense of."""
    if value_at(given, "counterbody.shape") == "flat":
        yield (
            "surface",
            'required: a table [surface] or [counterbody.surface], as counterbody.shape = "flat" touches a '
            "plane everywhere at once",
        )
    if value_at(given, "grid.border") == "relief":
        yield "grid.border", "only together with [surface] or [counterbody.surface]"


def _conflicts_of_rough(given: Mapping[str, Any]) -> Iterator[Conflict]:
    """What rough bodies need, and what they cannot be put together with yet."""
    kinds = [value_at(given, f"{table}.kind") for table in ("surface", "counterbody.surface")]
    words = "as nothing else says how large the generated surface is"
    longer = kinds[1] == "file" and value_at(given, "loading.path") is not MISSING_INPUT
    if longer:
        kinds, words = [kinds[0]], "as a counter-surface that moves is longer than the patch"
    if "file" not in kinds and (longer or any(kind in GENERATED for kind in kinds)):
        for key in ("grid.cells", "grid.extent"):
            if value_at(given, key) is MISSING_INPUT:
                yield key, f"required: grid.cells and grid.extent, {words}"


def _conflicts_of_wear(given: Mapping[str, Any]) -> Iterator[Conflict]:
    """What wear and a chemical film need, and what they cannot be put together with."""
    wears, film = "wear" in given, value_at(given, "friction.law") == "chemical-film"
    for there, words in ((wears, "[wear]"), (film, 'friction.law = "chemical-film"')):
        if not there:
            continue
        if value_at(given, "loading.prescribed") is not MISSING_INPUT:
            yield (
                "loading.prescribed",
                f"{words} needs a contact: remove it, and give force and [counterbody]",
            )
        if value_at(given, "solver.method") == "paper":
            yield "solver.method", f'"backward-euler" with {words}'
        if value_at(given, "body.coating") is not MISSING_INPUT:
            yield "body.coating", f"not together with {words}"
    if not wears:
        return
    if value_at(given, "body.plasticity") is MISSING_INPUT:
        yield "wear", "only together with [body.plasticity]: material is removed by its plastic strain"
    if value_at(given, "loading.unload") is not True:
        yield "loading.unload", "true with [wear]: material is removed after unloading"
    if value_at(given, "wear.strain_limit_layer") is not MISSING_INPUT and (
        value_at(given, "body.plasticity.layer_thickness") is MISSING_INPUT
    ):
        yield "wear.strain_limit_layer", "only together with body.plasticity.layer_thickness"


def _beyond_shear_strength(scene: Scene) -> Iterator[Conflict]:
    """A given traction under which the loaded circle slides off, however far the body hardens: its mean is
    2/3 mu p0.

    An upper bound of the limit load, of slip along the surface: at most (sigma_y + sum C_k/g_k)/sqrt(3) times
    the area is borne.
    """
    plasticity, mu = scene.body.plasticity, scene.coefficient
    if not scene.loading.hertz or plasticity is None or scene.body.coating is not None or mu == 0:
        return
    strength = plasticity.strength()
    most = float(strength.stress(0.0, STRAIN.high) + strength.back_saturation(0.0)) / sqrt(3) * 1.5 / mu
    if stated(scene.loading.p0) > most:
        yield (
            "loading.p0",
            f"at most {most:.4g} Pa with friction.coefficient = {mu:g}: the body bears no larger traction",
        )


def _not_extrapolated(scene: Scene) -> Iterator[Conflict]:
    """What cannot be put on half as many cells."""
    if scene.patch_surface is not None or (scene.friction is not None and scene.friction.path is not None):
        yield (
            "solver.extrapolate",
            "false with [surface], [counterbody.surface] or friction.path: they belong to their grid",
        )
    layers = None
    if scene.grid is not None and scene.body.plasticity is not None:
        layers = len(scene.grid.depths) - 1 if scene.grid.depths else scene.grid.layers
    if layers is not None and (layers % 2 or layers < 4):
        key = "grid.depths" if stated(scene.grid).depths else "grid.layers"
        yield key, "an even number of layers, four or more, with solver.extrapolate"


def _without_uncertainty(scene: Scene) -> Iterator[Conflict]:
    """What belongs to its grid, so that there is none that is coarser."""
    words = "false with {}: it belongs to its grid"
    if scene.friction is not None and scene.friction.path is not None:
        yield "solver.uncertainty", words.format("friction.path")
    for surface in (scene.surface, scene.counter_surface):
        if surface is not None and surface.kind == "file" and surface.resample is None:
            yield "solver.uncertainty", words.format(f'{surface.table}.path without resample = "fourier"')


def _without_accuracy(scene: Scene) -> Iterator[Conflict]:
    """What gives its cells, and what has a threshold: wear and film breakdown jump with the cells."""
    given = scene.grid
    if given is not None and (given.cells or given.extent or given.depths or given.layers):
        yield "solver.accuracy", "not together with [grid]: the cells are chosen"
    elif scene.patch_surface is not None:
        yield "solver.accuracy", "only for smooth bodies: the cells of a rough one are those of its surface"
    elif scene.loading.path is not None:
        yield "solver.accuracy", "not together with loading.path: no error over its steps was measured"
    if scene.loading.force == 0:
        yield "solver.accuracy", "only with loading.force above 0: without contact there is no error"
    if scene.wear is not None or (scene.friction is not None and scene.friction.film):
        yield "solver.accuracy", "not together with [wear] or a film: what is lost or breaks has a threshold"


def _other_cells(found: FrictionMap, scene: Scene) -> Iterator[Conflict]:
    """A grid that is not the one of the friction map."""
    cells, extent = (scene.grid.cells, scene.grid.extent) if scene.grid is not None else (None, None)
    if scene.patch_surface is not None:
        cells, extent = scene.patch
    if cells != found.cells:
        yield "grid.cells", f"{list(found.cells)}, the grid of friction.path"
    if extent is None or not all(
        isclose(*sides, rel_tol=1e-6) for sides in zip(extent, found.extent, strict=True)
    ):
        yield (
            "grid.extent",
            f"{' and '.join(f'{side:.9g} m' for side in found.extent)}, the grid of friction.path",
        )


def resolved(scene: Scene) -> dict[str, Any]:
    """The scene with every default, numbers in SI, as a mapping that JSON can hold; of keys that a section
    leaves unwritten at their default only what differs from it.

    >>> ball = {"shape": "sphere", "radius": 0.01}
    >>> scene = Scene(body={"young": 2e11, "poisson": 0.3}, counterbody=ball, loading={"force": 1.0})
    >>> Scene(**resolved(scene)) == scene
    True
    """
    return scene.model_dump(mode="json")


def solved_part(content: Mapping[str, Any]) -> dict[str, Any]:
    """What a result depends on, of a resolved scene: all but [compare], which only says how results are
    judged.
    """
    return {name: table for name, table in content.items() if name != "compare"}
