# SPDX-License-Identifier: MIT
"""Maps of fields: two on one grid side by side and their difference, and what marks a map."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.colorbar import Colorbar
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Ellipse, Patch
from matplotlib.ticker import MaxNLocator
from scipy.interpolate import RegularGridInterpolator

from sam.scene import Result
from verification.figures.places import edges_of
from verification.figures.style import BLACK, GREY, Drawing, new_figure, style
from verification.runs.sampling import plane_field, plane_field_on

SHOWN_SHARE = 0.995
"""Share of the points whose difference lies within the colour limits."""
LINE_WIDTH = 0.7
PANEL, AROUND = 2.8, 1.9
"""Inches: the width of one of three panels, and what stands above and below it."""
VON_MISES_LEVELS = np.arange(0.1, 0.95, 0.1)
_OUTLINE = {"facecolor": "none", "linestyle": "--", "linewidth": 1.0}
_BAR = {"color": BLACK, "linewidth": 4.0, "solid_capstyle": "butt"}
_CROSS = {"color": BLACK, "marker": "x", "markersize": 7, "markeredgewidth": 1.6, "linestyle": "none"}
_INTERFACE = {"color": "#777777", "linewidth": 0.9, "linestyle": (0, (6, 3))}
_STRIP = {"facecolor": "none", "edgecolor": "#9a9a9a", "hatch": "////", "linewidth": 0.0}
BAR, CROSS, INTERFACE = (
    Line2D([], [], **look, label=words)
    for look, words in ((_BAR, "contact"), (_CROSS, "largest value"), (_INTERFACE, "end of the film"))
)
"""Entries of a legend: what marks the contact, the largest value and the interface of a film in the maps."""


@dataclass(frozen=True)
class FieldPair:
    """Two normalised fields on one grid: u (m,), v (n,), first and second (m, n); NaN where a field is not
    known. names: of the two; axes: labels of u and v; quantity: label of the field, e.g. "$p/p_0$";
    semi_axes: of the contact in the units of u (and v), for the outline.
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
        """Columns for the CSV file, one row a grid point where one of the fields is not zero."""
        u, v = np.meshgrid(self.u, self.v, indexing="ij")
        shown = (np.nan_to_num(self.first) != 0.0) | (np.nan_to_num(self.second) != 0.0)
        names, fields = (*self.axes, *self.names), (u, v, self.first, self.second)
        plain = (name.replace("$", "").replace(" ", "_") for name in names)  # without mathtext
        return {name: field[shown] for name, field in zip(plain, fields, strict=True)}


@dataclass(frozen=True)
class MapPeak:
    """Place of a maximum in the axes of a map, and its value; words: what is written of it."""

    u: float
    v: float
    value: float
    words: str = ""

    def said(self, depth: str, unit: str) -> MapPeak:
        """With its value and its depth in words; depth: label of the axis."""
        return replace(self, words=f"max {self.value:#.4g}{unit} at {depth} = {self.v:.3f}")


def pressure_maps(pair: FieldPair) -> Drawing:
    """Pressure over (x, y): first | second | difference, with the contact outline; grey out of contact."""
    with style():
        figure, axes, _ = three_panels(pair, touching=True)
        names = [Patch(color=GREY, label="no contact")]
        if any(pair.semi_axes):
            for panel in axes:
                width, height = 2.0 * pair.semi_axes[0], 2.0 * pair.semi_axes[1]
                panel.add_patch(Ellipse((0.0, 0.0), width, height, edgecolor=BLACK, **_OUTLINE))
            names.append(
                Line2D([], [], color=BLACK, linestyle="--", linewidth=1.0, label="edge of the contact")
            )
        name_marks(figure, names)
    return Drawing(figure, pair.data())


def name_marks(figure: Figure, handles: Sequence[Artist]) -> None:
    """A legend below all panels."""
    figure.legend(handles=list(handles), loc="outside lower center", ncols=len(handles))


def plane_maps(
    pair: FieldPair,
    peaks: Sequence[MapPeak],
    levels: Sequence[float],
    *,
    strip: float = 0.0,
    interface: float | None = None,
) -> Drawing:
    """A field over (x, z), z down: first | second | difference. strip: not compared; interface: of a film."""
    with style():
        figure, axes, bar = three_panels(pair, strip=strip)
        mark_levels(bar, levels)
        axes[0].invert_yaxis()  # shared by all panels
        for panel in axes:
            mark_spots(panel, [(-pair.semi_axes[0], pair.semi_axes[0])])
        unit = " %" * pair.quantity.endswith("[%]")
        for panel, field, peak in zip(axes[:2], (pair.first, pair.second), peaks, strict=True):
            iso_lines(panel, (pair.u, pair.v), field, levels)
            mark_largest(panel, peak if peak.words else peak.said(pair.axes[1], unit))
        names = [BAR, CROSS]
        if interface is not None:
            mark_interface(axes, interface, across=True)
            names.append(INTERFACE)
        if strip:
            names.append(Patch(**_STRIP, label="not compared: depends on the mesh"))
        if np.isnan(pair.difference).any():
            names.append(Patch(color=GREY, label="not known"))
        name_marks(figure, names)
    return Drawing(figure, pair.data())


