# SPDX-License-Identifier: MIT
"""Which files of `verification` and `samfem` a module comes to: the imports of its source, anywhere in it,
and the modules that it names as text, to load or to run them.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Iterable, Iterator
from functools import cached_property
from pathlib import Path

PACKAGES = ("samfem", "verification")
REGISTRY = Path("verification/suite/cases/__init__.py")
"""It names every case, and a case needs none of the others: what it loads is not followed."""
_MODULE = re.compile(rf"({'|'.join(PACKAGES)})(\.\w+)+\.?")


class Sources:
    """The modules of these packages below `root`, each read at most once."""

    def __init__(self, root: Path):
        self._root = root
        self._found: dict[str, frozenset[str]] = {}

    @cached_property
    def _files(self) -> dict[str, Path]:
        """Name of each module and package -> its file."""
        return {
            ".".join((path.parent if path.name == "__init__.py" else path.with_suffix("")).parts): path
            for path in (
                found.relative_to(self._root)
                for package in PACKAGES
                for found in sorted((self._root / package).rglob("*.py"))
            )
        }

    def reached(self, module: str) -> list[Path]:
        """The file of a module and of all that it comes to, below the root; none if it is not there."""
        found, new = set(), {module} & self._files.keys()
        while new:
            found |= new
            new = {other for name in new for other in self._named(name)} - found
        return sorted(self._files[name] for name in found)

    def _named(self, module: str) -> frozenset[str]:
        """The modules that one loads or may load, with the packages that they are in."""
        if module not in self._found:
            self._found[module] = frozenset(self._read(module))
        return self._found[module]

    def _read(self, module: str) -> Iterator[str]:
        path = self._root / self._files[module]
        package = module if path.name == "__init__.py" else module.rpartition(".")[0]
        parents = module.split(".")
        yield from (".".join(parents[:k]) for k in range(1, len(parents)))
        if self._files[module] == REGISTRY:
            yield f"{module}.case"
            return
        for node in ast.walk(ast.parse(path.read_bytes())):
            if isinstance(node, ast.Import):
                yield from self._known(alias.name for alias in node.names)
            elif isinstance(node, ast.ImportFrom):
                base = ".".join(package.split(".")[: len(package.split(".")) + 1 - node.level])
                source = ".".join(filter(None, (base if node.level else "", node.module)))
                yield from self._known([source, *(f"{source}.{alias.name}" for alias in node.names)])
            elif isinstance(node, ast.Constant) and isinstance(node.value, str):
                yield from self._known(self._in_text(node.value))

    def _in_text(self, text: str) -> Iterator[str]:
        """A name of a module as it stands; one that ends with a dot is that of any module in the package."""
        if _MODULE.fullmatch(text):
            yield text if not text.endswith(".") else text[:-1]
            yield f"{text}.__main__"
            yield from (name for name in self._files if text.endswith(".") and name.startswith(text))

    def _known(self, names: Iterable[str]) -> Iterator[str]:
        """Of these names those of modules here."""
        for name in names:
            if name in self._files:
                yield name
