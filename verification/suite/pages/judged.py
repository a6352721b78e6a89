# SPDX-License-Identifier: MIT
"""What the tables of three cases say of the statements of the paper: in both readings, over the inputs that
it leaves open, and under other physics.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

from verification.suite.pages.statements import STATEMENT
from verification.suite.pages.stored import ShownCase, Stored

READINGS, INPUTS, PHYSICS = "running-in", "running-in-sensitivity", "running-in-physics"
FINER = "running-in-cells"
NOT_RUN = "did not run"
HARDENING = {"I": "isotropic hardening", "H": "half kinematic hardening", "K": "kinematic hardening"}
"""By the letters of the table of physics, the first with the printed inputs."""
COUNTER = {
    "the same plane in place": "a plane",
    "in place, rough, new in each cycle": "a rough counter-surface, new in each cycle",
    "moves, rough, the same in each pass": "a rough counter-body that moves, the same in each pass",
    "moves, rough, new in each pass": "a rough counter-body that moves, new in each pass",
}
"""By the columns of the table of physics."""
HELD, MEDIAN = "held", "by the median"
_SHARE = re.compile(r"([0-9]+) % \(([0-9]+) to ")


@dataclass(frozen=True)
class Verdict:
    """Of a statement on several surfaces. text: for the reader; median, agreed: by the median and by
    agreement.
    """

    text: str = NOT_RUN
    median: str = ""
    agreed: str = ""

    @property
    def held(self) -> bool:
        """By the median of the surfaces."""
        return self.median == HELD


@dataclass(frozen=True)
class Chance:
    """Of a statement over the open inputs. text: for the reader; percent, least: at how many of a hundred
    points it holds, and the lower bound, None where it says nothing; points: at which it holds, `12 of 64`;
    deciders: what changes it by most, with bounds.
    """

    text: str = NOT_RUN
    percent: float | None = None
    least: float | None = None
    points: str = "0"
    deciders: Sequence[str] = ()

    @property
    def possible(self) -> bool:
        """Whether it holds at any point."""
        return not self.points.startswith("0")


@dataclass(frozen=True)
class Physics:
    """One physics, by what it changes of that of the paper."""

    changes: tuple[str, ...]

    @property
    def words(self) -> str:
        """For the reader."""
        *first, last = self.changes or ("that of the paper",)
        return " and ".join(filter(None, (", ".join(first), last)))


@dataclass(frozen=True)
class Judged:
    """What was found of the statements; a property is empty where its case did not run."""

    stored: Stored

    def case(self, name: str) -> ShownCase | None:
        """A case, if it ran."""
        return self.stored.ran.get(name)

    def table(self, case: str, column: str, caption: str = "") -> Mapping:
        """The table of a case with such a column, and such a begin of its caption; empty if there is none."""
        tables = self.stored.ran[case].case["tables"] if case in self.stored.ran else ()
        found = (t for t in tables if column in t["columns"] and t["caption"].startswith(caption))
        return next(found, {})

    def note(self, case: str, begin: str) -> str:
        """A note of a case; empty without."""
        notes = self.stored.ran[case].case["notes"] if case in self.stored.ran else ()
        return next((note for note in notes if note.startswith(begin)), "")

    def setup(self, case: str, name: str) -> str:
        """A line of the set-up of a case; empty without."""
        rows = self.stored.ran[case].case["setup"] if case in self.stored.ran else ()
        return next((value for key, value in rows if key == name), "")

    @cached_property
    def statements(self) -> dict[str, str]:
        """Words of a statement -> figures of the paper, in its order."""
        tables = self._readings, self._chances, self._physics
        rows = next((table["rows"] for table in tables if table), ())
        return {row[1]: row[0] for row in rows if row[0]}

    @cached_property
    def _readings(self) -> Mapping:
        return self.table(READINGS, "by agreement")

    @cached_property
    def _chances(self) -> Mapping:
        return self.table(INPUTS, STATEMENT)

    @cached_property
    def _physics(self) -> Mapping:
        return self.table(PHYSICS, "statement")

    @cached_property
    def asked(self) -> dict[str, str]:
        """Words of a statement -> its measure, and what is asked of it; empty where it was not judged."""
        columns = self._readings.get("columns", ())
        at = [columns.index(name) for name in ("measure", "asked") if name in columns]
        return {row[1]: " ".join(row[k] for k in at) for row in self._readings.get("rows", ())}

    @cached_property
    def verdicts(self) -> dict[str, list[Verdict]]:
        """Words of a statement -> its verdict in each reading."""
        return _verdicts(self._readings)

    @cached_property
    def refuted(self) -> list[str]:
        """Statements that hold on the coarsest cells of the study of them, and on its finest do not."""
        found = _verdicts(self.table(FINER, MEDIAN))
        return [words for words, (first, *_, last) in found.items() if first.held and not last.held]

    @cached_property
    def chances(self) -> dict[str, Chance]:
        """Words of a statement -> its probability."""
        return {row[1]: _chance(row) for row in self._chances.get("rows", ())}

    @property
    def likely(self) -> int:
        """Statements that hold at more than half of the points."""
        return sum((each.percent or 0.0) > 50.0 for each in self.chances.values())

    @property
    def sure(self) -> str:
        """How many of them do by the lower bound, for the reader."""
        count = sum((each.least or 0.0) > 50.0 for each in self.chances.values())
        return "all" if count == self.likely else str(count)

    @property
    def fitted(self) -> Mapping:
        """The table of the points at which most statements hold; empty without."""
        return self.table(INPUTS, "input", "Fitted")

    @property
    def most_at_a_point(self) -> str:
        """How many statements hold together there: of the column `point 4: 12 hold`."""
        return self.fitted["columns"][2].split()[-2]

    @cached_property
    def physics(self) -> dict[Physics, int]:
        """Each physics -> how many statements hold under it together; the fewest changes first."""
        if not self._physics:
            return {}
        counts = (map(int, cell.split(", ")) for cell in self._physics["rows"][-1][2:])
        found = {
            Physics(_changes(letter, column, self._physics["columns"][2])): count
            for column, of in zip(self._physics["columns"][2:], counts, strict=True)
            for letter, count in zip(HARDENING, of, strict=True)
        }
        return dict(sorted(found.items(), key=lambda pair: len(pair[0].changes)))

    @property
    def plain(self) -> int:
        """How many statements hold under the physics of the paper."""
        return next((count for each, count in self.physics.items() if not each.changes), 0)

    @cached_property
    def under(self) -> dict[str, list[Physics]]:
        """Words of a statement -> the physics under which it holds, the fewest changes first."""
        return {row[1]: sorted(self._holding(row), key=_size) for row in self._physics.get("rows", ())[:-1]}

    @cached_property
    def silent(self) -> dict[str, int]:
        """Words of a statement -> number of physics under which it says nothing, or a run is missing."""
        inside = re.compile(r"\(([A-Z]+)\)")
        return {
            row[1]: sum(len(letters) for cell in row[2:] for letters in inside.findall(cell))
            for row in self._physics.get("rows", ())[:-1]
        }

    def _holding(self, row: Sequence[str]) -> Iterator[Physics]:
        columns = self._physics["columns"]
        for column, cell in zip(columns[2:], row[2:], strict=True):
            for letter in cell.partition("(")[0].strip().replace("none", ""):
                yield Physics(_changes(letter, column, columns[2]))


def _verdicts(table: Mapping) -> dict[str, list[Verdict]]:
    starts = [k for k, name in enumerate(table.get("columns", ())) if name == MEDIAN]
    return {row[1]: [_verdict(row[k - 1 : k + 2]) for k in starts] for row in table.get("rows", ())}


def _verdict(cells: Sequence[str]) -> Verdict:
    holds_on, median, agreed = cells
    median = median.partition(" by ")[0]
    return Verdict(f"{median}, {holds_on}", median, agreed)


def _chance(row: Sequence[str]) -> Chance:
    _, _, points, share, *deciders = row
    found = _SHARE.match(share)
    percent, least = (float(found[1]), float(found[2])) if found else (None, None)
    return Chance(share, percent, least, points, [each for each in deciders if each])


def _changes(letter: str, column: str, first: str) -> tuple[str, ...]:
    """What a physics changes of the first column with isotropic hardening. column: `counter-body; sign`."""
    (counter, _, sign), (plain, _, constant) = column.rpartition("; "), first.rpartition("; ")
    found = [HARDENING[letter]] if letter != next(iter(HARDENING)) else []
    if sign != constant:
        found.append(f"{sign} friction")
    if counter != plain:
        found.append(COUNTER[counter])
    return tuple(found)


def _size(physics: Physics) -> int:
    return len(physics.changes)
