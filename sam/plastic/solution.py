# SPDX-License-Identifier: MIT
"""An elasto-plastic scene, solved on a box of cells that grows with the plastic zone.

The state changes in one place, `Run.commit`; which steps are taken is the business of `sam.plastic.history`.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from sam.contact import BoxContact, Contact, Grid, around, measured, no_contact
from sam.convolution import Counters, Window
from sam.elastic import load_step, plane_stress
from sam.grid import CellGrid, contact_modulus, gap_of
from sam.plastic.history import Extent, History, Peak, Progressed, targets_of
from sam.plastic.outside import residual_stress, surface_lift
from sam.plastic.paper import PaperProblem
from sam.plastic.spectra import BoxOperator
from sam.plastic.step import CONTACT_SHARE, Material, Problem, State, Trial
from sam.record import Row, Snapshot
from sam.scene import Scene, Status
from sam.scene.result import Progress
from sam.stress import von_mises

ROUNDING, PAPER_SHARE = 1e-9, 1e2
GROWTH = 8  # a box grows by at least 1/GROWTH of its size on a side that is reached
LEAST_GROWTH = 3  # cells or layers
DEEPEST = 1.8  # contact half-widths: the first guess of the depth of the plastic zone is at most this


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
    _outside: dict[str, np.ndarray] = field(default_factory=dict)

    def __post_init__(self):
        self.surface = Grid((self.grid.nx, self.grid.ny), self.grid.hy / self.grid.hx, self.counters)
        self.gap0 = gap_of(self.scene, self.grid)
        self.unit = contact_modulus(self.scene) / 2
        self.problem = self._problem(self.extent)
        self.state = self.problem.virgin()

    def _problem(self, extent: Extent) -> Problem:
        """Operators and material of a box."""
        body, grid, window = self.scene.body, self.grid, extent.window
        mu, faces = body.young / (2 * (1 + body.poisson)), grid.faces[: extent.layers + 1]
        operator = BoxOperator(window.nx, window.ny, grid.hx, grid.hy, faces, mu, body.poisson, self.counters)
        factor = body.plasticity.depth_profile()(grid.depths[: extent.layers])
        material = Material(mu, body.plasticity.curve(), factor)
        tolerance = self.scene.solver.tolerance
        contact, gap0 = BoxContact(self.surface, window), self.gap0[window.slices]
        solver = self.scene.solver
        kind = PaperProblem if solver.method == "paper" else Problem
        problem = kind(operator, contact, material, gap0, grid.hx * grid.hy, self.unit, tolerance, self.counters)
        if solver.method == "paper":
            problem.stop = solver.stop
        return problem

    @classmethod
    def continued(cls, scene: Scene, grid: CellGrid, counters: Counters, start: Progressed) -> Run:
        """The run as it was when `start` was recorded, the counters included."""
        run = cls(scene, grid, counters, start.extent)
        run.state, run.last = start.state, start.last
        vars(counters).update(vars(start.counters))
        return run

    def attempt(self, force: float) -> Trial | None:
        """A step to `force` on a box that holds it, committed if it converged; None if the grid cannot hold it."""
        while True:
            trial = self.problem.step(self.state, force, self._guess(force))
            if not trial.converged:
                return trial
            if self._grow(trial):
                continue  # the same step again, from the committed state, on the larger box
            if self.status is not Status.CONVERGED:
                return None
            self.commit(trial)
            return trial

    def give_up(self) -> None:
        """A step did not converge however often it was halved."""
        self.status = Status.STEP_CUT_LIMIT

    def commit(self, trial: Trial) -> None:
        """The one place where the state changes."""
        self.state, self.last = self.problem.commit(self.state, trial), trial

    def _guess(self, force: float) -> np.ndarray | None:
        """The increment of the last step, scaled with the force, while the load rises."""
        last = self.last
        if last is None or not last.plastic or last.increment.shape != self.state.strain.shape:
            return None
        ratio = (force - self.state.force) / (last.step_force or np.inf)
        return ratio * last.increment if 0 < ratio <= 1 + 1e-9 else None

    def _grow(self, trial: Trial) -> bool:
        """Enlarge the box when plastic strain or contact reaches its sides; True if it did."""
        strained = trial.increment.any(axis=0)
        on_surface = strained.any(axis=0) | (trial.pressure > 0)
        window, layers = self.extent.window, self.extent.layers
        sides = on_surface[:2].any() or on_surface[-2:].any(), on_surface[:, :2].any() or on_surface[:, -2:].any()
        deep = strained[-1].any()
        if not (deep or any(sides)):
            return False
        i, nx = _widened(window.i0, window.nx, self.grid.nx) if sides[0] else (window.i0, window.nx)
        j, ny = _widened(window.j0, window.ny, self.grid.ny) if sides[1] else (window.j0, window.ny)
        more = min(layers + max(LEAST_GROWTH, layers // GROWTH), len(self.grid.depths)) if deep else layers
        extent = Extent(Window(i, j, nx, ny), more)
        if extent == self.extent:  # the grid ends here: say so unless only its outermost cells are free
            at_edge = (strained[-1].any() and deep) or strained[:, [0, -1]].any() or strained[:, :, [0, -1]].any()
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
        self.state = State(strain, alpha, residual, lift, pressure, before.force)

    def contact(self, trial: Trial) -> Contact:
        """The contact of a step in its box, with the residuals measured there."""
        return self._measured(trial.force, self.problem.gap0 + trial.lift, trial.pressure, self.problem.contact.apply)

    def contact_on_grid(self, trial: Trial) -> Contact:
        """The contact on the full grid, its residuals measured there: pile-up outside the box counts."""
        window = self.extent.window
        p = np.zeros(self.surface.shape)
        p[window.slices] = trial.pressure
        operator = self.surface.operator(window, self.surface.whole)
        return self._measured(trial.force, self.gap0 + self.lift(), p, lambda p: operator(p[window.slices]))

    def _measured(self, force: float, gap0: np.ndarray, p: np.ndarray, displacement) -> Contact:
        if force == 0:
            return no_contact(gap0)
        grid, tolerance, box = self.grid, self._contact_tolerance(), around(p > 0)
        u = displacement(p)
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
            self._outside = {"strain": self.state.strain, "lift": self._lift(), "stress": self._residual_stress()}
        return self._outside["lift"]

    def residual_stress(self) -> np.ndarray:
        """Stress of the plastic strain in the rows that touch y = 0, at all depths; computed once for a strain."""
        self.lift()
        return self._outside["stress"]

    def _residual_stress(self) -> np.ndarray:
        grid, body, faces = self.grid, self.scene.body, self.grid.faces[: self.extent.layers + 1]
        return residual_stress(
            self.state.strain, self.extent.window, faces, grid.depths, grid.axis_rows, grid.hx, grid.hy,
            self.problem.material.mu, body.poisson, self.counters,
        )  # fmt: skip

    def _lift(self) -> np.ndarray:
        grid, faces = self.grid, self.grid.faces[: self.extent.layers + 1]
        nu = self.scene.body.poisson
        return surface_lift(
            self.state.strain, self.extent.window, faces, self.surface.whole, grid.hx, grid.hy, nu, self.counters
        )

    def snapshot(self, name: str, trial: Trial) -> Snapshot:
        """Stress and strain in the plane y = 0: of the cells in the box, and at the cell centres outside it."""
        grid, rows, contact = self.grid, self.grid.axis_rows, self.contact_on_grid(trial)
        stress = plane_stress(self.scene, grid, contact, self.counters) + self.residual_stress()
        window, layers = self.extent.window, self.extent.layers
        inside = slice(window.i0, window.i0 + window.nx)
        in_box = slice(rows.j0 - window.j0, rows.j0 - window.j0 + rows.ny)
        strain, peeq = np.zeros_like(stress), np.zeros_like(stress[0])
        stress[:, :layers, inside] = trial.stress[..., in_box]
        strain[:, :layers, inside] = self.state.strain[..., in_box]
        peeq[:layers, inside] = self.state.alpha[..., in_box]
        return Snapshot(name, contact, self.lift(), stress, strain, peeq)


def _widened(first: int, count: int, limit: int) -> tuple[int, int]:
    """A range of cells with more on both sides, inside 0 .. limit."""
    more = max(LEAST_GROWTH, count // GROWTH)
    start, stop = max(first - more, 0), min(first + count + more, limit)
    return start, stop - start


def first_extent(scene: Scene, grid: CellGrid, counters: Counters) -> Extent:
    """Box around the contact and the cells that would yield if the body stayed elastic at the peak."""
    contact = load_step(scene, grid, scene.loading.force, None, counters)
    mises = von_mises(plane_stress(scene, grid, contact, counters)).max(axis=-1)
    plasticity = scene.body.plasticity
    limit = plasticity.depth_profile()(grid.depths) * plasticity.curve().stress(np.zeros(1))
    box = around(contact.pressure > 0)
    half_width = min(box.nx * grid.hx, box.ny * grid.hy) / 2
    yields = mises > limit[:, None]
    deep = np.flatnonzero(yields.any(axis=1) & (grid.depths <= DEEPEST * half_width))
    # as far beside the contact as the elastic zone, at most a sixth of the contact: the plastic one is narrower
    margin = int(np.clip(box.i0 + 2 - np.flatnonzero(yields.any(axis=0))[0], 0, box.nx // 6))
    i0, j0 = max(box.i0 - margin, 0), max(box.j0 - margin, 0)
    i1, j1 = min(box.i0 + box.nx + margin, grid.nx), min(box.j0 + box.ny + margin, grid.ny)
    layers = min(int(deep[-1]) + 2 if deep.size else 2, len(grid.depths))
    return Extent(Window(i0, j0, i1 - i0, j1 - j0), layers)


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
        history = History(run, committed, targets_of(scene.loading))
    else:
        run = Run.continued(scene, grid, counters, start)
        history = History.continued(run, committed, start)
    total = scene.loading.cycles * (scene.loading.steps + scene.loading.unload)
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
        last = run.last or run.problem.step(run.state, 0.0)
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
    return Found(history.rows, states, peak.peeq_max, certificate, discretisation, run.status, _warnings(run, peak))


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
    plasticity, window = run.scene.body.plasticity, run.extent.window
    limit = plasticity.depth_profile()(run.grid.depths) * plasticity.curve().stress(np.zeros(1))
    excess = von_mises(snapshot.in_plane) / limit[:, None] - 1
    excess[: run.extent.layers, window.i0 : window.i0 + window.nx] = 0.0
    return float(max(excess.max(), 0.0))
