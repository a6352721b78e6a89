# SPDX-License-Identifier: MIT
"""What `import samfem` gives: the functions, what they return, and what they raise."""

from __future__ import annotations

import html
import json
import os
import pickle
import subprocess
import sys
import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from subprocess import PIPE
from tempfile import TemporaryDirectory, TemporaryFile
from typing import TYPE_CHECKING, Any, Literal, overload

import numpy as np

from samfem.clash import foreign_package

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from pandas import DataFrame
    from pyvista import DataSet

    from verification.compare.own_data import OwnData
    from verification.cost.plan import Plan
    from verification.fit import Fitted
    from verification.fit.tensile import Tensile

if _words := foreign_package():
    raise ImportError(_words)

from sam.scene import HeightMap as HeightMap, Progress, Result, Scene, SceneError as SceneError, load_scene
from samfem.refusals import SeveralError as SeveralError
from verification import figures
from verification.runs import files, meshes, models
from verification.runs.files import COMPANION, FolderError
from verification.runs.model_range import off_in_words
from verification.runs.models import MODELS, SAM, ModelError
from verification.runs.tables import read_any_table
from verification.text.console import followed
from verification.text.readable import in_working_unit

load = load_scene
SHOWN = ("p_max_Pa", "contact_radius_m", "approach_m", "peeq_max", "friction_coefficient", "wear_volume_m3")
"""Quantities of the short representation, those of them that are not zero."""


@dataclass(frozen=True, repr=False)
class Run(files.Run):
    """A result of one model.

    Attributes
    ----------
    scene
        The scene that was solved, with every default.
    model, status, converged, message
        What solved it, and how that ended. Use the quantities only if `converged` is true.
    quantities
        Name with SI unit, as "p_max_Pa" -> float, or None where it does not apply.
    tables
        Name ("history", "axis", "line", "plane", "surface", ...) -> DataFrame, columns with SI unit.
    warnings
        What to know about the quantities, such as that the contact reaches the edge of its patch.
    model_range
        By how much small strains of a flat half-space are off, see `docs/guide/limits.md`; or None.
    cost
        Times in s, memory in bytes and counters.
    summary
        All that summary.json holds: also what was left out and why, the grid or mesh, and the provenance.
    folder
        Where the run was written or read; None where neither was done.
    result
        What the solver returned, of a run in no folder.
    """

    result: Result | None = None

    def save(self, folder: str | Path) -> Run:
        """The run, written to a folder. Raises FolderError where that holds something else."""
        if self.result is None:
            raise FolderError(f"the run is in {self.folder}: copy that folder")
        files.write_run(self.result, self.scene, folder)
        return _run_in(Path(folder))

    def mesh(self, part: Literal["body", "surface"] = "body", *, unloaded: bool = False) -> DataSet:
        """The fields of a part as pyvista holds them, at the peak load or unloaded; z points up, in m.

        Parameters
        ----------
        part
            "body": stresses and strains, of SAM in the box of a yielding body and else in the plane y = 0;
            "surface": pressure and displacements.
        unloaded
            After the last cycle, in place of the peak load.

        Raises
        ------
        FolderError
            For a part that the run does not have, with those that it has.
        """
        there: Mapping[str, Any] = files.meshes_in(self.folder) if self.folder else {}
        if self.result is not None:
            there = meshes.fields_of(self.result)
        state = "-unloaded" * unloaded
        for name in ("body", "fields") if part == "body" else (part,):
            found = there.get(f"{name}{state}")
            if found is not None:
                in_file = isinstance(found, Path)
                mesh: DataSet = (
                    files.mesh_of(found.parent, found.name) if in_file else meshes.as_pyvista(found)
                )
                return mesh
        raise FolderError(f"this run has no mesh {part}{state}: it has {', '.join(there) or 'none'}")

    def plot(self, name: str | None = None) -> Figure:
        """The figure of that name, see `samfem.plot`; the pressure, or else the profiles, without a name."""
        return _figure(self, name, "pressure", "line")

    def __str__(self) -> str:
        from samfem.solving import result_lines  # noqa: PLC0415 - loads the solvers

        said = [self.message] * (not self.converged) + [f"warning: {words}" for words in self.warnings]
        return "\n".join([*result_lines(self), *said])

    def __repr__(self) -> str:
        values = self.last_fitting or self.quantities
        shown = [in_working_unit(name, value, digits=3) for name in SHOWN if (value := values.get(name))]
        words = ", ".join(f"{name} {value}" for name, value in shown)
        return f"<samfem.Run {self.model}, {self.status}: {words or 'no load'}{_off(self)}>"

    def _repr_html_(self) -> str:
        values = self.last_fitting or self.quantities
        rows = [in_working_unit(name, value) for name, value in values.items() if value is not None]
        left_out = [(entry["stage"], entry["reason"]) for entry in self.summary["left_out"]]
        tables = [(name, f"{len(table)} rows: {', '.join(table)}") for name, table in self.tables.items()]
        head = f"{self.summary['title'] or 'scene'} ({self.model}): {self.status}. {self.message}"
        said = "".join(f"<p>warning: {html.escape(words)}</p>" for words in self.warnings)
        parts = (("Quantities", rows), ("Left out", left_out), ("Tables", tables))
        return f"<p><b>{html.escape(head)}</b></p>{said}" + "".join(
            f"<details{' open' * (of is rows)}><summary>{what}</summary>{_table(of)}</details>"
            for what, of in parts
        )


