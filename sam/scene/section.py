# SPDX-License-Identifier: MIT
"""The base of every table of a scene: exact types, no unknown keys, no change afterwards,
all errors at once.
"""

from __future__ import annotations

import difflib
from collections.abc import Iterator, Mapping, Sequence
from typing import Any, ClassVar, Protocol, Self, TypeVar, get_args, get_origin

from pydantic import (
    BaseModel,
    ConfigDict,
    ModelWrapValidatorHandler,
    SerializerFunctionWrapHandler,
    ValidationError,
    ValidationInfo,
    model_serializer,
    model_validator,
)
from pydantic_core import InitErrorDetails, PydanticCustomError

from sam.scene.errors import MOST_SHOWN
from sam.scene.units import Number, in_file

NOT_YET = "not available in this version of samfem: remove it"
Conflict = tuple[str, str]
"""A key of the section, dotted for one of a section inside it, and what is allowed instead."""

MOST_ALIKE = 3  # keys in a hint
ALIKE = 0.6  # of difflib, its default: keys of the same table that look alike
CLOSE = 0.8  # of difflib: nearer than the keys of other tables that look alike
T = TypeVar("T")
_WORDS = {
    "string_type": "a string",
    "bool_type": "true or false",
    "model_type": "a table",
}


def stated(value: T | None) -> T:
    """The value of a key that the rules of its section ask for: it is not None."""
    assert value is not None
    return value


class KnownPlaces(Protocol):
    """Where the keys of a scene are; `sam.scene.places.Places`."""

    def of(self, name: str, is_table: bool) -> tuple[str, ...]:
        """Where a key of this name belongs; or nothing."""

    def nearest(self, name: str) -> tuple[str, ...]:
        """Where a key of nearly this name belongs; or nothing."""


