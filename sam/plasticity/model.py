# SPDX-License-Identifier: MIT
"""What stays the same over the load history of a body that yields, and the problem of a load step that it
makes of a record.

A `Model` holds numbers, laws and fields. `Model.problem` builds the operators of a box; it keeps those that
it built last, which saves time and changes no result.

`Progressed` is the record of a load history: all that later steps read, so a history continued from it takes
the same steps, bit for bit. A checkpoint holds this record and nothing else. It is frozen;
`sam.plasticity.history.onward` makes the next one of it.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, partial
from typing import Any

import numpy as np

from sam.arrays import ROUNDING, Array, Mask
from sam.contact.box import BoxContact
from sam.contact.convolution import Convolution, Counters
from sam.contact.operators import SurfaceOperators, surface_strain
from sam.elastic.problem import ElasticProblem, Plan
from sam.grid.cells import CellGrid, Room, Window
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
from sam.plasticity.state import CellFields, Change, Extent, State, Trial, filled, surrounded
from sam.results.history import History
from sam.scene import Status
from sam.scene.result import Attempt
from sam.scene.section import stated
from sam.scene.verdict import Period, Verdict, cell_fields, norm_of, verdict_on
from sam.scene.yield_curve import Strength
from sam.schedule import UNLOADED, Coefficient, Load, Target
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
    def contact_tolerance(self) -> float:
        """Residual that a contact may have: the last move of the surface in the paper's loops leaves it."""
        return (PAPER_SHARE if self.plan.paper else CONTACT_SHARE) * self.plan.solver.tolerance

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
        return stated(self.grid.faces)[: extent.layers + 1]

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
            tolerance=self.plan.solver.tolerance,
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
        repeats, tolerance = self.plan.period is not None, self.plan.solver.tolerance
        box = ExpectedBox(nx, ny, extent.layers, tolerance, exchange, asked, periodic=repeats)
        period, of_cells = self.plan.period, (self.cuboids(extent), self.plan.pair.body.shear, counters)
        how: Any = {"tolerance": tolerance, "swept": box.swept}
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


@dataclass(frozen=True)
class Added:
    """What a period added to some cells of a box, (n,) and (6, n); worn: depth in m before it."""

    extent: Extent
    cells: Mask
    accumulated: Array
    norm: Array
    strain: Array | None
    worn: Array | None = None

    def on(self, extent: Extent, before: Array | None) -> Period:
        """The cells of a box in one row. before: worn depth at the beginning of the period before it."""
        where, shape = self.extent.inside(extent), extent.shape
        cells = surrounded(self.cells, where, shape)
        accumulated, norm = (filled(part, cells).ravel() for part in (self.accumulated, self.norm))
        strain = None if self.strain is None else filled(self.strain, cells).reshape(6, -1)
        restarted = None
        if self.worn is not None and before is not None:
            moved = (self.worn != before)[extent.window.slices]
            restarted = np.broadcast_to(moved, shape).ravel()
        return Period(accumulated, norm, strain, restarted)


@dataclass(frozen=True)
class Begun:
    """The material at the beginning of a cycle or period, on a box; worn as of `Added`."""

    extent: Extent
    material: CellFields
    worn: Array | None = None

    def added(self, state: State, extent: Extent) -> Added:
        """What a later state has more."""
        before = self.material.on_box(self.extent, extent)
        cells = state.material.cells | before.cells  # material may be gone where it was
        start, end = before.on(cells), state.material.on(cells)
        strain = end.strain.mean(axis=1) - start.strain.mean(axis=1)
        accumulated = end.peeq.mean(axis=0) - start.peeq.mean(axis=0)
        return Added(extent, cells, accumulated, norm_of(strain), strain, self.worn)

    def new_strain(self, state: State, extent: Extent) -> Array:
        """Accumulated plastic strain of a later state of the same cycle that is new, on the box of that."""
        return state.material.peeq - self.material.on_box(self.extent, extent).peeq