def iso_lines(
    panel: Axes, places: tuple[np.ndarray, np.ndarray], field: np.ndarray, levels: Sequence[float]
) -> None:
    """Iso-lines at those of `levels` that occur; places: (u, v); the colour bar says what they are."""
    if levels := [level for level in levels if np.nanmin(field) < level < np.nanmax(field)]:
        panel.contour(*places, field.T, levels=levels, colors="white", linewidths=LINE_WIDTH)


def mark_levels(bar: Colorbar, levels: Sequence[float]) -> None:
    """The iso-lines on their colour bar."""
    bar.add_lines(np.array(levels), ["white"] * len(levels), [LINE_WIDTH] * len(levels))


def mark_largest(panel: Axes, peak: MapPeak) -> None:
    """A cross at the maximum of a map, and above it to the right what is said of it."""
    panel.plot(peak.u, peak.v, **_CROSS)
    remark(panel, peak.words)


def remark(panel: Axes, words: str) -> None:
    """Words above a panel, opposite its title."""
    panel.set_title(words, loc="right", fontsize=8, fontweight="normal")


def three_panels(pair: FieldPair, *, touching: bool = False, strip: float = 0.0):
    """Three panels: two on one scale, the difference. touching: zero is no contact; strip: `plane_maps`."""
    size = PANEL * np.ptp(pair.v) / np.ptp(pair.u) + AROUND
    figure = new_figure(9.4, size, "compressed")
    axes = figure.subplots(1, 3, sharex=True, sharey=True)
    top = max(np.nanmax(pair.first), np.nanmax(pair.second))
    for panel, name, field in zip(axes, pair.names, (pair.first, pair.second), strict=False):
        shown = np.where(field > 0.0, field, np.nan) if touching else field
        mesh = draw_field(panel, pair.u, pair.v, shown, cmap="viridis", vmin=0.0, vmax=top)
        panel.set_title(name, loc="left")
    how = {"location": "bottom", "aspect": 30, "pad": 0.03}
    bar = figure.colorbar(mesh, ax=list(axes[:2]), label=pair.quantity, shrink=0.45, **how)
    _draw_difference(axes[2], pair, how | {"shrink": 0.9}, touching=touching, strip=strip)
    for panel in axes:
        panel.set_xlabel(pair.axes[0])
        if strip:
            panel.axhspan(0.0, strip, **_STRIP)
    axes[0].set_ylabel(pair.axes[1])
    return figure, axes, bar


def _draw_difference(panel: Axes, pair: FieldPair, bar: Mapping, *, touching: bool, strip: float) -> None:
    """The difference on a symmetric scale that few points exceed; the largest is written above it."""
    shown = pair.difference
    if touching:
        shown = np.where((pair.first > 0.0) | (pair.second > 0.0), shown, np.nan)
    size, below = np.abs(shown), pair.v >= strip
    largest, limit = np.nanmax(size[:, below]), np.nanquantile(size[:, below], SHOWN_SHARE)
    limit = limit if limit > 0.0 else max(largest, np.finfo(float).tiny)
    mesh = draw_field(panel, pair.u, pair.v, shown, cmap="RdBu_r", vmin=-limit, vmax=limit)
    extend = "both" if np.nanmax(size) > limit else "neither"
    label = f"difference [% of the largest of {pair.names[1]}]"
    ticks = MaxNLocator(5)
    panel.figure.colorbar(mesh, ax=panel, label=label, extend=extend, ticks=ticks, **bar)
    panel.set_title(f"{pair.names[0]} \N{MINUS SIGN} {pair.names[1]}", loc="left")
    remark(panel, f"largest {largest:.2g} %" + (f", {np.nanmax(size):.2g} % in the strip" if strip else ""))


def draw_field(panel: Axes, u: np.ndarray, v: np.ndarray, field: np.ndarray, **options):
    """Colours of a field (m, n) over u (m,) and v (n,), grey where it is NaN; rasterised for small PDFs."""
    panel.set_facecolor(GREY)
    mesh = panel.pcolormesh(
        u, v, np.ma.masked_invalid(field.T), shading="nearest", rasterized=True, **options
    )
    panel.set_aspect("equal")
    panel.grid(False)
    return mesh


def coloured(
    panel: Axes, places: Sequence[np.ndarray], field: np.ndarray, label: str, **options: Any
) -> None:
    """A field with its colour bar; places: x and y; options: of `draw_field`."""
    mesh = draw_field(panel, *places, field, **options)
    panel.figure.colorbar(mesh, ax=panel, label=label, fraction=0.05, pad=0.03)


