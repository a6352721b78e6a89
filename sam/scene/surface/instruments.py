# SPDX-License-Identifier: MIT
"""Height maps in the files of instruments, read by SurfaceTopography, the extra "instruments".

The ending of the name says which formats are tried. The library reads in a process of its own. Lengths
become m; a file that says neither a unit nor its size is refused, nothing is guessed. Formats that hold no
lengths are left out.

Orientation: x along the rows of the picture to the right, y from row to row downwards, heights out of the
surface. Seen from outside, x to the right, y down and z into the body are right-handed: nothing is mirrored.
"""

from __future__ import annotations

from importlib.util import find_spec
from pathlib import Path

from sam.scene.apart import read_apart
from sam.scene.inputs import InputError
from sam.scene.surface.height_map import HeightMap
from sam.scene.surface.instrument_formats import formats_of
from sam.scene.units import CELLS

LIBRARY = "SurfaceTopography"
EXTRA = "pip install samfem[instruments]"
READER = Path(__file__).with_name("instrument_child.py")
BYTES = 4 << 30  # of address space: a file may hold at most 256 MiB


def read(name: str, content: bytes, kind: type[HeightMap] = HeightMap) -> HeightMap:
    """The heights in an instrument's file of that name. Raises InputError, also where the library is not
    installed.
    """
    if find_spec(LIBRARY) is None:
        raise InputError(
            f'an instrument\'s file is read with {LIBRARY}, the extra "instruments", not installed: {EXTRA}'
        )
    formats = formats_of(name)
    try:
        said, arrays = read_apart(READER, f"{CELLS.high:g}", *formats, content=content, memory=BYTES)
        values, (along, across) = arrays["heights"].astype(float), map(float, said["extent"])
    except InputError as error:
        raise InputError(f"no heights, read as {' or '.join(formats)}: {error}") from None
    except (KeyError, TypeError, ValueError):
        raise InputError("no heights: its reader answered nonsense") from None
    return kind(values, (along, across))
