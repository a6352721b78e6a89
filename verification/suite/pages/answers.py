# SPDX-License-Identifier: MIT
"""The questions of the first page and their answers, by the rows, pairs and cells of `pages.toml`."""

import math
import re
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from fnmatch import fnmatch
from functools import partial
from statistics import median
from typing import Any

from verification.judging import LIMITS, RowStatus
from verification.runs.store import short
from verification.suite.pages.headline import headline_of
from verification.suite.pages.stored import (
    ELSEWHERE,
    LIMIT_SIGNS,
    NAMED,
    PAGES,
    RED,
    ShownCase,
    Stored,
    group_of,
)
from verification.text.console import number
from verification.text.readable import with_time

FEM, EXACT = "finite elements", "closed form or published value"
BANDS = (0.01, 0.05)
"""Of the picture of all pairs, and of the sentence above it."""
OPEN, REPORTED, RESULT, UNGATED = "open", "reported", "a result", "no gate"
FULL, NAMED_ONLY = "full level", "only when named"
UNANSWERED = {FULL: "Not run at the quick level.", NAMED_ONLY: "Its case runs only when named."}
"""Status of an answer without a number -> why it has none."""
ENOUGH = 5  # comparisons to say within what half of them lie
NORMALISED = " over the larger of "
"""Such an error is no share of the quantity, but of what the refinement leaves."""


@dataclass(frozen=True)
class Pair:
    """A value of SAM and its reference, whose ratio counts; gate: that holds it, None without one."""

    case: ShownCase
    quantity: str
    against: str
    predicted: float
    reference: float
    gate: Mapping | None = None

    @property
    def error(self) -> float:
        """Of the ratio from one, with its sign."""
        return self.predicted / self.reference - 1.0

    @property
    def bare(self) -> str:
        """The quantity without its unit."""
        return re.sub(r" \[[^]]*\]", "", self.quantity)

    @property
    def why(self) -> str:
        """Why it is as far off as it is, as far as that is known."""
        if self.gate:
            return f"the gate allows {100 * self.gate['tolerance']:g} %: {self.gate['reason']}"
        why = next((why for *of, why in PAGES["pairs"]["beyond"] if self.is_of([of])), "")
        return f"{UNGATED}; {why}" if why else UNGATED

    def is_of(self, named: Iterable[Sequence[str]]) -> bool:
        """Whether it is of one of some (cases, begin of a quantity)."""
        return any(fnmatch(self.case.name, case) and self.quantity.startswith(begin) for case, begin in named)


def pairs_of(stored: Stored) -> list[Pair]:
    """The pairs of all gates in the metric `relative`, and those that cases hand to the pages, each once."""
    found = []
    for each in stored.ran.values():
        gated = []
        for gate in each.gates:
            words, name = gate["quantity"], gate["id"]
            of_sam = not any(fnmatch(name, pattern) for pattern in PAGES["pairs"]["not_of_sam"])
            alone = "FEM" in words and "SAM" not in words
            if gate["metric"] == "relative" and of_sam and not alone and gate["value"] and gate["expected"]:
                against = FEM if "FEM" in words else EXACT
                gated.append(Pair(each, words, against, gate["value"], gate["expected"], gate))
        known = {round(pair.error, 4) for pair in gated}
        said = each.case.get("data", {}).get("pairs", ())
        beside = (Pair(each, words, FEM, sam, fem) for words, sam, fem in said)
        found += gated + [pair for pair in beside if round(pair.error, 4) not in known]
    return [pair for pair in found if not pair.is_of(PAGES["pairs"]["singular"])]


def far(pairs: Iterable[Pair]) -> list[list[Pair]]:
    """The pairs beyond the wider band, of each quantity and reason together, the farthest first."""
    found: dict[tuple[str, str], list[Pair]] = {}
    for pair in sorted(pairs, key=lambda pair: -abs(pair.error)):
        if abs(pair.error) > BANDS[-1]:
            found.setdefault((pair.bare, pair.why), []).append(pair)
    return list(found.values())


