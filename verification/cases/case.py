# SPDX-License-Identifier: MIT
"""What a verification case is, what it may use, and what it hands back."""

from __future__ import annotations

import traceback
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from importlib import resources
from pathlib import Path
from typing import TYPE_CHECKING, Any

from sam.scene import Progress, Result, Scene, printable, read_scene
from verification.figures import space
from verification.judging import Measured as Measured
from verification.rows import LEVELS as LEVELS, CaseFile
from verification.runs.files import plain, write_atomically, write_run
from verification.runs.models import FEM as FEM, FEM_3D as FEM_3D, FEM_LINE as FEM_LINE, SAM as SAM
from verification.runs.provenance import collect, without_places
from verification.runs.store import Reuse, Store, solve_or_reuse
from verification.scenes import with_keys as with_keys
from verification.text.console import number as number

if TYPE_CHECKING:  # loaded only where something is drawn or tabulated
    from pandas import DataFrame

    from verification.figures.style import Drawing
else:
    DataFrame = Drawing = Any


@dataclass(frozen=True)
class Plot:
    """A drawing that a case asks for. name: of its files, led by that of the case."""

    drawing: Drawing
    name: str
    title: str
    caption: str


@dataclass(frozen=True)
class View:
    """A picture in space that a case asks for. run: label of the run that it shows; picture: which one, see
    `verification.figures.space`; name: of its file, led by that of the case.
    """

    run: str
    picture: str
    name: str
    title: str
    caption: str


@dataclass(frozen=True)
class Figure:
    """A drawn figure; paths relative to the report's folder, a picture in space has no csv. alt: what stands
    in place of the picture; the caption describes it. findings: what cannot be read in it, see
    `verification.figures.check`: the case has failed then.
    """

    title: str
    alt: str
    caption: str
    png: str
    csv: str = ""
    findings: tuple[str, ...] = ()

    @property
    def files(self) -> tuple[str, ...]:
        """The paths that there are."""
        return tuple(filter(None, (self.png, self.csv)))


@dataclass(frozen=True)
class SmallTable:
    """Rows for the page, as text."""

    caption: str
    columns: Sequence[str]
    rows: Sequence[Sequence[str]]


@dataclass
class Outcome:
    """Of a case. values: gate id -> value; setup: (name, number with unit); data: for the pages, as JSON."""

    values: dict[str, Measured] = field(default_factory=dict)
    setup: list[tuple[str, str]] = field(default_factory=list)
    figures: list[Figure] = field(default_factory=list)
    tables: list[SmallTable] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)
    data: dict[str, Any] = field(default_factory=dict)


class NotDrawnError(Exception):
    """A figure could not be drawn. outcome: all that was found, with a finding in place of the figure."""

    def __init__(self, outcome: Outcome, why: str):
        super().__init__(why)
        self.outcome = outcome


@dataclass(frozen=True)
class Case:
    """A verification case: one question, and the parts of its answer.

    A new case is a subclass that defines `solve` and `measure`, and what else it has to show. Each part gets
    what `solve` returned; the harness, `run`, calls them, prefixes the ids of the gates and saves the
    figures.

    equations: (what, formula, source) as used for the independent answer; levels: at which of LEVELS it runs,
    none: only when it is named; file: that says so; needs: why it cannot run here and what to do, empty if it
    can; alone: whether it measures times, so that nothing runs beside it and a later run measures again.
    """

    name: str
    title: str = ""
    question: str = ""
    equations: Sequence[tuple[str, str, str]] = ()
    levels: Sequence[str] = LEVELS
    needs: Callable[[], str] = str
    alone: bool = False
    file: CaseFile | None = None

    def published_at(self, level: str) -> bool:
        """Whether it belongs to what is published: those that otherwise run only when named do too."""
        return level in self.levels or not self.levels

    def solve(self, context: Context) -> Any:
        """Everything that the parts below look at."""
        raise NotImplementedError(self.name)

    def ahead(self, context: Context) -> Iterable[Scene]:
        """Scenes that SAM may solve beforehand, by several processes; `solve` takes them from the store."""
        return ()

    def measure(self, found: Any) -> Mapping[str, Measured | float]:
        """Row id without the name of the case -> value; a number stands for one that expects nothing."""
        raise NotImplementedError(self.name)

    def setup(self, found: Any) -> Iterable[tuple[str, str]]:
        """The numbers of the case for the reader."""
        return self.file.setting if self.file else ()

    def tables(self, found: Any) -> Iterable[SmallTable]:
        """What the reader may want to look up."""
        return ()

    def notes(self, found: Any) -> Iterable[str]:
        """Sentences below the tables."""
        return self.file.notes if self.file else ()

    def data(self, found: Any) -> dict[str, Any]:
        """What pages read, as JSON holds it: no number is read back from a table or a note."""
        return {}

    def figures(self, found: Any) -> Iterable[Plot]:
        """What is drawn."""
        return ()

    def views(self, found: Any) -> Iterable[View]:
        """What is drawn in space, where the machine can: see `verification.figures.space`."""
        return ()

    def run(self, context: Context) -> Outcome:
        """Solve, and collect the parts."""
        return self.collect(context, self.solve(context))

    def collect(self, context: Context, found: Any) -> Outcome:
        """What the parts say of what `solve` returned; the figures are saved. Raises NotDrawnError, with all
        the rest, when a figure cannot be drawn.
        """
        setup, tables, notes = (list(part(found)) for part in (self.setup, self.tables, self.notes))
        outcome = Outcome(self.values(found), setup, [], tables, notes, plain(self.data(found)))
        try:
            for plot in self.figures(found):
                outcome.figures.append(context.save(plot))
            seen, cannot = context.look(self.views(found))
        except Exception as problem:
            why = f"not drawn: {context.told(problem)}"
            outcome.figures += [
                Figure("Figures that are missing", "", "", f"figures/{self.name}.png", findings=(why,))
            ]
            raise NotDrawnError(outcome, why) from problem
        outcome.figures += seen
        outcome.notes += cannot
        return outcome

    def values(self, found: Any) -> dict[str, Measured]:
        """Row id -> value: what is measured, led by the name of the case."""
        gates = self.measure(found).items()
        return {
            f"{self.name}.{gate}": value if isinstance(value, Measured) else Measured(value)
            for gate, value in gates
        }


