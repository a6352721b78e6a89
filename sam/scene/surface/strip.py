# SPDX-License-Identifier: MIT
"""A rough counter-body that moves: the strip of it that comes to lie opposite a patch, and which part of that
is opposite at a place of the path.

With c the heights in the frame of the counter-body, k its slip, s the place and m the middle of the path, the
heights opposite a point x of the body are c(x - k (s - m)): the middle of a map, or the crest of a sinusoid,
is opposite the middle of the patch half the way along the path. Steps slide whole cells, so that no summit is
blurred; a load between two of them, where a step is halved, takes heights between those of two cells.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache
from math import floor, isclose

import numpy as np

from sam.arrays import Array
from sam.scene.section import Conflict
from sam.scene.surface.counter import CounterSurface
from sam.scene.surface.generators import heights, mean_deviation
from sam.scene.surface.relief import fall
from sam.scene.surface.section import CLOSE, Surface, coarse_grid

WHOLE = 1e-6  # of a cell: a way of so much more or less is one of whole cells
WAVE_SHARE = 4  # steps in the shortest wave of the counter-surface at least
Place = tuple[float, float]


@dataclass(frozen=True)
class Strip:
    """The strip of a rough counter-body that passes over a patch.

    Parameters
    ----------
    surface
        Its heights.
    cells, extent
        (nx, ny) cells of the patch, and its sides (Lx, Ly) in m.
    start
        (x, y) in m, where the path begins.
    way
        How far it slides along x and y from start to end, in m: slip times the path.
    slip
        Share of its way by which it slides.
    relief
        Whether the heights fall off at the border of the patch; the fall is that of the strip, and does not
        move.
    """

    surface: CounterSurface
    cells: tuple[int, int]
    extent: tuple[float, float]
    start: Place
    way: tuple[float, float]
    slip: float
    relief: bool = False

    @property
    def cell(self) -> tuple[float, float]:
        """Sides of a cell in m."""
        return self.extent[0] / self.cells[0], self.extent[1] / self.cells[1]

    @property
    def swept(self) -> tuple[int, int]:
        """Cells along x and y by which it slides from start to end, with their sign."""
        found = [round(way / h) for way, h in zip(self.way, self.cell, strict=True)]
        return found[0], found[1]

    @property
    def whole(self) -> tuple[int, int]:
        """Cells of the strip."""
        found = [n + abs(more) for n, more in zip(self.cells, self.swept, strict=True)]
        return found[0], found[1]

    @property
    def sides(self) -> tuple[float, float]:
        """Sides of the strip in m."""
        found = [n * h for n, h in zip(self.whole, self.cell, strict=True)]
        return found[0], found[1]

    def at(self, number: int, place: Place) -> Array:
        """Heights opposite the patch, (nx, ny) in m, positive out of the counter-body.

        Parameters
        ----------
        number
            Of the stretch, from 0.
        place
            (x, y) of the counter-body in m.
        """
        found, stretch = self.sliding(number, place), self.surface.stretch(number)
        if not self.relief:
            return found
        if stretch.kind == "file":  # may be larger than the strip
            strip = _heights(stretch, self.whole, self.sides)
            return found - fall(self.cells, float(np.abs(strip - strip.mean()).mean()))
        return found - fall(self.cells, mean_deviation(stretch, self.sides))

    def sliding(self, number: int, place: Place) -> Array:
        """The same without the fall at the border, which does not move."""
        found = _heights(self.surface.stretch(number), self.whole, self.sides)
        ends = zip(place, self.start, self.cell, self.swept, strict=True)
        for axis, (now, start, h, swept) in enumerate(ends):
            first = max(swept, 0) - self.slip * (now - start) / h
            found = _part(found, axis, first, self.cells[axis])
        return found

    def excesses(self, steps: int) -> Iterator[Conflict]:
        """What does not suit the patch and the steps of the path, from start to end."""
        yield from self._broken_cells(steps)
        if self.surface.kind == "file":
            yield from self._short_file()
            return
        yield from coarse_grid(self.surface, self.cells, self.extent)
        if self.share_of_wave(1 / steps) > (1 + CLOSE) / WAVE_SHARE:
            least = int(np.ceil(self.share_of_wave(1.0) * WAVE_SHARE * (1 - CLOSE)))
            words = f"{least} or more: 1/{WAVE_SHARE} of the shortest wave of the counter-surface in a step"
            yield "loading.path.steps", words

    def share_of_wave(self, share: float) -> float:
        """Shortest waves that it slides in a share of the way; 0 of a map, whose waves nobody knows."""
        if self.surface.kind == "file":
            return 0.0
        return share * max(abs(way) / wave for way, wave in zip(self.way, self.surface.shortest, strict=True))

    def _broken_cells(self, steps: int) -> Iterator[Conflict]:
        """Steps in which the counter-body does not slide whole cells."""
        cells = [way / h for way, h in zip(self.way, self.cell, strict=True)]
        if any(abs(n - round(n)) > WHOLE for n in cells):
            words = " and ".join(f"{n:.6g}" for n in cells)
            slides = f"the counter-surface slides {words} cells along x and y"
            yield "loading.path.end", f"whole cells from loading.path.start, as {slides}"
            return
        if any(abs(n) % steps for n in self.swept):
            most = int(np.gcd(*self.swept))
            yield "loading.path.steps", f"{most}, or a divisor of it: the counter-surface slides whole cells"

    def _short_file(self) -> Iterator[Conflict]:
        """A map with other cells, or one that does not reach from the start to the end."""
        key, surface = f"{self.surface.table}.path", self.surface
        if surface.resample is not None:
            yield f"{surface.table}.resample", "remove it with loading.path: the map keeps its own cells"
            return
        own, sides = surface.patch()
        cell = [side / n for side, n in zip(sides, own, strict=True)]
        if not all(isclose(a, b, rel_tol=CLOSE) for a, b in zip(cell, self.cell, strict=True)):
            asked, found = (" x ".join(f"{h:.6g} m" for h in each) for each in (self.cell, cell))
            yield key, f"cells of {asked}, as those of the body; it has {found}"
        elif any(n < least for n, least in zip(own, self.whole, strict=True)):
            asked, found = (" x ".join(f"{side:.6g} m" for side in each) for each in (self.sides, sides))
            yield key, f"at least {asked}, the patch and the way of the counter-body over it; it has {found}"


def _part(found: Array, axis: int, first: float, count: int) -> Array:
    """So many cells along an axis from a first one on, which may lie between two."""
    low = floor(first + WHOLE)
    share = first - low
    near = np.take(found, range(low, low + count), axis=axis)
    if share <= WHOLE:
        return near
    return (1 - share) * near + share * np.take(found, range(low + 1, low + 1 + count), axis=axis)


@lru_cache(maxsize=1)  # the stretch that is opposite
def _heights(surface: Surface, cells: tuple[int, int], extent: tuple[float, float]) -> Array:
    """Of the whole strip; of a larger map those in its middle."""
    x, y = (((np.arange(n) + 0.5) / n - 0.5) * side for n, side in zip(cells, extent, strict=True))
    if surface.kind != "file":
        found = heights(surface, x, y, extent)
    else:
        own = surface.patch()[0]
        i, j = ((n - least) // 2 for n, least in zip(own, cells, strict=True))
        found = heights(surface, np.zeros(own[0]), np.zeros(own[1]), extent)[
            i : i + cells[0], j : j + cells[1]
        ]
    found.flags.writeable = False
    return found
