# SPDX-License-Identifier: MIT
"""A mutant put into this process: functions get other code, modules and classes other constants."""

import ast
import functools
import gc
import importlib
import sys
from collections.abc import Iterator, Sequence
from enum import Enum
from importlib.util import resolve_name
from pathlib import Path
from types import CodeType, FunctionType, ModuleType

from verification.robustness.mutants.changes import FACTOR, Mutant, Number, rewritten

ROOT = Path(__file__).resolve().parents[3]

OWN = ("samfem", "sam", "fem_reference", "verification", "tests")


def put(mutants: Sequence[Mutant], factor: float = FACTOR) -> dict[Mutant, Number]:
    """Change these of one module in this process; integers record their use, a table's row is one change."""
    forget(mutants[0].module)
    if mutants[0].kind == "row":
        table = getattr(importlib.import_module(mutants[0].module), mutants[0].function)()
        kind, entry, place = mutants[0].text.split(" ")
        rows, k = table[kind][entry], int(place)
        if isinstance(rows, list):
            rows[k] = (*rows[k][:-1], tuple(c * factor for c in rows[k][-1]))
        else:
            term = list(rows)[k]
            rows[term] = tuple(c * factor for c in rows[term])
        return {}
    module = importlib.import_module(mutants[0].module)
    file = module.__file__
    tree, numbers = rewritten(Path(file).read_text(encoding="utf-8"), mutants, factor)
    compiled, names = compile(tree, file, "exec"), {name: number for name, (_, number) in numbers.items()}
    vars(module).update(names)
    if any(mutant.code for mutant in mutants):
        new = {(code.co_qualname, code.co_firstlineno): code for code in _codes(compiled)}
        for function in living(FunctionType):
            old = function.__code__
            if old.co_filename == file and (code := new.get((old.co_qualname, old.co_firstlineno))):
                function.__code__ = code
    if not all(mutant.code for mutant in mutants):
        _transplant(module, compiled, names)
    return dict(numbers.values())


def forget(module: str = "") -> None:
    """Empty what the functions of the solvers, the references and this module remember."""
    for wrapper in living(functools._lru_cache_wrapper):
        home = getattr(wrapper, "__module__", None) or ""
        if home == module or home.startswith(("sam.", "fem_reference.", "verification.reference.")):
            wrapper.cache_clear()


@functools.cache
def living(kind: type) -> list:
    """All objects of this kind, remembered: call it before forking, as looking takes its time."""
    return [thing for thing in gc.get_objects() if isinstance(thing, kind)]


def _codes(code: CodeType) -> Iterator[CodeType]:
    yield code
    for part in code.co_consts:
        if isinstance(part, CodeType):
            yield from _codes(part)


def _transplant(module: ModuleType, compiled: CodeType, numbers: dict[str, Number]) -> None:
    """The constants of the module, run anew, wherever they are known; of its classes, and defaults."""
    anew = ModuleType(module.__name__)
    vars(anew).update({"__file__": module.__file__, "__package__": module.__package__}, **numbers)
    exec(compiled, vars(anew))
    for name, value in list(vars(anew).items()):
        old = vars(module).get(name)
        if name.startswith("__") or isinstance(value, ModuleType) or _same(value, old):
            continue
        if isinstance(value, type):
            _transplant_class(old, value)
            vars(anew)[name] = old  # for the functions in tables
            for thing in gc.get_referrers(value):  # what was made of it is of the class that others know
                if type(thing) is value:
                    object.__setattr__(thing, "__class__", old)
        elif isinstance(value, FunctionType):
            _with_defaults(old, value)
        elif not callable(value) or not hasattr(value, "cache_clear"):
            for other, called in importers(module, name):
                setattr(other, called, value)


def _same(value: object, old: object) -> bool:
    """Whether a constant run anew is what it was: members of an enumeration stay as they are."""
    members = isinstance(value, tuple) and all(isinstance(each, Enum) for each in value)
    return value is old or (members and value == old)


def _with_defaults(old: FunctionType, new: FunctionType) -> None:
    """Give a function the defaults of another, but for members of an enumeration."""
    if new.__defaults__ is not None:
        pairs = zip(new.__defaults__, old.__defaults__, strict=True)
        old.__defaults__ = tuple(was if isinstance(value, Enum) else value for value, was in pairs)
    if new.__kwdefaults__ is not None:
        own = {name: value for name, value in new.__kwdefaults__.items() if not isinstance(value, Enum)}
        old.__kwdefaults__ = old.__kwdefaults__ | own


def importers(module: ModuleType, name: str) -> Iterator[tuple[ModuleType, str]]:
    """The module, and those of the project and its tests that import the name from it; how they call it."""
    yield module, name
    for other in list(sys.modules.values()):
        file = getattr(other, "__file__", None) or ""
        # an environment may lie below the root, too
        own = file.endswith(".py") and any(file.startswith(f"{ROOT}/{part}/") for part in OWN)
        if own and (called := _imported(file, other.__package__ or "").get((module.__name__, name))):
            yield other, called


@functools.cache
def _imported(file: str, package: str) -> dict[tuple[str, str], str]:
    tree = ast.parse(Path(file).read_text(encoding="utf-8"))
    nodes = [node for node in ast.walk(tree) if isinstance(node, ast.ImportFrom) and node.module]
    return {
        (resolve_name("." * node.level + node.module, package), alias.name): alias.asname or alias.name
        for node in nodes
        for alias in node.names
    }


def _transplant_class(old: type, new: type) -> None:
    for name, value in vars(new).items():
        known = vars(old).get(name)
        if isinstance(value, FunctionType) and isinstance(known, FunctionType):
            _with_defaults(known, value)
        elif not name.startswith("__") and isinstance(value, int | float | tuple):
            setattr(old, name, value)
