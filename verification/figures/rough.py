# SPDX-License-Identifier: MIT
"""Figures of rough contacts: the pressure over the patch, a section under it, plastic strain below spots, and
what is left after unloading.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from verification.figures.maps import (
    INTERFACE,
    FieldPair,
    mark_interface,
    name_marks,
    pressure_maps,
    three_panels,
)
from verification.figures.style import FEM, SAM, Columns, Drawing, sheet, style

AXES = ("$x$ [µm]", "$y$ [µm]")
POINTS = FEM | {"linestyle": "none", "marker": "o", "markersize": 4.0, "fillstyle": "none"}


def pressures(
    x: np.ndarray, y: np.ndarray, fields: Mapping[str, np.ndarray], reach: float = np.inf
) -> Drawing:
    """Pressure over (x, y) in m, |y| <= reach, and the difference; fields: two names -> (nx, ny) in Pa."""
    near = np.abs(y) <= reach
    values = (1e-9 * p[:, near] for p in fields.values())
    pair = FieldPair(1e6 * x, 1e6 * y[near], *values, tuple(fields), AXES, "pressure [GPa]", (0.0, 0.0))
    return pressure_maps(pair)


def sections(
    x: np.ndarray, z: np.ndarray, coated: np.ndarray, bare: np.ndarray, *, thickness: float
) -> Drawing:
    """Von Mises stress over (x, z), z down, (nx, nz) in Pa, around its largest; the interface as a line."""
    middle = x[int(np.unravel_index(np.argmax(bare), bare.shape)[0])]
    near = np.abs(x - middle) <= 8e-6
    axes = ("$x$ [µm]", "$z$ [µm]")
    fields = (1e-9 * coated[near], 1e-9 * bare[near])
    pair = FieldPair(
        1e6 * x[near], 1e6 * z, *fields, ("coated", "bare"), axes, "von Mises stress [GPa]", (0.0, 0.0)
    )
    with style():
        figure, panels = three_panels(pair)
        panels[0].invert_yaxis()
        mark_interface(panels, 1e6 * thickness, across=True)
        name_marks(figure, [INTERFACE])
    return Drawing(figure, pair.data())


def below_spots(spots: Mapping[str, tuple]) -> Drawing:
    """Plastic strain over depth, SAM as a line, FEM as points. spots: title of a panel -> (z in m, strain) of
    each model, and the depth from which they are compared; above it is grey.
    """
    rows = Columns("spot", "series", "z_um", "peeq_percent")
    with sheet(3.3 * len(spots), 3.2, len(spots), sharey=True) as (figure, axes):
        for panel, (title, (sam, fem, compared)) in zip(axes, spots.items(), strict=True):
            for name, (z, peeq), look in (("SAM", sam, SAM), ("FEM", fem, POINTS)):
                panel.plot(1e6 * z, 1e2 * peeq, **look, label=name)
                rows.add(title, name, 1e6 * z, 1e2 * peeq)
            panel.axvspan(0.0, 1e6 * compared, color="#eeeeee", zorder=0)
            panel.set(title=title, xlabel="$z$ [µm]")
        axes[0].set_ylabel("plastic strain [%]")
        axes[0].legend()
    return Drawing(figure, rows)


def residual(sam: tuple[np.ndarray, np.ndarray], fem: tuple[np.ndarray, np.ndarray]) -> Drawing:
    """What the heights along y = 0 have lost after unloading: (x, displacement into the body) of each model,
    in m.
    """
    rows = Columns("series", "x_um", "change_nm")
    with sheet(6.0, 3.0) as (figure, panel):
        for name, (x, uz), look in (("SAM", sam, SAM), ("FEM", fem, POINTS)):
            panel.plot(1e6 * x, -1e9 * uz, **look, label=name)
            rows.add(name, 1e6 * x, -1e9 * uz)
        panel.set(xlabel="$x$ [µm]", ylabel="change of the height [nm]")
        panel.legend()
    return Drawing(figure, rows)
