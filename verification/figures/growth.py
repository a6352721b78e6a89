# SPDX-License-Identifier: MIT
"""Time and memory over the size of a scene, log-log with fitted powers, and predicted over measured."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.ticker import NullFormatter

from verification.figures.style import BLACK, BLUE, GREEN, ORANGE, VERMILION, Columns, Drawing, sheet
from verification.reference.convergence import Power

_LOOKS = tuple(
    {"color": color, "marker": marker, "fillstyle": "none"}
    for color, marker in zip((BLUE, VERMILION, GREEN, ORANGE, BLACK), "os^Dv", strict=True)
)
_MARKS = "os^Dv<>phXP"


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
    """At least one decade upwards, and no numbers between the decades where there are two."""
    low, high = axis.get_ylim()
    axis.set_ylim(min(low, np.sqrt(low * high / 10)), max(high, np.sqrt(low * high * 10)))
    axis.xaxis.set_minor_formatter(NullFormatter())
    axis.yaxis.set_minor_formatter(NullFormatter())


def _draw(axis, look: Mapping, name: str, curve: PowerCurve, *, unit: float) -> None:
    text = name if curve.power is None else f"{name}: {curve.power}"
    axis.loglog(curve.x, unit * curve.y, **look, linestyle="none", label=text)
    if curve.power is not None:
        ends = np.array([curve.power.first, curve.power.last])
        axis.loglog(ends, unit * curve.power(ends), color=look["color"], linewidth=1.0)


def predicted(panels: Mapping[str, tuple[float, float, Mapping[str, tuple[Sequence, Sequence]]]]) -> Drawing:
    """Title with unit -> (factor that is allowed, measured value from which it counts, family -> (measured,
    predicted)).
    """
    rows = Columns("panel", "family", "measured", "predicted")
    with sheet(4.6 * len(panels), 4.4, len(panels)) as (figure, axes):
        for axis, (title, (allowed, least, families)) in zip(axes, panels.items(), strict=True):
            every = np.concatenate([np.ravel(pair) for pair in families.values()])
            ends = np.array([0.7 * every.min(), 1.4 * every.max()])
            axis.fill_between(ends, ends / allowed, ends * allowed, color=GREEN, alpha=0.15, linewidth=0.0)
            axis.loglog(ends, ends, color=BLACK, linewidth=0.8)
            axis.axvline(least, color=BLACK, linewidth=0.8, linestyle=":")
            for k, (family, (measured, expected)) in enumerate(families.items()):
                look = _LOOKS[k % len(_LOOKS)] | {"marker": _MARKS[k % len(_MARKS)], "linestyle": "none"}
                axis.loglog(measured, expected, **look, label=family)
                rows.add(title, family, measured, expected)
            axis.set(title=title, xlabel="measured", ylabel="predicted")
        axes[-1].legend(loc="center left", bbox_to_anchor=(1.0, 0.5))
    return Drawing(figure, rows)
