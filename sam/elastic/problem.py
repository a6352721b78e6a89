# SPDX-License-Identifier: MIT
"""The plan of a solve, the elastic bodies on its grid, their contact under a load and the state it makes:
stresses at the output depths (paper Eq. 7, first sum), how friction moves the surface, and whether the stress
of the largest load yields anywhere. The load history of a body that stays elastic.

A misfit sphere: material about a centre that would grow, by the same linear strain in all directions, if
it were free.

The body around it makes stress of it. With the misfit strain e(r), E and nu, and the mean of e inside a
radius M(r) = 3/r^3 int_0^r e s^2 ds, that of an infinite body is s_r = -2 E M/(3 (1 - nu)) and s_theta - s_r
= E (M - e)/(1 - nu) (Timoshenko & Goodier 1970, Art. 152). Outside of the sphere it is that of a centre of
dilatation of strength S = int e s^2 ds * 3. A free surface adds the image of that centre (Mindlin & Cheng
1950), exact also above and inside the sphere, as the image of a point is harmonic in the place of the point.

With u = -K grad(1/R) of the centre, K = (1 + nu) S/(3 (1 - nu)), and phi = 1/R' about the mirrored centre the
displacement of the image is

    u' = -K ((3 - 4 nu) grad phi + 2 z grad phi_z - 2 (3 - 4 nu) e_z phi_z).                           (a)
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from math import pi

import numpy as np
from scipy.special import erf

from sam.arrays import Array
from sam.contact.convolution import Counters
from sam.contact.normal import Contact, Search, around, fit_of, no_contact, solve_contact
from sam.contact.operators import (
    DEPTHS_AT_ONCE,
    HALF_SPACES,
    LINE,
    CoatedPair,
    HalfSpaces,
    PeriodicHalfSpaces,
    SurfaceOperators,
    elastic_strain,
    moved_rows,
    stresses,
    von_mises,
    yielding,
)
from sam.grid.cells import CellGrid, InitialGap, Room, Shape, Sides, Window
from sam.grid.demands import GridDemand, MisfitDemand, RoughDemand, RoughPatch
from sam.half_space import ElasticConstants, ElasticPair
from sam.kernels.patches import Lags
from sam.moving import Track
from sam.results.history import (
    Coated,
    Comparison,
    Cut,
    History,
    Row,
    Sliding,
    Snapshot,
    counted,
    largest_pressure,
    row_of,
    row_of_largest,
)
from sam.results.tables import Remedies, advice
from sam.scene import LeftOut, Plasticity, Solver, Stage, Status
from sam.scene.result import Attempt, Progress, left_out_of
from sam.scene.verdict import Judging
from sam.schedule import UNLOADED, Coefficient, FullSlip, Load, Schedule
from sam.tribofilm.state import FilmOnCells, TribofilmState
from sam.wear import WearLaw

SMALL = 1e-2  # of x: below it the series of the mean of exp(-x^2), whose next term is 1e-13
POINTS, WEIGHTS = np.polynomial.legendre.leggauss(4)  # of the mean over a cell, in each direction
FARTHEST = 4.5  # radii: no grid is chosen for a larger zone (about 400 times the strain of first yield)
ZONE_POINTS = 4001  # at which the stress is looked at for the zone, 1e-3 radii apart
AT_ONCE = 200_000  # points whose stress is taken at once: 10 MB


@dataclass(frozen=True)
class Profile:
    """A misfit strain over x = r/radius, 1 at the centre, its mean inside x, and 3 int f x^2 dx."""

    local: Callable[[Array], Array]
    mean: Callable[[Array], Array]
    strength: float


def _inside(x: Array, inside: Callable[[Array], Array], strength: float) -> Array:
    """A mean that is `inside` up to x = 1, and that of the strength beyond."""
    return np.where(x < 1, inside(np.minimum(x, 1.0)), strength / np.maximum(x, 1.0) ** 3)


def _mean_of_gauss(x: Array) -> Array:
    large = np.maximum(x, SMALL)
    mean = 3 / large**3 * (np.sqrt(np.pi) / 4 * erf(large) - large / 2 * np.exp(-(large**2)))
    return np.where(x < SMALL, 1 - 3 / 5 * x**2 + 3 / 14 * x**4, mean)


PROFILES: Mapping[str, Profile] = {
    "smooth": Profile(
        lambda x: np.where(x < 1, (1 - np.minimum(x, 1.0) ** 2) ** 2, 0.0),
        lambda x: _inside(x, lambda s: 1 - 6 / 5 * s**2 + 3 / 7 * s**4, 8 / 35),
        8 / 35,
    ),
    "ball": Profile(lambda x: np.where(x < 1, 1.0, 0.0), lambda x: _inside(x, np.ones_like, 1.0), 1.0),
    "gauss": Profile(lambda x: np.exp(-(x**2)), _mean_of_gauss, 3 * float(np.sqrt(np.pi)) / 4),
}
"""The profiles of a scene, by their names."""


@dataclass(frozen=True)
class MisfitSphere:
    """A misfit strain, linear, about (0, 0, depth) in m; free: z = 0 has no tractions."""

    body: ElasticConstants
    depth: float
    radius: float
    strain: float
    profile: Profile
    free: bool

    def deviator(self, x: Array) -> Array:
        """s_theta - s_r of the infinite body in Pa at distances x, in radii, from the centre."""
        scale = self.body.young * self.strain / (1 - self.body.poisson)
        return scale * (self.profile.mean(x) - self.profile.local(x))

    def radial(self, x: Array) -> Array:
        """s_r of the infinite body in Pa at distances x, in radii, from the centre."""
        scale = self.body.young * self.strain / (1 - self.body.poisson)
        return -2 / 3 * scale * self.profile.mean(x)

    def zone(self, limit: float) -> float:
        """Radius in m of the plastic zone at a yield stress in Pa, FARTHEST radii at most, 0 for none."""
        scale = self.body.young * self.strain / (1 - self.body.poisson) * self.profile.strength
        x = np.linspace(0.0, min((scale / limit) ** (1 / 3), FARTHEST), ZONE_POINTS)
        reaching = x[self.deviator(x) >= limit * (1 - 1e-9)]
        return self.radius * float(reaching.max(initial=0.0))

    def stress(self, x: Array, y: Array, z: Array) -> Array:
        """Stress at points in m, (6, ...) in Pa, where x, y and z broadcast; z >= 0 on a free surface."""
        place = np.stack(np.broadcast_arrays(x, y, z - self.depth)) / self.radius
        distance = np.sqrt((place**2).sum(axis=0))
        normal = place / np.where(distance == 0, 1.0, distance)
        radial, deviator = self.radial(distance), self.deviator(distance)
        out = -deviator * _products(normal)
        out[:3] += radial + deviator
        return out + self._image(x, y, z) if self.free else out

    @property
    def _centre(self) -> float:
        """K of (a) in m^3."""
        nu, strength = self.body.poisson, self.profile.strength * self.strain * self.radius**3
        return (1 + nu) / (3 * (1 - nu)) * strength

    def _image(self, x: Array, y: Array, z: Array) -> Array:
        """Stress of (a) in Pa at points in m, (6, ...)."""
        nu, zeta = self.body.poisson, z + self.depth
        place = np.stack(np.broadcast_arrays(x, y, zeta))
        square = (place**2).sum(axis=0)
        distance = np.sqrt(square)
        products = _products(place)
        identity = np.array([1.0, 1, 1, 0, 0, 0]).reshape(6, *[1] * square.ndim)
        along_z = np.zeros_like(products)  # delta_iz X_j + delta_jz X_i
        along_z[2], along_z[3], along_z[4] = 2 * place[2], place[1], place[0]
        second = (3 * products / square - identity) / distance**3
        third = 3 * (along_z + place[2] * identity) / distance**5 - 15 * place[2] * products / distance**7
        mixed = np.zeros_like(second)  # delta_iz phi_zj + delta_jz phi_zi
        mixed[2], mixed[3], mixed[4] = 2 * second[2], second[3], second[4]
        strain = (3 - 4 * nu) * second + 2 * z * third - (2 - 4 * nu) * mixed
        return -2 * self.body.shear * self._centre * (strain - 4 * nu * second[2] * identity)

    def mean_stress(self, grid: CellGrid, window: Window, faces: Array) -> Array:
        """Means over the cells of a window and the layers between faces in m, (6, nz, nx, ny) in Pa."""
        (i, j), layers = window.slices, len(faces) - 1
        out = np.zeros((6, layers, window.nx, window.ny))
        x = grid.x[i, None] + grid.hx / 2 * POINTS
        y = grid.y[j, None] + grid.hy / 2 * POINTS
        z = (faces[1:] + faces[:-1])[:, None] / 2 + np.diff(faces)[:, None] / 2 * POINTS
        at_once = max(1, AT_ONCE // (x.size * y.size))
        for a, p in enumerate(WEIGHTS):
            for first in range(0, layers, at_once):
                some = slice(first, first + at_once)
                depths = z[some, a, None, None, None, None]
                points = self.stress(x[:, :, None, None], y, depths)
                out[:, some] += p / 8 * np.einsum("...iajb,a,b->...ij", points, WEIGHTS, WEIGHTS)
        return out

    def moved_surface(self, grid: CellGrid) -> Array:
        """u_z of the surface at the centres of the cells, (nx, ny) in m, > 0 into the body."""
        square = grid.x[:, None] ** 2 + grid.y**2 + self.depth**2
        held = -self._centre * self.depth / square**1.5
        return 4 * (1 - self.body.poisson) * held if self.free else held


def _products(vector: Array) -> Array:
    """n_i n_j of (3, ...), as (6, ...)."""
    a, b, c = vector
    return np.stack([a * a, b * b, c * c, b * c, a * c, a * b])


BYTES_AT_ONCE = 2e8  # of the spectra of a block of depths, which bounds the memory

PARTS = 8  # of a cell each way for its mean: the force errs by 1.5e-4 on 8 cells in a, 2e-6 on 16


@dataclass(frozen=True)
class GivenHertz:
    """p0 sqrt(1 - r^2/a^2) at the peak force, in proportion to the force. p0 in Pa, radius a in m."""

    p0: float
    radius: float

    @property
    def peak_force(self) -> float:
        """Force of the pressure in N, 2/3 pi p0 a^2."""
        return 2 / 3 * pi * self.p0 * self.radius**2

    def pressure(self, grid: CellGrid, load: Load, window: Window | None = None) -> Array:
        """The mean over each cell of a window or of the grid, about the place of the load, (nx, ny) in Pa."""
        in_x, in_y = (grid.whole if window is None else window).slices
        centres, cell, a = (grid.x[in_x], grid.y[in_y]), (grid.hx, grid.hy), self.radius
        out = np.zeros((centres[0].size, centres[1].size))
        part = (np.arange(PARTS) + 0.5) / PARTS - 0.5
        places = load.x, load.y
        i, j = (np.flatnonzero(np.abs(c - o) < a + h) for c, o, h in zip(centres, places, cell, strict=True))
        if load.force == 0 or not (i.size and j.size):
            return out
        fine_x, fine_y = (
            ((c[k, None] - o + h * part) / a).ravel()
            for c, k, o, h in zip(centres, (i, j), places, cell, strict=True)
        )
        p = np.sqrt(np.maximum(1.0 - fine_x[:, None] ** 2 - fine_y[None, :] ** 2, 0.0))
        p = p.reshape(i.size, PARTS, j.size, PARTS).mean(axis=(1, 3))
        out[np.ix_(i, j)] = self.p0 * (load.force / self.peak_force) * p
        return out

    def contact(self, grid: CellGrid, load: Load, pressure: Array, displacement: Array) -> Contact:
        """The state under the pressure, whose gap and approach are no numbers; fields (nx, ny) in Pa, m."""
        error = abs(float(pressure.sum()) * (grid.hx * grid.hy) - load.force) / load.force
        nothing = np.full_like(pressure, np.nan)
        area = pi * self.radius**2
        return Contact(
            pressure=pressure,
            displacement=displacement,
            gap=nothing,
            approach=np.nan,
            force=load.force,
            box=around(pressure > 0),
            gap_residual=0.0,
            penetration=0.0,
            tension=0.0,
            load_error=error,
            iterations=0,
            converged=True,
            area=area,
        )


CONTACT_SHARE = 1e-4  # of solver.tolerance, to which the contact is solved
REACHED = 1e-12  # residuals that rounding allows on grids of usual size (2e-13 on 513 x 513 cells)


def contact_tolerance(asked: float) -> float:
    """Tolerance of the contact: a share of what is asked, and no less than rounding allows."""
    return max(CONTACT_SHARE * asked, min(asked, REACHED))


Demand = GridDemand | MisfitDemand | RoughDemand
"""What the grid is chosen from."""


@dataclass(frozen=True)
class Places:
    """Where the largest stress and the contact may be: all of a patch, beside y = 0, off the origin."""

    anywhere: bool = False
    beside: bool = False
    off_origin: bool = False


@dataclass(frozen=True)
class Plan:
    """All that the solution of a scene needs; it is made once, and handed on. grid: cells and depths, in m;
    pair: elastic constants of both bodies; shape: of the counter-body, which makes the gap; axes: contact
    semi-axes (along x, along y) in m by Hertz, without coating; schedule: the load steps; slip: friction;
    places: where the largest stress and the contact may be; solver: tolerance and method; remedies: what may
    be changed of the scene, in words; given_sides: of the grid, which are not enlarged; demand: what a grid
    is chosen from; given, misfit: a pressure, or a misfit strain, in place of the counter-body; track: of a
    counter-body that moves; coated: both bodies with a coating; rough: heights of the bodies; plasticity:
    yield curve and profile over depth; tribofilm, wear: the laws; judging: how repeated loading is judged;
    dissipates: whether the energy that each cycle dissipates is asked for; coarser: the plan on half as many
    cells, from which quantities are extrapolated; period: both bodies where all repeats; stages: those that
    run, in the order in which they begin, with their sizes, then those that do not, and why. None of what a
    scene has not.
    """

    grid: CellGrid
    pair: ElasticPair
    shape: Shape
    axes: tuple[float, float]
    schedule: Schedule
    slip: FullSlip
    places: Places
    solver: Solver
    remedies: Remedies
    given_sides: Sides
    demand: Demand
    given: GivenHertz | None = None
    misfit: MisfitSphere | None = None
    track: Track | None = None
    coated: CoatedPair | None = None
    rough: RoughPatch | None = None
    plasticity: Plasticity | None = None
    tribofilm: FilmOnCells | None = None
    wear: WearLaw | None = None
    judging: Judging | None = None
    dissipates: bool = False
    coarser: Plan | None = None
    period: PeriodicHalfSpaces | None = None
    stages: tuple[Stage, ...] = ()

    @property
    def left_out(self) -> list[LeftOut]:
        """The stages that the scene does not need, with reasons."""
        return left_out_of(self.stages)

    @property
    def bodies(self) -> HalfSpaces:
        """Both bodies, as the contact asks for them."""
        if self.coated is not None:
            return self.coated.bodies(self.grid)
        if self.grid.line:
            return LINE
        return HALF_SPACES if self.period is None else self.period

    @property
    def paper(self) -> bool:
        """Whether load steps are made by the loops of the paper, in place of backward Euler."""
        return self.solver.method == "paper"

    @property
    def steps(self) -> int:
        """Load steps of a cycle, those along a path included; none without load."""
        return 0 if self.schedule.peak.rests else self.schedule.rises

    @property
    def unload_steps(self) -> int:
        """Steps in which a body is unloaded that yields in it; none without load."""
        return 0 if self.schedule.peak.rests else self.schedule.unload_steps

    @property
    def held_depths(self) -> tuple[int, int]:
        """Output depths in memory together, with coefficients, with stresses: of a rough body in blocks."""
        depths = len(self.grid.depths)
        together = min(depths, depths_at_once(self.grid)) if self.places.anywhere else depths
        return min(depths, DEPTHS_AT_ONCE, together), together

    @property
    def initial_yield(self) -> Array:
        """Yield stress of unstrained material at the depths of the grid, (nz,) in Pa; infinite if elastic."""
        if self.plasticity is None:
            return np.full(len(self.grid.depths), np.inf)
        return self.plasticity.strength().stress(self.grid.depths, np.zeros(1))

    def on(self, room: Room) -> Plan:
        """The same plan on a grid with another room, of cells of the same size."""
        if room == self.grid.room:
            return self
        grid, film, wear = self.demand.grid(room), self.tribofilm, self.wear
        film, wear = film and replace(film, shape=grid.shape), wear and replace(wear, shape=grid.shape)
        return replace(self, grid=grid, tribofilm=film, wear=wear)

    def problem(self, counters: Counters) -> ElasticProblem:
        """The elastic bodies on the grid; counters: where the work is counted."""
        return ElasticProblem(self, counters)


def depths_at_once(grid: CellGrid) -> int:
    """How many depths a block has: six spectra each, of complex numbers on a grid twice as long each way."""
    return int(max(1, BYTES_AT_ONCE // (6 * 16 * 2 * grid.nx * (grid.ny + 1))))


@dataclass(frozen=True)
class ElasticProblem:
    """The elastic bodies of a plan on its grid; counters: where the work is counted."""

    plan: Plan
    counters: Counters

    @cached_property
    def gap(self) -> InitialGap:
        """The gap before the first load."""
        plan = self.plan
        if plan.rough is None:
            return InitialGap(plan.shape, plan.grid)
        start = None if plan.track is None else plan.track.start
        return InitialGap(plan.shape, plan.grid, plan.rough.of_body, plan.rough.opposite, start)

    def bare(self) -> ElasticProblem:
        """The same with the material of the body up to its surface."""
        plan = self.plan
        coupling = plan.pair.tangential_mismatch if plan.slip.coupled else 0.0
        return replace(self, plan=replace(plan, coated=None, slip=replace(plan.slip, coupling=coupling)))

    def contact(
        self, load: Load, coefficient: Coefficient | None = None, start: Array | None = None
    ) -> Contact:
        """Contact under a load or a given pressure; start: pressure of the step before, in Pa."""
        plan, grid, gap = self.plan, self.plan.grid, self.gap(load)
        slip, modulus = plan.slip, plan.pair.contact_modulus
        if load.force == 0:
            return self.untouched(load, gap)
        mu = slip.coefficient if coefficient is None else coefficient
        coupling = load.sign * (slip.coupling * mu)
        bodies = plan.bodies
        if plan.given is not None:
            operators = SurfaceOperators(
                grid.shape, grid.hy / grid.hx, self.counters, coupling=coupling, bodies=bodies
            )
            pressure = plan.given.pressure(grid, load)
            u = operators.displacement(pressure * (2 / modulus), operators.whole, operators.whole) * grid.hx
            return plan.given.contact(grid, load, pressure, u)
        search = Search(contact_tolerance(plan.solver.tolerance), start, counters=self.counters)
        return solve_contact(
            gap, (grid.hx, grid.hy), modulus, load.given, coupling=coupling, bodies=bodies, search=search
        )

    def untouched(self, load: Load, gap: Array) -> Contact:
        """The state without force, over a gap (nx, ny) in m; a misfit strain moves the surface."""
        contact = no_contact(gap, load.given)
        if self.plan.misfit is None or not load.misfit:
            return contact
        return replace(contact, displacement=load.misfit * self.plan.misfit.moved_surface(self.plan.grid))

    def state(self, load: Load, contact: Contact, coefficient: Coefficient | None = None) -> Loaded:
        """The state of a solved contact."""
        load = load.found(contact.force)
        return Loaded(self, load, contact, self.plan.slip.coefficient if coefficient is None else coefficient)


@dataclass(frozen=True)
class Loaded:
    """The elastic bodies under a load. coefficient: of friction, with which the contact was solved."""

    problem: ElasticProblem
    load: Load
    contact: Contact
    coefficient: Coefficient

    @property
    def traction(self) -> Array | None:
        """q_x on the body, (nx, ny) in Pa; None without friction."""
        if not self.problem.plan.slip.slides:
            return None
        return self.load.sign * self.coefficient * self.contact.pressure


def stress_at(state: Loaded, depths: Array, window: Window) -> Array:
    """Stress in a window of cells at some depths, (6, nz, nx, ny) in Pa."""
    problem, tractions = state.problem, {3: state.contact.pressure}
    if (traction := state.traction) is not None:
        tractions[1] = traction
    plan = problem.plan
    cell, nu = (plan.grid.hx, plan.grid.hy), plan.pair.body.poisson
    if plan.period is not None:
        return plan.period.stresses(tractions, cell, depths, window, nu=nu, counters=problem.counters)
    stress = stresses(
        tractions,
        (*cell, plan.grid.period),
        depths,
        window,
        nu=nu,
        layered=None if plan.coated is None else plan.coated.layered,
        counters=problem.counters,
    )
    if plan.misfit is None or not state.load.misfit:
        return stress
    (i, j), grid = window.slices, plan.grid
    at = grid.x[i, None], grid.y[j], np.asarray(depths)[:, None, None]
    return stress + state.load.misfit * plan.misfit.stress(*at)


def plane_stress(state: Loaded) -> Array:
    """Stress in the rows of cells that touch y = 0, (6, nz, nx, rows) in Pa."""
    grid = state.problem.plan.grid
    return stress_at(state, grid.depths, grid.axis_rows)


@dataclass(frozen=True)
class Stresses:
    """In Pa: in the rows at y = 0, (6, nz, nx, rows); von Mises, (nz, n); in another row, (6, nz, nx)."""

    plane: Array
    mises: Array
    in_row: Array | None = None


def stresses_of(state: Loaded, row: int | None = None) -> Stresses:
    """Stresses of a state, with the largest von Mises stress in the plane through the contact; on
    the whole grid, which takes eight to twenty times as long, under a rough body.
    """
    problem = state.problem
    if problem.plan.places.anywhere:
        return _stresses_anywhere(state, row)
    plane, rows = plane_stress(state), problem.plan.grid.axis_rows
    if row is None:
        return Stresses(plane, _in_cells(plane))
    if rows.j0 <= row < rows.j0 + rows.ny:
        in_row = plane[..., row - rows.j0]
    else:
        in_row = stress_at(state, problem.plan.grid.depths, Window(0, row, problem.plan.grid.nx, 1))[..., 0]
    return Stresses(plane, _in_cells(in_row[..., None] if problem.plan.places.beside else plane), in_row)


def _in_cells(rows: Array) -> Array:
    """Von Mises stress of rows of cells, (nz, nx rows) in Pa, of their stress, (6, nz, nx, rows)."""
    return von_mises(rows).reshape(rows.shape[1], -1)


def _stresses_anywhere(state: Loaded, row: int | None) -> Stresses:
    """The largest von Mises stress of the cells that count, in blocks of depths, which bounds the memory."""
    grid = state.problem.plan.grid
    window = counted(state.contact, grid)
    block, rows = depths_at_once(grid), grid.axis_rows.slices[1]
    largest, plane, cut = [], [], []
    for k in range(0, len(grid.depths), block):
        stress = stress_at(state, grid.depths[k : k + block], grid.whole)
        largest.append(von_mises(stress[(..., *window.slices)]).max(axis=(-2, -1)))
        plane.append(stress[..., rows].copy())
        if row is not None:
            cut.append(stress[..., row].copy())
    in_row = np.concatenate(cut, axis=1) if cut else None
    return Stresses(np.concatenate(plane, axis=1), np.concatenate(largest)[:, None], in_row)


def sliding_of(state: Loaded) -> Sliding | None:
    """What friction adds to an elastic state; None without friction, then nothing is computed."""
    problem, pressure, traction = state.problem, state.contact.pressure, state.traction
    if traction is None:
        return None
    grid, counters, coated = problem.plan.grid, problem.counters, problem.plan.coated
    zero = np.zeros(grid.axis_rows.shape)
    if not traction.any():
        return Sliding(traction, zero, zero, zero, zero)
    if coated is not None:  # u_z: the contact's less that of the counter-body, see `CoatedPair`

        def layered(nx: int, ny: int, *, component: int, load: int) -> Array:
            lags = Lags(nx, ny, grid.hx, grid.hy)
            return coated.layered.displacement(lags, component=component, load=load)

        ux = moved_rows(grid, pressure, layered, (1, 3), counters=counters)
        ux = ux + moved_rows(grid, traction, layered, (1, 1), counters=counters)
        return Sliding(traction, ux, zero, zero, zero)
    pair = problem.plan.pair
    bodies = problem.plan.bodies
    kernel = bodies.kernel(grid, pair.body.poisson)
    ux = grid.hx * moved_rows(grid, pressure, kernel, (1, 3), counters=counters) / pair.body.shear
    ux = ux + grid.hx * moved_rows(grid, traction, kernel, (1, 1), counters=counters) / pair.body.shear
    # nu = 0 leaves out the factor 1 - 2 nu of D_31, which is a difference where the contact has it
    extra = 0.0
    if problem.plan.slip.coupled and pair.other is not None:
        share = pair.body.compliance  # times E*: of the body in the displacement of both
        extra = pair.body.tangential_compliance - 2 * share * pair.tangential_mismatch
    uz = zero
    if extra:
        kernel = bodies.kernel(grid, 0.0)
        uz = extra * (grid.hx * moved_rows(grid, traction, kernel, (3, 1), counters=counters))
    return Sliding(traction, ux, zero, uz, zero)


@dataclass(frozen=True)
class ElasticPeak:
    """The contact at the largest load of an elastic body, and von Mises stress (nz, n) in Pa: in y
    = 0, of a rough one the largest; of a tribofilm with its high coefficient.
    """

    contact: Contact
    mises: Array


def elastic_peak(problem: ElasticProblem, load: Load) -> ElasticPeak | None:
    """The elastic state under the largest load; None without any."""
    if load.rests:
        return None
    high = problem.plan.slip.highest
    state = problem.state(load, problem.contact(load, high), high)
    if problem.plan.places.anywhere:
        return ElasticPeak(state.contact, stresses_of(state).mises)
    return ElasticPeak(state.contact, von_mises(plane_stress(state)).max(axis=-1))


def yields(peak: ElasticPeak | None, limit: Array) -> bool:
    """Whether the elastic stress at the peak exceeds the yield stress (nz,) in Pa anywhere. Paper Eq. 8."""
    return peak is not None and bool(yielding(peak.mises, limit[:, None]).any())


UNFIT = "bare body, for comparison: {}: its largest pressure and stress and their changes are not given"
UNLOADING = "elastic: unloading in one step"
CYCLE = "elastic: equal to cycle 1"


def solve_elastic(problem: ElasticProblem, report: Progress) -> History:
    """The load history of an elastic body: one cycle stands for all but on a renewed surface."""
    plan, grid = problem.plan, problem.plan.grid
    rows: list[Row] = []
    snapshots: dict[str, Snapshot] = {}
    schedule, tribofilm, track = plan.schedule, plan.tribofilm, plan.track
    steps, previous, before = sum(target.rises for target in schedule.different), None, UNLOADED
    film = None
    for k, target in enumerate(schedule.different, start=1):
        if tribofilm is not None and target.step == 1 and (track is None or film is None):
            film = tribofilm.fresh(np.zeros((4, grid.nx, grid.ny)))
        if track is not None and previous is not None:
            previous = track.carried(grid, previous, before, target.load)
        if tribofilm is not None and film is not None and track is not None:
            film = tribofilm.entered(film, track.clock(target.cycle, target.load))
        if tribofilm is None or film is None:
            state = problem.state(target.load, problem.contact(target.load, start=previous))
        else:
            state, film = step_with_tribofilm(problem, tribofilm, film, target.load, start=previous)
        contact, note = state.contact, target.note if target.rises else UNLOADING
        attempts = (Attempt(True, contact.residuals, contact_tolerance(plan.solver.tolerance)),)
        once = replace(target, cycle=1) if schedule.all_alike else target
        row = row_of(grid, once, contact, coefficient=state.coefficient, whole=plan.slip.whole)
        row = replace(row, iterations=contact.iterations, residual=contact.residual, note=note)
        moved = None
        if track is not None:
            mu = target.load.sign * state.coefficient
            moved = track.moved(grid, target.load, contact.pressure, window=grid.whole, traction=mu)
        row = replace(row, attempts=attempts, moved=moved)
        rows.append(row)
        previous, before = contact.pressure, target.load
        if target.rises:
            report("contact", k, steps)
        if target.snapshot:
            place = target.load.x, target.load.y
            snapshots[target.snapshot] = replace(
                snapshot_of(target.snapshot, state), stretch=target.load.stretch, place=place
            )
            report("stress", 1, 1)
    first = list(rows)
    for cycle in range(2, schedule.cycles + 1 if schedule.all_alike else 2):
        rows += [replace(row, cycle=cycle, iterations=0, note=CYCLE, attempts=()) for row in first]
    return History(tuple(rows), snapshots)


def step_with_tribofilm(
    problem: ElasticProblem,
    tribofilm: FilmOnCells,
    film: TribofilmState,
    load: Load,
    *,
    start: Array | None = None,
) -> tuple[Loaded, TribofilmState]:
    """State and tribofilm after a step, repeated until the film is the one whose friction it had."""
    tried, grid, body = film, problem.plan.grid, problem.plan.pair.body
    while True:
        mu = tribofilm.coefficient(tried)
        state = problem.state(load, problem.contact(load, mu, start), mu)
        stress = stress_at(state, np.zeros(1), grid.whole)[:, 0]
        strain = elastic_strain(stress, body.young, body.poisson)
        pressure = state.contact.pressure
        tested = tribofilm.tested(film, tried, strain, pressure=pressure, sign=load.sign)
        if tested.film.failed is tried.film.failed:
            return replace(state, coefficient=tribofilm.coefficient(tested)), tested
        start, tried = pressure, tested


def snapshot_of(name: str, state: Loaded) -> Snapshot:
    """The record of a state."""
    problem, plan, contact = state.problem, state.problem.plan, state.contact
    row = row_of_largest(contact, counted(contact, plan.grid)) if plan.places.off_origin else None
    stresses = stresses_of(state, row)
    cut = None
    if row is not None and stresses.in_row is not None:
        peeq = np.zeros(stresses.in_row.shape[1:])
        cut = Cut(float(plan.grid.y[row]), plan.grid.x, plan.grid.depths, stresses.in_row, peeq)
    coated = None
    if plan.coated is not None:  # with the bare body to compare with, under force
        comparison = bare_body(state) if state.load.force else None
        traction = state.traction if plan.slip.coupled else None
        moved = plan.coated.counter_uz(plan.grid, contact.pressure, traction, problem.counters)
        coated = Coated(plan.coated.thickness, moved, comparison)
    zero, unmoved = np.zeros_like(stresses.plane), np.zeros(contact.gap.shape)
    return Snapshot(
        name,
        contact,
        unmoved,
        stresses.plane,
        zero,
        zero[0],
        stresses.mises,
        sliding=sliding_of(state),
        coated=coated,
        cut=cut,
    )


def bare_body(state: Loaded) -> Comparison:
    """Contact of the bare body, from the coated pressure on, and its stress; a warning where it is unfit."""
    bare, load = state.problem.bare(), state.load.by_force()
    contact = bare.contact(load, start=state.contact.pressure)
    status = fit_of(contact, rough=bare.plan.places.anywhere)
    if status is not Status.CONVERGED:
        return Comparison(warning=UNFIT.format(advice(bare.plan.remedies, status)))
    mises = stresses_of(bare.state(load, contact)).mises
    return Comparison(largest_pressure(contact, bare.plan.grid), mises)
