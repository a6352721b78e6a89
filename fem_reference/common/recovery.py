# SPDX-License-Identifier: MIT
"""Stresses of a state and their largest values; values between the points of a mesh: polynomials over depth;
a percentile of their values.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from typing import Self

import numpy as np

from fem_reference.common.arrays import Array
from fem_reference.common.elasticity import mises
from fem_reference.common.plasticity import History
from sam.scene.result import EXCEEDING, STRAINED
from sam.scene.yield_curve import Kinks

Peak = tuple[float, float | None]
"""A largest value and its depth in m, None if all are zero."""
REACH = 1.3
"""Nodes up to so many contact radii fix the edge: with 32 elements in it Hertz's is met to 7e-5."""


class Stresses(ABC):
    """Stress of the half-space in Pa, components first, tension positive, and accumulated plastic strain;
    axis, axis_peeq: the same at x = y = 0; interface: depth in m of the lower face of a coating, None without
    one.
    """

    stress: Array
    peeq: Array
    axis: Array
    axis_peeq: Array
    interface: float | None = None

    @property
    def even(self) -> tuple[Array, Array]:
        """Stress and accumulated plastic strain where fields are even, which has values of its own."""
        return self.axis, self.axis_peeq

    @abstractmethod
    def largest(self, field: Array, even: Array) -> Peak:
        """Largest value of a field in the body and where it is even, and its depth in m."""

    def layer(self, _coating: bool) -> Self:
        """The part above the interface, or from it downwards; all of a body without a coating."""
        return self

    def largest_in_layer(self, _coating: bool) -> Peak:
        """Largest von Mises stress in Pa of the coating or below it, with its faces, and depth in m."""
        return self.largest_mises()

    def largest_mises(self) -> Peak:
        """Largest von Mises stress in Pa and its depth in m; of a point that has yielded as it is."""
        if self.interface is not None:
            return max(map(self.largest_in_layer, (True, False)), key=lambda peak: peak[0])
        q, even = mises(self.stress), mises(self.even[0])
        return self.largest(q, np.zeros_like(even) if self.peeq.flat[q.argmax()] > 0.0 else even)

    def largest_peeq(self) -> Peak:
        """Largest accumulated plastic strain and its depth in m, as `largest_mises`."""
        parts = [self] if self.interface is None else [self.layer(coating) for coating in (True, False)]
        return max((part.largest(part.peeq, part.even[1]) for part in parts), key=lambda peak: peak[0])


def continued(z: Sequence[Array] | Array, values: Sequence[Array] | Array, depth: float) -> Array:
    """Value at `depth` of the polynomial over depth through `values` at the depths z, both (k,), each a
    number or an array.

    How a stress is read at a face of a layer, from the points of that layer alone: linear for k = 2,
    quadratic for k = 3.
    """
    total: Array = np.zeros(())
    for i, (place, value) in enumerate(zip(z, values, strict=True)):
        others = [other for j, other in enumerate(z) if j != i]
        total = total + value * np.prod([(depth - other) / (place - other) for other in others], axis=0)
    return total


def plastic_fields(
    history: History | None, stress: Array, unit: float, of: Callable[[Array], Array]
) -> tuple[Array, Array | None]:
    """Accumulated plastic strain, and the plastic strain as a tensor, None of an elastic body, where a stress
    (n, ...) is. unit: of strain; of: from the Gauss points (..., n_elements, n_points) to those places.
    """
    if history is None:
        return np.zeros(stress.shape[1:]), None
    shear = np.repeat([1.0, 0.5], [3, len(stress) - 3]).reshape(-1, *[1] * (stress.ndim - 1))
    return of(history.peeq) * unit, of(history.plastic_strain) * unit * shear


def over_depth(z: Array, values: Array, k: int, kinks: Kinks) -> Peak:
    """Value and depth of the top of the parabola through values (nz,) at z[k] and its neighbours, the largest
    at k; not across a kink of the yield stress, where a soft layer strains most: it would overshoot.
    """
    near = slice(k - 1, k + 2)
    if not 0 < k < z.size - 1 or np.ptp(kinks.interval(z[near])):
        return float(values[k]), float(z[k])
    return parabola_peak(z[near], values[near])


def exceeded_strain(peeq: Array, weights: Array) -> float | None:
    """The plastic strain that a share EXCEEDING of the plastic volume exceeds; None if there is none.

    peeq, weights: (n,), of the Gauss points and their volumes in any unit; linear between the points.
    """
    inside = peeq > STRAINED * peeq.max()
    if not inside.any():
        return None
    order = np.argsort(peeq[inside])
    strain, volume = peeq[inside][order], weights[inside][order]
    below = np.cumsum(volume)
    middles = (below - 0.5 * volume) / below[-1]
    return float(np.interp(1.0 - EXCEEDING, middles, strain))


def parabola_peak(x: Array, y: Array) -> tuple[float, float]:
    """(value, place) of the top of the parabola through three points, the middle the largest."""
    slope = np.diff(y) / np.diff(x)
    curvature = (slope[1] - slope[0]) / (x[2] - x[0])
    if curvature == 0.0:
        return float(y[1]), float(x[1])
    place = 0.5 * (x[0] + x[1] - slope[0] / curvature)
    value = y[0] + slope[0] * (place - x[0]) + curvature * (place - x[0]) * (place - x[1])
    return float(value), float(place)


def edge_radius(r: Array, gap: Array, last: int, reach: float = REACH) -> float:
    """Contact radius from the gap outside, which opens with (r - a)^(3/2) at the edge of any smooth contact.

    Value at zero gap of a parabola r(gap^(2/3)) through the nodes up to `reach` r[last], without the first;
    within one element of the last node in contact. r, gap: (n,) nodes by radius; last: number of the last
    one in contact.
    """
    use = np.flatnonzero(r <= reach * r[last])
    use = np.union1d(use[use > last + 1], np.arange(last + 2, last + 6))  # a contact of one or two elements
    if use[-1] >= r.size:
        return float(r[last])
    opening = np.cbrt(gap[use]) ** 2
    radius = np.polynomial.polynomial.polyfit(opening, r[use], 2)[0]
    return float(np.clip(radius, r[max(last - 2, 0)], r[last + 2]))
