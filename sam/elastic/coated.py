# SPDX-License-Identifier: MIT
"""A coated body and its counter-body. Loaded for coated scenes only."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from sam.arrays import Array
from sam.contact.convolution import Counters
from sam.contact.operators import CoatedBodies
from sam.elastic.stress import half_space_kernel, moved_rows
from sam.grid.cells import CellGrid
from sam.half_space import ElasticConstants, ElasticPair
from sam.layered.patches import LayeredPatches
from sam.layered.response import Layers


@dataclass(frozen=True)
class CoatedPair:
    """The coated body and its counter-body; one object serves all load steps.

    layered: coefficients of the coated body; pair: the body below the coating, and the counter-body;
    thickness in m.
    """

    layered: LayeredPatches
    pair: ElasticPair
    thickness: float
    _known: dict[float, CoatedBodies] = field(default_factory=dict, compare=False, repr=False)

    @classmethod
    def of(cls, coating: ElasticConstants, thickness: float, pair: ElasticPair) -> CoatedPair:
        """A coating of a thickness in m on the body of a pair."""
        layers = Layers(coating.young, coating.poisson, thickness, pair.body.young, pair.body.poisson)
        return cls(LayeredPatches(layers), pair, thickness)

    @property
    def compliance(self) -> float:
        """(1 - nu^2)/E of the counter-body in 1/Pa; 0 if it is rigid or absent."""
        return self.pair.other.compliance if self.pair.other is not None else 0.0

    @property
    def tangential_compliance(self) -> float:
        """(1 - 2 nu)/mu of the counter-body in 1/Pa; 0 if it is rigid or absent."""
        return self.pair.other.tangential_compliance if self.pair.other is not None else 0.0

    def response(self, k: Array) -> Array:
        """c_zz(k) of both bodies together in m/Pa, k > 0 in 1/m."""
        return self.layered.response(k) + 2 * self.compliance / k

    def bodies(self, grid: CellGrid) -> CoatedBodies:
        """Their coefficients on a grid; those of the last one are kept."""
        if grid.hx not in self._known:
            self._known.clear()
            self._known[grid.hx] = CoatedBodies(
                self.layered,
                grid.hx,
                self.pair.contact_modulus,
                compliance=self.compliance,
                tangential=self.tangential_compliance,
            )
        return self._known[grid.hx]

    def counter_uz(
        self, grid: CellGrid, pressure: Array, traction: Array | None, counters: Counters
    ) -> Array:
        """Displacement of the counter-body's surface away from the body, (nx, rows) in m, in the rows at y =
        0.

        traction: on the body, None where it does not count; the counter-body carries the opposite one.
        """
        if not (self.compliance and pressure.any()):
            return np.zeros(grid.axis_rows.shape)
        kernel = half_space_kernel(grid, 0.0)
        out = 2 * self.compliance * grid.hx * moved_rows(grid, pressure, kernel, (3, 3), counters=counters)
        if traction is None:
            return out
        moved = moved_rows(grid, traction, kernel, (3, 1), counters=counters)
        return out - self.tangential_compliance * grid.hx * moved
