# SPDX-License-Identifier: MIT
"""Running-in on a way: a rough pin with film and wear below a rough disc that moves on in steps of one cell,
another stretch of it in each pass; what it costs beside the same contact at rest.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from sam.scene import Path, Result, Scene
from verification.cases.case import SAM, Case, Context, Measured, Plot, SmallTable, with_grid, with_loading
from verification.cases.running_in.study import outside
from verification.figures.lines import of_passes
from verification.runs import models

CELLS, STEPS, PASSES, RISES = 24, 6, 2, 3  # of the small scene: cells of 1 um, steps of one cell
FEWER = 2  # steps of the one that goes on from the middle of a way
PRESSED = 1.5  # times the nominal pressure of the scene, for spots of enough cells
COLUMNS = ("work_J", "friction_mean", "protected_mean", "wear_of_pass_m3", "new_strain_max", "fx_mean_N")


@dataclass(frozen=True)
class OnWay:
    """What was found. moving, rest: on a way, and at one place with as many stretches of the disc; differing:
    numbers of the tables of the small scene that are others after it went on from the middle of its last way;
    growth: of its checkpoints, from the middle of the first way to there.
    """

    scene: Scene
    moving: Result
    rest: Result
    differing: int
    growth: float


def small(scene: Scene, steps: int = STEPS) -> Scene:
    """The scene on few cells, in few passes over a short way of so many steps."""
    cell, share = scene.grid.extent[0] / scene.grid.cells[0], CELLS / scene.grid.cells[0]
    scene = with_grid(scene, cells=(CELLS, CELLS), extent=(CELLS * cell, CELLS * cell))
    path = Path(start=(-steps / 2 * cell, 0.0), end=(steps / 2 * cell, 0.0), steps=steps)
    force = PRESSED * share**2 * scene.loading.force
    return with_loading(scene, force=force, steps=RISES, cycles=PASSES, path=path)


def resumed(scene: Scene) -> tuple[int, float]:
    """How many numbers of its tables differ where the scene goes on from the middle of the last way, and how
    much larger that checkpoint is than the one in the middle of the first way.
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
    before, after = (sum(a.nbytes for a in by_steps[at].arrays.values()) for at in (first, last))
    return differing, after / before - 1


def an_increment(result: Result) -> float:
    """Applications of the residual-stress operator in a load step."""
    return result.cost["operator_applications"] / len(result.tables["history"]["step"])


class RunningInOnWay(Case):
    """Film, friction and wear of passes over a way."""

    def solve(self, context: Context) -> OnWay:
        scene = context.scene("running-in-way")
        own = scene if context.level == "full" else small(scene)
        moving = context.solve(SAM, own, "way")
        rest = context.solve(SAM, with_loading(own, path=None), "rest")
        return OnWay(own, moving, rest, *resumed(small(scene, FEWER)))

    def measure(self, found: OnWay) -> dict[str, Measured | float]:
        passes, worn, friction = (
            found.moving.tables["passes"],
            found.moving.tables["surface"],
            found.scene.friction,
        )
        numbers = np.array([passes[name] for name in COLUMNS], dtype=float)
        last = np.array(worn["state"]) == "unloaded"
        cell = np.prod(found.scene.grid.extent) / np.prod(found.scene.grid.cells)
        volume = np.asarray(worn["worn_m"])[last].sum() * cell / np.sum(passes["wear_of_pass_m3"])
        missing = found.scene.loading.cycles * len(COLUMNS) - int(np.isfinite(numbers).sum())
        return {
            "unconverged": Measured(sum(not each.converged for each in (found.moving, found.rest)), 0),
            "increments": an_increment(found.moving) - an_increment(found.rest),
            "resumed": Measured(found.differing, 0),
            "checkpoint": found.growth,
            "missing": Measured(missing, 0),
            "volume": float(abs(volume - 1)),
            "friction-range": outside(np.asarray(passes["friction_mean"]), friction.low, friction.high),
        }

    def setup(self, found: OnWay) -> Iterator[tuple[str, str]]:
        loading, grid = found.scene.loading, found.scene.grid
        yield "Patch", f"{grid.cells[0]} x {grid.cells[1]} cells of 1 µm, {loading.cycles} passes"
        yield "Way of a pass", f"{1e6 * loading.path.length:g} µm in {loading.path.steps} steps"

    def tables(self, found: OnWay) -> Iterator[SmallTable]:
        shown = ("operator_applications", "contact_iterations", "step_cuts")
        rows = []
        for name, each in (("on a way", found.moving), ("at rest", found.rest)):
            steps = str(len(each.tables["history"]["step"]))
            rows.append((name, steps, *(str(each.cost[key]) for key in shown), f"{an_increment(each):.1f}"))
        columns = "run|load steps|operator applications|contact iterations|halved steps|applications a step"
        yield SmallTable("Cost", columns.split("|"), rows)
        visits = found.moving.tables["visits"]
        ways = zip(visits["way_m"], visits["thinning_limit"], visits["visits"], strict=True)
        yield SmallTable(
            "Visits of summits to cells, by the way out of contact",
            ("way up to [µm]", "thinning that the film may take [%]", "visits"),
            [(f"{1e6 * way:.3g}", f"{100 * limit:.3g}", str(count)) for way, limit, count in ways],
        )

    def notes(self, found: OnWay) -> Iterator[str]:
        limit = found.scene.friction.thinning_limit
        yield (
            f"By Eq. 16 and 17 of the paper, with the time between two passes of the disc, the film may thin "
            f"by {limit:.2%}: so in the first visit. The pin stays in the apparent contact, and later visits "
            "follow after the gaps between summits alone."
        )

    def figures(self, found: OnWay) -> Iterator[Plot]:
        yield Plot(
            of_passes(found.moving.tables["passes"]),
            "passes",
            "Passes of running-in on a way",
            "Coefficient of friction and wear of each pass over its number",
            "Means over the places of a pass, and the volume that it removes at its end.",
        )


CASES = (RunningInOnWay("running-in-way"),)
