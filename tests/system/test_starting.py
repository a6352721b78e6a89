# SPDX-License-Identifier: MIT
"""What a user begins with: `samfem new`, `examples`, `schema` and `completion`."""

import json
import subprocess

import jsonschema
import pytest
from builders import scene_text

from sam.scene import Scene, load_scene
from sam.scene.schema import parse_toml
from samfem.cli import SHELLS, STARTS
from samfem.compared import asked
from samfem.starting import KINDS, SCENES, json_schema
from verification.runs import models

SLOW = ("plastic", "sliding", "running-in")  # seconds to half a minute; a story of the guide solves the first


@pytest.fixture(scope="module")
def schema():
    found = json_schema(Scene)
    jsonschema.Draft202012Validator.check_schema(found)
    return jsonschema.Draft202012Validator(found)


@pytest.mark.parametrize("kind", STARTS)
def test_a_new_scene_is_commented_and_can_be_solved(folder, samfem, schema, kind):
    shown = samfem("new", kind).out
    advised = [line.split()[1:3] for line in shown.splitlines() if "  samfem " in line]
    text = (folder / f"{kind}.toml").read_text()
    assert text.count("#") >= 3 and tuple(KINDS) == STARTS
    assert not list(schema.iter_errors(parse_toml(text.encode(), kind)))
    scene = load_scene(folder / f"{kind}.toml")
    for command, path in advised:
        assert path == f"{kind}.toml" and samfem("plan", path)
        asked(scene) if command == "compare" else models.check(scene, models.SAM)
    if ["compare", f"{kind}.toml"] not in advised:
        with pytest.raises(models.ModelError):
            asked(scene)
    # users change the force or approach first, and the plastic zone would leave an extent of the file
    assert scene.patch_surface or scene.grid is None or scene.grid.extent is None
    if kind not in SLOW:
        assert models.solve(scene, models.SAM).converged


def test_nothing_is_overwritten(folder, samfem):
    (folder / "measured.csv").write_text("mine")
    assert "measured.csv: there already" in samfem("new", "measured", code=2).err
    assert [path.name for path in folder.iterdir()] == ["measured.csv"]
    assert (folder / "measured.csv").read_text() == "mine"


def test_examples_are_listed_and_copied_with_their_files(folder, samfem):
    listed = samfem("examples").out
    assert "hertz-sphere" in listed and "pin" in listed
    samfem("examples", "pin", "--out", "mine.toml")
    assert {path.name for path in folder.iterdir()} == {"mine.toml", "pin.csv"}
    assert load_scene(folder / "mine.toml").surface.measured.cells == (64, 64)


def test_the_schema_takes_every_scene_of_the_cases(schema):
    names = sorted(entry.name for entry in SCENES.iterdir() if entry.name.endswith(".toml"))
    assert "hertz-sphere.toml" in names
    for name in names:
        schema.validate(parse_toml(SCENES.joinpath(name).read_bytes(), name))


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ('"210 GPa"', "210e9"),
        ('"210 GPa"', '"GPa"'),
        ('"sphere"', '"cube"'),
        ("[loading]", "[loadings]"),
        ("poisson = 0.3", "poisson = 0.6"),
        ("[counterbody]", "[counterbody]\ncolour = 1"),
    ],
)
def test_the_schema_refuses_what_the_program_refuses(schema, old, new):
    text = scene_text()
    assert old in text
    schema.validate(parse_toml(text.encode(), "scene"))
    assert list(schema.iter_errors(parse_toml(text.replace(old, new, 1).encode(), "scene")))


def test_schema_and_completion_are_printed(folder, samfem):
    for words in ((), ("--study",)):
        jsonschema.Draft202012Validator.check_schema(json.loads(samfem("schema", *words).out))
    for shell in SHELLS:
        script = samfem("completion", shell).out
        assert "compare" in script and "figures" in script
    (folder / "complete").write_text(samfem("completion", "bash").out)
    subprocess.run(["bash", "-n", folder / "complete"], check=True)
