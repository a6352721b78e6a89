# SPDX-License-Identifier: MIT
"""Contact on a box of cells: constrained, preconditioned conjugate gradients (see `sam.contact.normal`, paper Eq. 9 and 10).

Directions are transformed in single precision: what they lack is a share of a change, and the displacement that the iteration
carries along is replaced by one in double precision before it decides to stop. Pressures below zero are cut off once the
residual of the cells in contact, sqrt(r . z), has fallen to `HalfSpaces.settled` of what a sequence of directions started with,
not in each iteration: each cut costs a displacement of its own and starts a new sequence.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from sam.contact.convolution import Window
from sam.contact.operators import Grid
from sam.contact.transforms import mirror_half, unfolded

PASSES = 500  # with a traction; 12 at beta mu = 0.1
# tolerance of the first pass, and of the next ones as a share of the residual
FIRST_PASS, NEXT_PASS = 1e-2, 0.1
ANEW = 1e-3  # of the residual, after which the displacement is computed anew in double precision
LONGEST = 20  # iterations without a cut
NOTHING_OPPOSITE = 1e100  # gap, in cells, where the counter-body ends


@dataclass
class _State:
    """Iterate: pressure, its displacement, the search direction and what belongs to it.

    count: how many cells of the box each stands for, 1 or (nx, ny).
    """

    p: np.ndarray
    u: np.ndarray
    count: np.ndarray | float
    free: np.ndarray | None = None  # cells that the sequence of directions changes: True, and
    weight: np.ndarray | None = None  # their counts over the sum of them
    direction: np.ndarray | None = None
    residual: np.ndarray | None = None  # times the count
    product: float = 0.0  # r . z of the last iteration
    first: float = 0.0  # of the first one of the sequence
    since: int = 0  # iterations of the sequence
    negative: bool = False

    def set_free(self, free: np.ndarray) -> None:
        """A new sequence of directions if the cells are others."""
        if self.free is None or not np.array_equal(free, self.free):
            counted = free * self.count
            self.free, self.weight = free, counted / counted.sum()
            self.direction, self.since = None, 0

    def projected(self, field: np.ndarray) -> np.ndarray:
        """Zero mean over the free cells, zero elsewhere."""
        return (field - np.vdot(self.weight, field)) * self.free

    def press(self, p: np.ndarray, load: float) -> np.ndarray:
        """p with the sum `load`."""
        return p * (load / (p * self.count).sum())


def gap_of_contact(p: np.ndarray, separation: np.ndarray) -> np.ndarray:
    """gap0 + u - delta, with delta from the mean over the cells in contact; inf where there is no counter-body."""
    return separation - separation[p > 0].mean()  # paper Eq. 9: h = h0 + u_3 - delta


def _mirrored(field: np.ndarray) -> bool:
    return np.array_equal(field, field[::-1]) and np.array_equal(field, field[:, ::-1])


class BoxContact:
    """Contact restricted to a box of cells: its operators are built once and serve any gap and load (Eq. 9 and 10).

    Without a traction, and where the gap is mirrored in x and in y, a quarter of the box is iterated.
    """

    def __init__(self, grid: Grid, box: Window):
        self.grid, self.box = grid, box
        self.tangential, self.relaxation = grid.tangential(box, box), grid.relaxation
        self.residuals: list[
            float
        ] = []  # of the last solve: after each pass; without traction each iteration with no p < 0

    @cached_property
    def _whole(self) -> _Iteration:
        return _Iteration(self.grid, self.box, mirrored=False)

    @cached_property
    def _quarter(self) -> _Iteration:
        return _Iteration(self.grid, self.box, mirrored=True)

    def solve(
        self, gap0: np.ndarray, load: float, p: np.ndarray, tolerance: float, limit: int, sign: float = 1.0
    ):
        """p_hat on the box with all residuals below the tolerance, or the last iterate when that is not reached.

        gap0: on the box, in cells hx; load: sum of p_hat; p: start; sign: of the traction along x; limit: of iterations.
        Returns (p_hat, u_hat, iterations), u_hat with the part of the traction.
        """
        gap0, self.residuals = np.minimum(gap0, NOTHING_OPPOSITE), []
        if self.tangential is None:
            return self._normal(gap0, load, p, tolerance, limit)
        total, inner, moved = 0, max(FIRST_PASS, tolerance), sign * self.tangential(p * (load / p.sum()))
        for _ in range(PASSES):
            p, u, iterations = self._whole.solve(gap0 + moved, load, p, inner, limit - total)
            total, current = total + iterations, sign * self.tangential(p)
            worst = self._whole.residual(p, gap_of_contact(p, gap0 + u + current))
            self.residuals.append(worst)
            if worst <= tolerance or total >= limit:
                break
            inner = max(NEXT_PASS * worst, tolerance / 2)
            moved = moved + self.relaxation * (current - moved)
        return p, u + current, total

    def displacement(self, p: np.ndarray, sign: float) -> np.ndarray:
        """u_hat on the box of p_hat there, with the part of the traction; sign: of that along x."""
        if self.tangential is None:
            return self._quarter.displacement(p) if _mirrored(p) else self._whole.displacement(p)
        return self._whole.displacement(p) + sign * self.tangential(p)

    def _normal(self, gap0: np.ndarray, load: float, p: np.ndarray, tolerance: float, limit: int):
        """`solve` without traction."""
        if not _mirrored(gap0):
            return self._recorded(self._whole, gap0, load, p, tolerance, limit)
        if not (p > 0)[tuple(mirror_half(n) for n in p.shape)].any():
            p = np.ones_like(p)  # a start that the kept quarter does not see
        return self._recorded(self._quarter, gap0, load, p, tolerance, limit)

    def _recorded(self, iteration: _Iteration, *arguments):
        found = iteration.solve(*arguments)
        self.residuals = iteration.residuals
        return found


class _Iteration:
    """The conjugate gradients on all of a box, or on the quarter from its middle outward."""

    def __init__(self, grid: Grid, box: Window, mirrored: bool):
        self.box, self.counters, self.self_influence = box, grid.counters, grid.self_influence
        self.operator, self.precondition = (
            grid.box_operator(box, mirrored),
            grid.preconditioner(box, mirrored),
        )
        bodies, self.mirrored, self.count = grid.bodies, mirrored, 1.0
        self.patience, self.single, self.settled = bodies.patience, bodies.single, bodies.settled
        if mirrored:
            self.kept = tuple(mirror_half(n) for n in box.shape)
            self.count = np.outer(*(np.full(n - n // 2, 2.0) for n in box.shape))
            self.count[0] /= 1 + box.nx % 2  # the middle cell of an odd number is its own mirror image
            self.count[:, 0] /= 1 + box.ny % 2

    def displacement(self, p: np.ndarray) -> np.ndarray:
        """u_hat on the box of p_hat there."""
        return self._back(self._apply(self._kept(p)))

    def solve(self, gap0: np.ndarray, load: float, p: np.ndarray, tolerance: float, limit: int):
        """(p_hat, u_hat, iterations) on the box, see `BoxContact.solve`.

        Gives up after `limit` iterations, or after many without a new smallest residual (`HalfSpaces.patience`): rounding, or
        a tolerance below it.
        """
        p, u, iterations = self._solve(self._kept(gap0), load, self._kept(p), tolerance, limit)
        return self._back(p), self._back(u), iterations

    def _kept(self, field: np.ndarray) -> np.ndarray:
        return field[self.kept] if self.mirrored else field

    def _back(self, kept: np.ndarray) -> np.ndarray:
        return kept[np.ix_(*map(unfolded, self.box.shape))] if self.mirrored else kept

    def _apply(self, p: np.ndarray) -> np.ndarray:
        self.counters.displacement_applications += 1
        return self.operator(p)

    def _apply_change(self, change: np.ndarray) -> np.ndarray:
        self.counters.displacement_applications += 1
        return self.operator.single(change) if self.single else self.operator(change)

    def residual(self, p: np.ndarray, gap: np.ndarray) -> float:
        """The larger of |gap| in contact and penetration elsewhere, as a relative pressure error.

        See `Contact`. These are the conditions of paper Eq. 9; `_cut` enforces p >= 0.
        """
        inside = gap * (p > 0)
        return max(inside.max(), -gap.min()) / (self.self_influence * p.max())

    def _solve(self, gap0: np.ndarray, load: float, p: np.ndarray, tolerance: float, limit: int):
        state = _State(p, p, self.count)
        state.p = state.press(p, load)
        state.u, fresh = self._apply(state.p), True
        gap0 = gap0 - (gap0 + state.u)[p > 0].mean()  # gaps near zero: sums over many cells then round little
        iteration, smallest, since, anew, self.residuals = 0, np.inf, 0, 0.0, []
        while iteration < limit and since < self.patience:
            separation = gap0 + state.u
            if not state.negative:
                contact = state.p > 0
                counted = contact * self.count
                gap = separation - np.vdot(counted, separation) / counted.sum()
                worst = self.residual(state.p, gap)
                self.residuals.append(float(worst))
                if fresh and worst <= tolerance:
                    break
                if fresh:
                    anew = max(ANEW * worst, tolerance)
                elif worst <= anew:
                    state.p = state.press(state.p, load)
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
        r = r * self.count
        product = float(np.vdot(r, z))
        if product <= 0.0:
            return False
        if state.direction is None:
            d, state.first = -z, product
        else:
            beta = max(0.0, (product - float(np.vdot(state.residual, z))) / state.product)  # Polak-Ribiere
            d = beta * state.direction - z  # paper Eq. 10, third line, preconditioned
        u_d = self._apply_change(d)
        alpha = -float(np.vdot(r, d)) / float(np.vdot(self.count * d, u_d))
        # paper Eq. 10, first and second line: u carries the residual
        state.p, state.u = state.p + alpha * d, state.u + alpha * u_d
        state.direction, state.residual, state.product, state.since = d, r, product, state.since + 1
        state.negative = bool(state.p.min() < 0)
        if state.negative and (product <= self.settled**2 * state.first or state.since >= LONGEST):
            self._cut(state, load)
        return True

    def _cut(self, state: _State, load: float) -> None:
        """p >= 0 and sum p = load."""
        p = state.press(np.maximum(state.p, 0.0), load)  # paper Eq. 9: p >= 0
        state.u = state.u + self._apply_change(p - state.p)
        state.p, state.negative = p, False
