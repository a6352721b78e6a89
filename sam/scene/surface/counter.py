# SPDX-License-Identifier: MIT
"""The table [counterbody.surface] of a scene: heights of the counter-body, others in each cycle if asked."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, ClassVar

from sam.scene.section import Conflict, stated
from sam.scene.surface.section import Surface


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
        found = list(super().excesses())
        yield from found
        if not found and self.renew and self.kind == "file":
            nx, ny = self._parts
            if nx * ny < 2:
                words = f"no second part of the size of {self.table}.crop lies beside it in the map"
                yield "renew", f"false: {words}"

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
        middles, lengths = [], []
        each = zip(starts, sides, self.measured.cells, self.measured.cell, strict=True)
        for start, side, n, cell in each:
            middles.append((start - (n - side) / 2) * cell)
            lengths.append(side * cell)
        return (*middles, *lengths)


def leading(surface: Surface | None, counter: CounterSurface | None) -> Surface | None:
    """The surface that says which cells the patch has: one from a file before a generated one.

    Parameters
    ----------
    surface, counter
        Of the body and of the counter-body; None if smooth.

    Returns
    -------
    Surface or None
        None if both are smooth.
    """
    there = [each for each in (surface, counter) if each is not None]
    from_file = [each for each in there if each.kind == "file"]
    return next(iter(from_file + there), None)
