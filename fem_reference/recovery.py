# SPDX-License-Identifier: MIT
"""Stresses of the body where they are reported: at the Gauss points, on the axis, in the elements. SI units."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fem_reference.contact import Equilibrium
from fem_reference.elasticity import mises
from fem_reference.model import Model


@dataclass(frozen=True)
class Stresses:
    """Stress of the body in Pa, components (rr, tt, zz, rz), tension positive.

    r, z: (n_elements, 4) Gauss points in m; gauss: (4, n_elements, 4); axis_z: (n_axis,) in m, ascending;
    axis: (4, n_axis).
    """

    r: np.ndarray
    z: np.ndarray
    gauss: np.ndarray
    axis_z: np.ndarray
    axis: np.ndarray

    @property
    def elements(self) -> np.ndarray:
        """(4, n_elements) mean over the Gauss points of each element, weighted by ring volume (rectangles: by r)."""
        return (self.gauss * self.r).sum(axis=-1) / self.r.sum(axis=-1)


def stresses(model: Model, state: Equilibrium) -> Stresses:
    """Stresses of a load step; never averaged over elements."""
    r, z = model.body.points * model.scales.length
    gauss = model.body.stress(model.problem.body(state.u, 0)) * model.scales.pressure
    axis_z, axis = on_axis(r, z, gauss)
    return Stresses(r, z, gauss, axis_z, axis)


def on_axis(r: np.ndarray, z: np.ndarray, gauss: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Stress (4, n) at r = 0 and its depths, from the two columns of Gauss points next to the axis.

    rr, tt, zz are even in r: s(0) = (s1 r2^2 - s2 r1^2) / (r2^2 - r1^2); rr = tt and rz = 0 on the axis.
    """
    radii = np.unique(np.round(r / r.min(), 9))[:2] * r.min()
    columns = []
    for radius in radii:
        at = np.isclose(r, radius, rtol=1e-6, atol=0.0)
        order = np.argsort(z[at])
        columns.append((z[at][order], gauss[:, at][:, order]))
    (depth, first), (_, second) = columns
    r1, r2 = radii**2
    axis = (first * r2 - second * r1) / (r2 - r1)
    axis[:2] = 0.5 * (axis[0] + axis[1])
    axis[3] = 0.0
    return depth, axis


def largest_mises(s: Stresses) -> tuple[float, float | None]:
    """Largest von Mises stress in Pa over Gauss points and axis, and its depth in m (None without stress).

    On the axis, value and depth are those of the parabola through the largest value and its neighbours.
    """
    gauss, axis = mises(s.gauss), mises(s.axis)
    i = int(np.argmax(axis))
    if gauss.max() > axis[i]:
        return float(gauss.max()), float(s.z.ravel()[np.argmax(gauss)])
    if axis[i] == 0.0:
        return 0.0, None
    if not 0 < i < axis.size - 1:
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
