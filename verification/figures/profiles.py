# SPDX-License-Identifier: MIT
"""Curves against the closed form with the error underneath, and errors against the cell size."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes

from verification.figures.maps import INTERFACE, mark_interface
from verification.figures.style import (
    BLUE,
    EXACT,
    FEM,
    GREEN,
    ORANGE,
    SAM,
    VERMILION,
    Columns,
    Drawing,
    sheet,
    zero_line,
)
from verification.reference.convergence import Order

IN_ROW = 3
"""Panels side by side; more stand in two columns."""
CLOSED_FORM = "closed form"
_SERIES = {"SAM": SAM, "FEM": FEM}
_MARKERS = {
    "SAM": {"marker": "o", "fillstyle": "none", "linestyle": "none"},
    "FEM": {"marker": "x", "linestyle": "none"},
}


@dataclass(frozen=True)
class Profile:
    """One panel: an exact curve, the computed series, and what their difference is divided by.

    exact: x -> y (vectorised); series: "SAM" or "FEM" -> (x, y); scale: the error is 100 (y - exact) / scale;
    points: draw markers instead of lines; xlim: what is shown (and written).
    """

    title: str
    xlabel: str
    ylabel: str
    exact: Callable[[np.ndarray], np.ndarray]
    series: Mapping[str, tuple[np.ndarray, np.ndarray]]
    scale: float
    scale_name: str
    xlim: tuple[float, float]
    points: bool = False


def profiles(
    panels: Sequence[Profile], reference: str = CLOSED_FORM, *, interface: float | None = None
) -> Drawing:
    """Each panel above its error in %; interface: x at which a film ends, a line."""
    rows, across = profile_rows(reference), len(panels) if len(panels) <= IN_ROW else 2
    bands = -(-len(panels) // across)
    size = max(3.3 * across, 5.0), 4.2 * bands
    with sheet(*size, (2 * bands, across), height_ratios=(3, 1.3) * bands) as (figure, axes):
        for k, panel in enumerate(panels):
            band, column = divmod(k, across)
            upper, lower = axes[2 * band : 2 * band + 2, column]
            draw_profile((upper, lower), panel, reference, rows)
            if interface is not None:
                mark_interface((upper, lower), interface)
        entries = axes[0, 0].get_legend_handles_labels()[0] + [INTERFACE] * (interface is not None)
        axes[0, 0].legend(handles=entries)
        figure.align_ylabels()
    return Drawing(figure, rows)


def profile_rows(reference: str) -> Columns:
    """The empty columns that `draw_profile` fills."""
    return Columns("panel", "series", "x", "value", reference.replace(" ", "_"), "error_percent")


def draw_profile(axes: tuple[Axes, Axes], panel: Profile, reference: str, rows: Columns) -> None:
    """A panel above its error; its numbers are added to `rows`."""
    upper, lower = axes
    for name, (x, y) in panel.series.items():
        inside = (x >= panel.xlim[0]) & (x <= panel.xlim[1])
        x, y = x[inside], y[inside]
        exact = panel.exact(x)
        error = 100.0 * (y - exact) / panel.scale
        look = _SERIES[name] | (_MARKERS[name] if panel.points else {})
        upper.plot(x, y, **look, label=name)
        lower.plot(x, error, **look)
        rows.add(panel.title, name, x, y, exact, error)
    dense = np.linspace(*panel.xlim, 801)
    look = EXACT | (FEM if reference == "FEM" else {})
    upper.plot(dense, panel.exact(dense), **look, label=reference, zorder=3)
    upper.set(title=panel.title, ylabel=panel.ylabel, xlim=_shown(panel))
    lower.sharex(upper)
    upper.tick_params(labelbottom=False)
    zero_line(lower)
    word = "error" if reference == CLOSED_FORM else "difference"
    lower.set(xlabel=panel.xlabel, ylabel=f"{word}\n[% of {panel.scale_name}]")


def _shown(panel: Profile) -> tuple[float, float]:
    """The limits of x, with room for markers at the ends."""
    room = 0.03 * (panel.xlim[1] - panel.xlim[0]) if panel.points else 0.0
    return panel.xlim[0] - room, panel.xlim[1] + room


def convergence(panels: Mapping[str, Mapping[str, tuple[np.ndarray, np.ndarray, Order | None]]]) -> Drawing:
    """log-log error against cell size; panels: title -> quantity -> (h/a, relative error, fitted order or
    None).
    """
    rows = Columns("panel", "quantity", "h_over_a", "relative_error", "fitted_order")
    names = dict.fromkeys(name for curves in panels.values() for name in curves)
    looks = dict(zip(names, ((BLUE, "o"), (VERMILION, "s"), (GREEN, "^"), (ORANGE, "D")), strict=False))
    with sheet(4.4 * len(panels), 3.9, len(panels), sharey=True) as (figure, axes):
        for axis, (title, curves) in zip(axes, panels.items(), strict=True):
            for name, (h, error, order) in curves.items():
                color, marker = looks[name]
                axis.loglog(h, error, marker=marker, color=color, linestyle="none")
                label, line = name, "none"
                if order is not None:
                    ends = np.array([np.min(h), np.max(h)])
                    axis.loglog(ends, order(ends), color=color, linewidth=1.0)
                    label, line = f"{name}: order {order.order:.2f}", "-"
                axis.plot([], [], marker=marker, color=color, linestyle=line, linewidth=1.0, label=label)
                rows.add(title, name, h, error, None if order is None else order.order)
            _finish(axis, title, [h for h, _, _ in curves.values()])
        axes[0].set_ylabel("relative error")
    return Drawing(figure, rows)


def _finish(axis: Axes, title: str, sizes: Sequence[np.ndarray]) -> None:
    """Ticks at the cell sizes used, written as a/n."""
    used = np.unique(np.round(np.concatenate(sizes), 9))
    axis.set_xticks(used, [f"a/{1.0 / h:.3g}" for h in used])
    axis.set_xticks([], minor=True)
    axis.set(title=title, xlabel="cell size")
    axis.legend(loc="best")