class Section(BaseModel):
    """A table of the scene file.

    Attributes
    ----------
    later
        Keys of the scene format that this version cannot compute, refused by name; each with the values it
        refuses, or None for all of them.
    of_scene
        Whether its keys are those of a scene, so that one may belong into another table.
    unwritten
        Optional keys that are not written at their default, so that a scene has the identity, the digests and
        the files that it had before there was such a key: every key that is added from now on.
    places
        Where each key of a scene is; the scene itself says so (`sam.scene.schema`).
    """

    model_config = ConfigDict(strict=True, extra="forbid", frozen=True)
    later: ClassVar[Mapping[str, tuple[str, ...] | None]] = {}
    of_scene: ClassVar[bool] = True
    unwritten: ClassVar[tuple[str, ...]] = ()
    places: ClassVar[KnownPlaces | None] = None

    @classmethod
    def implied(cls, given: Mapping[str, Any]) -> Mapping[str, Any]:
        """Defaults that depend on other keys of `given`."""
        return {}

    @classmethod
    def conflicts(cls, given: Mapping[str, Any]) -> Iterator[Conflict]:
        """Keys of `given` that contradict each other. Called whether or not the values are good."""
        return iter(())

    def excesses(self) -> Iterator[Conflict]:
        """Keys whose good values do not go together. Called only when every value is good."""
        return iter(())

    @model_serializer(mode="wrap")
    def _written(self, handler: SerializerFunctionWrapHandler) -> dict[str, Any]:
        """The keys as they are written, see `unwritten`."""
        content: dict[str, Any] = handler(self)
        for key in self.unwritten:
            if getattr(self, key) == type(self).model_fields[key].default:
                content.pop(key, None)
        return content

    @model_validator(mode="wrap")
    @classmethod
    def _all_errors(cls, raw: Any, handler: ModelWrapValidatorHandler[Self], info: ValidationInfo) -> Self:
        """Field errors and conflicts together: pydantic alone would stop at the fields."""
        section: Self | None = None
        lines: list[InitErrorDetails] = []
        given: dict[str, Any] = {}
        if isinstance(raw, Mapping):
            given = {key: value for key, value in raw.items() if value is not None}
            raw = {**raw, **{key: value for key, value in cls.implied(given).items() if key not in given}}
        try:
            section = handler(raw)
        except ValidationError as error:
            lines = [
                _line(item["loc"], _input(item), cls._allowed(item, info, hints=k < MOST_SHOWN))
                for k, item in enumerate(error.errors())
            ]
        if isinstance(raw, Mapping):
            found = list(cls.conflicts(given)) or ([] if section is None else list(section.excesses()))
            lines += [_line(tuple(key.split(".")), value_at(given, key), allowed) for key, allowed in found]
        if lines or section is None:
            raise ValidationError.from_exception_data(cls.__name__, lines)
        return section

    @classmethod
    def _allowed(cls, item: Mapping[str, Any], info: ValidationInfo, hints: bool) -> str:
        """What is allowed where pydantic reports `item`; hints: with keys that look like an unknown one."""
        kind, context, loc = item["type"], item.get("ctx", {}), item["loc"]
        name = str(loc[0]) if loc else ""
        refused = cls.later.get(name, ())
        if refused is None or (isinstance(item["input"], str) and item["input"] in refused):
            return NOT_YET
        if kind == "extra_forbidden":
            return cls._unknown(name, isinstance(item["input"], Mapping)) if hints else "unknown key"
        if kind == "missing":
            return f"required: {cls._field_in_words(name, in_file(info))}"
        if kind == "literal_error":
            return f"one of {context['expected']}".replace("'", '"')
        return str(context.get("allowed") or _WORDS.get(kind, item["msg"]))

    @classmethod
    def _unknown(cls, name: str, is_table: bool) -> str:
        """What is allowed in place of an unknown key; with the place where it belongs, or keys that look
        alike.
        """
        known = [field.alias or key for key, field in cls.model_fields.items()]

        near: Sequence[str] = difflib.get_close_matches(name, known, n=MOST_ALIKE, cutoff=ALIKE)
        if cls.of_scene and cls.places is not None:
            close = difflib.get_close_matches(name, near, n=MOST_ALIKE, cutoff=CLOSE)
            near = cls.places.of(name, is_table) or close or cls.places.nearest(name) or near
        hint = f"did you mean {' or '.join(near)}? " if near else ""
        return f"unknown key, {hint}allowed here: {', '.join(known)}"

    @classmethod
    def _field_in_words(cls, name: str, file: bool) -> str:
        field = cls.model_fields[name]
        if isinstance(field.annotation, type) and issubclass(field.annotation, Section):
            return f"a table [{name}]"
        if get_origin(field.annotation) is tuple:
            entries = get_args(field.annotation)
            each = cls._numbers_in_words(get_args(entries[0]), file)
            return f"a list of {len(entries)}, each {each[0]}"
        numbers = cls._numbers_in_words(field.metadata, file)
        return numbers[0] if numbers else " or ".join(f'"{value}"' for value in get_args(field.annotation))

    @staticmethod
    def _numbers_in_words(metadata: Sequence[Any], file: bool) -> list[str]:
        return [entry.allowed(file) for entry in metadata if isinstance(entry, Number)]


class _Missing:
    """Stands for the value of a key that should be there."""


MISSING_INPUT = _Missing()


def value_at(given: object, key: str) -> object:
    """The value at a dotted key of nested mappings and sections, also where a key of one of these has dots;
    MISSING_INPUT if there is none.
    """
    if isinstance(given, Mapping):
        whole = next((name for name in given if f"{key}.".startswith(f"{name}.")), None)
        part, value = whole or key, given.get(whole)
    else:
        part = key.partition(".")[0]
        value = getattr(given, part, None)
    rest = key[len(part) + 1 :]
    if value is None:
        return MISSING_INPUT
    return value_at(value, rest) if rest else value


def _input(item: Mapping[str, Any]) -> object:
    return MISSING_INPUT if item["type"] == "missing" else item["input"]


def _line(loc: tuple[int | str, ...], value: object, allowed: str) -> InitErrorDetails:
    error = PydanticCustomError("allowed", "allowed: {allowed}", {"allowed": allowed})
    return InitErrorDetails(type=error, loc=loc, input=value)
