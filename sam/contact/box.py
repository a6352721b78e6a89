# SPDX-License-Identifier: MIT
"""Contact on a box of cells: constrained, preconditioned conjugate gradients (see `sam.contact.normal`, paper
Eq. 9 and 10).

Directions are in single precision, in units of the residual that they begin with: what they lack is a share
of a change, and the displacement that the iteration carries along is replaced by one in double precision
before it decides to stop. The pressure is projected onto p >= 0 once the residual of the cells in contact,
sqrt(r . z), has fallen to `HalfSpaces.restart_threshold` of what a sequence of directions started with, not
in each iteration: each projection costs a displacement of its own and restarts the directions.

Given is the force, or how far the bodies approach; the conjugate gradients are the same for both. Under force
control the rigid approach is the mean separation of the cells in contact, and each change of the pressure has
no sum; under displacement control the approach is known, and the sum of the pressure follows (Polonsky & Keer
1999 with the force balance left out).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from math import pi, sqrt
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from sam.arrays import Array, Mask
from sam.contact.convolution import Real, mirror_half, unfolded
from sam.contact.operators import SurfaceOperators
from sam.grid.cells import Window

Begun = tuple[Array, Array]
"""p_hat and its u_hat."""


@dataclass(frozen=True)
class ForceControl:
    """The force is given: total, the sum of p_hat. counted: cells that each stands for, 0 out of contact."""

    total: float

    def coarser(self) -> ForceControl:
        """The same for cells twice as large."""
        return ForceControl(self.total / 4)

    def less(self, offset: float) -> ForceControl:
        """The same: a force does not depend on where gaps are counted from."""
        return self

    def touches(self, gap0: Array) -> bool:
        """Whether there is a force, and a counter-body opposite any cell."""
        return self.total > 0 and bool(np.isfinite(gap0).any())

    def start(self, gap0: Array) -> Array:
        """Uniform where there is a counter-body."""
        return np.isfinite(gap0).astype(float)

    def scaled(self, p: Array, count: Array | float = 1.0) -> Array:
        """The pressure with the given sum."""
        return p * (self.total / (p * count).sum())

    def begun(self, p: Array, gap0: Array, count: Array | float, apply: Callable[[Array], Array]) -> Begun:
        """The first iterate, with the given sum, and its u_hat by `apply`."""
        p = self.scaled(p, count)
        return p, apply(p)

    def share(self, counted: Array) -> float:
        """Share of a cell in what is taken off a change of the pressure: equal, it has no sum."""
        return 1 / float(counted.sum())

    def level(self, separation: Array, counted: Array) -> float:
        """Rigid approach of an iterate: the mean separation gap0 + u_hat of the cells in contact."""
        return np.vdot(counted, separation) / counted.sum()

    def approach(self, contact: Mask, separation: Array) -> float:
        """Mean separation of the cells in contact."""
        return float(separation[contact].mean())


@dataclass(frozen=True)
class ApproachControl:
    """The rigid approach is given: distance, in cells hx. Methods as of `ForceControl`."""

    distance: float

    def coarser(self) -> ApproachControl:
        """The same for cells twice as large."""
        return ApproachControl(self.distance / 2)

    def less(self, offset: float) -> ApproachControl:
        """The same for gaps that are smaller by an offset."""
        return ApproachControl(self.distance - offset)

    def touches(self, gap0: Array) -> bool:
        """Whether the bodies would overlap in any cell."""
        return bool(gap0.min() < self.distance)

    def start(self, gap0: Array) -> Array:
        """In proportion to the overlap, of which half touches; as large as Hertz's, p_hat = 4 a/(pi R)."""
        overlap = np.maximum(self.distance - gap0, 0.0)
        radius = sqrt(max(int(np.count_nonzero(overlap)), 1) / (2 * pi))
        return 4 / (pi * radius) * overlap

    def scaled(self, p: Array, count: Array | float = 1.0) -> Array:
        """The pressure itself: its sum is a result."""
        return p

    def begun(self, p: Array, gap0: Array, count: Array | float, apply: Callable[[Array], Array]) -> Begun:
        """The start times the number that fits its displacement best; `start` where none is positive."""
        overlap, u = self.distance - gap0, apply(p)
        if np.vdot(p * count, overlap) <= 0:
            p = self.start(gap0)
            u = apply(p)
        factor = np.vdot(p * count, overlap) / np.vdot(p * count, u)
        return factor * p, factor * u

    def share(self, counted: Array) -> float:
        """None: the sum of the pressure may change."""
        return 0.0

    def level(self, separation: Array, counted: Array) -> float:
        """The given approach."""
        return self.distance

    def approach(self, contact: Mask, separation: Array) -> float:
        """The given approach."""
        return self.distance


