# SPDX-License-Identifier: MIT
"""Nodal forces of prescribed pressures on the surface of a block, and the area of a contact between its
nodes.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from fem_reference.common.arrays import Array
from fem_reference.common.hertz import hertz_pressure

PARTS = 8
"""Parts of each edge of an element for the quadrature: total force within 1e-5."""
POINTS = 4
"""Gauss points in each part."""


def hertz_forces(x: Array, y: Array, centre: tuple[float, float]) -> Array:
    """(nx, ny) consistent nodal forces of 3/(2 pi) sqrt(1 - r^2), the Hertz pressure of unit force and
    radius, at `centre`.

    Integrals of pressure times bilinear shape function on the mesh lines x (nx,), y (ny,).
    """
    (px, hats_x), (py, hats_y) = (_hats(line) for line in (x, y))
    pressure = hertz_pressure(np.hypot(px[:, None] - centre[0], py[None, :] - centre[1]))
    return hats_x @ pressure @ hats_y.T


def _hats(line: Array) -> tuple[Array, Array]:
    """Quadrature points (m,) on a line, and (n, m) linear shape functions there times weights."""
    nodes, weights = np.polynomial.legendre.leggauss(POINTS)
    parts = np.concatenate([np.linspace(a, b, PARTS, endpoint=False) for a, b in pairwise(line)])
    size = np.diff(np.append(parts, line[-1]))
    points = (parts[:, None] + 0.5 * size[:, None] * (nodes + 1.0)).ravel()
    shapes = np.array([np.interp(points, line, unit) for unit in np.eye(line.size)])
    return points, shapes * (0.5 * size[:, None] * weights).ravel()


def contact_area(x: Array, y: Array, pressure: Array, gap: Array, *, half: bool) -> float:
    """Area of a convex contact on the mesh lines x (nx,), y (ny,); pressure, gap: (nx, ny), over E*, zero
    where not.

    The edge is where pressure and gap, interpolated as they meet there, are both zero (`crossing`), on
    every line of the mesh between a node in contact and one outside; the area is that of the polygon
    through these points.
    """
    touching = pressure > 0.0
    if not touching.any():
        return 0.0
    weight = pressure.sum()
    centre = np.array(
        [
            (pressure.sum(axis=1) * x).sum() / weight,
            0.0 if half else (pressure.sum(axis=0) * y).sum() / weight,
        ]
    )
    edge = []
    for axis, (nodes, others) in enumerate(((x, y), (y, x))):
        p, g = (np.moveaxis(field, axis, 0) for field in (pressure, gap))
        inside = p > 0.0
        for first, second in ((0, 1), (1, 0)):  # leaving the contact upwards, downwards
            here, there = slice(first, nodes.size - second), slice(second, nodes.size - first)
            i, j = np.nonzero(inside[here] & ~inside[there])
            start, step = nodes[here][i], nodes[there][i] - nodes[here][i]
            radial = np.stack([start + 0.5 * step, others[j]]) - centre[[axis, 1 - axis]][:, None]
            slant = np.abs(radial[0]) / np.hypot(*radial)
            place = start + step * crossing(p[here][i, j], g[there][i, j], np.abs(step), slant)
            edge.append(np.stack([place, others[j]])[[axis, 1 - axis]])
    points = np.concatenate(edge, axis=1)
    return polygon_area(
        np.concatenate([points, points * [[1.0], [-1.0]]], axis=1) if half else points, centre
    )


def crossing(pressure: Array, gap: Array, length: Array, slant: Array) -> Array:
    """Share of `length`, from a node with pressure > 0 to one with gap > 0, at which a smooth contact ends.

    At the distances s inside and d outside of its edge, p = k sqrt(s) and gap = 4 k/(3 E*) d^(3/2), from
    the plane contact of Hertz (Johnson 1985, Eq. 4.45 and Sec. 4.2c): s + d = slant length gives k; slant:
    cosine between line and normal of the edge. All (n,), pressure and gap with E* = 1. With m = k^(-2/3):
    p^2 m^3 + (3 gap/4)^(2/3) m = slant length.
    """
    cubic, linear, total = pressure**2, np.cbrt(0.75 * gap) ** 2, np.maximum(slant, 1e-3) * length
    m = np.minimum(np.cbrt(total / cubic), total / np.maximum(linear, 1e-300))
    for _ in range(50):  # Newton from above the root of a convex function: monotone
        m = m - (cubic * m**3 + linear * m - total) / (3.0 * cubic * m**2 + linear)
    found: Array = cubic * m**3 / total
    return found


def polygon_area(points: Array, centre: Array) -> float:
    """Area of the polygon through points (2, n), in the order of their angles around the centre (2,)."""
    x, y = points - centre[:, None]
    order = np.argsort(np.arctan2(y, x))
    x, y = x[order], y[order]
    return float(0.5 * np.abs(np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y)))
