# SPDX-License-Identifier: MIT
"""Error over processor time, a curve a method with its name at its end, and the time to one error for many
problems.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import NullFormatter

from verification.cost.precision import TARGETS, Reached
from verification.figures.style import BLACK, BLUE, GREEN, ORANGE, PURPLE, VERMILION, Columns, Drawing, sheet

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
APART = 0.062  # least distance of two labels, of the height of the panel
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
    with sheet(5.6 * len(panels), 4.0, len(panels)) as (figure, axes):
        for axis, (refined, (lines, floor)) in zip(axes, panels.items(), strict=True):
            shown = {name: drawable(line, floor) for name, line in lines.items()}
            for name, (seconds, error) in shown.items():
                axis.loglog(
                    seconds, error, **look(name, list(lines)), linewidth=1.4, markersize=4.5, fillstyle="none"
                )
            _frame(axis, refined, floor, [error for _, error in shown.values()])
            label_ends(axis, {name: ends for name, ends in shown.items() if ends[0].size}, list(lines))
            for name, line in lines.items():
                rows.add(refined, name, line.resolution, line.seconds, line.error, floor)
        axes[0].set_ylabel(ylabel)
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
        axis.axhspan(low, floor, color="#bbbbbb", alpha=0.45, linewidth=0.0)
    for target in TARGETS:
        axis.axhline(target, color="#888888", linewidth=0.6, linestyle=(0, (1, 3)))
    axis.set(title=f"refined: {refined}", xlabel="processor time [s]", ylim=(low, high))
    axis.yaxis.set_major_formatter(lambda value, _: f"{100.0 * value:g} %")
    for each in (axis.xaxis, axis.yaxis):
        each.set_minor_formatter(NullFormatter())


def label_ends(axis: Axes, lines: Mapping[str, tuple[np.ndarray, np.ndarray]], names: Sequence[str]) -> None:
    """Names to the right of the panel, each at the height of the last point of its curve where there is
    room.
    """
    low, high = np.log(axis.get_ylim())
    ends = {name: (np.log(error[-1]) - low) / (high - low) for name, (_, error) in lines.items()}
    for name, height in spread(ends, APART).items():
        seconds, error = lines[name]
        axis.annotate(
            name,
            (seconds[-1], error[-1]),
            xytext=(1.04, height),
            textcoords="axes fraction",
            color=look(name, names)["color"],
            va="center",
            fontsize=8.0,
            annotation_clip=False,
            arrowprops={
                "arrowstyle": "-",
                "color": look(name, names)["color"],
                "linewidth": 0.5,
                "alpha": 0.6,
            },
        )


def spread(heights: Mapping[str, float], apart: float) -> dict[str, float]:
    """Heights from 0 to 1, moved upwards as little as is needed to be `apart`; the whole down if that passes
    the top.
    """
    placed: dict[str, float] = {}
    last = -np.inf
    for name, height in sorted(heights.items(), key=lambda item: item[1]):
        last = max(min(max(height, 0.0), 1.0), last + apart)
        placed[name] = last
    over = max(0.0, last - 1.0)
    return {name: height - over for name, height in placed.items()}


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
        figure.legend(loc="outside right upper")
    return Drawing(figure, rows)
