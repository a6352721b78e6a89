# SPDX-License-Identifier: MIT
"""Relative differences of two models over the size of the contact, with the fits from which limits are
taken.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np

from verification.figures.style import BLACK, BLUE, GREEN, ORANGE, VERMILION, Columns, Drawing, sheet

_COLOURS = (BLUE, VERMILION, ORANGE, BLACK)
_MARKS = ("o", "x", "s", "+")
Series = Mapping[str, tuple[np.ndarray, np.ndarray, Callable[[np.ndarray], np.ndarray]]]


def limits(panels: Mapping[str, Series], band: float) -> Drawing:
    """panels: quantity -> material -> (a/R, relative difference, its fit); band: shaded on both sides of
    zero.
    """
    rows = Columns("quantity", "material", "a_over_R", "difference_percent", "fit_percent")
    columns = 2 if len(panels) > 3 else len(panels)
    rows_down = -(-len(panels) // columns)
    with sheet(3.6 * columns, 3.0 * rows_down, (rows_down, columns)) as (figure, grid):
        for axis, (title, series) in zip(axes := grid.ravel(), panels.items(), strict=False):
            for (name, (x, values, fit)), colour, mark in zip(series.items(), _COLOURS, _MARKS, strict=False):
                look = {"color": colour, "marker": mark, "markersize": 3.0, "fillstyle": "none"}
                axis.plot(x, 1e2 * values, **look, linestyle="none")
                axis.plot([], [], **look, linewidth=1.2, label=f"{name} and its fit")
                dense = np.linspace(0.0, x.max(), 200)
                axis.plot(dense, 1e2 * fit(dense), color=colour, linewidth=1.2)
                rows.add(title, name, x, 1e2 * values, 1e2 * fit(x))
            axis.axhspan(-1e2 * band, 1e2 * band, color=GREEN, alpha=0.15, linewidth=0.0)
            axis.set(title=title.capitalize(), xlabel="$a/R$", ylabel="difference [%]", xlim=(0.0, None))
        figure.legend(*axes[0].get_legend_handles_labels(), loc="outside lower center", ncols=2)
    return Drawing(figure, rows)
