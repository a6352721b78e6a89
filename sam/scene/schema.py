# SPDX-License-Identifier: MIT
"""The scene: one contact, described once, solved by every model. In Python all quantities are SI floats.

Conventions: x along sliding, z into the body, z = 0 at its surface; the counter-body is a paraboloid with its
apex at the origin, gap0 = x^2/(2 Rx) + y^2/(2 Ry), the flat end of a cylinder (punch), gap0 = 0 for r <=
radius, the same with a rounded edge (rounded-punch), gap0 = (r - flat_radius)^2/(2 radius) for r >
flat_radius, or a plane (flat), gap0 = 0. A rough body has heights, positive out of it, and so has a rough
counter-body: gap0 less the heights of both, and shifted to touch first at 0, anew with each stretch of a
renewed counter-surface. A cylinder has gap0 = x^2/(2 radius), its axis along y. A value out of range, an
unknown key or keys that contradict each other raise pydantic.ValidationError, all at once.

Reading of scene files: a file becomes a Scene, or every error of it is reported at once.
"""

from __future__ import annotations

import re
import tomllib
from collections.abc import Iterator, Mapping
from math import ceil, inf, isclose, pi, sqrt
from pathlib import Path
from typing import Any, Required, TypedDict, Unpack

from pydantic import BaseModel, ValidationError

from sam.arrays import ROUNDING
from sam.scene.body import Body, CounterBody, Friction
from sam.scene.inputs import InputError, Inputs, read_limited
from sam.scene.numerics import MISFIT_SPHERE, TO_AND_FRO, Compare, Fem, Grid, Loading, Solver, Strokes, Wear
from sam.scene.section import (
    NOT_YET,
    Conflict,
    Given,
    Problem,
    SceneError,
    Section,
    broken,
    nameless,
    problems,
    stated,
    tables_of,
    toml,
)
from sam.scene.surface import CounterSurface, FrictionMap, Strip, Surface, leading, patch_of
from sam.scene.surface.section import GENERATED, grid_excesses, patch_excesses
from sam.scene.units import COUNT, IN_FILE, STRAIN

Keys = Mapping[str, object]


class Tables(TypedDict, total=False):
    """The tables of a scene as Python gives them."""

    title: str
    body: Required[Body | Keys]
    counterbody: CounterBody | Keys | None
    surface: Surface | Keys | None
    loading: Required[Loading | Keys]
    friction: Friction | Keys | None
    wear: Wear | Keys | None
    grid: Grid | Keys | None
    solver: Solver | Keys
    fem: Fem | Keys
    compare: Compare | Keys | None


