# SPDX-License-Identifier: MIT
"""What a verification case is, what it may use, and what it hands back."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from importlib import resources
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING

from sam.scene import Grid, Result, Scene, read_scene
from sam.scene.result import Progress
from verification.runs.files import write_run
from verification.runs.provenance import collect
from verification.runs.store import Reuse, Store, solve_or_reuse
from verification.suite.gates import Measured

if TYPE_CHECKING:
    from verification.figures.style import Drawing

LEVELS = ("quick", "full")


@dataclass(frozen=True)
class Figure:
    """A drawn figure; paths relative to the report's folder. embedded: shown on the page, not only linked from it."""

    title: str
    alt: str
    caption: str
    png: str
    svg: str
    csv: str
    embedded: bool = True


@dataclass(frozen=True)
class SmallTable:
    """Rows for the page, as text."""

    caption: str
    columns: Sequence[str]
    rows: Sequence[Sequence[str]]


@dataclass
class Outcome:
    """What a case returns. values: gate id -> value; setup: (name, number with unit) for the reader."""

    values: dict[str, Measured] = field(default_factory=dict)
    setup: list[tuple[str, str]] = field(default_factory=list)
    figures: list[Figure] = field(default_factory=list)
    tables: list[SmallTable] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)


@dataclass(frozen=True)
class Case:
    """A verification case: one question, answered by `run`.

    equations: (what, formula, source) as used for the independent answer; levels: at which of LEVELS it runs, none: only
    when it is named; needs: why it cannot run here and what to do, empty if it can.
    """

    name: str
    title: str
    question: str
    run: Callable[[Context], Outcome]
    equations: Sequence[tuple[str, str, str]] = ()
    levels: Sequence[str] = LEVELS
    needs: Callable[[], str] = str


@dataclass
class Context:
    """What a case may use: scenes, solvers, and where to put its files.

    out: folder of the report; store: where results are looked up and kept, None to compute all. Filled here: inputs,
    name -> content of each scene file and of the files it names; runs, folders written; sources: run -> where its result
    is from; measures_anew: set by a solve that must be fresh.
    """

    case: str
    out: Path
    level: str
    progress: Progress
    inputs: dict[str, bytes] = field(default_factory=dict)
    runs: list[str] = field(default_factory=list)
    store: Store | None = None
    sources: dict[str, Reuse] = field(default_factory=dict)
    measures_anew: bool = False

    def scene(self, name: str) -> Scene:
        """The scene of `verification/scenes/<name>.toml`."""
        with resources.as_file(resources.files("verification").joinpath("scenes", f"{name}.toml")) as path:
            scene, inputs = read_scene(path)
        self.inputs |= inputs
        return scene

    def solve(self, model: str, scene: Scene, label: str, demand: bool = True, fresh: bool = False) -> Result:
        """Solve, or take from the store unless `fresh` (to measure times), and write the run into runs/<case>/<label>.

        RuntimeError when it did not converge, unless not `demand`ed.
        """

        def progress(stage: str, k: int, n: int) -> None:
            self.progress(f"{self.case}, {label}: {stage}", k, n)

        result, source = solve_or_reuse(self.store, scene, model, progress, fresh=fresh)
        folder = Path("runs", self.case, label)
        write_run(result, scene, self.out / folder, collect() | source.provenance)
        self.runs.append(folder.as_posix())
        self.sources[folder.as_posix()] = source
        self.measures_anew |= fresh
        if demand and not result.converged:
            raise RuntimeError(f"{label} ended {result.status}: {result.message}")
        return result

    def save(
        self, drawing: Drawing, name: str, title: str, alt: str, caption: str, embedded: bool = True
    ) -> Figure:
        """Write a drawing as figures/<case>-<name>.png, .svg and .csv."""
        from verification.figures.style import save  # loads matplotlib

        stem = f"{self.case}-{name}"
        (self.out / "figures").mkdir(parents=True, exist_ok=True)
        save(drawing, self.out / "figures" / stem)
        return Figure(
            title, alt, caption, *(f"figures/{stem}.{kind}" for kind in ("png", "svg", "csv")), embedded
        )


def package_of(extra: str, package: str) -> Callable[[], str]:
    """For `needs` of a case: how to install a package that only an extra of samfem brings, empty if it is there."""

    def needs() -> str:
        return "" if find_spec(package) else f'install {package}: pip install "samfem[{extra}]"'

    return needs


def with_grid(scene: Scene, **keys) -> Scene:
    """The scene with other keys in its [grid]."""
    return scene.model_copy(update={"grid": (scene.grid or Grid()).model_copy(update=keys)})


def with_loading(scene: Scene, **keys) -> Scene:
    """The scene with other keys in its [loading]."""
    return scene.model_copy(update={"loading": scene.loading.model_copy(update=keys)})


def with_mesh(scene: Scene, cells_per_radius: int) -> Scene:
    """The scene with another finite-element mesh."""
    return scene.model_copy(
        update={"fem": scene.fem.model_copy(update={"cells_per_radius": cells_per_radius})}
    )


def grid_text(sam: Result, a: float) -> str:
    """The cells of a SAM result for the reader; a: the contact radius in m, along x."""
    cells, cell = sam.discretisation["cells"], sam.discretisation["cell_m"][0]
    return f"{cells[0]} × {cells[1]} cells of {cell * 1e9:.1f} nm (a/{a / cell:.1f})"


def mesh_text(fem: Result) -> str:
    """The mesh of a FEM result for the reader."""
    return f"{fem.discretisation['elements']} elements, {fem.discretisation['dofs']} degrees of freedom"
