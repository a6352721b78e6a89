# SPDX-License-Identifier: MIT
"""What stays the same over the load history of a body that yields, and the problem of a load step that it
makes of a record.

A `Model` holds numbers, laws and fields. `Model.problem` builds the operators of a box; it keeps those that
it built last, which saves time and changes no result.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property, partial
from typing import Any

import numpy as np

from sam.arrays import Array, Mask
from sam.contact.box import BoxContact
from sam.contact.convolution import Convolution, Counters
from sam.contact.operators import SurfaceOperators
from sam.contact.stress import surface_strain
from sam.elastic.problem import ElasticProblem, Plan
from sam.grid.cells import CellGrid, Window
from sam.kernels.patches import Cuboids, Lags
from sam.plasticity.box import ExpectedBox
from sam.plasticity.flow import BackStressFields, KinematicMaterial, Material
from sam.plasticity.load_step import (
    CONTACT_SHARE,
    ContactPressure,
    GivenPressure,
    PressureSource,
    Problem,
)
from sam.plasticity.paper import PaperProblem
from sam.plasticity.spectra import BoxOperator, PeriodicOperator
from sam.plasticity.state import Extent
from sam.scene.section import stated
from sam.scene.yield_curve import Strength
from sam.schedule import UNLOADED, Coefficient, Load
from sam.tribofilm.state import TribofilmState
from sam.wear import WearState

PAPER_SHARE = 1e2  # residual of a contact in the paper's loops, over the tolerance of the scene


@dataclass
class Built:
    """The problem that a model built last with its parts, and the box and arrays that it was built for;
    onto_grid: the displacement of the grid by the strain of a box.
    """

    extent: Extent | None = None
    failed: Mask | None = None
    depth: Array | None = None
    surface: SurfaceOperators | None = None
    problem: Problem | None = None
    onto_grid: tuple[Extent, Convolution] | None = None


@dataclass(frozen=True)
class Model(ElasticProblem):
    """A body that yields on a grid, over its load history; built: the problem that was built last."""

    built: Built = field(default_factory=Built, compare=False, repr=False)

    def __post_init__(self) -> None:
        if self.plan.plasticity is None:
            raise ValueError("the plan has no plasticity")

    @cached_property
    def strength(self) -> Strength:
        """Yield stress over depth and plastic strain."""
        return stated(self.plan.plasticity).strength()

    @property
    def grid(self) -> CellGrid:
        """The cells and layers."""
        return self.plan.grid

    @property
    def tolerance(self) -> float:
        """Of the plastic iteration, see `Problem`."""
        return self.plan.solver.tolerance

    @property
    def contact_tolerance(self) -> float:
        """Residual that a contact may have: the last move of the surface in the paper's loops leaves it."""
        return (PAPER_SHARE if self.plan.paper else CONTACT_SHARE) * self.tolerance

    @property
    def unit(self) -> float:
        """Pa per p_hat, E*/2."""
        return self.plan.pair.contact_modulus / 2

    def coefficient(self, film: TribofilmState | None) -> Coefficient:
        """The coefficient of friction on the grid."""
        if self.plan.tribofilm is None or film is None:
            return self.plan.slip.coefficient
        return self.plan.tribofilm.coefficient(film)

    def worn_gap(self, load: Load, wear: WearState | None) -> Array:
        """Gap of the surfaces as they are worn, without displacement, (nx, ny) in m."""
        return self.gap(load) if wear is None else self.gap(load) + wear.depth

    def faces(self, extent: Extent) -> Array:
        """Depths of the faces of the layers of a box, (n_layers + 1,) in m."""
        return self.grid.layer_faces[: extent.layers + 1]

    def volumes(self, extent: Extent) -> Array:
        """Volume of a cell of each layer of a box, (n_layers, 1, 1) in m^3."""
        return self.grid.hx * self.grid.hy * np.diff(self.faces(extent))[:, None, None]

    def problem(
        self, extent: Extent, film: TribofilmState | None = None, wear: WearState | None = None
    ) -> Problem:
        """The problem of a load step on a box; what was built last is kept if the same."""
        last, old = self.built, self.built.problem
        failed = film.film.failed if film is not None else None
        depth = wear.depth if wear is not None else None
        same_box = old is not None and extent == last.extent
        same_wear, same_film = depth is last.depth, old is not None and failed is last.failed
        if old is not None and same_box and same_film and same_wear:
            return old
        coefficient, surface = self.coefficient(film), last.surface
        factor = self.plan.slip.coupling
        if self.plan.misfit is None and surface is None:
            aspect, coupling = self.grid.hy / self.grid.hx, factor * coefficient
            surface = SurfaceOperators(
                self.grid.shape, aspect, self.counters, coupling=coupling, bodies=self.plan.bodies
            )
        elif surface is not None and factor and not same_film:  # the others share what is computed
            surface = surface.with_coupling(factor * coefficient)
        if old is not None and same_box and same_wear and surface is last.surface:
            pressure = old.pressure
        else:
            pressure = self._pressure(extent.window, surface, wear)
        if isinstance(coefficient, np.ndarray):
            coefficient = coefficient[extent.window.slices]
        plan, again = self.plan, old if same_box else None
        misfit = None if again is None else again.misfit
        if again is None and plan.misfit is not None:  # in the cells of the box, at its full size
            misfit = plan.misfit.mean_stress(self.grid, extent.window, self.faces(extent))
        make = partial(PaperProblem, stop=stated(plan.solver.stop)) if plan.paper else Problem
        problem = make(
            again.operator if again is not None else self.operator(extent),
            pressure,
            self.material(extent),
            unit=self.unit,
            tolerance=self.tolerance,
            counters=self.counters,
            coefficient=coefficient,
            misfit=misfit,
        )
        last.extent, last.failed, last.depth = extent, failed, depth
        last.surface, last.problem = surface, problem
        return problem

    def material(self, extent: Extent) -> Material:
        """The yield stress of the layers of a box, at their centres."""
        depths, strength, mu = self.grid.depths[: extent.layers], self.strength, self.plan.pair.body.shear
        cells = depths[:, None, None]
        curve, factor, back = strength.curve_at(cells), strength.profile(cells), strength.back_at(cells[None])
        if back is None:
            return Material(mu, curve, factor)
        return KinematicMaterial(mu, curve, factor, BackStressFields(*back))

    def cuboids(self, extent: Extent) -> Cuboids:
        """The cells of a box, in m."""
        lags = Lags(*extent.window.shape, self.grid.hx, self.grid.hy, self.grid.period)
        return Cuboids(lags, tuple(self.faces(extent).tolist()), self.plan.pair.body.poisson)

    @property
    def asked_operator(self) -> str | None:
        """See `Solver.operator`; below a cylinder nothing is swept."""
        return "dense" if self.grid.line else self.plan.solver.operator

    def operator(self, extent: Extent, *, once: Counters | None = None) -> BoxOperator:
        """The operator of a box. once: counters of one beside that of the steps."""
        counters = self.counters if once is None else once
        counters.tangential_kernels += self.plan.slip.slides
        nx, ny = extent.window.shape
        exchange, asked = self._exchange(extent.window), self.asked_operator
        repeats = self.plan.period is not None
        box = ExpectedBox(nx, ny, extent.layers, self.tolerance, exchange, asked, periodic=repeats)
        period, of_cells = self.plan.period, (self.cuboids(extent), self.plan.pair.body.shear, counters)
        how: Any = {"tolerance": self.tolerance, "swept": box.swept}
        if period is not None:
            return PeriodicOperator(period, *of_cells, **how)
        return BoxOperator(*of_cells, mirror=self._mirror(extent.window), exchange=exchange, **how)

    def _mirror(self, window: Window) -> tuple[bool, bool]:
        """Whether fields are mirrored in x and in y: on a box about the middle, x without friction."""
        plan, path = self.plan, self.plan.schedule.path
        # gap and loads are: below a smooth body whose load does not leave the apex
        even = plan.rough is None and not plan.paper and plan.slip.uniform
        in_x, in_y = even and len(path) == 1, even and all(y == 0 for _, y in path)
        in_y = in_y and 2 * window.j0 + window.ny == self.grid.ny
        in_x = in_x and 2 * window.i0 + window.nx == self.grid.nx and not self.plan.slip.slides
        return bool(in_x and in_y), bool(in_y)

    def _exchange(self, window: Window) -> bool:
        """Whether x and y may be exchanged: below a sphere on square cells without wear."""
        grid = self.grid
        square = grid.hx == grid.hy and window.nx == window.ny and all(self._mirror(window))
        if not square or self.plan.wear is not None or self.plan.given is not None:
            return False
        if self.plan.misfit is not None:  # about the axis, and nothing is opposite
            return True
        gap = self.gap(UNLOADED)[window.slices]
        return np.array_equal(gap, gap.T)

    def _pressure(
        self, window: Window, surface: SurfaceOperators | None, wear: WearState | None
    ) -> PressureSource:
        """Where the pressure on a window of the grid comes from; no surface coefficients: nothing touches."""
        grid = self.grid
        if surface is None:
            return GivenPressure(lambda load: np.zeros(window.shape), window.shape)
        if (given := self.plan.given) is not None:
            return GivenPressure(lambda load: given.pressure(grid, load, window) / self.unit, window.shape)
        return ContactPressure(
            BoxContact(surface, window),
            lambda load: self.worn_gap(load, wear)[window.slices],
            grid.hx,
            grid.hx * grid.hy * self.unit,
        )

    def surface_strain(self, extent: Extent, stress: Array, plastic: Array) -> Array:
        """Total strains of the surface of the grid, (4, nx, ny), of fields on a box; zero outside of it."""
        body, out = self.plan.pair.body, np.zeros((4, *self.grid.shape))
        out[(..., *extent.window.slices)] = surface_strain(
            stress, plastic, self.grid.depths, young=body.young, poisson=body.poisson
        )
        return out


def model_of(plan: Plan, problem: ElasticProblem) -> Model:
    """The model of a body that yields, as a plan has it.

    Parameters
    ----------
    plan
        A plan with plasticity.
    problem
        Its elastic bodies, see `Plan.problem`.

    Returns
    -------
    Model
        What stays the same over the load history.

    Raises
    ------
    ValueError
        For the plan of an elastic body.
    """
    return Model(plan, problem.counters)
