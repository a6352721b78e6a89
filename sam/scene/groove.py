# SPDX-License-Identifier: MIT
"""The groove that a pass leaves: its depth, its deepest place, the shoulders around it, and which part of it
counts as steady.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import nan

import numpy as np

from sam.arrays import Array, Mask

RUN_IN, RUN_OUT = 3.0, 1.5
"""Contact radii after the start and before the end of a path that do not count as steady: at p0 = 4 yield
stresses the groove is within 1 % after 2.7 radii of Swift steel, 3 of linear hardening; the body ahead of the
contact is still raised 1.5 radii before its end.
"""
STEADY = 0.01  # of the largest new strain of the first pass, below which a pass adds nothing
WITHIN = 0.02  # of the steady depth, after which the groove counts as steady


def steady_part(way: Array, radius: float, length: float) -> Mask:
    """Whether places at these distances from the start lie in the steady part of a path; radius: of the
    contact along x.
    """
    return (way >= RUN_IN * radius) & (way <= length - RUN_OUT * radius)


def passes_to_steady(strains: Sequence[float]) -> int | None:
    """The first pass, counted from 1, whose largest new strain is below a share of that of the first one;
    None if none is.
    """
    return next((k for k, strain in enumerate(strains, start=1) if strain < STEADY * strains[0]), None)


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
    def of(
        cls, way: Array, uz: Array, steady: Mask, length: float, *, across: Array, peak: tuple[float, float]
    ) -> Groove:
        """Of u_z (n,) in m at distances from the start (n,), ascending; across: u_z beside the middle; peak:
        place and value of the largest u_z, between the given ones too.
        """
        depth, middle, transient = nan, nan, nan
        at, deepest = peak
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
