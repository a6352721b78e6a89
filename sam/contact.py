# SPDX-License-Identifier: MIT
"""Normal contact of two half-spaces: constrained conjugate gradients on the cells in contact.

Paper Eq. 9 and 10, read as follows. Eq. 9 is printed h = h + delta + u_3 with "h >= 0 then p >= 0"; used here is
gap = gap0 + u_3 - delta with gap >= 0, p >= 0, p gap = 0. Eq. 10 lacks d_k in the residual update and in
d_{k+1} = -r_{k+1} + beta d_k; used here is the textbook recurrence (Polonsky & Keer 1999), preconditioned.

Everything inside is dimensionless, so that no tolerance depends on units: lengths in cells hx, pressures as
p_hat = 2 p/E*, for which u_hat = C p_hat with the coefficients C of `sam.bodies`: of half-spaces, or of a coated one.

In full slip the traction q = mu p moves unlike bodies apart or together too, u_hat = C p_hat + 2 beta C_31 mu p_hat with
Dundurs' beta (Eq. 5, j = 1). The problem is then not symmetric: the conjugate gradients run with a tangential part that lags
behind, in passes, until the gap with the current one is closed. The tangential part is antisymmetric and at most b = beta mu of
the normal one (transforms i n_1 b and 1, times 1/k): relaxed by 1/(1 + b^2), each pass leaves b/sqrt(1 + b^2) of the error.
With a coating b depends on the wave number; its largest value counts.
"""

from __future__ import annotations

from collections.abc import Callable
from copy import copy
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy import fft

from sam.bodies import HALF_SPACES, HalfSpaces
from sam.convolution import Convolution, Counters, Window
from sam.kernels.patches import parity

COARSEST = 24  # a grid smaller than this in x or y starts from uniform pressure
COARSE_TOLERANCE = 1e-3  # of a start: the finer grid corrects what is left
PASSES = 500  # with a traction; 12 at beta mu = 0.1
FIRST_PASS, NEXT_PASS = 1e-2, 0.1  # tolerance of the first pass, and of the next ones as a share of the residual
MARGIN = 3  # cells around the estimated contact that are allowed to come into contact


@dataclass(frozen=True)
class Contact:
    """Solution of a normal contact on the full grid.

    pressure, displacement, gap: (nx, ny) in Pa, m, m; displacement is that of both bodies together, positive when they
    approach less; approach in m; box: the cells that were allowed into contact; area: in m^2, where the scene gives it.

    Measured on the returned fields: gap_residual = max |gap| over the cells in contact and penetration = max(-gap)
    over the others, both divided by the displacement that the largest pressure causes in its own cell, so that they
    estimate a relative pressure error; tension = max(-p)/max p; load_error = |hx hy sum p - F|/F.
    """

    pressure: np.ndarray
    displacement: np.ndarray
    gap: np.ndarray
    approach: float
    box: Window
    gap_residual: float
    penetration: float
    tension: float
    load_error: float
    iterations: int
    converged: bool
    area: float | None = None

    @property
    def residual(self) -> float:
        """The larger of gap_residual and penetration."""
        return max(self.gap_residual, self.penetration)


