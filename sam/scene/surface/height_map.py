# SPDX-License-Identifier: MIT
"""Measured heights as a value of a scene, known by the digest of their content wherever they come from.

Maps of a scene in files: text, npz, npy and the files of instruments, read without trusting them. Nothing
is unpickled, nothing unpacked that is too large.

Text: a line of names and the columns x_m, y_m, height_m, a row for each point of a regular grid, in any
order; or in other units and spellings, as "X [µm]", whose unit the name or the key `unit` of the scene says.
With the key `extent` the numbers are a matrix of heights: a picture, x along its lines, y from line to line;
a first line or column of coordinates is left out. How numbers may be written: `parsed`.
npz: arrays x_m (nx,) and y_m (ny,), evenly spaced, height_m (nx, ny), x first; others are not read. npy: as
text without names. Where the origin of x_m and y_m lies does not matter: the middle of the map is put into
the middle of the scene. A height that is nan is missing. Maps of another quantity have its column in place of
height_m.

Files of instruments are read by SurfaceTopography, the extra "instruments", in a process of its own; the
ending of the name says which formats are tried. Lengths become m; a file that says neither a unit nor its
size is refused, nothing is guessed. Formats that hold no lengths are left out. x is along the rows of the
picture to the right, y from row to row downwards, heights out of the surface. Seen from outside, x to the
right, y down and z into the body are right-handed: nothing is mirrored.
"""

from __future__ import annotations

import codecs
import hashlib
import io
import math
import re
import warnings
import zipfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path
from typing import IO, Annotated, Any, ClassVar

import numpy as np
from pydantic import ValidationInfo
from pydantic_core import core_schema

from sam.arrays import Array
from sam.scene.inputs import InputError, content_of, read_apart
from sam.scene.section import printable, spelling, stated
from sam.scene.units import CELLS, COEFFICIENT, LENGTH, in_file, metres_in, refused, spelled

HIGHEST = 1e30  # m; as for every length of a scene
PLACES = ("x_m", "y_m")
"""Columns of the coordinates in a file."""
KEYS = ("sha256", "cells", "extent")


class HeightMap:
    """Heights at the centres of nx x ny equal cells, positive out of the body; the origin in the middle.

    Parameters
    ----------
    values
        Heights (nx, ny) in m, x first; nan where one is missing.
    extent
        (Lx, Ly) in m: nx cells of Lx/nx each.

    Attributes
    ----------
    sha256
        Of extent and heights, by which two maps are equal.
    values
        Read-only; None if only the digest is at hand, as in the scene of a summary.json: such a map cannot be
        solved.
    of_file
        The keys of a scene file that name the file of the map; empty of one that was made in Python.

    Raises
    ------
    ValueError
        For too few or too many cells, or heights out of range.
    """

    __slots__ = ("cells", "extent", "of_file", "sha256", "values")
    column: ClassVar[str] = "height_m"
    wrapped: ClassVar[str] = "samfem.HeightMap(array, (Lx, Ly)), heights in m, x first"

    @classmethod
    def columns(cls) -> tuple[str, str, str]:
        """The columns of a file with such maps."""
        return (*PLACES, cls.column)

    @classmethod
    def columns_in_words(cls) -> str:
        """The same as messages name them."""
        return f"x_m, y_m and {cls.column} on a regular grid"

    def __init__(self, values: Array, extent: tuple[float, float]):
        heights: Array = np.array(values, dtype="<f8", order="C")
        if heights.ndim != 2:
            raise InputError(f"heights of shape {heights.shape}: two dimensions are needed")
        cells, sides = _sizes(heights.shape, tuple(extent))
        self.cells = cells
        self.extent = sides
        absent = np.isnan(heights)
        heights[absent] = np.nan  # of the many ways to write it the same
        if not (absent | (np.abs(heights) <= HIGHEST)).all():
            raise InputError(f"heights from {-HIGHEST:g} to {HIGHEST:g} m are allowed")
        heights.flags.writeable = False
        content = hashlib.sha256(np.array([*self.cells, *self.extent], dtype="<f8").tobytes())
        content.update(heights.tobytes())
        self.sha256 = content.hexdigest()
        self.values: Array | None = heights
        self.of_file: dict[str, Any] = {}

    @classmethod
    def known_by(cls, sha256: str, cells: tuple[int, int], extent: tuple[float, float]) -> HeightMap:
        """A map of which only the digest is at hand."""
        known = object.__new__(cls)
        known.values, known.sha256, known.cells, known.extent = None, sha256, cells, extent
        known.of_file = {}
        return known

    @property
    def cell(self) -> tuple[float, float]:
        """Sides of a cell in m."""
        return self.extent[0] / self.cells[0], self.extent[1] / self.cells[1]

    @property
    def missing(self) -> int:
        """How many heights are missing; 0 if only the digest is at hand."""
        return 0 if self.values is None else int(np.count_nonzero(np.isnan(self.values)))

    @property
    def described(self) -> dict[str, Any]:
        """What a resolved scene holds in place of the heights."""
        return {"sha256": self.sha256, "cells": list(self.cells), "extent": list(self.extent)}

    def __reduce__(self) -> tuple[Any, ...]:
        if self.values is None:
            return type(self).known_by, (self.sha256, self.cells, self.extent)
        return type(self), (self.values, self.extent), (None, {"of_file": self.of_file})

    def __eq__(self, other: object) -> bool:
        return type(other) is type(self) and self.sha256 == other.sha256

    def __hash__(self) -> int:
        return hash(self.sha256)

    def __repr__(self) -> str:
        return f"{type(self).__name__}({self.cells[0]} x {self.cells[1]} cells, {self.sha256[:8]})"


