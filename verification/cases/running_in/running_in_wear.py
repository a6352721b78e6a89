# SPDX-License-Identifier: MIT
"""Wear at its limits: a smooth sphere that wears; one and a rough patch that never do."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from sam.scene import Wear
from verification.cases.case import SAM, Context, with_keys, with_loading
from verification.cases.recipes import Resolution, sliding_scene
from verification.cases.running_in.study import Effort, reduced
from verification.quantities import of_cycles
from verification.runs.sampling import surface_pressure

LIMIT = 0.004
"""Of a law that hardens little: on Swift steel no strain reaches the surface without friction."""


def runs(context: Context) -> Iterator[dict[str, Any]]:
    """What each wears in m3, the largest strain, what the last cycle adds; differences of the scar."""
    sphere = sliding_scene(context.scene("plastic-linear"), 6.2, 0.0, Resolution(8, 8))
    sphere = with_loading(sphere, steps=3, unload=True, unload_steps=2, cycles=3)
    patch = reduced(context.scene("running-in-bulk"), Effort(cycles=5, steps=3, cells=32))
    scenes = {
        "sphere-worn": sphere.model_copy(update={"wear": Wear(strain_limit=LIMIT)}),
        "sphere-plain": sphere,
        "sphere-infinite": sphere.model_copy(update={"wear": Wear(strain_limit=np.inf)}),
        "patch-infinite": with_keys(patch, "wear", strain_limit=np.inf),
    }
    results = {label: context.solve(SAM, scene, label) for label, scene in scenes.items()}
    plain = results.pop("sphere-plain")
    for label, result in results.items():
        strain = of_cycles(result, "peeq_max")
        row = {
            "run": label,
            "volume": float(of_cycles(result, "wear_volume_m3")[-1]),
            "largest strain": float(strain[-1]),
            "settles": float((strain[-1] - strain[-2]) / strain[0]),
        }
        if label == "sphere-worn":
            fields = result.fields  # at the last peak, before the removal of the last cycle
            worn = surface_pressure(fields.points, fields.cells["quad"], fields.cell_data["worn_m"])[2]
            row |= {"asymmetry": asymmetry(worn), "turned": asymmetry(worn, turned=True)}
        if label == "sphere-infinite":
            names = ("peeq_max", "p_max_Pa", "friction_coefficient")
            apart = (np.abs(of_cycles(result, name) - of_cycles(plain, name)).max() for name in names)
            row["changed"] = float(max(apart))
        yield row


def asymmetry(worn: np.ndarray, turned: bool = False) -> float:
    """Largest difference of depths (nx, ny) to the same mirrored or turned by 90 degrees over the deepest."""
    others = (worn.T,) if turned else (worn[::-1], worn[:, ::-1])
    with np.errstate(invalid="ignore"):
        return float(np.max([np.abs(worn - other).max() for other in others]) / worn.max())
