# SPDX-License-Identifier: MIT
"""The stress of plastic strain by matrices between all layers and by sweeps; a large patch."""

from collections.abc import Iterator
from typing import Any

from sam.scene import Scene
from verification.cases.case import SAM, Context, with_keys, with_loading
from verification.cases.cost.growth import factor
from verification.cost.estimates import estimate

NAMES = (
    "approach_m contact_area_m2 p_max_Pa mises_max_Pa residual_mises_max_Pa peeq_max peeq_p95 wear_volume_m3 "
    "groove_depth_m"
).split()


def scenes(context: Context) -> Iterator[tuple[str, Scene]]:
    """Sphere, sliding sphere, rough patch, running-in cycle, moving pass."""
    yield "sphere", with_loading(context.scene("plastic-swift-rigid"), steps=4)
    yield "sliding sphere", context.scene("starts/sliding")
    cycle = with_loading(context.scene("running-in-bulk"), steps=3, unload_steps=3, cycles=2)
    yield "rough patch", with_loading(cycle.model_copy(update={"wear": None, "friction": None}), cycles=1)
    yield "running-in", cycle
    yield "moving sphere", context.scene("moving-sphere")


def frame(context: Context) -> Iterator[dict[str, Any]]:
    """Largest relative difference of the quantities of NAMES over the tolerance; bytes of coefficients."""
    for name, scene in scenes(context):
        dense, swept = (
            context.solve(SAM, with_keys(scene, "solver", operator=operator), f"{name}, {operator}")
            for operator in ("dense", "swept")
        )
        pairs = ((dense.quantities.get(key), swept.quantities.get(key)) for key in NAMES)
        difference = max(abs(b / a - 1) for a, b in pairs if a and b)
        yield {
            "sweep": name,
            "difference": difference / scene.solver.tolerance,
            "dense-bytes": dense.discretisation["operator_bytes"],
            "swept-bytes": swept.discretisation["operator_bytes"],
        }


def large(context: Context) -> Iterator[dict[str, Any]]:
    """Time in s and memory in bytes of the large patch, and the factor between each and its plan."""
    scene = context.scene("large-patch")
    result, planned = context.solve(SAM, scene, "sam"), estimate(scene, SAM)
    time_s, memory = result.cost["cpu_s"], result.cost["peak_memory_bytes"]
    yield {
        "sweep": "large patch",
        "cpu-s": time_s,
        "time-factor": factor(time_s, planned.time_s),
        "memory": memory,
        "memory-factor": factor(memory, planned.memory_bytes),
        "box-cells": "-".join(map(str, result.discretisation["plastic_box_cells"])),
        "box-layers": result.discretisation["plastic_box_layers"],
        "applications": result.cost["operator_applications"],
    }
