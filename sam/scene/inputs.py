# SPDX-License-Identifier: MIT
"""Files that a scene names: read once, when the scene is read, and part of it from then on. Those of other
programs are read in a process of their own with limits on time and memory: whatever the bytes are and
whatever a library makes of them, the answer is arrays or a refusal.

A key of a small table holds the name of a CSV file with a header line, in Python the rows themselves. One
validator serves both, so that solvers see rows and never a file.
"""

from __future__ import annotations

import csv
import errno
import io
import json
import os
import stat
import subprocess
import sys
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import islice, pairwise
from pathlib import Path
from types import MappingProxyType
from typing import Any, BinaryIO

import numpy as np
from numpy.typing import NDArray
from pydantic import BeforeValidator, ValidationInfo
from pydantic_core import PydanticCustomError, core_schema

from sam.scene.section import printable, spelling
from sam.scene.units import Number, in_file, refused

LARGEST_FILE = 1 << 20  # bytes: a scene, or a table of MOST_ROWS with 100 characters each
MOST_ROWS = 10_000  # of a table
SECONDS = 120.0  # by the clock, for a start of 2 s on a busy machine and the largest file
CHILD = Path(__file__).with_name("apart_child.py")
_MOST_FAULTS = 4  # of a table, named in one message


class Rows(tuple[tuple[float, float], ...]):
    """The rows of a small table; of_file: the key with the name of the file that they are of, if any."""

    of_file: Mapping[str, Any] = MappingProxyType({})

    def __repr__(self) -> str:
        return f"<{len(self)} rows>"


class InputError(ValueError):
    """A file that cannot be read, or must not be; the message says why."""


