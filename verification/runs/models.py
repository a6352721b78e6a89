# SPDX-License-Identifier: MIT
"""The models by name: what each can solve, its plan, and a solve with its cost."""

from __future__ import annotations

import resource
import sys
import time
from dataclasses import replace
from importlib import import_module
from types import ModuleType
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from sam.scene import Checkpoint, Keep, Progress, Result, Scene

SAM, FEM, FEM_3D, FEM_LINE = "sam", "fem-axisymmetric", "fem-3d", "fem-plane-strain"
MODELS = {
    SAM: "sam",
    FEM: "fem_reference",
    FEM_3D: "fem_reference.spatial",
    FEM_LINE: "fem_reference.plane_strain",
}


class ModelError(ValueError):
    """A model that cannot solve the scene."""


def check(scene: Scene, model: str) -> None:
    """Raise ModelError, naming the key, if `model` cannot represent the scene or it is beyond the range."""
    if reason := _refusal(scene, model):
        raise ModelError(f"model {model}: {reason}")
    from verification.runs.model_range import refusal  # noqa: PLC0415 - loads numpy

    if reason := refusal(scene):
        raise ModelError(reason)


def models_for(scene: Scene) -> tuple[str, ...]:
    """The models that are made for the kind of contact of a scene, the cheapest reference first."""
    line = scene.counterbody is not None and scene.counterbody.shape == "cylinder"
    return (SAM, FEM_LINE) if line else (SAM, FEM, FEM_3D)


def cheapest_reference(scene: Scene) -> str:
    """The cheapest finite-element model for the scene. ModelError with all reasons if none can."""
    reasons = {model: _refusal(scene, model) for model in models_for(scene)}
    for model, reason in reasons.items():
        if model != SAM and not reason:
            return model
    lines = [f"  {model}: {reason}" for model, reason in reasons.items() if reason]
    head = "no finite-element model can represent this scene; change all that one of them names:"
    raise ModelError("\n".join([head, *lines]))


def _refusal(scene: Scene, model: str) -> str:
    """Why a model cannot represent the scene, with each key and what is allowed; empty if it can."""
    package = _package(model)
    try:
        package.check(scene)
    except package.UnsupportedScene as reason:
        return str(reason)
    return ""


def plan(scene: Scene, model: str) -> Any:
    """What `model` will solve of a scene that it can represent; nothing is solved."""
    return _package(model).plan(scene)


def solve(
    scene: Scene,
    model: str,
    progress: Progress | None = None,
    checkpoint: Keep | None = None,
    *,
    start: Checkpoint | None = None,
    made: Any = None,
) -> Result:
    """The result of `model`, with by how much small strains of a flat half-space are off; its cost completed
    by cpu_s and peak_memory_bytes (of this process so far). checkpoint, start: see the solvers; the times of
    a solve in parts add up, and its memory is that of the largest part; made: the plan of the scene where it
    was checked and planned already, which then is not done again. Raises ModelError for a scene that the
    model cannot represent.
    """
    if made is None:
        check(scene, model)
    began, before = time.process_time(), start.cost if start else {}

    def measured() -> dict[str, float | int]:
        cpu = before.get("cpu_s", 0.0) + time.process_time() - began
        return {"cpu_s": cpu, "peak_memory_bytes": max(before.get("peak_memory_bytes", 0), peak_memory())}

    def keep(record: Checkpoint) -> None:
        checkpoint(record.with_cost(measured()))

    result = _package(model).solve(
        scene, progress=progress, checkpoint=keep if checkpoint else None, start=start, plan=made
    )
    from verification.runs.model_range import with_range  # noqa: PLC0415 - loads numpy

    return with_range(scene, replace(result, cost={**result.cost, **measured()}))


def _package(model: str) -> ModuleType:
    return import_module(MODELS[model])


def peak_memory() -> int:
    """Largest memory of this process in bytes. ru_maxrss begins with that of its parent on Linux."""
    try:
        with open("/proc/self/status", encoding="ascii") as status:
            return next(1024 * int(line.split()[1]) for line in status if line.startswith("VmHWM:"))
    except (OSError, StopIteration):
        largest = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
        return largest if sys.platform == "darwin" else largest * 1024  # bytes on macOS, KiB on Linux
