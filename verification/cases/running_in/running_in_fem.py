# SPDX-License-Identifier: MIT
"""Three asperities that harden by back-stresses and wear between the cycles: SAM against finite elements.
Each removes by its own plastic strain; beside it the finite elements remove what SAM does, so that the
transfer of the state alone is compared.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise
from math import lcm
from typing import Any

import numpy as np

from fem_reference.spatial import WornCycle, worn_cycles
from sam.scene import Plasticity, Result, Scene, Wear
from verification.cases.case import SAM, Context, DataFrame, with_body, with_loading
from verification.cases.recipes import cells_of_asperities, rubbed
from verification.compare.measures import Plane, depths_compared, patch_pressure, spots
from verification.judging import relative_l2
from verification.runs.sampling import Tables

CELLS = (32, 64)
SQUARES = 16  # along a side; the rim of a scar bears on single cells, of any size
CYCLES, STEPS = 2, 2
LIMIT, THICK = 0.012, 4e-9  # of the plastic strain, down to this depth in m below the surface of each cycle
LAW = Plasticity(
    law="linear",
    yield_stress=1.36e9,  # of rough-asperities.toml, before any strain
    modulus=10e9,
    layer_thickness=THICK,
    kinematic={"modulus": (100e9,), "recovery": (100.0,)},
)


def scene_of(base: Scene, cells: int) -> Scene:
    """The asperities on cells x cells cells, with back-stresses, friction map and wear."""
    scene = cells_of_asperities(rubbed(base, "map"), cells)
    scene = with_loading(scene, steps=STEPS, cycles=CYCLES)
    wear = Wear(strain_limit=np.inf, strain_limit_layer=LIMIT, smoothing_window=0)
    return with_body(scene, plasticity=LAW).model_copy(update={"wear": wear})


def compared(context: Context) -> Iterator[dict[str, Any]]:
    """SAM off FEM on three grids, at the peak of the first and of the last cycle and after it, where FEM
    removes by its own strain or the depths of SAM; wears: least depth in m that SAM removes in a cycle.
    """
    base = context.scene("rough-asperities")
    for cells in CELLS:
        scene = scene_of(base, cells)
        sam = context.solve(SAM, scene, f"sam-{cells}")
        alone = context.solve(SAM, with_loading(scene, cycles=1), f"sam-{cells}-alone")
        states = (*(f"cycle-{cycle}" for cycle in range(1, CYCLES)), "unloaded")
        worn = np.array([surface(sam, state, "worn_m") for state in states])
        steps = np.diff(worn, axis=0, prepend=0.0 * worn[:1])
        context.progress(f"{context.case}, {cells} cells, FEM", CELLS.index(cells), len(CELLS))
        for mode, fem in zip(("own", "given"), worn_cycles(scene, None, list(steps)), strict=True):
            first = alone.tables, fem[0].tables
            for cycle, own in ((1, alone), (CYCLES, sam)):
                row = {"cells": cells, "mode": mode, "cycle": cycle}
                row |= differences(own, fem[cycle - 1], first) | {"wears": steps.max(axis=(1, 2)).min()}
                shown = (cells, mode, cycle) == (CELLS[-1], "own", CYCLES)
                yield row if shown else {key: row[key] for key in row if key != "lowered"}


def differences(sam: Result, fem: WornCycle, first: tuple[Tables, Tables]) -> dict[str, Any]:
    """L2 of SAM off FEM; strain: the worst spot of the first cycle. lowered: heights lost on y = 0 in m."""
    (x, _, own), (*_, other) = patch_pressure(sam.tables), patch_pressure(fem.tables)
    below, strains = (Plane.of(sam.tables), Plane.of(fem.tables)), []
    for spot in spots(*first):
        z = depths_compared(below[1], spot.x, spot.radius)
        strains.append(relative_l2(*(each.below(spot.x, z) for each in below)))
    worn, moved = (surface(sam, "unloaded", column) for column in ("worn_m", "uz_m"))
    middle = slice(x.size // 2 - 1, x.size // 2 + 1)
    lost = [each[:, middle].mean(axis=1) for each in (worn + moved, fem.worn + fem.moved)]
    return {
        "pressure": relative_l2(own, other),
        "squares": relative_l2(over_squares(own), over_squares(other)),
        "strain": max(strains),
        "residual": relative_l2(worn + moved, fem.worn + fem.moved),
        "moved": relative_l2(moved, fem.moved),
        "volume": abs(worn.sum() / fem.worn.sum() - 1.0),
        **dict(zip(("x", "lowered", "lowered expected"), (x, *lost), strict=True)),
    }


def surface(sam: Result, state: str, column: str) -> np.ndarray:
    """(nx, ny) of the cells of SAM."""
    found: np.ndarray = sam.grids[state]["surface"].cell_data[column][..., 0]
    return found


def over_squares(values: np.ndarray) -> np.ndarray:
    """(SQUARES, SQUARES) means of values on cells (n, n), each cell by its shares of the squares."""
    parts = lcm(SQUARES, n := values.shape[0])
    fine, along = values.repeat(parts // n, axis=0).repeat(parts // n, axis=1), parts // SQUARES
    means: np.ndarray = fine.reshape(SQUARES, along, SQUARES, along).mean(axis=(1, 3))
    return means


def shrinking(rows: DataFrame, column: str) -> float:
    """Largest ratio to the coarser grid."""
    return max(fine / coarse for coarse, fine in pairwise(rows[column]))
