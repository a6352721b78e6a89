# SPDX-License-Identifier: MIT
"""What the studies of running-in found of the statements of the paper, from the data of their cases: in both
readings, over the inputs that it leaves open, under other physics, and on finer cells.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from verification.suite.pages.stored import ShownCase, Stored

READINGS, INPUTS, PHYSICS = "running-in", "running-in-sensitivity", "running-in-physics"
FINER = "running-in-cells"
STUDIES = {
    READINGS: "The comparison of both readings",
    INPUTS: "The study over the inputs",
    PHYSICS: "The study over hardening and loading",
}
NOT_RUN = "did not run"
OLDER = "made by an older version and {} to run again"
VERDICTS = HELD, FAILED, OPEN = "held", "failed", "not decided"
FOLLOWS = {
    "bulk: hardly any wear later": "bulk: worn in the first six cycles",
    "curve A: friction below that of bulk": "friction: A and hardening below bulk",
}
"""Statements that say no more than another one does -> that one. The first follows by what is asked of both:
where nine tenths wear in 6 cycles, 15 of the other 19 wear at less than a twentieth of that rate. The second
follows in words only: a difference of 0.001 is asked of it, and of that one a ratio of 0.999.
"""
WORDS = {
    "half and half": "half kinematic hardening",
    "kinematic": "kinematic hardening",
    "alternating": "alternating friction",
    "in place, rough, new in each cycle": "a rough counter-surface, new in each cycle",
    "moves, rough, the same in each pass": "a rough counter-body that moves, the same in each pass",
    "moves, rough, new in each pass": "a rough counter-body that moves, new in each pass",
}
"""Of hardening, friction and counter-body, other than those of the paper -> for the reader."""
MANY = 2  # of what is equal that is named
Physics = tuple[str, ...]
"""What one physics changes of that of the paper."""


@dataclass(frozen=True)
class Judged:
    """What was found of the statements, each by its words; a property is empty where its case did not run."""

    stored: Stored

    def case(self, name: str) -> ShownCase | None:
        """A case, if it ran."""
        return self.stored.ran.get(name)

    def said(self, case: str, key: str) -> Any:
        """Of the data of a case; empty where there is none."""
        ran = self.case(case)
        return (ran.case.get("data", {}) if ran else {}).get(key, {})

    def note(self, case: str, begin: str) -> str:
        """A note of a case; empty without."""
        notes = ran.case["notes"] if (ran := self.case(case)) else ()
        return next((note for note in notes if note.startswith(begin)), "")

    def missing(self, case: str) -> str:
        """Why a study says nothing of the statements."""
        ran, why = self.case(case), NOT_RUN
        if ran:
            older = "data" not in ran.case
            why = f"was {OLDER.format('has')}" if older else "was made without what the statements ask for"
        return f"{STUDIES[case]} (case {case}) {why}."

    @property
    def older(self) -> tuple[ShownCase, ...]:
        """The studies that ran, where none of them did with a version that gives pages its data."""
        ran = tuple(each for name in STUDIES if (each := self.case(name)))
        return () if any("data" in each.case for each in ran) else ran

    @cached_property
    def statements(self) -> dict[str, str]:
        """Words -> figures of the paper, in its order."""
        readings = self.said(READINGS, "statements").values()
        every = (*readings, self.said(INPUTS, "statements"), self.said(PHYSICS, "statements"))
        return {each["statement"]: each["figure"] for each in next(filter(None, every), ())}

    def found(self, case: str) -> dict[str, Sequence[Mapping]]:
        """What was found of each in each reading, or on each size of cells."""
        every = self.said(case, "statements").values()
        return {each[0]["statement"]: each for each in zip(*every, strict=True)}

    @cached_property
    def verdicts(self) -> dict[str, Sequence[Mapping]]:
        """What was found in each reading."""
        return self.found(READINGS)

    @cached_property
    def chances(self) -> dict[str, Mapping]:
        """At how many points each holds, with bounds, and what decides it."""
        return {each["statement"]: each for each in self.said(INPUTS, "statements")}

    @cached_property
    def likely(self) -> list[str]:
        """Those that hold at more than half of the points."""
        return [words for words, each in self.chances.items() if 2 * each["holds"] > each["of"]]

    @property
    def sure(self) -> str:
        """How many of them do by the lower bound, for the reader."""
        count = sum(self.chances[words]["bounds"][0] > 0.5 for words in self.likely)
        return "all" if count == len(self.likely) else str(count)

    @property
    def most_at_a_point(self) -> int:
        """How many hold together at the best of the points; 0 without any."""
        return max((each["hold"] for each in self.said(INPUTS, "best")), default=0)

    @cached_property
    def physics(self) -> dict[Physics, tuple[int, Mapping[str, str]]]:
        """Each physics, the fewest changes first -> how many hold under it together, and each verdict."""
        every, statements = self.said(PHYSICS, "physics"), self.said(PHYSICS, "statements")
        verdicts = {each["statement"]: each["verdicts"] for each in statements}
        found = {
            _changes(each, every[0]): (each["held"], {words: own[k] for words, own in verdicts.items()})
            for k, each in enumerate(every)
        }
        return dict(sorted(found.items(), key=lambda pair: len(pair[0])))

    def under(self, words: str, verdict: str = HELD) -> list[Physics]:
        """Where a statement has a verdict; not decided: it says nothing, or a run is missing."""
        return [each for each, (_, verdicts) in self.physics.items() if verdicts[words] == verdict]


def held(found: Mapping) -> bool:
    """Whether a statement holds by the median of the surfaces."""
    return found["by_median"] == HELD


def counted(statements: Sequence[Mapping]) -> str:
    """`6 held, 8 failed, 3 not decided, of 17; ...` by the median of the surfaces, for the reader."""
    own = [each for each in statements if each["statement"] not in FOLLOWS]
    more = f"; of the {len(own)} independent ones {_count(own)}" if len(own) < len(statements) else ""
    return f"{_count(statements)}, of {len(statements)}{more}"


def in_words(several: Sequence[Physics], join: str) -> str:
    """The first of them for the reader, and how many more there are."""
    parts = (
        (", ".join(each[:-1]), each[-1])
        for each in (each or ("that of the paper",) for each in several[:MANY])
    )
    named = (" and ".join(filter(None, each)) for each in parts)
    return f"{' or '.join(named)}{f' {join} {len(several) - MANY} more' if len(several) > MANY else ''}"


def _count(statements: Iterable[Mapping]) -> str:
    found = Counter(each["by_median"] for each in statements)
    return ", ".join(f"{found[verdict]} {verdict}" for verdict in VERDICTS)


def _changes(physics: Mapping, of_paper: Mapping) -> Physics:
    keys = (key for key in ("hardening", "sign", "counter") if physics[key] != of_paper[key])
    return tuple(WORDS[physics[key]] for key in keys)
