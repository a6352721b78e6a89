# SPDX-License-Identifier: MIT
"""The loops of Bosman & Schipper as printed (Fig. 5 to 7), kept to show what they do; not the default.

Outside, contact and residual displacement take turns until the surface stands still. Inside, at frozen pressure, the return
map of the CURRENT stress is added to the plastic strain, and its length to the accumulated strain, again and again until the
stress is inside the yield surface (stop = "stress", the paper's loop) or the strain stands still (stop = "strain", the loop
it replaces, Jacq 2002). The sum of such returns meets the yield condition but not the flow rule over the step: each was
made in the direction of an intermediate stress.
"""

from __future__ import annotations

import numpy as np

from sam.contact.stress import von_mises
from sam.loading import Load
from sam.plasticity.return_map import deviator, equivalent_strain
from sam.plasticity.step import CONTACT_SHARE, Change, Problem, State, Trial

OUTER, INNER = 60, 400


class PaperProblem(Problem):
    """A `Problem` whose steps are made by the nested loops. stop: "stress" or "strain"."""

    stop: str = "stress"

    def step(
        self, state: State, load: Load, guess: Change | None = None, start: np.ndarray | None = None,
        tolerance: float | None = None,
    ) -> Trial:  # fmt: skip
        """From a committed state to a load. guess, start and tolerance are not used: the loops start from the state."""
        x, length = np.zeros_like(state.strain), np.zeros_like(state.alpha)
        lift, residual, pressure, history = state.lift, state.residual, state.pressure, []
        settled = done = False
        for _ in range(OUTER):
            pressure = self.press(lift, load, pressure, CONTACT_SHARE * self.tolerance)
            elastic = self.stress(pressure, load)  # paper Eq. 7, first sum
            last, (x, length, lift, residual, done) = (
                lift,
                self._relax(state, x, length, lift, residual, elastic),
            )
            moved = np.abs(lift - last).max() / max(np.abs(lift).max(), np.finfo(float).tiny)
            history.append(float(moved))
            settled = done and moved <= self.tolerance
            if settled or not done:
                break
        stress = elastic + residual
        excess, flow = self.residuals(state, x, deviator(stress))
        limit = self.material.yield_stress(state.alpha + length)
        excess = float(max(np.max(von_mises(stress) / limit - 1), 0.0))
        return Trial(
            load=load,
            increment=x,
            length=length,
            stress=stress,
            residual=residual,
            lift=lift,
            pressure=pressure,
            yield_excess=excess,
            flow_residual=flow,
            history=tuple(history),
            converged=settled,
            step_force=load.force - state.load.force,
            goal=self.tolerance,
        )

    def _relax(self, state: State, x, length, lift, residual, elastic):
        """The plasticity loop at frozen pressure: (x, length, lift, residual, whether it stopped by its criterion)."""
        for _ in range(INNER):
            stress = elastic + residual  # paper Eq. 4
            alpha = state.alpha + length
            q, limit = von_mises(stress), self.material.yield_stress(alpha)
            # paper Eq. 8, as the stop of Fig. 7
            if self.stop == "stress" and np.max(q / limit - 1) <= self.tolerance:
                return x, length, lift, residual, True
            yielding = q > limit
            if not yielding.any():
                return x, length, lift, residual, True
            now = State(state.strain, alpha, state.residual, state.lift, state.pressure)
            gamma = self.multiplier(now, q, yielding, self.material.mu)
            change = np.zeros_like(x)
            change[:, yielding] = 1.5 * gamma / q[yielding] * deviator(stress)[:, yielding]
            x, length = x + change, length.copy()
            length[yielding] += gamma
            self.counters.plastic_iterations += 1
            lift, residual = self.plastic_part(state, x)
            total = equivalent_strain(state.strain + x).max()
            if self.stop == "strain" and equivalent_strain(change).max() <= self.tolerance * total:
                return x, length, lift, residual, True
        return x, length, lift, residual, False
