# SPDX-License-Identifier: MIT
"""Every number of SAM beside its reference: the ratio of both, a row for each group of cases."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.ticker import FixedLocator, FuncFormatter, NullLocator

from verification.figures.style import BLUE, VERMILION, Columns, Drawing, sheet

BANDS = ((5.0, "#dfe8f0"), (1.0, "#bfd3e6"))
LINEAR = 0.1  # in %: closer than that the axis is linear, as differences reach rounding
LEAST_WIDTH = 50.0  # of either side, in %
TICKS = (-30, -5, -1, -0.1, 0, 0.1, 1, 5, 30)
COLOURS = (VERMILION, BLUE)
MARKERS = ("o", "D")


def agreement(pairs: Sequence[tuple[str, str, float, float, str, str]]) -> Drawing:
    """SAM over reference. pairs: (group, kind of the reference, predicted, reference, case, quantity)."""
    groups = list(dict.fromkeys(pair[0] for pair in pairs))
    kinds = sorted({pair[1] for pair in pairs}, reverse=True)
    data = Columns("group", "against", "predicted", "reference", "case", "quantity")
    for pair in pairs:
        data.add(*pair)
    with sheet(9.0, 0.9 + 0.42 * len(groups)) as (figure, axes):
        for width, colour in BANDS:
            axes.axvspan(-width, width, color=colour, zorder=0, label=f"within {width:g} %")
        axes.axvline(0.0, color="black", linewidth=0.8)
        for kind, colour, marker in zip(kinds, COLOURS, MARKERS, strict=False):
            own = [pair for pair in pairs if pair[1] == kind]
            off = [100.0 * (pair[2] / pair[3] - 1.0) for pair in own]
            rows = [groups.index(pair[0]) + _aside(k) for k, pair in enumerate(own)]
            axes.scatter(off, rows, s=14, color=colour, marker=marker, alpha=0.7, linewidths=0, label=kind)
        _scales(axes, groups)
        figure.legend(loc="outside upper center", ncols=4)
    return Drawing(figure, data)


def _aside(k: int) -> float:
    """Points of a row stand apart: a sequence that fills the height evenly, the golden ratio."""
    return 0.6 * ((k * 0.6180339887) % 1.0 - 0.5)


def _scales(axes, groups: Sequence[str]) -> None:
    axes.set_xscale("symlog", linthresh=LINEAR)
    axes.xaxis.set_major_locator(FixedLocator(TICKS))
    axes.xaxis.set_minor_locator(NullLocator())
    axes.xaxis.set_major_formatter(
        FuncFormatter(lambda value, _: f"{value:+g} %".replace("-", "\N{MINUS SIGN}") if value else "0")
    )
    farthest = max(LEAST_WIDTH, 1.3 * max(map(abs, axes.dataLim.intervalx)))
    axes.set_xlim(-farthest, farthest)
    axes.set_yticks(np.arange(len(groups)), groups)
    axes.set_ylim(len(groups) - 0.5, -0.5)
    axes.grid(visible=False, axis="y")
    axes.set_xlabel("SAM over its reference, less one")
