# SPDX-License-Identifier: MIT
"""The figure of a study of sensitivity: how much each varied key moves the main quantities."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from verification.figures.style import BLACK, BLUE, RC, Columns, Drawing, sheet
from verification.figures.sweep import QUANTITIES

MORE = {
    "friction_coefficient": ("coefficient of friction", 1.0),
    "wear_volume_m3": ("wear volume [$\\mu$m$^3$]", 1e18),
}
SHOWN = {
    "mu_star": "mean change over the range of a key",
    "total": "total share of the variance",
    "rank_correlation": "correlation of ranks",
}
"""Index that is drawn -> name of its axis."""


def bars(rows: Sequence[Mapping]) -> Drawing:
    """A panel for each quantity, a bar with its confidence interval for each key.

    rows: of the table of indices, quantities and indices of both methods among them.
    """
    table = Columns("quantity", "key", "value", "low", "high")
    labels = {name: look for name, look in (QUANTITIES | MORE).items() if _of(rows, name)}
    with sheet(0.4 + 3.0 * len(labels), 1.1 + 0.28 * _keys(rows), len(labels)) as (figure, axes):
        for panel, (name, (label, factor)) in zip(np.atleast_1d(axes), labels.items(), strict=True):
            of_name = _of(rows, name)[::-1]
            effects, (quantity, *unit) = of_name[0]["index"] == "mu_star", label.partition(" [")
            scale = factor if effects else 1.0
            value, low, high = (scale * np.array([row[key] for row in of_name]) for key in _ENDS)
            keys = [row["key"] for row in of_name]
            panel.barh(keys, value, color=BLUE, height=0.6)
            ends = np.maximum([value - low, high - value], 0.0)
            panel.errorbar(value, keys, xerr=ends, fmt="none", ecolor=BLACK, elinewidth=0.8, capsize=2)
            panel.set(title=quantity, xlabel=effects * "".join(unit).strip())
            panel.set_axisbelow(True)
            table.add(name, keys, value, low, high)
        figure.supxlabel(SHOWN[of_name[0]["index"]], fontsize=RC["axes.labelsize"])
    return Drawing(figure, table)


_ENDS = ("value", "low", "high")


def _of(rows: Sequence[Mapping], name: str) -> list[Mapping]:
    return [row for row in rows if row["quantity"] == name and row["index"] in SHOWN]


def _keys(rows: Sequence[Mapping]) -> int:
    return len({row["key"] for row in rows})
