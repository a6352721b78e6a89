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

    resume: go on from the checkpoint in the folder, and do nothing where the result is there already;
    uncertainty: of all quantities, as [solver] of the scene may ask for it too; anyway: however long that
    takes, as what is resumed does.
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
        result = _solved_in_parts(scene, model, folder, inputs, resume=resume)
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


def _solved_in_parts(
    scene: Scene, model: str, folder: Path, inputs: dict[str, bytes], *, resume: bool
) -> Result:
    """A fresh result, written to `folder`, of a solve that may be interrupted and continued."""

    def say(text: str) -> None:
        print(f"samfem: {text}", file=sys.stderr, flush=True)

    if scene.solver.uncertainty or scene.solver.accuracy:
        return _solved_family(scene, model, folder, inputs, resume=resume, say=say)
    seconds, who = checkpoints.interval(), checkpoints.identity(scene, model)
    start = _start(scene, folder, who, say) if resume else _begin(folder, say)
    writer = checkpoints.Writer(folder, who, seconds, start, warn=say)
    with checkpoints.interruptible(writer):
        how = {"fresh": True, "checkpoint": writer, "start": start}
        return solved(scene, model, folder, inputs, store=default_store(), **how)


def _solved_family(
    scene: Scene,
    model: str,
    folder: Path,
    inputs: dict[str, bytes],
    *,
    resume: bool,
    say: Callable[[str], None],
) -> Result:
    """The same of a scene with its uncertainty: what is finished of it is kept in the folder until all is."""
    place = folder / MEMBERS
    if not resume:
        rmtree(place, ignore_errors=True)
    kept, seconds = Store(place), checkpoints.interval()

    def member(each: Scene, label: str) -> Result:
        if (found := kept.lookup(each, model).result) is not None:
            say(f"{label}: already solved")
            return found
        who = checkpoints.identity(each, model)
        start = _start(each, place, who, say) if (place / CHECKPOINT).exists() else None
        writer = checkpoints.Writer(place, who, seconds, start, warn=say)
        try:
            with checkpoints.interruptible(writer), Progress(remaining=True) as progress:
                told = _telling(progress, f"{model}, {label}")
                how = {"fresh": True, "checkpoint": writer, "start": start}
                result = solve_or_reuse(default_store(), each, model, told, **how)[0]
        except KeyboardInterrupt as stop:
            text = str(stop) or f"interrupted: --resume continues with {label}"
            raise KeyboardInterrupt(text) from None
        (place / CHECKPOINT).unlink(missing_ok=True)
        kept.keep(each, model, result)
        return result

    result = solve_family(scene, model, member)
    write_solved(scene, folder, result, source=Reuse(False), inputs=inputs)
    return result


def _telling(progress: Progress, who: str) -> Callable[[str, int, int], None]:
    """Shows how far a solve is, with its name."""
    return lambda stage, done, total: progress(f"{who}: {stage}", done, total)


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
        told = _telling(progress, model)
        result, source = solve_or_reuse(store, scene, model, told, fresh=fresh, **how)
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


def check(scene: Scene, *names: str, anyway: bool = False) -> None:
    """Raise ModelError unless each model can represent the scene within the memory of the machine, and,
    unless `anyway`, in the time that a command begins unasked.
    """
    for model in names:
        models.check(scene, model)
        accurate = scene.solver.accuracy is not None
        chosen = chosen_scene(scene, model, first_choice(scene, model)) if accurate else scene
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
