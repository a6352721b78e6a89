# SPDX-License-Identifier: MIT
"""Worn volume over the size of cells."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from verification.figures.style import (
    BLACK,
    BLUE,
    GREEN,
    ORANGE,
    PURPLE,
    VERMILION,
    Columns,
    Drawing,
    log_ticks,
    sheet,
)

COLORS = (BLUE, VERMILION, GREEN, ORANGE, PURPLE, BLACK)


def over_cells(volumes: Mapping[str, Mapping[float, Sequence[float]]], default: float) -> Drawing:
    """A line for each surface through the means, with bars from the smallest to the largest.

    volumes: name of a surface -> cells in the shortest wave -> volumes in um3 of the surface shifted against
    the cells; default: the cells in the shortest wave that are recommended, marked by a line.
    """
    table = Columns("surface", "cells in the shortest wave", "mean V [µm³]", "smallest", "largest")
    with sheet(6.2, 3.6) as (figure, axis):
        for (name, of_cells), color in zip(volumes.items(), COLORS, strict=False):
            cells = np.array(list(of_cells))
            mean, low, high = (
                np.array([of(each) for each in of_cells.values()]) for of in (np.mean, min, max)
            )
            axis.plot(cells, mean, color=color, marker="o", markersize=3.5, linewidth=1.2, label=name)
            ends = mean - low, high - mean
            axis.errorbar(cells, mean, ends, fmt="none", ecolor=color, elinewidth=2.2)
            table.add(name, cells, mean, low, high)
        axis.axvline(default, color=BLACK, linewidth=0.8, linestyle=":", label="recommended")
        axis.set(xlabel="cells in the shortest wave of the surface", ylabel="worn volume [µm³]", xscale="log")
        axis.set_ylim(bottom=0.0)
        log_ticks(axis.xaxis)
        figure.legend(loc="outside right center")
    return Drawing(figure, table)