class Grid:
    """Dimensionless coefficients of a grid of cells; operators between windows of it share them.

    shape: (nx, ny); aspect: hy/hx; coupling: see `sam.grid.coupling_of`, a number or (nx, ny), with 0 nothing is built
    for it; bodies: what is in contact; self_influence: the displacement that p_hat = 1 causes in its own cell.
    """

    def __init__(
        self,
        shape: tuple[int, int],
        aspect: float,
        counters: Counters,
        coupling: float | np.ndarray = 0.0,
        bodies: HalfSpaces = HALF_SPACES,
    ):
        self.shape, self.aspect, self.counters, self.bodies = shape, aspect, counters, bodies
        self.coupling = np.broadcast_to(coupling, shape) if np.any(coupling) else None
        self.whole = Window(0, 0, *shape)
        self.coefficients = bodies.normal(*shape, aspect)
        self.self_influence = float(self.coefficients[0, 0])

    def with_coupling(self, coupling: float | np.ndarray) -> Grid:
        """The same grid with another coefficient of friction; it shares what is computed."""
        other = copy(self)
        other.coupling = np.broadcast_to(coupling, self.shape) if np.any(coupling) else None
        return other

    def operator(self, source: Window, observed: Window) -> Callable[[np.ndarray], np.ndarray]:
        """p_hat on `source` -> u_hat on `observed` (Eq. 5, i = 3)."""
        lx, ly = Convolution.lags_needed(source, observed)
        convolution = Convolution(self.coefficients[None, :lx, :ly], [(1, 1)], source, observed, self.counters)

        def apply(p_hat: np.ndarray) -> np.ndarray:
            self.counters.displacement_applications += 1
            return convolution(p_hat)[0]

        return apply

    def tangential(self, source: Window, observed: Window) -> Callable[[np.ndarray], np.ndarray] | None:
        """p_hat on `source` -> u_hat on `observed` of its traction (Eq. 5, i = 3, j = 1); None without coupling."""
        if self.coupling is None:
            return None
        lx, ly = Convolution.lags_needed(source, observed)
        coefficients = self._tangential_coefficients[None, :lx, :ly]
        convolution = Convolution(coefficients, [parity("3", 1)], source, observed, self.counters)
        coupling = self.coupling[source.slices]

        def apply(p_hat: np.ndarray) -> np.ndarray:
            self.counters.displacement_applications += 1
            return convolution(coupling * p_hat)[0]

        return apply

    @cached_property
    def _tangential_coefficients(self) -> np.ndarray:
        self.counters.tangential_kernels += 1
        return self.bodies.tangential(*self.shape, self.aspect)

    @property
    def relaxation(self) -> float:
        """Of the passes of a contact with traction, 1/(1 + b^2)."""
        if self.coupling is None:
            return 1.0
        return 1 / (1 + (self.bodies.tangential_share(max(self.shape)) * np.abs(self.coupling).max()) ** 2)

    def displacement(self, p_hat: np.ndarray, source: Window, observed: Window, sign: float = 1.0) -> np.ndarray:
        """u_hat on `observed` of p_hat on `source` and of its traction, which acts along sign times x."""
        u, tangential = self.operator(source, observed)(p_hat), self.tangential(source, observed)
        return u if tangential is None else u + sign * tangential(p_hat)

    def preconditioner(self, box: Window) -> Callable[[np.ndarray], np.ndarray]:
        """r -> F^-1 s(|k|) F r on the box: the inverse of the operator on the whole plane, p_k = s(|k|) u_k."""
        kx = 2 * np.pi * fft.fftfreq(box.nx)[:, None]
        ky = 2 * np.pi * fft.rfftfreq(box.ny)[None, :] / self.aspect
        k = np.hypot(kx, ky)
        k[0, 0] = np.pi / max(box.nx, box.ny * self.aspect)  # any positive value: residuals have zero mean
        symbol = self.bodies.stiffness(k)

        def apply(r: np.ndarray) -> np.ndarray:
            self.counters.ffts += 2
            return fft.irfft2(symbol * fft.rfft2(r), s=box.shape)

        return apply


@dataclass
class _State:
    """Iterate on the box: pressure, its displacement, the search direction and what belongs to it."""

    p: np.ndarray
    u: np.ndarray
    direction: np.ndarray
    residual: np.ndarray | None = None
    product: float = 1.0  # r . z of the last iteration
    active: np.ndarray | None = None


def gap_of_contact(p: np.ndarray, separation: np.ndarray) -> np.ndarray:
    """gap0 + u - delta, with delta from the mean over the cells in contact; inf where there is no counter-body."""
    return separation - separation[p > 0].mean()


