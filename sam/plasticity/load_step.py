# SPDX-License-Identifier: MIT
"""One load step of elasto-plastic contact: plastic strain, stress and contact solved together.

Paper Fig. 5 to 7 nest three loops; here there is one. The unknown is the increment x of the plastic strain
over the step. One evaluation solves the contact on the surface that x has displaced, takes the stress of both
(Eq. 7) and returns it to the yield surface; its fixed point is the backward-Euler solution, found by Anderson
acceleration of preconditioned changes. In full slip the traction is q = coefficient * p everywhere in the
iteration: in the gap and in the stress.

The return map moves all parts of the strain of a cell by the stiffness 2 m. How much a part lowers the stress
of its own cell depends on the cell: in a flat one at the surface, a tenth of its width thick, a shear across
the layer by 0.1 mu for a unit strain, one in the plane by 1.6 mu. A soft layer that a traction shears flows
most by the first. Where the strain grows by x, the yield stress sigma_y resists a turn of x by

    T = 2 sigma_y/(3 dgamma),     dgamma = sqrt(2/3 x : x),                                               (f)

so that a change of the stress changes the return map by 1/(2 m + T), and the solution, as far as the cell
alone makes it, by 1/(k + T) with the stiffness k of the part in its own cell. The change of a part of x by
the return map is therefore multiplied by

    (2 m + T)/(k + T).                                                                                    (g)

The fixed point is the same for every factor.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from sam.arrays import Array, Mask
from sam.contact.box import BoxContact
from sam.contact.convolution import Counters
from sam.contact.normal import control_of
from sam.plasticity.flow import SHEAR, Material, equivalent_strain
from sam.plasticity.points import POINTS, CellFlow, whole
from sam.plasticity.spectra import BoxOperator, InWaves
from sam.plasticity.state import CellFields, Change, ResidualFields, State, Trial, filled, spread
from sam.schedule import UNLOADED, Load

CONTACT_LIMIT = 400  # iterations of a contact solve, ten times what a step takes; more halve the step


@dataclass(frozen=True)
class ContactPressure:
    """The contact on a displaced surface; gap of a load in m, cell hx in m, force_unit in N per p_hat."""

    contact: BoxContact
    gap: Callable[[Load], Array]
    hx: float
    force_unit: float

    def start(self, load: Load) -> Array:
        """p_hat to start from: uniform where there is a counter-body."""
        return np.isfinite(self.gap(load)).astype(float)

    def __call__(self, displacement: Array, load: Load, start: Array, tolerance: float) -> Array:
        """p_hat to a tolerance on its residual, from `start`, or a uniform one where that is zero."""
        if load.force == 0:
            return np.zeros(displacement.shape)
        gap = (self.gap(load) + displacement) / self.hx
        start = start if start.any() else self.start(load)
        lowest, control = float(gap.min()), control_of(load.given, self.hx, self.force_unit)
        return self.contact.solve(
            gap - lowest,
            control.less(lowest),
            start,
            tolerance=tolerance,
            limit=CONTACT_LIMIT,
            sign=load.sign,
        ).p

    def loaded(self, load: Load, pressure: Array) -> Load:
        """The load with the sum of the pressure as its force."""
        return load.found(float(pressure.sum()) * self.force_unit)


@dataclass(frozen=True)
class GivenPressure:
    """A pressure that acts whatever the surface does. pressure: of a load, p_hat on the box, (nx, ny)."""

    pressure: Callable[[Load], Array]
    shape: tuple[int, int]

    def start(self, load: Load) -> Array:
        """Nothing."""
        return np.zeros(self.shape)

    def __call__(self, displacement: Array, load: Load, start: Array, tolerance: float) -> Array:
        """p_hat of the load; nothing else counts."""
        return self.pressure(load)

    def loaded(self, load: Load, pressure: Array) -> Load:
        """The load itself, whose force is given."""
        return load


PressureSource = ContactPressure | GivenPressure

# Measured: operator applications on a sphere of perfect plasticity at p0 = 3
# yield stresses, 25 x 25 cells, 4 steps and back at 1e-6: 40 applications with the values below.
# Iterates that the acceleration combines: 47 with 2 of them, 41 with 4, 40 with 16.
WINDOW = 8
# m over mu, see (a) and (e): about that of a sphere in its surroundings, 0.52 for nu = 0.3 (Eshelby 1957). It
# is part of the discretisation, and of the fixed-point map: 53 applications with 0.25, 46 with 1.
STIFFNESS = 0.5
# Most iterations of a step before it is halved: 30 and 120 change nothing, steps that converge take
# fewer.
ITERATIONS = 60
# The same two of the longer iteration, where halving a step does not help: below a soft thin layer whose
# traction is three times its shear strength (strains of 1.6), a step takes 32 iterations with 20 and 45 with
# 8; with a strain of 4 it takes 50, and more than ITERATIONS with 8.
LONG_WINDOW = 20
LONG_ITERATIONS = 600
# Share of the tolerance of the plastic residual to which each contact is solved: with 1e-1 the residual of
# the contact is found too large. An evaluation takes as long as tens of contact iterations: none is repeated
# for a better contact.
CONTACT_SHARE = 1e-2
# Tolerance of the iterate with which the tribofilm is tested first, before that of the solved step: a
# running-in on 64 x 64 cells, two cycles, takes 125 operator applications with 0.01, 102 with 0.1, 81 with 1
# and 10; the friction is the same to 2e-6.
FIRST_TEST = 1.0


@dataclass(frozen=True)
class Problem:
    """Everything that stays the same over a load step on a box. pressure: gives p_hat; unit: Pa per p_hat;
    tolerance: on yield_excess and flow_residual; coefficient: of friction, a number or (nx, ny); misfit:
    stress of a misfit strain at its full size, (6, n_layers, nx, ny) in Pa, None without one; longer: whether
    a step may take LONG_ITERATIONS with LONG_WINDOW.
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
        nothing = ResidualFields(np.zeros((6, *shape)), np.zeros(self.operator.shape))
        material = CellFields(np.zeros(shape, dtype=bool), self.material.virgin((POINTS, 0)))
        return State(material, nothing, self.pressure.start(UNLOADED))

    def traction(self, pressure: Array, load: Load) -> Array | None:
        """q_x on the body in the unit of the pressure, (nx, ny); None without friction."""
        return load.sign * self.coefficient * pressure if np.any(self.coefficient) else None

    def stress(self, pressure: Array, load: Load, response: InWaves | None = None) -> Array:
        """Stress in Pa of p_hat, its traction, a misfit strain and plastic strain (`BoxOperator.stress`)."""
        keep, pressure = self.operator.keep, pressure * self.unit
        traction = self.traction(pressure, load)
        stress = self.operator.stress(keep(pressure), response, None if traction is None else keep(traction))
        return stress if self.misfit is None else stress + load.misfit * keep(self.misfit)

    def residual(self, before: ResidualFields, x: Array) -> ResidualFields:
        """The residual fields `before` and those of a plastic strain x: one application of the operator."""
        operator = self.operator
        transformed = operator.transformed(operator.keep(x))
        displacement = operator.whole(operator.displacement(transformed))
        stress = operator.whole(operator.stress(None, operator.response(transformed)))
        return before.plus(ResidualFields(stress, displacement))

    def residual_of(self, material: CellFields) -> ResidualFields:
        """The residual fields of a material; nothing is applied where it is unstrained."""
        nothing = self.virgin().residual
        return self.residual(nothing, material.strain) if material.cells.any() else nothing

    def stays_elastic(self, state: State) -> bool:
        """Whether the stress that is left without any load is within the yield surface."""
        stress = self.operator.keep(state.residual.stress)
        return self.flow(state).stays_elastic(stress, self.tolerance)

    def flow(self, state: State) -> CellFlow:
        """How the kept cells yield over a step that begins in a state."""
        transforms = self.operator.transforms
        before = state.material.part(self.operator.keep)
        return CellFlow(self.material, before, transforms, self.stiffness)

    @property
    def stiffness(self) -> float:
        """m of the return map (a) in Pa."""
        return STIFFNESS * self.material.mu

    def step(
        self,
        state: State,
        load: Load,
        *,
        guess: Change | None = None,
        start: Array | None = None,
        retest: Callable[[Trial], Problem | None] | None = None,
    ) -> Trial:
        """The end of a load step from a committed state, converged or not: a fixed point of the increment x,
        (6, n) of the cells that may flow, of those that the symmetry keeps. guess, start: change and p_hat
        before; retest: of an iterate within FIRST_TEST, and of the last (without its residual fields), gives
        the problem with other friction that the iteration goes on with, or None.
        """
        K, problem, goal = self.operator, self, self.tolerance
        goal = max(FIRST_TEST, goal) if retest is not None else goal
        window, most = (LONG_WINDOW, LONG_ITERATIONS) if self.longer else (WINDOW, ITERATIONS)
        anderson = Anderson(window, np.sqrt(SHEAR)[:, None])
        flow, history, accuracy = self.flow(state), list[float](), CONTACT_SHARE * self.tolerance

        # of the plastic strain so far: u_3 (Eq. 6), and its stress (Eq. 7) as that of residual plus response
        residual, response = state.residual, None
        x = flow.nothing
        if guess is not None:
            residual = residual.plus(guess.residual.times(guess.ratio))
            increment = guess.increment.part(K.keep)
            flow.add(increment.cells)
            x = guess.ratio * spread(increment.points.strain.mean(axis=1), increment.cells, flow.cells)
        displacement = residual.displacement
        pressure = state.pressure if start is None else start

        def reached() -> Trial:
            return Trial(
                load=problem.pressure.loaded(load, pressure),
                increment=whole(K.transforms, returned.increment()),
                stress=K.whole(stress),
                residual=residual,
                pressure=pressure,
                yield_excess=returned.yield_excess,
                flow_residual=returned.flow_residual,
                history=tuple(history),
                converged=bool(worst <= goal and np.isfinite(worst)),
                rise=load.rise(state.load),
                goal=goal,
            )

        while True:
            pressure = problem.pressure(displacement, load, pressure, accuracy)  # paper Eq. 9 and 10
            stress = K.keep(residual.stress) + problem.stress(pressure, load, response)  # paper Eq. 4 and 7
            returned = flow.returned(x, stress)  # paper Eq. 8, at the points of each cell
            x, worst = returned.x, returned.worst(goal)
            history.append(worst)
            if worst <= goal and retest is not None:
                if (changed := retest(reached())) is not None:
                    problem, history, anderson.last = changed, [], []
                    continue
                goal = self.tolerance
                history[-1] = worst = returned.worst(goal)
            if worst <= goal or len(history) > most:
                break
            own = np.repeat(stiffness_of_parts(K.own_stress), flow.counts, axis=-1)
            limit = flow.flow.limit.mean(axis=0)
            image = preconditioned(x, returned.image, limit, m=self.stiffness, own=own)
            x, residual, response = anderson.next(x, image, flow.cells), state.residual, None
            del stress, returned, image  # so long as the next ones are made
            strain = K.transformed(filled(x.astype(K.real, copy=False), flow.cells))
            displacement = residual.displacement + K.whole(K.displacement(strain))  # paper Eq. 6
            response = K.response(strain)  # paper Eq. 7, second sum
            del strain
            self.counters.plastic_iterations += 1
        if response is not None:  # of the stress, what the load does not make: paper Eq. 4
            del response, anderson
            residual = ResidualFields(K.whole(stress - problem.stress(pressure, load)), displacement)
        return reached()


