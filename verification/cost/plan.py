# SPDX-License-Identifier: MIT
"""What a scene will compute, what is left out and why, and an estimate of memory and time. Solves nothing.

The stages are those of the plans of the models, the estimates those of `verification.cost.estimates`.
"""

from __future__ import annotations

from dataclasses import asdict, replace
from typing import Any

from sam.scene import NO_FORCE, Scene, Stage, printable
from verification.cost import estimates
from verification.cost.accuracy import chosen_scene, expected, first_choice, quantities_of
from verification.cost.advice import advice_of
from verification.runs import models
from verification.runs.model_range import model_range, range_lines
from verification.runs.provenance import memory_bytes
from verification.text.console import table_lines
from verification.text.readable import with_prefix, with_time
from verification.uncertainty.solving import NoFamilyError, family

UNCERTAINTY = "uncertainty"
LONGEST = 86400.0  # predicted processor seconds that a command begins unasked
NOTE = "memory and time are estimates from the numbers of cells, not measurements"


def plan(scene: Scene) -> dict:
    """The plan of every model as a mapping that JSON can hold: stages, estimate, or why the model cannot be
    used; advice; by how much small strains of a flat half-space are off.
    """
    entries = [_model(scene, name) for name in models.MODELS]
    advice = advice_of(scene, [entry["model"] for entry in entries if entry["available"]])
    of_model = model_range(scene)
    return {"title": scene.title, "note": NOTE, "models": entries, "advice": advice, "model_range": of_model}


def _model(scene: Scene, model: str) -> dict:
    chosen = []
    try:
        models.check(scene, model)
        if scene.solver.accuracy is not None:
            choice, later = first_choice(scene, model), expected(scene, model)
            asked = f"{100 * scene.solver.accuracy:g} % of {', '.join(quantities_of(scene))}"
            words = f"{asked}: begins with {choice}; the table of advice expects {later}"
            chosen, scene = [Stage("accuracy", True, words)], chosen_scene(scene, model, later)
    except models.ModelError as reason:
        return {"model": model, "available": False, "reason": str(reason), "stages": [], "estimate": None}
    made = models.plan(scene, model)
    stages, estimate = _stages(scene, made), estimates.estimate(scene, model, made)
    if scene.solver.uncertainty:
        stage, seconds = _uncertainty(scene, model)
        stages, estimate = [*chosen, *stages, stage], replace(estimate, time_s=estimate.time_s + seconds)
    return {
        "model": model,
        "available": True,
        "reason": "",
        "stages": [asdict(stage) for stage in stages],
        "estimate": asdict(estimate),
    }


def _stages(scene: Scene, made: Any) -> list[Stage]:
    """Stages as the plan `made` of a model has them, in the order in which they begin, that of the
    eigenstrain kernels with the box that plastic strain may fill in SAM; then those that it leaves out.
    """
    found = []
    for stage in (each for each in made.stages if each.runs or each.reason == NO_FORCE):
        if stage.stage == "eigenstrain kernels" and stage.runs:
            box = estimates.plastic_boxes(scene, made.grid)[-1]
            size = {"box_cells": [box.nx, box.ny, box.layers], "coefficients": box.coefficients}
            stage = replace(stage, size=size | {"bytes": box.width * box.coefficients})
        found.append(stage)
    return [*found, *(Stage(entry.stage, False, entry.reason) for entry in made.left_out)]


def _uncertainty(scene: Scene, model: str) -> tuple[Stage, float]:
    """What the uncertainty of a scene is taken from besides the scene itself, and the seconds it adds."""
    try:
        found = family(scene, model)
    except NoFamilyError as error:
        return Stage(UNCERTAINTY, False, str(error)), 0.0
    seconds = sum(estimates.estimate(member.scene, model).time_s for member in found.all[1:])
    words = "solver.uncertainty: " + "; ".join(member.label for member in found.all[1:])
    return Stage(UNCERTAINTY, True, words, {"solves": len(found.all) - 1}), seconds


