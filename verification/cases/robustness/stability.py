# SPDX-License-Identifier: MIT
"""The robustness matrix: whether every extreme is right, or an error that says what to change."""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from verification.cases.case import Context
from verification.robustness.matrix.checks import Bench
from verification.robustness.matrix.rows import ERROR, KINDS, WRONG, Cell, Row, all_rows, judge, topics


def frame(context: Context) -> Iterator[dict[str, Any]]:
    """Every cell of the level, and topics of which there is none."""
    rows, bench, found = all_rows(context.level), Bench(), {}
    for k, row in enumerate(rows):
        context.progress(f"{context.case}: {row.name}", k, len(rows))
        found[row.name] = {model: judge(row, model, bench) for model in row.expected}
    yield from judged(rows, found)
    missing = set(topics()) - {row.topic for row in rows} if context.level == "full" else set()
    yield {"sweep": "Topics", "topics-missing": len(missing)}


def judged(rows: Sequence[Row], found: Mapping[str, Mapping[str, Cell]]) -> Iterator[dict[str, Any]]:
    """A row for each cell, with the comparison of a right one that is closest to its bound, and the message
    of an error; and how many rows have all of their cells. found: name of a row -> model -> cell.
    """
    kinds, seconds = dict.fromkeys(KINDS, 0), 0.0
    for row in rows:
        for model, cell in found[row.name].items():
            kind, reason, *said = row.expected[model]
            kinds[cell.kind] += 1
            seconds += cell.seconds
            of = {"sweep": topics()[row.topic], "model": model, "extreme input": row.what}
            of |= {"expected": kind, "and why": reason, "result": cell.kind, "message": cell.text or None}
            # an error has its reason, and its message was searched for words that tell what to change
            explained = kind == "error" and bool(reason and said[1:] and cell.text)
            of |= {"wrong": int(cell.kind == WRONG), "unexplained": int(cell.kind == ERROR and not explained)}
            if nearest := cell.worst:
                of |= {"comparisons": len(cell.deviations), "closest to its bound": nearest.what}
                of |= {"error": nearest.error, "bound": nearest.bound, "of the bound": nearest.reason}
            yield of
    whole = sum(set(row.expected) == set(found[row.name]) for row in rows)
    counts = {f"cells {kind}": count for kind, count in kinds.items()}
    yield {"sweep": "Cells", "rows": whole, "rows expected": len(rows)} | counts | {"time [s]": seconds}
