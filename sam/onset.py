# SPDX-License-Identifier: MIT
"""The onset of yield: the contact at the largest load if the body stayed elastic, and whether its stress
yields anywhere.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sam.arrays import Array
from sam.contact.convolution import Counters
from sam.contact.normal import Contact
from sam.contact.stress import von_mises
from sam.elastic import load_step, plane_stress, stress_and_mises
from sam.friction import most_friction
from sam.grid.cells import CellGrid
from sam.loading import Load, peak_force
from sam.scene import Scene


@dataclass(frozen=True)
class ElasticPeak:
    """The contact at the largest load if the body stayed elastic, and the von Mises stress, (nz, n) in Pa.

    mises: below a smooth body in the plane y = 0, n = nx; below a rough one the largest of the whole grid, n
    = 1. A tribofilm may fail and raise the traction: then with its high coefficient everywhere.
    """

    contact: Contact
    mises: Array


def elastic_peak(scene: Scene, grid: CellGrid, counters: Counters) -> ElasticPeak | None:
    """None without force."""
    peak, high = Load(peak_force(scene)), most_friction(scene)
    if peak.force == 0:
        return None
    contact = load_step(scene, grid, peak, None, counters, coefficient=high)
    if scene.surface is not None:
        return ElasticPeak(
            contact, stress_and_mises(scene, grid, peak, contact, counters, coefficient=high)[1]
        )
    stress = plane_stress(scene, grid, peak, contact, counters, coefficient=high)
    return ElasticPeak(contact, von_mises(stress).max(axis=-1))


def initial_yield(scene: Scene, grid: CellGrid) -> Array:
    """Yield stress of unstrained material at the depths of the grid, (nz,) in Pa."""
    plasticity = scene.body.plasticity
    return plasticity.depth_profile()(grid.depths) * plasticity.curve().stress(np.zeros(1))


def yields(peak: ElasticPeak | None, limit: Array) -> bool:
    """Whether the elastic stress at the peak exceeds the yield stress (nz,) in Pa anywhere. Paper Eq. 8."""
    return peak is not None and bool((peak.mises > limit[:, None]).any())
