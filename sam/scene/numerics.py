# SPDX-License-Identifier: MIT
"""The tables [grid], [solver], [fem], [wear] and [compare] of a scene: cells, how it is solved, which strain
removes material, and how results are judged.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from itertools import pairwise
from math import isfinite
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal

from pydantic import AfterValidator

from sam.scene.inputs import list_of
from sam.scene.result import QUANTITIES
from sam.scene.section import Conflict, Given, Section, broken
from sam.scene.units import (
    Box,
    Cells,
    Count,
    Depth,
    Fraction,
    Length,
    MeshCells,
    Number,
    Order,
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
