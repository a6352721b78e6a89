# SPDX-License-Identifier: MIT
"""The mutants of a module: numbers, comparisons and conditions of its source, which changes some of
them.

Perturbed by a factor 1.001 are, each by itself: every float; every integer that is an operand of +
- * / and meets a float there, which only the run tells (`Number`); every row of a table. Structure,
and left as it is: 0, indices and slices, powers, keys of dictionaries, operands of // and %,
arguments and limits that are integers, integers that only ever meet integers. A named integer, NAME
= 24 in a module or a class, is a count: it grows by 2, as some have to stay even. In functions, <
becomes <= and any other comparison its opposite, by itself; each condition of an if, a while or the
like is negated.
"""

import ast
import operator
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

ARITHMETIC = (np.add, np.subtract, np.multiply)
FACTOR = 1.001
MORE = 2
HOOK = "_perturbed_number_"
"""Begins the names of `Number` in a rewritten module; one underscore: a class changes those with two."""
NEIGHBOUR = {ast.Lt: ast.LtE, ast.LtE: ast.Lt, ast.Gt: ast.GtE, ast.GtE: ast.Gt}
OPPOSITE = {ast.Lt: ast.GtE, ast.LtE: ast.Gt, ast.Eq: ast.NotEq, ast.Is: ast.IsNot, ast.In: ast.NotIn}
OPPOSITE |= {other: one for one, other in OPPOSITE.items()}


@dataclass(frozen=True)
class Mutant:
    """One change. kind: "number", "count", "row", "comparison" or "branch"; function: qualified
    name, "" at the level of the module; ordinal: among those of its kind in the function; text:
    what is changed, or what a comparison becomes; code: file line where the code begins; line: of
    the source.
    """

    module: str
    kind: str
    function: str
    ordinal: int
    text: str
    code: int
    line: str = ""

    @property
    def name(self) -> str:
        return f"{self.module}:{self.function or 'module'}:{self.kind}:{self.ordinal}"

    @property
    def integer(self) -> bool:
        """Whether it is a `Number`, of which the run tells whether it is structure."""
        return self.kind == "number" and self.text.rpartition(" ")[2].lstrip("-").isdigit()

    @property
    def key(self) -> tuple[str, str, str]:
        """What a list of constants calls it."""
        return self.module, self.function, self.text


class Number:
    """An integer that is perturbed where it meets a float, and in true divisions; elsewhere itself."""

    def __init__(self, value: int, factor: float):
        self.value, self.factor, self.met = value, factor, False

    def beside(self, other) -> float | int:
        """What it is in arithmetic with the other operand."""
        kind = getattr(other, "dtype", np.dtype(type(other)) if isinstance(other, float | complex) else None)
        return self.perturbed() if kind is not None and kind.kind in "fc" else self.value

    def perturbed(self) -> float:
        """What it is beside a float: noted."""
        self.met = True
        return self.value * self.factor if self.factor != 1.0 else self.value

    def __array_ufunc__(self, ufunc, method, *inputs, **options):
        """The arithmetic of arrays, in place too; in any other function it is itself."""
        others = [value for value in inputs if value is not self]
        if ufunc is np.true_divide:
            own = self.perturbed()
        else:
            own = self.beside(others[0]) if others and ufunc in ARITHMETIC else self.value
        return getattr(ufunc, method)(*(own if value is self else value for value in inputs), **options)

    def __index__(self):
        return self.value

    def __float__(self):
        return float(self.perturbed())

    def __format__(self, form: str):
        return format(self.value, form)  # in a name

    def __neg__(self):
        return Number(-self.value, self.factor)

    def __hash__(self):
        return hash(self.value)

    def __array__(self, dtype=None, copy=None):
        beside_floats = dtype is not None and np.dtype(dtype).kind in "fc"
        return np.array(self.perturbed() if beside_floats else self.value, dtype)


def _method(operation: Callable, own: Callable, swapped: bool = False) -> Callable:
    """An operator of `Number`; own: (number, other operand) -> what stands for the number."""

    def method(self: Number, other):
        mine = own(self, other)
        return operation(other, mine) if swapped else operation(mine, other)

    return method


