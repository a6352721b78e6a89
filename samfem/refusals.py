# SPDX-License-Identifier: MIT
"""The errors that say what is wrong with the input of a command, which ends in exit code 2."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

from sam.scene import SceneError
from verification import ExtraError
from verification.runs.files import SUMMARY, FolderError, check_target
from verification.runs.models import ModelError


class SeveralError(ValueError):
    """More than one refusal; the message has each on lines of its own."""


REFUSALS = (SceneError, FolderError, ModelError, SeveralError, ExtraError)


def check_folder(folder: Path, also: Sequence[str], what: str) -> None:
    """Raise FolderError unless the folder is new, empty or of what is named, of which also is `also`."""
    check_target(folder, also=also)
    if (folder / SUMMARY).exists():
        words = "holds a single run: give a new or empty folder, or one of an older"
        raise FolderError(f"{folder} {words} {what}")


class Refusals:
    """Keeps what is refused until everything has been looked at."""

    def __init__(self) -> None:
        self.found: list[Exception] = []

    @contextmanager
    def kept(self) -> Iterator[None]:
        """A block that ends where something is refused."""
        try:
            yield
        except REFUSALS as error:
            self.found.append(error)

    def raise_any(self) -> None:
        """Raise the refusal, or SeveralError with all of them; do nothing without one."""
        if len(self.found) == 1:
            raise self.found[0]
        if self.found:
            raise SeveralError("\n".join(map(str, self.found)))
