# SPDX-License-Identifier: MIT
"""Coefficients kept in files from one process to the next, for whoever asks for it with `using`; without,
`kept` makes them and touches no file.

A file is a header, which names what the coefficients are of and the sums of their bits, and the array. Files
are written aside and put in place whole, so any number of processes may share a folder and delete what is in
it. A file that is not what is asked for, bit by bit, is made again in its place.
"""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from contextvars import ContextVar
from dataclasses import dataclass
from pathlib import Path
from tempfile import NamedTemporaryFile
from time import time
from typing import Any

import numpy as np
from numpy.typing import DTypeLike, NDArray

NAME, PART = ".coefficients", ".part"
HEADER = 4096  # bytes before the array: a page
SUMMED = 8192  # numbers of 8 bytes whose sum is kept, so that what changed its place shows too
FORGOTTEN = 86400.0  # s after which a file that was never finished is removed


@dataclass(frozen=True)
class CoefficientStore:
    """Files of coefficients up to so many bytes in all; version: of all that decides them."""

    path: Path
    limit: float
    version: str


_USED: ContextVar[CoefficientStore | None] = ContextVar("coefficients", default=None)


@contextmanager
def using(folder: CoefficientStore | None) -> Iterator[None]:
    """In the block coefficients are taken from a folder, which is made when needed, and kept there."""
    token = _USED.set(folder)
    try:
        yield
    finally:
        _USED.reset(token)


def kept(
    identity: str, shape: tuple[int, ...], real: DTypeLike, make: Callable[[], NDArray[Any]]
) -> NDArray[Any]:
    """The array that `make` gives, from the folder if it is there; identity: what it is made from."""
    folder, form = _USED.get(), np.dtype(real)
    size = int(np.prod(shape)) * form.itemsize
    if folder is None or size > folder.limit:
        return make()
    who = json.dumps([folder.version, identity, shape, form.str])
    path = folder.path / f"{hashlib.sha256(who.encode()).hexdigest()}{NAME}"
    with suppress(OSError, ValueError), path.open("rb") as file:  # of a file that is not there, or cut
        found = np.memmap(file, form, "r", HEADER, shape)
        file.seek(0)
        if path.stat().st_size == HEADER + size and file.read(HEADER) == _header(who, found):
            os.utime(path)
            return found
    made = make()
    with suppress(OSError):  # what cannot be kept is made again
        folder.path.mkdir(parents=True, exist_ok=True)
        _write(path, _header(who, made), made)
        _bound(folder)
    return made


def _header(who: str, array: NDArray[Any]) -> bytes:
    """Who, and a digest of sums over the bits of the array."""
    bits = array.reshape(-1).view(np.uint8)
    whole = len(bits) // (8 * SUMMED) * 8 * SUMMED
    sums = bits[:whole].view(np.uint64).reshape(-1, SUMMED).sum(axis=1)
    digest = hashlib.sha256(sums.tobytes() + bits[whole:].tobytes()).hexdigest()
    return f"{digest} {hashlib.sha256(who.encode()).hexdigest()}".encode().ljust(HEADER)


def _write(path: Path, header: bytes, array: NDArray[Any]) -> None:
    with NamedTemporaryFile(dir=path.parent, suffix=PART, delete=False) as file:
        try:
            file.write(header)
            array.tofile(file)
            file.close()
            os.replace(file.name, path)
        except BaseException:
            Path(file.name).unlink(missing_ok=True)
            raise


def _bound(folder: CoefficientStore) -> None:
    """Remove what was used longest ago beyond the limit, and files that were never finished."""
    last, total = {path: path.stat() for path in folder.path.glob(f"*{NAME}")}, 0
    for path in sorted(last, key=lambda path: last[path].st_mtime, reverse=True):
        total += last[path].st_size
        if total > folder.limit:
            path.unlink(missing_ok=True)
    for path in folder.path.glob(f"*{PART}"):
        if time() - path.stat().st_mtime > FORGOTTEN:
            path.unlink(missing_ok=True)
