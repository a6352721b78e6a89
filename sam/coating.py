# SPDX-License-Identifier: MIT
"""A coated scene: its layered body, and what the record of a state holds of the coating. Loaded for coated scenes only."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sam.contact.bodies import CoatedBodies
from sam.contact.convolution import Counters
from sam.contact.normal import Contact
from sam.friction import coefficient_on
from sam.grid.cells import CellGrid
from sam.half_space import ElasticConstants
from sam.kernels.lags import Lags
from sam.kernels.patches import displacement_coefficients
from sam.layered.patches import LayeredPatches
from sam.layered.response import Layers
from sam.loading import Load
from sam.planner.grids import pair_of
from sam.scene import Scene
from sam.sliding import moved_rows


@dataclass(frozen=True)
class Comparison:
    """The bare body under the same load, on the same grid and at the same depths.

    p_max in Pa; mises: von Mises stress of (nz, n) points in Pa, where that of the coated body is taken; warning: why they
    are None where the grid does not suit the contact of the bare body.
    """

    p_max: float | None = None
    mises: np.ndarray | None = None
    warning: str = ""


@dataclass(frozen=True)
class Coated:
    """What a coating adds to the record of a state.

    thickness in m; counter_uz: displacement of the counter-body's surface away from the body, (nx, rows) in m, which the
    contact counts and the body has not; comparison: with the bare body, at the peak of a scene with force.
    """

    thickness: float
    counter_uz: np.ndarray
    comparison: Comparison | None = None


class Film:
    """The coated body of a scene and its counter-body; one object serves all load steps.

    layered: coefficients of the body; compliance (1 - nu^2)/E and tangential_compliance (1 - 2 nu)/mu in 1/Pa of the
    counter-body, 0 if it is rigid or absent.
    """

    def __init__(self, scene: Scene):
        body, coating, other = scene.body, scene.body.coating, scene.counterbody
        self.scene, self.thickness = scene, coating.thickness
        self.layered = LayeredPatches(
            Layers(coating.young, coating.poisson, coating.thickness, body.young, body.poisson)
        )  # fmt: skip
        elastic = other is not None and other.elastic
        self.compliance = (1 - other.poisson**2) / other.young if elastic else 0.0
        self.tangential_compliance = (
            ElasticConstants(other.young, other.poisson).tangential_compliance if elastic else 0.0
        )
        self._bodies: CoatedBodies | None = None

    def response(self, k: np.ndarray) -> np.ndarray:
        """c_zz(k) of both bodies together in m/Pa, k > 0 in 1/m."""
        return self.layered.response(k) + 2 * self.compliance / k

    def bodies(self, grid: CellGrid) -> CoatedBodies:
        """Their coefficients on a grid; those of the last one are kept."""
        if self._bodies is None or self._bodies.hx != grid.hx:
            self._bodies = CoatedBodies(
                self.layered,
                grid.hx,
                pair_of(self.scene).contact_modulus,
                compliance=self.compliance,
                tangential=self.tangential_compliance,
            )
        return self._bodies

    def state(
        self, grid: CellGrid, load: Load, contact: Contact, counters: Counters, comparison: Comparison | None
    ) -> Coated:
        """The record of a state under a load."""
        return Coated(self.thickness, self._counter_uz(grid, load, contact, counters), comparison)

    def _counter_uz(self, grid: CellGrid, load: Load, contact: Contact, counters: Counters) -> np.ndarray:
        """See `Coated`; the counter-body carries the opposite traction."""
        pressure, friction = contact.pressure, self.scene.friction
        if not (self.compliance and pressure.any()):
            return np.zeros(grid.axis_rows.shape)

        def kernel(nx: int, ny: int, *, component: int, load: int) -> np.ndarray:
            """The coefficients of the counter-body times its mu."""
            lags = Lags(nx, ny, 1.0, grid.hy / grid.hx)
            return displacement_coefficients(lags, nu=0.0, component=component, load=load)

        out = 2 * self.compliance * grid.hx * moved_rows(grid, pressure, kernel, 3, 3, counters)
        if friction is not None and friction.coupling and self.scene.coefficient:
            traction = load.sign * coefficient_on(self.scene, grid) * pressure
            out = out - self.tangential_compliance * grid.hx * moved_rows(
                grid, traction, kernel, 3, 1, counters
            )
        return out


def bare(scene: Scene) -> Scene:
    """The scene with the material of the body up to its surface."""
    return scene.model_copy(update={"body": scene.body.model_copy(update={"coating": None})})
