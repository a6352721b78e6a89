# SPDX-License-Identifier: MIT
"""The numbers of a module: where they stand in its source, and the source with one of them perturbed.

Perturbed by a factor 1.001 are, each by itself: every float; every integer that is an operand of + - * / and
meets a float there, which only the run tells (`Number`); every row of a table. Structure, and left as it is:
0, indices and slices, powers, keys of dictionaries, operands of // and %, arguments and limits that are
integers, integers that only ever meet integers. A named integer, NAME = 24 in a module or a class, is a
count: it grows by 2, as some have to stay even.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

ARITHMETIC = (np.add, np.subtract, np.multiply)
FACTOR = 1.001
MORE = 2
HOOK = "_perturbed_number_"
"""Begins the names under which a rewritten module finds its `Number`; one underscore, as a class changes
names with two."""


@dataclass(frozen=True)
class Mutant:
    """A number or a row. function: qualified name, "" at the level of the module; code: file line where its
    code begins; place: (line, column) in the source, (name of the entry, row) in a table; kind: "number",
    "count" or "row".
    """

    module: str
    kind: str
    function: str
    code: int
    place: tuple
    text: str
    line: str = ""

    @property
    def name(self) -> str:
        return f"{self.module}:{self.place[0]}:{self.place[1]} {self.function or 'module'} {self.text}"

    @property
    def key(self) -> tuple[str, str, str]:
        """What a list of constants calls it: independent of lines."""
        return self.module, self.function, self.text


class Number:
    """An integer that is perturbed where it meets a float, and in each true division; anywhere else it is
    itself.
    """

    def __init__(self, value: int, factor: float):
        self.value, self.factor, self.met = value, factor, False

    def _beside(self, other) -> float | int:
        kind = getattr(other, "dtype", np.dtype(type(other)) if isinstance(other, float | complex) else None)
        return self._perturbed() if kind is not None and kind.kind in "fc" else self.value

    def _perturbed(self) -> float:
        self.met = True
        return self.value * self.factor if self.factor != 1.0 else self.value

    def __array_ufunc__(self, ufunc, method, *inputs, **options):
        """The arithmetic of arrays, in place too; in any other function it is itself."""
        others = [value for value in inputs if value is not self]
        if ufunc is np.true_divide:
            own = self._perturbed()
        else:
            own = self._beside(others[0]) if others and ufunc in ARITHMETIC else self.value
        return getattr(ufunc, method)(*(own if value is self else value for value in inputs), **options)

    def __add__(self, other):
        return self._beside(other) + other

    def __radd__(self, other):
        return other + self._beside(other)

    def __sub__(self, other):
        return self._beside(other) - other

    def __rsub__(self, other):
        return other - self._beside(other)

    def __mul__(self, other):
        return self._beside(other) * other

    def __rmul__(self, other):
        return other * self._beside(other)

    def __truediv__(self, other):
        return self._perturbed() / other

    def __rtruediv__(self, other):
        return other / self._perturbed()

    def __index__(self):
        return self.value

    def __float__(self):
        return float(self._perturbed())

    def __pow__(self, other):
        return self.value**other

    def __rpow__(self, other):
        return other**self.value

    def __neg__(self):
        return Number(-self.value, self.factor)

    def __eq__(self, other):
        return self.value == other

    def __lt__(self, other):
        return self.value < other

    def __gt__(self, other):
        return self.value > other

    def __hash__(self):
        return hash(self.value)

    def __array__(self, dtype=None, copy=None):
        return np.array(
            self._perturbed() if dtype is not None and np.dtype(dtype).kind in "fc" else self.value, dtype
        )


class _Finder(ast.NodeVisitor):
    """Collects the mutants of a module."""

    def __init__(self, module: str, source: str):
        self.module, self.lines = module, source.splitlines()
        self.found: list[Mutant] = []
        self.functions: list[tuple[str, int, bool]] = []  # qualified name, first line, whether a function
        self.parents: list[ast.AST] = []

    def generic_visit(self, node: ast.AST) -> None:
        self.parents.append(node)
        super().generic_visit(node)
        self.parents.pop()

    def _inside(self, node, name: str, function: bool) -> None:
        first = min([node.lineno, *(d.lineno for d in getattr(node, "decorator_list", ()))])
        if function:
            for default in (
                *node.args.defaults,
                *node.args.kw_defaults,
            ):  # evaluated where the function is made
                if default is not None:
                    self.visit(default)
        self.functions.append((name, first, function))
        self.parents.append(node)
        for part in node.body if isinstance(node.body, list) else [node.body]:
            self.visit(part)
        self.parents.pop()
        self.functions.pop()

    def visit_FunctionDef(self, node):
        self._inside(node, node.name, True)

    def visit_Lambda(self, node):
        self._inside(node, "<lambda>", True)

    def visit_ClassDef(self, node):
        self._inside(node, node.name, False)

    def visit_Subscript(self, node):
        self.parents.append(node)
        self.visit(node.value)
        self.parents.pop()

    def visit_Dict(self, node):
        self.parents.append(node)
        for value in node.values:
            self.visit(value)
        self.parents.pop()

    def visit_UnaryOp(self, node):
        if isinstance(node.op, ast.USub) and isinstance(node.operand, ast.Constant):
            self._number(node, node.operand.value)
        else:
            self.generic_visit(node)

    def visit_Constant(self, node):
        self._number(node, node.value)

    def _number(self, node, value) -> None:
        if type(value) not in (int, float, complex) or value == 0:
            return
        running = [function for function in self.functions if function[2]]
        kind = "number"
        if type(value) is int:
            kind = self._kind_of_integer(node, bool(running))
            if not kind:
                return
        text = ast.unparse(node)
        if not running and (name := self._assigned(node)):
            text = f"{name} = {text}"
        path, code = ".".join(name for name, *_ in self.functions), running[-1][1] if running else 0
        where = node.lineno, node.col_offset
        self.found.append(
            Mutant(self.module, kind, path, code, where, text, self.lines[node.lineno - 1].strip())
        )

    def _kind_of_integer(self, node, running: bool) -> str:
        parent = self.parents[-1]
        if isinstance(parent, ast.BinOp | ast.AugAssign):
            return "number" if isinstance(parent.op, ast.Add | ast.Sub | ast.Mult | ast.Div) else ""
        if running:
            return ""
        if self._assigned(node):
            return "count"
        return "number" if isinstance(parent, ast.Tuple | ast.List) else ""

    def _assigned(self, node) -> str:
        """The name that a number of a module or a class is assigned to, by itself or in a row of names."""
        above = self.parents[-2:] if isinstance(self.parents[-1], ast.Tuple) else self.parents[-1:]
        if not isinstance(above[0], ast.Assign | ast.AnnAssign):
            return ""
        targets = above[0].targets if isinstance(above[0], ast.Assign) else [above[0].target]
        if len(above) == 1:
            return ast.unparse(targets[0])
        if isinstance(targets[0], ast.Tuple):
            return ast.unparse(targets[0].elts[above[1].elts.index(node)])
        return ""


def find(module: str, source: str) -> list[Mutant]:
    """All numbers of a module's source, in the order of the source."""
    finder = _Finder(module, source)
    finder.visit(ast.parse(source))
    return finder.found