def outline(panel: Axes, x: np.ndarray, y: np.ndarray, inside: np.ndarray, **look: Any) -> None:
    """The edge of some cells (nx, ny): the sides of those inside that have one outside, or none, beyond."""
    a, b = edges_of(x), edges_of(y)
    padded = np.pad(inside, 1)
    across, along = padded[1:, 1:-1] != padded[:-1, 1:-1], padded[1:-1, 1:] != padded[1:-1, :-1]
    sides = [((a[i], b[j]), (a[i], b[j + 1])) for i, j in zip(*np.nonzero(across), strict=True)]
    sides += [((a[i], b[j]), (a[i + 1], b[j])) for i, j in zip(*np.nonzero(along), strict=True)]
    look = {"color": BLACK, "linewidth": 0.8} | look
    panel.add_collection(LineCollection(sides, **look), autolim=False)


def mark_spots(panel: Axes, spots: Sequence[tuple[float, float]]) -> None:
    """A bar over each spot of a contact, (first, last) on the horizontal axis, at the top edge."""
    for first, last in spots:
        at_top = panel.get_xaxis_transform()
        panel.plot([first, last], [1.0, 1.0], transform=at_top, **_BAR, clip_on=False)


def mark_interface(axes: Sequence[Axes], depth: float, across: bool = False) -> None:
    """A dashed line where the film ends: at x = depth, or across at y = depth."""
    for axis in axes:
        (axis.axhline if across else axis.axvline)(depth, **_INTERFACE)


PRESSURE, STRAIN = "contact pressure $p/p_0$", "plastic strain [%]"
VON_MISES = r"von Mises stress $\sigma_\mathrm{vM}/p_0$"
SURFACE_AXES, PLANE_AXES = ("$x/a$", "$y/a$"), ("$x/a$", "$z/a$")
MICRO, GIGA = 1e6, 1e-9
LINE = 0.2  # %: the proof strain of tensile tests


def rough_pressures(
    x: np.ndarray, y: np.ndarray, fields: Mapping[str, np.ndarray], reach: float = np.inf
) -> Drawing:
    """Pressure over (x, y) in m, |y| <= reach, and the difference; fields: two names -> (nx, ny) in Pa."""
    near, axes = np.abs(y) <= reach, ("$x$ [µm]", "$y$ [µm]")
    values = (GIGA * p[:, near] for p in fields.values())
    pair = FieldPair(MICRO * x, MICRO * y[near], *values, tuple(fields), axes, "pressure [GPa]", (0.0, 0.0))
    return pressure_maps(pair)


def section_pair(
    sam: Result,
    fem: Result,
    name: str,
    units: tuple[float, float],
    *,
    clear: tuple[float, float] | None = None,
) -> tuple[FieldPair, list[MapPeak]]:
    """A quantity of SAM and the axisymmetric model in y = 0, |x/a| <= 1.5, z/a <= 1.9, and the
    maxima as both quote them, refined in depth, in the column where the field is largest. clear:
    depth, and how far from it nothing is known.
    """
    (a, unit), column, label = units, *(("mises_Pa", VON_MISES) if name == "mises" else (name, STRAIN))
    x, z, values = plane_field(sam.tables, column)
    use_x, use_z = np.abs(x) <= 1.5 * a, z <= 1.9 * a
    if clear is not None:
        use_z &= np.abs(z - clear[0]) > clear[1]
    x, z, values = x[use_x], z[use_z], values[np.ix_(use_x, use_z)]
    fields = values / unit, plane_field_on(x, z, fem.tables, column) / unit
    axes = PLANE_AXES if clear is None else ("$x/a_0$", "$z/a_0$")
    peaks = []
    for result, field in zip((sam, fem), fields, strict=True):
        largest = result.quantities["mises_max_Pa" if name == "mises" else "peeq_max"] / unit
        at = int(np.argmax(np.nanmax(np.where(np.isnan(field), -np.inf, field), axis=1)))
        peaks.append(MapPeak(float(x[at] / a), result.quantities[f"{name}_max_depth_m"] / a, largest))
    return FieldPair(x / a, z / a, *fields, ("SAM", "FEM"), axes, label), peaks


def in_body(fem: Result, x: np.ndarray, z: np.ndarray, thickness: float) -> np.ndarray:
    """(nx, nz) von Mises stress of `fem-3d` in y = 0 below the film, linear; NaN above its first depth."""
    u, w, values = plane_field(fem.tables, "mises_Pa")
    w[np.isclose(w, thickness, rtol=1e-9, atol=0.0)] = thickness  # to rounding
    body = w >= thickness
    at = np.stack(np.meshgrid(x, z, indexing="ij"), axis=-1)
    return RegularGridInterpolator((u, w[body]), values[:, body], bounds_error=False)(at)


def peak_at(x: np.ndarray, z: np.ndarray, field: np.ndarray) -> MapPeak:
    """The largest value of a field (nx, nz) that is NaN in places."""
    i, k = np.unravel_index(np.nanargmax(field), field.shape)
    return MapPeak(float(x[i]), float(z[k]), float(field[i, k]))


def iso_levels(largest: float) -> np.ndarray:
    """Levels in % up to the largest strain: round numbers, and 0.2 % whenever it is reached."""
    ticks = MaxNLocator(6).tick_values(0.0, largest)
    apart = ticks[(ticks > 0.0) & (ticks < largest) & (np.abs(ticks - LINE) > 0.25 * ticks[1])]
    return np.union1d(apart, [LINE] if largest > LINE else [])
