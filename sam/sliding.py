# SPDX-License-Identifier: MIT
"""What friction adds to the record of a state: the traction, and how the surface of the body moves along x and in z."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sam.contact import Contact
from sam.convolution import Convolution, Counters, Window
from sam.grid import CellGrid, tangential_compliance, tangential_mismatch
from sam.kernels.patches import displacement_coefficients, parity
from sam.loading import Load
from sam.scene import Scene

SHEAR = 4  # index of the component 13


@dataclass(frozen=True)
class Sliding:
    """traction: q_x on the body, (nx, ny) in Pa. The others in the rows of cells that touch y = 0, (nx, rows) in m.

    ux: displacement of the surface along x, by pressure, traction and plastic strain; residual_ux: the part of the plastic
    strain; uz: what u_z of the body has beyond its share of the contact's displacement; shear: -integral of 2 eps_p_13 over
    depth, by which plastic flow carries the surface along x over the unstrained depth.
    """

    traction: np.ndarray
    ux: np.ndarray
    residual_ux: np.ndarray
    uz: np.ndarray
    shear: np.ndarray

    @classmethod
    def elastic(cls, scene: Scene, grid: CellGrid, load: Load, contact: Contact, counters: Counters) -> Sliding | None:
        """Under a load without plastic strain; None without friction, then nothing is computed."""
        if not scene.coefficient:
            return None
        pressure, traction = contact.pressure, load.sign * scene.coefficient * contact.pressure
        zero = np.zeros(grid.axis_rows.shape)
        if not traction.any():
            return cls(traction, zero, zero, zero, zero)
        body = scene.body
        mu = body.young / (2 * (1 + body.poisson))
        ux = _rows(grid, pressure, body.poisson, 1, 3, counters) / mu
        ux = ux + _rows(grid, traction, body.poisson, 1, 1, counters) / mu
        # nu = 0 leaves out the factor 1 - 2 nu of D_31, which is a difference where the contact has it (see tangential_mismatch)
        extra, other = 0.0, scene.counterbody
        if scene.friction.coupling and other is not None and other.elastic:
            share = (1 - body.poisson**2) / body.young  # times E*: of the body in the displacement of both
            extra = tangential_compliance(body.young, body.poisson) - 2 * share * tangential_mismatch(scene)
        uz = extra * _rows(grid, traction, 0.0, 3, 1, counters) if extra else zero
        return cls(traction, ux, zero, uz, zero)

    def strained(self, residual_ux: np.ndarray, strain: np.ndarray, thickness: np.ndarray) -> Sliding:
        """With plastic strain, (6, nz, nx, rows), in layers of these thicknesses in m."""
        shear = -2 * np.tensordot(thickness, strain[SHEAR], axes=1)
        return Sliding(self.traction, self.ux + residual_ux, residual_ux, self.uz, shear)


def _rows(grid: CellGrid, field: np.ndarray, nu: float, component: int, load: int, counters: Counters) -> np.ndarray:
    """mu times the displacement of the rows that touch y = 0 by a load on the surface, (nx, rows) in Pa m. Paper Eq. 5."""
    source, observed = Window(0, 0, grid.nx, grid.ny), grid.axis_rows
    lags = Convolution.lags_needed(source, observed)
    kernel = displacement_coefficients(*lags, 1.0, grid.hy / grid.hx, nu, component, load)
    counters.tangential_kernels += 1
    return grid.hx * Convolution(kernel[None], [parity(str(component), load)], source, observed, counters)(field)[0]
