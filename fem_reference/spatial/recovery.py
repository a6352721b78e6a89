# SPDX-License-Identifier: MIT
"""Stresses of a block where they are reported: in the elements, in the plane y = 0, on the axis. SI units."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from fem_reference.common import recovery as common
from fem_reference.common.arrays import Array, Integers
from fem_reference.common.bodies import EVEN
from fem_reference.common.contact import Equilibrium
from fem_reference.common.recovery import Peak, continued, over_depth, parabola_peak, plastic_fields
from fem_reference.spatial.model import Model
from sam.scene.section import stated
from sam.scene.yield_curve import Kinks

ODD_IN_Y = [3, 5]
"""Components yz and xy, zero in the plane of symmetry."""
MIDPOINT = np.array([-1.0, 9.0, 9.0, -1.0]) / 16.0
"""Cubic interpolation half-way between the inner two of four equidistant points."""
FIELDS = ("stress", "peeq", "plane", "plane_peeq", "axis", "axis_peeq")
"""Fields of stresses whose last axis is that of the depths."""
LEVELS = 3
"""Layers of elements next to a face from which a stress there is read; a coating may have two only."""


@dataclass(frozen=True)
class Stresses(common.Stresses):
    """Means of the elements, the values at their centres up to second order.

    x (nx,), y (ny,), z (nz,): centres in m; stress: (6, nx, ny, nz) in Pa, order xx yy zz yz xz xy; peeq:
    (nx, ny, nz); plastic_strain: as stress, tensor components, None for an elastic body; plane, plane_peeq:
    (6, nx, nz), (nx, nz), at y = 0; axis, axis_peeq: (6, nz), (nz,), at x = y = 0; coating_layers,
    interface: how many of the first layers of elements are a coating, and the depth of its lower face in m;
    kinks: as in fem_reference.axisymmetric.recovery.
    """

    x: Array
    y: Array
    z: Array
    stress: Array
    peeq: Array
    plane: Array
    plane_peeq: Array
    axis: Array
    axis_peeq: Array
    plastic_strain: Array | None = None
    coating_layers: int | None = None
    interface: float | None = None
    kinks: Kinks = EVEN

    @property
    def even(self) -> tuple[Array, Array]:
        """Stress and accumulated plastic strain in the plane y = 0."""
        return self.plane, self.plane_peeq

    def layer(self, coating: bool) -> Stresses:
        """The part above the interface, or below: the elements, without the faces."""
        k = slice(None, self.coating_layers) if coating else slice(self.coating_layers, None)
        fields: dict[str, Any] = {name: getattr(self, name)[..., k] for name in FIELDS}
        return Stresses(self.x, self.y, self.z[k], **fields, kinks=self.kinks)

    def largest_in_layer(self, coating: bool) -> Peak:
        """Largest von Mises stress in Pa of the coating or below it, with its faces, and depth in m."""
        part, interface = self.layer(coating), stated(self.interface)
        if not part.peeq.any():
            for depth in (0.0, interface) if coating else (interface,):
                part = with_face(part, depth)
        return part.largest_mises()

    def largest(self, field: Array, even: Array) -> Peak:
        """Largest value over elements (nx, ny, nz) and the plane y = 0 (nx, nz), and its depth in m (None if
        all are zero).

        In the plane it is refined by parabolas through the largest value and its neighbours along z and x.
        Without a coating it is that of the first layer of elements next to the surface, and at a kink of the
        yield stress that of the element above or below.
        """
        i, k = np.unravel_index(np.argmax(even), even.shape)
        peak = even[i, k]
        if field.max() > peak:
            return float(field.max()), float(self.z[np.unravel_index(np.argmax(field), field.shape)[2]])
        if peak == 0.0:
            return 0.0, None
        value, depth = over_depth(self.z, even[i], int(k), self.kinks)
        if 0 < i < self.x.size - 1:
            value += parabola_peak(self.x[i - 1 : i + 2], even[i - 1 : i + 2, k])[0] - float(peak)
        return value, depth


def stresses(model: Model, state: Equilibrium) -> Stresses:
    """Stresses of a load step."""
    unit, lines = model.scales, model.lines

    def means(field: Array) -> Array:
        return field.mean(axis=-1)[..., model.elements]

    stress = means(model.stress(state)) * unit.pressure
    peeq, tensor = plastic_fields(state.history, stress, unit.strain, means)
    plane = at_zero(stress, lines.y, 2)
    if lines.half:
        plane[ODD_IN_Y] = 0.0
    # an interpolating cubic can fall below zero at the edge of the plastic zone
    plane_peeq = np.maximum(at_zero(peeq, lines.y, 1), 0.0)
    layers = model.plan.coating_layers
    x, y, z = (0.5 * (line[1:] + line[:-1]) * unit.length for line in (lines.x, lines.y, lines.z))
    return Stresses(
        x,
        y,
        z,
        stress=stress,
        peeq=peeq,
        plane=plane,
        plane_peeq=plane_peeq,
        axis=at_zero(plane, lines.x, 1),
        axis_peeq=np.maximum(at_zero(plane_peeq, lines.x, 0), 0.0),
        plastic_strain=tensor,
        coating_layers=layers,
        interface=None if layers is None else float(lines.z[layers]) * unit.length,
        kinks=model.plan.bodies.kinks if state.yielded else EVEN,
    )


def with_face(part: Stresses, depth: float) -> Stresses:
    """A layer completed by one of its faces, at `depth` in m above or below its elements: a level more in
    every field.

    The stress there is that of the polynomial through the nearest LEVELS elements of the layer, second
    order in their size, and never that of another material. Of a layer that has yielded anywhere it is that
    of the elements next to the face, as beyond them the yield stress would be passed; so is the plastic
    strain.
    """
    nearest = np.argsort(np.abs(part.z - depth))[:LEVELS]
    used, place = (nearest[:1] if part.peeq.any() else nearest), 0 if depth < part.z[0] else part.z.size

    def complete(field: Array, levels: Integers) -> Array:
        face = continued(part.z[levels], np.moveaxis(field[..., levels], -1, 0), depth)
        return np.insert(field, place, face, axis=-1)

    levels = {name: nearest[:1] if "peeq" in name else used for name in FIELDS}
    fields: dict[str, Any] = {name: complete(getattr(part, name), n) for name, n in levels.items()}
    return replace(part, z=np.insert(part.z, place, depth), **fields)


def with_interface(s: Stresses) -> list[Stresses]:
    """The layers from above: of a coated body its coating, and the rest with its upper face."""
    return [s] if s.interface is None else [s.layer(True), with_face(s.layer(False), s.interface)]


def at_zero(values: Array, line: Array, axis: int) -> Array:
    """Elements between the planes of `line`, interpolated to its zero; even where it begins there."""
    zero = int(np.searchsorted(line, 0.0))
    if line[zero] > 0.0:
        return np.take(values, zero - 1, axis=axis)
    places = [zero - 2, zero - 1, zero, zero + 1] if zero else [1, 0, 0, 1]
    return np.moveaxis(np.take(values, places, axis=axis), axis, -1) @ MIDPOINT
