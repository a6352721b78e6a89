# SPDX-License-Identifier: MIT
"""Files of published figures, made smaller: tables are packed, large pictures of maps get a palette.

The store keeps them as they were drawn. Of 13.5 MB that 70 cases published, 3.7 MB fall away.
"""

from __future__ import annotations

import gzip
import io
from dataclasses import replace
from pathlib import Path

import numpy as np
from PIL import Image

from verification.cases.case import Figure
from verification.runs.files import write_atomically

PACKED = 4_000  # bytes of a table: packing those beyond saves 1.4 of the 1.9 MB of all, below it nothing
LARGE = 60_000  # bytes of a picture: those beyond, 26 of 181, are more than half of the bytes of all
COLOURS = 128  # of a palette: an eighth less than with 256, no channel off by more than 27 of 255

NEARLY_WHITE = 250  # of 255: the sheet, which the choice of a palette may shade


def lighter(figure: Figure, folder: Path) -> Figure:
    """The figure with smaller files in place of those that are in the folder of its report."""
    picture, table = folder / figure.png, folder / figure.csv
    if picture.is_file() and picture.stat().st_size > LARGE:
        smaller = _with_palette(picture)
        if len(smaller) < picture.stat().st_size:
            write_atomically(picture, smaller)
    if not (figure.csv.endswith(".csv") and table.is_file() and table.stat().st_size > PACKED):
        return figure
    packed = f"{figure.csv}.gz"
    write_atomically(folder / packed, gzip.compress(table.read_bytes(), mtime=0))
    table.unlink()
    return replace(figure, csv=packed)


def _with_palette(path: Path) -> bytes:
    """The picture on white with few colours; the same bytes every time."""
    smaller = io.BytesIO()
    with Image.open(path) as drawn:
        whole = drawn.convert("RGBA")
        resolution = drawn.info.get("dpi", (72.0, 72.0))
    picture = Image.new("RGB", whole.size, "white")
    picture.paste(whole, mask=whole.getchannel("A"))
    few = picture.quantize(COLOURS, Image.Quantize.MAXCOVERAGE, kmeans=3, dither=Image.Dither.NONE)
    colours = np.reshape(few.getpalette(), (-1, 3))
    colours[(colours >= NEARLY_WHITE).all(axis=1)] = 255
    few.putpalette(colours.ravel().tolist())
    few.save(smaller, "PNG", optimize=True, dpi=resolution)
    return smaller.getvalue()
