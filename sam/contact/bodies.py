# SPDX-License-Identifier: MIT
"""How far a loaded cell moves two surfaces, in the units of the contact: two homogeneous half-spaces, or one of them coated.

Units as in `sam.contact.normal`: lengths in cells hx, pressures as p_hat = 2 p/E*. A homogeneous pair then holds no
material constant; a coated one depends on the thickness in cells, so it knows its cell, and a coarser grid has another one.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from sam.kernels.lags import Lags
from sam.kernels.patches import displacement_coefficients

if TYPE_CHECKING:
    from sam.layered.patches import LayeredPatches

WAVES = 64  # between the grid and the cell, in the bound of a traction's effect


class HalfSpaces:
    """Two homogeneous half-spaces; the coupling of a traction is then 2 beta mu (see `sam.grid.coupling_of`).

    most_iterations of a contact; patience: iterations without a new smallest residual, after which it gives up; single: whether
    directions may be transformed in single precision; settled: see `sam.contact.box`.
    """

    most_iterations, patience, single, settled = 1000, 100, True, 0.4

    def normal(self, nx: int, ny: int, aspect: float) -> np.ndarray:
        """u_hat_z by p_hat = 1 on the cell at the origin, (nx, ny) lags >= 0. Paper: D_33 of Eq. 5."""
        return displacement_coefficients(Lags(nx, ny, 1.0, aspect), nu=0.0)

    def tangential(self, nx: int, ny: int, aspect: float) -> np.ndarray:
        """u_hat_z by a traction p_hat = 1 along x with coupling 1. Paper: D_31 of Eq. 5."""
        return displacement_coefficients(Lags(nx, ny, 1.0, aspect), nu=0.0, component=3, load=1)

    def stiffness(self, wave_number: np.ndarray) -> np.ndarray:
        """p_hat of a unit harmonic of u_hat with a wave number per cell > 0: |k| (Westergaard)."""
        return wave_number

    def tangential_share(self, cells: int) -> float:
        """The most that a traction with coupling 1 moves a harmonic, over what p moves it; cells: across the grid."""
        return 0.5

    def coarser(self) -> HalfSpaces:
        """The same bodies for cells twice as large."""
        return self


HALF_SPACES = HalfSpaces()


class CoatedBodies(HalfSpaces):
    """A coated body 1 and a homogeneous body 2; the coupling of a traction is then its coefficient mu.

    layered: coefficients of body 1; hx: cell in m; modulus: E* in Pa of the unit of p_hat; compliance (1 - nu2^2)/E2 and
    tangential (1 - 2 nu2)/mu2 in 1/Pa of body 2, which carries the opposite traction; both 0 if it is rigid.
    A stiff film bends like a plate, whose compliance falls like k^-4: the iteration then rests long and moves on, and short
    waves are lost in the rounding of long ones; pressures below zero are cut at once.
    """

    most_iterations, patience, single, settled = 5000, 2000, False, np.inf

    def __init__(
        self,
        layered: LayeredPatches,
        hx: float,
        modulus: float,
        compliance: float = 0.0,
        tangential: float = 0.0,
    ):
        self.layered, self.hx, self.modulus = layered, hx, modulus
        self.compliance, self.tangential_compliance = compliance, tangential
        self._known: dict[tuple, np.ndarray] = {}
        self._coarser: CoatedBodies | None = None

    def _coefficients(self, nx: int, ny: int, aspect: float, load: int, counterpart: float) -> np.ndarray:
        """u_hat_z by load 3 or 1: of body 1, and `counterpart` (in 1/p_hat) times that of a half-space."""
        key = nx, ny, aspect, load
        if key not in self._known:
            coated = self.layered.displacement(
                Lags(nx, ny, self.hx, aspect * self.hx), component=3, load=load
            )
            total = self.modulus / (2 * self.hx) * coated
            if counterpart:
                total = total + counterpart * displacement_coefficients(
                    Lags(nx, ny, 1.0, aspect), 0.0, component=3, load=load
                )
            self._known[key] = total
        return self._known[key]

    def normal(self, nx: int, ny: int, aspect: float) -> np.ndarray:
        return self._coefficients(nx, ny, aspect, 3, self.modulus * self.compliance)

    def tangential(self, nx: int, ny: int, aspect: float) -> np.ndarray:
        return self._coefficients(nx, ny, aspect, 1, -self.modulus * self.tangential_compliance / 2)

    def stiffness(self, wave_number: np.ndarray) -> np.ndarray:
        shape, k = wave_number.shape, wave_number.ravel() / self.hx
        coated = self.modulus / (2 * self.hx) * self.layered.response(k)
        return 1 / (coated.reshape(shape) + self.modulus * self.compliance / wave_number)

    def tangential_share(self, cells: int) -> float:
        from sam.layered.response import Response

        layers = self.layered.layers
        k = np.geomspace(2 * np.pi / cells, np.pi, WAVES) / self.hx
        c_zz, c_zl, *_ = Response(layers, k * layers.thickness).surface / layers.shear
        return float(np.max(np.abs(c_zl + self.tangential_compliance / 2) / (c_zz + 2 * self.compliance)))

    def coarser(self) -> CoatedBodies:
        if self._coarser is None:
            self._coarser = CoatedBodies(
                self.layered, 2 * self.hx, self.modulus, self.compliance, self.tangential_compliance
            )  # fmt: skip
        return self._coarser
