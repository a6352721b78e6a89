# SPDX-License-Identifier: MIT
"""The lock of a folder: one run at a time writes into it.

The lock is on the folder itself, so it leaves no file, and the kernel releases it however the process ends.
Where the system or the file system has no such locks there is none.
"""

import contextlib
import os
import platform
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from filelock import lock_descriptor

from verification.runs.files import FolderError

LOCKS = Path("/proc/locks")
"""Of this machine: "1: FLOCK  ADVISORY  WRITE pid major:minor:inode 0 EOF"."""


@contextmanager
def locked(folder: str | Path) -> Iterator[None]:
    """Hold `folder` for the block, made if need be; one that is made here and stays empty is removed again.
    Raises FolderError, at once, if another block of any process holds it or it cannot be made.
    """
    folder = Path(folder)
    made = [place for place in (folder, *folder.parents) if not place.exists()]
    descriptor = _held(folder)
    try:
        yield
    finally:
        with contextlib.suppress(OSError):  # not empty, or gone
            for place in made:
                place.rmdir()
        os.close(descriptor)


def _held(folder: Path) -> int:
    """A descriptor of the folder, with the lock on it."""
    while True:
        try:
            folder.mkdir(parents=True, exist_ok=True)
            descriptor = os.open(folder, os.O_RDONLY | os.O_DIRECTORY)
        except OSError as error:
            raise FolderError(f"{folder} cannot be used: {error.strerror}; give another --out") from None
        try:
            free = lock_descriptor(descriptor, blocking=False)
        except OSError:  # no such locks here
            return descriptor
        if free and _is(folder, descriptor):
            return descriptor
        holder = "" if free else _holder(os.fstat(descriptor).st_ino)
        os.close(descriptor)
        if holder:
            raise FolderError(f"{folder} is being written by {holder}: wait, or give another --out")
        # else its last holder removed the folder in between


def _is(folder: Path, descriptor: int) -> bool:
    try:
        return os.path.samestat(os.stat(folder), os.fstat(descriptor))
    except FileNotFoundError:
        return False


def _holder(inode: int) -> str:
    """Who holds the lock, in words."""
    try:
        rows = [line.split() for line in LOCKS.read_text(encoding="utf-8").splitlines()]
    except OSError:
        rows = []
    for row in rows:
        if len(row) > 5 and row[1] == "FLOCK" and row[5].rpartition(":")[2] == str(inode):
            return f"process {row[4]} on {platform.node()}"
    return "another process"
