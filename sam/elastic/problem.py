# SPDX-License-Identifier: MIT
"""The elastic bodies on a grid, the contact of them under a load, and the state that it makes."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Protocol

from sam.arrays import Array
from sam.contact.bodies import HALF_SPACES, CoatedBody, HalfSpaces
from sam.contact.convolution import Counters
from sam.contact.normal import Contact, Search, no_contact, solve_contact
from sam.contact.operators import SurfaceOperators
from sam.elastic.given import GivenHertz
from sam.grid.cells import CellGrid, Window
from sam.grid.gap import InitialGap
from sam.half_space import ElasticPair
from sam.schedule import Load
from sam.slip import Coefficient, FullSlip

CONTACT_SHARE = 1e-4  # of solver.tolerance, to which the contact is solved
REACHED = 1e-12  # residuals that rounding allows on grids of usual size (2e-13 on 513 x 513 cells)


def contact_tolerance(asked: float) -> float:
    """Tolerance of the contact: a share of what is asked, and no less than rounding allows."""
    return max(CONTACT_SHARE * asked, min(asked, REACHED))


class CoatedSurfaces(Protocol):
    """What a coating adds to the elastic bodies; see `sam.elastic.coated.CoatedPair`."""

    @property
    def thickness(self) -> float:
        """Thickness of the coating in m."""

    @property
    def layered(self) -> CoatedBody:
        """Coefficients of the coated body."""

    def bodies(self, grid: CellGrid) -> HalfSpaces:
        """Both bodies, in the units of the contact on a grid."""

    def counter_uz(
        self, grid: CellGrid, pressure: Array, traction: Array | None, counters: Counters
    ) -> Array:
        """Displacement of the counter-body's surface away from the body, (nx, rows) in m, in the rows at y =
        0.
        """


class MisfitLoad(Protocol):
    """A load inside the body: a misfit strain, such as a thermal one, and what it makes of an elastic body at
    its full size; see `sam.elastic.misfit.MisfitSphere`.
    """

    def stress(self, x: Array, y: Array, z: Array) -> Array:
        """Stress at points in m, (6, ...) in Pa."""

    def mean_stress(self, grid: CellGrid, window: Window, faces: Array) -> Array:
        """Means over the cells of a window and the layers between some faces in m, (6, nz, nx, ny) in Pa."""

    def moved_surface(self, grid: CellGrid) -> Array:
        """u_z of the surface at the centres of the cells, (nx, ny) in m."""


@dataclass(frozen=True)
class Looked:
    """Where the largest stress and the contact may be.

    anywhere: below all of a rough patch; beside: below the row of the largest pressure, as a load on a smooth
    body ends beside y = 0; off_origin: the contact at the peak may be elsewhere than around the origin.
    """

    anywhere: bool = False
    beside: bool = False
    off_origin: bool = False


@dataclass(frozen=True)
class ElasticProblem:
    """The elastic bodies on a grid, and all else that stays the same over the load steps.

    tolerance: on the residuals of the contact; given: a pressure in place of the counter-body; misfit: a load
    inside the body; coated: None without coating.
    """

    grid: CellGrid
    pair: ElasticPair
    gap: InitialGap
    slip: FullSlip
    looked: Looked
    tolerance: float
    counters: Counters
    given: GivenHertz | None = None
    misfit: MisfitLoad | None = None
    coated: CoatedSurfaces | None = None

    def bare(self) -> ElasticProblem:
        """The same with the material of the body up to its surface."""
        coupling = self.pair.tangential_mismatch if self.slip.coupled else 0.0
        return replace(self, coated=None, slip=replace(self.slip, coupling=coupling))

    def contact(
        self, load: Load, coefficient: Coefficient | None = None, start: Array | None = None
    ) -> Contact:
        """Contact of the bodies under a load, or under the pressure that is given.

        coefficient: of friction, if it is not that of the slip; start: pressure of the step before, in Pa.
        """
        grid, gap, modulus = self.grid, self.gap(load), self.pair.contact_modulus
        if load.force == 0:
            return self.untouched(load, gap)
        mu = self.slip.coefficient if coefficient is None else coefficient
        coupling = load.sign * (self.slip.coupling * mu)
        bodies = HALF_SPACES if self.coated is None else self.coated.bodies(grid)
        if self.given is not None:
            operators = SurfaceOperators(
                grid.shape, grid.hy / grid.hx, self.counters, coupling=coupling, bodies=bodies
            )
            pressure = self.given.pressure(grid, load)
            u = operators.displacement(pressure * (2 / modulus), operators.whole, operators.whole) * grid.hx
            return self.given.contact(grid, load, pressure, u)
        search = Search(self.tolerance, start, counters=self.counters)
        return solve_contact(
            gap, (grid.hx, grid.hy), modulus, load.given, coupling=coupling, bodies=bodies, search=search
        )

    def untouched(self, load: Load, gap: Array) -> Contact:
        """The state without force, over a gap (nx, ny) in m; a misfit strain moves the surface."""
        found = no_contact(gap, load.given)
        if self.misfit is None or not load.misfit:
            return found
        return replace(found, displacement=load.misfit * self.misfit.moved_surface(self.grid))

    def state(self, load: Load, contact: Contact, coefficient: Coefficient | None = None) -> Loaded:
        """The state of a solved contact."""
        load = load.found(contact.force)
        return Loaded(self, load, contact, self.slip.coefficient if coefficient is None else coefficient)


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
        if not self.problem.slip.slides:
            return None
        return self.load.sign * self.coefficient * self.contact.pressure
