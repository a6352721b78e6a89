# SPDX-License-Identifier: MIT
"""What a report will take: said before its cases run, and as the time that is left while they do.

`case_costs.csv` has, of each case at each level, the seconds and the processor seconds that it took on one
machine without a store, and the megabytes that it left in the report and in the store; empty: not measured.
"""

import csv
import math
import time
from collections.abc import Mapping, Sequence
from dataclasses import astuple, dataclass, field, fields, replace
from importlib import resources

from verification.cases import Case
from verification.runs.store import Store
from verification.suite.outcomes import is_kept
from verification.text.readable import with_prefix, with_time

PRIOR_S = 30.0
"""As if a case had run so long at the predicted pace: the first cases alone say little of a machine."""
STORED_S = 0.3
"""Of a case that is only read from the store."""


@dataclass(frozen=True)
class Cost:
    """Of a case, or of several; NaN: not known."""

    seconds: float = math.nan
    processor_s: float = math.nan
    report_MB: float = math.nan  # noqa: N815 - a unit
    store_MB: float = math.nan  # noqa: N815 - a unit


def costs_at(level: str) -> dict[str, Cost]:
    """Name of a case -> what it costs at the level, of those that were measured."""
    text = resources.files("verification.suite").joinpath("case_costs.csv").read_text(encoding="utf-8")
    rows = [row for row in csv.DictReader(text.splitlines()) if row["level"] == level]
    return {row["case"]: Cost(*(float(row[each.name] or "nan") for each in fields(Cost))) for row in rows}


@dataclass
class Forecast:
    """Cases run in turn. needs: of each, in order; took: s of those ended; began: when this one did."""

    needs: Mapping[str, Cost]
    stored: int = 0
    took: dict[str, float] = field(default_factory=dict)
    began: float = field(default_factory=time.monotonic)

    def ended(self, name: str) -> None:
        """A case has ended, and the next one begins."""
        now = time.monotonic()
        self.took[name], self.began = now - self.began, now

    @property
    def left(self) -> str:
        """The time that is left, at the pace so far, in words; empty where it is short or not known."""
        predicted = sum(self.needs[name].seconds for name in self.took)
        pace = (PRIOR_S + sum(self.took.values())) / (PRIOR_S + predicted)
        current, *later = (pace * cost.seconds for name, cost in self.needs.items() if name not in self.took)
        seconds = max(current - (time.monotonic() - self.began), 0.0) + sum(later)
        return f", about {with_time(seconds)} left" if seconds >= 1.0 else ""

    @property
    def words(self) -> str:
        """What all cases take."""
        whole = Cost(*map(sum, zip(*map(astuple, self.needs.values()), strict=True)))
        if math.isnan(whole.seconds):
            return "Time and disk: not known."
        text = f"Estimate: {with_time(whole.seconds)} in one process"
        if not math.isnan(whole.store_MB):
            report, store = (with_prefix(1e6 * size, "B", 2) for size in (whole.report_MB, whole.store_MB))
            text += f", {with_time(whole.processor_s)} of processor time; disk: {report} in the report, "
            text += f"{store} in the store"
        of = f"{self.stored} of {len(self.needs)} cases"
        return f"{text}{f'; already in the store: {of}' * bool(self.stored)}."


def forecast(chosen: Sequence[Case], level: str, store: Store | None) -> Forecast:
    """Of these cases; one that the store holds is only read."""
    known, needs, stored = costs_at(level), {}, 0
    for case in chosen:
        cost = known.get(case.name, Cost())
        if store and not case.alone and is_kept(store, case, level):
            cost, stored = replace(cost, seconds=STORED_S, processor_s=STORED_S, store_MB=0.0), stored + 1
        needs[case.name] = cost
    return Forecast(needs, stored)
