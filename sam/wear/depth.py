# SPDX-License-Identifier: MIT
"""How deep each column of cells is removed: from the surface down as far as the plastic strain is above its
limit.

Nelias, Boucly & Brunet 2006; Bosman & Schipper 2011, section 5: a crack runs along the border of the volume
that both reaches the surface and is strained beyond the limit; what it encloses becomes a wear particle in
the cycle that strained it. What is above the limit under a sound roof does not reach the surface: it stays,
and is counted.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from sam.arrays import Array, Mask
from sam.scene import Wear

UNREACHED = 1e300  # a strain, in place of inf: differences stay numbers


@dataclass(frozen=True)
class StrainLimits:
    """Accumulated plastic strain beyond which material is removed: `layer` at depths z < thickness (m),
    `bulk` below; inf: nothing is.
    """

    bulk: float
    layer: float
    thickness: float

    def __call__(self, z: Array) -> Array:
        """The limit at depths z in m."""
        return np.where(np.asarray(z) < self.thickness, self.layer, self.bulk)


def limit_by_depth(wear: Wear, layer_thickness: float | None) -> StrainLimits:
    """The limits of a scene. layer_thickness in m: of its plasticity; only a limit of the layer makes use of
    it.
    """
    if wear.strain_limit_layer is None or layer_thickness is None:
        return StrainLimits(wear.strain_limit, wear.strain_limit, 0.0)
    return StrainLimits(wear.strain_limit, wear.strain_limit_layer, layer_thickness)


class Worn(NamedTuple):
    """What is removed of each column before smoothing, all (nx, ny).

    depth: in m, from the surface; roofed: thickness in m of what is above its limit further down, under a
    sound roof; at_bottom: all layers are removed, so the true depth may be larger.
    """

    depth: Array
    roofed: Array
    at_bottom: Mask


def worn_depth(alpha: Array, faces: Array, limits: StrainLimits, interpolate: bool) -> Worn:
    """What is removed: all above its limit. alpha: accumulated plastic strain (n_layers, nx, ny), mean of
    each cell; faces: (n_layers + 1,) in m from the current surface, 0, downwards.

    interpolate: the strain is linear between the centres of the layers. At the surface it is extrapolated
    from the two uppermost ones, never below 0 (a single layer: constant); from the lowest centre to the
    deepest face it is constant. The depth is the first crossing with the limit, which steps where the layer
    ends: a crossing at the step is found exactly. Error O(dz^2). Without, whole layers are removed whose mean
    is above the limit at their centre: error O(dz). Raises ValueError for faces that do not fit the layers or
    do not descend from 0, and for alpha that is not finite.
    """
    faces = _checked(alpha, faces)
    centres = (faces[:-1] + faces[1:]) / 2
    if interpolate:
        nodes, strain = _profile(alpha, faces, centres)
        if 0 < limits.thickness < faces[-1]:
            nodes, strain = _with_node(nodes, strain, limits.thickness)
        limit = _finite(limits((nodes[:-1] + nodes[1:]) / 2))
        start, end, lengths = strain[:-1] - limit, strain[1:] - limit, np.diff(nodes)
    else:
        start = end = alpha - _finite(limits(centres))
        lengths = np.diff(faces)
    return _from_surface(start, end, lengths)


def _checked(alpha: Array, faces: Array) -> Array:
    faces = np.asarray(faces, dtype=float)
    if faces.shape != (len(alpha) + 1,) or faces[0] != 0 or not np.all(np.diff(faces) > 0):
        raise ValueError(f"faces = {faces.tolist()}: {len(alpha) + 1} depths, ascending from 0, are needed")
    if not np.isfinite(alpha).all():
        raise ValueError("alpha: all of it must be finite")
    return faces


def _finite(limit: Array) -> Array:
    """The limit of each layer, with one that no strain reaches in place of inf, so that differences are
    numbers.
    """
    finite: Array = np.minimum(limit, UNREACHED)[:, None, None]
    return finite


def _profile(alpha: Array, faces: Array, centres: Array) -> tuple[Array, Array]:
    """Depths between which alpha is linear, and alpha there: at the surface, all centres and the deepest
    face.
    """
    surface = alpha[0]
    if len(alpha) > 1:
        surface = np.maximum(alpha[0] - (alpha[1] - alpha[0]) * (centres[0] / (centres[1] - centres[0])), 0.0)
    return np.concatenate([[0.0], centres, faces[-1:]]), np.concatenate([surface[None], alpha, alpha[-1:]])


def _with_node(nodes: Array, values: Array, depth: float) -> tuple[Array, Array]:
    """The same linear profile with one more node."""
    k = int(np.searchsorted(nodes, depth))
    if nodes[k] == depth:
        return nodes, values
    share = (depth - nodes[k - 1]) / (nodes[k] - nodes[k - 1])
    there = values[k - 1] + share * (values[k] - values[k - 1])
    return np.insert(nodes, k, depth), np.insert(values, k, there, axis=0)


def _from_surface(start: Array, end: Array, lengths: Array) -> Worn:
    """Columns of segments (n, nx, ny) in which the excess over the limit is linear, from `start` to `end`; it
    may jump from one segment to the next. An excess of exactly 0 removes nothing; one that only touches 0 at
    an end goes on.
    """
    open_top, full = start > 0, (start > 0) & (end >= 0)
    crossing = (open_top != (end > 0)) & ~full
    share = np.divide(np.maximum(start, end), np.abs(start - end), out=full.astype(float), where=crossing)
    above = share * lengths[:, None, None]  # of each segment; it holds on to the end that is above
    reached = np.ones_like(full)
    np.logical_and.accumulate(full[:-1], axis=0, out=reached[1:])
    removed = np.where(reached & open_top, above, 0.0)
    return Worn(removed.sum(axis=0), (above - removed).sum(axis=0), np.asarray(full.all(axis=0)))
