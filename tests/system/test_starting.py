# SPDX-License-Identifier: MIT
"""What a user begins with: `samfem new`, `examples`, `schema` and `completion`."""

import json
import subprocess

import jsonschema
import pytest
from builders import scene_text

from sam.scene import Scene, load_scene
from sam.scene.load import parse_toml
from samfem.cli import STARTS, main
from samfem.compared import asked
from samfem.starting import KINDS, SCENES, json_schema
from verification.runs import models

SLOW = ("plastic", "sliding", "running-in")  # seconds to half a minute; a story of the guide solves the first


@pytest.fixture(scope="module")
def schema():
    found = json_schema(Scene)
    jsonschema.Draft202012Validator.check_schema(found)
    return jsonschema.Draft202012Validator(found)


@pytest.fixture
def here(tmp_path, monkeypatch):
    """An empty folder, the current one."""
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.mark.parametrize("kind", STARTS)
def test_a_new_scene_is_commented_and_can_be_solved(here, capsys, schema, kind):
    assert main(["new", kind]) == 0
    advised = [line.split()[1:3] for line in capsys.readouterr().out.splitlines() if "  samfem " in line]
    text = (here / f"{kind}.toml").read_text()
    assert text.count("#") >= 3 and tuple(KINDS) == STARTS
    assert not list(schema.iter_errors(parse_toml(text.encode(), kind)))
    scene = load_scene(here / f"{kind}.toml")
    for command, path in advised:
        assert path == f"{kind}.toml" and main(["plan", path]) == 0
        asked(scene) if command == "compare" else models.check(scene, models.SAM)
    if ["compare", f"{kind}.toml"] not in advised:
        with pytest.raises(models.ModelError):
            asked(scene)
    # users change the force or approach first, and the plastic zone would leave an extent of the file
    assert scene.patch_surface or scene.grid is None or scene.grid.extent is None
    if kind not in SLOW:
        assert models.solve(scene, models.SAM).converged


def test_nothing_is_overwritten(here, capsys):
    (here / "measured.csv").write_text("mine")
    assert main(["new", "measured"]) == 2
    assert "measured.csv: there already" in capsys.readouterr().err
    assert [path.name for path in here.iterdir()] == ["measured.csv"]
    assert (here / "measured.csv").read_text() == "mine"


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("new", "cube"), "cube"),
        (("new", "sphere", "--out", "nowhere/a.toml"), "no folder nowhere"),
        (("examples", "cube"), "no example 'cube'"),
        (("examples", "../scenes/pin"), "no example"),
        (("completion", "ksh"), "ksh"),
    ],
)
def test_wrong_words_are_refused_and_nothing_is_made(here, capsys, words, said):
    assert main(words) == 2
    assert said in capsys.readouterr().err
    assert not list(here.iterdir())


def test_examples_are_listed_and_copied_with_their_files(here, capsys):
    assert main(["examples"]) == 0
    assert "hertz-sphere" in (listed := capsys.readouterr().out) and "pin" in listed
    assert main(["examples", "pin", "--out", "mine.toml"]) == 0
    assert {path.name for path in here.iterdir()} == {"mine.toml", "pin.csv"}
    assert load_scene(here / "mine.toml").surface.measured.cells == (64, 64)


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


@pytest.mark.parametrize("words", [(), ("--study",)])
def test_schema_prints_json(capsys, words):
    assert main(["schema", *words]) == 0
    jsonschema.Draft202012Validator.check_schema(json.loads(capsys.readouterr().out))


@pytest.mark.parametrize("shell", ["bash", "zsh"])
def test_completion_names_commands_and_options(here, capsys, shell):
    assert main(["completion", shell]) == 0
    script = capsys.readouterr().out
    assert "compare" in script and "--figures" in script
    if shell == "bash":
        (here / "complete").write_text(script)
        subprocess.run(["bash", "-n", here / "complete"], check=True)
