# SPDX-License-Identifier: MIT
"""Thinning of a chemical film against the pressure on it."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from verification.figures.style import BLUE, EXACT, GREEN, VERMILION, Drawing, new_figure, style

_LOOKS = ((BLUE, "-"), (VERMILION, "-"), (GREEN, "--"))


def thinning_curves(pressure: np.ndarray, curves: Mapping[str, np.ndarray], limit: float) -> Drawing:
    """pressure in GPa, (n,); curves: name -> thinning in %, (n,), NaN where there is none; limit in %."""
    rows: dict[str, list] = {"curve": [], "pressure_GPa": [], "thinning_percent": []}
    with style():
        figure = new_figure(4.8, 3.2)
        axis = figure.subplots()
        for (name, thinning), (color, line) in zip(curves.items(), _LOOKS, strict=True):
            axis.plot(pressure, thinning, color=color, linestyle=line, linewidth=1.6, label=name)
            shown = np.isfinite(thinning)
            for key, column in zip(
                rows, ([name] * shown.sum(), pressure[shown], thinning[shown]), strict=True
            ):
                rows[key].extend(column)
        axis.axhline(limit, **EXACT, label=f"growth of a cycle, {limit:.2f} %")
        axis.axhline(0.0, color="black", linewidth=0.6)
        axis.set(xlabel="pressure [GPa]", ylabel="thinning [%]", xlim=(0.0, pressure.max()))
        axis.legend()
    return Drawing(figure, rows)