@dataclass(frozen=True)
class Periods:
    """The periods so far. begun: of the present one; last: those that have ended; verdicts: after each."""

    begun: Begun | None = None
    last: tuple[Added, ...] = ()
    verdicts: tuple[Verdict, ...] = ()

    def ended(self, model: Model, state: State, extent: Extent) -> Periods:
        """The same with the period that a state ends, before anything is removed from it."""
        earlier = (*(replace(period, strain=None) for period in self.last[:-1]), *self.last[-1:])
        added = (*earlier, stated(self.begun).added(state, extent))
        verdict = verdict_on(
            _compared(added, extent),
            state.material.peeq.ravel(),
            _yield_strain(model, extent),
            stated(model.plan.judging),
            volume=np.broadcast_to(model.volumes(extent), extent.shape).ravel(),
        )
        return Periods(None, added, (*self.verdicts, verdict))

    def fields(self, model: Model, state: State, extent: Extent) -> dict[str, Array]:
        """Fields of the last period on a box, (n_layers, nx, ny) each; nothing before its end."""
        if model.plan.judging is None or not self.last:
            return {}
        compared, total = _compared(self.last, extent), state.material.peeq.ravel()
        of_cells = cell_fields(compared, total, _yield_strain(model, extent), model.plan.judging)
        return {name: values.reshape(extent.shape) for name, values in of_cells.items()}

    def at(self, place: Callable[[Extent], Extent]) -> Periods:
        """The same on another grid. place: of a box on it."""
        begun = self.begun and replace(self.begun, extent=place(self.begun.extent))
        return replace(
            self,
            begun=begun,
            last=tuple(replace(period, extent=place(period.extent)) for period in self.last),
        )


def _compared(added: Sequence[Added], extent: Extent) -> list[Period]:
    """The periods on one box."""
    before = [None, *(period.worn for period in added)]
    return [period.on(extent, worn) for period, worn in zip(added, before, strict=False)]


def _yield_strain(model: Model, extent: Extent) -> Array:
    """Initial yield stress over Young's modulus in each cell of a box, (n,)."""
    strain = model.plan.initial_yield[: extent.layers] / model.plan.pair.body.young
    return np.broadcast_to(strain[:, None, None], extent.shape).ravel()


def floor(model: Model, extent: Extent) -> Array:
    """Strain of each cell of a box below which a period counts as without plastic strain, (n,)."""
    return stated(model.plan.judging).floor * _yield_strain(model, extent)


@dataclass(frozen=True)
class Parts:
    """What is committed of the step to the first target: parts, iterations, largest residual, attempts."""

    count: int = 0
    iterations: int = 0
    worst: float = 0.0
    attempts: tuple[Attempt, ...] = ()

    def with_(self, trial: Trial) -> Parts:
        """The same with one more part."""
        worst = max(self.worst, trial.history[-1]) if self.count else trial.history[-1]
        tried = self.tried(trial)
        return Parts(self.count + 1, self.iterations + len(trial.history), worst, tried.attempts)

    def tried(self, trial: Trial) -> Parts:
        """The same with one more attempt."""
        return replace(self, attempts=(*self.attempts, Attempt(trial.converged, trial.history, trial.goal)))


@dataclass(frozen=True)
class Outside:
    """Plastic u_z of the surface (nx, ny) in m, and stress in the rows at y = 0, (6, nz, nx, rows) in Pa."""

    displacement: Array
    stress: Array | None = None


@dataclass(frozen=True)
class Progressed:
    """A history after a committed step, or part of one: state on a box, targets to come, work, what
    the surface remembers; last, change: the trial committed last; cuts: loads to the first target;
    parts: committed of it; recalled: p_hat of earlier steps by load; outside: None where to be
    computed; longer: the longer iteration; cycle_start, periods: what strain counts from;
    dissipated: J in the cycle; left: the largest yield excess and flow residual of its steps.
    """

    state: State
    extent: Extent
    room: Room
    targets: tuple[Target, ...]
    counters: Counters
    tribofilm: TribofilmState | None = None
    wear: WearState | None = None
    last: Trial | None = None
    change: Change | None = None
    cuts: tuple[Load, ...] = ()
    parts: Parts = Parts()
    history: History = field(default_factory=History)
    recalled: Mapping[str, Array] = field(default_factory=dict)
    outside: Outside | None = None
    longer: bool = False
    cycle_start: Begun | None = None
    periods: Periods = field(default_factory=Periods)
    dissipated: float = 0.0
    left: tuple[float, float] = (0.0, 0.0)

    @property
    def ended(self) -> bool:
        """Whether all targets are reached, or one was not."""
        return not self.targets or self.history.status is not Status.CONVERGED

    def guess(self, load: Load) -> Change | None:
        """What the last step changed, scaled with the load, while the load rises on the same box."""
        if self.change is None or self.last is None or self.change.increment.cells.shape != self.extent.shape:
            return None
        ratio = load.rise(self.state.load) / (self.last.rise or float("inf"))
        return replace(self.change, ratio=ratio) if 0 < ratio <= 1 + ROUNDING else None
