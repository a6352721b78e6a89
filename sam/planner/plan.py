# SPDX-License-Identifier: MIT
"""The plan of a solve: all that is known before it begins. It is made once; the solver executes it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np

from sam.arrays import Array
from sam.contact.convolution import Counters
from sam.contact.normal import Contact
from sam.contact.stress import DEPTHS_AT_ONCE
from sam.elastic.problem import (
    CoatedSurfaces,
    ElasticProblem,
    GivenHertz,
    Looked,
    MisfitLoad,
    contact_tolerance,
)
from sam.elastic.stress import depths_at_once
from sam.grid.cells import CellGrid, Room, Sides
from sam.grid.gap import InitialGap, Place, Shape
from sam.half_space import ElasticPair
from sam.results.snapshots import Snapshot
from sam.results.tables import Remedies
from sam.scene import LeftOut, Plasticity, Solver, Stage
from sam.scene.result import left_out_of
from sam.scene.surface import Roughness
from sam.scene.verdict import Judging
from sam.schedule import FullSlip, Schedule
from sam.surface_state import Tribofilm, Wear

if TYPE_CHECKING:
    from sam.moving import Track


class Demand(Protocol):
    """What the grid of a smooth scene is chosen from; see `sam.grid.smooth` and `sam.grid.smooth`."""

    def grid(self, room: Room) -> CellGrid:
        """The grid, larger by the factors of a room than the one chosen first."""


class RoughSurface(Protocol):
    """The heights of rough bodies, and what they add to the record; see `sam.results.rough.RoughRecord`."""

    @property
    def heights(self) -> Array:
        """Heights of the body before the first load, (nx, ny) in m."""

    @property
    def opposite(self) -> Callable[[int, Place], Array] | None:
        """Heights of a stretch of the counter-body at a place, (nx, ny) in m; None if it is smooth."""

    def roughness(self, lowered: Array | float = 0.0) -> Roughness:
        """Roughness of the surface lowered by wear and plastic strain, (nx, ny) in m."""

    def discretisation(self) -> dict[str, object]:
        """Entries of the discretisation."""

    def table(self, grid: CellGrid, snapshots: Sequence[Snapshot]) -> dict[str, Any]:
        """The table surface."""

    def warnings(self, grid: CellGrid, contact: Contact) -> tuple[str, ...]:
        """What a user should know about the peak, in words."""


@dataclass(frozen=True)
class Plan:
    """All that the solution of a scene needs.

    Parameters
    ----------
    grid : CellGrid
        Cells and depths, in m.
    pair : ElasticPair
        Elastic constants of both bodies.
    shape : Shape
        Shape of the counter-body, which makes the gap.
    axes : tuple of float
        Contact semi-axes (along x, along y) in m by Hertz, for the body without coating.
    schedule : Schedule
        The load steps.
    slip : FullSlip
        Friction.
    looked : Looked
        Where the largest stress and the contact may be.
    solver : Solver
        Tolerance and method.
    remedies : Remedies
        What may be changed of the scene, in words.
    given_sides : Sides
        Sides of the grid that the scene gives, which are not enlarged.
    demand : Demand
        What the grid and a larger one are chosen from.
    given : GivenHertz or None
        A pressure in place of the counter-body.
    misfit : MisfitLoad or None
        A misfit strain in place of the counter-body.
    track : Track or None
        Of a counter-body that moves; None of one in place.
    coated : CoatedSurfaces or None
        Both bodies with a coating.
    rough : RoughSurface or None
        The heights of the body and of the counter-body; None if both are smooth.
    plasticity : Plasticity or None
        Yield curve and profile over depth; None for an elastic body.
    tribofilm, wear : callable or None
        Grid -> law of the tribofilm, and law of wear, on its cells.
    paper : callable or None
        Loads the loops of the paper; None for backward Euler.
    with_back : callable or None
        Loads what makes a material with back-stresses; None without them.
    judging : Judging or None
        How repeated loading is judged; None without a verdict.
    dissipates : bool
        Whether the energy that each cycle dissipates is asked for.
    coarser : Plan or None
        The plan on half as many cells, from which quantities are extrapolated.
    stages : tuple of Stage
        Stages that run, in the order in which they begin, with their sizes; then those that do not, and why.
    """

    grid: CellGrid
    pair: ElasticPair
    shape: Shape
    axes: tuple[float, float]
    schedule: Schedule
    slip: FullSlip
    looked: Looked
    solver: Solver
    remedies: Remedies
    given_sides: Sides
    demand: Demand
    given: GivenHertz | None = None
    misfit: MisfitLoad | None = None
    track: Track | None = None
    coated: CoatedSurfaces | None = None
    rough: RoughSurface | None = None
    plasticity: Plasticity | None = None
    tribofilm: Callable[[CellGrid], Tribofilm] | None = None
    wear: Callable[[CellGrid], Wear] | None = None
    paper: Callable[[], Callable[..., Any]] | None = None
    with_back: Callable[[], Callable[..., Any]] | None = None
    judging: Judging | None = None
    dissipates: bool = False
    coarser: Plan | None = None
    stages: tuple[Stage, ...] = ()

    @property
    def left_out(self) -> list[LeftOut]:
        """The stages that the scene does not need, with reasons."""
        return left_out_of(self.stages)

    @property
    def unloads(self) -> bool:
        """Whether the history ends unloaded."""
        return self.schedule.unloads

    @property
    def steps(self) -> int:
        """Load steps of a cycle, those along a path included; none without load."""
        return 0 if self.schedule.peak.rests else self.schedule.rises

    @property
    def unload_steps(self) -> int:
        """Steps in which a body is unloaded that yields in it; none without load."""
        return 0 if self.schedule.peak.rests else self.schedule.unload_steps

    @property
    def held_depths(self) -> tuple[int, int]:
        """Output depths that are in memory at the same time: with their coefficients, with their stresses.

        Of a rough body the stresses are taken in blocks of depths, and the coefficients with them.
        """
        depths = len(self.grid.depths)
        together = min(depths, depths_at_once(self.grid)) if self.looked.anywhere else depths
        return min(depths, DEPTHS_AT_ONCE, together), together

    @property
    def initial_yield(self) -> Array:
        """Yield stress of unstrained material at the depths of the grid, (nz,) in Pa; infinite of an elastic
        body.
        """
        if self.plasticity is None:
            return np.full(len(self.grid.depths), np.inf)
        return self.plasticity.strength().stress(self.grid.depths, np.zeros(1))

    def on(self, room: Room) -> Plan:
        """The same plan on a grid with another room, of cells of the same size."""
        if room == self.grid.room:
            return self
        return replace(self, grid=self.demand.grid(room))

    def problem(self, counters: Counters) -> ElasticProblem:
        """The elastic bodies on the grid; counters: where the work is counted."""
        return ElasticProblem(
            grid=self.grid,
            pair=self.pair,
            gap=self._gap(),
            slip=self.slip,
            looked=self.looked,
            tolerance=contact_tolerance(self.solver.tolerance),
            counters=counters,
            given=self.given,
            misfit=self.misfit,
            coated=self.coated,
        )

    def _gap(self) -> InitialGap:
        """The gap before the first load."""
        if self.rough is None:
            return InitialGap(self.shape, self.grid)
        start = None if self.track is None else self.track.start
        return InitialGap(self.shape, self.grid, self.rough.heights, self.rough.opposite, start)
