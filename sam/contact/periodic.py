# SPDX-License-Identifier: MIT
"""Two half-spaces under tractions that repeat with the grid: what is asked of them in place of single ones.

A mean traction moves a half-space without bound. Displacements are therefore those about their mean, and the
approach is that of the mean planes of the deformed surfaces: at most the mean of the gap, where all of the
patch touches. The mean stress is laterally uniform: under a mean pressure p it is -p in 33 and, where the
body cannot spread, -nu/(1 - nu) p in 11 and 22.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import fft

from sam.arrays import Array
from sam.contact.convolution import BoxConvolution, Counters, PeriodicConvolution
from sam.contact.operators import HALF_SPACES, HalfSpaces, Kernel
from sam.grid.cells import CellGrid, Window
from sam.kernels.patches import STRESS, Cuboids, Lags
from sam.kernels.waves import (
    in_cells,
    load_displacement_waves,
    load_waves,
    strain_displacement_waves,
    whole_waves,
)


class Odd(NamedTuple):
    """Of coefficients by a load whether they are odd in x and in y."""

    x: NDArray[np.integer[Any]]
    y: NDArray[np.integer[Any]]

    @classmethod
    def of(cls, names: tuple[str, ...], other: str) -> Odd:
        """names: indices of what is found; other: of what makes it."""
        return cls(*(np.array([(name + other).count(axis) % 2 for name in names]) for axis in "12"))


def displacement_kernel(period: Lags, nu: float, *, component: int, load: int) -> Array:
    """mu times the displacement of the surface at the lags 0 .. n - 1, lengths in hx. Paper Eq. 5."""
    waves = load_displacement_waves(period, nu, component=component, load=load)
    return np.asarray(in_cells(waves[None], period.shape, *Odd.of((str(component),), str(load)))[0])


@dataclass(frozen=True)
class PeriodicHalfSpaces(HalfSpaces):
    """Two homogeneous half-spaces under tractions that repeat; free: whether the mean of the lateral stress
    is zero at each depth, else the mean of the lateral strain is.
    """

    free: bool = False
    largest_box = 1 / 3  # share of the grid up to which a box padded with zeros takes less time than that

    def normal(self, nx: int, ny: int, aspect: float) -> Array:
        """u_hat_z by p_hat = 1 on the cell at the origin and its images, about its mean."""
        return displacement_kernel(Lags(nx, ny, 1.0, aspect), 0.0, component=3, load=3)

    def own(self, coefficients: Array, aspect: float) -> float:
        """That of a single cell, whatever the period."""
        return HALF_SPACES.own(HALF_SPACES.normal(1, 1, aspect), aspect)

    def tangential(self, nx: int, ny: int, aspect: float) -> Array:
        """u_hat_z by a traction p_hat = 1 along x with coupling 1, and by its images."""
        return displacement_kernel(Lags(nx, ny, 1.0, aspect), 0.0, component=3, load=1)

    def halves(self, nx: int, ny: int) -> bool:
        """Whether every second cell repeats with the same period."""
        return nx % 2 == 0 and ny % 2 == 0

    def box_operator(
        self, coefficients: Array, shape: tuple[int, int], mirrored: bool, counters: Counters
    ) -> BoxConvolution:
        """p_hat -> u_hat on a box of cells; on all of them without padding."""
        if shape != coefficients.shape or (mirrored and not self.halves(*shape)):
            return super().box_operator(coefficients, shape, mirrored, counters)
        return PeriodicConvolution(coefficients, mirrored, counters)

    def kernel(self, grid: CellGrid, nu: float) -> Kernel:
        """The same of a cell and its images, about the mean."""

        def kernel(nx: int, ny: int, *, component: int, load: int) -> Array:
            period = Lags(*grid.shape, 1.0, grid.hy / grid.hx)
            return displacement_kernel(period, nu, component=component, load=load)[:nx, :ny]

        return kernel

    def strain_kernel(self, grid: CellGrid, cuboids: Cuboids, component: int) -> Array:
        """Displacement of the surface by unit strain in layers, (6, layers, nx, ny); cuboids: in hx."""
        period = Lags(*grid.shape, 1.0, grid.hy / grid.hx)
        waves = strain_displacement_waves(period, cuboids.faces, cuboids.nu, component)
        return np.asarray(in_cells(waves, grid.shape, *Odd.of(STRESS, str(component))))

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
        """See `sam.contact.stress.stresses`."""
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
                total = total + whole_waves(waves, nx, *Odd.of(STRESS, str(load))) * transform
            counters.ffts += 6
            out[:, at] += fft.irfft2(total, s=(nx, ny))[(..., *observed.slices)]  # paper Eq. 7, first sum
        return out