@dataclass(frozen=True, repr=False)
class Comparison:
    """SAM and a finite-element model on one scene, and own data if they are given.

    Attributes
    ----------
    frame
        A row for each quantity and field: SAM, FEM, their difference, its tolerance and the reason of that;
        four columns more for own data.
    sam, fem
        The two runs.
    line
        The verdict on one line.
    data
        Name of own data -> what was read of them; empty for a comparison that is read from a folder.
    """

    frame: DataFrame
    sam: Run
    fem: Run
    line: str
    data: Mapping[str, OwnData] = field(default_factory=dict)

    @property
    def failed(self) -> DataFrame:
        """The rows of the frame that are not within their tolerance, of the models or of own data."""
        judged = [name for name in self.frame if name == "passed" or name.endswith("_passed")]
        return self.frame[(self.frame[judged].astype(str) == "False").any(axis=1)]

    @property
    def passed(self) -> bool:
        """Whether both models converged and every row is within its tolerance, of own data too."""
        return self.failed.empty and self.sam.converged and self.fem.converged

    def check(self) -> None:
        """Raise AssertionError, with every row that is not within its tolerance, unless all are."""
        if not self.passed:
            raise AssertionError(f"{self.line}\n{self.failed.to_string(index=False)}")

    def plot(self, name: str | None = None) -> Figure:
        """The figure of that name, see `samfem.plot`; the profiles along the surface without a name."""
        return _figure(self, name, "line")

    def __str__(self) -> str:
        from samfem.solving import status_line  # noqa: PLC0415 - loads the solvers

        runs = self.sam, self.fem
        said = dict.fromkeys(f"warning: {words}" for run in runs for words in run.warnings)
        return "\n".join([*(f"{run.model}: {status_line(run)}" for run in runs), self.line, *said])

    def __repr__(self) -> str:
        return f"<samfem.Comparison {self.line}{_off(self.sam)}>"

    def _repr_html_(self) -> str:
        line = "; ".join([self.line, *self.sam.range_lines])
        return f"<p><b>{html.escape(line)}</b></p>{self.frame.to_html(index=False)}"


@dataclass(frozen=True, repr=False)
class Sweep:
    """A finished sweep.

    Attributes
    ----------
    frame
        A row for each scene: the varied values in SI units, status, reason, quantities and counters.
    folder
        Where it is; None where it was not written. record: what sweep.json holds.
    """

    frame: DataFrame
    folder: Path | None
    record: Mapping[str, Any]

    def run(self, index: int) -> Run:
        """The run of a row, by its index. Raises FolderError where the sweep kept none."""
        if self.folder is None:
            raise FolderError('this sweep kept no runs: samfem.sweep(study, out="folder") does')
        width = len(str(self.record["points"] - 1))
        return _run_in(self.folder / "runs" / f"{index:0{width}}")

    def plot(self, name: str | None = None) -> Figure:
        """The main quantities over each of the varied keys; name: only "sweep"."""
        return _figure(self, name, "sweep")

    def __repr__(self) -> str:
        counts = ", ".join(
            f"{number} {name.replace('_', ' ')}" for name, number in self.record["counts"].items()
        )
        return f"<samfem.Sweep of {len(self.frame)} scenes: {counts}>"

    def _repr_html_(self) -> str:
        return f"<p><b>{html.escape(repr(self))}</b></p>{self.frame.to_html(index=False, max_rows=20)}"


