# SPDX-License-Identifier: MIT
"""The grid of a rough scene, and the heights of both bodies on it. Loaded for rough scenes only: the whole
grid may come into contact.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from sam.arrays import Array
from sam.grid.cells import CellGrid, Room
from sam.grid.smooth import LAYERS_IN_PROFILE, depths_with_film, given_depths
from sam.scene import Grid, Plasticity
from sam.scene.section import stated
from sam.scene.surface import (
    CounterSurface,
    Roughness,
    Strip,
    Surface,
    border_cells,
    heights,
    leading,
    mean_deviation,
    patch_of,
    roughness,
    with_relief,
)

FINE_DEPTH = (
    # cells: down to here the depth levels are even, as the stress of a single summit is largest near the
    # surface
    2.0
)
FINEST = 0.25  # cells between the even levels
GROWTH = 1.2  # ratio of the distances between deeper levels
DEPTH_SHARE = 1 / 8  # of the shorter side: the deepest level, unless the plastic zone goes deeper
LAYER_GROWTH = 1.25  # ratio of the thicknesses of layers
MOST_ACROSS = 3.0  # of `step_across`: self-affine patches that repeat have 0.6 to 1.6


@dataclass(frozen=True)
class RoughPatch:
    """Rough surfaces on (nx, ny) cells over (Lx, Ly) in m; strip: of one that moves."""

    surface: Surface | None
    cells: tuple[int, int]
    extent: tuple[float, float]
    relief: bool = False
    counter: CounterSurface | None = None
    strip: Strip | None = None
    periodic: bool = False

    @classmethod
    def of(
        cls,
        surface: Surface | None,
        counter: CounterSurface | None,
        given: Grid | None,
        *,
        strip: Strip | None = None,
    ) -> RoughPatch:
        """On the cells of a file, or on those that [grid] gives; strip: of a counter-body that moves."""
        relief = given is not None and given.border == "relief"
        if strip is not None:
            return cls(surface, strip.cells, strip.extent, relief, counter, strip)
        cells, extent = patch_of(stated(leading(surface, counter)), given)
        periodic = given is not None and given.periodic == "xy"
        return cls(surface, cells, extent, relief, counter, periodic=periodic)

    def heights(self) -> Array:
        """Heights of a rough body at the cell centres, (nx, ny) in m, positive out of it; read-only."""
        return _heights(stated(self.surface), self.cells, self.extent, self.relief)

    def counter_heights(self, number: int, place: tuple[float, float]) -> Array:
        """Heights of a stretch of a rough counter-body at a place of its path in m, positive out of it."""
        if self.strip is not None:
            return self.strip.at(number, place)
        stretch = stated(self.counter).stretch(number)
        return _heights(stretch, self.cells, self.extent, self.relief)

    @property
    def opposite(self) -> Callable[[int, tuple[float, float]], Array] | None:
        """Heights of a stretch of the counter-body at a place, (nx, ny) in m; None if it is smooth."""
        return None if self.counter is None else self.counter_heights

    def changed_by_taper(self, surface: Surface) -> tuple[float, float]:
        """Rms change of the heights of a surface by its taper, and their rms deviation, in m."""
        before = surface.model_copy(update={"taper": None})
        as_is, other = (_heights(each, self.cells, self.extent, False) for each in (before, surface))
        return float(np.sqrt(np.mean((other - as_is) ** 2))), float(as_is.std())

    @property
    def of_body(self) -> Array:
        """The heights of the body, or zeros if it is smooth."""
        return np.zeros(self.cells) if self.surface is None else self.heights()

    def roughness(self, lowered: Array | float = 0.0) -> Roughness:
        """Of the heights less what is lowered, (nx, ny) in m, but for a border that falls off."""
        (nx, ny), (lx, ly) = self.cells, self.extent
        bx, by = border_cells((nx, ny)) if self.relief else (0, 0)
        inner = (self.of_body - lowered)[bx : nx - bx, by : ny - by]
        return roughness(inner, lx / nx, ly / ny)


@lru_cache(maxsize=2)  # the body, and the stretch opposite
def _heights(surface: Surface, cells: tuple[int, int], extent: tuple[float, float], relief: bool) -> Array:
    x, y = (((np.arange(n) + 0.5) / n - 0.5) * side for n, side in zip(cells, extent, strict=True))
    values = heights(surface, x, y, extent)
    if surface.taper:
        values = tapered(values, surface.taper)
    if relief:
        values = with_relief(values, (x, y), extent, mean_deviation(surface, extent))
    values.flags.writeable = False
    return values


def step_across(heights: Array, axes: tuple[int, ...] = (0, 1)) -> float:
    """Rms step across the border of a patch over that between neighbouring cells, the larger of some
    directions: about 1 of heights (nx, ny) that repeat.
    """
    steps = [(heights.take(0, axis) - heights.take(-1, axis), np.diff(heights, axis=axis)) for axis in axes]
    rms = [[float(np.sqrt(np.square(each).mean())) for each in both] for both in steps]
    return max(across / (inside or across or 1.0) for across, inside in rms)


def tapered(heights: Array, share: float) -> Array:
    """Heights (nx, ny) that repeat: in a share of each side, half of it at both ends, half of the step across
    the border is added or taken off, as s^3 (10 - 15 s + 6 s^2) of the way s to the border.
    """
    for axis in (0, 1):
        n = heights.shape[axis]
        s = np.clip(1 - (np.arange(n) + 0.5) / (share * n / 2), 0.0, 1.0)
        half = np.expand_dims(np.subtract(heights.take(-1, axis), heights.take(0, axis)) / 2, axis)
        at_start = np.expand_dims(s**3 * (10 - 15 * s + 6 * s**2), 1 - axis)
        heights = heights + half * (at_start - np.flip(at_start, axis))
    return heights


@dataclass(frozen=True)
class RoughDemand:
    """What the grid of a rough scene is chosen from; reach: of `point_load_reach` in m; line: below a
    cylinder, all repeats along y.
    """

    patch: RoughPatch
    given: Grid | None
    plasticity: Plasticity | None
    film: float | None = None
    reach: float = 0.0
    line: bool = False

    def grid(self, room: Room) -> CellGrid:
        """The cells of the patch; depths that are not given are fine near the surface, for small contacts."""
        patch, plasticity = self.patch, self.plasticity
        (nx, ny), (lx, ly) = patch.cells, patch.extent
        hx, hy = lx / nx, ly / ny
        depths = given_depths(self.given)
        if depths is None:
            cell, deepest = hx if ny == 1 else min(hx, hy), DEPTH_SHARE * (lx if self.line else min(lx, ly))
            chosen = (
                _depths(cell, deepest)
                if plasticity is None
                else _faces(plasticity, cell, deepest * room.below, self.reach * room.below)
            )
            depths = chosen if self.film is None else depths_with_film(chosen, self.film)
        border = (0, 0) if patch.relief or patch.periodic else border_cells((nx, ny))
        border = (border[0], 0) if self.line else border
        faces = None if plasticity is None else depths
        depths = depths if faces is None else (faces[1:] + faces[:-1]) / 2
        return CellGrid(nx, ny, hx, hy, depths, faces, border, room, patch.periodic, self.line)


def _depths(cell: float, deepest: float) -> Array:
    """Output depths in m: even ones near the surface, then growing distances."""
    levels, step = [FINEST * cell * k for k in range(round(FINE_DEPTH / FINEST) + 1)], FINEST * cell
    while levels[-1] < deepest:
        step *= GROWTH
        levels.append(levels[-1] + step)
    return np.array(levels)


def _faces(plasticity: Plasticity, cell: float, deepest: float, reach: float) -> Array:
    """Faces of layers of a body that yields; the one next to a kink is moved there."""
    thin = [cell / 2]
    if plasticity.profile is not None:
        thin.append(plasticity.profile[-1][0] / LAYERS_IN_PROFILE or cell / 2)
    if plasticity.layer_thickness is not None:
        thin.append(plasticity.layer_thickness / LAYERS_IN_PROFILE)
    faces, step = [0.0, min(thin)], LAYER_GROWTH * min(thin)
    while faces[-1] < deepest or faces[-2] < reach:
        faces.append(faces[-1] + step)
        step *= LAYER_GROWTH
    kinks = plasticity.strength().kinks.depths
    for kink in (z for z in kinks if min(thin) / 2 < z < faces[-1]):
        nearest = int(np.abs(np.array(faces) - kink).argmin())
        faces[nearest] = faces[nearest] if faces[nearest] in kinks else kink
    return np.array(faces)
