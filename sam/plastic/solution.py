# SPDX-License-Identifier: MIT
"""An elasto-plastic scene, solved on a box of cells that grows with the plastic zone.

The state changes in one place, `Run.commit`; which steps are taken is the business of `sam.plastic.history`.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from sam.contact import BoxContact, Contact, Grid, around, measured, no_contact
from sam.convolution import Counters, Window
from sam.elastic import plane_stress, protection_of
from sam.friction import Coefficient, coefficient_on
from sam.grid import CellGrid, contact_modulus, coupling_of, gap_of
from sam.loading import UNLOADED, Load, given_contact, given_pressure, path_of, targets_of
from sam.plastic.extent import GROWTH, LEAST_GROWTH, Extent, first_extent, initial_yield, widened
from sam.plastic.history import History, Peak, Progressed
from sam.plastic.outside import residual_stress, surface_lift
from sam.plastic.paper import PaperProblem
from sam.plastic.pressing import ContactPressure, GivenPressure
from sam.plastic.spectra import SINGLE, BoxOperator
from sam.plastic.step import CONTACT_SHARE, Material, Problem, State, Trial
from sam.record import CycleEnd, Row, Snapshot, counted
from sam.scene import Scene, Status
from sam.scene.result import Progress
from sam.sliding import Sliding
from sam.stress import von_mises

if TYPE_CHECKING:
    from sam.wear.ledger import Ledger

ROUNDING, PAPER_SHARE = 1e-9, 1e2
FIRST_TEST = 0.1  # tolerance of a step after which the film is tested first; the last test is that of the solved step


@dataclass(frozen=True)
class Found:
    """The solved history. status: CONVERGED, or why not."""

    rows: list[Row]
    snapshots: list[Snapshot]
    peeq_max: float
    certificate: dict[str, float]
    discretisation: dict[str, object]
    status: Status
    warnings: tuple[str, ...] = ()
    ends: tuple[CycleEnd, ...] = ()
    ledger: Ledger | None = None


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
    status: Status = Status.CONVERGED
    ledger: Ledger | None = field(init=False)
    recalled: dict[str, np.ndarray] = field(default_factory=dict)
    _outside: dict[str, np.ndarray] = field(default_factory=dict)

    def __post_init__(self):
        grid = self.grid
        self.protection = protection_of(self.scene, grid)
        self.surface = Grid((grid.nx, grid.ny), grid.hy / grid.hx, self.counters, self._coupling())
        self.unworn = gap_of(self.scene, self.grid)
        self.ledger = _ledger(self.scene, grid)
        self.unit = contact_modulus(self.scene) / 2
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
            window.nx, window.ny, grid.hx, grid.hy, faces, mu, body.poisson, self.counters, self.scene.coefficient > 0,
            self.scene.solver.tolerance >= SINGLE,
        )
        factor = body.plasticity.depth_profile()(grid.depths[: extent.layers])
        material = Material(mu, body.plasticity.curve(), factor)
        tolerance = self.scene.solver.tolerance
        press, solver = self._pressing(window), self.scene.solver
        kind = PaperProblem if solver.method == "paper" else Problem
        problem = kind(operator, press, material, self.unit, tolerance, self.counters, friction)
        if solver.method == "paper":
            problem.stop = solver.stop
        return problem

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
        run.state, run.last, run.recalled = start.state, start.last, dict(start.recalled)
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
                guess, start = trial.increment if trial.plastic else None, trial.pressure
                continue  # the same step again, with more friction
            if until > tolerance:
                guess, start, until = trial.increment if trial.plastic else None, trial.pressure, tolerance
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
        from sam.plastic.tearing import torn_off

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
            self.give_up()
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
        from sam.protection import surface_strain

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

    def give_up(self) -> None:
        """A step did not converge however often it was halved."""
        self.status = Status.STEP_CUT_LIMIT

    def commit(self, trial: Trial) -> None:
        """The one place where the state changes in a load step."""
        self.state, self.last = self.problem.commit(self.state, trial), trial
        if self.protection is not None:
            self.protection.commit()
        if trial.load.force and self.scene.loading.cycles > 1:
            self.recalled[repr(trial.load.force)] = trial.pressure

    def _guess(self, force: float) -> np.ndarray | None:
        """The increment of the last step, scaled with the force, while the load rises."""
        last = self.last
        if last is None or not last.plastic or last.increment.shape != self.state.strain.shape:
            return None
        ratio = (force - self.state.load.force) / (last.step_force or np.inf)
        return ratio * last.increment if 0 < ratio <= 1 + 1e-9 else None

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
            at_edge = deep or (beside and self.scene.surface is None)  # a rough patch is cut there anyway, which is warned of
            if at_edge:
                self.status = Status.PLASTIC_ZONE_AT_GRID_EDGE
            return False
        self._move_to(extent)
        return True

    def _move_to(self, extent: Extent) -> None:
        """The committed state on a larger box; its residual stress and surface are computed anew there."""
        old, new = self.extent.window, extent.window
        cells = (slice(old.i0 - new.i0, old.i0 - new.i0 + old.nx), slice(old.j0 - new.j0, old.j0 - new.j0 + old.ny))
        problem, before = self._problem(extent), self.state
        fresh = problem.virgin()
        strain, alpha, pressure = np.zeros_like(fresh.strain), np.zeros_like(fresh.alpha), np.zeros_like(fresh.pressure)
        strain[:, : self.extent.layers, *cells] = before.strain
        alpha[: self.extent.layers, *cells] = before.alpha
        pressure[cells] = before.pressure
        lift, residual = problem.plastic_part(fresh, strain) if strain.any() else (fresh.lift, fresh.residual)
        self.extent, self.problem = extent, problem
        self.state = State(strain, alpha, residual, lift, pressure, before.load)

    def contact(self, trial: Trial) -> Contact:
        """The contact of a step in its box, with the residuals measured there."""
        load, p, gap0 = trial.load, trial.pressure, self.gap0[self.extent.window.slices] + trial.lift
        if load.force == 0:
            return no_contact(gap0)
        if self.scene.loading.prescribed:
            return self._given(load, p, np.zeros_like(p))
        return self._measured(load.force, gap0, p, self.problem.press.contact.displacement(p, load.sign))

    def contact_on_grid(self, trial: Trial) -> Contact:
        """The contact on the full grid, its residuals measured there: pile-up outside the box counts."""
        window, load = self.extent.window, trial.load
        if load.force == 0:
            return no_contact(self.gap0 + self.lift())
        p = np.zeros(self.surface.shape)
        p[window.slices] = trial.pressure
        u = self.surface.displacement(trial.pressure, window, self.surface.whole, load.sign)
        if self.scene.loading.prescribed:
            return self._given(load, p, u)
        return self._measured(load.force, self.gap0 + self.lift(), p, u)

    def _given(self, load: Load, p: np.ndarray, u: np.ndarray) -> Contact:
        cell = self.grid.hx * self.grid.hy
        return given_contact(self.scene, load, p * self.unit, u * self.grid.hx, cell)

    def _measured(self, force: float, gap0: np.ndarray, p: np.ndarray, u: np.ndarray) -> Contact:
        grid, tolerance, box = self.grid, self._contact_tolerance(), around(p > 0)
        return measured(self.surface, gap0, p, u, grid.hx, grid.hy, self.unit, force, box, 0, tolerance)

    def _contact_tolerance(self) -> float:
        """The residual that the contact may have: it is solved to CONTACT_SHARE of the plastic tolerance.

        The transforms of another window round differently (ROUNDING); the paper's loops leave the last move of the surface.
        """
        share = PAPER_SHARE if self.scene.solver.method == "paper" else CONTACT_SHARE
        return share * self.scene.solver.tolerance + ROUNDING

    def lift(self) -> np.ndarray:
        """Residual displacement of the whole surface, (nx, ny) in m."""
        if self._outside.get("strain") is not self.state.strain:
            whole = self.extent.window == self.surface.whole
            lift = self.state.lift if whole else self._moved(3, self.surface.whole)
            self._outside = {"strain": self.state.strain, "lift": lift}
        return self._outside["lift"]

    def residual_stress(self) -> np.ndarray:
        """Stress of the plastic strain in the rows that touch y = 0, at all depths; computed once for a strain."""
        self.lift()
        if "stress" not in self._outside:
            self._outside["stress"] = self._residual_stress()
        return self._outside["stress"]

    def _residual_stress(self) -> np.ndarray:
        """Where the box covers the rows its own stresses are taken, see `snapshot`: zero there."""
        grid, body, faces = self.grid, self.scene.body, self.grid.faces[: self.extent.layers + 1]
        covered = self.extent.layers if self.extent.window == self.surface.whole else 0
        below = residual_stress(
            self.state.strain, self.extent.window, faces, grid.depths[covered:], grid.axis_rows, grid.hx, grid.hy,
            self.problem.material.mu, body.poisson, self.counters,
        )  # fmt: skip
        return np.concatenate([np.zeros((6, covered, *below.shape[2:])), below], axis=1)

    def _moved(self, component: int, observed: Window) -> np.ndarray:
        """Displacement of a window of the surface by the plastic strain, (nx, ny) in m."""
        grid, faces = self.grid, self.grid.faces[: self.extent.layers + 1]
        return surface_lift(
            self.state.strain, self.extent.window, faces, observed, grid.hx, grid.hy, self.scene.body.poisson,
            self.counters, component,
        )  # fmt: skip

    def friction(self, trial: Trial) -> Coefficient:
        """Of friction on the box, with the sign of the traction."""
        return trial.load.sign * self.problem.coefficient

    def snapshot(self, name: str, trial: Trial) -> Snapshot:
        """Stress and strain in the plane y = 0: of the cells in the box, and at the cell centres outside it."""
        grid, rows, contact = self.grid, self.grid.axis_rows, self.contact_on_grid(trial)
        mu = self.coefficient
        stress = plane_stress(self.scene, grid, trial.load, contact, self.counters, coefficient=mu) + self.residual_stress()
        window, layers = self.extent.window, self.extent.layers
        inside = slice(window.i0, window.i0 + window.nx)
        strain, peeq = np.zeros_like(stress), np.zeros_like(stress[0])
        for row, j in enumerate(range(rows.j0 - window.j0, rows.j0 - window.j0 + rows.ny)):
            if 0 <= j < window.ny:
                stress[:, :layers, inside, row] = trial.stress[..., j]
                strain[:, :layers, inside, row] = self.state.strain[..., j]
                peeq[:layers, inside, row] = self.state.alpha[..., j]
        sliding = Sliding.elastic(self.scene, grid, trial.load, contact, self.counters, coefficient=mu)
        if sliding is not None:
            sliding = sliding.strained(self._moved(1, rows), strain, np.diff(grid.faces))
        mises = peeq_at = None
        if self.scene.surface is not None:
            mises, peeq_at = self._largest(stress, trial, contact)
        return Snapshot(
            name, contact, self.lift(), stress, strain, peeq, sliding, mises=mises, peeq_at=peeq_at,
            worn=None if self.ledger is None else self.ledger.depth,
        )  # fmt: skip

    def _largest(self, plane: np.ndarray, trial: Trial, contact: Contact) -> tuple[np.ndarray, np.ndarray]:
        """At each depth the largest von Mises stress in Pa and plastic strain anywhere, (nz, 1); below the box in y = 0 only."""
        window, layers = counted(contact, self.grid).slices, self.extent.layers
        mises, peeq = von_mises(plane).max(axis=(-2, -1)), np.zeros(plane.shape[1])
        mises[:layers] = von_mises(trial.stress)[(..., *window)].max(axis=(-2, -1))
        peeq[:layers] = self.state.alpha.max(axis=(-2, -1))
        return mises[:, None], peeq[:, None]

    def ended(self, cycle: int) -> CycleEnd:
        """The surface at the end of a cycle, and how much is worn so far."""
        found, lowered = None, self.lift()
        if self.ledger is not None:
            lowered = lowered + self.ledger.depth
        if self.scene.surface is not None:
            from sam.rough import roughness_now

            found = roughness_now(self.scene, self.grid, lowered)
        volume = self.ledger.volume if self.ledger is not None else 0.0
        return CycleEnd(cycle, volume, found, self.counters.operator_applications)


def _ledger(scene: Scene, grid: CellGrid) -> Ledger | None:
    """Of a scene that wears; else None, and nothing of it is loaded."""
    if scene.wear is None:
        return None
    from sam.wear.ledger import Ledger

    return Ledger.empty((grid.nx, grid.ny), grid.hx, grid.hy)


def solve_plastic(
    scene: Scene,
    grid: CellGrid,
    counters: Counters,
    report: Progress,
    keep: Callable[[Progressed, int, int], None] | None = None,
    start: Progressed | None = None,
) -> Found:
    """History and states of a scene that yields.

    keep: called as keep(progressed, done, total) after each committed step, or part of one, with the number of load steps;
    start: such a record, to go on from there.
    """

    def committed(history: History) -> None:
        if keep is not None:
            done = len(history.rows)
            keep(history.progressed(), done, done + len(history.targets))

    if start is None:
        run = Run(scene, grid, counters, first_extent(scene, grid, counters))
        history = History(run, committed, targets_of(scene))
    else:
        run = Run.continued(scene, grid, counters, start)
        history = History.continued(run, committed, start)
    loading, moves = scene.loading, len(path_of(scene)) - 1
    total = loading.cycles * (loading.steps + moves + loading.unload)
    while history.targets:
        rises = history.targets[0].rises
        if not history.advance():
            break
        if rises:
            report("load steps", len(history.rows), total)
    return _found(run, history)


def _found(run: Run, history: History) -> Found:
    """The record of a run; one that broke off keeps what it reached as its peak, and its status says so."""
    snapshots, peak = dict(history.snapshots), history.peak
    if peak is None:
        last = run.last or run.problem.step(run.state, UNLOADED)
        snapshots["peak"] = run.snapshot("peak", last)
        peak = Peak(float(run.state.alpha.max()), last.yield_excess, last.flow_residual)
    states = [snapshots[name] for name in ("peak", "unloaded") if name in snapshots]
    extent, operator = run.extent, run.problem.operator
    certificate = {
        "yield_excess": peak.yield_excess,
        "flow_residual": peak.flow_residual,
        "yield_excess_outside_box": _excess_outside(run, snapshots["peak"]),
        "plastic_tolerance": run.scene.solver.tolerance,
    }
    discretisation = {
        "plastic_box_cells": [extent.window.nx, extent.window.ny],
        "plastic_box_layers": extent.layers,
        "layers": len(run.grid.depths),
        "operator_bytes": operator.memory,
    }
    return Found(
        history.rows, states, peak.peeq_max, certificate, discretisation, run.status, _warnings(run, peak),
        tuple(history.ends), run.ledger,
    )  # fmt: skip


def _warnings(run: Run, peak: Peak) -> tuple[str, ...]:
    """The paper's loops stop by their own criterion: what they leave is said."""
    solver = run.scene.solver
    if solver.method != "paper":
        return ()
    return (
        f'solver.method = "paper", stop = "{solver.stop}": the last step leaves a yield excess of {peak.yield_excess:.1e} and '
        f"a flow-rule residual of {peak.flow_residual:.1e} of the yield stress",
    )


def _excess_outside(run: Run, snapshot: Snapshot) -> float:
    """max((mises - sigma_y)/sigma_y, 0) in the plane y = 0 outside the box, where no plastic strain was allowed."""
    window, limit = run.extent.window, initial_yield(run.scene, run.grid)
    excess = von_mises(snapshot.in_plane) / limit[:, None] - 1
    excess[: run.extent.layers, window.i0 : window.i0 + window.nx] = 0.0
    return float(max(excess.max(), 0.0))
