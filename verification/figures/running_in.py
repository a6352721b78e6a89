# SPDX-License-Identifier: MIT
"""The figures of running-in: six panels of a run (Bosman & Schipper 2011, Figs. 13-17), all runs over the
cycles, regimes, statements over uncertain inputs, worn volume over the size of cells.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import BoundaryNorm, LightSource, ListedColormap
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.ticker import MaxNLocator

from verification.compare.running_in_measures import History, Limits, Scar
from verification.figures.maps import draw_field, outline
from verification.figures.places import edges_of
from verification.figures.style import (
    BLACK,
    BLUE,
    GREEN,
    GREY,
    GUIDE,
    ORANGE,
    PURPLE,
    VERMILION,
    Columns,
    Drawing,
    log_ticks,
    sheet,
)

MICRO, GIGA, CUBIC = 1e6, 1e-9, 1e18
MAP_AXES = {"xlabel": "$x$ [µm]", "ylabel": "$y$ [µm]"}
LOOKS = (
    {"color": BLACK, "marker": "o"},
    {"color": BLUE, "marker": "s"},
    {"color": VERMILION, "marker": "P"},
    {"color": ORANGE, "marker": "X", "linestyle": "--"},
    {"color": GREEN, "marker": "D"},
)
"""Of the five cases, in order."""
_OUT, _LOW, _HIGH = 0, 1, 2
_FRICTION = {
    _OUT: (GREY, "no contact"),
    _LOW: (BLUE, "{:g}, film whole"),
    _HIGH: (ORANGE, "{:g}, film failed"),
}
_EDGE = {"color": VERMILION, "linewidth": 1.0}
_SUN = {"azdeg": 315.0, "altdeg": 40.0}
NO_WEAR = "no wear"


def six_panels(scar: Scar, history: History, friction: tuple[float, float]) -> Drawing:
    """(a) worn depth, (b) the worn surface in relief, (c) volume and (d) friction over the cycles, (e) local
    friction and (f) pressure at the last peak. friction: the low and the high coefficient.
    """
    with sheet(10.6, 6.6, (2, 3)) as (figure, axes):
        (worn, relief, volume), (over_cycles, local, pressure) = axes
        depth = np.where(scar.worn > 0.0, 1e9 * scar.worn, np.nan)
        _map(worn, scar, depth, "worn depth [nm]", cmap="viridis")
        worn.set_title("(a) worn depth" if np.isfinite(depth).any() else f"(a) worn depth: {NO_WEAR}")
        _relief(relief, scar)
        _over_cycles(volume, history.cycle, CUBIC * history.volume, ("(c) wear volume", "volume [µm³]"))
        words = "(d) friction, this surface", "coefficient of friction"
        _over_cycles(over_cycles, history.cycle, history.friction, words)
        room = 0.05 * (friction[1] - friction[0])
        over_cycles.set_ylim(friction[0] - room, friction[1] + room)
        _local_friction(local, scar, friction)
        touching = np.where(scar.in_contact, GIGA * scar.p, np.nan)
        _map(pressure, scar, touching, "pressure [GPa]", cmap="plasma")
        pressure.set_title("(f) pressure")
    return Drawing(figure, _columns(scar, "worn_m", "p_Pa", "friction"))


def _columns(scar: Scar, *more: str) -> dict[str, np.ndarray]:
    """One row a cell; the cycles are in cycles.csv of the run. more: columns beside places and heights."""
    x, y = np.meshgrid(scar.x, scar.y, indexing="ij")
    fields = {"x_m": x, "y_m": y, "height_m": scar.height}
    fields |= {name: getattr(scar, name.partition("_")[0]) for name in more}
    return {name: field.ravel() for name, field in fields.items()}


def _map(panel: Axes, scar: Scar, field: np.ndarray, label: str, *, cmap: str) -> None:
    """A field over the patch with its colour bar; grey, without a bar, where there is nothing to show."""
    known = np.isfinite(field).any()
    limits = {"vmin": 0.0, "vmax": np.nanmax(field) if known else 1.0}
    mesh = draw_field(panel, MICRO * scar.x, MICRO * scar.y, field, cmap=cmap, **limits)
    if known:
        panel.figure.colorbar(mesh, ax=panel, label=label, fraction=0.05, pad=0.03)
    else:
        mesh.remove()
    panel.set(xlim=_ends(scar.x), ylim=_ends(scar.y), **MAP_AXES)


def _ends(places: np.ndarray) -> tuple[float, float]:
    return MICRO * edges_of(places)[0], MICRO * edges_of(places)[-1]


def _relief(panel: Axes, scar: Scar) -> None:
    """The worn surface around its scar as if lit from the upper left, and the edge of what is worn."""
    near = _around(scar)
    x, y, height = scar.x[near[0]], scar.y[near[1]], (scar.height - scar.worn)[near]
    steep = np.std(np.gradient(height, x, y)) or 1.0
    light = LightSource(**_SUN).hillshade(height.T, vert_exag=1.0 / steep, dx=x[1] - x[0], dy=y[1] - y[0])
    where = (*_ends(x), *_ends(y))
    panel.imshow(
        np.repeat(light[..., None], 3, axis=2), origin="lower", extent=where, interpolation="bilinear"
    )
    panel.grid(False)
    removed = scar.worn[near] > 0.0
    if removed.any():
        outline(panel, MICRO * x, MICRO * y, removed, **_EDGE)
        names = [Line2D([], [], **_EDGE, label="edge of what is worn")]
        panel.legend(handles=names, loc="upper center", bbox_to_anchor=(0.5, -0.17), fontsize=7)
    panel.set(title=f"(b) {'worn ' * bool(removed.any())}surface in relief", **MAP_AXES)


def _around(scar: Scar) -> tuple[slice, slice]:
    """The cells of the scar, or without one of the contact, and a third of its size beside it."""
    marked = scar.worn > 0.0 if (scar.worn > 0.0).any() else scar.in_contact
    slices = []
    for axis in (1, 0):
        cells = np.flatnonzero(marked.any(axis=axis)) if marked.any() else np.arange(marked.shape[1 - axis])
        beside = max(4, (cells[-1] - cells[0]) // 3)
        slices.append(slice(max(0, cells[0] - beside), cells[-1] + beside + 1))
    return slices[0], slices[1]


def _over_cycles(panel: Axes, cycle: np.ndarray, values: np.ndarray, words: tuple[str, str]) -> None:
    title, label = words
    panel.plot(cycle, values, color=BLUE, marker="o", markersize=3, linewidth=1.3)
    panel.set(title=title, xlabel="cycle", ylabel=label, xlim=(0.0, cycle[-1] + 0.5))
    panel.xaxis.set_major_locator(MaxNLocator(integer=True))
    if not values.any():
        panel.set(title=f"{title}: {NO_WEAR}", ylim=(-0.05, 1.0))
    elif values.min() >= 0.0:
        panel.set_ylim(0.0, 1.06 * values.max())


def _local_friction(panel: Axes, scar: Scar, friction: tuple[float, float]) -> None:
    """Where there is no contact, and where friction is low or high."""
    state = np.where(scar.in_contact, np.where(scar.unprotected(*friction), _HIGH, _LOW), _OUT)
    cmap, norm = (
        ListedColormap([colour for colour, _ in _FRICTION.values()]),
        BoundaryNorm([-0.5, 0.5, 1.5, 2.5], 3),
    )
    draw_field(panel, MICRO * scar.x, MICRO * scar.y, state, cmap=cmap, norm=norm)
    panel.set(title="(e) local friction", **MAP_AXES)
    words = [text.format(*([] if k == _OUT else [friction[k - 1]])) for k, (_, text) in _FRICTION.items()]
    colours = [colour for colour, _ in _FRICTION.values()]
    patches = [Patch(facecolor=colour, label=word) for colour, word in zip(colours, words, strict=True)]
    place = {"loc": "upper center", "bbox_to_anchor": (0.5, -0.17)}
    panel.legend(handles=patches, **place, ncols=3, fontsize=7, handlelength=1.2)


COLORS, LINES = (BLUE, VERMILION, GREEN), ("-", "--")
"""Of the first and of the second name of a line, in order."""
Lines = Mapping[tuple[str, str], np.ndarray]
"""Two names of a line -> (n,) its values, a cycle each."""


def over_cycles(
    panels: Mapping[tuple[str, str], Lines], names: Sequence[str], *, first: int = 0, thick: str = ""
) -> Drawing:
    """A row of panels for each quantity, a column for each title, lines over the cycles from the `first` on;
    colours by the first of the `names` of a line, dashes by the second, unless one of these is drawn `thick`,
    the others thin.

    panels: (quantity, title) -> its lines.
    """
    numbers = Columns("quantity", "panel", *names, "cycle", "value")
    rows, titles = (list(dict.fromkeys(parts)) for parts in zip(*panels, strict=True))
    firsts, seconds = ({key[k]: None for lines in panels.values() for key in lines} for k in (0, 1))
    colors = dict(zip(firsts, COLORS, strict=False))
    dashes = dict(zip(firsts if thick else seconds, LINES, strict=False))
    size = (len(rows), len(titles))
    with sheet(2.2 * max(3, size[1]), 1.1 + 1.7 * size[0], size, sharex=True, sharey="row") as (figure, axes):
        for (quantity, title), lines in panels.items():
            panel = axes[rows.index(quantity), titles.index(title)]
            for (one, two), values in lines.items():
                look = {"color": colors[one], "linestyle": dashes[one if thick else two], "linewidth": 1.3}
                look |= (
                    ({"linewidth": 2.0} if two == thick else {"linewidth": 0.5, "alpha": 0.4})
                    if thick
                    else {}
                )
                cycles = np.arange(first, first + len(values))
                panel.plot(cycles, values, **look)
                numbers.add(quantity, title, one, two, cycles, values)
            panel.xaxis.set_major_locator(MaxNLocator(4, integer=True, min_n_ticks=2))
        for row, quantity in zip(axes, rows, strict=True):
            row[0].set(ylabel=quantity, ylim=(0.0, None))
        for column, title in zip(axes.T, titles, strict=True):
            begin, comma, rest = title.rpartition(", ") if len(title) > LONG_TITLE else (title, "", "")
            column[0].set_title(f"{begin}{comma.strip()}\n{rest}" if comma else title)
            column[-1].set_xlabel("cycle")
        named = [
            Line2D([], [], color=color, linestyle=dashes.get(name, "-"), label=name)
            for name, color in colors.items()
        ]
        if not thick:
            named += [
                Line2D([], [], color=BLACK, linestyle=line, label=name) for name, line in dashes.items()
            ]
        figure.legend(handles=named, loc="outside lower center", ncols=len(named))
        figure.align_ylabels()
    return Drawing(figure, numbers)


LONG_TITLE = 20  # characters from which a title is broken at its last comma


def yield_profiles(cases: Mapping[str, Callable[[np.ndarray, float], np.ndarray]], deep: float) -> Drawing:
    """Yield stress in GPa over depth to `deep` (m), without plastic strain and with 1 %; cases: name ->
    function of depths in m and a plastic strain, in Pa.
    """
    rows, z = Columns("case", "plastic_strain", "z_um", "yield_stress_GPa"), np.linspace(0.0, deep, 401)
    with sheet(9.0, 3.6, len(STRAINS), sharey=True) as (figure, axes):
        for panel, (strain, words) in zip(axes, STRAINS.items(), strict=True):
            for look, (name, stress) in zip(LOOKS, cases.items(), strict=False):
                values, line = GIGA * stress(z, strain), {"linestyle": "-"} | look | {"marker": None}
                panel.plot(MICRO * z, values, **line, linewidth=1.5, label=name)
                rows.add(name, strain, MICRO * z, values)
            panel.set(title=words, xlabel="depth $z$ [µm]", xlim=(0.0, MICRO * deep))
        axes[0].set(ylabel="yield stress [GPa]", ylim=(0.0, None))
        figure.legend(*axes[0].get_legend_handles_labels(), loc="outside lower center", ncols=len(cases))
    return Drawing(figure, rows)


STRAINS = {0.0: "Before any plastic strain", 0.01: "After a plastic strain of 1 %"}
"""Plastic strain -> title of its panel."""


ZONES = {"film whole": "#e3f0e3", "film failed, metal holds": "#fdf1d6"}
ZONES |= {"film broken down, metal removed": "#f6d9d2"}
DARK = "#555555"
TOP, STRONG = 12.0, 7.5  # GPa: of the pressure, unless runs reach more, and of the strength


def regime_map(
    limits: Mapping[str, Sequence[Limits]],
    reached: Mapping[str, tuple[float, float]],
    friction: tuple[float, float],
    constants: Sequence[str],
) -> Drawing:
    """Left: pressure that removes a spot without film over its friction; pressure of film breakdown. Right:
    the same over the strength of the surface, with the largest pressure of each run in its first and
    last cycle.

    limits: case -> those with each of the `constants` (in words; the first is that of the runs); reached:
    case -> (first, last) in Pa.
    """
    rows = Columns("case", "constant", "strength_GPa", "tears_GPa", "film_GPa", "first_GPa", "last_GPa")
    with sheet(10.6, 4.4, 2, sharey=True) as (figure, (left, right)):
        _over_friction(left, limits, friction, constants)
        _over_strength(right, limits, reached, friction[1])
        for name, values in limits.items():
            for words, one in zip(constants, values, strict=True):
                ends = reached.get(name, (np.nan,) * 2) if words == constants[0] else (np.nan,) * 2
                rows.add(name, words, *(GIGA * v for v in (one.strength, one.removal, one.film, *ends)))
        look = {"color": BLACK, "marker": "o", "linestyle": "none", "markersize": 4}
        marks = [
            Line2D([], [], **look, fillstyle=fill, label=f"strength with {words}")
            for fill, words in zip(("full", "none"), (constants[0], constants[-1]), strict=True)
        ]
        handles = [*left.get_legend_handles_labels()[0], *marks]
        figure.legend(handles=handles, loc="outside lower center", ncols=max(4, len(limits)))
    return Drawing(figure, rows)


def _over_friction(
    panel: Axes,
    limits: Mapping[str, Sequence[Limits]],
    friction: tuple[float, float],
    constants: Sequence[str],
) -> None:
    mu = np.linspace(0.05, 0.6, 200)
    for look, (name, values) in zip(LOOKS, limits.items(), strict=False):
        for line, one in zip(("-", ":"), values, strict=False):
            removal = GIGA * one.strength / (np.sqrt(3.0) * mu)
            panel.plot(mu, removal, color=look["color"], linestyle=line, linewidth=1.5)
        mark = {"color": look["color"], "marker": look["marker"], "markersize": 5}
        panel.plot([], [], **mark, linewidth=1.5, label=name)
    film = GIGA * next(iter(limits.values()))[0].film
    panel.axhline(film, color=BLACK, linewidth=1.0, linestyle="-.", label="film fails")
    box = {"facecolor": "white", "edgecolor": "none", "pad": 1.0}
    text = {"rotation": 90, "fontsize": 7.5, "ha": "center", "va": "bottom", "color": DARK, "bbox": box}
    for coefficient, words in zip(friction, ("film whole", "film failed"), strict=True):
        panel.axvline(coefficient, color=DARK, linewidth=0.8)
        panel.text(coefficient, 0.3, words, **text)
    for line, words in zip(("-", ":"), (constants[0], constants[-1]), strict=True):
        panel.plot([], [], color=BLACK, linewidth=1.5, linestyle=line, label=words)
    panel.set(xlabel="local coefficient of friction", ylabel="pressure [GPa]")
    panel.set(xlim=(0.05, 0.6), ylim=(0.0, TOP), title="removed above the line of its case")


def _over_strength(
    panel: Axes,
    limits: Mapping[str, Sequence[Limits]],
    reached: Mapping[str, tuple[float, float]],
    high: float,
) -> None:
    top = max([TOP, *(1.1 * GIGA * p for ends in reached.values() for p in ends)])
    film, strength = GIGA * next(iter(limits.values()))[0].film, np.linspace(0.0, STRONG, 100)
    edges = [0.0, film, np.minimum(np.maximum(strength / (np.sqrt(3.0) * high), film), top), top]
    places = ((4.6, 0.5 * film), (5.15, 4.9), (0.2, 11.3))
    for (words, color), low, upper, (x, y) in zip(ZONES.items(), edges[:-1], edges[1:], places, strict=True):
        panel.fill_between(strength, low, upper, color=color, linewidth=0.0)
        side = "center" if x > 1.0 else "left"
        panel.text(x, y, words, fontsize=8.5, style="italic", ha=side, va="center")
    panel.axhline(film, color=BLACK, linewidth=1.0, linestyle="-.")
    before: list[float] = []
    for look, (name, values) in zip(LOOKS, limits.items(), strict=False):
        mark = {"color": look["color"], "marker": look["marker"]}
        x = GIGA * values[0].strength
        x += 0.12 * sum(abs(x - other) < 0.1 for other in before)  # beside one that is as strong
        before.append(x)
        if name in reached:
            first, last = (GIGA * p for p in reached[name])
            arrow = {"arrowstyle": "->", "color": look["color"], "linewidth": 1.4}
            panel.annotate("", (x, last), (x, first), arrowprops=arrow)
            panel.plot(x, first, **mark, markersize=5)
        panel.plot(x, 0.15, **mark, markersize=4)
        panel.plot(GIGA * values[-1].strength, 0.15, **mark, markersize=4, fillstyle="none")
    panel.set(xlabel="yield stress of the surface at its strain limit [GPa]", xlim=(0.0, STRONG))
    panel.set(ylim=(0.0, top), title=f"with friction {high:g}: largest pressure, first → last cycle")


PALE = "#9fc8e3"  # of bars on which bounds are drawn


def probabilities(rows: Sequence[tuple[str, int, int, tuple[float, float]]]) -> Drawing:
    """A bar with its bounds for each statement. rows: words, points at which it holds, points at which it
    says anything, bounds of the share.
    """
    table = Columns("statement", "holds", "of", "low", "high")
    names, held, of, bounds = (list(each) for each in zip(*rows[::-1], strict=True))
    value, (low, high) = np.array(held) / np.maximum(of, 1), np.array(bounds).T
    with sheet(7.2, 0.8 + 0.24 * len(names)) as (figure, axis):
        axis.barh(names, value, color=PALE, height=0.6)
        ends = np.maximum([value - low, high - value], 0.0)
        axis.errorbar(
            value, range(len(names)), xerr=ends, fmt="none", ecolor=BLACK, elinewidth=1.0, capsize=3
        )
        for k, words in enumerate(f"{yes} of {all_}" for yes, all_ in zip(held, of, strict=True)):
            axis.text(1.02, k, words, va="center", fontsize=8.0, transform=axis.get_yaxis_transform())
        axis.axvline(0.5, color=BLACK, linewidth=0.6, gid=GUIDE)
        axis.set(xlabel="share of points at which the statement holds")
        axis.set(xlim=(0.0, 1.0), ylim=(-0.7, len(names) - 0.3))
        axis.set_axisbelow(True)
    table.add(names, held, of, low, high)
    return Drawing(figure, table)


SURFACES = (BLUE, VERMILION, GREEN, ORANGE, PURPLE, BLACK)


def over_cells(volumes: Mapping[str, Mapping[float, Sequence[float]]], default: float) -> Drawing:
    """A line for each surface through the means, with bars from the smallest to the largest.

    volumes: name of a surface -> cells in the shortest wave -> volumes in um3 of the surface shifted against
    the cells; default: the cells in the shortest wave that are recommended, marked by a line.
    """
    table = Columns("surface", "cells in the shortest wave", "mean V [µm³]", "smallest", "largest")
    with sheet(6.2, 3.6) as (figure, axis):
        for (name, of_cells), color in zip(volumes.items(), SURFACES, strict=False):
            cells = np.array(list(of_cells))
            mean, low, high = (
                np.array([of(each) for each in of_cells.values()]) for of in (np.mean, min, max)
            )
            axis.plot(cells, mean, color=color, marker="o", markersize=3.5, linewidth=1.2, label=name)
            ends = mean - low, high - mean
            axis.errorbar(cells, mean, ends, fmt="none", ecolor=color, elinewidth=2.2)
            table.add(name, cells, mean, low, high)
        axis.axvline(default, color=BLACK, linewidth=0.8, linestyle=":", label="recommended")
        axis.set(xlabel="cells in the shortest wave of the surface", ylabel="worn volume [µm³]", xscale="log")
        axis.set_ylim(bottom=0.0)
        log_ticks(axis.xaxis)
        figure.legend(loc="outside right center")
    return Drawing(figure, table)
