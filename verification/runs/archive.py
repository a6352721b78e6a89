# SPDX-License-Identifier: MIT
"""Arrays and plain values in one file (npz), written whole or not at all and read without trusting it.

The values are JSON in an array of bytes; nothing is ever unpickled and nothing inflated: the members are
stored as they are. A file that is damaged in any way is an ArchiveError: a digest covers names, types, shapes
and content of all members.
"""

import hashlib
import json
import os
import zipfile
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from sam.scene import open_file
from verification.runs.files import replacing

VALUES, DIGEST = "values.json", "sha256"


class ArchiveError(ValueError):
    """A file that is no archive, or a damaged one; the message says why."""


def write_archive(path: Path, arrays: Mapping[str, np.ndarray], values: Mapping) -> None:
    """Write arrays (no objects) and values (what JSON holds; every digit, NaN and inf allowed)."""
    members = {**arrays, VALUES: np.frombuffer(json.dumps(values).encode(), dtype=np.uint8)}
    members[DIGEST] = digest_of(members)
    with replacing(path) as temporary, open(temporary, "wb") as stream:
        np.savez(stream, allow_pickle=False, **members)


def read_archive(path: Path) -> tuple[dict[str, np.ndarray], dict]:
    """(arrays, values) of an archive. Raises ArchiveError, also for a file that is not there."""
    try:
        with open_file(path) as stream:
            with zipfile.ZipFile(stream) as members:
                if sum(each.file_size for each in members.infolist()) > os.fstat(stream.fileno()).st_size:
                    raise ArchiveError(f"{path} is damaged: it would become larger than it is")
            stream.seek(0)
            with np.load(stream, allow_pickle=False) as content:
                arrays = {name: content[name] for name in content.files}
        said, found = arrays.pop(DIGEST, None), digest_of(arrays)
        values = json.loads(arrays.pop(VALUES).tobytes())
    except FileNotFoundError:
        raise ArchiveError(f"{path} is not there") from None
    except ArchiveError:
        raise
    except Exception as error:  # of a dozen kinds for odd bytes in zipfile and numpy, TokenError among them
        raise ArchiveError(f"{path} is no archive, or a damaged one ({error})") from None
    if not isinstance(values, dict):
        raise ArchiveError(f"{path} is no archive: its values are no table")
    if not np.array_equal(said, found):
        raise ArchiveError(f"{path} is damaged, or of an older version: it has not the digest of its content")
    return arrays, values


def read_values(path: Path) -> dict:
    """The values of an archive, without its arrays and unchecked. Raises ArchiveError."""
    try:
        with np.load(path, allow_pickle=False) as content:
            values: dict = json.loads(content[VALUES].tobytes())
    except Exception as error:
        raise ArchiveError(f"{path} is no archive, or a damaged one ({error})") from None
    return values


def digest_of(members: Mapping[str, np.ndarray]) -> np.ndarray:
    """SHA-256 of names, types, shapes and content, as bytes in an array."""
    found = hashlib.sha256()
    for name, array in sorted(members.items()):
        found.update(json.dumps([name, array.dtype.str, array.shape]).encode())
        found.update(np.ascontiguousarray(array))
    return np.frombuffer(found.digest(), dtype=np.uint8)
