# SPDX-License-Identifier: MIT
"""The figures of sliding contacts: plastic strain over depth, and the plane y = 0 beside FEM with two
contours.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from matplotlib.ticker import MaxNLocator

from verification.compare.sliding_measures import Plane
from verification.figures.iso_numbers import readable
from verification.figures.maps import FieldPair, MapPeak, plane_maps
from verification.figures.plastic import PERCENT, iso_lines
from verification.figures.style import BLACK, BLUE, GREEN, ORANGE, VERMILION, Columns, Drawing, sheet
from verification.figures.views import PLANE_AXES

CONTOURS = (0.2, 2.0)  # % of plastic strain
REACH = 1.6  # elastic contact radii: half the width of a map
LOOKS = {
    "FEM": {"color": BLACK, "linewidth": 2.0},
    "SAM": {"color": BLUE, "marker": "o", "markersize": 3.5, "fillstyle": "none", "linestyle": "none"},
    "SAM, decoupled": {"color": VERMILION, "linewidth": 1.3, "linestyle": "--"},
    "SAM, paper": {"color": ORANGE, "linewidth": 1.5, "linestyle": ":"},
}
"""The look of FEM and of each form of SAM."""
CYCLES = (
    {"color": BLUE, "marker": "o", "markersize": 4, "linewidth": 1.2},
    {"color": VERMILION, "marker": "s", "markersize": 4, "linewidth": 1.2, "linestyle": "--"},
    {"color": GREEN, "marker": "^", "markersize": 4, "linewidth": 1.2},
    {"color": ORANGE, "marker": "D", "markersize": 4, "linewidth": 1.2, "linestyle": "--"},
)
"""Looks of series over cycles, in order."""


@dataclass(frozen=True)
class Curve:
    """x and y of a line, any units."""

    x: np.ndarray
    y: np.ndarray


def curves(
    panels: Mapping[str, Mapping[str, Curve]],
    xlabel: str,
    ylabel: str,
    shade: tuple[float, float] | None = None,
    *,
    looks: Mapping[str, Mapping] = LOOKS,
    count: bool = False,
    logarithmic: bool = False,
) -> Drawing:
    """Panels side by side with one scale; looks: of each series; shade: a range of x that is not compared;
    count: x are whole numbers, and y begins at zero, so that a small change looks small; logarithmic: y.
    """
    rows = Columns("panel", "series", "x", "y")
    top = max((np.max(curve.y) for series in panels.values() for curve in series.values()), default=1.0)
    with sheet(max(3.2 * len(panels), 5.0), 3.3, len(panels), sharey=True) as (figure, axes):
        for axis, (title, series) in zip(axes, panels.items(), strict=True):
            for name, curve in series.items():
                axis.plot(curve.x, curve.y, **looks[name], label=name)
                rows.add(title, name, curve.x, curve.y)
            if shade is not None:
                axis.axvspan(*shade, color="#eeeeee", zorder=0)
            axis.set(title=title, xlabel=xlabel)
            if logarithmic:
                axis.set_yscale("log")
            if count:
                axis.xaxis.set_major_locator(MaxNLocator(integer=True, min_n_ticks=2))
                if not logarithmic:
                    axis.set_ylim(0.0, 1.08 * top)
        axes[0].set_ylabel(ylabel)
        axes[np.argmax([len(series) for series in panels.values()])].legend()
    return Drawing(figure, rows)


def profile_of(plane: Plane, x: float, deep: float) -> Curve:
    """Plastic strain in % over depth at x, at the own depths of a result."""
    z = plane.z[plane.z <= deep]
    return Curve(z, PERCENT * plane.at(np.array([x]), z)[0])


def compared_planes(
    first: Plane, second: Plane, names: tuple[str, str], edge: float, *, strip: float = 0.0, deep: float = 1.4
) -> Drawing:
    """Plastic strain in % in y = 0: first | second | difference, with iso-lines, among them 0.2 % and 2 %.

    edge: contact radius in that of the elastic contact, for the bar over the maps; strip: depth down to which
    nothing is compared; the maxima are those below it, and what the strip holds is said beside them.
    """
    x = first.x[np.abs(first.x) <= REACH]
    z = first.z[first.z <= deep]
    fields = tuple(PERCENT * plane.at(x, z) for plane in (first, second))
    pair = FieldPair(x, z, *fields, names, PLANE_AXES, "plastic strain [%]", (edge, edge))
    below = z >= strip
    peaks = [_said(peak_at(x, z[below], field[:, below]), np.nanmax(field), strip) for field in fields]
    largest = max(peak.value for peak in peaks)
    wanted = [level for level in CONTOURS if level < largest]
    levels = np.union1d(iso_lines(largest), wanted)
    return readable(lambda left: plane_maps(pair, peaks, left, strip=strip), levels, keep=wanted)


def _said(peak: MapPeak, anywhere: float, strip: float) -> MapPeak:
    """The largest value below a strip in words, with that in the strip."""
    words = f"max {peak.value:#.3g} %"
    if strip:
        words += " below the strip" + (f", {anywhere:#.3g} % in it" if anywhere > peak.value else "")
    return replace(peak, words=words)


def peak_at(x: np.ndarray, z: np.ndarray, field: np.ndarray) -> MapPeak:
    """The largest value of a field (nx, nz) that is NaN in places."""
    i, k = np.unravel_index(np.nanargmax(field), field.shape)
    return MapPeak(float(x[i]), float(z[k]), float(field[i, k]))
