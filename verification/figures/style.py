# SPDX-License-Identifier: MIT
"""One look for all figures, and how they are written. The only place besides its siblings that imports
matplotlib.
"""

from __future__ import annotations

import io
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from PIL import Image

from verification.runs.files import write_atomically
from verification.runs.tables import csv_text

# Okabe & Ito (2008), distinguishable with every common colour vision deficiency.
BLACK, ORANGE, BLUE, GREEN, VERMILION, PURPLE = (
    "#000000",
    "#E69F00",
    "#0072B2",
    "#009E73",
    "#D55E00",
    "#CC79A7",
)
SAM = {"color": BLUE, "linestyle": "-", "linewidth": 1.6}
FEM = {"color": VERMILION, "linestyle": "--", "linewidth": 1.6}
EXACT = {"color": BLACK, "linestyle": ":", "linewidth": 1.6}

RC = {
    "font.size": 9.0,
    "axes.titlesize": 9.5,
    "axes.titleweight": "bold",
    "axes.labelsize": 9.0,
    "legend.fontsize": 8.0,
    "legend.frameon": False,
    "xtick.labelsize": 8.0,
    "ytick.labelsize": 8.0,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "grid.color": "#dddddd",
    "grid.linewidth": 0.6,
    "axes.formatter.useoffset": False,
    "image.interpolation": "nearest",
    "pdf.fonttype": 42,  # fonts go into the file as they are, so that text stays text
}

DPI = 200
GREY = "#d9d9d9"
"""Of what is not in contact, not known or not compared: never a colour of a map."""
GUIDE = "guide"
"""`gid` of a line that a reader knows without a word: zero, or the diagonal of two equal axes."""
_DIGITS = 5


@dataclass(frozen=True)
class Drawing:
    """A figure and the numbers behind it: column name (with unit) -> (n,) values."""

    figure: Figure
    data: Mapping[str, Sequence]


class Columns(dict[str, list]):
    """The numbers behind a drawing, filled as it is drawn: name of a column (with unit) -> its entries."""

    def __init__(self, *names: str) -> None:
        super().__init__({name: [] for name in names})

    def add(self, *values: object) -> None:
        """Entries of every column, in their order; a single value stands for all entries of the others."""
        count = next((len(each) for each in values if np.ndim(each)), 1)
        for column, each in zip(self.values(), values, strict=True):
            column.extend(each if np.ndim(each) else [each] * count)


def zero_line(axis: Axes) -> None:
    """The zero of a vertical axis."""
    axis.axhline(0.0, color=BLACK, linewidth=0.6, gid=GUIDE)


def style():
    """Context manager: matplotlib's parameters for drawing and for writing."""
    return matplotlib.rc_context(RC)


@contextmanager
def sheet(
    width: float,
    height: float,
    panels: int | tuple[int, int] | None = None,
    *,
    layout: str = "constrained",
    **options: Any,
) -> Iterator[tuple[Figure, Any]]:
    """An empty figure (inches) in the house style and its axes.

    panels: None for one, a number of them in a row, or (rows, columns) of a grid; options: of
    `Figure.subplots`.
    """
    grid = panels if isinstance(panels, tuple) else (1, panels or 1)
    with style():
        figure = new_figure(width, height, layout)
        axes = figure.subplots(*grid, squeeze=False, **options)
        if panels is None:
            yield figure, axes[0, 0]
        else:
            yield figure, axes if isinstance(panels, tuple) else axes[0]


def new_figure(width: float, height: float, layout: str = "constrained") -> Figure:
    """An empty figure (inches) on the Agg canvas, without pyplot's global state; "compressed" is for maps."""
    figure = Figure(figsize=(width, height), layout=layout, dpi=DPI)
    FigureCanvasAgg(figure)
    return figure


def save(drawing: Drawing, stem: Path, data: bool = True, *, pdf: bool = False) -> list[Path]:
    """Write stem.png and, if `data`, stem.csv, or stem.pdf alone; equal drawings give equal bytes, without a
    date.
    """
    kind, dated = ("pdf", "CreationDate") if pdf else ("png", "Software")
    buffer, paths = io.BytesIO(), [_suffixed(stem, kind)]
    with style():
        drawing.figure.savefig(buffer, format=kind, dpi=DPI, metadata={dated: None})
    write_atomically(paths[0], buffer.getvalue() if pdf else _small(buffer))
    if data and not pdf:
        paths.append(_suffixed(stem, "csv"))
        write_atomically(paths[-1], _short(drawing.data).encode())
    return paths


def _small(png: io.BytesIO) -> bytes:
    """The same picture, in full colour without transparency, compressed as far as it goes."""
    smaller = io.BytesIO()
    Image.open(png).convert("RGB").save(smaller, "PNG", optimize=True, dpi=(DPI, DPI))
    return smaller.getvalue()


def _suffixed(stem: Path, kind: str) -> Path:
    return stem.with_name(f"{stem.name}.{kind}")


def _short(data: Mapping[str, Sequence]) -> str:
    """Five digits are more than a figure shows; the runs keep every digit."""
    columns = [[_rounded(value) for value in column] for column in data.values()]
    return csv_text(list(data), list(zip(*columns, strict=True)))


def _rounded(value: object) -> object:
    return float(f"{value:.{_DIGITS}g}") if isinstance(value, float) else value
