# SPDX-License-Identifier: MIT
"""SAM against FEM, quantity by quantity and field by field, each with a tolerance and its reason.

Both arguments are results (`sam.scene.Result`) or runs read back (`verification.runs.files.Run`).
"""

from __future__ import annotations

import math

from sam.scene import Scene
from verification.compare.own_data import OwnData
from verification.compare.rough import NAMES, compare_rough
from verification.compare.rows import Pair, Solution, scalar_row
from verification.compare.smooth import CENTRE, centre_row, compare_results, wanted
from verification.compare.verdicts import CHANGES
from verification.judging import Verdict

RISE = 1.5  # of an elastic contact of Hertz, the steepest of those that are compared
ABOUT_THE_ORIGIN = ("p_center_Pa", "p_Pa over the contact")
OF_TRACK = ("groove_depth_m", "groove_deepest_m")
GROOVE = (5e-2, "the sum of the plastic strains along the way, about first order in cells and elements")
FORCE = (1e-2, "the load of the scene; data under another load, or of a quarter of the body, are off by it")


def compare_scene(scene: Scene, sam: Solution, fem: Solution) -> list[Verdict]:
    """Every comparison of the results of a scene."""
    if _rough(scene):
        return _of_load(scene, compare_rough(scene, sam, fem), sam, fem)
    shape = "" if scene.counterbody is None else scene.counterbody.shape
    film = scene.body.coating.thickness if scene.body.coating else 0.0
    rows = compare_results(sam, fem, shape=shape, film=film, **_kind(scene))
    return _of_load(scene, _of_track(rows, sam, fem) if scene.moves else rows, sam, fem)


def _of_track(rows: list[Verdict], sam: Solution, fem: Solution) -> list[Verdict]:
    """The rows of a counter-body that moves: its contact may be off the origin, and it leaves a groove."""
    pair = Pair(sam, fem, float("nan"), punch=False, plastic=False)
    found = [name for name in OF_TRACK if sam.quantities.get(name) is not None]
    kept = [row for row in rows if row.quantity not in ABOUT_THE_ORIGIN]
    return kept + [scalar_row(pair, name, "relative", GROOVE) for name in found]


def compare_data(
    scene: Scene, sam: Solution, fem: Solution, data: OwnData
) -> tuple[list[Verdict], list[Verdict]]:
    """Rows that both models have only beside data, and every row of SAM and the data that these have.

    The column fem of the second holds the data. What they lack is not compared.
    """
    between: list[Verdict] = []
    found = compare_scene(scene, sam, data)
    for other, rows in ((fem, between), (data, found)):
        if scene.loading.force is not None:
            pair = Pair(sam, other, math.nan, punch=False, plastic=False)
            rows.append(scalar_row(pair, "force_N", "relative", FORCE))
        if not _rough(scene):
            rows.append(centre_row(sam, other, fem))
    own = [row for row in found if math.isfinite(row.expected)]
    return [row for row in between if row.quantity in {each.quantity for each in own}], own


def names_of_rows(scene: Scene) -> tuple[str, ...]:
    """What the results of a scene may be compared by: names of rows, or how the names of several begin."""
    found = ("force_N",) if scene.loading.prescribed is None else ()
    if _rough(scene):
        return (*found, *NAMES)
    coated = scene.body.coating is not None
    tables = wanted(coated=coated, **_kind(scene))
    names = (row[0] for table in tables for row in table)
    return (*found, *names, CENTRE, *(CHANGES if coated else ()))


def _rough(scene: Scene) -> bool:
    return scene.patch_surface is not None and scene.body.coating is None


def _kind(scene: Scene) -> dict[str, bool]:
    plastic = scene.body.plasticity is not None
    unloaded = plastic and scene.loading.unload
    return {"plastic": plastic, "unloaded": unloaded, "slides": scene.coefficient > 0}


def _of_load(scene: Scene, rows: list[Verdict], sam: Solution, fem: Solution) -> list[Verdict]:
    """The rows of what the scene does not give; where it gives the approach, the force in its place."""
    if scene.loading.prescribed is None and scene.loading.approach is None:
        return rows
    others = [row for row in rows if row.quantity != "approach_m"]
    if scene.loading.prescribed:
        return others
    (own,) = (row for row in rows if row.quantity == "approach_m")
    pair = Pair(sam, fem, float("nan"), punch=False, plastic=False)
    reason = f"{own.row.reason}; the force grows with the power {RISE:g} of the approach"
    return [scalar_row(pair, "force_N", "relative", (RISE * own.row.tolerance, reason)), *others]