@dataclass(frozen=True)
class Cost:
    """Processor seconds to 1 % of SAM and the fastest finite elements (or None), and whether bounds."""

    sam: tuple[float | None, bool]
    fem: tuple[float | None, bool]

    @property
    def ratio(self) -> float:
        """Of finite elements to SAM; NaN where it is not known."""
        unknown = not self.fem[0] or not self.sam[0] or (self.sam[1] and self.fem[1])
        return math.nan if unknown else self.fem[0] / self.sam[0]

    @property
    def shown(self) -> str:
        """The ratio for the reader, as a bound where a time is one."""
        return f"{'> ' * self.sam[1]}{'< ' * self.fem[1]}{number(self.ratio, 2)}"


def costs_of(stored: Stored) -> list[Cost]:
    """Every contact of the case that measured times, none where it did not run."""
    costs, ran, nothing = [], stored.ran.get("work-precision"), (None, False)
    for _, _, times in ran.case.get("data", {}).get("times", ()) if ran else ():
        fem = [time for name, time in times.items() if name.startswith("FEM") and time[0]]
        costs.append(Cost(times.get("SAM", nothing), min(fem, default=nothing)))
    return costs


@dataclass(frozen=True)
class Evidence:
    """All that answers may look at."""

    stored: Stored
    pairs: Sequence[Pair]

    def gates(self, *patterns: str) -> Iterator[tuple[ShownCase, Mapping]]:
        """The gates of these names, of cases that ran."""
        for each in self.stored.ran.values():
            for gate in each.gates:
                if any(fnmatch(gate["id"], pattern) for pattern in patterns):
                    yield each, gate


@dataclass(frozen=True)
class Finding:
    """One number of an answer. value: with its unit; cases: all behind it; worst: the one that the number is
    from, if it is one; gates: behind it; allowed: what the gate of the number allows, or that it has none;
    deviation: the number, if it is one.
    """

    words: str
    value: str
    cases: tuple[ShownCase, ...]
    worst: ShownCase | None = None
    gates: Sequence[Mapping] = ()
    allowed: str = ""
    deviation: float = 0.0

    @property
    def red(self) -> list[str]:
        """The gates that failed."""
        return [gate["id"] for gate in self.gates if gate["status"] in RED]


def largest(evidence: Evidence, words: str, *of: str) -> Iterator[Finding]:
    """The largest relative difference, of how many, and within what half of them lie if that says more."""
    begins = [each.split(": ", 1) for each in of if ": " in each]
    found = [
        (gate["error"], each, gate)
        for each, gate in evidence.gates(*of)
        if gate["error"] is not None and NORMALISED not in gate["quantity"]
    ]
    found += [(abs(pair.error), pair.case, pair.gate) for pair in evidence.pairs if pair.is_of(begins)]
    if found:
        error, worst, by = max(found, key=lambda each: each[0])
        count, half = len(found), percent(median(e for e, *_ in found))
        within = f", half of them within {half}" if count >= ENOUGH and half != percent(error) else ""
        cases, gates = _once(each for _, each, _ in found), [gate for *_, gate in found if gate]
        allowed = _allowed(by, percent) if by else UNGATED
        text = f"{words} ({count} comparisons{within})" if count > 1 else words
        yield Finding(text, percent(error), cases, worst, gates, allowed, error)


def value(
    evidence: Evidence, words: str, gate: str, *how: str, in_percent: bool = False
) -> Iterator[Finding]:
    """The value of a gate, or its error. how: it and its tolerance are shown, with {} for the number."""
    shown, limit = (*how, *("{}", "")[len(how) :])
    show = percent if in_percent else lambda of: number(of, 3)
    for each, row in evidence.gates(gate):
        found = row["error"] if row["value"] is None else row["value"]
        if found is not None:
            bound = row["metric"] in ("at_most", "at_least")
            allowed = limit.format(show(row["tolerance"])) or (_allowed(row, show) if bound else "")
            yield Finding(words, shown.format(show(found)), (each,), each, [row], allowed)


def spread(evidence: Evidence, words: str, gates: str, shown: str) -> Iterator[Finding]:
    """The least and the largest value of some gates."""
    if found := [(each, row) for each, row in evidence.gates(gates) if row["error"] is not None]:
        errors = [row["error"] for _, row in found]
        ends = dict.fromkeys(number(pick(errors), 3) for pick in (min, max))
        cases = _once(each for each, _ in found)
        yield Finding(words, shown.format(" to ".join(ends)), cases, cases[0], [row for _, row in found])


