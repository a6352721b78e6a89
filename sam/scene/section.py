# SPDX-License-Identifier: MIT
"""The base of every table of a scene: exact types, no unknown keys, no change afterwards, and what is wrong
with it all at once: key, value and what is allowed.

A scene as its file spells it: the tables that `parse_toml` would return, and their text.
"""

from __future__ import annotations

import difflib
import json
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any, ClassVar, Self, TypeVar, get_args, get_origin

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
from pydantic_core import InitErrorDetails

from sam.scene.units import Number, in_file, refused, spelled

NOT_YET = "not available in this version of samfem: remove it"
Conflict = tuple[str, str]
"""A key of the section, dotted for one of a section inside it, and what is allowed instead."""
MISSING = "missing"
MOST_SHOWN = 100  # problems of a file: more is no scene file
_LONGEST = 60  # characters of a value in a message
_MOST_ALIKE, _MOST_PLACES = 3, 4  # keys in a hint, of the same table and of others
# of difflib: keys of the same table that look alike, its default; a slip of one or two letters in a key of
# any table; and nearer than that
_ALIKE, _SLIP, _CLOSE = 0.6, 0.75, 0.8
OTHER_NAMES = {
    "film": ("[body.coating]", '[friction] with law = "chemical-film"'),
    "layer": ("[body.coating]",),
    "hardening": ("[body.plasticity]",),
    "substrate": ("[body]",),
    "halfspace": ("[body]",),
    "indenter": ("[counterbody]",),
    "ball": ("[counterbody]",),
    "sphere": ("[counterbody]",),
    "punch": ("[counterbody]",),
    "roughness": ("[surface]",),
    "mesh": ("[fem]", "[grid]"),
}
"""What others call a table -> where it is here."""
_WORDS = {"string_type": "a string", "bool_type": "true or false", "model_type": "a table"}
T = TypeVar("T")


MISSING_INPUT = object()
"""Stands for the value of a key that should be there."""


@dataclass(frozen=True)
class Problem:
    """An error of a scene: dotted key; value as TOML spells it, or "missing"; what is allowed."""

    key: str
    value: str
    allowed: str

    def __str__(self) -> str:
        if not self.key:
            return self.allowed
        between = " is " if self.value == MISSING else " = "
        return f"{printable(self.key)}{between}{self.value}: {self.allowed}"


class SceneError(ValueError):
    """A scene that cannot be used.

    Parameters
    ----------
    problems
        Every error of it.
    source
        The name of the file.
    """

    def __init__(self, problems: Sequence[Problem], source: str):
        self.problems = tuple(problems)
        self.source = source
        super().__init__(str(self))

    def __str__(self) -> str:
        source = printable(self.source)
        if len(self.problems) == 1:
            return f"{source}: {self.problems[0]}"
        shown = list(map(str, self.problems[:MOST_SHOWN]))
        if len(self.problems) > MOST_SHOWN:
            shown.append(f"and {len(self.problems) - MOST_SHOWN} more")
        return "\n  ".join([f"{source}: {len(self.problems)} errors", *shown])


def problems(error: ValidationError) -> list[Problem]:
    """Every problem of the validation error of a `Section`, in the order of the file's keys."""
    listed = []
    for item in error.errors(include_url=False):
        key = "".join(f"[{part}]" if isinstance(part, int) else f".{part}" for part in item["loc"])
        value = MISSING if item["input"] is MISSING_INPUT else spelling(item["input"])
        listed.append(Problem(key.removeprefix("."), value, item["ctx"]["allowed"]))
    return listed


def spelling(value: Any, unit: str = "") -> str:
    """A value, of a number in SI with its unit, as a scene file spells it, on one line of at most 60
    characters; what JSON cannot hold is named by its type.

    >>> spelling([1, "m"])
    '[1, "m"]'
    """
    try:
        text = json.dumps(spelled(value, unit) if unit else value, ensure_ascii=False, default=str)
    except (ValueError, RecursionError):
        text = repr(type(value))
    text = printable(text)
    return text if len(text) <= _LONGEST else text[: _LONGEST - 3] + "..."


def printable(text: str) -> str:
    """The text with "?" for control characters and line ends, which act on terminals or break files."""
    return "".join(character if character.isprintable() else "?" for character in text)


def stated(value: T | None) -> T:
    """The value of a key that the rules of its section ask for: it is not None."""
    assert value is not None
    return value


class Given(dict[str, Any]):
    """The keys of a section that are given, with their values."""

    def at(self, key: str) -> Any:
        """The value at a dotted key of nested tables, whose keys may have dots; or None."""
        value: Any = self
        while key and value is not None:
            if isinstance(value, Mapping):
                name = next((name for name in value if f"{key}.".startswith(f"{name}.")), key)
                value = value.get(name)
            else:
                name = key.partition(".")[0]
                value = getattr(value, name, None)
            key = key[len(name) + 1 :]
        return value

    def text(self, key: str) -> str:
        """The text at a key; empty where there is none."""
        return value if isinstance(value := self.get(key), str) else ""

    def has(self, key: str) -> bool:
        """Whether there is a value at a dotted key."""
        return self.at(key) is not None


