# SPDX-License-Identifier: MIT
"""Reading of scene files: a file becomes a Scene, or every error of it is reported at once."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from sam.scene.inputs import InputError, Inputs, read_limited
from sam.scene.schema import Scene
from sam.scene.section import Problem, SceneError, problems
from sam.scene.units import IN_FILE

_BETWEEN = re.compile(rb"([\n,={}\[\]#])")
_BARE = re.compile(rb"^[^\n#\"']*[=\[,]\s*+[+-]?[0-9][0-9.eE_+-]*+[ \t]*+[A-Za-z]", re.MULTILINE)
"""A number with a unit and without quotes."""
_MOST_DOTS = 32  # in one key

KINDS = {
    "rows": ("verification case", "verify"),
    "cases": ("verification case", "verify"),
    "vary": ("study", "sweep"),
    "unknown": ("fit", "fit"),
    "body": ("scene", "solve"),
}
"""Table that a file has -> its kind, and the command that takes it."""


def load_scene(path: str | Path) -> Scene:
    """The scene in a TOML file.

    Parameters
    ----------
    path
        Of the file; files that it names are read from its folder.

    Raises
    ------
    SceneError
        With every problem of the file: key, value and what is allowed.
    """
    return read_scene(path)[0]


def read_scene(path: str | Path) -> tuple[Scene, dict[str, bytes]]:
    """As `load_scene`, with the content of every file that was read, the scene file among them, by name."""
    path = Path(path)
    try:
        content = read_limited(path)
    except InputError as error:
        raise _whole_file(str(error), path) from None
    inputs = Inputs(path.parent)
    scene = parse_scene(content, str(path), inputs)
    return scene, {path.name: content, **inputs.contents}


def parse_scene(content: bytes, source: str, inputs: Inputs | None = None) -> Scene:
    """The scene in bytes of TOML, whose name is `source`; inputs: reads the files that it names."""
    table = parse_toml(content, source)
    if not table:
        raise _whole_file("empty: a scene needs the tables [body], [counterbody] and [loading]", source)
    check_kind(table, "scene", source)
    return scene_of(table, source, inputs)


def parse_toml(content: bytes, source: str) -> dict[str, Any]:
    """The tables in bytes of TOML; SceneError for others, or tables in too many."""
    pieces = _BETWEEN.split(content)  # every second one is a separator
    if any(
        name.count(b".") > _MOST_DOTS and end in b"=]"
        for name, end in zip(pieces[::2], pieces[1::2], strict=False)
    ):
        raise _whole_file("nested too deeply", source)  # tomllib takes time with the square of the depth
    try:
        return tomllib.loads(content.decode("utf-8-sig"))
    except UnicodeDecodeError as error:
        line = content.count(b"\n", 0, error.start) + 1
        raise _whole_file(f"not UTF-8: byte {content[error.start]:#04x} in line {line}", source) from None
    except RecursionError:
        raise _whole_file("nested too deeply", source) from None
    except ValueError as error:  # TOMLDecodeError, and a number of thousands of digits
        quotes = ": numbers with units stand in quotes" if _BARE.search(content) else ""
        raise _whole_file(f"not TOML: {error}{quotes}", source) from None


def check_kind(table: Mapping[str, Any], own: str, source: str) -> None:
    """Raise SceneError for a file of another kind than its own, with the command that takes it."""
    kind, command = next((kind for key, kind in KINDS.items() if key in table), (own, ""))
    if kind != own and not any(key in table for key, (other, _) in KINDS.items() if other == own):
        raise _whole_file(f"this is a {kind}: samfem {command} {source}", source)


def scene_of(table: Mapping[str, Any], source: str, inputs: Inputs | None = None) -> Scene:
    """The scene, with all defaults, in the tables that `parse_toml` returns; the rest as of `parse_scene`."""
    try:
        return Scene.model_validate(table, context={**IN_FILE, "inputs": inputs})
    except ValidationError as error:
        raise SceneError(problems(error), source) from None


def _whole_file(message: str, source: str | Path) -> SceneError:
    return SceneError([Problem("", "", message)], str(source))
