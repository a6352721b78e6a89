# SPDX-License-Identifier: MIT
"""Near-perfect and perfect plasticity far beyond yield, in few load steps, in both models."""

import math
from collections.abc import Iterator
from typing import Any

import numpy as np

from sam.scene import Scene
from verification.cases.case import (
    FEM,
    SAM,
    Context,
    DataFrame,
    with_body,
    with_grid,
    with_keys,
    with_loading,
    with_mesh,
)
from verification.cases.recipes import at_ratio
from verification.checks.certificates import curves_of
from verification.checks.conditions import peak_rows
from verification.references import contact_of

MODELS = {"sam": SAM, "fem": FEM}
SLOPES = {"perfect": 0.0, "nearly-perfect": 1e-4}  # of the yield curve over Young's modulus
EXTENT = {6.2: (2.5, 3.3), 15.0: (5.5, 5.4)}
"""p0/sigma_y0 -> half sides of the grid and depth in elastic radii; the contact grows to 1.1 and 1.9."""
CELLS = {"quick": {6.2: (6, 6), 15.0: (4, 4)}, "full": {6.2: (8, 10), 15.0: (6, 8)}}
"""Of SAM and of FEM in the elastic contact radius."""
TIGHT = 1e-9  # tolerance of the whole load at once: more than SAM iterates


def scene_of(
    base: Scene, ratio: float, cells: tuple[int, int], *, slope: float = 0.0, steps: int = 15
) -> Scene:
    """p0/sigma_y0 = ratio on these cells; layers are even down to 1.8 radii, then ever thicker."""
    if slope:
        keys = {"law": "linear", "modulus": slope * base.body.young}
        base = with_body(base, plasticity=base.body.plasticity.model_copy(update=keys))
    scene = with_loading(at_ratio(base, ratio), steps=steps, unload=False)
    a, (count, elements), (reach, deepest) = contact_of(scene).contact_radius, cells, EXTENT[ratio]
    n, even = 2 * round(reach * count) + 1, np.arange(round(3.0 * count) + 1) / count
    faces = even + (deepest - 3.0) / 1.2**2 * np.maximum(even - 1.8, 0.0) ** 2
    grid = {"cells": (n, n), "extent": (n * a / count,) * 2, "depths": tuple(float(z) for z in a * faces)}
    return with_mesh(with_grid(scene, **grid), elements)


def frame(context: Context) -> Iterator[dict[str, Any]]:
    """Both ratios with both models; and one step from nothing. A peak that was not reached has no numbers."""
    base, solves = context.scene("plastic-perfect"), []
    for ratio, cells in CELLS[context.level].items():
        for law in SLOPES if context.level == "full" else ("perfect",):
            scene = scene_of(base, ratio, cells, slope=SLOPES[law])
            solves += [(f"{ratio:g}-{law}", name, scene) for name in MODELS]
    once = with_keys(scene_of(base, 15.0, CELLS["quick"][15.0], steps=1), "solver", tolerance=TIGHT)
    for name, model, scene in [*solves, ("15-perfect-one-step", "sam", once)]:
        result = context.solve(MODELS[model], scene, f"{name}-{model}", demand=False)
        row = {"sweep": "solves", "solve": name, "model": model, "status": str(result.status)}
        row |= {"attempts": len(curves_of(result)), "cuts": result.cost["step_cuts"]}
        row["time [s]"] = result.cost["cpu_s"]
        q, force = result.quantities, result.tables["history"]["force_N"][-1]
        values = {"area": q["contact_area_m2"], "approach": q["approach_m"], "largest strain": q["peeq_max"]}
        values["axis"] = float(np.max(peak_rows(result, "axis")["peeq"]))
        values["load"] = abs(q["force_N"] / force - 1.0)
        values = dict.fromkeys(values, math.nan) if result.last_fitting else values
        yield row | values | {"unfinished": float(not result.converged), "unfinished expected": 0.0}


def apart(rows: DataFrame, column: str) -> float:
    """Largest relative difference of both models, over the solves of both."""
    sam, fem = (rows[rows["model"] == model].set_index("solve")[column] for model in MODELS)
    return float(np.max(np.abs(sam[fem.index].to_numpy() / fem.to_numpy() - 1.0)))
