# SPDX-License-Identifier: MIT
"""Normal contact of two half-spaces: constrained conjugate gradients on the cells in contact.

Paper Eq. 9 and 10, read as follows. Eq. 9 is printed h = h + delta + u_3 with "h >= 0 then p >= 0"; used
here is gap = gap0 + u_3 - delta with gap >= 0, p >= 0, p gap = 0. Eq. 10 lacks d_k in the residual update
and in d_{k+1} = -r_{k+1} + beta d_k, and its minus signs before alpha go with +r_{k+1}; used here is the
textbook recurrence (Polonsky & Keer 1999), preconditioned. See docs/equations.md.

Everything inside is dimensionless, so that no tolerance depends on units: lengths in cells hx, pressures as
p_hat = 2 p/E*, for which u_hat = C p_hat with the coefficients C of `sam.contact.operators`: of half-spaces,
or of a coated one.

In full slip the traction q = mu p moves unlike bodies apart or together too, u_hat = C p_hat + 2 beta C_31
mu p_hat with Dundurs' beta (D_31 of Eq. 5). The problem is then not symmetric: the conjugate gradients run
with a tangential part that lags behind, in passes, until the gap with the current one is closed. The
tangential part is antisymmetric and at most b = beta mu of the normal one (transforms i n_1 b and 1, times
1/k): relaxed by 1/(1 + b^2), each pass leaves b/sqrt(1 + b^2) of the error. With a coating b depends on the
wave number; its largest value counts.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import pi

import numpy as np

from sam.arrays import Array, Mask
from sam.contact.box import ApproachControl, BoxContact, Control, ForceControl, gap_of_contact
from sam.contact.convolution import Counters
from sam.contact.operators import HALF_SPACES, HalfSpaces, SurfaceOperators
from sam.grid.cells import Window, at_edge
from sam.scene import Status
from sam.scene.result import unfinished
from sam.schedule import Approach

# Iterations on all grids together, to 1e-8 for a sphere on 129 x 129 cells: 27, half of them on coarse ones.
COARSEST = 48  # a grid smaller than this in x or y starts from uniform pressure: 27; 24 29, 8 33
COARSE_TOLERANCE = 1e-1  # of a start, the finer grid corrects what is left: 27; 1e-3 29, 1e-6 32
COARSE_LIMIT = 60  # iterations of a start, which is as good as it then is
# Share of a periodic grid up to which a box, padded with zeros, takes less time than all of its cells.
LARGEST_PADDED = 1 / 3
MARGIN = 3  # cells around the estimated contact that may come into contact; 1 and 8 the same


@dataclass(frozen=True)
class Units:
    """Units of the dimensionless fields: u_hat in hx (m), p_hat in E*/2, with the modulus E* in Pa."""

    hx: float
    hy: float
    modulus: float

    @property
    def pressure(self) -> float:
        """Pa per p_hat."""
        return self.modulus / 2

    @property
    def force(self) -> float:
        """N per sum of p_hat."""
        return self.hx * self.hy * self.pressure


def control_of(given: float | Approach, hx: float, force_unit: float) -> Control:
    """What is given, a force in N or an approach, in the units of the module; force_unit: N per p_hat."""
    if isinstance(given, Approach):
        return ApproachControl(given.distance / hx)
    return ForceControl(given / force_unit)


@dataclass(frozen=True)
class Search:
    """How a contact is solved; tolerance: on residuals; start: (nx, ny) pressure of a neighbour."""

    tolerance: float = 1e-10
    start: Array | None = None
    max_iterations: int | None = None
    counters: Counters | None = None


@dataclass(frozen=True)
class Contact:
    """Solution of a normal contact on the full grid: pressure in Pa, displacement of both bodies
    (positive: apart) and gap in m, all (nx, ny); approach in m; force in N; box: allowed cells.

    gap_residual, penetration: max |gap| in contact and max(-gap) beside it, over the displacement
    that the largest pressure causes in its own cell; tension, load_error: max(-p)/max p and the
    missing share of the force; area in m^2; residuals: the larger of both, by iteration; ending: in
    words; compliance: displacement per pressure of one cell, in m/Pa.
    """

    pressure: Array
    displacement: Array
    gap: Array
    approach: float
    force: float
    box: Window
    gap_residual: float
    penetration: float
    tension: float
    load_error: float
    iterations: int
    converged: bool
    area: float | None = None
    residuals: tuple[float, ...] = ()
    ending: str = ""
    compliance: float = 0.0

    @property
    def residual(self) -> float:
        """The larger of gap_residual and penetration."""
        return max(self.gap_residual, self.penetration)


def _coarse_start(operators: SurfaceOperators, gap0: Array, control: Control) -> Array:
    """Pressure interpolated from every second cell (recursive); `Control.start` on the coarsest grid."""
    nx, ny = operators.shape
    # every second cell, among them the central one
    ox, oy = (nx // 2) % 2, (ny // 2) % 2
    coarse_gap, on_coarse = gap0[ox::2, oy::2] / 2, control.coarser()
    fewer = min(coarse_gap.shape) < COARSEST or (operators.bodies.periodic and operators.odd)
    if fewer or not on_coarse.touches(coarse_gap):
        return control.start(gap0)
    shape, bodies = (coarse_gap.shape[0], coarse_gap.shape[1]), operators.bodies.coarser()
    coarse = SurfaceOperators(shape, operators.aspect, operators.counters, bodies=bodies)
    start = _coarse_start(coarse, coarse_gap, on_coarse)
    box = around(start > 0)  # what comes into contact beside it, the finest grid finds
    p = np.zeros(coarse.shape)
    gap, begin = coarse_gap[box.slices], start[box.slices]
    contact = BoxContact(coarse, box)
    p[box.slices] = contact.solve(gap, on_coarse, begin, tolerance=COARSE_TOLERANCE, limit=COARSE_LIMIT).p
    # a frame of zeros, for the last odd row and the wings of the interpolation
    fine = np.zeros((nx + 3, ny + 3))
    fine[ox + 1 : nx + 1 : 2, oy + 1 : ny + 1 : 2] = p
    fine[1:-1] += (fine[:-2] + fine[2:]) / 2
    fine[:, 1:-1] += (fine[:, :-2] + fine[:, 2:]) / 2
    start = np.where(np.isfinite(gap0), fine[1 : nx + 1, 1 : ny + 1], 0.0)
    return start if start.sum() > 0 else control.start(gap0)


def margin_around(cells: int) -> int:
    """How many cells on each side of a contact of so many cells may come into contact too."""
    return MARGIN + (cells - 1) // 16


def around(cells: Mask) -> Window:
    """The smallest window that holds all true cells, and a margin."""
    bounds = []
    for axis, n in enumerate(cells.shape):
        hit = np.flatnonzero(cells.any(axis=1 - axis))
        margin = margin_around(int(hit[-1] - hit[0]) + 1)
        bounds.append((max(hit[0] - margin, 0), min(hit[-1] + margin + 1, n)))
    (i0, i1), (j0, j1) = bounds
    return Window(int(i0), int(j0), int(i1 - i0), int(j1 - j0))


@dataclass(frozen=True)
class Solved:
    """p_hat and u_hat on the full grid, the box that was allowed into contact, and the iterations."""

    p: Array
    u: Array
    box: Window
    iterations: int = 0
    residuals: tuple[float, ...] = ()


def _growing_box(
    operators: SurfaceOperators, gap0: Array, control: Control, start: Array, *, tolerance: float, limit: int
) -> Solved:
    """Solve in a box around the start, and grow it until nothing outside of it penetrates."""
    residuals: tuple[float, ...] = ()
    cells, total, grid = start > 0, 0, BoxContact(operators, operators.whole)
    while True:
        box = around(cells)
        if operators.bodies.periodic and box.nx * box.ny > LARGEST_PADDED * cells.size:
            box = operators.whole
        contact = BoxContact(operators, box)
        p_box, u, iterations = contact.solve(
            gap0[box.slices], control, start[box.slices], tolerance=tolerance, limit=limit
        )
        total, residuals = total + iterations, (*residuals, *contact.residuals)
        if box == operators.whole:
            return Solved(p_box, u, box, total, residuals)
        p = np.zeros(operators.shape)
        p[box.slices] = p_box
        u = grid.displacement(p, 1.0)
        outside = gap_of_contact(p, gap0 + u, control) < -tolerance * operators.self_influence * p.max()
        outside[box.slices] = False
        if not outside.any():
            return Solved(p, u, box, total, residuals)
        start, cells = p, (p > 0) | outside


def solve_contact(
    gap0: Array,
    cell: tuple[float, float],
    modulus: float,
    given: float | Approach,
    *,
    coupling: float | Array = 0.0,
    bodies: HalfSpaces = HALF_SPACES,
    search: Search = Search(),
) -> Contact:
    """Pressure between two elastic half-spaces pressed together, at rest or sliding. Paper Eq. 9 and 10.

    Parameters
    ----------
    gap0
        (nx, ny) initial gap in m at the cell centres, inf where the counter-body ends.
    cell
        (hx, hy), sides of a cell in m.
    modulus
        E* in Pa, 1/E* = (1 - nu1^2)/E1 + (1 - nu2^2)/E2.
    given
        Force in N, > 0, or `Approach` in its place: the force is then a result, zero where nothing touches.
    coupling
        2 beta mu of Dundurs' beta and the traction mu p on body 1 along x, a number or (nx, ny).
    bodies
        A coated body 1 (`CoatedBodies`, made for this hx and modulus, its coupling being mu).
    search
        Tolerance, start and limits.

    Returns
    -------
    Contact
        Fields on the full grid with their residuals; `converged` says whether these are within the tolerance.

    Raises
    ------
    ValueError
        For a gap without a finite cell or with NaN, and for other numbers that are not positive.

    Examples
    --------
    A sphere with R = E* = 1 under F = 4/3 approaches a plane by 1, the peak pressure is 2/pi (Hertz):

    >>> x = (np.arange(64) - 31.5) / 20
    >>> contact = solve_contact((x[:, None] ** 2 + x**2) / 2, (0.05, 0.05), 1.0, 4 / 3)
    >>> contact.converged, round(contact.approach, 2), round(float(contact.pressure.max()), 2)
    (True, 1.0, 0.64)
    >>> round(solve_contact((x[:, None] ** 2 + x**2) / 2, (0.05, 0.05), 1.0, Approach(1.0)).force, 2)
    1.33
    """
    positive = {"hx": cell[0], "hy": cell[1], "modulus": modulus}
    positive |= {"approach": given.distance} if isinstance(given, Approach) else {"force": given}
    for name, value in positive.items():
        if not (np.isfinite(value) and value > 0):
            raise ValueError(f"{name} = {value!r}: a finite number > 0 is needed")
    if np.isnan(gap0).any() or not np.isfinite(gap0).any():
        raise ValueError("gap0: at least one finite value and no NaN are needed")
    counters = search.counters if search.counters is not None else Counters()
    limit = bodies.most_iterations if search.max_iterations is None else search.max_iterations
    units, shape = Units(*cell, modulus), (gap0.shape[0], gap0.shape[1])
    operators = SurfaceOperators(shape, cell[1] / cell[0], counters, coupling=coupling, bodies=bodies)
    gap_hat, control, start = gap0 / units.hx, control_of(given, units.hx, units.force), search.start
    if not control.touches(gap_hat):
        return no_contact(gap0, given)
    if start is None or not (start > 0).any():
        start = _coarse_start(operators, gap_hat, control)
    solved = _growing_box(operators, gap_hat, control, start, tolerance=search.tolerance, limit=limit)
    contact = measured(operators, gap0, solved, units, given=given, tolerance=search.tolerance)
    contact = replace(contact, residuals=(*solved.residuals, contact.residual))
    if contact.converged:
        return contact
    within = solved.iterations < limit
    ending = unfinished("the contact iteration", contact.residuals, search.tolerance, within)
    return replace(contact, ending=ending)


def measured(
    operators: SurfaceOperators,
    gap0: Array,
    solved: Solved,
    units: Units,
    *,
    given: float | Approach,
    tolerance: float,
) -> Contact:
    """The Contact of p_hat and u_hat on the full grid, with its residuals there; gap0 in m."""
    p, hx = solved.p, units.hx
    separation, control = gap0 / hx + solved.u, control_of(given, hx, units.force)
    gap, contact = gap_of_contact(p, separation, control), p > 0
    scale = operators.self_influence * p.max()
    gap_residual = float(np.abs(gap[contact]).max() / scale)
    penetration = float(max(0.0, -gap[~contact].min(initial=0.0)) / scale)
    pressure = p * units.pressure
    total = float(pressure.sum()) * hx * units.hy
    if isinstance(given, Approach):
        force, approach = total, given.distance
    else:
        force, approach = given, control.approach(contact, separation) * hx
    return Contact(
        pressure=pressure,
        displacement=solved.u * hx,
        gap=gap * hx,
        approach=approach,
        force=force,
        box=solved.box,
        gap_residual=gap_residual,
        penetration=penetration,
        tension=float(max(0.0, -pressure.min()) / pressure.max()),
        load_error=abs(total - force) / force,
        iterations=solved.iterations,
        converged=max(gap_residual, penetration) <= 2 * tolerance,
        compliance=operators.self_influence * hx / units.pressure,
    )


def no_contact(gap0: Array, given: float | Approach = 0.0) -> Contact:
    """The state without force: the surfaces as they first touch, or as a given approach leaves them."""
    zero, window = np.zeros(gap0.shape), Window(0, 0, *gap0.shape)
    approach = given.distance if isinstance(given, Approach) else float(gap0.min())
    return Contact(zero, zero, gap0 - approach, approach, 0.0, window, 0.0, 0.0, 0.0, 0.0, 0, True)


# cells in the contact radius; with fewer the largest pressure is off by up to 4 %, from here on by 1 %
FEWEST_CELLS = 3.0


def fewest_in_spot(pressure: Array) -> int:
    """Cells that a spot of a pressure, (nx, ny), needs: of a circle, or in a row."""
    return round(pi * FEWEST_CELLS**2) if pressure.shape[1] > 1 else round(2 * FEWEST_CELLS)


def fit_of(contact: Contact, rough: bool = False, line: bool = False) -> Status:
    """CONVERGED, or what is wrong with a contact on the full grid; rough: all spots count together; line: all
    repeats along y.
    """
    if not contact.converged:
        return Status.NOT_CONVERGED
    touching = contact.pressure > 0
    if not touching.any():
        return Status.CONVERGED
    if rough:
        return (
            Status.CONVERGED if touching.sum() >= fewest_in_spot(contact.pressure) else Status.UNDER_RESOLVED
        )
    if at_edge(touching, line):
        return Status.CONTACT_AT_GRID_EDGE
    across = [touching.any(axis=1 - axis).sum() for axis in range(1 if line else 2)]
    if min(across) < 2 * FEWEST_CELLS:
        return Status.UNDER_RESOLVED
    return Status.CONVERGED
