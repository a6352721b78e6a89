# SPDX-License-Identifier: MIT
"""The commands plan and solve: what a scene will compute, and from its file to the folder of a result,
what is printed of it and an exit code.

Wrong input raises SceneError, ModelError or FolderError before anything is solved or written.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from shutil import rmtree
from typing import Any

from sam.scene import Checkpoint, Result, Scene, Status, read_scene
from verification.cost import plan as plans
from verification.cost.accuracy import chosen_scene, first_choice, missed, solve as solve_family
from verification.runs import checkpoints, models
from verification.runs.archive import ArchiveError
from verification.runs.files import CHECKPOINT, MEMBERS, Run, check_target, json_text, read_run, write_run
from verification.runs.lock import locked
from verification.runs.meshes import not_written
from verification.runs.model_range import refusal
from verification.runs.provenance import collect
from verification.runs.store import Reuse, Store, default_store, solve_or_reuse
from verification.text.console import Progress, print_table, table_lines
from verification.text.readable import in_working_unit, with_prefix, with_time
from verification.uncertainty import asked_of as with_uncertainty

ROUNDING = 1e-12
"""Of the contact radius: a length below it is shown as 0 to a person."""


def plan(path: Path, as_json: bool) -> int:
    """Print what the scene will compute. Raises ModelError for a contact beyond the range of every model."""
    scene, _ = read_scene(path)
    if reason := refusal(scene):
        raise models.ModelError(reason)
    content = plans.plan(scene)
    if as_json:
        print(json_text(content).rstrip())
        return 0
    print("\n".join(plans.advice_lines(content)))
    table = content["advice"]["table"]
    if table["rows"]:
        print_table(table["columns"], table["rows"])
    print("\n".join(plans.model_lines(content)))
    return 0


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
    made = check(scene, model, anyway=anyway or resume)
    check_target(folder)
    with locked(folder):
        return _solve(scene, model, folder, inputs, made=made, figures=figures, resume=resume)


def _solve(
    scene: Scene,
    model: str,
    folder: Path,
    inputs: dict[str, bytes],
    *,
    made: Any,
    figures: bool,
    resume: bool,
) -> int:
    if resume and checkpoints.is_finished(folder, scene, model):
        result: Result | Run = read_run(folder)
        print(f"samfem: {folder} is already finished: nothing is solved", file=sys.stderr)
    else:
        result = _solved(scene, model, folder, inputs, made=made, resume=resume)
    heads = status_line(result), undecided_line(result), load_line(result)
    print(*filter(None, heads), sep="\n")
    if result.uncertainty:
        print_table(*uncertain_table(result, sys.stdout.isatty()))
        print(*uncertain_lines(result), sep="\n")
    else:
        print_table(("quantity", model), quantity_rows(result, sys.stdout.isatty()))
    print(folder / "summary.json")
    if figures:
        from verification.figures import solve_figures  # noqa: PLC0415 - not needed without
        from verification.figures.space import CannotDrawError, draw_run  # noqa: PLC0415

        print(*solve_figures(folder), sep="\n")
        try:
            print(*draw_run(folder), sep="\n")
        except CannotDrawError as error:
            print(f"samfem: {error}", file=sys.stderr)
    return unconverged([result])


def _solved(
    scene: Scene, model: str, folder: Path, inputs: dict[str, bytes], *, made: Any, resume: bool
) -> Result:
    """A fresh result, written to `folder`, of a solve that may be continued; made: its plan."""

    def write(result: Result, source: Reuse) -> None:
        write_solved(scene, folder, result, source=source, inputs=inputs)

    if not (scene.solver.uncertainty or scene.solver.accuracy):
        if not resume and (folder / CHECKPOINT).exists():
            _say(f"a checkpoint of an interrupted run is in {folder}, and is replaced; --resume continues it")
        return _in_parts(scene, model, folder, resume=resume, write=write, made=made)
    place = folder / MEMBERS  # of a scene with its uncertainty: what is finished, until all is
    if not resume:
        rmtree(place, ignore_errors=True)
    kept = Store(place)

    def member(each: Scene, label: str) -> Result:
        found: Result | None = kept.lookup(each, model).result
        if found is not None:
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
    made: Any = None,
) -> Result:
    """A fresh result, with checkpoints in a folder; write: what an interruption may not leave half done;
    made: the plan, if there is one.
    """
    seconds, who = checkpoints.interval(), checkpoints.identity(scene, model)
    start = _start(scene, place, who) if resume else None
    writer = checkpoints.Writer(place, who, seconds, start, warn=_say)
    with checkpoints.interruptible(writer):
        with Progress(remaining=True) as progress:

            def told(stage: str, done: int, total: int) -> None:
                progress(f"{model}{label}: {stage}", done, total)

            result, source = solve_or_reuse(
                default_store(), scene, model, told, fresh=True, checkpoint=writer, start=start, made=made
            )
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
    except ArchiveError as error:
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
    """Write a result to `folder`; on stderr: where it is from, what it warns of, which files are left out."""
    lacking = [f"left out: {entry.reason}" for entry in not_written(result)]
    for text in (source.text, *result.warnings, *lacking):
        if text:
            print(f"samfem: {result.model}: {text}", file=sys.stderr)
    write_run(result, scene, folder, collect(inputs, scene.seeds) | source.provenance)


def check(scene: Scene, model: str, *, anyway: bool = False) -> Any:
    """The plan of a model, with the first cells and load steps where an accuracy is asked for.

    Raises ModelError unless the model can represent the scene within the memory of the machine, and, unless
    `anyway`, in the time that a command begins unasked.
    """
    if scene.solver.accuracy is not None:
        models.check(scene, model)
        scene = chosen_scene(scene, model, first_choice(scene, model))
    return plans.check_needs(scene, model, anyway=anyway)


def unconverged(results: Sequence[Result | Run]) -> int:
    """1 if a result did not converge, with its status and what to change on stderr; else 0."""
    ended = [result for result in results if not result.converged]
    for result in ended:
        message = result.message or Status(result.status).advice
        print(f"samfem: {result.model}: {result.status}: {message}", file=sys.stderr)
    short = [(result.model, words) for result in results if (words := missed(result))]
    for model, words in short:
        print(f"samfem: {model}: {words}", file=sys.stderr)
    return 1 if ended or short else 0


def status_line(result: Result | Run) -> str:
    """Status, time and cells or elements, on one line."""
    cost = result.cost
    seconds = sum(cost.get(name) or 0.0 for name in ("setup_s", "solve_s"))
    return f"{result.status} in {with_time(seconds)}: {_cells(result.discretisation)}"


def result_lines(result: Result | Run) -> list[str]:
    """What is said of a result: how it ended, and its quantities."""
    heads = filter(None, (status_line(result), undecided_line(result), load_line(result)))
    if result.uncertainty:
        return [*heads, *table_lines(*uncertain_table(result, True)), *uncertain_lines(result)]
    return [*heads, *table_lines(("quantity", result.model), quantity_rows(result, True))]


def load_line(result: Result | Run) -> str:
    """At which load the quantities are, where that is not the peak; else empty."""
    last = result.last_fitting
    return (
        f"the peak load was not reached; at the last load that fitted, {last['force_N']:.6g} N:"
        if last
        else ""
    )


def undecided_line(result: Result | Run) -> str:
    """How many more load cycles would tell what becomes of the body; empty where it is decided."""
    verdict = result.verdict
    if not verdict or verdict["class"] != "undecided":
        return ""
    more = verdict.get("periods_to_decide")
    what = f"about {more * verdict['cycles_in_period']} more of loading.cycles" if more else "no more cycles"
    hint = "" if more else ", a smaller solver.tolerance might"
    return f"what becomes of the body under repeated loading is undecided: {what} would decide it{hint}"


def _cells(found: Mapping[str, Any]) -> str:
    """The discretisation in words."""
    if "cells" in found:
        size = " x ".join(dict.fromkeys(with_prefix(side, "m") for side in found["cell_m"]))
        (nx, ny), touching = found["cells"], found["contact_cells"]
        return f"{nx} x {ny} cells of {size}, {touching} in contact, {found['depths']} depths"
    smallest = with_prefix(found["h_m"], "m")
    return f"{found['elements']} elements, the smallest {smallest}, {found['dofs']} unknowns"


def _known(result: Result | Run) -> dict[str, float]:
    """The quantities that apply; where the peak load was not reached, those of `load_line`."""
    values = result.last_fitting or result.quantities
    return {name: value for name, value in values.items() if value is not None}


def quantity_rows(result: Result | Run, terminal: bool) -> list[tuple[str, str]]:
    """Name and value of each quantity that applies: for a terminal in GPa, um and N, else in SI as
    summary.json has them.
    """
    found = _known(result)
    if terminal:
        least = ROUNDING * (found.get("contact_radius_m") or 0.0)
        noise = {name for name, value in found.items() if name.endswith("_m") and abs(value) < least}
        return [in_working_unit(name, 0.0 if name in noise else value) for name, value in found.items()]
    return [(name, f"{value:.6g}") for name, value in found.items()]


def uncertain_table(result: Result | Run, terminal: bool) -> tuple[tuple[str, ...], list[tuple[str, ...]]]:
    """Heads and rows: name, value, uncertainty, and shares of cells, load steps and box in percent."""
    parts = {name: f"u_{name}" for name in ("cells", "steps", "box")}
    found, rows = result.uncertainty or {}, []
    shown = {name for name in parts if any(entry.get(parts[name]) for entry in found.values())}
    for words, value in zip(_known(result), quantity_rows(result, terminal), strict=True):
        entry = found.get(words, {})
        total, size = entry.get("u_num"), abs(result.quantities[words] or 0.0)
        of_parts = [_percent(entry.get(key), size) for name, key in parts.items() if name in shown]
        around = ""
        if total is not None:
            around = in_working_unit(words, total, digits=2)[1] if terminal else f"{total:.2g}"
        order = "" if entry.get("order_seen") is None else f"{entry['order_seen']:.2g}"
        short = "not converging" if total is not None and entry["flag"] else ""
        rows.append((*value, around, _percent(total, size), *of_parts, order, short))
    heads = ("quantity", result.model, "+-", "%", *(name for name in parts if name in shown))
    return (*heads, "order seen", ""), rows


def uncertain_lines(result: Result | Run) -> list[str]:
    """What the uncertainty is taken from, and which quantities have none, with the reason."""
    lines: list[str] = []
    without: dict[str, list[str]] = {}
    for name, entry in (result.uncertainty or {}).items():
        if entry["u_num"] is None:
            without.setdefault(entry["flag"], []).append(name)
        elif not lines:
            cells = ", ".join(f"{number:g}" for number in entry["cells"])
            steps = ", ".join(f"{number:g}" for number in entry["steps"])
            what = "cells" if "cells" in result.discretisation else "elements in the radius"
            on = f"; 2 times, from {steps} load steps on coarse ones" if steps else ""
            lines.append(f"uncertainty: 3 times the estimated error, from {cells} {what}{on}")
    return lines + [f"no uncertainty: {', '.join(names)}: {reason}" for reason, names in without.items()]


def _percent(part: float | None, size: float) -> str:
    return "" if part is None or not size else f"{100 * part / size:.2g}"
