# SPDX-License-Identifier: MIT
"""One load step of elasto-plastic contact: plastic strain, stress and contact solved together.

Paper Fig. 5 to 7 nest three loops; here there is one. The unknown is the increment x of the plastic strain over the step.
One evaluation solves the contact on the surface that x has displaced, takes the stress of both (Eq. 7) and returns it to the
yield surface; its fixed point is the backward-Euler solution, found by Anderson acceleration. In full slip the traction is
q = coefficient * p everywhere in the iteration: in the gap and in the stress.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from sam.contact.convolution import Counters
from sam.loading import UNLOADED, Load
from sam.plasticity.anderson import Anderson
from sam.plasticity.pressing import ContactPressure, GivenPressure
from sam.plasticity.return_map import SHEAR, contraction, deviator, equivalent_strain, plastic_multiplier
from sam.plasticity.spectra import BoxOperator
from sam.scene.yield_curve import YieldCurve

WINDOW = 8  # iterates that the acceleration combines
SELF_STIFFNESS = 0.5  # m/mu of the return map in the iteration: about that of a cell in its surroundings
ITERATIONS = 60
CONTACT_SHARE = 1e-2  # the contact is solved to this share of the plastic residual
AHEAD = 0.1  # of the plastic residual, about what the next iteration leaves: its contact is solved for that


@dataclass(frozen=True)
class Material:
    """Elastic constants (mu in Pa), yield curve, and the factor of the yield stress of each layer, (n_layers,)."""

    mu: float
    curve: YieldCurve
    factor: np.ndarray

    def yield_stress(self, alpha: np.ndarray) -> np.ndarray:
        """(n_layers, nx, ny) in Pa."""
        return self.factor[:, None, None] * self.curve.stress(alpha)  # phi of paper Eq. 8, with Eq. 18


@dataclass(frozen=True)
class State:
    """A committed state of the box. The only way to a new one is `Problem.commit`.

    strain: plastic strain (6, n_layers, nx, ny); alpha: its accumulated length (peeq); residual: stress of the plastic
    strain alone in Pa; lift: displacement that it gives the surface, (nx, ny) in m, > 0 into the body; pressure: p_hat.
    """

    strain: np.ndarray
    alpha: np.ndarray
    residual: np.ndarray
    lift: np.ndarray
    pressure: np.ndarray
    load: Load = UNLOADED


@dataclass(frozen=True)
class Change:
    """An increment of the plastic strain, and what it adds to the residual stress (Pa) and to the lift (m)."""

    increment: np.ndarray
    residual: np.ndarray
    lift: np.ndarray

    def times(self, ratio: float) -> Change:
        """All is linear in the increment."""
        return Change(ratio * self.increment, ratio * self.residual, ratio * self.lift)


@dataclass(frozen=True)
class Trial:
    """The end of a load step, converged or not: nothing is committed yet.

    increment: of the plastic strain; length: of the accumulated plastic strain, (n_layers, nx, ny); stress in Pa; residual:
    the part of it that the plastic strain makes; lift in m; yield_excess: max (mises - sigma_y)/sigma_y; flow_residual: 2 mu
    max |change of the increment by one more return map| / initial yield stress; history: their larger one, by iteration;
    goal: that it is to fall to; step_force: change of the force in N.
    """

    load: Load
    increment: np.ndarray
    length: np.ndarray
    stress: np.ndarray
    residual: np.ndarray
    lift: np.ndarray
    pressure: np.ndarray
    yield_excess: float
    flow_residual: float
    history: tuple[float, ...]
    converged: bool
    step_force: float
    goal: float

    @property
    def plastic(self) -> bool:
        """Whether the step strained any cell."""
        return bool(self.increment.any())

    def change(self, state: State) -> Change | None:
        """Of the state that the step began at; None if it strains nothing."""
        return (
            Change(self.increment, self.residual - state.residual, self.lift - state.lift)
            if self.plastic
            else None
        )


class Problem:
    """Everything that stays the same over the load steps of a box.

    press: gives p_hat; unit: Pa per p_hat; tolerance: on yield_excess and flow_residual; coefficient: of friction, a number
    or (nx, ny).
    """

    def __init__(
        self,
        operator: BoxOperator,
        press: ContactPressure | GivenPressure,
        material: Material,
        unit: float,
        tolerance: float,
        counters: Counters,
        coefficient: float | np.ndarray = 0.0,
    ):
        self.operator, self.press, self.material, self.unit = operator, press, material, unit
        self.tolerance, self.counters, self.coefficient = tolerance, counters, coefficient
        self.initial_yield = float(material.curve.stress(np.zeros(1))[0] * material.factor.min())

    def virgin(self) -> State:
        """The body before the first load."""
        shape = (self.operator.layers, *self.operator.shape)
        zero = np.zeros((6, *shape))
        surface = np.zeros(self.operator.shape)
        return State(zero, np.zeros(shape), zero, surface, self.press.start)

    def commit(self, state: State, trial: Trial) -> State:
        """The state after a converged step."""
        if not trial.converged:
            raise ValueError("a step that did not converge cannot be committed")
        # the same arrays where nothing yields: what hangs on them is still right
        strain, alpha = state.strain, state.alpha
        if trial.plastic:
            strain, alpha = strain + trial.increment, alpha + trial.length
        return State(strain, alpha, trial.residual, trial.lift, trial.pressure, trial.load)

    def traction(self, pressure: np.ndarray, load: Load) -> np.ndarray | None:
        """q_x on the body in the unit of the pressure, (nx, ny); None without friction."""
        return load.sign * self.coefficient * pressure if np.any(self.coefficient) else None

    def stress(self, pressure: np.ndarray, load: Load, response: np.ndarray | None = None) -> np.ndarray:
        """Stress in Pa of p_hat (on the box) and its traction, and of plastic strain, see `BoxOperator.stress`."""
        keep, pressure = self.operator.keep, pressure * self.unit
        traction = self.traction(pressure, load)
        return self.operator.stress(keep(pressure), response, None if traction is None else keep(traction))

    def plastic_part(self, state: State, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """(lift, residual stress) of the plastic strain of `state` and x: one application of the operator."""
        operator = self.operator
        transformed = operator.transformed(operator.keep(x))
        return (
            state.lift + operator.whole(operator.displacement(transformed)),
            state.residual + operator.whole(operator.stress(None, operator.response(transformed))),
        )

    def multiplier(
        self, state: State, q: np.ndarray, yielding: np.ndarray, m: float, near: np.ndarray | None = None
    ) -> np.ndarray:
        """Increment of the accumulated strain of the cells that yield, for their trial stress q: (n,); near: about the answer."""
        factor = np.broadcast_to(self.material.factor[:, None, None], q.shape)[yielding]
        near = None if near is None else near[yielding]
        return plastic_multiplier(
            q[yielding], state.alpha[yielding], self.material.curve, factor, 3 * m, near
        )

    def image(self, state: State, x: np.ndarray, s: np.ndarray, m: float) -> np.ndarray:
        """The increment that the return map gives for the deviatoric stress s + 2 m x: zero where that does not yield."""
        trial, length = s + 2 * m * x, equivalent_strain(x)
        q = np.sqrt(1.5 * contraction(trial, trial))
        yielding = q > self.material.yield_stress(state.alpha)  # paper Eq. 8 does not hold
        scale = np.zeros_like(q)
        scale[yielding] = 1.5 * self.multiplier(state, q, yielding, m, length) / q[yielding]
        return scale * trial

    def residuals(self, state: State, x: np.ndarray, s: np.ndarray) -> tuple[float, float]:
        """(yield_excess, flow_residual) of an increment and the deviatoric stress s that goes with it.

        yield_excess is how far paper Eq. 8 is violated.
        """
        limit = self.material.yield_stress(state.alpha + equivalent_strain(x))
        excess = np.max((np.sqrt(1.5 * contraction(s, s)) - limit) / limit)  # paper Eq. 8
        change = self.image(state, x, s, self.material.mu) - x
        flow = 2 * self.material.mu * np.sqrt(contraction(change, change).max()) / self.initial_yield
        return float(max(excess, 0.0)), float(flow)

    def _kept(self, state: State) -> State:
        """The state on the cells that the operator keeps of the box; its surface on all of them."""
        keep = self.operator.keep
        return replace(
            state, strain=keep(state.strain), alpha=keep(state.alpha), residual=keep(state.residual)
        )

    def stays_elastic(self, state: State) -> bool:
        """Whether the stress that is left without any load is within the yield surface."""
        return (
            self.residuals(state, np.zeros_like(state.strain), deviator(state.residual))[0] <= self.tolerance
        )

    def step(
        self, state: State, load: Load, guess: Change | None = None, start: np.ndarray | None = None,
        tolerance: float | None = None,
    ) -> Trial:  # fmt: skip
        """From a committed state to a load; guess: the change of the last step scaled, say; start: of p_hat.

        tolerance: another one than that of the problem.
        """
        tolerance = self.tolerance if tolerance is None else tolerance
        m = SELF_STIFFNESS * self.material.mu
        operator, full, lift, residual = self.operator, state, state.lift, state.residual
        if guess is not None:
            lift, residual = lift + guess.lift, residual + guess.residual
        state, base = self._kept(state), operator.keep(residual)
        x = np.zeros_like(state.strain) if guess is None else operator.keep(guess.increment)
        anderson = Anderson(WINDOW, np.sqrt(SHEAR)[:, None, None, None])
        pressure, contact_tolerance, history = full.pressure if start is None else start, 1e-3, []
        response = None
        while True:
            pressure = self.press(lift, load, pressure, contact_tolerance)
            stress = base + self.stress(pressure, load, response)  # paper Eq. 4 and 7
            s = deviator(stress)
            excess, flow = self.residuals(state, x, s)
            worst = max(excess, flow)
            history.append(worst)
            finest = CONTACT_SHARE * tolerance
            if (worst <= tolerance and contact_tolerance <= finest) or len(history) > ITERATIONS:
                break
            contact_tolerance = max(min(CONTACT_SHARE * AHEAD * worst, contact_tolerance), finest)
            if worst <= tolerance:
                contact_tolerance = finest  # once more, with the contact as good as promised
                continue
            x = anderson.next(x, self.image(state, x, s, m))
            transformed = operator.transformed(x)
            lift = full.lift + operator.whole(operator.displacement(transformed))
            base, response = state.residual, operator.response(transformed)
            self.counters.plastic_iterations += 1
        converged = worst <= tolerance and np.isfinite(worst)
        return Trial(
            load=load,
            increment=operator.whole(x),
            length=operator.whole(equivalent_strain(x)),
            stress=operator.whole(stress),
            residual=residual if response is None else operator.whole(stress - self.stress(pressure, load)),
            lift=lift,
            pressure=pressure,
            yield_excess=excess,
            flow_residual=flow,
            history=tuple(history),
            converged=bool(converged),
            step_force=load.force - state.load.force,
            goal=tolerance,
        )
