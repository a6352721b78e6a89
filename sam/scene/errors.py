# SPDX-License-Identifier: MIT
"""What is wrong with a scene: key, value and what is allowed, all of it at once."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass

_LONGEST = 60


@dataclass(frozen=True)
class Problem:
    """One error. key: dotted, empty for the file as a whole; value: as TOML would spell it, "missing" if it is."""

    key: str
    value: str
    allowed: str

    def __str__(self) -> str:
        if not self.key:
            return self.allowed
        between = " is " if self.value == MISSING else " = "
        return f"{self.key}{between}{self.value}: {self.allowed}"


MISSING = "missing"


class SceneError(ValueError):
    """A scene that cannot be used. problems: every error of it; source: the name of the file."""

    def __init__(self, problems: Sequence[Problem], source: str):
        self.problems = tuple(problems)
        self.source = source
        super().__init__(str(self))

    def __str__(self) -> str:
        if len(self.problems) == 1:
            return f"{self.source}: {self.problems[0]}"
        return "\n  ".join([f"{self.source}: {len(self.problems)} errors", *map(str, self.problems)])


def spelling(value: object) -> str:
    """A value as a scene file spells it, on one line and shortened."""
    try:
        text = json.dumps(value, ensure_ascii=False, default=str)
    except (ValueError, RecursionError):
        text = repr(type(value))
    text = "".join(character if character.isprintable() else "?" for character in text)
    return text if len(text) <= _LONGEST else text[: _LONGEST - 3] + "..."
