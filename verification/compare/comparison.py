# SPDX-License-Identifier: MIT
"""SAM against FEM, quantity by quantity and field by field, each with a tolerance and its reason.

Both arguments are results (`sam.scene.Result`) or runs read back (`verification.runs.files.Run`).
"""

from __future__ import annotations

from sam.scene import Scene
from verification.compare.rough import compare_rough
from verification.compare.rows import Comparison, Solution
from verification.compare.smooth import compare_results


def compare_scene(scene: Scene, sam: Solution, fem: Solution) -> list[Comparison]:
    """Every comparison of the results of a scene."""
    if scene.surface is not None and scene.body.coating is None:
        return compare_rough(scene, sam, fem)
    plastic = scene.body.plasticity is not None
    punch = scene.counterbody is not None and scene.counterbody.shape == "punch"
    unloaded = plastic and scene.loading.unload
    kind = {"punch": punch, "plastic": plastic, "unloaded": unloaded, "slides": scene.coefficient > 0}
    film = scene.body.coating.thickness if scene.body.coating else 0.0
    rows = compare_results(sam, fem, **kind, film=film)
    return [row for row in rows if row.quantity != "approach_m"] if scene.loading.prescribed else rows
