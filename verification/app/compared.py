# SPDX-License-Identifier: MIT
"""A scene solved by SAM and a finite-element model, and judged row by row; nothing is printed or written."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from sam.scene import Problem, Progress, Result, Scene, SceneError, spelling
from verification.app.solving import check
from verification.compare.comparison import compare_scene
from verification.compare.rows import COLUMNS, Comparison, table_rows
from verification.compare.tolerances import Tolerances, tolerances_of
from verification.compare.verdicts import FilmVerdict, change_rows, claim_rows, verdict
from verification.runs import models
from verification.runs.store import Reuse, Store, solve_or_reuse
from verification.text.readable import with_time

if TYPE_CHECKING:
    from pandas import DataFrame

Solved = Callable[[str, Result, Reuse], None]
"""Told of the result of a model as soon as it is there, and whether it is from the store."""


@dataclass(frozen=True)
class Compared:
    """Both results of a scene and the rows that hold one against the other.

    sources: where each result is from; film: of a coated scene, whether its film is negligible; claim: the
    one that decides too, if any.
    """

    scene: Scene
    sam: Result
    fem: Result
    sources: tuple[Reuse, Reuse]
    rows: tuple[Comparison, ...]
    film: FilmVerdict | None = None
    claim: str | None = None

    @property
    def results(self) -> tuple[Result, Result]:
        return self.sam, self.fem

    @property
    def frame(self) -> DataFrame:
        """The rows as compare.csv has them."""
        from pandas import DataFrame

        return DataFrame(table_rows(self.rows), columns=list(COLUMNS))

    @property
    def failed(self) -> tuple[Comparison, ...]:
        """The rows outside of their tolerance."""
        return tuple(row for row in self.rows if not row.passed)

    @property
    def passed(self) -> bool:
        """Whether both models converged and every row held."""
        return not self.failed and all(result.converged for result in self.results)

    @property
    def line(self) -> str:
        """The verdict on one line: how many rows agree, which is closest to its tolerance, and the cost."""
        ended = [f"{each.model} ended with {each.status}; " for each in self.results if not each.converged]
        agree = f"{len(self.rows) - len(self.failed)} of {len(self.rows)} agree"
        times = zip(("SAM", "FEM"), map(seconds, self.results), strict=True)
        cost = ", ".join(f"{name} {with_time(time)}" for name, time in times)
        return f"{''.join(ended)}{agree}{self._closest()}; {cost}"

    def _closest(self) -> str:
        """The row that uses most of its tolerance."""
        used = {row.difference / row.tolerance: row.quantity for row in self.rows if row.difference >= 0}
        return f", closest {used[max(used)]} at {100 * max(used):.0f} % of its tolerance" if used else ""

    def check(self) -> None:
        """Raise AssertionError with every row that does not hold, and every model that did not converge."""
        lines = [
            f"{each.model}: {each.status}: {each.message}" for each in self.results if not each.converged
        ]
        lines += [
            f"{row.quantity}: SAM {row.sam:.6g}, FEM {row.fem:.6g}, {row.metric} {row.difference:.3g}, "
            f"tolerance {row.tolerance:g}"
            for row in self.failed
        ]
        if lines:
            raise AssertionError("\n  ".join([self.line, *lines]))


@dataclass(frozen=True)
class Question:
    """A comparison that can be made: everything that may be wrong with what was asked has been looked at.

    model: of the reference; claim: that is judged too, if any.
    """

    scene: Scene
    model: str
    tolerances: Tolerances = field(default_factory=Tolerances)
    claim: str | None = None

    def answer(
        self, *, store: Store | None = None, progress: Progress | None = None, solved: Solved | None = None
    ) -> Compared:
        """The comparison; results are taken from the store, or solved and kept there."""
        sam, of_sam = self._solve(models.SAM, store, progress, solved)
        fem, of_fem = self._solve(self.model, store, progress, solved)
        rows, film = compare_scene(self.scene, sam, fem), None
        if self.scene.body.coating is not None:
            film = verdict(self.scene, sam, fem)
            rows += change_rows(sam, fem) + (claim_rows(film, sam, fem) if self.claim else [])
        rows = tuple(self.tolerances.judged(rows))
        return Compared(self.scene, sam, fem, (of_sam, of_fem), rows, film, self.claim)

    def _solve(
        self, model: str, store: Store | None, progress: Progress | None, solved: Solved | None
    ) -> tuple[Result, Reuse]:
        def told(stage: str, done: int, total: int) -> None:
            if progress:
                progress(f"{model}: {stage}", done, total)

        result, source = solve_or_reuse(store, self.scene, model, told)
        if solved:
            solved(model, result, source)
        return result, source


def asked(
    scene: Scene,
    *,
    model: str | None = None,
    tolerances: Mapping[str, object] | None = None,
    claim: str | None = None,
    source: str = "scene",
) -> Question:
    """The comparison of a scene, once it is known that it can be made.

    model: None takes the cheapest that can represent the scene; tolerances: name of a row -> number, or text
    such as "2 %", in place of those of the scene; claim: judged too, like that of [compare] in the scene;
    source: names the scene in errors. Raises SceneError or ModelError.
    """
    if claim is not None and scene.body.coating is None:
        raise SceneError(
            [Problem("--claim", spelling(claim), "only for a scene with [body.coating]")], source
        )
    given = tolerances_of(scene, tolerances or {}, source)
    model = model or models.cheapest_reference(scene)
    check(scene, models.SAM, model)
    return Question(scene, model, given, claim or (scene.compare and scene.compare.claim))


def compared(
    scene: Scene,
    *,
    model: str | None = None,
    data: Sequence[object] = (),
    tolerances: Mapping[str, object] | None = None,
    claim: str | None = None,
    store: Store | None = None,
    progress: Progress | None = None,
) -> Compared:
    """A scene solved by both models and compared; see `asked` and `Question.answer`."""
    return asked(scene, model=model, tolerances=tolerances, claim=claim).answer(
        store=store, progress=progress
    )


def seconds(result: Result) -> float:
    """Wall time of a result in s, of its own solve also where it is from the store."""
    return sum(result.cost.get(name) or 0.0 for name in ("setup_s", "solve_s"))
