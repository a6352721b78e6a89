# SPDX-License-Identifier: MIT
"""What a scene will compute, what is left out and why, with estimates. Solves nothing."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import asdict, dataclass, replace
from math import prod, sqrt
from typing import Any

from sam.scene import NO_FORCE, Grid, Scene, Stage, printable
from verification.cost import estimates
from verification.cost.accuracy import chosen_scene, expected, first_choice, quantities_of
from verification.cost.advice import LOAD_STEPS, ON_TWO_GRIDS, advice_of, kind_of, table
from verification.cost.contact import expected_contact
from verification.runs import model_range, models
from verification.runs.provenance import memory_bytes
from verification.text.console import table_lines
from verification.text.readable import with_prefix, with_time
from verification.uncertainty.solving import NoFamilyError, family, too_coarse

UNCERTAINTY = "uncertainty"
LONGEST = 86400.0  # predicted processor seconds that a command begins unasked
NOTE = "memory and time are estimates from the numbers of cells, not measurements"
COARSEST = 4.0  # cells in the contact radius: below it a grid is called coarse
BRIEF = {
    "surface heights": "roughness",
    "counter-surface heights": "rough counter-body",
    "layered coefficients": "coating",
    "film elements": "coating",
    "mesh of the counter-body": "elastic counter-body",
    "coarser grid": "a coarser grid to extrapolate from",
    "contact search": "contact| in {steps} load steps",
    "given pressure": "given pressure| in {steps} load steps",
    "misfit strain": "misfit strain| in {steps} steps",
    "moving counter-body": "moving counter-body|, {passes} x {steps} steps",
    "tangential kernels": "friction",
    "tangential traction": "friction",
    "coupling": "coupling of friction and gap",
    "plastic loop": "plastic strain",
    "return mapping and plastic history": "plastic strain",
    "back-stresses": "back-stresses",
    "cycles after the first": "cycles| ({cycles})",
    "verdict on repeated loading": "verdict on repeated loading",
    "chemical film": "chemical film",
    "worn geometry": "wear",
    "unloading": "unloading",
    "stresses at the output depths": "stresses below the surface",
    "stresses at the Gauss points": "stresses below the surface",
    "stresses in the elements": "stresses below the surface",
    "bare comparison": "the body without coating",
    "bare body": "the body without coating",
    UNCERTAINTY: "uncertainty| from {solves} more solves",
}
"""Stage -> what it computes, for the short lines, and after a bar its size; others prepare or follow one."""
SELDOM = ("counter-surface heights", "back-stresses", "chemical film")  # told only where they run


@dataclass(frozen=True, repr=False)
class Plan:
    """What the models will compute of a scene; `print` shows it in a line for each topic and each warning.
    content: all of it as a mapping that JSON can hold: stages, estimate and resolution of every model, or why
    it cannot be used; contact; advice; by how much small strains of a flat half-space are off. model: the one
    that the attributes are about.
    """

    content: Mapping[str, Any]
    model: str

    def __repr__(self) -> str:
        return "\n".join(self.lines())

    @property
    def _entry(self) -> Mapping[str, Any]:
        return next(each for each in self.content["models"] if each["model"] == self.model)

    @property
    def time_s(self) -> float:
        """Predicted processor time in s."""
        return self._entry["estimate"]["time_s"]

    @property
    def memory_bytes(self) -> int:
        """Predicted largest memory of the process."""
        return self._entry["estimate"]["memory_bytes"]

    @property
    def cells(self) -> int:
        """Cells of the surface, or elements."""
        size = next(each["size"] for each in self._entry["stages"] if each["stage"] in ("grid", "mesh"))
        return size["elements"] if "elements" in size else size["cells"][0] * size["cells"][1]

    @property
    def cells_in_radius(self) -> float | None:
        """Cells in the estimated contact radius; None of a rough body."""
        return self._entry["resolution"]["cells_in_radius"]

    @property
    def error(self) -> float | None:
        """The largest error measured with so many cells and load steps; None where none was."""
        found = self._entry["resolution"]
        return None if found["error"] is None else max(found["error"], found["steps_error"] or 0.0)

    @property
    def contact(self) -> Mapping[str, Any]:
        """p0_Pa, a_m, b_m, a_over_R, p0_over_yield and the like of the estimated elastic contact, in SI."""
        return self.content["contact"]

    @property
    def left_out(self) -> dict[str, str]:
        """Stages that the scene does not need, and why."""
        return {each["stage"]: each["reason"] for each in self._entry["stages"] if not each["runs"]}

    @property
    def warnings(self) -> list[str]:
        """What a user should know before a solve, a line each."""
        return self.content["warnings"]

    def lines(self, verbose: bool = False) -> list[str]:
        """The short lines; verbose: also the advice, and every stage of every model with its reason."""
        content, entries = self.content, [each for each in self.content["models"] if each["available"]]
        short = [content["contact"]["words"]]
        if entries:
            short += [_resolved(entries[:2])]
        short += ["time and memory (estimated): " + "; ".join(map(_needed, content["models"]))]
        if self._entry["available"]:
            stages = self._entry["stages"]
            short += [f"computed: {_brief(stages, runs=True)}", f"left out: {_brief(stages, runs=False)}"]
        short += [f"warning: {words}" for words in self.warnings]
        if not verbose:
            return short
        title, advised = printable(content["title"]), content["advice"]["table"]
        shown = table_lines(**advised) if advised["rows"] else []
        heads = [*([title, ""] if title else []), *short, "", f"advice: {content['advice']['words']}"]
        return [*heads, *shown, *_model_lines(content)]


def plan(scene: Scene, model: str | None = None) -> Plan:
    """The plan of every model for its contact; model: of the attributes, by default the first usable."""
    entries = [_model(scene, name) for name in models.models_for(scene)]
    usable = [entry["model"] for entry in entries if entry["available"]]
    advice, of_model = advice_of(scene, usable), model_range.model_range(scene)
    contact = expected_contact(scene)
    content = {
        "title": scene.title,
        "note": NOTE,
        "contact": contact,
        "models": entries,
        "advice": advice,
        "model_range": of_model,
        "warnings": [*_off(of_model, contact.get("a_over_R")), *_warnings(scene, entries)],
    }
    return Plan(content, model or (usable or [models.SAM])[0])


def _resolution(scene: Scene, model: str, made: Any) -> dict[str, Any]:
    """Cells in the estimated contact radius, and the smallest error of the table of advice that so many, and
    the load steps of the scene, leave: None where none is so large or none was measured.
    """
    found = dict.fromkeys(("cells_in_radius", "quantity", "error", "steps_error"))
    if scene.patch_surface is not None or scene.loading.misfit_sphere:
        return found
    cells: float = scene.fem.cells_per_radius
    if model == models.SAM:
        from sam import hertz_semi_axes

        axes = hertz_semi_axes(scene)
        cells = sqrt(prod(axes) / (made.grid.hx * made.grid.hy))
        cells = axes[0] / made.grid.hx if made.grid.line else cells
    method = ON_TWO_GRIDS if model == models.SAM and scene.solver.extrapolate else model
    of_kind = [row for row in table() if row.kind == kind_of(scene)]

    def left(by: str, count: float) -> float | None:
        reached = [row.error for row in of_kind if row.method == by and row.resolution <= count + 0.01]
        return min(reached, default=None)

    named = {row.method: row.quantity for row in of_kind}
    own = {"error": left(method, cells), "steps_error": left(LOAD_STEPS, scene.loading.steps)}
    own = {"quantity": named[method], **own} if method in named else {}
    return found | {"cells_in_radius": cells} | own


def _resolved(entries: Sequence[Mapping[str, Any]]) -> str:
    """Cells in the contact radius of some models, and the error that they leave, in words."""
    parts, about = [], ""
    for entry in entries:
        found, model = entry["resolution"], entry["model"]
        if found["cells_in_radius"] is None:
            size = next(each["size"] for each in entry["stages"] if each["stage"] in ("grid", "mesh"))
            number = size.get("elements") or " x ".join(map(str, size["cells"]))
            parts.append(f"{model} {number} {'elements' if 'elements' in size else 'cells'}")
            continue
        words, error, steps = f"{model} {found['cells_in_radius']:.3g}", found["error"], found["steps_error"]
        if found["quantity"] is not None:
            about = f" and error of the {found['quantity']} (at most about)"
            words += ", more than 5 %" if error is None else f", {100 * max(error, steps or 0):g} %"
            words += " by the load steps" * (error is not None and (steps or 0) > error)
        parts.append(words)
    head = "cells in a" if any(entry["resolution"]["cells_in_radius"] for entry in entries) else "grid"
    return f"{head}{about}: {'; '.join(parts)}"


def _needed(entry: Mapping[str, Any]) -> str:
    """Time and memory of a model, or the keys for which it cannot be used."""
    if not entry["available"]:
        keys = re.findall(r"([a-z_]+(?:\.[a-z_]+)+) (?:=|together)", entry["reason"]) or [entry["reason"]]
        first, *more = dict.fromkeys(keys)
        return f"{entry['model']} cannot ({first}{', ...' * bool(more)})"
    memory, time = with_prefix(entry["estimate"]["memory_bytes"], "B"), with_time(entry["estimate"]["time_s"])
    return f"{entry['model']} {time}, {memory}"


def _brief(stages: Sequence[Mapping[str, Any]], *, runs: bool) -> str:
    """The stages that run, or those that do not, in words, each once."""
    told, sizes = {}, {each["stage"]: each["size"] for each in stages if each["runs"] == runs}
    for stage in BRIEF:
        if stage in sizes and (runs or stage not in SELDOM):
            words, _, size = BRIEF[stage].partition("|")
            sized = size.format_map(sizes[stage]) if runs else ""
            told[words] = re.sub(r"in 1 (load )?steps", r"in one \1step", sized)
    return ", ".join(words + size for words, size in told.items()) or "nothing"


def _off(found: Mapping[str, Any] | None, hertz: float | None) -> list[str]:
    """That the contact is outside of the model, and by how much that is off; hertz: elastic a/R."""
    if found is None:
        return []
    outside = [model_range.outside_in_words(found["a_over_R"])] if found["outside"] else []
    sphere = found["like"] not in ("", model_range.CYLINDER)
    like = f"{'as of a sphere at ' * sphere}a/R = {found['a_over_R']:.2g}"
    like += " with yielding" * bool(hertz and found["a_over_R"] > 1.01 * hertz)
    off = model_range.off_in_words(found)
    return [*outside, *([model_range.in_a_sentence(off, like)] if off else [])]


def _warnings(scene: Scene, entries: Sequence[Mapping[str, Any]]) -> list[str]:
    """Coarse grids, and what a machine or a command would not begin."""
    found = []
    for entry in (each for each in entries if each["available"]):
        cells, needs, model = entry["resolution"]["cells_in_radius"], entry["estimate"], entry["model"]
        if cells is not None and cells < COARSEST:
            found.append(f"{model}: only {cells:.2g} cells in the contact radius")
        none = [each for each in entry["stages"] if each["stage"] == UNCERTAINTY and not each["runs"]]
        found += [f"{model}: no uncertainty: {each['reason']}" for each in none]
        if (most := memory_bytes()) and needs["memory_bytes"] > most:
            fits = _fitting(scene, model, most)
            found.append(f"{model}: this machine has {with_prefix(most, 'B')} of memory{fits}")
        if needs["time_s"] > LONGEST:
            found.append(f"{model}: more than a day, begun with --anyway only")
    return found


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
        nothing: dict[str, Any] = {"stages": [], "estimate": None, "resolution": None}
        return {"model": model, "available": False, "reason": str(reason), **nothing}
    made = models.plan(scene, model)
    stages, estimate = _stages(scene, made), estimates.estimate(scene, model, made)
    resolution = _resolution(scene, model, made)
    if scene.solver.uncertainty:
        stage, seconds = _uncertainty(scene, model, resolution["cells_in_radius"])
        stages, estimate = [*chosen, *stages, stage], replace(estimate, time_s=estimate.time_s + seconds)
    return {
        "model": model,
        "available": True,
        "reason": "",
        "stages": [asdict(stage) for stage in stages],
        "estimate": asdict(estimate),
        "resolution": resolution,
    }


def _stages(scene: Scene, made: Any) -> list[Stage]:
    """Stages of the plan `made` in their order, with the plastic box of SAM; then those it leaves out."""
    found = []
    for stage in (each for each in made.stages if each.runs or each.reason == NO_FORCE):
        if stage.stage == "eigenstrain kernels" and stage.runs:
            box = estimates.plastic_boxes(scene, made)[-1]
            size = {"box_cells": [box.nx, box.ny, box.layers], "coefficients": box.coefficients}
            size |= {"bytes": box.width * box.coefficients}
            stage = replace(stage, size=size | {"operator": box.words})
        found.append(stage)
    return [*found, *(Stage(entry.stage, False, entry.reason) for entry in made.left_out)]


def _uncertainty(scene: Scene, model: str, cells: float | None = None) -> tuple[Stage, float]:
    """What the uncertainty is taken from, or why there is none, and its seconds; cells: in the radius."""
    try:
        found = family(scene, model)
    except NoFamilyError as error:
        return Stage(UNCERTAINTY, False, str(error)), 0.0
    seconds = sum(estimates.estimate(member.scene, model).time_s for member in found.all[1:])
    if cells is not None and (reason := too_coarse(found, model, cells)):
        return Stage(UNCERTAINTY, False, f"by the estimated contact, {reason}"), seconds
    words = "solver.uncertainty: " + "; ".join(member.label for member in found.all[1:])
    return Stage(UNCERTAINTY, True, words, {"solves": len(found.all) - 1}), seconds


def check_needs(scene: Scene, model: str, available: float | None = None, *, anyway: bool = False) -> Any:
    """The plan of a scene. Raises ModelError if `model` cannot represent it, or would need more memory than
    `available` bytes, by default this machine's, or, unless `anyway`, more time than LONGEST.
    """
    models.check(scene, model)
    available = memory_bytes() if available is None else available
    made = models.plan(scene, model)
    needs = estimates.estimate(scene, model, made)
    if available and needs.memory_bytes > available:
        needed, there = (with_prefix(number, "B") for number in (needs.memory_bytes, available))
        words = _smaller(scene, model) + _fitting(scene, model, available)
        raise models.ModelError(f"model {model}: about {needed} of memory needed, {there} available: {words}")
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
    words = " or ".join(f"loading.{key} = {count}" for key, count in given.items() if count > 1)
    return f", {words}" if words else ""


def _fitting(scene: Scene, model: str, available: float) -> str:
    """What would fit in SAM, half as many cells each way or half of those, and its memory."""
    from sam import choose_grid

    grid = choose_grid(scene)
    for share in (2, 4, 8, 16) if model == models.SAM else ():
        cells = grid.nx // share, max(grid.ny // share, 1)
        fewer = (scene.grid or Grid()).model_copy(update={"cells": cells})
        with suppress(ValueError):  # of heights that cannot be had so coarse
            needed = estimates.estimate(scene.model_copy(update={"grid": fewer}), model).memory_bytes
            if needed <= available:
                return f"; grid.cells = {list(cells)} would take {with_prefix(needed, 'B')}"
    return ""


def _smaller(scene: Scene, model: str) -> str:
    """What to change, with the value that it has."""
    surface = scene.patch_surface
    if surface is not None and surface.kind == "file" and surface.resample is None:
        cells, name = list(surface.patch()[0]), surface.table
        return f"give a smaller {name}.crop, as grid.cells = {cells} are those of {name}.path"
    if model != models.SAM and surface is not None:
        return f"lower grid.cells or fem.box = {scene.fem.box:g}"
    if model != models.SAM:
        return f"lower fem.cells_per_radius = {scene.fem.cells_per_radius} or fem.box = {scene.fem.box:g}"
    if scene.solver.operator == "dense":
        return 'leave out solver.operator = "dense"'
    from sam import choose_grid

    grid = choose_grid(scene)
    layers = f" or the number of layers, {len(grid.depths)}" if scene.body.plasticity else ""
    return f"lower grid.cells = [{grid.nx}, {grid.ny}]{layers}"


def _model_lines(content: Mapping[str, Any]) -> list[str]:
    """What each model computes and leaves out, with its estimate."""
    lines: list[str] = []
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
    off = [] if content["model_range"] is None else model_range.range_lines(content["model_range"])
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
