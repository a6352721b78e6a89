# SPDX-License-Identifier: MIT
"""The track of a cylinder that moves, in a section along its path."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fem_reference.common.arrays import Array
from fem_reference.common.contact import Equilibrium
from fem_reference.common.elasticity import mises
from fem_reference.common.tables import columns
from fem_reference.common.track import Track, track_table
from fem_reference.plane_strain.model import Model
from fem_reference.plane_strain.recovery import Stresses, columns_of_points
from sam.scene.result import CROSS, Table
from sam.scene.section import stated


@dataclass(frozen=True)
class LineTrack(Track):
    """The path of a model, in m."""

    model: Model

    def pressing(self, state: Equilibrium) -> tuple[Array, Array, Array, Array]:
        """Of the base; the slope of the gap is x/R."""
        along = float(self.direction[0])
        x = along * (self.model.surface[self.model.candidates] - state.load.x)
        return state.multipliers, self.model.scales.strain * x, np.array(along * state.load.ratio), x

    def profile(self, state: Equilibrium) -> tuple[Array, Array, Array]:
        """Of the base; across the path all is the same, and nothing rises beside it."""
        model = self.model
        uz = model.displacements(state)[model.body.boundary_dofs("surface", 1)]
        return model.surface * model.scales.length, uz * model.scales.displacement, np.zeros(0)

    def strain(self, state: Equilibrium) -> tuple[Array, Array]:
        """Of the base, at the Gauss points (2 nx, 2 nz)."""
        unit, points = self.model.scales, columns_of_points(self.model)
        peeq = stated(state.history).peeq.ravel()[points] * unit.strain
        return peeq, self.model.body.points[0].ravel()[points[:, 0]] * unit.length

    def tables(self, state: Equilibrium, stresses: Stresses) -> dict[str, Table]:
        """Of the base; the section across the path is one line over depth, at y = 0."""
        s, (x, uz, _) = stresses, self.profile(state)
        fields = np.stack([s.peeq, *s.stress[[0, 1, 3]]])
        xx, yy, zz, xz = stress = s.at(self.middle, s.stress)
        middle, peeq = float(np.interp(self.middle, x, uz)), s.at(self.middle, s.peeq)
        cross = columns(CROSS, [0.0, s.z, middle, peeq, mises(stress), xx, yy, zz, 0.0, xz, 0.0])
        return {"track": track_table(self, (x, uz), (s.x, s.z), fields), "cross": cross}