def _sizes(cells: tuple[Any, ...], extent: tuple[Any, ...]) -> tuple[tuple[int, int], tuple[float, float]]:
    """The cells and sides in m. Raises InputError unless they are those of a grid."""
    if len(cells) != 2 or not all(isinstance(n, int) and CELLS.low <= n <= CELLS.high for n in cells):
        words = f"{' x '.join(map(str, cells))} heights"
        raise InputError(f"{words}: {CELLS.low:g} to {CELLS.high:g} each way are allowed")
    sides = tuple(map(float, extent))
    if len(sides) != 2 or not all(LENGTH.low <= side <= LENGTH.high for side in sides):
        words = " and ".join(f"{side:g}" for side in sides)
        raise InputError(f"sides of {words} m: {LENGTH.low:g} to {LENGTH.high:g} are allowed")
    return (cells[0], cells[1]), (sides[0], sides[1])


class FrictionMap(HeightMap):
    """Coefficients of friction on (nx, ny) equal cells about the origin, as a HeightMap."""

    __slots__ = ()
    column: ClassVar[str] = "friction"
    wrapped: ClassVar[str] = "sam.scene.FrictionMap(array, (Lx, Ly)), x first"

    def __init__(self, values: Array, extent: tuple[float, float]):
        """Raises InputError also for coefficients out of range."""
        super().__init__(values, extent)
        coefficients = np.asarray(self.values)
        if not ((coefficients >= COEFFICIENT.low) & (coefficients <= COEFFICIENT.high)).all():
            raise InputError(f"coefficients from {COEFFICIENT.low:g} to {COEFFICIENT.high:g} are allowed")


def from_python(value: object, kind: type[HeightMap]) -> HeightMap:
    """A map given in Python, or as `HeightMap.described`; else an error "allowed"."""
    if type(value) is kind:
        return value
    if not isinstance(value, Mapping) or set(value) != set(KEYS):
        array = isinstance(value, np.ndarray)
        raise refused(f"wrap it: {kind.wrapped}" if array else f"a {kind.__name__}")
    try:
        sha256, cells, extent = (value[key] for key in KEYS)
        cells, extent = _sizes(tuple(cells), tuple(extent))
        if len(bytes.fromhex(sha256)) != hashlib.sha256().digest_size:
            raise ValueError(sha256)
    except (InputError, TypeError, ValueError):
        raise refused(f"a {kind.__name__}, or sha256, cells and extent of one") from None
    return kind.known_by(sha256, cells, extent)


