# SPDX-License-Identifier: MIT
"""Statements on running-in over uncertain inputs: how probable each is, and where most of them hold."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from verification.figures.style import BLACK, BLUE, Columns, Drawing, sheet


def probabilities(names: Sequence[str], bounds: Sequence[tuple[float, float, float]]) -> Drawing:
    """A bar for each statement. bounds: probability, its lower and its upper bound."""
    table = Columns("statement", "probability", "low", "high")
    value, low, high = np.array(bounds[::-1]).T
    with sheet(6.8, 0.8 + 0.24 * len(names)) as (figure, axis):
        axis.barh(list(names[::-1]), value, color=BLUE, height=0.6)
        ends = np.maximum([value - low, high - value], 0.0)
        axis.errorbar(
            value, range(len(names)), xerr=ends, fmt="none", ecolor=BLACK, elinewidth=0.8, capsize=2
        )
        axis.set(xlabel="probability that the statement holds", xlim=(0.0, 1.0))
        axis.set_axisbelow(True)
    table.add(names[::-1], value, low, high)
    return Drawing(figure, table)


def best_pair(
    places: Sequence[Sequence[float]], labels: Sequence[str], counts: np.ndarray, logarithmic: Sequence[bool]
) -> Drawing:
    """A mark for each point over two inputs, coloured by the number of statements that hold there."""
    table = Columns(*labels, "statements that hold")
    with sheet(5.2, 3.8) as (figure, axis):
        marks = axis.scatter(*places, c=counts, cmap="viridis", s=28)
        figure.colorbar(marks, ax=axis, label="statements that hold")
        axis.set(xlabel=labels[0], ylabel=labels[1])
        for scale, yes in zip((axis.set_xscale, axis.set_yscale), logarithmic, strict=True):
            scale("log" if yes else "linear")
    table.add(*places, counts)
    return Drawing(figure, table)
