# SPDX-License-Identifier: MIT
"""Height maps in the files of instruments, read by SurfaceTopography, the extra "instruments".

The ending of the name says which formats are tried. The library reads in a process of its own, with limits on time and
memory: whatever the bytes are and whatever its readers do with them, the answer is a map or a refusal. Lengths become m; a
file that says neither a unit nor its size is refused, nothing is guessed. Formats that hold no lengths are left out.

Orientation: x along the rows of the picture to the right, y from row to row downwards, heights out of the surface. Seen
from outside, x to the right, y down and z into the body are right-handed: nothing is mirrored.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path

import numpy as np

from sam.scene.errors import printable
from sam.scene.inputs import InputError
from sam.scene.surface.height_map import HeightMap
from sam.scene.units import CELLS

LIBRARY, EXTRA = "SurfaceTopography", "pip install samfem[instruments]"
SECONDS = 120.0  # by the clock, for a start of 2 s on a busy machine and the largest file
CHILD = Path(__file__).with_name("instrument_child.py")
ENDINGS = {
    "al3d": "al3d", "asc": "asc dat txt", "bcr": "bcr bcrf", "datx": "datx", "di": "001 002 003 004 005 spm", "ezd": "ezd nid",
    "frt": "frt", "gwy": "gwy", "ibw": "ibw", "jpk": "jpk", "lext": "lext", "mdt": "mdt", "metropro": "dat", "mi": "mi",
    "mitutoyo": "xlsx", "mnt": "mnt", "nc": "nc", "nmm": "zip", "nms": "nms", "oir": "oir", "opd": "opd", "opdx": "opdx",
    "os3d": "os3d", "plu": "apx plu", "plux": "plux", "poir": "poir", "ps": "tif tiff", "qep": "qep", "sdf": "sdf", "sur": "sur",
    "tmd": "tmd", "vk": "vk3 vk4 vk6 vk7", "wsxm": "cur stp tom top", "x3p": "x3p", "xyz": "hfm xyz", "zmg": "zmg", "zon": "zon",
}  # fmt: skip
"""Format, as the library calls it -> endings of names."""


def formats_of(name: str) -> tuple[str, ...]:
    """The formats that the ending of a name stands for; none for what is no instrument's file."""
    ending = name.rpartition(".")[2].lower()
    return tuple(found for found, endings in ENDINGS.items() if ending in endings.split())


def read_instrument(name: str, content: bytes) -> HeightMap:
    """The map in an instrument's file. Raises InputError, also where the library is not installed."""
    if find_spec(LIBRARY) is None:
        raise InputError(
            f'an instrument\'s file is read with {LIBRARY}, the extra "instruments", not installed: {EXTRA}'
        )
    formats = formats_of(name)
    head, raw = _answer(content, formats)
    if "refused" in head:
        raise InputError(f"no heights, read as {' or '.join(formats)}: {printable(str(head['refused']))}")
    try:
        values = np.frombuffer(raw, dtype="<f8").reshape(head["cells"])
        extent = tuple(map(float, head["extent"]))
    except (KeyError, TypeError, ValueError):
        raise _unreadable(formats, "its reader answered nonsense") from None
    return HeightMap(values, extent)


def _answer(content: bytes, formats: tuple[str, ...]) -> tuple[dict, bytes]:
    """What the other process says: its first line, and the rest."""
    command = [sys.executable, "-P", str(CHILD), *formats, f"{CELLS.high:g}"]
    alone = {**os.environ, "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
    try:
        found = subprocess.run(
            command,
            input=content,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            timeout=SECONDS,
            env=alone,
            check=False,
        )
        line, _, rest = found.stdout.partition(b"\n")
        head = json.loads(line)
    except subprocess.TimeoutExpired:
        raise _unreadable(formats, f"its reader did not end in {SECONDS:g} s") from None
    except (OSError, ValueError):
        raise _unreadable(formats, "its reader ended without an answer") from None
    if not isinstance(head, dict):
        raise _unreadable(formats, "its reader answered nonsense")
    return head, rest


def _unreadable(formats: tuple[str, ...], why: str) -> InputError:
    return InputError(f"not readable as {' or '.join(formats)}: {why}")
