# SPDX-License-Identifier: MIT
"""Error over processor time, a curve a method, and the time to one error for many problems."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

import numpy as np

from verification.cost.precision import TARGETS, Reached
from verification.figures.lines import PERCENT, Curve, curves as drawn
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

LOOKS = {
    "SAM": {"color": BLUE, "marker": "o"},
    "SAM, decoupled": {"color": GREEN, "marker": "^", "linestyle": "-."},
    "SAM, the paper's loop": {"color": ORANGE, "marker": "D", "linestyle": ":"},
    "FEM, axisymmetric": {"color": VERMILION, "marker": "s", "linestyle": "--"},
    "FEM, 3D": {"color": BLACK, "marker": "x", "linestyle": "--"},
    "SAM, two grids": {"color": PURPLE, "marker": "v", "linestyle": (0, (4, 1))},
}
"""Of the methods; others have the same by turns."""
LOWEST, DEEPEST = 1e-6, 0.3  # errors below it, or below so much of the floor, are drawn there


@dataclass(frozen=True)
class Line:
    """Of one method, coarse to fine, each (n,); error is nan where there is no answer."""

    seconds: np.ndarray
    error: np.ndarray
    resolution: np.ndarray


def _looks(names: Iterable[str]) -> dict[str, dict]:
    """Colour, marker and line of each method."""
    order = [*LOOKS, *(name for name in names if name not in LOOKS)]
    return {name: dict(list(LOOKS.values())[k % len(LOOKS)]) for k, name in enumerate(order)}


def curves(panels: Mapping[str, tuple[Mapping[str, Line], float]], ylabel: str) -> Drawing:
    """Panels: what is refined -> (method -> line, uncertainty of the reference, shaded)."""
    rows, shown, floors = (
        Columns("refined", "method", "resolution", "cpu_s", "error", "reference_uncertainty"),
        {},
        {},
    )
    for refined, (lines, floor) in panels.items():
        panel = shown[f"refined: {refined}"] = {}
        floors[f"refined: {refined}"] = PERCENT * floor * (floor > LOWEST)
        for name, line in lines.items():
            rows.add(refined, name, line.resolution, line.seconds, line.error, floor)
            use = np.isfinite(line.error) & np.isfinite(line.seconds)
            error = np.maximum(line.error[use], max(LOWEST, DEEPEST * floor))
            if use.any():
                panel[name] = Curve(line.seconds[use], PERCENT * error, look={"fillstyle": "none"})
    marks = {"an error whose times are stated": ("y", *(PERCENT * target for target in TARGETS))}
    looks = _looks(name for lines, _ in panels.values() for name in lines)
    how = {"looks": looks, "logarithmic": "xy", "floor": floors, "marks": marks}
    return Drawing(drawn(shown, "processor time [s]", f"{ylabel} [%]", size=(4.9, 4.4), **how).figure, rows)


def overview(times: Mapping[str, Mapping[str, Reached]], error: str) -> Drawing:
    """Rows: kind of scene -> method -> time to one error; hollow where it is an upper bound."""
    rows = Columns("kind", "method", "cpu_s", "upper_bound")
    there = dict.fromkeys(name for found in times.values() for name in found)
    with sheet(8.4, max(0.9 + 0.42 * len(times), 2.6)) as (figure, axis):
        for name, look in _looks(there).items():
            if name in there:
                axis.plot([], [], **look | {"linestyle": "none"}, label=name)
        for k, (kind, found) in enumerate(times.items()):
            for name, reached in found.items():
                rows.add(kind, name, reached.value, reached.coarsest)
                look = _looks(there)[name] | {"linestyle": "none", "markersize": 6.5}
                fill = {"fillstyle": "none"} if reached.coarsest else {}
                axis.plot([np.nan if reached.value is None else reached.value], [k], **look, **fill)
        axis.set_yticks(range(len(times)), list(times))
        words = f"processor time to an error of {error} [s]"
        axis.set(xscale="log", ylim=(len(times) - 0.5, -0.5), xlabel=words)
        if not any(rows["cpu_s"]):
            axis.set_xlim(0.1, 10.0)  # nothing to choose them from
        log_ticks(axis.xaxis)
        figure.legend(loc="outside right upper")
    return Drawing(figure, rows)