def plan(scene: Scene | str | Path, model: str = SAM) -> Plan:
    """What the models will compute of a scene, what is left out and why, the error that the grid leaves, time
    and memory. Solves nothing.

    Parameters
    ----------
    scene
        A scene, or the path of its file.
    model
        The one of `MODELS` that the attributes of the plan are about.

    Raises
    ------
    SceneError, ModelError
        For a wrong file, a scene that the model cannot represent.
    """
    from verification.cost.plan import plan as plan_of  # noqa: PLC0415 - loads the solvers

    scene = _scene(scene)
    models.check(scene, model)
    return plan_of(scene, model)


def solve(
    scene: Scene | str | Path,
    model: str = SAM,
    out: str | Path | None = None,
    *,
    progress: bool | Progress | None = None,
) -> Run:
    """The result of a scene. Its warnings are UserWarnings too, but for the small error of the model that
    nearly every contact has.

    Parameters
    ----------
    scene
        A scene, or the path of its file.
    model
        One of `MODELS`: "sam", "fem-axisymmetric", "fem-3d", "fem-plane-strain".
    out
        Folder to write the run to; nothing is written without it.
    progress
        None shows a bar at a terminal and in a notebook, True plain lines elsewhere too, False nothing; a
        function is told (stage, done, total).

    Raises
    ------
    SceneError, ModelError, FolderError
        For a wrong file, a scene that the model cannot represent, a folder that holds something else.
    """
    from samfem.solving import named  # noqa: PLC0415 - loads the solvers
    from verification.cost.accuracy import solve as solve_family  # noqa: PLC0415 - likewise
    from verification.runs.store import kept_coefficients  # noqa: PLC0415 - only where it solves

    scene = _scene(scene)
    if model not in MODELS:
        raise ModelError(f"model = {model!r}, allowed: {', '.join(MODELS)}")
    if out is not None:
        files.check_target(Path(out))
    with followed(progress) as told, kept_coefficients():

        def one(each: Scene, label: str) -> Result:
            return models.solve(each, model, named(told, model, label))

        run = _run_of(solve_family(scene, model, one), scene)
    run = run if out is None else run.save(out)
    stated = [] if run.model_range is None or run.model_range["outside"] else run.range_lines
    for words in run.warnings:
        if words not in stated:
            warnings.warn(words, stacklevel=2)
    return run


def compare(
    scene: Scene | str | Path,
    model: str | None = None,
    *,
    data: Sequence[str | Path] = (),
    tolerances: Mapping[str, Any] | None = None,
    claim: str | None = None,
    progress: bool | Progress | None = None,
) -> Comparison:
    """SAM and a finite-element model on one scene, row by row with tolerances; from the store what it holds.

    Parameters
    ----------
    scene
        A scene, or the path of its file.
    model
        The finite-element model; None takes the cheapest that can represent the scene.
    data
        Files of own data, as the command compare takes them after --with.
    tolerances
        Name of a row -> number or text such as "2 %", in place of those of the scene and the defaults.
    claim
        "negligible-film": judged too.
    progress
        As of `solve`.

    Raises
    ------
    SceneError, ModelError
        For a wrong scene or wrong data, or a scene that no finite-element model can represent.
    SeveralError
        For more than one of these; a ValueError too.
    """
    from samfem.compared import asked  # noqa: PLC0415 - loads the solvers
    from verification.runs.store import default_store  # noqa: PLC0415 - only here

    question = asked(_scene(scene), model=model, data=data, tolerances=tolerances, claim=claim)
    with followed(progress) as told:
        found = question.answer(store=default_store(), progress=told)
    sam, fem = (_run_of(result, found.scene) for result in found.results)
    return Comparison(found.frame, sam, fem, found.line, {data.name: data for data in found.data})


