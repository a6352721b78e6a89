# SPDX-License-Identifier: MIT
"""Stresses of the body where they are reported: at the Gauss points, on the axis, in the elements. SI
units.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from fem_reference.axisymmetric.model import Model
from fem_reference.common import recovery as common
from fem_reference.common.arrays import Array
from fem_reference.common.bodies import EVEN
from fem_reference.common.contact import Equilibrium
from fem_reference.common.elasticity import mises
from fem_reference.common.recovery import Peak, continued, over_depth, plastic_fields
from sam.scene.section import stated
from sam.scene.yield_curve import Kinks


@dataclass(frozen=True)
class Stresses(common.Stresses):
    """Stress of the body in Pa, components (rr, tt, zz, rz), tension positive, and its plastic strain.

    r, z: (n_elements, 4) Gauss points in m; stress: (4, n_elements, 4); axis_z: (n_axis,) in m, ascending;
    axis: (4, n_axis); peeq, axis_peeq: accumulated plastic strain at the same points; plastic_strain: as
    stress, tensor components; None for an elastic body; interface: depth of a coating's lower face in m. The
    axis has a point there, with the values below it; those above are of the coating alone. kinks: of the
    yield stress of a body that has yielded; there fields over depth have kinks too.
    """

    r: Array
    z: Array
    stress: Array
    axis_z: Array
    axis: Array
    peeq: Array
    axis_peeq: Array
    plastic_strain: Array | None = None
    interface: float | None = None
    kinks: Kinks = EVEN

    def layer(self, coating: bool) -> Stresses:
        """The part above the interface, or from it downwards."""
        interface = stated(self.interface)
        elements = (self.z.mean(axis=1) < interface) == coating
        axis = (self.axis_z < interface) == coating
        return Stresses(
            self.r[elements],
            self.z[elements],
            self.stress[:, elements],
            self.axis_z[axis],
            self.axis[:, axis],
            self.peeq[elements],
            self.axis_peeq[axis],
            kinks=self.kinks,
        )

    def largest_in_layer(self, coating: bool) -> Peak:
        """Largest von Mises stress in Pa of the coating or below it, with its faces, and depth in m."""
        part = self.layer(coating)
        inside = part.largest_mises()
        if coating and part.peeq.any():
            return inside
        interface = stated(self.interface)
        depths = (0.0, interface) if coating else (interface,)
        on_faces = [(float(mises(on_face(part, depth)).max()), depth) for depth in depths]
        return max(inside, *on_faces, key=lambda peak: peak[0])

    def largest(self, field: Array, even: Array) -> Peak:
        """Largest value over Gauss points (n_elements, 4) and axis (n_axis,), and its depth in m (None if all
        are zero); on the axis of `over_depth`.
        """
        i = int(np.argmax(even))
        if field.max() > even[i]:
            return float(field.max()), float(self.z.ravel()[np.argmax(field)])
        if even[i] == 0.0:
            return 0.0, None
        return over_depth(self.axis_z, even, i, self.kinks)


def stresses(model: Model, state: Equilibrium) -> Stresses:
    """Stresses of a load step; never averaged over elements."""
    unit = model.scales
    r, z = model.body.points * unit.length
    gauss = model.stress(state) * unit.pressure
    peeq, tensor = plastic_fields(state.history, gauss, unit.strain, lambda field: field)
    axis_z, axis = on_axis(r, z, gauss)
    axis[:2] = 0.5 * (axis[0] + axis[1])
    axis[3] = 0.0
    # an even parabola can fall below zero at the edge of the plastic zone
    axis_peeq = np.maximum(on_axis(r, z, peeq[None])[1][0], 0.0)
    kinks = model.plan.bodies.kinks if state.yielded else EVEN
    s = Stresses(r, z, gauss, axis_z, axis, peeq, axis_peeq, tensor, kinks=kinks)
    interface = model.plan.interface
    return s if interface is None else with_interface(s, interface * unit.length)


def with_interface(s: Stresses, depth: float) -> Stresses:
    """Stresses with a point of the axis at the interface: on the line through the two below, or as
    next to it where the body has yielded, as beyond it the yield stress would be passed.
    """
    first = int(np.searchsorted(s.axis_z, depth))
    near = slice(first, first + (1 if s.axis_peeq[first] > 0.0 else 2))
    stress = continued(s.axis_z[near], np.moveaxis(s.axis[:, near], -1, 0), depth)
    return replace(
        s,
        interface=depth,
        axis_z=np.insert(s.axis_z, first, depth),
        axis=np.insert(s.axis, first, stress, axis=1),
        axis_peeq=np.insert(s.axis_peeq, first, s.axis_peeq[first]),
    )


def on_face(part: Stresses, depth: float) -> Array:
    """(4, n) stresses at a face, from the elements next to it that have not yielded."""
    distance = np.abs(part.z.mean(axis=1) - depth)
    nearest = distance < distance.min() * (1.0 + 1e-6)
    row = nearest & ~(part.peeq > 0.0).any(axis=1)
    if not row.any():
        return np.zeros((4, 1))
    order = np.lexsort((np.abs(part.z[row][0] - depth), np.round(part.r[row][0] / part.r[row][0].max(), 9)))
    z, s = part.z[row][:, order], part.stress[:, row][:, :, order]
    near, far = (slice(k, None, 2) for k in (0, 1))
    return continued((z[:, near], z[:, far]), (s[..., near], s[..., far]), depth).reshape(4, -1)


def on_axis(r: Array, z: Array, gauss: Array) -> tuple[Array, Array]:
    """Depths and values (k, n) at r = 0 of k fields (k, n_elements, 4), from the two columns of Gauss
    points next to it.

    Fields even in r: s(0) = (s1 r2^2 - s2 r1^2) / (r2^2 - r1^2). The shear stress is odd, and zero on the
    axis.
    """
    radii = np.unique(np.round(r / r.min(), 9))[:2] * r.min()
    columns = []
    for radius in radii:
        at = np.isclose(r, radius, rtol=1e-6, atol=0.0)
        order = np.argsort(z[at])
        columns.append((z[at][order], gauss[:, at][:, order]))
    (depth, first), (_, second) = columns
    r1, r2 = radii**2
    return depth, (first * r2 - second * r1) / (r2 - r1)
