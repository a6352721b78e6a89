# SPDX-License-Identifier: MIT
"""Height maps in the files of instruments, read by SurfaceTopography, the extra "instruments".

The ending of the name says which formats are tried. The library reads in a process of its own, with limits on
time and memory: whatever the bytes are and whatever its readers do with them, the answer is a map or a
refusal. Lengths become m; a file that says neither a unit nor its size is refused, nothing is guessed.
Formats that hold no lengths are left out.

Orientation: x along the rows of the picture to the right, y from row to row downwards, heights out of the
surface. Seen from outside, x to the right, y down and z into the body are right-handed: nothing is mirrored.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np

from sam.scene.errors import printable
from sam.scene.inputs import InputError
from sam.scene.surface.height_map import HeightMap
from sam.scene.surface.instrument_formats import formats_of
from sam.scene.units import CELLS

LIBRARY = "SurfaceTopography"
EXTRA = "pip install samfem[instruments]"
SECONDS = 120.0  # by the clock, for a start of 2 s on a busy machine and the largest file
CHILD = Path(__file__).with_name("instrument_child.py")


def read(name: str, content: bytes, kind: type[HeightMap] = HeightMap) -> HeightMap:
    """The heights in an instrument's file of that name. Raises InputError, also where the library is not
    installed.
    """
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
        along, across = map(float, head["extent"])
    except (KeyError, TypeError, ValueError):
        raise _unreadable(formats, "its reader answered nonsense") from None
    return kind(values, (along, across))


def _answer(content: bytes, formats: tuple[str, ...]) -> tuple[dict[str, Any], bytes]:
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
