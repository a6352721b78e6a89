# SPDX-License-Identifier: MIT
"""Elasto-plastic contact: eigenstrains on a box of cells, return mapping, and a load history of frozen
records.

A `Model` holds what stays the same over a history, a `Progressed` what changes; `onward` makes the next
record. The load step is `Problem.step`, its operator on a box of cells is `BoxOperator`.
"""

from __future__ import annotations

from sam.plasticity.extent import CONTAINED, DEEPEST, GROWTH, LEAST_GROWTH
from sam.plasticity.history import attempt, onward
from sam.plasticity.model import Model
from sam.plasticity.outside import Strained, surface_displacement
from sam.plasticity.pointwise import at_centres
from sam.plasticity.progress import Progressed
from sam.plasticity.return_map import SHEAR, contraction
from sam.plasticity.solution import begun, first_box, solve_plastic
from sam.plasticity.spectra import CACHED_BOXES, SINGLE, BoxOperator
from sam.plasticity.state import Extent, MaterialFields, Residual, State, Trial, surrounded
from sam.plasticity.step import Problem

__all__ = [
    "CACHED_BOXES",
    "CONTAINED",
    "DEEPEST",
    "GROWTH",
    "LEAST_GROWTH",
    "SHEAR",
    "SINGLE",
    "BoxOperator",
    "Extent",
    "MaterialFields",
    "Model",
    "Problem",
    "Progressed",
    "Residual",
    "State",
    "Strained",
    "Trial",
    "at_centres",
    "attempt",
    "begun",
    "contraction",
    "first_box",
    "onward",
    "solve_plastic",
    "surface_displacement",
    "surrounded",
]
