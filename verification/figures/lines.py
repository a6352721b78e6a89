# SPDX-License-Identifier: MIT
"""Lines over x by series and panel, with points, fits and bounds: `curves`, and figures of it."""

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import cycle
from textwrap import fill
from typing import Any

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import MaxNLocator

from verification.figures.style import (
    BLACK,
    BLUE,
    EXACT,
    FEM,
    GREEN,
    ORANGE,
    PURPLE,
    SAM,
    VERMILION,
    Columns,
    Drawing,
    log_ticks,
    sheet,
)

MICRO, GIGA, PERCENT = 1e6, 1e-9, 1e2
POINTS = {"SAM": SAM | {"marker": "o", "fillstyle": "none"}, "FEM": FEM | {"marker": "x"}}
LOOKS = {
    "FEM": {"color": BLACK, "linewidth": 2.0},
    "SAM": {"color": BLUE, "marker": "o", "markersize": 3.5, "fillstyle": "none", "linestyle": "none"},
    "SAM, decoupled": {"color": VERMILION, "linewidth": 1.3, "linestyle": "--"},
    "SAM, paper": {"color": ORANGE, "linewidth": 1.5, "linestyle": ":"},
}
"""The look of FEM and of each form of SAM, where FEM is the reference."""
HOLLOW = {"markersize": 4, "fillstyle": "none", "linewidth": 1.2}
CYCLES = tuple(
    {"color": color, "marker": marker, "linestyle": line} | HOLLOW
    for color, marker, line in zip(
        (BLUE, VERMILION, GREEN, ORANGE, PURPLE, BLACK), "os^Dvx", cycle(("-", "--")), strict=False
    )
)
"""Looks of series that have none of their own, in order: hollow, so that one behind another is seen."""
INTO = "displacement into the body [$\\mu$m]"
"""Of y, which then points down."""
LETTERS = 10.5
"""Of a title or a label in an inch."""
BAND = {"color": GREEN, "alpha": 0.15, "linewidth": 0.0}
UNKNOWN = {"color": "#bbbbbb", "alpha": 0.45, "linewidth": 0.0}


@dataclass(frozen=True)
class Curve:
    """x and y of a line (n,), any units. fit: function of x through these points, drawn between the ends of
    `span` (None: of x); note: what the legend says behind the name; ends: least and largest y, of bars; look:
    of this line alone.
    """

    x: np.ndarray
    y: np.ndarray
    fit: Callable[[np.ndarray], np.ndarray] | None = None
    note: str = ""
    span: tuple[float, float] | None = None
    ends: tuple[np.ndarray, np.ndarray] | None = None
    look: Mapping[str, Any] = field(default_factory=dict)


@dataclass(frozen=True)
class How:
    """How panels are drawn. looks: of the series that have one of their own; size: of a panel, in inches;
    logarithmic: axes, "x", "y" or "xy"; count: x are whole numbers, and y begins at zero, so that a small
    change looks small; ticks: words of the x of the points, which alone have a number; shade: range of x that
    is not compared, floor: y below which nothing is claimed, each of all panels or of each; band: of
    tolerance on both sides of zero; marks: words -> ("x" or "y", places of guide lines); legend: "below" all
    panels or in "each", its entries, below all, or none.
    """

    looks: Mapping[str, Mapping] = field(default_factory=lambda: LOOKS)
    size: tuple[float, float] = (3.4, 3.3)
    logarithmic: str = ""
    count: bool = False
    ticks: Callable[[float], str] | None = None
    shade: tuple[float, float] | Mapping[str, tuple[float, float]] | None = None
    floor: float | Mapping[str, float] = 0.0
    band: float = 0.0
    marks: Mapping[str, Sequence] = field(default_factory=dict)
    legend: str | Sequence[Artist] | None = "below"


