# SPDX-License-Identifier: MIT
"""Numbers in a text file, as instruments and spreadsheets write them: the separator, a decimal comma, the
encoding, a line of names and marks of missing values are seen from the file itself.
"""

from __future__ import annotations

import codecs
import io
import re
import warnings

import numpy as np

from sam.arrays import Array
from sam.scene.errors import printable, spelling
from sam.scene.inputs import InputError

_MARK = r"(?:[-*?]++|n/?a|null|none|bad|missing|invalid)"  # of a missing number; numpy reads nan itself
_NUMBER = r"[+-]?(?:[0-9]++(?:[.,][0-9]*+)?+|[.,][0-9]++)(?:[eE][+-]?[0-9]++)?+"
_SPACED = re.compile(rf"\s*+{_NUMBER}(?:[ \t]++{_NUMBER})++\s*+")
_CELL = re.compile(rf"(?:nan|{_MARK}|{_NUMBER})?", re.IGNORECASE)
_ABOVE = re.compile(r"(?:[^\S\n]*+(?:[#%][^\n]*+)?+\n)*+")  # empty lines and comments
_CONTROL = re.compile(r"[\x00-\x08\x0e-\x1f]")
_MOST_ABOVE = 1000  # lines in which the first numbers are looked for
_LONGEST = 160  # characters of another library's words


def parsed(content: bytes, name: str = "") -> tuple[list[str], Array]:
    """The names of the columns, and the numbers.

    Columns are separated by semicolons, tabs, commas or spaces, whichever comes first in this order in the
    second line; a comma that separates nothing is a decimal one. Lines that start with # or % are comments;
    the last of them before the numbers holds the names if no other line does.

    Parameters
    ----------
    content
        Of the file: UTF-8 or Windows-1252, or UTF-16 with its mark.
    name
        Of a file of heights, for the line of Python that a refusal advises.

    Returns
    -------
    names, rows
        As many names as columns, or none; (n, m), nan where a cell is empty or marked as missing.

    Raises
    ------
    InputError
        For what is no text, and for rows that are no numbers or of different lengths.
    """
    text, encoding = _decoded(content)
    text = text.replace('"', "")
    comment, first, rest = _split(text)
    second = rest.lstrip().partition("\n")[0] or first
    separator = _separator(second)
    names, in_comment = _cells(first, separator), False
    if all(map(_CELL.fullmatch, names)):
        rest, names, in_comment = f"{first}\n{rest}", _cells(comment, separator), True
    try:
        rows = _numbers(rest.replace(",", ".") if separator != "," else rest, separator)
    except ValueError as error:
        words = f"not CSV: {printable(str(error))[:_LONGEST].rstrip('.')}"
        raise InputError(words + _conversion(text, encoding, name)) from None
    if not rows.size:
        raise InputError("no rows")
    surplus = rows.shape[1] - len(names)
    if separator and rows.shape[1] > 1 and (not names or surplus == 1) and np.isnan(rows[:, -1]).all():
        rows, surplus = rows[:, :-1], surplus - 1  # every line ends with a separator
    if surplus and not in_comment:
        words = f"{rows.shape[1]} columns below {len(names)} names in {spelling(first.strip())}"
        raise InputError(words + _conversion(text, encoding, name))
    return ([] if surplus else names), rows


def _separator(line: str) -> str | None:
    """What separates the numbers of a line; None: spaces."""
    spaced = _SPACED.fullmatch(line) is not None
    return next((each for each in ";\t," if each in line and not (spaced and each == ",")), None)


def _conversion(text: str, encoding: str, name: str) -> str:
    """The line of Python that writes the numbers alone, of a text with other lines above them or other
    words between them; empty without a name of the file.
    """
    if not name:
        return ""
    lines = text.rstrip().split("\n", _MOST_ABOVE)[:_MOST_ABOVE]
    separator = _separator(lines[-1])
    rows = [_cells(line, separator) for line in lines]
    numbers = [sum(_CELL.fullmatch(cell) is not None for cell in row) for row in rows]
    width = len(rows[-1])
    usable = (k for k, row in enumerate(rows) if len(row) == width and numbers[k] > width / 2)
    start = next(usable, 0)
    given = {"sep": separator or r"\s+", "skiprows": start, "header": None, "encoding": encoding}
    if separator != ",":
        given["decimal"] = "," if "," in lines[start] else "."
    words = ", ".join(f"{key}={value!r}" for key, value in given.items())
    return (
        ". This Python writes its numbers to heights.csv, whose unit, and extent of a matrix, the scene then "
        f"says: import pandas as pd; pd.read_csv({name!r}, {words})"
        '.apply(pd.to_numeric, errors="coerce").to_csv("heights.csv", header=False, index=False)'
    )


def _decoded(content: bytes) -> tuple[str, str]:
    """The text, and its encoding."""
    wide = content.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE))
    for encoding in ("utf-16",) if wide else ("utf-8-sig", "cp1252"):
        try:
            text = content.decode(encoding)
        except UnicodeDecodeError:
            continue
        if _CONTROL.search(text) is None:
            return text.replace("\r\n", "\n").replace("\r", "\n"), encoding
    raise InputError("neither npz nor npy, and no text")


def _split(text: str) -> tuple[str, str, str]:
    """The last comment before the first line, that line, and the rest."""
    above = _ABOVE.match(text)
    assert above is not None  # it may be empty
    comment = above[0].rstrip().rpartition("\n")[2]
    line, _, rest = text[above.end() :].partition("\n")
    return comment.lstrip(" #%"), line, rest


def _cells(line: str, separator: str | None) -> list[str]:
    """The cells of a line; one that is empty after a last separator does not count."""
    parts = line.split(separator) if separator else re.split(r"\s+(?![\[(])", line.strip())
    cells = [part.strip() for part in parts]
    return cells if cells[-1] else cells[:-1]


def _numbers(text: str, separator: str | None) -> Array:
    """The rows of a text; empty cells and marks are looked for only where numpy cannot read it."""

    def read(given: str) -> Array:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # no rows: said below
            found: Array = np.loadtxt(io.StringIO(given), delimiter=separator, comments="#", ndmin=2)
        return found

    try:
        return read(text)
    except ValueError:
        return read(_marked(text, separator))


def _marked(text: str, separator: str | None) -> str:
    """The text with nan in place of empty cells and of marks of missing numbers."""
    if separator is None:
        return re.sub(rf"(?<!\S){_MARK}(?!\S)", "nan", text, flags=re.IGNORECASE)
    for place in (
        rf"(?<={separator}) *+(?:{_MARK} *+)?+(?={separator}|$)",
        rf"^ *+(?:{_MARK} *+)?+(?={separator})",
    ):
        text = re.sub(place, "nan", text, flags=re.IGNORECASE | re.MULTILINE)
    return text
