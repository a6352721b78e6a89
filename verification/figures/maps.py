# SPDX-License-Identifier: MIT
"""Two fields on one grid side by side, and their difference."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Ellipse

from verification.figures.style import Drawing, new_figure, style

SHOWN_SHARE = 0.995
"""Share of the points whose difference lies within the colour limits."""
_OUTLINE = {"facecolor": "none", "linestyle": "--", "linewidth": 1.0}


@dataclass(frozen=True)
class FieldPair:
    """Two normalised fields on one grid: u (m,), v (n,), first and second (m, n); NaN where a field is not
    known.

    names: of the two; axes: labels of u and v; quantity: label of the field, e.g. "$p/p_0$"; semi_axes: of
    the contact in the units of u (and v), for the outline.
    """

    u: np.ndarray
    v: np.ndarray
    first: np.ndarray
    second: np.ndarray
    names: tuple[str, str]
    axes: tuple[str, str]
    quantity: str
    semi_axes: tuple[float, float] = (1.0, 1.0)

    @property
    def difference(self) -> np.ndarray:
        """first - second in % of the largest value of the second."""
        return 100.0 * (self.first - self.second) / np.nanmax(np.abs(self.second))

    def data(self) -> dict[str, np.ndarray]:
        """Columns for the CSV file, one row a grid point."""
        u, v = np.meshgrid(self.u, self.v, indexing="ij")
        names = (self.axes[0], self.axes[1], *self.names, "difference_percent_of_maximum")
        return {
            _plain(name): field.ravel()
            for name, field in zip(names, (u, v, self.first, self.second, self.difference), strict=True)
        }


@dataclass(frozen=True)
class MapPeak:
    """Place of a maximum in the axes of a map, and its value; words: what is written of it, of itself value
    and depth.
    """

    u: float
    v: float
    value: float
    words: str = ""


def _plain(label: str) -> str:
    """A label without mathtext, for a column name."""
    return label.replace("$", "").replace(" ", "_")


def pressure_maps(pair: FieldPair) -> Drawing:
    """Pressure over (x, y): first | second | difference, with the contact outline."""
    with style():
        figure, axes = three_panels(pair, height=3.0)
        for panel, color in zip(axes, ("white", "white", "black"), strict=True):
            mark_outline(panel, pair.semi_axes, color)
    return Drawing(figure, pair.data())


def mark_outline(panel: Axes, semi_axes: tuple[float, float], color: str = "white") -> None:
    """The edge of the contact, dashed."""
    width, height = 2.0 * semi_axes[0], 2.0 * semi_axes[1]
    panel.add_patch(Ellipse((0.0, 0.0), width, height, edgecolor=color, **_OUTLINE))


def plane_maps(
    pair: FieldPair,
    peaks: Sequence[MapPeak],
    levels: Sequence[float],
    labelled: Sequence[float] | None = None,
) -> Drawing:
    """A field over (x, z), z down: first | second | difference, with iso-lines, contact width and the maxima.

    labelled: those of the levels that carry their number, every second one from the third by default.
    """
    with style():
        figure, axes = three_panels(pair, height=2.7)
        axes[0].invert_yaxis()  # shared by all panels
        for panel in axes:
            mark_contact(panel, pair.semi_axes[0])
        for panel, field, peak in zip(axes[:2], (pair.first, pair.second), peaks, strict=True):
            iso_lines(panel, (pair.u, pair.v), field, levels, labelled=labelled)
            mark_largest(panel, peak)
    return Drawing(figure, pair.data())


def iso_lines(
    panel: Axes,
    places: tuple[np.ndarray, np.ndarray],
    field: np.ndarray,
    levels: Sequence[float],
    *,
    labelled: Sequence[float] | None = None,
) -> None:
    """Iso-lines at `levels` that occur, some with their number; places: (u, v); labelled: see
    `plane_maps`.
    """
    lines = panel.contour(*places, field.T, levels=levels, colors="white", linewidths=0.7)
    panel.clabel(lines, levels[2::2] if labelled is None else labelled, fmt="%.3g", fontsize=7)


def mark_largest(panel: Axes, peak: MapPeak, color: str = "white") -> None:
    """A cross at the maximum of a map, and in a corner its value; color: of the words."""
    panel.plot(peak.u, peak.v, marker="x", color="black", markersize=7, markeredgewidth=1.6, linestyle="none")
    text = peak.words or f"max {peak.value:#.4g} at $z/a$ = {peak.v:.3f}"
    panel.text(0.98, 0.04, text, transform=panel.transAxes, ha="right", fontsize=8, color=color)


def three_panels(pair: FieldPair, height: float):
    """Three panels of one size: two with shared colour limits, the difference with symmetric ones."""
    figure = new_figure(10.0, height, "compressed")
    axes = figure.subplots(1, 3, sharex=True, sharey=True)
    top = max(np.nanmax(pair.first), np.nanmax(pair.second))
    for panel, name, field in zip(axes, pair.names, (pair.first, pair.second), strict=False):
        mesh = draw_field(panel, pair.u, pair.v, field, cmap="viridis", vmin=0.0, vmax=top)
        panel.set_title(name)
        panel.set_xlabel(pair.axes[0])
    figure.colorbar(mesh, ax=axes[:2], label=pair.quantity, fraction=0.05, pad=0.015)
    _draw_difference(axes[2], pair)
    axes[0].set_ylabel(pair.axes[1])
    return figure, axes


def _draw_difference(panel: Axes, pair: FieldPair) -> None:
    """The difference on a symmetric scale that a few points of the edge may exceed; the largest is written
    in.
    """
    size = np.abs(pair.difference)
    largest, limit = np.nanmax(size), np.nanquantile(size, SHOWN_SHARE)
    limit = limit if limit > 0.0 else max(largest, np.finfo(float).tiny)
    mesh = draw_field(panel, pair.u, pair.v, pair.difference, cmap="RdBu_r", vmin=-limit, vmax=limit)
    extend = "both" if largest > limit else "neither"
    panel.figure.colorbar(
        mesh, ax=panel, label="difference [% of max]", fraction=0.1, pad=0.03, extend=extend
    )
    panel.set_title(f"{pair.names[0]} \N{MINUS SIGN} {pair.names[1]}")
    panel.set_xlabel(pair.axes[0])
    panel.text(0.98, 0.04, f"largest {largest:.2g} %", transform=panel.transAxes, ha="right", fontsize=8)


def draw_field(panel: Axes, u: np.ndarray, v: np.ndarray, field: np.ndarray, **options):
    """Colours of a field (m, n) over u (m,) and v (n,), rasterised so that an SVG stays small."""
    mesh = panel.pcolormesh(u, v, field.T, shading="nearest", rasterized=True, **options)
    panel.set_aspect("equal")
    panel.grid(False)
    return mesh


def mark_contact(panel: Axes, half_width: float) -> None:
    """A bar over a contact around the origin, at the top edge."""
    mark_spots(panel, [(-half_width, half_width)])


def mark_spots(panel: Axes, spots: Sequence[tuple[float, float]]) -> None:
    """A bar over each spot of a contact, (first, last) on the horizontal axis, at the top edge."""
    look = {"color": "black", "linewidth": 4.0, "solid_capstyle": "butt", "clip_on": False}
    for first, last in spots:
        panel.plot([first, last], [1.0, 1.0], transform=panel.get_xaxis_transform(), **look)


def mark_interface(axes: Sequence[Axes], depth: float, across: bool = False) -> None:
    """A dashed line where the film ends: at x = depth, or across at y = depth."""
    for axis in axes:
        (axis.axhline if across else axis.axvline)(
            depth, color="#777777", linewidth=0.9, linestyle=(0, (6, 3))
        )
