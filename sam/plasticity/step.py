# SPDX-License-Identifier: MIT
"""One load step of elasto-plastic contact: plastic strain, stress and contact solved together.

Paper Fig. 5 to 7 nest three loops; here there is one. The unknown is the increment x of the plastic strain
over the step. One evaluation solves the contact on the surface that x has displaced, takes the stress of both
(Eq. 7) and returns it to the yield surface; its fixed point is the backward-Euler solution, found by Anderson
acceleration of preconditioned changes. In full slip the traction is q = coefficient * p everywhere in the
iteration: in the gap and in the stress.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial

import numpy as np

from sam.arrays import Array
from sam.contact.convolution import Counters
from sam.plasticity.anderson import Anderson
from sam.plasticity.flow import Material
from sam.plasticity.points import POINTS, CellFlow, Returned, whole
from sam.plasticity.preconditioner import preconditioned, stiffness_of_parts
from sam.plasticity.pressure import PressureSource
from sam.plasticity.return_map import SHEAR, deviator
from sam.plasticity.spectra import BoxOperator
from sam.plasticity.state import Change, MaterialFields, Residual, State, Trial
from sam.schedule import UNLOADED, Load

# Measured: operator applications (and contact iterations, ci) on a sphere of perfect plasticity at p0 = 3
# yield stresses, 25 x 25 cells, 4 steps and back at 1e-6: 40 applications and 150 ci with the values below.
# Iterates that the acceleration combines: 47 with 2 of them, 41 with 4, 40 with 16.
WINDOW = 8
# Stiffness over mu with which a part of a cell relaxes, see `sam.plasticity.points`: about that of a sphere
# in its surroundings, 0.52 for nu = 0.3 (Eshelby 1957). It is part of the discretisation, and of the
# fixed-point map: 53 applications with 0.25, 46 with 1.
STIFFNESS = 0.5
# Most iterations of a step before it is halved: 30 and 120 change nothing, steps that converge take
# fewer.
ITERATIONS = 60
# The same two of the longer iteration, where halving a step does not help: below a soft thin layer whose
# traction is three times its shear strength (strains of 1.6), a step takes 32 iterations with 20 and 45 with
# 8; with a strain of 4 it takes 50, and more than ITERATIONS with 8.
LONG_WINDOW = 20
LONG_ITERATIONS = 600
# Share of the plastic residual to which the contact is solved: 181 ci with 1e-3; with 1e-1 the residual of
# the contact is found too large.
CONTACT_SHARE = 1e-2
# Share of the plastic residual that the next iteration leaves, for which its contact is solved: 174 ci with
# 1e-2; 120 ci with 1, but 6438 transforms in place of 6306.
AHEAD = 0.1
# Tolerance of the first contact of a step: 154 ci with 1e-4, 147 with 1e-2.
FIRST_CONTACT = 1e-3


@dataclass(frozen=True)
class Iterate:
    """One iterate of a step, on the cells that the operator keeps of the box.

    x: increment of the plastic strain; displacement: of the whole surface by the plastic strain, in m; base:
    the part of the residual stress that is known, in Pa; response: transform of the rest of it, None if there
    is none.
    """

    x: Array
    displacement: Array
    base: Array
    response: Array | None = None


@dataclass(frozen=True)
class Evaluated:
    """What the contact and the return map make of an iterate: p_hat, and the stress in Pa."""

    pressure: Array
    stress: Array
    returned: Returned


@dataclass(frozen=True)
class Problem:
    """Everything that stays the same over a load step on a box.

    pressure: gives p_hat; unit: Pa per p_hat; tolerance: on yield_excess and flow_residual; coefficient: of
    friction, a number or (nx, ny); misfit: stress of a misfit strain at its full size, (6, n_layers, nx, ny)
    in Pa, None without one; longer: whether a step may take LONG_ITERATIONS with LONG_WINDOW.
    """

    operator: BoxOperator
    pressure: PressureSource
    material: Material
    unit: float
    tolerance: float
    counters: Counters
    coefficient: float | Array = 0.0
    misfit: Array | None = None
    longer: bool = False

    def virgin(self) -> State:
        """The body before the first load."""
        shape = (self.operator.layers, *self.operator.shape)
        nothing = Residual(np.zeros((6, *shape)), np.zeros(self.operator.shape))
        return State(self.material.virgin((POINTS, *shape)), nothing, self.pressure.start(UNLOADED))

    def traction(self, pressure: Array, load: Load) -> Array | None:
        """q_x on the body in the unit of the pressure, (nx, ny); None without friction."""
        return load.sign * self.coefficient * pressure if np.any(self.coefficient) else None

    def stress(self, pressure: Array, load: Load, response: Array | None = None) -> Array:
        """Stress in Pa of p_hat (on the box), its traction and a misfit strain, and of plastic strain, see
        `BoxOperator.stress`.
        """
        keep, pressure = self.operator.keep, pressure * self.unit
        traction = self.traction(pressure, load)
        found = self.operator.stress(keep(pressure), response, None if traction is None else keep(traction))
        return found if self.misfit is None else found + load.misfit * keep(self.misfit)

    def residual(self, before: Residual, x: Array) -> Residual:
        """The residual fields `before` and those of a plastic strain x: one application of the operator."""
        operator = self.operator
        transformed = operator.transformed(operator.keep(x))
        displacement = operator.whole(operator.displacement(transformed))
        stress = operator.whole(operator.stress(None, operator.response(transformed)))
        return before.plus(Residual(stress, displacement))

    def residual_of(self, material: MaterialFields) -> Residual:
        """The residual fields of a material; nothing is applied where it is unstrained."""
        nothing = self.virgin().residual
        return self.residual(nothing, material.strain) if material.strain.any() else nothing

    def stays_elastic(self, state: State) -> bool:
        """Whether the stress that is left without any load is within the yield surface."""
        s = deviator(self.operator.keep(state.residual.stress))
        return self.flow(state).stays_elastic(s, self.tolerance)

    def flow(self, state: State) -> CellFlow:
        """How the kept cells yield over a step that begins in a state."""
        before = state.points.each(self.operator.keep)
        return CellFlow(self.material, before, self.operator.transforms, self.stiffness)

    @property
    def stiffness(self) -> float:
        """Stiffness in Pa with which the plastic strain of a part of a cell lowers its own stress."""
        return STIFFNESS * self.material.mu

    def step(
        self,
        state: State,
        load: Load,
        *,
        guess: Change | None = None,
        start: Array | None = None,
        tolerance: float | None = None,
    ) -> Trial:
        """Make a load step, plastic strain, stress and contact together: its end, converged or not.

        Parameters
        ----------
        state
            The committed state at its beginning.
        load
            The load at its end.
        guess
            A change of the plastic strain to start from, say that of the last step.
        start
            p_hat to start from, (nx, ny); that of the state if it is not given.
        tolerance
            Another one than that of the problem.
        """
        goal = self.tolerance if tolerance is None else tolerance
        finest, flow = CONTACT_SHARE * goal, self.flow(state)
        now, residual = self._first(state, guess)
        window, most = (LONG_WINDOW, LONG_ITERATIONS) if self.longer else (WINDOW, ITERATIONS)
        anderson = Anderson(window, np.sqrt(SHEAR)[:, None, None, None])
        pressure, accuracy = state.pressure if start is None else start, FIRST_CONTACT
        history: list[float] = []
        while True:
            found = self._evaluated(now, flow, load, start=pressure, accuracy=accuracy)
            pressure, worst = found.pressure, found.returned.worst(goal)
            history.append(worst)
            if (worst <= goal and accuracy <= finest) or len(history) > most:
                break
            accuracy = max(min(CONTACT_SHARE * AHEAD * worst, accuracy), finest)
            if worst <= goal:
                accuracy = finest  # once more, with the contact as good as promised
                continue
            now = self._iterate(anderson.next(now.x, self._image(now, found, flow)), state.residual)
            self.counters.plastic_iterations += 1
        if now.response is not None:
            residual = self._residual(now, found, load)
        return Trial(
            load=self.pressure.found(load, pressure),
            points=flow.increment(found.returned).each(partial(whole, self.operator.transforms)),
            stress=self.operator.whole(found.stress),
            residual=residual,
            pressure=pressure,
            yield_excess=found.returned.yield_excess,
            flow_residual=found.returned.flow_residual,
            history=tuple(history),
            converged=bool(worst <= goal and np.isfinite(worst)),
            rise=load.rise(state.load),
            goal=goal,
        )

    def _first(self, state: State, guess: Change | None) -> tuple[Iterate, Residual]:
        """The iterate that a step begins from, and its residual fields."""
        keep = self.operator.keep
        if guess is None:
            x, residual = np.zeros_like(keep(state.material.strain)), state.residual
        else:
            x, residual = keep(guess.strain), state.residual.plus(guess.residual)
        return Iterate(x, residual.displacement, keep(residual.stress)), residual

    def _iterate(self, x: Array, before: Residual) -> Iterate:
        """The iterate with the increment x of the plastic strain, after the residual fields `before`."""
        operator = self.operator
        transformed = operator.transformed(x)
        displacement = before.displacement + operator.whole(operator.displacement(transformed))
        return Iterate(x, displacement, operator.keep(before.stress), operator.response(transformed))

    def _evaluated(
        self, now: Iterate, flow: CellFlow, load: Load, *, start: Array, accuracy: float
    ) -> Evaluated:
        """The contact of an iterate, solved from `start` to this accuracy, and its residuals."""
        pressure = self.pressure(now.displacement, load, start, accuracy)
        stress = now.base + self.stress(pressure, load, now.response)  # paper Eq. 4 and 7
        return Evaluated(pressure, stress, flow.returned(now.x, deviator(stress)))

    def _image(self, now: Iterate, found: Evaluated, flow: CellFlow) -> Array:
        """The increment that the fixed-point map makes of an iterate, preconditioned."""
        own = stiffness_of_parts(self.operator.own_stress)
        return preconditioned(now.x, found.returned.image, flow.limit, m=self.stiffness, own=own)

    def _residual(self, now: Iterate, found: Evaluated, load: Load) -> Residual:
        """The residual fields of an iterate: the stress is what the load does not make."""
        stress = found.stress - self.stress(found.pressure, load)  # paper Eq. 4
        return Residual(self.operator.whole(stress), now.displacement)
