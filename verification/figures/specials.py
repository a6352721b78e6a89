# SPDX-License-Identifier: MIT
"""Figures of their own kind: agreement, bars with bounds, energies over a path, what a film changes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import SymLogNorm
from matplotlib.lines import Line2D
from matplotlib.ticker import FixedLocator, MaxNLocator, NullLocator
from scipy.interpolate import RectBivariateSpline

from verification.energy import Balance
from verification.figures.style import (
    BLACK,
    BLUE,
    GREEN,
    GUIDE,
    ORANGE,
    RC,
    VERMILION,
    Columns,
    Drawing,
    log_ticks,
    save,
    sheet,
)
from verification.figures.sweep import QUANTITIES

if TYPE_CHECKING:
    from pandas import DataFrame


def agreement(pairs: Sequence[tuple[str, str, float, float, str, str]]) -> Drawing:
    """Deviation of SAM by group. pairs: (group, kind of reference, predicted, reference, case, quantity)."""
    groups = list(dict.fromkeys(pair[0] for pair in pairs))
    kinds = sorted({pair[1] for pair in pairs}, reverse=True)
    data = Columns("group", "against", "predicted", "reference", "case", "quantity")
    for pair in pairs:
        data.add(*pair)
    with sheet(9.0, 0.9 + 0.42 * len(groups)) as (figure, axes):
        for width, colour in ((5.0, "#dfe8f0"), (1.0, "#bfd3e6")):
            axes.axvspan(-width, width, color=colour, zorder=0, label=f"within {width:g} %")
        axes.axvline(0.0, color="black", linewidth=0.8)
        for kind, colour, marker in zip(kinds, (VERMILION, BLUE), ("o", "D"), strict=False):
            own = [pair for pair in pairs if pair[1] == kind]
            off = [100.0 * (pair[2] / pair[3] - 1.0) for pair in own]
            # points of a row stand apart: a sequence that fills the height evenly, the golden ratio
            aside = 0.6 * (np.arange(len(own)) * 0.6180339887 % 1.0 - 0.5)
            rows = [groups.index(pair[0]) for pair in own] + aside
            axes.scatter(off, rows, s=14, color=colour, marker=marker, alpha=0.7, linewidths=0, label=kind)
        axes.set_xscale("symlog", linthresh=0.1)  # in %: nearer to zero differences reach rounding
        axes.xaxis.set_major_locator(FixedLocator((-30, -5, -1, -0.1, 0, 0.1, 1, 5, 30)))
        axes.xaxis.set_minor_locator(NullLocator())
        axes.xaxis.set_major_formatter(lambda value, _: _signed(value, " %"))
        farthest = max(50.0, 1.3 * max(map(abs, axes.dataLim.intervalx)))
        axes.set(xlim=(-farthest, farthest), ylim=(len(groups) - 0.5, -0.5))
        axes.set_yticks(np.arange(len(groups)), groups)
        axes.grid(visible=False, axis="y")
        axes.set_xlabel("relative deviation of SAM from its reference (symmetric logarithmic scale)")
        figure.legend(loc="outside upper center", ncols=4)
    return Drawing(figure, data)


def _signed(value: float, unit: str = "") -> str:
    return f"{value:+g}{unit}".replace("-", "\N{MINUS SIGN}") if value else "0"


SHOWN = {
    "mu_star": "mean change over the range of a key",
    "total": "total share of the variance",
    "rank_correlation": "correlation of ranks",
}
"""Index of a study of sensitivity that is drawn -> name of its axis."""
MORE = {
    "friction_coefficient": ("coefficient of friction", 1.0),
    "wear_volume_m3": ("wear volume [$\\mu$m$^3$]", 1e18),
}


def probabilities(rows: Sequence[tuple[str, int, int, tuple[float, float]]]) -> Drawing:
    """A bar with bounds for each statement. rows: words, points at which it holds, of how many, bounds."""
    table = Columns("statement", "holds", "of", "low", "high")
    names, held, of, bounds = (list(each) for each in zip(*rows[::-1], strict=True))
    low, high = np.array(bounds).T
    with sheet(7.2, 0.8 + 0.24 * len(names)) as (figure, axis):
        _bars(axis, names, np.array(held) / np.maximum(of, 1), (low, high), color="#9fc8e3")
        for k, (yes, every) in enumerate(zip(held, of, strict=True)):
            place = {"va": "center", "fontsize": 8.0, "transform": axis.get_yaxis_transform()}
            axis.text(1.02, k, f"{yes} of {every}", **place)
        axis.axvline(0.5, color=BLACK, linewidth=0.6, gid=GUIDE)
        label = "share of points at which the statement holds"
        axis.set(xlabel=label, xlim=(0.0, 1.0), ylim=(-0.7, len(names) - 0.3))
    table.add(names, held, of, low, high)
    return Drawing(figure, table)


def sensitivity_figure(rows: Sequence[Mapping], path: Path) -> None:
    """Draw the indices of a study as `path`.png, if there are any."""
    if rows:
        save(sensitivities(rows), path, data=False)


def sensitivities(rows: Sequence[Mapping]) -> Drawing:
    """How each varied key moves the main quantities, with confidence intervals. rows: of the indices."""
    table, of = Columns("quantity", "key", "value", "low", "high"), dict[str, list[Mapping]]()
    for row in reversed([each for each in rows if each["index"] in SHOWN]):
        of.setdefault(row["quantity"], []).append(row)
    labels = {name: look for name, look in (QUANTITIES | MORE).items() if name in of}
    height = 1.1 + 0.28 * len({row["key"] for row in rows})
    with sheet(0.4 + 3.0 * len(labels), height, len(labels)) as (figure, axes):
        for panel, (name, (label, factor)) in zip(axes, labels.items(), strict=True):
            effects, (quantity, *unit) = of[name][0]["index"] == "mu_star", label.partition(" [")
            scale, keys = factor if effects else 1.0, [row["key"] for row in of[name]]
            ends = ("value", "low", "high")
            value, low, high = (scale * np.array([row[key] for row in of[name]]) for key in ends)
            _bars(panel, keys, value, (low, high), color=BLUE)
            panel.set(title=quantity, xlabel=effects * "".join(unit).strip())
            table.add(name, keys, value, low, high)
        figure.supxlabel(SHOWN[of[name][0]["index"]], fontsize=RC["axes.labelsize"])
    return Drawing(figure, table)


def _bars(
    axis: Axes, names: list[str], value: np.ndarray, bounds: tuple[np.ndarray, np.ndarray], *, color: str
) -> None:
    """A bar for each name, with its bounds."""
    ends = np.maximum([value - bounds[0], bounds[1] - value], 0.0)
    axis.barh(names, value, color=color, height=0.6)
    axis.errorbar(value, range(len(names)), xerr=ends, fmt="none", ecolor=BLACK, elinewidth=0.9, capsize=2.5)
    axis.set_axisbelow(True)


def over_path(panels: Mapping[str, tuple[Balance, Balance | None]]) -> Drawing:
    """Shares of the largest work over the steps: title -> (SAM, FEM or None). Areas and line: SAM."""
    parts = {"dissipated": ORANGE, "stored by residual stress": GREEN, "recovered on unloading": BLUE}
    rows = Columns("panel", "model", "state", "force_N", "work", "stored", "dissipated")
    with sheet(4.2 * len(panels), 3.4, len(panels), sharey=True) as (figure, axes):
        for axis, (title, (sam, fem)) in zip(axes, panels.items(), strict=True):
            scale, states = sam.work.max(), np.arange(sam.work.size)
            shares = np.array([sam.dissipated, sam.stored, sam.elastic - sam.stored]) / scale
            axis.stackplot(states, shares, colors=parts.values(), alpha=0.6, labels=list(parts))
            axis.plot(states, sam.work / scale, color=BLACK, linewidth=1.6, label="work of the tractions")
            if fem is not None:
                axis.plot(fem.work / scale, "x", color=BLACK, label="FEM: work")
                axis.plot(fem.dissipated / scale, "+", color=BLACK, label="FEM: dissipated")
            axis.set(
                title=title, xlabel="load step, the last one unloaded", xlim=(0, states[-1]), ylim=(0.0, 1.1)
            )
            axis.xaxis.set_major_locator(MaxNLocator(integer=True))
            axis.legend(loc="upper left")
            for model, one in (("SAM", sam), ("FEM", fem)):
                if one is not None:
                    energies = (each / scale for each in (one.work, one.elastic + one.beyond, one.dissipated))
                    rows.add(title, model, range(one.work.size), one.force, *energies)
        axes[0].set_ylabel("share of the work at the peak")
    return Drawing(figure, rows)


def change_maps(maps: Mapping[str, DataFrame], paper: tuple[float, Mapping[str, float]]) -> Drawing:
    """Heat maps on logarithmic axes, of a bicubic spline through the points over the logarithms, with lines
    of 1 % and 5 %, one colour scale for all, and the film of the paper. maps: title -> changes as shares over
    thickness/a0 (index) and E1/E2 (columns); paper: its modulus ratio, and label -> thickness/a0 on some
    contact radii.
    """
    rows = Columns("map", "thickness_over_a0", "E1_over_E2", "change_percent")
    largest = 100.0 * max(np.abs(each.to_numpy()).max() for each in maps.values())
    norm = SymLogNorm(linthresh=1.0, linscale=0.5, vmin=-largest, vmax=largest)
    look: dict[str, Any] = {"color": GREEN, "marker": "o", "markersize": 4, "linewidth": 1.8}
    words: dict[str, Any] = {"textcoords": "offset points", "ha": "center", "va": "top", "fontsize": 7.5}
    with sheet(5.0 * len(maps), 4.4, len(maps), sharey=True) as (figure, axes):
        for axis, (title, each) in zip(axes, maps.items(), strict=True):
            sides, percent = (each.index.to_numpy(), each.columns.to_numpy()), 100.0 * each.to_numpy()
            dense = [np.geomspace(side.min(), side.max(), 200) for side in sides]
            fine = RectBivariateSpline(*map(np.log, sides), percent)(*map(np.log, dense)).T
            axis.set(xscale="log", yscale="log")
            how = {"shading": "gouraud", "cmap": "RdBu_r", "norm": norm, "rasterized": True}
            mesh = axis.pcolormesh(*dense, fine, **how)
            for limit, line in ((1, "--"), (5, "-")):
                axis.contour(*dense, fine, [-limit, limit], colors=BLACK, linestyles=line, linewidths=1.2)
            axis.grid(False)
            log_ticks(axis.xaxis)
            log_ticks(axis.yaxis)
            axis.set(title=title, xlabel="$h/a_0$, thickness over contact radius without film")
            modulus, places = paper
            axis.plot(list(places.values()), [modulus] * len(places), **look)
            for label, place in places.items():
                axis.annotate(label, (place, modulus), xytext=(0, -5), **words)
            rows.add(title, *(side.ravel() for side in np.meshgrid(*sides, indexing="ij")), percent.ravel())
        axes[0].set_ylabel("$E_1/E_2$, modulus of the film over that of the body")
        bar = figure.colorbar(mesh, ax=axes, label="change by the film [%]", fraction=0.04, pad=0.02)
        above = [t for t in (1, 2, 5, 10, 20, 50, 100) if t <= largest]
        ticks = [*(-t for t in above[::-1]), 0, *above]
        bar.set_ticks(ticks, labels=list(map(_signed, ticks)))
        bar.ax.yaxis.set_minor_locator(NullLocator())
        names = [Line2D([], [], color=BLACK, linestyle="--", label="±1 %")]
        names += [Line2D([], [], color=BLACK, linestyle="-", label="±5 %")]
        names += [Line2D([], [], label="film of the paper on contact radii", **look)]
        figure.legend(handles=names, loc="outside lower center", ncols=3)
    return Drawing(figure, rows)
