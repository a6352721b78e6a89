# SPDX-License-Identifier: MIT
"""Figures of a rough contact solved by SAM and by FEM: pressure, plastic strain below the spots, what is left
after unloading.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from verification.figures.maps import FieldPair, pressure_maps
from verification.figures.style import FEM, SAM, Columns, Drawing, sheet

POINTS = FEM | {"linestyle": "none", "marker": "o", "markersize": 4.0, "fillstyle": "none"}


@dataclass(frozen=True)
class Below:
    """Plastic strain below one spot: depths z in m and strain of each model, from `compared` on; title of the
    panel.
    """

    title: str
    sam: tuple[np.ndarray, np.ndarray]
    fem: tuple[np.ndarray, np.ndarray]
    compared: float


def pressures(x: np.ndarray, y: np.ndarray, sam: np.ndarray, fem: np.ndarray, *, reach: float) -> Drawing:
    """Pressure over (x, y) in m, |y| <= reach: SAM | FEM | difference; (nx, ny) in Pa."""
    near = np.abs(y) <= reach
    fields = (1e-9 * p[:, near] for p in (sam, fem))
    pair = FieldPair(
        1e6 * x,
        1e6 * y[near],
        *fields,
        ("SAM", "FEM"),
        ("$x$ [µm]", "$y$ [µm]"),
        "pressure [GPa]",
        (0.0, 0.0),
    )
    return pressure_maps(pair)


def below_spots(spots: Sequence[Below]) -> Drawing:
    """Plastic strain over depth, a panel for each spot: SAM as a line, FEM as points; grey: not compared."""
    rows = Columns("spot", "series", "z_um", "peeq_percent")
    with sheet(3.3 * len(spots), 3.2, len(spots), sharey=True) as (figure, axes):
        for panel, spot in zip(axes, spots, strict=True):
            for name, (z, peeq), look in (("SAM", spot.sam, SAM), ("FEM", spot.fem, POINTS)):
                panel.plot(1e6 * z, 1e2 * peeq, **look, label=name)
                rows.add(spot.title, name, 1e6 * z, 1e2 * peeq)
            panel.axvspan(0.0, 1e6 * spot.compared, color="#eeeeee", zorder=0)
            panel.set(title=spot.title, xlabel="$z$ [µm]")
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
