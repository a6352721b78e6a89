# SPDX-License-Identifier: MIT
"""What a scene will compute, what is left out and why, and an estimate of memory and time. Solves nothing.

The stages are those of `verification.stages`, the estimates those of `verification.estimates`.
"""

from __future__ import annotations

from dataclasses import asdict

from sam.scene import Scene
from sam.scene.errors import printable
from verification import estimates, models
from verification.advice import advice_of
from verification.provenance import memory_bytes
from verification.stages import Stage, of_fem, of_fem_3d, of_sam

NOTE = "memory and time are estimates from the numbers of cells, not measurements"


def plan(scene: Scene) -> dict:
    """The plan of every model as a mapping that JSON can hold: stages, estimate, or why the model cannot be used; advice."""
    entries = [_model(scene, name) for name in models.MODELS]
    advice = advice_of(scene, [entry["model"] for entry in entries if entry["available"]])
    return {"title": scene.title, "note": NOTE, "models": entries, "advice": advice}


def _model(scene: Scene, model: str) -> dict:
    try:
        models.check(scene, model)
    except models.ModelError as reason:
        return {"model": model, "available": False, "reason": str(reason), "stages": [], "estimate": None}
    stages = {models.SAM: of_sam, models.FEM: of_fem, models.FEM_3D: of_fem_3d}[model](scene)
    stages += [Stage(entry.stage, False, entry.reason) for entry in models.left_out(scene, model)]
    estimate = asdict(estimates.estimate(scene, model))
    return {
        "model": model,
        "available": True,
        "reason": "",
        "stages": [asdict(stage) for stage in stages],
        "estimate": estimate,
    }


def check_memory(scene: Scene, model: str, available: float | None = None) -> None:
    """Raise ModelError if `model` would need more memory than there is: `available` bytes, by default this machine's."""
    available = memory_bytes() if available is None else available
    try:
        models.check(scene, model)
    except models.ModelError:
        return
    memory = estimates.estimate(scene, model).memory_bytes
    if available and memory > available:
        needed, there = (f"{number / 1e9:.3g} GB" for number in (memory, available))
        raise models.ModelError(
            f"model {model}: about {needed} of memory needed, {there} available: {_smaller(scene, model)}"
        )


def _smaller(scene: Scene, model: str) -> str:
    """What to change, with the value that it has."""
    if model != models.SAM and scene.surface is not None:
        return f"lower grid.cells or fem.box = {scene.fem.box:g}"
    if model != models.SAM:
        return f"lower fem.cells_per_radius = {scene.fem.cells_per_radius} or fem.box = {scene.fem.box:g}"
    from sam.grid import choose_grid

    grid = choose_grid(scene)
    layers = f" or the number of layers, {len(grid.depths)}" if scene.body.plasticity else ""
    return f"lower grid.cells = [{grid.nx}, {grid.ny}]{layers}"


def plan_lines(content: dict) -> list[str]:
    """A plan as lines for the reader."""
    title = printable(content["title"])
    lines = [title] if title else []
    for entry in content["models"]:
        if not entry["available"]:
            lines += ["", f"{entry['model']}: cannot be used: {entry['reason']}"]
            continue
        estimate = entry["estimate"]
        lines += [
            "",
            f"{entry['model']}: about {estimate['memory_bytes'] / 1e6:.0f} MB and {estimate['time_s']:g} s",
        ]
        for stage in sorted(entry["stages"], key=lambda stage: not stage["runs"]):
            size = ", ".join(f"{name} {_shown(value)}" for name, value in stage["size"].items())
            mark = "computed" if stage["runs"] else "left out"
            lines.append(f"  {mark}  {stage['stage']}: {stage['reason']}" + (f" ({size})" if size else ""))
    first, *advice = content["advice"]["lines"]
    return [*lines, "", f"advice: {first}", *(f"  {line}" for line in advice), "", content["note"]]


def _shown(value: object) -> str:
    if isinstance(value, list):
        return " x ".join(map(_shown, value))
    return f"{value:.4g}" if isinstance(value, float) else str(value)
