# SPDX-License-Identifier: MIT
"""The command sweep: the scenes of a study, solved by many workers, as one table.

What the store holds is not solved again, and what is solved is kept there as soon as it is
finished, so a sweep that was killed goes on where it was. The table holds no times: the same study
gives the same bytes wherever it was solved.
"""

from __future__ import annotations

import json
import os
import pickle
import sys
import time
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from contextlib import AbstractContextManager, suppress
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from sam.scene import QUANTITIES, Problem, Progress as Told, Result, Scene, SceneError, resolved, spelling
from samfem.executors import Cluster, Failure, Processes, run
from samfem.refusals import REFUSALS, check_folder
from verification import ExtraError
from verification.cost.plan import check_needs
from verification.figures import sensitivity_figure, sweep_figure
from verification.runs import models
from verification.runs.code_version import code_version
from verification.runs.files import (
    FIGURES,
    SUMMARY,
    FolderError,
    clear_run,
    json_text,
    read_summary,
    write_atomically,
    write_run,
)
from verification.runs.lock import locked
from verification.runs.provenance import collect, without_places
from verification.runs.store import (
    RESULT,
    UNCONVERGED,
    Lookup,
    Reuse,
    Store,
    default_store,
    identity,
    kept_coefficients,
)
from verification.runs.study import Points, StudyPoint, read_study
from verification.runs.tables import csv_text
from verification.sensitivity import indices
from verification.text.console import Progress, print_table

FORMAT = "samfem sweep 1"
TABLE, RECORD, RUNS, SENSITIVITY = "sweep.csv", "sweep.json", "runs", "sensitivity.csv"
FILES, OF_DESIGN = (RECORD, TABLE, "sweep.png"), (SENSITIVITY, "sensitivity.png")
INDEX_COLUMNS = ("quantity", "key", "index", "value", "low", "high", "samples")
COUNTERS = ("contact_iterations", "plastic_iterations", "operator_applications", "newton_iterations")
REFUSED, FAILED = "refused", "failed"
MOST_SAID = 3
REST_FACTOR = 4  # the table is not rewritten before this many times the time that the last writing took


class KeepsAll(Store):
    """A store that keeps a run without a converged result as it keeps the others: with its status,
    it is a finding of a study of many runs, and costs as much.
    """

    def lookup(self, scene: Scene, model: str, kind: str = RESULT) -> Lookup:
        found = super().lookup(scene, model, kind)
        other = super().lookup(scene, model, UNCONVERGED) if found.result is None else found
        return found if other.result is None else other

    def keep(self, scene: Scene, model: str, result: Result, *, unconverged: bool = True) -> None:
        super().keep(scene, model, result, unconverged=unconverged)


Solved = tuple[Result, Mapping[str, object]]
"""A result and where it was computed: versions, machine and threads of the worker."""
Cells = Sequence[Any]
"""Of a row of a table."""


