# SPDX-License-Identifier: MIT
"""Elasto-plastic contact: eigenstrains on a box of cells, return mapping, and a load history of frozen
records.

A `Model` holds what stays the same over a history, a `Progressed` what changes; `onward` makes the next
record. The load step is `Problem.step`, its operator on a box of cells is `BoxOperator`.
"""

from __future__ import annotations

from sam.plasticity.expected import ExpectedBox, Zone, expected_sides, held
from sam.plasticity.history import onward
from sam.plasticity.model import Model
from sam.plasticity.outside import Strained, surface_displacement
from sam.plasticity.points import POINTS, stress_at_points
from sam.plasticity.pointwise import at_centres
from sam.plasticity.progress import Progressed
from sam.plasticity.return_map import SHEAR, contraction
from sam.plasticity.spectra import BoxOperator
from sam.plasticity.state import Extent, MaterialFields, surrounded

__all__ = [
    "POINTS",
    "SHEAR",
    "BoxOperator",
    "ExpectedBox",
    "Extent",
    "MaterialFields",
    "Model",
    "Progressed",
    "Strained",
    "Zone",
    "at_centres",
    "contraction",
    "expected_sides",
    "held",
    "onward",
    "stress_at_points",
    "surface_displacement",
    "surrounded",
]
