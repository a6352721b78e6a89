# SPDX-License-Identifier: MIT
"""The figure of a sweep: its main quantities over each of the varied values."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import cycle
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
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
    "contact_share": ("share of the patch in contact [%]", 1e2),
    "approach_m": ("approach [$\\mu$m]", 1e6),
    "peeq_max": ("largest plastic strain [%]", 1e2),
}
"""Column -> label and factor of its unit."""
KEYS = {
    "body.young": "Young's modulus of the body",
    "body.poisson": "Poisson's ratio of the body",
    "body.plasticity.yield_stress": "yield stress",
    "body.plasticity.modulus": "hardening modulus",
    "body.coating.thickness": "thickness of the coating",
    "body.coating.young": "Young's modulus of the coating",
    "counterbody.radius": "radius of the counter-body",
    "counterbody.young": "Young's modulus of the counter-body",
    "friction.coefficient": "coefficient of friction",
    "loading.approach": "approach",
    "loading.cycles": "load cycles",
    "loading.force": "normal force",
    "loading.p0": "largest given pressure",
    "loading.steps": "load steps",
    "surface.ra": "roughness Ra",
    "surface.sq": "roughness Sq",
    "surface.seed": "seed of the surface",
}
"""Keys of a scene in words, those that are often varied."""
NOT_CONVERGED = "no converged result"
FEWEST_IN_MAP = 3  # values of each of two keys
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
    """Of two varied numbers a map for each quantity, else panels by key. rows: column -> value, of points."""
    shown = {
        name: look for name, look in QUANTITIES.items() if any(row.get(name) for row in rows)
    } or QUANTITIES
    if any(row.get("contact_share") for row in rows):  # of rough bodies
        shown = {name: look for name, look in shown.items() if name != "contact_radius_m"}
    with style():
        drawn = _maps(study, rows, shown) or _lines_over(study, rows, shown)
        drawn.suptitle(study.title[:120] or f"{study.scene}, {study.model}", parse_math=False)
    return Drawing(drawn, {})


def _maps(study: Study, rows: Sequence[Mapping], shown: Mapping[str, tuple[str, float]]) -> Figure | None:
    """A map for each quantity over two numbers; crosses did not converge. None where lines say it better."""
    if study.mode != "grid" or len(study.vary) != 2:
        return None
    (kx, ax), (ky, ay) = study.vary.items()
    (x, words), (y, others) = (_places(axis, [row[key] for row in rows]) for key, axis in study.vary.items())
    (columns, i), (lines, j) = (np.unique(values, return_inverse=True) for values in (x, y))
    if (
        words
        or others
        or min(columns.size, lines.size) < FEWEST_IN_MAP
        or columns.size * lines.size != x.size
    ):
        return None
    bad = np.array([row["status"] != "converged" for row in rows], dtype=bool)
    if bad.all():
        return None
    figure = new_figure(0.6 + 3.6 * len(shown), 3.4)
    for k, (panel, (name, (label, factor))) in enumerate(
        zip(figure.subplots(1, len(shown), squeeze=False)[0], shown.items(), strict=True)
    ):
        values = np.full((columns.size, lines.size), np.nan)
        values[i, j] = [np.nan if row[name] is None else factor * row[name] for row in rows]
        drawn = panel.pcolormesh(_edges(columns, ax), _edges(lines, ay), values.T, cmap="viridis")
        figure.colorbar(drawn, ax=panel, label=label)
        panel.plot(x[bad], y[bad], **_BAD)
        panel.grid(visible=False)
        _label(panel, ax, kx, [])
        _label(panel, ay, ky, [], along="y")
        if k:
            panel.set_ylabel("")
    if bad.any():
        figure.legend(handles=[Line2D([], [], **_BAD, label=NOT_CONVERGED)], loc="outside lower center")
    return figure


def _edges(centres: np.ndarray, axis: Axis) -> np.ndarray:
    """Edges of cells about these places, halfway between them on their scale."""
    places = np.log(centres) if axis.logarithmic else centres
    middle = (places[1:] + places[:-1]) / 2
    edges = np.concatenate([[2 * places[0] - middle[0]], middle, [2 * places[-1] - middle[-1]]])
    return np.exp(edges) if axis.logarithmic else edges


def _lines_over(study: Study, rows: Sequence[Mapping], shown: Mapping[str, tuple[str, float]]) -> Figure:
    """Panels: quantities down, varied keys across. Points of a grid that differ in one key only are joined. A
    point that did not converge is a cross at its value, or at the foot of the panel if it has none.
    """
    keys = list(study.vary)[:MOST_KEYS]
    converged = np.array([row["status"] == "converged" for row in rows], dtype=bool)
    figure = new_figure(0.6 + 2.9 * max(len(keys), 2), 0.6 + 2.0 * len(shown))
    panels = figure.subplots(len(shown), len(keys), sharex="col", sharey="row", squeeze=False)
    for column, key in enumerate(keys):
        x, ticks = _places(study.vary[key], [row[key] for row in rows])
        joined = not ticks and study.mode != "zip"
        lines = (
            _lines(rows, {other: axis for other, axis in study.vary.items() if other != key})
            if joined
            else {}
        )
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
    if not converged.all():
        names = [Line2D([], [], **_GOOD, label="converged"), Line2D([], [], **_BAD, label=NOT_CONVERGED)]
        figure.legend(handles=names, loc="outside lower center", ncols=2)
    figure.align_ylabels()
    return figure


def _places(axis: Axis, values: Sequence) -> tuple[np.ndarray, list[str]]:
    """Where the values stand: numbers in the unit of the study, texts and lists one by one."""
    if all(isinstance(value, int | float) for value in values):
        scale = in_si(f"1 {axis.unit}") if axis.unit else 1.0
        return np.array(values, dtype=float) / scale, []
    known = list(dict.fromkeys(str(value) for value in values))
    return np.array([known.index(str(value)) for value in values], dtype=float), known


def _lines(rows: Sequence[Mapping], others: Mapping[str, Axis]) -> dict[str, np.ndarray]:
    """Rows that agree in the other keys, (n,) each, by what they agree in; none if too many to tell."""
    groups: dict[tuple, list[int]] = {}
    for k, row in enumerate(rows):
        groups.setdefault(tuple(row[other] for other in others), []).append(k)
    if len(groups) > MOST_LINES:
        return {}
    return {
        ", ".join(
            _said(key, others[key], value) for key, value in zip(others, values, strict=True)
        ): np.array(group)
        for values, group in groups.items()
    }


def _said(key: str, axis: Axis, value: object) -> str:
    """A varied value in the unit of the study."""
    if not isinstance(value, float):
        return f"{KEYS.get(key, key)} = {str(value)[:20]}"
    scale = in_si(f"1 {axis.unit}") if axis.unit else 1.0
    return f"{KEYS.get(key, key)} = {value / scale:.4g} {_unit(axis)}".rstrip()


def _unit(axis: Axis) -> str:
    """The unit of a varied key as other axes spell it."""
    return axis.unit.replace("um", "\N{MICRO SIGN}m")


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


def _label(panel: Axes, axis: Axis, key: str, ticks: Sequence[str], *, along: str = "x") -> None:
    """Words, unit and scale of a varied key along an axis of a panel."""
    words, drawn = KEYS.get(key, key), getattr(panel, f"{along}axis")
    drawn.set_label_text(f"{words} [{_unit(axis)}]" if axis.unit else words, parse_math=False)
    if axis.logarithmic:
        panel.set(**{f"{along}scale": "log"})
        log_ticks(drawn)
    elif not ticks:
        drawn.set_major_locator(MaxNLocator(5, min_n_ticks=2))
    if ticks:
        every = -(-len(ticks) // MOST_TICKS)
        panel.set_xticks(
            range(0, len(ticks), every), [tick[:20] for tick in ticks[::every]], parse_math=False
        )
        if sum(map(len, ticks[::every])) > LETTERS:
            panel.tick_params(axis="x", labelrotation=90)
        panel.set_xlim(-0.5, len(ticks) - 0.5)