class Anderson:
    """Anderson acceleration of x = g(x) (Walker & Ni 2011, type II): combines the last `window` iterates so
    that g(x) - x cancels best, each entry with its `weight`. Singular values below `cutoff` of the scaled
    normal equations are dropped: directions the window already holds.
    """

    def __init__(self, window: int, weight: Array, cutoff: float = 1e-12):
        self.window, self.weight, self.cutoff = window, weight, cutoff
        self.count = 0  # differences so far; they take turns in the rows of
        self.steps, self.changes = list[Array](), list[Array]()  # of g(x), and of the weighted g(x) - x
        self.gram = np.zeros((window, window))
        self.last = list[Array]()  # g(x), and the weighted g(x) - x
        self.cells: Mask | None = None

    def next(self, x: Array, image: Array, cells: Mask) -> Array:
        """The next iterate after g(x) = image, (6, n) of cells, which those before were among."""
        distance = (image - x) * self.weight
        if self.cells is not None:
            if cells is not self.cells:
                kinds = self.steps, self.changes, self.last
                self.steps, self.changes, self.last = (
                    [spread(each, self.cells, cells) for each in rows] for rows in kinds
                )
            if self.last:
                self._add(image - self.last[0], distance - self.last[1])
        self.last, self.cells = [image, distance], cells
        n = len(self.steps)
        if not n:
            return image
        gram = self.gram[:n, :n]
        size = np.sqrt(np.maximum(gram.diagonal(), np.finfo(float).tiny))
        right = self._products(distance) / size
        coefficients = np.linalg.lstsq(gram / np.outer(size, size), right, rcond=self.cutoff)[0] / size
        out = image.copy()
        for coefficient, step in zip(coefficients, self.steps, strict=True):
            out -= coefficient * step
        return out

    def _add(self, step: Array, change: Array) -> None:
        """The newest differences, in place of the oldest, and their products with those in the window."""
        row, self.count = self.count % self.window, self.count + 1
        self.steps[row : row + 1], self.changes[row : row + 1] = [step], [change]
        n = len(self.changes)
        self.gram[row, :n] = self.gram[:n, row] = self._products(change)

    def _products(self, change: Array) -> Array:
        """Of all changes in the window with one."""
        return np.array([np.vdot(each, change) for each in self.changes])


