# SPDX-License-Identifier: MIT
"""The groove that a pass leaves: its depth, its deepest place, and the shoulders around it."""

from __future__ import annotations

from dataclasses import dataclass
from math import nan

import numpy as np

from sam.arrays import Array, Mask
from sam.results.peaks import refined_peak

WITHIN = 0.02  # of the steady depth, after which the groove counts as steady


@dataclass(frozen=True)
class Groove:
    """Lengths in m; not a number where a path is too short for a steady part.

    depth: mean over the steady part; deepest, deepest_at: largest depth along the path, and its distance from
    the start; middle: depth in the middle of the steady part; at_start, at_end, beside: heights of the
    shoulders before the start, behind the end and beside the middle; transient: distance from the start after
    which the depth stays within 2 % of the steady one.
    """

    depth: float
    deepest: float
    deepest_at: float
    middle: float
    at_start: float
    at_end: float
    beside: float
    transient: float

    @classmethod
    def of(cls, way: Array, uz: Array, steady: Mask, length: float, *, across: Array) -> Groove:
        """Of u_z (n,) in m at distances from the start (n,), ascending; across: u_z beside the middle."""
        depth, middle, transient = nan, nan, nan
        at, deepest = refined_peak(way, uz)
        if steady.any():
            depth = float(uz[steady].mean())
            places = np.flatnonzero(steady)
            middle = float(np.interp((way[places[0]] + way[places[-1]]) / 2, way, uz))
            if depth > 0:
                transient = _transient(way[: places[-1] + 1], uz[: places[-1] + 1], depth)
        shoulders = (-uz[way < 0], -uz[way > length], -across)
        start, end, side = (float(max(part.max(initial=0.0), 0.0)) for part in shoulders)
        return cls(depth, deepest, at, middle, start, end, side, transient)


def _transient(way: Array, uz: Array, depth: float) -> float:
    """The distance after which u_z stays within WITHIN of the depth, interpolated between the cells."""
    off = np.abs(uz / depth - 1) - WITHIN
    outside = np.flatnonzero(off > 0)
    if not outside.size:
        return 0.0
    k = int(outside[-1])
    if k + 1 == len(way):
        return nan
    share = off[k] / (off[k] - off[k + 1])
    return float(way[k] + share * (way[k + 1] - way[k]))
