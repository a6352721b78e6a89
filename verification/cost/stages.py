# SPDX-License-Identifier: MIT
"""The stages that a model runs for a scene, in the order in which they begin, then those that it leaves out,
with reasons and sizes. Solves nothing.

test_leave_out counts that what is listed runs and nothing else does.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from sam.grid import CellGrid
from sam.scene import NO_FORCE, Scene, Stage
from verification.cost import estimates


def stages_of(scene: Scene, made: Any) -> list[Stage]:
    """Stages as the plan `made` of a model has them, with the box that plastic strain may fill in SAM."""
    needed = [stage for stage in made.stages if stage.runs or stage.reason == NO_FORCE]
    left = [Stage(entry.stage, False, entry.reason) for entry in made.left_out]
    return [*(_with_box(scene, made.grid, each) if _fills_a_box(each) else each for each in needed), *left]


def _fills_a_box(stage: Stage) -> bool:
    return stage.stage == "eigenstrain kernels" and stage.runs


def _with_box(scene: Scene, grid: CellGrid, stage: Stage) -> Stage:
    """The stage of the eigenstrain kernels with its size."""
    box = estimates.plastic_box(scene, grid)
    size = {
        "box_cells": [box.nx, box.ny, box.layers],
        "coefficients": box.coefficients,
        "bytes": box.width * box.coefficients,
    }
    return replace(stage, size=size)
