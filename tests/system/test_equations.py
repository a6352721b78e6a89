# SPDX-License-Identifier: MIT
"""docs/equations.md against the code: a row for each equation, names that exist, functions that cite it.

Nothing is solved. Names of functions stand in backquotes with their module, names of tests with their file.
"""

import ast
import inspect
import io
import re
import tokenize
from functools import cache, cached_property
from importlib import import_module
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "equations.md").read_text(encoding="utf-8")
NUMBERS = {str(k) for k in range(1, 31)}
WITHOUT_NUMBER = {"D_33": "D_33", "D_31": "D_31", "outside": "outside", "inside": "inside"}
"""Rows of equations that have no number, and the word by which a function cites them."""
NAME = re.compile(r"`((?:sam|verification)\.[\w.]+)`")
TEST = re.compile(r"`tests/([\w/]+\.py)::([\w:]+)`")
CITATION = re.compile(r"Eqs?\.\s+(\d+(?:(?:, | and | to |-)\d+)*)(?![\d.]*\.\d)")


def rows(page: str) -> dict[str, str]:
    """Equation -> its row in the first table."""
    table = page.partition("## Where each equation is")[2].partition("## Misprints")[0]
    lines = [line for line in table.splitlines() if line.startswith("| ") and not line.startswith("| Eq.")]
    return {line.split("|")[1].strip(): line for line in lines}


def found(name: str) -> object:
    """What a dotted name with its module stands for, None if there is none."""
    parts = name.split(".")
    for k in range(len(parts) - 1, 0, -1):
        try:
            thing = import_module(".".join(parts[:k]))
        except ModuleNotFoundError:
            continue
        for part in parts[k:]:
            thing = inspect.getattr_static(thing, part, None)
        return thing
    return None


def texts(thing: object) -> str:
    """Comments and strings of the source of a function, method, property or class."""
    if isinstance(thing, property):
        thing = thing.fget
    if isinstance(thing, cached_property):
        thing = thing.func
    source = inspect.cleandoc("\n" + inspect.getsource(inspect.unwrap(thing)))
    tokens = tokenize.generate_tokens(io.StringIO(source).readline)
    return "\n".join(token.string for token in tokens if token.type in (tokenize.COMMENT, tokenize.STRING))


def cited(text: str) -> set[str]:
    """Numbers in a text: of "Eq. 5", "Eq. 9 and 10", "Eq. 22 to 26"; not "Eq. 3.19" of another source."""
    out = set()
    for match in CITATION.findall(text):
        for part in re.split(", | and ", match):
            ends = [int(end) for end in re.split(" to |-", part)]
            out |= {str(k) for k in range(ends[0], ends[-1] + 1)}
    return out


@cache
def names_in(file: str) -> set[str]:
    """Names of the tests in a file, those of a class as Class::test."""
    path, out = ROOT / "tests" / file, set()
    for node in ast.parse(path.read_text(encoding="utf-8")).body if path.exists() else ():
        if isinstance(node, ast.FunctionDef):
            out.add(node.name)
        if isinstance(node, ast.ClassDef):
            out |= {f"{node.name}::{each.name}" for each in node.body if isinstance(each, ast.FunctionDef)}
    return out


def faults(page: str) -> list[str]:
    """What is wrong with a page."""
    known, out = rows(page), []
    out += [f"{each}: no row" for each in sorted((NUMBERS | set(WITHOUT_NUMBER)) - set(known))]
    for equation, row in known.items():
        names = NAME.findall(row)
        if not names:
            out.append(f"{equation}: no function")
        for name in names:
            thing = found(name)
            if thing is None:
                out.append(f"{equation}: {name} does not exist")
            elif equation not in cited(texts(thing)) and WITHOUT_NUMBER.get(equation, "\0") not in texts(
                thing
            ):
                out.append(f"{equation}: {name} does not cite it")
        tests = TEST.findall(row)
        if not tests:
            out.append(f"{equation}: no test")
        out += [
            f"{equation}: {file}::{test} does not exist" for file, test in tests if test not in names_in(file)
        ]
    return out


def test_the_page_is_right():
    assert faults(PAGE) == []


def test_every_misprint_names_an_equation_of_the_page():
    table = PAGE.partition("## Misprints")[2]
    lines = [line.split("|")[1] for line in table.splitlines() if line.startswith("| ")][1:]
    assert len(lines) > 30
    for cell in lines:
        for equation in re.split(", ", re.sub(r"^\s*above |\bto\b", ", ", cell).strip(" ,")):
            assert equation.strip() in rows(PAGE), cell


@pytest.mark.parametrize(
    ("right", "wrong", "fault"),
    [
        ("`sam.scene.yield_curve.Swift.stress`", "`sam.scene.yield_curve.Swift.strain`", "18: sam.scene"),
        ("`sam.contact.box._Iteration._step`", "`sam.no_such_module.step`", "10: sam.no_such_module"),
        ("`sam.contact.box._Iteration._step`", "`sam.wear.worn_depth`", "10: sam.wear"),
        ("::test_law_of_a_scene`", "::test_law_of_no_scene`", "17: sam/test_film_law.py"),
        ("| 24 |", "| 42 |", "24: no row"),
    ],
)
def test_a_wrong_page_turns_red(right, wrong, fault):
    assert right in PAGE
    assert any(each.startswith(fault) for each in faults(PAGE.replace(right, wrong)))


def test_citations_are_read():
    assert cited("Paper Eq. 9 and 10, and Eq. 22 to 24; Eqs. 12-14.") == {*"9 10 22 23 24 12 13 14".split()}
    assert cited("Johnson (1985), Eq. 3.19; Eq. 4.22-4.24") == set()
