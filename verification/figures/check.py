# SPDX-License-Identifier: MIT
"""What a reader cannot read in a figure: the rules of the published figures, measured on what is drawn.

Texts keep apart and stay on the sheet; no title or entry of a legend is a bare number; an axis has at least
two numbers, whole ones where it counts; every look of a line is in a legend or beside a text of its colour; a
colour bar stands beside the panel that it is of; no name of a variable of the code is written.
"""

import re
from collections.abc import Iterable, Iterator

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.cm import ScalarMappable
from matplotlib.colors import ListedColormap, to_hex
from matplotlib.figure import Figure
from matplotlib.legend import Legend
from matplotlib.lines import Line2D
from matplotlib.text import Text

from verification.figures.style import BLACK, GUIDE, fields_of

APART = 0.2
"""Of the size of the letters: least distance of two texts side by side."""
TOUCH = 0.2
"""Of the lower of two texts: how much the boxes may overlap in height; a box is higher than its letters."""
FEW = 8
"""Colours of a map that a legend may name instead of a colour bar."""
_RAW = re.compile(r"[^\W\d_]+_\w")
_FORMULA = re.compile(r"\$[^$]*\$")
COUNTS = re.compile(r"(cycle|iteration|load step|pass\b|passes|period)", re.IGNORECASE)
"""Begins the label of an axis of whole numbers."""
_NUMBER = re.compile(r"[-+\N{MINUS SIGN}]?[\d.]+")
_NO_LINE = ("None", "none", " ", "", None)


def findings(figure: Figure) -> list[str]:
    """One sentence for each thing in a figure that breaks a rule; none of a good one."""
    figure.draw_without_rendering()
    panels = [panel for panel in figure.axes if panel.get_visible()]
    found = [*_of_texts(figure, panels), *_of_bars(panels), *_of_lines(figure, panels)]
    found += [finding for panel in panels for finding in _of_ticks(panel)]
    return list(dict.fromkeys(found))


def _texts(figure: Figure, panels: Iterable[Axes]) -> Iterator[Text]:
    """All texts that are drawn, the numbers of an axis as far as they are within its limits."""
    on_axes = {}
    for panel in panels:
        for axis in (panel.xaxis, panel.yaxis):
            shown = {id(text) for text in _labels(axis)} if axis.get_visible() and panel.axison else set()
            on_axes |= {id(text): id(text) in shown for text in axis.findobj(Text)}
            on_axes |= {id(text): bool(panel.axison) for text in (axis.label, axis.offsetText)}
    for text in dict.fromkeys(figure.findobj(Text)):
        if text.get_visible() and text.get_text().strip() and on_axes.get(id(text), True) and _within(text):
            yield text


def _within(text: Text) -> bool:
    """Whether no artist that it belongs to is hidden, and its place is not clipped away."""
    panel = text.axes
    if panel is not None and not panel.get_visible():
        return False
    if panel is not None and text.get_clip_on() and text.get_clip_box() is not None:
        box, (x, y) = panel.bbox, text.get_transform().transform(text.get_unitless_position())
        return box.x0 <= x <= box.x1 and box.y0 <= y <= box.y1
    return True


def _labels(axis: Axis) -> list[Text]:
    """The numbers of an axis that are drawn."""
    low, high = sorted(axis.get_transform().transform(axis.get_view_interval()))
    room = 1e-6 * (high - low)
    ticks = [*axis.get_major_ticks(), *axis.get_minor_ticks()]
    return [
        label
        for tick in ticks
        if low - room <= axis.get_transform().transform(tick.get_loc()) <= high + room
        for label in (tick.label1, tick.label2)
        if label.get_visible() and label.get_text().strip()
    ]


def _of_texts(figure: Figure, panels: list[Axes]) -> Iterator[str]:
    texts = list(_texts(figure, panels))
    words = [" ".join(text.get_text().split())[:50] for text in texts]
    boxes = np.array([text.get_window_extent().extents for text in texts]).reshape(-1, 4)
    sizes = np.array([text.get_fontsize() for text in texts]) * figure.dpi / 72.0
    whole = figure.bbox.extents
    out = np.any([boxes[:, :2] < whole[:2], boxes[:, 2:] > whole[2:]], axis=(0, 2))
    yield from (f"the text '{words[k]}' leaves the sheet" for k in np.flatnonzero(out))
    yield from (
        f"'{text}' is the name of a variable" for text in words if _RAW.search(_FORMULA.sub("", text))
    )
    (x0, y0, x1, y1), gap = boxes.T, APART * np.minimum.outer(sizes, sizes)
    across = np.minimum.outer(x1, x1) - np.maximum.outer(x0, x0) > -gap
    height = np.minimum.outer(y1 - y0, y1 - y0)
    along = np.minimum.outer(y1, y1) - np.maximum.outer(y0, y0) > TOUCH * height
    for i, k in zip(*np.nonzero(np.triu(across & along, 1)), strict=True):
        yield f"the texts '{words[i]}' and '{words[k]}' collide"
    titles = [panel.get_title() for panel in panels]
    for legend in _legends(figure, panels):
        titles += [text.get_text() for text in legend.get_texts()]
        own, box = {id(text) for text in legend.findobj(Text)}, legend.get_window_extent().extents
        over = np.minimum(y1, box[3]) - np.maximum(y0, box[1]) > TOUCH * sizes
        inside = over & (x1 > box[0]) & (x0 < box[2])
        for k in np.flatnonzero(inside):
            if id(texts[k]) not in own:
                yield f"a legend covers '{words[k]}'"
    yield from (f"'{title}' does not say of what" for title in titles if _NUMBER.fullmatch(title.strip()))


