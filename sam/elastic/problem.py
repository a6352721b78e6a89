# SPDX-License-Identifier: MIT
"""The plan of a solve, the elastic bodies on its grid, their contact under a load and the state it makes."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from math import pi

import numpy as np

from sam.arrays import Array
from sam.contact.convolution import Counters
from sam.contact.normal import Contact, Search, around, no_contact, solve_contact
from sam.contact.operators import HALF_SPACES, LINE, CoatedPair, HalfSpaces, SurfaceOperators
from sam.contact.periodic import PeriodicHalfSpaces
from sam.contact.stress import DEPTHS_AT_ONCE
from sam.elastic.misfit import MisfitSphere
from sam.grid.cells import CellGrid, Room, Sides, Window
from sam.grid.gap import InitialGap, Shape
from sam.grid.rough import RoughDemand, RoughPatch
from sam.grid.smooth import GridDemand, MisfitDemand
from sam.half_space import ElasticPair
from sam.moving import Track
from sam.results.tables import Remedies
from sam.scene import LeftOut, Plasticity, Solver, Stage
from sam.scene.result import left_out_of
from sam.scene.verdict import Judging
from sam.schedule import Coefficient, FullSlip, Load, Schedule
from sam.tribofilm.state import FilmOnCells
from sam.wear import WearLaw

BYTES_AT_ONCE = 2e8  # of the spectra of a block of depths, which bounds the memory

PARTS = 8  # of a cell each way for its mean: the force errs by 1.5e-4 on 8 cells in a, 2e-6 on 16


@dataclass(frozen=True)
class GivenHertz:
    """p0 sqrt(1 - r^2/a^2) at the peak force, in proportion to the force. p0 in Pa, radius a in m."""

    p0: float
    radius: float

    @property
    def peak_force(self) -> float:
        """Force of the pressure in N, 2/3 pi p0 a^2."""
        return 2 / 3 * pi * self.p0 * self.radius**2

    def pressure(self, grid: CellGrid, load: Load, window: Window | None = None) -> Array:
        """The mean over each cell of a window or of the grid, about the place of the load, (nx, ny) in Pa."""
        i, j = (grid.whole if window is None else window).slices
        return self._mean((grid.x[i], grid.y[j]), (grid.hx, grid.hy), load)

    def _mean(self, centres: tuple[Array, Array], cell: tuple[float, float], load: Load) -> Array:
        (x, y), a = centres, self.radius
        out, part = np.zeros((x.size, y.size)), (np.arange(PARTS) + 0.5) / PARTS - 0.5
        places = load.x, load.y
        i, j = (np.flatnonzero(np.abs(c - o) < a + h) for c, o, h in zip(centres, places, cell, strict=True))
        if load.force == 0 or not (i.size and j.size):
            return out
        fine_x, fine_y = (
            ((c[k, None] - o + h * part) / a).ravel()
            for c, k, o, h in zip(centres, (i, j), places, cell, strict=True)
        )
        p = np.sqrt(np.maximum(1.0 - fine_x[:, None] ** 2 - fine_y[None, :] ** 2, 0.0))
        p = p.reshape(i.size, PARTS, j.size, PARTS).mean(axis=(1, 3))
        out[np.ix_(i, j)] = self.p0 * (load.force / self.peak_force) * p
        return out

    def contact(self, grid: CellGrid, load: Load, pressure: Array, displacement: Array) -> Contact:
        """The state under the pressure, whose gap and approach are no numbers; fields (nx, ny) in Pa, m."""
        error = abs(float(pressure.sum()) * (grid.hx * grid.hy) - load.force) / load.force
        nothing = np.full_like(pressure, np.nan)
        area = pi * self.radius**2
        return Contact(
            pressure=pressure,
            displacement=displacement,
            gap=nothing,
            approach=np.nan,
            force=load.force,
            box=around(pressure > 0),
            gap_residual=0.0,
            penetration=0.0,
            tension=0.0,
            load_error=error,
            iterations=0,
            converged=True,
            area=area,
        )


CONTACT_SHARE = 1e-4  # of solver.tolerance, to which the contact is solved
REACHED = 1e-12  # residuals that rounding allows on grids of usual size (2e-13 on 513 x 513 cells)


def contact_tolerance(asked: float) -> float:
    """Tolerance of the contact: a share of what is asked, and no less than rounding allows."""
    return max(CONTACT_SHARE * asked, min(asked, REACHED))


Demand = GridDemand | MisfitDemand | RoughDemand
"""What the grid is chosen from."""


@dataclass(frozen=True)
class Places:
    """Where the largest stress and the contact may be: all of a patch, beside y = 0, off the origin."""

    anywhere: bool = False
    beside: bool = False
    off_origin: bool = False


@dataclass(frozen=True)
class Plan:
    """All that the solution of a scene needs; it is made once, and handed on. grid: cells and depths, in m;
    pair: elastic constants of both bodies; shape: of the counter-body, which makes the gap; axes: contact
    semi-axes (along x, along y) in m by Hertz, without coating; schedule: the load steps; slip: friction;
    places: where the largest stress and the contact may be; solver: tolerance and method; remedies: what may
    be changed of the scene, in words; given_sides: of the grid, which are not enlarged; demand: what a grid
    is chosen from; given, misfit: a pressure, or a misfit strain, in place of the counter-body; track: of a
    counter-body that moves; coated: both bodies with a coating; rough: heights of the bodies; plasticity:
    yield curve and profile over depth; tribofilm, wear: the laws; judging: how repeated loading is judged;
    dissipates: whether the energy that each cycle dissipates is asked for; coarser: the plan on half as many
    cells, from which quantities are extrapolated; period: both bodies where all repeats; stages: those that
    run, in the order in which they begin, with their sizes, then those that do not, and why. None of what a
    scene has not.
    """

    grid: CellGrid
    pair: ElasticPair
    shape: Shape
    axes: tuple[float, float]
    schedule: Schedule
    slip: FullSlip
    places: Places
    solver: Solver
    remedies: Remedies
    given_sides: Sides
    demand: Demand
    given: GivenHertz | None = None
    misfit: MisfitSphere | None = None
    track: Track | None = None
    coated: CoatedPair | None = None
    rough: RoughPatch | None = None
    plasticity: Plasticity | None = None
    tribofilm: FilmOnCells | None = None
    wear: WearLaw | None = None
    judging: Judging | None = None
    dissipates: bool = False
    coarser: Plan | None = None
    period: PeriodicHalfSpaces | None = None
    stages: tuple[Stage, ...] = ()

    @property
    def left_out(self) -> list[LeftOut]:
        """The stages that the scene does not need, with reasons."""
        return left_out_of(self.stages)

    @property
    def bodies(self) -> HalfSpaces:
        """Both bodies, as the contact asks for them."""
        if self.coated is not None:
            return self.coated.bodies(self.grid)
        if self.grid.line:
            return LINE
        return HALF_SPACES if self.period is None else self.period

    @property
    def unloads(self) -> bool:
        """Whether the history ends unloaded."""
        return self.schedule.unloads

    @property
    def paper(self) -> bool:
        """Whether load steps are made by the loops of the paper, in place of backward Euler."""
        return self.solver.method == "paper"

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
        """Output depths in memory together, with coefficients, with stresses: of a rough body in blocks."""
        depths = len(self.grid.depths)
        together = min(depths, depths_at_once(self.grid)) if self.places.anywhere else depths
        return min(depths, DEPTHS_AT_ONCE, together), together

    @property
    def initial_yield(self) -> Array:
        """Yield stress of unstrained material at the depths of the grid, (nz,) in Pa; infinite if elastic."""
        if self.plasticity is None:
            return np.full(len(self.grid.depths), np.inf)
        return self.plasticity.strength().stress(self.grid.depths, np.zeros(1))

    def on(self, room: Room) -> Plan:
        """The same plan on a grid with another room, of cells of the same size."""
        if room == self.grid.room:
            return self
        grid, film, wear = self.demand.grid(room), self.tribofilm, self.wear
        film, wear = film and replace(film, shape=grid.shape), wear and replace(wear, shape=grid.shape)
        return replace(self, grid=grid, tribofilm=film, wear=wear)

    def problem(self, counters: Counters) -> ElasticProblem:
        """The elastic bodies on the grid; counters: where the work is counted."""
        return ElasticProblem(self, counters)


def depths_at_once(grid: CellGrid) -> int:
    """How many depths a block has: six spectra each, of complex numbers on a grid twice as long each way."""
    return int(max(1, BYTES_AT_ONCE // (6 * 16 * 2 * grid.nx * (grid.ny + 1))))


@dataclass(frozen=True)
class ElasticProblem:
    """The elastic bodies of a plan on its grid; counters: where the work is counted."""

    plan: Plan
    counters: Counters

    @cached_property
    def gap(self) -> InitialGap:
        """The gap before the first load."""
        plan = self.plan
        if plan.rough is None:
            return InitialGap(plan.shape, plan.grid)
        start = None if plan.track is None else plan.track.start
        return InitialGap(plan.shape, plan.grid, plan.rough.of_body, plan.rough.opposite, start)

    def bare(self) -> ElasticProblem:
        """The same with the material of the body up to its surface."""
        plan = self.plan
        coupling = plan.pair.tangential_mismatch if plan.slip.coupled else 0.0
        return replace(self, plan=replace(plan, coated=None, slip=replace(plan.slip, coupling=coupling)))

    def contact(
        self, load: Load, coefficient: Coefficient | None = None, start: Array | None = None
    ) -> Contact:
        """Contact under a load or a given pressure; start: pressure of the step before, in Pa."""
        plan, grid, gap = self.plan, self.plan.grid, self.gap(load)
        slip, modulus = plan.slip, plan.pair.contact_modulus
        if load.force == 0:
            return self.untouched(load, gap)
        mu = slip.coefficient if coefficient is None else coefficient
        coupling = load.sign * (slip.coupling * mu)
        bodies = plan.bodies
        if plan.given is not None:
            operators = SurfaceOperators(
                grid.shape, grid.hy / grid.hx, self.counters, coupling=coupling, bodies=bodies
            )
            pressure = plan.given.pressure(grid, load)
            u = operators.displacement(pressure * (2 / modulus), operators.whole, operators.whole) * grid.hx
            return plan.given.contact(grid, load, pressure, u)
        search = Search(contact_tolerance(plan.solver.tolerance), start, counters=self.counters)
        return solve_contact(
            gap, (grid.hx, grid.hy), modulus, load.given, coupling=coupling, bodies=bodies, search=search
        )

    def untouched(self, load: Load, gap: Array) -> Contact:
        """The state without force, over a gap (nx, ny) in m; a misfit strain moves the surface."""
        contact = no_contact(gap, load.given)
        if self.plan.misfit is None or not load.misfit:
            return contact
        return replace(contact, displacement=load.misfit * self.plan.misfit.moved_surface(self.plan.grid))

    def state(self, load: Load, contact: Contact, coefficient: Coefficient | None = None) -> Loaded:
        """The state of a solved contact."""
        load = load.found(contact.force)
        return Loaded(self, load, contact, self.plan.slip.coefficient if coefficient is None else coefficient)


@dataclass(frozen=True)
class Loaded:
    """The elastic bodies under a load. coefficient: of friction, with which the contact was solved."""

    problem: ElasticProblem
    load: Load
    contact: Contact
    coefficient: Coefficient

    @property
    def traction(self) -> Array | None:
        """q_x on the body, (nx, ny) in Pa; None without friction."""
        if not self.problem.plan.slip.slides:
            return None
        return self.load.sign * self.coefficient * self.contact.pressure
