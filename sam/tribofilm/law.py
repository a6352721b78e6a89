# SPDX-License-Identifier: MIT
"""When a tribofilm breaks down: what a load step does to its state in each cell of the surface.

The film of Bosman & Schipper (2011, section 4) is bonded on the body, perfectly plastic (von Mises) and
tested with the low coefficient of friction. It fails where it thins by more than it grows again in a cycle
(paper Eq. 15, 17), or where it cannot bear the traction at all: sqrt(3) mu p >= sigma_y. A film that
becomes thicker loses nothing; the printed form, which only ever thickens under a pressure, is judged by the
size of its strain. A failure lasts until the end of the cycle, and the next cycle starts with a fresh film.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from sam.arrays import Array
from sam.scene.friction import Friction
from sam.surface_state import FilmState
from sam.tribofilm.return_map import bearable_radius, flow, trial_stress


@dataclass(frozen=True)
class FilmLaw:
    """young, yield_stress in Pa; low, high: coefficients of friction; limit: of the plastic strain along z in a cycle."""

    young: float
    poisson: float
    yield_stress: float
    low: float
    high: float
    limit: float
    printed: bool = False

    @classmethod
    def of(cls, friction: Friction) -> FilmLaw:
        """The law of a scene; ValueError unless friction.law is "chemical-film"."""
        given = friction.film_young, friction.film_poisson, friction.film_yield, friction.low, friction.high
        values = [value for value in given if value is not None]
        if not friction.film or len(values) < len(given):
            raise ValueError(f'friction.law = "{friction.law}": a film needs "chemical-film"')
        young, poisson, yield_stress, low, high = values
        limit, printed = friction.thinning_limit, friction.form == "printed"
        return cls(young, poisson, yield_stress, low, high, limit, printed)

    def step(
        self,
        state: FilmState,
        strain: Array,
        pressure: Array,
        sign: float = 1.0,
        bulk_normal: Array | None = None,
    ) -> FilmState:
        """The state at the end of a load step that starts from `state`, which is left as it is.

        strain: of the body's surface since the start of the cycle, xx, yy, xy, (3, nx, ny); pressure: (nx, ny) in Pa, >= 0;
        sign: of the traction on the body along x, s_xz = -sign low p; bulk_normal: the body's strain zz, (nx, ny), for the
        printed form only. Where the pressure is 0 the film may flow but not fail. ValueError for other shapes or numbers.
        """
        strain, pressure = self._checked(state, strain, pressure, bulk_normal)
        radius = bearable_radius(self.low * pressure, self.yield_stress)
        bears = (radius > 0.0) | self.printed
        alive = bears & ~state.failed
        plastic = state.plastic.copy()
        plastic[:, alive] += self._flow(
            state.plastic[:, alive],
            strain[:, alive],
            pressure[alive],
            shear=-sign * self.low * pressure[alive],  # paper Eq. 14
            radius=radius[alive],
            bulk_normal=None if bulk_normal is None else np.asarray(bulk_normal)[alive],
        )
        lost = np.abs(plastic[2]) if self.printed else -plastic[2]
        beyond = ~bears | (lost > self.limit)  # paper Eq. 15 does not hold, by Eq. 17
        return FilmState(plastic, state.failed | (beyond & (pressure > 0.0)))

    def coefficient(self, state: FilmState) -> Array:
        """Local coefficient of friction, (nx, ny)."""
        return np.where(state.failed, self.high, self.low)

    @property
    def bearable_pressure(self) -> float:
        """Pressure in Pa from which there is no equilibrium at the low coefficient; infinite without friction."""
        return self.yield_stress / (np.sqrt(3.0) * self.low) if self.low > 0 else np.inf

    def _flow(
        self,
        plastic: Array,
        strain: Array,
        pressure: Array,
        *,
        shear: Array,
        radius: Array,
        bulk_normal: Array | None,
    ) -> Array:
        """Increment of the plastic strain, (6, n), of cells that are whole and in equilibrium."""
        if bulk_normal is not None and self.printed:
            from sam.tribofilm.printed import printed_stress, radial_flow

            stress = printed_stress(strain, bulk_normal, pressure, shear, self.young, self.poisson)
            return radial_flow(stress, plastic, self.young, self.poisson, self.yield_stress)
        # paper Eq. 12, and Eq. 13 with s_zz = -P
        trial = trial_stress(plastic, strain, -pressure, self.young, self.poisson)
        return flow(trial, shear, radius, self.young, self.poisson)

    def _checked(
        self, state: FilmState, strain: ArrayLike, pressure: ArrayLike, bulk_normal: Array | None
    ) -> tuple[Array, Array]:
        """strain and pressure as arrays of floats; ValueError for shapes or numbers that cannot be."""
        strain, pressure = np.asarray(strain, dtype=float), np.asarray(pressure, dtype=float)
        shape = state.failed.shape
        if strain.shape != (3, *shape) or pressure.shape != shape:
            raise ValueError(
                f"strain {strain.shape} and pressure {pressure.shape} must be {(3, *shape)} and {shape}, as the film is"
            )
        if not (np.isfinite(strain).all() and np.isfinite(pressure).all() and (pressure >= 0.0).all()):
            raise ValueError("strain and pressure must be finite, and the pressure nowhere below 0")
        if self.printed and (bulk_normal is None or np.shape(bulk_normal) != shape):
            raise ValueError(f'bulk_normal, the strain zz of the body {shape}, is needed by form = "printed"')
        return strain, pressure
