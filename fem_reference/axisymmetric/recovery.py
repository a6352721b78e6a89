# SPDX-License-Identifier: MIT
"""Stresses of the body where they are reported: at the Gauss points, on the axis, in the elements. SI units."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from fem_reference.axisymmetric.model import EVEN, Model
from fem_reference.common.contact import Equilibrium
from fem_reference.common.elasticity import mises
from sam.scene.yield_curve import DepthProfile


@dataclass(frozen=True)
class Stresses:
    """Stress of the body in Pa, components (rr, tt, zz, rz), tension positive, and its plastic strain.

    r, z: (n_elements, 4) Gauss points in m; gauss: (4, n_elements, 4); axis_z: (n_axis,) in m, ascending; axis:
    (4, n_axis); peeq, axis_peeq: accumulated plastic strain at the same points; plastic_strain: as gauss, tensor
    components; None for an elastic body; interface: depth of a film's lower face in m. The axis has a point there, with the
    values below it; those above are of the film alone. profile: of the yield stress of a body that has yielded; at its rows
    fields over depth have kinks.
    """

    r: np.ndarray
    z: np.ndarray
    gauss: np.ndarray
    axis_z: np.ndarray
    axis: np.ndarray
    peeq: np.ndarray
    axis_peeq: np.ndarray
    plastic_strain: np.ndarray | None = None
    interface: float | None = None
    profile: DepthProfile = EVEN

    def in_elements(self, gauss: np.ndarray) -> np.ndarray:
        """Mean (..., n_elements) over the Gauss points of each element, weighted by ring volume (rectangles: by r)."""
        return (gauss * self.r).sum(axis=-1) / self.r.sum(axis=-1)

    def layer(self, film: bool) -> Stresses:
        """The part above the interface, or from it downwards."""
        elements = (self.z.mean(axis=1) < self.interface) == film
        axis = (self.axis_z < self.interface) == film
        return Stresses(
            self.r[elements],
            self.z[elements],
            self.gauss[:, elements],
            self.axis_z[axis],
            self.axis[:, axis],
            self.peeq[elements],
            self.axis_peeq[axis],
            profile=self.profile,
        )


def stresses(model: Model, state: Equilibrium) -> Stresses:
    """Stresses of a load step; never averaged over elements."""
    unit, history = model.scales, state.history
    strain = unit.displacement / unit.length
    r, z = model.body.points * unit.length
    plastic, peeq = (
        (0.0, np.zeros(r.shape)) if history is None else (history.plastic_strain, history.peeq * strain)
    )
    gauss = model.body.stress(model.problem.body(state.u, 0), plastic) * unit.pressure
    axis_z, axis = on_axis(r, z, gauss)
    axis[:2] = 0.5 * (axis[0] + axis[1])
    axis[3] = 0.0
    # an even parabola can fall below zero at the edge of the plastic zone
    axis_peeq = np.maximum(on_axis(r, z, peeq[None])[1][0], 0.0)
    tensor = None if history is None else plastic * strain * np.array([1.0, 1.0, 1.0, 0.5])[:, None, None]
    profile = model.profile if state.yielded else EVEN
    s = Stresses(r, z, gauss, axis_z, axis, peeq, axis_peeq, tensor, profile=profile)
    return s if model.interface is None else with_interface(s, model.interface * unit.length)


def with_interface(s: Stresses, depth: float) -> Stresses:
    """With the interface, and the axis completed by a point there: on the line through the two next below.

    Of a point that has yielded the values themselves, as beyond them the yield stress would be passed.
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


def on_face(part: Stresses, depth: float) -> np.ndarray:
    """(4, n) stresses at `depth`, a face of the part, extrapolated in the elements next to it that have not yielded."""
    distance = np.abs(part.z.mean(axis=1) - depth)
    nearest = distance < distance.min() * (1.0 + 1e-6)
    row = nearest & ~(part.peeq > 0.0).any(axis=1)
    if not row.any():
        return np.zeros((4, 1))
    order = np.lexsort((np.abs(part.z[row][0] - depth), np.round(part.r[row][0] / part.r[row][0].max(), 9)))
    z, s = part.z[row][:, order], part.gauss[:, row][:, :, order]
    near, far = (slice(k, None, 2) for k in (0, 1))
    return continued((z[:, near], z[:, far]), (s[..., near], s[..., far]), depth).reshape(4, -1)