class Scene(Section):
    """One contact, with the tables of a scene file; each is a mapping of its keys, numbers in SI units or
    strings with units. There is no counter-body where the load is given in its place (loading.prescribed).

    Raises
    ------
    SceneError
        With every error: key, value and what is allowed.

    Examples
    --------
    >>> ball = {"shape": "sphere", "radius": "105 um"}
    >>> print(Scene(body={"young": 210e9, "poisson": 0.3}, counterbody=ball, loading={"force": 0.65}))
    [body]
    young = "210 GPa"
    poisson = 0.3
    <BLANKLINE>
    [counterbody]
    shape = "sphere"
    radius = "105 um"
    <BLANKLINE>
    [loading]
    force = "650 mN"
    """

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

    def __init__(self, **tables: Unpack[Tables]):
        try:
            BaseModel.__init__(self, **tables)
        except ValidationError as error:
            raise SceneError(problems(error), "scene") from None

    # to pydantic it is its own, so that what is validated in another way, as a file is, does not come here
    __init__.__pydantic_base_init__ = True  # type: ignore[attr-defined]

    def __repr__(self) -> str:
        return "\n".join(toml(tables_of(self))).lstrip("\n")

    __str__ = __repr__

    def to_toml(self) -> str:
        """The scene as the text of a scene file, without what is at its default; read back it is equal.

        A file that the scene was read with (of heights, friction, yield stresses or a profile) is named: it
        belongs beside the text. Raises SceneError for such values that were given in Python.
        """
        tables = tables_of(self)
        if found := list(nameless(tables)):
            raise SceneError(found, "scene")
        return "\n".join(toml(tables)).lstrip("\n") + "\n"

    @classmethod
    def conflicts(cls, given: Given) -> Iterator[Conflict]:
        """Tables and keys that need or exclude each other."""
        at, has = given.at, given.has
        load, other, coated = at("loading.prescribed"), has("counterbody"), has("body.coating")
        plastic, wears, film = has("body.plasticity"), has("wear"), at("friction.law") == "chemical-film"
        misfit, pressure = load == MISFIT_SPHERE, load is not None
        pressed = "on the body" if misfit else "where the pressure is given"
        instead, shape = f'loading.prescribed = "{load}"', 'counterbody.shape = "flat"'
        flat, rough_counter = at("counterbody.shape") == "flat", has("counterbody.surface")
        smooth, either = not (has("surface") or rough_counter), "[surface] or [counterbody.surface]"
        paper, method = at("solver.method") == "paper", "solver.method"
        euler, loop = '"backward-euler"', "the loop of the paper"
        backs = has("body.plasticity.kinematic") or has("body.plasticity.layer.kinematic")
        bare, table = not (pressure or other), 'a table [counterbody], or loading.prescribed = "hertz"'
        anywhere = f"as {shape} touches a plane everywhere at once"
        yield from broken(
            (paper and not plastic, method, f"{euler}: {loop} needs [body.plasticity]"),
            (paper and backs, method, f"{euler}: {loop} knows no back-stress"),
            (bare, "counterbody", f"required: {table}"),
            (pressure and other, "counterbody", f"nothing presses {pressed}, {instead}: remove it"),
            (pressure and has("surface"), "surface", f"with {instead} {NOT_YET}"),
            (misfit and has("friction"), "friction", f"not together with {instead}: remove it"),
            (misfit and coated, "body.coating", f"not together with {instead}: remove it"),
            (misfit and paper, method, f"{euler} with {instead}: {loop} solves a contact"),
            (smooth and flat, "surface", f"required: a table {either}, {anywhere}"),
            (smooth and at("grid.border") == "relief", "grid.border", f"only together with {either}"),
        )
        yield from cls._conflicts_of_period(given)
        kinds = [at("surface.kind"), at("counterbody.surface.kind")]
        large = "nothing else says how large the generated surface is"
        if longer := kinds[1] == "file" and has("loading.path"):
            kinds, large = kinds[:1], "a counter-surface that moves is longer than the patch"
        if "file" not in kinds and (longer or any(kind in GENERATED for kind in kinds)):
            required = f"required: grid.cells and grid.extent, as {large}"
            yield from broken(*((not has(key), key, required) for key in ("grid.cells", "grid.extent")))
        for there, words in ((wears, "[wear]"), (film, 'friction.law = "chemical-film"')):
            contact = f"{words} needs a contact: remove it, and give force and [counterbody]"
            yield from broken(
                (there and pressure, "loading.prescribed", contact),
                (there and coated, "body.coating", f"not together with {words}"),
            )
        layered = has("wear.strain_limit_layer") and not has("body.plasticity.layer_thickness")
        stays, removed = wears and at("loading.unload") is not True, "material is removed"
        needs = f"only together with [body.plasticity]: {removed} by its plastic strain"
        moves, slip = has("loading.path") and other, at("counterbody.slip")
        returns, steps = at("loading.path.return") == TO_AND_FRO, "loading.path.steps"
        plane, along = moves and flat, moves and at("friction.direction") == "alternating"
        still, rolls = plane and not rough_counter, plane and rough_counter and slip == 0
        renewed = moves and at("counterbody.surface.renew") is True and returns and not wears
        uncertain, key = moves and rough_counter and at("solver.uncertainty") is True, "solver.uncertainty"
        cells = "its steps are whole cells, on others they would not be"
        yield from broken(
            (wears and not plastic, "wear", needs),
            (stays, "loading.unload", f"true with [wear]: {removed} after unloading"),
            (layered, "wear.strain_limit_layer", "only together with body.plasticity.layer_thickness"),
            (not moves and slip is not None, "counterbody.slip", "only together with loading.path"),
            (not moves and returns, "loading.path.return", '"lifted" where the pressure is given'),
            (moves and coated, "body.coating", f"with loading.path {NOT_YET}"),
            (still, "loading.path", "nothing moves: a plane needs [counterbody.surface], or leave it out"),
            (rolls, "counterbody.slip", "above 0: nothing moves on a plane that rolls"),
            (plane and not has(steps), steps, f"required with {shape}, which has no contact radius"),
            (renewed, "counterbody.surface.renew", 'false with return = "to-and-fro": the load stays on'),
            (uncertain, key, f"false with [counterbody.surface] and loading.path: {cells}"),
            (along, "friction.direction", '"constant" with loading.path: the traction is along the motion'),
            (moves and paper, method, f"{euler} with loading.path: {loop} knows no motion"),
            (has("compare.claim") and not coated, "compare.claim", "only together with [body.coating]"),
        )

    @classmethod
    def _conflicts_of_period(cls, given: Given) -> Iterator[Conflict]:
        """What a periodic patch and a line contact need, and cannot have."""
        at, has = given.at, given.has
        periodic, shape = at("grid.periodic"), at("counterbody.shape")
        line, repeats, along = shape == "cylinder", periodic == "xy", periodic == "y"
        patch, axis = 'grid.periodic = "xy"', 'counterbody.shape = "cylinder"'
        either, only = f"with {patch if repeats else axis}", f"only together with {patch}"
        summits = 'counterbody.shape = "flat", whose summits or those of the body repeat'
        datum = f"a force with {axis}: the approach of a line contact has no absolute value"
        rough = has("surface") or has("counterbody.surface")
        cells, swept = at("grid.cells"), at("solver.operator") == "swept"
        pair = isinstance(cells, list | tuple) and len(cells) == 2 and isinstance(cells[1], int)
        rows = cells[1] if pair else 0
        loop, plastic = at("solver.method") == "paper", has("body.plasticity")
        bordered, several = at("grid.border") == "relief", line and not rough and rows > 1
        across, moves = line and rough and rows > 1 and not along, line and rough and has("loading.path")
        lateral, alike = (
            has("loading.lateral"),
            f"one cell along y with a smooth {axis}: all is the same there",
        )
        yield from broken(
            ((repeats or line) and has("body.coating"), "body.coating", f"{either} {NOT_YET}"),
            (repeats and has("loading.path"), "loading.path", f"{either} {NOT_YET}"),
            (line and has("friction.path"), "friction.path", f"{either} {NOT_YET}"),
            (repeats and not line and shape != "flat", "counterbody.shape", f"with {patch}: {summits}"),
            (repeats and bordered, "grid.border", f'"free" with {patch}: it has no border'),
            (across, "grid.periodic", f'"y" with {axis} on cells along y'),
            (moves, "loading.path", f"with {axis} and a rough surface {NOT_YET}"),
            (line and bordered, "grid.border", f'"free" with {axis}'),
            (has("surface.taper") and not repeats, "surface.taper", only),
            (has("counterbody.surface.taper") and not repeats, "counterbody.surface.taper", only),
            (along and not line, "grid.periodic", f'"y" only together with {axis}'),
            (repeats and line, "grid.periodic", f'"y" with {axis}'),
            (line and has("loading.approach"), "loading.approach", datum),
            (several, "grid.cells", alike),
            (not line and 0 < rows < 3, "grid.cells", f"3 or more cells along y, 1 only with {axis}"),
            (line and swept, "solver.operator", f'"dense" with {axis}'),
            ((repeats or line) and loop, "solver.method", f'"backward-euler" {either}'),
            (has("loading.mean_pressure") and not repeats, "loading.mean_pressure", only),
            (lateral and not (repeats and plastic), "loading.lateral", f"{only} and [body.plasticity]"),
        )

    @property
    def force(self) -> float | None:
        """The normal force in N, of a mean pressure on the patch; None if another load is given."""
        pressure = self.loading.mean_pressure
        if pressure is None:
            return self.loading.force
        lx, ly = self.patch[1]
        return pressure * lx * ly

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
        """The surface whose cells the patch has, the body's before a moving one's; or None."""
        if self.moves:
            return self.surface or self.counter_surface
        return leading(self.surface, self.counter_surface)

    @property
    def counter_strip(self) -> Strip | None:
        """What of a rough counter-body lies opposite while it moves; else None."""
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
            count = loading.path.count(contact_radius(self))
        alternates = self.friction is not None and self.friction.direction == "alternating"
        moves = self.counterbody is not None
        worn = self.wear is not None
        return Strokes(loading.path, count, loading.cycles, loading.unload, alternates, moves, worn)

    def excesses(self) -> Iterator[Conflict]:
        """Good values that do not go together."""
        grid, path, friction = self.grid, self.loading.path, self.friction
        depths, plasticity = grid.depths if grid else None, self.body.plasticity
        if plasticity and depths and (depths[0] != 0 or len(depths) < 2):
            yield "grid.depths", "with plasticity the faces of the layers: two or more, the first 0"
        radius, refused = contact_radius(self) if path is not None else inf, list[Conflict]()
        if path is not None and radius == 0:
            words = "above 0 with loading.path: nothing else says how long its steps may be"
            refused = [("loading.force", words)]
        elif path is not None and path.step_per_radius is not None:
            most = COUNT.high * radius / path.length
            words = f"at most {most:.4g}: this path may have {COUNT.high:g} steps"
            if path.step_per_radius * path.length > COUNT.high * radius:
                refused = [("loading.path.step_per_radius", words)]
        yield from refused
        if not refused:  # else the path has no places
            yield from self._excesses_of_patch()
            if self.moves:
                yield from self._excesses_of_path(radius)
        if friction is not None and friction.path is not None:
            yield from self._other_cells(friction.path)
        yield from self._excesses_of_solver()
        if self.loading.hertz and plasticity is not None and self.body.coating is None and self.coefficient:
            # a traction under which the loaded circle slides off, however far the body hardens: its mean is
            # 2/3 mu p0. An upper bound of the limit load, of slip along the surface: at most
            # (sigma_y + sum C_k/g_k)/sqrt(3) times the area is borne
            strength, mu = plasticity.strength(), self.coefficient
            borne = float(strength.stress(0.0, STRAIN.high) + strength.back_saturation(0.0)) / sqrt(3)
            most = borne * 1.5 / mu
            if stated(self.loading.p0) > most:
                words = f"with friction.coefficient = {mu:g}: the body bears no larger traction"
                yield "loading.p0", f"at most {most:.4g} Pa {words}"

    def _excesses_of_path(self, radius: float) -> Iterator[Conflict]:
        """A path that the counter-body or the grid is not fit for; radius: of the contact in m."""
        path, other, mu = stated(self.loading.path), stated(self.counterbody), self.coefficient
        step, least = path.length / path.count(radius), ceil(path.length / radius - ROUNDING)
        long = f"{least} or more: a step of {step:.4g} m is longer than the contact radius, {radius:.4g} m"
        turns, rolls = mu > 0 and path.start[1] != path.end[1], mu > 0 and other.slip == 0
        sticks = "rolls (slip = 0) with friction sticks in a part of the contact (stick-slip)"
        slides = f"above 0 with friction.coefficient = {mu:g}: a counter-body that {sticks}"
        yield from broken(
            (step > radius * (1 + ROUNDING), "loading.path.steps", long),
            (turns, "loading.path.end", "the y of start with [friction]: the traction acts along x"),
            (
                other.length is not None and (path.start[1], path.end[1]) != (0.0, 0.0),
                "loading.path.end",
                'y = 0 as in start with counterbody.shape = "cylinder": it moves along x',
            ),
            (rolls, "counterbody.slip", slides),
        )
        extent = None if self.grid is None or other.shape == "flat" else self.grid.extent
        if extent is not None:
            far = [2 * (max(map(abs, ends)) + radius) for ends in zip(path.start, path.end, strict=True)]
            if any(side < least for side, least in zip(extent, far, strict=True)):
                words = " and ".join(f"{least:.4g} m" for least in far)
                yield "grid.extent", f"at least {words}, to hold the contact at both ends of loading.path"

    def _excesses_of_patch(self) -> Iterator[Conflict]:
        """A grid that does not suit the surfaces, or surfaces that do not suit each other."""
        first, strip = self.patch_surface, self.counter_strip
        length, extent = self.counterbody and self.counterbody.length, self.grid and self.grid.extent
        if length and extent and not isclose(extent[1], length, rel_tol=ROUNDING):
            yield "grid.extent", f"{length:.9g} m along y, the length of the cylinder"
        if first is None:
            return
        rough = self.surface if strip is not None else first
        unfit = [] if rough is None else list(grid_excesses(rough, self.grid))
        yield from unfit
        if unfit:
            return
        if strip is not None:
            yield from strip.excesses(self.strokes.count)
            return
        for other in (self.surface, self.counter_surface):
            if other is not None and other is not first:
                yield from patch_excesses(other, *self.patch)

    def _other_cells(self, coefficients: FrictionMap) -> Iterator[Conflict]:
        """A grid that is not the one of the friction map."""
        cells, extent = (self.grid.cells, self.grid.extent) if self.grid is not None else (None, None)
        if self.patch_surface is not None:
            cells, extent = self.patch
        if cells != coefficients.cells:
            yield "grid.cells", f"{list(coefficients.cells)}, the grid of friction.path"
        sides = coefficients.extent
        if extent is None or not all(
            isclose(*both, rel_tol=1e-6) for both in zip(extent, sides, strict=True)
        ):
            words = " and ".join(f"{side:.9g} m" for side in sides)
            yield "grid.extent", f"{words}, the grid of friction.path"

    def _excesses_of_solver(self) -> Iterator[Conflict]:
        """What rules out extrapolation: a grid or cells of its own, or a threshold."""
        solver, grid, friction = self.solver, self.grid, self.friction
        rough, mapped = self.patch_surface is not None, friction is not None and friction.path is not None
        layers, key = None, "grid.layers"
        if grid is not None and self.body.plasticity is not None:
            layers, key = (len(grid.depths) - 1, "grid.depths") if grid.depths else (grid.layers, key)
        odd = layers is not None and (layers % 2 or layers < 4)
        more, sure, accuracy = solver.extrapolate, solver.uncertainty, "solver.accuracy"
        exact, alone = solver.accuracy is not None, "false with {}: it belongs to its grid"
        measured = "[surface], [counterbody.surface] or friction.path: they belong to their grid"
        yield from broken(
            (more and (rough or mapped), "solver.extrapolate", f"false with {measured}"),
            (more and odd, key, "an even number of layers, four or more, with solver.extrapolate"),
            (sure and mapped, "solver.uncertainty", alone.format("friction.path")),
        )
        for surface in (self.surface, self.counter_surface):
            if sure and surface is not None and surface.kind == "file" and surface.resample is None:
                path = f'{surface.table}.path without resample = "fourier"'
                yield "solver.uncertainty", alone.format(path)
        cells = exact and grid is not None and bool(grid.cells or grid.extent or grid.depths or grid.layers)
        own, moved = exact and not cells and rough, exact and self.loading.path is not None
        jumps = exact and (self.wear is not None or (friction is not None and friction.film))
        idle = exact and self.loading.force == 0
        yield from broken(
            (cells, accuracy, "not together with [grid]: the cells are chosen"),
            (own, accuracy, "only for smooth bodies: the cells of a rough one are those of its surface"),
            (
                moved and not (cells or rough),
                accuracy,
                "not together with loading.path: no error over its steps was measured",
            ),
            (idle, accuracy, "only with loading.force above 0: without contact there is no error"),
            (jumps, accuracy, "not together with [wear] or a film: what is lost or breaks has a threshold"),
        )


