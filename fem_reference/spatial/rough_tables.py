# SPDX-License-Identifier: MIT
"""The table of a rough result that smooth ones do not have, in SI units."""

from __future__ import annotations

import numpy as np

from fem_reference.axisymmetric.tables import columns
from fem_reference.common.contact import Equilibrium
from fem_reference.spatial.rough import RoughModel, heights_of
from sam.scene.result import SURFACE, Table
from sam.scene.schema import Scene


def surface_table(state: str, scene: Scene, model: RoughModel, equilibrium: Equilibrium) -> Table:
    """A row for each node of the patch, y running first; height_m: of the body before loading."""
    unit = model.scales
    inside = np.isfinite(model.gap)
    x, y = np.meshgrid(model.lines.x * unit.length, model.lines.y * unit.length, indexing="ij")
    pressure = model.nodal_pressure(equilibrium) * unit.pressure
    friction = np.where(pressure > 0.0, np.abs(model.ratio(equilibrium)), np.nan)
    return columns(
        SURFACE,
        [state, x[inside], y[inside], heights_of(scene).ravel(), pressure[inside], 0.0, friction[inside]],
    )
