# SPDX-License-Identifier: MIT
"""A scene as its file spells it: the tables that `parse_toml` would return, and their text."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from typing import Any, get_args

from sam.scene.section import Given, Problem, Section
from sam.scene.units import Number, spelled


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
