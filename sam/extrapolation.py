# SPDX-License-Identifier: MIT
"""Two grids, one with twice the cells of the other, and what they say together: Richardson's extrapolation.

The errors of maxima, depths and displacements fall with the square of the cell once it is small: not smoothly where the edge of
a contact or of a plastic zone falls between cells. Of two values q_c (coarse) and q_f (fine, r times as many cells) the
extrapolated one is q_f + (q_f - q_c)/(r^2 - 1) (Richardson 1911). The coarse solution costs a tenth to a half of the fine one.
Their difference, recorded with each quantity, tells how good the fine value is by itself.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace

from sam.grid.cells import CellGrid
from sam.planner.grids import choose_grid
from sam.scene import Grid, LeftOut, Result, Scene, Status

SECOND_ORDER = (
    "approach_m",
    "p_max_Pa",
    "p_center_Pa",
    "mises_max_Pa",
    "mises_max_depth_m",
    "peeq_max",
    "peeq_max_depth_m",
    "residual_uz_center_m",
    "residual_mises_max_Pa",
    "p_max_bare_Pa",
    "mises_max_substrate_Pa",
    "mises_max_bare_Pa",
    "mises_max_film_Pa",
)
"""Quantities whose error is of second order; those not named are left as the finer grid gives them."""


def halved(count: int) -> int:
    """About half of a number of cells, odd if it is odd: a cell centre then stays on the apex."""
    return 2 * round((count - 1) / 4) + 1 if count % 2 else 2 * round(count / 4)


def coarse(scene: Scene, grid: CellGrid) -> Scene:
    """The scene on half as many cells over the same extent, its layers twice as thick if it gives them."""
    given, cells = scene.grid or Grid(), (halved(grid.nx), halved(grid.ny))
    change = {"cells": cells, "extent": (grid.nx * grid.hx, grid.ny * grid.hy)}
    if scene.body.plasticity is not None and given.depths:
        change["depths"] = given.depths[::2]
    elif scene.body.plasticity is not None and given.layers:
        change["layers"] = given.layers // 2
    solver = scene.solver.model_copy(update={"extrapolate": False})
    return scene.model_copy(update={"grid": given.model_copy(update=change), "solver": solver})


def solve_on_two(scene: Scene, solve: Callable[[Scene], Result]) -> Result:
    """The result of `solve` on the grid of the scene, its quantities extrapolated from a coarser one.

    Where the coarser grid does not converge or does not resolve the contact, the result says so and is not extrapolated.
    """
    before, fine = solve(coarse(scene, choose_grid(scene))), solve(scene)
    cost = {name: value + before.cost[name] for name, value in fine.cost.items()}
    if before.status is not Status.CONVERGED or not fine.converged:
        reason = f"{before.discretisation['cells']} cells: {before.status}"
        return replace(fine, cost=cost, left_out=[*fine.left_out, LeftOut("extrapolation", reason)])
    ratio = fine.discretisation["cells"][0] / before.discretisation["cells"][0]
    found = extrapolated(before.quantities, fine.quantities, ratio)
    changes = {name: found[name] / fine.quantities[name] - 1 for name in found if fine.quantities[name]}
    extra = {"extrapolated_from_cells": before.discretisation["cells"], "extrapolation_change": changes}
    return replace(
        fine, quantities=fine.quantities | found, discretisation=fine.discretisation | extra, cost=cost
    )  # fmt: skip


def extrapolated(
    before: Mapping[str, float | None], fine: Mapping[str, float | None], ratio: float
) -> dict[str, float]:
    """Those quantities of SECOND_ORDER that both have."""
    both = [name for name in SECOND_ORDER if before.get(name) is not None and fine.get(name) is not None]
    return {name: fine[name] + (fine[name] - before[name]) / (ratio**2 - 1) for name in both}
