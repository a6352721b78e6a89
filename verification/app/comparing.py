# SPDX-License-Identifier: MIT
"""The command compare: a scene solved by SAM and a finite-element model, row by row.

Wrong input raises SceneError, ModelError or FolderError before anything is solved or written.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path

from sam.scene import (
    Problem,
    Result,
    Scene,
    SceneError,
    either,
    finer_cells,
    finer_mesh,
    read_scene,
    spelling,
)
from verification.app.solving import check, solved, unconverged
from verification.compare.comparison import compare_scene
from verification.compare.rows import COLUMNS, Comparison, table_rows
from verification.compare.verdicts import CLAIM, NOT_JUDGED, FilmVerdict, change_rows, claim_rows, verdict
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
from verification.runs.store import Store, default_store
from verification.runs.tables import csv_text
from verification.text.console import digits, print_table

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
    if claim is not None and scene.body.coating is None:
        raise SceneError(
            [Problem("--claim", spelling(claim), "only for a scene with [body.coating]")], str(path)
        )
    folder = out or Path(f"{path.stem}-compare")
    model = model or models.cheapest_reference(scene)
    check(scene, models.SAM, model)
    _check_comparison(folder)
    with locked(folder):
        results = _solved_by_both(scene, model, folder, inputs, store=default_store() if use_store else None)
        code = _compare(scene, results, folder, claim or (scene.compare and scene.compare.claim))
        if figures:
            for drawn in compare_figures(folder, folder / PARTS[models.SAM], folder / PARTS[model]):
                print(drawn)
        return code


def _solved_by_both(
    scene: Scene, model: str, folder: Path, inputs: dict[str, bytes], *, store: Store | None
) -> list[Result]:
    """Results of SAM and `model`, written to their folders; what an older comparison says is removed."""
    for name in (COMPARISON, VERDICT):
        (folder / name).unlink(missing_ok=True)
    if folder.exists():
        clear_run(folder)  # figures of an older comparison
    return [solved(scene, name, folder / PARTS[name], inputs, store=store) for name in (models.SAM, model)]


def _compare(scene: Scene, results: Sequence[Result], folder: Path, claim: str | None) -> int:
    """Write and show the rows; the exit code. claim: the one that is judged by it too, if any."""
    rows, words = compare_scene(scene, *results), ""
    if scene.body.coating:
        found = _verdict(scene, results, folder)
        rows += change_rows(*results) + (claim_rows(found, *results) if claim else [])
        words = found.words + ("" if claim else NOT_JUDGED)
    write_atomically(folder / COMPARISON, csv_text(COLUMNS, table_rows(rows)).encode())
    _show(rows)
    if words:
        print(words)
    print(folder / COMPARISON)
    return _judge(scene, results, rows)


def _verdict(scene: Scene, results: Sequence[Result], folder: Path) -> FilmVerdict:
    """Whether the film is negligible, also as verdict.json."""
    found = verdict(scene, *results)
    write_atomically(folder / VERDICT, json_text(found.content()).encode())
    return found


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
