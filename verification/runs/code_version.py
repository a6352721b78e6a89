# SPDX-License-Identifier: MIT
"""The version of the code that a stored result depends on: a digest of source files and of the packages below
them.

A commit would not do: it changes with every word of documentation, and not with an edit that is not committed
yet.
"""

from __future__ import annotations

import hashlib
import re
from collections.abc import Iterable, Iterator
from functools import lru_cache
from importlib import metadata
from pathlib import Path

from verification.runs.imports import Sources
from verification.runs.models import FEM, FEM_3D, SAM

ROOT = Path(__file__).resolve().parents[2]
SUFFIXES = (".py", ".json", ".toml", ".csv")
CACHE = "__pycache__"
_OF_RESULTS = (
    "verification/runs/models.py",
    "verification/runs/model_range.py",
    "verification/data/model_range.csv",
)
PLACES = {
    SAM: ("sam", *_OF_RESULTS),
    FEM: ("fem_reference", "sam/scene", *_OF_RESULTS),
    FEM_3D: ("fem_reference", "sam/scene", *_OF_RESULTS),
}
"""Files and folders, below the root, that decide the result of a model."""
PACKAGES = {
    SAM: ("numpy", "scipy"),
    FEM: ("numpy", "scipy", "scikit-fem"),
    FEM_3D: ("numpy", "scipy", "scikit-fem", "pyamg"),
}
SOLVERS = ("sam", "fem_reference")
FRAME = Path("verification/suite/cases/case.py")
"""What all cases come to: it solves with the model that a case names."""
FINITE_ELEMENTS = re.compile(
    rb"\b(FEM|FEM_3D|MODELS|cheapest_reference|fem_reference|fem-axisymmetric|fem-3d)\b"
)
"""Words by which a source file asks for finite elements; a case without any of them solves by SAM alone."""
OF_CASES = (*SOLVERS, "verification", "samfem")
"""What may decide the outcome of a verification case."""
NOT_OF_CASES = (
    *("verification/suite/pages", "verification/suite/records.py", "verification/suite/templates"),
    *("verification/suite/gates", "verification/scenes"),
    *("verification/runs/code_version.py", "verification/runs/imports.py"),
)
"""But for what only words it or says what it needs: gates are judged anew from stored numbers, scenes count
by what a case reads."""
EVERYTHING = Path("verification/suite/verify.py")
"""A case that comes to it runs commands of samfem, and may depend on all of OF_CASES."""
MORE = {
    Path("verification/robustness/mutants/__init__.py"): ("tests",),
    Path("verification/peers/__init__.py"): ("requirements-peers.lock", "requirements-aspher.lock"),
}
"""What decides besides, for a case that comes to a package."""
READ_BY = {Path("verification/data/advice.csv"): Path("verification/cost/advice.py")}
"""Data files that decide only for a case that comes to a module: all others decide for every case."""
PACKAGES_OF_CASES = (*PACKAGES[FEM_3D], "matplotlib", "meshio", "pydantic", "pyvista", "vtk")


@lru_cache
def code_version(model: str, root: Path = ROOT) -> str:
    """Digest (SHA-256, 64 digits) of the code that decides the result of `model`; read once in a process."""
    return _digest(root, PLACES[model], (), PACKAGES[model])


@lru_cache
def version_of_case(module: str, root: Path = ROOT) -> str:
    """Digest of the code that decides what the verification cases in a module find and draw; read once in a
    process.

    That is all of the solvers, or of SAM where none of its own modules names finite elements, and the data
    files, and of the rest the modules that it comes to; of a module that is not below the root, all of it.
    """
    reached = _sources(root).reached(module)
    more = tuple(place for path, places in MORE.items() if path in reached for place in places)
    if not reached or EVERYTHING in reached:
        return _digest(root, (*OF_CASES, *more), NOT_OF_CASES, PACKAGES_OF_CASES)
    data = (path.relative_to(root) for path in _files(root / "verification") if path.suffix != ".py")
    read = (path for path in data if READ_BY.get(path, reached[0]) in reached)
    own = set(reached) - set(_sources(root).reached(".".join(FRAME.with_suffix("").parts)))
    both = any(FINITE_ELEMENTS.search((root / path).read_bytes()) for path in own)
    places = (*(SOLVERS if both else (SAM,)), *map(str, read), *map(str, reached), *more)
    return _digest(root, places, NOT_OF_CASES, PACKAGES_OF_CASES)


@lru_cache
def modules_of_case(module: str, root: Path = ROOT) -> frozenset[str]:
    """The modules of `verification` and `samfem` that version_of_case counts, by name; none: all of them."""
    reached = _sources(root).reached(module)
    parts = (path.parent.parts if path.stem == "__init__" else path.with_suffix("").parts for path in reached)
    return frozenset() if EVERYTHING in reached else frozenset(map(".".join, parts))


def unchanged(*, model: str = "", case: str = "") -> bool:
    """Whether the files of a model, or of the cases in a module, are those that were read first, so that what
    ran is what they say.
    """
    version, name = (code_version, model) if model else (version_of_case, case)
    return version.__wrapped__(name) == version(name)


_sources = lru_cache(Sources)


def _digest(root: Path, places: Iterable[str], without: Iterable[str], packages: Iterable[str]) -> str:
    total = hashlib.sha256()
    left_out = [root / place for place in without]
    for path in sorted({path for place in places for path in _files(root / place)}):
        if not any(path.is_relative_to(place) for place in left_out):
            content = hashlib.sha256(path.read_bytes()).hexdigest()
            total.update(f"{path.relative_to(root).as_posix()}\0{content}\n".encode())
    for package in packages:
        total.update(f"{package} {_installed(package)}\n".encode())
    return total.hexdigest()


def _files(place: Path) -> Iterator[Path]:
    if place.is_file():
        yield place
        return
    for path in place.rglob("*"):
        if path.suffix in SUFFIXES and CACHE not in path.parts and path.is_file():
            yield path


def _installed(package: str) -> str:
    try:
        return metadata.version(package)
    except metadata.PackageNotFoundError:
        return "none"
