# SPDX-License-Identifier: MIT
"""What is changed: the modules, which of their mutants are drawn, and the constants that have a reason.

`constants.csv` lists equivalent mutants, whose answer must be the same, and explained ones, of which it is
understood why no fast test kills them.
"""

import csv
import functools
import pkgutil
import zlib
from importlib import import_module
from pathlib import Path

from verification.robustness.mutants.changes import Mutant, find, rows

CORE = {
    "sam": "moving schedule wear",
    "sam.contact": "box convolution normal operators",
    "sam.elastic": "problem",
    "sam.grid": "cells",
    "sam.kernels": "eigenstrain layer_stress patches primitives",
    "sam.layered": "patches",
    "sam.plasticity": "cell_means flow load_step measure paper points spectra state",
    "sam.scene": "body verdict yield_curve",
    "sam.scene.surface": "counter",
    "sam.tribofilm": "law state",
    "fem_reference.axisymmetric": "misfit problem recovery",
    "fem_reference.common": "back_stress contact elasticity hertz layered_force plasticity "
    "quadrilaterals recovery",
    "fem_reference.spatial": "hexahedra problem",
    "verification.uncertainty": "rule",
}
"""The numerical core, package -> modules: every number of it is changed."""
AROUND = (
    *("verification.reference", "verification.compare", "verification.uncertainty"),
    *("verification.rows", "verification.judging", "verification.quantities", "verification.references"),
    "sam.grid.demands",
)
"""Packages and modules of which, as of the comparisons and conditions of the core, PERCENT are drawn."""
PERCENT, SEED = 33, 417
TABLES = {"sam.kernels.patches": "load_table", "sam.kernels.eigenstrain": "eigenstrain_table"}
NUMBERS = ("number", "count", "row")


def core() -> list[str]:
    """The modules of the core."""
    return [f"{package}.{name}" for package, names in CORE.items() for name in names.split()]


def modules() -> list[str]:
    """All modules that are changed."""
    places = {name: getattr(import_module(name), "__path__", None) for name in AROUND}
    single = [name for name, place in places.items() if place is None]
    packages = {name: pkgutil.iter_modules(place) for name, place in places.items() if place is not None}
    inside = [f"{name}.{part.name}" for name, parts in packages.items() for part in parts]
    return list(dict.fromkeys([*core(), *inside, *single]))


def whole(mutant: Mutant) -> bool:
    """Whether it is one of those that are not drawn: a number of the core."""
    return mutant.kind in NUMBERS and mutant.module in core()


def drawn(mutant: Mutant) -> bool:
    """Whether it is asked about: decided by its function's name and its text, wherever they stand."""
    words = f"{SEED} {mutant.function.rpartition('.')[2]} {mutant.kind} {mutant.text}"
    return whole(mutant) or zlib.crc32(words.encode()) % 100 < PERCENT


def mutants_of(module: str) -> list[Mutant]:
    """All mutants of a module, and of the table that it reads."""
    loaded = import_module(module)
    found = find(module, Path(loaded.__file__).read_text(encoding="utf-8"))
    if module in TABLES:
        read = getattr(loaded, TABLES[module]).__wrapped__
        found += rows(module, TABLES[module], read(), read.__code__.co_firstlineno)
    return found


@functools.cache
def constants(which: str) -> dict[tuple[str, str, str], str]:
    """Key of a mutant -> the reason that `constants.csv` gives; which: "equivalent" or "explained"."""
    with Path(__file__).with_name("constants.csv").open(encoding="utf-8", newline="") as lines:
        rows = [row for row in csv.DictReader(lines) if row["list"] == which]
    return {(row["module"], row["function"], row["text"]): row["reason"] for row in rows}
