# SPDX-License-Identifier: MIT
"""The command solve: from a scene file to the folder of a result and an exit code.

Wrong input raises SceneError, ModelError or FolderError before anything is solved or written.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Sequence
from pathlib import Path

from sam.scene import Checkpoint, Result, Scene, read_scene
from verification.app.shown import load_line, quantity_rows, status_line
from verification.cost.plan import check_memory
from verification.figures import solve_figures
from verification.figures.space import CannotDrawError, draw_run
from verification.runs import checkpoints, models
from verification.runs.files import CHECKPOINT, Run, check_target, read_run, write_run
from verification.runs.lock import locked
from verification.runs.provenance import collect
from verification.runs.store import Reuse, Store, default_store, solve_or_reuse
from verification.text.console import Progress, print_table


def solve(path: Path, *, model: str, out: Path | None, figures: bool, resume: bool = False) -> int:
    """Solve a scene into a folder; 0 if converged, else 1 with status and advice on stderr.

    resume: go on from the checkpoint in the folder, and do nothing where the result is there already.
    """
    scene, inputs = read_scene(path)
    folder = out or Path(f"{path.stem}-{model}")
    check(scene, model)
    check_target(folder)
    with locked(folder):
        return _solve(scene, model, folder, inputs, figures=figures, resume=resume)


def _solve(
    scene: Scene, model: str, folder: Path, inputs: dict[str, bytes], *, figures: bool, resume: bool
) -> int:
    if resume and checkpoints.is_finished(folder, scene, model):
        result = read_run(folder)
        print(f"samfem: {folder} is already finished: nothing is solved", file=sys.stderr)
    else:
        result = _solved_in_parts(scene, model, folder, inputs, resume=resume)
    print(*filter(None, (status_line(result), load_line(result))), sep="\n")
    print_table(("quantity", model), quantity_rows(result, sys.stdout.isatty()))
    print(folder / "summary.json")
    if figures:
        print(*solve_figures(folder), sep="\n")
        try:
            print(*draw_run(folder), sep="\n")
        except CannotDrawError as error:
            print(f"samfem: {error}", file=sys.stderr)
    return unconverged([result])


def _solved_in_parts(
    scene: Scene, model: str, folder: Path, inputs: dict[str, bytes], *, resume: bool
) -> Result:
    """A fresh result, written to `folder`, of a solve that may be interrupted and continued."""

    def say(text: str) -> None:
        print(f"samfem: {text}", file=sys.stderr, flush=True)

    seconds, who = checkpoints.interval(), checkpoints.identity(scene, model)
    start = _start(scene, folder, who, say) if resume else _begin(folder, say)
    writer = checkpoints.Writer(folder, who, seconds, start, warn=say)
    with checkpoints.interruptible(writer):
        how = {"fresh": True, "checkpoint": writer, "start": start}
        return solved(scene, model, folder, inputs, store=default_store(), **how)


def _begin(folder: Path, say: Callable[[str], None]) -> None:
    """Begin anew, and say so where a checkpoint is in the folder."""
    if (folder / CHECKPOINT).exists():
        say(f"a checkpoint of an interrupted run is in {folder}, and is replaced; --resume continues it")


def _start(
    scene: Scene, folder: Path, who: dict[str, object], say: Callable[[str], None]
) -> Checkpoint | None:
    """The checkpoint to go on from; says where it begins, or why there is none.

    Raises FolderError for the checkpoint of something else.
    """
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


def solved(
    scene: Scene,
    model: str,
    folder: Path,
    inputs: dict[str, bytes],
    *,
    store: Store | None,
    fresh: bool = False,
    **how,
) -> Result:
    """The result of a scene from the store, or solved and kept there; written to `folder`.

    fresh, how: see `solve_or_reuse`.
    """
    with Progress(remaining=True) as progress:
        result, source = solve_or_reuse(
            store,
            scene,
            model,
            lambda stage, done, total: progress(f"{model}: {stage}", done, total),
            fresh=fresh,
            **how,
        )
    write_solved(scene, folder, result, source=source, inputs=inputs)
    return result


def write_solved(
    scene: Scene, folder: Path, result: Result, *, source: Reuse, inputs: dict[str, bytes]
) -> None:
    """Write a result to `folder`, and say on stderr where it is from and what it warns of."""
    for text in (source.text, *result.warnings):
        if text:
            print(f"samfem: {result.model}: {text}", file=sys.stderr)
    write_run(result, scene, folder, collect(inputs, scene.seeds) | source.provenance)


def check(scene: Scene, *names: str) -> None:
    """Raise ModelError unless each model can represent the scene, and within the memory of the machine."""
    for model in names:
        models.check(scene, model)
        check_memory(scene, model)


def unconverged(results: Sequence[Result | Run]) -> int:
    """Exit code 1 if a result did not converge, with its status and what to change on stderr; else 0."""
    ended = [result for result in results if not result.converged]
    for result in ended:
        message = result.message or result.status.advice
        print(f"samfem: {result.model}: {result.status}: {message}", file=sys.stderr)
    return 1 if ended else 0
