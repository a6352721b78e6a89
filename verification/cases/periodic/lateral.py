# SPDX-License-Identifier: MIT
"""Columns of a patch that yields, held or free along its sides: the mean lateral stress over the depth."""

from typing import Any

import numpy as np

from sam.scene import Plasticity, Result, Scene
from verification.cases.case import with_body
from verification.judging import Measured
from verification.quantities import Reference


def yields(scene: Scene, law: dict[str, Any]) -> Scene:
    """The scene with a body that yields."""
    return with_body(scene, plasticity=Plasticity(**law))


def _means(scene: Scene, result: Result, state: str) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Of the layers that yield: depth in m, and means over the patch, in xx and yy, of the stress in Pa and
    of what plastic strain and pressure make of it where the mean lateral strain is held (Hooke).
    """
    body, nu = result.grids[state]["body"], scene.body.poisson
    stress, strain = (body.cell_data[name].mean(axis=(1, 2)) for name in ("stress_Pa", "plastic_strain"))
    pressure = scene.loading.mean_pressure if state == "peak" else 0.0
    by_strain = -scene.body.young / (1.0 - nu**2) * (strain[:2] + nu * strain[1::-1])
    return (body.z[1:] + body.z[:-1]) / 2, stress[:2], by_strain - nu / (1.0 - nu) * pressure


def off_hand(scene: Scene, result: Result, reference: Reference) -> float:
    """Largest deviation of the mean lateral stress from that by hand, over the largest stress."""
    off = []
    for state, grids in result.grids.items():
        _, found, held = _means(scene, result, state)
        largest = np.abs(grids["body"].cell_data["stress_Pa"]).max()
        off.append(np.abs(found - held * (scene.loading.lateral == "held")).max() / largest)
    return float(max(off))


def depth(scene: Scene, result: Result, reference: Reference) -> np.ndarray:
    """Depth in m."""
    return _means(scene, result, "unloaded")[0]


def mean_stress(scene: Scene, result: Result, reference: Reference) -> Measured:
    """Mean of the residual stress across the crests in Pa."""
    _, found, held = _means(scene, result, "unloaded")
    return Measured(found[0], held[0] * (scene.loading.lateral == "held"))
