# SPDX-License-Identifier: MIT
"""The stability matrix: is every extreme right, or an error that says what to change?"""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence

from verification.robustness.matrix.row import Bench, Cell, Expectation, Kind, Refused, Right, Row, judge
from verification.robustness.matrix.rows import TOPICS, all_rows
from verification.runs.models import FEM, FEM_3D, SAM
from verification.suite.cases.case import Case, Context, Outcome, SmallTable
from verification.suite.gates import Measured

MODELS = (SAM, FEM, FEM_3D)
Judged = Mapping[str, Mapping[str, Cell]]  # row -> model -> cell


def run(context: Context) -> Outcome:
    """Judge every cell of the level."""
    rows, bench, judged = all_rows(context.level), Bench(), {}
    for k, row in enumerate(rows):
        context.progress(f"{context.case}: {row.name}", k, len(rows))
        judged[row.name] = {model: judge(row, model, bench) for model in row.expected}
    out = outcome(context.case, rows, judged, context.level)
    out.figures = [_figure(context, judged)]
    return out


def outcome(case: str, rows: Sequence[Row], judged: Judged, level: str = "full") -> Outcome:
    """Gates and tables of the matrix."""
    values = values_of(rows, judged, level)
    counts = Counter(cell.kind for cells in judged.values() for cell in cells.values())
    wrong = [
        (name, model, cell)
        for name, cells in judged.items()
        for model, cell in cells.items()
        if cell.kind is Kind.WRONG
    ]
    seconds = sum(cell.seconds for cells in judged.values() for cell in cells.values())
    return Outcome(
        {f"{case}.{gate}": value for gate, value in values.items()},
        [
            (
                "Matrix",
                f"{len(rows)} extremes, {sum(counts.values())} cells; {seconds:.0f} s of processor time",
            ),
            ("Cells", ", ".join(f"{counts[kind]} {kind.value}" for kind in Kind)),
            (
                "Beforehand",
                "each row says what must become of it in each model, and why; a cell that does otherwise is wrong",
            ),
            ("Always wrong", "another exception, a warning of numpy, a quantity that is not finite"),
        ],
        tables=[matrix_table(rows, judged), right_table(rows, judged), error_table(rows, judged)],
        notes=[f"Wrong: {name}, {model}: {cell.text}" for name, model, cell in wrong],
    )


def values_of(rows: Sequence[Row], judged: Judged, level: str) -> dict[str, Measured]:
    """Gate -> what was counted."""
    cells = [(row.expected[model], judged[row.name].get(model)) for row in rows for model in row.expected]
    topics = set(TOPICS) - {row.topic for row in rows} if level == "full" else set()
    return {
        "wrong": Measured(sum(cell is not None and cell.kind is Kind.WRONG for _, cell in cells), 0),
        "rows": Measured(sum(set(row.expected) == set(judged[row.name]) for row in rows), len(rows)),
        "topics-missing": Measured(len(topics), 0),
        "errors-explained": Measured(sum(not _explained(expected, cell) for expected, cell in cells), 0),
    }


def _explained(expected: Expectation, cell: Cell | None) -> bool:
    """Whether an error cell has its reason, and its message words that tell what to change."""
    if cell is None or cell.kind is not Kind.ERROR:
        return True
    return isinstance(expected, Refused) and bool(expected.reason and expected.says and cell.text)


def matrix_table(rows: Sequence[Row], judged: Judged) -> SmallTable:
    shown = [
        (row.name, row.what, _expected(row), *(_shown(judged[row.name].get(model)) for model in MODELS))
        for row in rows
    ]
    return SmallTable(
        "The matrix", ("row", "what", "expected, and why", "SAM", "FEM, axisymmetric", "FEM, 3D"), shown
    )


def _expected(row: Row) -> str:
    """One text where all models are expected to do the same."""
    words = {model: f"{_verb(expected)}: {expected.reason}" for model, expected in row.expected.items()}
    if len(set(words.values())) == 1:
        return next(iter(words.values()))
    return "; ".join(f"{model} {text}" for model, text in words.items())


def _verb(expected: Expectation) -> str:
    return {Right: "right", Refused: "error"}.get(type(expected), "not applicable")


def _shown(cell: Cell | None) -> str:
    return "" if cell is None else cell.kind.value


def right_table(rows: Sequence[Row], judged: Judged) -> SmallTable:
    """The comparison of each right cell that is nearest to its bound."""
    shown = []
    for row in rows:
        for model, cell in judged[row.name].items():
            worst = cell.worst
            if cell.kind is Kind.RIGHT and worst is not None:
                numbers = f"{worst.error:.2g}", f"{worst.bound:g}", worst.reason
                shown.append((row.name, model, str(len(cell.deviations)), worst.what, *numbers))
    columns = ("row", "model", "comparisons", "nearest to its bound", "error", "bound", "why this bound")
    return SmallTable("Right cells", columns, shown)


def error_table(rows: Sequence[Row], judged: Judged) -> SmallTable:
    """Every error with its text, and why it is right that it is one."""
    shown = [
        (row.name, model, cell.text, row.expected[model].reason)
        for row in rows
        for model, cell in judged[row.name].items()
        if cell.kind is Kind.ERROR
    ]
    return SmallTable("Errors", ("row", "model", "message", "why it is right"), shown)


def _figure(context: Context, judged: Judged):
    from verification.figures.stability import matrix

    kinds = {
        name: {model: cell.kind.value for model, cell in cells.items()} for name, cells in judged.items()
    }
    counts = Counter(kind for cells in kinds.values() for kind in cells.values())
    words = ", ".join(f"{count} {kind}" for kind, count in counts.items())
    return context.save(
        matrix(kinds, [model for model in MODELS if any(model in cells for cells in kinds.values())]),
        "matrix",
        "Extremes and what becomes of them",
        f"A table of coloured cells, a row for each extreme and a column for each model: {words}",
        "r: converged and within its bound; e: an error that says what to change, as expected; grey: not applicable.",
    )


CASES = (
    Case(
        "stability",
        "Stiff and extreme cases",
        "Is the answer to every extreme of the input right, or an error that says what to change?",
        run,
    ),
)