LARGEST_FILE = 1 << 28  # bytes: 4097 x 4097 heights with 16 characters each
STEEPEST = 1.0  # heights differ by more than the map is long: no surface of a half-space
MOST_POINTS = int(CELLS.high) ** 2
EVEN = 0.01  # of a step: coordinates are rounded when they are written
# of the whole length: coordinates closer than this are the same; the finest step is 250 times as large
SAME = 1e-6
FEWEST_STEPS = 4  # that are even by chance in a row of a million
LIBRARY = "SurfaceTopography"
EXTRA = "pip install samfem[instruments]"
READER = Path(__file__).with_name("instrument_child.py")
BYTES = 4 << 30  # of address space of its reader: a file may hold at most 256 MiB
ENDINGS = {
    "al3d": "al3d", "asc": "asc dat txt", "bcr": "bcr bcrf", "datx": "datx",
    "di": "001 002 003 004 005 spm", "ezd": "ezd nid", "frt": "frt", "gwy": "gwy", "ibw": "ibw",
    "jpk": "jpk", "lext": "lext", "mdt": "mdt", "metropro": "dat", "mi": "mi", "mitutoyo": "xlsx",
    "mnt": "mnt", "nc": "nc", "nmm": "zip", "nms": "nms", "oir": "oir", "opd": "opd", "opdx": "opdx",
    "os3d": "os3d", "plu": "apx plu", "plux": "plux", "poir": "poir", "ps": "tif tiff", "qep": "qep",
    "sdf": "sdf", "sur": "sur", "tmd": "tmd", "vk": "vk3 vk4 vk6 vk7", "wsxm": "cur stp tom top",
    "x3p": "x3p", "xyz": "hfm xyz", "zmg": "zmg", "zon": "zon",
}  # fmt: skip
"""Format, as the library calls it -> endings of names."""
_LONGEST = 160  # characters of another library's words
_LONGEST_START = 400  # bytes of a file in which its line of names is looked for
_MOST_ABOVE = 1000  # lines in which the first numbers are looked for
_HEADER = 1000  # bytes of an npy header beyond which it is none of a plain array
_COLUMN = re.compile(r"(?:(x|y)|z|h|height)(?:[\W_]*([^\W\d_]+)[\W_]*)?", re.IGNORECASE)  # and its unit
_COORDINATE = re.compile(r"[+-]?[0-9]+(?:\.[0-9]*)?(?:[eE][+-]?[0-9]+)?")
_MARK = r"(?:[-*?]++|n/?a|null|none|bad|missing|invalid)"  # of a missing number; numpy reads nan itself
_NUMBER = r"[+-]?(?:[0-9]++(?:[.,][0-9]*+)?+|[.,][0-9]++)(?:[eE][+-]?[0-9]++)?+"
_SPACED = re.compile(rf"\s*+{_NUMBER}(?:[ \t]++{_NUMBER})++\s*+")
_CELL = re.compile(rf"(?:nan|{_MARK}|{_NUMBER})?", re.IGNORECASE)
_ABOVE = re.compile(r"(?:[^\S\n]*+(?:[#%][^\n]*+)?+\n)*+")  # empty lines and comments
_CONTROL = re.compile(r"[\x00-\x08\x0e-\x1f]")


@dataclass(frozen=True)
class MapField:
    """A field that holds a map: the name of its file in a scene file, the map itself in Python."""

    kind: type[HeightMap]

    def check(self, value: object, info: ValidationInfo) -> HeightMap:
        """The map of a named file, or `from_python`. An error "allowed" for others."""
        heights = self.kind is HeightMap
        if heights and not {"extent", "unit"} <= set(info.data):
            raise refused("read only once extent and unit are right")
        told = Told(info.data.get("extent"), info.data.get("unit"))
        if not in_file(info) or isinstance(value, self.kind):
            if told != NOTHING:
                raise refused(f"the name of a file with extent and unit; a {self.kind.__name__} is in m")
            return from_python(value, self.kind)
        words = f"a CSV or npz file: {self.kind.columns_in_words()}"
        content = content_of(value, info, words, LARGEST_FILE)
        try:
            map_ = read_named(str(value), content, self.kind, told)
        except InputError as error:
            raise refused(str(error)) from None
        values = stated(map_.values)
        known = values[np.isfinite(values)]
        if heights and known.size and np.ptp(known) > STEEPEST * max(map_.extent):
            low, high, *sides = (f"{number:.4g} m" for number in (known.min(), known.max(), *map_.extent))
            raise refused(
                f"heights from {low} to {high} on a map of {' x '.join(sides)}: is a unit wrong, or one of "
                "them the mark of a missing height? That is to be empty or nan"
            )
        sides = [spelled(side, "m") for side in told.extent or ()]
        keys = {"extent": sides, "unit": told.unit, "path": value}
        map_.of_file = {key: entry for key, entry in keys.items() if entry}
        return map_

    def __get_pydantic_core_schema__(self, _source: Any, _handler: Any) -> core_schema.CoreSchema:
        as_described = core_schema.plain_serializer_function_ser_schema(lambda map_: map_.described)
        return core_schema.with_info_plain_validator_function(self.check, serialization=as_described)

    def __get_pydantic_json_schema__(self, _core: Any, _handler: Any) -> dict[str, Any]:
        """JSON schema of the key in a scene file: the name of the map's file."""
        words = f"the name of a CSV or npz file: {self.kind.columns_in_words()}"
        return {"type": "string", "minLength": 1, "description": words}


