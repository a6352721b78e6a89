# SPDX-License-Identifier: MIT
"""One look for all figures, and how they are written."""

import gzip
import io
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.cm import ScalarMappable
from matplotlib.contour import ContourSet
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, MaxNLocator, NullFormatter
from PIL import Image

from verification.runs.files import write_atomically
from verification.runs.model_range import OUTSIDE, outside_in_words, outside_of_model
from verification.runs.tables import csv_text

# Okabe & Ito (2008), distinguishable with every common colour vision deficiency.
BLACK, ORANGE, BLUE = "#000000", "#E69F00", "#0072B2"
GREEN, VERMILION, PURPLE = "#009E73", "#D55E00", "#CC79A7"
SAM = {"color": BLUE, "linestyle": "-", "linewidth": 1.6}
FEM = {"color": VERMILION, "linestyle": "--", "linewidth": 1.6}
EXACT = {"color": BLACK, "linestyle": ":", "linewidth": 1.6}

LONG = 60_000  # bytes of a table, some 1500 cells of a map
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

DPI = 180
GREY = "#d9d9d9"
"""Of what is not in contact, not known or not compared: never a colour of a map."""
GUIDE = "guide"
"""`gid` of a line that a reader knows without a word: zero, or the diagonal of two equal axes."""
MANY_DECADES = 2.0
PLAIN_NUMBERS = (5e-4, 2e4)
"""Ends of a logarithmic axis within which its numbers are written out."""


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


def marked(drawings: Mapping[str, Drawing], *results: Any) -> dict[str, Drawing]:
    """The drawings of results, each with a foot note and a column where one lies outside of its model."""
    outside = max((a for each in results if (a := outside_of_model(each)) is not None), default=None)
    if outside is None:
        return dict(drawings)
    with style():
        for each in drawings.values():
            each.figure.supxlabel(outside_in_words(outside), fontsize=8.0, color=VERMILION)
    return {
        name: Drawing(
            each.figure, {**each.data, OUTSIDE: [outside] * len(next(iter(each.data.values()), ()))}
        )
        for name, each in drawings.items()
    }


def zero_line(axis: Axes) -> None:
    """The zero of a vertical axis."""
    axis.axhline(0.0, color=BLACK, linewidth=0.6, gid=GUIDE)


def log_ticks(axis: Axis) -> None:
    """Numbers on a logarithmic axis: powers of ten, steps between them where there are few of those, fewer of
    multiples of powers, which are wide, and even ones where its ends are less than a factor of two apart; all
    in one notation.
    """
    low, high = axis.get_view_interval()
    decades = np.log10(high / low)
    plain = PLAIN_NUMBERS[0] <= low and high <= PLAIN_NUMBERS[1]
    between = ((1.0, 2.0, 5.0) if plain else (1.0, 3.0)) if decades > 0.7 else (1.0, 1.5, 2.0, 3.0, 5.0, 7.0)
    steps = (1.0,) if decades > MANY_DECADES else between
    several = LogLocator(subs=steps, numticks=20 if decades < 8.0 else 7)
    axis.set_major_locator(several if high > 2.0 * low else MaxNLocator(4))
    words = "{:g}".format if plain else _scientific
    axis.set_major_formatter(lambda value, _: words(value))
    axis.set_minor_formatter(NullFormatter())


def _scientific(value: float) -> str:
    """A number as a multiple of a power of ten."""
    digits, power = f"{value:e}".split("e")
    return "$" + rf"{float(digits):g} \times ".removeprefix(r"1 \times ") + f"10^{{{int(power)}}}$"


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
    """An empty figure (inches) and its axes. panels: None, a number in a row, or (rows, columns)."""
    grid = panels if isinstance(panels, tuple) else (1, panels or 1)
    with style():
        figure = new_figure(width, height, layout)
        axes = figure.subplots(*grid, squeeze=False, **options)
        if panels is None:
            yield figure, axes[0, 0]
        else:
            yield figure, axes if isinstance(panels, tuple) else axes[0]


class NotebookFigure(Figure):
    """A figure that a notebook shows, at half the size of its pixels, without pyplot."""

    def _repr_png_(self) -> tuple[bytes, dict[str, int]]:
        width, height = (round(DPI / 2 * side) for side in self.get_size_inches())
        return encoded(self), {"width": width, "height": height}


def new_figure(width: float, height: float, layout: str = "constrained") -> Figure:
    """An empty figure (inches) on the Agg canvas, without pyplot's global state; "compressed" is for maps."""
    figure = NotebookFigure(figsize=(width, height), layout=layout, dpi=DPI)
    FigureCanvasAgg(figure)
    return figure


def save(
    drawing: Drawing,
    stem: Path,
    data: bool = True,
    *,
    pdf: bool = False,
    long: int = LONG,
    small: bool = True,
) -> list[Path]:
    """Write stem.png and, if `data`, stem.csv (stem.csv.gz beyond `long` bytes), or stem.pdf alone, and
    return their paths; equal drawings give equal bytes.
    """
    paths = [stem.with_name(f"{stem.name}.{'pdf' if pdf else 'png'}")]
    write_atomically(paths[0], encoded(drawing.figure, pdf=pdf, small=small))
    if data and not pdf:
        # five digits are more than a figure shows; the runs keep every digit
        columns = [
            [float(f"{each:.5g}") if isinstance(each, float) else each for each in column]
            for column in drawing.data.values()
        ]
        content = csv_text(list(drawing.data), list(zip(*columns, strict=True))).encode()
        packed = len(content) > long
        paths.append(stem.with_name(f"{stem.name}.csv{'.gz' * packed}"))
        write_atomically(paths[-1], gzip.compress(content, mtime=0) if packed else content)
    return paths


def encoded(figure: Figure, *, pdf: bool = False, small: bool = True) -> bytes:
    """A figure as PDF, or as PNG; small: with a palette of 256 colours."""
    buffer, smaller = io.BytesIO(), io.BytesIO()
    with style():
        figure.savefig(
            buffer, format="pdf" if pdf else "png", dpi=DPI, metadata={"CreationDate": None} if pdf else {}
        )
    if pdf or not small:
        return buffer.getvalue()
    picture = Image.open(buffer).convert("RGB")
    # colours that cover all that are there: those of few pixels, as in a colour bar, stay what they are
    picture = picture.quantize(256, Image.Quantize.MAXCOVERAGE, dither=Image.Dither.NONE)
    picture.save(smaller, "PNG", optimize=True, dpi=(DPI, DPI))
    return smaller.getvalue()


def fields_of(panel: Axes) -> list[ScalarMappable]:
    """What of a panel is coloured by numbers."""
    drawn = [*panel.collections, *panel.images]
    return [
        each for each in drawn if np.ndim(each.get_array()) in (1, 2) and not isinstance(each, ContourSet)
    ]
