# SPDX-License-Identifier: MIT
"""The figure of a sweep: its main quantities over each of the varied values."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import cycle
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.ticker import MaxNLocator

from verification.figures.style import (
    BLACK,
    BLUE,
    GREEN,
    ORANGE,
    PURPLE,
    VERMILION,
    Drawing,
    log_ticks,
    new_figure,
    save,
    style,
)
from verification.runs.study import Axis, Study, in_si

if TYPE_CHECKING:
    from pandas import DataFrame

QUANTITIES = {
    "p_max_Pa": ("largest pressure [GPa]", 1e-9),
    "contact_radius_m": ("contact radius [$\\mu$m]", 1e6),
    "approach_m": ("approach [$\\mu$m]", 1e6),
    "peeq_max": ("largest plastic strain [%]", 1e2),
}
"""Column -> label and factor of its unit."""
MOST_KEYS = 8
MOST_TICKS = 8
MANY = 2000  # points from which a panel is a picture in a PDF
MOST_LINES = 40
LETTERS = 24  # below a panel side by side; more are turned
COLOURS = (BLUE, VERMILION, GREEN, ORANGE, PURPLE, BLACK)
_GOOD = {"color": BLUE, "marker": "o", "markersize": 4.0, "fillstyle": "none", "linewidth": 0.0}
_BAD = {"color": VERMILION, "marker": "x", "markersize": 5.0, "linewidth": 0.0}
_SAME = {"color": BLUE, "linewidth": 0.7, "alpha": 0.5}


def drawing_of_sweep(frame: DataFrame, study: Mapping[str, Any]) -> Drawing:
    """The figure of a finished sweep, not written. frame, study: its table and what its record says of it."""
    rows = frame.astype(object).where(frame.notna(), None).to_dict("records")
    return summary(Study.model_validate(dict(study)), rows)


def sweep_figure(study: Study, rows: Sequence[Mapping], path: Path) -> None:
    """Draw the table of a sweep as `path`.png."""
    save(summary(study, rows), path, data=False)


def summary(study: Study, rows: Sequence[Mapping]) -> Drawing:
    """Panels: quantities down, varied keys across. rows: column of the table -> value, a mapping a point.

    Points of a grid that differ in one key only are joined. A point that did not converge is a cross at its
    value, or at the foot of the panel if it has none.
    """
    shown = {
        name: look
        for name, look in QUANTITIES.items()
        if name != "peeq_max" or any(row["peeq_max"] for row in rows)
    }
    keys = list(study.vary)[:MOST_KEYS]
    converged = np.array([row["status"] == "converged" for row in rows], dtype=bool)
    with style():
        figure = new_figure(0.6 + 2.9 * max(len(keys), 2), 0.6 + 2.0 * len(shown))
        panels = figure.subplots(len(shown), len(keys), sharex="col", sharey="row", squeeze=False)
        for column, key in enumerate(keys):
            x, ticks = _places(study.vary[key], [row[key] for row in rows])
            joined = not ticks and study.mode != "zip"
            lines = _lines(rows, [other for other in study.vary if other != key]) if joined else {}
            for panel, (name, (_, factor)) in zip(panels[:, column], shown.items(), strict=True):
                y = np.array([np.nan if row[name] is None else factor * row[name] for row in rows])
                _join(panel, lines, x, np.where(converged, y, np.nan))
                there, bitmap = np.isfinite(y), {"rasterized": x.size > MANY}
                for marked, look in ((there & converged, _GOOD), (there & ~converged, _BAD)):
                    panel.plot(x[marked], y[marked], **look, **bitmap)
                if not there.all():  # matplotlib cannot lay out an empty line that is not clipped
                    at_foot = {"transform": panel.get_xaxis_transform(), "clip_on": False, "zorder": 3}
                    panel.plot(x[~there], np.zeros(np.sum(~there)), **_BAD, **at_foot, **bitmap)
            _label(panels[-1, column], study.vary[key], key, ticks)
        for panel, (label, _) in zip(panels[:, 0], shown.values(), strict=True):
            panel.set_ylabel(label)
        figure.suptitle(study.title[:120] or f"{study.scene}, {study.model}", parse_math=False)
        names = [Line2D([], [], **_GOOD, label="converged")]
        if any(panel.lines[0].get_color() == _SAME["color"] for panel in panels[0] if len(panel.lines) > 2):
            names.append(Line2D([], [], **_SAME, label="points that differ in the value of the axis only"))
        if not converged.all():
            names.append(Line2D([], [], **_BAD, label="no converged result"))
        figure.legend(handles=names, loc="outside lower center", ncols=len(names))
        figure.align_ylabels()
    return Drawing(figure, {})


def _places(axis: Axis, values: Sequence) -> tuple[np.ndarray, list[str]]:
    """Where the values stand: numbers in the unit of the study, texts and lists one by one with
    their spellings.
    """
    if all(isinstance(value, int | float) for value in values):
        scale = in_si(f"1 {axis.unit}") if axis.unit else 1.0
        return np.array(values, dtype=float) / scale, []
    known = list(dict.fromkeys(str(value) for value in values))
    return np.array([known.index(str(value)) for value in values], dtype=float), known


def _lines(rows: Sequence[Mapping], others: Sequence[str]) -> dict[str, np.ndarray]:
    """Numbers of the rows that agree in the other keys, (n,) each, by what they agree in; none if
    there are too many lines to tell apart.
    """
    groups: dict[tuple, list[int]] = {}
    for k, row in enumerate(rows):
        groups.setdefault(tuple(row[other] for other in others), []).append(k)
    if len(groups) > MOST_LINES:
        return {}
    return {
        ", ".join(f"{o} = {_short(v)}" for o, v in zip(others, values, strict=True)): np.array(group)
        for values, group in groups.items()
    }


def _short(value: object) -> str:
    return f"{value:.4g}" if isinstance(value, float) else str(value)[:20]


def _join(panel: Axes, lines: Mapping[str, np.ndarray], x: np.ndarray, y: np.ndarray) -> None:
    """The points of each line in order; few lines have a colour and a name each."""
    few = 1 < len(lines) <= len(COLOURS)
    for (name, line), color in zip(lines.items(), cycle(COLOURS), strict=False):
        order = line[np.argsort(x[line], kind="stable")]
        look = _SAME | ({"color": color, "alpha": 1.0, "label": name} if few else {})
        panel.plot(x[order], y[order], **look)
    if few and panel.get_subplotspec().is_first_row():
        for text in panel.legend(fontsize=6.5).get_texts():
            text.set_parse_math(False)


def _label(panel: Axes, axis: Axis, key: str, ticks: Sequence[str]) -> None:
    panel.set_xlabel(f"{key} [{axis.unit}]" if axis.unit else key, parse_math=False)
    if axis.logarithmic:
        panel.set_xscale("log")
        log_ticks(panel.xaxis)
    elif not ticks:
        panel.xaxis.set_major_locator(MaxNLocator(5, min_n_ticks=2))
    if ticks:
        every = -(-len(ticks) // MOST_TICKS)
        panel.set_xticks(
            range(0, len(ticks), every), [tick[:20] for tick in ticks[::every]], parse_math=False
        )
        if sum(map(len, ticks[::every])) > LETTERS:
            panel.tick_params(axis="x", labelrotation=90)
        panel.set_xlim(-0.5, len(ticks) - 0.5)
