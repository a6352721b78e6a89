# SPDX-License-Identifier: MIT
"""Curves of several programs on logarithmic axes, each with its name at its end."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.axes import Axes

from verification.figures.style import BLACK, BLUE, GREEN, ORANGE, VERMILION, Columns, Drawing, sheet
from verification.figures.work_precision import APART, spread

LOOKS = {
    "SAM": {"color": BLUE, "marker": "o"},
    "Tamaas": {"color": VERMILION, "marker": "s"},
    "ContactMechanics": {"color": GREEN, "marker": "^"},
    "aspher": {"color": ORANGE, "marker": "D"},
}
LINES = ("-", "--", ":")  # first, second and third curve of a program
Series = Mapping[str, tuple[str, np.ndarray, np.ndarray]]
"""Label of the curve -> (program, x, y), in the order of the resolution."""


def curves(
    series: Series,
    xlabel: str,
    ylabel: str,
    columns: Sequence[str],
    *,
    target: float | None = None,
    floor: float = 0.0,
) -> Drawing:
    """log-log; columns: names of x and y in the data; target: a value of y that times are stated at; floor:
    shaded, no claims below.
    """
    rows = Columns("curve", columns[0], columns[1])
    looks = looks_of(series)
    with sheet(7.2, 4.2) as (figure, axis):
        for label, (_, x, y) in series.items():
            axis.loglog(x, y, **looks[label], linewidth=1.4, markersize=4.5, fillstyle="none")
            rows.add(label, x, y)
        low, high = axis.get_ylim()
        if target is not None:
            axis.axhline(target, color=BLACK, linewidth=0.8, linestyle=(0, (1, 3)))
        if floor > low:
            axis.axhspan(low, floor, color="#bbbbbb", alpha=0.45, linewidth=0.0)
        axis.set(xlabel=xlabel, ylabel=ylabel, ylim=(low, high))
        _name_ends(axis, series, looks)
    return Drawing(figure, rows)


def looks_of(series: Series) -> dict[str, Mapping[str, object]]:
    """Colour and marker of the program, a line of its own for each of its curves."""
    looks, seen = {}, dict.fromkeys(LOOKS, 0)
    for label, (program, _, _) in series.items():
        looks[label] = {**LOOKS[program], "linestyle": LINES[seen[program] % len(LINES)]}
        seen[program] += 1
    return looks


def _name_ends(axis: Axes, series: Series, looks: Mapping[str, Mapping[str, object]]) -> None:
    low, high = np.log(axis.get_ylim())
    ends = {label: (np.log(y[-1]) - low) / (high - low) for label, (_, _, y) in series.items() if len(y)}
    for label, height in spread(ends, APART).items():
        _, x, y = series[label]
        color = looks[label]["color"]
        axis.annotate(
            label,
            (x[-1], y[-1]),
            xytext=(1.03, height),
            textcoords="axes fraction",
            color=color,
            va="center",
            fontsize=8.0,
            annotation_clip=False,
            arrowprops={"arrowstyle": "-", "color": color, "linewidth": 0.5, "alpha": 0.6},
        )
