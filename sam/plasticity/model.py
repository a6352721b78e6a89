# SPDX-License-Identifier: MIT
"""What stays the same over the load history of a body that yields, and the problem of a load step that it
makes of a record.

A `Model` holds numbers, laws and fields. `Model.problem` builds the operators of a box; it keeps those that
it built last, which saves time and changes no result.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from sam.arrays import Array, Mask
from sam.contact.box import BoxContact
from sam.contact.convolution import Counters
from sam.contact.operators import SurfaceOperators
from sam.contact.stress import surface_strain
from sam.elastic.problem import ElasticProblem
from sam.grid.cells import CellGrid, Window
from sam.half_space import ElasticConstants
from sam.kernels.patches import Cuboids, Lags
from sam.plasticity.flow import Material
from sam.plasticity.load_step import (
    CONTACT_SHARE,
    ContactPressure,
    GivenPressure,
    NoPressure,
    PressureSource,
    Problem,
)
from sam.plasticity.spectra import SINGLE, BoxOperator
from sam.plasticity.state import Extent
from sam.scene.surface import Roughness
from sam.scene.verdict import Judging
from sam.scene.yield_curve import Strength
from sam.schedule import UNLOADED, Coefficient, FullSlip, Load, Schedule
from sam.surface_state import Tribofilm, TribofilmState, Wear, WearState

if TYPE_CHECKING:
    from sam.moving import Track


@dataclass(frozen=True)
class YieldingBody:
    """Elastic constants of the body, and its yield stress over depth and plastic strain."""

    elastic: ElasticConstants
    strength: Strength

    @property
    def mu(self) -> float:
        """Shear modulus in Pa."""
        return self.elastic.shear

    @property
    def poisson(self) -> float:
        """Poisson's ratio."""
        return self.elastic.poisson

    def initial_yield(self, depths: Array) -> Array:
        """Yield stress of unstrained material at some depths in m, (n,) in Pa."""
        return self.strength.stress(depths, np.zeros(1))


@dataclass
class Built:
    """The problem that a model built last with its parts, and the box and arrays that it was built for."""

    extent: Extent | None = None
    failed: Mask | None = None
    depth: Array | None = None
    surface: SurfaceOperators | None = None
    pressure: PressureSource | None = None
    problem: Problem | None = None


