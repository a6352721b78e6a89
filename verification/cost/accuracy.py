# SPDX-License-Identifier: MIT
"""Results to an accuracy that a scene asks for: cells, layers and load steps from the table of advice,
confirmed by the uncertainty of the result, and refined where that is too large.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import ceil, sqrt

import sam
from sam.scene import Grid, Result, Scene
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
from verification.uncertainty import Solve, alone, coarser, has_history, solve as solve_uncertain, why_not

ADVISED = {ELASTIC: "p_max_Pa", COATED: "p_max_Pa"} | dict.fromkeys((YIELDING, DEEP, SLIDING), "peeq_max")
"""Kind of scene -> the quantity that its table of advice is about."""
# Of the accuracy: the errors of cells and load steps to begin with. The uncertainty is 3 to 4 times an error
# in the median (case uncertainty-study), and both parts add up.
CELLS_SHARE, STEPS_SHARE = 1 / 4.5, 1 / 9
FEWEST_CELLS = 10  # in the contact radius: the coarsest of three grids then has more than four
FEWEST_STEPS, MOST_STEPS = 4, 1000
MOST_CELLS = 4097
REFINEMENTS = 2
AIMED = 0.8  # of the accuracy: at which a refinement aims, as the uncertainty does not fall smoothly


@dataclass(frozen=True)
class Choice:
    """cells: in the contact radius; steps: of the load, 0 where they decide nothing."""

    cells: float
    steps: int

    def __str__(self) -> str:
        steps = f" and {self.steps} load steps" if self.steps else ""
        return f"{self.cells:.3g} cells in the contact radius{steps}"


def solve(scene: Scene, model: str, solver: Solve | None = None) -> Result:
    """The result of a scene as it asks for it: plain, with its uncertainty, or to an accuracy.

    Raises what the solver raises, and ModelError as `first_choice`.
    """
    if scene.solver.accuracy is None:
        return solve_uncertain(scene, model, solver)
    names, choice, attempt = quantities_of(scene), first_choice(scene, model), 0
    while True:
        result = solve_uncertain(chosen_scene(scene, model, choice), model, solver)
        found = _record(scene, names, result, choice)
        if found["reached"] or found["relative"] is None or attempt == REFINEMENTS:
            return replace(result, discretisation={**result.discretisation, "accuracy": found})
        attempt, choice = attempt + 1, _finer(scene, names, result, choice)


def missed(result: Result) -> str:
    """What an asked accuracy came to, where it was not reached; else empty."""
    found = result.discretisation.get("accuracy")
    if not found or found["reached"]:
        return ""
    words = f"accuracy {100 * found['asked']:g} % not reached with {found['with']}"
    if found["relative"] is None:
        return f"{words}: {found['quantity']} has no uncertainty: {found['flag']}"
    return f"{words}: {found['quantity']} is known to {100 * found['relative']:.2g} %; try {found['next']}"


def quantities_of(scene: Scene) -> tuple[str, ...]:
    """Those whose accuracy is asked for: by the scene, else the one of its table of advice."""
    own = scene.solver.accuracy_of
    return tuple(own) if own else (ADVISED[kind_of(scene)],)


def first_choice(scene: Scene, model: str) -> Choice:
    """What the table of advice has for the accuracy of a scene.

    Raises ModelError for a kind of scene or an accuracy that was not measured, and for quantities without an
    uncertainty.
    """
    accuracy, kind = scene.solver.accuracy, kind_of(scene)
    if kind not in ADVISED:
        raise models.ModelError(
            f"solver.accuracy = {accuracy:g}: remove it, no error was measured for such scenes"
        )
    for name in quantities_of(scene):
        if reason := why_not(name, scene):
            raise models.ModelError(f'solver.accuracy_of = ["{name}"]: {reason}: remove it')
    cells = _resolution(kind, model, accuracy * CELLS_SHARE, 0.5)
    if cells is None:
        raise models.ModelError(
            f"solver.accuracy = {accuracy:g}: larger, or another --model: {model} does not reach it"
        )
    steps = 0
    if has_history(scene):
        steps = ceil(_resolution(kind, LOAD_STEPS, accuracy * STEPS_SHARE, 1.0) or scene.loading.steps)
    return Choice(max(cells, FEWEST_CELLS), min(max(steps, FEWEST_STEPS), MOST_STEPS) if steps else 0)


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


def _record(scene: Scene, names: tuple[str, ...], result: Result, choice: Choice) -> dict[str, object]:
    """What came of an attempt: the quantity that is known worst, and whether it is good enough."""
    asked, entries = scene.solver.accuracy, result.uncertainty or {}
    missing = {"relative": None, "flag": str(result.status)}
    known = {name: entries.get(name, missing) for name in names}
    worst = max(
        known,
        key=lambda name: float("inf") if known[name].get("relative") is None else known[name]["relative"],
    )
    relative = known[worst].get("relative")
    reached = relative is not None and relative <= asked
    found = {"asked": asked, "quantity": worst, "relative": relative, "reached": reached, "with": str(choice)}
    if relative is None:
        return {**found, "flag": known[worst]["flag"]}
    return found if reached else {**found, "next": str(_finer(scene, names, result, choice))}


def _finer(scene: Scene, names: tuple[str, ...], result: Result, choice: Choice) -> Choice:
    """More of what the uncertainty is due to: both parts to the same share of what they are together."""
    aim = AIMED * scene.solver.accuracy
    entries = [(result.uncertainty[name], abs(result.quantities[name])) for name in names]
    of_cells, of_steps = (
        max(sum(entry[key] for key in keys) / size for entry, size in entries)
        for keys in (("u_cells", "u_box"), ("u_steps",))
    )
    share = aim * (2 / 3 if choice.steps else 1.0)
    cells = choice.cells * max(sqrt(of_cells / share), 1.0)
    steps = ceil(choice.steps * max(of_steps / (aim - share), 1.0)) if choice.steps else 0
    return Choice(cells, min(steps, MOST_STEPS))
