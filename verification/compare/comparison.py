# SPDX-License-Identifier: MIT
"""SAM against FEM, quantity by quantity and field by field, each with a tolerance and its reason.

Both arguments are results (`sam.scene.Result`) or runs read back (`verification.runs.files.Run`).
"""

from __future__ import annotations

from sam.scene import Scene
from verification.compare.rough import NAMES, compare_rough
from verification.compare.rows import Comparison, Solution
from verification.compare.smooth import compare_results, wanted
from verification.compare.verdicts import CHANGES


def compare_scene(scene: Scene, sam: Solution, fem: Solution) -> list[Comparison]:
    """Every comparison of the results of a scene."""
    if _rough(scene):
        return compare_rough(scene, sam, fem)
    punch = scene.counterbody is not None and scene.counterbody.shape == "punch"
    film = scene.body.coating.thickness if scene.body.coating else 0.0
    rows = compare_results(sam, fem, punch=punch, film=film, **_kind(scene))
    return [row for row in rows if row.quantity != "approach_m"] if scene.loading.prescribed else rows


def names_of_rows(scene: Scene) -> tuple[str, ...]:
    """What the results of a scene may be compared by: names of rows, or how the names of several begin."""
    if _rough(scene):
        return NAMES
    coated = scene.body.coating is not None
    tables = wanted(coated=coated, **_kind(scene))
    return (*(row[0] for table in tables for row in table), *(CHANGES if coated else ()))


def _rough(scene: Scene) -> bool:
    return scene.surface is not None and scene.body.coating is None


def _kind(scene: Scene) -> dict[str, bool]:
    plastic = scene.body.plasticity is not None
    unloaded = plastic and scene.loading.unload
    return {"plastic": plastic, "unloaded": unloaded, "slides": scene.coefficient > 0}
