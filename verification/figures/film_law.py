# SPDX-License-Identifier: MIT
"""Thinning of a chemical film against the pressure on it."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from verification.figures.style import BLUE, EXACT, GREEN, VERMILION, Columns, Drawing, sheet, zero_line

_LOOKS = ((BLUE, "-"), (VERMILION, "-"), (GREEN, "--"))


def thinning_curves(pressure: np.ndarray, curves: Mapping[str, np.ndarray], limit: float) -> Drawing:
    """pressure in GPa, (n,); curves: name -> thinning in %, (n,), NaN where there is none; limit in %."""
    rows = Columns("curve", "pressure_GPa", "thinning_percent")
    with sheet(4.8, 3.2) as (figure, axis):
        for (name, thinning), (color, line) in zip(curves.items(), _LOOKS, strict=True):
            axis.plot(pressure, thinning, color=color, linestyle=line, linewidth=1.6, label=name)
            shown = np.isfinite(thinning)
            rows.add(name, pressure[shown], thinning[shown])
        axis.axhline(limit, **EXACT, label=f"growth of a cycle, {limit:.2f} %")
        zero_line(axis)
        axis.set(xlabel="pressure [GPa]", ylabel="thinning [%]", xlim=(0.0, pressure.max()))
        axis.legend()
    return Drawing(figure, rows)
