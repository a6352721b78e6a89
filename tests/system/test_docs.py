# SPDX-License-Identifier: MIT
"""The documentation is right: its links, commands, scenes, file names, symbols and numbers are checked."""

import json
import re
import shlex
import shutil
import tomllib
from functools import cache
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path

import pytest

from sam.scene import SceneError
from sam.scene.inputs import Inputs
from sam.scene.load import scene_of
from samfem.cli import _options
from verification.cases import all_cases
from verification.rows import read_cases
from verification.runs.study import read_study

ROOT = Path(__file__).resolve().parents[2]
README = ROOT / "README.md"
PAGES = (README, ROOT / "CONTRIBUTING.md", ROOT / "CHANGELOG.md", *sorted((ROOT / "docs").rglob("*.md")))
LONGEST_README = 120
NUMBERS = ("No", "One", "Two", "Three", "Four", "Five", "Six", "Seven", "Eight", "Nine", "Ten")
PLACEHOLDER = "NAME"
"""Stands for a name that the reader chooses."""

FENCE = re.compile(r"^```(\w*)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
LINK = re.compile(r"\]\(([^)\s]+)\)")
CODE = re.compile(r"`([^`\n]+)`")
PATH_OF_SOURCE = re.compile(r"(samfem|sam|fem_reference|verification|tests|docs|reports)/[\w./*-]+")
SYMBOLS_IN_FILE = re.compile(r"((?:`[\w.]+`(?:, | and ))*`[\w.]+`) in `([\w/]+\.py)`")
NUMBER_OF_GATE = re.compile(
    r"\| ([0-9.]+) (%|times) \| `([a-z0-9.-]+)` \| \[[^]]+\]\((reports/[\w-]+\.html)\) \|"
)


def text_of(page: Path) -> str:
    return page.read_text(encoding="utf-8")


def prose(text: str) -> str:
    """The text without its fenced blocks."""
    return FENCE.sub("", text)


def blocks(text: str, language: str) -> list[str]:
    """The contents of the fenced blocks of a language."""
    return [content for name, content in FENCE.findall(text) if name == language]


def anchors(text: str) -> set[str]:
    """The anchors of the headings: lower case, without punctuation, hyphens for spaces."""
    headings = re.findall(r"^#+ (.+)$", prose(text), re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in headings}


def broken_links(text: str, folder: Path) -> list[str]:
    """Relative links without a file, or whose anchor is no heading of the page."""
    broken = []
    for link in LINK.findall(prose(text)):
        if re.match(r"[a-z]+:", link):
            continue
        name, _, anchor = link.partition("#")
        target = folder / name
        if not name or not target.exists() or (anchor and anchor not in anchors(text_of(target))):
            broken.append(link)
    return broken


def commands(text: str) -> list[list[str]]:
    """The command lines of samfem in blocks, and those of the prose that have an argument."""
    lines = [line for block in blocks(text, "sh") for line in block.splitlines()]
    lines += [code for code in CODE.findall(prose(text)) if len(code.split("samfem ")[-1].split()) > 1]
    found = (re.fullmatch(r"(?:[A-Z_]+=\S* )*samfem ([^>]+)(?:> \S+.*)?", line) for line in lines)
    return [shlex.split(match.group(1), comments=True) for match in found if match]


def wrong_command(words: list[str]) -> str:
    """Why the command line is refused; empty if it is not. Nothing runs."""
    try:
        options = _options(words)
    except SystemExit as stop:
        return f"exit code {stop.code}: samfem {' '.join(words)}"
    named = {name for name in getattr(options, "case", ()) if not name.endswith(".toml")}
    unknown = named - {*all_cases(), PLACEHOLDER}
    return f"unknown cases {unknown}" if unknown else ""


@cache
def scene_of_readme() -> str:
    return blocks(text_of(README), "toml")[0]


def with_fragment(scene: dict, fragment: dict) -> dict:
    """The scene with the tables of a fragment in place of its own; of [body] only the keys that it gives."""
    merged = scene | fragment
    merged["body"] = scene["body"] | fragment.get("body", {})
    if "prescribed" in merged["loading"]:
        merged.pop("counterbody", None)
    return merged


def fragments() -> list[tuple[str, str, str]]:
    """(section, earlier fragments of the section, fragment) of every block of TOML outside of the README."""
    found = []
    for page in PAGES[1:]:
        for section in re.split(r"^## ", text_of(page), flags=re.MULTILINE):
            before: list[str] = []
            for block in blocks(section, "toml"):
                found.append((f"{page.stem}: {section.splitlines()[0]}", tuple(before), block))
                before.append(block)
    return found


@pytest.fixture
def folder(tmp_path) -> Path:
    """A folder with the scene of the README and the files that the fragments name."""
    (tmp_path / "sphere.toml").write_text(scene_of_readme(), encoding="utf-8")
    scenes = ROOT / "verification" / "scenes"
    shutil.copy(scenes / "curve-b.csv", tmp_path)
    shutil.copy(scenes / "pin.csv", tmp_path)
    return tmp_path


def accept(fragment: str, before: tuple[str, ...], folder: Path) -> None:
    """Raises SceneError unless the fragment is a study, a case, or makes a scene with that of the README."""
    if "rows" in tomllib.loads(fragment):
        (folder / "hertz-ellipse.toml").write_text(fragment, encoding="utf-8")
        assert read_cases(folder / "hertz-ellipse.toml")[0].rows
        return
    if "vary" in tomllib.loads(fragment):
        (folder / "study.toml").write_text(fragment, encoding="utf-8")
        read_study(folder / "study.toml")
        return
    scene = tomllib.loads(scene_of_readme())
    for part in (*before, fragment):  # no file of an instrument is shipped: heights in CSV take its place
        scene = with_fragment(scene, tomllib.loads(part.replace("pin.al3d", "pin.csv")))
    scene_of(scene, "fragment", Inputs(folder))


def test_the_readme_is_one_page():
    assert len(text_of(README).splitlines()) <= LONGEST_README


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_every_relative_link_has_its_file(page):
    assert broken_links(text_of(page), page.parent) == []


@pytest.mark.parametrize("link", ["missing.md", "docs/theory.md#no-such-heading", "reports/none.html"])
def test_a_broken_link_is_seen(link):
    assert broken_links(f"[page]({link}) and [good](docs/theory.md#conventions)", ROOT) == [link]


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_every_command_line_is_accepted_by_the_parser(page):
    assert [wrong_command(words) for words in commands(text_of(page)) if wrong_command(words)] == []


def test_the_commands_are_found():
    assert {words[0] for page in PAGES for words in commands(text_of(page))} == {
        "compare", "completion", "examples", "export", "new", "pages", "plan", "publish", "report",
        "schema", "solve", "store", "sweep", "verify", "view",
    }  # fmt: skip


@pytest.mark.parametrize(
    "line", ["samfem solve", "samfem solve a.toml --modle sam", "samfem verify no-such-case", "samfem sove a"]
)
def test_a_wrong_command_line_is_seen(line):
    (words,) = commands(f"```sh\n{line}  # a comment\n```\n")
    assert wrong_command(words)


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_every_target_of_make_and_every_module_to_run_is_there(page):
    text, makefile = text_of(page), text_of(ROOT / "Makefile")
    targets = set(re.findall(r"(?:^|`)make ([a-z.]+)", text, re.MULTILINE))
    assert {target for target in targets if f"\n{target}:" not in makefile} == set()
    modules = set(re.findall(r"python -m (verification[\w.]*)", text))
    assert {module for module in modules if find_spec(module) is None} == set()


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_every_path_that_is_named_exists(page):
    named = {code for code in CODE.findall(prose(text_of(page))) if PATH_OF_SOURCE.fullmatch(code)}
    kept = {path for path in named if PLACEHOLDER not in path and not path.startswith("reports/latest")}
    assert {path for path in kept if not any(ROOT.glob(path.rstrip("/")))} == set()


def test_every_symbol_stands_in_the_file_that_the_architecture_names():
    found = SYMBOLS_IN_FILE.findall(text_of(ROOT / "docs" / "architecture.md"))
    places = [(symbol, path) for symbols, path in found for symbol in CODE.findall(symbols)]
    assert len(places) >= 10
    for symbol, path in places:
        name = symbol.split(".")[-1]
        assert re.search(rf"^\s*(def|class) {name}\b", text_of(ROOT / path), re.MULTILINE), (symbol, path)


def test_the_architecture_names_every_package():
    text = text_of(ROOT / "docs" / "architecture.md")
    folders = {path.parent for name in ("samfem", "sam", "fem_reference", "verification") for path in
               (ROOT / name).rglob("__init__.py")}  # fmt: skip
    parts = {folder.relative_to(ROOT).as_posix() for folder in folders}
    parts = {part for part in parts if not part.startswith("verification/cases/")}  # families of cases
    missing = {part for part in parts if f"`{part.replace('/', '.')}`" not in text}
    assert missing <= {"sam/scene/surface", "verification", "verification/peers/programs"}


def test_the_scene_of_the_readme_is_complete(folder):
    scene_of(tomllib.loads(scene_of_readme()), "README", Inputs(folder))


@pytest.mark.parametrize("where, before, fragment", fragments(), ids=[found[0] for found in fragments()])
def test_every_fragment_of_a_scene_or_study_is_accepted(folder, where, before, fragment):
    accept(fragment, before, folder)


@pytest.mark.parametrize(
    "fragment",
    ["[friction]\ncoeficient = 0.2\n", '[loading]\nforce = "-1 N"\n', "[solver]\nextrapolate = 1\n",
     'scene = "sphere.toml"\nmodel = "sam"\nmode = "grid"\n[vary]\n"loading.forse" = { list = ["1 N"] }\n'],
)  # fmt: skip
def test_a_wrong_fragment_is_seen(folder, fragment):
    with pytest.raises(SceneError):
        accept(fragment, (), folder)


def test_every_public_function_of_the_python_page_is_public():
    rows = re.findall(
        r"^\| `([\w.]+)` \|[^|]*\| (.+) \|$", text_of(ROOT / "docs/guide/python.md"), re.MULTILINE
    )
    assert {package for package, _ in rows} == {"sam", "fem_reference", "fem_reference.spatial"}
    for package, names in rows:
        assert set(CODE.findall(names)) <= set(import_module(package).__all__), package


@cache
def published() -> dict:
    return json.loads(text_of(ROOT / "reports" / "results.json"))


def wrong_numbers(text: str) -> list[str]:
    """Gates whose printed number is not that of the published page to half a unit of its last digit, or which
    do not stand on that page.
    """
    wrong = []
    for number, unit, gate, page in NUMBER_OF_GATE.findall(text):
        verdict = next(v for v in published()["gates"] if v["id"] == gate)
        value = verdict["error"] * (100 if unit == "%" else 1)
        half = 0.5 * 10.0 ** -len(number.partition(".")[2])
        right = verdict["status"] == "passed" and abs(float(number) - value) <= half * (1 + 1e-9)
        if not right or f'id="{gate}"' not in text_of(ROOT / page):
            wrong.append(gate)
    return wrong


def not_named_red(text: str) -> set[str]:
    """Gates that failed and that the text does not name, or names although they hold."""
    states = {gate["id"]: gate["status"] for gate in published()["gates"]}
    red = {name for name, status in states.items() if status in ("failed", "unchecked")}
    numbers = {gate for *_, gate, _ in NUMBER_OF_GATE.findall(text)}
    return red ^ ({name for name in CODE.findall(text) if name in states} - numbers)


def test_the_numbers_are_those_of_the_published_pages():
    assert len(NUMBER_OF_GATE.findall(text_of(README))) == 5 and wrong_numbers(text_of(README)) == []


def test_the_readme_names_every_gate_that_failed():
    text = text_of(README)
    failed = published()["summary"]["failed"] + published()["summary"]["unchecked"]
    assert not_named_red(text) == set()
    count = NUMBERS[failed] if failed < len(NUMBERS) else failed
    assert not failed or f"{count} gate{'s' if failed > 1 else ''} fail" in text


def test_another_number_is_seen():
    text = text_of(README)
    rows = re.findall(r"\| ([0-9.]+)( (?:%|times)) \| `([^`]+)`", text)
    assert len(rows) == 5
    for number, unit, gate in rows:
        other = text.replace(f"| {number}{unit} | `{gate}`", f"| {1.1 * float(number):.4g}{unit} | `{gate}`")
        assert wrong_numbers(other) == [gate]


def test_a_red_gate_that_is_not_named_is_seen():
    assert not_named_red(text_of(README) + " `pavement.fox`") == {"pavement.fox"}
    red = [gate["id"] for gate in published()["gates"] if gate["status"] == "failed"]
    assert not_named_red("") == set(red)
