# SPDX-License-Identifier: MIT
"""The parts of an answer: each looks for one number in what ran, and says it with its worst case."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from fnmatch import fnmatch
from statistics import median
from typing import Protocol

from verification.judging import LIMITS
from verification.suite.pages.costs import BOUND, CASE, TARGET, costs_of
from verification.suite.pages.judged import INPUTS, OLDER, PHYSICS, READINGS, Judged, counted
from verification.suite.pages.pairs import Pair
from verification.suite.pages.stored import RED, ShownCase, Stored
from verification.suite.pages.views import LIMIT_SIGNS
from verification.text.console import number

NORMALISED = " over the larger of "
"""Such an error is no share of the quantity, but of what the refinement leaves."""
UNGATED = "no gate"
SAID = {
    "printed inputs": "with the printed inputs",
    "renewed": "in the second reading (a weakly hardening layer, a counter-surface renewed in each cycle)",
}
"""Readings of the paper -> for the reader."""


@dataclass(frozen=True)
class Evidence:
    """All that answers may look at."""

    stored: Stored
    pairs: Sequence[Pair]

    def gates(self, patterns: Sequence[str]) -> Iterator[tuple[ShownCase, Mapping]]:
        """The gates of these names, of cases that ran."""
        for each in self.stored.ran.values():
            for gate in each.gates:
                if any(fnmatch(gate["id"], pattern) for pattern in patterns):
                    yield each, gate


@dataclass(frozen=True)
class Finding:
    """One number of an answer. value: with its unit; cases: all behind it; worst: the one that the number is
    from, if it is one, and at: which quantity of it; red: gates that failed; gated: whether any gate stands
    behind it; allowed: what the gate of the number allows, or that it has none.
    """

    words: str
    value: str
    cases: tuple[ShownCase, ...]
    worst: ShownCase | None = None
    at: str = ""
    red: tuple[str, ...] = ()
    gated: bool = True
    allowed: str = ""


class Part(Protocol):
    """Looks for one number."""

    def find(self, evidence: Evidence) -> Iterator[Finding]:
        """Nothing where no case ran that has it."""
        ...


@dataclass(frozen=True)
class Largest:
    """The largest relative difference. gates: patterns of their names; rows: (pattern of cases, begin of the
    quantity) of pairs.
    """

    words: str
    gates: tuple[str, ...] = ()
    rows: tuple[tuple[str, str], ...] = ()

    def find(self, evidence: Evidence) -> Iterator[Finding]:
        """The largest of all, how many there are, and within what half of them lie."""
        found = [
            (gate["error"], each, gate["quantity"], gate)
            for each, gate in evidence.gates(self.gates)
            if gate["error"] is not None and NORMALISED not in gate["quantity"]
        ]
        found += [
            (abs(pair.error), pair.case, pair.quantity, pair.gate)
            for pair in evidence.pairs
            if any(fnmatch(pair.case.name, case) and pair.quantity.startswith(q) for case, q in self.rows)
        ]
        if not found:
            return
        error, worst, quantity, by = max(found, key=lambda each: each[0])
        gates = [gate for *_, gate in found if gate]
        red = tuple(gate["id"] for gate in gates if gate["status"] in RED)
        typical = f", {len(found)} comparisons, half of them within {percent(median(e for e, *_ in found))}"
        words = f"{self.words}{typical if len(found) > 1 else ''}"
        cases, allowed = _once(each for _, each, *_ in found), _allowed(by, True) if by else UNGATED
        yield Finding(words, percent(error), cases, worst, quantity, red, bool(gates), allowed)


@dataclass(frozen=True)
class Value:
    """The value of a gate. shown: how, with {} for the number; percent: whether it is one."""

    words: str
    gate: str
    shown: str = "{}"
    percent: bool = False

    def find(self, evidence: Evidence) -> Iterator[Finding]:
        """The number, or its error where it has none."""
        for each, gate in evidence.gates((self.gate,)):
            value = gate["error"] if gate["value"] is None else gate["value"]
            if value is not None:
                text = self.shown.format(percent(value) if self.percent else number(value, 3))
                red = (gate["id"],) if gate["status"] in RED else ()
                bound = gate["metric"] in ("at_most", "at_least")
                allowed = _allowed(gate, self.percent) if bound else ""
                yield Finding(self.words, text, (each,), each, gate["quantity"], red, allowed=allowed)


@dataclass(frozen=True)
class Held:
    """How many of the gates of some cases hold."""

    words: str
    gates: tuple[str, ...]

    def find(self, evidence: Evidence) -> Iterator[Finding]:
        """Held of evaluated."""
        found = list(evidence.gates(self.gates))
        red = tuple(gate["id"] for _, gate in found if gate["status"] in RED)
        if found:
            text = f"{len(found) - len(red)} of {len(found)} gates"
            yield Finding(self.words, text, _once(each for each, _ in found), red=red)


@dataclass(frozen=True)
class Cell:
    """Numbers of a row of a table. case: its name; caption: its begin; row: cells that tell the row; columns:
    of the numbers; shown: how, with {} for each; gate: that holds the first of them, if one does.
    """

    words: str
    case: str
    caption: str
    row: tuple[str, ...]
    columns: tuple[str, ...]
    shown: str = "{}"
    gate: str = ""

    def find(self, evidence: Evidence) -> Iterator[Finding]:
        """The cells as they stand, where there are such."""
        ran = evidence.stored.ran.get(self.case)
        gates = [gate for _, gate in evidence.gates((self.gate,))]
        red = tuple(gate["id"] for gate in gates if gate["status"] in RED)
        allowed = _allowed(gates[0], False) if gates else UNGATED
        for table in ran.case["tables"] if ran else ():
            if table["caption"].startswith(self.caption) and set(self.columns) <= set(table["columns"]):
                at = [table["columns"].index(column) for column in self.columns]
                for cells in (cells for cells in table["rows"] if set(self.row) <= set(cells)):
                    text = self.shown.format(*(_spaced(cells[k]) for k in at))
                    yield Finding(self.words, text, (ran,), ran, "", red, bool(gates), allowed)


@dataclass(frozen=True)
class TimeTo:
    """How many times the processor time of SAM finite elements take to the same error."""

    def find(self, evidence: Evidence) -> Iterator[Finding]:
        """The range over the contacts where both reach it, and where only one does."""
        costs = costs_of(evidence.stored)
        both = sorted((each for each in costs if each.known), key=lambda each: each.ratio)
        bounds = sum(each.known and BOUND in f"{each.sam}{each.fem}" for each in costs)
        if both:
            words = (
                f"the processor time of SAM: finite elements to an error of {TARGET}, in {len(both)} of "
                f"{len(costs)} contacts{f' ({bounds} of them as bounds)' * bool(bounds)}; of the others the "
                "ratio is not known"
            )
            text = f"{both[0].shown} to {both[-1].shown} times"
            yield Finding(words, text, (evidence.stored.ran[CASE],), gated=False)


@dataclass(frozen=True)
class PaperStatements:
    """What holds of the statements of the paper."""

    def find(self, evidence: Evidence) -> Iterator[Finding]:
        """One for each reading of the paper by the median of the surfaces, and for each study that ran."""
        judged, found = Judged(evidence.stored), []
        if cases := judged.older:
            yield Finding(f"from studies that were {OLDER.format('have')}", "No number", cases, gated=False)
        for reading, said in judged.said(READINGS, "statements").items():
            words = f"{SAID.get(reading, reading)}, by the median of the surfaces"
            found.append((READINGS, words, counted(said)))
        every = f"of {len(judged.statements)}"
        if judged.likely:
            words = (
                "hold at more than half of the points of the study over the inputs that the paper leaves "
                f"open, {judged.sure} of them also by the lower bound"
            )
            found.append((INPUTS, words, f"{len(judged.likely)} {every}"))
        if best := judged.most_at_a_point:
            words = "hold together at the best of its points, which is no bound"
            found.append((INPUTS, words, f"{best} {every}"))
        if best := max((count for count, _ in judged.physics.values()), default=0):
            words = (
                f"hold on one surface under the best of {len(judged.physics)} ways to harden and to load it "
                f"({judged.physics[()][0]} on the same surface under the way of the paper)"
            )
            found.append((PHYSICS, words, f"{best} {every}"))
        for name, words, value in found:
            yield Finding(words, value, (evidence.stored.ran[name],), gated=False)


def percent(value: float) -> str:
    """A share to two digits; what is rounding, as such."""
    if abs(value) < 1e-8:
        return "rounding" if value else "0\N{NO-BREAK SPACE}%"
    return f"{float(f'{100 * value:.2g}'):g}\N{NO-BREAK SPACE}%".replace("-", "\N{MINUS SIGN}")


def _spaced(cell: str) -> str:
    """A cell as the other numbers are written: a sign of its own for minus, and a space before per cent."""
    return re.sub(r"(?<=\d) ?%", "\N{NO-BREAK SPACE}%", cell.replace("-", "\N{MINUS SIGN}"))


def _allowed(gate: Mapping, of_percent: bool) -> str:
    """What a gate allows, as its number is shown; empty where that is nothing."""
    tolerance = gate["tolerance"]
    text = percent(tolerance) if of_percent else number(tolerance, 3)
    return f"{LIMIT_SIGNS[LIMITS.get(gate['metric'], '<=')]} {text}" if tolerance else ""


def _once(cases: Iterator[ShownCase]) -> tuple[ShownCase, ...]:
    return tuple({each.name: each for each in cases}.values())
