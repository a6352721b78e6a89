# SPDX-License-Identifier: MIT
"""The figures of running-in: six panels of a run (Bosman & Schipper 2011, Figs. 13-17), all runs over the
cycles, regimes.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import BoundaryNorm, LinearSegmentedColormap, ListedColormap
from matplotlib.figure import Figure
from matplotlib.patches import Patch
from matplotlib.ticker import MaxNLocator

from verification.compare.running_in_measures import History, Limits, Scar
from verification.figures.maps import draw_field
from verification.figures.style import (
    BLACK,
    BLUE,
    GREEN,
    ORANGE,
    VERMILION,
    Columns,
    Drawing,
    new_figure,
    sheet,
    style,
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
_SCAR = LinearSegmentedColormap.from_list("scar", ("#c9c9c9", ORANGE, VERMILION))
_OUT, _LOW, _HIGH = 0, 1, 2
_FRICTION = {
    _OUT: ("#000000", "no contact"),
    _LOW: ("#9a9a9a", "{:g}, film whole"),
    _HIGH: ("#ffffff", "{:g}, film failed"),
}


def six_panels(scar: Scar, history: History, friction: tuple[float, float]) -> Drawing:
    """(a) worn depth, (b) original over worn surface, (c) volume and (d) friction over the cycles, (e) local
    friction and (f) pressure at the last peak. friction: the low and the high coefficient.
    """
    with style():
        figure = new_figure(10.6, 6.4)
        grid = figure.add_gridspec(2, 3)
        worn, friction_map, pressure = (figure.add_subplot(grid[k]) for k in ((0, 0), (1, 1), (1, 2)))
        _map(worn, scar, 1e9 * scar.worn, "worn depth [nm]", cmap="viridis")
        worn.set_title("(a) worn depth")
        _surfaces(figure, grid[0, 1], scar)
        for place, title, column, label in (
            (grid[0, 2], "(c) wear volume", CUBIC * history.volume, "volume [µm³]"),
            (grid[1, 0], "(d) friction", history.friction, "coefficient of friction"),
        ):
            _over_cycles(figure.add_subplot(place), history.cycle, column, (title, label))
        figure.axes[-1].set_ylim(*_room(friction))
        _local_friction(friction_map, scar, friction)
        _map(
            pressure, scar, np.where(scar.in_contact, GIGA * scar.p, np.nan), "pressure [GPa]", cmap="plasma"
        )
        pressure.set_title("(f) pressure")
    return Drawing(figure, _columns(scar))


def _columns(scar: Scar) -> dict[str, np.ndarray]:
    """One row a cell; the cycles are in cycles.csv of the run."""
    x, y = np.meshgrid(scar.x, scar.y, indexing="ij")
    fields = {
        "x_m": x,
        "y_m": y,
        "height_m": scar.height,
        "worn_m": scar.worn,
        "p_Pa": scar.p,
        "friction": scar.friction,
    }
    return {name: field.ravel() for name, field in fields.items()}


def _room(friction: tuple[float, float]) -> tuple[float, float]:
    low, high = friction
    return low - 0.05 * (high - low), high + 0.05 * (high - low)


def _map(panel: Axes, scar: Scar, field: np.ndarray, label: str, *, cmap: str) -> None:
    largest = np.nanmax(field) if np.isfinite(field).any() else 0.0
    limits = {"vmin": 0.0, "vmax": largest if largest > 0.0 else 1.0}
    panel.set_facecolor("#dddddd")
    mesh = draw_field(panel, MICRO * scar.x, MICRO * scar.y, field, cmap=cmap, **limits)
    panel.figure.colorbar(mesh, ax=panel, label=label, fraction=0.05, pad=0.03)
    panel.set(**MAP_AXES)


def _surfaces(figure: Figure, place, scar: Scar) -> None:
    """Around the scar the worn surface, solid, coloured by the worn depth, and above it the original one,
    transparent.
    """
    near = _around(scar)
    x, y = np.meshgrid(MICRO * scar.x[near[0]], MICRO * scar.y[near[1]], indexing="ij")
    height, worn = MICRO * scar.height[near], MICRO * scar.worn[near]
    top = np.nanmax(worn)
    panel = figure.add_subplot(place, projection="3d", computed_zorder=False)
    look = {"rstride": 1, "cstride": 1, "linewidth": 0.0}
    colours = _SCAR(worn / top if top > 0.0 else np.zeros_like(worn))
    panel.plot_surface(x, y, height - worn, facecolors=colours, shade=True, **look, zorder=1)
    lost = np.where(worn > 0.02 * top, height, np.nan)
    if np.isfinite(lost).any():
        panel.plot_surface(x, y, lost, color=BLUE, alpha=0.3, shade=False, **look, zorder=2)
    panel.set_title("(b) original over worn, at the scar")
    panel.set_xlabel("$x$ [µm]", labelpad=-4)
    panel.set_ylabel("$y$ [µm]", labelpad=-4)
    panel.set_zlabel("height [µm]", labelpad=-4)
    panel.tick_params(labelsize=7, pad=-2)
    panel.view_init(elev=32.0, azim=-60.0)
    panel.set_box_aspect((1.0, 1.0, 0.5), zoom=0.92)


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
    if values.min() >= 0.0:
        panel.set_ylim(0.0, 1.06 * values.max() if values.max() > 0.0 else 1.0)


def _local_friction(panel: Axes, scar: Scar, friction: tuple[float, float]) -> None:
    """Black: no contact, grey: low, white: high, as in the paper."""
    state = np.where(scar.in_contact, np.where(scar.unprotected(*friction), _HIGH, _LOW), _OUT)
    cmap, norm = (
        ListedColormap([colour for colour, _ in _FRICTION.values()]),
        BoundaryNorm([-0.5, 0.5, 1.5, 2.5], 3),
    )
    draw_field(panel, MICRO * scar.x, MICRO * scar.y, state, cmap=cmap, norm=norm)
    panel.set(title="(e) local friction", **MAP_AXES)
    words = [text.format(*([] if k == _OUT else [friction[k - 1]])) for k, (_, text) in _FRICTION.items()]
    patches = [
        Patch(facecolor=colour, edgecolor="black", linewidth=0.6, label=word)
        for (colour, _), word in zip(_FRICTION.values(), words, strict=True)
    ]
    panel.legend(
        handles=patches,
        loc="upper center",
        bbox_to_anchor=(0.5, -0.17),
        ncols=3,
        fontsize=7,
        handlelength=1.2,
    )


PANELS = (
    ("volume", CUBIC, "wear volume [µm³]"),
    ("friction", 1.0, "coefficient of friction"),
    ("sa", 1e9, "Sa [nm]"),
)


def comparison(runs: Mapping[str, Sequence[History]]) -> Drawing:
    """Volume, friction and Sa over the cycles: the median of the surfaces of each case, and their range as a
    band.
    """
    rows = Columns("panel", "case", "cycle", "median", "lowest", "highest", "surfaces")
    with sheet(10.6, 3.9, len(PANELS)) as (figure, axes):
        for panel, (column, scale, label) in zip(axes, PANELS, strict=True):
            for look, (name, histories) in zip(LOOKS, runs.items(), strict=False):
                cycle = histories[0].cycle
                values = scale * np.array([getattr(history, column) for history in histories])
                middle, low, high = np.median(values, axis=0), values.min(axis=0), values.max(axis=0)
                panel.fill_between(cycle, low, high, color=look["color"], alpha=0.1, linewidth=0.0)
                panel.plot(cycle, middle, **look, markersize=3, linewidth=1.3, markevery=2, label=name)
                rows.add(column, name, cycle, middle, low, high, len(histories))
            panel.set(xlabel="cycle", ylabel=label)
            panel.xaxis.set_major_locator(MaxNLocator(integer=True))
        figure.legend(*axes[0].get_legend_handles_labels(), loc="outside lower center", ncols=len(runs))
    return Drawing(figure, rows)


ZONES = (
    ("#e3f0e3", "film whole"),
    ("#fdf1d6", "film failed, metal holds"),
    ("#f6d9d2", "film broken down, metal removed"),
)


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
        top = max([TOP, *(1.1 * GIGA * p for ends in reached.values() for p in ends)])
        _over_friction(left, limits, friction, constants)
        _over_strength(right, limits, reached, high=friction[1], top=top)
        for name, values in limits.items():
            for words, one in zip(constants, values, strict=True):
                ends = reached.get(name, (np.nan,) * 2) if words == constants[0] else (np.nan,) * 2
                rows.add(name, words, *(GIGA * v for v in (one.strength, one.removal, one.film, *ends)))
        figure.legend(*left.get_legend_handles_labels(), loc="outside lower center", ncols=len(limits) + 2)
    return Drawing(figure, rows)


def film_breaks_at(limits: Mapping[str, Sequence[Limits]]) -> float:
    """The pressure in GPa at which the film breaks down, the same in all cases."""
    return GIGA * next(iter(limits.values()))[0].film


TOP = 12.0  # GPa, unless runs reach more


def _over_friction(
    panel: Axes,
    limits: Mapping[str, Sequence[Limits]],
    friction: tuple[float, float],
    constants: Sequence[str],
) -> None:
    film = film_breaks_at(limits)
    mu = np.linspace(0.05, 0.6, 200)
    for look, (name, values) in zip(LOOKS, limits.items(), strict=False):
        for line, one in zip(("-", ":"), values, strict=False):
            removal = GIGA * one.strength / (np.sqrt(3.0) * mu)
            label = name if line == "-" else None
            panel.plot(mu, removal, color=look["color"], linestyle=line, linewidth=1.5, label=label)
    panel.axhline(film, color=BLACK, linewidth=1.0, linestyle="-.")
    panel.text(0.052, film - 0.15, "film fails", fontsize=7.5, va="top")
    for coefficient, words in zip(friction, ("film whole", "film failed"), strict=True):
        panel.axvline(coefficient, color="#777777", linewidth=0.8)
        box = {"facecolor": "white", "edgecolor": "none", "pad": 1.0}
        panel.text(
            coefficient,
            0.3,
            words,
            rotation=90,
            fontsize=7.5,
            ha="center",
            va="bottom",
            color="#555555",
            bbox=box,
        )
    panel.plot([], [], color="#555555", linewidth=1.5, linestyle="-", label=constants[0])
    panel.plot([], [], color="#555555", linewidth=1.5, linestyle=":", label=constants[-1])
    panel.set(
        xlabel="local coefficient of friction", ylabel="pressure [GPa]", xlim=(0.05, 0.6), ylim=(0.0, TOP)
    )
    panel.set_title("removed above the line of its case")


def _over_strength(
    panel: Axes,
    limits: Mapping[str, Sequence[Limits]],
    reached: Mapping[str, tuple[float, float]],
    *,
    high: float,
    top: float,
) -> None:
    _zones(panel, high, film_breaks_at(limits), top)
    places: list[float] = []
    for look, (name, values) in zip(LOOKS, limits.items(), strict=False):
        mark = {"color": look["color"], "marker": look["marker"]}
        x = GIGA * values[0].strength
        x += 0.12 * sum(abs(x - other) < 0.1 for other in places)  # beside one that is as strong
        places.append(x)
        if name in reached:
            first, last = (GIGA * p for p in reached[name])
            arrow = {"arrowstyle": "->", "color": look["color"], "linewidth": 1.4}
            panel.annotate("", (x, last), (x, first), arrowprops=arrow)
            panel.plot(x, first, **mark, markersize=5)
        panel.plot(x, 0.15, **mark, markersize=4)
        panel.plot(GIGA * values[-1].strength, 0.15, **mark, markersize=4, fillstyle="none")
    panel.set(
        xlabel="yield stress of the surface at its strain limit [GPa]", xlim=(0.0, 7.5), ylim=(0.0, top)
    )
    panel.set_title(f"with friction {high:g}: largest pressure, first → last cycle")


def _zones(panel: Axes, high: float, film: float, top: float) -> None:
    """The three regimes as colours, with their borders."""
    strength = np.linspace(0.0, 7.5, 100)
    removal = strength / (np.sqrt(3.0) * high)
    upper = np.maximum(removal, film)
    panel.fill_between(strength, 0.0, film, color=ZONES[0][0], linewidth=0.0)
    panel.fill_between(strength, film, np.minimum(upper, top), color=ZONES[1][0], linewidth=0.0)
    panel.fill_between(strength, np.minimum(upper, top), top, color=ZONES[2][0], linewidth=0.0)
    for (x, y), (_, words) in zip(((4.6, 0.5 * film), (5.15, 4.9), (1.2, 9.6)), ZONES, strict=True):
        panel.text(x, y, words, fontsize=8.5, ha="center", va="center", style="italic")
    panel.plot(strength, removal, color="#555555", linewidth=1.0)
    panel.axhline(film, color=BLACK, linewidth=1.0, linestyle="-.")