for _name, _own in (
    *((name, Number.beside) for name in ("add", "sub", "mul")),
    ("truediv", lambda number, other: number.perturbed()),
    *((name, lambda number, other: number.value) for name in ("pow", "eq", "lt", "gt")),
):
    setattr(Number, f"__{_name}__", _method(getattr(operator, _name), _own))
    setattr(Number, f"__r{_name}__", _method(getattr(operator, _name), _own, swapped=True))


def _conditions(node: ast.AST) -> list[ast.expr]:
    """What decides in an if, a while, an assertion, a conditional expression or a comprehension."""
    return [node.test] if hasattr(node, "test") else getattr(node, "ifs", [])


Found = tuple[Mutant, ast.AST, tuple[int, type] | None]
"""A mutant, its node, and the place of an operator with what it becomes."""


def _found(module: str, source: str, tree: ast.Module) -> list[Found]:
    """The mutants of a module, in the order of the source."""
    lines, ordinals, found = source.splitlines(), Counter(), []

    def add(scopes: tuple, kind: str, text: str, node, *, change: tuple[int, type] | None = None) -> None:
        path = ".".join(name for name, *_ in scopes)
        code = next((first for _, first, function in reversed(scopes) if function), 0)
        if code or change is None:
            line = lines[node.lineno - 1].strip()
            found.append((Mutant(module, kind, path, ordinals[path, kind], text, code, line), node, change))
            ordinals[path, kind] += 1

    def visit(node: ast.AST, above: tuple, scopes: tuple, inside_index: bool) -> None:
        """above: the nodes around; scopes: (name, first line, whether a function) of each around."""
        if isinstance(_unsigned(node), ast.Constant):
            running = any(function for *_, function in scopes)
            if not inside_index and (kind := _kind_of_number(node, above, running)):
                name = "" if running else _assigned(node, above)
                add(scopes, kind, f"{name} = " * bool(name) + ast.unparse(node), node)
            return
        for kind, text, changed, change in _operators(node, above):
            add(scopes, kind, text, changed, change=change)
        for child, scope, index in _parts(node):
            visit(child, (*above, node), (*scopes, *scope), inside_index or index)

    visit(tree, (), (), False)
    return found


def _parts(node: ast.AST) -> Iterator[tuple[ast.AST, tuple, bool]]:
    """(part, its scope as a tuple, whether it is an index) of a node: no keys, decorators, annotations."""
    if isinstance(node, ast.FunctionDef | ast.Lambda | ast.ClassDef):
        arguments = getattr(node, "args", None)  # a class has none
        defaults = [*arguments.defaults, *filter(None, arguments.kw_defaults)] if arguments else []
        yield from ((each, (), False) for each in defaults)  # evaluated where the function is made
        first = min([node.lineno, *(each.lineno for each in getattr(node, "decorator_list", ()))])
        scope = getattr(node, "name", "<lambda>"), first, arguments is not None
        body = node.body if isinstance(node.body, list) else [node.body]
        yield from ((each, (scope,), False) for each in body)
    else:
        index = node.slice if isinstance(node, ast.Subscript) else None
        for child in node.values if isinstance(node, ast.Dict) else ast.iter_child_nodes(node):
            yield child, (), child is index


def _operators(node: ast.AST, above: tuple) -> Iterator[tuple]:
    """(kind, text, node, change) of each comparison in a node, and of each condition that it has."""
    if isinstance(node, ast.Compare):
        negated = len(node.ops) == 1 and node in _conditions(above[-1])
        for place, old in enumerate(map(type, node.ops)):
            left, right = [node.left, *node.comparators][place : place + 2]
            for other in filter(None, (NEIGHBOUR.get(old), None if negated else OPPOSITE[old])):
                yield "comparison", ast.unparse(ast.Compare(left, [other()], [right])), node, (place, other)
    for test in _conditions(node):
        if not isinstance(test, ast.Constant):
            yield "branch", f"not ({ast.unparse(test)})", test, (0, ast.Not)


