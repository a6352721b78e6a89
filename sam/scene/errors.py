# SPDX-License-Identifier: MIT
"""What is wrong with a scene: key, value and what is allowed, all of it at once."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass

_LONGEST = 60  # characters of a value in a message
MOST_SHOWN = 100  # more is no scene file


@dataclass(frozen=True)
class Problem:
    """One error of a scene.

    Parameters
    ----------
    key
        Dotted, empty for the file as a whole.
    value
        As TOML would spell it, "missing" if it is.
    allowed
        What is allowed, in words.
    """

    key: str
    value: str
    allowed: str

    def __str__(self) -> str:
        if not self.key:
            return self.allowed
        between = " is " if self.value == MISSING else " = "
        return f"{printable(self.key)}{between}{self.value}: {self.allowed}"


MISSING = "missing"


class SceneError(ValueError):
    """A scene that cannot be used.

    Parameters
    ----------
    problems
        Every error of it.
    source
        The name of the file.
    """

    def __init__(self, problems: Sequence[Problem], source: str):
        self.problems = tuple(problems)
        self.source = source
        super().__init__(str(self))

    def __str__(self) -> str:
        source = printable(self.source)
        if len(self.problems) == 1:
            return f"{source}: {self.problems[0]}"
        shown = list(map(str, self.problems[:MOST_SHOWN]))
        if len(self.problems) > MOST_SHOWN:
            shown.append(f"and {len(self.problems) - MOST_SHOWN} more")
        return "\n  ".join([f"{source}: {len(self.problems)} errors", *shown])


def spelling(value: object) -> str:
    """A value as a scene file spells it, on one line and shortened.

    Parameters
    ----------
    value
        Anything; what JSON cannot hold is named by its type.

    Returns
    -------
    str
        At most 60 characters.

    Examples
    --------
    >>> spelling([1, "m"])
    '[1, "m"]'
    """
    try:
        text = json.dumps(value, ensure_ascii=False, default=str)
    except (ValueError, RecursionError):
        text = repr(type(value))
    text = printable(text)
    return text if len(text) <= _LONGEST else text[: _LONGEST - 3] + "..."


def printable(text: str) -> str:
    """The text without control characters and line ends, which could act on a terminal or break a file.

    Parameters
    ----------
    text
        Any text.

    Returns
    -------
    str
        Of the same length, with "?" in their places.
    """
    return "".join(character if character.isprintable() else "?" for character in text)