def broken(*rules: tuple[object, str, str]) -> Iterator[Conflict]:
    """The conflicts of a table of rules: whether the rule is broken, the key, and what is allowed."""
    return ((key, allowed) for breaks, key, allowed in rules if breaks)


def of_choice(
    given: Mapping[str, Any],
    keys: Iterable[str],
    choice: tuple[Collection[str], Collection[str]],
    words: Conflict,
) -> Iterator[Conflict]:
    """The conflicts of keys that depend on a choice, such as a law: what it needs and takes."""
    needed, taken = choice
    for key in keys:
        if key in needed and key not in given:
            yield key, words[0]
        if key not in taken and key in given:
            yield key, words[1]


class Section(BaseModel):
    """A table of the scene file.

    of_scene: whether its keys are those of a scene, so that one may belong into another table; whole: the
    table of all others, the scene, which says so itself (`sam.scene.schema`). unwritten: optional keys that
    are not written at their default, so that a scene has the identity, the digests and the files that it had
    before there was such a key: every key that is added from now on.
    """

    model_config = ConfigDict(strict=True, extra="forbid", frozen=True)
    of_scene: ClassVar[bool] = True
    unwritten: ClassVar[tuple[str, ...]] = ()
    whole: ClassVar[type[Section] | None] = None

    @classmethod
    def implied(cls, given: Given) -> Mapping[str, Any]:
        """Defaults that depend on other keys of `given`."""
        return {}

    @classmethod
    def conflicts(cls, given: Given) -> Iterator[Conflict]:
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
        given = Given()
        if isinstance(raw, Mapping):
            given.update({key: value for key, value in raw.items() if value is not None})
            raw = {**raw, **{key: value for key, value in cls.implied(given).items() if key not in given}}
        try:
            section = handler(raw)
        except ValidationError as error:
            for k, item in enumerate(error.errors()):
                value = MISSING_INPUT if item["type"] == "missing" else item["input"]
                lines.append(_line(item["loc"], value, cls._allowed(item, info, hints=k < MOST_SHOWN)))
        if isinstance(raw, Mapping):
            conflicts = list(cls.conflicts(given)) or ([] if section is None else list(section.excesses()))
            for key, allowed in conflicts:
                value = given.at(key) if given.has(key) else MISSING_INPUT
                lines.append(_line(tuple(key.split(".")), value, allowed))
        if lines or section is None:
            raise ValidationError.from_exception_data(cls.__name__, cls._once(lines, given))
        return section

    @classmethod
    def _once(cls, lines: Sequence[InitErrorDetails], given: Given) -> list[InitErrorDetails]:
        """The errors without that of a missing key for which an unknown one stands, which is an error too."""
        unknown = [name for name in given if name not in cls._names()][:MOST_SHOWN]
        meant = {(near,) for name in unknown for near in cls._near(name, isinstance(given[name], Mapping))}
        return [line for line in lines if line["input"] is not MISSING_INPUT or line["loc"] not in meant]

    @classmethod
    def _names(cls) -> list[str]:
        return [field.alias or key for key, field in cls.model_fields.items()]

    @classmethod
    def _allowed(cls, item: Mapping[str, Any], info: ValidationInfo, hints: bool) -> str:
        """What is allowed where pydantic reports `item`; hints: with keys that look like an unknown one."""
        kind, context = item["type"], item.get("ctx", {})
        name = str(item["loc"][0]) if item["loc"] else ""
        if kind == "extra_forbidden":
            near = cls._near(name, isinstance(item["input"], Mapping)) if hints else ()
            hint = f"did you mean {' or '.join(near)}? " if near else ""
            return f"unknown key, {hint}allowed here: {', '.join(cls._names())}" if hints else "unknown key"
        if kind == "missing":
            return f"required: {cls._field_in_words(name, in_file(info))}"
        if kind == "literal_error":
            return f"one of {context['expected']}".replace("'", '"')
        return str(context.get("allowed") or _WORDS.get(kind, item["msg"]))

    @classmethod
    def _near(cls, name: str, is_table: bool) -> Sequence[str]:
        """For an unknown key the place it belongs to, or keys that look alike."""
        near: Sequence[str] = difflib.get_close_matches(name, cls._names(), n=_MOST_ALIKE, cutoff=_ALIKE)
        if cls.of_scene and cls.whole is not None:
            places = places_of(cls.whole)
            there, others = places.get(name, ()), OTHER_NAMES.get(name.lower(), ()) if is_table else ()
            alike = [place for place in there if place.startswith("[") == is_table]
            near = (
                (*others, *(alike or there))[:_MOST_PLACES]
                or difflib.get_close_matches(name, near, n=_MOST_ALIKE, cutoff=_CLOSE)
                or [p for key in difflib.get_close_matches(name, places, 1, _SLIP) for p in places[key]][
                    :_MOST_PLACES
                ]
                or near
            )
        return near

    @classmethod
    def _field_in_words(cls, name: str, file: bool) -> str:
        def numbers(metadata: Sequence[Any]) -> list[str]:
            return [entry.allowed(file) for entry in metadata if isinstance(entry, Number)]

        field = cls.model_fields[name]
        if isinstance(field.annotation, type) and issubclass(field.annotation, Section):
            return f"a table [{name}]"
        if get_origin(field.annotation) is tuple:
            entries = get_args(field.annotation)
            return f"a list of {len(entries)}, each {numbers(get_args(entries[0]))[0]}"
        words = numbers(field.metadata)
        return words[0] if words else " or ".join(f'"{value}"' for value in get_args(field.annotation))


