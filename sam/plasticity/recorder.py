# SPDX-License-Identifier: MIT
"""What is recorded of a load history: contacts, states and cycles of a `Run`, measured on what it returns."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from sam.contact.normal import Contact, Found, Units, around, measured, no_contact
from sam.contact.stress import von_mises
from sam.elastic import plane_stress
from sam.friction import Coefficient
from sam.grid.cells import Window
from sam.loading import Load, given_contact, leaves_axis, off_origin
from sam.plasticity.outside import residual_stress, surface_lift
from sam.plasticity.pointwise import at_centres, largest
from sam.plasticity.step import CONTACT_SHARE, Trial
from sam.record import CycleEnd, Snapshot, counted
from sam.scene.residuals import unfinished
from sam.sliding import Sliding

if TYPE_CHECKING:
    from sam.cut import Cut
    from sam.plasticity.run import Run

ROUNDING, PAPER_SHARE = 1e-9, 1e2


class Recorder:
    """Reads a run, and changes nothing of it but its counters. What is outside of the box is computed once for a strain."""

    def __init__(self, run: Run):
        self.run, self.scene, self.grid, self.counters = run, run.scene, run.grid, run.counters
        self._outside: dict[str, np.ndarray] = {}

    def known(self) -> dict[str, np.ndarray]:
        """What is known outside of the box for the strain as it is."""
        current = self._outside.get("strain") is self.run.state.strain
        return {name: field for name, field in self._outside.items() if name != "strain"} if current else {}

    def recall(self, known: dict[str, np.ndarray]) -> None:
        """Go on with what was known of the state that the run is in."""
        self._outside = {"strain": self.run.state.strain, **known} if known else {}

    def contact(self, trial: Trial) -> Contact:
        """The contact of a step in its box, with the residuals measured there."""
        load, p, gap0 = trial.load, trial.pressure, self.run.gap0[self.run.extent.window.slices] + trial.lift
        if load.force == 0:
            return no_contact(gap0)
        if self.scene.loading.prescribed:
            return self._given(load, p, np.zeros_like(p))
        return self._measured(load.force, gap0, p, self.run.problem.press.contact.displacement(p, load.sign))

    def contact_on_grid(self, trial: Trial) -> Contact:
        """The contact on the full grid, its residuals measured there: pile-up outside the box counts."""
        window, load = self.run.extent.window, trial.load
        if load.force == 0:
            return no_contact(self.run.gap0 + self.lift())
        p = np.zeros(self.run.surface.shape)
        p[window.slices] = trial.pressure
        u = self.run.surface.displacement(trial.pressure, window, self.run.surface.whole, load.sign)
        if self.scene.loading.prescribed:
            return self._given(load, p, u)
        return self._measured(load.force, self.run.gap0 + self.lift(), p, u)

    def _given(self, load: Load, p: np.ndarray, u: np.ndarray) -> Contact:
        cell = self.grid.hx * self.grid.hy
        return given_contact(self.scene, load, p * self.run.unit, u * self.grid.hx, cell)

    def _measured(self, force: float, gap0: np.ndarray, p: np.ndarray, u: np.ndarray) -> Contact:
        grid, tolerance, fields = self.grid, self._contact_tolerance(), Found(p, u, around(p > 0))
        units = Units(grid.hx, grid.hy, 2 * self.run.unit)
        found = measured(self.run.surface, gap0, fields, units, force=force, tolerance=tolerance)
        if found.converged:
            return found
        residuals = self.run.problem.press.contact.residuals
        return replace(found, ending=unfinished("the contact iteration of a load step", residuals, tolerance))

    def _contact_tolerance(self) -> float:
        """The residual that the contact may have: it is solved to CONTACT_SHARE of the plastic tolerance.

        The transforms of another window round differently (ROUNDING); the paper's loops leave the last move of the surface.
        """
        share = PAPER_SHARE if self.scene.solver.method == "paper" else CONTACT_SHARE
        return share * self.scene.solver.tolerance + ROUNDING

    def lift(self) -> np.ndarray:
        """Residual displacement of the whole surface, (nx, ny) in m."""
        if self._outside.get("strain") is not self.run.state.strain:
            whole = self.run.extent.window == self.run.surface.whole
            lift = self.run.state.lift if whole else self._moved(3, self.run.surface.whole)
            self._outside = {"strain": self.run.state.strain, "lift": lift}
        return self._outside["lift"]

    def residual_stress(self) -> np.ndarray:
        """Stress of the plastic strain in the rows that touch y = 0, at all depths; computed once for a strain."""
        self.lift()
        if "stress" not in self._outside:
            self._outside["stress"] = self._residual_stress()
        return self._outside["stress"]

    def _residual_stress(self) -> np.ndarray:
        """Where the box covers the rows its own stresses are taken, see `snapshot`: zero there."""
        grid, body, faces = self.grid, self.scene.body, self.grid.faces[: self.run.extent.layers + 1]
        window, rows = self.run.extent.window, grid.axis_rows
        across = window.j0 <= rows.j0 and rows.j0 + rows.ny <= window.j0 + window.ny
        covered = self.run.extent.layers if across and window.nx == grid.nx else 0
        below = residual_stress(
            self.run.state.strain, window, faces, grid.depths[covered:], rows, grid.hx, grid.hy,
            self.run.problem.material.mu, body.poisson, self.counters,
        )  # fmt: skip
        return np.concatenate([np.zeros((6, covered, *below.shape[2:])), below], axis=1)

    def _moved(self, component: int, observed: Window) -> np.ndarray:
        """Displacement of a window of the surface by the plastic strain, (nx, ny) in m."""
        grid, faces = self.grid, self.grid.faces[: self.run.extent.layers + 1]
        return surface_lift(
            self.run.state.strain, self.run.extent.window, faces, observed, grid.hx, grid.hy, self.scene.body.poisson,
            self.counters, component,
        )  # fmt: skip

    def friction(self, trial: Trial) -> Coefficient:
        """Of friction on the box, with the sign of the traction."""
        return trial.load.sign * self.run.problem.coefficient

    def snapshot(self, name: str, trial: Trial) -> Snapshot:
        """Stress and strain in the plane y = 0: of the cells in the box, and at the cell centres outside it."""
        grid, rows, contact = self.grid, self.grid.axis_rows, self.contact_on_grid(trial)
        mu = self.run.coefficient
        stress = (
            plane_stress(self.scene, grid, trial.load, contact, self.counters, coefficient=mu)
            + self.residual_stress()
        )
        window, layers = self.run.extent.window, self.run.extent.layers
        inside = slice(window.i0, window.i0 + window.nx)
        strain, peeq = np.zeros_like(stress), np.zeros_like(stress[0])
        for row, j in enumerate(range(rows.j0 - window.j0, rows.j0 - window.j0 + rows.ny)):
            if 0 <= j < window.ny:
                stress[:, :layers, inside, row] = trial.stress[..., j]
                strain[:, :layers, inside, row] = self.run.state.strain[..., j]
                peeq[:layers, inside, row] = self.run.state.alpha[..., j]
        sliding = Sliding.elastic(self.scene, grid, trial.load, contact, self.counters, coefficient=mu)
        if sliding is not None:
            sliding = sliding.strained(self._moved(1, rows), strain, np.diff(grid.faces))
        anywhere = self.scene.surface is not None or leaves_axis(self.scene)
        mises = self._largest(stress, trial, contact) if anywhere else None
        return Snapshot(
            name, contact, self.lift(), stress, strain, peeq, sliding, mises=mises, top=self._top(),
            worn=None if self.run.ledger is None else self.run.ledger.depth, cut=self._cut(trial, contact),
        )  # fmt: skip

    def _cut(self, trial: Trial, contact: Contact) -> Cut | None:
        """The cells of the box in the row of the largest pressure; None without contact, or where that is around the origin."""
        if not off_origin(self.scene) or trial.load.force == 0:
            return None
        from sam.cut import Cut, row_of_largest

        window, layers, grid = self.run.extent.window, self.run.extent.layers, self.grid
        row = row_of_largest(contact, counted(contact, grid))
        if row is None or not window.j0 <= row < window.j0 + window.ny:
            return None
        x, j = grid.x[window.i0 : window.i0 + window.nx], row - window.j0
        return Cut(
            float(grid.y[row]), x, grid.depths[:layers], trial.stress[..., j].copy(), self.run.state.alpha[..., j].copy(),
        )  # fmt: skip

    def _top(self) -> tuple[float, float] | None:
        """Depth in m and value of the largest plastic strain; cells hold means."""
        alpha, layers = self.run.state.alpha, self.run.extent.layers
        if not alpha.any():
            return None
        depths = self.grid.depths[:layers]
        interval = self.scene.body.plasticity.depth_profile().interval(depths)
        return largest(at_centres(alpha, self.grid.faces[: layers + 1], interval), depths, interval)

    def _largest(self, plane: np.ndarray, trial: Trial, contact: Contact) -> np.ndarray:
        """At each depth the largest von Mises stress anywhere in Pa, (nz, 1); below the box in y = 0 only."""
        window, layers = counted(contact, self.grid).slices, self.run.extent.layers
        mises = von_mises(plane).max(axis=(-2, -1))
        mises[:layers] = von_mises(trial.stress)[(..., *window)].max(axis=(-2, -1))
        return mises[:, None]

    def ended(self, cycle: int) -> CycleEnd:
        """The surface at the end of a cycle, and how much is worn so far."""
        found, lowered = None, self.lift()
        if self.run.ledger is not None:
            lowered = lowered + self.run.ledger.depth
        if self.scene.surface is not None:
            from sam.grid.rough import RoughPatch

            found = RoughPatch.of(self.scene.surface, self.scene.grid).roughness(lowered)
        volume = self.run.ledger.volume if self.run.ledger is not None else 0.0
        return CycleEnd(cycle, volume, found, self.counters.operator_applications)
