# SPDX-License-Identifier: MIT
"""The scene: one contact, described once, solved by every model. In Python all quantities are SI floats.

Conventions: x along sliding, z into the body, z = 0 at its surface; the counter-body is a paraboloid with its apex at
the origin, gap0 = x^2/(2 Rx) + y^2/(2 Ry), the flat end of a cylinder (punch), gap0 = 0 for r <= radius, or a plane
(flat), gap0 = 0. A rough body has heights, positive out of it: gap0 less the heights, and shifted to touch first at 0.
A value out of range, an unknown key or keys that contradict each other raise pydantic.ValidationError, all at once.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from itertools import pairwise
from math import isclose, sqrt
from typing import Annotated, Literal

from pydantic import AfterValidator, BeforeValidator
from pydantic_core import PydanticCustomError

from sam.scene.compare import Compare
from sam.scene.friction import Friction
from sam.scene.inputs import Rows, TwoColumns
from sam.scene.section import MISSING_INPUT, NOT_YET, Conflict, Section, value_at
from sam.scene.surface import Surface
from sam.scene.surface.height_map import FrictionMap
from sam.scene.surface.section import GENERATED, grid_excesses
from sam.scene.units import (
    DEPTH,
    FACTOR,
    PRESSURE,
    STRAIN,
    Box,
    Cells,
    Coordinate,
    Count,
    Depth,
    Exponent,
    Force,
    Fraction,
    Length,
    MeshCells,
    Modulus,
    Poisson,
    Positive,
    Pressure,
)
from sam.scene.wear import Wear
from sam.scene.yield_curve import DepthProfile, Linear, Swift, Tabulated, YieldCurve

MOST_DEPTHS = 1001
# ratio of the radii of an ellipsoid; beyond it the contact is a line for every grid that is allowed
MOST_SLENDER = 1e4


def _list_of(shortest: int, longest: int) -> BeforeValidator:
    """A TOML array (or tuple, or list) of so many entries, as a tuple."""
    words = f"a list of {shortest}" if shortest == longest else f"a list of {shortest} to {longest}"

    def check(value: object) -> tuple:
        if not isinstance(value, list | tuple) or not shortest <= len(value) <= longest:
            raise PydanticCustomError("allowed", "allowed: {allowed}", {"allowed": words})
        return tuple(value)

    return BeforeValidator(check)


def _ascending(depths: tuple[float, ...]) -> tuple[float, ...]:
    if any(lower >= upper for lower, upper in pairwise(depths)):
        raise PydanticCustomError(
            "allowed", "allowed: {allowed}", {"allowed": "depths in strictly ascending order"}
        )
    return depths


YIELD_TABLE = TwoColumns(("peeq", "yield_stress_Pa"), (STRAIN, PRESSURE), from_zero=True, falling="softening")
PROFILE = TwoColumns(("depth_m", "factor"), (DEPTH, FACTOR))
MICROSTRAIN = 1e6
LAWS = {
    "swift": ("B", "C", "n"),
    "linear": ("yield_stress", "modulus"),
    "perfect": ("yield_stress",),
    "table": ("file",),
}
"""Yield laws and the keys that each needs."""


class Plasticity(Section):
    """J2 plasticity with isotropic hardening. Yield stress at depth z: depth_profile()(z) * curve().stress(peeq).

    law "swift": B (C + alpha peeq)^n, B in Pa, alpha 1e6 if not given; "linear": yield_stress + modulus peeq, both in Pa;
    "perfect": yield_stress; "table": file, the rows (peeq, yield stress in Pa), the first at peeq = 0, never falling.
    profile: the rows (depth in m, factor); in a scene file, file and profile are names of CSV files in its folder.
    layer_thickness: depth in m of the layer that wears by a limit of its own; without wear it changes nothing.
    """

    law: Literal["swift", "linear", "perfect", "table"]
    B: Pressure | None = None
    C: Positive | None = None
    n: Exponent | None = None
    alpha: Positive | None = None
    yield_stress: Pressure | None = None
    modulus: Modulus | None = None
    file: Annotated[Rows, YIELD_TABLE] | None = None
    profile: Annotated[Rows, PROFILE] | None = None
    layer_thickness: Length | None = None

    @classmethod
    def implied(cls, given: Mapping) -> Mapping:
        return {"alpha": MICROSTRAIN} if given.get("law") == "swift" else {}

    @classmethod
    def conflicts(cls, given: Mapping) -> Iterator[Conflict]:
        law = given.get("law")
        needed = LAWS.get(law) if isinstance(law, str) else None
        if needed is None:
            return
        optional = ("alpha",) if law == "swift" else ()
        for key in ("B", "C", "n", "alpha", "yield_stress", "modulus", "file"):
            if key in needed and key not in given:
                yield key, f'law = "{law}" takes {", ".join(needed)}'
            if key not in (*needed, *optional) and key in given:
                yield key, f'law = "{law}" takes {", ".join((*needed, *optional))}: remove it'

    def curve(self) -> YieldCurve:
        """The yield stress in Pa as a function of the accumulated plastic strain, where the factor over depth is 1."""
        match self.law:
            case "swift":
                return Swift(self.B, self.C, self.n, self.alpha)
            case "linear":
                return Linear(self.yield_stress, self.modulus)
            case "perfect":
                return Linear(self.yield_stress)
            case "table":
                return Tabulated(*zip(*self.file, strict=True))

    def depth_profile(self) -> DepthProfile:
        """The factor on the yield stress as a function of depth in m; 1 everywhere without profile."""
        return DepthProfile(*zip(*self.profile, strict=True)) if self.profile else DepthProfile()


class Coating(Section):
    """An elastic film bonded on the body, 0 <= z < thickness; thickness in m, young in Pa.

    yield_stress in Pa: perfectly plastic beyond it (finite elements only); elastic if not given.
    """

    thickness: Length
    young: Pressure
    poisson: Poisson
    yield_stress: Pressure | None = None

    @classmethod
    def conflicts(cls, given: Mapping) -> Iterator[Conflict]:
        if "yield_stress" in given and given.get("poisson") == 0.5:
            yield "poisson", "less than 0.5 with yield_stress"


class Body(Section):
    """The half-space z >= 0, isotropic; elastic without plasticity. young in Pa. A coating takes the place of its outer part."""

    young: Pressure
    poisson: Poisson
    plasticity: Plasticity | None = None
    coating: Coating | None = None

    @classmethod
    def conflicts(cls, given: Mapping) -> Iterator[Conflict]:
        if "plasticity" in given and given.get("poisson") == 0.5:
            yield "poisson", "less than 0.5 with plasticity"


RADII = {"sphere": ("radius",), "punch": ("radius",), "ellipsoid": ("radius_x", "radius_y"), "flat": ()}
"""Shapes and the keys that each needs."""


class CounterBody(Section):
    """The smooth counter-body. Rigid without young and poisson, elastic with both. Lengths in m, young in Pa."""

    shape: Literal["sphere", "ellipsoid", "punch", "flat"]
    radius: Length | None = None
    radius_x: Length | None = None
    radius_y: Length | None = None
    young: Pressure | None = None
    poisson: Poisson | None = None

    @property
    def elastic(self) -> bool:
        return self.young is not None

    @property
    def radii(self) -> tuple[float, float]:
        """(Rx, Ry) in m of a sphere or an ellipsoid."""
        if self.shape == "ellipsoid":
            return self.radius_x, self.radius_y
        return self.radius, self.radius

    @classmethod
    def conflicts(cls, given: Mapping) -> Iterator[Conflict]:
        shape = given.get("shape")
        needed = RADII.get(shape) if isinstance(shape, str) else None
        for key in ("radius", "radius_x", "radius_y"):
            if needed is not None and (key in needed) != (key in given):
                words = " and ".join(needed) or "no radius"
                yield key, f'shape = "{shape}" takes {words}' + ("" if key in needed else ": remove it")
        if ("young" in given) != ("poisson" in given):
            missing = "poisson" if "young" in given else "young"
            yield missing, "required: young and poisson together (elastic counter-body), or neither (rigid)"

    def excesses(self) -> Iterator[Conflict]:
        if (
            self.shape == "ellipsoid"
            and not 1 / MOST_SLENDER <= self.radius_x / self.radius_y <= MOST_SLENDER
        ):
            yield "radius_y", f"radius_x/radius_y from {1 / MOST_SLENDER:g} to {MOST_SLENDER:g}"


Place = Annotated[tuple[Coordinate, Coordinate], _list_of(2, 2)]
"""(x, y) on the surface in m."""


class Path(Section):
    """The way of a given pressure over the surface, from start to end in `steps` equal steps at full size.

    Before it the load is put on at start, after it lifted at end: one pass in every cycle.
    """

    start: Place
    end: Place
    steps: Count

    def excesses(self) -> Iterator[Conflict]:
        if self.start == self.end:
            yield "end", "another place than start"


GIVEN_PRESSURE = ("p0", "radius")
"""Keys that a given pressure needs."""


class Loading(Section):
    """`steps` equal steps to the peak, and back to zero in `unload_steps` when `unload`; so in every one of the cycles.

    The load is a normal force in N, by which a counter-body is pressed on, or with prescribed = "hertz" the pressure itself:
    at step k (k/steps) p0 sqrt(1 - r^2/radius^2), p0 in Pa, radius in m the same in all steps; it may travel on a path.
    """

    force: Force | None = None
    prescribed: Literal["hertz"] | None = None
    p0: Pressure | None = None
    radius: Length | None = None
    path: Path | None = None
    steps: Count = 1
    unload: bool = False
    unload_steps: Count | None = None
    cycles: Count = 1

    @classmethod
    def conflicts(cls, given: Mapping) -> Iterator[Conflict]:
        words = 'prescribed = "hertz" with p0 and radius'
        if "prescribed" in given:
            yield from ((key, f"required: {words}") for key in GIVEN_PRESSURE if key not in given)
            if "force" in given:
                yield "force", f"either force, or {words}, not both"
        else:
            if "force" not in given:
                yield "force", f"required: force, or {words}"
            yield from ((key, f"only as part of {words}") for key in GIVEN_PRESSURE if key in given)
            if "path" in given:
                yield "path", 'only together with prescribed = "hertz"'
        if "unload_steps" in given and given.get("unload", False) is False:
            yield "unload_steps", "only together with unload = true"


class Grid(Section):
    """The cells and output depths of the semi-analytical model. cells: (nx, ny); extent: (Lx, Ly) in m.

    Cells alone take the default extent, an extent alone the default number of cells. depths: z in m where stresses are
    returned, with plasticity the faces of the layers, the first at 0; or `layers` equal layers down to `depth`.
    border: of a rough patch; "relief": its heights fall off there, so that the contact ends before the patch does.
    """

    cells: Annotated[tuple[Cells, Cells], _list_of(2, 2)] | None = None
    extent: Annotated[tuple[Length, Length], _list_of(2, 2)] | None = None
    depths: Annotated[tuple[Depth, ...], AfterValidator(_ascending), _list_of(1, MOST_DEPTHS)] | None = None
    layers: Count | None = None
    depth: Length | None = None
    border: Literal["free", "relief"] = "free"

    @classmethod
    def conflicts(cls, given: Mapping) -> Iterator[Conflict]:
        if "depths" in given and ("layers" in given or "depth" in given):
            yield "depths", "either depths, or layers with depth, not both"
        elif ("layers" in given) != ("depth" in given):
            yield ("depth" if "layers" in given else "layers"), "required: layers and depth together"


class Solver(Section):
    """tolerance: see the solver. The methods differ in the plastic loop; elastic contact knows only the default.

    "paper": the loop of Bosman & Schipper 2011, Fig. 7, as printed, which stops on the change of `stop` ("stress" if not given).
    extrapolate: the semi-analytical model solves on half as many cells too, and extrapolates its quantities to none.
    """

    method: Literal["backward-euler", "paper"] = "backward-euler"
    stop: Literal["stress", "strain"] | None = None
    tolerance: Fraction = 1e-6
    extrapolate: bool = False

    @classmethod
    def implied(cls, given: Mapping) -> Mapping:
        return {"stop": "stress"} if given.get("method") == "paper" else {}

    @classmethod
    def conflicts(cls, given: Mapping) -> Iterator[Conflict]:
        if "stop" in given and given.get("method") != "paper":
            yield "stop", 'only together with method = "paper"'


class Fem(Section):
    """The finite-element mesh. box: outer radius and depth in Hertz radii.

    Of a rough scene box is in half sides of its patch, and the cells of the scene are those of the mesh.
    """

    cells_per_radius: MeshCells = 16
    box: Box = 10.0


class Scene(Section):
    """One contact. There is no counter-body where the pressure is given (loading.prescribed)."""

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
    def conflicts(cls, given: Mapping) -> Iterator[Conflict]:
        elastic = value_at(given, "body.plasticity") is MISSING_INPUT
        if elastic and value_at(given, "solver.method") == "paper":
            yield "solver.method", '"backward-euler": the loop of the paper needs [body.plasticity]'
        free = value_at(given, "loading.prescribed") is MISSING_INPUT
        if free and "counterbody" not in given:
            yield "counterbody", 'required: a table [counterbody], or loading.prescribed = "hertz"'
        if not free and "counterbody" in given:
            yield (
                "counterbody",
                'nothing presses where the pressure is given, loading.prescribed = "hertz": remove it',
            )
        yield from (_conflicts_of_smooth if "surface" not in given else _conflicts_of_rough)(given)
        yield from _conflicts_of_wear(given)
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
        """Of what is drawn at random: the surface, if it is generated so."""
        return (self.surface.seed,) if self.surface is not None and self.surface.random else ()

    def excesses(self) -> Iterator[Conflict]:
        depths = self.grid.depths if self.grid else None
        if self.body.plasticity and depths and (depths[0] != 0 or len(depths) < 2):
            yield "grid.depths", "with plasticity the faces of the layers: two or more, the first 0"
        if self.surface is not None:
            yield from grid_excesses(self.surface, self.grid)
        if self.friction is not None and self.friction.path is not None:
            yield from _other_cells(self.friction.path, self)
        if self.solver.extrapolate:
            yield from _not_extrapolated(self)
        yield from _beyond_shear_strength(self)


def _conflicts_of_smooth(given: Mapping) -> Iterator[Conflict]:
    """What only a rough body makes sense of."""
    if value_at(given, "counterbody.shape") == "flat":
        yield (
            "surface",
            'required: a table [surface], as counterbody.shape = "flat" touches a plane everywhere at once',
        )
    if value_at(given, "grid.border") == "relief":
        yield "grid.border", "only together with [surface]"


def _conflicts_of_rough(given: Mapping) -> Iterator[Conflict]:
    """What a rough body needs, and what it cannot be put together with yet."""
    if value_at(given, "loading.prescribed") is not MISSING_INPUT:
        yield "surface", f'with loading.prescribed = "hertz" {NOT_YET}'
    if value_at(given, "surface.kind") in GENERATED:
        for key in ("grid.cells", "grid.extent"):
            if value_at(given, key) is MISSING_INPUT:
                yield (
                    key,
                    "required: grid.cells and grid.extent, as nothing else says how large the generated surface is",
                )


def _conflicts_of_wear(given: Mapping) -> Iterator[Conflict]:
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
        yield "wear", "only together with [body.plasticity]: plastic strain tears"
    if value_at(given, "loading.unload") is not True:
        yield "loading.unload", "true with [wear]: material is removed after unloading"
    if value_at(given, "wear.strain_limit_layer") is not MISSING_INPUT and (
        value_at(given, "body.plasticity.layer_thickness") is MISSING_INPUT
    ):
        yield "wear.strain_limit_layer", "only together with body.plasticity.layer_thickness"


def _beyond_shear_strength(scene: Scene) -> Iterator[Conflict]:
    """A given traction under which the loaded circle slides off, however far the body hardens: its mean is 2/3 mu p0.

    An upper bound of the limit load, of slip along the surface: at most sigma_y/sqrt(3) times the area is borne.
    """
    plasticity, mu = scene.body.plasticity, scene.coefficient
    if scene.loading.prescribed is None or plasticity is None or scene.body.coating is not None or mu == 0:
        return
    most = (
        float(plasticity.curve().stress(STRAIN.high) * plasticity.depth_profile()(0.0)) / sqrt(3) * 1.5 / mu
    )
    if scene.loading.p0 > most:
        yield (
            "loading.p0",
            f"at most {most:.4g} Pa with friction.coefficient = {mu:g}: the body bears no larger traction",
        )


def _not_extrapolated(scene: Scene) -> Iterator[Conflict]:
    """What cannot be put on half as many cells."""
    if scene.surface is not None or (scene.friction is not None and scene.friction.path is not None):
        yield "solver.extrapolate", "false with [surface] or friction.path: they belong to their grid"
    layers = None
    if scene.grid is not None and scene.body.plasticity is not None:
        layers = len(scene.grid.depths) - 1 if scene.grid.depths else scene.grid.layers
    if layers is not None and (layers % 2 or layers < 4):
        key = "grid.depths" if scene.grid.depths else "grid.layers"
        yield key, "an even number of layers, four or more, with solver.extrapolate"


def _other_cells(found: FrictionMap, scene: Scene) -> Iterator[Conflict]:
    """A grid that is not the one of the friction map."""
    cells, extent = (scene.grid.cells, scene.grid.extent) if scene.grid is not None else (None, None)
    if scene.surface is not None and scene.surface.kind == "file":
        cells, extent = scene.surface.patch(cells)
    if cells != found.cells:
        yield "grid.cells", f"{list(found.cells)}, the grid of friction.path"
    if extent is None or not all(
        isclose(*sides, rel_tol=1e-6) for sides in zip(extent, found.extent, strict=True)
    ):
        yield (
            "grid.extent",
            f"{' and '.join(f'{side:.9g} m' for side in found.extent)}, the grid of friction.path",
        )


def resolved(scene: Scene) -> dict:
    """The scene with every default, numbers in SI, as a mapping that JSON can hold; Scene(**it) is the scene again."""
    return scene.model_dump(mode="json")


def solved_part(content: Mapping) -> dict:
    """What a result depends on, of a resolved scene: all but [compare], which only says how results are judged."""
    return {name: table for name, table in content.items() if name != "compare"}
