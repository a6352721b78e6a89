# SPDX-License-Identifier: MIT
"""Height maps in files: text, npz and npy, read without trusting them. Nothing is unpickled, nothing
unpacked that is too large.

Text: a line of names and the columns x_m, y_m, height_m, a row for each point of a regular grid, in any
order; or in other units and spellings, as "X [µm]", whose unit the name or the key `unit` of the scene says.
With the key `extent` the numbers are a matrix of heights: a picture, x along its lines, y from line to line;
a first line or column of coordinates is left out. How numbers may be written: sam.scene.surface.text_tables.
npz: arrays x_m (nx,) and y_m (ny,), evenly spaced, height_m (nx, ny), x first; others are not read. npy: as
text without names. Where the origin of x_m and y_m lies does not matter: the middle of the map is put into
the middle of the scene. A height that is nan is missing. Maps of another quantity have its column in place of
height_m. Files of instruments: sam.scene.surface.instruments.
"""

from __future__ import annotations

import io
import math
import re
import zipfile
from collections.abc import Sequence
from dataclasses import dataclass
from typing import IO

import numpy as np

from sam.arrays import Array
from sam.scene.errors import printable, spelling
from sam.scene.inputs import InputError
from sam.scene.section import stated
from sam.scene.surface.height_map import HIGHEST, PLACES, HeightMap
from sam.scene.surface.text_tables import parsed
from sam.scene.units import CELLS, metres_in

MOST_POINTS = int(CELLS.high) ** 2
EVEN = 0.01  # of a step: coordinates are rounded when they are written
# of the whole length: coordinates closer than this are one; the finest step is 250 times as large
SAME = 1e-6
FEWEST_STEPS = 4  # that are even by chance in one row of a million
_LONGEST = 160  # characters of another library's words
_COLUMN = re.compile(r"(?:(x|y)|z|h|height)(?:[\W_]*([^\W\d_]+)[\W_]*)?", re.IGNORECASE)  # and its unit
_NUMBER = re.compile(r"[+-]?[0-9]+(?:\.[0-9]*)?(?:[eE][+-]?[0-9]+)?")
_HEADER = 1000  # bytes of an npy header beyond which it is none of a plain array


@dataclass(frozen=True)
class Told:
    """What the scene says of a file that does not say it itself. extent: (Lx, Ly) in m or (L,), what a matrix
    covers, its outer cells as a whole; unit: of every number without one.
    """

    extent: tuple[float, ...] | None = None
    unit: str | None = None


NOTHING = Told()


def read(name: str, content: bytes, kind: type[HeightMap] = HeightMap, told: Told = NOTHING) -> HeightMap:
    """The map in the bytes of a text, npz or npy file, whatever its name. Raises InputError, which says what
    is wrong with it.
    """
    if content[:2] == b"PK":
        found = _from_npz(name, content, kind)
        if told != NOTHING:
            raise InputError("npz, which has its lengths in m: leave out extent and unit")
        return found
    names: list[str] = []
    if content.startswith(np.lib.format.MAGIC_PREFIX):
        rows = _from_npy(content)
    else:
        names, rows = parsed(content, name if kind is HeightMap else "")
    needed = columns_of(names, kind)
    if needed is None and not names and rows.shape[1] == len(PLACES) + 1 and kind is HeightMap:
        needed = [(k, "") for k in range(rows.shape[1])]
    if told.extent is not None:
        if needed is not None:
            raise InputError("its columns are x, y and heights: leave out extent")
        return _matrix(names, rows, told)
    if needed is None:
        words = (
            f"its first line is {spelling(','.join(names))}"
            if names
            else f"{rows.shape[1]} columns without names"
        )
        matrix = (
            '; for a matrix of heights give the keys extent and unit, such as "24 um" and "um"'
            if kind is HeightMap
            else ""
        )
        raise InputError(f"{words}: columns {kind.columns_in_words()}{matrix}")
    if len(rows) > MOST_POINTS:
        raise InputError(f"{len(rows)} rows: at most {MOST_POINTS} are allowed")
    if told.unit is not None and all(unit for _, unit in needed):
        raise InputError(f"its columns {spelling(names)} name their unit: leave out unit")
    x, y, height = (rows[:, k] * _metres(unit or told.unit) for k, unit in needed)
    return _gridded(x, y, height, kind)


