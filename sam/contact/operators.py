# SPDX-License-Identifier: MIT
"""How far a loaded cell moves two surfaces, of homogeneous half-spaces or of a coated one, and the operators
between windows of a grid of cells.

Units as in `sam.contact.normal`: lengths in cells hx, pressures as p_hat = 2 p/E*. A homogeneous pair then
holds no material constant; a coated one depends on the thickness in cells, so it knows its cell, and a
coarser grid has another one.

Two half-spaces under tractions that repeat with the grid: what is asked of them in place of single ones.

A mean traction moves a half-space without bound. Displacements are therefore those about their mean, and the
approach is that of the mean planes of the deformed surfaces: at most the mean of the gap, where all of the
patch touches. The mean stress is laterally uniform: under a mean pressure p it is -p in 33 and, where the
body cannot spread, -nu/(1 - nu) p in 11 and 22.

Elastic stresses under surface tractions in a window of the grid, paper Eq. 7, first sum; and the total
strains at the surface of a body, which a tribofilm that is bonded to it shares.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from copy import copy
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike
from scipy import fft

from sam.arrays import Array, Mask
from sam.contact.convolution import (
    FEW_CELLS,
    BoxConvolution,
    Convolution,
    Counters,
    DirectConvolution,
    MirroredConvolution,
    PeriodicConvolution,
    Real,
    convolution_onto,
    half_length,
)
from sam.grid.cells import CellGrid, Window
from sam.half_space import ElasticConstants, ElasticPair
from sam.kernels.patches import STRESS, Cuboids, Lags, displacement_coefficients, parity, stress_coefficients
from sam.kernels.waves import in_cells, load_waves, strain_displacement_waves, whole_waves
from sam.layered.patches import LayeredPatches, Layers

WAVES = 64  # wave numbers of a bound: 1024 give one larger by less than 0.02 %, 8 one smaller by 0.8 %


Kernel = Callable[..., Array]
"""nx, ny lags >= 0, component, load (1 to 3) -> displacement by a unit load on the cell at the origin."""


class HalfSpaces:
    """Two homogeneous half-spaces; the coupling of a traction is then 2 beta mu."""

    # Counted in displacements to 1e-8 for a sphere on 129 x 129 and a random surface on 64 x 64 cells.
    most_iterations = 1000  # limit of a contact; 27 and 26 are needed
    stagnation_limit = 100  # iterations without a new smallest residual after which it gives up: rounding
    real: type[np.floating[Any]] = np.float32  # of directions: as many displacements, half the time
    restart_threshold = (
        0.4  # share of the first residual at which p is projected: 44 and 38; at 0.1 48 and 45
    )
    periodic = False  # whether all repeats with the grid

    def coefficients(
        self, wanted: Lags, cells: tuple[int, int], nu: float, *, component: int, load: int
    ) -> Array:
        """mu times the displacement of the surface of one of them, lengths in hx; cells: of the grid."""
        return displacement_coefficients(wanted, nu, component=component, load=load)  # paper Eq. 5

    def normal(self, nx: int, ny: int, aspect: float) -> Array:
        """u_hat_z by p_hat = 1 on the cell at the origin, (nx, ny) lags >= 0. Paper: D_33 of Eq. 5."""
        return self.coefficients(Lags(nx, ny, 1.0, aspect), (nx, ny), 0.0, component=3, load=3)

    def tangential(self, nx: int, ny: int, aspect: float) -> Array:
        """u_hat_z by a traction p_hat = 1 along x with coupling 1. Paper: D_31 of Eq. 5."""
        return self.coefficients(Lags(nx, ny, 1.0, aspect), (nx, ny), 0.0, component=3, load=1)

    def stiffness(self, wave_number: Array) -> Array:
        """p_hat of a unit harmonic of u_hat with a wave number per cell > 0: |k| (Westergaard)."""
        return wave_number

    def tangential_share(self, cells: int) -> float:
        """Largest ratio of what a traction moves a harmonic to what p moves it; cells: across the grid."""
        return 0.5

    def coarser(self) -> HalfSpaces:
        """The same bodies for cells twice as large."""
        return self

    def own(self, coefficients: Array, aspect: float) -> float:
        """u_hat_z of p_hat = 1 in its own cell, of `normal` coefficients: a unit of residuals."""
        return float(coefficients[0, 0])

    def kernel(self, grid: CellGrid, nu: float) -> Kernel:
        """The `coefficients` on a grid."""

        def kernel(nx: int, ny: int, *, component: int, load: int) -> Array:
            lags = Lags(nx, ny, 1.0, grid.hy / grid.hx)
            return self.coefficients(lags, grid.shape, nu, component=component, load=load)

        return kernel


HALF_SPACES = HalfSpaces()


class RepeatedAlongY(HalfSpaces):
    """The same below pressures that repeat along y after the grid, the bodies of a line contact."""

    def coefficients(
        self, wanted: Lags, cells: tuple[int, int], nu: float, *, component: int, load: int
    ) -> Array:
        """The same, along the load zero at |x| = ny aspect/2 below a line force at x = 0."""
        repeated = replace(wanted, period=cells[1])
        return displacement_coefficients(repeated, nu, component=component, load=load)  # paper Eq. 5

    def own(self, coefficients: Array, aspect: float) -> float:
        """Of one cell that does not repeat, which depends on no reference."""
        return HALF_SPACES.own(HALF_SPACES.normal(1, 1, aspect), aspect)


LINE = RepeatedAlongY()


class CoatedBodies(HalfSpaces):
    """A coated body 1 and a homogeneous body 2; a traction's coupling is its coefficient. Plates
    bend with a compliance like k^-4, so that the iteration may rest long. hx: side of a cell in m.
    """

    most_iterations = 5000  # limit: a plate rests long before it moves on
    stagnation_limit = 2000  # the same
    real = np.float64  # short waves are lost in the rounding of long ones
    restart_threshold = (
        np.inf
    )  # p is projected in each iteration: 46 displacements on 65 x 65 cells, 53 at 0.4

    def __init__(self, pair: CoatedPair, hx: float):
        self.pair, self.hx = pair, hx
        self.layered, self.modulus = pair.layered, pair.pair.contact_modulus
        self.compliance, self.tangential_compliance = pair.compliance, pair.tangential_compliance
        self._known: dict[tuple[Lags, int], Array] = {}
        self._coarser: CoatedBodies | None = None

    def _coefficients(self, cells: Lags, load: int, counterpart: float) -> Array:
        """u_hat_z by load 3 or 1: of body 1, and `counterpart` (in 1/p_hat) times that of a half-space."""
        key = cells, load
        if key not in self._known:
            in_m = Lags(cells.nx, cells.ny, self.hx, cells.hy * self.hx)
            coated = self.layered.displacement(in_m, component=3, load=load)
            total = self.modulus / (2 * self.hx) * coated
            if counterpart:
                total = total + counterpart * displacement_coefficients(cells, 0.0, component=3, load=load)
            self._known[key] = total
        return self._known[key]

    def normal(self, nx: int, ny: int, aspect: float) -> Array:
        """u_hat_z by p_hat = 1 on the cell at the origin, (nx, ny) lags >= 0."""
        return self._coefficients(Lags(nx, ny, 1.0, aspect), 3, self.modulus * self.compliance)

    def tangential(self, nx: int, ny: int, aspect: float) -> Array:
        """u_hat_z by a traction p_hat = 1 along x with coupling 1."""
        counterpart = -self.modulus * self.tangential_compliance / 2
        return self._coefficients(Lags(nx, ny, 1.0, aspect), 1, counterpart)

    def stiffness(self, wave_number: Array) -> Array:
        """p_hat of a unit harmonic of u_hat with a wave number per cell > 0."""
        shape, k = wave_number.shape, wave_number.ravel() / self.hx
        coated = self.modulus / (2 * self.hx) * self.layered.response(k)
        return 1 / (coated.reshape(shape) + self.modulus * self.compliance / wave_number)

    def tangential_share(self, cells: int) -> float:
        """The largest ratio over WAVES wave numbers between those of the grid and of a cell."""
        k = np.geomspace(2 * np.pi / cells, np.pi, WAVES) / self.hx
        c_zz, c_zl, *_ = self.layered.surface_response(k)
        return float(np.max(np.abs(c_zl + self.tangential_compliance / 2) / (c_zz + 2 * self.compliance)))

    def coarser(self) -> CoatedBodies:
        """The same bodies for cells twice as large; made once."""
        if self._coarser is None:
            self._coarser = CoatedBodies(self.pair, 2 * self.hx)
        return self._coarser


Operator = Callable[[Array], Array]
"""A field on one window -> a field on another, or on the same."""


class SurfaceOperators:
    """Makes the operators between windows of (nx, ny) cells, which share coefficients; coupling: of
    the traction, a number or (nx, ny); self_influence: displacement of p_hat = 1 in its own cell.
    """

    def __init__(
        self,
        shape: tuple[int, int],
        aspect: float,
        counters: Counters,
        *,
        coupling: float | Array = 0.0,
        bodies: HalfSpaces = HALF_SPACES,
    ):
        self.shape, self.aspect, self.counters, self.bodies = shape, aspect, counters, bodies
        self.coupling = np.broadcast_to(coupling, shape) if np.any(coupling) else None
        self.whole = Window(0, 0, *shape)
        self.coefficients = bodies.normal(*shape, aspect)
        self.self_influence = bodies.own(self.coefficients, aspect)

    def with_coupling(self, coupling: float | Array) -> SurfaceOperators:
        """The operators of the same cells with another coefficient of friction, which share the rest."""
        other = copy(self)
        other.coupling = np.broadcast_to(coupling, self.shape) if np.any(coupling) else None
        return other

    def box_operator(self, box: Window, mirrored: bool) -> BoxConvolution:
        """p_hat -> u_hat on a box; mirrored: of fields that are, on the kept quarter."""
        if self.bodies.periodic and box == self.whole and not (mirrored and self.odd):
            spectrum = fft.rfft2(self.coefficients).real
            spectrum = spectrum[: self.shape[0] // 2 + 1] if mirrored else spectrum
            return PeriodicConvolution(spectrum, self.shape, mirrored, self.counters)
        few = DirectConvolution if box.nx * box.ny <= FEW_CELLS else BoxConvolution
        return (MirroredConvolution if mirrored else few)(self.coefficients, box.shape, self.counters)

    @property
    def odd(self) -> bool:
        """Whether the number of cells along x or y is odd."""
        return any(n % 2 for n in self.shape)

    def operator(self, source: Window, observed: Window) -> Operator:
        """p_hat on `source` -> u_hat on `observed`: paper Eq. 5 with D_33."""
        lx, ly = Convolution.lags_needed(source, observed)
        coefficients = self.coefficients[None, :lx, :ly]
        convolution = Convolution(coefficients, [(1, 1)], source, observed, counters=self.counters)

        def apply(p_hat: Array) -> Array:
            self.counters.displacement_applications += 1
            return convolution(p_hat)[0]  # paper Eq. 5, D_33

        return apply

    def tangential(self, source: Window, observed: Window) -> Operator | None:
        """p_hat on `source` -> u_hat on `observed` of its traction, paper Eq. 5 with D_31; None without."""
        if self.coupling is None:
            return None
        lx, ly = Convolution.lags_needed(source, observed)
        coefficients = self._tangential_coefficients[None, :lx, :ly]
        convolution = Convolution(coefficients, [parity("3", 1)], source, observed, counters=self.counters)
        coupling = self.coupling[source.slices]

        def apply(p_hat: Array) -> Array:
            self.counters.displacement_applications += 1
            return convolution(coupling * p_hat)[0]  # paper Eq. 5, D_31

        return apply

    @cached_property
    def _tangential_coefficients(self) -> Array:
        self.counters.tangential_kernels += 1
        return self.bodies.tangential(*self.shape, self.aspect)

    @property
    def relaxation(self) -> float:
        """The relaxation factor of the passes of a contact with traction, 1/(1 + b^2)."""
        if self.coupling is None:
            return 1.0
        return 1 / (1 + (self.bodies.tangential_share(max(self.shape)) * np.abs(self.coupling).max()) ** 2)

    def displacement(self, p_hat: Array, source: Window, observed: Window, sign: float = 1.0) -> Array:
        """u_hat on `observed` of p_hat on `source` and of its traction, which acts along sign times x."""
        u, tangential = self.operator(source, observed)(p_hat), self.tangential(source, observed)
        return u if tangential is None else u + sign * tangential(p_hat)

    def preconditioner(self, box: Window, mirrored: bool) -> Callable[[Real], Real]:
        """r -> F^-1 s(|k|) F r, near the inverse operator, for r in the precision of `HalfSpaces.real`."""
        if mirrored:
            half = tuple(half_length(n - n // 2) for n in box.shape)
            kx, ky = np.pi * np.arange(half[0] + 1) / half[0], np.pi * np.arange(half[1] + 1) / half[1]
        else:
            kx, ky = 2 * np.pi * fft.fftfreq(box.nx), 2 * np.pi * fft.rfftfreq(box.ny)
        k = np.hypot(kx[:, None], ky[None, :] / self.aspect)
        k[0, 0] = np.pi / max(box.nx, box.ny * self.aspect)  # any positive value: residuals have zero mean
        symbol = self.bodies.stiffness(k)
        symbol = (symbol / symbol.max()).astype(self.bodies.real)
        if not mirrored and box.nx * box.ny <= FEW_CELLS:
            kernel = fft.irfft2(symbol, box.shape).astype(symbol.dtype)
            return DirectConvolution(kernel, box.shape, self.counters)
        return PeriodicConvolution(symbol, box.shape, mirrored, self.counters)


def moved_rows(
    grid: CellGrid, field: Array, kernel: Kernel, moved_by: tuple[int, int], *, counters: Counters
) -> Array:
    """Displacement of the rows that touch y = 0, (nx, rows); moved_by: its component and that of the load."""
    component, load = moved_by
    source, observed = grid.whole, grid.axis_rows
    coefficients = kernel(*Convolution.lags_needed(source, observed), component=component, load=load)
    counters.tangential_kernels += moved_by != (3, 3)
    signs = [parity(str(component), load)]
    return convolution_onto(coefficients[None], signs, source, observed, counters=counters)(field)[0]


@dataclass(frozen=True)
class CoatedPair:
    """The coated body, the body below its coating (thickness in m), and the counter-body."""

    layered: LayeredPatches
    pair: ElasticPair
    thickness: float
    _known: dict[float, CoatedBodies] = field(default_factory=dict, compare=False, repr=False)

    @classmethod
    def of(cls, coating: ElasticConstants, thickness: float, pair: ElasticPair) -> CoatedPair:
        """A coating of a thickness in m on the body of a pair."""
        layers = Layers(coating.young, coating.poisson, thickness, pair.body.young, pair.body.poisson)
        return cls(LayeredPatches(layers), pair, thickness)

    @property
    def compliance(self) -> float:
        """(1 - nu^2)/E of the counter-body in 1/Pa; 0 if it is rigid or absent."""
        return self.pair.other.compliance if self.pair.other is not None else 0.0

    @property
    def tangential_compliance(self) -> float:
        """(1 - 2 nu)/mu of the counter-body in 1/Pa; 0 if it is rigid or absent."""
        return self.pair.other.tangential_compliance if self.pair.other is not None else 0.0

    def response(self, k: Array) -> Array:
        """c_zz(k) of both bodies together in m/Pa, k > 0 in 1/m."""
        return self.layered.response(k) + 2 * self.compliance / k

    def bodies(self, grid: CellGrid) -> CoatedBodies:
        """Their coefficients on a grid; those of the last one are kept."""
        if grid.hx not in self._known:
            self._known.clear()
            self._known[grid.hx] = CoatedBodies(self, grid.hx)
        return self._known[grid.hx]

    def counter_uz(
        self, grid: CellGrid, pressure: Array, traction: Array | None, counters: Counters
    ) -> Array:
        """Displacement of the counter-body away in the rows at y = 0, (nx, rows) in m."""
        if not (self.compliance and pressure.any()):
            return np.zeros(grid.axis_rows.shape)
        kernel = HALF_SPACES.kernel(grid, 0.0)
        out = 2 * self.compliance * grid.hx * moved_rows(grid, pressure, kernel, (3, 3), counters=counters)
        if traction is None:
            return out
        moved = moved_rows(grid, traction, kernel, (3, 1), counters=counters)
        return out - self.tangential_compliance * grid.hx * moved


@dataclass(frozen=True)
class PeriodicHalfSpaces(HalfSpaces):
    """Two homogeneous half-spaces under tractions that repeat; free: whether the mean of the lateral stress
    is zero at each depth, else the mean of the lateral strain is.
    """

    free: bool = False
    periodic = True

    def coefficients(
        self, wanted: Lags, cells: tuple[int, int], nu: float, *, component: int, load: int
    ) -> Array:
        """The same by the load on a cell and its images, about the mean."""
        period, name = replace(wanted, nx=cells[0], ny=cells[1]), (str(component),)
        waves = load_waves("displacement", name, period, nu, load=load)  # paper Eq. 5
        return in_cells(waves, cells, name, load)[0, : wanted.nx, : wanted.ny]

    def own(self, coefficients: Array, aspect: float) -> float:
        """That of a single cell, whatever the period."""
        return HALF_SPACES.own(HALF_SPACES.normal(1, 1, aspect), aspect)

    def moved(self, strain: Array, cells: Cuboids, component: int) -> Array:
        """Displacement of the surface by plastic strain, (6, layers, nx, ny), in m. Paper Eq. 6."""
        lags, faces = cells.lags, cells.depths / cells.lags.hx
        waves = strain_displacement_waves(lags.in_units_of(lags.hx), faces.tolist(), cells.nu, component)
        total = (whole_waves(waves, lags.nx, STRESS, component) * fft.rfft2(strain)).sum(axis=(0, 1))
        return np.asarray(lags.hx * fft.irfft2(total, s=lags.shape))

    def mean_stress(self, tractions: Mapping[int, float], nu: float) -> Array:
        """Stress (6,) of mean tractions on the body: load -> Pa."""
        p, out = tractions.get(3, 0.0), np.zeros(6)
        out[:3] = -p * np.array([0.0 if self.free else nu / (1 - nu)] * 2 + [1.0])
        out[3:5] = -tractions.get(2, 0.0), -tractions.get(1, 0.0)
        return out

    def mean_residual(self, strain: Array, nu: float) -> Array:
        """Stress/mu of a plastic strain uniform in layers, (6 layers, r), see `sam.plasticity.spectra`."""
        e, out = strain.reshape(6, -1, strain.shape[-1]), np.zeros_like(strain)
        if not self.free:
            s = out.reshape(e.shape)
            s[0], s[1] = (-2 / (1 - nu) * (e[i] + nu * e[1 - i]) for i in (0, 1))  # and s_i3 = 0
            s[5] = -2 * e[5]
        return out

    def stresses(
        self,
        tractions: Mapping[int, Array],
        cell: tuple[float, float],
        depths: ArrayLike,
        observed: Window,
        *,
        nu: float,
        counters: Counters,
    ) -> Array:
        """See `sam.contact.operators.stresses`."""
        loads = {load: field for load, field in tractions.items() if field.any()}
        depths, (hx, hy) = np.asarray(depths, dtype=float), cell
        means = self.mean_stress({load: float(field.mean()) for load, field in loads.items()}, nu)
        out = np.empty((6, len(depths), *observed.shape))
        out[:] = means[:, None, None, None]
        counters.tangential_kernels += any(load != 3 for load in loads)
        transforms = [(load, field.shape, fft.rfft2(field)) for load, field in loads.items()]
        for at, z in enumerate(depths / hx) if loads else ():
            total: Any = 0.0
            for load, (nx, ny), transform in transforms:
                waves = load_waves("stress", STRESS, Lags(nx, ny, 1.0, hy / hx), nu, load=load, depths=[z])
                total = total + whole_waves(waves, nx, STRESS, load) * transform
            counters.ffts += 6
            out[:, at] += fft.irfft2(total, s=(nx, ny))[(..., *observed.slices)]  # paper Eq. 7, first sum
        return out


DEPTHS_AT_ONCE = 16  # bounds the memory of the spectra
MIRRORED = 1e-9  # of the largest traction: within the tolerance of a contact


def stresses(
    tractions: Mapping[int, Array],
    cell: tuple[float, float] | tuple[float, float, int],
    depths: ArrayLike,
    observed: Window,
    *,
    nu: float,
    layered: LayeredPatches | None = None,
    counters: Counters | None = None,
) -> Array:
    """Stress in Pa under tractions on the surface, at the centres of the observed cells, (6, nz, nx, ny);
    components 11 22 33 23 13 12, tension positive. Paper Eq. 7, first sum.

    tractions: direction of the load (1, 2, 3: q_x, q_y, p, on the body, p > 0 compressive) -> (nx, ny) in Pa
    on the whole grid; one that is left out costs nothing. cell: (hx, hy), sides in m; third the cells along y
    after which the tractions repeat, if they do. depths: (nz,) in m. layered: coefficients of a coated body,
    in place of nu. counters: where the work is counted.
    """
    (hx, hy, *period), depths = cell, np.asarray(depths, dtype=float)
    total = np.zeros((len(STRESS), len(depths), *observed.shape))
    for load, traction in tractions.items():
        source = _loaded(traction)
        if source is None:
            continue
        lags = Convolution.lags_needed(source, observed)
        if counters is not None and load != 3:
            counters.tangential_kernels += 1
        needed = _needed(traction, load, observed)
        names = tuple(STRESS[k] for k in needed)
        parities = [parity(name, load) for name in names]
        for k in range(0, len(depths), DEPTHS_AT_ONCE):
            some = depths[k : k + DEPTHS_AT_ONCE]
            if layered is None:
                in_cells = Lags(*lags, 1.0, hy / hx, *period)
                kernels = stress_coefficients(in_cells, some / hx, nu, load=load, names=names)
            else:
                kernels = layered.stress(Lags(*lags, hx, hy), some, load=load, names=names)
            each = [sign for sign in parities for _ in some]
            convolution = convolution_onto(kernels, each, source, observed, counters=counters)
            # paper Eq. 7, first sum
            total[needed, k : k + len(some)] += convolution(traction[source.slices])
    return total


def _loaded(field: Array) -> Window | None:
    """The smallest window that holds all that is not zero; None for a field of zeros."""
    loaded = np.flatnonzero(field.any(axis=1)), np.flatnonzero(field.any(axis=0))
    if not loaded[0].size:
        return None
    (i0, i1), (j0, j1) = ((hit[0], hit[-1] + 1) for hit in loaded)
    return Window(int(i0), int(j0), int(i1 - i0), int(j1 - j0))


def _needed(field: Array, load: int, observed: Window) -> list[int]:
    """The components that are not zero by symmetry: in the row of a mirrored field those even in y."""
    everything = list(range(len(STRESS)))
    if observed.ny > 1 or 2 * observed.j0 + 1 != field.shape[1]:
        return everything
    if np.abs(field - field[:, ::-1]).max() > MIRRORED * np.abs(field).max():
        return everything
    return [k for k in everything if parity(STRESS[k], load)[1] > 0]


def von_mises(stress: Array) -> Array:
    """Von Mises stress (...) of stresses (6, ...), to compare in paper Eq. 8."""
    s11, s22, s33, s23, s13, s12 = stress
    normal = (s11 - s22) ** 2 + (s22 - s33) ** 2 + (s33 - s11) ** 2
    return np.sqrt(normal / 2 + 3 * (s23**2 + s13**2 + s12**2))


def yielding(mises: Array, limit: Array) -> Mask:
    """Where material yields: its von Mises stress is above the yield stress, which broadcasts with it."""
    return np.asarray(mises > limit)  # paper Eq. 8 does not hold


def elastic_strain(stress: Array, young: float, poisson: float) -> Array:
    """Elastic strains xx, yy, xy, zz of stresses (6, ...) in Pa, order 11 22 33 23 13 12."""
    sxx, syy, szz, sxy = stress[0], stress[1], stress[2], stress[5]
    parts = (
        sxx - poisson * (syy + szz),
        syy - poisson * (sxx + szz),
        (1 + poisson) * sxy,
        szz - poisson * (sxx + syy),
    )
    return np.stack(parts) / young


def surface_strain(stress: Array, plastic: Array, depths: Array, *, young: float, poisson: float) -> Array:
    """Total strains xx, yy, xy, zz of the surface, (4, nx, ny), from stress in Pa and plastic
    strain, (6, n_layers, nx, ny): linear to z = 0 from two layers, the mean of one.
    """
    total = elastic_strain(stress[:, :2], young, poisson) + plastic[[0, 1, 5, 2], :2]
    if total.shape[1] < 2:
        return total[:, 0]
    up: Array = (total[:, 0] - total[:, 1]) * depths[0] / (depths[1] - depths[0])
    return total[:, 0] + up
