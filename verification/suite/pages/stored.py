# SPDX-License-Identifier: MIT
"""The results that pages are made of: the cases of a results.json that ran, each with gates and
origin, and the page of each.
"""

import tomllib
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from importlib import resources
from pathlib import PurePosixPath
from typing import Any

from verification.judging import LIMITS, RowStatus
from verification.rows import case_files

PAGES: dict[str, Any] = tomllib.loads(
    resources.files("verification.suite").joinpath("pages", "pages.toml").read_text(encoding="utf-8")
)
OTHER = {
    "name": "other",
    "title": "Further cases",
    "families": [],
    "about": "Cases that stand in no family of the table of gates.",
}
GROUPS: list[dict] = [*PAGES["page"], OTHER]
"""The pages: name of the file, title, families of cases, and what it is about."""
LIMIT_SIGNS = {"<=": "\N{LESS-THAN OR EQUAL TO}", ">=": "\N{GREATER-THAN OR EQUAL TO}", "=": "="}

ASKED, NAMED, WAITS = "asked", "named", "still to run"
ELSEWHERE = {
    "quick": "of the quick level",
    "full": "of the full level",
    NAMED: "run only when named",
    ASKED: "not asked for",
    WAITS: WAITS,
}
"""Why a case did not run that nothing kept from it."""
RED = (RowStatus.FAILED, RowStatus.UNCHECKED)


@dataclass(frozen=True)
class ShownCase:
    """A case that ran. commit, date: of the code and day that solved it; inputs: its scene files."""

    case: Mapping
    gates: Sequence[Mapping]
    commit: str
    date: str
    inputs: Sequence[str]

    @property
    def name(self) -> str:
        """As samfem verify calls it."""
        return self.case["name"]

    @property
    def red(self) -> list[Mapping]:
        """Gates that failed or were not evaluated."""
        return [gate for gate in self.gates if gate["status"] in RED]

    @property
    def failed(self) -> bool:
        """Whether a gate is red, the case broke off, or the results call it failed for another reason."""
        return bool(self.red or self.case["failure"] or self.case["status"] == RowStatus.FAILED)

    @property
    def used(self) -> float:
        """The largest share of a tolerance that a gate uses; 0 where none has such a number."""
        return max((share for gate in self.gates if (share := share_used(gate)) is not None), default=0.0)


@dataclass(frozen=True)
class Stored:
    """All that was found. ran: by name, in the order of the report; waiting: (name, title, why) of the cases
    that did not run; results: as verify writes them; stale: name -> why a case is older than the code.
    """

    ran: Mapping[str, ShownCase]
    waiting: Sequence[tuple[str, str, str]]
    results: Mapping
    stale: Mapping[str, str]

    @property
    def gates(self) -> list[Mapping]:
        """Of all cases that ran."""
        return [gate for each in self.ran.values() for gate in each.gates]

    @property
    def quick(self) -> bool:
        """Whether it holds what the quick level has, so that only cases of the full level are missing."""
        others = {ELSEWHERE[ASKED], WAITS}.intersection(why for *_, why in self.waiting)
        return self.results.get("level") == "quick" and not others

    @property
    def further(self) -> str:
        """How many cases are in the report, and why the others are not; empty where all are."""
        if not self.waiting:
            return ""
        known = (*ELSEWHERE.values(), "")
        whys = Counter(why if why in known else "could not run here" for *_, why in self.waiting)
        said = ", ".join(f"{count} {why or 'did not run'}" for why, count in whys.most_common())
        said = said.replace(ELSEWHERE["full"], f"{ELSEWHERE['full']} (--level full)")
        return f"{len(self.ran)} of the {len(self.ran) + len(self.waiting)} cases ran; the others: {said}"

    @property
    def red(self) -> list[tuple[ShownCase, Mapping]]:
        """Every red gate with its case."""
        return [(each, gate) for each in self.ran.values() for gate in each.red]

    @property
    def broken(self) -> list[ShownCase]:
        """Cases that failed without a red gate."""
        return [each for each in self.ran.values() if each.failed and not each.red]


def group_of(case: str) -> dict:
    """The page of a case."""
    family = case_files()[case].family if case in case_files() else ""
    return next((group for group in GROUPS if family in group["families"]), OTHER)


def page_of(case: str) -> str:
    """The file where a case stands, and the place in it."""
    return f"{group_of(case)['name']}.html#{case}"


def share_used(gate: Mapping) -> float | None:
    """The share of the tolerance that a gate uses, None where it has no such number, or has a share of one,
    which cannot be larger.
    """
    lower = LIMITS.get(gate["metric"]) == ">="
    if not gate["error"] or not gate["tolerance"] or (lower and gate["error"] == 1.0):
        return None
    share = gate["error"] / gate["tolerance"]
    return 1.0 / share if lower else share


def read_stored(results: Mapping, stale: Mapping[str, str] | None = None) -> Stored:
    """The cases of results as verify writes them."""
    ran = [case for case in results["cases"] if case["status"] != RowStatus.NOT_RUN]
    waiting = [case for case in results["cases"] if case["status"] == RowStatus.NOT_RUN]
    return Stored(
        {case["name"]: _shown(case, results) for case in ran},
        [(case["name"], case["title"], case.get("unmet", "")) for case in waiting],
        results,
        stale or {},
    )


def _shown(case: Mapping, results: Mapping) -> ShownCase:
    source, solved = results["provenance"], case.get("reused") or {}
    return ShownCase(
        case,
        [gate for gate in results["gates"] if gate["case"] == case["name"]],
        solved.get("commit") or source["commit"] or "",
        solved.get("created") or source["time_utc"],
        case.get("inputs", _named_alike(case["name"], source["input_sha256"])),
    )


def _named_alike(case: str, inputs: Mapping[str, str]) -> list[str]:
    """The scenes whose names begin that of a case: results of before cases named theirs."""
    return [name for name in inputs if name.endswith(".toml") and case.startswith(PurePosixPath(name).stem)]
