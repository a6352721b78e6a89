# SPDX-License-Identifier: MIT
"""Stresses of a section where they are reported: at the Gauss points, which are a tensor grid as the mesh
is, and on the axis. SI units.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fem_reference.common import recovery as common
from fem_reference.common.arrays import Array, Integers
from fem_reference.common.bodies import EVEN
from fem_reference.common.contact import Equilibrium
from fem_reference.common.elasticity import on_grid
from fem_reference.common.recovery import Peak, over_depth, plastic_fields
from fem_reference.plane_strain.model import Model
from sam.scene.yield_curve import Kinks


@dataclass(frozen=True)
class Stresses(common.Stresses):
    """Stress of the body in Pa, components (xx, yy, zz, xz), tension positive, and its plastic strain.

    x (nx,), z (nz,): columns and rows of Gauss points in m; stress: (4, nx, nz); peeq: (nx, nz) accumulated
    plastic strain; plastic_strain: as stress, tensor components, None for an elastic body; axis (4, nz),
    axis_peeq (nz,): at x = 0; kinks: of the yield stress of a body that has yielded.
    """

    x: Array
    z: Array
    stress: Array
    peeq: Array
    axis: Array
    axis_peeq: Array
    plastic_strain: Array | None = None
    kinks: Kinks = EVEN

    def at(self, place: float, values: Array) -> Array:
        """Values (..., nx, nz) at the place x in m, (..., nz): linear between the columns."""
        k = int(np.clip(np.searchsorted(self.x, place), 1, self.x.size - 1))
        share = (place - self.x[k - 1]) / (self.x[k] - self.x[k - 1])
        out: Array = (1.0 - share) * values[..., k - 1, :] + share * values[..., k, :]
        return out

    def largest(self, field: Array, even: Array) -> Peak:
        """Largest value over the Gauss points (nx, nz) and the axis (nz,), and its depth in m (None if all
        are zero), of `over_depth`.
        """
        i, k = np.unravel_index(np.argmax(field), field.shape)
        row = field[i]
        if even.max() > field.max():
            row, k = even, even.argmax()
        if row[k] == 0.0:
            return 0.0, None
        # at a point that has yielded the stress is bounded, and no parabola passes it
        if field is not self.peeq and row is not even and self.peeq[i, k] > 0.0:
            return float(row[k]), float(self.z[k])
        return over_depth(self.z, row, int(k), self.kinks)


def columns_of_points(model: Model) -> Integers:
    """(2 nx, 2 nz) numbers of the Gauss points of the body in a flat field, by x and by z."""
    return on_grid(model.body.points.reshape(2, -1), (2 * model.plan.x.size - 2, -1))


def stresses(model: Model, state: Equilibrium) -> Stresses:
    """Stresses of a load step."""
    unit, points = model.scales, columns_of_points(model)
    x, z = model.body.points.reshape(2, -1) * unit.length

    def ordered(field: Array) -> Array:
        return field.reshape(*field.shape[:-2], -1)[..., points]

    gauss = ordered(model.stress(state)) * unit.pressure
    peeq, tensor = plastic_fields(state.history, gauss, unit.strain, ordered)
    x, z = x[points[:, 0]], z[points[0]]
    axis = on_axis(x, gauss)
    if model.plan.half:
        axis[3] = 0.0
    # an even parabola can fall below zero at the edge of the plastic zone
    axis_peeq = np.maximum(on_axis(x, peeq[None])[0], 0.0)
    kinks = model.plan.bodies.kinks if state.yielded else EVEN
    return Stresses(x, z, gauss, peeq, axis, axis_peeq, tensor, kinks=kinks)


def on_axis(x: Array, field: Array) -> Array:
    """(k, nz) values at x = 0 of fields (k, nx, nz) by the even parabola through the nearest columns."""
    first = int(np.searchsorted(x, 0.0))
    near, far = field[:, first], field[:, first + 1]
    if first:
        near, far = 0.5 * (near + field[:, first - 1]), 0.5 * (far + field[:, first - 2])
    r1, r2 = x[first] ** 2, x[first + 1] ** 2
    out: Array = (near * r2 - far * r1) / (r2 - r1)
    return out
