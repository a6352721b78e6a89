# SPDX-License-Identifier: MIT
"""The stages that each model runs for a scene, in the order in which they begin, with reasons and sizes.
Solves nothing.

What is not among them is left out, and the models say why (`models.left_out`); test_leave_out counts that
what is listed runs and nothing else does.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

import sam
from sam.grid.cells import CellGrid
from sam.scene import Scene, Stage
from sam.scene.result import NO_FORCE
from verification.cost import estimates
from verification.runs import models


def of_sam(scene: Scene) -> list[Stage]:
    """Stages of the semi-analytical model as its plan has them, with the box that plastic strain may fill."""
    plan = sam.plan(scene)
    return [_with_box(scene, plan.grid, stage) if stage.runs else stage for stage in _needed(plan.stages)]


def _with_box(scene: Scene, grid: CellGrid, stage: Stage) -> Stage:
    """The stage, that of the eigenstrain kernels with its size."""
    if stage.stage != "eigenstrain kernels":
        return stage
    box = estimates.plastic_box(scene, grid)
    size = {
        "box_cells": [box.nx, box.ny, box.layers],
        "coefficients": box.coefficients,
        "bytes": box.width * box.coefficients,
    }
    return replace(stage, size=size)


def of_fem(scene: Scene) -> list[Stage]:
    """Stages of the axisymmetric model that its plan has, without those that are left out."""
    return _needed(models.plan(scene, models.FEM).stages)


def of_fem_3d(scene: Scene) -> list[Stage]:
    """Stages of the three-dimensional model, as `of_fem`."""
    return _needed(models.plan(scene, models.FEM_3D).stages)


def _needed(stages: Iterable[Stage]) -> list[Stage]:
    return [stage for stage in stages if stage.runs or stage.reason == NO_FORCE]
