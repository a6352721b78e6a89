# SPDX-License-Identifier: MIT
"""The sources: modules within their limit, and docs/equations.md against the code: a
row for each equation, names that exist, functions that cite it; models apart. ruff holds the other limits.
"""

import ast
import inspect
import io
import re
import tokenize
from functools import cache, cached_property
from pathlib import Path
from pkgutil import resolve_name

ROOT = Path(__file__).resolve().parents[2]
SOURCES = {
    path.relative_to(ROOT).as_posix(): path.read_text(encoding="utf-8")
    for folder in ("samfem", "sam", "fem_reference", "verification", "tests", "docs")
    for path in sorted((ROOT / folder).rglob("*"))
    if path.suffix in (".py", ".md")
}
MODULE = 800  # lines
PAGE = SOURCES["docs/equations.md"]
NUMBERS = {str(k) for k in range(1, 31)}
WITHOUT_NUMBER = {"D_33": "D_33", "D_31": "D_31", "outside": "outside", "inside": "inside"}
"""Rows of equations that have no number, and the word by which a function cites them."""
NAME = re.compile(r"`((?:sam|verification)\.[\w.]+)`")
TEST = re.compile(r"`(tests/[\w/]+\.py)::([\w:]+)`")
CITATION = re.compile(r"Eqs?\.\s+(\d+(?:(?:, | and | to |-)\d+)*)(?![\d.]*\.\d)")


def test_modules_within_their_limit():
    python = {name: text for name, text in SOURCES.items() if name.endswith(".py")}
    assert len(python) > 300
    assert not [name for name, text in python.items() if len(text.splitlines()) > MODULE]


def rows(page: str) -> dict[str, str]:
    """Equation -> its row in the first table."""
    table = page.partition("## Where each equation is")[2].partition("## Misprints")[0]
    lines = [line for line in table.splitlines() if line.startswith("| ") and not line.startswith("| Eq.")]
    return {line.split("|")[1].strip(): line for line in lines}


@cache
def cited(thing: object) -> set[str]:
    """The words of comments and strings of a function, method, property or class, and the numbers
    that they cite: of "Eq. 5", "Eq. 9 and 10", "Eq. 22 to 26"; not "Eq. 3.19" of another source.
    """
    thing = thing.fget if isinstance(thing, property) else thing
    thing = thing.func if isinstance(thing, cached_property) else thing
    source = inspect.cleandoc("\n" + inspect.getsource(inspect.unwrap(thing)))
    tokens = tokenize.generate_tokens(io.StringIO(source).readline)
    text = "\n".join(token.string for token in tokens if token.type in (tokenize.COMMENT, tokenize.STRING))
    out = set(re.findall(r"\w+", text)) - NUMBERS
    for match in CITATION.findall(text):
        for part in re.split(", | and ", match):
            ends = [int(end) for end in re.split(" to |-", part)]
            out |= {str(k) for k in range(ends[0], ends[-1] + 1)}
    return out


def faults(page: str) -> list[str]:
    """What is wrong with a page."""
    known = rows(page)
    out = [f"{each}: no row" for each in sorted((NUMBERS | set(WITHOUT_NUMBER)) - set(known))]
    for equation, row in known.items():
        names, tests = NAME.findall(row), TEST.findall(row)
        out += [f"{equation}: no {what}" for what, of in (("function", names), ("test", tests)) if not of]
        for name in names:
            try:
                thing = resolve_name(name)
            except (ImportError, AttributeError):
                out.append(f"{equation}: {name} does not exist")
                continue
            if WITHOUT_NUMBER.get(equation, equation) not in cited(thing):
                out.append(f"{equation}: {name} does not cite it")
        for file, test in tests:
            if not re.search(rf"^\s*def {test.rpartition(':')[2]}\(", SOURCES.get(file, ""), re.MULTILINE):
                out.append(f"{equation}: {file}::{test} does not exist")
    return out


def test_the_page_of_equations_is_right():
    assert faults(PAGE) == []


def test_a_table_names_no_module_of_the_other_model():
    """Texts that are names of modules, to load them when a scene needs them: no linter sees them."""
    own = {"sam": ("sam.",), "fem_reference": ("fem_reference.", "sam.scene.")}
    known = {path.removesuffix(".py").removesuffix("/__init__").replace("/", ".") for path in SOURCES}
    seen = set()
    for path, text in SOURCES.items():
        package = path.split("/")[0]
        nodes = ast.walk(ast.parse(text)) if package in own and path.endswith(".py") else ()
        texts = {str(node.value) for node in nodes if isinstance(node, ast.Constant)} & known
        assert all(f"{name}.".startswith(own[package]) for name in texts), path
        seen |= texts
    assert len(seen) > 10