def _unsigned(node: ast.AST) -> ast.AST:
    """What a minus stands before, or the node."""
    return node.operand if isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub) else node


def _kind_of_number(node: ast.AST, above: tuple, running: bool) -> str:
    """What a number is: "number" or "count", empty for structure. running: whether inside of a function."""
    value, parent = _unsigned(node).value, above[-1]
    if type(value) not in (int, float, complex) or value == 0:
        return ""
    if type(value) is not int:
        return "number"
    if isinstance(parent, ast.BinOp | ast.AugAssign):
        return "number" if isinstance(parent.op, ast.Add | ast.Sub | ast.Mult | ast.Div) else ""
    if running:
        return ""
    if _assigned(node, above):
        return "count"
    return "number" if isinstance(parent, ast.Tuple | ast.List) else ""


def _assigned(node: ast.AST, above: tuple) -> str:
    """The name that a number of a module or a class is assigned to, by itself or in a row of names."""
    row = isinstance(above[-1], ast.Tuple)
    statement = above[-2] if row else above[-1]
    if not isinstance(statement, ast.Assign | ast.AnnAssign):
        return ""
    target = statement.targets[0] if isinstance(statement, ast.Assign) else statement.target
    if not row:
        return ast.unparse(target)
    return ast.unparse(target.elts[above[-1].elts.index(node)]) if isinstance(target, ast.Tuple) else ""


def find(module: str, source: str) -> list[Mutant]:
    """All mutants of a module's source, in the order of the source."""
    return [mutant for mutant, *_ in _found(module, source, ast.parse(source))]


class _Rewriter(ast.NodeTransformer):
    """Puts into a tree what takes the place of nodes; numbers: name in the module -> mutant, `Number`."""

    def __init__(self, wanted: dict[int, list[tuple]], factor: float):
        self.wanted, self.factor = wanted, factor
        self.numbers: dict[str, tuple[Mutant, Number]] = {}

    def visit(self, node):
        changed = self.generic_visit(node)
        for mutant, change in self.wanted.get(id(node), ()):
            if mutant.kind == "comparison":
                changed.ops[change[0]] = change[1]()
            elif mutant.kind == "branch":
                changed = ast.copy_location(ast.UnaryOp(change[1](), changed), node)
            else:
                changed = ast.copy_location(self._number(mutant, ast.literal_eval(node)), node)
        return changed

    def _number(self, mutant: Mutant, value: complex) -> ast.expr:
        if mutant.kind == "count":
            return ast.Constant(value + (MORE if self.factor != 1.0 else 0))
        if not isinstance(value, int):
            return ast.Constant(value * self.factor)
        name = f"{HOOK}{len(self.numbers)}"
        self.numbers[name] = mutant, Number(value, self.factor)
        return ast.Name(name, ast.Load())


def rewritten(
    source: str, mutants: Sequence[Mutant], factor: float = FACTOR
) -> tuple[ast.Module, dict[str, tuple[Mutant, Number]]]:
    """The tree of the source with these changed, and the integers by the names that it needs to run."""
    tree, wanted, chosen = ast.parse(source), {}, set(mutants)
    for mutant, node, change in _found(mutants[0].module, source, tree):
        if mutant in chosen:
            wanted.setdefault(id(node), []).append((mutant, change))
    rewriter = _Rewriter(wanted, factor)
    return ast.fix_missing_locations(rewriter.visit(tree)), rewriter.numbers


def rows(module: str, function: str, table: dict, code: int) -> Iterator[Mutant]:
    """The rows of a table kind -> entry -> rows; function: by whose execution a test is known to read it."""
    places = (
        (f"{kind} {entry} {k}", row)
        for kind, entries in table.items()
        for entry, lines in entries.items()
        for k, row in enumerate(lines if isinstance(lines, list) else lines.items())
    )
    for ordinal, (text, row) in enumerate(places):
        yield Mutant(module, "row", function, ordinal, text, code, str(row))
