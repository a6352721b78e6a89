# SPDX-License-Identifier: MIT
"""As many iso-lines of a map as there is room for their numbers."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Sequence
from itertools import combinations

import numpy as np
from matplotlib.contour import ContourSet
from matplotlib.text import Text

from verification.figures.style import Drawing

ROOM = 0.5
"""Of the font size: what is free around a number at least."""
NUMBERED = 2
"""So many of the lines of a panel have a number at least, or all if they are fewer."""


def readable(
    draw: Callable[[Sequence[float]], Drawing], levels: Sequence[float], keep: Collection[float] = ()
) -> Drawing:
    """A drawing of iso-lines at `levels`, less those whose number touches another one or finds no place.

    keep: of those that touch, the levels that go last.
    """
    left = [float(level) for level in levels]
    drawing = draw(left)
    while len(left) > 1 and (going := _without(drawing, left) or _touching(drawing, left)):
        left.remove(min(going, key=lambda level: (level in keep, -level)))
        drawing = draw(left)
    return drawing


def _numbers(
    drawing: Drawing, levels: Sequence[float]
) -> Iterator[tuple[ContourSet, list[tuple[Text, float]]]]:
    """The iso-lines of each panel, with their numbers and the levels of these."""
    for lines in drawing.figure.findobj(ContourSet):
        texts = getattr(lines, "labelTexts", ())
        said = [float(text.get_text()) for text in texts]
        nearest = [min(levels, key=lambda level, near=value: abs(level - near)) for value in said]
        yield lines, list(zip(texts, nearest, strict=True))


def _without(drawing: Drawing, levels: Sequence[float]) -> set[float]:
    """Levels whose line found no place for a number, in panels where too few have one."""
    found: set[float] = set()
    for lines, numbers in _numbers(drawing, levels):
        paths = zip(lines.levels, lines.get_paths(), strict=True)
        drawn = {float(level) for level, path in paths if len(path.vertices)}
        numbered = {level for _, level in numbers}
        if len(numbered) < min(len(drawn), NUMBERED):
            found |= drawn - numbered
    return found


def _touching(drawing: Drawing, levels: Sequence[float]) -> set[float]:
    """Levels whose number touches another one."""
    drawing.figure.draw_without_rendering()  # the layout says where the numbers are
    pairs = (pair for _, numbers in _numbers(drawing, levels) for pair in combinations(numbers, 2))
    return {level for one, other in pairs if _touch(one[0], other[0]) for _, level in (one, other)}


def _touch(one: Text, other: Text) -> bool:
    first, second = (text.get_window_extent().extents for text in (one, other))
    room = ROOM * one.get_fontsize() * one.get_figure().dpi / 72.0
    return bool(np.all(np.minimum(first, second)[2:] + room > np.maximum(first, second)[:2]))
