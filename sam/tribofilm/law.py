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
from importlib import import_module

import numpy as np
from numpy.typing import ArrayLike

from sam.arrays import Array
from sam.scene.friction import Friction
from sam.scene.section import stated
from sam.surface_state import FilmState
from sam.tribofilm.material import Loads, Material
from sam.tribofilm.return_map import bearable_radius

FORMS = {"consistent": "sam.tribofilm.return_map", "printed": "sam.tribofilm.printed"}
"""Form of the law -> the module whose `increment` gives the plastic strain; loaded when a
step asks for it.
"""


@dataclass(frozen=True)
class FilmLaw:
    """The law of a tribofilm, which decides where the coefficient of friction is low and where it is high.

    Parameters
    ----------
    young, yield_stress
        In Pa; the film is perfectly plastic.
    poisson
        Poisson's ratio, below 1/2.
    low, high
        Coefficients of friction of a whole film, and where it has broken down.
    limit
        Largest loss of thickness in a cycle, as a strain (paper Eq. 17).
    printed
        Whether Eq. 12 and 13 are taken as printed.
    """

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
        if not friction.film:
            raise ValueError(f'friction.law = "{friction.law}": a film needs "chemical-film"')
        return cls(
            young=stated(friction.film_young),
            poisson=stated(friction.film_poisson),
            yield_stress=stated(friction.film_yield),
            low=stated(friction.low),
            high=stated(friction.high),
            limit=friction.thinning_limit,
            printed=friction.form == "printed",
        )

    @property
    def material(self) -> Material:
        """What the film is made of."""
        return Material(self.young, self.poisson, self.yield_stress)

    def step(
        self,
        state: FilmState,
        strain: ArrayLike,
        pressure: ArrayLike,
        *,
        sign: float = 1.0,
        bulk_normal: ArrayLike | None = None,
        limit: Array | None = None,
    ) -> FilmState:
        """The state at the end of a load step that starts from `state`, which is left as it is.

        Where the pressure is 0 the film may flow but not fail.

        Parameters
        ----------
        state
            The film on (nx, ny) cells.
        strain
            (3, nx, ny) strains xx, yy, xy of the body's surface since the start of the cycle.
        pressure
            (nx, ny) in Pa, >= 0.
        sign
            Of the traction on the body along x, s_xz = -sign low p.
        bulk_normal
            (nx, ny) strain zz of the body, for the printed form only.
        limit
            (nx, ny) largest loss of thickness of each cell, in place of that of the law.

        Raises
        ------
        ValueError
            For other shapes, or numbers that are not finite.
        """
        strain, pressure, bulk = self._checked(state, strain, pressure, bulk_normal)
        bears = (bearable_radius(self.low * pressure, self.yield_stress) > 0.0) | self.printed
        alive = bears & ~state.failed
        loads = Loads(
            state.plastic[:, alive],
            strain[:, alive],
            pressure[alive],
            -sign * self.low * pressure[alive],  # paper Eq. 14
            None if bulk is None else bulk[alive],
        )
        form = import_module(FORMS["printed" if self.printed else "consistent"])
        plastic = state.plastic.copy()
        plastic[:, alive] += form.increment(loads, self.material)
        lost = np.abs(plastic[2]) if self.printed else -plastic[2]
        beyond = ~bears | (
            lost > (self.limit if limit is None else limit)
        )  # paper Eq. 15 does not hold, by Eq. 17
        return FilmState(plastic, state.failed | (beyond & (pressure > 0.0)))

    def coefficient(self, state: FilmState) -> Array:
        """Local coefficient of friction, (nx, ny)."""
        return np.where(state.failed, self.high, self.low)

    @property
    def bearable_pressure(self) -> float:
        """Pressure in Pa from which there is no equilibrium at the low coefficient; infinite without
        friction.
        """
        return float(self.yield_stress / (np.sqrt(3.0) * self.low)) if self.low > 0 else np.inf

    def _checked(
        self, state: FilmState, strain: ArrayLike, pressure: ArrayLike, bulk_normal: ArrayLike | None
    ) -> tuple[Array, Array, Array | None]:
        """strain, pressure and bulk_normal as arrays of floats."""
        strain, pressure = np.asarray(strain, dtype=float), np.asarray(pressure, dtype=float)
        shape = state.failed.shape
        if strain.shape != (3, *shape) or pressure.shape != shape:
            shapes = f"{(3, *shape)} and {shape}, as the film is"
            raise ValueError(f"strain {strain.shape} and pressure {pressure.shape} must be {shapes}")
        if not (np.isfinite(strain).all() and np.isfinite(pressure).all() and (pressure >= 0.0).all()):
            raise ValueError("strain and pressure must be finite, and the pressure nowhere below 0")
        bulk = None if bulk_normal is None else np.asarray(bulk_normal)
        if self.printed and (bulk is None or bulk.shape != shape):
            raise ValueError(f'bulk_normal, the strain zz of the body {shape}, is needed by form = "printed"')
        return strain, pressure, bulk
