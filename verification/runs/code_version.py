# SPDX-License-Identifier: MIT
"""The version of the code that a stored result depends on: a digest of source files and of the packages below
them.

A commit would not do: it changes with every word of documentation, and not with an edit that is not committed
yet.
"""

import hashlib
from collections.abc import Iterable, Iterator
from functools import lru_cache
from pathlib import Path

from verification.runs.models import FEM, FEM_3D, FEM_LINE, SAM
from verification.runs.provenance import installed

ROOT = Path(__file__).resolve().parents[2]
SUFFIXES = (".py", ".json", ".toml", ".csv", ".gz")
CACHE = "__pycache__"
_RUNS = "verification/runs/models.py", "verification/runs/model_range.py"
_OF_RESULTS = (*_RUNS, "verification/data/model_range.csv")
PLACES = {SAM: ("sam", *_OF_RESULTS)}
PLACES |= dict.fromkeys((FEM, FEM_3D, FEM_LINE), ("fem_reference", "sam/scene", *_OF_RESULTS))
"""Files and folders, below the root, that decide the result of a model."""
PACKAGES: dict[str, tuple[str, ...]] = dict.fromkeys((FEM, FEM_LINE), ("numpy", "scipy", "scikit-fem"))
PACKAGES |= {SAM: ("numpy", "scipy"), FEM_3D: ("numpy", "scipy", "scikit-fem", "pyamg")}
OF_CASES = ("sam", "fem_reference", "verification", "samfem")
NOT_OF_CASES = (*("verification/suite", "verification/scenes"), "verification/runs/code_version.py")
"""What decides the outcome of a verification case, but for what only words it: rows are judged anew from
stored numbers, scenes and case files count by their content, case by case.
"""
CASE_FILES = "verification/cases"
PACKAGES_OF_CASES = (*PACKAGES[FEM_3D], "matplotlib", "meshio", "pydantic", "pyvista", "vtk")


@lru_cache
def code_version(model: str, root: Path = ROOT) -> str:
    """Digest (SHA-256, 64 digits) of the code that decides the result of `model`; read once in a process."""
    return _digest(root, PLACES[model], (), PACKAGES[model])


@lru_cache
def version_of_cases(root: Path = ROOT) -> str:
    """Digest of the code that decides what the verification cases find and draw; read once in a process."""
    return _digest(root, OF_CASES, NOT_OF_CASES, PACKAGES_OF_CASES)


def unchanged(model: str = "") -> bool:
    """Whether the files of a model, or of the cases, are those that were read first."""
    if model:
        return code_version.__wrapped__(model) == code_version(model)
    return version_of_cases.__wrapped__() == version_of_cases()


def _digest(root: Path, places: Iterable[str], without: Iterable[str], packages: Iterable[str]) -> str:
    total = hashlib.sha256()
    left_out = [root / place for place in without]
    for path in sorted({path for place in places for path in _files(root / place)}):
        a_case = path.suffix == ".toml" and path.is_relative_to(root / CASE_FILES)
        if not a_case and not any(path.is_relative_to(place) for place in left_out):
            content = hashlib.sha256(path.read_bytes()).hexdigest()
            total.update(f"{path.relative_to(root).as_posix()}\0{content}\n".encode())
    for package in packages:
        total.update(f"{package} {installed(package) or 'none'}\n".encode())
    return total.hexdigest()


def _files(place: Path) -> Iterator[Path]:
    if place.is_file():
        yield place
        return
    for path in place.rglob("*"):
        if path.suffix in SUFFIXES and CACHE not in path.parts and path.is_file():
            yield path
