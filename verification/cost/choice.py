# SPDX-License-Identifier: MIT
"""Cells, layers and load steps for an accuracy that a scene asks for: with which it begins, and how many the
table of advice has for it.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import ceil, sqrt

import sam
from sam.scene import Grid, Scene
from verification.cost.advice import (
    COATED,
    DEEP,
    ELASTIC,
    LOAD_STEPS,
    NEVER,
    SLIDING,
    YIELDING,
    kind_of,
    table,
)
from verification.runs import models
from verification.uncertainty import RATIO, alone, coarser, has_history, why_not

ADVISED = {ELASTIC: "p_max_Pa", COATED: "p_max_Pa"} | dict.fromkeys((YIELDING, DEEP, SLIDING), "peeq_max")
"""Kind of scene -> the quantity that its table of advice is about."""
# Of the accuracy: the errors that the table of advice is asked for. The uncertainty is 3 to 4 times an error
# in the median (case uncertainty-study), and its parts by cells and load steps add up.
CELLS_SHARE, STEPS_SHARE = 1 / 4.5, 1 / 9
FEWEST_CELLS = 4.2  # in the contact radius of the coarsest of three grids: below four it has no uncertainty
# From each of the first three grids to the next, so that rounding to whole cells leaves 1.3; elements: more.
RATIOS = {models.SAM: 1.4, models.FEM: RATIO, models.FEM_3D: RATIO}
FEWEST_STEPS = 6  # 4, 3 and 2 steps may agree by chance: linear hardening, 0.29 of the error
MOST_STEPS = 1000
MOST_CELLS = 4097


@dataclass(frozen=True)
class Choice:
    """cells: in the contact radius; steps: of the load, 0 where they decide nothing."""

    cells: float
    steps: int

    def __str__(self) -> str:
        steps = f" and {self.steps} load steps" if self.steps else ""
        return f"{self.cells:.3g} cells in the contact radius{steps}"


def quantities_of(scene: Scene) -> tuple[str, ...]:
    """Those whose accuracy is asked for: by the scene, else the one of its table of advice."""
    own = scene.solver.accuracy_of
    return tuple(own) if own else (ADVISED[kind_of(scene)],)


def first_choice(scene: Scene, model: str) -> Choice:
    """With what the first three grids of a scene end: what the table of advice has, or for a scene with a
    history the fewest cells and steps, as a grid that is finer than it has to be costs more there.

    Raises ModelError as `expected`, and for quantities without an uncertainty.
    """
    advised = expected(scene, model)
    for name in quantities_of(scene):
        if reason := why_not(name, scene):
            raise models.ModelError(f'solver.accuracy_of = ["{name}"]: {reason}: remove it')
    return Choice(FEWEST_CELLS * RATIOS[model] ** 2, FEWEST_STEPS) if has_history(scene) else advised


def expected(scene: Scene, model: str) -> Choice:
    """What the table of advice has for the accuracy of a scene.

    Raises ModelError for a kind of scene or an accuracy that was not measured.
    """
    accuracy, kind = scene.solver.accuracy, kind_of(scene)
    if kind not in ADVISED:
        raise models.ModelError(
            f"solver.accuracy = {accuracy:g}: remove it, no error was measured for such scenes"
        )
    cells = _resolution(kind, model, accuracy * CELLS_SHARE, 0.5)
    if cells is None:
        raise models.ModelError(
            f"solver.accuracy = {accuracy:g}: larger, or another --model: {model} does not reach it"
        )
    steps = 0
    if has_history(scene):
        steps = ceil(_resolution(kind, LOAD_STEPS, accuracy * STEPS_SHARE, 1.0) or scene.loading.steps)
    return Choice(
        max(cells, FEWEST_CELLS * RATIOS[model] ** 2),
        min(max(steps, FEWEST_STEPS), MOST_STEPS) if steps else 0,
    )


def chosen_scene(scene: Scene, model: str, choice: Choice) -> Scene:
    """The scene with these cells and load steps, asked for its uncertainty."""
    scene = alone(scene)
    changed = scene.model_copy(update={"solver": scene.solver.model_copy(update={"uncertainty": True})})
    if model == models.SAM:
        grid = sam.choose_grid(scene)
        a, b = sam.hertz_semi_axes(scene)
        factor = sqrt(a * b / (grid.hx * grid.hy)) / choice.cells
        cells = tuple(min(coarser(count, factor) + 2 * (factor < 1), MOST_CELLS) for count in grid.shape)
        given = (scene.grid or Grid()).model_copy(update={"cells": cells})
        changed = changed.model_copy(update={"grid": given})
    else:
        fem = scene.fem.model_copy(update={"cells_per_radius": ceil(choice.cells)})
        changed = changed.model_copy(update={"fem": fem})
    if not choice.steps:
        return changed
    loading = scene.loading
    steps: dict[str, int] = {"steps": choice.steps}
    if loading.unload_steps:
        steps["unload_steps"] = min(ceil(loading.unload_steps * choice.steps / loading.steps), MOST_STEPS)
    return changed.model_copy(update={"loading": loading.model_copy(update=steps)})


def _resolution(kind: str, method: str, error: float, power: float) -> float | None:
    """Cells or load steps to an error, of the table; beyond its smallest error with a power. None: never."""
    own = sorted(
        (row for row in table() if row.kind == kind and row.method == method), key=lambda row: -row.error
    )
    if not own:
        return None
    row = next((row for row in own if row.error <= error), own[-1])
    return None if row.bound == NEVER else row.resolution * max(row.error / error, 1.0) ** power