# Counted in displacements to 1e-8 for a sphere on 129 x 129 cells, with a traction at a coupling of 0.1.
PASSES = 500  # limit with a traction; 12 at beta mu = 0.1
FIRST_PASS = 1e-2  # tolerance of the first pass with a traction: 83; 1e-1 80, 1e-3 85
NEXT_PASS = 0.1  # tolerance of the next passes as a share of the residual: 83; 0.3 89, 0.03 88
ANEW = 1e-3  # fall of the residual until the displacement is computed anew in double: 44; 1e-1 48, 1e-6 45
LONGEST = 20  # iterations without a projection: 5 and 100 the same, as the residual falls before
NEGLIGIBLE = 0.01  # share of the tolerance: cells that penetrate more join; 0 and 1 the same
NOTHING_OPPOSITE = 1e100  # gap, in cells, where the counter-body ends


Control = ForceControl | ApproachControl
"""What is given of a contact."""


class Solution(NamedTuple):
    """p_hat and u_hat on the cells of a window, u_hat with that of the traction, and the iterations."""

    p: Array
    u: Array
    iterations: int


class _State:
    """The iterate and the search direction, on the free cells alone: elsewhere the pressure is zero."""

    unit = np.float64(1.0)  # of the following fields: the largest residual when the sequence started
    direction: Real | None = None
    residual: Real | None = None  # times the count
    product = 0.0  # r . z of the last iteration
    first = 0.0  # of the first one of the sequence
    since = 0  # iterations of the sequence
    negative = False

    def __init__(self, free: Mask, p: Array, count: Array, control: Control):
        """free: the cells that the sequence changes; p, count: of all cells, count: that each stands for."""
        self.free, self.cells = free, np.flatnonzero(free)
        self.p, self.count = p.take(self.cells), count.take(self.cells)
        self.share = control.share(self.count)

    def projected(self, field: Real) -> NDArray[Any]:
        """A field of all cells on the free ones, less its mean over them where the force is given."""
        found = field.take(self.cells)
        return found - float(self.share * np.vdot(self.count, found))

    def spread(self, values: Real) -> NDArray[Any]:
        """A field of all cells from its values on the free ones, zero elsewhere."""
        field = np.zeros(self.free.shape, dtype=values.dtype)
        field.ravel()[self.cells] = values
        return field


def gap_of_contact(p: Array, separation: Array, control: Control) -> Array:
    """gap0 + u - delta, with delta given or of the cells in contact; inf without a counter-body."""
    return separation - control.approach(p > 0, separation)  # paper Eq. 9: h = h0 + u_3 - delta


def _mirrored(field: Array) -> bool:
    """Whether a field is its own mirror image in x and in y."""
    return np.array_equal(field, field[::-1]) and np.array_equal(field, field[:, ::-1])


