# SPDX-License-Identifier: MIT
"""Error over processor time, a curve a method, and the time to one error for many problems."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from verification.cost.precision import TARGETS, Reached
from verification.figures.lines import CYCLES, PERCENT, Curve, curves as drawn
from verification.figures.style import Columns, Drawing, log_ticks, sheet

if TYPE_CHECKING:
    from pandas import DataFrame

METHODS = ("SAM", "FEM, axisymmetric", "SAM, decoupled", "SAM, the paper's loop", "SAM, two grids", "FEM, 3D")
LOOKS = dict(zip(METHODS, CYCLES, strict=True))
LOWEST, DEEPEST = 1e-6, 0.3  # errors below it, or below so much of the floor, are drawn there


def curves(solves: DataFrame, ylabel: str) -> Drawing:
    """A panel for what is refined, a curve a method, the uncertainty of the reference shaded. solves: rows
    with refined, method, resolution, cpu_s, error (nan where there is no answer) and floor.
    """
    rows = Columns("refined", "method", "resolution", "cpu_s", "error", "reference_uncertainty")
    shown: dict[str, dict[str, Curve]] = {}
    floors: dict[str, float] = {}
    for refined, of_panel in solves.groupby("refined", sort=False):
        floor, panel = max(of_panel["floor"]), shown.setdefault(f"refined: {refined}", {})
        floors[f"refined: {refined}"] = PERCENT * floor * (floor > LOWEST)
        for name, own in of_panel.groupby("method", sort=False):
            line = (own[column].to_numpy(dtype=float) for column in ("resolution", "cpu_s", "error"))
            resolution, seconds, error = line
            rows.add(refined, name, resolution, seconds, error, floor)
            if (use := np.isfinite(error) & np.isfinite(seconds)).any():
                error = np.maximum(error[use], max(LOWEST, DEEPEST * floor))
                panel[name] = Curve(seconds[use], PERCENT * error)
    marks = {"an error whose times are stated": ("y", *(PERCENT * target for target in TARGETS))}
    how = {"looks": LOOKS, "logarithmic": "xy", "floor": floors, "marks": marks}
    return Drawing(drawn(shown, "processor time [s]", f"{ylabel} [%]", size=(4.9, 4.4), **how).figure, rows)


def overview(times: Mapping[str, Mapping[str, Reached]], error: str) -> Drawing:
    """Rows: kind of scene -> method -> time to one error; an arrow where it is an upper bound."""
    rows = Columns("kind", "method", "cpu_s", "upper_bound")
    there = dict.fromkeys(name for found in times.values() for name, one in found.items() if one.value)
    with sheet(8.4, max(0.9 + 0.42 * len(times), 2.6)) as (figure, axis):
        for name in there:
            axis.plot([], [], **LOOKS[name] | {"linestyle": "none", "fillstyle": "none"}, label=name)
        for k, (kind, found) in enumerate(times.items()):
            for name, reached in found.items():
                rows.add(kind, name, reached.value, reached.coarsest)
                look = LOOKS[name] | {"linestyle": "none", "markersize": 6.5, "fillstyle": "none"}
                value = np.nan if reached.value is None else reached.value
                bound = [0.25 * value] if reached.coarsest else None
                axis.errorbar([value], [k], xerr=bound, xuplims=reached.coarsest, **look)
        known = {kind: any(one.value for one in found.values()) for kind, found in times.items()}
        axis.set_yticks(range(len(times)), [f"{kind}{': not reached' * (not known[kind])}" for kind in times])
        words = f"processor time to an error of {error} [s]"
        axis.set(xscale="log", ylim=(len(times) - 0.5, -0.5), xlabel=words)
        if not any(rows["cpu_s"]):
            axis.set_xlim(0.1, 10.0)  # nothing to choose them from
        log_ticks(axis.xaxis)
        if there:
            figure.legend(loc="outside right upper")
    return Drawing(figure, rows)
