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
    "svg.hashsalt": "samfem",
    "svg.fonttype": "none",
}

_KINDS = {
    "png": {"dpi": 120, "metadata": {"Software": None}},
    "svg": {"dpi": 120, "metadata": {"Date": None}},
}


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
    figure = Figure(figsize=(width, height), layout=layout)
    FigureCanvasAgg(figure)
    return figure


def save(drawing: Drawing, stem: Path, data: bool = True) -> list[Path]:
    """Write stem.png, stem.svg and, if `data`, stem.csv; equal drawings give equal bytes (no date, fixed
    identifiers).
    """
    paths = []
    with style():
        for kind, options in _KINDS.items():
            buffer = io.BytesIO()
            drawing.figure.savefig(buffer, format=kind, **options)
            paths.append(_suffixed(stem, kind))
            write_atomically(paths[-1], _indexed(buffer) if kind == "png" else buffer.getvalue())
    if data:
        paths.append(_suffixed(stem, "csv"))
        write_atomically(paths[-1], _short(drawing.data).encode())
    return paths


def _indexed(png: io.BytesIO) -> bytes:
    """The picture with a palette of 256 colours: a third of the bytes, no colour off by more than 6 %."""
    colours = (
        Image.open(png)
        .convert("RGB")
        .quantize(256, Image.Quantize.MAXCOVERAGE, kmeans=3, dither=Image.Dither.NONE)
    )
    smaller = io.BytesIO()
    colours.save(smaller, "PNG", optimize=True)
    return smaller.getvalue()


def _suffixed(stem: Path, kind: str) -> Path:
    return stem.with_name(f"{stem.name}.{kind}")


def _short(data: Mapping[str, Sequence]) -> str:
    """Seven digits are enough to redraw a figure; the runs keep every digit."""
    columns = [[_seven_digits(value) for value in column] for column in data.values()]
    return csv_text(list(data), list(zip(*columns, strict=True)))


def _seven_digits(value: object) -> object:
    return float(f"{value:.7g}") if isinstance(value, float) else value
