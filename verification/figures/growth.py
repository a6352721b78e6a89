# SPDX-License-Identifier: MIT
"""Time and memory over the size of a scene, log-log with fitted powers, and predicted over measured."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import matplotlib
import numpy as np

from verification.figures.style import (
    BLACK,
    BLUE,
    GREEN,
    ORANGE,
    VERMILION,
    Columns,
    Drawing,
    log_ticks,
    sheet,
)
from verification.reference.convergence import Power

_LOOKS = tuple(
    {"color": color, "marker": marker, "fillstyle": "none"}
    for color, marker in zip((BLUE, VERMILION, GREEN, ORANGE, BLACK), "os^Dv", strict=True)
)
_MARKS, _SCALE = "os^Dv<>phXP*", matplotlib.colormaps["turbo"]
"""A mark and a colour of its own for each family of scenes."""


@dataclass(frozen=True)
class PowerCurve:
    """Points and, where one was fitted, their power."""

    x: np.ndarray
    y: np.ndarray
    power: Power | None = None


def growth(columns: Mapping[str, tuple[str, Mapping[str, PowerCurve], Mapping[str, PowerCurve]]]) -> Drawing:
    """Title -> (label of x, name -> seconds over x, name -> bytes over x): seconds above, megabytes
    underneath.
    """
    rows = Columns("panel", "quantity", "series", "x", "value", "fit")
    with sheet(3.6 * len(columns), 6.0, (2, len(columns)), sharex="col") as (figure, axes):
        for column, (title, (xlabel, *quantities)) in zip(axes.T, columns.items(), strict=True):
            for axis, label, unit, curves in zip(
                column, ("processor time [s]", "memory [MB]"), (1.0, 1e-6), quantities, strict=True
            ):
                for look, (name, curve) in zip(_LOOKS, curves.items(), strict=False):
                    _draw(axis, look, name, curve, unit=unit)
                    fit = (
                        np.full(curve.x.size, np.nan) if curve.power is None else unit * curve.power(curve.x)
                    )
                    rows.add(title, label, name, curve.x, unit * curve.y, fit)
                axis.set_ylabel(label)
                axis.legend()
                _decades(axis)
            column[0].set_title(title)
            column[1].set_xlabel(xlabel)
        figure.align_ylabels()
    return Drawing(figure, rows)


def _decades(axis) -> None:
    """At least one decade upwards, and numbers enough."""
    low, high = axis.get_ylim()
    axis.set_ylim(min(low, np.sqrt(low * high / 10)), max(high, np.sqrt(low * high * 10)))
    log_ticks(axis.xaxis)
    log_ticks(axis.yaxis)


def _draw(axis, look: Mapping, name: str, curve: PowerCurve, *, unit: float) -> None:
    text = name if curve.power is None else f"{name}: {curve.power}"
    axis.loglog(curve.x, unit * curve.y, **look, linestyle="none")
    if curve.power is not None:
        ends = np.array([curve.power.first, curve.power.last])
        axis.loglog(ends, unit * curve.power(ends), color=look["color"], linewidth=1.0)
    axis.plot([], [], **look, linestyle="none" if curve.power is None else "-", linewidth=1.0, label=text)


def predicted(panels: Mapping[str, tuple[float, float, Mapping[str, tuple[Sequence, Sequence]]]]) -> Drawing:
    """Title with unit -> (factor that is allowed, measured value from which it counts, family -> (measured,
    predicted)).
    """
    rows = Columns("panel", "family", "measured", "predicted")
    most = max(len(families) for _, _, families in panels.values())
    colours = _SCALE(np.linspace(0.0, 0.95, most))
    with sheet(4.4 * len(panels) + 2.2, 4.4, len(panels)) as (figure, axes):
        for axis, (title, (allowed, least, families)) in zip(axes, panels.items(), strict=True):
            every = np.concatenate([np.ravel(pair) for pair in families.values()])
            ends = np.array([0.7 * every.min(), 1.4 * every.max()])
            axis.fill_between(ends, ends / allowed, ends * allowed, color=GREEN, alpha=0.15, linewidth=0.0)
            axis.loglog(ends, ends, color=BLACK, linewidth=0.8, label="predicted = measured")
            axis.axvline(least, color=BLACK, linewidth=0.8, linestyle=":", label="counted to its right")
            for k, (family, (measured, expected)) in enumerate(families.items()):
                look = {"color": colours[k], "marker": _MARKS[k % len(_MARKS)], "fillstyle": "none"}
                axis.loglog(measured, expected, **look, linestyle="none", label=family)
                rows.add(title, family, measured, expected)
            axis.set(title=title, xlabel="measured", ylabel="predicted")
            log_ticks(axis.xaxis)
            log_ticks(axis.yaxis)
        figure.legend(*axes[0].get_legend_handles_labels(), loc="outside right center")
    return Drawing(figure, rows)
