# SPDX-License-Identifier: MIT
"""Two half-spaces under tractions that repeat with the grid: what is asked of them in place of single ones.

A mean traction moves a half-space without bound. Displacements are therefore those about their mean, and the
approach is that of the mean planes of the deformed surfaces: at most the mean of the gap, where all of the
patch touches. The mean stress is laterally uniform: under a mean pressure p it is -p in 33 and, where the
body cannot spread, -nu/(1 - nu) p in 11 and 22.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike
from scipy import fft

from sam.arrays import Array
from sam.contact.convolution import Counters
from sam.contact.operators import HALF_SPACES, HalfSpaces
from sam.grid.cells import Window
from sam.kernels.patches import STRESS, Cuboids, Lags
from sam.kernels.waves import in_cells, load_waves, strain_displacement_waves, whole_waves


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
                total = total + whole_waves(waves, nx, STRESS, load) * transform
            counters.ffts += 6
            out[:, at] += fft.irfft2(total, s=(nx, ny))[(..., *observed.slices)]  # paper Eq. 7, first sum
        return out
