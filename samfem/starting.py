# SPDX-License-Identifier: MIT
"""The commands that a user starts with: new and examples write scene files, schema and completion what an
editor and a shell need.
"""

from __future__ import annotations

import json
from argparse import ArgumentParser
from importlib import import_module
from importlib.resources import files
from pathlib import Path
from typing import Any

from pydantic.json_schema import GenerateJsonSchema
from pydantic_core import core_schema

from sam.scene import load_scene, parse_toml, read_scene
from verification.runs import models
from verification.runs.files import FolderError, write_atomically
from verification.text.console import print_table

DRAFT = "https://json-schema.org/draft/2020-12/schema"
KINDS = {
    "sphere": "a rigid sphere on an elastic body (Hertz)",
    "plastic": "a sphere on steel that yields, loaded and unloaded",
    "indentation": "a sphere pressed into plastic steel by a given depth: the force is the result",
    "sliding": "a sliding sphere with friction, plastic",
    "coated": "a sphere on a thin coating",
    "rough": "a plane on a rough surface that is made from its parameters",
    "measured": "a plane on a measured surface; writes a small one to begin with",
    "running-in": "load cycles on a rough surface with a chemical film and wear",
}
"""Kinds of scene that `samfem new` writes."""
SCENES = files("verification").joinpath("scenes")


def new(kind: str, out: Path | None) -> int:
    """Write a commented scene of a kind, and the files that it names, and say what to do next.

    Raises FolderError where one of the files is there already.
    """
    target = out or Path(f"{kind}.toml")
    _copy(SCENES.joinpath("starts", f"{kind}.toml"), target)
    print(f"{target}: {KINDS[kind]}")
    advice = {"plan": "what it will compute", "solve": "solves it"}
    try:
        models.cheapest_reference(load_scene(target))
        advice["compare"] = "SAM and FEM"
    except models.ModelError:
        print("  by SAM alone: samfem plan says why no finite-element model can represent it")
    for command, what in advice.items():
        print(f"  samfem {command} {target}".ljust(40), what)
    return 0


def examples(name: str | None, out: Path | None) -> int:
    """List the scenes of the verification cases, or copy one, with the files that it names, to `out`.

    Raises FolderError for an unknown name, or where a file is there already.
    """
    known = {entry.name[: -len(".toml")]: entry for entry in SCENES.iterdir() if entry.name.endswith(".toml")}
    if name is None:
        titles = [(each, parse_toml(known[each].read_bytes(), each)["title"]) for each in sorted(known)]
        print_table(("example", "title"), titles)
        print("samfem examples NAME copies one")
        return 0
    if name not in known:
        raise FolderError(f"no example {name!r}: samfem examples lists them")
    target = out or Path(f"{name}.toml")
    _copy(known[name], target)
    print(target)
    return 0


def _copy(source: Any, target: Path) -> None:
    """Write a scene and the files that it names beside it. Raises FolderError and writes nothing where one is
    there already, or the folder is not.
    """
    with_files = {target: source}
    _, contents = read_scene(Path(str(source)))
    for name in contents:
        if name != source.name:
            with_files[target.parent / name] = Path(str(source)).parent / name
    if not target.parent.is_dir():
        raise FolderError(f"--out {target}: there is no folder {target.parent}")
    if there := [str(path) for path in with_files if path.exists()]:
        raise FolderError(f"{', '.join(there)}: there already, give another --out")
    for path, content in with_files.items():
        write_atomically(path, content.read_bytes())


def schema(study: bool) -> int:
    """Print the JSON schema of a scene file, or of a study, by which an editor completes and checks it."""
    module, name = ("verification.runs.study", "Study") if study else ("sam.scene", "Scene")
    print(json.dumps(json_schema(getattr(import_module(module), name)), indent=1))
    return 0


def json_schema(section: Any) -> dict[str, Any]:
    """JSON schema of the file that a `Section` is read from."""
    found: dict[str, Any] = section.model_json_schema(by_alias=True, schema_generator=_OfFile)
    return {"$schema": DRAFT, **found}


class _OfFile(GenerateJsonSchema):
    """TOML has no null, a key is there or is not; titles would only repeat the names."""

    def nullable_schema(self, schema: core_schema.NullableSchema) -> dict[str, Any]:
        return self.generate_inner(schema["schema"])

    def default_schema(self, schema: core_schema.WithDefaultSchema) -> dict[str, Any]:
        if schema.get("default", "") is None:
            return self.generate_inner(schema["schema"])
        return super().default_schema(schema)

    def model_schema(self, schema: core_schema.ModelSchema) -> dict[str, Any]:
        return {name: entry for name, entry in super().model_schema(schema).items() if name != "title"}

    def field_title_should_be_set(self, schema: object) -> bool:
        return False


def completion(shell: str, parser: ArgumentParser) -> int:
    """Print the completion of a command line for a shell."""
    import shtab

    print(shtab.complete(parser, shell=shell))
    return 0
