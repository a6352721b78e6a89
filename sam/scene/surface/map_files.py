# SPDX-License-Identifier: MIT
"""Maps of a scene that are in files: the fields that hold them, and the choice of the reader."""

from __future__ import annotations

from dataclasses import dataclass
from importlib import import_module
from typing import Annotated, Any

from pydantic import ValidationInfo
from pydantic_core import core_schema

from sam.scene.inputs import InputError, content_of, refused
from sam.scene.surface.height_map import FrictionMap, HeightMap, from_python
from sam.scene.surface.instrument_formats import formats_of
from sam.scene.units import in_file

LARGEST_FILE = 1 << 28  # bytes: 4097 x 4097 heights with 16 characters each
READERS = {"table": "sam.scene.surface.readers", "instrument": "sam.scene.surface.instruments"}
"""Kind of file -> the module whose `read` makes a map of its name and content, loaded when a scene names such
a file.
"""
_LONGEST_LINE = 160  # characters of a first line that are looked at


def read_named(name: str, content: bytes, kind: type[HeightMap] = HeightMap) -> HeightMap:
    """The map in a file of that name; heights may also stand in an instrument's, known by the ending. Raises
    InputError.
    """
    tabular = kind is not HeightMap or _has_columns(content, kind) or not formats_of(name)
    reader = import_module(READERS["table" if tabular else "instrument"])
    found: HeightMap = reader.read(name, content, kind)
    return found


def _has_columns(content: bytes, kind: type[HeightMap]) -> bool:
    """Whether the first line is that of a table of such maps."""
    names = content[:_LONGEST_LINE].decode("utf-8-sig", errors="replace").partition("\n")[0].split(",")
    return sorted(name.strip() for name in names) == sorted(kind.columns())


@dataclass(frozen=True)
class MapField:
    """A field that holds a map: the name of its file in a scene file, the map itself in Python."""

    kind: type[HeightMap]

    def check(self, value: object, info: ValidationInfo) -> HeightMap:
        """The map in the file that a scene file names; in Python see `from_python`. An error "allowed" for
        others.
        """
        if not in_file(info):
            return from_python(value, self.kind)
        words = f"a CSV or npz file: {self.kind.columns_in_words()}"
        content = content_of(value, info, words, LARGEST_FILE)
        try:
            return read_named(str(value), content, self.kind)
        except InputError as error:
            raise refused(str(error)) from None

    def __get_pydantic_core_schema__(self, _source: Any, _handler: Any) -> core_schema.CoreSchema:
        as_described = core_schema.plain_serializer_function_ser_schema(lambda found: found.described)
        return core_schema.with_info_plain_validator_function(self.check, serialization=as_described)

    def __get_pydantic_json_schema__(self, _core: Any, _handler: Any) -> dict[str, Any]:
        """JSON schema of the key in a scene file: the name of the map's file."""
        words = f"the name of a CSV or npz file: {self.kind.columns_in_words()}"
        return {"type": "string", "minLength": 1, "description": words}


HeightField = Annotated[HeightMap, MapField(HeightMap)]
FrictionField = Annotated[FrictionMap, MapField(FrictionMap)]
