# SPDX-License-Identifier: MIT
"""Error over processor time, a curve a method, and the time to one error for many problems."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from verification.cost.precision import TARGETS, Reached
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

LOOKS = (
    {"color": BLUE, "marker": "o"},
    {"color": GREEN, "marker": "^", "linestyle": "-."},
    {"color": ORANGE, "marker": "D", "linestyle": ":"},
    {"color": VERMILION, "marker": "s", "linestyle": "--"},
    {"color": BLACK, "marker": "x", "linestyle": "--"},
    {"color": PURPLE, "marker": "v", "linestyle": (0, (4, 1))},
)
"""In the order of the methods below; others follow by turns."""
KNOWN = ("SAM", "SAM, decoupled", "SAM, the paper's loop", "FEM, axisymmetric", "FEM, 3D", "SAM, two grids")
LINE = {"linewidth": 1.4, "markersize": 4.5, "fillstyle": "none"}
TARGET = {"color": "#888888", "linewidth": 0.6, "linestyle": (0, (1, 3))}
FLOOR = {"color": "#bbbbbb", "alpha": 0.45, "linewidth": 0.0}
LOWEST, DEEPEST = 1e-6, 0.3  # errors below it, or below so much of the floor, are drawn there


@dataclass(frozen=True)
class Line:
    """Of one method, coarse to fine, each (n,); error is nan where there is no answer."""

    seconds: np.ndarray
    error: np.ndarray
    resolution: np.ndarray


def look(name: str, names: Sequence[str] = KNOWN) -> Mapping[str, object]:
    """Colour, marker and line of a method; those that are not KNOWN follow by turns."""
    order = [*KNOWN, *(other for other in names if other not in KNOWN)]
    return LOOKS[order.index(name) % len(LOOKS)]


def curves(panels: Mapping[str, tuple[Mapping[str, Line], float]], ylabel: str) -> Drawing:
    """Panels: what is refined -> (method -> line, uncertainty of the reference, shaded)."""
    rows = Columns("refined", "method", "resolution", "cpu_s", "error", "reference_uncertainty")
    there = dict.fromkeys(name for lines, _ in panels.values() for name in lines)
    with sheet(4.9 * max(len(panels), 1.3), 4.4, len(panels)) as (figure, axes):
        for axis, (refined, (lines, floor)) in zip(axes, panels.items(), strict=True):
            shown = {name: drawable(line, floor) for name, line in lines.items()}
            for name, (seconds, error) in shown.items():
                axis.loglog(seconds, error, **(LINE | look(name, list(there))))
            _frame(axis, refined, floor, [error for _, error in shown.values()])
            axis.set_ylabel(ylabel)
            for name, line in lines.items():
                rows.add(refined, name, line.resolution, line.seconds, line.error, floor)
        drawn = [
            name
            for name in there
            if any(name in lines and drawable(lines[name], 0.0)[0].size for lines, _ in panels.values())
        ]
        names = [Line2D([], [], **(LINE | look(name, list(there))), label=name) for name in drawn]
        names += [Line2D([], [], **TARGET, label="an error whose times are stated")]
        names += [Patch(**FLOOR, label="below the uncertainty of the reference")]
        figure.legend(handles=names, loc="outside lower center", ncols=2 * min(len(panels), 2))
    return Drawing(figure, rows)


def drawable(line: Line, floor: float) -> tuple[np.ndarray, np.ndarray]:
    """Seconds and errors of the points that have both; how far below the floor means nothing."""
    use = np.isfinite(line.error) & np.isfinite(line.seconds)
    return line.seconds[use], np.maximum(line.error[use], max(LOWEST, DEEPEST * floor))


def _frame(axis: Axes, refined: str, floor: float, errors: Sequence[np.ndarray]) -> None:
    """Limits, the floor, and the errors that times are stated for."""
    found = np.concatenate([*errors, [floor, *TARGETS]])
    found = found[found > LOWEST]
    low, high = 0.7 * found.min(), min(2.0 * found.max(), 10.0)
    if floor > LOWEST:
        axis.axhspan(low, floor, **FLOOR)
    for target in TARGETS:
        axis.axhline(target, **TARGET)
    axis.set(title=f"refined: {refined}", xlabel="processor time [s]", ylim=(low, high))
    log_ticks(axis.xaxis)
    log_ticks(axis.yaxis, lambda value: f"{100.0 * value:g} %")


def overview(times: Mapping[str, Mapping[str, Reached]], error: str) -> Drawing:
    """Rows: kind of scene -> method -> time to one error; hollow where it is an upper bound."""
    rows = Columns("kind", "method", "cpu_s", "upper_bound")
    there = dict.fromkeys(name for found in times.values() for name in found)
    names = [*(name for name in KNOWN if name in there), *(name for name in there if name not in KNOWN)]
    with sheet(8.4, max(0.9 + 0.42 * len(times), 2.6)) as (figure, axis):
        for k, (kind, found) in enumerate(times.items()):
            for name, reached in found.items():
                rows.add(kind, name, reached.value, reached.coarsest)
                if reached.value is not None:
                    mark = {key: value for key, value in look(name, names).items() if key != "linestyle"}
                    fill = {"fillstyle": "none"} if reached.coarsest else {}
                    axis.plot(reached.value, k, **mark, **fill, linestyle="none", markersize=6.5)
        for name in names:
            mark = {key: value for key, value in look(name, names).items() if key != "linestyle"}
            axis.plot([], [], **mark, linestyle="none", label=name)
        axis.set_yticks(range(len(times)), list(times))
        axis.set(
            xscale="log", ylim=(len(times) - 0.5, -0.5), xlabel=f"processor time to an error of {error} [s]"
        )
        if not any(rows["cpu_s"]):
            axis.set_xlim(0.1, 10.0)  # nothing to choose them from
        log_ticks(axis.xaxis)
        figure.legend(loc="outside right upper")
    return Drawing(figure, rows)