def sweep(
    study: Mapping[str, object] | str | Path,
    out: str | Path | None = None,
    workers: int | None = None,
    *,
    progress: bool | Progress | None = None,
) -> Sweep:
    """The scenes of a study, solved on this machine as `samfem sweep` does; from the store what it holds.

    Parameters
    ----------
    study
        Path of the study, or a mapping with the keys of its file: "scene", a `Scene`, its tables or the path
        of its file; "vary", dotted key of the scene -> its values, a list or array of SI numbers, strings
        with units or texts, or such as ``{"range": ["0.1 N", "0.5 N"], "count": 5}``; "model", "mode" and the
        others where they are wanted.
    out
        Folder to write the table and the runs to; without it they are not kept.
    workers
        Processes; one for each core by default.
    progress
        As of `solve`.

    Raises
    ------
    SceneError, FolderError
        For a wrong study or a folder that holds something else.

    Examples
    --------
    >>> study = {"scene": "sphere.toml", "vary": {"loading.force": [0.1, 0.2, 0.4]}}
    >>> samfem.sweep(study).frame[["loading.force", "approach_m"]]  # doctest: +SKIP
    """
    from samfem.sweeping import answer, check  # noqa: PLC0415 - loads the solvers
    from verification.runs.study import read_study, study_of  # noqa: PLC0415 - loads scipy.stats

    points = read_study(study) if isinstance(study, str | Path) else study_of(study)
    if out is not None:
        check(Path(out))
    # a process of its own, as its workers would run the script of the user again
    program = f"from {answer.__module__} import answer; answer()"
    with TemporaryDirectory() as temporary, TemporaryFile() as said, followed(progress) as told:
        folder = Path(out or Path(temporary, "sweep")).absolute()
        path = os.pathsep.join(filter(None, sys.path))  # a notebook may have extended it
        child = subprocess.Popen(
            [sys.executable, "-c", program],
            stdin=PIPE,
            stdout=PIPE,
            stderr=said,
            env={**os.environ, "PYTHONPATH": path},
        )
        assert child.stdin is not None and child.stdout is not None
        with child:
            try:
                child.stdin.write(pickle.dumps((points, folder, workers, out is not None)))
                child.stdin.close()
                for line in child.stdout:
                    told(*json.loads(line))
            except BaseException:
                child.kill()
                raise
        if child.returncode:
            said.seek(0)
            raise FolderError(said.read().decode(errors="replace").strip())
        return _sweep_in(folder, keep=out is not None)


def fit(
    definition: Mapping[str, object] | str | Path,
    out: str | Path | None = None,
    *,
    progress: bool | Progress | None = None,
) -> Fitted:
    """The parameters of a body from measured dents, as `samfem fit` finds them; from the store what it holds.

    Parameters
    ----------
    definition
        Path of the fit, or a mapping with the keys of its file, in SI or with units; "scene": a `Scene`, its
        tables or a path; a test may have its table as "data", a DataFrame.
    out
        Folder to write what the command writes; nothing is written without it.
    progress
        As of `solve`.

    Raises
    ------
    SceneError, ModelError, FolderError
        For data or bounds that cannot be, a model that was not solved, a folder that holds something else.
    """
    from samfem.fitting import FILES, answer, write  # noqa: PLC0415 - loads the solvers
    from samfem.refusals import check_folder  # noqa: PLC0415
    from verification.fit import definition_of, read_definition  # noqa: PLC0415 - loads scipy
    from verification.runs.store import default_store  # noqa: PLC0415 - only here

    wanted = read_definition(definition) if isinstance(definition, str | Path) else definition_of(definition)
    if out is not None:
        check_folder(Path(out), FILES, "fit")
    with followed(progress) as told:
        found, solves = answer(wanted, default_store(), told)
    if out is not None:
        write(found, solves, Path(out))
    return found


