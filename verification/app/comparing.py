# SPDX-License-Identifier: MIT
"""The command compare: a scene solved by SAM and a finite-element model, row by row.

Wrong input raises SceneError, ModelError or FolderError before anything is solved or written.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path

from sam.scene import Result, Scene, either, finer_cells, finer_mesh, read_scene
from verification.app.compared import Compared, Question, asked
from verification.app.solving import unconverged, write_solved
from verification.compare.rows import COLUMNS, Comparison, table_rows
from verification.compare.verdicts import CLAIM, NOT_JUDGED
from verification.figures import compare_figures
from verification.runs import models
from verification.runs.files import (
    SUMMARY,
    FolderError,
    Run,
    check_target,
    clear_run,
    json_text,
    write_atomically,
)
from verification.runs.lock import locked
from verification.runs.store import Reuse, Store, default_store
from verification.runs.tables import csv_text
from verification.text.console import Progress, digits, print_table

COMPARISON, VERDICT = "compare.csv", "verdict.json"
PARTS = {models.SAM: "sam", models.FEM: "fem", models.FEM_3D: "fem"}


def compare(
    path: Path,
    *,
    model: str | None = None,
    out: Path | None = None,
    use_store: bool = True,
    figures: bool = False,
    claim: str | None = None,
) -> int:
    """Solve with SAM and `model`, and write DIR/sam, DIR/fem and compare.csv.

    Returns 0 if both converged and every row held.

    model: None takes the cheapest that can represent the scene; use_store: take what the store holds, and
    keep there what is solved; figures: also draw both into DIR/figures; claim: judged too, like that of
    [compare] in the scene.
    """
    scene, inputs = read_scene(path)
    folder = out or Path(f"{path.stem}-compare")
    question = asked(scene, model=model, claim=claim, source=str(path))
    _check_comparison(folder)
    with locked(folder):
        found = _answered(question, folder, inputs, store=default_store() if use_store else None)
        _write(found, folder)
        if figures:
            for drawn in compare_figures(folder, folder / PARTS[models.SAM], folder / PARTS[question.model]):
                print(drawn)
        print(found.line)
        return _judge(scene, found.results, found.rows)


def _answered(question: Question, folder: Path, inputs: dict[str, bytes], *, store: Store | None) -> Compared:
    """The comparison, each run written to its folder once it is there; what an older one says is removed."""
    for name in (COMPARISON, VERDICT):
        (folder / name).unlink(missing_ok=True)
    if folder.exists():
        clear_run(folder)  # figures of an older comparison

    def solved(model: str, result: Result, source: Reuse) -> None:
        write_solved(question.scene, folder / PARTS[model], result, source=source, inputs=inputs)

    with Progress(remaining=True) as progress:
        return question.answer(store=store, progress=progress, solved=solved)


def _write(found: Compared, folder: Path) -> None:
    """Write and show the rows, and the verdict on a film."""
    if found.film is not None:
        write_atomically(folder / VERDICT, json_text(found.film.content()).encode())
    write_atomically(folder / COMPARISON, csv_text(COLUMNS, table_rows(found.rows)).encode())
    _show(found.rows)
    if found.film is not None:
        print(found.film.words + ("" if found.claim else NOT_JUDGED))
    print(folder / COMPARISON)


def _check_comparison(folder: Path) -> None:
    """Raise FolderError unless the folder is new, empty or of an older comparison."""
    check_target(folder, also=(COMPARISON, VERDICT, *PARTS.values()))
    if (folder / SUMMARY).exists():
        raise FolderError(
            f"{folder} holds a single run: give a new or empty folder, or one of an older comparison"
        )
    for part in PARTS.values():
        check_target(folder / part)


def _show(rows: Sequence[Comparison]) -> None:
    cells = [
        (
            row.quantity,
            digits(row.sam),
            digits(row.fem),
            digits(row.difference, 3),
            digits(row.tolerance),
            "passed" if row.passed else "FAILED",
        )
        for row in rows
    ]
    columns = ("quantity", "sam", "fem", "difference", "tolerance", "")
    print_table(columns, cells, red=[not row.passed for row in rows])


def _judge(scene: Scene, results: Sequence[Result | Run], rows: Sequence[Comparison]) -> int:
    """Exit code; what did not hold, and what to change, on stderr."""
    code, (failed, claimed) = unconverged(results), _broken(rows)
    if failed and not code:  # else there is something to change first
        finer = f"to see whether the meshes are too coarse, {_finer(scene)}, and compare again"
        print(f"samfem: outside the tolerance: {', '.join(failed)}: {finer}", file=sys.stderr)
    if claimed:
        print(f"samfem: the film is not negligible: {', '.join(claimed)}", file=sys.stderr)
    return 1 if code or failed or claimed else 0


def _finer(scene: Scene) -> str:
    """What to refine of both models."""
    layers = "raise the number of layers in grid" if scene.body.plasticity is not None else ""
    mesh = finer_mesh(scene) if scene.surface is None else ""  # of a rough scene both have the same cells
    return either(finer_cells(scene), layers, mesh) or "lower grid.extent"


def _broken(rows: Sequence[Comparison]) -> tuple[list[str], list[str]]:
    """Quantities outside of their tolerance, and those that break the claim of a negligible film."""
    broken = [row for row in rows if not row.passed]
    claimed = [row.quantity for row in broken if row.metric == CLAIM]
    return [row.quantity for row in broken if row.metric != CLAIM], claimed
