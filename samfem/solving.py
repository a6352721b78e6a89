# SPDX-License-Identifier: MIT
"""The commands plan and solve: what a scene will compute, and from its file to the folder of a result,
what is printed of it and an exit code.

Wrong input raises SceneError, ModelError or FolderError before anything is solved or written.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor, wait
from pathlib import Path
from shutil import rmtree
from typing import Any, cast

from sam.scene import Checkpoint, Progress as Told, Result, Scene, Status, read_scene
from verification.cost import plan as plans
from verification.cost.accuracy import chosen_scene, first_choice, missed, solve as solve_family
from verification.cost.contact import hertz_of
from verification.cost.estimates import flows
from verification.runs import checkpoints, models
from verification.runs.archive import ArchiveError
from verification.runs.files import (
    CHECKPOINT,
    MEMBERS,
    Run,
    check_target,
    figures_of,
    json_text,
    read_run,
    write_run,
)
from verification.runs.lock import locked
from verification.runs.meshes import not_written
from verification.runs.model_range import refusal
from verification.runs.provenance import collect
from verification.runs.store import Reuse, Store, default_store, kept_coefficients, solve_or_reuse
from verification.runs.tables import contact_size
from verification.text.console import Progress, table_lines
from verification.text.readable import in_working_unit, with_prefix, with_time
from verification.uncertainty import asked_of as with_uncertainty, unknown

ROUNDING = 1e-12
"""Of the contact radius: a length below it is shown as 0 to a person."""


def plan(path: Path, *, as_json: bool, verbose: bool) -> int:
    """Print what the scene will compute. Raises ModelError for a contact beyond the range of every model."""
    scene, _ = read_scene(path)
    if reason := refusal(scene):
        raise models.ModelError(reason)
    found = plans.plan(scene)
    print(json_text(found.content).rstrip() if as_json else "\n".join(found.lines(verbose=verbose)))
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
    with locked(folder), kept_coefficients():
        if resume and checkpoints.is_finished(folder, scene, model):
            result: Result | Run = read_run(folder)
            _say(f"{folder} is already finished: nothing is solved")
        else:
            drawn = figures_of(folder)
            result = _solved(scene, model, folder, inputs, made=made, resume=resume)
            if drawn and not figures and not figures_of(folder):
                removed = "were of another result and are removed: --figures draws new ones"
                _say(f"the figures in {folder} {removed}")
        print(*result_lines(result, scene, readable=sys.stdout.isatty()), sep="\n")
        print(folder / "summary.json")
        if figures:
            _draw(folder)
        return unconverged([result])


def _draw(folder: Path) -> None:
    """Draw the figures of a run, those in space in a process beside the others, and print their files."""
    from verification.figures import solve_figures  # noqa: PLC0415 - not needed without
    from verification.figures.space import CannotDrawError, draw_run  # noqa: PLC0415

    told = [("drawing pictures in space", 0, 0)]
    with ThreadPoolExecutor(1) as beside:
        in_space = beside.submit(draw_run, folder, progress=lambda *state: told.append(state))
        with Progress() as progress:
            drawn = solve_figures(folder, progress=progress)
            while not wait([in_space], timeout=1.0).done:
                progress(*told[-1])
    print(*drawn, sep="\n")
    try:
        print(*in_space.result(), sep="\n")
    except CannotDrawError as error:
        _say(str(error))


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
            result = _in_parts(each, model, place, label=label, resume=begun)
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
    who = checkpoints.identity(scene, model)
    start = _start(scene, place, who) if resume else None
    writer = checkpoints.Writer(place, who, checkpoints.interval(), start, warn=_say)
    with checkpoints.interruptible(writer):
        with Progress(remaining=True) as progress:
            told, how = named(progress, model, label), {"checkpoint": writer, "start": start, "made": made}
            result, source = solve_or_reuse(default_store(), scene, model, told, fresh=True, **how)
        write(result, source)
    return result


def named(progress: Told, model: str, label: str = "") -> Told:
    """Progress of a solve by a model; label: of one of several solves."""
    head = ", ".join(filter(None, (model, label)))
    return lambda stage, done, total: progress(f"{head}: {stage}", done, total)


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
    """1 if a result did not converge, or has not the accuracy or no uncertainty at all that was asked for,
    with what to change on stderr; else 0.
    """
    ended = [result for result in results if not result.converged]
    for result in ended:
        message = result.message or Status(result.status).advice
        print(f"samfem: {result.model}: {result.status}: {message}", file=sys.stderr)
    short = [(result.model, words) for result in results if (words := missed(result) or unknown(result))]
    for model, words in short:
        print(f"samfem: {model}: {words}", file=sys.stderr)
    return 1 if ended or short else 0


def seconds(result: Result | Run) -> float:
    """Wall time of a result in s, of its own solve also where it is from the store."""
    return sum(result.cost.get(name) or 0.0 for name in ("setup_s", "solve_s"))


def status_line(result: Result | Run) -> str:
    """Status, time and cells or elements, on one line."""
    return f"{result.status} in {with_time(seconds(result))}: {_cells(result.discretisation)}"


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


def result_lines(result: Result | Run, scene: Scene | None = None, *, readable: bool = True) -> list[str]:
    """Status, time and cells, and a table of the quantities that the scene has; of a smooth contact beside
    those of Hertz, and with the uncertainty that the scene asks for.

    scene: that of the result, which a Run has itself; readable: in GPa, um and N, else in SI.
    """
    scene = cast(Run, result).scene if scene is None else scene
    found = _shown(result, scene)
    columns = [(result.model, _texts(found, found, readable))]
    if not result.last_fitting and found:
        columns += _hertz_columns(scene, found, readable)
    if result.uncertainty and not unknown(result):
        columns += _uncertain_columns(result, found, readable)
    names = [in_working_unit(name, 0.0)[0] if readable else name for name in found]
    rows = [
        (words, *(cells.get(name, "") for _, cells in columns))
        for words, name in zip(names, found, strict=True)
    ]
    heads = status_line(result), undecided_line(result), load_line(result)
    table = table_lines(("quantity", *(head for head, _ in columns)), rows)
    return [*filter(None, heads), *table, *_uncertain_lines(result, found)]


def _shown(result: Result | Run, scene: Scene) -> dict[str, float]:
    """The quantities that say something of the scene; where the peak load was not reached, those of
    `load_line`.
    """
    beside = set()
    if not flows(scene):
        beside |= {"peeq_max", "peeq_max_depth_m", "residual_uz_center_m", "residual_mises_max_Pa"}
    if scene.friction is None:
        beside |= {"friction_coefficient", *(() if scene.moves else ("pressure_centroid_x_m",))}
    if scene.wear is None:
        beside.add("wear_volume_m3")
    if scene.patch_surface is not None:
        beside |= {"contact_radius_m", "pressure_centroid_x_m"}
    values = result.last_fitting or result.quantities
    return {name: value for name, value in values.items() if value is not None and name not in beside}


Column = tuple[str, dict[str, str]]
"""Head of a column of a table, and the cells by quantity."""


def _texts(values: Mapping[str, float], found: Mapping[str, float], readable: bool) -> dict[str, str]:
    """Values of quantities as text; lengths that are rounding beside the contact radius as 0."""
    if not readable:
        return {name: f"{value:.6g}" for name, value in values.items()}
    least = ROUNDING * contact_size(found)
    noise = {name for name, value in values.items() if name.endswith("_m") and abs(value) < least}
    return {
        name: in_working_unit(name, value * (name not in noise), beside=found.get(name))[1]
        for name, value in values.items()
    }


def _hertz_columns(scene: Scene, found: Mapping[str, float], readable: bool) -> list[Column]:
    """What Hertz gives, and of an elastic body the deviation from that."""
    hertz = hertz_of(scene)
    if not hertz:
        return []
    off = {name: f"{100 * (found[name] / exact - 1):+.2g} %" for name, exact in hertz.items()}
    return [("Hertz", _texts(hertz, hertz, readable)), *([] if flows(scene) else [("deviation", off)])]


def _uncertain_columns(result: Result | Run, found: Mapping[str, float], readable: bool) -> list[Column]:
    """Uncertainty, its shares of cells, load steps and box in percent, order and whether it converges."""
    entries: Mapping[str, Mapping[str, Any]] = result.uncertainty or {}
    known = {name: entry for name, entry in entries.items() if name in found}
    parts = [
        part for part in ("cells", "steps", "box") if any(entry.get(f"u_{part}") for entry in known.values())
    ]

    def percent(key: str) -> dict[str, str]:
        return {name: _percent(entry.get(key), abs(found[name])) for name, entry in known.items()}

    around = {name: entry["u_num"] for name, entry in known.items() if entry["u_num"] is not None}
    return [
        (
            "+-",
            {
                name: in_working_unit(name, each, digits=2, beside=found[name])[1]
                if readable
                else f"{each:.2g}"
                for name, each in around.items()
            },
        ),
        ("%", percent("u_num")),
        *((part, percent(f"u_{part}")) for part in parts),
        (
            "order seen",
            {
                name: f"{order:.2g}"
                for name, entry in known.items()
                if (order := entry.get("order_seen")) is not None
            },
        ),
        ("", {name: "not converging" for name in around if known[name]["flag"]}),
    ]


def _uncertain_lines(result: Result | Run, found: Mapping[str, float]) -> list[str]:
    """What the uncertainty is taken from, and which quantities have none, with the reason."""
    lines: list[str] = []
    without: dict[str, list[str]] = {}
    for name, entry in (result.uncertainty or {}).items():
        if entry["u_num"] is None and name in found:
            without.setdefault(entry["flag"], []).append(name)
        elif entry["u_num"] is not None and not lines:
            cells = ", ".join(f"{number:g}" for number in entry["cells"])
            steps = ", ".join(f"{number:g}" for number in entry["steps"])
            what = "cells" if "cells" in result.discretisation else "elements in the radius"
            on = f"; 2 times, from {steps} load steps on coarse ones" if steps else ""
            lines.append(f"uncertainty: 3 times the estimated error, from {cells} {what}{on}")
    return lines + [f"no uncertainty: {', '.join(names)}: {reason}" for reason, names in without.items()]


def _percent(part: float | None, size: float) -> str:
    return "" if part is None or not size else f"{100 * part / size:.2g}"