def tensile(strain: Sequence[float], stress: Sequence[float]) -> Tensile:
    """Yield stress, exponent, Swift's constants and a table of a tensile test, see `Tensile`.

    Parameters
    ----------
    strain, stress
        (n,) engineering strain (1, not %) and stress in Pa, as measured.

    Raises
    ------
    SceneError
        For too few points, or a curve without elastic line.
    """
    from verification.fit.tensile import tensile as law_of  # noqa: PLC0415 - loads scipy

    return law_of(np.asarray(strain), np.asarray(stress))


def read(folder: str | Path) -> Run | Comparison | Sweep:
    """What a command wrote to a folder: a run, a comparison or a sweep.

    Raises
    ------
    FolderError
        For a folder that is none of them.
    """
    folder = Path(folder)
    for name, reader in (("sweep.json", _sweep_in), ("compare.csv", _comparison_in)):
        if (folder / name).exists():
            return reader(folder)
    return _run_in(folder)


@overload
def plot(result: Run | Comparison | Sweep, name: None = None) -> dict[str, Figure]: ...
@overload
def plot(result: Run | Comparison | Sweep, name: str) -> Figure: ...
def plot(result: Run | Comparison | Sweep, name: str | None = None) -> dict[str, Figure] | Figure:
    """The figures of a result by name, or the one of that name, as matplotlib figures.

    Raises
    ------
    KeyError
        For another name, with those that there are.
    """
    if name is not None:
        return _figure(result, name)
    return {key: drawing.figure for key, drawing in _drawings(result).items()}


def _figure(result: Run | Comparison | Sweep, name: str | None, *usual: str) -> Figure:
    """The figure of that name, or without one the first of the usual ones that there is."""
    found = plot(result)
    shown = name or next(key for key in (*usual, *found) if key in found)
    if shown not in found:
        raise KeyError(f"{name!r}: this result has the figures {', '.join(found)}")
    return found[shown]


def _drawings(result: Run | Comparison | Sweep) -> Mapping[str, Any]:
    if isinstance(result, Run):
        with TemporaryDirectory() as folder:  # the figures look at the meshes too
            return figures.drawings_of_run(result if result.folder else result.save(folder))
    if isinstance(result, Comparison):
        solutions: dict[str, Any] = {"SAM": result.sam, "FEM": result.fem, **result.data}
        return figures.drawings_of_comparison(solutions)
    return {"sweep": figures.drawing_of_sweep(result.frame, result.record["study"])}


def _off(run: Run) -> str:
    """By how much the model is off, short; empty where no quantity is off by 1 %."""
    found = run.model_range or {"quantities": {}, "outside": False}
    parts = ["outside" * found["outside"], off_in_words(found)]
    words = ", ".join(filter(None, parts))
    return f"; model: {words}" if words else ""


def _scene(scene: Scene | str | Path) -> Scene:
    return scene if isinstance(scene, Scene) else load(scene)


def _run_of(result: Result, scene: Scene) -> Run:
    return Run(**vars(files.run_of(result, scene)), result=result)


def _run_in(folder: Path) -> Run:
    return Run(**vars(files.read_run(folder)))


def _comparison_in(folder: Path) -> Comparison:
    frame = _frame_in(folder / "compare.csv")
    sam, fem = (_run_in(folder / part) for part in ("sam", "fem"))
    try:
        line = json.loads((folder / COMPANION).read_bytes())["line"]
    except (OSError, ValueError, KeyError, TypeError):
        raise FolderError(f"{folder / COMPANION} is missing or damaged: run the command again") from None
    return Comparison(frame, sam, fem, line)


def _sweep_in(folder: Path, *, keep: bool = True) -> Sweep:
    record = json.loads((folder / "sweep.json").read_bytes())
    return Sweep(_frame_in(folder / "sweep.csv"), folder if keep else None, record)


def _frame_in(path: Path) -> DataFrame:
    try:
        return read_any_table(path.read_bytes())
    except (OSError, ValueError) as error:
        raise FolderError(f"{path} is damaged ({error}): run the command again") from None


def _table(rows: Sequence[Sequence[str]]) -> str:
    """Rows of text as an HTML table."""
    cells = ("".join(f"<td>{html.escape(str(cell))}</td>" for cell in row) for row in rows)
    return f"<table>{''.join(f'<tr>{row}</tr>' for row in cells)}</table>"
