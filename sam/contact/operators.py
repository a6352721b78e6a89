# SPDX-License-Identifier: MIT
"""The surface coefficients of a grid of cells, and operators between windows of it, in the units of
`sam.contact.normal`.
"""

from __future__ import annotations

from collections.abc import Callable
from copy import copy
from functools import cached_property
from typing import Any

import numpy as np
from scipy import fft

from sam.arrays import Array
from sam.contact.bodies import HALF_SPACES, HalfSpaces
from sam.contact.convolution import BoxConvolution, Convolution, Counters, cropped, transformed
from sam.contact.real_transforms import half_length
from sam.contact.transforms import MirroredConvolution, filtered
from sam.grid.cells import Window
from sam.kernels.patches import parity

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
