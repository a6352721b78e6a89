# SPDX-License-Identifier: MIT
"""The elastic bodies on a grid, the contact of them under a load, and the state that it makes.

A pressure that a scene gives in place of a counter-body.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import pi
from typing import Protocol

import numpy as np

from sam.arrays import Array
from sam.contact.convolution import Counters
from sam.contact.normal import Contact, Search, around, no_contact, solve_contact
from sam.contact.operators import HALF_SPACES, CoatedBody, HalfSpaces, SurfaceOperators
from sam.grid.cells import CellGrid, Window
from sam.grid.gap import InitialGap
from sam.half_space import ElasticPair
from sam.schedule import Coefficient, FullSlip, Load

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
        """The mean over each cell of a window (None: of the grid), centred at the place of the load, (nx, ny)
        in Pa.
        """
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
        """The state under the pressure: nothing is opposite, so gap and approach are not numbers.

        pressure in Pa, displacement in m, (nx, ny); load_error: of the means over the cells against the
        force.
        """
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
