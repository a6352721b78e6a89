# SPDX-License-Identifier: MIT
"""The track of a counter-body that moves, in space: the groove along the path and a section across it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fem_reference.common import track
from fem_reference.common.arrays import Array, Bools
from fem_reference.common.contact import Equilibrium
from fem_reference.common.elasticity import mises
from fem_reference.common.tables import columns
from fem_reference.spatial.model import Model
from fem_reference.spatial.recovery import Stresses, at_zero, stresses
from sam.scene.result import CROSS, Table

XX, YY, XZ = 0, 1, 4  # of the order 11 22 33 23 13 12


@dataclass(frozen=True)
class Track(track.Track):
    """The path of a model, in m."""

    model: Model

    @property
    def along_x(self) -> bool:
        """Whether the groove is measured."""
        return bool(self.ends[0, 1] == self.ends[1, 1]) and not self.plane

    @property
    def plane(self) -> bool:
        """Whether the counter-body is a rough plane, below which every place counts as steady."""
        patch = self.model.plan.patch
        return patch is not None and patch.radii is None

    @property
    def y(self) -> float:
        """Of a path along x, in the units of the model."""
        return float(self.model.plan.sliding.places[0, 1])

    def steady(self, way: Array) -> Bools:
        """Whether these distances lie in the steady part."""
        return np.ones(np.shape(way), dtype=bool) if self.plane else super().steady(way)

    def pressing(self, state: Equilibrium) -> tuple[Array, Array, Array, Array]:
        """Of the base; below a plane the distance is from the origin."""
        model, (tx, ty) = self.model, self.direction
        x, y = model.offsets(*((0.0, 0.0) if self.plane else (state.load.x, state.load.y)))
        slope = model.slope(state.load, self.direction)
        forces = model.on_surface(state.multipliers) / model.part
        return forces, slope, tx * model.ratio(state), tx * x + ty * y

    def profile(self, state: Equilibrium) -> tuple[Array, Array, Array]:
        """Of the base."""
        model, lines = self.model, self.model.lines
        uz = state.u[model.body.basis.nodal_dofs[2][model.surface]] * model.scales.displacement
        x, along = lines.x * model.scales.length, [np.interp(self.y, lines.y, row) for row in uz]
        return x, np.array(along), np.array([np.interp(self.middle, x, column) for column in uz.T])

    def strain(self, state: Equilibrium) -> tuple[Array, Array]:
        """Of the base, in the elements (nx, ny, nz)."""
        s = stresses(self.model, state)
        return s.peeq, s.x

    def tables(self, state: Equilibrium, stresses: Stresses) -> dict[str, Table]:
        """Of the base; across the path the elements in the middle of the steady part, z running first."""
        s, lines = stresses, self.model.lines
        x, uz, across = self.profile(state)
        plane = at_zero(s.stress, lines.y - self.y, 2)[[XX, YY, XZ]]
        strain = np.maximum(s.peeq.max(axis=1), s.plane_peeq if self.y == 0.0 else 0.0)
        line = lines.x - self.middle / self.model.scales.length
        stress, peeq = at_zero(s.stress, line, 1), np.maximum(at_zero(s.peeq, line, 0), 0.0)
        y, z = np.meshgrid(s.y, s.z, indexing="ij")
        uz_of = np.interp(s.y, lines.y * self.model.scales.length, across)
        components = stress.reshape(6, -1)
        values = [y.ravel(), z.ravel(), np.repeat(uz_of, s.z.size), peeq.ravel(), mises(components)]
        return {
            "track": track.track_table(self, (x, uz), (s.x, s.z), np.stack([strain, *plane])),
            "cross": columns(CROSS, [*values, *components]),
        }
