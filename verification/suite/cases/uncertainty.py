# SPDX-License-Identifier: MIT
"""Whether the uncertainty that samfem gives covers the error, on scenes whose answer is known."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass

from verification.figures.uncertainty import coverage
from verification.suite.cases.case import Case, Context, Measured, Plot, SmallTable
from verification.suite.cases.uncertainty_study import (
    KNOWN,
    Row,
    covered,
    of_program,
    of_textbook,
    over_error,
    rows_of,
    step_rows,
    subjects,
)

RULES: Mapping[str, Callable[[Row], float]] = {
    "formal order, 3 times the larger change": of_program,
    "observed order, factor 1.25": of_textbook,
}
"""Rule for the reader -> uncertainty of a row by it: that of the program, and that of textbooks."""
EQUATIONS = (
    ("uncertainty", "U = 3 max_i |f_1 − f_i| / ((h_i/h_1)^p − 1)", "formal order p; factor 3: Roache (1998)"),
    ("at least", "U ≥ 0.1 |f_1| (h_1/a)², p = 2", "cells of SAM in a contact of radius a: measured"),
    ("textbook", "U = 1.25 |f_1 − f_2| / ((h_2/h_1)^p − 1), p observed", "Roache (1998); ASME V&V 20 (2009)"),
)


@dataclass(frozen=True)
class Found:
    """Rows of all triplets of grids, and of all triplets of load steps."""

    grids: Sequence[Row]
    steps: Sequence[Row] = ()

    @property
    def known(self) -> list[Row]:
        """Those of the grids whose reference is good enough to count."""
        return [row for row in self.grids if row.known]


class Uncertainty(Case):
    """Triplets of grids, and in the study of load steps, against closed forms and finite elements."""

    def solve(self, context: Context) -> Found:
        study = self.levels == ("full",)
        own = subjects(context, study=study)
        grids = [row for subject in own for row in rows_of(context, subject)]
        return Found(grids, list(step_rows(context)) if study else ())

    def measure(self, found: Found) -> dict[str, Measured | float]:
        known = found.known
        values: dict[str, Measured | float] = {
            "covered": covered(known, of_program),
            "over-error": over_error(known, of_program),
            "not-too-wide": over_error(known, of_program),
            "textbook": covered(known, of_textbook),
        }
        if found.steps:
            steps = [row for row in found.steps if row.known]
            values |= {
                "covered-apart": covered([row for row in known if not row.chose], of_program),
                "covered-steps": covered(steps, of_program),
                "triplets": float(len({(row.subject, row.cells) for row in known})),
            }
        return values

    def setup(self, found: Found) -> Iterator[tuple[str, str]]:
        chose = {row.subject: row.chose for row in found.grids}
        yield "The rule was chosen with", "; ".join(name for name, own in chose.items() if own)
        yield "Kept apart", "; ".join(name for name, own in chose.items() if not own)
        left = len(found.grids) - len(found.known)
        words = f"{left} of {len(found.grids)}: their reference is not {KNOWN:g} times better known than U"
        yield "Values that do not count", words

    def tables(self, found: Found) -> Iterator[SmallTable]:
        for by in ("subject", "quantity"):
            yield table(f"Values of triplets of grids, by {by}", by, found.grids)
        if found.steps:
            yield table("Values of triplets of load steps, by subject", "subject", found.steps)

    def figures(self, found: Found) -> Iterator[Plot]:
        panels = {name: points(found.known, rule) for name, rule in RULES.items()}
        yield Plot(
            coverage(panels),
            "coverage",
            "Uncertainty over error",
            "Uncertainty of each value over its error, by two rules; above the line it is covered.",
            "Each point is a quantity on a triplet of grids. Below the line the uncertainty is too small.",
        )


def table(caption: str, by: str, rows: Sequence[Row]) -> SmallTable:
    """How many values there are, count and are covered, by an attribute of the rows."""
    lines = []
    for name in dict.fromkeys(getattr(row, by) for row in rows):
        own = [row for row in rows if getattr(row, by) == name]
        known = [row for row in own if row.known]
        shares = [
            cell
            for rule in RULES.values()
            for cell in (
                (f"{1e2 * covered(known, rule):.1f}", f"{over_error(known, rule):.2g}") if known else "--"
            )
        ]
        lines.append((name, str(len(own)), str(len(known)), *shares))
    heads = ("covered [%]", "U/error", "textbook: covered [%]", "U/error")
    return SmallTable(caption, (by, "values", "that count", *heads), lines)


def points(rows: Sequence[Row], rule: Callable[[Row], float]) -> list[tuple[str, str, float, float]]:
    """What is drawn of a rule."""
    least = 1e-9  # of the value, so that a logarithm can show it
    return [
        (row.subject, row.quantity, *(max(part / abs(row.truth), least) for part in (row.error, rule(row))))
        for row in rows
    ]


CASES = (
    Uncertainty(
        "uncertainty",
        "Uncertainty of a number",
        "Does the uncertainty that samfem gives cover the error?",
        EQUATIONS,
    ),
    Uncertainty(
        "uncertainty-study",
        "Uncertainty: eleven scenes with known answers",
        "How often does it cover the error, on sliding, coated, ellipsoidal and yielding contacts?",
        EQUATIONS,
        levels=("full",),
    ),
)
