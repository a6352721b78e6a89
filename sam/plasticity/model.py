# SPDX-License-Identifier: MIT
"""What stays the same over the load history of a body that yields, and the problem of a load step that it makes of a record.

A `Model` holds numbers, laws and fields. `Model.problem` builds the operators of a box; it keeps those that it built last,
which saves time and changes no result.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from sam.arrays import Array, Mask
from sam.contact.box import BoxContact
from sam.contact.convolution import Counters
from sam.contact.operators import SurfaceOperators
from sam.contact.surface_strain import surface_strain
from sam.friction import Coefficient
from sam.grid.cells import CellGrid, Window
from sam.kernels.lags import Cuboids, Lags
from sam.loading import UNLOADED, Load
from sam.plasticity.instruments import Instruments
from sam.plasticity.pressure import ContactPressure, GivenPressure, PressureSource
from sam.plasticity.spectra import SINGLE, BoxOperator
from sam.plasticity.state import Extent
from sam.plasticity.step import CONTACT_SHARE, Material, Problem
from sam.scene.yield_curve import DepthProfile, YieldCurve
from sam.surface_state import Tribofilm, TribofilmState, Wear, WearState


@dataclass(frozen=True)
class YieldingBody:
    """Elastic constants of the body (young in Pa), its yield curve, and the profile of the yield stress over depth."""

    young: float
    poisson: float
    curve: YieldCurve
    profile: DepthProfile

    @property
    def mu(self) -> float:
        """Shear modulus in Pa."""
        return self.young / (2 * (1 + self.poisson))

    def initial_yield(self, depths: Array) -> Array:
        """Yield stress of unstrained material at some depths in m, (n,) in Pa."""
        return self.profile(depths) * self.curve.stress(np.zeros(1))


@dataclass(frozen=True)
class Pressing:
    """What presses on the body.

    unit: Pa per p_hat, E*/2; gap: of a load, between the surfaces before wear and displacement, (nx, ny) in m on the
    grid; given: of a load and a window, a pressure in Pa in place of a contact; mirrored: whether gap and loads are the
    same after x -> -x, and after y -> -y.
    """

    unit: float
    gap: Callable[[Load], Array]
    given: Callable[[Load, Window], Array] | None = None
    mirrored: tuple[bool, bool] = (False, False)


@dataclass(frozen=True)
class Slip:
    """Full slip along x.

    slides: whether there is a traction; coefficient: of friction without a tribofilm; coupling: 2 beta, see
    `sam.contact.normal`.
    """

    slides: bool = False
    coefficient: Coefficient = 0.0
    coupling: float = 0.0


@dataclass
class Built:
    """The problem that a model built last with its parts, and the box and the arrays that it was built for."""

    extent: Extent | None = None
    failed: Mask | None = None
    depth: Array | None = None
    surface: SurfaceOperators | None = None
    pressure: PressureSource | None = None
    problem: Problem | None = None


@dataclass(frozen=True)
class Model:
    """A body that yields, on the cells of a grid, and the laws of what happens to its surface.

    tolerance: of the plastic iteration; contact_share: residual that a contact may have, over the tolerance; cut_beside:
    whether the sides of the grid cut the body anyway, as those of a rough patch; remembers: whether pressures serve as a
    start in the next cycle; make: `Problem`, or what makes another one of the same fields.
    """

    grid: CellGrid
    body: YieldingBody
    pressing: Pressing
    slip: Slip
    instruments: Instruments
    counters: Counters
    tolerance: float
    contact_share: float = CONTACT_SHARE
    tribofilm: Tribofilm | None = None
    wear: Wear | None = None
    cut_beside: bool = False
    remembers: bool = False
    make: Callable[..., Problem] = Problem
    built: Built = field(default_factory=Built, compare=False, repr=False)

    def coefficient(self, film: TribofilmState | None) -> Coefficient:
        """The coefficient of friction on the grid."""
        return (
            self.slip.coefficient
            if self.tribofilm is None or film is None
            else self.tribofilm.coefficient(film)
        )

    def gap(self, load: Load, wear: WearState | None) -> Array:
        """Gap of the surfaces as they are worn, without displacement, (nx, ny) in m."""
        unworn = self.pressing.gap(load)
        return unworn if wear is None else unworn + wear.depth

    def faces(self, extent: Extent) -> Array:
        """Depths of the faces of the layers of a box, (n_layers + 1,) in m."""
        return self.grid.faces[: extent.layers + 1]

    def problem(
        self, extent: Extent, film: TribofilmState | None = None, wear: WearState | None = None
    ) -> Problem:
        """The problem of a load step on a box, with friction and gap of the surface as it is.

        What was built last is taken again as far as it is for the same box and the same arrays of film and wear.
        """
        last, failed, depth = self.built, film and film.film.failed, wear and wear.depth
        same_box, same_film = extent == last.extent, last.problem is not None and failed is last.failed
        same_wear = depth is last.depth
        if last.problem is not None and same_box and same_film and same_wear:
            return last.problem
        coefficient = self.coefficient(film)
        surface = last.surface if same_film else self._with_friction(last.surface, coefficient)
        if not (same_box and same_wear and surface is last.surface):
            last.pressure = self._pressure(extent.window, surface, wear)
        last.problem = self.make(
            last.problem.operator if last.problem is not None and same_box else self._operator(extent),
            last.pressure,
            Material(self.body.mu, self.body.curve, self.body.profile(self.grid.depths[: extent.layers])),
            unit=self.pressing.unit,
            tolerance=self.tolerance,
            counters=self.counters,
            coefficient=coefficient[extent.window.slices] if np.ndim(coefficient) else coefficient,
        )
        last.extent, last.failed, last.depth, last.surface = extent, failed, depth, surface
        return last.problem

    def _with_friction(self, surface: SurfaceOperators | None, coefficient: Coefficient) -> SurfaceOperators:
        """The surface coefficients of the grid with this friction; they share what is computed."""
        grid = self.grid
        if surface is None:
            coupling = self.slip.coupling * coefficient
            return SurfaceOperators((grid.nx, grid.ny), grid.hy / grid.hx, self.counters, coupling=coupling)
        return surface.with_coupling(self.slip.coupling * coefficient) if self.slip.coupling else surface

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
        """Whether all fields are mirrored in x and in y: on a box about the middle; in x only without friction."""
        in_x, in_y = self.pressing.mirrored
        in_y = in_y and 2 * window.j0 + window.ny == self.grid.ny
        in_x = in_x and 2 * window.i0 + window.nx == self.grid.nx and not self.slip.slides
        return bool(in_x and in_y), bool(in_y)

    def _exchange(self, window: Window) -> bool:
        """Whether x and y may be exchanged: below a sphere on square cells, unless single cells are removed."""
        grid = self.grid
        square = grid.hx == grid.hy and window.nx == window.ny and all(self._mirror(window))
        if not square or self.wear is not None or self.pressing.given is not None:
            return False
        gap = self.pressing.gap(UNLOADED)[window.slices]
        return np.array_equal(gap, gap.T)

    def _pressure(self, window: Window, surface: SurfaceOperators, wear: WearState | None) -> PressureSource:
        """Where the pressure on a window of the grid comes from."""
        grid, pressing = self.grid, self.pressing
        if (given := pressing.given) is not None:
            return GivenPressure(lambda load: given(load, window) / pressing.unit, window.shape)
        return ContactPressure(
            BoxContact(surface, window),
            lambda load: self.gap(load, wear)[window.slices],
            grid.hx,
            grid.hx * grid.hy * pressing.unit,
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
            stress, plastic, self.grid.depths, young=body.young, poisson=body.poisson
        )
        return out
