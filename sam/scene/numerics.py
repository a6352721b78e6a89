# SPDX-License-Identifier: MIT
"""The tables [solver] and [fem] of a scene: how it is solved, and the mesh of the finite-element models."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal

from sam.scene.compare import Share
from sam.scene.inputs import list_of
from sam.scene.result import QUANTITIES
from sam.scene.section import Conflict, Section
from sam.scene.units import Box, Fraction, MeshCells

ACCURACY = Share("an accuracy", 1e-4, 0.5, example="1 %")
if TYPE_CHECKING:
    QuantityName = str
else:
    QuantityName = Literal[QUANTITIES]


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
    small strains of a flat half-space too; the models know nothing of it.
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
    unwritten: ClassVar[tuple[str, ...]] = ("beyond_model",)

    @classmethod
    def implied(cls, given: Mapping[str, Any]) -> Mapping[str, Any]:
        """What the loop of the paper stops on, unless it is given."""
        return {"stop": "stress"} if given.get("method") == "paper" else {}

    @classmethod
    def conflicts(cls, given: Mapping[str, Any]) -> Iterator[Conflict]:
        """A stop without the loop of the paper; the uncertainty of what is extrapolated."""
        if "stop" in given and given.get("method") != "paper":
            yield "stop", 'only together with method = "paper"'
        if given.get("uncertainty") is True and given.get("extrapolate") is True:
            yield "uncertainty", "false with extrapolate: the change by extrapolation is no uncertainty"
        if "accuracy" in given and given.get("extrapolate") is True:
            yield "accuracy", "not together with extrapolate: the change by extrapolation is no uncertainty"
        if "accuracy_of" in given and "accuracy" not in given:
            yield "accuracy_of", "only together with accuracy"


class Fem(Section):
    """The finite-element mesh. box: outer radius and depth in Hertz radii.

    Of a rough scene box is in half sides of its patch, and the cells of the scene are those of the mesh.
    """

    cells_per_radius: MeshCells = 16
    box: Box = 10.0
