# SPDX-License-Identifier: MIT
"""Residuals over the iterations of each load step, semi-logarithmic: a panel for each solve."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from sam.scene import Attempt
from verification.figures.style import BLACK, BLUE, VERMILION, Columns, Drawing, sheet

COLUMNS = 4


def histories(panels: Mapping[str, Sequence[tuple[str, Attempt]]]) -> Drawing:
    """Title -> (name, attempt) of all steps; the last ones are darker, attempts that were discarded are
    red.
    """
    data = Columns("solve", "step", "accepted", "iteration", "residual", "goal")
    rows = -(-len(panels) // COLUMNS)
    with sheet(2.5 * COLUMNS, 2.3 * rows, (rows, COLUMNS), sharey=True) as (figure, grid):
        for axis, (title, curves) in zip(axes := grid.ravel(), panels.items(), strict=False):
            for k, (name, attempt) in enumerate(curves, start=1):
                at = np.arange(1, len(attempt.residuals) + 1)
                color = BLUE if attempt.accepted else VERMILION
                axis.semilogy(
                    at,
                    np.maximum(attempt.residuals, 1e-17),
                    color=color,
                    alpha=k / len(curves),
                    linewidth=1.1,
                )
                axis.axhline(attempt.goal, color=BLACK, linestyle=":", linewidth=0.9)
                data.add(title, name, attempt.accepted, at.tolist(), attempt.residuals, attempt.goal)
            axis.set_title(title)
            axis.set_xlabel("iteration")
        for axis in axes[len(panels) :]:
            axis.set_visible(False)
        axes[0].set_ylabel("residual")
    return Drawing(figure, data)
