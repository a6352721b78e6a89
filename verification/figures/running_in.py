# SPDX-License-Identifier: MIT
"""The figures of running-in: six panels of a run (Bosman & Schipper 2011, Figs. 13-17), its
surface, and the regimes of film and metal.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import BoundaryNorm, LightSource, ListedColormap
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.ticker import MaxNLocator

from verification.compare.running_in_measures import History, Limits, Scar
from verification.figures.maps import coloured, draw_field, outline
from verification.figures.places import edges_of
from verification.figures.style import BLACK, BLUE, GREEN, GREY, ORANGE, VERMILION, Columns, Drawing, sheet

MICRO, GIGA = 1e6, 1e-9
MAP_AXES = {"xlabel": "$x$ [µm]", "ylabel": "$y$ [µm]"}
BELOW_PANEL = {"loc": "upper center", "bbox_to_anchor": (0.5, -0.17), "fontsize": 7}


def six_panels(scar: Scar, history: History, friction: tuple[float, float]) -> Drawing:
    """(a) worn depth, (b) the worn surface in relief, (c) volume and (d) friction over the cycles, (e) local
    friction and (f) pressure at the last peak. friction: the low and the high coefficient.
    """
    x, y, nothing = MICRO * scar.x, MICRO * scar.y, " no wear"
    with sheet(10.6, 6.6, (2, 3)) as (figure, axes):
        (worn, relief, volume), (over_cycles, local, pressure) = axes
        depth = np.where(scar.worn > 0.0, 1e9 * scar.worn, np.nan)
        touching = np.where(scar.in_contact, GIGA * scar.p, np.nan)
        for panel, field, label, colours in (
            (worn, depth, "worn depth [nm]", "viridis"),
            (pressure, touching, "pressure [GPa]", "plasma"),
        ):
            if np.isfinite(field).any():
                coloured(panel, (x, y), field, label, cmap=colours, vmin=0.0)
            panel.set(xlim=_ends(x), ylim=_ends(y), facecolor=GREY, aspect="equal", **MAP_AXES)
            panel.grid(False)
        worn.set_title("(a) worn depth" + f":{nothing}" * (not (scar.worn > 0.0).any()))
        pressure.set_title("(f) pressure")
        _relief(relief, scar)
        removed = 1e18 * history.volume
        for panel, values in ((volume, removed), (over_cycles, history.friction)):
            panel.plot(history.cycle, values, color=BLUE, marker="o", markersize=3, linewidth=1.3)
            panel.set(xlabel="cycle", xlim=(0.0, history.cycle[-1] + 0.5))
            panel.xaxis.set_major_locator(MaxNLocator(integer=True))
        top = 1.06 * removed.max() or 1.0
        volume.set(ylabel="volume [µm³]", ylim=(-0.05 * (not removed.any()), top))
        volume.set_title("(c) wear volume" + f":{nothing}" * (not removed.any()))
        room = 0.05 * (friction[1] - friction[0])
        over_cycles.set(title="(d) friction, this surface", ylabel="coefficient of friction")
        over_cycles.set_ylim(friction[0] - room, friction[1] + room)
        _local_friction(local, scar, friction)
    return Drawing(figure, _columns(scar, worn_m=scar.worn, p_Pa=scar.p, friction=scar.friction))


def _columns(scar: Scar, **more: np.ndarray) -> dict[str, np.ndarray]:
    """One row a cell; the cycles are in cycles.csv of the run. more: columns beside places and heights."""
    x, y = np.meshgrid(scar.x, scar.y, indexing="ij")
    fields = {"x_m": x, "y_m": y, "height_m": scar.height, **more}
    return {name: field.ravel() for name, field in fields.items()}


def _ends(places: np.ndarray) -> tuple[float, float]:
    return edges_of(places)[0], edges_of(places)[-1]


def _relief(panel: Axes, scar: Scar) -> None:
    """The worn surface around its scar, or without one its contact, and a third of its size beside
    it, as if lit from the upper left; and the edge of what is worn.
    """
    marked, near = scar.worn > 0.0 if (scar.worn > 0.0).any() else scar.in_contact, []
    for axis in (1, 0):
        cells = np.flatnonzero(marked.any(axis=axis)) if marked.any() else np.arange(marked.shape[1 - axis])
        beside = max(4, (cells[-1] - cells[0]) // 3)
        near.append(slice(max(0, cells[0] - beside), cells[-1] + beside + 1))
    x, y, height = MICRO * scar.x[near[0]], MICRO * scar.y[near[1]], (scar.height - scar.worn)[*near]
    steep = np.std(np.gradient(height, x, y)) or 1.0
    sun = LightSource(azdeg=315.0, altdeg=40.0)
    light = sun.hillshade(height.T, vert_exag=1.0 / steep, dx=x[1] - x[0], dy=y[1] - y[0])
    how = {"origin": "lower", "extent": (*_ends(x), *_ends(y)), "interpolation": "bilinear"}
    panel.imshow(np.repeat(light[..., None], 3, axis=2), **how)
    panel.grid(False)
    removed, edge = scar.worn[*near] > 0.0, {"color": VERMILION, "linewidth": 1.0}
    if removed.any():
        outline(panel, x, y, removed, **edge)
        panel.legend(handles=[Line2D([], [], **edge, label="edge of what is worn")], **BELOW_PANEL)
    panel.set(title=f"(b) {'worn ' * bool(removed.any())}surface in relief", **MAP_AXES)


def _local_friction(panel: Axes, scar: Scar, friction: tuple[float, float]) -> None:
    """Where there is no contact, and where friction is low or high."""
    low, high = friction
    looks = {"no contact": GREY, f"{low:g}, film whole": BLUE, f"{high:g}, film failed": ORANGE}
    state = np.where(scar.in_contact, np.where(scar.unprotected(*friction), 2, 1), 0)
    how = {"cmap": ListedColormap(list(looks.values())), "norm": BoundaryNorm([-0.5, 0.5, 1.5, 2.5], 3)}
    draw_field(panel, MICRO * scar.x, MICRO * scar.y, state, **how)
    panel.set(title="(e) local friction", **MAP_AXES)
    patches = [Patch(facecolor=colour, label=words) for words, colour in looks.items()]
    panel.legend(handles=patches, **BELOW_PANEL, ncols=3, handlelength=1.2)


LOOKS = (
    {"color": BLACK, "marker": "o"},
    {"color": BLUE, "marker": "s"},
    {"color": VERMILION, "marker": "P"},
    {"color": ORANGE, "marker": "X"},
    {"color": GREEN, "marker": "D"},
)
"""Of the five cases, in order."""
ZONES = {
    "film whole": ("#e3f0e3", (4.6, 1.7)),
    "film failed, metal holds": ("#fdf1d6", (5.15, 4.9)),
    "film broken down, metal removed": ("#f6d9d2", (0.2, 11.3)),
}
"""Words -> colour and place of the words, in GPa."""
DARK = "#555555"
TOP, STRONG = 12.0, 7.5  # GPa: of the pressure, unless runs reach more, and of the strength


def regime_map(
    limits: Mapping[str, Sequence[Limits]],
    reached: Mapping[str, tuple[float, float]],
    friction: tuple[float, float],
    constants: Sequence[str],
) -> Drawing:
    """Left: pressure that removes a spot without film over its friction; pressure of film
    breakdown. Right: the same over the strength of the surface, with the largest pressure of each
    run in its first and last cycle.

    limits: case -> those with each of the `constants` (in words; the first is that of the runs);
    reached: case -> (first, last) in Pa.
    """
    rows = Columns("case", "constant", "strength_GPa", "tears_GPa", "film_GPa", "first_GPa", "last_GPa")
    film = GIGA * next(iter(limits.values()))[0].film
    with sheet(10.6, 4.4, 2, sharey=True) as (figure, (left, right)):
        _over_friction(left, limits, friction, film)
        _over_strength(right, limits, reached, (friction[1], film))
        for name, values in limits.items():
            for words, one in zip(constants, values, strict=True):
                ends = reached.get(name, (np.nan,) * 2) if words == constants[0] else (np.nan,) * 2
                rows.add(name, words, *(GIGA * v for v in (one.strength, one.removal, one.film, *ends)))
        handles = left.get_legend_handles_labels()[0]
        for words, line, fill in zip((constants[0], constants[-1]), "-:", ("full", "none"), strict=True):
            handles.append(Line2D([], [], color=BLACK, linewidth=1.5, linestyle=line, label=words))
            mark = {"color": BLACK, "marker": "o", "linestyle": "none", "markersize": 4, "fillstyle": fill}
            handles.append(Line2D([], [], **mark, label=f"strength with {words}"))
        figure.legend(handles=handles, loc="outside lower center", ncols=max(4, len(limits)))
    return Drawing(figure, rows)


def _over_friction(
    panel: Axes, limits: Mapping[str, Sequence[Limits]], friction: tuple[float, float], film: float
) -> None:
    mu = np.linspace(0.05, 0.6, 200)
    for look, (name, values) in zip(LOOKS, limits.items(), strict=False):
        for line, one in zip("-:", values, strict=False):
            removal = GIGA * one.strength / (np.sqrt(3.0) * mu)
            panel.plot(mu, removal, color=look["color"], linestyle=line, linewidth=1.5)
        panel.plot([], [], **look, markersize=5, linewidth=1.5, label=name)
    panel.axhline(film, color=BLACK, linewidth=1.0, linestyle="-.", label="film fails")
    box = {"facecolor": "white", "edgecolor": "none", "pad": 1.0}
    text = {"rotation": 90, "fontsize": 7.5, "ha": "center", "va": "bottom", "color": DARK, "bbox": box}
    for coefficient, words in zip(friction, ("film whole", "film failed"), strict=True):
        panel.axvline(coefficient, color=DARK, linewidth=0.8)
        panel.text(coefficient, 0.3, words, **text)
    panel.set(xlabel="local coefficient of friction", ylabel="pressure [GPa]")
    panel.set(xlim=(0.05, 0.6), ylim=(0.0, TOP), title="removed above the line of its case")


def _over_strength(
    panel: Axes,
    limits: Mapping[str, Sequence[Limits]],
    reached: Mapping[str, tuple[float, float]],
    at: tuple[float, float],
) -> None:
    """at: the high coefficient of friction and the pressure at which films fail."""
    (high, film), strength = at, np.linspace(0.0, STRONG, 100)
    top = max([TOP, *(1.1 * GIGA * p for ends in reached.values() for p in ends)])
    edges = [0.0, film, np.minimum(np.maximum(strength / (np.sqrt(3.0) * high), film), top), top]
    for (words, (color, (x, y))), low, upper in zip(ZONES.items(), edges[:-1], edges[1:], strict=True):
        panel.fill_between(strength, low, upper, color=color, linewidth=0.0)
        side = "center" if x > 1.0 else "left"
        panel.text(x, y, words, fontsize=8.5, style="italic", ha=side, va="center")
    panel.axhline(film, color=BLACK, linewidth=1.0, linestyle="-.")
    before: list[float] = []
    for look, (name, values) in zip(LOOKS, limits.items(), strict=False):
        x = GIGA * values[0].strength
        x += 0.12 * sum(abs(x - other) < 0.1 for other in before)  # beside one that is as strong
        before.append(x)
        if name in reached:
            first, last = (GIGA * p for p in reached[name])
            arrow = {"arrowstyle": "->", "color": look["color"], "linewidth": 1.4}
            panel.annotate("", (x, last), (x, first), arrowprops=arrow)
            panel.plot(x, first, **look, markersize=5)
        panel.plot(x, 0.15, **look, markersize=4)
        panel.plot(GIGA * values[-1].strength, 0.15, **look, markersize=4, fillstyle="none")
    panel.set(xlabel="yield stress of the surface at its strain limit [GPa]", xlim=(0.0, STRONG))
    panel.set(ylim=(0.0, top), title=f"with friction {high:g}: largest pressure, first → last cycle")
