# SPDX-License-Identifier: MIT
"""The loading of a scene in progress, on a box of cells that grows with the plastic zone.

The state changes in `Run.commit` and, where material is torn off, in `Run.end_cycle`; which steps are taken is the business
of `sam.plasticity.history`, what is recorded of them that of `sam.plasticity.recorder`.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from sam.contact.box import BoxContact
from sam.contact.convolution import Counters
from sam.contact.operators import SurfaceOperators
from sam.elastic import protection_of
from sam.friction import Coefficient, coefficient_on
from sam.grid.cells import CellGrid, Window
from sam.grid.enlargement import Sides
from sam.loading import Load, given_pressure
from sam.planner.grids import coupling_of, gap_of, pair_of
from sam.plasticity.extent import GROWTH, LEAST_GROWTH, Extent, widened
from sam.plasticity.pressing import ContactPressure, GivenPressure
from sam.plasticity.spectra import SINGLE, BoxOperator
from sam.plasticity.step import Change, Material, Problem, State, Trial
from sam.scene import Scene, Status
from sam.scene.residuals import unfinished

if TYPE_CHECKING:
    from sam.plasticity.history import Progressed
    from sam.wear.ledger import Ledger

# tolerance of a step after which the film is tested first; the last test is that of the solved step
FIRST_TEST = 0.1


@dataclass
class Run:
    """The loading of a scene in progress."""

    scene: Scene
    grid: CellGrid
    counters: Counters
    extent: Extent
    problem: Problem = field(init=False)
    state: State = field(init=False)
    last: Trial | None = None
    change: Change | None = None
    status: Status = Status.CONVERGED
    reached: Sides = field(default_factory=Sides)
    ledger: Ledger | None = field(init=False)
    recalled: dict[str, np.ndarray] = field(default_factory=dict)
    ending: str = ""

    def __post_init__(self):
        grid = self.grid
        self.protection = protection_of(self.scene, grid)
        self.surface = SurfaceOperators(
            (grid.nx, grid.ny), grid.hy / grid.hx, self.counters, coupling=self._coupling()
        )
        self.unworn = gap_of(self.scene, self.grid)
        self.ledger = _ledger(self.scene, grid)
        self.unit = pair_of(self.scene).contact_modulus / 2
        self.problem = self._problem(self.extent)
        self.state = self.problem.virgin()

    @property
    def gap0(self) -> np.ndarray:
        """Gap of the surfaces as they are worn, (nx, ny) in m."""
        return self.unworn if self.ledger is None else self.unworn + self.ledger.depth

    @property
    def coefficient(self) -> Coefficient:
        """Of friction, on the full grid."""
        return self.protection.coefficient if self.protection else coefficient_on(self.scene, self.grid)

    def _on(self, window: Window) -> Coefficient:
        """Of friction, on a window."""
        return self.coefficient[window.slices] if np.ndim(self.coefficient) else self.coefficient

    def _coupling(self) -> Coefficient:
        return coupling_of(self.scene, self.coefficient)

    def _problem(self, extent: Extent) -> Problem:
        """Operators and material of a box."""
        body, grid, window, friction = self.scene.body, self.grid, extent.window, self._on(extent.window)
        mu, faces = body.young / (2 * (1 + body.poisson)), grid.faces[: extent.layers + 1]
        operator = BoxOperator(
            window.nx,
            window.ny,
            grid.hx,
            grid.hy,
            faces,
            mu,
            body.poisson,
            self.counters,
            self.scene.coefficient > 0,
            self.scene.solver.tolerance >= SINGLE,
            self._mirror(window),
            self._exchange(window),
        )
        factor = body.plasticity.depth_profile()(grid.depths[: extent.layers])
        material = Material(mu, body.plasticity.curve(), factor)
        tolerance = self.scene.solver.tolerance
        press, solver = self._pressing(window), self.scene.solver
        fixed = operator, press, material, self.unit, tolerance, self.counters, friction
        if solver.method != "paper":
            return Problem(*fixed)
        from sam.plasticity.paper import PaperProblem  # nothing else needs it

        problem = PaperProblem(*fixed)
        problem.stop = solver.stop
        return problem

    def _mirror(self, window: Window) -> tuple[bool, bool]:
        """Whether all fields are mirrored in x and in y: below a smooth body, on a box about its apex.

        In x not with friction, or a load that travels. What the paper's loops do is left as it is.
        """
        scene, grid, path = self.scene, self.grid, self.scene.loading.path
        if scene.surface is not None or scene.solver.method == "paper" or np.ndim(self.coefficient):
            return False, False
        in_y = 2 * window.j0 + window.ny == grid.ny and (path is None or path.start[1] == path.end[1] == 0)
        in_x = 2 * window.i0 + window.nx == grid.nx and path is None and not scene.coefficient
        return bool(in_x and in_y), bool(in_y)

    def _exchange(self, window: Window) -> bool:
        """Whether x and y may be exchanged: below a sphere on square cells, unless single cells are torn off."""
        scene, grid, gap = self.scene, self.grid, self.gap0[window.slices]
        square = grid.hx == grid.hy and window.nx == window.ny and all(self._mirror(window))
        return bool(
            square and self.ledger is None and not scene.loading.prescribed and np.array_equal(gap, gap.T)
        )

    def _pressing(self, window: Window) -> ContactPressure | GivenPressure:
        """The source of the pressure on a window of the grid."""
        scene, grid = self.scene, self.grid
        if scene.loading.prescribed:
            i, j = window.slices
            x, y = grid.x[i], grid.y[j]
            return GivenPressure(
                lambda load: given_pressure(scene, load, x, y, grid.hx, grid.hy) / self.unit, window.shape
            )  # fmt: skip
        contact = BoxContact(self.surface, window)
        return ContactPressure(contact, self.gap0[window.slices], grid.hx, grid.hx * grid.hy * self.unit)

    @classmethod
    def continued(cls, scene: Scene, grid: CellGrid, counters: Counters, start: Progressed) -> Run:
        """The run as it was when `start` was recorded, the counters included."""
        run = cls(scene, grid, counters, start.extent)
        run.state, run.last, run.change, run.recalled = (
            start.state,
            start.last,
            start.change,
            dict(start.recalled),
        )
        if start.ledger is not None:
            run.ledger = start.ledger
            run.reshape()
        if start.film is not None:
            run.protection.continue_from(start.film)
            run._slide()
        vars(counters).update(vars(start.counters))
        return run

    def attempt(self, load: Load) -> Trial | None:
        """A step to a load on a box that holds it, committed if it converged; None if the grid cannot hold it."""
        guess, start = self._guess(load.force), self._recalled(load)
        tolerance = self.scene.solver.tolerance
        until = tolerance if self.protection is None else max(FIRST_TEST, tolerance)
        while True:
            trial = self.problem.step(self.state, load, guess, start, until)
            if not trial.converged:
                self._revert_film()
                return trial
            if self._grow(trial):
                guess, start = self._guess(load.force), None
                continue  # the same step again, from the committed state, on the larger box
            if self.status is not Status.CONVERGED:
                return None
            if self._film_fails(trial):
                guess, start = trial.change(self.state), trial.pressure
                continue  # the same step again, with more friction
            if until > tolerance:
                guess, start, until = trial.change(self.state), trial.pressure, tolerance
                continue
            self.commit(trial)
            return trial

    def begin_cycle(self) -> None:
        """A new chemical film on the surface as it is."""
        if self.protection is not None:
            self.protection.begin_cycle(self._surface_strain(self.state.residual, self.state.strain))
            self._slide()

    def end_cycle(self, trial: Trial) -> Trial:
        """Tear off what is strained too much, and find equilibrium again; the trial at its end, or the one given."""
        if self.ledger is None:
            return trial
        from sam.plasticity.tearing import torn_off

        torn = torn_off(self.scene, self.grid, self.extent, self.state, self.ledger)
        self.ledger = torn.ledger
        if not torn.ledger.volumes[-1]:
            return trial
        self.reshape()
        fresh = self.problem.virgin()
        lift, residual = self.problem.plastic_part(fresh, torn.strain)
        self.state = State(torn.strain, torn.alpha, residual, lift, trial.pressure, trial.load)
        after = self.problem.step(self.state, trial.load)
        if not after.converged:
            self.give_up(after)
            return trial
        self.commit(after)
        return after

    def reshape(self) -> None:
        """The contact of the surfaces as they are worn."""
        self.problem.press = self._pressing(self.extent.window)

    def _slide(self) -> None:
        """Friction as the film has it now."""
        window = self.extent.window
        self.problem.coefficient = self._on(window)
        if np.any(self._coupling()):
            self.surface = self.surface.with_coupling(self._coupling())
            self.problem.press = self._pressing(window)

    def _surface_strain(self, stress: np.ndarray, plastic: np.ndarray) -> np.ndarray:
        """Total strains of the surface on the full grid, (4, nx, ny); zero outside of the box."""
        from sam.tribofilm.state import surface_strain

        body, out = self.scene.body, np.zeros((4, self.grid.nx, self.grid.ny))
        out[(..., *self.extent.window.slices)] = surface_strain(
            stress, plastic, self.grid.depths, body.young, body.poisson
        )  # fmt: skip
        return out

    def _film_fails(self, trial: Trial) -> bool:
        """Whether the film fails in further cells at the end of a step; friction is then high there."""
        if self.protection is None:
            return False
        pressure = np.zeros((self.grid.nx, self.grid.ny))
        pressure[self.extent.window.slices] = trial.pressure * self.unit
        strain = self._surface_strain(trial.stress, self.state.strain + trial.increment)
        if not self.protection.fails(strain, pressure, trial.load.sign):
            return False
        self._slide()
        return True

    def _revert_film(self) -> None:
        """Friction as it was at the last committed step."""
        if self.protection is not None:
            self.protection.revert()
            self._slide()

    def _recalled(self, load: Load) -> np.ndarray | None:
        """p_hat under the same force in the cycle before."""
        found = self.recalled.get(repr(load.force))
        return found if found is not None and found.shape == self.extent.window.shape else None

    def give_up(self, trial: Trial) -> None:
        """A step did not converge however often it was halved; trial: the last attempt."""
        self.status = Status.STEP_CUT_LIMIT
        words = f"the plastic iteration of the last attempt, to {trial.load.force:.6g} N,"
        self.ending = unfinished(words, trial.history, trial.goal)

    def commit(self, trial: Trial) -> None:
        """The one place where the state changes in a load step."""
        self.change = trial.change(self.state)
        self.state, self.last = self.problem.commit(self.state, trial), trial
        if self.protection is not None:
            self.protection.commit()
        if trial.load.force and self.scene.loading.cycles > 1:
            self.recalled[repr(trial.load.force)] = trial.pressure

    def _guess(self, force: float) -> Change | None:
        """What the last step changed, scaled with the force, while the load rises."""
        if self.change is None or self.change.increment.shape != self.state.strain.shape:
            return None
        ratio = (force - self.state.load.force) / (self.last.step_force or np.inf)
        return self.change.times(ratio) if 0 < ratio <= 1 + 1e-9 else None

    def _grow(self, trial: Trial) -> bool:
        """Enlarge the box when plastic strain or contact reaches its sides; True if it did."""
        strained = trial.increment.any(axis=0)
        on_surface = strained.any(axis=0) | (trial.pressure > 0)
        window, layers = self.extent.window, self.extent.layers
        in_x = on_surface[:2].any(), on_surface[-2:].any()
        in_y = on_surface[:, :2].any(), on_surface[:, -2:].any()
        deep = strained[-1].any()
        if not (deep or any(in_x) or any(in_y)):
            return False
        i, nx = widened(window.i0, window.nx, self.grid.nx, *in_x)
        j, ny = widened(window.j0, window.ny, self.grid.ny, *in_y)
        more = min(layers + max(LEAST_GROWTH, layers // GROWTH), len(self.grid.depths)) if deep else layers
        extent = Extent(Window(i, j, nx, ny), more)
        if extent == self.extent:  # the grid ends here: say so unless only its outermost cells are free
            beside = strained[:, [0, -1]].any() or strained[:, :, [0, -1]].any()
            beside = bool(
                beside and self.scene.surface is None
            )  # a rough patch is cut there anyway, which is warned of
            if deep or beside:
                self.status, self.reached = Status.PLASTIC_ZONE_AT_GRID_EDGE, Sides(beside, bool(deep))
            return False
        self._move_to(extent)
        return True

    def _move_to(self, extent: Extent) -> None:
        """The committed state on a larger box; its residual stress and surface are computed anew there."""
        old, new = self.extent.window, extent.window
        cells = (
            slice(old.i0 - new.i0, old.i0 - new.i0 + old.nx),
            slice(old.j0 - new.j0, old.j0 - new.j0 + old.ny),
        )
        problem, before = self._problem(extent), self.state
        fresh = problem.virgin()
        strain, alpha, pressure = (
            np.zeros_like(fresh.strain),
            np.zeros_like(fresh.alpha),
            np.zeros_like(fresh.pressure),
        )
        strain[:, : self.extent.layers, *cells] = before.strain
        alpha[: self.extent.layers, *cells] = before.alpha
        pressure[cells] = before.pressure
        lift, residual = problem.plastic_part(fresh, strain) if strain.any() else (fresh.lift, fresh.residual)
        self.extent, self.problem = extent, problem
        self.state = State(strain, alpha, residual, lift, pressure, before.load)


def _ledger(scene: Scene, grid: CellGrid) -> Ledger | None:
    """Of a scene that wears; else None, and nothing of it is loaded."""
    if scene.wear is None or not scene.wear.tears:
        return None
    from sam.wear.ledger import Ledger

    return Ledger.empty((grid.nx, grid.ny), grid.hx, grid.hy)
