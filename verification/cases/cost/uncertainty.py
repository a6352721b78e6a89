# SPDX-License-Identifier: MIT
"""Whether the uncertainty that samfem gives covers the error, on problems whose answer is known."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass

from verification.cases.case import Case, Context, Measured, Plot, SmallTable
from verification.cases.cost.uncertainty_study import (
    KNOWN,
    Row,
    covered,
    of_program,
    of_textbook,
    over_error,
    rows_of,
    subjects,
)
from verification.figures.uncertainty import coverage

RULES: Mapping[str, Callable[[Row], float]] = {
    "formal order, 3 times the larger change": of_program,
    "observed order, factor 1.25": of_textbook,
}
"""Rule for the reader -> uncertainty of a row by it: that of the program, and that of textbooks."""
LEAST = 3  # values of a quantity with a median of its own
AREA = "contact_area_m2"


@dataclass(frozen=True)
class Found:
    """The rows of all problems."""

    rows: Sequence[Row]

    @property
    def known(self) -> list[Row]:
        """Those whose reference is good enough to count."""
        return [row for row in self.rows if row.known]

    @property
    def medians(self) -> dict[str, float]:
        """Quantity -> median of uncertainty over error."""
        own = {name: [row for row in self.known if row.quantity == name] for name in _names(self.known)}
        return {name: over_error(rows, of_program) for name, rows in own.items() if len(rows) >= LEAST}


def _names(rows: Sequence[Row]) -> list[str]:
    return list(dict.fromkeys(row.quantity for row in rows))


class Uncertainty(Case):
    """Each problem is solved as with --uncertainty, and set against a closed form or finer solves."""

    def solve(self, context: Context) -> Found:
        own = subjects(study=self.levels == ("full",))
        return Found([row for subject in own for row in rows_of(context, subject)])

    def measure(self, found: Found) -> dict[str, Measured | float]:
        medians = found.medians
        values: dict[str, Measured | float] = {
            "covered": covered(found.known, of_program),
            "over-error": min(medians.values()),
            "not-too-wide": max(value for name, value in medians.items() if name != AREA),
            "area-not-too-wide": medians[AREA],
            "textbook": covered(found.known, of_textbook),
        }
        if self.levels == ("full",):
            values["problems"] = float(len({row.subject for row in found.known}))
        return values

    def setup(self, found: Found) -> Iterator[tuple[str, str]]:
        yield "Problems", "; ".join(dict.fromkeys(row.subject for row in found.rows))
        left = len(found.rows) - len(found.known)
        words = f"neither U nor error is {KNOWN:g} times what is unknown of the reference"
        yield "Values that do not count", f"{left} of {len(found.rows)}: {words}"

    def tables(self, found: Found) -> Iterator[SmallTable]:
        for by in ("subject", "quantity"):
            yield table(f"Values, by {by}", by, found.rows)

    def figures(self, found: Found) -> Iterator[Plot]:
        panels = {name: points(found.known, rule) for name, rule in RULES.items()}
        yield Plot(
            coverage(panels),
            "coverage",
            "Uncertainty over error",
            "Uncertainty of each value over its error, by two rules; above the line it is covered.",
            "Each point is a quantity of a problem. Below the line the uncertainty is too small.",
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
    Uncertainty("uncertainty"),
    Uncertainty("uncertainty-study"),
)
