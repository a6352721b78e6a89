# SPDX-License-Identifier: MIT
"""What is stored in tests of the store: a coarse scene; equality bit by bit, and damage."""

from dataclasses import fields, is_dataclass
from enum import Enum
from pathlib import Path

import numpy as np
from builders import parsed

from verification.runs import models

COARSE_KEYS = 'unload = true\n[grid]\ncells = [33, 33]\nlayers = 20\ndepth = "12 um"\n'
COARSE_KEYS += "[fem]\ncells_per_radius = 8\nbox = 6\n"
COARSE = parsed(add=COARSE_KEYS)
BOTH = (models.SAM, models.FEM)


def same(a, b) -> bool:
    """Equal in type, in every bit of a number, and all the way down."""
    if type(a) is not type(b):
        return False
    if isinstance(a, np.ndarray | np.generic):
        return a.dtype == b.dtype and a.shape == b.shape and a.tobytes() == b.tobytes()
    if isinstance(a, Enum) or not (is_dataclass(a) or isinstance(a, dict | list | tuple)):
        return repr(a) == repr(b)
    if is_dataclass(a):
        return all(same(getattr(a, field.name), getattr(b, field.name)) for field in fields(a))
    if isinstance(a, dict):
        return list(a) == list(b) and all(same(a[key], b[key]) for key in a)
    return len(a) == len(b) and all(map(same, a, b))


def flipped(path: Path, place: int) -> None:
    content = bytearray(path.read_bytes())
    content[place] ^= 0x10
    path.write_bytes(content)
