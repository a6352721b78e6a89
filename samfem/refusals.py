# SPDX-License-Identifier: MIT
"""The errors that say what is wrong with the input of a command, which ends in exit code 2."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from sam.scene import SceneError
from verification.runs.files import FolderError
from verification.runs.models import ModelError


class SeveralError(ValueError):
    """More than one refusal; the message has each on lines of its own."""


REFUSALS = (SceneError, FolderError, ModelError, SeveralError)


class Refusals:
    """Keeps what is refused until everything has been looked at."""

    def __init__(self) -> None:
        self._found: list[Exception] = []

    @contextmanager
    def kept(self) -> Iterator[None]:
        """A block that ends where something is refused."""
        try:
            yield
        except REFUSALS as error:
            self._found.append(error)

    def raise_any(self) -> None:
        """Raise the refusal, or SeveralError with all of them; do nothing without one."""
        if len(self._found) == 1:
            raise self._found[0]
        if self._found:
            raise SeveralError("\n".join(map(str, self._found)))
