# SPDX-License-Identifier: MIT
"""The surface coefficients of a grid of cells, and operators between windows of it, in the units of
`sam.contact.normal`.

How far a loaded cell moves two surfaces, in the units of the contact: two homogeneous half-spaces, or one
of them coated.

Units as in `sam.contact.normal`: lengths in cells hx, pressures as p_hat = 2 p/E*. A homogeneous pair then
holds no material constant; a coated one depends on the thickness in cells, so it knows its cell, and a
coarser grid has another one.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from copy import copy
from functools import cached_property
from typing import Any, Protocol

import numpy as np
from numpy.typing import ArrayLike
from scipy import fft

from sam.arrays import Array
from sam.contact.convolution import (
    BoxConvolution,
    Convolution,
    Counters,
    MirroredConvolution,
    cropped,
    filtered,
    half_length,
    transformed,
)
from sam.grid.cells import Window
from sam.kernels.patches import STRESS, Lags, displacement_coefficients, parity

WAVES = 64  # wave numbers of a bound: 1024 give one larger by less than 0.02 %, 8 one smaller by 0.8 %


class CoatedBody(Protocol):
    """The coefficients of a coated body that a contact needs;
    `sam.layered.patches.LayeredPatches` has them.
    """

    def displacement(self, lags: Lags, *, component: int = 3, load: int = 3) -> Array:
        """Surface displacement per unit traction on a cell, (nx, ny) in m/Pa; lags in m."""

    def stress(self, lags: Lags, z: ArrayLike, *, load: int = 3, names: Sequence[str] = STRESS) -> Array:
        """Stress at depths z in m per unit traction on a cell, (len(names), nz, nx, ny)."""

    def response(self, k: Array) -> Array:
        """u_z over p in m/Pa of waves with k > 0 in rad/m."""

    def surface_response(self, k: Array) -> Array:
        """k times (c_zz, c_zL, c_LL, c_TT) in 1/Pa of waves with k > 0 in rad/m, (4, ...)."""


class HalfSpaces:
    """Two homogeneous half-spaces; the coupling of a traction is then 2 beta mu (see
    `sam.grid.coupling_of`).
    """

    # Counted in displacements to 1e-8 for a sphere on 129 x 129 and a random surface on 64 x 64 cells.
    most_iterations = 1000  # limit of a contact; 35 and 31 are needed
    stagnation_limit = 100  # iterations without a new smallest residual after which it gives up: rounding
    single = True  # directions are transformed in single precision: as many displacements, half the time
    restart_threshold = (
        0.4  # share of the first residual at which p is projected: 58 and 50; at 0.1 61 and 61
    )

    def normal(self, nx: int, ny: int, aspect: float) -> Array:
        """u_hat_z by p_hat = 1 on the cell at the origin, (nx, ny) lags >= 0. Paper: D_33 of Eq. 5."""
        return displacement_coefficients(Lags(nx, ny, 1.0, aspect), nu=0.0)

    def tangential(self, nx: int, ny: int, aspect: float) -> Array:
        """u_hat_z by a traction p_hat = 1 along x with coupling 1. Paper: D_31 of Eq. 5."""
        return displacement_coefficients(Lags(nx, ny, 1.0, aspect), nu=0.0, component=3, load=1)

    def stiffness(self, wave_number: Array) -> Array:
        """p_hat of a unit harmonic of u_hat with a wave number per cell > 0: |k| (Westergaard)."""
        return wave_number

    def tangential_share(self, cells: int) -> float:
        """The largest ratio of what a traction with coupling 1 moves a harmonic to what p moves it.

        cells: across the grid, which bounds the wave numbers.
        """
        return 0.5

    def coarser(self) -> HalfSpaces:
        """The same bodies for cells twice as large."""
        return self


HALF_SPACES = HalfSpaces()


class CoatedBodies(HalfSpaces):
    """A coated body 1 and a homogeneous body 2; the coupling of a traction is then its coefficient mu.

    A stiff coating bends like a plate, whose compliance falls like k^-4: the iteration then rests long and
    moves on, and short waves are lost in the rounding of long ones.

    Parameters
    ----------
    layered
        Coefficients of body 1.
    hx
        Side of a cell in m.
    modulus
        E* in Pa, of the unit of p_hat.
    compliance, tangential
        (1 - nu2^2)/E2 and (1 - 2 nu2)/mu2 in 1/Pa of body 2, which carries the opposite traction; 0 if it is
        rigid.
    """

    most_iterations = 5000  # limit: a plate rests long before it moves on
    stagnation_limit = 2000  # the same
    single = False  # short waves are lost in the rounding of long ones
    restart_threshold = (
        np.inf
    )  # p is projected in each iteration: 46 displacements on 65 x 65 cells, 53 at 0.4

    def __init__(
        self,
        layered: CoatedBody,
        hx: float,
        modulus: float,
        *,
        compliance: float = 0.0,
        tangential: float = 0.0,
    ):
        self.layered, self.hx, self.modulus = layered, hx, modulus
        self.compliance, self.tangential_compliance = compliance, tangential
        self._known: dict[tuple[Lags, int], Array] = {}
        self._coarser: CoatedBodies | None = None

    def _coefficients(self, cells: Lags, load: int, counterpart: float) -> Array:
        """u_hat_z by load 3 or 1: of body 1, and `counterpart` (in 1/p_hat) times that of a half-space;
        cells: in hx.
        """
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
            self._coarser = CoatedBodies(
                self.layered,
                2 * self.hx,
                self.modulus,
                compliance=self.compliance,
                tangential=self.tangential_compliance,
            )
        return self._coarser


Operator = Callable[[Array], Array]
"""A field on one window -> a field on another, or on the same."""


class SurfaceOperators:
    """Makes the dimensionless operators between windows of a grid of cells, which share their coefficients.

    self_influence is the displacement that p_hat = 1 causes in its own cell.

    Parameters
    ----------
    shape
        (nx, ny) cells.
    aspect
        hy/hx.
    counters
        Where the work is counted.
    coupling
        Of the traction, see `sam.grid.coupling_of`: a number or (nx, ny); with 0 nothing is built for it.
    bodies
        What is in contact.
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
        self.self_influence = float(self.coefficients[0, 0])

    def with_coupling(self, coupling: float | Array) -> SurfaceOperators:
        """The operators of the same cells with another coefficient of friction; both
        share what is computed.
        """
        other = copy(self)
        other.coupling = np.broadcast_to(coupling, self.shape) if np.any(coupling) else None
        return other

    def operator(self, source: Window, observed: Window) -> Operator:
        """p_hat on `source` -> u_hat on `observed`: paper Eq. 5 with D_33."""
        lx, ly = Convolution.lags_needed(source, observed)
        coefficients = self.coefficients[None, :lx, :ly]
        convolution = Convolution(coefficients, [(1, 1)], source, observed, counters=self.counters)

        def apply(p_hat: Array) -> Array:
            self.counters.displacement_applications += 1
            found: Array = convolution(p_hat)[0]  # paper Eq. 5, D_33
            return found

        return apply

    def box_operator(self, box: Window, mirrored: bool) -> BoxConvolution | MirroredConvolution:
        """p_hat on a box -> u_hat there, also in single precision; mirrored: on a quarter of the box."""
        return (MirroredConvolution if mirrored else BoxConvolution)(
            self.coefficients, box.shape, self.counters
        )

    def tangential(self, source: Window, observed: Window) -> Operator | None:
        """p_hat on `source` -> u_hat on `observed` of its traction: paper Eq. 5 with D_31.

        None without coupling.
        """
        if self.coupling is None:
            return None
        lx, ly = Convolution.lags_needed(source, observed)
        coefficients = self._tangential_coefficients[None, :lx, :ly]
        convolution = Convolution(coefficients, [parity("3", 1)], source, observed, counters=self.counters)
        coupling = self.coupling[source.slices]

        def apply(p_hat: Array) -> Array:
            self.counters.displacement_applications += 1
            found: Array = convolution(coupling * p_hat)[0]  # paper Eq. 5, D_31
            return found

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
        found: float = 1 / (
            1 + (self.bodies.tangential_share(max(self.shape)) * np.abs(self.coupling).max()) ** 2
        )
        return found

    def displacement(self, p_hat: Array, source: Window, observed: Window, sign: float = 1.0) -> Array:
        """u_hat on `observed` of p_hat on `source` and of its traction, which acts along sign times x."""
        u, tangential = self.operator(source, observed)(p_hat), self.tangential(source, observed)
        return u if tangential is None else u + sign * tangential(p_hat)

    def preconditioner(self, box: Window, mirrored: bool) -> Operator:
        """r -> F^-1 s(|k|) F r on the box: the inverse of the operator on the whole plane, p_k = s(|k|) u_k,
        but for a factor.

        In single precision where the bodies allow: it has to be near, not exact. mirrored: on a quarter of
        the box.
        """
        real: type[np.floating[Any]] = np.float32 if self.bodies.single else np.float64
        if mirrored:
            half = tuple(map(half_length, box.shape))
            kx, ky = np.pi * np.arange(half[0] + 1) / half[0], np.pi * np.arange(half[1] + 1) / half[1]
        else:
            kx, ky = 2 * np.pi * fft.fftfreq(box.nx), 2 * np.pi * fft.rfftfreq(box.ny)
        k = np.hypot(kx[:, None], ky[None, :] / self.aspect)
        k[0, 0] = np.pi / max(box.nx, box.ny * self.aspect)  # any positive value: residuals have zero mean
        symbol = self.bodies.stiffness(k)
        symbol = (symbol / symbol.max()).astype(real)

        def apply(r: Array) -> Array:
            self.counters.ffts += 2
            scale = max(r.max(), -r.min()) or 1.0
            unit = (r / scale).astype(real)
            found: Array
            if mirrored:
                found = scale * filtered(unit, box.shape, symbol)  # type: ignore[assignment]
            else:
                spectrum = transformed(unit, box.shape)
                spectrum *= symbol
                found = scale * cropped(spectrum, box.shape, box.shape)
            return found

        return apply