class BoxContact:
    """A contact on a box of cells, whose operators serve any gap and load (Eq. 9 and 10). Of a gap
    that is mirrored a quarter is iterated, without a traction; residuals: of the last solve.
    """

    def __init__(self, operators: SurfaceOperators, box: Window):
        self.operators, self.box = operators, box
        self.tangential, self.relaxation = operators.tangential(box, box), operators.relaxation
        self.residuals: list[float] = []

    @cached_property
    def _whole(self) -> _Iteration:
        return _Iteration(self.operators, self.box, mirrored=False)

    @cached_property
    def _quarter(self) -> _Iteration:
        return _Iteration(self.operators, self.box, mirrored=True)

    def solve(
        self, gap0: Array, control: Control, start: Array, *, tolerance: float, limit: int, sign: float = 1.0
    ) -> Solution:
        """p_hat on the box, its residuals below the tolerance or the last. gap0: (nx, ny) in cells
        hx, inf beside the counter-body; start: p_hat; limit: iterations; sign: of the traction.
        """
        gap0, p, self.residuals = np.minimum(gap0, NOTHING_OPPOSITE), start, []
        if self.tangential is None:
            return self._normal(gap0, control, p, tolerance=tolerance, limit=limit)
        total, inner, moved = 0, max(FIRST_PASS, tolerance), sign * self.tangential(control.scaled(p))
        for _ in range(PASSES):
            p, u, iterations = self._whole.solve(
                gap0 + moved, control, p, tolerance=inner, limit=limit - total
            )
            total, current = total + iterations, sign * self.tangential(p)
            worst = self._whole.residual(p, gap_of_contact(p, gap0 + u + current, control))
            self.residuals.append(worst)
            if worst <= tolerance or total >= limit:
                break
            inner = max(NEXT_PASS * worst, tolerance / 2)
            moved = moved + self.relaxation * (current - moved)
        return Solution(p, u + current, total)

    def displacement(self, p: Array, sign: float) -> Array:
        """u_hat on the box of p_hat there, with the part of the traction; sign: of that along x."""
        if self.tangential is None:
            return self._quarter.displacement(p) if _mirrored(p) else self._whole.displacement(p)
        return self._whole.displacement(p) + sign * self.tangential(p)

    def _normal(self, gap0: Array, control: Control, p: Array, *, tolerance: float, limit: int) -> Solution:
        """Solve without a traction."""
        mirrored = _mirrored(gap0)
        if mirrored and not (p > 0)[tuple(mirror_half(n) for n in p.shape)].any():
            p = np.ones_like(p)  # a start that the kept quarter does not see
        iteration = self._quarter if mirrored else self._whole
        solution = iteration.solve(gap0, control, p, tolerance=tolerance, limit=limit)
        self.residuals = iteration.residuals
        return solution