def held(evidence: Evidence, words: str, *patterns: str) -> Iterator[Finding]:
    """How many of the gates of some cases hold."""
    if found := list(evidence.gates(*patterns)):
        gates = [gate for _, gate in found]
        red = sum(gate["status"] in RED for gate in gates)
        text = f"{len(gates) - red} of {len(gates)} gates hold"
        yield Finding(words, text, _once(each for each, _ in found), gates=gates)


def cell(evidence: Evidence, words: str, case: str, caption: str, *how: Any) -> Iterator[Finding]:
    """Numbers of a row of a table as they stand. caption: its begin; how: cells that tell the row, columns of
    the numbers, how they are shown, with {} for each, and the gate that holds the first, if one does.
    """
    row, columns, shown, *gate = how
    gates = [found for _, found in evidence.gates(*gate)]
    allowed = _allowed(gates[0], lambda of: number(of, 3)) if gates else UNGATED
    ran = evidence.stored.ran.get(case)
    for table in ran.case["tables"] if ran else ():
        if table["caption"].startswith(caption) and set(columns) <= set(table["columns"]):
            at = [table["columns"].index(column) for column in columns]
            for cells in (cells for cells in table["rows"] if set(row) <= set(cells)):
                signed = (re.sub(r"-(?=\d)", "\N{MINUS SIGN}", cells[k]) for k in at)
                spaced = [re.sub(r"(?<=\d) ?%", "\N{NO-BREAK SPACE}%", each) for each in signed]
                yield Finding(words.format(*spaced), shown.format(*spaced), (ran,), ran, gates, allowed)


def times(evidence: Evidence, _: str) -> Iterator[Finding]:
    """How many times the time of SAM finite elements take to the same error, over the contacts."""
    costs = costs_of(evidence.stored)
    if both := sorted((each for each in costs if each.ratio > 0.0), key=lambda each: each.ratio):
        bounds = sum(each.sam[1] or each.fem[1] for each in both)
        words = (
            "the processor time of SAM is needed by the faster FEM model for an error of 1 %, over the "
            f"{len(both)} of {len(costs)} contacts in which both times are known"
            f"{f', {bounds} of them as bounds' * bool(bounds)}"
        )
        ran = (evidence.stored.ran["work-precision"],)
        yield Finding(words, f"{both[0].shown} to {both[-1].shown} times", ran)


def statements(evidence: Evidence, words: str) -> Iterator[Finding]:
    """What holds of the statements of the paper."""
    if headline := headline_of(evidence.stored):
        yield Finding(words, headline.answer, headline.studies)


PARTS: Mapping[str, Callable[..., Iterator[Finding]]] = {
    "largest": largest,
    "held": held,
    "value": value,
    "percent": partial(value, in_percent=True),
    "range": spread,
    "cell": cell,
    "times": times,
    "statements": statements,
}
"""Kind of a part of an answer -> what looks for its number; nothing where no case ran that has it."""


@dataclass(frozen=True)
class Answer:
    """A row of the index. question: of `pages.toml`; origin: (date, commit) of each code; cases: names."""

    question: Mapping
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
    def badge(self) -> str:
        """How many of its gates hold; the status where it has none."""
        gates = {gate["id"] for each in self.findings for gate in each.gates}
        return f"{len(gates) - len(set(self.red))} of {len(gates)} gates" if gates else self.status

    @property
    def about(self) -> str:
        """What the failed gates are about, empty without any."""
        return " and ".join(dict.fromkeys(map(kind_of, self.red)))


def answers_of(evidence: Evidence) -> list[Answer]:
    """An answer to each question, whether its cases ran or not."""
    return [
        _answer({"note": "", "parts": [], "open": False} | question, evidence)
        for question in PAGES["question"]
    ]


def first_numbers(evidence: Evidence) -> list[tuple[str, Finding | None]]:
    """(label, what is found) of the numbers on the first screen, None where no case of the report has it."""
    return [
        (label, next(PARTS[kind](evidence, *part), None)) for label, kind, *part in PAGES["first"]["numbers"]
    ]