HeightField = Annotated[HeightMap, MapField(HeightMap)]
FrictionField = Annotated[FrictionMap, MapField(FrictionMap)]


@dataclass(frozen=True)
class Told:
    """What the scene says of a file that does not: (Lx, Ly) or (L,) in m with outer cells; unit."""

    extent: tuple[float, ...] | None = None
    unit: str | None = None


NOTHING = Told()


def formats_of(name: str) -> tuple[str, ...]:
    """The formats that the ending of a name stands for; none for what is no instrument's file."""
    ending = name.rpartition(".")[2].lower()
    return tuple(kind for kind, endings in ENDINGS.items() if ending in endings.split())


def read_named(
    name: str, content: bytes, kind: type[HeightMap] = HeightMap, told: Told = NOTHING
) -> HeightMap:
    """The map in a file, an instrument's where only its ending says what it is. Raises InputError."""
    formats = formats_of(name) if kind is HeightMap and told == NOTHING else ()
    if not formats or content.startswith(np.lib.format.MAGIC_PREFIX) or _has_names(content):
        return read(name, content, kind, told)
    try:
        return read_instrument(name, content)
    except InputError as error:
        if name.lower().endswith("xlsx"):
            python = f"import pandas as pd; pd.read_excel({name!r}, header=None)"
            python += '.to_csv("heights.csv", header=False, index=False)'
            words = f"{error}. This Python writes its first sheet to heights.csv: {python}"
            raise InputError(words) from None
        try:
            parsed(content)
        except InputError:
            raise error from None
    return read(name, content)


def _has_names(content: bytes) -> bool:
    """Whether the first lines hold the names of the columns of a table of heights."""
    try:
        start = content if len(content) < _LONGEST_START else content[:_LONGEST_START].rpartition(b"\n")[0]
        return content[:2] != b"PK" and columns_of(parsed(start)[0]) is not None
    except InputError:
        return False


def read_instrument(name: str, content: bytes) -> HeightMap:
    """The heights in an instrument's file. Raises InputError, also without the library."""
    if find_spec(LIBRARY) is None:
        raise InputError(
            f'an instrument\'s file is read with {LIBRARY}, the extra "instruments", not installed: {EXTRA}'
        )
    formats = formats_of(name)
    try:
        said, arrays = read_apart(READER, f"{CELLS.high:g}", *formats, content=content, memory=BYTES)
        values, (along, across) = arrays["heights"].astype(float), map(float, said["extent"])
    except InputError as error:
        raise InputError(f"no heights, read as {' or '.join(formats)}: {error}") from None
    except (KeyError, TypeError, ValueError):
        raise InputError("no heights: its reader answered nonsense") from None
    return HeightMap(values, (along, across))


def read(name: str, content: bytes, kind: type[HeightMap] = HeightMap, told: Told = NOTHING) -> HeightMap:
    """The map in the bytes of a text, npz or npy file. Raises InputError, which says why."""
    heights = kind is HeightMap
    if content[:2] == b"PK":
        map_ = _from_npz(name, content, kind)
        if told != NOTHING:
            raise InputError("npz, which has its lengths in m: leave out extent and unit")
        return map_
    names: list[str] = []
    if content.startswith(np.lib.format.MAGIC_PREFIX):
        rows = _from_npy(content)
    else:
        names, rows = parsed(content, name if heights else "")
    needed = columns_of(names, kind)
    if needed is None and not names and rows.shape[1] == len(PLACES) + 1 and heights:
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
        matrix = '; for a matrix of heights give the keys extent and unit, such as "24 um" and "um"'
        raise InputError(f"{words}: columns {kind.columns_in_words()}{matrix * heights}")
    if len(rows) > MOST_POINTS:
        raise InputError(f"{len(rows)} rows: at most {MOST_POINTS} are allowed")
    if told.unit is not None and all(unit for _, unit in needed):
        raise InputError(f"its columns {spelling(names)} name their unit: leave out unit")
    x, y, z = (rows[:, k] * _metres(unit or told.unit) for k, unit in needed)
    return _gridded(x, y, z, kind)