@dataclass
class Sweep:
    """What has become of the points so far. rows: index -> row of the table; runs: whether run
    folders are written.
    """

    content: Points
    folder: Path
    store: Store | None
    runs: bool
    provenance: Mapping[str, Any] = field(init=False)
    rows: dict[int, Cells] = field(default_factory=dict)
    counts: Counter[str] = field(default_factory=Counter)
    notes: list[str] = field(default_factory=list)
    repeats: int = 0
    _rest_until: float = 0.0

    def __post_init__(self) -> None:
        seed = self.content.study.seed
        self.provenance = collect(self.content.inputs, [] if seed is None else [seed])

    @property
    def columns(self) -> tuple[str, ...]:
        vary = self.content.study.vary
        return ("index", *vary, "model", "status", "reason", *QUANTITIES, *COUNTERS, "warnings")

    @property
    def ordered(self) -> list[Cells]:
        return [self.rows[index] for index in sorted(self.rows)]

    def add(self, point: StudyPoint, result: Result, source: Reuse, origin: Mapping[str, Any]) -> None:
        """A result, solved or reused."""
        self.counts["reused" if source.reused else "solved"] += 1
        self.counts["not_converged"] += not result.converged
        numbers = [result.quantities.get(name) for name in QUANTITIES]
        counts = [result.cost.get(name) for name in COUNTERS]
        reason = "" if result.converged else result.message or result.status.advice
        self._row(point, result.status.value, reason, [*numbers, *counts, "; ".join(result.warnings)])
        place = self.place(point.index)
        if self.runs and not (source.reused and (place / SUMMARY).exists()):
            code = {"code_version": code_version(result.model)}
            write_run(
                result, _scene_of(point), place, {**self.provenance, **code, **origin, **source.provenance}
            )

    def place(self, index: int) -> Path:
        """The folder of a run; names of equal length, so that they sort."""
        return self.folder / RUNS / f"{index:0{len(str(len(self.content.points) - 1))}}"

    def add_without(self, point: StudyPoint, status: str, reason: str) -> None:
        """A point without a result."""
        self.counts[status] += 1
        empty = [*[None] * (len(QUANTITIES) + len(COUNTERS)), ""]
        self._row(point, status, " ".join(reason.split()), empty)

    def _row(self, point: StudyPoint, status: str, reason: str, last: Cells) -> None:
        model = self.content.study.model
        self.rows[point.index] = (point.index, *point.shown, model, status, reason, *last)

    def write(self, always: bool = False) -> None:
        """The table of what is finished, in the order of the index; a long one not after each point."""
        began = time.monotonic()
        if always or began >= self._rest_until:
            write_atomically(self.folder / TABLE, csv_text(self.columns, self.ordered).encode())
            now = time.monotonic()
            self._rest_until = now + REST_FACTOR * (now - began)


def sweep(
    path: Path,
    *,
    out: Path | None = None,
    scheduler: str | None = None,
    workers: int | None = None,
    runs: bool = True,
    use_store: bool = True,
    anyway: bool = False,
) -> int:
    """Solve the scenes of a study into a folder; 0 if all converged, else 1 with the first reasons on stderr.

    scheduler: address of a Dask cluster, instead of so many `workers` on this machine (None: one a core);
    runs: write a folder for each result; use_store: take what the store holds, and keep there what is solved;
    anyway: also scenes that take longer than a command begins unasked. Raises SceneError or FolderError
    before anything is made, KeyboardInterrupt that says what is kept.
    """
    content, folder = read_study(path), out or Path(f"{path.stem}-sweep")
    check(folder)
    state = Sweep(content, folder, store() if use_store else None, runs)
    with Progress(remaining=True) as progress:
        solve_study(state, _executor(scheduler, workers), progress, anyway=anyway)
    return _judge(state)


def store() -> KeepsAll | None:
    """The store of a sweep, if there is one."""
    known = default_store()
    return None if known is None else KeepsAll(known.folder)


def check(folder: Path) -> None:
    """Raise FolderError unless a sweep may be written to the folder."""
    check_folder(folder, (*FILES, *OF_DESIGN, RUNS), "sweep")


def solve_study(
    state: Sweep,
    executor: AbstractContextManager[Processes | Cluster],
    progress: Told,
    *,
    anyway: bool = True,
    draw: bool = True,
) -> None:
    """Solve the scenes of a study, and write its tables and, if asked to draw, its figures."""
    began, content, folder = time.monotonic(), state.content, state.folder
    with locked(folder), executor as solvers:
        folder.mkdir(parents=True, exist_ok=True)
        _clear(state)
        try:
            _fill(state, solvers, anyway, progress)
        except KeyboardInterrupt:
            state.write(always=True)
            kept = f"{len(state.rows)} of {len(content.points)} scenes are finished"
            again = (
                "the same command goes on from there"
                if state.store
                else "without a store all are solved again"
            )
            raise KeyboardInterrupt(f"interrupted: {kept}; {again}") from None
    state.write(always=True)
    found = index_rows(state) if content.study.design else []
    if content.study.design:
        write_atomically(folder / SENSITIVITY, csv_text(INDEX_COLUMNS, found).encode())
    try:
        if draw:
            sweep_figure(content.study, _named(state.columns, state.ordered), folder / "sweep")
            sensitivity_figure(_named(INDEX_COLUMNS, found), folder / "sensitivity")
    except ExtraError as error:
        print(f"samfem: sweep: no figure and no mesh is written: {error}", file=sys.stderr)
    kind = "dask" if isinstance(solvers, Cluster) else "processes"
    workers = {"kind": kind, "lost": solvers.lost}
    record = _record(state) | {"workers": workers, "elapsed_s": time.monotonic() - began}
    write_atomically(folder / RECORD, json_text(record).encode())


