# SPDX-License-Identifier: MIT
"""From a scene file to a Scene, or to every error of it at once."""

from __future__ import annotations

import tomllib
from pathlib import Path

from pydantic import ValidationError

from sam.scene.errors import MISSING, Problem, SceneError, spelling
from sam.scene.schema import Scene
from sam.scene.section import MISSING_INPUT
from sam.scene.units import IN_FILE

LARGEST_FILE = 1 << 20


def load_scene(path: str | Path) -> Scene:
    """The scene in a TOML file. Raises SceneError, which lists every problem with key, value and what is allowed."""
    return parse_scene(read_bytes(path), str(path))


def read_bytes(path: str | Path) -> bytes:
    """The content of a scene file. Raises SceneError if it cannot be read or is too large to be one."""
    try:
        with open(path, "rb") as stream:
            content = stream.read(LARGEST_FILE + 1)
    except (OSError, ValueError) as error:  # ValueError: a null character in the name
        raise _whole_file(f"cannot be read: {getattr(error, 'strerror', None) or error}", path) from None
    if len(content) > LARGEST_FILE:
        raise _whole_file(f"too large for a scene: at most {LARGEST_FILE} bytes are allowed", path)
    return content


def parse_scene(content: bytes, source: str) -> Scene:
    """The scene in the bytes of a TOML file; `source` names it in errors. Raises SceneError."""
    try:
        table = tomllib.loads(content.decode("utf-8-sig"))
    except UnicodeDecodeError as error:
        line = content.count(b"\n", 0, error.start) + 1
        raise _whole_file(f"not UTF-8: byte {content[error.start]:#04x} in line {line}", source) from None
    except RecursionError:
        raise _whole_file("not a scene: nested too deeply", source) from None
    except ValueError as error:  # TOMLDecodeError, and a number of thousands of digits
        raise _whole_file(f"not TOML: {error}", source) from None
    if not table:
        raise _whole_file("empty: a scene needs the tables [body], [counterbody] and [loading]", source)
    try:
        return Scene.model_validate(table, context=IN_FILE)
    except ValidationError as error:
        raise SceneError(problems(error), source) from None


def problems(error: ValidationError) -> list[Problem]:
    """Every problem of a validation error, in the order of the file's keys."""
    found = []
    for item in error.errors(include_url=False):
        missing = item["input"] is MISSING_INPUT
        value = MISSING if missing else spelling(item["input"])
        found.append(Problem(_key(item["loc"]), value, item["ctx"]["allowed"]))
    return found


def _key(loc: tuple) -> str:
    parts = [f"[{part}]" if isinstance(part, int) else f".{part}" for part in loc]
    return "".join(parts).removeprefix(".")


def _whole_file(message: str, source: str | Path) -> SceneError:
    return SceneError([Problem("", "", message)], str(source))
