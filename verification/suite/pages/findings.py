# SPDX-License-Identifier: MIT
"""The parts of an answer: each looks for one number in what ran, and says it with its worst case."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from fnmatch import fnmatch
from typing import Protocol

from verification.suite.pages.judged import INPUTS, PHYSICS, Judged
from verification.suite.pages.pairs import Pair, number_in
from verification.suite.pages.statements import statements_of
from verification.suite.pages.stored import RED, ShownCase, Stored
from verification.text.console import number

NORMALISED = " over the larger of "
"""Such an error is no share of the quantity, but of what the refinement leaves."""


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
    behind it.
    """

    words: str
    value: str
    cases: tuple[ShownCase, ...]
    worst: ShownCase | None = None
    at: str = ""
    red: tuple[str, ...] = ()
    gated: bool = True


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
        """The largest of all, and how many there are."""
        found = [
            (gate["error"], each, gate["quantity"], gate)
            for each, gate in evidence.gates(self.gates)
            if gate["error"] is not None and NORMALISED not in gate["quantity"]
        ]
        found += [
            (abs(pair.error), pair.case, pair.quantity, None)
            for pair in evidence.pairs
            if any(fnmatch(pair.case.name, case) and pair.quantity.startswith(q) for case, q in self.rows)
        ]
        if not found:
            return
        error, worst, quantity, _ = max(found, key=lambda each: each[0])
        red = tuple(gate["id"] for *_, gate in found if gate and gate["status"] in RED)
        words = f"{self.words}, {len(found)} comparisons" if len(found) > 1 else self.words
        cases = _once(each for _, each, *_ in found)
        yield Finding(words, percent(error), cases, worst, quantity, red, gated=bool(self.gates))


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
                yield Finding(self.words, text, (each,), each, gate["quantity"], red)


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
class TimeTo:
    """Processor time to an error, SAM beside the fastest finite elements. column: of the case's table."""

    case: str
    column: str

    def find(self, evidence: Evidence) -> Iterator[Finding]:
        """A finding for each problem of the table."""
        each = evidence.stored.ran.get(self.case)
        if each is None:
            return
        for table in each.case["tables"]:
            columns = list(table["columns"])
            if columns[:2] == ["problem", "method"] and self.column in columns:
                times: dict[str, dict[str, str]] = {}
                for row in table["rows"]:
                    times.setdefault(row[0], {})[row[1]] = row[columns.index(self.column)].split(" (")[0]
                for problem, of_method in times.items():
                    yield Finding(problem, _beside(of_method), (each,), gated=False)


def _beside(times: Mapping[str, str]) -> str:
    """`SAM 0.2 s, FEM, 3D 3 s`; of the finite elements the fastest."""
    fem = {name: time for name, time in times.items() if name.startswith("FEM")}
    reached = {name: time for name, time in fem.items() if number_in(time.lstrip("< ")) > 0.0}
    best = min(reached, key=lambda name: number_in(reached[name].lstrip("< ")), default=next(iter(fem), ""))
    said = [("SAM", times.get("SAM", "")), *([(best, fem[best])] if best else [])]
    return ", ".join(f"{name} {_seconds(time)}" for name, time in said if time)


def _seconds(time: str) -> str:
    return f"{time} s" if time.lstrip("< ")[:1].isdigit() else time


@dataclass(frozen=True)
class PaperStatements:
    """What holds of the statements of the paper."""

    def find(self, evidence: Evidence) -> Iterator[Finding]:
        """A finding for each reading of the paper and rule of the verdict, and for each study that ran."""
        for table in statements_of(evidence.stored):
            for words, count in table.counts:
                yield Finding(words, count, (table.case,), gated=False)
        judged = Judged(evidence.stored)
        for count, words, name in (
            (judged.chances and judged.likely, "are more likely than not over the inputs left open", INPUTS),
            (judged.fitted and judged.most_at_a_point, "hold together at most at one point of them", INPUTS),
            (max(judged.physics.values(), default=0), "hold together at most under one physics", PHYSICS),
        ):
            if case := judged.case(name) if count else None:
                yield Finding(words, f"{count} of {len(judged.statements)}", (case,), gated=False)


def percent(value: float) -> str:
    """A share to two digits; what is rounding, as such."""
    if abs(value) < 1e-8:
        return "rounding" if value else "0\N{NO-BREAK SPACE}%"
    return f"{float(f'{100 * value:.2g}'):g}\N{NO-BREAK SPACE}%".replace("-", "\N{MINUS SIGN}")


def _once(cases: Iterator[ShownCase]) -> tuple[ShownCase, ...]:
    return tuple({each.name: each for each in cases}.values())
