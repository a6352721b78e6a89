# SPDX-License-Identifier: MIT
"""The answers of the first page, computed of the results."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from fnmatch import fnmatch

from verification.judging import RowStatus
from verification.runs.store import short
from verification.suite.pages.agreement import BEYOND
from verification.suite.pages.findings import Evidence, Finding
from verification.suite.pages.pairs import Pair, number_in
from verification.suite.pages.question import Question
from verification.suite.pages.questions import QUESTIONS
from verification.suite.pages.stored import ShownCase, Stored
from verification.text.readable import with_time

OPEN, REPORTED = "open", "reported"
BANDS = (0.01, 0.05)
"""Of the picture of all pairs, and of the sentence above it."""


RESULT = "a result"
KINDS = {
    "a cost": (
        *(
            "work-precision.*-1",
            "work-precision.*-0-3",
            "work-precision.*-faster",
            "growth.*",
            "accuracy.over-fixed",
        ),
        *("operator-budget.applications", "peers.*-tamaas", "peers.*-contact-mechanics", "peers.step-*"),
    ),
    "the tests": ("mutation.*",),
}
"""What the gates of some names are about; all others are about a result."""


@dataclass(frozen=True)
class Answer:
    """A row of the index. cost: of the cases behind it and, where they tell, of both models in the worst;
    origin: (date, commit) of each code that they ran with; cases: their names.
    """

    question: Question
    findings: Sequence[Finding]
    status: str
    cost: str
    origin: Sequence[tuple[str, str]]
    cases: Sequence[str]

    @property
    def red(self) -> list[str]:
        """The gates that failed."""
        return [name for each in self.findings for name in each.red]

    @property
    def about(self) -> str:
        """What the failed gates are about, empty without any."""
        return " and ".join(dict.fromkeys(kind_of(name) for name in self.red))


def answers_of(evidence: Evidence) -> list[Answer]:
    """An answer to each question, whether its cases ran or not."""
    return [_answer(question, evidence) for question in QUESTIONS]


def _answer(question: Question, evidence: Evidence) -> Answer:
    findings = [finding for part in question.parts for finding in part.find(evidence)]
    behind = {each.name: each for finding in findings for each in finding.cases}
    cases = behind.values()
    if not question.parts:
        status = OPEN
    elif not findings:
        status = str(RowStatus.NOT_RUN)
    elif not any(each.gated for each in findings):
        status = REPORTED
    else:
        status = str(RowStatus.FAILED if any(each.red for each in findings) else RowStatus.PASSED)
    return Answer(question, findings, status, _cost(findings, cases), origins(cases), list(behind))


def _cost(findings: Sequence[Finding], cases: Iterable[ShownCase]) -> str:
    seconds = [each.case["seconds"] or 0.0 for each in cases]
    said = f"{len(seconds)} case{'s' * (len(seconds) > 1)}, {with_time(sum(seconds))}" if seconds else ""
    for finding in findings:
        if finding.worst and (times := _solutions(finding.worst.case)):
            return f"{times} in {finding.worst.case['title']}; {said}"
    return said


def _solutions(case: Mapping) -> str:
    """The times that both models took, if the case has them in a table."""
    for table in case["tables"]:
        columns = list(table["columns"])
        if {"SAM", "FEM"} <= set(columns):
            for row in table["rows"]:
                times = [number_in(row[columns.index(name)]) for name in ("SAM", "FEM")]
                if "solution [s]" in row and all(time > 0.0 for time in times):
                    return f"SAM {with_time(times[0])}, FEM {with_time(times[1])}"
    return ""


def origins(cases: Iterable[ShownCase]) -> list[tuple[str, str]]:
    """(day, commit) of the codes that some cases ran with, the newest first; of each code its last day."""
    days: dict[str, str] = {}
    for each in cases:
        commit = short(each.commit)
        days[commit] = max(days.get(commit, ""), each.date[:10])
    return sorted(((day, commit) for commit, day in days.items()), reverse=True)


@dataclass(frozen=True)
class Far:
    """Pairs of one quantity whose difference is beyond the wider band, and why, as far as it is known."""

    pairs: Sequence[Pair]
    why: str

    @property
    def quantity(self) -> str:
        """Without its unit."""
        return _bare(self.pairs[0])


def far(pairs: Iterable[Pair]) -> list[Far]:
    """The pairs beyond the wider band, of each quantity and reason together, the farthest first."""
    found: dict[tuple[str, str], list[Pair]] = {}
    for pair in sorted(pairs, key=lambda pair: -abs(pair.error)):
        if abs(pair.error) > BANDS[-1]:
            found.setdefault((_bare(pair), _why(pair)), []).append(pair)
    return [Far(several, why) for (_, why), several in found.items()]


def _bare(pair: Pair) -> str:
    """The quantity without its unit."""
    return re.sub(r" \[[^]]*\]", "", pair.quantity)


def _why(pair: Pair) -> str:
    if pair.gate:
        return f"its gate allows {100 * pair.gate['tolerance']:g} %: {pair.gate['reason']}"
    reasons = (
        why
        for case, quantity, why in BEYOND
        if fnmatch(pair.case.name, case) and pair.quantity.startswith(quantity)
    )
    return f"no gate{next((f'; {why}' for why in reasons), '')}"


def kind_of(gate: str) -> str:
    """What a gate is about: a result, a cost, or the tests."""
    return next((kind for kind, names in KINDS.items() if any(fnmatch(gate, name) for name in names)), RESULT)


def _kinds(stored: Stored) -> str:
    """How many of the failed gates are about what."""
    counts = Counter(kind_of(gate["id"]) for _, gate in stored.red)
    rest = "" if counts[RESULT] else f"none about {RESULT}; "
    said = ", ".join(f"{count} about {kind}" for kind, count in counts.items())
    return f" ({rest}{said})" if counts else ""


def sentence(stored: Stored, pairs: Sequence[Pair]) -> str:
    """What stands above the picture."""
    ran, red = len(stored.gates), len(stored.red)
    text = f"{ran - red} of {ran} gates hold, {red or 'none'} failed{_kinds(stored)}"
    end = f" {stored.further}." if stored.further else ""
    if not pairs:
        return f"{text}.{end}"
    inside = [sum(abs(pair.error) <= band for pair in pairs) for band in BANDS]
    worst = max(pairs, key=lambda pair: abs(pair.error))
    return (
        f"{text}; of {len(pairs)} single values of SAM beside a reference {inside[0]} lie within "
        f"{100 * BANDS[0]:g} %, {inside[1]} within {100 * BANDS[1]:g} %, and the farthest is "
        f"{100 * abs(worst.error):.0f} % off ({worst.quantity.split(' [')[0]}, {worst.case.case['title']}"
        f"{'' if worst.gate else '; it has no gate'}).{end}"
    )
