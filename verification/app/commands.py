# SPDX-License-Identifier: MIT
"""The commands solve, plan and compare: from a scene file to a folder and an exit code.

Wrong input raises SceneError, ModelError or FolderError before anything is solved or written.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from sam.scene import Problem, Result, Scene, SceneError, read_scene
from sam.scene.checkpoint import Checkpoint
from sam.scene.errors import spelling
from sam.scene.remedies import either, finer_cells, finer_mesh
from verification.app.shown import load_line, quantity_rows, status_line
from verification.runs import checkpoints, models
from verification.runs.files import (
    CHECKPOINT,
    FolderError,
    Run,
    check_target,
    clear_run,
    csv_text,
    json_text,
    read_run,
    write_atomically,
    write_run,
)
from verification.runs.lock import locked
from verification.runs.provenance import collect
from verification.runs.store import Store, default_store, solve_or_reuse
from verification.text.console import Progress, digits, print_table

if TYPE_CHECKING:
    from verification.compare.comparison import Row
    from verification.compare.verdicts import Verdict

COMPARISON, VERDICT = "compare.csv", "verdict.json"
PARTS = {models.SAM: "sam", models.FEM: "fem", models.FEM_3D: "fem"}


def solve(path: Path, model: str, out: Path | None, figures: bool, resume: bool = False) -> int:
    """Solve a scene into a folder; 0 if converged, else 1 with status and advice on stderr.

    resume: go on from the checkpoint in the folder, and do nothing where the result is there already.
    """
    scene, inputs = read_scene(path)
    folder = out or Path(f"{path.stem}-{model}")
    _check(scene, model)
    check_target(folder)
    with locked(folder):
        return _solve(scene, model, folder, inputs, figures, resume)


def _solve(
    scene: Scene, model: str, folder: Path, inputs: dict[str, bytes], figures: bool, resume: bool
) -> int:
    if resume and checkpoints.is_finished(folder, scene, model):
        result = read_run(folder)
        print(f"samfem: {folder} is already finished: nothing is solved", file=sys.stderr)
    else:
        result = _solved_in_parts(scene, model, folder, inputs, resume)
    print(*filter(None, (status_line(result), load_line(result))), sep="\n")
    print_table(("quantity", model), quantity_rows(result, sys.stdout.isatty()))
    print(folder / "summary.json")
    if figures:
        from verification.figures import solve_figures

        for drawn in solve_figures(folder):
            print(drawn)
    return _judge(scene, [result])


def plan(path: Path, as_json: bool) -> int:
    """Print what the scene will compute."""
    from verification.cost.plan import advice_lines, model_lines
    from verification.cost.plan import plan as planned

    scene, _ = read_scene(path)
    content = planned(scene)
    if as_json:
        print(json_text(content).rstrip())
        return 0
    print("\n".join(advice_lines(content)))
    table = content["advice"]["table"]
    if table["rows"]:
        print_table(table["columns"], table["rows"])
    print("\n".join(model_lines(content)))
    return 0


def compare(
    path: Path,
    model: str | None,
    out: Path | None,
    use_store: bool = True,
    figures: bool = False,
    claim: str | None = None,
) -> int:
    """Solve with SAM and `model`, write DIR/sam, DIR/fem and compare.csv; 0 if both converged and every row
    held.

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
    _check(scene, models.SAM, model)
    _check_comparison(folder)
    with locked(folder):
        results = _solved_by_both(scene, model, folder, inputs, default_store() if use_store else None)
        code = _compare(scene, results, folder, claim or (scene.compare and scene.compare.claim))
        if figures:
            from verification.figures import compare_figures

            for drawn in compare_figures(folder, folder / PARTS[models.SAM], folder / PARTS[model]):
                print(drawn)
        return code


def _solved_by_both(
    scene: Scene, model: str, folder: Path, inputs: dict[str, bytes], store: Store | None
) -> list[Result]:
    """Results of SAM and `model`, written to their folders; what an older comparison says is removed."""
    for name in (COMPARISON, VERDICT):
        (folder / name).unlink(missing_ok=True)
    if folder.exists():
        clear_run(folder)  # figures of an older comparison
    return [_solved(store, scene, name, folder / PARTS[name], inputs) for name in (models.SAM, model)]


def _compare(scene: Scene, results: Sequence[Result], folder: Path, claim: str | None) -> int:
    """Write and show the rows; the exit code. claim: the one that is judged by it too, if any."""
    from verification.compare.comparison import COLUMNS, compare_scene, table_rows

    rows, words = compare_scene(scene, *results), ""
    if scene.body.coating:
        from verification.compare.verdicts import NOT_JUDGED, change_rows, claim_rows

        found = _verdict(scene, results, folder)
        rows += change_rows(*results) + (claim_rows(found, *results) if claim else [])
        words = found.words + ("" if claim else NOT_JUDGED)
    write_atomically(folder / COMPARISON, csv_text(COLUMNS, table_rows(rows)).encode())
    _show(rows)
    if words:
        print(words)
    print(folder / COMPARISON)
    return _judge(scene, results, rows)


