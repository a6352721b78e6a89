# SPDX-License-Identifier: MIT
"""The documentation is right: commands, scenes, names. `make docs` runs the stories and checks links."""

import re
import shlex
import shutil
import tomllib
from importlib.util import find_spec
from pathlib import Path

import pytest

from sam.scene import PATH_QUANTITIES, QUANTITIES, load_scene
from sam.scene.inputs import Inputs
from sam.scene.schema import scene_of
from samfem.cli import COMMANDS, _options
from verification.cases import all_cases
from verification.cost.plan import plan
from verification.rows import read_cases
from verification.runs.study import read_study

ROOT = Path(__file__).resolve().parents[2]
STARTS = ROOT / "verification" / "scenes" / "starts"
GUIDE, ARCHITECTURE = ROOT / "docs" / "guide", ROOT / "docs" / "architecture.md"
README = (ROOT / "README.md").read_text(encoding="utf-8")
PAGES = {
    path: path.read_text(encoding="utf-8")
    for path in (*ROOT.glob("*.md"), *sorted((ROOT / "docs").glob("*.md")), *sorted(GUIDE.glob("*.md")))
}
LONGEST_README, LONGEST_PATH = 165, 2800  # lines
PLACEHOLDER = "NAME"
"""Stands for a name that the reader chooses."""

FENCE = re.compile(r"^```(\w*)[^\n]*\n(.*?)^```$", re.MULTILINE | re.DOTALL)
CODE = re.compile(r"`([^`\n]+)`")
PATH_OF_SOURCE = re.compile(r"(samfem|sam|fem_reference|verification|tests|docs|reports)/[\w./*-]+")


def prose(text: str) -> str:
    """The text without its fenced blocks."""
    return FENCE.sub("", text)


def blocks(text: str, language: str) -> list[str]:
    """The contents of the fenced blocks of a language."""
    return [content for name, content in FENCE.findall(text) if name == language]


def commands(text: str) -> list[list[str]]:
    """The command lines of samfem in blocks, and those of the prose that have an argument."""
    lines = [line for block in blocks(text, "sh") for line in block.splitlines()]
    lines += [code for code in CODE.findall(prose(text)) if len(code.split("samfem ")[-1].split()) > 1]
    found = (re.fullmatch(r"(?:[A-Z_]+=\S* )*samfem ([^>]+)(?:> \S+.*)?", line) for line in lines)
    return [shlex.split(match.group(1), comments=True) for match in found if match]


def wrong_commands(text: str) -> list[list[str]]:
    """The command lines that the parser refuses, or that name an unknown case. Nothing runs."""
    wrong = []
    for words in commands(text):
        try:
            named = getattr(_options(words), "case", ())
        except SystemExit:
            wrong.append(words)
            continue
        if {name for name in named if not name.endswith(".toml")} - {*all_cases(), PLACEHOLDER}:
            wrong.append(words)
    return wrong


def fragments() -> list[tuple[str, list[str]]]:
    """(section, its first blocks of TOML, up to one that is tested)."""
    found = []
    for page, text in PAGES.items():
        for section in re.split(r"^## ", text, flags=re.MULTILINE):
            inside = blocks(section, "toml")
            found += [
                (f"{page.stem}: {section.splitlines()[0]}", inside[:k]) for k in range(1, len(inside) + 1)
            ]
    return found