class _Iteration:
    """The conjugate gradients on all of a box, or on the quarter from its middle outward."""

    def __init__(self, operators: SurfaceOperators, box: Window, mirrored: bool):
        self.operators, self.box = operators, box
        self.counters, self.bodies = operators.counters, operators.bodies
        self.self_influence, self.mirrored = operators.self_influence, mirrored
        self.operator = operators.box_operator(box, mirrored)
        self.residuals: list[float] = []
        self.count: Array = np.ones(box.shape)
        if mirrored:
            self.kept = tuple(mirror_half(n) for n in box.shape)
            count = np.outer(*(np.full(n - n // 2, 2.0) for n in box.shape))
            count[0] /= 1 + box.nx % 2  # the middle cell of an odd number is its own mirror image
            count[:, 0] /= 1 + box.ny % 2
            self.count = count

    @cached_property
    def precondition(self) -> Callable[[Real], Real]:
        """r -> z, both on the kept cells."""
        return self.operators.preconditioner(self.box, self.mirrored)

    def displacement(self, p: Array) -> Array:
        """u_hat on the box of p_hat there."""
        return self._back(self._apply(self._kept(p)))

    def solve(self, gap0: Array, control: Control, p: Array, *, tolerance: float, limit: int) -> Solution:
        """See `BoxContact.solve`; given up after `limit` iterations, or many without a smaller residual."""
        if not control.touches(gap0):
            return Solution(np.zeros_like(p), np.zeros_like(p), 0)
        solution = self._solve(self._kept(gap0), control, self._kept(p), tolerance=tolerance, limit=limit)
        return Solution(self._back(solution.p), self._back(solution.u), solution.iterations)

    def _kept(self, field: Array) -> Array:
        return field[self.kept] if self.mirrored else field

    def _back(self, kept: Array) -> Array:
        return kept[np.ix_(*map(unfolded, self.box.shape))] if self.mirrored else kept

    def _apply(self, p: Real) -> NDArray[Any]:
        self.counters.displacement_applications += 1
        return self.operator(p)

    def residual(self, p: Array, gap: Array) -> float:
        """The larger of |gap| in contact and penetration elsewhere, as a pressure error: paper Eq. 9."""
        inside = gap * (p > 0)
        return max(inside.max(), -gap.min()) / (self.self_influence * p.max() or 1.0)

    def _solve(self, gap0: Array, control: Control, p: Array, *, tolerance: float, limit: int) -> Solution:
        """Iterate on the kept cells until the residual is below the tolerance in double precision."""
        (p, u), fresh = control.begun(p, gap0, self.count, self._apply), True
        # gaps near zero: sums over many cells then round little
        offset = control.approach(p > 0, gap0 + u)
        gap0, control = gap0 - offset, control.less(offset)
        separation, state = gap0 + u, _State(p > 0, p, self.count, control)
        iteration, smallest, since, anew, self.residuals = 0, np.inf, 0, 0.0, []
        while iteration < limit and since < self.bodies.stagnation_limit:
            if not state.negative:
                p = state.spread(state.p)
                contact = p > 0
                gap = separation - control.level(separation, contact * self.count)
                worst = self.residual(p, gap)
                self.residuals.append(float(worst))
                if fresh and worst <= tolerance:
                    break
                if fresh:
                    anew = max(ANEW * worst, tolerance)
                elif worst <= anew:
                    state.p = control.scaled(state.p, state.count)
                    u, fresh = self._apply(state.spread(state.p)), True
                    separation = gap0 + u
                    continue
                smallest, since = (worst, 0) if worst < smallest else (smallest, since)
                free = contact | (gap < -NEGLIGIBLE * tolerance * self.self_influence * p.max())
                if not np.array_equal(free, state.free):
                    state = _State(free, p, self.count, control)
            if not self._step(state, separation, control):
                break
            fresh = False
            iteration, since = iteration + 1, since + 1
            self.counters.contact_iterations += 1
        if not fresh:
            p = control.scaled(np.maximum(state.spread(state.p), 0.0), self.count)
            u = self._apply(p)
        return Solution(p, u, iteration)

    def _step(self, state: _State, separation: Array, control: Control) -> bool:
        """One iteration of Eq. 10 on the free cells, with a projection where due; False at no residual."""
        gap = state.projected(separation)
        if state.direction is None:
            state.unit = np.float64(max(gap.max(), -gap.min()) or 1.0)
        r = (gap / state.unit).astype(self.bodies.real)
        z = state.projected(self.precondition(state.spread(r)))
        r *= state.count
        product = float(np.vdot(r, z))
        if product <= 0.0:
            return False
        d = -z
        if state.direction is None or state.residual is None:
            state.first = product
        else:
            beta = max(0.0, (product - float(np.vdot(state.residual, z))) / state.product)  # Polak-Ribiere
            d += beta * state.direction  # paper Eq. 10, third line, preconditioned
            if -np.vdot(r, d) < product / 2:  # it is the product, but for rounding
                d = -z
        u_d = self._apply(state.spread(d))
        alpha = -float(np.vdot(r, d)) / float(np.vdot(state.count * d, u_d.take(state.cells)))
        # paper Eq. 10, first and second line: u carries the residual
        state.p += alpha * state.unit * d
        separation += alpha * state.unit * u_d
        state.direction, state.residual, state.product, state.since = d, r, product, state.since + 1
        state.negative = bool(state.p.min() < 0)
        fallen = product <= self.bodies.restart_threshold**2 * state.first
        if state.negative and (fallen or state.since >= LONGEST):
            p = control.scaled(np.maximum(state.p, 0.0), state.count)  # paper Eq. 9: p >= 0
            change = ((p - state.p) / state.unit).astype(self.bodies.real)
            separation += state.unit * self._apply(state.spread(change))
            state.p, state.negative = p, False
        return True
