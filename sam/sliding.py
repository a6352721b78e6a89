# SPDX-License-Identifier: MIT
"""What friction adds to the record of a state: the traction, and how the surface of the body moves along x and in z."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from sam.contact.convolution import Convolution, Counters, convolution_onto
from sam.contact.normal import Contact
from sam.friction import Coefficient, coefficient_on
from sam.grid.cells import CellGrid, Window
from sam.kernels.lags import Lags
from sam.kernels.patches import displacement_coefficients, parity
from sam.loading import Load
from sam.planner.grids import pair_of
from sam.scene import Scene

if TYPE_CHECKING:
    from sam.coating import Film

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
    def elastic(
        cls,
        scene: Scene,
        grid: CellGrid,
        load: Load,
        contact: Contact,
        counters: Counters,
        film: Film | None = None,
        coefficient: Coefficient | None = None,
    ) -> Sliding | None:
        """Under a load without plastic strain; None without friction, then nothing is computed.

        film: of a coated scene; coefficient: of friction, if it is not what the scene gives (`sam.friction`).
        """
        if not scene.coefficient:
            return None
        if coefficient is None:
            coefficient = coefficient_on(scene, grid)
        pressure, traction = contact.pressure, load.sign * coefficient * contact.pressure
        zero = np.zeros(grid.axis_rows.shape)
        if not traction.any():
            return cls(traction, zero, zero, zero, zero)
        if film is not None:

            def kernel(nx: int, ny: int, *, component: int, load: int) -> np.ndarray:
                lags = Lags(nx, ny, grid.hx, grid.hy)
                return film.layered.displacement(lags, component=component, load=load)

            ux = moved_rows(grid, pressure, kernel, 1, 3, counters) + moved_rows(
                grid, traction, kernel, 1, 1, counters
            )
            return cls(
                traction, ux, zero, zero, zero
            )  # u_z: the contact's less that of the counter-body (sam.coating)
        body = scene.body
        mu = body.young / (2 * (1 + body.poisson))
        ux = _rows(grid, pressure, body.poisson, 1, 3, counters) / mu
        ux = ux + _rows(grid, traction, body.poisson, 1, 1, counters) / mu
        # nu = 0 leaves out the factor 1 - 2 nu of D_31, which is a difference where the contact has it (see tangential_mismatch)
        extra, pair = 0.0, pair_of(scene)
        if scene.friction.coupling and pair.other is not None:
            share = pair.body.compliance  # times E*: of the body in the displacement of both
            extra = pair.body.tangential_compliance - 2 * share * pair.tangential_mismatch
        uz = extra * _rows(grid, traction, 0.0, 3, 1, counters) if extra else zero
        return cls(traction, ux, zero, uz, zero)

    def strained(self, residual_ux: np.ndarray, strain: np.ndarray, thickness: np.ndarray) -> Sliding:
        """With plastic strain, (6, nz, nx, rows), in layers of these thicknesses in m."""
        shear = -2 * np.tensordot(thickness, strain[SHEAR], axes=1)
        return Sliding(self.traction, self.ux + residual_ux, residual_ux, self.uz, shear)


def _rows(
    grid: CellGrid, field: np.ndarray, nu: float, component: int, load: int, counters: Counters
) -> np.ndarray:
    """mu times the displacement of the rows that touch y = 0 by a load on the surface, (nx, rows) in Pa m. Paper Eq. 5."""

    def kernel(nx: int, ny: int, *, component: int, load: int) -> np.ndarray:
        lags = Lags(nx, ny, 1.0, grid.hy / grid.hx)
        return displacement_coefficients(lags, nu, component=component, load=load)

    return grid.hx * moved_rows(grid, field, kernel, component, load, counters)


def moved_rows(
    grid: CellGrid, field: np.ndarray, coefficients: Callable, component: int, load: int, counters: Counters
) -> np.ndarray:
    """Displacement of the rows that touch y = 0 by a load on the surface, (nx, rows).

    coefficients: (nx, ny, component=, load=) -> (nx, ny), lags >= 0, displacement by a unit load on the cell at the origin.
    """
    source, observed = Window(0, 0, grid.nx, grid.ny), grid.axis_rows
    kernel = coefficients(*Convolution.lags_needed(source, observed), component=component, load=load)
    counters.tangential_kernels += (component, load) != (3, 3)
    return convolution_onto(
        kernel[None], [parity(str(component), load)], source, observed, counters=counters
    )(field)[0]