class BoxContact:
    """Contact restricted to a box of cells: its operators are built once and serve any gap and load (Eq. 9 and 10)."""

    def __init__(self, grid: Grid, box: Window):
        self.box, self.counters, self.self_influence = box, grid.counters, grid.self_influence
        self.apply, self.precondition = grid.operator(box, box), grid.preconditioner(box)
        self.tangential = grid.tangential(box, box)
        self.relaxation, self.patience = grid.relaxation, grid.bodies.patience

    def solve(self, gap0: np.ndarray, load: float, p: np.ndarray, tolerance: float, limit: int, sign: float = 1.0):
        """p_hat on the box with all residuals below the tolerance, or the last iterate when that is not reached.

        gap0: on the box, in cells hx; load: sum of p_hat; p: start; sign: of the traction along x; limit: of iterations.
        Returns (p_hat, u_hat, iterations), u_hat with the part of the traction.
        """
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
        return self.apply(p) if self.tangential is None else self.apply(p) + sign * self.tangential(p)

    def _residual(self, p: np.ndarray, gap: np.ndarray) -> float:
        """The larger of |gap| in contact and penetration elsewhere, as a relative pressure error (see `Contact`)."""
        contact = p > 0
        return max(np.abs(gap[contact]).max(), -gap[~contact].min(initial=0.0)) / (self.self_influence * p.max())

    def _normal(self, gap0: np.ndarray, load: float, p: np.ndarray, tolerance: float, limit: int):
        """`solve` without traction, or with a displacement of its traction that is part of gap0.

        The displacement carried along is replaced by a fresh one before it decides to stop. Gives up after `limit`
        iterations, or after many without a new smallest residual (`HalfSpaces.patience`): rounding, or a tolerance below it.
        """
        p = p * (load / p.sum())
        state, fresh = _State(p, self.apply(p), np.zeros_like(p)), True
        iteration, smallest, since = 0, np.inf, 0
        while iteration < limit and since < self.patience:
            gap = gap_of_contact(state.p, gap0 + state.u)
            worst = self._residual(state.p, gap)
            if worst <= tolerance:
                if fresh:
                    break
                state.p *= load / state.p.sum()
                state.u, fresh = self.apply(state.p), True
                continue
            smallest, since = (worst, 0) if worst < smallest else (smallest, since + 1)
            free = (state.p > 0) | (gap < -0.01 * tolerance * self.self_influence * state.p.max())
            if not self._step(state, gap, free, load):
                break
            fresh = False
            iteration += 1
            self.counters.contact_iterations += 1
        return state.p, state.u, iteration

    def _step(self, state: _State, gap: np.ndarray, free: np.ndarray, load: float) -> bool:
        """One iteration of Eq. 10 on the cells in `free`: a step of zero sum, then p >= 0 and sum p = load.

        False, and nothing done, when the residual is zero in double precision.
        """

        def project(v):
            return np.where(free, v - v[free].mean(), 0.0)

        r = project(np.where(free, gap, 0.0))
        z = project(self.precondition(r))
        product = float(np.vdot(r, z))
        if product <= 0.0:
            return False
        if state.active is not None and np.array_equal(free, state.active):
            beta = max(0.0, (product - float(np.vdot(state.residual, z))) / state.product)  # Polak-Ribiere
        else:
            beta = 0.0  # the set changed: start a new sequence of directions
        d = beta * state.direction - z
        u_d = self.apply(d)
        alpha = -float(np.vdot(r, d)) / float(np.vdot(d, u_d))
        p = state.p + alpha * d
        if (p < 0).any():
            p = np.maximum(p, 0.0)
            p *= load / p.sum()
            state.u = self.apply(p)
        else:
            state.u = state.u + alpha * u_d
        state.p, state.direction, state.residual, state.product, state.active = p, d, r, product, free
        return True


