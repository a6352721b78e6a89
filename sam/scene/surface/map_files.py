# SPDX-License-Identifier: MIT
"""Maps of a scene that are in files: the fields that hold them, and the choice of the reader."""

from __future__ import annotations

from dataclasses import dataclass
from importlib import import_module
from typing import Annotated, Any

import numpy as np
from pydantic import ValidationInfo
from pydantic_core import core_schema

from sam.arrays import Array
from sam.scene.inputs import InputError, content_of, refused
from sam.scene.section import stated
from sam.scene.surface.height_map import FrictionMap, HeightMap, from_python
from sam.scene.surface.instrument_formats import formats_of
from sam.scene.surface.readers import NOTHING, Told, columns_of, read
from sam.scene.surface.text_tables import parsed
from sam.scene.units import in_file

LARGEST_FILE = 1 << 28  # bytes: 4097 x 4097 heights with 16 characters each
INSTRUMENTS = "sam.scene.surface.instruments"
"""The module that reads the files of instruments, loaded when a scene names one."""
STEEPEST = 1.0  # heights differ by more than the map is long: no surface of a half-space
_LONGEST_START = 400  # bytes of a file in which its line of names is looked for


def read_named(
    name: str, content: bytes, kind: type[HeightMap] = HeightMap, told: Told = NOTHING
) -> HeightMap:
    """The map in a file of that name; heights may also stand in an instrument's, known by the ending where
    neither its first lines nor the scene say what its numbers are. Raises InputError.
    """
    formats = formats_of(name) if kind is HeightMap and told == NOTHING else ()
    if not formats or content.startswith(np.lib.format.MAGIC_PREFIX) or _has_names(content):
        return read(name, content, kind, told)
    try:
        found: HeightMap = import_module(INSTRUMENTS).read(name, content, kind)
    except InputError as error:
        return _without_instrument(name, content, error)
    return found


def _without_instrument(name: str, content: bytes, error: InputError) -> HeightMap:
    """Raise what to do about a file that no reader of instruments takes; `error` says why none does."""
    if name.lower().endswith("xlsx"):
        python = f"import pandas as pd; pd.read_excel({name!r}, header=None)"
        python += '.to_csv("heights.csv", header=False, index=False)'
        raise InputError(f"{error}. This Python writes its first sheet to heights.csv: {python}")
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


def _check_heights(values: Array, extent: tuple[float, float]) -> None:
    """Raise InputError for heights that no surface of that size has; values (nx, ny) and sides in m."""
    known = values[np.isfinite(values)]
    if known.size and np.ptp(known) > STEEPEST * max(extent):
        low, high, *sides = (f"{number:.4g} m" for number in (known.min(), known.max(), *extent))
        raise InputError(
            f"heights from {low} to {high} on a map of {' x '.join(sides)}: is a unit wrong, or one of them "
            "the mark of a missing height? That is to be empty or nan"
        )


@dataclass(frozen=True)
class MapField:
    """A field that holds a map: the name of its file in a scene file, the map itself in Python."""

    kind: type[HeightMap]

    def check(self, value: object, info: ValidationInfo) -> HeightMap:
        """The map in the file that a scene file names; in Python see `from_python`. An error "allowed" for
        others.
        """
        if self.kind is HeightMap and not {"extent", "unit"} <= set(info.data):
            raise refused("read only once extent and unit are right")
        told = Told(info.data.get("extent"), info.data.get("unit"))
        if not in_file(info):
            if told != NOTHING:
                raise refused(f"the name of a file with extent and unit; a {self.kind.__name__} is in m")
            return from_python(value, self.kind)
        words = f"a CSV or npz file: {self.kind.columns_in_words()}"
        content = content_of(value, info, words, LARGEST_FILE)
        try:
            found = read_named(str(value), content, self.kind, told)
            if self.kind is HeightMap:
                _check_heights(stated(found.values), found.extent)
        except InputError as error:
            raise refused(str(error)) from None
        return found

    def __get_pydantic_core_schema__(self, _source: Any, _handler: Any) -> core_schema.CoreSchema:
        as_described = core_schema.plain_serializer_function_ser_schema(lambda found: found.described)
        return core_schema.with_info_plain_validator_function(self.check, serialization=as_described)

    def __get_pydantic_json_schema__(self, _core: Any, _handler: Any) -> dict[str, Any]:
        """JSON schema of the key in a scene file: the name of the map's file."""
        words = f"the name of a CSV or npz file: {self.kind.columns_in_words()}"
        return {"type": "string", "minLength": 1, "description": words}


HeightField = Annotated[HeightMap, MapField(HeightMap)]
FrictionField = Annotated[FrictionMap, MapField(FrictionMap)]
