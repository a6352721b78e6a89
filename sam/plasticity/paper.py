# SPDX-License-Identifier: MIT
"""The loops of Bosman & Schipper as printed (Fig. 5 to 7), kept to show what they do; not the default.

Outside, contact and residual displacement take turns until the surface stands still. Inside, at frozen
pressure, the return map of the CURRENT stress is added to the plastic strain, and its length to the
accumulated strain, again and again until the stress is inside the yield surface (stop = "stress", the paper's
loop) or the strain stands still (stop = "strain", the loop it replaces, Jacq 2002). The sum of such returns
meets the yield condition but not the flow rule over the step: each was made in the direction of an
intermediate stress.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from sam.arrays import Array
from sam.contact.operators import von_mises, yielding
from sam.plasticity.flow import contraction, deviator, equivalent_strain
from sam.plasticity.load_step import CONTACT_SHARE, Problem
from sam.plasticity.points import POINTS
from sam.plasticity.state import CellFields, Change, MaterialFields, ResidualFields, State, Trial
from sam.schedule import Load

OUTER = 60  # alternations of contact and displacement; they end by their criterion, or the step is halved
INNER = 400  # returns at frozen pressure; likewise


@dataclass(frozen=True)
class Sum:
    """The sum of the returns so far, its accumulated length, residual fields, whether the loop stopped."""

    x: Array
    length: Array
    residual: ResidualFields
    stopped: bool = False


@dataclass(frozen=True)
class PaperProblem(Problem):
    """A `Problem` whose steps are made by the nested loops. stop: "stress" or "strain"."""

    stop: str = "stress"

    def step(
        self,
        state: State,
        load: Load,
        *,
        guess: Change | None = None,
        start: Array | None = None,
        retest: Callable[[Trial], Problem | None] | None = None,
    ) -> Trial:
        """A step from a committed state, where the loops start; guess, start, retest are not used."""
        # the loops are of cells, as printed
        begun = MaterialFields(state.material.strain, state.material.peeq)
        zero = np.zeros_like(begun.strain), np.zeros_like(begun.peeq)
        total, pressure, history = Sum(*zero, state.residual), state.pressure, []
        converged = False
        for _ in range(OUTER):
            last = total.residual.displacement
            pressure = self.pressure(last, load, pressure, CONTACT_SHARE * self.tolerance)
            elastic = self.stress(pressure, load)  # paper Eq. 7, first sum
            total = self._relaxed(begun, state.residual, total, elastic)
            displaced = total.residual.displacement
            moved = np.abs(displaced - last).max() / max(np.abs(displaced).max(), np.finfo(float).tiny)
            history.append(float(moved))
            converged = bool(total.stopped and moved <= self.tolerance)
            if converged or not total.stopped:
                break
        stress = elastic + total.residual.stress
        step, m = self.material.flow(begun), self.material.mu
        again = step.returned(deviator(stress) + 2 * m * total.x, m, near=equivalent_strain(total.x))
        flow = 2 * m * np.sqrt(contraction(again - total.x, again - total.x).max())
        increment, cells = step.increment(total.x, total.length), total.length > 0
        points = increment.each(lambda values: np.repeat(values[..., None, cells], POINTS, axis=-2))
        limit = self.material.yield_stress(begun.peeq + total.length)
        return Trial(
            load=self.pressure.loaded(load, pressure),
            increment=CellFields(cells, points),
            stress=stress,
            residual=total.residual,
            pressure=pressure,
            yield_excess=float(max(np.max(von_mises(stress) / limit - 1), 0.0)),
            flow_residual=float(flow / self.material.initial_yield),
            history=tuple(history),
            converged=converged,
            rise=load.rise(state.load),
            goal=self.tolerance,
        )

    def _relaxed(self, begun: MaterialFields, left: ResidualFields, before: Sum, elastic: Array) -> Sum:
        """The plasticity loop at frozen pressure, from the returns so far; begun, left: before the step."""
        x, length, residual = before.x, before.length, before.residual
        for _ in range(INNER):
            stress = elastic + residual.stress  # paper Eq. 4
            peeq = begun.peeq + length
            q, limit = von_mises(stress), self.material.yield_stress(peeq)
            # paper Eq. 8, as the stop of Fig. 7
            if self.stop == "stress" and np.max(q / limit - 1) <= self.tolerance:
                return Sum(x, length, residual, True)
            flowing = yielding(q, limit)
            if not flowing.any():
                return Sum(x, length, residual, True)
            flow = self.material.flow(MaterialFields(strain=x, peeq=peeq))
            gamma = flow.multiplier(q, flowing, m=self.material.mu)
            change = np.zeros_like(x)
            change[:, flowing] = 1.5 * gamma / q[flowing] * deviator(stress)[:, flowing]
            x, length = x + change, length.copy()
            length[flowing] += gamma
            self.counters.plastic_iterations += 1
            residual = self.residual(left, x)
            total = equivalent_strain(begun.strain + x).max()
            if self.stop == "strain" and equivalent_strain(change).max() <= self.tolerance * total:
                return Sum(x, length, residual, True)
        return Sum(x, length, residual)
