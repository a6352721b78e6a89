# SPDX-License-Identifier: MIT
"""Records in files, bit for bit: the codec of dataclasses as plain values and arrays, and the checkpoint of a
solve in progress, which a solver hands out after a committed load step and begins from again.

The codec has two layers. cattrs takes dataclasses apart by the types of their fields, and builds them again
only from values of these types. Below it, arrays move out of the plain values, so that the rest is JSON; what
JSON cannot say is a table with one key: {"array": name}, {"bytes": name}, {"scalar": [type, bytes]} (of
numpy), {"tuple": [...]}, and {"dict": {...}} around a table that would look like one of these. Nothing is
unpickled, and a file names no class: its reader does.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from enum import StrEnum
from types import NoneType, UnionType
from typing import Any, TypeVar, Union, cast, get_args, get_origin

import numpy as np
from cattrs import Converter
from cattrs.cols import is_sequence

JSON = None | bool | int | float | str | list["JSON"] | dict[str, "JSON"]
Arrays = Mapping[str, "np.ndarray[Any, Any]"]
T = TypeVar("T")
Hook = Callable[[Any, Any], Any]

_TAGS = ("array", "bytes", "scalar", "tuple", "dict")
_NUMBERS = "biufc"  # kinds of numpy scalars whose bytes are all there is to them
_READABLE = re.compile(r"[A-Za-z_]\w*(\.\w+)+", re.ASCII)  # paths that an array may be named by in a file
_LEAVES: dict[object, tuple[type, ...]] = {
    NoneType: (NoneType,),
    bool: (bool, np.bool_),
    int: (int, np.integer),
    float: (float, int, np.floating, np.integer),
    str: (str,),
    bytes: (bytes,),
    np.ndarray: (np.ndarray,),
}
"""Type of a field -> types of the values it may hold, which come back as they were."""


class CodecError(ValueError):
    """Values that cannot be stored, or stored ones that do not make the record that is asked for."""


def encode(record: object) -> tuple[JSON, dict[str, np.ndarray[Any, Any]]]:
    """Take a record apart: what JSON holds (NaN and infinity included), and the arrays by name, the path of
    their field or a number. An array that is met twice is stored once, and is one object again when read.

    record: a dataclass; its fields hold dataclasses, enumerations, mappings with texts as keys, lists,
    tuples, arrays of any shape, numbers, texts, bytes and None. A field of an open type (`object`, `Any`)
    holds any of these but dataclasses and enumerations, whose type a reader could not know. The types of the
    fields must be known when the program runs, not only to the type checker. CodecError for a value of
    another type.

    >>> from sam.scene.result import LeftOut
    >>> encode(LeftOut("friction", "no coefficient"))
    ({'stage': 'friction', 'reason': 'no coefficient'}, {})
    >>> encode({"cells": (3, 4), "depth": np.zeros(2)})
    ({'cells': {'tuple': [3, 4]}, 'depth': {'array': 'array-0'}}, {'array-0': array([0., 0.])})
    """
    packer = _Packer()
    return packer.pack(_CONVERTER.unstructure(record)), packer.arrays


def decode(tree: JSON, arrays: Arrays, kind: type[T]) -> T:
    """Build the record, a dataclass `kind`, that `encode` took apart, with every bit of its numbers.
    CodecError if the values are not those of a `kind`: a field that is missing, unknown or of another type.

    >>> from sam.scene.result import LeftOut
    >>> decode({"stage": "friction", "reason": "no coefficient"}, {}, LeftOut)
    LeftOut(stage='friction', reason='no coefficient')
    >>> decode({"stage": "friction", "reason": 3}, {}, LeftOut)
    Traceback (most recent call last):
    sam.scene.checkpoint.CodecError: these are not the values of a LeftOut: TypeError: 3 is no str
    """
    return build(unpacked(tree, arrays), kind)


def unpacked(tree: JSON, arrays: Arrays) -> Any:
    """Give the plain values, with the arrays where they belong. Raises CodecError."""
    try:
        return _unpacked(tree, arrays)
    except (LookupError, TypeError, ValueError, AttributeError, RecursionError) as error:
        raise CodecError(f"these are no stored values: {type(error).__name__}: {error}") from None


def build(values: object, kind: type[T]) -> T:
    """Build a record from its plain values, or a part of one. Raises CodecError."""
    try:
        return _CONVERTER.structure(values, kind)
    except Exception as error:  # of damaged values, and cattrs has a dozen types of its own
        why = f"{type(error).__name__}: {error}"
        raise CodecError(f"these are not the values of a {kind.__name__}: {why}") from None


class _Packer:
    """Moves the arrays out of plain values into `arrays`, each once."""

    def __init__(self) -> None:
        self.arrays: dict[str, np.ndarray[Any, Any]] = {}
        self._names: dict[int, str] = {}

    def pack(self, value: Any, path: str = "") -> JSON:
        """Give the value as JSON; path: names of the fields down to it."""
        kind = type(value)
        if value is None or kind in (bool, int, float, str):
            return value  # type: ignore[no-any-return]
        if kind is np.ndarray:
            return {"array": self._named(value, path)}
        if kind is bytes:
            return {"bytes": self._named(np.frombuffer(value, dtype=np.uint8), path)}
        if isinstance(value, np.generic) and value.dtype.kind in _NUMBERS:
            return {"scalar": [value.dtype.str, value.tobytes().hex()]}
        if kind in (list, tuple):
            parts = [self.pack(part, f"{path}.{k}") for k, part in enumerate(value)]
            return parts if kind is list else {"tuple": parts}
        if kind is dict and all(type(key) is str for key in value):
            table = {key: self.pack(part, f"{path}.{key}".removeprefix(".")) for key, part in value.items()}
            return {"dict": table} if len(table) == 1 and set(table) <= set(_TAGS) else table
        raise CodecError(f"{path or 'record'}: a value of the type {kind.__name__} cannot be stored")

    def _named(self, array: np.ndarray[Any, Any], path: str) -> str:
        """Store an array and give its name: the path where it was met first, if that can be a name."""
        if array.dtype.hasobject:
            raise CodecError(f"{path}: an array of objects cannot be stored")
        if id(array) not in self._names:
            free = _READABLE.fullmatch(path) and path not in self.arrays
            self._names[id(array)] = name = path if free else f"array-{len(self.arrays)}"
            self.arrays[name] = array
        return self._names[id(array)]


def _unpacked(tree: Any, arrays: Arrays) -> Any:
    if isinstance(tree, list):
        return [_unpacked(part, arrays) for part in tree]
    if not isinstance(tree, dict):
        return tree
    tag = next(iter(tree)) if len(tree) == 1 else ""
    if tag not in _TAGS:
        return {key: _unpacked(part, arrays) for key, part in tree.items()}
    body = tree[tag]
    if tag == "array":
        return arrays[body]
    if tag == "bytes":
        return arrays[body].tobytes()
    if tag == "scalar":
        return np.frombuffer(bytes.fromhex(body[1]), dtype=body[0])[0]
    if tag == "tuple":
        return tuple([_unpacked(part, arrays) for part in body])
    return {key: _unpacked(part, arrays) for key, part in body.items()}


def _leaf(kind: Any) -> tuple[type, ...]:
    """What a field of this type may hold if it is a leaf or a choice of these; else empty."""
    if get_origin(kind) in (Union, UnionType):
        choice = [_leaf(part) for part in get_args(kind)]
        return tuple(leaf for leaves in choice for leaf in leaves) if all(choice) else ()
    return _LEAVES.get(get_origin(kind) or kind, ())


def _leaf_hook(kind: Any) -> Hook:
    """The check of a leaf."""
    accepted = _leaf(kind)

    def check(value: Any, _: Any) -> Any:
        if not isinstance(value, accepted):
            raise TypeError(f"{value!r} is no {getattr(kind, '__name__', kind)}")
        return value

    return check


def _entries(value: Any, change: Callable[[Any], Any]) -> Any:
    """The sequence with its entries changed, of its own kind; an array or a text as it is."""
    return type(value)([change(entry) for entry in value]) if isinstance(value, list | tuple) else value


def _entry_type(kind: Any) -> Any:
    return (get_args(kind) or (Any,))[0]


def _sequence_apart(kind: Any, converter: Converter) -> Callable[[Any], Any]:
    entry = converter.get_unstructure_hook(_entry_type(kind))
    return lambda value: _entries(value, entry)


def _sequence_built(kind: Any, converter: Converter) -> Hook:
    inner = _entry_type(kind)
    entry = converter.get_structure_hook(inner)

    def build(value: Any, _: Any) -> Any:
        if not isinstance(value, list | tuple | np.ndarray):
            raise TypeError(f"{value!r} is no sequence")
        return _entries(value, lambda part: entry(part, inner))

    return build


def _converter() -> Converter:
    """The converter of all records. Its errors are of one field, as damage has no need of a list."""
    converter = Converter(forbid_extra_keys=True, detailed_validation=False)
    open_types: list[object] = [Any, object]

    def sequence(kind: Any) -> bool:
        return kind is Sequence or is_sequence(kind)

    converter.register_structure_hook_func(lambda kind: kind in open_types, lambda value, _: value)
    converter.register_unstructure_hook_func(lambda kind: kind in open_types, lambda value: value)
    converter.register_unstructure_hook_factory(sequence, _sequence_apart)
    converter.register_structure_hook_factory(sequence, _sequence_built)
    converter.register_structure_hook_factory(lambda kind: bool(_leaf(kind)), _leaf_hook)
    for kind in (bool, int, float, str, bytes):  # cattrs would convert them, and looks them up first
        converter.register_structure_hook(kind, _leaf_hook(kind))
    converter.register_structure_hook(StrEnum, lambda value, kind: kind(value))
    converter.register_unstructure_hook(StrEnum, lambda value: value.value)
    return converter


_CONVERTER = _converter()


@dataclass(frozen=True)
class Checkpoint:
    """A solve in progress of a model. arrays: by name, of numbers or bool, in C order (another order of the
    memory would sum in another order); values: what JSON holds, `done` and `total` load steps, `cost` so far
    (names of `sam.scene.COST`), and the tree of the record.
    """

    model: str
    arrays: Mapping[str, np.ndarray[Any, Any]]
    values: Mapping[str, Any]

    @classmethod
    def of(
        cls, model: str, record: object, *, done: int, total: int, cost: Mapping[str, float | int]
    ) -> Checkpoint:
        """The checkpoint of a record that `encode` can take apart."""
        tree, arrays = encode(record)
        return cls(model, arrays, {"done": done, "total": total, "cost": dict(cost), "tree": tree})

    def record(self, kind: type[T]) -> T:
        """The record, a `kind`. Raises CodecError if it is of another type."""
        return build(self.tree(), kind)

    def tree(self) -> dict[str, Any]:
        """The record as tables of arrays and values, for a reader that does not know its type."""
        return cast(dict[str, Any], unpacked(self.values["tree"], self.arrays))

    def with_cost(self, more: Mapping[str, float | int]) -> Checkpoint:
        """The same with more counters or times."""
        return replace(self, values={**self.values, "cost": {**self.cost, **more}})

    @property
    def cost(self) -> Mapping[str, float | int]:
        """Counters and times so far."""
        return cast(Mapping[str, float | int], self.values["cost"])

    @property
    def done(self) -> int:
        """Committed load steps."""
        return int(self.values["done"])

    @property
    def total(self) -> int:
        """Load steps of the whole scene."""
        return int(self.values["total"])


Keep = Callable[[Checkpoint], None]
"""Called by a solver after each committed load step; it decides which checkpoints it writes."""


def check_model(start: Checkpoint | None, model: str) -> None:
    """Raise ValueError for the checkpoint of another model."""
    if start is not None and start.model != model:
        raise ValueError(f"start: a checkpoint of model {start.model}, needed is one of {model}")
