# SPDX-License-Identifier: MIT
"""Figures of rough contacts: the pressure over the patch, and a section under it, coated beside bare."""

from __future__ import annotations

import numpy as np

from verification.figures.maps import (
    INTERFACE,
    FieldPair,
    mark_interface,
    name_marks,
    pressure_maps,
    three_panels,
)
from verification.figures.style import Drawing, style

NAMES = ("coated", "bare")


def pressures(x: np.ndarray, y: np.ndarray, coated: np.ndarray, bare: np.ndarray) -> Drawing:
    """Pressure over (x, y) in m: coated | bare | difference; (nx, ny) in Pa."""
    axes = ("$x$ [µm]", "$y$ [µm]")
    pair = FieldPair(1e6 * x, 1e6 * y, 1e-9 * coated, 1e-9 * bare, NAMES, axes, "pressure [GPa]", (0.0, 0.0))
    return pressure_maps(pair)


def sections(
    x: np.ndarray, z: np.ndarray, coated: np.ndarray, bare: np.ndarray, *, thickness: float
) -> Drawing:
    """Von Mises stress over (x, z), z down, (nx, nz) in Pa, around its largest; the interface as a line."""
    middle = x[int(np.unravel_index(np.argmax(bare), bare.shape)[0])]
    near = np.abs(x - middle) <= 8e-6
    axes = ("$x$ [µm]", "$z$ [µm]")
    fields = (1e-9 * coated[near], 1e-9 * bare[near])
    pair = FieldPair(1e6 * x[near], 1e6 * z, *fields, NAMES, axes, "von Mises stress [GPa]", (0.0, 0.0))
    with style():
        figure, panels = three_panels(pair)
        panels[0].invert_yaxis()
        mark_interface(panels, 1e6 * thickness, across=True)
        name_marks(figure, [INTERFACE])
    return Drawing(figure, pair.data())