ROOT = np.sqrt(SHEAR)
# Parts of a deviator, each of unit length in components times ROOT: 11 - 22, 11 + 22 - 2 33, 23, 13 and 12.
PARTS = np.zeros((5, 6))
PARTS[0, :3] = np.array([1.0, -1.0, 0.0]) / np.sqrt(2)
PARTS[1, :3] = np.array([1.0, 1.0, -2.0]) / np.sqrt(6)
PARTS[2:, 3:] = np.eye(3)
ACROSS = slice(2, 4)  # the shears across the layer: one stiffness for both


def stiffness_of_parts(own_stress: Array) -> Array:
    """Stiffness k of (g) in Pa, (5, n_layers), from `BoxOperator.own_stress`, (6, 6, n_layers) in Pa."""
    stiffness: Array = -np.einsum("ai,ijk,aj->ak", PARTS * ROOT, own_stress, PARTS / ROOT)
    stiffness[ACROSS] = stiffness[ACROSS].mean(axis=0)
    return stiffness


def preconditioned(x: Array, image: Array, limit: Array, *, m: float, own: Array) -> Array:
    """The image (6, n) of an increment x by the return map, its change multiplied by (g); limit: yield stress
    of the cells in Pa, (n,); own: k of `stiffness_of_parts` for each, (5, n).
    """
    out, flowing = image.copy(), image.any(axis=0)
    start, end = x[:, flowing], image[:, flowing]
    turn = limit[flowing] / (1.5 * equivalent_strain(end))
    factor = (2 * m + turn) / (own[:, flowing] + turn)
    parts = factor * (PARTS @ (ROOT[:, None] * (end - start)))
    out[:, flowing] = start + PARTS.T @ parts / ROOT[:, None]
    return out
