# SPDX-License-Identifier: MIT
"""Running-in on a way: a rough pin below a rough disc that moves on, another stretch in each pass."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from sam.scene import Path, Result, Scene
from verification.cases.case import SAM, Context, with_grid, with_loading
from verification.cases.running_in.study import outside
from verification.runs import models

CELLS, STEPS, PASSES, RISES = 24, 6, 2, 3  # of the small scene: cells of 1 um, steps of one cell
FEWER = 2  # steps of the one that goes on from the middle of a way
PRESSED = 1.5  # times the nominal pressure of the scene, for spots of enough cells
COLUMNS = ("work_J", "friction_mean", "protected_mean", "wear_of_pass_m3", "new_strain_max", "fx_mean_N")


def small(scene: Scene, steps: int = STEPS) -> Scene:
    """The scene on few cells, in few passes over a short way of so many steps."""
    cell, share = scene.grid.extent[0] / scene.grid.cells[0], CELLS / scene.grid.cells[0]
    scene = with_grid(scene, cells=(CELLS, CELLS), extent=(CELLS * cell, CELLS * cell))
    path = Path(start=(-steps / 2 * cell, 0.0), end=(steps / 2 * cell, 0.0), steps=steps)
    force = PRESSED * share**2 * scene.loading.force
    return with_loading(scene, force=force, steps=RISES, cycles=PASSES, path=path)


def resumed(scene: Scene) -> tuple[int, float]:
    """How many numbers of its tables differ where the scene goes on from the middle of the last
    way, and how much larger that checkpoint is, but for the strains at points,
    than the one in the middle of the first way.
    """
    kept: list = []
    found = models.solve(scene, SAM, checkpoint=kept.append)
    by_steps = {each.done: each for each in kept}
    last = kept[-1].total - scene.loading.path.steps // 2 - 1
    first = last - kept[-1].total // scene.loading.cycles * (scene.loading.cycles - 1)
    again = models.solve(scene, SAM, start=by_steps[last])
    differing = sum(
        int(not np.array_equal(one, two, equal_nan=np.asarray(one).dtype.kind == "f"))
        for name, table in found.tables.items()
        for column, values in table.items()
        for one, two in zip(values, again.tables[name][column], strict=True)
    )
    before, after = (
        sum(array.nbytes for name, array in by_steps[at].arrays.items() if ".points." not in name)
        for at in (first, last)
    )
    return differing, after / before - 1


def runs(context: Context) -> Iterator[dict[str, Any]]:
    """The contact on a way, and at one place with as many stretches of the disc."""
    scene = context.scene("running-in-way")
    own = scene if context.level == "full" else small(scene)
    moving = context.solve(SAM, own, "way")
    rest = context.solve(SAM, with_loading(own, path=None), "rest")
    differing, growth = resumed(small(scene, FEWER))
    passes = on_way(own, moving, rest) | {"resumed": differing, "growth": growth}
    yield {"run": "on-a-way"} | cost(moving) | passes
    yield {"run": "at-rest"} | cost(rest)


def cost(result: Result) -> dict[str, Any]:
    """Of a run, each load step an application of the residual stress or more."""
    steps, counted = len(result.tables["history"]["step"]), result.cost["operator_applications"]
    return {
        "unconverged": int(not result.converged),
        "load steps": steps,
        "applications a step": counted / steps,
    }


def on_way(scene: Scene, moving: Result, rest: Result) -> dict[str, Any]:
    """What the passes say of their friction and wear."""
    passes, worn = moving.tables["passes"], moving.tables["surface"]
    numbers = np.array([passes[name] for name in COLUMNS], dtype=float)
    cell = np.prod(scene.grid.extent) / np.prod(scene.grid.cells)
    unloaded = np.asarray(worn["worn_m"])[np.array(worn["state"]) == "unloaded"]
    volume = unloaded.sum() * cell / np.sum(passes["wear_of_pass_m3"])
    low, high = scene.friction.low, scene.friction.high
    return {
        "thinning limit": scene.friction.thinning_limit,
        "increments": cost(moving)["applications a step"] - cost(rest)["applications a step"],
        "missing": scene.loading.cycles * len(COLUMNS) - int(np.isfinite(numbers).sum()),
        "volume": float(abs(volume - 1)),
        "outside": outside(np.asarray(passes["friction_mean"]), low, high),
        **{name: np.asarray(passes[name]) for name in ("pass", "friction_mean", "wear_of_pass_m3")},
    }