Section.whole = Scene


def contact_radius(scene: Scene) -> float:
    """Radius in m of the contact by Hertz, in which steps along a path are counted: (3 F R/(4 E*))^(1/3), of
    an ellipsoid with the geometric mean R of its radii (Johnson 1985, Eq. 4.22); under an approach d
    sqrt(R d). Of a cylinder its half-width, (4 F R/(pi length E*))^(1/2) (Johnson 1985, Eq. 4.43). That of
    the flat end of a punch, and of a load that is given. 0 without force, infinite below a plane.
    """
    other, loading, body = scene.counterbody, scene.loading, scene.body
    if other is None:
        return stated(loading.radius)
    if other.shape == "flat":
        return inf
    compliance = (1 - body.poisson**2) / body.young
    if other.young is not None:
        compliance += (1 - stated(other.poisson) ** 2) / other.young
    if other.length is not None:
        return sqrt(4 / pi * stated(loading.force) / other.length * stated(other.radius) * compliance)
    if other.radii is None:
        return stated(other.flat_radius or other.radius)
    radius = sqrt(other.radii[0] * other.radii[1])
    if loading.approach is not None:
        return sqrt(radius * loading.approach)
    return float((0.75 * stated(loading.force) * radius * compliance) ** (1 / 3))


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
    """What a result depends on, of a resolved scene: all but [compare]."""
    return {name: table for name, table in content.items() if name != "compare"}