def _legends(figure: Figure, panels: Iterable[Axes]) -> list[Legend]:
    return [each for part in (figure, *panels) for each in part.findobj(Legend) if each.get_visible()]


def _of_ticks(panel: Axes) -> Iterator[str]:
    for name, axis in (("horizontal", panel.xaxis), ("vertical", panel.yaxis)):
        if not (axis.get_visible() and panel.axison):
            continue
        words = [label.get_text() for label in _labels(axis)]
        shared = getattr(panel, f"get_shared_{axis.axis_name}_axes")().get_siblings(panel)
        hidden = not words and (len(shared) > 1 or not len(axis.get_majorticklocs()))
        title = panel.get_title() or axis.get_label_text() or "a colour bar"
        if len(words) < 2 and not hidden and all(map(_NUMBER.search, words)):
            yield f"the {name} axis of '{title}' has fewer than two numbers"
        if COUNTS.match(axis.get_label_text()) and any("." in word for word in words):
            yield f"the {name} axis of '{title}' counts and has broken numbers"


def _of_lines(figure: Figure, panels: list[Axes]) -> Iterator[str]:
    """Looks of lines that no legend has, of panels with several; a legend may also name colours and marks."""
    legends = _legends(figure, panels)
    known = {part for legend in legends for each in legend.legend_handles for part in _look(each)}
    colors = {color for color, *_ in known}
    forms = {(kind, name) for color, kind, name in known if color == BLACK}
    bars = {id(panel) for panel, _ in _bars(panels)}
    for panel in panels:
        drawn = [line for line in panel.lines if _is_drawn(line)]
        beside = {to_hex(text.get_color()) for text in panel.texts if text.get_text().strip()} - {BLACK}
        looks = {_look(line): line for line in drawn if to_hex(line.get_color()) not in beside}
        if id(panel) in bars or len({_look(line) for line in drawn}) < 2:
            continue
        for look in looks:
            for color, kind, name in look:
                if (color, kind, name) not in known and not (color in colors and (kind, name) in forms):
                    yield f"no legend has the {kind} {name} in {color} of '{panel.get_title()}'"


def _is_drawn(line: Line2D) -> bool:
    known = np.isfinite(line.get_xydata()).all(axis=1)
    return line.get_visible() and line.get_gid() != GUIDE and bool(known.any())


def _look(artist: Artist) -> tuple[tuple[str, str, str], ...]:
    """What tells a line from others: its colour with its dashes, and with its marker; the arrow of a bound,
    which matplotlib numbers, tells nothing.
    """
    if not isinstance(artist, Line2D):
        return ()
    color, parts = to_hex(artist.get_color()), []
    if artist.get_linestyle() not in _NO_LINE:
        parts.append((color, "line", str(artist.get_linestyle())))
    if artist.get_marker() not in _NO_LINE and not isinstance(artist.get_marker(), int):
        parts.append((color, "marker", str(artist.get_marker())))
    return tuple(parts)


def _bars(panels: Iterable[Axes]) -> list[tuple[Axes, ScalarMappable]]:
    """The axes of each colour bar, and what it is of."""
    every = [each for panel in panels for each in fields_of(panel)]
    return [(each.colorbar.ax, each) for each in every if getattr(each, "colorbar", None) is not None]


def _scale(each: ScalarMappable) -> tuple:
    return each.get_cmap().name, *each.get_clim()


def _of_bars(panels: list[Axes]) -> Iterator[str]:
    bars = _bars(panels)
    taken, scaled = {id(bar) for bar, _ in bars}, {_scale(each) for _, each in bars}
    fields = [panel for panel in panels if fields_of(panel) and id(panel) not in taken]
    for panel in fields:
        for each in fields_of(panel):
            few = isinstance(each.get_cmap(), ListedColormap) and each.get_cmap().N <= FEW
            if not (few and panel.get_legend()) and _scale(each) not in scaled:
                yield f"the colours of '{panel.get_title()}' have no colour bar"
    for bar, each in bars:
        nearest = min(fields, key=lambda panel: _distance(panel, bar))
        if _scale(each) not in map(_scale, fields_of(nearest)):
            yield f"a colour bar stands beside '{nearest.get_title()}', and is of another panel"


def _distance(one: Axes, other: Axes) -> float:
    """Between the boxes of two axes, in pixels."""
    a, b = one.get_window_extent().extents, other.get_window_extent().extents
    apart = np.maximum(0.0, np.maximum(a[:2] - b[2:], b[:2] - a[2:]))
    return float(np.hypot(*apart))