def _answer(question: Mapping, evidence: Evidence) -> Answer:
    findings = [each for kind, *part in question["parts"] for each in PARTS[kind](evidence, *part)]
    behind = {each.name: each for finding in findings for each in finding.cases}
    gated = [finding.red for finding in findings if finding.gates]
    waiting = {why for name, _, why in evidence.stored.waiting if group_of(name)["name"] == question["page"]}
    if not question["parts"]:
        status = OPEN
    elif not findings and waiting == {ELSEWHERE[NAMED]}:
        status = NAMED_ONLY
    elif not findings:
        status = FULL if evidence.stored.quick else str(RowStatus.NOT_RUN)
    else:
        status = str(RowStatus.FAILED if any(gated) else RowStatus.PASSED) if gated else REPORTED
    seconds = [each.case["seconds"] or 0.0 for each in behind.values()]
    cost = f"{len(seconds)} case{'s' * (len(seconds) > 1)}, {with_time(sum(seconds))}" if seconds else ""
    return Answer(question, findings, status, cost, origins(behind.values()), list(behind))


def unanswered(status: str) -> str:
    """Why an answer of this status has no number."""
    return UNANSWERED.get(status, "No case of this report answers it.")


def origins(cases: Iterable[ShownCase]) -> list[tuple[str, str]]:
    """(day, commit) of the codes that some cases ran with, the newest first; of each code its last day."""
    days: dict[str, str] = {}
    for each in cases:
        commit = short(each.commit)
        days[commit] = max(days.get(commit, ""), each.date[:10])
    return sorted(((day, commit) for commit, day in days.items()), reverse=True)


def kind_of(gate: str) -> str:
    """What a gate is about: a result, a cost, or the tests."""
    kinds = PAGES["kinds"].items()
    return next((kind for kind, names in kinds if any(fnmatch(gate, name) for name in names)), RESULT)


def of_fields(answers: Iterable[Answer]) -> float:
    """The largest difference of whole fields among the answers, 0 without any."""
    fields = (each.deviation for answer in answers for each in answer.findings if "(L2)" in each.words)
    return max(fields, default=0.0)


def sentence(stored: Stored, pairs: Sequence[Pair], fields: float) -> str:
    """What stands above the picture. fields: as `of_fields` says."""
    ran, counts = len(stored.gates), Counter(kind_of(gate["id"]) for _, gate in stored.red)
    red, rest = counts.total(), "" if counts[RESULT] else f"none about {RESULT}; "
    about = ", ".join(f"{count} about {kind}" for kind, count in counts.items() if count)
    text = f"{ran - red} of {ran} gates hold, {red or 'none'} failed{f' ({rest}{about})' * bool(red)}"
    end = f" {stored.further}." if stored.further else ""
    if not pairs:
        return f"{text}.{end}"
    inside = [sum(abs(pair.error) <= band for pair in pairs) for band in BANDS]
    worst = max(pairs, key=lambda pair: abs(pair.error))
    whole = f" Differences of whole fields (L2) are among the answers, up to {percent(fields)}."
    return (
        f"{text}. Of {len(pairs)} single values with a reference, {inside[0]} agree within "
        f"{100 * BANDS[0]:g} % and {inside[1]} within {100 * BANDS[1]:g} %; the largest deviation is "
        f"{100 * abs(worst.error):.0f} % ({worst.quantity.split(' [')[0]}, {worst.case.case['title']}"
        f"{'' if worst.gate else '; it has no gate'}).{whole * bool(fields)}{end}"
    )


def percent(share_of_one: float) -> str:
    """A share to two digits; what is rounding, as such."""
    if abs(share_of_one) < 1e-8:
        return "rounding" if share_of_one else "0\N{NO-BREAK SPACE}%"
    return f"{float(f'{100 * share_of_one:.2g}'):g}\N{NO-BREAK SPACE}%".replace("-", "\N{MINUS SIGN}")


def _allowed(gate: Mapping, show: Callable[[float], str]) -> str:
    """What a gate allows, as its number is shown; empty where that is nothing."""
    sign = LIMIT_SIGNS[LIMITS.get(gate["metric"], "<=")]
    return f"{sign} {show(gate['tolerance'])}" if gate["tolerance"] else ""


def _once(cases: Iterable[ShownCase]) -> tuple[ShownCase, ...]:
    return tuple({each.name: each for each in cases}.values())