_BETWEEN = re.compile(rb"([\n,={}\[\]#])")
_BARE = re.compile(rb"^[^\n#\"']*[=\[,]\s*+[+-]?[0-9][0-9.eE_+-]*+[ \t]*+[A-Za-z]", re.MULTILINE)
"""A number with a unit and without quotes."""
_MOST_DOTS = 32  # in one key

KINDS = {
    "rows": ("verification case", "verify"),
    "cases": ("verification case", "verify"),
    "vary": ("study", "sweep"),
    "unknown": ("fit", "fit"),
    "body": ("scene", "solve"),
}
"""Table that a file has -> its kind, and the command that takes it."""


def load_scene(path: str | Path) -> Scene:
    """The scene in a TOML file.

    Parameters
    ----------
    path
        Of the file; files that it names are read from its folder.

    Raises
    ------
    SceneError
        With every problem of the file: key, value and what is allowed.
    """
    return read_scene(path)[0]


def read_scene(path: str | Path) -> tuple[Scene, dict[str, bytes]]:
    """As `load_scene`, with the content of every file that was read, the scene file among them, by name."""
    path = Path(path)
    try:
        content = read_limited(path)
    except InputError as error:
        raise _whole_file(str(error), path) from None
    inputs = Inputs(path.parent)
    scene = parse_scene(content, str(path), inputs)
    return scene, {path.name: content, **inputs.contents}


