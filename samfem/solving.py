# SPDX-License-Identifier: MIT
"""The command solve: from a scene file to the folder of a result and an exit code.

Wrong input raises SceneError, ModelError or FolderError before anything is solved or written.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from shutil import rmtree

from sam.scene import Checkpoint, Result, Scene, read_scene
from samfem.shown import (
    load_line,
    quantity_rows,
    status_line,
    uncertain_lines,
    uncertain_table,
    undecided_line,
)
from verification.cost.accuracy import chosen_scene, first_choice, missed, solve as solve_family
from verification.cost.plan import check_needs
from verification.figures import solve_figures
from verification.figures.space import CannotDrawError, draw_run
from verification.runs import checkpoints, models
from verification.runs.files import CHECKPOINT, MEMBERS, Run, check_target, read_run, write_run
from verification.runs.lock import locked
from verification.runs.provenance import collect
from verification.runs.store import Reuse, Store, default_store, solve_or_reuse
from verification.text.console import Progress, print_table
from verification.uncertainty import asked_of as with_uncertainty


def solve(
    path: Path,
    *,
    model: str,
    out: Path | None,
    figures: bool,
    resume: bool = False,
    uncertainty: bool = False,
    anyway: bool = False,
) -> int:
    """Solve a scene into a folder; 0 if converged, else 1 with status and advice on stderr.

    resume: go on from the checkpoint in the folder, and do nothing where the result is there
    already; uncertainty: of all quantities, as [solver] of the scene may ask for it too; anyway:
    however long that takes, as what is resumed does.
    """
    scene, inputs = read_scene(path)
    if uncertainty:
        scene = with_uncertainty(scene, str(path))
    folder = out or Path(f"{path.stem}-{model}")
    check(scene, model, anyway=anyway or resume)
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
        result = _solved(scene, model, folder, inputs, resume=resume)
    heads = status_line(result), undecided_line(result), load_line(result)
    print(*filter(None, heads), sep="\n")
    if result.uncertainty:
        print_table(*uncertain_table(result, sys.stdout.isatty()))
        print(*uncertain_lines(result), sep="\n")
    else:
        print_table(("quantity", model), quantity_rows(result, sys.stdout.isatty()))
    print(folder / "summary.json")
    if figures:
        print(*solve_figures(folder), sep="\n")
        try:
            print(*draw_run(folder), sep="\n")
        except CannotDrawError as error:
            print(f"samfem: {error}", file=sys.stderr)
    return unconverged([result])


def _solved(scene: Scene, model: str, folder: Path, inputs: dict[str, bytes], *, resume: bool) -> Result:
    """A fresh result, written to `folder`, of a solve that may be interrupted and continued."""

    def write(result: Result, source: Reuse) -> None:
        write_solved(scene, folder, result, source=source, inputs=inputs)

    if not (scene.solver.uncertainty or scene.solver.accuracy):
        if not resume and (folder / CHECKPOINT).exists():
            _say(f"a checkpoint of an interrupted run is in {folder}, and is replaced; --resume continues it")
        return _in_parts(scene, model, folder, resume=resume, write=write)
    place = folder / MEMBERS  # of a scene with its uncertainty: what is finished, until all is
    if not resume:
        rmtree(place, ignore_errors=True)
    kept = Store(place)

    def member(each: Scene, label: str) -> Result:
        if (found := kept.lookup(each, model).result) is not None:
            _say(f"{label}: already solved")
            return found
        try:
            begun = (place / CHECKPOINT).exists()
            result = _in_parts(each, model, place, label=f", {label}", resume=begun)
        except KeyboardInterrupt as stop:
            text = str(stop) or f"interrupted: --resume continues with {label}"
            raise KeyboardInterrupt(text) from None
        (place / CHECKPOINT).unlink(missing_ok=True)
        kept.keep(each, model, result)
        return result

    result = solve_family(scene, model, member)
    write(result, Reuse(False))
    return result


def _in_parts(
    scene: Scene,
    model: str,
    place: Path,
    *,
    resume: bool,
    label: str = "",
    write: Callable[[Result, Reuse], None] = lambda *_: None,
) -> Result:
    """A fresh result, with checkpoints in a folder; write: what an interruption may not leave half done."""
    seconds, who = checkpoints.interval(), checkpoints.identity(scene, model)
    start = _start(scene, place, who) if resume else None
    writer = checkpoints.Writer(place, who, seconds, start, warn=_say)
    how = {"fresh": True, "checkpoint": writer, "start": start}
    with checkpoints.interruptible(writer):
        with Progress(remaining=True) as progress:

            def told(stage: str, done: int, total: int) -> None:
                progress(f"{model}{label}: {stage}", done, total)

            result, source = solve_or_reuse(default_store(), scene, model, told, **how)
        write(result, source)
    return result


def _say(text: str) -> None:
    print(f"samfem: {text}", file=sys.stderr, flush=True)


def _start(scene: Scene, folder: Path, who: dict[str, object]) -> Checkpoint | None:
    """The checkpoint to go on from; says where it begins, or why there is none.

    Raises FolderError for the checkpoint of something else.
    """
    if scene.body.plasticity is None:
        _say("an elastic scene has no checkpoint: solved from the beginning")
        return None
    try:
        start = checkpoints.read(folder, who)
    except checkpoints.ArchiveError as error:
        _say(f"{error}: solved from the beginning")
        return None
    if start is None:
        _say(f"no checkpoint in {folder}: solved from the beginning")
    elif start.done < start.total:
        _say(f"continued from step {start.done + 1} of {start.total}")
    else:
        _say(f"continued after the last of {start.total} steps")
    return start


def write_solved(
    scene: Scene, folder: Path, result: Result, *, source: Reuse, inputs: dict[str, bytes]
) -> None:
    """Write a result to `folder`, and say on stderr where it is from and what it warns of."""
    for text in (source.text, *result.warnings):
        if text:
            print(f"samfem: {result.model}: {text}", file=sys.stderr)
    write_run(result, scene, folder, collect(inputs, scene.seeds) | source.provenance)


def check(scene: Scene, *names: str, anyway: bool = False) -> None:
    """Raise ModelError unless each model can represent the scene within the memory of the machine,
    and, unless `anyway`, in the time that a command begins unasked.
    """
    for model in names:
        chosen = scene
        if scene.solver.accuracy is not None:
            models.check(scene, model)
            chosen = chosen_scene(scene, model, first_choice(scene, model))
        check_needs(chosen, model, anyway=anyway)


def unconverged(results: Sequence[Result | Run]) -> int:
    """Exit code 1 if a result did not converge, with its status and what to change on stderr; else 0."""
    ended = [result for result in results if not result.converged]
    for result in ended:
        message = result.message or result.status.advice
        print(f"samfem: {result.model}: {result.status}: {message}", file=sys.stderr)
    short = [(result.model, words) for result in results if (words := missed(result))]
    for model, words in short:
        print(f"samfem: {model}: {words}", file=sys.stderr)
    return 1 if ended or short else 0