class _Rewriter(ast.NodeTransformer):
    def __init__(self, wanted: dict[tuple[int, int], Mutant], factor: float):
        self.wanted, self.factor = wanted, factor
        self.numbers: dict[str, Number] = {}

    def visit_UnaryOp(self, node):
        if isinstance(node.operand, ast.Constant) and (node.lineno, node.col_offset) in self.wanted:
            return self._rewritten(node, -node.operand.value)
        return self.generic_visit(node)

    def visit_Constant(self, node):
        return self._rewritten(node, node.value) if (node.lineno, node.col_offset) in self.wanted else node

    def _rewritten(self, node, value):
        mutant = self.wanted[node.lineno, node.col_offset]
        if mutant.kind == "count":
            new = ast.Constant(value + (MORE if self.factor != 1.0 else 0))
        elif isinstance(value, int):
            name = f"{HOOK}{len(self.numbers)}"
            self.numbers[name] = Number(value, self.factor)
            new = ast.Name(name, ast.Load())
        else:
            new = ast.Constant(value * self.factor)
        return ast.copy_location(new, node)


def rewritten(
    source: str, mutants: list[Mutant], factor: float = FACTOR
) -> tuple[ast.Module, dict[str, Number]]:
    """The tree of the source with these numbers perturbed, and the names that it needs to run."""
    rewriter = _Rewriter({mutant.place: mutant for mutant in mutants}, factor)
    return ast.fix_missing_locations(rewriter.visit(ast.parse(source))), rewriter.numbers


def rows(module: str, function: str, table: dict) -> Iterator[Mutant]:
    """The rows of a table kind -> entry -> rows; function: by whose execution a test is known to read it."""
    for kind, entries in table.items():
        for entry, lines in entries.items():
            for k, row in enumerate(lines if isinstance(lines, list) else lines.items()):
                yield Mutant(module, "row", function, 0, (f"{kind} {entry}", k), str(row))
