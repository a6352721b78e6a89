# SPDX-License-Identifier: MIT
"""Graded meshes of quadrilaterals of the half plane r >= 0, z >= 0; lengths in contact radii."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from skfem import MeshQuad

GROWTH = 1.25
"""Ratio of neighbouring elements outside the uniform part of a mesh."""
CLOSEST = 8.0
"""Depths at which the material changes that are nearer than an element over this are one."""


@dataclass(frozen=True)
class Core:
    """The uniform part of a mesh for a smooth contact of radius 1: radius beyond the edge of the contact, depth."""

    radius: float = 1.3
    depth: float = 0.8


ELASTIC = Core()
"""The largest von Mises stress of Hertz is at the depth 0.48."""


def plastic_core(radius: float) -> Core:
    """Uniform part for a plastic contact whose radius is about `radius`; the largest plastic strain is well inside.

    With twice the depth, or elements that grow by 1.1, no scalar result changes by more than 1e-4.
    """
    return Core(1.3 * radius, 1.2 * radius)


def grow(start: float, stop: float, size: float, growth: float = GROWTH) -> np.ndarray:
    """Points after `start` up to `stop`, intervals growing geometrically from about `size`.

    Their ratio is `growth`, their number the smallest that reaches, and all are scaled to end at `stop` exactly.
    """
    reached = np.log1p((stop - start) / size * (growth - 1.0)) / np.log(growth)
    count = max(1, int(np.ceil(round(reached, 9))))
    steps = growth ** np.arange(1, count + 1)
    return start + (stop - start) * np.cumsum(steps) / np.sum(steps)


def uniform_then_growing(
    size: float, core: float, box: float, growth: float = GROWTH, marks: Sequence[float] = ()
) -> np.ndarray:
    """Lines from 0: intervals of `size` to `core` or just beyond, then growing to `box`.

    marks: ascending; those inside the core are lines too, with equal intervals of at most `size` between them; of marks that
    are nearer than size/CLOSEST the first is a line.
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


def smooth_lines(
    cells_per_radius: int, box: float, core: Core = ELASTIC, marks: Sequence[float] = ()
) -> tuple[np.ndarray, np.ndarray]:
    """(r, z) mesh lines for a smooth contact of radius 1: uniform in `core`, then growing to `box`.

    marks: depths, at which the material changes; without lines there a layer would be up to a quarter of an element thicker
    or thinner, as its Gauss points are.
    """
    size = 1.0 / cells_per_radius
    return uniform_then_growing(size, core.radius, box), uniform_then_growing(
        size, core.depth, box, marks=marks
    )


def punch_lines(cells_per_radius: int, box: float) -> tuple[np.ndarray, np.ndarray]:
    """(r, z) mesh lines for a flat-ended cylinder of radius 1.

    Inside r = sin(i pi / (2 n)): in this variable the force of the pressure 1/sqrt(1 - r^2) is smooth up to the edge;
    outside, and in depth, elements grow from the size at the edge.
    """
    inside = np.sin(np.linspace(0.0, np.pi / 2.0, cells_per_radius + 1))
    inside[-1] = 1.0
    edge = inside[-1] - inside[-2]
    return np.concatenate([inside, grow(1.0, box, edge)]), np.concatenate([[0.0], grow(0.0, box, edge)])


@dataclass(frozen=True)
class Sizes:
    """Largest size of an element at a distance from the origin: `fine` up to the first limit, then `coarse` up to the other."""

    fine: float
    coarse: float
    limits: tuple[float, float]

    def __call__(self, distance: float) -> float:
        below = [
            size
            for size, limit in zip((self.fine, self.coarse), self.limits, strict=True)
            if distance < limit
        ]
        return below[0] if below else np.inf


def marched(
    start: float, stop: float, first: float, sizes: Callable[[float], float], growth: float = GROWTH
) -> np.ndarray:
    """Points after `start` up to `stop`: intervals from `first` on, growing as `sizes` allows, scaled to end at `stop`."""
    places, size = [start], min(first, sizes(start))
    while places[-1] < stop:
        places.append(places[-1] + size)
        size = min(growth * size, sizes(places[-1]))
    steps = np.array(places[1:]) - start
    scaled = start + steps * (stop - start) / steps[-1]
    scaled[-1] = stop  # to the last digit: materials change there
    return scaled


def film_depths(
    thickness: float, box: float, sizes: Sizes, growth: float = GROWTH, fewest: int = 2
) -> np.ndarray:
    """z lines to `box`, one of them at the interface, at least `fewest` elements above it; below growing from their size."""
    film = marched(0.0, thickness, min(sizes.fine, thickness / fewest), sizes, growth)
    last = film[-1] - film[-2] if film.size > 1 else thickness
    return np.concatenate([[0.0], film, marched(thickness, box, growth * last, sizes, growth)])


def half_plane(r: np.ndarray, z: np.ndarray) -> MeshQuad:
    """Tensor mesh with the boundaries "axis" (r = 0), "surface" (z = 0) and "far" (largest r or z)."""
    return MeshQuad.init_tensor(r, z).with_boundaries(
        {
            "axis": lambda x: x[0] == 0.0,
            "surface": lambda x: x[1] == 0.0,
            "far": lambda x: (x[0] == r[-1]) | (x[1] == z[-1]),
        }
    )