def check_needs(scene: Scene, model: str, available: float | None = None, *, anyway: bool = False) -> Any:
    """The plan of a scene. Raises ModelError if `model` cannot represent it, or would need more memory than
    there is, `available` bytes, by default this machine's; or, unless `anyway`, more time than LONGEST.
    """
    models.check(scene, model)
    available = memory_bytes() if available is None else available
    made = models.plan(scene, model)
    needs = estimates.estimate(scene, model, made)
    if available and needs.memory_bytes > available:
        needed, there = (with_prefix(number, "B") for number in (needs.memory_bytes, available))
        raise models.ModelError(
            f"model {model}: about {needed} of memory needed, {there} available: {_smaller(scene, model)}"
        )
    if anyway:
        return made
    seconds = needs.time_s + (_uncertainty(scene, model)[1] if scene.solver.uncertainty else 0.0)
    if seconds > LONGEST:
        raise models.ModelError(
            f"model {model}: about {with_time(seconds)} of processor time predicted, more than "
            f"{with_time(LONGEST)}: {_smaller(scene, model)}{_fewer(scene)}, or say --anyway"
        )
    return made


def _fewer(scene: Scene) -> str:
    """Load steps and cycles that can be fewer, with the numbers that they have."""
    given = {"steps": scene.loading.steps, "cycles": scene.loading.cycles}
    return ", " * any(count > 1 for count in given.values()) + " or ".join(
        f"loading.{key} = {count}" for key, count in given.items() if count > 1
    )


def _smaller(scene: Scene, model: str) -> str:
    """What to change, with the value that it has."""
    surface = scene.patch_surface
    if surface is not None and surface.kind == "file" and surface.resample is None:
        cells = list(surface.patch()[0])
        return (
            f"give a smaller {surface.table}.crop, as grid.cells = {cells} are those of {surface.table}.path"
        )
    if model != models.SAM and surface is not None:
        return f"lower grid.cells or fem.box = {scene.fem.box:g}"
    if model != models.SAM:
        return f"lower fem.cells_per_radius = {scene.fem.cells_per_radius} or fem.box = {scene.fem.box:g}"
    from sam import choose_grid

    grid = choose_grid(scene)
    layers = f" or the number of layers, {len(grid.depths)}" if scene.body.plasticity else ""
    return f"lower grid.cells = [{grid.nx}, {grid.ny}]{layers}"


def plan_lines(content: dict) -> list[str]:
    """A plan as lines of plain text for the reader: the advice first, then what each model computes."""
    table = content["advice"]["table"]
    shown = table_lines(table["columns"], table["rows"]) if table["rows"] else []
    return [*advice_lines(content), *shown, *model_lines(content)]


def advice_lines(content: dict) -> list[str]:
    """What stands above the table of the advice: the title of the scene, and what the table is about."""
    title = printable(content["title"])
    return [*([title, ""] if title else []), f"advice: {content['advice']['words']}"]


def model_lines(content: dict) -> list[str]:
    """What each model computes and leaves out, with its estimate; by how much all of them are off."""
    of_model, lines = content["model_range"], []
    for entry in content["models"]:
        if not entry["available"]:
            lines += ["", f"{entry['model']}: cannot be used: {entry['reason']}"]
            continue
        estimate = entry["estimate"]
        memory, time = with_prefix(estimate["memory_bytes"], "B"), with_time(estimate["time_s"])
        lines += ["", f"{entry['model']}: about {memory} and {time}"]
        for stage in sorted(entry["stages"], key=lambda stage: not stage["runs"]):
            size = ", ".join(_sized(name, value) for name, value in stage["size"].items())
            mark = "computed" if stage["runs"] else "left out"
            lines.append(f"  {mark}  {stage['stage']}: {stage['reason']}" + (f" ({size})" if size else ""))
    off = [] if of_model is None else range_lines(of_model)
    return [*lines, "", *off, content["note"]]


def _sized(name: str, value: Any) -> str:
    """A size of a stage with its unit: bytes in MB or GB, what ends in _m in um."""
    if name == "bytes":
        return with_prefix(value, "B")
    words, unit = (name[: -len("_m")], "m") if name.endswith("_m") else (name, "")
    values = value if isinstance(value, list) else [value]
    return f"{words} {' x '.join(_shown(each, unit) for each in values)}"


def _shown(value: Any, unit: str) -> str:
    if unit:
        return with_prefix(value, unit, 4)
    return f"{value:.4g}" if isinstance(value, float) else str(value)