@dataclass
class Context:
    """What a case may use: scenes, solvers, and where to put its files. out: folder of the report; store:
    where results are looked up and kept, None to compute all. Filled here: inputs, name -> content of each
    scene file and of the files it names; runs, folders written; sources: run -> where its result is from;
    taken_s: what the solves of results from the store took; pdf: draw figures as PDF alone.
    """

    case: str
    out: Path
    level: str
    progress: Progress
    inputs: dict[str, bytes] = field(default_factory=dict)
    runs: list[str] = field(default_factory=list)
    store: Store | None = None
    sources: dict[str, Reuse] = field(default_factory=dict)
    taken_s: float = 0.0
    pdf: bool = False

    def scene(self, name: str) -> Scene:
        """The scene of `verification/scenes/<name>.toml`, or in a file of a user."""
        if name.endswith(".toml"):
            scene, inputs = read_scene(name)
            self.inputs |= inputs
            return scene
        with resources.as_file(resources.files("verification").joinpath("scenes", f"{name}.toml")) as path:
            scene, inputs = read_scene(path)
        self.inputs |= {f"{name.removesuffix(path.stem)}{file}": content for file, content in inputs.items()}
        return scene

    def solve(self, model: str, scene: Scene, label: str, *, demand: bool = True) -> Result:
        """Solve, or take from the store, and write runs/<case>/<label>. RuntimeError if unconverged."""

        def progress(stage: str, k: int, n: int) -> None:
            self.progress(f"{self.case}, {label}: {stage}", k, n)

        result, source = solve_or_reuse(self.store, scene, model, progress)
        folder = Path("runs", self.case, label)
        write_run(result, scene, self.out / folder, collect() | source.provenance)
        self.runs.append(folder.as_posix())
        self.sources[folder.as_posix()] = source
        self.taken_s += source.reused * sum(result.cost.get(part) or 0.0 for part in ("setup_s", "solve_s"))
        if demand and not result.converged:
            raise RuntimeError(f"{label} ended {result.status}: {result.message}")
        return result

    def told(self, problem: Exception) -> str:
        """An error with the line that raised it, in words that may be published."""
        last = traceback.extract_tb(problem.__traceback__)[-1]
        where = f"{Path(last.filename).name}, line {last.lineno}"
        return printable(without_places(f"{type(problem).__name__}: {problem} ({where})", self.out))

    def save(self, plot: Plot) -> Figure:
        """Write a drawing as figures/<case>-<name>.png with its data, or as PDF; and whether it reads."""
        from verification.figures.check import findings  # noqa: PLC0415 - loads matplotlib
        from verification.figures.style import save  # noqa: PLC0415 - loads matplotlib

        folder = self.out / "figures"
        stem = folder / f"{self.case}-{plot.name}"
        folder.mkdir(parents=True, exist_ok=True)
        picture, *data = (f"figures/{path.name}" for path in save(plot.drawing, stem, pdf=self.pdf))
        unread = tuple(findings(plot.drawing.figure))
        return Figure(plot.title, plot.title, plot.caption, picture, "".join(data), unread)

    def look(self, views: Iterable[View]) -> tuple[list[Figure], list[str]]:
        """Write pictures in space as figures/<case>-<name>.png; a line says why others are missing."""
        seen = []
        for view in () if self.pdf else views:
            path = Path("figures", f"{self.case}-{view.name}.png")
            try:
                pictures = space.draw(self.out / "runs" / self.case / view.run, view.picture)
            except space.CannotDrawError as error:
                why = str(error)
                return seen, [f"{why[0].upper()}{why[1:]}."]
            for picture in pictures.values():
                (self.out / path).parent.mkdir(parents=True, exist_ok=True)
                write_atomically(self.out / path, picture)
                seen.append(Figure(view.title, view.title, view.caption, path.as_posix()))
        return seen, []


with_body, with_grid, with_loading = (
    partial(with_keys, section=name) for name in ("body", "grid", "loading")
)
"""(scene, keys) -> the scene with other keys in that section."""


def with_mesh(scene: Scene, cells_per_radius: int) -> Scene:
    """The scene with another finite-element mesh."""
    return with_keys(scene, "fem", cells_per_radius=cells_per_radius)
