# SPDX-License-Identifier: MIT
"""Running-in in several readings of the paper: each case over the cycles, the readings in one panel."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.ticker import MaxNLocator

from verification.compare.running_in_measures import History
from verification.figures.style import BLUE, VERMILION, Columns, Drawing, sheet

ROWS = (("volume", 1e18, "wear volume [µm³]"), ("friction", 1.0, "coefficient of friction"))
LOOKS = ({"color": BLUE, "linestyle": "-"}, {"color": VERMILION, "linestyle": "--"})
"""Of the readings, in order."""


def side_by_side(cases: Mapping[str, Mapping[str, Sequence[History]]]) -> Drawing:
    """Volume and friction over the cycles, a column of panels for each case: a thick line for the median of
    the surfaces in each reading, a thin one for each surface.

    cases: name of a case -> name of a reading -> its histories.
    """
    numbers = Columns("quantity", "case", "reading", "surface", "cycle", "value")
    size = (len(ROWS), len(cases))
    with sheet(2.2 * max(3, len(cases)), 5.2, size, sharex=True, sharey="row") as (figure, axes):
        for (quantity, scale, label), row in zip(ROWS, axes, strict=True):
            for panel, (name, readings) in zip(row, cases.items(), strict=True):
                for look, (reading, histories) in zip(LOOKS, readings.items(), strict=False):
                    values = [scale * getattr(history, quantity) for history in histories]
                    for k, each in enumerate(values):
                        panel.plot(histories[k].cycle, each, **look, linewidth=0.5, alpha=0.4)
                        numbers.add(quantity, name, reading, k + 1, histories[k].cycle, each)
                    if values:
                        middle = np.median(values, axis=0)
                        panel.plot(histories[0].cycle, middle, **look, linewidth=2.0, label=reading)
                        numbers.add(quantity, name, reading, "median", histories[0].cycle, middle)
                panel.xaxis.set_major_locator(MaxNLocator(4, integer=True))
            row[0].set_ylabel(label)
        for top, bottom, name in zip(axes[0], axes[-1], cases, strict=True):
            top.set_title(name)
            bottom.set_xlabel("cycle")
        shown = {}
        for panel in axes.ravel():
            handles, names = panel.get_legend_handles_labels()
            shown |= dict(zip(names, handles, strict=True))
        figure.legend(shown.values(), shown.keys(), loc="outside lower center", ncols=len(LOOKS))
    return Drawing(figure, numbers)
