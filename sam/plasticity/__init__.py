# SPDX-License-Identifier: MIT
"""Elasto-plastic contact: eigenstrains on a box of cells, return mapping, and a load history of frozen
records.

A `Model` holds what stays the same over a history, a `Progressed` what changes; `onward` makes the next
record. The load step is `Problem.step`, its operator on a box of cells is `BoxOperator`.
"""

from __future__ import annotations

from sam.plasticity.box import ExpectedBox, Zone, expected_sides, held, or_whole
from sam.plasticity.flow import SHEAR, contraction
from sam.plasticity.history import onward
from sam.plasticity.measure import Strained, at_centres, surface_displacement
from sam.plasticity.model import Model, Progressed
from sam.plasticity.points import POINTS, stress_at_points
from sam.plasticity.spectra import BoxOperator
from sam.plasticity.state import CellFields, Extent, MaterialFields

__all__ = [
    "POINTS",
    "SHEAR",
    "BoxOperator",
    "CellFields",
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
    "or_whole",
    "stress_at_points",
    "surface_displacement",
]