def columns_of(names: Sequence[str], kind: type[HeightMap] = HeightMap) -> list[tuple[int, str]] | None:
    """The columns of x, y and heights with their units, "" without; None if there are others."""
    if kind is not HeightMap:
        wanted = kind.columns()
        return [(names.index(name), "m") for name in wanted] if sorted(names) == sorted(wanted) else None
    matches = [(k, _COLUMN.fullmatch(name)) for k, name in enumerate(names) if name]
    columns = {(match[1] or "z").lower(): (k, match[2] or "") for k, match in matches if match}
    whole = len(columns) == len(matches) and sorted(columns) == ["x", "y", "z"]
    return [columns[axis] for axis in "xyz"] if whole else None


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
        numbers = [float(name) if _COORDINATE.fullmatch(name) else np.nan for name in names]
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


def _gridded(x: Array, y: Array, z: Array, kind: type[HeightMap]) -> HeightMap:
    """The map of points that are given in rows, in any order."""
    (xs, i), (ys, j) = _distinct("x_m", x), _distinct("y_m", y)
    if xs.size * ys.size != z.size or np.unique(i * ys.size + j).size != z.size:
        raise InputError(
            f"no regular grid: {z.size} rows with {xs.size} different x_m and {ys.size} different y_m, "
            "allowed: a row for each pair of them"
        )
    values = np.empty((xs.size, ys.size))
    values[i, j] = z
    return kind(values, (_side("x_m", xs), _side("y_m", ys)))


def _distinct(name: str, values: Array) -> tuple[Array, Array]:
    """The different coordinates, ascending, and the number of that of each row."""
    _check_coordinates(name, values)
    ordered, where = np.unique(values, return_inverse=True)
    new = np.append(True, np.diff(ordered) > SAME * (ordered[-1] - ordered[0]))
    return ordered[new], (np.cumsum(new) - 1)[where]


def _side(name: str, coordinates: Array) -> float:
    """n steps of n coordinates that are ascending and evenly spaced."""
    steps = np.diff(coordinates)
    if coordinates.size < CELLS.low:
        raise InputError(f"{coordinates.size} different {name}: {CELLS.low:g} to {CELLS.high:g} are allowed")
    mean = float(coordinates[-1] - coordinates[0]) / steps.size
    if not (mean > 0 and np.abs(steps - mean).max() <= EVEN * mean):
        words = f"steps of {name} from {steps.min():.6g} to {steps.max():.6g} m"
        raise InputError(f"no regular grid: {words}, allowed: equal ones, ascending")
    return mean * coordinates.size


def _check_coordinates(name: str, values: Array) -> None:
    if not values.size or not (np.abs(values) <= HIGHEST).all():
        raise InputError(f"{name}: finite numbers from {-HIGHEST:g} to {HIGHEST:g} are needed")


def _from_npz(name: str, content: bytes, kind: type[HeightMap]) -> HeightMap:
    def array(key: str, needed: tuple[int, int] | str = "n") -> Array:
        """A member as floats, of the shape that is needed."""
        entry = members.getinfo(f"{key}.npy")
        with members.open(entry) as stream:
            return _unpacked(stream, entry.file_size, key, needed)

    try:
        with zipfile.ZipFile(io.BytesIO(content)) as members:
            there = members.namelist()
            first = next(iter(there), "z").removesuffix(".npy")
            if not {f"{key}.npy" for key in (*PLACES, kind.column)} <= set(there):
                words = f"npz with {spelling(there)}: {kind.columns_in_words()} are needed"
                advice = (
                    ". This Python writes a matrix of heights to heights.npy, of which the scene then says "
                    "extent and unit"
                    f': import numpy as np; np.save("heights.npy", np.load({name!r})[{first!r}])'
                )
                raise InputError(words + advice * (kind is HeightMap and bool(there)))
            x, y = (array(key) for key in PLACES)
            height = array(kind.column, (x.size, y.size))
    except InputError:
        raise
    except (
        Exception
    ) as error:  # for odd bytes zipfile and numpy raise errors of a dozen kinds, TokenError too
        raise InputError(f"no npz file, or a damaged one: {printable(str(error))[:_LONGEST]}") from None
    for key, values in zip(PLACES, (x, y), strict=True):
        _check_coordinates(key, values)
    return kind(height, (_side("x_m", x), _side("y_m", y)))


