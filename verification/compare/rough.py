# SPDX-License-Identifier: MIT
"""SAM against the three-dimensional FEM on a rough patch: the rows of compare.csv, see
verification.compare.comparison.

The tolerances hold for spots of three cells in the radius or more; of smaller ones neither model knows the
pressure.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from sam.scene import Scene
from verification.compare.rough_measures import PatchPressure, Spot, residual_line, spots
from verification.compare.rows import Pair, Solution, field_row, scalar_row
from verification.judging import Verdict

EDGES = "cells and nodes at the edges of spots of a few cells"
SCALARS = (
    ("approach_m", "relative", 2e-2, "a global quantity, first order in the cells of small spots"),
    ("contact_area_m2", "relative", 5e-2, f"{EDGES}, in between which both models place the edge"),
)
LOAD = (2e-2, "an integral of the pressure, insensitive to the edge of the spot")
PRESSURE = (0.15, EDGES)
FRICTION = ("friction_coefficient", "relative", 1e-2, "local coefficients weighted by the loads of the spots")
STRAIN = ("peeq_max", "relative", 0.1, "cells, layers and elements in plastic zones of a few cells")
SPOT, PATCH_PRESSURE, RESIDUAL_LINE = "load of the spot", "p_Pa over the patch", "residual uz_m on the line"
NAMES = (*(row[0] for row in (*SCALARS, FRICTION, STRAIN)), SPOT, PATCH_PRESSURE, RESIDUAL_LINE)
"""What a rough scene may be compared by; SPOT stands for every spot."""
RESIDUAL = (0.25, "a sum of the plastic strains near the surface, first order in the cells of both models")


def compare_rough(scene: Scene, sam: Solution, fem: Solution) -> list[Verdict]:
    """Every comparison of two results of a rough scene; without load the scalars only."""
    plastic, slides = scene.body.plasticity is not None, scene.coefficient > 0.0
    pair = Pair(sam, fem, float("nan"), punch=False, plastic=plastic, slides=slides, spatial=True)
    wanted = SCALARS + (FRICTION,) * (not scene.constant_friction) + (STRAIN,) * (plastic and not slides)
    rows = [scalar_row(pair, name, metric, limit) for name, metric, *limit in wanted]
    if fem.quantities.get("force_N") == 0:
        return rows
    try:
        found = spots(*(PatchPressure.of(solved.tables) for solved in (sam, fem)))
    except (KeyError, ValueError):  # a table is missing: its rows fail below
        found = []
    rows += [field_row(pair, f"{SPOT} at {_place(spot)}", _load_of(spot), LOAD) for spot in found]
    rows.append(field_row(pair, PATCH_PRESSURE, _pressure, PRESSURE))
    if plastic and scene.loading.unload:
        rows.append(field_row(pair, RESIDUAL_LINE, _residual, RESIDUAL))
    return rows


def _place(spot: Spot) -> str:
    return f"{spot.x * 1e6:.2f}, {spot.y * 1e6:.2f} um"


def _load_of(spot: Spot) -> Callable:
    """The load of a spot as a field of one value."""
    return lambda _pair: (np.array([spot.sam]), np.array([spot.fem]), np.ones(1))


def _pressure(pair: Pair):
    own, fem = (PatchPressure.of(solved.tables) for solved in (pair.sam, pair.fem))
    return own.p, fem.p, np.ones_like(fem.p)


def _residual(pair: Pair):
    """At the cells of SAM."""
    (x, own), (nodes, fem) = (residual_line(solved.tables) for solved in (pair.sam, pair.fem))
    return own, np.interp(x, nodes, fem), np.ones_like(x)
