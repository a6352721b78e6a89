# SPDX-License-Identifier: MIT
"""All rows of the robustness matrix, and what they must cover."""

from __future__ import annotations

from verification.robustness.matrix import elastic, plastic, rough
from verification.robustness.matrix.row import Row

TOPICS = {
    "poisson": "Poisson's ratio 0, 0.4999 and 0.5",
    "force": "force 0, and 1e-15 to 1e6 N",
    "approach": "approach 1e-18 to 1e-6 m in place of the force",
    "film": "modulus of film over body 1e-6 to 1e6, thickness 1e-4 to 1e4 contact radii",
    "counter-body": "modulus of the counter-body over the body's 1e-6 to 1e6",
    "perfect": "nearly perfect plasticity",
    "p0/yield": "p0 over the yield stress 0.5 to 15",
    "misfit": "a sphere that grows by 1e-9 to 0.5, deep and close below the surface",
    "layer": "factor of a layer on the yield stress 0.1 and 10",
    "swift": "Swift's slope at zero strain of tens of TPa",
    "C -> 0": "Swift's yield stress at zero strain towards 0",
    "back-stress": "back-stresses stiff, vanishing, saturated at once; eight of them",
    "alternating": "traction that changes its sign from cycle to cycle",
    "stiff": "hardening towards elastic",
    "friction": "friction 0 to 1, and beyond what a perfectly plastic surface carries",
    "one cell": "one cell in contact",
    "all cells": "all cells in contact",
    "edge": "contact at the edge of the grid",
    "aspect": "slender cells and contacts",
    "punch": "flat punch",
    "edge of a punch": "a punch with a rounded edge: nearly a sphere, nearly sharp",
    "ridge": "a ridge along the border",
    "spike": "a spike",
    "step": "a step",
    "nan": "heights that are none",
    "constant": "a constant surface",
    "counter-surface": "a rough counter-body: constant, upside down, opposite to its own image, renewed",
    "path": "a counter-body that moves: hardly, by its own wave, too far, in broken cells",
    "steps": "1 and 200 load steps",
    "tolerance": "tolerances 1e-3 to 1e-12",
    "too coarse": "grids too coarse for the contact",
    "uncertainty": "uncertainties and accuracies: too coarse a grid, no load, 0.1 % to a half",
}
"""Of what there must be rows at level full: name -> in words."""
_SOURCES = (
    *(elastic.rows, elastic.films, plastic.rows, plastic.back_stresses, plastic.misfits),
    *(elastic.paths, elastic.friction, rough.rows, elastic.uncertainties),
)


def all_rows(level: str) -> list[Row]:
    """The rows of a level, in the order of the matrix."""
    found = [row for source in _SOURCES for row in source()]
    return found if level == "full" else [row for row in found if row.quick]
