# SPDX-License-Identifier: MIT
"""The table [counterbody.surface] of a scene: heights of the counter-body, others in each cycle if asked; and
what of them comes to lie opposite a patch over which it moves.

With c the heights in the frame of the counter-body, k its slip, s the place and m the middle of the path, the
heights opposite a point x of the body are c(x - k (s - m)): the middle of a map, or the crest of a sinusoid,
is opposite the middle of the patch half the way along the path. Steps slide whole cells, so that no summit is
blurred; a load between two of them, where a step is halved, takes heights between those of two cells.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache
from math import ceil, floor, gcd, isclose
from typing import Any, ClassVar

import numpy as np

from sam.arrays import Array
from sam.scene.section import Conflict, broken, stated
from sam.scene.surface.making import centres, fall, heights, mean_deviation
from sam.scene.surface.section import CLOSE, Surface, coarse_grid

WHOLE = 1e-6  # of a cell: a way of so much more or less is that of whole cells
WAVE_SHARE = 4  # steps in the shortest wave of the counter-surface at least
Place = tuple[float, float]


class CounterSurface(Surface):
    """The heights of the counter-body's surface, positive out of it, with the keys of `Surface`.

    renew: another stretch of it is opposite the body in each cycle, the first being what the keys say. Of a
    generated surface the seed is one higher from cycle to cycle; of a file the next part of the map of the
    size of crop follows, along x, then along y, and the first one after the last. A sinusoid stays the same.
    """

    table: ClassVar[str] = "counterbody.surface"
    words: ClassVar[str] = "counter-surface"
    common: ClassVar[tuple[str, ...]] = ("kind", "renew")
    renew: bool = False

    @property
    def renewed(self) -> bool:
        """Whether the cycles have different stretches."""
        return self.renew and self.kind != "sinusoid"

    def stretch(self, number: int) -> Surface:
        """The surface opposite the body in stretch `number`, from 0."""
        if number == 0 or not self.renewed:
            return self
        if self.kind == "file":
            return self.model_copy(update={"crop": self._crop_of(number)})
        return self.model_copy(update={"seed": stated(self.seed) + number})

    def seeds(self, cycles: int) -> tuple[int, ...]:
        """The seeds that are drawn in so many cycles; none of a surface that is not random."""
        if self.seed is None:
            return ()
        return tuple(self.seed + k for k in range(cycles if self.renewed else 1))

    def excesses(self) -> Iterator[Conflict]:
        """Those of every surface, and a map of which nothing else can follow."""
        unfit = list(super().excesses())
        yield from unfit
        if not unfit and self.renew and self.kind == "file":
            nx, ny = self._parts
            words = f"false: no second part of the size of {self.table}.crop lies beside it in the map"
            yield from broken((nx * ny < 2, "renew", words))

    @property
    def _parts(self) -> tuple[int, int]:
        """How many parts of the size of crop the map has along x and along y, that part among them."""
        nx, ny = (
            (n - part.start % (part.stop - part.start)) // (part.stop - part.start)
            for n, part in zip(self.measured.cells, self.window, strict=True)
        )
        return nx, ny

    def _crop_of(self, number: int) -> tuple[Any, ...]:
        """Middle and sides in m of a part, counted from that of crop."""
        (x, y), (nx, ny) = self.window, self._parts
        sides = x.stop - x.start, y.stop - y.start
        place = (x.start // sides[0] + nx * (y.start // sides[1]) + number) % (nx * ny)
        starts = x.start % sides[0] + place % nx * sides[0], y.start % sides[1] + place // nx * sides[1]
        cells, cell = self.measured.cells, self.measured.cell
        places = zip(starts, sides, cells, cell, strict=True)
        middles = [(start - (n - side) / 2) * h for start, side, n, h in places]
        return (*middles, *(side * h for side, h in zip(sides, cell, strict=True)))


def leading(surface: Surface | None, counter: CounterSurface | None) -> Surface | None:
    """The surface that says which cells the patch has: of a file before a generated one; or None."""
    rough = [surface for surface in (surface, counter) if surface is not None]
    return next(iter([surface for surface in rough if surface.kind == "file"] + rough), None)


@dataclass(frozen=True)
class Strip:
    """The strip of a rough counter-body that passes over a patch of (nx, ny) cells. start, way: (x,
    y) in m of the path and of the sliding; slip: share of sliding; relief: the strip's heights fall
    off at the border.
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
        return round(self.way[0] / self.cell[0]), round(self.way[1] / self.cell[1])

    @property
    def whole(self) -> tuple[int, int]:
        """Cells of the strip."""
        return self.cells[0] + abs(self.swept[0]), self.cells[1] + abs(self.swept[1])

    @property
    def sides(self) -> tuple[float, float]:
        """Sides of the strip in m."""
        return self.whole[0] * self.cell[0], self.whole[1] * self.cell[1]

    def at(self, number: int, place: Place) -> Array:
        """Heights (nx, ny) opposite the patch in m at (x, y); number: of the stretch."""
        opposite, stretch = self.sliding(number, place), self.surface.stretch(number)
        if not self.relief:
            return opposite
        if stretch.kind == "file":  # may be larger than the strip
            strip = _heights(stretch, self.whole, self.sides)
            return opposite - fall(self.cells, float(np.abs(strip - strip.mean()).mean()))
        return opposite - fall(self.cells, mean_deviation(stretch, self.sides))

    def sliding(self, number: int, place: Place) -> Array:
        """The same without the fall at the border, which does not move."""
        opposite = _heights(self.surface.stretch(number), self.whole, self.sides)
        ends = zip(place, self.start, self.cell, self.swept, self.cells, strict=True)
        for axis, (at, start, h, swept, count) in enumerate(ends):  # the first cell may lie between two
            first = max(swept, 0) - self.slip * (at - start) / h
            low = floor(first + WHOLE)
            share = first - low
            near = np.take(opposite, range(low, low + count), axis=axis)
            if share > WHOLE:
                far = np.take(opposite, range(low + 1, low + 1 + count), axis=axis)
                near = (1 - share) * near + share * far
            opposite = near
        return opposite

    def excesses(self, steps: int) -> Iterator[Conflict]:
        """What does not suit patch and path: broken cells, short waves, another map."""
        slides = "the counter-surface slides"
        cells = [way / h for way, h in zip(self.way, self.cell, strict=True)]
        if any(abs(n - round(n)) > WHOLE for n in cells):
            words = " and ".join(f"{n:.6g}" for n in cells)
            start = f"whole cells from loading.path.start, as {slides} {words} cells along x and y"
            yield "loading.path.end", start
        elif any(n % steps for n in self.swept):
            yield "loading.path.steps", f"{gcd(*self.swept)}, or a divisor of it: {slides} whole cells"
        table, surface = self.surface.table, self.surface
        if surface.kind != "file":
            yield from coarse_grid(surface, self.cells, self.extent)
            if self.share_of_wave(1 / steps) > (1 + CLOSE) / WAVE_SHARE:
                least = ceil(self.share_of_wave(1.0) * WAVE_SHARE * (1 - CLOSE))
                words = (
                    f"{least} or more: 1/{WAVE_SHARE} of the shortest wave of the counter-surface in a step"
                )
                yield "loading.path.steps", words
            return
        if surface.resample is not None:
            yield f"{table}.resample", "remove it with loading.path: the map keeps its own cells"
            return
        measured, sides = surface.patch()
        cell = [side / n for side, n in zip(sides, measured, strict=True)]
        if not all(isclose(a, b, rel_tol=CLOSE) for a, b in zip(cell, self.cell, strict=True)):
            asked, there = (" x ".join(f"{h:.6g} m" for h in both) for both in (self.cell, cell))
            yield f"{table}.path", f"cells of {asked}, as those of the body; it has {there}"
        elif any(n < least for n, least in zip(measured, self.whole, strict=True)):
            asked, there = (" x ".join(f"{side:.6g} m" for side in both) for both in (self.sides, sides))
            words = "the patch and the way of the counter-body over it"
            yield f"{table}.path", f"at least {asked}, {words}; it has {there}"

    def share_of_wave(self, share: float) -> float:
        """Shortest waves that it slides in a share of the way; 0 of a map, whose waves nobody knows."""
        if self.surface.kind == "file":
            return 0.0
        return share * max(abs(way) / wave for way, wave in zip(self.way, self.surface.shortest, strict=True))


@lru_cache(maxsize=1)  # the stretch that is opposite
def _heights(surface: Surface, cells: tuple[int, int], extent: tuple[float, float]) -> Array:
    """Of the whole strip; of a larger map those in its middle."""
    if surface.kind != "file":
        strip = heights(surface, centres(cells[0]) * extent[0], centres(cells[1]) * extent[1], extent)
    else:
        nx, ny = surface.patch()[0]
        i, j = (nx - cells[0]) // 2, (ny - cells[1]) // 2
        strip = heights(surface, np.zeros(nx), np.zeros(ny), extent)[i : i + cells[0], j : j + cells[1]]
    strip.flags.writeable = False
    return strip