def _line(loc: tuple[int | str, ...], value: object, allowed: str) -> InitErrorDetails:
    return InitErrorDetails(type=refused(allowed), loc=loc, input=value)


@cache
def places_of(section: type[Section], above: str = "") -> dict[str, tuple[str, ...]]:
    """Key -> every place that has it, as a file spells it: "[body.coating]", "body.young"."""
    known: dict[str, tuple[str, ...]] = {}
    for key, field in section.model_fields.items():
        name, parts = field.alias or key, (field.annotation, *get_args(field.annotation))
        inner = next((part for part in parts if isinstance(part, type) and issubclass(part, Section)), None)
        place = {name: (f"[{above}{name}]" if inner else f"{above}{name}",)}
        for table in (place, places_of(inner, f"{above}{name}.") if inner else {}):
            for name_in, places in table.items():
                known[name_in] = known.get(name_in, ()) + places
    return known


def unit_in(kind: Any) -> str:
    """The SI unit of the numbers in an annotation; empty for pure numbers and others."""
    if isinstance(kind, Number):
        return kind.unit
    return next(filter(None, map(unit_in, get_args(kind))), "")


def unit_of_key(section: type[Section], key: str) -> str:
    """The SI unit of the numbers of a dotted key; empty for pure numbers, others and unknown keys."""
    name, _, rest = key.partition(".")
    for field_name, field in section.model_fields.items():
        if name == (field.alias or field_name):
            kinds = (field.annotation, *get_args(field.annotation))
            inner = [kind for kind in kinds if isinstance(kind, type) and issubclass(kind, Section)]
            if rest:
                return unit_of_key(inner[0], rest) if inner else ""
            return next(filter(None, map(unit_in, (*field.metadata, field.annotation))), "")
    return ""


def with_units(value: Any, unit: str) -> Any:
    """A value whose SI numbers are spelled with their unit, those of a list too; others as they are."""
    if unit and type(value) in (list, tuple):
        return [with_units(entry, unit) for entry in value]
    number = unit and isinstance(value, int | float) and not isinstance(value, bool)
    return spelled(value, unit) if number else value


def tables_of(section: Section) -> dict[str, Any]:
    """The keys of a section that are not at their default, numbers as strings with units; what stands in a
    file of its own is the value itself.
    """
    fields = type(section).model_fields
    given = {key: value for key in fields if (value := getattr(section, key)) is not None}
    implied, found = type(section).implied(Given(given)), {}
    for key, value in given.items():
        if value != implied.get(key, fields[key].default):
            name = fields[key].alias or key
            if isinstance(value, Section):
                found[name] = tables_of(value)
            else:
                found[name] = with_units(value, unit_of_key(type(section), name))
    return found


def nameless(tables: Mapping[str, Any], above: str = "") -> Iterator[Problem]:
    """What a file cannot spell: maps and rows that are in no file of their own."""
    for name, value in tables.items():
        if isinstance(value, Mapping):
            yield from nameless(value, f"{above}{name}.")
        elif not getattr(value, "of_file", True):
            words = "a file of its own, which a scene file names: write it, and load a scene that names it"
            yield Problem(f"{above}{name}", repr(value), words)


def toml(tables: Mapping[str, Any], above: str = "") -> Iterator[str]:
    """The lines of tables."""
    inner = {name: value for name, value in tables.items() if isinstance(value, Mapping)}
    for name, value in tables.items():
        if name not in inner:
            for key, entry in (getattr(value, "of_file", None) or {name: value}).items():
                yield f"{_key(key)} = {_value(entry)}"
    for name, table in inner.items():
        yield from ("", f"[{above}{_key(name)}]")
        yield from toml(table, f"{above}{_key(name)}.")


def _key(name: str) -> str:
    return name if name.replace("-", "_").isidentifier() and name.isascii() else _value(name)


def _value(value: Any) -> str:
    if isinstance(value, str):
        return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")
    if type(value) in (list, tuple):
        return f"[{', '.join(map(_value, value))}]"
    return str(value).lower() if isinstance(value, bool) else repr(value)
