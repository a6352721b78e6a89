# SPDX-License-Identifier: MIT
"""Height maps in files: CSV and npz, read without trusting them. Nothing is unpickled, nothing unpacked that
is too large.

CSV: a header line and the columns x_m, y_m, height_m, a row for each point of a regular grid, in any order.
npz: arrays of these names, x_m (nx,) and y_m (ny,) evenly spaced, height_m (nx, ny), x first; others are not
read. Where the origin of x_m and y_m lies does not matter: the middle of the map is put into the middle of
the scene. A height that is nan is missing. Maps of another quantity have its column in place of height_m.
Files of instruments: sam.scene.surface.instruments.
"""

from __future__ import annotations

import io
import math
import zipfile

import numpy as np

from sam.arrays import Array
from sam.scene.errors import printable, spelling
from sam.scene.inputs import InputError
from sam.scene.surface.height_map import HIGHEST, PLACES, HeightMap
from sam.scene.units import CELLS

MOST_POINTS = int(CELLS.high) ** 2
EVEN = 0.01  # of a step: coordinates are rounded when they are written
# of the whole length: coordinates closer than this are one; the finest step is 250 times as large
SAME = 1e-6
_LONGEST = 160  # characters of another library's words
_HEADER = 1000  # bytes of an npy header beyond which it is none of a plain array


def read(name: str, content: bytes, kind: type[HeightMap] = HeightMap) -> HeightMap:
    """The map in the bytes of a CSV or npz file, whatever its name. Raises InputError, which says what is
    wrong with it.
    """
    return _from_npz(content, kind) if content[:2] == b"PK" else _from_csv(content, kind)


def _from_csv(content: bytes, kind: type[HeightMap]) -> HeightMap:
    try:
        header, _, rest = content.decode("utf-8-sig").partition("\n")
    except UnicodeDecodeError:
        raise InputError("neither npz nor a CSV file: not UTF-8") from None
    names, needed = [name.strip() for name in header.split(",")], kind.columns()
    if sorted(names) != sorted(needed):
        raise InputError(f"its first line is {spelling(header.strip())}: columns {kind.columns_in_words()}")
    if not rest.strip():
        raise InputError(f"no rows: columns {kind.columns_in_words()}")
    try:
        rows = np.loadtxt(io.StringIO(rest), delimiter=",", comments=None, ndmin=2)
    except ValueError as error:
        raise InputError(f"not CSV: {printable(str(error))[:_LONGEST]}") from None
    if rows.shape[1] != len(needed) or len(rows) > MOST_POINTS:
        raise InputError(
            f"{rows.shape[1]} columns and {len(rows)} rows: 3 and at most {MOST_POINTS} are allowed"
        )
    x, y, height = (rows[:, names.index(name)] for name in needed)
    return _gridded(x, y, height, kind)


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


def _from_npz(content: bytes, kind: type[HeightMap]) -> HeightMap:
    try:
        with zipfile.ZipFile(io.BytesIO(content)) as members:
            found = members.namelist()
            if not {f"{name}.npy" for name in (*PLACES, kind.column)} <= set(found):
                raise InputError(f"npz with {spelling(found)}: {kind.columns_in_words()} are needed")
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


def _array(members: zipfile.ZipFile, name: str, needed: tuple[int, int] | None = None) -> Array:
    """A member as floats, of the shape that is needed, else of one dimension.

    What its header declares is compared with its size before anything of it is unpacked.
    """
    entry = members.getinfo(f"{name}.npy")
    with members.open(entry) as stream:
        version = np.lib.format.read_magic(stream)
        read = {(1, 0): np.lib.format.read_array_header_1_0, (2, 0): np.lib.format.read_array_header_2_0}.get(
            version
        )
        if read is None:
            raise InputError(f"{name}: npy version {version} is not allowed")
        shape, fortran, kind = read(stream, max_header_size=_HEADER)
        if kind.kind not in "fiu":
            raise InputError(f"{name}: {spelling(str(kind))}, numbers are allowed")
        if shape != needed if needed else len(shape) != 1 or not CELLS.low <= shape[0] <= CELLS.high:
            words = (
                f"{needed}, the lengths of x_m and y_m,"
                if needed
                else f"(n,), n from {CELLS.low:g} to {CELLS.high:g},"
            )
            raise InputError(f"{name}: shape {spelling(list(shape))}, {words} is needed")
        size = math.prod(shape) * kind.itemsize
        if entry.file_size > size + _HEADER:
            raise InputError(f"{name}: {entry.file_size} bytes for shape {shape} of {kind}")
        raw = stream.read(size + 1)
    if len(raw) != size:
        raise InputError(f"{name}: {len(raw)} bytes for shape {shape} of {kind}")
    return np.frombuffer(raw, dtype=kind).reshape(shape, order="F" if fortran else "C").astype(float)
