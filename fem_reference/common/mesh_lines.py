# SPDX-License-Identifier: MIT
"""Graded lines of tensor meshes; lengths in contact radii, of a rough body in half sides of the patch."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from fem_reference.common.arrays import Array

GROWTH = 1.25
"""Ratio of elements beyond the uniform part; 1.1 changes plastic scalars by up to 1e-4."""
CLOSEST = 8.0
"""Depths at which the material changes that are nearer than an element over this are one."""


def grow(start: float, stop: float, size: float, growth: float = GROWTH) -> Array:
    """Points after `start` up to `stop`, intervals growing geometrically from about `size`.

    Their ratio is `growth`, their number the smallest that reaches, and all are scaled to end at `stop`
    exactly.
    """
    reached = np.log1p((stop - start) / size * (growth - 1.0)) / np.log(growth)
    count = max(1, int(np.ceil(round(reached, 9))))
    steps = growth ** np.arange(1, count + 1)
    return start + (stop - start) * np.cumsum(steps) / np.sum(steps)


def uniform_then_growing(
    size: float, core: float, box: float, *, growth: float = GROWTH, marks: Sequence[float] | Array = ()
) -> Array:
    """Lines from 0: intervals of `size` to `core` or just beyond, then growing to `box`.

    marks: ascending; those inside the core are lines too, with equal intervals of at most `size` between
    them; of marks that are nearer than size/CLOSEST the first is a line.
    """
    above = [0.0]
    for mark in marks:
        if above[-1] + size / CLOSEST <= mark < core:
            count = int(np.ceil(round((mark - above[-1]) / size, 9)))
            above.extend(np.linspace(above[-1], mark, count + 1)[1:])
    uniform = above[-1] + size * np.arange(int(np.ceil(round((core - above[-1]) / size, 9))) + 1)
    uniform = np.concatenate([above[:-1], uniform])
    if uniform[-1] >= box:
        raise ValueError(f"box = {box:g}: the uniform part of the mesh alone reaches {uniform[-1]:g}")
    return np.concatenate([uniform, grow(uniform[-1], box, size, growth)])


def two_sided(low: float, high: float, size: float, box: float, *, growth: float = GROWTH) -> Array:
    """Lines uniform from low <= 0 to high >= 0, with 0, then growing over `box` on both sides."""
    below, above = (int(np.ceil(round(reach / size, 9))) for reach in (-low, high))
    return widened(size * np.arange(-below, above + 1, dtype=float), size, box, growth)


def widened(core: Array, size: float, box: float, growth: float) -> Array:
    """Equidistant lines continued by growing ones over `box` beyond both ends."""
    outside = grow(0.0, box, size, growth)
    return np.concatenate([core[0] - outside[::-1], core, core[-1] + outside])


@dataclass(frozen=True)
class Lines:
    """Coordinates of the planes of a block, ascending; z from 0. half: the block ends at the plane y = 0."""

    x: Array
    y: Array
    z: Array
    half: bool

    @property
    def shape(self) -> tuple[int, int, int]:
        """Numbers of elements."""
        return self.x.size - 1, self.y.size - 1, self.z.size - 1

    @property
    def share(self) -> float:
        """Modelled part of every force."""
        return 0.5 if self.half else 1.0

    @cached_property
    def areas(self) -> Array:
        """(nx + 1, ny + 1) integrals of the surface shape functions."""
        x, y = (0.5 * (np.diff(a, prepend=a[0]) + np.diff(a, append=a[-1])) for a in (self.x, self.y))
        return np.outer(x, y)


@dataclass(frozen=True)
class Sizes:
    """Largest size of an element at a distance: `fine` to the first limit, then `coarse`."""

    fine: float
    coarse: float
    limits: tuple[float, float]

    def __call__(self, distance: float) -> float:
        """Return the largest size at a distance."""
        fine, coarse = self.limits
        if distance < fine:
            return self.fine
        return self.coarse if distance < coarse else np.inf


def marched(
    start: float, stop: float, first: float, sizes: Callable[[float], float], *, growth: float = GROWTH
) -> Array:
    """Points after `start` to `stop`: from `first` on growing as `sizes` allows, then scaled."""
    places, size = [start], min(first, sizes(start))
    while places[-1] < stop:
        places.append(places[-1] + size)
        size = min(growth * size, sizes(places[-1]))
    steps = np.array(places[1:]) - start
    scaled: Array = start + steps * (stop - start) / steps[-1]
    scaled[-1] = stop  # to the last digit: materials change there
    return scaled


def coated_depths(thickness: float, box: float, sizes: Sizes, *, growth: float = GROWTH) -> Array:
    """z lines to `box`, one at the interface, two elements or more above it, growing below."""
    coating = marched(0.0, thickness, min(sizes.fine, thickness / 2.0), sizes, growth=growth)
    last = coating[-1] - coating[-2] if coating.size > 1 else thickness
    below = marched(thickness, box, growth * last, sizes, growth=growth)
    return np.concatenate([[0.0], coating, below])
