# SPDX-License-Identifier: MIT
"""The conditions of a returned solution, as in `certificates`, in the last cycle of a body that wears:
strains are counted from the start of that cycle, heights from the worn surface.
"""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np

from sam import choose_grid
from sam.scene import Checkpoint, CounterBody, Result, Scene
from verification.cases.case import SAM, Context, with_grid, with_keys, with_loading
from verification.cases.running_in.running_in_converged import COARSEST, Member
from verification.checks import cells as cell_checks, conditions as contact_checks, film as film_checks
from verification.checks.certificates import late, solved
from verification.checks.conditions import surface_of
from verification.checks.material import around, fields_at_points

CYCLES = (2, 5)
SEED, TOLERANCE = 1, 1e-6
"""Of wear-converged: the surface that wears most; under a rigid plane it needs twice the load."""
DEEPER = 14e-6, 19e-6  # m: further faces of layers


def frame(context: Context) -> Iterator[dict[str, float]]:
    """Every condition of the last cycle after more and more; worn: the volume in m3 before its peak."""
    for cycles in CYCLES:
        scene = scene_of(context.scene("running-in-bulk"), cycles)
        result, records = solved(scene, SAM)
        volume = float(result.tables["cycles"]["wear_volume_m3"][-2])
        yield {"cycles": cycles} | conditions_of(scene, result, records) | {"worn": volume}


def scene_of(base: Scene, cycles: int) -> Scene:
    """The surface below a rigid plane."""
    scene = Member(SEED, COARSEST, force=2.0).of(base)
    scene = scene.model_copy(update={"counterbody": CounterBody(shape="flat")})
    scene = with_grid(scene, depths=(*scene.grid.depths, *DEEPER))
    return with_loading(with_keys(scene, "solver", tolerance=TOLERANCE), cycles=cycles)


def conditions_of(scene: Scene, result: Result, records: Sequence[Checkpoint]) -> dict[str, float]:
    """All conditions of the last cycle."""
    before, loaded, end = last_cycle(records)
    result = lowered(result)
    values = late(result) | {
        "load": contact_checks.load(scene, result),
        "displacement": max(
            cell_checks.displaced(scene, result, loaded), cell_checks.left(scene, result, [end])
        ),
        "friction": contact_checks.slips(scene, result),
    }
    values |= contact_checks.flow(scene, [before, *loaded], choose_grid(scene).depths)
    states = (contact_checks.yields(scene, result, state) for state in ("peak", "unloaded"))
    values["yield"] = max(values["yield"], *states)
    values["film"] = film_checks.states(scene, [since(before, each) for each in loaded])
    return values


def last_cycle(records: Sequence[Checkpoint]) -> tuple[Checkpoint, list[Checkpoint], Checkpoint]:
    """The record before the last cycle, those of its loading, and that of its end, unloaded and worn."""
    forces = [record.tree()["state"]["load"]["force"] for record in records]
    first = max(k for k in range(len(forces) - 1) if forces[k] == 0.0) + 1
    return records[first - 1], list(records[first:-1]), records[-1]


def lowered(result: Result) -> Result:
    """The result with its heights less what was worn off, and its approach from the first touch of that."""
    data = result.fields.cell_data
    height = np.asarray(data["height_m"]) - np.asarray(data["worn_m"])
    cells = surface_of(result)[2].size  # of those of the plane y = 0 nothing is asked
    touch = float(data["height_m"][:cells].max() - height[:cells].max())
    quantities = result.quantities | {"approach_m": result.quantities["approach_m"] - touch}
    fields = replace(result.fields, cell_data=data | {"height_m": height})
    return replace(result, quantities=quantities, fields=fields)


def since(before: Checkpoint, now: Checkpoint) -> Any:
    """A record whose stress and plastic strain are what has come since another one."""
    start, tree = before.tree(), now.tree()
    old, new = (fields_at_points(each["state"]["material"])["strain"] for each in (start, tree))
    box, larger = start["extent"]["window"], tree["extent"]["window"]
    inside = box | {"i0": box["i0"] - larger["i0"], "j0": box["j0"] - larger["j0"]}
    strain, stress = (around(v, inside, new.shape[2:]) for v in (old, start["last"]["stress"]))
    points = {"strain": (new - strain).reshape(*new.shape[:2], -1)}
    state = {**tree["state"], "material": {"cells": np.ones(new.shape[2:], bool), "points": points}}
    last = {**tree["last"], "stress": tree["last"]["stress"] - stress}
    return SimpleNamespace(tree=lambda: {**tree, "state": state, "last": last})