def continued(z: Sequence[np.ndarray], values: Sequence[np.ndarray], depth: float) -> np.ndarray:
    """At `depth` the polynomial over depth through `values` at the depths z, both (k,), each a number or an array.

    How a stress is read at a face of a layer, from the points of that layer alone: linear for k = 2, quadratic for k = 3.
    """
    total = 0.0
    for i, (own, value) in enumerate(zip(z, values, strict=True)):
        others = [other for j, other in enumerate(z) if j != i]
        total = total + value * np.prod([(depth - other) / (own - other) for other in others], axis=0)
    return total


def largest_in_layer(s: Stresses, film: bool) -> tuple[float, float | None]:
    """Largest von Mises stress in Pa of the film or below it, its faces included, and its depth in m, as `largest_mises`."""
    part = s.layer(film)
    peaks = [largest_mises(part)]
    if film and part.peeq.any():
        return peaks[0]
    for depth in (0.0, s.interface) if film else (s.interface,):
        peaks.append((float(mises(on_face(part, depth)).max()), depth))
    return max(peaks, key=lambda peak: peak[0])


def on_axis(r: np.ndarray, z: np.ndarray, gauss: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Depths and values (k, n) at r = 0 of k fields (k, n_elements, 4), from the two columns of Gauss points next to it.

    Fields even in r: s(0) = (s1 r2^2 - s2 r1^2) / (r2^2 - r1^2). The shear stress is odd, and zero on the axis.
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


def largest_mises(s: Stresses) -> tuple[float, float | None]:
    """Largest von Mises stress in Pa and its depth in m, see `largest`; never across an interface.

    Where it has yielded it is that of the Gauss points: beyond them the yield stress would be passed.
    """
    if s.interface is not None:
        return max((largest_in_layer(s, film) for film in (True, False)), key=lambda peak: peak[0])
    q = mises(s.gauss)
    if s.peeq.flat[q.argmax()] > 0.0:
        return float(q.max()), float(s.z.flat[q.argmax()])
    return largest(s, q, mises(s.axis))


def largest_peeq(s: Stresses) -> tuple[float, float | None]:
    """Largest accumulated plastic strain and its depth in m, as `largest_mises`."""
    parts = [s] if s.interface is None else [s.layer(film) for film in (True, False)]
    return max((largest(part, part.peeq, part.axis_peeq) for part in parts), key=lambda peak: peak[0])


def largest(s: Stresses, gauss: np.ndarray, axis: np.ndarray) -> tuple[float, float | None]:
    """Largest value over Gauss points (n_elements, 4) and axis (n_axis,), and its depth in m (None if all are zero).

    On the axis, value and depth are those of the parabola through the largest value and its neighbours; not across a row of
    the profile, where a soft layer strains most: it would overshoot.
    """
    i = int(np.argmax(axis))
    if gauss.max() > axis[i]:
        return float(gauss.max()), float(s.z.ravel()[np.argmax(gauss)])
    if axis[i] == 0.0:
        return 0.0, None
    if not 0 < i < axis.size - 1 or np.ptp(s.profile.interval(s.axis_z[i - 1 : i + 2])):
        return float(axis[i]), float(s.axis_z[i])
    return parabola_peak(s.axis_z[i - 1 : i + 2], axis[i - 1 : i + 2])


def parabola_peak(x: np.ndarray, y: np.ndarray) -> tuple[float, float]:
    """(value, place) of the top of the parabola through three points, the middle one the largest; Newton's form."""
    slope = np.diff(y) / np.diff(x)
    curvature = (slope[1] - slope[0]) / (x[2] - x[0])
    if curvature == 0.0:
        return float(y[1]), float(x[1])
    place = 0.5 * (x[0] + x[1] - slope[0] / curvature)
    value = y[0] + slope[0] * (place - x[0]) + curvature * (place - x[0]) * (place - x[1])
    return float(value), float(place)
