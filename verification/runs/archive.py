# SPDX-License-Identifier: MIT
"""Arrays and plain values in one file (npz), written whole or not at all and read without trusting it.

The values are JSON in an array of bytes; nothing is ever unpickled. A file that is damaged in any way is an
ArchiveError: the checksums of the zip container cover every byte of the members.
"""

from __future__ import annotations

import json
import zipfile
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from sam.scene import open_file
from verification.runs.files import replacing

VALUES = "values.json"


class ArchiveError(ValueError):
    """A file that is no archive, or a damaged one; the message says why."""


def write_archive(path: Path, arrays: Mapping[str, np.ndarray], values: Mapping) -> None:
    """Write arrays (no objects among them) and values (what JSON holds; floats keep every digit, NaN and inf
    allowed).
    """
    if VALUES in arrays:
        raise ValueError(f"the name {VALUES} is taken")
    text = np.frombuffer(json.dumps(values).encode(), dtype=np.uint8)
    with replacing(path) as temporary, open(temporary, "wb") as stream:
        np.savez(stream, allow_pickle=False, **arrays, **{VALUES: text})


def read_archive(path: Path) -> tuple[dict[str, np.ndarray], dict]:
    """(arrays, values) of an archive. Raises ArchiveError, also for a file that is not there."""
    try:
        with open_file(path) as stream:
            with zipfile.ZipFile(stream) as members:
                whole = members.testzip() is None
            if not whole:
                raise ArchiveError(f"{path} is damaged")
            stream.seek(0)
            with np.load(stream, allow_pickle=False) as content:
                arrays = {name: content[name] for name in content.files}
        values = json.loads(arrays.pop(VALUES).tobytes())
    except FileNotFoundError:
        raise ArchiveError(f"{path} is not there") from None
    except ArchiveError:
        raise
    except (
        Exception
    ) as error:  # for odd bytes zipfile and numpy raise errors of a dozen kinds, TokenError among them
        raise ArchiveError(f"{path} is no archive, or a damaged one ({error})") from None
    if not isinstance(values, dict):
        raise ArchiveError(f"{path} is no archive: its values are no table")
    return arrays, values
