# SPDX-License-Identifier: MIT
"""The tables [grid], [solver], [fem], [wear], [compare] and [loading] of a scene: cells, how it is solved,
which strain removes material, how results are judged; a force, an approach or a given pressure, its steps and
its path, with the passes over it, the schedule that all models share.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import pairwise
from math import ceil, copysign, hypot, isfinite
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal

from pydantic import AfterValidator, ConfigDict, Field

from sam.arrays import ROUNDING
from sam.scene.inputs import list_of
from sam.scene.result import QUANTITIES
from sam.scene.section import Conflict, Given, Section, broken, stated
from sam.scene.units import (
    COUNT,
    Box,
    Cells,
    Coordinate,
    Count,
    Depth,
    Force,
    Fraction,
    Length,
    MeshCells,
    Misfit,
    Number,
    Order,
    PerRadius,
    Pressure,
    Rows,
    SmoothingWindow,
    StrainLimit,
    refused,
)

MOST_DEPTHS = 1001  # entries of a list; the layers of a box cost 36 n^2 coefficients for each wave number
ACCURACY = Number("an accuracy", 1e-4, 0.5, example="1 %", percent=True)
TOLERANCE = Number("tolerance", 1e-12, 10.0, example="2 %", percent=True)
if TYPE_CHECKING:
    QuantityName = str
else:
    QuantityName = Literal[QUANTITIES]


def _ascending(depths: tuple[float, ...]) -> tuple[float, ...]:
    if any(lower >= upper for lower, upper in pairwise(depths)):
        raise refused("depths in strictly ascending order")
    return depths


class Grid(Section):
    """The cells and output depths of the semi-analytical model. cells: (nx, ny); extent: (Lx, Ly) in m.

    Cells alone take the default extent, an extent alone the default number of cells. depths: z in m where
    stresses are returned, with plasticity the faces of the layers, the first at 0; or `layers` equal layers
    down to `depth`. border: of a rough patch; "relief": its heights fall off there, so that the contact ends
    before the patch does. periodic: "xy": cells and heights repeat beside the patch in both directions; "y":
    below a cylinder they repeat along its axis. Below a smooth cylinder there is one cell along y.
    """

    cells: Annotated[tuple[Cells, Rows], list_of(2, 2)] | None = None
    extent: Annotated[tuple[Length, Length], list_of(2, 2)] | None = None
    depths: Annotated[tuple[Depth, ...], AfterValidator(_ascending), list_of(1, MOST_DEPTHS)] | None = None
    layers: Count | None = None
    depth: Length | None = None
    border: Literal["free", "relief"] = "free"
    periodic: Literal["xy", "y"] | None = None
    unwritten: ClassVar[tuple[str, ...]] = ("periodic",)

    @classmethod
    def conflicts(cls, given: Given) -> Iterator[Conflict]:
        """Depths together with layers, or layers without a depth."""
        both, layers, depth = "depths" in given, "layers" in given, "depth" in given
        missing = "depth" if layers else "layers"
        return broken(
            (both and (layers or depth), "depths", "either depths, or layers with depth, not both"),
            (not both and layers != depth, missing, "required: layers and depth together"),
        )


class Solver(Section):
    """tolerance: see the solver. The methods differ in the plastic loop; elastic contact knows only the
    default.

    "paper": the loop of Bosman & Schipper 2011, Fig. 7, as printed, which stops on the change of `stop`
    ("stress" if not given). extrapolate: the semi-analytical model solves on half as many cells too, and
    extrapolates its quantities to none. verdict: say what becomes of the body under repeated loading; with
    back-stresses that is always said. uncertainty: the scene is solved on coarser grids and with other
    numbers of load steps too, for a numerical uncertainty of each quantity; the models know nothing of it.
    accuracy: relative; cells and load steps are chosen so that the uncertainty of the quantities accuracy_of
    (by default the one that advice is given for) is no larger. beyond_model: solve a contact too large for
    small strains of a flat half-space too; the models know nothing of it. operator: of the semi-analytical
    model, the stress of plastic strain by a matrix between all layers for each wave number, or by sweeps over
    them; chosen from sizes if not given.
    """

    method: Literal["backward-euler", "paper"] = "backward-euler"
    stop: Literal["stress", "strain"] | None = None
    tolerance: Fraction = 1e-6
    extrapolate: bool = False
    verdict: bool = False
    uncertainty: bool = False
    accuracy: Annotated[float, ACCURACY] | None = None
    accuracy_of: Annotated[tuple[QuantityName, ...], list_of(1, len(QUANTITIES))] | None = None
    beyond_model: bool = False
    operator: Literal["dense", "swept"] | None = None
    unwritten: ClassVar[tuple[str, ...]] = ("beyond_model", "operator")

    @classmethod
    def implied(cls, given: Given) -> Mapping[str, Any]:
        """What the loop of the paper stops on, unless it is given."""
        return {"stop": "stress"} if given.get("method") == "paper" else {}

    @classmethod
    def conflicts(cls, given: Given) -> Iterator[Conflict]:
        """A stop without the loop of the paper; the uncertainty of what is extrapolated."""
        none, more = "the change by extrapolation is no uncertainty", given.get("extrapolate") is True
        stops = "stop" in given and given.get("method") != "paper"
        uncertain, accurate = given.get("uncertainty") is True, "accuracy" in given
        alone = "accuracy_of" in given and not accurate
        return broken(
            (stops, "stop", 'only together with method = "paper"'),
            (uncertain and more, "uncertainty", f"false with extrapolate: {none}"),
            (accurate and more, "accuracy", f"not together with extrapolate: {none}"),
            (alone, "accuracy_of", "only together with accuracy"),
        )


class Fem(Section):
    """The finite-element mesh. box: outer radius and depth in Hertz radii.

    Of a rough scene box is in half sides of its patch, and the cells of the scene are those of the mesh.
    """

    cells_per_radius: MeshCells = 16
    box: Box = 10.0


class Wear(Section):
    """Wear removes material after each cycle where its plastic strain, from the surface downwards, is above a
    limit.

    strain_limit: accumulated plastic strain beyond which it is removed (inf: never); strain_limit_layer:
    another one inside of body.plasticity.layer_thickness. smoothing_window: odd number of cells of a
    Savitzky-Golay filter of the worn depth, 0: none; smoothing_order: of its polynomials. interpolate: depths
    between the layers by linear interpolation of the strain; else whole layers are removed. roof: whether
    sound material above material beyond its limit stays, or goes with it. smoothing_fills: the filter may
    leave, or raise, what is removed, as its printed form does. Bosman & Schipper 2011, sections 1 and 5.
    """

    strain_limit: StrainLimit
    strain_limit_layer: StrainLimit | None = None
    smoothing_window: SmoothingWindow = 5
    smoothing_order: Order = 2
    interpolate: bool = True
    roof: Literal["stays", "falls"] = "stays"
    smoothing_fills: bool = False
    unwritten: ClassVar[tuple[str, ...]] = ("roof", "smoothing_fills")

    @property
    def removes(self) -> bool:
        """Whether any strain removes material."""
        limits = self.strain_limit, self.strain_limit_layer
        return any(limit is not None and isfinite(limit) for limit in limits)

    @classmethod
    def conflicts(cls, given: Given) -> Iterator[Conflict]:
        """A smoothing window without a middle."""
        window = given.get("smoothing_window")
        even = isinstance(window, int) and window > 0 and window % 2 == 0
        fills = given.get("smoothing_fills") is True and window == 0
        return broken(
            (even, "smoothing_window", "an odd number of cells, or 0 for none"),
            (fills, "smoothing_fills", "false with smoothing_window = 0: nothing is smoothed"),
        )

    def excesses(self) -> Iterator[Conflict]:
        """A polynomial that the window does not determine."""
        window, words = self.smoothing_window, f"less than smoothing_window, {self.smoothing_window}"
        return broken((window and not self.smoothing_order < window, "smoothing_order", words))


class Compare(Section):
    """claim "negligible-film": a comparison fails if the film changes pressure or stress of the body by more
    than its limit; tolerances: row of a comparison -> its tolerance, in place of that of samfem.
    """

    claim: Literal["negligible-film"] | None = None
    tolerances: dict[str, Annotated[float, TOLERANCE]] | None = None


Place = Annotated[tuple[Coordinate, Coordinate], list_of(2, 2)]
"""(x, y) on the surface in m."""
TO_AND_FRO = "to-and-fro"
HERTZ, MISFIT_SPHERE = "hertz", "misfit-sphere"


@dataclass(frozen=True)
class Prescribed:
    """A load in place of a force: keys that it needs, may have (with defaults), both in words."""

    needed: tuple[str, ...]
    further: Mapping[str, str | None]
    words: str

    @property
    def keys(self) -> tuple[str, ...]:
        """All keys of it."""
        return *self.needed, *self.further


PRESCRIBED = {
    HERTZ: Prescribed(("p0", "radius"), {"path": None}, 'prescribed = "hertz" with p0 and radius'),
    MISFIT_SPHERE: Prescribed(
        ("depth", "radius", "misfit"),
        {"profile": "smooth", "surface": "free"},
        'prescribed = "misfit-sphere" with depth, radius and misfit',
    ),
}
"""Loads that a scene may give in place of a force, by their names."""
DEEPER = {"smooth": 1.0, "ball": 1.0, "gauss": 3.0}
"""Profiles of a misfit sphere, and the depth of its centre over its radius, which it has to exceed."""
if TYPE_CHECKING:
    PrescribedName = str
    ProfileName = str
else:
    PrescribedName, ProfileName = Literal[tuple(PRESCRIBED)], Literal[tuple(DEEPER)]


class Path(Section):
    """The way of the load over the surface, from start to end in equal steps at full size; a cycle is one
    pass over it.

    Either `steps` of them, or `step_per_radius` in each contact radius of Hertz, see
    `sam.scene.schema.contact_radius`. return "lifted": in every cycle the load is put on at start and taken
    off at end; "to-and-fro": odd cycles go forth and even ones back, and the load stays on between them
    unless the body wears.
    """

    model_config = ConfigDict(serialize_by_alias=True)
    start: Place
    end: Place
    steps: Count | None = None
    step_per_radius: PerRadius | None = None
    return_: Literal["lifted", "to-and-fro"] = Field("lifted", alias="return")

    @classmethod
    def conflicts(cls, given: Given) -> Iterator[Conflict]:
        """Neither a number of steps nor their size, or both."""
        number, size = "steps" in given, "step_per_radius" in given
        required = f"required: steps, {COUNT.allowed(True)}, or step_per_radius"
        return broken(
            (not (number or size), "steps", required),
            (number and size, "step_per_radius", "either steps or step_per_radius, not both"),
        )

    def excesses(self) -> Iterator[Conflict]:
        """A path without length."""
        return broken((self.start == self.end, "end", "another place than start"))

    @property
    def to_and_fro(self) -> bool:
        """Whether even cycles go back."""
        return self.return_ == TO_AND_FRO

    @property
    def length(self) -> float:
        """From start to end in m."""
        return hypot(self.end[0] - self.start[0], self.end[1] - self.start[1])

    def count(self, radius: float) -> int:
        """Steps from start to end; radius: of the contact in m, for a path that gives their size."""
        if self.steps is not None:
            return self.steps
        return max(1, ceil(self.length * stated(self.step_per_radius) / radius - ROUNDING))


@dataclass(frozen=True)
class Pass:
    """What the load does in one cycle.

    places: (x, y) in m at full size, in their order, the first where the cycle begins; pressed: whether it is
    put on there in `loading.steps` steps, else it is on; unloads: whether it is taken off at the last place;
    sign: of the traction on the body along x.
    """

    places: tuple[tuple[float, float], ...]
    pressed: bool = True
    unloads: bool = True
    sign: float = 1.0


@dataclass(frozen=True)
class Strokes:
    """The passes of a scene.

    path: None without; count: steps along it; cycles: how many passes; unload: whether the last one ends
    unloaded; alternates: whether the sign of the traction changes from cycle to cycle; with_motion: whether
    the traction is along the motion, as of a counter-body that slides; in_passes: whether the load is taken
    off at the end of every pass, as for wear.
    """

    path: Path | None
    count: int
    cycles: int
    unload: bool
    alternates: bool = False
    with_motion: bool = False
    in_passes: bool = False

    def places(self) -> tuple[tuple[float, float], ...]:
        """Places of the load on its way forth, the start first; the origin alone without path."""
        if self.path is None:
            return ((0.0, 0.0),)
        (x0, y0), (x1, y1) = self.path.start, self.path.end
        shares = [k / self.count for k in range(self.count + 1)]
        return tuple((x0 + share * (x1 - x0), y0 + share * (y1 - y0)) for share in shares)

    def goes_back(self, cycle: int) -> bool:
        """Whether the pass of a cycle, counted from 1, begins at the end of the path."""
        return cycle % 2 == 0 and self.with_motion and self.path is not None and self.path.to_and_fro

    def of_cycle(self, cycle: int) -> Pass:
        """The pass of a cycle, counted from 1."""
        places, last, even = self.places(), cycle == self.cycles, cycle % 2 == 0
        unloads = self.unload if last else True
        if self.path is None or not self.with_motion:
            return Pass(places, unloads=unloads, sign=-1.0 if self.alternates and even else 1.0)
        back, stays = self.goes_back(cycle), self.path.to_and_fro and not self.in_passes
        along_x = (self.path.end[0] - self.path.start[0]) * (-1.0 if back else 1.0)
        return Pass(
            places[::-1] if back else places,
            pressed=cycle == 1 or not stays,
            unloads=unloads and (last or not stays),
            sign=copysign(1.0, along_x),
        )


class Loading(Section):
    """`steps` equal steps to the peak, and back to zero in `unload_steps` when `unload`; so in every one of
    the cycles.

    The load is a normal force in N, by which a counter-body is pressed on, or in its place the approach of
    the bodies in m, whose force is then a result, or on a periodic patch the mean_pressure in Pa; or with
    prescribed = "hertz" the pressure itself: at step k (k/steps) p0 sqrt(1 - r^2/radius^2), p0 in Pa, radius
    in m the same in all steps. Each of these may travel on a path at full size; a cycle is then one pass.

    With prescribed = "misfit-sphere" nothing touches the body: material about
    a centre at `depth` would grow by a linear strain in all directions if it were free, at step k (k/steps)
    misfit f(r/radius), r the distance from the centre, f = (1 - x^2)^2 inside x = 1 ("smooth"), 1 inside it
    ("ball") or exp(-x^2) ("gauss"). surface: "free", or "held" by the tractions of the infinite body.

    lateral: of a periodic patch of a body that yields; the mean strain along x and y grows with the plastic
    strain so that no mean stress remains ("free"), or is held at zero ("held", if not given).
    """

    force: Force | None = None
    approach: Length | None = None
    prescribed: PrescribedName | None = None
    p0: Pressure | None = None
    radius: Length | None = None
    depth: Length | None = None
    misfit: Misfit | None = None
    profile: ProfileName | None = None
    surface: Literal["free", "held"] | None = None
    path: Path | None = None
    steps: Count = 1
    unload: bool = False
    unload_steps: Count | None = None
    cycles: Count = 1
    mean_pressure: Pressure | None = None
    lateral: Literal["free", "held"] | None = None
    unwritten: ClassVar[tuple[str, ...]] = ("mean_pressure", "lateral")

    @property
    def hertz(self) -> bool:
        """Whether the pressure is given."""
        return self.prescribed == HERTZ

    @property
    def misfit_sphere(self) -> bool:
        """Whether a misfit strain inside the body is the load."""
        return self.prescribed == MISFIT_SPHERE

    @classmethod
    def implied(cls, given: Given) -> Mapping[str, Any]:
        """The defaults of the load that is given in place of a force."""
        load = PRESCRIBED.get(given.text("prescribed"))
        further = {} if load is None else load.further
        return {key: value for key, value in further.items() if value is not None}

    @classmethod
    def conflicts(cls, given: Given) -> Iterator[Conflict]:
        """No load or more than one; keys without the one that they need."""
        named, load = "prescribed" in given, PRESCRIBED.get(given.text("prescribed"))
        pressed = [key for key in ("force", "approach", "mean_pressure") if key in given]
        if not named or load is not None:
            taken = ("path",) if load is None else load.keys
            for key in dict.fromkeys(key for other in PRESCRIBED.values() for key in other.keys):
                if key in given and key not in taken:
                    yield key, _only_with(key)
        if load is not None:
            yield from ((key, f"required: {load.words}") for key in load.needed if key not in given)
            yield from ((key, f"either {key}, or {load.words}, not both") for key in pressed)
        required = f"required: force, approach, or {PRESCRIBED[HERTZ].words}"
        yield from broken(
            (
                not named and len(pressed) > 1,
                pressed[-1] if pressed else "",
                f"either {' or '.join(pressed)}, not both",
            ),
            (not (named or pressed), "force", required),
        )
        if "unload_steps" in given and given.get("unload", False) is False:
            yield "unload_steps", "only together with unload = true"

    def excesses(self) -> Iterator[Conflict]:
        """A misfit sphere that reaches the surface."""
        if self.misfit_sphere:
            least = DEEPER[stated(self.profile)]
            if stated(self.depth) <= least * stated(self.radius):
                words = "the radius" if least == 1.0 else f'{least:g} times the radius with profile = "gauss"'
                yield "depth", f"more than {words}, {least * stated(self.radius):g} m"


def _only_with(key: str) -> str:
    """Of what a key is a part."""
    needed = [load.words for load in PRESCRIBED.values() if key in load.needed]
    if needed:
        return f"only as part of {', or of '.join(needed)}"
    named = [f'prescribed = "{name}"' for name, load in PRESCRIBED.items() if key in load.further]
    return f"only together with {' or '.join(named)}"
