# SPDX-License-Identifier: MIT
"""All rows of the robustness matrix, from `rows.toml`."""

from __future__ import annotations

import tomllib
from functools import cache
from importlib import resources

from verification.robustness.matrix.checks import check_of
from verification.robustness.matrix.row import Absent, Expectation, Refused, Right, Row
from verification.runs.models import FEM, FEM_3D, SAM


@cache
def table() -> dict:
    """The file: `quick`, `changes`, `expected`, and the topics with their rows."""
    return tomllib.loads(resources.files(__package__).joinpath("rows.toml").read_text(encoding="utf-8"))


def topics() -> dict[str, str]:
    """Of what there must be rows at level full: name -> in words."""
    return {name: words for name, (words, *_) in table()["topics"].items()}


def expectation(said: str | list) -> Expectation:
    """What must become of a cell, as a row says it or by its name."""
    kind, reason, *rest = table()["expected"][said] if isinstance(said, str) else said
    if kind == "right":
        named = table()["checks"]
        return Right(reason, [check_of(named.get(e, e) if isinstance(e, str) else e) for e in rest])
    if kind == "absent":
        return Absent(reason)
    return Refused(reason, rest[1:], None if rest[0] == "unsolved" else rest[0])


def all_rows(level: str) -> list[Row]:
    """The rows of a level, by topic."""
    quick, found = table()["quick"], []
    for topic, (_, *rows) in table()["topics"].items():
        for name, what, *rest in rows:
            own: dict = {}
            for part in (each for each in rest if isinstance(each, dict)):
                for shared in part.get("with", ()):
                    own |= table()["changes"][shared]
                own |= {key: value for key, value in part.items() if key != "with"}
            said = [each for each in rest if not isinstance(each, dict)]
            if len(said) == 1:
                said *= 2
            elif said[0] == "every":
                said = said[1:] * 3
            expected = zip((SAM, FEM, FEM_3D), map(expectation, said), strict=False)
            found.append(Row(name, topic, what, own, dict(expected), name in quick))
    return found if level == "full" else [row for row in found if row.quick]
