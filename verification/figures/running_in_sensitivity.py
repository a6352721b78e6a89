# SPDX-License-Identifier: MIT
"""Statements on running-in over uncertain inputs: how probable each is, and where most of them hold."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.ticker import MaxNLocator

from verification.figures.style import BLACK, GUIDE, VERMILION, Columns, Drawing, log_ticks, sheet

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


def best_pair(
    places: Sequence[Sequence[float]],
    labels: Sequence[str],
    counts: np.ndarray,
    logarithmic: Sequence[bool],
    *,
    printed: Sequence[float],
) -> Drawing:
    """A mark for each point over two inputs, coloured by the number of statements that hold there. printed:
    the two printed inputs.
    """
    table = Columns(*labels, "statements that hold")
    with sheet(5.6, 4.2) as (figure, axis):
        marks = axis.scatter(*places, c=counts, cmap="viridis", s=36, edgecolors=BLACK, linewidths=0.4)
        figure.colorbar(marks, ax=axis, label="statements that hold", ticks=MaxNLocator(integer=True))
        axis.plot(
            *printed,
            "x",
            color=VERMILION,
            markersize=9,
            markeredgewidth=2,
            clip_on=False,
            label="printed inputs",
        )
        axis.set(xlabel=labels[0], ylabel=labels[1], axisbelow=True)
        for of, scale, yes in zip(
            (axis.xaxis, axis.yaxis), (axis.set_xscale, axis.set_yscale), logarithmic, strict=True
        ):
            if yes:
                scale("log")
                log_ticks(of)
        figure.legend(loc="outside upper left")
    table.add(*places, counts)
    return Drawing(figure, table)
