# SPDX-License-Identifier: MIT
"""Curves of several programs on logarithmic axes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from verification.figures.style import BLUE, GREEN, ORANGE, VERMILION, Columns, Drawing, log_ticks, sheet
from verification.figures.work_precision import FLOOR, LINE, TARGET

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
    with sheet(8.4, 4.2) as (figure, axis):
        for label, (_, x, y) in series.items():
            axis.loglog(x, y, **looks[label], **LINE, label=label)
            rows.add(label, x, y)
        low, high = axis.get_ylim()
        names = axis.get_legend_handles_labels()[0]
        if target is not None:
            names.append(axis.axhline(target, **TARGET, label="error whose times are compared"))
        if floor > low:
            names.append(axis.axhspan(low, floor, **FLOOR, label="below the uncertainty"))
        axis.set(xlabel=xlabel, ylabel=ylabel, ylim=(low, high))
        for each in (axis.xaxis, axis.yaxis):
            log_ticks(each)
        figure.legend(handles=names, loc="outside right upper")
    return Drawing(figure, rows)


def looks_of(series: Series) -> dict[str, Mapping[str, object]]:
    """Colour and marker of the program, a line of its own for each of its curves."""
    looks, seen = {}, dict.fromkeys(LOOKS, 0)
    for label, (program, _, _) in series.items():
        looks[label] = {**LOOKS[program], "linestyle": LINES[seen[program] % len(LINES)]}
        seen[program] += 1
    return looks
