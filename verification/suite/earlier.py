# SPDX-License-Identifier: MIT
"""Cases of an earlier report that stay in a new one: those that do not run again.

A publication in several sittings needs no more than its own report: what is of this code stays, word for word
and byte for byte.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from verification.suite.freshness import ran_in, stale

Record = Mapping[str, Any]


@dataclass(frozen=True)
class Earlier:
    """Cases of results.json by name, and their gates."""

    cases: Mapping[str, Record] = field(default_factory=dict)
    gates: Sequence[Record] = ()

    @property
    def files(self) -> set[str]:
        """Of their figures, relative to the folder of the report."""
        figures = [figure for case in self.cases.values() for figure in case["figures"]]
        return {figure[kind] for figure in figures for kind in ("png", "csv") if figure[kind]}

    @property
    def inputs(self) -> dict[str, str]:
        """Name of each scene and of what it names -> SHA-256."""
        return {name: digest for case in self.cases.values() for name, digest in case["inputs"].items()}

    def among(self, gates: Iterable[Record]) -> list[Record]:
        """Gates of a new report with these in place of those of the same cases, the others of these last."""
        own: dict[str, list[Record]] = {name: [] for name in self.cases}
        for gate in self.gates:
            own[gate["case"]].append(gate)
        found = []
        for gate in gates:
            found += own.pop(gate["case"], []) if gate["case"] in self.cases else [gate]
        return found + [gate for left in own.values() for gate in left]


def earlier(results: Record, known: Iterable[str], wanted: Iterable[str]) -> Earlier:
    """What stays of a report: the cases that are known and not wanted, and of those wanted what came to its
    end with this code.
    """
    again = set(wanted) & set(stale(results))
    cases = {name: case for name, case in ran_in(results).items() if name in set(known) - again}
    return Earlier(cases, [gate for gate in results["gates"] if gate["case"] in cases])
