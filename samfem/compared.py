# SPDX-License-Identifier: MIT
"""A scene solved by SAM and a finite-element model, and judged row by row; nothing is printed or written."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

from sam.scene import Problem, Progress, Result, Scene, SceneError, spelling
from samfem.refusals import Refusals
from samfem.solving import check, named, seconds
from verification.compare.comparison import Tolerances, compare_data, compare_scene, tolerances_of
from verification.compare.own_data import OwnData, read_data
from verification.compare.rows import COLUMNS, table_rows
from verification.compare.verdicts import FilmVerdict, change_rows, claim_rows, verdict
from verification.cost.accuracy import solve as solve_family
from verification.judging import Verdict
from verification.runs import models
from verification.runs.model_range import range_lines
from verification.runs.store import Reuse, Store, solve_or_reuse
from verification.text.readable import with_time

if TYPE_CHECKING:
    from pandas import DataFrame

NOT_COMPARED = "not compared"
"""What stands in a table for a row that data do not have."""
Solved = Callable[[str, Result, Reuse], None]
"""Told of the result of a model as soon as it is there, and whether it is from the store."""


@dataclass(frozen=True)
class Uncertain:
    """A quantity of both models with their numerical uncertainties, all in its unit.

    Where it does not hold, cells, load steps and box do not explain the difference.
    """

    quantity: str
    difference: float
    sam: float
    fem: float

    @property
    def u_num(self) -> float:
        """Of both together: a sum, as neither knows the sign of its error."""
        return self.sam + self.fem

    @property
    def holds(self) -> bool:
        """Whether the difference is no larger than that."""
        return self.difference <= self.u_num


@dataclass(frozen=True)
class Compared:
    """Both results of a scene and the rows that hold one against the other.

    film: of a coated scene, whether its film is negligible; claim: the one that decides too, if any; data,
    beside: data of the user, and the rows that each has, with the data in the place of FEM.
    """

    scene: Scene
    sam: Result
    fem: Result
    rows: tuple[Verdict, ...]
    film: FilmVerdict | None = None
    claim: str | None = None
    data: tuple[OwnData, ...] = ()
    beside: tuple[tuple[Verdict, ...], ...] = ()

    @property
    def results(self) -> tuple[Result, Result]:
        return self.sam, self.fem

    @property
    def solutions(self) -> dict[str, Any]:
        """SAM, FEM and the data, to be drawn."""
        return {"SAM": self.sam, "FEM": self.fem} | {data.name: data for data in self.data}

    @property
    def frame(self) -> DataFrame:
        """The rows as compare.csv has them; of data four columns each, empty where they lack the quantity."""
        from pandas import DataFrame

        table = DataFrame(table_rows(self.rows), columns=list(COLUMNS))
        if self.scene.solver.uncertainty or self.scene.solver.accuracy:
            uncertain = {row.quantity: row for row in self.uncertain}
            both = [uncertain.get(row.quantity) for row in self.rows]
            table["u_num"] = [each and each.u_num for each in both]
            table["within_u_num"] = [str(each.holds) if each else "" for each in both]
        for data, rows in zip(self.data, self.beside, strict=True):
            of_row = {row.quantity: row for row in rows}
            found = [of_row.get(row.quantity) for row in self.rows]
            table[data.name] = [row and row.expected for row in found]
            table[f"{data.name}_difference"] = [row and row.error for row in found]
            table[f"{data.name}_tolerance"] = [row and row.row.tolerance for row in found]
            table[f"{data.name}_passed"] = [str(row.passed) if row else NOT_COMPARED for row in found]
        return table

    @property
    def uncertain(self) -> tuple[Uncertain, ...]:
        """The rows of quantities that have an uncertainty in both models."""
        found = []
        for row in self.rows:
            own = [(each.uncertainty or {}).get(row.quantity, {}).get("u_num") for each in self.results]
            if None not in own and row.value is not None and row.expected is not None:
                found.append(Uncertain(row.quantity, abs(row.value - row.expected), *own))
        return tuple(found)

    @property
    def range_lines(self) -> tuple[str, ...]:
        """By how much the model of both is off, as SAM found it; nothing where no quantity is off by 1 %."""
        return () if self.sam.model_range is None else tuple(range_lines(self.sam.model_range))

    @property
    def failed(self) -> tuple[Verdict, ...]:
        """The rows of both models outside of their tolerance."""
        return tuple(row for row in self.rows if not row.passed)

    @property
    def off(self) -> tuple[tuple[str, Verdict], ...]:
        """Name of the data and row, for each row of data outside of its tolerance."""
        pairs = zip(self.data, self.beside, strict=True)
        return tuple((data.name, row) for data, rows in pairs for row in rows if not row.passed)

    @property
    def passed(self) -> bool:
        """Whether both models converged and every row held, of data too."""
        return not (self.failed or self.off) and all(result.converged for result in self.results)

    @property
    def line(self) -> str:
        """The verdict on one line: how many rows agree, which is closest to its tolerance, and the cost."""
        ended = [f"{each.model} ended with {each.status}; " for each in self.results if not each.converged]
        parts = [agreement(self.rows)]
        for data, rows in zip(self.data, self.beside, strict=True):
            lacks = len(self.rows) - len(rows)
            parts.append(f"{data.name}: {agreement(rows)}" + (f", {lacks} not compared" if lacks else ""))
        if both := self.uncertain:
            beyond = ", ".join(each.quantity for each in both if not each.holds)
            holding = sum(each.holds for each in both)
            words = f"{holding} of {len(both)} within their numerical uncertainties"
            parts.append(words + f", not {beyond}" * bool(beyond))
        times = zip(("SAM", "FEM"), map(seconds, self.results), strict=True)
        parts.append(", ".join(f"{name} {with_time(time)}" for name, time in times))
        return "".join(ended) + "; ".join(parts)


@dataclass(frozen=True)
class Question:
    """A comparison that can be made: everything that may be wrong with what was asked has been looked at.

    model: of the reference; claim: that is judged too, if any; data: of the user, beside both models.
    """

    scene: Scene
    model: str
    tolerances: Tolerances = field(default_factory=Tolerances)
    claim: str | None = None
    data: tuple[OwnData, ...] = ()

    def answer(
        self, *, store: Store | None = None, progress: Progress | None = None, solved: Solved | None = None
    ) -> Compared:
        """The comparison; results are taken from the store, or solved and kept there."""
        sam, fem = (self._solve(model, store, progress, solved) for model in (models.SAM, self.model))
        rows, film = compare_scene(self.scene, sam, fem), None
        if self.scene.body.coating is not None:
            film = verdict(self.scene, sam, fem)
            rows += change_rows(sam, fem) + (claim_rows(film, sam, fem) if self.claim else [])
        beside = []
        for data in self.data:
            between, own = compare_data(self.scene, sam, fem, data)
            rows += [row for row in between if row.quantity not in {each.quantity for each in rows}]
            beside.append(tuple(self.tolerances.judged(own)))
        judged = tuple(self.tolerances.judged(rows))
        return Compared(self.scene, sam, fem, judged, film, self.claim, self.data, tuple(beside))

    def _solve(
        self, model: str, store: Store | None, progress: Progress | None, solved: Solved | None
    ) -> Result:
        sources = []

        def one(scene: Scene, label: str) -> Result:
            told = named(progress, model, label) if progress else None
            result, source = solve_or_reuse(store, scene, model, told)
            sources.append(source)
            return result

        result = solve_family(self.scene, model, one)
        if solved:
            solved(model, result, sources[0])
        return result


def asked(
    scene: Scene,
    *,
    model: str | None = None,
    data: Sequence[str | Path] = (),
    tolerances: Mapping[str, object] | None = None,
    claim: str | None = None,
    source: str = "scene",
    anyway: bool = True,
) -> Question:
    """The comparison of a scene, once it is known that it can be made.

    model: None takes the cheapest that can represent the scene; data: files of the user, see
    `verification.compare.own_data`; tolerances: name of a row -> number, or text such as "2 %", in place of
    those of the scene; claim: judged too, like that of [compare] in the scene; source: names the scene in
    errors; anyway: however long that takes. Raises SceneError, ModelError, or SeveralError with all that is
    wrong.
    """
    refusals, own, given, chosen = Refusals(), list[OwnData](), Tolerances(), ""
    if claim is not None and scene.body.coating is None:
        problem = Problem("--claim", spelling(claim), "only for a scene with [body.coating]")
        refusals.found.append(SceneError([problem], source))
    with refusals.kept():
        given = tolerances_of(scene, tolerances or {}, source)
    with refusals.kept():
        chosen = model or models.cheapest_reference(scene)
        for each in (models.SAM, chosen):
            check(scene, each, anyway=anyway)
    for path in data:
        with refusals.kept():
            own.append(read_data(path, scene))
    names = sorted(each.name for each in own)
    if len(set(names)) < len(names):
        problem = Problem("data", ", ".join(names), "each with a name of its own: rename the files")
        refusals.found.append(SceneError([problem], source))
    refusals.raise_any()
    of_scene = None if scene.compare is None else scene.compare.claim
    return Question(scene, chosen, given, claim or of_scene, tuple(own))


def agreement(rows: Sequence[Verdict]) -> str:
    """How many rows agree, and which uses most of its tolerance."""
    used = {
        row.error / row.row.tolerance: row.quantity
        for row in rows
        if row.error is not None and row.error >= 0
    }
    closest = f", closest {used[max(used)]} at {100 * max(used):.0f} % of its tolerance" if used else ""
    return f"{sum(row.passed for row in rows)} of {len(rows)} agree{closest}"