def open_file(path: str | Path) -> BinaryIO:
    """An ordinary file, open for reading bytes; OSError for a pipe or a device, which could block."""

    def without_waiting(name: str, flags: int) -> int:
        return os.open(name, flags | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_NOCTTY", 0))

    stream = open(path, "rb", opener=without_waiting)  # noqa: SIM115 - for who asks
    if not stat.S_ISREG(os.fstat(stream.fileno()).st_mode):
        stream.close()
        raise OSError(errno.EINVAL, "not an ordinary file", str(path))
    return stream


def read_limited(path: str | Path, largest: int = LARGEST_FILE) -> bytes:
    """The content of a file of at most `largest` bytes. InputError if it cannot be read or is larger."""
    try:
        with open_file(path) as stream:
            content = stream.read(largest + 1)
    except (OSError, ValueError) as error:  # ValueError: a null character in the name
        raise InputError(f"cannot be read: {getattr(error, 'strerror', None) or error}") from None
    if len(content) > largest:
        raise InputError(f"too large: at most {largest} bytes are allowed")
    return content


def below(folder: Path, name: str, what: str) -> Path:
    """The path of a named file in a folder or below it; InputError if it is elsewhere."""
    try:
        home = folder.resolve()
        path = (home / name).resolve()
    except (OSError, ValueError, RuntimeError) as error:  # RuntimeError: links in a circle
        raise InputError(f"cannot be read: {error}") from None
    if not path.is_relative_to(home):
        raise InputError(f"outside the folder of the {what}: copy it there")
    return path


@dataclass
class Inputs:
    """The folder of a scene file, and what has been read of it, by name as the scene spells it."""

    folder: Path
    contents: dict[str, bytes] = field(default_factory=dict)

    def read(self, name: str, largest: int = LARGEST_FILE) -> bytes:
        """The content of a file in the folder or below it, of at most `largest` bytes. Raises InputError."""
        self.contents[name] = read_limited(below(self.folder, name, "scene"), largest)
        return self.contents[name]


def read_apart(
    reader: Path, *arguments: str, content: bytes = b"", memory: int
) -> tuple[dict[str, Any], dict[str, NDArray[Any]]]:
    """What `answer(content, *arguments)` of the script `reader` makes of a file in a process of its
    own with `memory` bytes: what JSON holds, and arrays by name. InputError if it failed or took
    too long.
    """
    command = [sys.executable, "-P", str(CHILD), str(reader), str(memory), str(SECONDS / 2), *arguments]
    # the library of instruments loads matplotlib, which else makes a folder in that of the user
    alone = {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1", "MPLCONFIGDIR": os.devnull}
    how: dict[str, Any] = {"stdout": subprocess.PIPE, "stderr": subprocess.DEVNULL}
    how["env"] = {**os.environ, **alone}
    try:
        said = subprocess.run(command, input=content, timeout=SECONDS, check=False, **how).stdout
        head = json.loads(said[: said.index(b"\n")])
    except subprocess.TimeoutExpired:
        raise InputError(f"its reader did not end in {SECONDS:g} s") from None
    except (OSError, ValueError):
        raise InputError("its reader ended without an answer") from None
    try:
        if "refused" in head:
            raise InputError(printable(str(head["refused"])))
        arrays, start, raw = {}, said.index(b"\n") + 1, memoryview(said)
        for name, (kind, shape) in head["arrays"].items():
            if np.dtype(kind).kind not in "fiu":
                raise TypeError(kind)
            arrays[name] = np.ndarray(shape, kind, raw, start)
            start += arrays[name].nbytes
        return head["said"], arrays
    except (KeyError, OverflowError, TypeError, ValueError) as error:
        raise error if isinstance(error, InputError) else InputError("its reader answered nonsense") from None


def content_of(value: object, info: ValidationInfo, kind: str, largest: int = LARGEST_FILE) -> bytes:
    """The content of a named file; an error "allowed" for what is no name. kind: in words."""
    if not isinstance(value, str) or not value:
        raise refused(f"the name of {kind}")
    inputs: Inputs | None = info.context.get("inputs") if info.context else None
    if inputs is None:
        raise refused("this scene has no folder to read files from")
    try:
        return inputs.read(value, largest)
    except InputError as error:
        raise refused(str(error)) from None


@dataclass(frozen=True)
class TwoColumns:
    """A table of two columns: their names and ranges, the first column strictly ascending.

    from_zero: the first column begins with 0; falling: what a falling second column is called, if that is
    refused.
    """

    columns: tuple[str, str]
    numbers: tuple[Number, Number]
    from_zero: bool = False
    falling: str = ""

    @property
    def allowed(self) -> str:
        """What is allowed, in words."""
        return f"columns {' and '.join(self.columns)}, 1 to {MOST_ROWS} rows"

    def check(self, value: object, info: ValidationInfo) -> Rows:
        """The rows of a named file, or given in Python; an error "allowed" for others."""
        if isinstance(value, Rows):
            return value
        if file := in_file(info):
            content = content_of(value, info, f"a CSV file: {self.allowed}")
            try:
                places, rows = self._parsed(content.decode("utf-8-sig"))
            except UnicodeDecodeError:
                raise refused("not UTF-8") from None
            except (csv.Error, InputError) as error:
                raise refused(f"{'not CSV: ' * isinstance(error, csv.Error)}{error}") from None
        else:
            value = listed(value)
            if not isinstance(value, list | tuple) or len(value) > MOST_ROWS:
                raise refused(f"rows: {self.allowed}")
            places, rows = [f"row {k + 1}" for k in range(len(value))], list(value)
        if not rows:
            raise refused(self.allowed)
        faults = [f"{places[k]}: {text}" for k, text in sorted(self._faults(rows))]
        if faults:
            words = "; ".join(faults[:_MOST_FAULTS])
            words += f"; and {len(faults) - _MOST_FAULTS} more" if len(faults) > _MOST_FAULTS else ""
            noisy = file and all(self.falling and self.falling in fault for fault in faults)
            raise refused(words + (self._rising(str(value)) if noisy else ""))
        found = Rows((float(first), float(second)) for first, second in rows)
        found.of_file = {str(info.field_name): value} if file else {}
        return found

    def _rising(self, name: str) -> str:
        """The line of Python that takes the noise of a measurement off a curve that falls nowhere else."""
        column = self.columns[1]
        return (
            f". This Python writes rising.csv, the nearest curve that does not fall: import pandas as pd, "
            f"scipy.optimize as so; c = pd.read_csv({name!r}); c[{column!r}] = "
            f'so.isotonic_regression(c[{column!r}]).x; c.to_csv("rising.csv", index=False)'
        )

    def _parsed(self, text: str) -> tuple[list[str], list[Any]]:
        """The lines of a file that are not blank, as places and rows in the order of `columns`."""
        reader = csv.reader(io.StringIO(text, newline=""), strict=True)
        header = [name.strip() for name in next(reader, [])]
        if sorted(header) != sorted(self.columns):
            raise InputError(f"its first line is {spelling(','.join(header))}: {self.allowed}")
        order, places, rows = [header.index(name) for name in self.columns], list[str](), list[Any]()
        for cells in reader:
            if not any(cell.strip() for cell in cells):
                continue
            if len(rows) == MOST_ROWS:
                raise InputError(f"more than {MOST_ROWS} rows")
            places.append(f"line {reader.line_num}")
            numbers = [_number(cell) for cell in cells]
            rows.append([numbers[k] for k in order] if len(cells) == 2 else cells)
        return places, rows

    def _faults(self, rows: Sequence[Any]) -> Iterator[tuple[int, str]]:
        """Positions of rows, from 0, and what is wrong with them."""
        bad, (first, second) = set(), self.columns
        for k, row in enumerate(rows):
            if not isinstance(row, list | tuple) or len(row) != 2:
                bad.add(k)
                yield k, f"{spelling(row)} is not two numbers"
                continue
            for name, number, value in zip(self.columns, self.numbers, row, strict=True):
                try:
                    number.check(None if isinstance(value, str) else value, None)
                except PydanticCustomError:
                    bad.add(k)
                    yield k, f"{name} = {spelling(value)}, allowed: {number.allowed(False)}"
        if self.from_zero and 0 not in bad and rows[0][0] != 0:
            yield 0, f"{first} = {rows[0][0]:g}, allowed: 0 in the first row"
        for k, (above, row) in enumerate(pairwise(rows), start=1):
            if {k - 1, k} & bad:
                continue
            if row[0] <= above[0]:
                yield k, f"{first} = {row[0]:g} after {above[0]:g}, allowed: strictly ascending"
            if self.falling and row[1] < above[1]:
                yield k, f"{second} = {row[1]:g} after {above[1]:g}: {self.falling} is not available"

    def __get_pydantic_core_schema__(self, _source: Any, _handler: Any) -> core_schema.CoreSchema:
        return core_schema.with_info_plain_validator_function(self.check)

    def __get_pydantic_json_schema__(self, _core: Any, _handler: Any) -> dict[str, Any]:
        """JSON schema of the key in a scene file: the name of the table's file."""
        return {"type": "string", "minLength": 1, "description": f"the name of a CSV file: {self.allowed}"}


def listed(value: object) -> object:
    """A numpy array or a zip as the list that Python users mean by it; others as they are."""
    if isinstance(value, zip):
        return list(islice(value, MOST_ROWS + 1))
    return value.tolist() if isinstance(value, np.ndarray) else value


def list_of(shortest: int, longest: int) -> BeforeValidator:
    """A TOML array (or tuple, or list) of so many entries, as a tuple."""
    words = f"a list of {shortest}" if shortest == longest else f"a list of {shortest} to {longest}"

    def check(value: object) -> tuple[Any, ...]:
        value = listed(value)
        if not isinstance(value, list | tuple) or not shortest <= len(value) <= longest:
            raise refused(words)
        return tuple(value)

    return BeforeValidator(check)


def _number(text: str) -> float | str:
    try:
        return float(text)
    except ValueError:
        return text
