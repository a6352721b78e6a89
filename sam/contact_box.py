# SPDX-License-Identifier: MIT
"""Contact on a box of cells: constrained, preconditioned conjugate gradients (see `sam.contact`, paper Eq. 9 and 10).

Directions are transformed in single precision: what they lack is a share of a change, and the displacement that the iteration
carries along is replaced by one in double precision before it decides to stop. Pressures below zero are cut off once the
residual of the cells in contact, sqrt(r . z), has fallen to `HalfSpaces.settled` of what a sequence of directions started with,
not in each iteration: each cut costs a displacement of its own and starts a new sequence.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sam.contact_grid import Grid
from sam.convolution import Window

PASSES = 500  # with a traction; 12 at beta mu = 0.1
FIRST_PASS, NEXT_PASS = 1e-2, 0.1  # tolerance of the first pass, and of the next ones as a share of the residual
ANEW = 1e-3  # of the residual, after which the displacement is computed anew in double precision
LONGEST = 20  # iterations without a cut
NOTHING_OPPOSITE = 1e100  # gap, in cells, where the counter-body ends


@dataclass
class _State:
    """Iterate on the box: pressure, its displacement, the search direction and what belongs to it."""

    p: np.ndarray
    u: np.ndarray
    free: np.ndarray | None = None  # cells that the sequence of directions changes: True, and
    weight: np.ndarray | None = None  # the same as numbers over their count
    direction: np.ndarray | None = None
    residual: np.ndarray | None = None
    product: float = 0.0  # r . z of the last iteration
    first: float = 0.0  # of the first one of the sequence
    since: int = 0  # iterations of the sequence
    negative: bool = False

    def set_free(self, free: np.ndarray) -> None:
        """A new sequence of directions if the cells are others."""
        if self.free is None or not np.array_equal(free, self.free):
            self.free, self.weight = free, free / np.count_nonzero(free)
            self.direction, self.since = None, 0

    def projected(self, field: np.ndarray) -> np.ndarray:
        """Zero mean over the free cells, zero elsewhere."""
        return (field - np.vdot(self.weight, field)) * self.free


def gap_of_contact(p: np.ndarray, separation: np.ndarray) -> np.ndarray:
    """gap0 + u - delta, with delta from the mean over the cells in contact; inf where there is no counter-body."""
    return separation - separation[p > 0].mean()


class BoxContact:
    """Contact restricted to a box of cells: its operators are built once and serve any gap and load (Eq. 9 and 10)."""

    def __init__(self, grid: Grid, box: Window):
        self.box, self.counters, self.self_influence = box, grid.counters, grid.self_influence
        self.operator, self.precondition = grid.box_operator(box), grid.preconditioner(box)
        self.tangential = grid.tangential(box, box)
        self.relaxation, bodies = grid.relaxation, grid.bodies
        self.patience, self.single, self.settled = bodies.patience, bodies.single, bodies.settled

    def solve(self, gap0: np.ndarray, load: float, p: np.ndarray, tolerance: float, limit: int, sign: float = 1.0):
        """p_hat on the box with all residuals below the tolerance, or the last iterate when that is not reached.

        gap0: on the box, in cells hx; load: sum of p_hat; p: start; sign: of the traction along x; limit: of iterations.
        Returns (p_hat, u_hat, iterations), u_hat with the part of the traction.
        """
        gap0 = np.minimum(gap0, NOTHING_OPPOSITE)
        if self.tangential is None:
            return self._normal(gap0, load, p, tolerance, limit)
        total, inner, moved = 0, max(FIRST_PASS, tolerance), sign * self.tangential(p * (load / p.sum()))
        for _ in range(PASSES):
            p, u, iterations = self._normal(gap0 + moved, load, p, inner, limit - total)
            total, current = total + iterations, sign * self.tangential(p)
            worst = self._residual(p, gap_of_contact(p, gap0 + u + current))
            if worst <= tolerance or total >= limit:
                break
            inner = max(NEXT_PASS * worst, tolerance / 2)
            moved = moved + self.relaxation * (current - moved)
        return p, u + current, total

    def displacement(self, p: np.ndarray, sign: float = 1.0) -> np.ndarray:
        """u_hat on the box of p_hat there, with the part of the traction."""
        return self._apply(p) if self.tangential is None else self._apply(p) + sign * self.tangential(p)

    def _apply(self, p: np.ndarray) -> np.ndarray:
        self.counters.displacement_applications += 1
        return self.operator(p)

    def _apply_change(self, change: np.ndarray) -> np.ndarray:
        self.counters.displacement_applications += 1
        return self.operator.single(change) if self.single else self.operator(change)

    def _residual(self, p: np.ndarray, gap: np.ndarray) -> float:
        """The larger of |gap| in contact and penetration elsewhere, as a relative pressure error (see `Contact`)."""
        inside = gap * (p > 0)
        return max(inside.max(), -gap.min()) / (self.self_influence * p.max())

    def _normal(self, gap0: np.ndarray, load: float, p: np.ndarray, tolerance: float, limit: int):
        """`solve` without traction, or with a displacement of its traction that is part of gap0.

        Gives up after `limit` iterations, or after many without a new smallest residual (`HalfSpaces.patience`): rounding, or
        a tolerance below it.
        """
        p = p * (load / p.sum())
        state, fresh = _State(p, self._apply(p)), True
        gap0 = gap0 - (gap0 + state.u)[p > 0].mean()  # gaps near zero: sums over many cells then round little
        iteration, smallest, since, anew = 0, np.inf, 0, 0.0
        while iteration < limit and since < self.patience:
            separation = gap0 + state.u
            if not state.negative:
                contact = state.p > 0
                gap = separation - np.vdot(contact, separation) / np.count_nonzero(contact)
                worst = self._residual(state.p, gap)
                if fresh and worst <= tolerance:
                    break
                if fresh:
                    anew = max(ANEW * worst, tolerance)
                elif worst <= anew:
                    state.p *= load / state.p.sum()
                    state.u, fresh = self._apply(state.p), True
                    continue
                smallest, since = (worst, 0) if worst < smallest else (smallest, since)
                state.set_free(contact | (gap < -0.01 * tolerance * self.self_influence * state.p.max()))
            if not self._step(state, separation, load):
                break
            fresh = False
            iteration, since = iteration + 1, since + 1
            self.counters.contact_iterations += 1
        if not fresh:
            if state.negative:
                self._cut(state, load)
            state.u = self._apply(state.p)
        return state.p, state.u, iteration

    def _step(self, state: _State, separation: np.ndarray, load: float) -> bool:
        """One iteration of Eq. 10 on the free cells: a step of zero sum, and the cut p >= 0, sum p = load where it is due.

        False, and nothing done, when the residual is zero in double precision.
        """
        r = state.projected(separation)
        z = state.projected(self.precondition(r))
        product = float(np.vdot(r, z))
        if product <= 0.0:
            return False
        if state.direction is None:
            d, state.first = -z, product
        else:
            beta = max(0.0, (product - float(np.vdot(state.residual, z))) / state.product)  # Polak-Ribiere
            d = beta * state.direction - z
        u_d = self._apply_change(d)
        alpha = -float(np.vdot(r, d)) / float(np.vdot(d, u_d))
        state.p, state.u = state.p + alpha * d, state.u + alpha * u_d
        state.direction, state.residual, state.product, state.since = d, r, product, state.since + 1
        state.negative = bool(state.p.min() < 0)
        if state.negative and (product <= self.settled**2 * state.first or state.since >= LONGEST):
            self._cut(state, load)
        return True

    def _cut(self, state: _State, load: float) -> None:
        """p >= 0 and sum p = load."""
        p = np.maximum(state.p, 0.0)
        p *= load / p.sum()
        state.u = state.u + self._apply_change(p - state.p)
        state.p, state.negative = p, False