def _verdict(scene: Scene, results: Sequence[Result], folder: Path) -> Verdict:
    """Whether the film is negligible, also as verdict.json."""
    from verification.compare.verdicts import verdict

    found = verdict(scene, *results)
    write_atomically(folder / VERDICT, json_text(found.content()).encode())
    return found


def _solved_in_parts(
    scene: Scene, model: str, folder: Path, inputs: dict[str, bytes], resume: bool
) -> Result:
    """A fresh result, written to `folder`, of a solve that may be interrupted and continued."""

    def say(text: str) -> None:
        print(f"samfem: {text}", file=sys.stderr, flush=True)

    seconds, who = checkpoints.interval(), checkpoints.identity(scene, model)
    start = _start(scene, folder, who, resume, say)
    writer = checkpoints.Writer(folder, who, seconds, start, say)
    with checkpoints.interruptible(writer):
        return _solved(
            default_store(), scene, model, folder, inputs, fresh=True, checkpoint=writer, start=start
        )


def _start(
    scene: Scene, folder: Path, who: dict[str, object], resume: bool, say: Callable[[str], None]
) -> Checkpoint | None:
    """The checkpoint to go on from; why there is none, or that there is one, is said. Raises FolderError for
    another's.
    """
    if not resume:
        if (folder / CHECKPOINT).exists():
            say(f"a checkpoint of an interrupted run is in {folder}, and is replaced; --resume continues it")
        return None
    if scene.body.plasticity is None:
        say("an elastic scene has no checkpoint: solved from the beginning")
        return None
    try:
        start = checkpoints.read(folder, who)
    except checkpoints.DamagedError as error:
        say(f"{error}: solved from the beginning")
        return None
    if start is None:
        say(f"no checkpoint in {folder}: solved from the beginning")
    elif start.done < start.total:
        say(f"continued from step {start.done + 1} of {start.total}")
    else:
        say(f"continued after the last of {start.total} steps")
    return start


def _solved(
    store: Store | None,
    scene: Scene,
    model: str,
    folder: Path,
    inputs: dict[str, bytes],
    fresh: bool = False,
    **how,
) -> Result:
    """A result from the store, or solved and kept there, and written to `folder`; fresh, how: see
    solve_or_reuse.
    """
    with Progress(remaining=True) as progress:
        result, source = solve_or_reuse(
            store,
            scene,
            model,
            lambda stage, done, total: progress(f"{model}: {stage}", done, total),
            fresh,
            **how,
        )
    for text in (source.text, *result.warnings):
        if text:
            print(f"samfem: {model}: {text}", file=sys.stderr)
    write_run(result, scene, folder, collect(inputs, scene.seeds) | source.provenance)
    return result


def _check(scene: Scene, *names: str) -> None:
    """Raise ModelError unless each model can represent the scene, and within the memory of the machine."""
    from verification.cost.plan import check_memory

    for model in names:
        models.check(scene, model)
        check_memory(scene, model)


def _check_comparison(folder: Path) -> None:
    """Raise FolderError unless the folder is new, empty or of an older comparison."""
    check_target(folder, also=(COMPARISON, VERDICT, *PARTS.values()))
    if (folder / "summary.json").exists():
        raise FolderError(
            f"{folder} holds a single run: give a new or empty folder, or one of an older comparison"
        )
    for part in PARTS.values():
        check_target(folder / part)


def _show(rows: Sequence[Row]) -> None:
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


def _judge(scene: Scene, results: Sequence[Result | Run], rows: Sequence[Row] = ()) -> int:
    """Exit code; what did not hold, and what to change, on stderr."""
    unconverged = [result for result in results if not result.converged]
    for result in unconverged:
        message = result.message or result.status.advice
        print(f"samfem: {result.model}: {result.status}: {message}", file=sys.stderr)
    failed, claimed = _broken(rows) if rows else ([], [])
    if failed and not unconverged:  # else there is something to change first
        finer = f"to see whether the meshes are too coarse, {_finer(scene)}, and compare again"
        print(f"samfem: outside the tolerance: {', '.join(failed)}: {finer}", file=sys.stderr)
    if claimed:
        print(f"samfem: the film is not negligible: {', '.join(claimed)}", file=sys.stderr)
    return 1 if unconverged or failed or claimed else 0


def _finer(scene: Scene) -> str:
    """What to refine of both models."""
    layers = "raise the number of layers in grid" if scene.body.plasticity is not None else ""
    mesh = (
        "" if scene.surface is not None else finer_mesh(scene)
    )  # of a rough scene the cells are those of both models
    return either(finer_cells(scene), layers, mesh) or "lower grid.extent"


def _broken(rows: Sequence[Row]) -> tuple[list[str], list[str]]:
    """Quantities outside of their tolerance, and those that break the claim of a negligible film."""
    from verification.compare.verdicts import CLAIM

    broken = [row for row in rows if not row.passed]
    claimed = [row.quantity for row in broken if row.metric == CLAIM]
    return [row.quantity for row in broken if row.metric != CLAIM], claimed