def _coarse_start(grid: Grid, gap0: np.ndarray, load: float) -> np.ndarray:
    """Pressure interpolated from the solution on every second cell (recursive); uniform on the coarsest grid."""
    nx, ny = grid.shape
    possible = np.isfinite(gap0)
    # every second cell, among them the central one
    ox, oy = (nx // 2) % 2, (ny // 2) % 2
    coarse_gap = gap0[ox::2, oy::2] / 2
    if min(coarse_gap.shape) < COARSEST or not np.isfinite(coarse_gap).any():
        return possible.astype(float)
    coarse = Grid(coarse_gap.shape, grid.aspect, grid.counters, bodies=grid.bodies.coarser())
    start = _coarse_start(coarse, coarse_gap, load / 4)
    p, *_ = _growing_box(coarse, coarse_gap, load / 4, start, COARSE_TOLERANCE, 60)
    fine = np.zeros((nx + 3, ny + 3))  # a frame of zeros, for the last odd row and the wings of the interpolation
    fine[ox + 1 : nx + 1 : 2, oy + 1 : ny + 1 : 2] = p
    fine[1:-1] += (fine[:-2] + fine[2:]) / 2
    fine[:, 1:-1] += (fine[:, :-2] + fine[:, 2:]) / 2
    start = np.where(possible, fine[1 : nx + 1, 1 : ny + 1], 0.0)
    return start if start.sum() > 0 else possible.astype(float)


def around(cells: np.ndarray) -> Window:
    """The smallest window that holds all true cells, and a margin."""
    bounds = []
    for axis, n in enumerate(cells.shape):
        hit = np.flatnonzero(cells.any(axis=1 - axis))
        margin = MARGIN + (hit[-1] - hit[0]) // 16
        bounds.append((max(hit[0] - margin, 0), min(hit[-1] + margin + 1, n)))
    (i0, i1), (j0, j1) = bounds
    return Window(int(i0), int(j0), int(i1 - i0), int(j1 - j0))


def _growing_box(grid: Grid, gap0: np.ndarray, load: float, start: np.ndarray, tolerance: float, limit: int):
    """Contact restricted to a box around the start, checked on the full grid, the box grown until nothing penetrates.

    Returns (p_hat, u_hat, box, iterations), both fields on the full grid.
    """
    cells, total = start > 0, 0
    while True:
        box = around(cells)
        p_box, _, iterations = BoxContact(grid, box).solve(gap0[box.slices], load, start[box.slices], tolerance, limit)
        total += iterations
        p = np.zeros(grid.shape)
        p[box.slices] = p_box
        u = grid.displacement(p_box, box, grid.whole)
        outside = gap_of_contact(p, gap0 + u) < -tolerance * grid.self_influence * p.max()
        outside[box.slices] = False
        if not outside.any():
            return p, u, box, total
        start, cells = p, (p > 0) | outside


def solve_contact(
    gap0: np.ndarray,
    hx: float,
    hy: float,
    modulus: float,
    force: float,
    *,
    coupling: float | np.ndarray = 0.0,
    bodies: HalfSpaces = HALF_SPACES,
    start: np.ndarray | None = None,
    tolerance: float = 1e-10,
    max_iterations: int | None = None,
    counters: Counters | None = None,
) -> Contact:
    """Pressure between two elastic half-spaces pressed together by a force, at rest or sliding. Paper Eq. 9 and 10.

    gap0: (nx, ny) initial gap in m at the cell centres, inf where the counter-body ends; hx, hy: cell size in m;
    modulus: E* with 1/E* = (1 - nu1^2)/E1 + (1 - nu2^2)/E2 in Pa; force in N, > 0; coupling: 2 beta mu of Dundurs' beta and
    the traction mu p on body 1 along x, a number or (nx, ny); bodies: a coated body 1 (`sam.bodies.CoatedBodies`, made for
    this hx and modulus, its coupling being mu); start: pressure of a neighbouring problem (else coarser grids provide one);
    tolerance: on the dimensionless residuals (see Contact).

    Raises ValueError for a gap without a finite cell or with NaN, and for sizes, modulus or force that are not
    positive.
    """
    for name, value in (("hx", hx), ("hy", hy), ("modulus", modulus), ("force", force)):
        if not (np.isfinite(value) and value > 0):
            raise ValueError(f"{name} = {value!r}: a finite number > 0 is needed")
    if np.isnan(gap0).any() or not np.isfinite(gap0).any():
        raise ValueError("gap0: at least one finite value and no NaN are needed")
    counters = counters if counters is not None else Counters()
    limit = bodies.most_iterations if max_iterations is None else max_iterations
    unit = modulus / 2  # Pa per p_hat
    grid = Grid(gap0.shape, hy / hx, counters, coupling, bodies)
    gap_hat, load = gap0 / hx, force / (hx * hy * unit)
    if start is None or not (start > 0).any():
        start = _coarse_start(grid, gap_hat, load)
    p, u, box, iterations = _growing_box(grid, gap_hat, load, start, tolerance, limit)
    return measured(grid, gap0, p, u, hx, hy, unit, force, box, iterations, tolerance)


def measured(
    grid: Grid,
    gap0: np.ndarray,
    p: np.ndarray,
    u: np.ndarray,
    hx: float,
    hy: float,
    unit: float,
    force: float,
    box: Window,
    iterations: int,
    tolerance: float,
) -> Contact:
    """The Contact of p_hat and u_hat on the full grid, with its residuals measured there.

    gap0 in m, with the residual displacement of the surface if it has any; unit: Pa per p_hat; converged if the
    residuals are within twice the tolerance (rounding of a sum over another window).
    """
    separation = gap0 / hx + u
    gap = gap_of_contact(p, separation)
    contact = p > 0
    scale = grid.self_influence * p.max()
    gap_residual = float(np.abs(gap[contact]).max() / scale)
    penetration = float(max(0.0, -gap[~contact].min(initial=0.0)) / scale)
    pressure = p * unit
    return Contact(
        pressure=pressure,
        displacement=u * hx,
        gap=gap * hx,
        approach=float(separation[contact].mean() * hx),
        box=box,
        gap_residual=gap_residual,
        penetration=penetration,
        tension=float(max(0.0, -pressure.min()) / pressure.max()),
        load_error=abs(float(pressure.sum()) * hx * hy - force) / force,
        iterations=iterations,
        converged=max(gap_residual, penetration) <= 2 * tolerance,
    )


def no_contact(gap0: np.ndarray) -> Contact:
    """The state without force: the surfaces as they first touch."""
    zero = np.zeros(gap0.shape)
    lowest = float(gap0.min())
    return Contact(zero, zero, gap0 - lowest, lowest, Window(0, 0, *gap0.shape), 0.0, 0.0, 0.0, 0.0, 0, True)