def columns_of(names: Sequence[str], kind: type[HeightMap] = HeightMap) -> list[tuple[int, str]] | None:
    """Which columns x, y and the heights are, each with the unit in its name, "" without; None if there are
    not just these, next to columns without a name.
    """
    if kind is not HeightMap:
        own = kind.columns()
        return [(names.index(name), "m") for name in own] if sorted(names) == sorted(own) else None
    matches = [(k, _COLUMN.fullmatch(name)) for k, name in enumerate(names) if name]
    found = {(match[1] or "z").lower(): (k, match[2] or "") for k, match in matches if match}
    whole = len(found) == len(matches) and sorted(found) == ["x", "y", "z"]
    return [found[axis] for axis in "xyz"] if whole else None


def _metres(unit: str | None) -> float:
    """How many m are in a unit of length."""
    factor = 1.0 if unit == "m" else metres_in(unit)
    if factor is None:
        words = "nothing says the unit of its numbers"
        words = words if unit is None else f"{spelling(unit)} is no unit of length"
        raise InputError(
            f'{words}: give the key unit, such as unit = "um", or name the columns x_um, y_um, z_um'
        )
    return factor


def _matrix(names: Sequence[str], rows: Array, told: Told) -> HeightMap:
    """The map of a matrix, its lines along x, on the sides that the scene says."""
    if names:
        numbers = [float(name) if _NUMBER.fullmatch(name) else np.nan for name in names]
        rows = np.vstack([numbers, rows])
    across = _is_axis(rows[:2, 1:])
    rows = rows[1:] if names and not across else rows  # other words
    down = _is_axis(rows[1:, :2].T)
    heights = rows[int(across) :, int(down) :]
    if across and rows[0, -1] < rows[0, -2]:
        heights = heights[:, ::-1]
    if down and rows[-1, 0] < rows[-2, 0]:
        heights = heights[::-1]
    sides = stated(told.extent)
    if len(sides) == 1 and heights.shape[0] != heights.shape[1]:
        raise InputError(
            f"{heights.shape[1]} x {heights.shape[0]} heights: extent needs both sides of the map, [lx, ly]"
        )
    return HeightMap(heights.T * _metres(told.unit), (sides[0], sides[-1]))


def _is_axis(lines: Array) -> bool:
    """Whether the first of two lines of a matrix holds coordinates: even steps, as the second one has not."""
    if len(lines) < 2 or lines.shape[1] <= FEWEST_STEPS:
        return False
    with np.errstate(invalid="ignore"):  # of heights that are missing or infinite
        steps = np.diff(lines)
        mean = np.abs(steps.mean(axis=1, keepdims=True))
        even = (np.abs(np.abs(steps) - mean) <= EVEN * mean).all(axis=1) & (mean[:, 0] > 0)
    return bool(even[0]) and not bool(even[1])


def _gridded(x: Array, y: Array, height: Array, kind: type[HeightMap]) -> HeightMap:
    """The map of points that are given one a row, in any order."""
    (xs, i), (ys, j) = (_distinct(name, values) for name, values in zip(PLACES, (x, y), strict=True))
    if xs.size * ys.size != height.size or np.unique(i * ys.size + j).size != height.size:
        raise InputError(
            f"no regular grid: {height.size} rows with {xs.size} different x_m and {ys.size} different y_m, "
            "allowed: a row for each pair of them"
        )
    values = np.empty((xs.size, ys.size))
    values[i, j] = height
    return kind(values, (_side("x_m", xs), _side("y_m", ys)))


def _distinct(name: str, values: Array) -> tuple[Array, Array]:
    """The different coordinates, ascending, and the number of the one of each row."""
    _check_coordinates(name, values)
    found, where = np.unique(values, return_inverse=True)
    new = np.append(True, np.diff(found) > SAME * (found[-1] - found[0]))
    return found[new], (np.cumsum(new) - 1)[where]


def _side(name: str, coordinates: Array) -> float:
    """n steps of n coordinates that are ascending and evenly spaced."""
    steps = np.diff(coordinates)
    if coordinates.size < CELLS.low:
        raise InputError(f"{coordinates.size} different {name}: {CELLS.low:g} to {CELLS.high:g} are allowed")
    mean = float(coordinates[-1] - coordinates[0]) / steps.size
    if not (mean > 0 and np.abs(steps - mean).max() <= EVEN * mean):
        found = f"steps of {name} from {steps.min():.6g} to {steps.max():.6g} m"
        raise InputError(f"no regular grid: {found}, allowed: equal ones, ascending")
    return mean * coordinates.size


