# SPDX-License-Identifier: MIT
"""How the surface of an elastic body moves along x and in z under pressure and traction, in the rows at y =
0.
"""

from __future__ import annotations

from typing import Protocol

import numpy as np

from sam.arrays import Array
from sam.contact.convolution import Convolution, Counters, convolution_onto
from sam.elastic.problem import Loaded
from sam.grid.cells import CellGrid
from sam.kernels.lags import Lags
from sam.kernels.patches import displacement_coefficients, parity
from sam.results.snapshots import Sliding


class Kernel(Protocol):
    """Displacement by a unit load on the cell at the origin, (nx, ny) lags >= 0."""

    def __call__(self, nx: int, ny: int, *, component: int, load: int) -> Array:
        """Of a component by a load in a direction, both 1 to 3."""


def sliding_of(state: Loaded) -> Sliding | None:
    """What friction adds to an elastic state; None without friction, then nothing is computed."""
    problem, pressure, traction = state.problem, state.contact.pressure, state.traction
    if traction is None:
        return None
    grid, counters, coated = problem.grid, problem.counters, problem.coated
    zero = np.zeros(grid.axis_rows.shape)
    if not traction.any():
        return Sliding(traction, zero, zero, zero, zero)
    if coated is not None:  # u_z: the contact's less that of the counter-body, see sam.elastic.coated

        def layered(nx: int, ny: int, *, component: int, load: int) -> Array:
            lags = Lags(nx, ny, grid.hx, grid.hy)
            return coated.layered.displacement(lags, component=component, load=load)

        ux = moved_rows(grid, pressure, layered, (1, 3), counters=counters)
        ux = ux + moved_rows(grid, traction, layered, (1, 1), counters=counters)
        return Sliding(traction, ux, zero, zero, zero)
    pair = problem.pair
    kernel = half_space_kernel(grid, pair.body.poisson)
    ux = grid.hx * moved_rows(grid, pressure, kernel, (1, 3), counters=counters) / pair.body.shear
    ux = ux + grid.hx * moved_rows(grid, traction, kernel, (1, 1), counters=counters) / pair.body.shear
    # nu = 0 leaves out the factor 1 - 2 nu of D_31, which is a difference where the contact has it
    extra = 0.0
    if problem.slip.coupled and pair.other is not None:
        share = pair.body.compliance  # times E*: of the body in the displacement of both
        extra = pair.body.tangential_compliance - 2 * share * pair.tangential_mismatch
    uz = zero
    if extra:
        kernel = half_space_kernel(grid, 0.0)
        uz = extra * (grid.hx * moved_rows(grid, traction, kernel, (3, 1), counters=counters))
    return Sliding(traction, ux, zero, uz, zero)


def half_space_kernel(grid: CellGrid, nu: float) -> Kernel:
    """mu times the displacement of the surface of a half-space, lengths in hx. Paper Eq. 5."""

    def kernel(nx: int, ny: int, *, component: int, load: int) -> Array:
        lags = Lags(nx, ny, 1.0, grid.hy / grid.hx)
        return displacement_coefficients(lags, nu, component=component, load=load)

    return kernel


def moved_rows(
    grid: CellGrid, field: Array, kernel: Kernel, moved_by: tuple[int, int], *, counters: Counters
) -> Array:
    """Displacement of the rows that touch y = 0 by a load on the surface, (nx, rows).

    moved_by: component of the displacement and direction of the load, 1 to 3.
    """
    component, load = moved_by
    source, observed = grid.whole, grid.axis_rows
    coefficients = kernel(*Convolution.lags_needed(source, observed), component=component, load=load)
    counters.tangential_kernels += moved_by != (3, 3)
    signs = [parity(str(component), load)]
    found: Array = convolution_onto(coefficients[None], signs, source, observed, counters=counters)(field)[0]
    return found