def test_the_readme_is_short_and_its_example_is_that_of_the_command():
    """The times and the memory of the plan alone are those of a machine."""
    assert len(README.splitlines()) <= LONGEST_README
    assert blocks(README, "toml")[0] == (STARTS / "sliding.toml").read_text(encoding="utf-8")
    shown = blocks(README, "console")[0].splitlines()
    planned = [line for line in plan(load_scene(STARTS / "sliding.toml")).lines() if "time and" not in line]
    assert len(planned) >= 4 and [line for line in planned if line not in shown] == []


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_commands_targets_modules_and_paths_are_right(page):
    text, makefile = PAGES[page], (ROOT / "Makefile").read_text(encoding="utf-8")
    assert wrong_commands(text) == []
    targets = set(re.findall(r"(?:^|`)make ([a-z.]+)", text, re.MULTILINE))
    assert {target for target in targets if f"\n{target}:" not in makefile} == set()
    modules = set(re.findall(r"python -m (verification[\w.]*)", text))
    assert {module for module in modules if find_spec(module) is None} == set()
    named = {code for code in CODE.findall(prose(text)) if PATH_OF_SOURCE.fullmatch(code)}
    made = PLACEHOLDER, "reports/latest", "docs/_build"
    kept = {path for path in named if not any(part in path for part in made)}
    assert {path for path in kept if not any(ROOT.glob(path.rstrip("/")))} == set()


def test_every_command_is_documented():
    assert {words[0] for text in PAGES.values() for words in commands(text)} == set(COMMANDS)


def defines(path: str, name: str) -> bool:
    """Whether a file defines a function or class of that name."""
    source = (ROOT / path).read_text(encoding="utf-8")
    return re.search(rf"^\s*(def|class) {name}\b", source, re.MULTILINE) is not None


def test_the_reading_path_is_short_and_each_file_defines_what_is_to_be_read_in_it():
    section = PAGES[ARCHITECTURE].split("### A reading path")[1].split("\n## ")[0]
    path = dict(re.findall(r"^\| `([^`]+)` \| (.+) \|$", section, re.MULTILINE))
    assert next(iter(path)) == "sam/solver.py" and list(path)[-1].startswith("sam/kernels/")
    lines = [len((ROOT / file).read_text(encoding="utf-8").splitlines()) for file in path]
    assert 1000 < sum(lines) <= LONGEST_PATH
    for file, words in path.items():
        parts = [part for name in CODE.findall(words) for part in name.split(".")]
        assert parts and [part for part in parts if not defines(file, part)] == [], file


def test_the_guide_has_every_quantity_with_its_unit():
    rows = re.findall(r"^\| `(\w+)` \| (\S+) \| \w", (GUIDE / "results.md").read_text("utf-8"), re.MULTILINE)
    units = {"m2": "m²", "m3": "m³", "Pa": "Pa", "m": "m", "N": "N"}
    found = [*QUANTITIES, *PATH_QUANTITIES]
    assert rows[: len(found)] == [(name, units.get(name.rpartition("_")[2], "1")) for name in found]


@pytest.mark.parametrize("where, parts", fragments(), ids=[found[0] for found in fragments()])
def test_every_fragment_of_a_scene_or_study_is_accepted(folder, where, parts):
    """The last part is a study, a case, or makes a scene with the parts before it and that of `samfem new
    plastic`; of [body] a part changes only the keys that it gives.
    """
    shutil.copy(STARTS / "plastic.toml", folder / "sphere.toml")
    for name in ("curve-b.csv", "pin.csv"):
        shutil.copy(ROOT / "verification" / "scenes" / name, folder)
    kind = tomllib.loads(parts[-1])
    if "rows" in kind:
        (folder / "hertz-ellipse.toml").write_text(parts[-1], encoding="utf-8")
        assert read_cases(folder / "hertz-ellipse.toml")[0].rows
    elif "vary" in kind:
        (folder / "study.toml").write_text(parts[-1], encoding="utf-8")
        assert read_study(folder / "study.toml")
    else:
        scene = tomllib.loads((STARTS / "plastic.toml").read_text(encoding="utf-8"))
        for part in parts:  # no file of an instrument is shipped: heights in CSV take its place
            changes = tomllib.loads(part.replace("pin.al3d", "pin.csv"))
            scene = scene | changes | {"body": scene["body"] | changes.get("body", {})}
            if "prescribed" in scene["loading"]:
                scene.pop("counterbody", None)
        assert scene_of(scene, "fragment", Inputs(folder)).body
