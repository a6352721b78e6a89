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
    """Whether places at these distances from the start are steady; radius: of the contact along x."""
    return (way >= RUN_IN * radius) & (way <= length - RUN_OUT * radius)


def passes_to_steady(strains: Sequence[float]) -> int | None:
    """The first pass with a new strain below a share of the first one, from 1; None if none is."""
    return next((k for k, strain in enumerate(strains, start=1) if strain < STEADY * strains[0]), None)


@dataclass(frozen=True)
class Groove:
    """Lengths in m, not a number without a steady part: depth, mean over that; deepest and where;
    middle; shoulders at_start, at_end, beside; transient: before the depth is within 2 %.
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
        """Of u_z (n,) in m at ascending distances; peak: place and value of the largest."""
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
