# SPDX-License-Identifier: MIT
"""Results and outcomes as arrays and plain values, and back, with every type and bit as it was.

A tree of JSON holds what JSON has (None, bool, int, float, str, list); all else is a table of one entry, its tag:
{"array": name}, {"scalar": name} (of numpy), {"bytes": name}, {"tuple": [...]}, {"dict": [[key, value], ...]}, and for a
dataclass or enumeration its name. Nothing is built while reading but the classes that the reader names.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from enum import Enum

import numpy as np

Classes = Mapping[str, type]
"""Name in the file -> dataclass or enumeration that may be stored and is built when reading."""
_PLAIN = (type(None), bool, int, float, str)


class PackingError(ValueError):
    """Values that hold something that cannot be stored, or a stored tree that is none."""


def pack(value: object, classes: Classes) -> tuple[object, dict[str, np.ndarray]]:
    """(tree, arrays) of nested values. Raises PackingError for a type that is neither named here nor in `classes`."""
    names, arrays = {kind: name for name, kind in classes.items()}, {}

    def kept(array: np.ndarray) -> str:
        if array.dtype.hasobject:
            raise PackingError("an array of objects cannot be stored")
        name = f"array-{len(arrays)}"
        arrays[name] = array
        return name

    def packed(item: object) -> object:
        kind = type(item)
        if kind in _PLAIN:
            return item
        if kind is list:
            return [packed(entry) for entry in item]
        if kind is tuple:
            return {"tuple": [packed(entry) for entry in item]}
        if kind is dict and all(type(key) is str for key in item):
            return {"dict": [[key, packed(entry)] for key, entry in item.items()]}
        if kind is np.ndarray:
            return {"array": kept(item)}
        if isinstance(item, np.generic):
            return {"scalar": kept(np.asarray(item))}
        if kind is bytes:
            return {"bytes": kept(np.frombuffer(item, dtype=np.uint8))}
        if kind in names and isinstance(item, Enum):
            return {names[kind]: packed(item.value)}
        if kind in names and is_dataclass(item):
            return {names[kind]: [[field.name, packed(getattr(item, field.name))] for field in fields(item)]}
        raise PackingError(f"a value of the type {kind.__name__} cannot be stored")

    return packed(value), arrays


def unpack(tree: object, arrays: Mapping[str, np.ndarray], classes: Classes) -> object:
    """The values that were packed. Raises PackingError if this is not what `pack` makes of them."""
    builders = {
        "tuple": lambda body: tuple(map(unpacked, body)),
        "dict": lambda body: {key: unpacked(entry) for key, entry in body},
        "array": lambda name: arrays[name],
        "scalar": lambda name: arrays[name][()],
        "bytes": lambda name: arrays[name].tobytes(),
    }

    def unpacked(item: object) -> object:
        if isinstance(item, list):
            return [unpacked(entry) for entry in item]
        if not isinstance(item, dict):
            return item
        ((tag, body),) = item.items()
        if tag in builders:
            return builders[tag](body)
        kind = classes[tag]
        if issubclass(kind, Enum):
            return kind(body)
        return kind(**{key: unpacked(entry) for key, entry in body})

    try:
        return unpacked(tree)
    except (KeyError, TypeError, ValueError, IndexError, AttributeError, RecursionError) as error:
        raise PackingError(f"not what was stored: {type(error).__name__} {error}") from None