def _from_npy(content: bytes) -> Array:
    """The numbers of an npy file, of two dimensions."""
    try:
        return _unpacked(io.BytesIO(content), len(content), "npy", "nm")
    except InputError:
        raise
    except Exception as error:  # as for npz
        raise InputError(f"no npy file, or a damaged one: {printable(str(error))[:_LONGEST]}") from None


def _unpacked(stream: IO[bytes], held: int, name: str, needed: tuple[int, int] | str) -> Array:
    """An array of `held` bytes as floats of shape "n" or "nm", checked before."""
    version = np.lib.format.read_magic(stream)
    versions = {(1, 0): np.lib.format.read_array_header_1_0, (2, 0): np.lib.format.read_array_header_2_0}
    if version not in versions:
        raise InputError(f"{name}: npy version {version} is not allowed")
    shape, fortran, kind = versions[version](stream, max_header_size=_HEADER)
    if kind.kind not in "fiu":
        raise InputError(f"{name}: {spelling(str(kind))}, numbers are allowed")
    if isinstance(needed, str):
        low, high = CELLS.low, CELLS.high
        fits = len(shape) == len(needed) and all(low <= n and (n <= high or needed == "nm") for n in shape)
        words = f"(n,), n from {low:g} to {high:g}," if needed == "n" else f"(n, m), {low:g} or more,"
    else:
        fits, words = shape == needed, f"{needed}, the lengths of x_m and y_m,"
    if not fits:
        raise InputError(f"{name}: shape {spelling(list(shape))}, {words} is needed")
    size = math.prod(shape) * kind.itemsize
    raw = stream.read(size + 1) if held <= size + _HEADER else None
    if raw is None or len(raw) != size:
        raise InputError(f"{name}: {held if raw is None else len(raw)} bytes for shape {shape} of {kind}")
    return np.frombuffer(raw, dtype=kind).reshape(shape, order="F" if fortran else "C").astype(float)


def parsed(content: bytes, name: str = "") -> tuple[list[str], Array]:
    """The names of the columns of a text, as many as there are or none, and the numbers (n, m), nan where a
    cell is empty or marked as missing. Raises InputError for what is no text, and for rows that are no
    numbers or of different lengths.

    The encoding is UTF-8 or Windows-1252, or UTF-16 with its mark. Columns are separated by semicolons, tabs,
    commas or spaces, whichever comes first in this order in the second line; a comma that separates nothing
    is a decimal one. Lines that start with # or % are comments; the last of them before the numbers holds the
    names if no other line does. name: of a file of heights, for the line of Python that a refusal advises.
    """
    text, encoding = _decoded(content)
    text = text.replace('"', "")
    above = stated(_ABOVE.match(text))  # it may be empty
    comment = above[0].rstrip().rpartition("\n")[2].lstrip(" #%")
    first, _, rest = text[above.end() :].partition("\n")
    separator = _separator(rest.lstrip().partition("\n")[0] or first)
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


def _separator(line: str) -> str | None:
    """What separates the numbers of a line; None: spaces."""
    spaced = _SPACED.fullmatch(line) is not None
    return next((mark for mark in ";\t," if mark in line and not (spaced and mark == ",")), None)


def _cells(line: str, separator: str | None) -> list[str]:
    """The cells of a line; one that is empty after a last separator does not count."""
    parts = line.split(separator) if separator else re.split(r"\s+(?![\[(])", line.strip())
    cells = [part.strip() for part in parts]
    return cells if cells[-1] else cells[:-1]


def _conversion(text: str, encoding: str, name: str) -> str:
    """The line of Python that writes the numbers of a text alone; empty without a name."""
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


def _numbers(text: str, separator: str | None) -> Array:
    """The rows of a text; empty cells and marks are looked for only where numpy cannot read it."""

    def read(given: str) -> Array:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # no rows: said by `parsed`
            return np.loadtxt(io.StringIO(given), delimiter=separator, comments="#", ndmin=2)

    try:
        return read(text)
    except ValueError:
        if separator is None:
            return read(re.sub(rf"(?<!\S){_MARK}(?!\S)", "nan", text, flags=re.IGNORECASE))
        empty = rf" *+(?:{_MARK} *+)?+"
        for place in (rf"(?<={separator}){empty}(?={separator}|$)", rf"^{empty}(?={separator})"):
            text = re.sub(place, "nan", text, flags=re.IGNORECASE | re.MULTILINE)
        return read(text)