@dataclass(frozen=True)
class Model:
    """A body that yields, on the cells of a grid, and the laws of what happens to its surface.

    Parameters
    ----------
    elastic
        The elastic bodies, and what is in contact.
    body
        Its yield stress.
    schedule
        The load steps.
    tolerance
        Of the plastic iteration, see `Problem`.
    contact_share
        Residual that a contact may have, over the tolerance.
    mirrored
        Whether gap and loads are the same after x -> -x, and after y -> -y.
    tribofilm, wear
        Laws of the surface; None without them.
    roughness
        Of a surface that was lowered by so much, (nx, ny) in m; None if it is smooth.
    make
        `Problem`, or what makes another one of the same fields.
    judging
        How repeated loading is judged; None without a verdict.
    dissipates
        Whether the energy that each cycle dissipates is asked for.
    with_back
        Makes a material with back-stresses of mu, curve, factor and (moduli, recoveries); None without.
    lengthens
        Whether its steps know a longer iteration.
    track
        Of a counter-body that moves; None of one in place.
    built
        The problem that was built last.
    """

    elastic: ElasticProblem
    body: YieldingBody
    schedule: Schedule
    tolerance: float
    contact_share: float = CONTACT_SHARE
    mirrored: tuple[bool, bool] = (False, False)
    tribofilm: Tribofilm | None = None
    wear: Wear | None = None
    roughness: Callable[[Array], Roughness] | None = None
    make: Callable[..., Problem] = Problem
    lengthens: bool = True
    track: Track | None = None
    judging: Judging | None = None
    dissipates: bool = False
    with_back: Callable[..., Material] | None = None
    built: Built = field(default_factory=Built, compare=False, repr=False)

    @property
    def grid(self) -> CellGrid:
        """The cells and layers."""
        return self.elastic.grid

    @property
    def counters(self) -> Counters:
        """Where the work is counted."""
        return self.elastic.counters

    @property
    def slip(self) -> FullSlip:
        """Friction."""
        return self.elastic.slip

    @property
    def unit(self) -> float:
        """Pa per p_hat, E*/2."""
        return self.elastic.pair.contact_modulus / 2

    def leaves_grid(self, window: Window, pressure: Array) -> bool:
        """Whether a counter-body that moves over a smooth body touches the edge of the grid; pressure: on a
        window.
        """
        if self.track is None or self.elastic.looked.anywhere:
            return False
        return self.track.at_edge(self.grid, pressure, window)

    def coefficient(self, film: TribofilmState | None) -> Coefficient:
        """The coefficient of friction on the grid."""
        return (
            self.slip.coefficient
            if self.tribofilm is None or film is None
            else self.tribofilm.coefficient(film)
        )

    def gap(self, load: Load, wear: WearState | None) -> Array:
        """Gap of the surfaces as they are worn, without displacement, (nx, ny) in m."""
        unworn = self.elastic.gap(load)
        return unworn if wear is None else unworn + wear.depth

    def faces(self, extent: Extent) -> Array:
        """Depths of the faces of the layers of a box, (n_layers + 1,) in m."""
        return self.grid.layer_faces[: extent.layers + 1]

    def volumes(self, extent: Extent) -> Array:
        """Volume of a cell of each layer of a box, (n_layers, 1, 1) in m^3."""
        found: Array = self.grid.hx * self.grid.hy * np.diff(self.faces(extent))[:, None, None]
        return found

    def problem(
        self, extent: Extent, film: TribofilmState | None = None, wear: WearState | None = None
    ) -> Problem:
        """The problem of a load step on a box, with friction and gap of the surface as it is.

        What was built last is taken again as far as it is for the same box and the same arrays of film and
        wear.
        """
        last = self.built
        failed = film.film.failed if film is not None else None
        depth = wear.depth if wear is not None else None
        same_box, same_wear = extent == last.extent, depth is last.depth
        same_film = last.problem is not None and failed is last.failed
        if last.problem is not None and same_box and same_film and same_wear:
            return last.problem
        coefficient, surface = self.coefficient(film), last.surface
        touched = self.elastic.misfit is None
        if touched and (surface is None or not same_film):
            surface = self._with_friction(surface, coefficient)
        if not (same_box and same_wear and surface is last.surface):
            last.pressure = self._pressure(extent.window, surface, wear)
        if isinstance(coefficient, np.ndarray):
            coefficient = coefficient[extent.window.slices]
        last.problem = self.make(
            last.problem.operator if last.problem is not None and same_box else self._operator(extent),
            last.pressure,
            self.material(extent),
            unit=self.unit,
            tolerance=self.tolerance,
            counters=self.counters,
            coefficient=coefficient,
            misfit=last.problem.misfit if last.problem is not None and same_box else self._misfit(extent),
        )
        last.extent, last.failed, last.depth, last.surface = extent, failed, depth, surface
        return last.problem

    def material(self, extent: Extent) -> Material:
        """The yield stress of the layers of a box, at their centres."""
        depths, strength = self.grid.depths[: extent.layers], self.body.strength
        cells = depths[:, None, None]
        curve, factor, back = strength.curve_at(cells), strength.profile(cells), strength.back_at(cells[None])
        if back is None or self.with_back is None:
            return Material(self.body.mu, curve, factor)
        return self.with_back(self.body.mu, curve, factor, back)

    def _with_friction(self, surface: SurfaceOperators | None, coefficient: Coefficient) -> SurfaceOperators:
        """The surface coefficients of the grid with this friction; they share what is computed."""
        grid = self.grid
        if surface is None:
            coupling = self.slip.coupling * coefficient
            return SurfaceOperators((grid.nx, grid.ny), grid.hy / grid.hx, self.counters, coupling=coupling)
        return surface.with_coupling(self.slip.coupling * coefficient) if self.slip.coupling else surface

    def _misfit(self, extent: Extent) -> Array | None:
        """The stress of a misfit strain in the cells of a box, (6, n_layers, nx, ny) in Pa; None without."""
        load = self.elastic.misfit
        return None if load is None else load.mean_stress(self.grid, extent.window, self.faces(extent))

    def cuboids(self, extent: Extent) -> Cuboids:
        """The cells of a box, in m."""
        lags = Lags(extent.window.nx, extent.window.ny, self.grid.hx, self.grid.hy)
        return Cuboids(lags, tuple(self.faces(extent).tolist()), self.body.poisson)

    def _operator(self, extent: Extent) -> BoxOperator:
        return BoxOperator(
            self.cuboids(extent),
            self.body.mu,
            self.counters,
            sliding=self.slip.slides,
            single=self.tolerance >= SINGLE,
            mirror=self._mirror(extent.window),
            exchange=self._exchange(extent.window),
        )

    def _mirror(self, window: Window) -> tuple[bool, bool]:
        """Whether all fields are mirrored in x and in y: on a box about the middle; in x only without
        friction.
        """
        in_x, in_y = self.mirrored
        in_y = in_y and 2 * window.j0 + window.ny == self.grid.ny
        in_x = in_x and 2 * window.i0 + window.nx == self.grid.nx and not self.slip.slides
        return bool(in_x and in_y), bool(in_y)

    def _exchange(self, window: Window) -> bool:
        """Whether x and y may be exchanged: below a sphere on square cells without wear."""
        grid = self.grid
        square = grid.hx == grid.hy and window.nx == window.ny and all(self._mirror(window))
        if not square or self.wear is not None or self.elastic.given is not None:
            return False
        if self.elastic.misfit is not None:  # about the axis, and nothing is opposite
            return True
        gap = self.elastic.gap(UNLOADED)[window.slices]
        return np.array_equal(gap, gap.T)

    def _pressure(
        self, window: Window, surface: SurfaceOperators | None, wear: WearState | None
    ) -> PressureSource:
        """Where the pressure on a window of the grid comes from; no surface coefficients: nothing touches."""
        grid = self.grid
        if surface is None:
            return NoPressure(window.shape)
        if (given := self.elastic.given) is not None:
            return GivenPressure(lambda load: given.pressure(grid, load, window) / self.unit, window.shape)
        return ContactPressure(
            BoxContact(surface, window),
            lambda load: self.gap(load, wear)[window.slices],
            grid.hx,
            grid.hx * grid.hy * self.unit,
        )

    @property
    def surface(self) -> SurfaceOperators:
        """The surface coefficients of the grid, with the friction of the problem that was built last."""
        if self.built.surface is None:
            raise ValueError("no problem was built yet")
        return self.built.surface

    def nothing_strained(self) -> Array:
        """Total strains of the surface before the first load, (4, nx, ny)."""
        return np.zeros((4, self.grid.nx, self.grid.ny))

    def surface_strain(self, extent: Extent, stress: Array, plastic: Array) -> Array:
        """Total strains of the surface of the grid, (4, nx, ny), of fields on a box; zero outside of it."""
        body, out = self.body, self.nothing_strained()
        out[(..., *extent.window.slices)] = surface_strain(
            stress, plastic, self.grid.depths, young=body.elastic.young, poisson=body.poisson
        )
        return out