def curves(
    panels: Mapping[Any, Mapping[str, Curve]],
    xlabel: str | Mapping[Any, str],
    ylabel: str | Mapping[Any, str] | None = "",
    shade: tuple[float, float] | None = None,
    **how: Any,
) -> Drawing:
    """Panels of series: title -> name -> curve, at most three side by side; or (label of y, title) -> name ->
    curve, a row of panels for each label. One label of y for all: one scale for all in a row; None: the
    title of a panel is its label of y. how: see `How`.
    """
    way = How(**{"shade": shade} | how)
    rows = list(dict.fromkeys(key[0] for key in panels)) if isinstance(next(iter(panels)), tuple) else []
    few = 2 if len(panels) == 4 else min(len(panels), 3)
    across = len(panels) // len(rows) if rows else few
    shape = -(-len(panels) // across), across
    every = [each for series in panels.values() for each in series.items()]
    others, shared = cycle(CYCLES), bool(rows) or isinstance(ylabel, str)
    names = dict.fromkeys(name for name, _ in every)
    looks = {name: way.looks[name] if name in way.looks else next(others) for name in names}
    fitted = any(curve.fit for _, curve in every)
    data = Columns("panel", "series", "x", "y", *(["fit"] if fitted else []))
    inches, share = (max(way.size[0] * across, 5.0), way.size[1] * shape[0]), "row" if shared else False
    with sheet(*inches, shape, sharey=share, sharex="col" if rows else False) as (figure, grid):
        for axis in grid.ravel()[len(panels) :]:
            axis.set_visible(False)
        for k, (axis, (key, series)) in enumerate(zip(grid.ravel(), panels.items(), strict=False)):
            label, title = key if rows else (_of(key, ylabel) if ylabel is not None else key, key)
            for name, curve in series.items():
                fit = curve.fit(curve.x) if curve.fit else np.full(np.size(curve.x), np.nan)
                panel = f"{title}, {label}" if rows else title
                data.add(panel, name, curve.x, curve.y, *([fit] if fitted else []))
                _draw(axis, curve, name, {**looks[name], **curve.look})
            _finish(axis, title, series.values(), way)
            if label == INTO:
                axis.invert_yaxis()
            if ylabel is not None and (not rows or k < across):
                axis.set_title(fill(title, int(LETTERS * way.size[0]), break_on_hyphens=False))
            if not rows or label == rows[-1]:
                axis.set_xlabel(_of(key, xlabel))
            if not shared or k % across == 0:
                axis.set_ylabel(fill(label, int(LETTERS * way.size[1])))
        if way.count and "y" not in way.logarithmic:
            top = max(np.max(curve.y) for _, curve in every)
            for axis in grid.ravel():
                axis.set_ylim(0.0, 1.08 * top if shared and not rows else None)
        _name(figure, list(grid.ravel()), way)
        figure.align_ylabels()
    return Drawing(figure, data)


def _of(key: Any, words: str | Mapping[Any, str]) -> str:
    """The words of a panel, one text for all or one for each."""
    return words if isinstance(words, str) else words[key]


def _draw(axis: Axes, curve: Curve, name: str, look: Mapping) -> None:
    """A line with its bars, or points with their fit, and one entry of the legend."""
    label = f"{name}: {curve.note}" if curve.note else name
    if curve.fit is None:
        axis.plot(curve.x, curve.y, **{"label": label} | dict(look))
    else:
        points = {"fillstyle": "none"} | dict(look) | {"linestyle": "none"}
        line = {"color": look["color"], "linestyle": look.get("linestyle", "-"), "linewidth": 1.0}
        low, high = curve.span or (curve.x.min(), curve.x.max())
        dense = np.geomspace(low, high, 200) if low > 0.0 else np.linspace(low, high, 200)
        axis.plot(curve.x, curve.y, **points)
        axis.plot(dense, curve.fit(dense), **line)
        axis.plot([], [], **points | line, label=label)
    if curve.ends is not None:
        ends = np.maximum([curve.y - curve.ends[0], curve.ends[1] - curve.y], 0.0)
        axis.errorbar(curve.x, curve.y, ends, fmt="none", ecolor=look["color"], elinewidth=2.2)


def _finish(axis: Axes, title: str, series: Collection[Curve], way: How) -> None:
    """Scales and numbers of a panel, and what is marked or shaded in it."""
    for words, (along, *places) in way.marks.items():
        for k, place in enumerate(places):
            line = axis.axvline if along == "x" else axis.axhline
            line(place, **EXACT | {"linewidth": 1.0}, label="" if k else words)
    if way.count:
        axis.xaxis.set_major_locator(MaxNLocator(integer=True, min_n_ticks=2))
    for scale in way.logarithmic:
        getattr(axis, f"set_{scale}scale")("log", nonpositive="mask")
    if grey := way.shade[title] if isinstance(way.shade, Mapping) else way.shade:
        axis.axvspan(*grey, color="#eeeeee", zorder=0)
    if way.band:
        axis.axhspan(-way.band, way.band, **BAND)
    (low, high), unknown = axis.get_ylim(), way.floor[title] if isinstance(way.floor, Mapping) else way.floor
    if 0.0 < low < unknown:
        axis.axhspan(low, unknown, **UNKNOWN, label="below the uncertainty of the reference")
        axis.set_ylim(low, high)
    for scale in way.logarithmic:
        log_ticks(getattr(axis, f"{scale}axis"))
    if way.ticks is not None:
        used = np.unique(np.round(np.concatenate([curve.x for curve in series]), 9))
        axis.set_xticks(used, map(way.ticks, used))
        axis.set_xticks([], minor=True)


def _name(figure: Figure, axes: Sequence[Axes], way: How) -> None:
    """The legends."""
    if way.legend is None:
        return
    if way.legend == "each":
        for axis in axes:
            axis.legend()
        return
    drawn = [axis.get_legend_handles_labels() for axis in axes]
    named = {label: handle for pair in drawn for handle, label in zip(*pair, strict=True)}
    handles = list(named.values()) if isinstance(way.legend, str) else list(way.legend)
    if not handles:
        return
    letters = max(len(handle.get_label()) for handle in handles)
    wide = min(len(handles), max(1, int(14 * figure.get_figwidth() / (letters + 6))))
    figure.set_figheight(figure.get_figheight() + 0.17 * (-(-len(handles) // wide) - 1))  # of more rows
    figure.legend(handles=handles, loc="outside lower center", ncols=wide)


PLAIN = {"marker": "", "linestyle": "-", "linewidth": 1.4}
"""Of a curve of many points."""


LINE_ON_POINTS = {
    "SAM": SAM,
    "FEM": FEM | {"linestyle": "none", "marker": "o", "markersize": 4.0, "fillstyle": "none"},
}


def yield_profiles(cases: Mapping[str, Callable[[np.ndarray, float], np.ndarray]], deep: float) -> Drawing:
    """Yield stress to `deep` (m), without plastic strain and with 1 %; cases: name -> Pa of (m, strain)."""
    z = np.linspace(0.0, deep, 401)
    titles = {0.0: "Before any plastic strain", 0.01: "After a plastic strain of 1 %"}
    drawn = {
        title: {
            name: Curve(MICRO * z, GIGA * stress(z, strain), look={"marker": ""})
            for name, stress in cases.items()
        }
        for strain, title in titles.items()
    }
    drawing = curves(drawn, "depth $z$ [µm]", "yield stress [GPa]", size=(4.5, 3.6))
    drawing.figure.axes[0].set_ylim(0.0, None)
    return drawing


def over_cycles(
    panels: Mapping[tuple[str, str], Mapping[tuple[str, str], np.ndarray]], names: Sequence[str]
) -> Drawing:
    """A row of panels for each quantity, a column for each title, lines over the cycles from 0 on; colours by
    the first of the two `names` of a line, dashes by the second. panels: (quantity, title) -> two names of a
    line -> (n,) its values.
    """
    firsts, seconds = ({key[k]: None for own in panels.values() for key in own} for k in (0, 1))
    colors = dict(zip(firsts, (BLUE, VERMILION, GREEN), strict=False))
    dashes = dict(zip(seconds, ("-", "--"), strict=False))
    drawn: dict[tuple[str, str], dict[str, Curve]] = {}
    data = Columns("quantity", "panel", *names, "cycle", "value")
    for (quantity, title), own in panels.items():
        panel = drawn[quantity, title] = {}
        for (one, two), values in own.items():
            cycles, look = np.arange(len(values)), {"color": colors[one], "linestyle": dashes[two]}
            panel[f"{one}, {two}"] = Curve(cycles, values, look=look | {"marker": "", "linewidth": 1.3})
            data.add(quantity, title, one, two, cycles, values)
    entries = [Line2D([], [], color=color, label=name) for name, color in colors.items()]
    entries += [Line2D([], [], color=BLACK, linestyle=line, label=name) for name, line in dashes.items()]
    how = {"count": True, "legend": entries, "size": (2.2, 1.9)}
    return Drawing(curves(drawn, "cycle", **how).figure, data)
