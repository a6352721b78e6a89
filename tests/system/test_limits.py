# SPDX-License-Identifier: MIT
"""Functions have at most 100 lines and modules 800; ruff holds the other limits, of parameters, columns and
branches.
"""

from __future__ import annotations

import ast
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
FUNCTION, MODULE = 100, 800
FILES = [
    path
    for name in ("samfem", "sam", "fem_reference", "verification", "tests")
    for path in (ROOT / name).rglob("*.py")
]


def too_long(source: str) -> list[str]:
    """The functions that are longer than their limit, and the module if it is longer than its own."""
    functions = [
        f"{node.name}: {lines} lines"
        for node in ast.walk(ast.parse(source))
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef)
        if (lines := node.end_lineno - node.lineno + 1) > FUNCTION
    ]
    lines = len(source.splitlines())
    return functions + [f"module: {lines} lines"] * (lines > MODULE)


def test_functions_and_modules_within_their_limits():
    found = {path.relative_to(ROOT).as_posix(): too_long(path.read_text(encoding="utf-8")) for path in FILES}
    assert len(found) > 400
    assert {name: what for name, what in found.items() if what} == {}


@pytest.mark.parametrize("lines, hits", [(FUNCTION, 0), (FUNCTION + 1, 1), (MODULE, 1), (MODULE + 1, 2)])
def test_the_limits(lines, hits):
    assert len(too_long("def f():\n" + "    a = 1\n" * (lines - 1))) == hits
