# SPDX-License-Identifier: MIT
"""Residuals over the iterations of each load step, semi-logarithmic: a panel for each solve."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.lines import Line2D
from matplotlib.ticker import MaxNLocator

from sam.scene import Attempt
from verification.figures.style import BLACK, BLUE, VERMILION, Columns, Drawing, sheet

COLUMNS = 4
PALE = 0.25
"""Opacity of the first step; the last one has 1."""
_GOAL = {"color": BLACK, "linestyle": ":", "linewidth": 0.9}


def histories(panels: Mapping[str, Sequence[tuple[str, Attempt]]]) -> Drawing:
    """Title -> (name, attempt) of all steps; the last ones are darker, attempts that were discarded are red.

    A residual of zero has no place on a logarithmic axis, and is in the data only.
    """
    data = Columns("solve", "step", "accepted", "iteration", "residual", "goal")
    rows = -(-len(panels) // COLUMNS)
    with sheet(2.6 * COLUMNS, 0.5 + 2.3 * rows, (rows, COLUMNS), sharey=True) as (figure, grid):
        for axis, (title, curves) in zip(axes := grid.ravel(), panels.items(), strict=False):
            for shade, (name, attempt) in zip(np.linspace(PALE, 1.0, len(curves)), curves, strict=True):
                at = np.arange(1, len(attempt.residuals) + 1)
                color = BLUE if attempt.accepted else VERMILION
                shown = [value if value > 0.0 else np.nan for value in attempt.residuals]
                axis.semilogy(at, shown, color=color, alpha=shade, linewidth=1.1)
                axis.axhline(attempt.goal, **_GOAL)
                data.add(title, name, attempt.accepted, at.tolist(), attempt.residuals, attempt.goal)
            axis.set(title=title, xlabel="iteration")
            axis.title.set_fontsize(8.5)
            axis.xaxis.set_major_locator(MaxNLocator(5, integer=True, min_n_ticks=2))
        for axis in axes[len(panels) :]:
            axis.set_visible(False)
        for axis in grid[:, 0]:
            axis.set_ylabel("residual")
        figure.legend(handles=_names(), loc="outside lower center", ncols=4)
    return Drawing(figure, data)


def _names() -> list[Line2D]:
    return [
        Line2D([], [], color=BLUE, alpha=PALE, label="first load step"),
        Line2D([], [], color=BLUE, label="last load step"),
        Line2D([], [], color=VERMILION, label="attempt given up: its step is cut"),
        Line2D([], [], **_GOAL, label="goal"),
    ]
