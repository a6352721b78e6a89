# SPDX-License-Identifier: MIT
"""Area of contact spots of any number and shape between the nodes of a surface mesh."""

from __future__ import annotations

import numpy as np
from scipy import ndimage

from fem_reference.common.arrays import Array, Bools

CORNERS = ((0, 0), (1, 0), (1, 1), (0, 1))
"""Corners of a face, in order around it, as steps along x and y."""
CLAMPED = 0.09
"""Elements by which the nodes in contact clamp the surface beyond its edge, on average over where the edge
lies between them.

At the edge of any smooth contact pressure and gap are those of one plane problem, so that it is the same
for all: 0.07 to 0.105 in Hertz contacts of 2.6 to 6 elements in the radius, with the apex off the nodes.
"""


def area_of_spots(x: Array, y: Array, pressure: Array, gap: Array, *, clamped: float = CLAMPED) -> float:
    """Area of all spots of contact, on the mesh lines x (nx,), y (ny,); pressure, gap: (nx, ny), over E*,
    not negative.

    On each line of the mesh between a node with pressure > 0 and one without the edge is where both,
    interpolated as they meet there, are zero (`crossing`); in each face the area is that of the polygon of
    the nodes in contact and these points, less a strip of `clamped` elements along the edge.
    """
    inside = pressure > 0.0
    if not inside.any():
        return 0.0
    along_x = edges(x, pressure, gap, inside)
    along_y = edges(y, pressure.T, gap.T, inside.T).T
    total, (nx, ny) = 0.0, inside.shape
    for i, j in np.argwhere(sum(inside[k : nx - 1 + k, m : ny - 1 + m] for k, m in CORNERS)):
        here, there = slice(i, i + 2), slice(j, j + 2)
        area, length = face(x[here], y[there], inside[here, there], (along_x[i, there], along_y[here, j]))
        total += area - clamped * length * np.sqrt((x[i + 1] - x[i]) * (y[j + 1] - y[j]))
    return max(float(total), 0.0)  # spots of one node are smaller than the strip


def edges(line: Array, pressure: Array, gap: Array, inside: Bools) -> Array:
    """(n - 1, m) places on `line` (n,) where contact ends along the first axis, else NaN."""
    places = np.full((line.size - 1, pressure.shape[1]), np.nan)
    # cosine between the first axis and the normal of the edge, from the smoothed contact
    along, across = np.gradient(ndimage.uniform_filter(inside.astype(float), size=3, mode="nearest"))
    length = np.hypot(along, across)
    slant = np.divide(np.abs(along), length, out=np.ones_like(along), where=length > 0.0)
    for first, second in ((0, 1), (1, 0)):  # in contact before the edge, after it
        here, there = slice(first, line.size - second), slice(second, line.size - first)
        i, j = np.nonzero(inside[here] & ~inside[there])
        start, step = line[here][i], line[there][i] - line[here][i]
        cosine = 0.5 * (slant[here][i, j] + slant[there][i, j])
        places[i, j] = start + step * crossing(pressure[here][i, j], gap[there][i, j], np.abs(step), cosine)
    return places


def face(x: Array, y: Array, inside: Bools, along: tuple[Array, Array]) -> tuple[float, float]:
    """Area in contact of one face and length of its edge; along: where this crosses the sides (2,)."""
    along_x, along_y = along
    crossings = ((along_x[0], y[0]), (x[1], along_y[1]), (along_x[1], y[1]), (x[0], along_y[0]))
    points, leaves = [], []
    for (i, j), place in zip(CORNERS, crossings, strict=True):
        if inside[i, j]:
            points.append((x[i], y[j]))
            leaves.append(False)
        if not np.isnan(place).any():
            points.append(place)
            leaves.append(inside[i, j])  # from here the edge goes on to the next point
    p = np.array(points)
    q = np.roll(p, -1, axis=0)
    area = 0.5 * abs(float(p[:, 0] @ q[:, 1] - p[:, 1] @ q[:, 0]))
    return area, float(np.hypot(*(q - p)[np.array(leaves)].T).sum())


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
    return cubic * m**3 / total