def _check_coordinates(name: str, values: Array) -> None:
    if not values.size or not (np.abs(values) <= HIGHEST).all():
        raise InputError(f"{name}: finite numbers from {-HIGHEST:g} to {HIGHEST:g} are needed")


def _from_npz(name: str, content: bytes, kind: type[HeightMap]) -> HeightMap:
    try:
        with zipfile.ZipFile(io.BytesIO(content)) as members:
            found = members.namelist()
            first = next(iter(found), "z").removesuffix(".npy")
            if not {f"{name}.npy" for name in (*PLACES, kind.column)} <= set(found):
                words = f"npz with {spelling(found)}: {kind.columns_in_words()} are needed"
                advice = (
                    ". This Python writes a matrix of heights to heights.npy, of which the scene then says "
                    "extent and unit"
                    f': import numpy as np; np.save("heights.npy", np.load({name!r})[{first!r}])'
                )
                raise InputError(words + advice * (kind is HeightMap and bool(found)))
            x, y = (_array(members, name) for name in PLACES)
            height = _array(members, kind.column, (x.size, y.size))
    except InputError:
        raise
    except (
        Exception
    ) as error:  # for odd bytes zipfile and numpy raise errors of a dozen kinds, TokenError among them
        raise InputError(f"no npz file, or a damaged one: {printable(str(error))[:_LONGEST]}") from None
    for name, values in zip(PLACES, (x, y), strict=True):
        _check_coordinates(name, values)
    return kind(height, (_side("x_m", x), _side("y_m", y)))


def _from_npy(content: bytes) -> Array:
    """The numbers of an npy file, of two dimensions."""
    try:
        return _unpacked(io.BytesIO(content), len(content), "npy", "nm")
    except InputError:
        raise
    except Exception as error:  # as for npz
        raise InputError(f"no npy file, or a damaged one: {printable(str(error))[:_LONGEST]}") from None


def _array(members: zipfile.ZipFile, name: str, needed: tuple[int, int] | None = None) -> Array:
    """A member as floats, of the shape that is needed, else of one dimension."""
    entry = members.getinfo(f"{name}.npy")
    with members.open(entry) as stream:
        return _unpacked(stream, entry.file_size, name, needed or "n")


def _unpacked(stream: IO[bytes], held: int, name: str, needed: tuple[int, int] | str) -> Array:
    """An array of `held` bytes as floats, of the shape that is needed: "n" of one dimension, "nm" of two.

    What its header declares is compared with its size before anything of it is unpacked.
    """
    version = np.lib.format.read_magic(stream)
    read = {(1, 0): np.lib.format.read_array_header_1_0, (2, 0): np.lib.format.read_array_header_2_0}.get(
        version
    )
    if read is None:
        raise InputError(f"{name}: npy version {version} is not allowed")
    shape, fortran, kind = read(stream, max_header_size=_HEADER)
    if kind.kind not in "fiu":
        raise InputError(f"{name}: {spelling(str(kind))}, numbers are allowed")
    free = isinstance(needed, str)
    many = free and all(n >= CELLS.low and (n <= CELLS.high or len(needed) > 1) for n in shape)
    if len(shape) != len(needed) or not (many if free else shape == needed):
        words = {
            "n": f"(n,), n from {CELLS.low:g} to {CELLS.high:g},",
            "nm": f"(n, m), {CELLS.low:g} or more,",
        }.get(str(needed), f"{needed}, the lengths of x_m and y_m,")
        raise InputError(f"{name}: shape {spelling(list(shape))}, {words} is needed")
    size = math.prod(shape) * kind.itemsize
    if held > size + _HEADER:
        raise InputError(f"{name}: {held} bytes for shape {shape} of {kind}")
    raw = stream.read(size + 1)
    if len(raw) != size:
        raise InputError(f"{name}: {len(raw)} bytes for shape {shape} of {kind}")
    return np.frombuffer(raw, dtype=kind).reshape(shape, order="F" if fortran else "C").astype(float)