def parse_scene(content: bytes, source: str, inputs: Inputs | None = None) -> Scene:
    """The scene in bytes of TOML, whose name is `source`; inputs: reads the files that it names."""
    table = parse_toml(content, source)
    if not table:
        raise _whole_file("empty: a scene needs the tables [body], [counterbody] and [loading]", source)
    check_kind(table, "scene", source)
    return scene_of(table, source, inputs)


def parse_toml(content: bytes, source: str) -> dict[str, Any]:
    """The tables in bytes of TOML; SceneError for others, or tables in too many."""
    pieces = _BETWEEN.split(content)  # every second one is a separator
    if any(
        name.count(b".") > _MOST_DOTS and end in b"=]"
        for name, end in zip(pieces[::2], pieces[1::2], strict=False)
    ):
        raise _whole_file("nested too deeply", source)  # tomllib takes time with the square of the depth
    try:
        return tomllib.loads(content.decode("utf-8-sig"))
    except UnicodeDecodeError as error:
        line = content.count(b"\n", 0, error.start) + 1
        raise _whole_file(f"not UTF-8: byte {content[error.start]:#04x} in line {line}", source) from None
    except RecursionError:
        raise _whole_file("nested too deeply", source) from None
    except ValueError as error:  # TOMLDecodeError, and a number of thousands of digits
        quotes = ": numbers with units stand in quotes" if _BARE.search(content) else ""
        raise _whole_file(f"not TOML: {error}{quotes}", source) from None


def check_kind(table: Mapping[str, Any], own: str, source: str) -> None:
    """Raise SceneError for a file of another kind than its own, with the command that takes it."""
    kind, command = next((kind for key, kind in KINDS.items() if key in table), (own, ""))
    if kind != own and not any(key in table for key, (other, _) in KINDS.items() if other == own):
        raise _whole_file(f"this is a {kind}: samfem {command} {source}", source)


def scene_of(table: Mapping[str, Any], source: str, inputs: Inputs | None = None) -> Scene:
    """The scene, with all defaults, in the tables that `parse_toml` returns; the rest as of `parse_scene`."""
    try:
        return Scene.model_validate(table, context={**IN_FILE, "inputs": inputs})
    except ValidationError as error:
        raise SceneError(problems(error), source) from None


def _whole_file(message: str, source: str | Path) -> SceneError:
    return SceneError([Problem("", "", message)], str(source))
