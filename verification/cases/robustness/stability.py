# SPDX-License-Identifier: MIT
"""The robustness matrix: whether every extreme is right, or an error that says what to change."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from verification.cases.case import FEM, FEM_3D, SAM, Case, Context, Measured, SmallTable
from verification.robustness.matrix.checks import Bench
from verification.robustness.matrix.rows import ERROR, KINDS, RIGHT, WRONG, Cell, Row, all_rows, judge, topics

MODELS = (SAM, FEM, FEM_3D)
CAMPAIGN = "once, by commit a82b4b2: also spheres at 7.5 and 8 yield stresses on chosen grids; none wrong"
Judged = Mapping[str, Mapping[str, Cell]]  # row -> model -> cell


@dataclass(frozen=True)
class Matrix:
    """The rows of a level, and row -> model -> its cell."""

    rows: Sequence[Row]
    judged: Judged
    level: str = "full"

    @property
    def cells(self) -> list[tuple[str, str, Cell]]:
        """(row, model, cell)."""
        return [(name, model, cell) for name, each in self.judged.items() for model, cell in each.items()]


class Stability(Case):
    """Every cell of the level."""

    def solve(self, context: Context) -> Matrix:
        rows, bench, judged = all_rows(context.level), Bench(), {}
        for k, row in enumerate(rows):
            context.progress(f"{self.name}: {row.name}", k, len(rows))
            judged[row.name] = {model: judge(row, model, bench) for model in row.expected}
        return Matrix(rows, judged, context.level)

    def measure(self, found: Matrix) -> dict[str, Measured]:
        rows, judged = found.rows, found.judged
        cells = [(row.expected[model], judged[row.name].get(model)) for row in rows for model in row.expected]
        missing = set(topics()) - {row.topic for row in rows} if found.level == "full" else set()
        return {
            "wrong": Measured(sum(cell is not None and cell.kind == WRONG for _, cell in cells), 0),
            "rows": Measured(sum(set(row.expected) == set(judged[row.name]) for row in rows), len(rows)),
            "topics-missing": Measured(len(missing), 0),
            "errors-explained": Measured(sum(not _explained(expected, cell) for expected, cell in cells), 0),
        }

    def setup(self, found: Matrix) -> Iterator[tuple[str, str]]:
        counts = Counter(cell.kind for *_, cell in found.cells)
        seconds = sum(cell.seconds for *_, cell in found.cells)
        cells = f"{sum(counts.values())} cells; {seconds:.0f} s of processor time"
        yield "Matrix", f"{len(found.rows)} extreme inputs, {cells}"
        yield "Cells", ", ".join(f"{counts[kind]} {kind}" for kind in KINDS)
        wrong = "a cell that deviates from it is wrong"
        yield "Campaign", CAMPAIGN
        yield "Fixed beforehand", f"each row states the expected result in each model and its reason; {wrong}"
        yield "Always wrong", "another exception, a warning of numpy, a quantity that is not finite"

    def tables(self, found: Matrix) -> Iterator[SmallTable]:
        rows = [
            (row.name, row.what, _expected(row), *(cells[m].kind if m in cells else "" for m in MODELS))
            for row in found.rows
            if (cells := found.judged[row.name]) is not None
        ]
        columns = (
            "row",
            "extreme input",
            "expected result and its reason",
            "SAM",
            "FEM, axisymmetric",
            "FEM, 3D",
        )
        yield SmallTable("The matrix", columns, rows)
        what = {row.name: row.what for row in found.rows}
        rows = [
            (what[name], model, str(len(cell.deviations)), w.what, f"{w.error:.2g}", f"{w.bound:g}", w.reason)
            for name, model, cell in found.cells
            if cell.kind == RIGHT and (w := cell.worst)
        ]
        columns = (
            "extreme input",
            "model",
            "comparisons",
            "closest to its bound",
            "error",
            "bound",
            "reason",
        )
        yield SmallTable("Right answers", columns, rows)
        expected = {row.name: row.expected for row in found.rows}
        rows = [
            (what[name], model, cell.text, expected[name][model][1])
            for name, model, cell in found.cells
            if cell.kind == ERROR
        ]
        yield SmallTable("Expected errors", ("extreme input", "model", "message", "reason"), rows)

    def notes(self, found: Matrix) -> list[str]:
        wrong = [each for each in found.cells if each[-1].kind == WRONG]
        return [f"Wrong: {name}, {model}: {cell.text}" for name, model, cell in wrong]


def _explained(expected: Sequence, cell: Cell | None) -> bool:
    """Whether an error cell has its reason, and its message words that tell what to change."""
    if cell is None or cell.kind != ERROR:
        return True
    return expected[0] == "error" and bool(expected[1] and expected[3:] and cell.text)


def _expected(row: Row) -> str:
    """One text where all models are expected to do the same."""
    verbs = {"absent": "not applicable"}
    words = {m: f"{verbs.get(kind, kind)}: {reason}" for m, (kind, reason, *_) in row.expected.items()}
    if len(set(words.values())) == 1:
        return next(iter(words.values()))
    return "; ".join(f"{model} {text}" for model, text in words.items())


CASES = (Stability("stability"),)