def _executor(scheduler: str | None, count: int | None) -> Processes | Cluster:
    if scheduler is None:
        return Processes(count or _cores())
    try:
        return Cluster(scheduler)
    except ModuleNotFoundError:
        allowed = "needs the package distributed: pip install samfem[dask]"
    except ImportError as error:
        lacks = f"which cannot be loaded on this machine ({error}): use --workers"
        allowed = f"needs the package distributed, {lacks}"
    except OSError as error:
        such = f"such as tcp://localhost:8786 ({error})"
        allowed = f"the address of a running Dask scheduler with workers, {such}"
    raise SceneError([Problem("--scheduler", spelling(scheduler), allowed)], "samfem sweep")


def _cores() -> int:
    """Those that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def _clear(state: Sweep) -> None:
    """Remove the files of an older sweep, sweep.json first, and its runs, but those that the store
    will give again.
    """
    for name in (*FILES, *OF_DESIGN):
        (state.folder / name).unlink(missing_ok=True)
    kept = state.content.points if state.runs and state.store else ()
    ours = {state.place(point.index).name: point for point in kept}
    for place in (state.folder / RUNS).glob("[0-9]*"):
        if place.is_dir() and not place.is_symlink() and not _is_run_of(place, ours.get(place.name), state):
            clear_run(place)
            for emptied in (place / FIGURES, place, state.folder / RUNS):
                with suppress(OSError):  # not there, or something else is in it
                    emptied.rmdir()


def _is_run_of(place: Path, point: StudyPoint | None, state: Sweep) -> bool:
    """Whether the folder holds the run of a point, by the model and the code of now."""
    if point is None or point.scene is None:
        return False
    try:
        summary = read_summary(place)
        found = summary["scene"], summary["model"], summary["provenance"]["code_version"]
    except (FolderError, KeyError, TypeError):
        return False
    model = state.content.study.model
    return (
        found == (resolved(point.scene), model, code_version(model)) and summary.get("status") == "converged"
    )


def _fill(state: Sweep, workers: Processes | Cluster, anyway: bool, progress: Told) -> None:
    """A row for each point: refused, from the store, or solved."""
    points, model = state.content.points, state.content.study.model
    missing = {point.index: point for point in _look_up(state, progress)}
    if state.rows:
        state.write(always=True)
    equal: dict[str, list[int]] = {}
    for index, point in missing.items():
        equal.setdefault(json_text(identity(_scene_of(point), model)), []).append(index)
    same = {indices[0]: indices for indices in equal.values()}
    tasks = {index: (points[index].scene, model, code_version(model), anyway) for index in same}
    progress("sweep", 0, len(tasks))
    for done, (index, outcome, repeats) in enumerate(run(workers, solve_scene, tasks), start=1):
        state.repeats = repeats
        for point in (points[each] for each in same[index]):
            if isinstance(outcome, Failure):
                state.add_without(point, FAILED, outcome.reason)
                continue
            result, origin = outcome
            if state.store is not None:
                state.store.keep(_scene_of(point), result.model, result)
            state.add(point, result, Reuse(False), origin)
        state.write()
        progress("sweep", done, len(tasks))


def _look_up(state: Sweep, progress: Told) -> Iterator[StudyPoint]:
    """The points that have to be solved; the others become rows."""
    points, model = state.content.points, state.content.study.model
    for done, point in enumerate(points, start=1):
        if point.scene is None:
            state.add_without(point, REFUSED, point.reason)
            continue
        found = state.store.lookup(point.scene, model) if state.store else Lookup()
        if found.result is not None:
            state.add(point, found.result, Reuse(True, found.created, found.commit), {})
        else:
            state.notes += filter(None, [found.note])
            yield point
        progress("looked up in the store", done, len(points))
    if state.notes:
        text = f"{len(state.notes)} results of the store cannot be used and are computed again"
        print(f"samfem: sweep: {text}: {state.notes[0]}", file=sys.stderr)


def _scene_of(point: StudyPoint) -> Scene:
    """Of a point that is not refused."""
    assert point.scene is not None
    return point.scene


def solve_scene(scene: Scene, model: str, code: str, anyway: bool = False) -> Solved | Failure:
    """In a worker: the result of a scene. A Failure if it raises, or if the worker runs another
    version of the code.
    """
    try:
        if code_version(model) != code:
            return Failure(
                "the worker runs another version of samfem, numpy or scipy: install the same one there"
            )
        made = check_needs(scene, model, anyway=anyway)
        with kept_coefficients():
            return models.solve(scene, model, made=made), _origin()
    except models.ModelError as error:
        return Failure(str(error))
    except MemoryError:
        return Failure("out of memory: lower grid.cells, grid.layers or fem.cells_per_radius")
    except Exception as error:  # whatever it is, it is this scene's
        return Failure(f"{type(error).__name__}: {error}")


@cache
def _origin() -> Mapping[str, object]:
    found = collect()
    return {name: found[name] for name in ("versions", "machine", "threads")}


def _named(columns: Sequence[str], rows: Sequence[Cells]) -> list[dict[str, Any]]:
    return [dict(zip(columns, row, strict=True)) for row in rows]


def index_rows(state: Sweep) -> Sequence[Cells]:
    """The indices of sensitivity of each quantity that changes over a design, by what moves it most."""
    study, shares, found = state.content.study, state.content.study.shares(), []
    columns = dict(zip(state.columns, zip(*state.ordered, strict=True), strict=True))
    converged = np.array(columns["status"]) == "converged"
    assert study.seed is not None  # every design has one
    for name in QUANTITIES:
        values = np.where(converged, np.array(columns[name], dtype=float), np.nan)
        for index in indices(study.mode, shares, values, study.seed):
            columns_of = zip(study.factors, index.values, *index.bounds, index.count, strict=True)
            rows = [(name, key, index.name, *each) for key, *each in columns_of]
            found += sorted(rows, key=lambda row: -abs(row[3]))
    return found


def _record(state: Sweep) -> dict[str, Any]:
    study = state.content.study
    counts = {name: state.counts[name] for name in ("solved", "reused", "not_converged", FAILED, REFUSED)}
    return {
        "format": FORMAT,
        "title": study.title,
        "study": study.model_dump(mode="json", by_alias=True, exclude_none=True),
        "seed": study.seed,
        "model": study.model,
        "points": len(state.content.points),
        "counts": counts,
        "retries": state.repeats,
        "store": state.store is not None,
        "not_used_of_store": [
            without_places(each, state.store.folder) for each in state.notes if state.store
        ],
        "units": {key: axis.si_unit for key, axis in study.vary.items()},
        "columns": state.columns,
        "provenance": state.provenance,
    }


def _judge(state: Sweep) -> int:
    """Exit code; counts on stdout, and the first points without a converged result on stderr."""
    names = ("solved", "reused", "not_converged", FAILED, REFUSED)
    print_table(("scenes", *names), [[str(len(state.rows)), *(str(state.counts[name]) for name in names)]])
    print(state.folder / TABLE)
    place = state.columns.index("status")
    bad = [(row[0], row[place], row[place + 1]) for row in state.ordered if row[place] != "converged"]
    for index, status, reason in bad[:MOST_SAID]:
        print(f"samfem: sweep: scene {index}: {status}: {reason}", file=sys.stderr)
    if len(bad) > MOST_SAID:
        print(f"samfem: sweep: and {len(bad) - MOST_SAID} more, see {state.folder / TABLE}", file=sys.stderr)
    return 1 if bad else 0


def answer() -> None:
    """In a process of its own, for Python: solve the study that is pickled on stdin. Each line on stdout is
    what progress is told, as JSON.
    """
    content, folder, workers, keep = pickle.load(sys.stdin.buffer)

    def told(*state: str | int) -> None:
        print(json.dumps(state), flush=True)

    try:
        state = Sweep(content, folder, store(), runs=keep)
        solve_study(state, Processes(workers or _cores()), told, draw=keep)
    except REFUSALS as error:
        sys.exit(str(error))
