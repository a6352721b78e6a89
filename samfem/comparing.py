# SPDX-License-Identifier: MIT
"""The command compare: scenes solved by SAM and a finite-element model, row by row.

Wrong input of any of them raises, with everything that is wrong, before anything is solved or written.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from types import SimpleNamespace
from typing import Any

from sam.scene import Problem, Result, SceneError, either, finer_cells, finer_mesh, read_scene
from samfem.compared import NOT_COMPARED, Compared, Question, agreement, asked
from samfem.refusals import Refusals, check_folder
from samfem.solving import seconds, unconverged, write_solved
from verification.compare.verdicts import CLAIM, NOT_JUDGED
from verification.figures import compare_figures
from verification.judging import Verdict
from verification.runs import models
from verification.runs.files import (
    COMPANION,
    FIGURES,
    FolderError,
    check_target,
    clear_run,
    figures_of,
    json_text,
    lasting,
    read_summary,
    write_atomically,
)
from verification.runs.lock import locked
from verification.runs.store import Reuse, Store, default_store
from verification.runs.tables import csv_text
from verification.text.console import Progress, digits, print_table
from verification.text.readable import with_time

COMPARISON, VERDICT = "compare.csv", "verdict.json"
WRITTEN = (COMPARISON, VERDICT, COMPANION)
PARTS = dict.fromkeys(models.MODELS, "fem") | {models.SAM: "sam"}


@dataclass(frozen=True)
class Job:
    """A scene to compare. inputs: name of a file that was read -> its content; folder: of what is written."""

    name: str
    question: Question
    folder: Path
    inputs: dict[str, bytes]


def compare(paths: Sequence[Path], **options: Any) -> int:
    """Solve each scene with SAM and another model, and write DIR/sam, DIR/fem and compare.csv.

    Returns 0 if all converged and every row held. options: of the command, as its --help says.
    """
    given = SimpleNamespace(**options)
    jobs = _jobs(paths, given)
    store, found = default_store() if given.use_store else None, []
    for job in jobs:
        with locked(job.folder):
            drawn = _shown(job.folder)
            found.append(_answered(job, store))
            _write(job, found[-1], drawn, draw=given.figures)
    if len(jobs) == 1:
        _show(jobs[0], found[0], figures=given.figures)
    else:
        _show_all(jobs, found)
    _write_pages(jobs, found, given)
    print(found[0].line if len(jobs) == 1 else _verdict(jobs, found))
    return max(map(_judge, found))


def _jobs(paths: Sequence[Path], given: SimpleNamespace) -> list[Job]:
    """The comparisons that are asked for. Raises with everything that is wrong with any of them."""
    refusals, jobs = Refusals(), []
    for path in paths:
        with refusals.kept():
            name = f"{path.stem}-compare" if given.out is None else path.stem
            folder = given.out if given.out and len(paths) == 1 else (given.out or Path()) / name
            jobs.append(_job(path, folder, given))
    if given.data and len(paths) > 1:
        problem = Problem(
            "--with", ", ".join(map(str, given.data)), "for one scene only: compare it by itself"
        )
        refusals.found.append(SceneError([problem], "options"))
    names = [path.stem for path in paths]
    if twice := sorted({name for name in names if names.count(name) > 1}):
        words = f"{', '.join(twice)}: scenes of one name would be written to one folder"
        refusals.found.append(FolderError(words))
    with refusals.kept():
        if given.report is not None:
            from samfem.comparison_page import check_report  # noqa: PLC0415 - loads the suite

            check_report(given.report)
        if given.junit is not None:
            above = given.junit.absolute().parent
            if given.junit.is_dir() or not above.is_dir() or not os.access(above, os.W_OK):
                raise FolderError(f"--junit {given.junit}: a file in a folder that can be written to")
    refusals.raise_any()
    return jobs


def _job(path: Path, folder: Path, given: SimpleNamespace) -> Job:
    scene, inputs = read_scene(path)
    how = {"model": given.model, "claim": given.claim, "data": given.data, "anyway": given.anyway}
    refusals = Refusals()
    with refusals.kept():
        question = asked(scene, tolerances=dict(given.tolerances), source=str(path), **how)
    with refusals.kept():
        check_folder(folder, (*WRITTEN, *PARTS.values()), "comparison")
        for part in PARTS.values():
            check_target(folder / part)
    refusals.raise_any()
    return Job(path.stem, question, folder, inputs)


def _shown(folder: Path) -> list[Any]:
    """What figures of the comparison in a folder show: its rows and both runs; empty where there is none."""
    try:
        runs = [lasting(read_summary(folder / part)) for part in ("sam", "fem")]
        return [(folder / COMPARISON).read_bytes(), *runs]
    except (FolderError, OSError):
        return []


def _answered(job: Job, store: Store | None) -> Compared:
    """The comparison, each run written to its folder once it is there; what an older one says is removed, but
    for its figures.
    """
    for name in WRITTEN:
        (job.folder / name).unlink(missing_ok=True)
    if job.folder.exists():
        clear_run(job.folder, figures=False)

    def solved(model: str, result: Result, source: Reuse) -> None:
        where = job.folder / PARTS[model]
        write_solved(job.question.scene, where, result, source=source, inputs=job.inputs)

    with Progress(remaining=True) as progress:
        return job.question.answer(store=store, progress=progress, solved=solved)


def _write(job: Job, found: Compared, drawn: list[Any], *, draw: bool) -> None:
    """Write the rows, the cost of both models, the verdict on a film, and figures if they are asked for;
    those of an earlier comparison stay if what they have `drawn` is the same.
    """
    if found.film is not None:
        write_atomically(job.folder / VERDICT, json_text(found.film.content()).encode())
    table = found.frame
    text = csv_text(list(table.columns), list(table.itertuples(index=False)))
    write_atomically(job.folder / COMPARISON, text.encode())
    content = {
        "passed": found.passed,
        "line": found.line,
        "rows": len(found.rows),
        "failed": len(found.failed),
        "model_range": found.range_lines,
        "data": {
            data.name: {"rows": len(rows), "failed": sum(not row.passed for row in rows)}
            for data, rows in zip(found.data, found.beside, strict=True)
        },
        "cost": {each.model: {"seconds": seconds(each), **each.cost} for each in found.results},
    }
    write_atomically(job.folder / COMPANION, json_text(content).encode())
    if figures_of(job.folder) and _shown(job.folder) != drawn:
        clear_run(job.folder)
        if not draw:
            words = "the figures were of another comparison and are removed: --figures draws new ones"
            print(f"samfem: {job.folder}: {words}", file=sys.stderr)
    if draw:
        compare_figures(job.folder, found.solutions)


def _write_pages(jobs: Sequence[Job], found: Sequence[Compared], given: SimpleNamespace) -> None:
    """The page and the JUnit file, if they are asked for."""
    if given.report is None and given.junit is None:
        return
    from samfem.comparison_page import junit_of, write_report  # noqa: PLC0415 - loads the suite

    scenes = {job.name: each for job, each in zip(jobs, found, strict=True)}
    if given.report is not None:
        inputs = {name: content for job in jobs for name, content in job.inputs.items()}
        print(write_report(scenes, inputs, given.report))
    if given.junit is not None:
        write_atomically(given.junit, junit_of(scenes))
        print(given.junit)


def _show_all(jobs: Sequence[Job], found: Sequence[Compared]) -> None:
    """A line for each scene."""
    rows = []
    for job, each in zip(jobs, found, strict=True):
        times = map(with_time, map(seconds, each.results))
        rows.append((job.name, agreement(each.rows), *times, _ended(each)))
    print_table(("scene", "rows", "SAM", "FEM", ""), rows, red=[not each.passed for each in found])


def _verdict(jobs: Sequence[Job], found: Sequence[Compared]) -> str:
    """How many scenes agree, which do not, and the cost."""
    wrong = [job.name for job, each in zip(jobs, found, strict=True) if not each.passed]
    sam, fem = (with_time(sum(seconds(each.results[k]) for each in found)) for k in (0, 1))
    agree = f"{len(jobs) - len(wrong)} of {len(jobs)} scenes agree"
    return agree + f", not {', '.join(wrong)}" * bool(wrong) + f"; SAM {sam}, FEM {fem}"


def _show(job: Job, found: Compared, *, figures: bool) -> None:
    """The rows, the verdict on a film, and what was written."""
    of_data = [{row.quantity: row for row in rows} for rows in found.beside]
    heads = [head for data in found.data for head in (data.name, "")]
    both, cells, red = {each.quantity: each for each in found.uncertain}, [], []
    for row in found.rows:
        numbers = map(digits, (row.value, row.expected))
        line = [row.quantity, *numbers, digits(row.error, 3), digits(row.row.tolerance), _ended(row)]
        for own in (rows.get(row.quantity) for rows in of_data):
            line += [digits(None if own is None else own.expected), _beside(own)]
        if both:
            around = both.get(row.quantity)
            line.append(f"{digits(around.u_num, 2)}{'' if around.holds else ' exceeded'}" if around else "")
        cells.append(line)
        red.append("FAILED" in " ".join(line))
    heads += ["u_num"] * bool(both)
    print_table(("quantity", "sam", "fem", "difference", "tolerance", "", *heads), cells, red=red)
    if found.film is not None:
        print(found.film.words + ("" if found.claim else NOT_JUDGED))
    print(job.folder / COMPARISON)
    if figures:
        print(*sorted((job.folder / FIGURES).iterdir()), sep="\n")


def _ended(row: Verdict | Compared) -> str:
    return "passed" if row.passed else "FAILED"


def _beside(row: Verdict | None) -> str:
    """What became of a row of data, with its difference."""
    return NOT_COMPARED if row is None else f"{digits(row.error, 3)} {_ended(row)}"


def _judge(found: Compared) -> int:
    """Exit code; what did not hold, and what to change, on stderr."""
    code, scene, off = unconverged(found.results), found.scene, found.off
    claimed = [row.quantity for row in found.failed if row.row.metric == CLAIM]
    failed = [row.quantity for row in found.failed if row.row.metric != CLAIM]
    if failed and not code:  # else there is something to change first
        layers = "raise the number of layers in grid" if scene.body.plasticity is not None else ""
        mesh = finer_mesh(scene) if scene.patch_surface is None else ""  # rough: both have the same cells
        advice = either(finer_cells(scene), layers, mesh) or "lower grid.extent"
        finer = f"to see whether the meshes are too coarse, {advice}, and compare again"
        print(f"samfem: outside the tolerance: {', '.join(failed)}: {finer}", file=sys.stderr)
    if claimed:
        print(f"samfem: the film is not negligible: {', '.join(claimed)}", file=sys.stderr)
    for name in dict.fromkeys(name for name, _ in off):
        quantities = ", ".join(row.quantity for other, row in off if other == name)
        print(f"samfem: {name} is outside the tolerance: {quantities}", file=sys.stderr)
    return 1 if code or failed or claimed or off else 0
